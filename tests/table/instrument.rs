//! Whose contact is it, and what controls do: driven as a table drives it, by contact events and looks at the scene.

use crate::instrument_support::{MS, SIZE_MM, Table, contact, params};
use glam::DVec2;
use orogen::gesture::command::{Action, Command, Tool};
use orogen::gesture::contact::{Phase, Side, Source};
use orogen::instrument::{ControlKind, Deed, Instrument, InstrumentParams, Key, Route};
use proptest::prelude::*;

const LAND: DVec2 = DVec2::new(600.0, 300.0);
const BOTH: [Side; 2] = [Side::North, Side::South];

fn command(action: Action, side: Side, contact: Option<u64>) -> Deed {
    Deed::Command(Command {
        action,
        side: Some(side),
        contact,
    })
}

#[test]
fn a_tap_on_a_control_acts_when_it_lifts_and_carries_side_and_contact() {
    for side in BOTH {
        for (kind, action) in [
            (ControlKind::Tool(Tool::Edit), Action::Tool(Tool::Edit)),
            (ControlKind::Tool(Tool::Slice), Action::Tool(Tool::Slice)),
            (ControlKind::Undo, Action::Undo),
            (ControlKind::PlayPause, Action::Pause),
            (ControlKind::Speed, Action::Speed(2.0)),
        ] {
            let mut table = Table::new();
            let at = table.place(side, kind);
            assert_eq!(table.down(5, at), Route::Control);
            assert!(table.control(side, kind).pressed);
            assert_eq!(table.instrument.drain(), [], "nothing before it lifts");
            assert_eq!(table.up(5), Route::Control);
            assert_eq!(table.instrument.drain(), [command(action, side, Some(5))]);
            assert!(!table.control(side, kind).pressed);
        }
    }
}

#[test]
fn readouts_and_saving_are_deeds_of_their_own() {
    let mut table = Table::new();
    table.tap(1, table.place(Side::North, ControlKind::Readouts));
    table.tap(2, table.place(Side::South, ControlKind::Save));
    table.tap(3, table.place(Side::North, ControlKind::Readouts));
    let expected = [
        Deed::Readouts {
            side: Side::North,
            on: true,
        },
        Deed::Save { side: Side::South },
        Deed::Readouts {
            side: Side::North,
            on: false,
        },
    ];
    assert_eq!(table.instrument.drain(), expected);
}

#[test]
fn a_finger_that_slides_off_does_nothing_and_never_becomes_the_lands() {
    let mut table = Table::new();
    let at = table.place(Side::South, ControlKind::Undo);
    table.down(1, at);
    assert_eq!(table.shift(1, LAND), Route::Control);
    assert!(!table.control(Side::South, ControlKind::Undo).pressed);
    assert_eq!(table.up(1), Route::Control);
    assert_eq!(table.instrument.drain(), []);
    // Back on it before it lifts, it counts.
    table.down(2, at);
    table.shift(2, LAND);
    table.shift(2, at);
    table.up(2);
    assert_eq!(table.instrument.drain().len(), 1);
    // Withdrawn, it does not.
    table.down(3, at);
    assert_eq!(table.cancel(3), Route::Control);
    assert_eq!(table.instrument.drain(), []);
}

#[test]
fn a_finger_of_the_land_may_cross_controls() {
    let mut table = Table::new();
    let undo = table.place(Side::South, ControlKind::Undo);
    assert_eq!(table.down(1, LAND), Route::Land);
    assert_eq!(table.shift(1, undo), Route::Land);
    assert!(!table.control(Side::South, ControlKind::Undo).pressed);
    assert_eq!(table.up(1), Route::Land);
    assert_eq!(table.instrument.drain(), []);
}

