//! Tidy test: which module may name which. Reads the sources and fails where an arrow points the wrong way.
//!
//! The rules are invariants of absence: the core never names a window, a graphics card, the clock or the
//! environment; the flat world knows nothing of files; gestures know nothing of worlds.

use std::fs;
use std::path::{Path, PathBuf};

/// What a module must not name, and why.
struct Rule {
    module: &'static str,
    forbidden: &'static [&'static str],
    reason: &'static str,
}

const WINDOW_AND_CARD: [&str; 5] = ["winit", "wgpu", "egui::", "hidapi", "rosc"];
const CLOCK_AND_ENVIRONMENT: [&str; 5] = ["std::time", "Instant::now", "SystemTime", "std::env", "std::net"];
const FILES: [&str; 2] = ["std::fs", "std::path"];

const RULES: &[Rule] = &[
    Rule {
        module: "units",
        forbidden: &["crate::"],
        reason: "frames and quantities know nothing",
    },
    Rule {
        module: "sphere",
        forbidden: &["crate::"],
        reason: "samples on a sphere know nothing",
    },
    Rule {
        module: "globe",
        forbidden: &[
            "crate::mountain",
            "crate::terrain",
            "crate::gesture",
            "crate::sim",
            "crate::picture",
            "crate::export",
            "crate::input",
        ],
        reason: "the planet knows neither the flat world, nor hands, nor its viewers",
    },
    Rule {
        module: "rock",
        forbidden: &[
            "crate::gesture",
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::surface",
            "crate::picture",
        ],
        reason: "a pile of rock knows no world",
    },
    Rule {
        module: "gesture",
        forbidden: &[
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::surface",
            "crate::picture",
        ],
        reason: "gestures know no world",
    },
    Rule {
        module: "terrain",
        forbidden: &[
            "crate::mountain",
            "crate::gesture",
            "crate::sim",
            "crate::picture",
            "crate::export",
        ],
        reason: "terrain is written on nodes and neighbours",
    },
    Rule {
        module: "isostasy",
        forbidden: &[
            "crate::mountain",
            "crate::gesture",
            "crate::sim",
            "crate::picture",
            "crate::export",
        ],
        reason: "the crust floats under any land",
    },
    Rule {
        module: "mountain",
        forbidden: &[
            "crate::sim",
            "crate::picture",
            "crate::export",
            "crate::input",
            "crate::globe",
        ],
        reason: "the flat world knows neither its owner nor its viewers",
    },
    Rule {
        module: "surface",
        forbidden: &[
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::gesture",
            "crate::picture",
        ],
        reason: "a surface is plain data",
    },
    Rule {
        module: "slice",
        forbidden: &[
            "crate::gesture",
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::picture",
            "crate::export",
        ],
        reason: "a slice is cut from a surface, for any painter",
    },
    Rule {
        module: "survey",
        forbidden: &[
            "crate::gesture",
            "crate::mountain",
            "crate::sim",
            "crate::picture",
            "crate::export",
        ],
        reason: "a land on its nodes is all that is surveyed",
    },
    Rule {
        module: "live",
        forbidden: &["crate::picture", "crate::export", "crate::input", "crate::cli"],
        reason: "the session is looked at, it does not look",
    },
    Rule {
        module: "sim",
        forbidden: &["crate::picture", "crate::export", "crate::input", "crate::cli"],
        reason: "the session is looked at, it does not look",
    },
    Rule {
        module: "picture",
        forbidden: &[
            "crate::gesture",
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
        ],
        reason: "a picture is made of a surface",
    },
    Rule {
        module: "export",
        forbidden: &[
            "crate::gesture::command",
            "crate::gesture::event",
            "crate::gesture::file",
            "crate::gesture::hand",
            "crate::gesture::stroke",
            "crate::mountain",
            "crate::sim",
            "crate::picture",
        ],
        reason: "files are made of plain data, contacts among them",
    },
    Rule {
        module: "input",
        forbidden: &[
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::picture",
        ],
        reason: "sources know no world",
    },
    Rule {
        module: "gpu",
        forbidden: &[
            "winit",
            "egui::",
            "crate::gesture",
            "crate::terrain",
            "crate::sim",
            "crate::live",
            "crate::render",
            "crate::app",
            "crate::cli",
            "Instant::now",
            "std::env",
        ],
        reason: "the card computes stages and knows neither who asks nor the time",
    },
    Rule {
        module: "device",
        forbidden: &[
            "winit",
            "wgpu",
            "egui::",
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::live",
            "crate::picture",
            "crate::app",
            "crate::cli",
        ],
        reason: "who opens devices knows neither window nor worlds",
    },
    Rule {
        module: "ui",
        forbidden: &[
            "winit",
            "wgpu",
            "crate::sim",
            "crate::mountain",
            "crate::terrain",
            "crate::render",
            "crate::gpu",
            "crate::app",
            "std::time",
            "Instant::now",
            "std::env",
            "std::fs",
        ],
        reason: "what lies on the land is drawn from plain data",
    },
    Rule {
        module: "instrument",
        forbidden: &[
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::picture",
            "crate::kiosk",
        ],
        reason: "the instrument sees marks and a clock, and no world",
    },
    Rule {
        module: "kiosk",
        forbidden: &[
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::surface",
            "crate::live",
            "crate::picture",
            "crate::instrument",
        ],
        reason: "the circle knows contacts and times",
    },
    Rule {
        module: "settings",
        forbidden: &[
            "crate::mountain",
            "crate::terrain",
            "crate::sim",
            "crate::surface",
            "crate::live",
            "crate::picture",
            "crate::instrument",
            "crate::kiosk",
        ],
        reason: "settings are read by all and read nobody",
    },
];

