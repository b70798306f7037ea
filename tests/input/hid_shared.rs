//! Report descriptors of real devices, where they lie beside the checkout; the project ships none of them.
//!
//! They are looked for in the folder that `OROGEN_SHARED` names, else in `../shared`. Where they are missing each
//! test says so and passes, unless `OROGEN_REQUIRE_SHARED=1`.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use orogen::input::hid::{Decoder, Descriptor, Quirk, Quirks, Refusal};
use serde_json::Value;

/// The devices of this file, or none after saying that it is skipped.
fn devices(name: &str) -> Vec<Value> {
    let shared = std::env::var_os("OROGEN_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
        PathBuf::from,
    );
    let path = shared.join("touch/hid").join(name);
    let Ok(text) = fs::read_to_string(&path) else {
        let required = std::env::var_os("OROGEN_REQUIRE_SHARED").is_some_and(|v| v == "1");
        assert!(
            !required,
            "OROGEN_REQUIRE_SHARED=1, but {} is missing",
            path.display()
        );
        // Past the test harness, which keeps what passing tests print to itself.
        let _ = writeln!(std::io::stderr(), "SKIPPED: {} is missing", path.display());
        return Vec::new();
    };
    let file: Value = serde_json::from_str(&text).expect("JSON");
    file["devices"].as_array().expect("devices").clone()
}

fn descriptor(device: &Value) -> Descriptor {
    let hex = device["hex"].as_str().expect("hex").as_bytes();
    let digit = |c: u8| (c as char).to_digit(16).expect("a digit") as u8;
    let bytes: Vec<u8> = hex
        .chunks(2)
        .map(|pair| digit(pair[0]) << 4 | digit(pair[1]))
        .collect();
    Descriptor::parse(&bytes).unwrap_or_else(|error| panic!("{}: {error}", device["name"]))
}

fn number(value: &Value) -> u16 {
    u16::from_str_radix(value.as_str().unwrap_or("0"), 16).unwrap_or(0)
}

#[test]
fn touchscreens_are_found_with_their_slots() {
    for device in devices("touchscreens.json") {
        let name = &device["name"];
        let found = descriptor(&device);
        let report = found.touch.as_ref().unwrap_or_else(|no| panic!("{name}: {no:?}"));
        let told = device["facts"]["touch_reports"].as_array().expect("reports");
        let of_screen = told.iter().filter(|r| r["app"] == "04");
        let ids = |r: &Value| r["usages"]["contact_id"].as_u64().unwrap_or(0);
        let best = of_screen.clone().map(ids).max().expect("a touch report");
        let expected = of_screen.clone().find(|r| ids(r) == best).expect("the best one");
        assert_eq!(
            report.slots.len() as u64,
            expected["slots"].as_u64().unwrap(),
            "{name}"
        );
        assert_eq!(
            u64::from(report.id.unwrap_or(0)),
            expected["report_id"].as_u64().unwrap(),
            "{name}"
        );
        assert_eq!(
            report.bytes as u64,
            expected["report_bytes"].as_u64().unwrap(),
            "{name}"
        );
        let usages = &expected["usages"];
        assert_eq!(report.count.is_some(), usages["contact_count"].is_u64(), "{name}");
        assert_eq!(report.scan_time.is_some(), usages["scan_time"].is_u64(), "{name}");
        for slot in &report.slots {
            assert_eq!(slot.id.is_some(), best > 0, "{name}");
            assert_eq!(slot.tip.is_some(), usages["tip"].is_u64(), "{name}");
            assert_eq!(slot.confidence.is_some(), usages["confidence"].is_u64(), "{name}");
        }
        match (
            report.physical_mm(),
            expected["x_mm"].as_f64(),
            expected["y_mm"].as_f64(),
        ) {
            (Some(size), Some(x), Some(y)) => {
                assert!(
                    (size.x - x).abs() < 0.06 && (size.y - y).abs() < 0.06,
                    "{name}: {size}"
                );
            }
            (Some(size), ..) => panic!("{name}: {size} from nowhere"),
            (None, Some(x), Some(y)) => assert!(x < 30.0 || y < 30.0, "{name}: {x} × {y} mm is lost"),
            (None, ..) => {}
        }
        let told_max = &device["facts"]["max_contact_feature"];
        let field = found.features.contact_count_max;
        assert_eq!(
            field.map(|f| f.declared_max),
            told_max["logical_max"].as_i64(),
            "{name}"
        );
        assert_eq!(
            field.map(|f| f.report.id.into()),
            told_max["report_id"].as_u64(),
            "{name}"
        );
        let mode = found.features.input_mode.map(|f| f.report.id.into());
        assert_eq!(
            mode,
            device["facts"]["input_mode_feature"]["report_id"].as_u64(),
            "{name}"
        );
    }
}

#[test]
fn the_quirks_of_known_devices_are_known() {
    for device in devices("touchscreens.json") {
        let Some(told) = device["kernel_quirks"].as_array() else {
            continue;
        };
        let quirks = Quirks::choose(
            number(&device["vid"]),
            number(&device["pid"]),
            &descriptor(&device),
            10,
        );
        let names: Vec<&str> = quirks.iter().map(Quirk::name).collect();
        assert_eq!(names.len(), told.len(), "{}: {names:?}", device["name"]);
        assert!(
            told.iter().all(|t| names.contains(&t.as_str().unwrap())),
            "{names:?}"
        );
    }
}

#[test]
fn touchpads_are_refused() {
    for device in devices("touchpads.json") {
        assert_eq!(
            descriptor(&device).touch.unwrap_err(),
            Refusal::Touchpad,
            "{}",
            device["name"]
        );
    }
}

/// Any bytes at all are no reason to panic, and no more contacts than there can be come of them.
#[test]
fn garbage_in_the_form_of_reports_does_no_harm() {
    for device in devices("touchscreens.json") {
        let found = descriptor(&device);
        let report = found.touch.clone().expect("a touchscreen");
        let quirks = Quirks::choose(number(&device["vid"]), number(&device["pid"]), &found, 40);
        let mut decoder = Decoder::new(&found, quirks, 40, None).expect("a touchscreen");
        let mut noise = 7_u64;
        let mut last_us = 0;
        for i in 0..2000_u64 {
            let mut bytes: Vec<u8> = (0..report.bytes)
                .map(|_| {
                    noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (noise >> 56) as u8
                })
                .collect();
            if let (Some(id), Some(first)) = (report.id, bytes.first_mut()) {
                *first = id;
            }
            if let Some(frame) = decoder.decode(&bytes, i * 4000) {
                assert!(frame.touching.len() <= 256);
                assert!((last_us..=i * 4000).contains(&frame.t_us));
                last_us = frame.t_us;
            }
        }
        assert_eq!(decoder.counts().reports, 2000, "{}", device["name"]);
    }
}
