//! Palms, sleeves, ghosts, flicker, stuck and withdrawn contacts.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use glam::DVec2;
use orogen::gesture::contact::{ContactEvent, Phase};
use orogen::gesture::event::HandEvent;
use orogen::gesture::stroke::Role;

use crate::gesture_support::{Table, event, key, near, with_confidence, with_size};

fn down(id: u64, x: f64, y: f64) -> ContactEvent {
    event(Phase::Down, id, x, y)
}

fn shift(id: u64, x: f64, y: f64) -> ContactEvent {
    event(Phase::Move, id, x, y)
}

/// The retractions told: contacts, time of the first thing they did.
fn retractions(table: &Table) -> Vec<(Vec<u64>, u64)> {
    table
        .events()
        .iter()
        .filter_map(|e| match e {
            HandEvent::Retract { contacts, since_us } => {
                Some((contacts.iter().map(|key| key.id).collect(), *since_us))
            }
            _ => None,
        })
        .collect()
}

#[test]
fn palms_and_sleeves_never_start_a_stroke() {
    let mut table = Table::default();
    table.at(0.0, &[with_confidence(down(1, 300.0, 200.0), 0.0)]);
    table.at(0.0, &[with_size(down(2, 500.0, 200.0), 12.0, 25.1)]);
    table.at(100.0, &[shift(1, 400.0, 200.0), shift(2, 600.0, 200.0)]);
    let roles: Vec<Role> = table.until(112.0).tracker.contacts().map(|c| c.1).collect();
    assert_eq!(roles, [Role::Ghost, Role::Ghost], "they can be shown");
    // The device changes its mind: it stays what it began as.
    table.at(200.0, &[with_confidence(shift(1, 500.0, 200.0), 1.0)]);
    table.up(800.0, 1).up(800.0, 2).until(900.0);
    assert!(table.told.is_empty());
    assert_eq!(table.tracker.stats().dropped_ghosts, 2);
    assert_eq!(table.tracker.stats().total, 2);
}

#[test]
fn a_fingertip_with_size_and_confidence_is_a_finger() {
    let mut table = Table::default();
    table.at(
        0.0,
        &[with_confidence(with_size(down(1, 300.0, 200.0), 25.0, 25.0), 0.5)],
    );
    table.up(100.0, 1).until(200.0);
    assert_eq!(table.words(), ["tap 0"]);
}

#[test]
fn a_finger_beside_its_palm_still_acts() {
    let mut table = Table::default();
    table.at(
        0.0,
        &[
            down(1, 300.0, 200.0),
            with_size(down(2, 330.0, 280.0), 60.0, 50.0),
        ],
    );
    table.drag(
        50.0,
        200.0,
        &[
            (1, (300.0, 200.0), (340.0, 200.0)),
            (2, (330.0, 280.0), (370.0, 280.0)),
        ],
    );
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    assert_eq!(table.last_push(0, 0).0.len(), 1);
}

#[test]
fn evidence_before_anything_happened_drops_silently() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0);
    table.at(400.0, &[with_size(shift(1, 300.0, 200.0), 40.0, 40.0)]);
    table.until(700.0);
    assert!(table.told.is_empty());
    assert_eq!(table.tracker.hands().count(), 0);
    let stats = table.tracker.stats();
    assert_eq!((stats.dropped_ghosts, stats.retracted), (1, 0));
}

#[test]
fn evidence_within_the_revision_time_takes_back_what_was_done() {
    let mut table = Table::default();
    table.down(10.0, 1, 300.0, 200.0).shift(60.0, 1, 320.0, 200.0);
    table.at(260.0, &[with_confidence(shift(1, 330.0, 200.0), 0.0)]);
    table.until(300.0);
    assert_eq!(table.words(), ["push 0.0", "retract"]);
    assert_eq!(retractions(&table), [(vec![1], 10_000)]);
    table.shift(310.0, 1, 400.0, 200.0).up(400.0, 1).finish();
    assert_eq!(
        table.words(),
        ["push 0.0", "retract"],
        "it acts on nothing any more"
    );
    let stats = table.tracker.stats();
    assert_eq!((stats.dropped_ghosts, stats.retracted), (1, 1));
}

