//! The commands as a person runs them: outputs, exit codes, one-line errors, nothing half-written.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cli_common::{OUTPUTS, folder, gesture, listing, orogen, refused, text};

fn replay(dir: &Path, more: &[&str]) -> PathBuf {
    let out = text(dir);
    let file = gesture("two_hands_push");
    let mut args = vec![
        "replay", &file, "--out", &out, "--nodes", "3000", "--size", "320", "--years", "5e5",
    ];
    args.extend_from_slice(more);
    let output = orogen(&args);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    let shown = String::from_utf8_lossy(&output.stdout);
    let picture = PathBuf::from(shown.trim_end());
    assert!(picture.is_file(), "the command names the picture: {shown}");
    picture.parent().expect("a folder").to_owned()
}

#[test]
fn replay_writes_everything_it_promises() {
    let dir = folder();
    let run = replay(dir.path(), &[]);
    assert_eq!(run, dir.path().join("two_hands_push"));
    assert_eq!(listing(&run), OUTPUTS);
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(run.join("report.json")).expect("report")).expect("JSON");
    assert_eq!(report["terrain"]["nodes"], 3000);
    assert!(report["contacts"]["pushes"].as_u64().expect("a number") >= 1);
    assert_eq!(report["contacts"]["dead_touches"], 0);
    let area = report["terrain"]["outlet_area_km2"].as_f64().expect("a number");
    let size = &report["inputs"]["size_km"];
    let whole = size[0].as_f64().expect("km") * size[1].as_f64().expect("km");
    assert!(
        (area / whole - 1.0).abs() < 1e-9,
        "all water leaves: {area} of {whole} km²"
    );
    let height = report["terrain"]["max_m"].as_f64().expect("a number");
    assert!(height > 300.0, "a range rises: {height} m");
}

#[test]
fn equal_inputs_give_equal_bytes_for_any_number_of_threads() {
    let dirs: Vec<_> = ["1", "2", "7"]
        .iter()
        .map(|threads| {
            let dir = folder();
            let run = replay(dir.path(), &["--threads", threads]);
            (dir, run)
        })
        .collect();
    for name in OUTPUTS.iter().filter(|name| **name != "timings.json") {
        let first = fs::read(dirs[0].1.join(name)).expect("file");
        for (_, run) in &dirs[1..] {
            assert!(first == fs::read(run.join(name)).expect("file"), "{name} differs");
        }
    }
    let other = folder();
    let run = replay(other.path(), &["--seed", "99"]);
    let (a, b) = (
        fs::read(dirs[0].1.join("report.json")),
        fs::read(run.join("report.json")),
    );
    assert_ne!(
        a.expect("file"),
        b.expect("file"),
        "another seed gives another land"
    );
}

#[test]
fn history_is_drawn_on_request() {
    let dir = folder();
    let run = replay(dir.path(), &["--every", "5"]);
    let frames = listing(&run.join("frames"));
    assert!(frames.len() >= 2 && frames[0] == "00001.png", "{frames:?}");
}

#[test]
fn bad_gestures_are_refused_with_file_and_line() {
    let dir = folder();
    let header =
        r#"{"format":"orogen-gesture","version":1,"surface":{"size_mm":[1209.6,680.4]},"mode":"mountain"}"#;
    let cases: &[(&str, String, &[&str])] = &[
        ("empty", String::new(), &["empty.gesture.jsonl"]),
        (
            "format",
            "{\"format\":\"other\",\"version\":1}\n".into(),
            &["format.gesture.jsonl:1:", "orogen-gesture"],
        ),
        (
            "version",
            header.replace(":1,", ":2,") + "\n",
            &["version.gesture.jsonl:1:", "version"],
        ),
        (
            "nan",
            format!("{header}\n{{\"t\":0,\"down\":[[1,NaN,3]]}}\n{{\"t\":1}}\n"),
            &[":2:"],
        ),
        (
            "huge",
            format!("{header}\n{{\"t\":0,\"down\":[[1,1e300,3]]}}\n"),
            &[":2:"],
        ),
        (
            "unknown",
            format!("{header}\n{{\"t\":0,\"move\":[[1,3,3]]}}\n"),
            &[":2:", "1"],
        ),
        ("back", format!("{header}\n{{\"t\":5}}\n{{\"t\":4}}\n"), &[":3:"]),
        (
            "twice",
            format!("{header}\n{{\"t\":0,\"down\":[[1,3,3]]}}\n{{\"t\":4,\"down\":[[1,3,3]]}}\n"),
            &[":3:"],
        ),
    ];
    for (name, content, words) in cases {
        let path = dir.path().join(format!("{name}.gesture.jsonl"));
        fs::write(&path, content).expect("written");
        let out = dir.path().join("out");
        refused(&["replay", &text(&path), "--out", &text(&out)], words);
        assert!(!out.exists(), "{name}: nothing is written");
    }
    refused(&["replay", "no-such.gesture.jsonl"], &["no-such.gesture.jsonl"]);
}

