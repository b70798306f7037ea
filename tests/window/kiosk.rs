//! The table when nobody is there, and the way out: for staff, not for visitors. On the equipment of `window.rs`.

use std::process::Command;
use std::thread;
use std::time::Duration;

use crate::window_support::fingers::Script;
use crate::window_support::{Key, SLOW_S, Setup, Table};

/// A table that nobody uses for twenty seconds begins to count down from twenty.
fn soon_idle() -> Setup<'static> {
    Setup {
        arguments: &["kiosk"],
        settings: "[table]\nwidth_mm = 1209.6\n[kiosk]\nidle_s = 20\ncountdown_s = 20\n",
        ..Setup::default()
    }
}

#[test]
fn an_idle_table_starts_over() {
    let Some(mut table) = Table::in_play("an_idle_table_starts_over", &soon_idle()) else {
        return;
    };
    let (from, to) = (table.at(0.4, 0.5), table.at(0.55, 0.5));
    let mut finger = Script::default();
    finger.stroke(0.0, 1.0, from, to);
    table.play(&finger);
    let start = table.settled();
    let warned = table.wait("the warning", 30.0, |now| now.phase == "idle_warning");
    let idle = warned.t_s - start.t_s;
    assert!((15.0..25.0).contains(&idle), "warned {idle:.1} s after the touch");
    assert!(
        warned.max_m > start.max_m + 500.0,
        "the land goes on while nobody touches it"
    );
    let over = table.wait("the reset", 30.0, |now| now.resets > start.resets);
    let counted = over.t_s - warned.t_s;
    assert!(
        (17.0..24.0).contains(&counted),
        "the countdown took {counted:.1} s"
    );
    let rest = table.wait("the show", 10.0, |now| now.phase == "attract");
    assert!(rest.max_m < start.max_m.max(500.0), "the range is gone: {rest:?}");
    assert_eq!(rest.resets, start.resets + 1);
}

#[test]
fn a_touch_cancels_the_countdown() {
    let Some(mut table) = Table::in_play("a_touch_cancels_the_countdown", &soon_idle()) else {
        return;
    };
    let start = table.settled();
    let warned = table.wait("the warning", 30.0, |now| now.phase == "idle_warning");
    let picture = table.look("warned");
    let mut touch = Script::default();
    touch.tap(0.0, 0.2, table.at(0.3, 0.4));
    table.play(&touch);
    table.wait("play", 3.0, |now| now.phase == "play");
    assert!(
        table
            .look("cancelled")
            .difference(&picture, table.at(0.5, 0.5), 360)
            > 0.5,
        "the warning is not seen"
    );
    // Had the countdown gone on, it would have ended by now.
    let later = table.wait("twenty-two seconds", 30.0, |now| now.t_s > warned.t_s + 22.0);
    assert_eq!(later.resets, start.resets);
}

#[test]
fn a_touch_during_the_flight_only_wakes_the_plan() {
    let setup = Setup {
        settings: "[table]\nwidth_mm = 1209.6\n[kiosk]\nidle_s = 600\nflight_after_s = 5\n",
        ..Setup::default()
    };
    let Some(mut table) = Table::in_play("a_touch_during_the_flight_only_wakes_the_plan", &setup) else {
        return;
    };
    let start = table.settled();
    let (plan, middle) = (table.look("plan"), table.at(0.5, 0.5));
    table.wait("the flight", 20.0, |now| now.t_s > start.t_s + 12.0);
    let flight = table.look("flight").difference(&plan, middle, 360);
    assert!(
        flight > 10.0,
        "in flight the picture is the plan but for {flight:.1}"
    );
    let mut touch = Script::default();
    touch.tap(0.0, 0.2, middle);
    table.play(&touch);
    let mut back = flight;
    for second in 0..20 {
        table.settled();
        back = table
            .look(&format!("back-{second}"))
            .difference(&plan, middle, 360);
        if back < flight / 3.0 {
            break;
        }
    }
    assert!(
        back < flight / 3.0,
        "the plan differs by {back:.1} from what it was"
    );
    let end = table.settled();
    assert_eq!(
        (end.taps, end.pushes),
        (start.taps, start.pushes),
        "the touch sculpted"
    );
}