#[test]
fn evidence_after_the_revision_time_comes_too_late() {
    let mut table = Table::default();
    table.down(10.0, 1, 300.0, 200.0).shift(60.0, 1, 320.0, 200.0);
    table.at(261.0, &[with_confidence(shift(1, 330.0, 200.0), 0.0)]);
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    assert!(near(table.last_push(0, 0).1[0], (330.0, 200.0)));
}

#[test]
fn retracting_one_finger_leaves_the_others_pushing() {
    let mut table = Table::default();
    table.at(0.0, &[down(1, 300.0, 200.0), down(2, 360.0, 200.0)]);
    table.at(50.0, &[shift(1, 320.0, 200.0), shift(2, 380.0, 200.0)]);
    table
        .at(100.0, &[with_size(shift(2, 380.0, 200.0), 50.0, 30.0)])
        .until(112.0);
    assert_eq!(table.words(), ["push 0.0", "retract", "push 0.0"]);
    assert_eq!(table.last_push(0, 0).0, [DVec2::new(300.0, 200.0)]);
    table.finish();
    assert_eq!(table.words().last().unwrap(), "end 0.0");
}

#[test]
fn a_rewound_tracker_with_the_ban_acts_as_if_the_contact_had_been_a_palm() {
    let script = |table: &mut Table| {
        table.at(10.0, &[down(1, 300.0, 200.0), down(2, 350.0, 230.0)]);
        table.drag(
            50.0,
            150.0,
            &[
                (1, (300.0, 200.0), (330.0, 200.0)),
                (2, (350.0, 230.0), (380.0, 230.0)),
            ],
        );
        table.at(200.0, &[with_confidence(shift(2, 380.0, 230.0), 0.0)]);
        table
            .shift(300.0, 1, 345.0, 200.0)
            .up(400.0, 1)
            .up(420.0, 2)
            .until(600.0);
    };
    let mut first = Table::default();
    script(&mut first);
    assert_eq!(retractions(&first), [(vec![2], 10_000)]);

    let mut again = Table::default();
    again.tracker.ban(key(2));
    script(&mut again);
    assert!(retractions(&again).is_empty());
    assert_eq!(
        again.tracker.stats().retracted,
        1,
        "rewinding does not lose the count"
    );
    assert_eq!(again.tracker.stats().dropped_ghosts, 1);

    let mut alone = Table::default();
    alone.at(10.0, &[down(1, 300.0, 200.0)]);
    alone.drag(50.0, 150.0, &[(1, (300.0, 200.0), (330.0, 200.0))]);
    alone.shift(300.0, 1, 345.0, 200.0).up(400.0, 1).until(600.0);
    assert_eq!(again.last_push(0, 0), alone.last_push(0, 0));
    assert_eq!(again.words(), alone.words());
}

#[test]
fn banning_a_contact_that_is_down_drops_it_without_a_retraction() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .shift(50.0, 1, 330.0, 200.0)
        .until(64.0);
    table.tracker.ban(key(1));
    table.shift(80.0, 1, 360.0, 200.0).up(100.0, 1).finish();
    assert_eq!(table.words(), ["push 0.0"]);
}

#[test]
fn a_cancel_soon_after_the_down_takes_everything_back() {
    let mut table = Table::default();
    table.at(
        0.0,
        &[
            down(1, 300.0, 200.0),
            down(2, 800.0, 200.0),
            down(3, 1000.0, 500.0),
        ],
    );
    table.at(50.0, &[shift(1, 330.0, 200.0), shift(2, 830.0, 200.0)]);
    let all = [1, 2, 3].map(|id| event(Phase::Cancel, id, 0.0, 0.0));
    table.at(250.0, &all).until(300.0);
    assert_eq!(
        retractions(&table),
        [(vec![1, 2], 0)],
        "the third had done nothing"
    );
    assert_eq!(table.tracker.hands().count(), 0);
    assert_eq!(table.tracker.stats().dropped_ghosts, 3);
}

