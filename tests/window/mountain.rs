//! Real window, real touch: the program full screen on an X server with a touchscreen, and what visitors do to it.
//!
//! The fingers are device events, the pictures are the screen's, the heights are the saved land's. Where the equipment
//! (see `touch-x/README.md`) is not installed, the tests say so and pass; with `OROGEN_REQUIRE_WINDOW=1` they fail.

use std::fs;

use crate::window_support::fingers::{Script, gesture};
use crate::window_support::metrics::{Metrics, WHOLE_SECOND};
use crate::window_support::picture::Picture;
use crate::window_support::{Key, SLOW_S, Setup, Table};
use orogen::gesture::file::GestureFile;

/// Mean difference of pixels that a visitor sees without looking for it, 0–255.
const SEEN: f64 = 5.0;

/// Age at which touched land is compared with untouched land, years: five seconds after the start. Rivers and lakes
/// change everywhere while land is young, on both alike.
const AGE_YR: f64 = 2.5e6;

#[test]
fn two_hands_raise_a_range() {
    let Some(mut table) = Table::fresh("two_hands_raise_a_range", &Setup::default()) else {
        return;
    };
    let untouched = table.look_at_age(AGE_YR, "untouched");
    let land = table.save();
    table.start_over();
    let start = table.settled();

    let mut hands = Script::default();
    let (west, east) = (table.at(0.27, 0.5), table.at(0.73, 0.5));
    let (towards_east, towards_west) = (table.at(0.39, 0.5), table.at(0.61, 0.5));
    hands.hand(0.0, 2.0, west, towards_east);
    hands.hand(0.0, 2.0, east, towards_west);
    table.play(&hands);
    table.wait("the range rises under the fingers", SLOW_S, |now| {
        (now.contacts, now.hands) == (10, 2) && now.max_m > start.max_m + 100.0
    });
    table.play(&Script::lifting(10));
    let end = table.wait("a range of 600 m", SLOW_S, |now| {
        now.contacts == 0 && now.max_m > start.max_m + 600.0
    });
    assert_eq!(end.pushes - start.pushes, 2);

    let touched = table.look_at_age(AGE_YR, "touched");
    let risen_land = table.save();
    let between = table.at(0.5, 0.5);
    let risen = risen_land.risen(&land, between, 100.0);
    assert!(risen > 400.0, "between the hands the land rose by {risen:.0} m");
    let highest = risen_land.report["terrain"]["max_m"].as_f64().unwrap();
    assert!(
        highest > start.max_m + 400.0,
        "the report's highest point: {highest:.0} m"
    );
    let changed = touched.difference(&untouched, between, 60);
    assert!(
        changed > 3.0 * SEEN,
        "between the hands the picture changed by {changed:.1}"
    );
    for (x, y) in [(0.06, 0.15), (0.06, 0.8), (0.94, 0.15), (0.94, 0.5)] {
        let far = table.at(x, y);
        let noise = touched.difference(&untouched, far, 40);
        assert!(
            noise < changed / 4.0,
            "between the hands the picture changed by {changed:.1}, and by {noise:.1} at {far:?}"
        );
        let moved = risen_land.changed(&land, far, 40.0);
        assert!(
            moved < 100.0,
            "far from the hands the land changed by {moved:.0} m at {far:?}"
        );
    }
}

