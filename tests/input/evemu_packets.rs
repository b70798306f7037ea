//! The older protocol: each frame tells all contacts, and nobody says which is which.

use std::fmt::Write as _;

use glam::DVec2;
use orogen::gesture::contact::Phase;
use orogen::input::import::{ImportOptions, import_evemu};
use proptest::prelude::*;

use crate::import_support::{HEAD, at, shown};

fn played(events: &[String]) -> (Vec<String>, Vec<String>) {
    let text = HEAD.to_owned() + &events.concat();
    let imported = import_evemu(text.as_bytes(), "rec", &ImportOptions::default()).expect("a recording");
    (shown(&imported.frames), imported.warnings)
}

#[test]
fn fingers_are_followed_whatever_their_order() {
    let (frames, warnings) = played(&[
        at(0, "x 1000,y 500,mt_report,x 2000,y 700,mt_report,button 1,sync"),
        at(10, "x 2050,y 700,mt_report,x 1000,y 500,mt_report,sync"),
        // Nothing is told of contacts.
        at(15, "single 5,sync"),
        at(20, "x 2100,y 700,mt_report,sync"),
        at(30, "x 3000,y 100,mt_report,x 2150,y 700,mt_report,sync"),
        at(40, "mt_report,sync"),
    ]);
    assert_eq!(
        frames,
        [
            "0: down 0.0 (100,50), down 1.0 (200,70)",
            "10: move 1.0 (205,70)",
            "20: up 0.0, move 1.0 (210,70)",
            "30: move 1.0 (215,70), down 0.1 (300,10)",
            "40: up 0.1, up 1.0",
        ]
    );
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn the_last_finger_lifts_with_the_button() {
    let (frames, warnings) = played(&[
        at(0, "x 1000,y 500,mt_report,button 1,sync"),
        at(10, "button 0,sync"),
    ]);
    assert_eq!(frames, ["0: down 0.0 (100,50)", "10: up 0.0"]);
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn tracking_ids_count_more_than_places() {
    let (frames, _) = played(&[
        at(0, "id 5,x 1000,y 500,mt_report,id 6,x 1100,y 500,mt_report,sync"),
        at(10, "id 6,x 1000,y 500,mt_report,id 5,x 1100,y 500,mt_report,sync"),
        at(20, "id 7,x 1000,y 500,mt_report,id 5,x 1100,y 500,mt_report,sync"),
        at(30, "mt_report,sync"),
    ]);
    assert_eq!(
        frames,
        [
            "0: down 0.0 (100,50), down 1.0 (110,50)",
            "10: move 0.0 (110,50), move 1.0 (100,50)",
            "20: up 1.0, down 1.1 (100,50)",
            "30: up 0.0, up 1.1",
        ]
    );
}

#[test]
fn what_is_missing_cancels_and_what_is_half_is_left_out() {
    let (frames, warnings) = played(&[
        at(0, "x 1000,y 500,mt_report,x 5,mt_report,sync"),
        at(10, "x 1010,y 500,mt_report,dropped,x 9,y 9,mt_report,sync"),
        at(20, "x 1020,y 500,mt_report,sync"),
        at(30, "x 1030,y 500,mt_report"),
    ]);
    assert_eq!(
        frames,
        [
            "0: down 0.0 (100,50)",
            "10: cancel 0.0",
            "20: down 0.1 (102,50)",
            "30: cancel 0.1",
        ]
    );
    assert_eq!(
        warnings,
        [
            "the last frame has no SYN_REPORT, left out",
            "1 SYN_DROPPED: events are missing, all contacts cancelled",
            "1 contact(s) left out: no frame has them down with both coordinates",
            "1 contact(s) still down at the end, cancelled",
        ]
    );
}

#[test]
fn more_than_any_such_device_had_are_left_out() {
    let many: Vec<String> = (0..70).map(|i| format!("x {i},y 1,mt_report")).collect();
    let (frames, warnings) = played(&[at(0, &(many.join(",") + ",sync")), at(5, "mt_report,sync")]);
    assert_eq!(frames[0].matches("down").count(), 64);
    assert!(
        warnings[0].starts_with("6 contact(s) left out: more"),
        "{warnings:?}"
    );
}

#[test]
fn two_protocols_in_one_are_refused() {
    for events in ["slot 0,x 1,y 1,mt_report", "x 1,y 1,mt_report,slot 0"] {
        let text = HEAD.to_owned() + &at(0, events);
        let error = import_evemu(text.as_bytes(), "rec", &ImportOptions::default()).unwrap_err();
        let error = error.to_string();
        assert!(
            error.starts_with("rec:14: expected one multi-touch protocol"),
            "{error}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// Fingers in cells of 80 mm that never leave them by more than they can be told apart, told in any order.
    #[test]
    fn fingers_that_keep_apart_are_never_mixed_up(
        frames in prop::collection::vec(
            (prop::collection::btree_map(0..20_i32, (0..200_i32, 0..200_i32), 0..12), any::<u64>()),
            2..40,
        ),
    ) {
        let mut text = "A: 35 0 4000 0 0 10\nA: 36 0 4000 0 0 10\n".to_owned();
        for (t, (cells, order)) in frames.iter().enumerate() {
            let mut cells: Vec<_> = cells.iter().collect();
            cells.sort_by_key(|(cell, _)| (**cell as u64).wrapping_mul(order | 1));
            let mut say = |kind, code, value: i32| {
                writeln!(text, "E: {t}.000000 {kind:04x} {code:04x} {value}").expect("memory takes all");
            };
            for (cell, (dx, dy)) in cells {
                say(3, 0x35, cell % 5 * 800 + dx);
                say(3, 0x36, cell / 5 * 800 + dy);
                say(0, 2, 0);
            }
            say(0, 2, 0);
            say(0, 0, 0);
        }
        let Ok(imported) = import_evemu(text.as_bytes(), "any", &ImportOptions::default()) else {
            // Nobody ever touched.
            return Ok(());
        };
        let cell = |at: DVec2| (at / 80.0).floor();
        let mut home = std::collections::BTreeMap::new();
        for event in imported.frames.iter().flat_map(|frame| &frame.events) {
            let (id, at) = (event.contact.key.id, event.contact.position);
            match event.phase {
                Phase::Down => prop_assert_eq!(home.insert(id, cell(at)), None),
                Phase::Move => prop_assert_eq!(home[&id], cell(at)),
                Phase::Up | Phase::Cancel => prop_assert_eq!(home.remove(&id), Some(cell(at))),
            }
        }
        prop_assert!(home.is_empty());
    }
}