#[test]
fn replay_cuts_slices_and_marks_them_on_the_map() {
    let dir = folder();
    let run = replay(dir.path(), &[]);
    let plain = fs::read(run.join("picture.png")).expect("picture");
    let run = replay(
        dir.path(),
        &["--slice", "-20,50,400,50", "--slice", "30,20,60,80"],
    );
    let names = listing(&run);
    for name in ["slice.svg", "slice.png", "slice-2.svg", "slice-2.png"] {
        assert!(names.iter().any(|found| found == name), "{name} in {names:?}");
    }
    let svg = fs::read_to_string(run.join("slice-2.svg")).expect("UTF-8");
    assert!(svg.contains("B'") && svg.ends_with("</svg>\n"));
    assert!(plain != fs::read(run.join("picture.png")).expect("picture"));
}

#[test]
fn a_torn_last_line_is_a_warning() {
    let dir = folder();
    let whole = fs::read_to_string(gesture("one_finger_push")).expect("shipped gesture");
    let path = dir.path().join("torn.gesture.jsonl");
    fs::write(&path, &whole[..whole.len() - 4]).expect("written");
    let out = text(&dir.path().join("out"));
    let output = orogen(&[
        "replay",
        &text(&path),
        "--out",
        &out,
        "--nodes",
        "500",
        "--size",
        "64",
        "--years",
        "1e5",
    ]);
    assert!(output.status.success());
    assert!(
        String::from_utf8_lossy(&output.stderr).contains("warning"),
        "the torn line is named"
    );
}

#[test]
fn bad_usage_is_one_line() {
    refused(&["replay", "--nodes", "3"], &["--nodes", "16"]);
    refused(&["replay", "--threads", "0"], &["--threads"]);
    refused(&["replay", "--frobnicate"], &["--frobnicate"]);
    refused(&["replay", "--years", "-1"], &["--years", "expected"]);
    refused(
        &["replay", "--slice", "1,2,3"],
        &["--slice", "x0,y0,x1,y1", "found 3"],
    );
    refused(&["replay", "--slice", "-1,2,x,4"], &["--slice", "x1", "km"]);
    refused(&["replay", "--slice", "5,5,5,5"], &["--slice", "apart"]);
    refused(
        &["replay", "--slice", "-9,5,-8,7"],
        &["--slice", "cross the land", "km"],
    );
    refused(&["dance"], &["dance"]);
    refused(&["erode"], &["--uplift"]);
    refused(&["erode", "--uplift", "5"], &["--uplift", "5"]);
    refused(&["erode", "--uplift", "1e-3", "--n", "0"], &["--n"]);
    refused(&["import", "x"], &["--out"]);
    refused(&["export-evemu", "x"], &["--out"]);
}

#[test]
fn an_output_folder_that_cannot_be_written_is_named_before_the_work() {
    let dir = folder();
    let blocked = dir.path().join("a-file");
    fs::write(&blocked, "in the way").expect("written");
    let file = gesture("one_finger_push");
    refused(&["replay", &file, "--out", &text(&blocked)], &["a-file"]);
    refused(
        &["erode", "--uplift", "1e-3", "--out", &text(&blocked)],
        &["a-file"],
    );
    assert_eq!(fs::read_to_string(&blocked).expect("still there"), "in the way");
}