#[test]
fn four_visitors_sculpt_at_once() {
    let Some(mut table) = Table::fresh("four_visitors_sculpt_at_once", &Setup::default()) else {
        return;
    };
    let start = table.settled();
    let land = table.save();
    // Two on each long side push away from themselves; the land rises before their fingertips.
    let places = [
        (0.25, 0.2, 0.36),
        (0.75, 0.2, 0.36),
        (0.25, 0.8, 0.64),
        (0.75, 0.8, 0.64),
    ];
    let mut hands = Script::default();
    for (visitor, (x, from, to)) in places.into_iter().enumerate() {
        let (from, to) = (table.at(x, from), table.at(x, to));
        hands.hand(0.1 * visitor as f64, 2.0, from, to);
    }
    table.play(&hands);
    table.wait("twenty fingers of four hands", SLOW_S, |now| {
        (now.contacts, now.hands) == (20, 4)
    });
    table.play(&Script::lifting(20));
    let end = table.wait("high land", SLOW_S, |now| now.max_m > start.max_m + 400.0);
    assert_eq!(
        (end.pushes - start.pushes, end.dead_touches),
        (4, start.dead_touches)
    );
    let risen_land = table.save();
    for (x, from, to) in places {
        let ahead = table.at(x, to + 0.3 * (to - from));
        let risen = risen_land.risen(&land, ahead, 60.0);
        assert!(
            risen > 100.0,
            "before the hand at {ahead:?} the land rose by {risen:.0} m"
        );
    }
}

#[test]
fn taps_between_two_frames_are_kept() {
    let Some(mut table) = Table::fresh("taps_between_two_frames_are_kept", &Setup::default()) else {
        return;
    };
    let start = table.settled();
    // A thousandth of a second each, far apart, at ever another time within a frame.
    let mut taps = Script::default();
    let places = [0.15, 0.5, 0.85, 0.3, 0.7, 0.2, 0.6, 0.4];
    for (i, x) in places.into_iter().enumerate() {
        let y = if i % 2 == 0 { 0.35 } else { 0.65 };
        let at = table.at(x, y);
        taps.tap(0.4531 * i as f64, 0.001, at);
    }
    table.play(&taps);
    let sent = places.len() as u64;
    let end = table.settled();
    assert_eq!(end.contacts_total - start.contacts_total, sent);
    assert_eq!(end.taps - start.taps, sent);
    assert_eq!((end.contacts, end.dead_touches), (0, start.dead_touches));
}

#[test]
fn a_finger_on_a_control_does_not_sculpt() {
    let Some(mut table) = Table::fresh("a_finger_on_a_control_does_not_sculpt", &Setup::default()) else {
        return;
    };
    let start = table.settled();
    let land = table.save();
    let control = table.metrics.control("readouts");
    let at = (control.x_px, control.y_px);
    let (from, to) = (table.at(0.4, 0.5), table.at(0.55, 0.5));
    let mut both = Script::default();
    both.stroke(0.0, 2.0, from, to);
    both.tap(0.5, 0.2, at);
    both.tap(1.3, 0.2, at);
    table.play(&both);
    let end = table.wait("the range", SLOW_S, |now| {
        now.contacts == 0 && now.max_m > start.max_m + 200.0
    });
    assert_eq!(end.control_presses - start.control_presses, 2, "{control:?}");
    let land_only = (
        end.contacts_total - start.contacts_total,
        end.pushes - start.pushes,
        end.taps - start.taps,
    );
    assert_eq!(land_only, (1, 1, 0), "only the other finger came to the land");
    let risen_land = table.save();
    let ahead = table.at(0.57, 0.5);
    let risen = risen_land.risen(&land, ahead, 60.0);
    assert!(
        risen > 100.0,
        "before the other finger the land rose by {risen:.0} m"
    );
    let under = risen_land.risen(&land, at, 40.0);
    // Rivers of the range may lay something down there; a finger raises hundreds of metres.
    assert!(under < 60.0, "under the control the land rose by {under:.0} m");
}

#[test]
fn an_unplugged_touchscreen_leaves_no_finger_behind() {
    let Some(mut table) = Table::fresh(
        "an_unplugged_touchscreen_leaves_no_finger_behind",
        &Setup::default(),
    ) else {
        return;
    };
    let (from, to) = (table.at(0.3, 0.5), table.at(0.42, 0.5));
    let mut hand = Script::default();
    hand.hand(0.0, 1.0, from, to);
    table.play(&hand);
    table.wait("five fingers", SLOW_S, |now| now.contacts == 5);
    table.unplug();
    table.wait("no finger", SLOW_S, |now| now.contacts == 0);
    table.replug();
    let start = table.settled();
    let land = table.save();
    let (from, to) = (table.at(0.5, 0.75), table.at(0.65, 0.75));
    let mut finger = Script::default();
    finger.stroke(0.0, 1.5, from, to);
    table.play(&finger);
    let end = table.settled();
    assert_eq!((end.contacts, end.pushes - start.pushes), (0, 1));
    let risen = table.save().risen(&land, (to.0 + 20.0, to.1), 60.0);
    assert!(risen > 50.0, "before the finger the land rose by {risen:.0} m");
}

