//! Replays the seeds of the fuzz targets and everything they once found.

#![allow(clippy::print_stdout, reason = "a test that fails shows on which file")]

#[path = "../fuzz/checks.rs"]
mod checks;
#[path = "../fuzz/hid_checks.rs"]
mod hid_checks;

use std::fs;
use std::path::Path;

/// Runs `check` on the files of both folders of `target`, and says how many there were.
fn replay(target: &str, check: fn(&[u8])) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = 0;
    for folder in ["fuzz/seeds", "tests/regressions"] {
        let Ok(entries) = fs::read_dir(root.join(folder).join(target)) else {
            continue;
        };
        for entry in entries {
            let path = entry.expect("a readable folder").path();
            println!("{}", path.display());
            check(&fs::read(&path).expect("a readable file"));
            files += 1;
        }
    }
    files
}

#[test]
fn gesture_reader() {
    assert!(replay("gesture_reader", checks::gesture_reader) >= 3);
}

#[test]
fn evemu_import() {
    assert!(replay("evemu_import", checks::evemu_import) >= 3);
}

#[test]
fn hid_recorder_import() {
    assert!(replay("hid_recorder_import", checks::hid_recorder_import) >= 1);
}

#[test]
fn libinput_import() {
    assert!(replay("libinput_import", checks::libinput_import) >= 1);
}

#[test]
fn tuio() {
    assert!(replay("tuio", checks::tuio) >= 3);
}

#[test]
fn tuio_import() {
    assert!(replay("tuio_import", checks::tuio_import) >= 2);
}

#[test]
fn settings() {
    assert!(replay("settings", checks::settings) >= 2);
}

#[test]
fn pile() {
    assert!(replay("pile", checks::pile) >= 1);
}

#[test]
fn planet_image() {
    assert!(replay("planet_image", checks::planet_image) >= 3);
}

#[test]
fn hid_descriptor() {
    assert!(replay("hid_descriptor", hid_checks::descriptor) >= 5);
}

#[test]
fn hid_report() {
    assert!(replay("hid_report", hid_checks::reports) >= 3);
}

/// Seeds that are refused at the first line would teach the fuzzer nothing.
#[test]
fn seeds_are_read() {
    use orogen::gesture::file::read_gesture;
    use orogen::input::hid::Descriptor;
    use orogen::input::import::{
        ImportOptions, import_evemu, import_hid_recorder, import_libinput, import_tuio,
    };
    use orogen::input::planet::{Colours, Heights};
    use orogen::settings::Settings;

    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds");
    for name in ["grammar", "split", "commands"] {
        let path = seeds.join(format!("gesture_reader/{name}.gesture.jsonl"));
        let file = read_gesture(fs::File::open(path).unwrap(), name).unwrap();
        assert!(file.frames.len() >= 5, "{name}");
    }
    for name in ["few", "sample"] {
        let bytes = fs::read(seeds.join(format!("settings/{name}.toml"))).unwrap();
        Settings::parse(&bytes, name).unwrap();
    }
    let bytes = fs::read(seeds.join("pile/digne.toml")).unwrap();
    orogen::rock::Stratigraphy::parse(&bytes, "digne").unwrap();
    let planet = |name: &str| fs::read(seeds.join("planet_image").join(name)).unwrap();
    Heights::decode(&planet("heights.png"), [0.0, 1.0]).unwrap();
    Colours::decode(&planet("plates.png")).unwrap();
    Colours::decode(&planet("plates.exr")).unwrap();
    for name in ["hybrid", "parallel", "serial", "features"] {
        let bytes = fs::read(seeds.join(format!("hid_descriptor/{name}.bin"))).unwrap();
        assert!(Descriptor::parse(&bytes).unwrap().touch.is_ok(), "{name}");
    }
    let options = ImportOptions {
        range: None,
        size_mm: Some([100.0, 60.0].into()),
    };
    for name in ["two_fingers", "mid_touch", "packets"] {
        let path = seeds.join(format!("evemu_import/{name}.events"));
        let imported = import_evemu(fs::File::open(path).unwrap(), name, &options).unwrap();
        assert!(imported.frames.len() >= 3, "{name}");
    }
    let path = seeds.join("hid_recorder_import/two_fingers.hid");
    let imported = import_hid_recorder(fs::File::open(path).unwrap(), "hid", &options).unwrap();
    assert!(imported.frames.len() >= 3);
    let path = seeds.join("libinput_import/two_devices.yml");
    let imported = import_libinput(fs::File::open(path).unwrap(), "yml", &options).unwrap();
    assert!(imported.frames.len() >= 3);
    for name in ["times.jsonl", "list.json"] {
        let path = seeds.join("tuio_import").join(name);
        let imported = import_tuio(fs::File::open(path).unwrap(), name, &options).unwrap();
        assert!(imported.frames.len() >= 3);
    }
}
