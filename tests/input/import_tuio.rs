//! Captures of TUIO become gesture files.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use crate::tuio_common::*;
use glam::DVec2;
use orogen::gesture::contact::InputFrame;
use orogen::gesture::contact::Phase::{self, Cancel, Down, Move, Up};
use orogen::gesture::file::{GestureFile, Header, read_gesture};
use orogen::input::import::{ImportOptions, Imported, import_recording, import_tuio};
use proptest::prelude::*;

const SIZE: DVec2 = DVec2::new(1000.0, 500.0);

fn options() -> ImportOptions {
    ImportOptions {
        size_mm: Some(SIZE),
        ..ImportOptions::default()
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").expect("a text takes all");
        text
    })
}

fn line(t_ms: f64, bytes: &[u8]) -> String {
    format!("{{\"t\":{t_ms},\"hex\":\"{}\"}}\n", hex(bytes))
}

fn import(text: &str) -> Result<Imported, String> {
    import_tuio(text.as_bytes(), "capture", &options()).map_err(|error| error.to_string())
}

/// What happens, in brief.
fn events(frames: &[InputFrame]) -> Vec<(u64, Phase, u64, u32, DVec2)> {
    let of = |frame: &InputFrame| {
        let t_us = frame.t_us;
        let brief = move |e: &orogen::gesture::contact::ContactEvent| {
            (
                t_us,
                e.phase,
                e.contact.key.id,
                e.contact.key.generation,
                e.contact.position,
            )
        };
        frame.events.iter().map(brief).collect::<Vec<_>>()
    };
    frames.iter().flat_map(of).collect()
}

/// Writes the recording as a gesture file and reads it back.
fn round_trip(imported: &Imported) {
    let file = GestureFile {
        header: Header::new(imported.size_mm),
        frames: imported.frames.clone(),
        warnings: Vec::new(),
    };
    let bytes = file.write(Vec::new()).expect("memory takes all");
    assert_eq!(
        read_gesture(&bytes[..], "written").expect("what was written"),
        file
    );
}

#[test]
fn packets_with_times_become_contacts_with_the_lowest_free_ids() {
    let text = [
        line(1000.0, &cursors("a@b", 1, &[])),
        line(1016.5, &cursors("a@b", 2, &[(70, 0.1, 0.1), (71, 0.2, 0.2)])),
        line(1033.0, &cursors("a@b", 3, &[(71, 0.3, 0.2)])),
        line(1050.0, &cursors("a@b", 4, &[(71, 0.3, 0.2), (72, 0.4, 0.4)])),
        line(1066.0, &cursors("a@b", 5, &[])),
    ]
    .concat();
    let imported = import_recording(text.as_bytes(), "capture", &options()).unwrap();
    let at = |x, y| DVec2::new(x, y);
    let expected = [
        (0, Down, 0, 0, at(100.0, 50.0)),
        (0, Down, 1, 0, at(200.0, 100.0)),
        (16_500, Up, 0, 0, at(100.0, 50.0)),
        (16_500, Move, 1, 0, at(300.0, 100.0)),
        (33_500, Down, 0, 1, at(400.0, 200.0)),
        (49_500, Up, 0, 1, at(400.0, 200.0)),
        (49_500, Up, 1, 0, at(300.0, 100.0)),
    ];
    assert_eq!(events(&imported.frames), expected);
    assert_eq!((imported.title.as_str(), imported.size_mm), ("capture", SIZE));
    assert_eq!(imported.warnings, Vec::<String>::new());
    round_trip(&imported);
}

#[test]
fn a_list_without_times_is_sixty_packets_a_second() {
    let packets = [
        cursors("", -1, &[(1, 0.1, 0.1)]),
        cursors("", -1, &[(1, 0.2, 0.1)]),
        cursors("", -1, &[(1, 0.2, 0.1)]),
    ];
    let objects: Vec<String> = packets
        .iter()
        .map(|p| format!("{{\"hex\":\"{}\",\"decoded\":[]}}", hex(p)))
        .collect();
    let text = format!("\n [{}]\n", objects.join(",\n"));
    let imported = import_recording(text.as_bytes(), "capture", &options()).unwrap();
    let times: Vec<_> = events(&imported.frames).iter().map(|e| (e.0, e.1)).collect();
    assert_eq!(times, [(0, Down), (16_667, Move), (33_334, Cancel)]);
    let warnings = [
        "no packet has a time: taken as sixty a second",
        "1 contact(s) still down at the end, cancelled",
    ];
    assert_eq!(imported.warnings, warnings);
    round_trip(&imported);
}

#[test]
fn senders_have_contacts_of_their_own() {
    let from = |port: u16, t: u32, bytes: &[u8]| {
        format!(
            "{{\"t\":{t},\"from\":\"127.0.0.1:{port}\",\"hex\":\"{}\"}}\n",
            hex(bytes)
        )
    };
    let text = [
        from(1, 0, &cursors("", 1, &[(5, 0.1, 0.1)])),
        from(2, 1, &cursors("", 1, &[(5, 0.9, 0.1)])),
        from(1, 2, &cursors("", 2, &[])),
        from(2, 3, &cursors("", 2, &[])),
    ]
    .concat();
    let imported = import(&text).unwrap();
    let brief: Vec<_> = events(&imported.frames).iter().map(|e| (e.1, e.2)).collect();
    assert_eq!(brief, [(Down, 0), (Down, 1), (Up, 0), (Up, 1)]);
    round_trip(&imported);
}

