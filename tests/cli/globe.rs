//! `orogen planet`, and `orogen replay` of the globe, as a person runs them.

use std::fs;
use std::path::Path;

use crate::cli_common::{listing, orogen, refused, text};
use serde_json::Value;

/// Good input: the picture that is named is there.
fn done(args: &[&str]) {
    let output = orogen(args);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {error}");
    let shown = String::from_utf8_lossy(&output.stdout);
    assert!(Path::new(shown.trim_end()).is_file(), "names a file: {shown}");
}

fn report(dir: &Path) -> Value {
    serde_json::from_slice(&fs::read(dir.join("report.json")).expect("report")).expect("JSON")
}

const OUTPUTS: [&str; 15] = [
    "age.exr",
    "age.png",
    "crust.png",
    "elevation.exr",
    "elevation16.json",
    "elevation16.png",
    "globe.png",
    "orogeny.png",
    "picture.png",
    "planet.glb",
    "plates.geojson",
    "plates.png",
    "plates.rot",
    "report.json",
    "timings.json",
];

/// A small planet.
fn planet(out: &Path, more: &[&str]) -> Vec<String> {
    let out = text(out);
    let mut args = vec![
        "planet", "--out", &out, "--nodes", "3000", "--size", "256", "--plates", "12", "--years", "2e7",
    ];
    args.extend_from_slice(more);
    args.into_iter().map(str::to_owned).collect()
}

fn strs(args: &[String]) -> Vec<&str> {
    args.iter().map(String::as_str).collect()
}

/// A file in which the plate below two fingers is led for a while.
fn globe_file(dir: &Path, header: &str) -> String {
    let path = dir.join("led.gesture.jsonl");
    let mut lines = format!(
        "{{\"format\":\"orogen-gesture\",\"version\":1,\"surface\":{{\"size_mm\":[1209.6,680.4]}},\"mode\":\"globe\"{header}}}\n\
         {{\"t\":0,\"do\":{{\"planet\":{{\"plates\":8,\"continental\":0.3,\"seed\":4}}}}}}\n"
    );
    for step in 0..60 {
        let x = 560.0 + f64::from(step);
        let t = 200 + 32 * step;
        let phase = if step == 0 { "down" } else { "move" };
        let frame = format!("{{\"t\":{t},\"{phase}\":[[1,{x},340],[2,{},340]]}}\n", x + 70.0);
        lines.push_str(&frame);
    }
    lines += "{\"t\":2500,\"up\":[1,2]}\n";
    fs::write(&path, lines).expect("a gesture file");
    text(&path)
}

#[test]
fn a_planet_is_written_with_all_its_files_and_is_the_same_for_any_number_of_threads() {
    let dirs = ["1", "2"].map(|threads| {
        let dir = tempfile::tempdir().expect("a folder");
        done(&strs(&planet(
            dir.path(),
            &["--threads", threads, "--every", "10"],
        )));
        dir
    });
    let [one, two] = [0, 1].map(|k| dirs[k].path().join("planet"));
    let names = listing(&one);
    assert_eq!(
        names.iter().filter(|name| *name != "history").count(),
        OUTPUTS.len()
    );
    for name in OUTPUTS.iter().filter(|name| **name != "timings.json") {
        let [a, b] = [&one, &two].map(|dir| fs::read(dir.join(name)).expect("a file"));
        assert!(a == b, "{name} differs between one and two threads");
    }
    assert_eq!(
        listing(&one.join("history")),
        ["map_0000.png", "map_0001.png", "map_0002.png"]
    );
    let report = report(&one);
    assert_eq!(report["inputs"]["samples"], 3000);
    assert_eq!(report["inputs"]["preset"], "planet");
    assert!((report["time_my"].as_f64().expect("a number") - 20.0).abs() < 1e-6);
    let bins = report["hypsometry"]["bins"].as_array().expect("bins");
    let sum: f64 = bins.iter().map(|bin| bin.as_f64().expect("a share")).sum();
    assert_eq!(bins.len(), 38);
    assert!((sum - 1.0).abs() < 1e-9, "shares of the whole: {sum}");
}