#[test]
fn several_people_do_different_things_at_once() {
    let mut table = Table::new();
    let (north, south) = (
        table.place(Side::North, ControlKind::Undo),
        table.place(Side::South, ControlKind::PlayPause),
    );
    assert_eq!(table.down(1, LAND), Route::Land);
    assert_eq!(table.down(2, north), Route::Control);
    assert_eq!(table.down(3, south), Route::Control);
    assert_eq!(table.shift(1, LAND + 50.0), Route::Land);
    table.up(2);
    table.up(3);
    assert_eq!(table.up(1), Route::Land);
    let expected = [
        command(Action::Undo, Side::North, Some(2)),
        command(Action::Pause, Side::South, Some(3)),
    ];
    assert_eq!(table.instrument.drain(), expected);
}

#[test]
fn one_finger_presses_a_control_and_a_palm_presses_none() {
    let mut table = Table::new();
    let at = table.place(Side::South, ControlKind::Undo);
    for id in 1..=5 {
        assert_eq!(
            table.down(id, at + DVec2::new(id as f64 - 3.0, 0.0)),
            Route::Control
        );
    }
    for id in 1..=5 {
        table.up(id);
    }
    assert_eq!(table.instrument.drain().len(), 1);
    // A palm by its size, by its confidence, and one that shows only later.
    let mut wide = contact(6, at);
    wide.size_mm = Some(DVec2::new(40.0, 20.0));
    let mut unsure = contact(7, at);
    unsure.confidence = Some(0.0);
    let mut grows = contact(8, at);
    for palm in [wide, unsure, grows] {
        table.event(Phase::Down, palm);
    }
    grows.size_mm = Some(DVec2::new(26.0, 20.0));
    table.event(Phase::Move, grows);
    for palm in [wide, unsure, grows] {
        assert_eq!(
            table.event(Phase::Up, palm),
            Route::Control,
            "it does not sculpt either"
        );
    }
    assert_eq!(table.instrument.drain(), []);
}

#[test]
fn between_two_controls_nobody_sculpts() {
    let mut table = Table::new();
    let (a, b) = (
        table.place(Side::South, ControlKind::Tool(Tool::Edit)),
        table.place(Side::South, ControlKind::Save),
    );
    for i in 0..=200_u32 {
        let at = a.lerp(b, f64::from(i) / 200.0);
        assert_eq!(table.down(i.into(), at), Route::Control, "{at}");
        table.cancel(i.into());
    }
}

#[test]
fn starting_over_is_held_with_a_ring_and_never_tapped() {
    let mut table = Table::new();
    let at = table.place(Side::North, ControlKind::StartOver);
    table.tap(1, at);
    table.wait(2000);
    assert_eq!(table.instrument.drain(), []);
    table.down(2, at);
    table.wait(750);
    let progress = table.control(Side::North, ControlKind::StartOver).progress;
    assert!((progress - 0.5).abs() < 0.02, "{progress}");
    // Slid off and back, the time begins anew.
    table.shift(2, LAND);
    table.wait(1000);
    assert_eq!(table.control(Side::North, ControlKind::StartOver).progress, 0.0);
    table.shift(2, at);
    table.wait(1400);
    assert_eq!(table.instrument.drain(), []);
    table.wait(200);
    let once = [command(Action::StartOver, Side::North, Some(2))];
    assert_eq!(table.instrument.drain(), once);
    table.wait(5000);
    table.up(2);
    assert_eq!(table.instrument.drain(), [], "once for each time it is held");
}

#[test]
fn tools_and_undo_belong_to_a_side() {
    let mut table = Table::new();
    table.set.clock.can_undo = [true, false];
    table.wait(1);
    assert!(table.control(Side::North, ControlKind::Undo).enabled);
    assert!(!table.control(Side::South, ControlKind::Undo).enabled);
    let undo = table.place(Side::South, ControlKind::Undo);
    assert_eq!(table.down(1, undo), Route::Control, "off, but no land either");
    table.up(1);
    assert_eq!(table.instrument.drain(), []);
    table.tap(2, table.place(Side::North, ControlKind::Tool(Tool::Edit)));
    assert_eq!(table.instrument.tool(Side::North), Tool::Edit);
    assert_eq!(table.instrument.tool(Side::South), Tool::Push);
    assert!(table.control(Side::North, ControlKind::Tool(Tool::Edit)).on);
    assert!(!table.control(Side::South, ControlKind::Tool(Tool::Edit)).on);
    assert_eq!(table.down(3, DVec2::new(600.0, 200.0)), Route::Tool);
    assert_eq!(table.down(4, DVec2::new(600.0, 500.0)), Route::Land);
}