#[test]
fn silence_and_new_starts_are_as_on_the_live_table() {
    let mut text = String::new();
    for i in 0..30 {
        text += &line(f64::from(i) * 16.0, &cursors("a@b", i + 1, &[(1, 0.1, 0.1)]));
    }
    text += &line(20_000.0, &cursors("a@b", 200, &[(1, 0.1, 0.1)]));
    text += &line(20_016.0, &cursors("a@b", 1, &[(1, 0.5, 0.5)]));
    text += &line(20_032.0, &cursors("a@b", 2, &[]));
    let imported = import(&text).unwrap();
    let brief: Vec<_> = events(&imported.frames).iter().map(|e| (e.0, e.1)).collect();
    let expected = [
        (0, Down),
        (29 * 16_000 + 1_050_000, Cancel),
        (20_000_000, Down),
        (20_016_000, Cancel),
        (20_016_000, Down),
        (20_032_000, Up),
    ];
    assert_eq!(brief, expected);
    assert_eq!(imported.warnings.len(), 2, "{:?}", imported.warnings);
    round_trip(&imported);
}

#[test]
fn what_is_no_capture_is_refused_by_line() {
    let good = line(0.0, &cursors("", 1, &[(1, 0.5, 0.5)]));
    let later = line(5.0, &cursors("", 2, &[(1, 0.6, 0.5)]));
    let cases = [
        (
            String::new(),
            "capture:1: expected a packet of TUIO with a contact, found something else",
        ),
        (
            "{}\n".to_owned(),
            "capture:1: hex: expected at most 65536 bytes in hexadecimal, found nothing",
        ),
        (
            format!("{good}{{\"t\":1}}\n"),
            "capture:2: hex: expected at most 65536 bytes in hexadecimal, found nothing",
        ),
        (
            format!("{good}{{\"t\":1,\"hex\":\"2\"}}\n"),
            "capture:2: hex: expected at most 65536 bytes in hexadecimal, found \"2\"",
        ),
        (
            format!("{good}{{\"t\":1,\"hex\":\"2ü\"}}\n"),
            "capture:2: hex: expected at most 65536 bytes in hexadecimal, found \"2ü\"",
        ),
        (
            format!("{good}{{\"hex\":\"22\"}}\n"),
            "capture:2: t: expected milliseconds, in each packet or in none, found nothing",
        ),
        (
            format!("{good}{{\"t\":-1,\"hex\":\"22\"}}\n"),
            "capture:2: t: expected milliseconds, in each packet or in none, found -1",
        ),
        (
            format!("{good}{{\"t\":1,\"from\":\"here\",\"hex\":\"22\"}}\n"),
            "capture:2: from: expected an address with a port, found \"here\"",
        ),
        (
            format!("{good}nonsense\n"),
            "capture:2: expected {\"t\":ms,\"hex\":\"…\"} of a TUIO capture, found something else",
        ),
        (
            format!("{later}{good}"),
            "capture:2: time: expected at least 0.005000 s as in the event before, found 0.000000",
        ),
        (
            "[{\n\"hex\":5}\n".to_owned(),
            "capture:3: expected {\"t\":ms,\"hex\":\"…\"} of a TUIO capture, found something else",
        ),
        (
            line(0.0, b"noise"),
            "capture:1: expected a packet of TUIO with a contact, found something else",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(import(&text).unwrap_err(), expected, "{text}");
    }
    let error = import_tuio(good.as_bytes(), "capture", &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("--size-mm"), "{error}");
}

#[test]
fn a_torn_last_line_is_left_out() {
    let good = line(0.0, &cursors("", 1, &[(1, 0.5, 0.5)]));
    let imported = import(&format!("{good}{}", &good[..40])).unwrap();
    assert!(
        imported.warnings.contains(&"line 2: torn, left out".to_owned()),
        "{:?}",
        imported.warnings
    );
}

proptest! {
    #[test]
    fn any_text_is_refused_in_one_line_or_imported(text in "[\\[{\"thex:0-9a-f,}\\]\n ]{0,80}") {
        match import(&text) {
            Ok(imported) => round_trip(&imported),
            Err(error) => prop_assert!(error.contains("expected") && !error.contains('\n'), "{}", error),
        }
    }
}

/// Packets of a sender that others wrote, where they lie beside the checkout.
#[test]
fn packets_of_python_tuio_are_imported() {
    let shared = std::env::var_os("OROGEN_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
        std::path::PathBuf::from,
    );
    let path = shared.join("touch/tuio/python-tuio-0.0.9-packets.json");
    if !path.exists() {
        let required = std::env::var_os("OROGEN_REQUIRE_SHARED").is_some_and(|v| v == "1");
        assert!(
            !required,
            "OROGEN_REQUIRE_SHARED=1, but {} is missing",
            path.display()
        );
        // Past the test harness, which keeps what passing tests print to itself.
        let _ = writeln!(std::io::stderr(), "SKIPPED: {} is missing", path.display());
        return;
    }
    let imported = import_recording(std::fs::File::open(path).unwrap(), "packets", &options()).unwrap();
    let brief: Vec<_> = events(&imported.frames)
        .iter()
        .map(|e| (e.0, e.1, e.2, e.4))
        .collect();
    let expected = [
        (0, Down, 0, DVec2::new(500.0, 250.0)),
        (16_667, Move, 0, DVec2::new(510.0, 250.0)),
        (16_667, Down, 1, DVec2::new(250.0, 375.0)),
        (33_334, Up, 0, DVec2::new(510.0, 250.0)),
        (33_334, Up, 1, DVec2::new(250.0, 375.0)),
    ];
    assert_eq!(brief, expected);
    round_trip(&imported);
}
