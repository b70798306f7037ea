//! The gesture grammar, rule by rule, in small scenes.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use glam::DVec2;
use orogen::gesture::contact::{MAX_CONTACTS, Phase, Side};
use orogen::gesture::event::HandEvent;
use orogen::gesture::hand::Doing;

use crate::gesture_support::{Table, event, near};

#[test]
fn a_touch_that_leaves_at_once_is_a_tap() {
    let mut table = Table::default();
    table.down(3.0, 1, 300.0, 200.0).up(100.0, 1).until(300.0);
    assert_eq!(table.words(), ["tap 0"]);
    match &table.told[0] {
        (112_000, HandEvent::Tap { side, fingers, .. }) => {
            assert_eq!(*side, Side::North);
            assert_eq!(fingers, &[DVec2::new(300.0, 200.0)]);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_tap_between_two_ticks_is_not_lost() {
    let mut table = Table::default();
    table.down(17.0, 1, 300.0, 600.0).up(31.0, 1).until(32.0);
    assert_eq!(table.words(), ["tap 0"]);
}

#[test]
fn a_tap_within_one_frame_is_not_lost() {
    let mut table = Table::default();
    let both = [
        event(Phase::Down, 1, 300.0, 600.0),
        event(Phase::Up, 1, 300.0, 600.0),
    ];
    table.at(17.0, &both).until(32.0);
    assert_eq!(table.words(), ["tap 0"]);
}

#[test]
fn several_fingers_tap_as_one() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .down(40.0, 2, 350.0, 210.0)
        .up(120.0, 1)
        .up(140.0, 2)
        .until(300.0);
    assert_eq!(table.words(), ["tap 0"]);
    assert!(matches!(&table.told[0].1, HandEvent::Tap { fingers, .. } if fingers.len() == 2));
}

#[test]
fn a_still_hand_rests_after_half_a_second_and_lifts() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .shift(200.0, 1, 302.0, 201.0)
        .until(499.0);
    assert!(table.told.is_empty());
    table.until(512.0);
    assert_eq!(table.words(), ["rest 0"]);
    table.up(900.0, 1).until(1000.0);
    assert_eq!(table.words(), ["rest 0", "lift 0"]);
}

#[test]
fn a_hand_that_rests_tells_it_even_if_it_lifts_before_the_tick() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).up(505.0, 1).until(600.0);
    assert_eq!(table.words(), ["rest 0", "lift 0"]);
}

#[test]
fn a_finger_that_joins_a_resting_hand_widens_its_anchor() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).until(600.0);
    table.down(700.0, 2, 360.0, 200.0).until(800.0);
    let fingers: Vec<usize> = table
        .events()
        .iter()
        .map(|e| match e {
            HandEvent::Rest { fingers, .. } => fingers.len(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(fingers, [1, 2]);
}

#[test]
fn a_drag_pushes_while_it_moves_and_ends_with_the_lift() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .shift(20.0, 1, 303.9, 200.0)
        .until(100.0);
    assert!(table.told.is_empty(), "3.9 mm is no drag");
    table.shift(110.0, 1, 304.0, 200.0).until(112.0);
    assert_eq!(table.words(), ["push 0.0"]);
    table
        .drag(120.0, 400.0, &[(1, (304.0, 200.0), (360.0, 230.0))])
        .up(410.0, 1);
    table.until(500.0);
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    let (starts, ends) = table.last_push(0, 0);
    assert_eq!(starts, [DVec2::new(300.0, 200.0)]);
    assert!(near(ends[0], (360.0, 230.0)));
}

#[test]
fn nothing_is_told_while_nothing_changes() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .shift(50.0, 1, 340.0, 200.0)
        .until(100.0);
    let told = table.told.len();
    table.until(3000.0);
    assert_eq!(table.told.len(), told);
    // Resting after a drag keeps the push standing, and goes on with the same leg.
    table.shift(3010.0, 1, 360.0, 200.0).until(3100.0);
    assert_eq!(table.words(), ["push 0.0"]);
}

