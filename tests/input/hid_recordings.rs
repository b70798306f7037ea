//! Recordings of `hid-recorder`: bytes of devices that are made here, and what becomes of them.

use std::fmt::Write as _;

use glam::DVec2;
use orogen::input::import::{ImportOptions, Imported, import_recording};

use crate::import_support::shown;

/// A touchscreen of 400 × 300 mm with two slots of tip, id, x and y, and a contact count: report 1, 14 bytes.
fn touchscreen() -> Vec<u8> {
    let finger = [
        0x09, 0x22, 0xa1, 0x02, // Usage (Finger), Collection (Logical)
        0x09, 0x42, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x01, 0x81, 0x02, // tip: 1 bit
        0x95, 0x07, 0x81, 0x03, // padding
        0x75, 0x08, 0x95, 0x01, 0x09, 0x51, 0x25, 0x7f, 0x81, 0x02, // contact id: a byte
        0x05, 0x01, 0x75, 0x10, 0x55, 0x0f, 0x65, 0x11, 0x35, 0x00, // 0.1 cm: millimetres
        0x26, 0xa0, 0x0f, 0x46, 0x90, 0x01, 0x09, 0x30, 0x81, 0x02, // x: 0 to 4000, 400 mm
        0x26, 0xb8, 0x0b, 0x46, 0x2c, 0x01, 0x09, 0x31, 0x81, 0x02, // y: 0 to 3000, 300 mm
        0x05, 0x0d, 0x45, 0x00, 0x65, 0x00, 0x55, 0x00, 0xc0,
    ];
    let mut bytes = vec![0x05, 0x0d, 0x09, 0x04, 0xa1, 0x01, 0x85, 0x01];
    bytes.extend(finger);
    bytes.extend(finger);
    bytes.extend([0x09, 0x54, 0x25, 0x02, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02]); // contact count
    bytes.extend([0x85, 0x02, 0x09, 0x55, 0x25, 0x02, 0xb1, 0x02, 0xc0]); // contact count maximum
    bytes
}

fn sized(bytes: &[u8]) -> String {
    let mut text = bytes.len().to_string();
    for byte in bytes {
        write!(text, " {byte:02x}").expect("memory takes all");
    }
    text
}

fn described(descriptor: &[u8], name: &str) -> String {
    format!("R: {}\nN: {name}\nP: usb-1\nI: 3 056a 005d\n", sized(descriptor))
}

/// A report with these contacts: down, id, x and y in tenths of a millimetre.
fn report(ms: u64, contacts: &[(bool, u8, u16, u16)]) -> String {
    let mut bytes = vec![1];
    for i in 0..2 {
        let (down, id, x, y) = contacts.get(i).copied().unwrap_or_default();
        bytes.extend([down.into(), id]);
        bytes.extend(x.to_le_bytes());
        bytes.extend(y.to_le_bytes());
    }
    bytes.push(contacts.len() as u8);
    format!("E: {:06}.{:03}000 {}\n", ms / 1000, ms % 1000, sized(&bytes))
}

fn two_fingers() -> String {
    report(1000, &[(true, 7, 1000, 500)])
        + &report(1010, &[(true, 7, 1010, 500), (true, 9, 2000, 700)])
        + &report(1020, &[(false, 7, 1010, 500), (true, 9, 2050, 700)])
        + &report(1030, &[(true, 7, 3000, 500), (true, 9, 2050, 700)])
        + &report(1040, &[(false, 7, 3000, 500), (false, 9, 2050, 700)])
}

const EXPECTED: [&str; 5] = [
    "0: down 7.0 (100,50)",
    "10: move 7.0 (101,50), down 9.0 (200,70)",
    "20: up 7.0, move 9.0 (205,70)",
    "30: down 7.1 (300,50)",
    "40: up 7.1, up 9.0",
];

fn import(text: &str) -> Result<Imported, String> {
    import_recording(text.as_bytes(), "rec", &ImportOptions::default()).map_err(|error| error.to_string())
}

#[test]
fn reports_become_contacts() {
    let imported = import(&(described(&touchscreen(), "Table") + &two_fingers())).unwrap();
    assert_eq!(imported.title, "Table");
    assert_eq!(imported.size_mm, DVec2::new(400.0, 300.0));
    assert_eq!(shown(&imported.frames), EXPECTED);
    assert_eq!(imported.warnings, Vec::<String>::new());
}

