//! Recordings of `libinput record`: the same events as evemu's, in YAML, of one device or several.

use glam::DVec2;
use orogen::input::import::{ImportOptions, Imported, import_evemu, import_recording};
use proptest::prelude::*;

use crate::import_support::{HEAD, LIBINPUT_HEAD, as_libinput, at, shown};

const TOUCH: &str = "1";

fn import(text: &str) -> Result<Imported, String> {
    import_recording(text.as_bytes(), "rec", &ImportOptions::default()).map_err(|error| error.to_string())
}

fn two_fingers() -> String {
    HEAD.to_owned()
        + &at(0, "id 7,x 1000,y 500,slot 1,id 8,x 2000,y 700,sync")
        + &at(16, "x 2105,slot 0,y 501,sync")
        + &at(32, "id -1,slot 1,id -1,sync")
}

#[test]
fn a_touchscreen_is_imported_as_evemu_would() {
    let evemu = two_fingers();
    let expected = import_evemu(evemu.as_bytes(), "rec", &ImportOptions::default()).unwrap();
    let text = LIBINPUT_HEAD.to_owned() + &as_libinput(&evemu, "/dev/input/event4", TOUCH);
    assert_eq!(import(&text).as_ref(), Ok(&expected));
    // Other kinds of events may stand between.
    let more = text.replacen(
        "  - evdev:\n",
        "  - libinput:\n    - {time: 0.1, type: TOUCH_DOWN, slot: 0, point: [ 1.00, 2.00]}\n  - hid:\n    time: [0, 5]\n    \
         hidraw0: [0x01, 0x02]\n  - evdev:\n",
        1,
    );
    assert_ne!(more, text);
    assert_eq!(import(&more).as_ref(), Ok(&expected));
    assert_eq!(shown(&expected.frames).len(), 3);
}

#[test]
fn of_several_devices_the_touchscreen_counts() {
    let keyboard = HEAD.replace("A: 3", "A: 1").replace("Table", "Keys") + &at(0, "button 1,sync");
    let touchpad = two_fingers().replace("Table", "Pad");
    let untouched = HEAD.replace("Table", "Side table");
    let text = LIBINPUT_HEAD.to_owned()
        + &as_libinput(&keyboard, "/dev/input/event1", "")
        + &as_libinput(&touchpad, "/dev/input/event2", "0, 2")
        + &as_libinput(&untouched, "/dev/input/event3", TOUCH)
        + &as_libinput(&two_fingers(), "/dev/input/event4", TOUCH);
    let imported = import(&text).unwrap();
    assert_eq!(imported.title, "Table");
    assert_eq!(imported.frames.len(), 3);
    assert_eq!(
        imported.warnings,
        [
            "taken: touchscreen \"Table\" (/dev/input/event4); left out: device \"Keys\" (/dev/input/event1), touchpad \
             \"Pad\" (/dev/input/event2), touchscreen \"Side table\" (/dev/input/event3)"
        ]
    );
    let text = LIBINPUT_HEAD.to_owned()
        + &as_libinput(&keyboard, "/dev/input/event1", "")
        + &as_libinput(&touchpad, "/dev/input/event2", "0, 2");
    let error = import(&text).unwrap_err();
    assert!(
        error.contains("expected a touchscreen among the devices, found device \"Keys\""),
        "{error}"
    );
    // What udev says counts more than what the kernel's driver forgot to say.
    let told = LIBINPUT_HEAD.to_owned()
        + &as_libinput(&two_fingers(), "/dev/input/event4", TOUCH)
            .replace("ID_INPUT=1", "ID_INPUT=1\n    - ID_INPUT_TOUCHPAD=1");
    assert!(import(&told).unwrap_err().contains("found touchpad \"Table\""));
}

#[test]
fn a_recorder_that_was_killed_leaves_half_a_line() {
    let whole = LIBINPUT_HEAD.to_owned() + &as_libinput(&two_fingers(), "/dev/input/event4", TOUCH);
    let cut = whole.len() - 20;
    let imported = import(&whole[..cut]).unwrap();
    assert_eq!(
        shown(&imported.frames)[2..],
        ["32: cancel 0.0, cancel 1.0".to_owned()]
    );
    let torn = format!("line {}: torn, left out", whole[..cut].lines().count());
    assert_eq!(
        imported.warnings,
        [
            &torn[..],
            "the last frame has no SYN_REPORT, left out",
            "2 contact(s) still down at the end, cancelled",
        ]
    );
}

