//! The binary as a person runs it.
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

pub(crate) fn orogen(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_orogen"))
        .args(args)
        .output()
        .expect("the binary runs")
}

pub(crate) fn gesture(name: &str) -> String {
    format!("{}/gestures/{name}.gesture.jsonl", env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

pub(crate) fn text(path: &Path) -> String {
    path.to_str().expect("a UTF-8 path").to_owned()
}

/// Bad input: exit code 2, one line on standard error that holds all of `words`, nothing on standard output.
pub(crate) fn refused(args: &[&str], words: &[&str]) {
    let output = orogen(args);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
    assert_eq!(
        error.trim_end().lines().count(),
        1,
        "{args:?}: one line expected, got:\n{error}"
    );
    for word in words {
        assert!(error.contains(word), "{args:?}: `{word}` expected in: {error}");
    }
    assert!(output.stdout.is_empty(), "{args:?}");
}

pub(crate) fn listing(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(dir)
        .expect("folder")
        .map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

pub(crate) const OUTPUTS: [&str; 12] = [
    "folds.geojson",
    "geology.png",
    "height.exr",
    "height16.json",
    "height16.png",
    "height16.r16",
    "picture.png",
    "report.json",
    "rivers.geojson",
    "terrain.glb",
    "terrain.ply",
    "timings.json",
];