#[test]
fn visitors_cannot_leave_the_kiosk_and_staff_can() {
    let setup = Setup {
        arguments: &["kiosk"],
        settings: "[table]\nwidth_mm = 1209.6\n[staff]\npin = \"2468\"\ncorner = \"north-west\"\n",
        ..Setup::default()
    };
    let Some(mut table) = Table::in_play("visitors_cannot_leave_the_kiosk_and_staff_can", &setup) else {
        return;
    };
    for keys in [&[Key::Escape][..], &[Key::Alt, Key::F4]] {
        table.press(keys, 0.1);
        assert!(table.survives(2.0), "{keys:?} closed the kiosk");
    }
    let corner = table.metrics.staff_corner();
    let mut touch = Script::default();
    touch.tap(0.0, 1.0, corner);
    table.play(&touch);
    table.settled();
    assert!(!table.metrics.keypad_shown(), "a short touch opened the keypad");
    let mut touch = Script::default();
    touch.tap(0.0, 3.5, corner);
    table.play(&touch);
    for wrong_then_right in ["1357", "2468"] {
        for digit in wrong_then_right.chars() {
            tap(&mut table, &digit.to_string());
        }
        tap(&mut table, "Enter");
    }
    tap(&mut table, "Close the program");
    tap(&mut table, "Press again to close");
    assert_eq!(table.ended(15.0).code(), Some(0));
}

#[test]
fn four_touches_calibrate_the_table_and_are_kept() {
    let Some(mut table) = Table::in_play("four_touches_calibrate_the_table_and_are_kept", &Setup::default())
    else {
        return;
    };
    let before = table.settled();
    let mut touch = Script::default();
    touch.tap(0.0, 3.5, table.metrics.staff_corner());
    table.play(&touch);
    for digit in "2580".chars() {
        tap(&mut table, &digit.to_string());
    }
    tap(&mut table, "Enter");
    tap(&mut table, "Calibrate touch at four crosses");
    table.look("cross");
    // The touching surface lies to the left and lower.
    let (dx, dy) = (-0.02, 0.015);
    for (x, y) in [(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)] {
        let mut touch = Script::default();
        touch.tap(0.0, 0.3, table.at(x + dx, y + dy));
        table.play(&touch);
        table.settled();
    }
    let settings = table.settings();
    let line = settings.lines().find(|line| line.starts_with("calibration = "));
    let text = line
        .and_then(|line| line.split('"').nth(1))
        .expect("a calibration");
    let found: Vec<f64> = text
        .split(' ')
        .map(|number| number.parse().expect("a number"))
        .collect();
    let expected = [1.0, 0.0, 0.0, 1.0, -dx, -dy];
    // (A pixel is 0.0014 of the height.)
    assert!(
        found.len() == 6 && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.004),
        "{text}"
    );
    assert_eq!(
        table.settled().contacts_total,
        before.contacts_total,
        "the crosses' touches sculpt nothing"
    );
}

/// Taps a key of the keypad or a button of the menu.
fn tap(table: &mut Table, label: &str) {
    let at = table.metrics.place(label, SLOW_S);
    let mut touch = Script::default();
    touch.tap(0.0, 0.15, at);
    table.play(&touch);
    thread::sleep(Duration::from_millis(300));
}

#[test]
fn without_a_display_the_kiosk_says_so_in_a_line() {
    let output = Command::new(env!("CARGO_BIN_EXE_orogen"))
        .arg("kiosk")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert_eq!(
        error.trim_end().lines().count(),
        1,
        "one line expected, got:\n{error}"
    );
    assert!(error.contains("display"), "{error}");
    assert!(output.stdout.is_empty());
}