/// What the screen shows some time after a gesture file was played on fresh land. No touch of it may be dead.
fn played(table: &mut Table, file: &GestureFile, name: &str) -> Picture {
    table.start_over();
    let start = table.settled();
    table.play(&Script::of_gesture(file, start.width.into()));
    let touched = table.look_at_age(AGE_YR, name);
    let end = table.settled();
    assert_eq!(
        end.dead_touches, start.dead_touches,
        "{name}: a touch changed nothing"
    );
    touched
}

/// Plays gesture files. Each has to be seen where it says that the land changes.
fn answered(table: &mut Table, untouched: &Picture, names: &[&str]) {
    for &name in names {
        let file = gesture(name);
        let touched = played(table, &file, name);
        let expected = file.header.expect.unwrap_or_default().land_changes_at;
        assert!(!expected.is_empty(), "{name} says no place");
        for place in expected {
            let share = place.at / file.header.size_mm;
            let at = table.at(share.x, share.y);
            let changed = touched.difference(untouched, at, 25);
            assert!(
                changed > SEEN,
                "{name}: the picture changed by {changed:.1} at {at:?}"
            );
        }
    }
}

#[test]
fn drumming_slapping_rubbing_and_writing_are_answered() {
    let test = "drumming_slapping_rubbing_and_writing_are_answered";
    let Some(mut table) = Table::fresh(test, &Setup::default()) else {
        return;
    };
    let untouched = table.look_at_age(AGE_YR, "untouched");
    let names = ["drumming", "slapping", "rubbing", "writing_a_name"];
    answered(&mut table, &untouched, &names);
}

#[test]
fn pulling_equal_pushes_and_a_neighbour_are_answered() {
    let test = "pulling_equal_pushes_and_a_neighbour_are_answered";
    let Some(mut table) = Table::fresh(test, &Setup::default()) else {
        return;
    };
    let untouched = table.look_at_age(AGE_YR, "untouched");
    let names = ["pulling_towards_oneself", "two_equal_pushes"];
    answered(&mut table, &untouched, &names);
    // A window is not told how large contacts are: the neighbour's arm is a finger to it, and may move the range.
    let name = "neighbour_leaning_in";
    let touched = played(&mut table, &gesture(name), name);
    let squares =
        (1..12).flat_map(|column| (1..7).map(move |row| (f64::from(column) / 12.0, f64::from(row) / 7.0)));
    let squares = squares.map(|(x, y)| touched.difference(&untouched, table.at(x, y), 40));
    let most = squares.fold(0.0, f64::max);
    assert!(
        most > 3.0 * SEEN,
        "{name}: the picture changed by {most:.1} at most"
    );
}

#[test]
fn the_mouse_is_a_finger_and_alt_f4_closes_a_window() {
    let setup = Setup {
        screen: (1440, 900),
        arguments: &["--windowed", "--size", "960x540"],
        ..Setup::default()
    };
    let Some(mut table) = Table::fresh("the_mouse_is_a_finger_and_alt_f4_closes_a_window", &setup) else {
        return;
    };
    let start = table.settled();
    assert_eq!((start.width, start.height), (960, 540));
    let land = table.save();
    let (from, to) = (table.at(0.3, 0.5), table.at(0.5, 0.5));
    table.drag(from, to, 1.5);
    let end = table.wait("the range", SLOW_S, |now| {
        now.contacts == 0 && now.max_m > start.max_m + 200.0
    });
    assert_eq!(end.pushes - start.pushes, 1);
    let risen = table.save().risen(&land, (to.0 + 15.0, to.1), 40.0);
    assert!(risen > 100.0, "before the mouse the land rose by {risen:.0} m");
    table.press(&[Key::R], 0.3);
    let kept = table.settled();
    assert!(
        kept.max_m >= end.max_m,
        "R was not held, yet the land is another: {kept:?}"
    );
    table.start_over();
    table.press(&[Key::Alt, Key::F4], 0.1);
    assert_eq!(table.ended(10.0).code(), Some(0));
}