#[test]
fn stopped_time_is_for_editing_on_both_sides_and_shows_the_slider() {
    let mut table = Table::new();
    let sliders = |table: &Table| {
        let controls = table.instrument.controls();
        controls.iter().filter(|c| c.kind == ControlKind::Scrub).count()
    };
    assert_eq!(sliders(&table), 0);
    table.set.clock.paused = true;
    table.wait(16);
    assert_eq!(sliders(&table), 2);
    assert!(!table.control(Side::South, ControlKind::PlayPause).on);
    assert_eq!(table.down(1, LAND), Route::Tool);
    assert_eq!(table.down(2, LAND + DVec2::new(0.0, 200.0)), Route::Tool);
    table.tap(3, table.place(Side::South, ControlKind::PlayPause));
    assert_eq!(
        table.instrument.drain(),
        [command(Action::Play, Side::South, Some(3))]
    );
    // While the clock runs the slider is not there, and its place is land.
    let slider = table.place(Side::South, ControlKind::Scrub);
    table.set.clock.paused = false;
    assert_eq!(table.down(4, slider), Route::Land);
}

#[test]
fn the_slider_follows_its_finger_through_history_and_reads_from_its_side() {
    let years = |deeds: Vec<Deed>| -> Vec<f64> {
        deeds
            .into_iter()
            .map(|deed| match deed {
                Deed::Command(Command {
                    action: Action::Scrub(years),
                    ..
                }) => years,
                other => panic!("{other:?}"),
            })
            .collect()
    };
    for (side, right) in [(Side::South, 1.0), (Side::North, -1.0)] {
        let mut table = Table::new();
        table.set.clock.paused = true;
        table.set.clock.history_yr = (1e6, 5e6);
        table.set.clock.elapsed_yr = 2e6;
        table.wait(16);
        let slider = table.control(side, ControlKind::Scrub);
        assert!((slider.value - 0.25).abs() < 1e-12);
        let half = DVec2::new(slider.half_size_mm.x * right, 0.0);
        table.down(1, slider.centre_mm);
        table.wait(16);
        assert_eq!(years(table.instrument.drain()), [3e6], "it jumps to the finger");
        // A quick finger is followed, but not by every event.
        for step in 0..60 {
            table.shift(1, slider.centre_mm + half * (f64::from(step) / 59.0));
            table.wait(8);
        }
        let sent = years(table.instrument.drain());
        assert!((6..=11).contains(&sent.len()), "{} in half a second", sent.len());
        assert!(sent.is_sorted());
        assert_eq!(table.control(side, ControlKind::Scrub).value, 1.0);
        // Far past its end and off the row it is still the slider's; what was not yet sent is sent at the end.
        table.shift(1, slider.centre_mm - half * 3.0 - DVec2::new(0.0, 80.0 * right));
        table.up(1);
        assert_eq!(years(table.instrument.drain()), [1e6]);
    }
}

#[test]
fn a_land_without_history_has_a_slider_that_is_off() {
    let mut table = Table::new();
    table.set.clock.paused = true;
    table.wait(16);
    assert!(!table.control(Side::South, ControlKind::Scrub).enabled);
    table.tap(1, table.place(Side::South, ControlKind::Scrub));
    table.key(Key::Back, true);
    assert_eq!(table.instrument.drain(), []);
}

