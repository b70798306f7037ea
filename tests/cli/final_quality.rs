//! `replay --quality final` and `--region` as a person runs them.

use std::fs;
use std::path::Path;

use crate::cli_common::{OUTPUTS, folder, gesture, listing, orogen, refused, text};

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(path).expect("a file")).expect("JSON")
}

#[test]
fn final_quality_writes_a_finer_land_and_a_box_of_it() {
    let dir = folder();
    let coarse = text(&dir.path().join("coarse.gesture.jsonl"));
    let session = fs::read_to_string(gesture("two_hands_push")).expect("a session");
    fs::write(&coarse, session.replace("\"nodes\":60000", "\"nodes\":2000")).expect("written");
    let out = text(dir.path());
    let final_land = [
        "--quality",
        "final",
        "--years",
        "5e5",
        "--size",
        "320",
        "--out",
        &out,
        "--nodes",
    ];
    let args = [
        &["replay", &coarse],
        &final_land[..],
        &["9000", "--region", "60,40,4,10"],
    ]
    .concat();
    let output = orogen(&args);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let out = dir.path().join("coarse");
    let report = json(&out.join("report.json"));
    assert_eq!(report["inputs"]["nodes"], 9000);
    assert_eq!(report["refinement"]["live_nodes"], 2000);
    assert_eq!(report["refinement"]["steps"], 100);
    let region = out.join("region");
    assert_eq!(listing(&region), OUTPUTS);
    let report = json(&region.join("report.json"));
    assert_eq!(report["south_west_km"], serde_json::json!([60.0, 40.0]));
    assert_eq!(report["terrain"]["nodes"], 160_000);
    assert_eq!(
        json(&region.join("height16.json"))["km_per_pixel"],
        serde_json::json!([0.0125, 0.0125])
    );
    let few = [&["replay", &coarse], &final_land[..], &["1000"]].concat();
    refused(&few, &["--nodes 1000", "2000"]);
}

#[test]
fn boxes_that_cannot_be_are_refused_before_the_work() {
    let file = gesture("two_hands_push");
    let refuse = |region: &str, word: &str| {
        refused(
            &["replay", &file, "--quality", "final", "--region", region],
            &["--region", word],
        );
    };
    refuse("60,40", "expected X,Y,SIDE");
    refuse("60,40,4,x", "expected X,Y,SIDE");
    refuse("60,40,20", "expected 4 to 16");
    refuse("60,40,4,1", "expected 2 to 10");
    refuse("170,97,8", "expected within 0, 0");
    refused(
        &["replay", &file, "--region", "60,40,4"],
        &["--region", "--quality final"],
    );
}
