//! Results read back with readers that others wrote: OpenEXR, imageio and trimesh under Python. All files of a session
//! must show the same land: same heights at the same places, north up, metres, to the precision that the sidecar states.
//!
//! They are found as `common/python.rs` says, with `tests/readers/requirements.txt`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::python;

/// Plays a small session into `out` and returns the folder of its results. Its width is odd, so that no half is the same.
fn session(out: &Path) -> PathBuf {
    let gestures = Path::new(env!("CARGO_MANIFEST_DIR")).join("gestures/two_hands_push.gesture.jsonl");
    let output = Command::new(env!("CARGO_BIN_EXE_orogen"))
        .arg("replay")
        .arg(gestures)
        .args([
            "--nodes", "6000", "--size", "505", "--years", "1e6", "--quiet", "--out",
        ])
        .arg(out)
        .output()
        .expect("the binary runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    out.join("two_hands_push")
}

fn read(python: &Path, folder: &Path) -> Output {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/read.py");
    let output = Command::new(python).arg(script).arg(folder).output();
    output.expect("a Python that starts")
}

/// What the readers complain about.
fn complaint(python: &Path, folder: &Path) -> String {
    let output = read(python, folder);
    assert!(!output.status.success(), "nothing was found wrong");
    let said = String::from_utf8_lossy(&output.stderr);
    said.lines().last().unwrap_or_default().to_owned()
}

#[test]
fn others_read_the_same_land_from_every_file() {
    let Some(python) = python::with_modules("OpenEXR, imageio.v3, numpy, trimesh") else {
        return;
    };
    let out = tempfile::tempdir().expect("a folder");
    let folder = session(out.path());
    let output = read(&python, &folder);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}");
    let facts: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a line of JSON");
    assert_eq!(facts["vertices"], 6000);
    assert_eq!(facts["pixels"], serde_json::json!([284, 505]));
    assert!(
        facts["rivers"].as_u64().is_some_and(|rivers| rivers > 50),
        "{facts}"
    );
    // Vertices lie on the surface that the pixels show.
    assert!(
        facts["mesh_off_m"].as_f64().is_some_and(|off| off < 2.0),
        "{facts}"
    );
}

#[test]
fn readers_find_what_is_wrong() {
    let Some(python) = python::with_modules("OpenEXR, imageio.v3, numpy, trimesh") else {
        return;
    };
    let out = tempfile::tempdir().expect("a folder");
    let folder = session(out.path());
    let spoil = |file: &str, with: &dyn Fn(&mut Vec<u8>), word: &str| {
        let path = folder.join(file);
        let whole = fs::read(&path).expect("a result");
        let mut spoilt = whole.clone();
        with(&mut spoilt);
        assert_ne!(whole, spoilt, "{file}");
        fs::write(&path, spoilt).expect("a file");
        let said = complaint(&python, &folder);
        assert!(said.contains(word), "{file}: {said}");
        fs::write(&path, whole).expect("a file");
    };
    let southern_row_first = |bytes: &mut Vec<u8>| {
        let rows: Vec<u8> = bytes.rchunks(2 * 505).flatten().copied().collect();
        *bytes = rows;
    };
    spoil("height16.r16", &southern_row_first, "height16.r16");
    let replace = |from: &'static str, to: &'static str| {
        move |bytes: &mut Vec<u8>| {
            let at = bytes.windows(from.len()).position(|part| part == from.as_bytes());
            let at = at.expect("the text is there");
            bytes.splice(at..at + from.len(), to.bytes());
        }
    };
    spoil(
        "height16.json",
        &replace("\"metres_at_0\": -", "\"metres_at_0\": "),
        "height16",
    );
    spoil("height16.json", &replace("0.352", "0.252"), "edge");
    // The order of coordinates in the header: the land lies turned.
    let turned = replace(
        "property float x\nproperty float y",
        "property float y\nproperty float x",
    );
    spoil("terrain.ply", &turned, "edge");
    spoil("terrain.glb", &replace("TEXCOORD_0", "TEXCOORD_1"), "");
    spoil("rivers.geojson", &replace("kilometres", "degrees"), "degrees");
}