#[test]
fn a_later_cancel_ends_like_a_lift() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .shift(50.0, 1, 330.0, 200.0)
        .cancel(251.0, 1)
        .until(300.0);
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).cancel(700.0, 1).until(800.0);
    assert_eq!(table.words(), ["rest 0", "lift 0"]);
}

#[test]
fn a_cancelled_touch_is_no_tap() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).cancel(300.0, 1).until(500.0);
    assert!(table.told.is_empty());
}

#[test]
fn a_flicker_goes_on_with_the_same_stroke() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .drag(20.0, 200.0, &[(1, (300.0, 200.0), (360.0, 200.0))]);
    table.up(210.0, 1).down(260.0, 2, 369.0, 200.0);
    table.drag(270.0, 400.0, &[(2, (369.0, 200.0), (420.0, 200.0))]);
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    assert!(near(table.last_push(0, 0).1[0], (420.0, 200.0)));
    let stats = table.tracker.stats();
    assert_eq!((stats.bridged, stats.hands, stats.total), (1, 1, 2));
}

#[test]
fn a_down_that_is_later_or_farther_is_another_stroke() {
    for (ms, x) in [(261.0, 360.0), (250.0, 370.1)] {
        let mut table = Table::default();
        table
            .down(0.0, 1, 300.0, 200.0)
            .drag(20.0, 200.0, &[(1, (300.0, 200.0), (360.0, 200.0))]);
        table.up(210.0, 1).down(ms, 2, x, 200.0).until(400.0);
        assert_eq!(table.tracker.stats().bridged, 0, "{ms} {x}");
        assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    }
}

#[test]
fn two_quick_taps_are_two_taps() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .up(60.0, 1)
        .down(100.0, 2, 301.0, 200.0)
        .up(160.0, 2)
        .until(300.0);
    assert_eq!(table.words(), ["tap 0", "tap 1"]);
}

/// A contact that is down for `on_ms` and away for `off_ms`, again and again, around one place.
fn flickering(on_ms: f64, off_ms: f64, wander_mm: f64) -> Table {
    let mut table = Table::default();
    for i in 0..12_u32 {
        let (from, id) = (f64::from(i) * (on_ms + off_ms), u64::from(i));
        let x = 300.0 + wander_mm * f64::from(i % 2);
        table.down(from, id, x, 200.0).up(from + on_ms, id);
    }
    table.until(3_000.0);
    table
}

#[test]
fn what_flickers_around_one_place_is_a_palm() {
    let table = flickering(60.0, 30.0, 8.0);
    assert_eq!(table.words(), ["tap 0", "tap 1", "tap 2"]);
    assert_eq!(table.tracker.stats().dropped_ghosts, 9);
    // As fast as a finger can drum, with another way to be slow: long gaps, long contacts, or places apart.
    for (on_ms, off_ms, wander_mm) in [(60.0, 66.0, 1.0), (260.0, 30.0, 1.0), (60.0, 30.0, 12.0)] {
        let table = flickering(on_ms, off_ms, wander_mm);
        assert_eq!(
            table.tracker.stats().dropped_ghosts,
            0,
            "{on_ms} {off_ms} {wander_mm}"
        );
    }
}