#[test]
fn what_is_no_such_recording_is_refused_by_line() {
    let device = as_libinput(&two_fingers(), "/dev/input/event4", TOUCH);
    let whole = LIBINPUT_HEAD.to_owned() + &device;
    let bad = |from: &str, to: &str| {
        let text = whole.replacen(from, to, 1);
        assert_ne!(text, whole, "{from}");
        let error = import(&text).expect_err(to);
        assert!(
            error.starts_with("rec:") && error.contains("expected") && !error.contains('\n'),
            "{error}"
        );
        error
    };
    for (from, to, holds) in [
        ("version: 1", "version: 2", "rec:2: expected version: 1"),
        ("version: 1", "version: one", "found \"one\""),
        (
            "devices:\n-",
            "devices: 5\nmore:\n-",
            "expected a list of devices",
        ),
        (
            "53: [0, 4000, 4, 0, 10]",
            "53: [0, 4000, 4, 0]",
            "[min, max, fuzz, flat, resolution]",
        ),
        (
            "53: [0, 4000, 4, 0, 10]",
            "53: [0, 4000, 4, 0, 10, 1]",
            "[min, max, fuzz, flat, resolution]",
        ),
        ("53: [0, 4000, 4, 0, 10]", "x: [0, 4000, 4, 0, 10]", "code: [min"),
        (
            "53: [0, 4000, 4, 0, 10]",
            "53: [0, 9999999999, 4, 0, 10]",
            "32 bits",
        ),
        ("name: \"Table\"", "name: \"Ta\"ble\"", "expected YAML"),
        ("name: \"Table\"", "name: [a, b]", "name: a text"),
        (
            "- [1369413358,      0",
            "- [-1,      0",
            "[sec, usec, type, code, value]",
        ),
        (
            "- [1369413358,      0",
            "- [1369413358, 1000000",
            "[sec, usec, type, code, value]",
        ),
        (
            "- [1369413358,      0",
            "- [2369413358,      0",
            "time: expected at least",
        ),
        (
            "name: \"Table\"",
            "name: &a \"Table\"\n    again: *a",
            "no aliases",
        ),
        (
            "  hid: [\n",
            &("  deep: ".to_owned() + &"[".repeat(40) + &"]".repeat(40) + "\n  hid: [\n"),
            "at most 32 levels",
        ),
        (
            "  hid: [\n",
            &("  hid: ".to_owned() + &" ".repeat(200_000) + "[\n"),
            "163840 bytes",
        ),
    ] {
        let error = bad(from, to);
        assert!(error.contains(holds), "{error}");
    }
    let no_range = whole.replace(
        "      53: [0, 4000, 4, 0, 10]\n      54: [0, 3000, 4, 0, 10]\n",
        "      0: [0, 1, 0, 0, 0]\n",
    );
    assert_ne!(no_range, whole);
    // Without those axes it is no touchscreen, unless udev says that it is one.
    assert!(
        import(&no_range)
            .unwrap_err()
            .contains("expected a touchscreen among the devices")
    );
    let told = no_range.replace("ID_INPUT=1", "ID_INPUT=1\n    - ID_INPUT_TOUCHSCREEN=1");
    assert!(import(&told).unwrap_err().contains("give --range X0,X1,Y0,Y1"));
    assert!(
        import("version: 1\ndevices:\n")
            .unwrap_err()
            .contains("found nothing")
    );
    assert!(import("version: 1\n").unwrap_err().contains("found nothing"));
}

#[test]
fn what_nobody_wrote_is_refused_with_all_that_is_understood() {
    for (text, found) in [
        ("", "found nothing"),
        ("\n  \n", "found nothing"),
        ("hello\nworld", "found \"hello\""),
        ("{\"format\":\"orogen-gesture\",\"version\":1}", "found \"{"),
    ] {
        let error = import(text).unwrap_err();
        assert!(
            error.starts_with("rec:1: expected a recording of evemu-record"),
            "{error}"
        );
        assert!(
            error.contains("libinput record") && error.contains(found),
            "{error}"
        );
    }
}

/// Lines that are nearly right.
fn nearly() -> impl Strategy<Value = String> {
    let indent = (0..4_usize).prop_map(|n| "  ".repeat(n));
    let number = prop_oneof![
        (0..60_i64).prop_map(|n| n.to_string()),
        any::<i64>().prop_map(|n| n.to_string())
    ];
    let words = prop::sample::select(vec![
        "version: 1",
        "devices:",
        "- node: a",
        "evdev:",
        "- evdev:",
        "absinfo:",
        "events:",
        "- ",
        "[",
        "]",
        "{",
        "}",
        "name: \"a",
        "properties: [1]",
        "udev:",
        "&a",
        "*a",
        "|",
        ">",
        "---",
        "...",
        "%YAML 1.2",
        "? ",
        ": ",
        "!!int",
    ]);
    let line = prop_oneof![
        4 => (indent.clone(), words).prop_map(|(indent, words)| indent + words + "\n"),
        4 => (indent.clone(), prop::collection::vec(number, 0..6)).prop_map(|(indent, n)| format!("{indent}- [{}]\n", n.join(", "))),
        1 => any::<String>(),
    ];
    prop::collection::vec(line, 0..30).prop_map(|lines| lines.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn any_text_is_refused_or_imported(lines in nearly(), cut in any::<prop::sample::Index>(), whole in any::<bool>()) {
        let mut text = LIBINPUT_HEAD.to_owned() + &as_libinput(&two_fingers(), "/dev/input/event4", TOUCH);
        if whole {
            let mut at = cut.index(text.len());
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            text.insert_str(at, &lines);
        } else {
            text = "version: 1\n".to_owned() + &lines;
        }
        let options = ImportOptions { range: None, size_mm: Some(DVec2::new(400.0, 300.0)) };
        if let Err(error) = import_recording(text.as_bytes(), "any", &options) {
            let error = error.to_string();
            prop_assert!(error.starts_with("any:") && error.contains("expected"), "{error}");
            prop_assert!(!error.contains('\n'), "{error}");
        }
    }
}