#[test]
fn a_resting_hand_that_moves_drags_from_where_it_landed() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .shift(100.0, 1, 302.0, 200.0)
        .until(700.0);
    table.shift(800.0, 1, 330.0, 200.0).until(900.0);
    assert_eq!(table.words(), ["rest 0", "push 0.0"]);
    assert_eq!(table.last_push(0, 0).0, [DVec2::new(300.0, 200.0)]);
}

#[test]
fn two_fingers_turn_their_plate() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).down(10.0, 2, 380.0, 200.0);
    for step in 1..=20 {
        let turn = DVec2::from_angle(f64::from(step) * 0.05) * 40.0;
        let (a, b) = (DVec2::new(340.0, 200.0) - turn, DVec2::new(340.0, 200.0) + turn);
        table.at(
            100.0 + 16.0 * f64::from(step),
            &[event(Phase::Move, 1, a.x, a.y), event(Phase::Move, 2, b.x, b.y)],
        );
    }
    table.finish();
    let fits: Vec<f64> = table
        .events()
        .iter()
        .filter_map(|e| match e {
            HandEvent::Push { fit, .. } => Some(fit.motion.angle),
            _ => None,
        })
        .collect();
    assert!((fits.last().unwrap() - 1.0).abs() < 1e-9, "{fits:?}");
    assert_eq!(table.tracker.stats().splits, 0);
}

#[test]
fn a_late_finger_starts_where_the_plate_carried_it_from() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0);
    table.drag(50.0, 400.0, &[(1, (300.0, 200.0), (350.0, 220.0))]);
    table.down(500.0, 2, 420.0, 260.0).until(520.0);
    let (starts, ends) = table.last_push(0, 0);
    assert!(near(starts[1], (370.0, 240.0)), "{starts:?}");
    assert!(near(ends[1], (420.0, 260.0)));
    // Both go on together.
    table.drag(
        600.0,
        800.0,
        &[
            (1, (350.0, 220.0), (390.0, 220.0)),
            (2, (420.0, 260.0), (460.0, 260.0)),
        ],
    );
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    assert!(near(table.last_push(0, 0).1[1], (460.0, 260.0)));
}

#[test]
fn a_late_finger_keeps_the_turning_point_of_its_leg() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0);
    table.drag(50.0, 400.0, &[(1, (300.0, 200.0), (400.0, 200.0))]);
    table.drag(400.0, 500.0, &[(1, (400.0, 200.0), (385.0, 200.0))]);
    table.down(550.0, 2, 385.0, 260.0);
    table.drag(
        600.0,
        800.0,
        &[
            (1, (385.0, 200.0), (350.0, 200.0)),
            (2, (385.0, 260.0), (350.0, 260.0)),
        ],
    );
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0", "push 0.1", "end 0.1"]);
    let (starts, ends) = table.last_push(0, 0);
    assert!(
        near(starts[1], (300.0, 260.0)) && near(ends[1], (400.0, 260.0)),
        "{starts:?} {ends:?}"
    );
    assert!(near(table.last_push(0, 1).0[1], (400.0, 260.0)));
}

#[test]
fn turning_back_ends_the_leg_at_its_farthest_point() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0);
    table.drag(50.0, 400.0, &[(1, (300.0, 200.0), (400.0, 200.0))]);
    // A quarter of the leg may be taken back.
    table
        .drag(400.0, 500.0, &[(1, (400.0, 200.0), (376.0, 200.0))])
        .until(512.0);
    assert_eq!(table.words(), ["push 0.0"]);
    assert!(
        near(table.last_push(0, 0).1[0], (376.0, 200.0)),
        "smaller retreats shorten the arrow"
    );
    table.drag(512.0, 700.0, &[(1, (376.0, 200.0), (320.0, 200.0))]);
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0", "push 0.1", "end 0.1"]);
    assert!(near(table.last_push(0, 0).1[0], (400.0, 200.0)));
    let (starts, ends) = table.last_push(0, 1);
    assert!(near(starts[0], (400.0, 200.0)) && near(ends[0], (320.0, 200.0)));
}

