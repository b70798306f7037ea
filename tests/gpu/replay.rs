//! `orogen replay --stages gpu`: the same land as the processor's, within rounding, and said to be so.
//!
//! Where nothing computes, the test says so and passes; with `OROGEN_REQUIRE_GPU=1` it fails.

use crate::card;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Rounding of `q` shifts uplift by a millionth; in a few million years of rivers that becomes no more than this, metres.
const SAME_M: f64 = 1.0;

fn replay(stages: &str, out: &Path) -> Value {
    let gesture = Path::new(env!("CARGO_MANIFEST_DIR")).join("gestures/one_finger_push.gesture.jsonl");
    let run = Command::new(env!("CARGO_BIN_EXE_orogen"))
        .arg("replay")
        .arg(gesture)
        .args([
            "--nodes", "9000", "--layers", "jura", "--years", "500000", "--size", "64",
        ])
        .args(["--picture", "none", "--stages", stages, "--out"])
        .arg(out)
        .output()
        .expect("the program runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let report = std::fs::read(out.join("one_finger_push/report.json")).expect("a report");
    serde_json::from_slice(&report).expect("JSON")
}

#[test]
fn the_card_makes_the_same_land() {
    if card::computing().is_none() {
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let [cpu, gpu] = ["cpu", "gpu"].map(|stages| replay(stages, &dir.path().join(stages)));
    assert_eq!(
        (&cpu["reproducible"], &gpu["reproducible"]),
        (&Value::Bool(true), &Value::Bool(false))
    );
    assert_ne!(cpu["digest"], gpu["digest"], "the card has computed");
    assert!(
        !cpu["folds"].as_array().expect("a list").is_empty(),
        "layers fold"
    );
    for key in ["min_m", "max_m", "mean_m"] {
        let [a, b] = [&cpu, &gpu].map(|report| report["terrain"][key].as_f64().expect("metres"));
        assert!((a - b).abs() < SAME_M, "{key}: {a} and {b}");
    }
}