/// Modules that must run without window, card, clock and environment: all but the command line.
const CORE: [&str; 16] = [
    "units",
    "gesture",
    "mountain",
    "terrain",
    "isostasy",
    "surface",
    "slice",
    "survey",
    "sim",
    "live",
    "instrument",
    "kiosk",
    "settings",
    "report",
    "picture",
    "input",
];
/// Modules that must not touch files: they read and write through `Read` and `Write`, or not at all.
const WITHOUT_FILES: [&str; 14] = [
    "units",
    "gesture",
    "mountain",
    "terrain",
    "isostasy",
    "surface",
    "slice",
    "survey",
    "sim",
    "live",
    "instrument",
    "kiosk",
    "settings",
    "report",
];

/// Code of a file without comments, doc comments and its test module.
fn code_of(text: &str) -> String {
    let text = text.split("#[cfg(test)]").next().unwrap_or(text);
    text.lines()
        .map(|line| line.split("//").next().unwrap_or(line))
        .collect::<Vec<_>>()
        .join("\n")
}

fn violations(module: &str, file: &str, text: &str) -> Vec<String> {
    let code = code_of(text);
    let mut found = Vec::new();
    let mut check = |names: &[&str], reason: &str| {
        for name in names {
            if code.contains(name) {
                found.push(format!("{file} names `{name}`: {reason}"));
            }
        }
    };
    for rule in RULES.iter().filter(|rule| rule.module == module) {
        check(rule.forbidden, rule.reason);
    }
    if CORE.contains(&module) {
        check(&WINDOW_AND_CARD, "the core knows no window, card or device");
        check(
            &CLOCK_AND_ENVIRONMENT,
            "the core knows no clock and no environment",
        );
    }
    if WITHOUT_FILES.contains(&module) {
        check(&FILES, "the core reads and writes no files");
    }
    found
}

fn sources() -> Vec<PathBuf> {
    fn walk(dir: &Path, out: &mut Vec<PathBuf>) {
        let mut entries: Vec<_> = fs::read_dir(dir)
            .expect("source folder")
            .map(|e| e.expect("entry").path())
            .collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                walk(&path, out);
            } else if path.extension().is_some_and(|e| e == "rs") {
                out.push(path);
            }
        }
    }
    let mut out = Vec::new();
    walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut out);
    out
}

fn module_of(path: &Path) -> String {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let inside = path.strip_prefix(src).expect("below src");
    let first = inside.components().next().expect("a file name");
    first
        .as_os_str()
        .to_string_lossy()
        .trim_end_matches(".rs")
        .to_owned()
}

#[test]
fn the_arrows_point_one_way() {
    let mut all = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for path in sources() {
        let module = module_of(&path);
        let text = fs::read_to_string(&path).expect("source");
        all.extend(violations(&module, &path.display().to_string(), &text));
        seen.insert(module);
    }
    for rule in RULES {
        assert!(
            seen.contains(rule.module),
            "rule for `{}`, but there is no such module",
            rule.module
        );
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn the_check_can_fail() {
    assert_eq!(
        violations("terrain", "x.rs", "use crate::mountain::Plate;").len(),
        1
    );
    assert_eq!(
        violations("sim", "x.rs", "let t = std::time::Instant::now();").len(),
        2
    );
    assert_eq!(violations("gesture", "x.rs", "use std::fs::File;").len(), 1);
    assert!(violations("terrain", "x.rs", "// not crate::mountain\nuse crate::units::KM;").is_empty());
    assert!(violations("cli", "x.rs", "use std::fs::File;").is_empty());
}

#[test]
fn files_stay_readable() {
    /// Past this a newcomer no longer finds the seam.
    const MOST_LINES: usize = 600;
    for path in sources() {
        let lines = fs::read_to_string(&path).expect("source").lines().count();
        assert!(lines <= MOST_LINES, "{} has {lines} lines", path.display());
    }
}
