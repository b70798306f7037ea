//! The tools of each side under real touch, on the equipment of `window.rs`.

use std::thread;
use std::time::Duration;

use crate::window_support::fingers::Script;
use crate::window_support::{SLOW_S, Setup, Table};
use orogen::gesture::command::Action;
use orogen::gesture::file::read_gesture;

/// Mean difference of pixels where a sheet of paper has come, 0–255.
const SHEET: f64 = 25.0;

#[test]
fn two_fingers_open_a_sheet_and_a_line_turns_folds() {
    let Some(mut table) = Table::fresh(
        "two_fingers_open_a_sheet_and_a_line_turns_folds",
        &Setup::default(),
    ) else {
        return;
    };
    let before = table.look("before");
    take(&mut table, "slice");
    let (west, east) = (table.at(0.25, 0.45), table.at(0.75, 0.4));
    let mut hands = Script::default();
    hands.stroke(0.0, 2.0, (west.0, west.1 - 40.0), west);
    hands.stroke(0.05, 2.0, (east.0, east.1 - 40.0), east);
    table.play(&hands);
    let end = table.settled();
    assert_eq!(end.contacts, 0);
    let freeze = table.metrics.control("freeze_slice");
    let sheet = table.look("sheet");
    let changed = sheet.difference(&before, (freeze.x_px + 150.0, freeze.y_px - 60.0), 40);
    assert!(
        changed > SHEET,
        "beside its controls the picture changed by {changed:.1}"
    );

    // Frozen and closed by its own controls.
    take(&mut table, "freeze_slice");
    take(&mut table, "close_slice");

    take(&mut table, "fold");
    let (from, to) = (table.at(0.4, 0.15), table.at(0.6, 0.42));
    let mut line = Script::default();
    line.stroke(0.0, 1.2, from, to);
    table.play(&line);
    table.settled();

    let kept = kept_contacts(&mut table);
    let file = read_gesture(&kept[..], "the ring").expect("a gesture file");
    let done: Vec<&Action> = file
        .frames
        .iter()
        .flat_map(|frame| frame.commands.iter().map(|command| &command.action))
        .collect();
    let ends: Vec<_> = done
        .iter()
        .filter_map(|action| match action {
            Action::Slice(ends) => Some(*ends),
            _ => None,
        })
        .collect();
    assert!(ends.len() > 2, "it follows the fingers: {done:?}");
    let px_per_mm = f64::from(end.width) / 1209.6;
    let last = ends[ends.len() - 1];
    let off = (last.from.x * px_per_mm - west.0).abs() + (last.to.x * px_per_mm - east.0).abs();
    assert!(off < 8.0, "{last:?} is not where the fingers lifted");
    assert!(done.contains(&&Action::FreezeSlice(true)), "{done:?}");
    assert!(done.contains(&&Action::CloseSlice), "{done:?}");
    let turned = done.iter().find_map(|action| match action {
        Action::TurnFolds { path } => Some(path),
        _ => None,
    });
    let path = turned.expect("a line along folds");
    assert!((path[0].x * px_per_mm - from.0).abs() < 8.0, "{path:?}");
    assert_eq!(end.pushes, table.settled().pushes, "tools do not push");
}

/// Taps a control of the north side.
fn take(table: &mut Table, kind: &str) {
    let control = table.metrics.control(kind);
    let mut touch = Script::default();
    touch.tap(0.0, 0.2, (control.x_px, control.y_px));
    table.play(&touch);
    table.settled();
}

/// What staff save of the last minute.
fn kept_contacts(table: &mut Table) -> Vec<u8> {
    let mut touch = Script::default();
    touch.tap(0.0, 3.5, table.metrics.staff_corner());
    table.play(&touch);
    for label in ["2", "5", "8", "0", "Enter", "Save the last 60 s of touches"] {
        let at = table.metrics.place(label, SLOW_S);
        let mut touch = Script::default();
        touch.tap(0.0, 0.15, at);
        table.play(&touch);
        thread::sleep(Duration::from_millis(300));
    }
    table.saved_contacts()
}