#[test]
fn erode_makes_land_from_a_number_and_from_maps() {
    let dir = folder();
    let out = text(dir.path());
    let output = orogen(&[
        "erode", "--uplift", "5e-4", "--out", &out, "--nodes", "2000", "--size", "128", "--years", "2e6",
    ]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let first = dir.path().join("erode");
    // Rock that is all alike has no geology and no folds.
    assert_eq!(listing(&first), OUTPUTS[2..]);

    // A terrain that exists already goes in as a start surface, with its own uplift map and a mask.
    let start = text(&first.join("height16.png"));
    let uplift = text(&first.join("height.exr"));
    let mask = dir.path().join("mask.png");
    image::GrayImage::from_pixel(128, 128, image::Luma([255]))
        .save(&mask)
        .expect("mask");
    let second = dir.path().join("again");
    let args = [
        "erode",
        "--uplift",
        "0",
        "--start",
        &start,
        "--protect",
        &text(&mask),
        "--out",
        &text(&second),
        "--nodes",
        "2000",
        "--size",
        "128",
        "--years",
        "1e6",
    ];
    let output = orogen(&args);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let terrain = |dir: &Path| -> serde_json::Value {
        let report = fs::read(dir.join("report.json")).expect("report");
        serde_json::from_slice::<serde_json::Value>(&report).expect("JSON")["terrain"].clone()
    };
    let kept = terrain(&second.join("height16"));
    assert_eq!(kept["eroded_km3"], 0.0, "a protected land stays");
    let before = terrain(&first)["max_m"].as_f64().expect("m");
    let after = kept["max_m"].as_f64().expect("m");
    assert!((before - after).abs() < 0.25 * before, "{before} m and {after} m");

    let output = orogen(&[
        "erode",
        "--uplift",
        &uplift,
        "--out",
        &text(&second),
        "--nodes",
        "500",
        "--size",
        "64",
        "--years",
        "1e5",
    ]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn maps_that_are_none_are_refused() {
    let dir = folder();
    let none = dir.path().join("none.exr");
    fs::write(&none, b"this is no picture").expect("written");
    let wide = dir.path().join("wide.png");
    image::GrayImage::from_pixel(64, 32, image::Luma([255]))
        .save(&wide)
        .expect("map");
    let tall = dir.path().join("tall.png");
    image::GrayImage::from_pixel(32, 64, image::Luma([255]))
        .save(&tall)
        .expect("map");
    let out = text(&dir.path().join("out"));
    refused(
        &["erode", "--uplift", &text(&none), "--out", &out],
        &["none.exr", "EXR"],
    );
    refused(
        &["erode", "--uplift", "no-such.png", "--out", &out],
        &["no-such.png"],
    );
    refused(
        &[
            "erode",
            "--uplift",
            &text(&wide),
            "--rain",
            &text(&tall),
            "--out",
            &out,
        ],
        &["--rain", "32 × 64", "64 × 32"],
    );
    assert!(!Path::new(&out).exists());
}

#[test]
fn import_writes_a_gesture_file_that_replays() {
    let dir = folder();
    let recording = dir.path().join("two.events");
    let mut events = String::from(
        "# EVEMU 1.2\nN: Test screen\nA: 2f 0 9 0 0\nA: 35 0 4000 0 0 10\nA: 36 0 3000 0 0 10\nA: 39 0 65535 0 0\n",
    );
    for step in 0..60 {
        let (seconds, x) = (f64::from(step) * 0.016, 1500 + step * 10);
        if step == 0 {
            events += "E: 0.000000 0003 002f 0000\nE: 0.000000 0003 0039 0007\nE: 0.000000 0003 0036 1500\n";
        }
        write!(
            events,
            "E: {seconds:.6} 0003 0035 {x}\nE: {seconds:.6} 0000 0000 0000\n"
        )
        .expect("a string");
    }
    events += "E: 1.000000 0003 0039 -1\nE: 1.000000 0000 0000 0000\n";
    fs::write(&recording, events).expect("written");
    let target = dir.path().join("two.gesture.jsonl");
    let output = orogen(&["import", &text(&recording), "--out", &text(&target)]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let out = text(&dir.path().join("out"));
    let output = orogen(&[
        "replay",
        &text(&target),
        "--out",
        &out,
        "--nodes",
        "500",
        "--size",
        "64",
        "--years",
        "1e5",
    ]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let report = fs::read_to_string(dir.path().join("out/two/report.json")).expect("report");
    assert!(report.contains("\"pushes\": 1"), "{report}");

    // And back again: the same recording, whatever its units were.
    let exported = dir.path().join("again.events");
    let output = orogen(&["export-evemu", &text(&target), "--out", &text(&exported)]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let again = dir.path().join("again.gesture.jsonl");
    let output = orogen(&["import", &text(&exported), "--out", &text(&again)]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let read = |path: &Path| fs::read_to_string(path).expect("a file");
    assert_eq!(read(&again), read(&target));
    refused(
        &["export-evemu", &text(&exported), "--out", &text(&again)],
        &["again.events:1:", "expected"],
    );

    let bad = dir.path().join("bad.events");
    fs::write(&bad, "# EVEMU 1.2\nN: x\nE: 0.0 0003 zz 1\n").expect("written");
    refused(
        &["import", &text(&bad), "--out", &text(&target)],
        &["bad.events:3:", "expected"],
    );
}

/// Something here can draw, as far as the command can see.
#[cfg(feature = "app")]
#[expect(clippy::print_stderr, reason = "a test that is left out says so")]
fn can_draw() -> bool {
    let can = orogen::gpu::Gpu::offscreen().is_ok();
    let required = std::env::var_os("OROGEN_REQUIRE_GPU").is_some_and(|value| value == "1");
    assert!(can || !required, "no graphics adapter");
    if !can {
        eprintln!("skipped: no graphics adapter");
    }
    can
}

#[cfg(feature = "app")]
#[test]
fn the_evening_is_drawn_beside_the_map_or_alone() {
    if !can_draw() {
        return;
    }
    let dir = folder();
    let both = replay(&dir.path().join("both"), &["--picture", "both"]);
    assert!(both.join("picture.png").is_file());
    let render = image::open(both.join("render.png")).expect("a picture").to_rgb8();
    assert_eq!((render.width(), render.height()), (320, 180));
    let first = render.get_pixel(0, 0);
    assert!(render.pixels().any(|pixel| pixel != first), "something is drawn");

    let alone = replay(&dir.path().join("alone"), &["--picture", "render"]);
    assert!(alone.join("render.png").is_file());
    assert!(!alone.join("picture.png").exists());
}

#[cfg(feature = "app")]
#[test]
fn without_an_adapter_the_evening_fails_and_both_draws_the_map() {
    let run = |picture: &str, dir: &Path| {
        Command::new(env!("CARGO_BIN_EXE_orogen"))
            .args(["replay", &gesture("two_hands_push"), "--out", &text(dir)])
            .args([
                "--nodes",
                "500",
                "--size",
                "64",
                "--years",
                "1e5",
                "--picture",
                picture,
            ])
            // No interface has this name.
            .env("WGPU_BACKEND", "none")
            .output()
            .expect("the binary runs")
    };
    let dir = folder();
    let refused = run("render", &dir.path().join("render"));
    let error = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(3), "{error}");
    assert_eq!(error.trim_end().lines().count(), 1, "{error}");
    assert!(error.contains("--picture map"), "{error}");
    assert!(!dir.path().join("render").exists(), "nothing is written");

    let warned = run("both", &dir.path().join("both"));
    let error = String::from_utf8_lossy(&warned.stderr);
    assert!(warned.status.success(), "{error}");
    assert!(error.contains("no render.png"), "{error}");
    let out = dir.path().join("both").join("two_hands_push");
    assert!(out.join("picture.png").is_file() && !out.join("render.png").exists());
}