#[test]
fn the_size_can_be_given() {
    let text = described(&touchscreen(), "") + &two_fingers();
    let options = ImportOptions {
        range: None,
        size_mm: Some(DVec2::new(800.0, 600.0)),
    };
    let imported = import_recording(text.as_bytes(), "rec", &options).unwrap();
    assert_eq!(
        (&imported.title[..], imported.size_mm),
        ("rec", DVec2::new(800.0, 600.0))
    );
    assert_eq!(shown(&imported.frames)[0], "0: down 7.0 (200,100)");
    // A descriptor that tells no size that can be believed: 4 × 3 mm.
    let mut tiny = touchscreen();
    for at in 0..tiny.len() - 1 {
        if tiny[at..at + 2] == [0x55, 0x0f] {
            tiny[at + 1] = 0x0d;
        }
    }
    let text = described(&tiny, "Table") + &two_fingers();
    let error = import(&text).unwrap_err();
    assert!(error.contains("give --size-mm W,H"), "{error}");
    let imported = import_recording(text.as_bytes(), "rec", &options).unwrap();
    assert_eq!(imported.frames.len(), 5);
}

#[test]
fn of_several_devices_the_touchscreen_counts() {
    let touchpad: Vec<u8> = [0x05, 0x0d, 0x09, 0x05]
        .into_iter()
        .chain(touchscreen()[4..].iter().copied())
        .collect();
    let events = two_fingers().replace("E: ", "D: 1\nE: ");
    let text = format!(
        "# hid-recorder\nD: 0\n{}D: 1\n{}D: 0\nE: 000000.000000 2 01 02\n{events}",
        described(&touchpad, "Pad"),
        described(&touchscreen(), "Table")
    );
    let imported = import(&text).unwrap();
    assert_eq!(shown(&imported.frames), EXPECTED);
    assert_eq!(
        imported.warnings,
        ["taken: touchscreen \"Table\"; left out: touchpad \"Pad\""]
    );
    let error = import(&(described(&touchpad, "Pad") + &two_fingers())).unwrap_err();
    assert!(
        error.contains("expected a touchscreen among the devices, found touchpad \"Pad\""),
        "{error}"
    );
}

#[test]
fn what_is_half_or_missing_is_said() {
    let text = described(&touchscreen(), "Table")
        + &report(0, &[(true, 7, 1000, 500)])
        + "E: 000000.010000 3 01 02 03\n"
        + &report(20, &[(true, 7, 1100, 500)])
        + "E: 000000.030000 14 01 01";
    let imported = import(&text).unwrap();
    assert_eq!(
        shown(&imported.frames),
        ["0: down 7.0 (100,50)", "20: move 7.0 (110,50)", "20: cancel 7.0"]
    );
    assert_eq!(
        imported.warnings,
        [
            "line 8: torn, left out",
            "1 report(s) left out: too short",
            "1 contact(s) still down at the end, cancelled",
        ]
    );
}

#[test]
fn what_is_no_such_recording_is_refused_by_line() {
    let head = described(&touchscreen(), "Table");
    for (text, start, holds) in [
        (
            head.clone() + "E: 0.000000 2 01\n",
            "rec:5: E: ",
            "a length and that many bytes",
        ),
        (head.clone() + "E: 0.000000 1 1g\n", "rec:5: E: ", "hexadecimal"),
        (head.clone() + "E: 0.5 1 01\n", "rec:5: E: time", "six decimals"),
        (
            head.clone() + "E: 1.000000 1 01\nE: 0.000000 1 01\n",
            "rec:6: time:",
            "at least",
        ),
        (head.clone() + &head, "rec:5: R: ", "one descriptor"),
        (head.clone() + "nonsense\n", "rec:5: line: ", "hid-recorder"),
        (head.clone() + "D: one\n", "rec:5: D: ", "number of a device"),
        (
            "D: 0\nE: 0.000000 1 01\n".to_owned(),
            "rec:2: R: ",
            "before its reports",
        ),
        ("D: 0\nR: 2 05\n".to_owned(), "rec:2: R: ", "a length"),
        ("D: 0\nR: 0\n".to_owned(), "rec:2: R: ", "found none"),
        (head.replace("056a", "xyz"), "rec:4: I: ", "bus vendor product"),
        ("D: 0\n".to_owned(), "rec:1: ", "found nothing"),
    ] {
        let error = import(&text).unwrap_err();
        assert!(
            error.starts_with(start) && error.contains(holds),
            "{text}\n{error}"
        );
        assert!(error.contains("expected") && !error.contains('\n'), "{error}");
    }
}
