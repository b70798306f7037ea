//! The gesture files: what each is about, and its bytes.

mod builtin;
mod expected;
mod hand;
mod planets;
mod ranges;
mod show;
mod trouble;
mod visitors;

use std::fmt::Write as _;
use std::io;

use orogen::gesture::file::GestureFile;

/// A gesture file and what it is called.
pub(crate) struct Matter {
    /// The file is `<name>.gesture.jsonl`.
    pub(crate) name: &'static str,
    /// The heading it stands under in the table.
    group: &'static str,
    /// What is played.
    pub(crate) file: GestureFile,
}

type Scene = (&'static str, fn() -> show::Show);

/// All matters, in the order of the table.
pub(crate) fn matters() -> Vec<Matter> {
    let groups: [(&str, &[Scene]); 6] = [
        ("What hands are for", &expected::SCENES),
        ("Ranges of the world", &ranges::SCENES),
        ("Planets", &planets::SCENES),
        ("Visitors to whom nobody explained anything", &visitors::SCENES),
        ("Trouble with contacts", &trouble::SCENES),
        ("The show", &builtin::SCENES),
    ];
    let all = groups
        .iter()
        .flat_map(|&(group, scenes)| scenes.iter().map(move |&(name, scene)| (group, name, scene)));
    all.map(|(group, name, scene)| Matter {
        name,
        group,
        file: scene().file(),
    })
    .collect()
}

/// Name and bytes of everything in `gestures/`.
///
/// # Errors
/// What writing to memory reports: nothing.
pub(crate) fn files() -> io::Result<Vec<(String, Vec<u8>)>> {
    let matters = matters();
    let mut files = vec![("README.md".to_owned(), readme(&matters).into_bytes())];
    for matter in &matters {
        let bytes = matter.file.write(Vec::new())?;
        files.push((format!("{}.gesture.jsonl", matter.name), bytes));
    }
    Ok(files)
}

/// The table of matters, in Markdown.
fn readme(matters: &[Matter]) -> String {
    let mut out = String::from(
        "# Gestures\n\n\
         Each file is about one matter. The format is described in `src/gesture/file/mod.rs`; play a file with\n\
         `orogen replay gestures/two_hands_push.gesture.jsonl`. Files and table are written by\n\
         `cargo run --example make_gestures`: change a scene there, never here.\n",
    );
    let mut group = "";
    for matter in matters {
        if matter.group != group {
            group = matter.group;
            let _ = write!(
                out,
                "\n## {group}\n\n| file | about | must be seen |\n|---|---|---|\n"
            );
        }
        let header = &matter.file.header;
        let about = header.title.as_deref().unwrap_or_default();
        let see = header.expect.as_ref().and_then(|expect| expect.see.as_deref());
        let _ = writeln!(
            out,
            "| `{}` | {about} | {} |",
            matter.name,
            see.unwrap_or_default()
        );
    }
    out
}