#[test]
fn panels_corner_and_flight_come_before_the_land() {
    let mut table = Table::new();
    let undo = table.place(Side::South, ControlKind::Undo);
    table.set.panels = vec![(LAND - 10.0, LAND + 10.0)];
    assert_eq!(table.down(1, LAND + 9.0), Route::Panel);
    assert_eq!(table.down(2, LAND + 11.0), Route::Land);
    assert_eq!(table.down(3, DVec2::new(30.0, 59.0)), Route::Corner);
    assert_eq!(table.shift(3, LAND + 100.0), Route::Corner, "it never sculpts");
    assert_eq!(table.down(4, DVec2::new(30.0, 61.0)), Route::Land);
    table.set.in_flight = true;
    assert_eq!(table.shift(2, LAND + 20.0), Route::Land, "what was down goes on");
    assert_eq!(table.down(5, LAND + 50.0), Route::Wake);
    assert_eq!(table.down(6, undo), Route::Wake);
    assert_eq!(table.down(7, LAND), Route::Panel);
    assert_eq!(table.down(8, DVec2::ONE), Route::Corner);
    table.set.in_flight = false;
    assert_eq!(table.shift(5, LAND), Route::Wake, "until it lifts");
    table.up(6);
    assert_eq!(table.instrument.drain(), []);
}

#[test]
fn the_shows_contacts_are_always_the_lands() {
    let mut table = Table::new();
    table.set.in_flight = true;
    let mut shown = contact(1, table.place(Side::South, ControlKind::Undo));
    shown.key.source = Source::File;
    for phase in [Phase::Down, Phase::Move, Phase::Up] {
        assert_eq!(table.event(phase, shown), Route::Land);
    }
    assert_eq!(table.instrument.drain(), []);
}

#[test]
fn letting_go_of_everything_keeps_the_lands_contacts_the_lands() {
    let mut table = Table::new();
    let held = table.place(Side::South, ControlKind::StartOver);
    table.down(1, LAND);
    table.down(2, held);
    table.down(3, DVec2::ONE);
    table.instrument.cancel_all();
    table.wait(3000);
    assert_eq!(table.shift(1, LAND + 5.0), Route::Land);
    assert_eq!(table.up(1), Route::Land, "its end must reach the session");
    assert_eq!(table.up(2), Route::Ignored);
    assert_eq!(table.up(3), Route::Ignored);
    assert_eq!(table.up(9), Route::Ignored, "it never landed");
    assert_eq!(table.instrument.drain(), []);
}

#[test]
fn a_new_visitor_finds_a_new_instrument() {
    let mut table = Table::new();
    table.tap(1, table.place(Side::North, ControlKind::Tool(Tool::Edit)));
    table.tap(2, table.place(Side::North, ControlKind::Readouts));
    table.instrument.drain();
    table.instrument.reset();
    let expected = [
        command(Action::Tool(Tool::Push), Side::North, None),
        Deed::Readouts {
            side: Side::North,
            on: false,
        },
    ];
    assert_eq!(table.instrument.drain(), expected);
    table.instrument.reset();
    assert_eq!(table.instrument.drain(), [], "what is new stays as it is");
}

#[test]
fn keys_do_what_controls_do() {
    let mut table = Table::new();
    let mut press = |key: Key, for_ms: u64| {
        table.key(key, true);
        let shown = table
            .instrument
            .controls()
            .iter()
            .any(|control| control.pressed && control.side == Side::South);
        table.wait(for_ms);
        table.key(key, false);
        (shown, table.instrument.drain())
    };
    let south = |action| vec![command(action, Side::South, None)];
    assert_eq!(press(Key::PlayPause, 10), (true, south(Action::Pause)));
    assert_eq!(press(Key::Undo, 10), (true, south(Action::Undo)));
    assert_eq!(
        press(Key::Tool(Tool::Edit), 10),
        (true, south(Action::Tool(Tool::Edit)))
    );
    assert_eq!(
        press(Key::Save, 10),
        (true, vec![Deed::Save { side: Side::South }])
    );
    assert_eq!(press(Key::Faster, 10), (false, south(Action::Speed(1.0))));
    assert_eq!(press(Key::Slower, 10), (false, south(Action::Speed(0.2))));
    assert_eq!(press(Key::StartOver, 1000), (true, vec![]));
    assert_eq!(press(Key::StartOver, 1600), (true, south(Action::StartOver)));
    table.set.clock.history_yr = (0.0, 4e6);
    table.set.clock.elapsed_yr = 1e6;
    table.key(Key::Back, true);
    table.key(Key::Back, false);
    assert_eq!(table.instrument.drain(), south(Action::Scrub(0.8e6)));
    let unattended = InstrumentParams {
        unattended: true,
        ..params()
    };
    table.instrument.set_params(unattended);
    table.key(Key::Save, true);
    table.key(Key::Save, false);
    assert_eq!(table.instrument.drain(), [], "visitors do not save");
}