#[test]
fn rubbing_makes_a_leg_of_each_stroke() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0);
    for i in 0..6 {
        let (a, b) = if i % 2 == 0 {
            (300.0, 340.0)
        } else {
            (340.0, 300.0)
        };
        let t = 50.0 + 100.0 * f64::from(i);
        table.drag(t, t + 100.0, &[(1, (a, 200.0), (b, 200.0))]);
    }
    table.finish();
    assert_eq!(table.tracker.stats().pushes, 6);
}

#[test]
fn small_wiggles_stay_one_leg() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0);
    for i in 0..20 {
        let x = if i % 2 == 0 { 307.0 } else { 293.0 };
        table.shift(50.0 + 30.0 * f64::from(i), 1, x, 200.0);
    }
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
}

#[test]
fn turning_on_the_spot_and_back_is_two_legs() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).down(0.0, 2, 400.0, 200.0);
    for step in 1..=40 {
        let angle = 0.05 * f64::from(if step <= 20 { step } else { 40 - step });
        let turn = DVec2::from_angle(angle) * 50.0;
        let (a, b) = (DVec2::new(350.0, 200.0) - turn, DVec2::new(350.0, 200.0) + turn);
        table.at(
            100.0 + 16.0 * f64::from(step),
            &[event(Phase::Move, 1, a.x, a.y), event(Phase::Move, 2, b.x, b.y)],
        );
    }
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0", "push 0.1", "end 0.1"]);
}

#[test]
fn fingers_that_lift_one_by_one_leave_the_arrow_as_it_is() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).down(5.0, 2, 360.0, 200.0);
    table.drag(
        50.0,
        300.0,
        &[
            (1, (300.0, 200.0), (350.0, 200.0)),
            (2, (360.0, 200.0), (410.0, 200.0)),
        ],
    );
    table.up(310.0, 1).until(400.0);
    assert_eq!(table.words(), ["push 0.0"]);
    table.up(450.0, 2).until(600.0);
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    let (_, ends) = table.last_push(0, 0);
    assert!(near(ends[0], (350.0, 200.0)) && near(ends[1], (410.0, 200.0)));
}

#[test]
fn the_finger_that_stays_carries_the_lifted_one_on() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).down(5.0, 2, 360.0, 200.0);
    table.drag(
        50.0,
        300.0,
        &[
            (1, (300.0, 200.0), (350.0, 200.0)),
            (2, (360.0, 200.0), (410.0, 200.0)),
        ],
    );
    table.up(310.0, 1).until(400.0);
    table.drag(400.0, 600.0, &[(2, (410.0, 200.0), (440.0, 230.0))]);
    table.finish();
    assert_eq!(table.words(), ["push 0.0", "end 0.0"]);
    let (_, ends) = table.last_push(0, 0);
    assert!(
        near(ends[0], (380.0, 230.0)) && near(ends[1], (440.0, 230.0)),
        "{ends:?}"
    );
}

#[test]
fn a_pinch_falls_apart_and_each_finger_pushes_from_where_it_started() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).down(5.0, 2, 420.0, 200.0);
    table.drag(
        50.0,
        400.0,
        &[
            (1, (300.0, 200.0), (340.0, 200.0)),
            (2, (420.0, 200.0), (380.0, 200.0)),
        ],
    );
    table.finish();
    assert_eq!(table.tracker.stats().hands, 2);
    assert_eq!(table.tracker.stats().pushes, 2);
    let (a, b) = (table.last_push(0, 0), table.last_push(1, 0));
    assert!(near(a.0[0], (300.0, 200.0)) && near(a.1[0], (340.0, 200.0)));
    assert!(near(b.0[0], (420.0, 200.0)) && near(b.1[0], (380.0, 200.0)));
}