#[test]
fn where_a_palm_flickered_a_finger_can_land_a_moment_later() {
    let mut table = flickering(60.0, 30.0, 2.0);
    let before = table.words().len();
    // The last one lifted at 1050 ms.
    table
        .down(3_100.0, 50, 301.0, 200.0)
        .up(3_200.0, 50)
        .until(3_300.0);
    assert_eq!(table.words().len(), before + 1);
    let mut table = Table::default();
    for i in 0..6_u32 {
        let from = f64::from(i) * 90.0;
        table
            .down(from, u64::from(i), 300.0, 200.0)
            .up(from + 60.0, u64::from(i));
    }
    // Long after the last tap, but the palm was there all the time.
    table
        .down(530.0, 10, 303.0, 200.0)
        .up(900.0, 10)
        .down(930.0, 11, 301.0, 200.0)
        .up(960.0, 11);
    table.down(960.0, 12, 900.0, 400.0).up(1_100.0, 12).until(1_400.0);
    assert_eq!(
        table.words(),
        ["tap 0", "tap 1", "tap 2", "tap 3"],
        "the fourth is elsewhere"
    );
    assert_eq!(table.tracker.stats().dropped_ghosts, 5);
}

#[test]
fn a_flickering_contact_is_taken_back_whole() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .shift(40.0, 1, 330.0, 200.0)
        .up(60.0, 1)
        .down(90.0, 2, 332.0, 200.0);
    table
        .at(150.0, &[with_confidence(shift(2, 333.0, 200.0), 0.0)])
        .until(200.0);
    assert_eq!(retractions(&table), [(vec![1, 2], 0)]);
    assert_eq!(table.tracker.stats().retracted, 2);
}

#[test]
fn a_short_touch_that_changes_its_size_is_a_ghost() {
    let ghost = |sizes: [f64; 2], up_ms: f64, x: f64| {
        let mut table = Table::default();
        table.at(0.0, &[with_size(down(1, 300.0, 200.0), sizes[0], 5.0)]);
        table.at(20.0, &[with_size(shift(1, x, 200.0), sizes[1], 5.0)]);
        table.up(up_ms, 1).until(200.0);
        let stats = table.tracker.stats();
        assert_eq!(stats.dropped_ghosts + stats.taps, 1);
        stats.dropped_ghosts == 1
    };
    assert!(ghost([8.0, 14.0], 50.0, 300.0));
    assert!(!ghost([8.0, 9.0], 50.0, 300.0), "size as good as constant");
    assert!(!ghost([8.0, 14.0], 60.0, 300.0), "long enough");
    assert!(!ghost([8.0, 14.0], 50.0, 302.0), "it moved");
}

#[test]
fn a_stuck_contact_fades_out_while_others_move() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).down(18_000.0, 2, 900.0, 500.0);
    table
        .drag(18_200.0, 19_500.0, &[(2, (900.0, 500.0), (960.0, 500.0))])
        .until(20_000.0);
    assert_eq!(table.words(), ["rest 0", "push 1.0"]);
    table.until(20_016.0);
    assert_eq!(table.words(), ["rest 0", "push 1.0", "lift 0"]);
    assert_eq!(table.tracker.stats().stuck, 1);
    let roles: Vec<Role> = table.tracker.contacts().map(|c| c.1).collect();
    assert_eq!(roles[0], Role::Stuck);
    // It acts on nothing when it moves at last, and its lift is nothing.
    table.shift(21_000.0, 1, 400.0, 200.0).up(21_100.0, 1).finish();
    assert_eq!(table.words(), ["rest 0", "push 1.0", "lift 0", "end 1.0"]);
}

#[test]
fn a_still_hand_alone_is_not_stuck() {
    let mut table = Table::default();
    table
        .down(0.0, 2, 900.0, 500.0)
        .shift(1.0, 2, 901.0, 500.0)
        .up(2.0, 2);
    table.down(10.0, 1, 300.0, 200.0).until(60_000.0);
    assert_eq!(table.tracker.stats().stuck, 0);
    assert_eq!(table.tracker.hands().count(), 1);
}

#[test]
fn a_hand_that_trembles_is_not_stuck() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).down(0.0, 2, 900.0, 500.0);
    for i in 1..300 {
        let t = 100.0 * f64::from(i);
        table.at(
            t,
            &[
                shift(1, 300.0 + 0.01 * f64::from(i % 2), 200.0),
                shift(2, 900.0 + f64::from(i % 3), 500.0),
            ],
        );
    }
    assert_eq!(table.tracker.stats().stuck, 0);
}