#[test]
fn a_gesture_file_of_the_globe_is_played() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = globe_file(dir.path(), ",\"seed\":3,\"nodes\":3000,\"years\":4e6");
    let out = text(dir.path());
    done(&["replay", &file, "--out", &out, "--size", "256"]);
    let run = dir.path().join("led");
    assert_eq!(listing(&run), OUTPUTS);
    let report = report(&run);
    assert_eq!(report["inputs"]["plates"], 8, "the planet that the file asks for");
    assert_eq!(report["inputs"]["seed"], 4);
    assert!(
        report["deeds"]["led"].as_u64().expect("a number") >= 1,
        "a hand led"
    );
    assert_eq!(report["contacts"]["dead_touches"], 0);
    // Two seconds and a half at the default pace, and the years of the file.
    let time = report["time_my"].as_f64().expect("a number");
    assert!((14.0..=18.0).contains(&time), "{time} My");
    done(&[
        "replay",
        &file,
        "--out",
        &out,
        "--size",
        "256",
        "--paper",
        "--picture",
        "none",
    ]);
    let paper = self::report(&run);
    assert_eq!(paper["inputs"]["preset"], "paper");
    assert_ne!(paper["digest"], report["digest"]);
}

#[test]
fn images_of_heights_and_plates_are_a_planet_to_begin_with() {
    let dir = tempfile::tempdir().expect("a folder");
    let heights = image::ImageBuffer::from_fn(64, 32, |x, _| {
        image::Luma([if x < 20 { 40_000_u16 } else { 18_000 }])
    });
    let plates = image::RgbImage::from_fn(64, 32, |x, _| {
        image::Rgb(if x < 32 { [255, 0, 0] } else { [0, 0, 255] })
    });
    let [elevation, colours] = ["heights.png", "plates.png"].map(|name| dir.path().join(name));
    heights.save(&elevation).expect("an image");
    plates.save(&colours).expect("an image");
    let (elevation, colours, out) = (text(&elevation), text(&colours), text(dir.path()));
    let args = [
        "planet",
        "--out",
        &out,
        "--nodes",
        "3000",
        "--size",
        "128",
        "--years",
        "0",
        "--elevation",
        &elevation,
        "--plate-colours",
        &colours,
        "--metres",
        "-10000,10000",
    ];
    done(&args);
    let found = report(&dir.path().join("planet"));
    assert_eq!(
        (&found["inputs"]["start"], &found["inputs"]["plates"]),
        (&"maps".into(), &2.into())
    );
    let land = found["hypsometry"]["land_share"].as_f64().expect("a share");
    assert!((land - 20.0 / 64.0).abs() < 0.03, "{land}");
    // What Orogen writes of a planet it reads again.
    let exr = text(&dir.path().join("planet/elevation.exr"));
    let second = text(&dir.path().join("again"));
    let args = [
        "planet",
        "--out",
        &second,
        "--nodes",
        "3000",
        "--size",
        "128",
        "--years",
        "0",
        "--elevation",
        &exr,
        "--plate-colours",
        &colours,
    ];
    done(&args);
    let again = report(&dir.path().join("again/planet"));
    let again = again["hypsometry"]["land_share"].as_f64().expect("a share");
    assert!((again - land).abs() < 0.02, "{again} for {land}");
    refused(&["planet", "--elevation", &elevation], &["--plate-colours"]);
    let missing = text(&dir.path().join("none.png"));
    refused(
        &[
            "planet",
            "--out",
            &out,
            "--elevation",
            &missing,
            "--plate-colours",
            &colours,
        ],
        &["none.png"],
    );
}

#[test]
fn what_a_globe_cannot_have_is_refused_in_one_line() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = globe_file(dir.path(), "");
    let out = text(dir.path());
    for (option, value) in [
        ("--slice", "1,1,9,9"),
        ("--layers", "jura"),
        ("--isostasy", "off"),
        ("--deposition", "off"),
    ] {
        refused(
            &["replay", &file, "--out", &out, option, value],
            &["led.gesture.jsonl", option, "globe"],
        );
    }
    refused(
        &["replay", &file, "--out", &out, "--nodes", "16"],
        &["--nodes", "1000"],
    );
    refused(
        &["replay", &file, "--out", &out, "--years", "2e9"],
        &["--years", "1e9"],
    );
    refused(&["planet", "--out", &out, "--years", "-1"], &["--years", "1e9"]);
    refused(&["planet", "--out", &out, "--plates", "0"], &["plates"]);
    refused(
        &["planet", "--out", &out, "--continental", "1.5"],
        &["continental"],
    );
    refused(
        &["planet", "--out", &out, "--metres", "high"],
        &["--metres", "-10000,10000"],
    );
    assert!(!dir.path().join("planet").exists(), "nothing is left behind");
}

#[cfg(feature = "app")]
#[test]
fn a_rendered_picture_of_a_globe_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = globe_file(dir.path(), "");
    refused(
        &["replay", &file, "--picture", "render"],
        &["--picture render", "globe"],
    );
}