#[test]
fn a_whole_hand_pinch_is_a_thumb_and_four_fingers() {
    let mut table = Table::default();
    let fingers = [(300.0, 150.0), (335.0, 140.0), (370.0, 145.0), (400.0, 160.0)];
    let mut drags = Vec::new();
    for (i, &(x, y)) in fingers.iter().enumerate() {
        table.down(i as f64, i as u64, x, y);
        drags.push((i as u64, (x, y), (x, y + 40.0)));
    }
    table.down(10.0, 9, 350.0, 290.0);
    drags.push((9, (350.0, 290.0), (350.0, 250.0)));
    table.drag(50.0, 400.0, &drags);
    table.finish();
    let mut sizes: Vec<usize> = [0, 1].map(|hand| table.last_push(hand, 0).0.len()).to_vec();
    sizes.sort_unstable();
    assert_eq!(sizes, [1, 4]);
    assert_eq!(table.tracker.stats().hands, 2);
}

#[test]
fn a_neighbour_who_leaves_takes_only_his_own_finger_along() {
    // One finger anchors, the other, which landed within reach, pushes towards it.
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).until(600.0);
    table.down(700.0, 2, 400.0, 200.0).until(800.0);
    table
        .drag(800.0, 1000.0, &[(2, (400.0, 200.0), (350.0, 200.0))])
        .until(1100.0);
    let hands: Vec<_> = table.tracker.hands().collect();
    assert_eq!(hands.len(), 2);
    assert_eq!(hands[0].doing, Doing::Resting, "the anchor stays the hand it was");
    assert_eq!(hands[0].fingers, [DVec2::new(300.0, 200.0)]);
    assert!(matches!(&hands[1].doing, Doing::Pushing { starts, .. } if near(starts[0], (400.0, 200.0))));
    assert_eq!(table.words(), ["rest 0", "push 1.0"]);
}

#[test]
fn a_common_push_that_falls_apart_stays_with_those_who_moved_most() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0).down(5.0, 2, 360.0, 200.0);
    table.drag(
        50.0,
        200.0,
        &[
            (1, (300.0, 200.0), (310.0, 200.0)),
            (2, (360.0, 200.0), (370.0, 200.0)),
        ],
    );
    table.until(220.0);
    assert_eq!(table.words(), ["push 0.0"]);
    table.drag(
        220.0,
        500.0,
        &[
            (1, (310.0, 200.0), (260.0, 200.0)),
            (2, (370.0, 200.0), (430.0, 200.0)),
        ],
    );
    table.finish();
    assert!(near(table.last_push(0, 0).0[0], (360.0, 200.0)));
    assert_eq!(table.last_push(0, 0).0.len(), 1);
    // The other began where it started, too, and then turned back through it.
    assert!(near(table.last_push(1, 0).0[0], (300.0, 200.0)));
}

#[test]
fn one_slipping_finger_of_five_is_no_drag() {
    let mut table = Table::default();
    for i in 0..5 {
        table.down(0.0, i, 300.0 + 35.0 * i as f64, 200.0);
    }
    table
        .drag(600.0, 700.0, &[(4, (440.0, 200.0), (445.0, 205.0))])
        .until(1000.0);
    assert_eq!(table.words(), ["rest 0"]);
}

#[test]
fn far_hands_are_two_and_answer_for_their_own_side() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 100.0).down(0.0, 2, 300.0, 600.0);
    table.drag(
        50.0,
        300.0,
        &[
            (1, (300.0, 100.0), (300.0, 200.0)),
            (2, (300.0, 600.0), (300.0, 500.0)),
        ],
    );
    let sides: Vec<Side> = table.tracker.hands().map(|h| h.side).collect();
    assert_eq!(sides, [Side::North, Side::South]);
    table.finish();
    assert_eq!(table.tracker.stats().pushes, 2);
}

#[test]
fn a_finger_after_the_joining_time_joins_only_within_reach() {
    let count = |ms: f64, x: f64| {
        let mut table = Table::default();
        table
            .down(0.0, 1, 300.0, 200.0)
            .down(ms, 2, x, 200.0)
            .until(ms + 20.0);
        table.tracker.hands().count()
    };
    assert_eq!(count(140.0, 480.0), 1);
    assert_eq!(count(160.0, 480.0), 2);
    assert_eq!(count(160.0, 410.0), 1);
    assert_eq!(count(140.0, 510.0), 2);
}

