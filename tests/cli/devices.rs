//! `orogen devices`, as people and tools use it.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use crate::hid_common::{Items, Shape, TOUCH_PAD};
use serde_json::{Value, json};

fn devices(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_orogen"))
        .arg("devices")
        .args(args)
        .output()
        .expect("the program starts")
}

/// What `--descriptor` makes of this text, with these arguments.
fn explain(text: &str, args: &[&str]) -> (Output, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.hex");
    fs::write(&path, text).expect("a file");
    let path = path.to_str().expect("a plain path");
    (devices(&[&["--descriptor", path], args].concat()), path.into())
}

fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn hex(bytes: &[u8]) -> String {
    let bytes: Vec<String> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    bytes.join(" ")
}

#[test]
fn a_touchscreen_is_explained_to_people_and_tools() {
    let bytes = Shape {
        slots: 2,
        in_range: true,
        ..Shape::default()
    }
    .build()
    .bytes;
    let (page, _) = explain(&hex(&bytes), &[]);
    assert!(page.status.success());
    let page = out(&page);
    for words in [
        "touchscreen   yes: a touchscreen: 2 contacts in each report, up to 10 in 5 reports",
        "collections   Touch Screen",
        "surface       600.0 × 340.0 mm",
        "report        1, ",
        "0 to 4095, 600.0 mm",
        "1 more slot",
        "contact_count",
        "feature report 2",
        "CONTACT_CNT_ACCURATE",
    ] {
        assert!(page.contains(words), "{words}:\n{page}");
    }

    let recorded = format!("R: {} {}\nN: a table\n", bytes.len(), hex(&bytes));
    let (object, _) = explain(&recorded, &["--json"]);
    let object: Value = serde_json::from_str(&out(&object)).expect("JSON");
    let expected = json!({
        "touchscreen": true,
        "reason": "a touchscreen: 2 contacts in each report, up to 10 in 5 reports",
        "slots": 2,
        "max_contacts": 10,
        "fields": {
            "tip": 2, "in_range": 2, "confidence": 2, "contact_id": 2, "x": 2, "y": 2, "width": 2, "height": 2,
            "contact_count": 1, "scan_time": 1,
        },
        "report_bytes": 24,
        "physical_mm": [600.0, 340.0],
    });
    assert_eq!(object, expected);
}

#[test]
fn a_touchpad_is_no_touchscreen_and_that_is_no_error() {
    let mut items = Items::default();
    items.open(TOUCH_PAD, 1);
    Shape::default().report(&mut items);
    items.close();
    let (object, _) = explain(&hex(&items.0), &["--json"]);
    assert!(object.status.success());
    let object: Value = serde_json::from_str(&out(&object)).expect("JSON");
    assert_eq!(object["touchscreen"], false);
    assert!(object["reason"].as_str().expect("a reason").contains("touchpad"));
    let (page, _) = explain(&hex(&items.0), &[]);
    assert!(out(&page).starts_with("touchscreen   no: a touchpad"));
}

#[test]
fn bad_input_is_one_line_and_names_file_and_place() {
    for (text, words) in [
        (
            "05 0d\nhello",
            "line 2: expected hexadecimal bytes, found \"hello\"",
        ),
        ("", "found none"),
        ("05", "byte 0: expected an item of 1 bytes, found the end"),
        (&"00 ".repeat(9000), "at most 8192 bytes"),
        (&" ".repeat(300_000), "at most 262144"),
    ] {
        let (output, path) = explain(text, &[]);
        assert_eq!(output.status.code(), Some(2), "{words}");
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(error.lines().count(), 1, "{error}");
        assert!(
            error.contains(words) && error.contains(path.to_str().unwrap()),
            "{error}"
        );
    }
    assert_eq!(
        devices(&["--descriptor", "/nowhere/table.hex"]).status.code(),
        Some(2)
    );
    assert_eq!(devices(&["--udev", "--json"]).status.code(), Some(2));
}

/// What is plugged in differs; that it is told does not.
#[test]
fn what_is_plugged_in_is_told() {
    let list = devices(&["--json"]);
    assert!(list.status.success());
    let list: Value = serde_json::from_str(&out(&list)).expect("JSON");
    assert!(list.is_array());
    assert!(!out(&devices(&[])).trim().is_empty());
    let rule = out(&devices(&["--udev"]));
    assert!(
        rule.contains("KERNEL==\"hidraw*\"") && rule.contains("TAG+=\"uaccess\""),
        "{rule}"
    );
    assert!(
        rule.contains("/etc/udev/rules.d/70-") && rule.contains("GROUP="),
        "{rule}"
    );
}
