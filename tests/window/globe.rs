//! The planet in the real window under real touch, on the equipment of `window.rs`.

use crate::window_support::fingers::Script;
use crate::window_support::{SLOW_S, Setup, Table};

/// Mean difference of pixels where one world has given way to the other, 0–255.
const OTHER_WORLD: f64 = 12.0;
/// The same where a planet was turned.
const TURNED: f64 = 4.0;

#[test]
fn hands_lead_plates_and_both_worlds_are_kept() {
    let setup = Setup {
        arguments: &["--mode", "globe"],
        ..Setup::default()
    };
    let Some(mut table) = Table::start("hands_lead_plates_and_both_worlds_are_kept", &setup) else {
        return;
    };
    table.wait("the planet", SLOW_S, |now| now.mode == "globe" && now.plates > 3);
    let mut touch = Script::default();
    touch.tap(0.0, 0.1, table.at(0.5, 0.5));
    table.play(&touch);
    let fresh = table.wait("the touch to wake the table", SLOW_S, |now| now.phase == "invite");

    // Two hands of five fingers, one on either half of the disc, go towards each other and stay.
    let mut push = Script::default();
    push.hand(0.0, 2.5, table.at(0.38, 0.5), table.at(0.45, 0.5));
    push.hand(0.1, 2.5, table.at(0.62, 0.46), table.at(0.55, 0.48));
    table.play(&push);
    let led = table.wait("hands to lead plates", SLOW_S, |now| {
        now.plates_led > 0 && now.led_deg_per_my > 0.05 && now.phase == "play"
    });
    assert!(led.contacts >= 8, "{led:?}");
    table.look("led");
    let moved = table.wait("plates to move", SLOW_S, |now| {
        now.elapsed_yr > led.elapsed_yr + 2e6
    });
    assert!(moved.elapsed_yr > fresh.elapsed_yr, "time goes on");
    table.play(&Script::lifting(10));
    table.wait("the hands to lift", SLOW_S, |now| now.contacts == 0);

    // A finger beside the planet turns it.
    press(&mut table, "play_pause");
    let still = table.settled();
    let before = table.look("before");
    let mut turn = Script::default();
    turn.stroke(0.0, 1.0, table.at(0.12, 0.5), table.at(0.3, 0.5));
    table.play(&turn);
    let stopped = table.settled();
    let turned = table.look("turned");
    let middle = table.at(0.5, 0.5);
    let changed = turned.difference(&before, middle, 150);
    assert!(changed > TURNED, "turned, the picture changed by {changed:.1}");
    assert_eq!(stopped.elapsed_yr, still.elapsed_yr, "the clock stands");

    // To the mountain, where there is work to do, and back.
    press(&mut table, "world");
    table.wait("the mountain", SLOW_S, |now| now.mode == "mountain");
    let mut raise = Script::default();
    raise.stroke(0.0, 2.0, table.at(0.35, 0.5), table.at(0.6, 0.5));
    table.play(&raise);
    let land = table.wait("land to rise", SLOW_S, |now| {
        now.contacts == 0 && now.max_m > 300.0
    });
    assert_eq!(land.plates, 0);
    let mountain = table.look("mountain");
    let changed = mountain.difference(&turned, middle, 150);
    assert!(changed > OTHER_WORLD, "the picture changed by {changed:.1}");
    press(&mut table, "world");
    let back = table.wait("the planet again", SLOW_S, |now| now.mode == "globe");
    assert_eq!(back.elapsed_yr, still.elapsed_yr, "it was kept as it was left");
    let again = table.look("again");
    let changed = again.difference(&turned, middle, 150);
    assert!(changed < TURNED, "the picture changed by {changed:.1}");
    press(&mut table, "world");
    let kept = table.wait("the mountain again", SLOW_S, |now| now.mode == "mountain");
    assert!(
        kept.max_m > 250.0 && kept.elapsed_yr >= land.elapsed_yr,
        "{kept:?}"
    );
    assert_eq!(kept.panics, 0);
}

/// Taps a control of the north side.
fn press(table: &mut Table, kind: &str) {
    let control = table.metrics.control(kind);
    let mut touch = Script::default();
    touch.tap(0.0, 0.2, (control.x_px, control.y_px));
    table.play(&touch);
    table.settled();
}