#[test]
fn a_sixth_finger_is_another_hand() {
    let mut table = Table::default();
    for i in 0..6 {
        table.down(i as f64, i, 300.0 + 30.0 * i as f64, 200.0);
    }
    table.until(50.0);
    let mut fingers: Vec<usize> = table.tracker.hands().map(|h| h.fingers.len()).collect();
    fingers.sort_unstable();
    assert_eq!(fingers, [1, 5]);
}

#[test]
fn nobody_joins_a_hand_that_is_leaving() {
    let mut table = Table::default();
    table.down(0.0, 1, 300.0, 200.0);
    table.drag(50.0, 300.0, &[(1, (300.0, 200.0), (350.0, 200.0))]);
    table.up(310.0, 1).down(330.0, 2, 400.0, 200.0).until(340.0);
    assert_eq!(table.tracker.hands().count(), 2);
}

#[test]
fn drumming_never_piles_up_more_than_five_fingers() {
    let mut table = Table::default();
    for i in 0..60_u64 {
        let t = 40.0 * i as f64;
        table.down(t, i, 300.0 + 25.0 * (i % 5) as f64, 200.0);
        if i > 0 {
            table.up(t + 10.0, i - 1);
        }
    }
    table.finish();
    let words = table.words();
    assert!(
        words.contains(&"rest 0".to_owned()) && words.contains(&"lift 0".to_owned()),
        "{words:?}"
    );
}

#[test]
fn all_contacts_at_once_become_hands() {
    let mut table = Table::default();
    let downs: Vec<_> = (0..MAX_CONTACTS as u64 + 3)
        .map(|i| {
            event(
                Phase::Down,
                i,
                20.0 + 70.0 * (i % 17) as f64,
                20.0 + 40.0 * (i / 17) as f64,
            )
        })
        .collect();
    table.at(5.0, &downs).until(600.0);
    let stats = table.tracker.stats();
    assert_eq!((stats.total, stats.over_cap), (256, 3));
    let fingers: usize = table.tracker.hands().map(|h| h.fingers.len()).sum();
    assert_eq!(fingers, 256);
    table.finish();
}

#[test]
fn unknown_contacts_are_ignored_and_counted() {
    let mut table = Table::default();
    table
        .shift(0.0, 7, 1.0, 1.0)
        .up(5.0, 7)
        .cancel(6.0, 8)
        .down(7.0, 9, f64::NAN, 3.0);
    table
        .down(10.0, 1, 300.0, 200.0)
        .shift(12.0, 1, f64::INFINITY, 200.0)
        .shift(13.0, 1, 3e4, 0.0);
    table.up(100.0, 1).until(200.0);
    assert_eq!(table.tracker.stats().ignored, 6);
    assert_eq!(table.words(), ["tap 0"]);
}

#[test]
fn a_second_down_cancels_the_first() {
    let mut table = Table::default();
    table
        .down(0.0, 1, 300.0, 200.0)
        .down(50.0, 1, 700.0, 400.0)
        .until(64.0);
    assert_eq!(table.tracker.stats().doubled, 1);
    let hands: Vec<_> = table.tracker.hands().collect();
    assert_eq!(hands.len(), 1);
    assert_eq!(hands[0].fingers, [DVec2::new(700.0, 400.0)]);
    table.up(100.0, 1).until(200.0);
    assert_eq!(table.words(), ["tap 1"]);
}

#[test]
fn time_that_runs_back_is_taken_as_now() {
    let mut table = Table::default();
    table.down(100.0, 1, 300.0, 200.0).until(200.0);
    table.tracker.feed(&orogen::gesture::contact::InputFrame {
        t_us: 50_000,
        events: vec![event(Phase::Move, 1, 350.0, 200.0)],
        commands: Vec::new(),
    });
    table.until(220.0);
    assert_eq!(table.words(), ["push 0.0"]);
}