#[test]
fn a_window_changes_its_size_and_escape_closes_it() {
    let setup = Setup {
        screen: (1440, 810),
        arguments: &["--windowed", "--size", "960x540"],
        ..Setup::default()
    };
    let Some(mut table) = Table::fresh("a_window_changes_its_size_and_escape_closes_it", &setup) else {
        return;
    };
    let whole: serde_json::Value = serde_json::from_str(&table.metrics.last_line()).unwrap();
    for field in WHOLE_SECOND.split_whitespace() {
        assert!(whole.get(field).is_some(), "no `{field}` in {whole}");
    }
    table.press(&[Key::F11], 0.05);
    table.wait("full screen", SLOW_S, |now| {
        (now.width, now.height) == (1440, 810)
    });
    table.find_window();
    let start = table.settled();
    let land = table.save();
    let (from, to) = (table.at(0.5, 0.3), table.at(0.5, 0.55));
    let mut finger = Script::default();
    finger.stroke(0.0, 1.5, from, to);
    table.play(&finger);
    table.wait("the range", SLOW_S, |now| {
        now.contacts == 0 && now.max_m > start.max_m + 200.0
    });
    let risen = table.save().risen(&land, (to.0, to.1 + 20.0), 60.0);
    assert!(
        risen > 100.0,
        "on the greater window the land rose by {risen:.0} m before the finger"
    );
    table.press(&[Key::F11], 0.05);
    let end = table.wait("a window", SLOW_S, |now| (now.width, now.height) == (960, 540));
    assert!(
        end.max_m > start.max_m + 200.0 && end.panics == 0,
        "the land is kept: {end:?}"
    );
    table.press(&[Key::Escape], 0.05);
    assert_eq!(table.ended(10.0).code(), Some(0));
}

#[test]
fn the_checks_can_fail() {
    let dark = Picture(image::RgbImage::from_pixel(64, 64, image::Rgb([10, 20, 30])));
    let mut lit = dark.0.clone();
    for (x, y) in [(40, 40), (41, 40), (40, 41), (41, 41)] {
        lit.put_pixel(x, y, image::Rgb([10, 120, 30]));
    }
    let lit = Picture(lit);
    assert_eq!(lit.difference(&dark, (41.0, 41.0), 2), 25.0);
    assert_eq!(lit.difference(&dark, (20.0, 20.0), 10), 0.0);

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("metrics.jsonl");
    let mut metrics = Metrics::new(file.clone());
    let line = |t_s: u32, phase: &str| {
        let mut second: serde_json::Map<_, _> = WHOLE_SECOND
            .split_whitespace()
            .map(|field| (field.to_owned(), 0.into()))
            .collect();
        second.insert("t_s".to_owned(), t_s.into());
        second.insert("phase".to_owned(), phase.into());
        for words in ["mode", "source", "adapter", "backend"] {
            second.insert(words.to_owned(), "some".into());
        }
        // The next line is being written.
        format!("{}\n{{\"t_s\":", serde_json::Value::from(second))
    };
    fs::write(&file, line(1, "attract")).unwrap();
    assert_eq!(
        (metrics.newest().t_s, metrics.newest().phase.as_str()),
        (1.0, "attract")
    );
    let waits = |metrics: &mut Metrics, alive: Result<(), String>| {
        let wait = std::panic::AssertUnwindSafe(|| {
            metrics.wait("play", 0.2, || alive.clone(), |now| now.phase == "play")
        });
        std::panic::catch_unwind(wait).is_ok()
    };
    assert!(!waits(&mut metrics, Ok(())), "nobody played");
    assert!(!waits(&mut metrics, Err("ended".to_owned())), "the program ended");
}