#[test]
fn controls_wake_near_hands_and_become_quiet_again() {
    let mut table = Table::new();
    let glow = |table: &Table, side| table.control(side, ControlKind::PlayPause).glow;
    table.down(1, LAND);
    table.wait(1000);
    assert!(glow(&table, Side::South) < 0.01);
    table.shift(
        1,
        table.place(Side::South, ControlKind::PlayPause) - DVec2::new(0.0, 40.0),
    );
    table.wait(500);
    assert!(glow(&table, Side::South) > 0.7);
    assert!(glow(&table, Side::North) < 0.01);
    table.up(1);
    table.wait(400);
    let fading = glow(&table, Side::South);
    assert!(fading > 0.3 && fading < 0.7, "{fading}");
    // A frame that comes late does not make them flash.
    table.now_us += 60_000 * MS;
    table.wait(0);
    assert!(glow(&table, Side::South) > 0.3);
    table.wait(10_000);
    assert!(glow(&table, Side::South) < 0.01);
    // The pointer of a mouse wakes them too.
    let at = table.place(Side::North, ControlKind::PlayPause);
    table.instrument.point(Some(at));
    table.wait(500);
    assert!(glow(&table, Side::North) > 0.9);
    table.instrument.point(None);
    table.wait(10_000);
    assert!(glow(&table, Side::North) < 0.01);
}

#[test]
fn controls_are_read_from_their_side() {
    let table = Table::new();
    for control in table.instrument.controls() {
        let expected = if control.side == Side::North {
            std::f64::consts::PI
        } else {
            0.0
        };
        assert_eq!(control.rotation, expected);
        assert_eq!(Side::of(control.centre_mm, SIZE_MM), control.side);
    }
}

fn anywhere() -> impl Strategy<Value = DVec2> {
    let table = (0.0..SIZE_MM.x, 0.0..SIZE_MM.y).prop_map(|(x, y)| DVec2::new(x, y));
    let places: Vec<DVec2> = Instrument::new(params())
        .controls()
        .iter()
        .map(|control| control.centre_mm)
        .collect();
    prop_oneof![table, prop::sample::select(places), Just(DVec2::ONE)]
}

proptest! {
    /// Whatever several fingers do: each keeps its route, and what is the land's gets its end.
    #[test]
    fn no_contact_changes_its_owner(
        steps in prop::collection::vec((0..6_u64, 0..4_u8, anywhere(), 0..400_u64, any::<bool>(), any::<bool>()), 1..80)
    ) {
        let mut table = Table::new();
        table.set.panels = vec![(DVec2::new(100.0, 100.0), DVec2::new(300.0, 300.0))];
        table.set.clock.history_yr = (0.0, 1e6);
        let mut down = std::collections::BTreeMap::new();
        for (id, what, at, ms, paused, in_flight) in steps {
            table.set.clock.paused = paused;
            table.set.in_flight = in_flight;
            table.wait(ms);
            let phase = match (what, down.contains_key(&id)) {
                (_, false) => Phase::Down,
                (0, true) => Phase::Up,
                (1, true) => Phase::Cancel,
                (_, true) => Phase::Move,
            };
                        let route = table.event(phase, contact(id, at));
            prop_assert!(route != Route::Ignored);
            let owner = *down.entry(id).or_insert(route);
            prop_assert_eq!(route, owner);
            if matches!(phase, Phase::Up | Phase::Cancel) {
                down.remove(&id);
            }
            for control in table.instrument.controls() {
                for part in [control.progress, control.value, control.glow] {
                    prop_assert!((0.0..=1.0).contains(&part));
                }
            }
            for deed in table.instrument.drain() {
                if let Deed::Command(Command { action: Action::Scrub(years), .. }) = deed {
                    prop_assert!((0.0..=1e6).contains(&years));
                }
            }
        }
    }
}
