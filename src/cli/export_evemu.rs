//! `orogen export-evemu`: gesture files → recordings that Linux can play.

use std::fs::File;

use super::ExportEvemuArgs;
use super::console::Console;
use super::failure::Failure;
use super::import::folder_and_name;
use crate::export::OutDir;
use crate::export::evemu::write_evemu;
use crate::gesture::file::read_gesture;

/// Reads the gesture file of `args` and writes its contacts.
pub(super) fn run(args: &ExportEvemuArgs) -> Result<(), Failure> {
    let name = args.file.display().to_string();
    let file = File::open(&args.file).map_err(|error| Failure::input(format!("{name}: {error}")))?;
    let gestures = read_gesture(file, &name).map_err(Failure::input)?;
    for warning in &gestures.warnings {
        Console::warn(warning);
    }
    let title = gestures.header.title.as_deref().unwrap_or("Orogen");
    let (folder, target) = folder_and_name(&args.out)?;
    let mut left_out = Vec::new();
    OutDir::create(folder)
        .and_then(|out| {
            out.write(&target, |w| {
                left_out = write_evemu(w, title, gestures.header.size_mm, &gestures.frames)?;
                Ok(())
            })
        })
        .map_err(Failure::input)?;
    for sentence in &left_out {
        Console::warn(sentence);
    }
    Console::result(&args.out.display().to_string());
    Ok(())
}
