//! What hands are for: pushes that a person means.

use glam::DVec2;

use super::Scene;
use super::hand::{five, three, toward};
use super::show::{Finger, Push, Pushed, Show};

pub(super) const SCENES: [Scene; 12] = [
    ("one_finger_push", one_finger_push),
    ("two_hands_push", two_hands_push),
    ("hand_rests_other_pushes", hand_rests_other_pushes),
    ("oblique_push", oblique_push),
    ("twisting_hand", twisting_hand),
    ("pull_apart", pull_apart),
    ("three_plates", three_plates),
    ("four_visitors", four_visitors),
    ("slow_and_fast", slow_and_fast),
    ("late_finger", late_finger),
    ("ten_fingers", ten_fingers),
    ("finished_range_eroding", finished_range_eroding),
];

/// Where land rises before a push that nothing meets, mm ahead of its foremost finger: beyond the ground that moves
/// with it.
pub(super) const AHEAD_MM: f64 = 85.0;

const UP: DVec2 = DVec2::new(0.0, -1.0);
const DOWN: DVec2 = DVec2::new(0.0, 1.0);
const LEFT: DVec2 = DVec2::new(-1.0, 0.0);
const RIGHT: DVec2 = DVec2::new(1.0, 0.0);

/// A push straight on.
pub(super) fn straight(from_ms: f64, for_ms: f64, at: (f64, f64), by: DVec2) -> Push {
    Push {
        from_ms,
        for_ms,
        at: DVec2::from(at),
        by,
        turn_deg: 0.0,
    }
}

/// One finger pushes.
pub(super) fn push_finger(show: &mut Show, push: Push) -> Pushed {
    show.push(&[DVec2::ZERO], push)
}

/// The land rises before the push.
pub(super) fn rises(show: &mut Show, pushed: &Pushed) {
    show.changes(pushed.ahead(AHEAD_MM), pushed.end_ms);
}

fn one_finger_push() -> Show {
    let mut show = Show::new(
        "one finger pushes",
        "A short range rises across the way of the finger, and the land far from it stays as it is.",
    );
    let pushed = push_finger(&mut show, straight(160.0, 1100.0, (520.0, 360.0), RIGHT * 100.0));
    rises(&mut show, &pushed);
    show
}

fn two_hands_push() -> Show {
    let mut show = Show::new(
        "two hands push",
        "A wide range strikes north-south between the hands, slightly curved, highest before the moving hand.",
    );
    show.world(5e6, 60_000);
    // 330 mm, 48 km, are left between the hands.
    show.rest(&five(RIGHT, 184.0), DVec2::new(412.0, 363.0), 160.0, 4400.0);
    let pushed = show.push(
        &five(LEFT, 184.0),
        Push {
            from_ms: 900.0,
            for_ms: 2400.0,
            at: DVec2::new(916.0, 363.0),
            by: DVec2::new(-130.0, -4.0),
            turn_deg: 5.0,
        },
    );
    show.changes(DVec2::new(588.0, 350.0), pushed.end_ms);
    show
}

fn hand_rests_other_pushes() -> Show {
    let mut show = Show::new(
        "a hand rests, the other comes towards it",
        "The range rises before the hand that comes, and the ground under the hand that rests stays flat.",
    );
    show.rest(&five(DOWN, 160.0), DVec2::new(590.0, 165.0), 160.0, 3600.0);
    let pushed = show.push(
        &five(UP, 160.0),
        straight(1000.0, 1600.0, (610.0, 540.0), UP * 95.0),
    );
    show.changes(DVec2::new(603.0, 298.0), pushed.end_ms);
    show
}

fn oblique_push() -> Show {
    let mut show = Show::new(
        "an oblique push",
        "The range stands askew to the way of the hand: it is pushed 35° past the hand that rests.",
    );
    show.rest(&five(RIGHT, 150.0), DVec2::new(380.0, 330.0), 160.0, 3800.0);
    let pushed = show.push(
        &five(LEFT, 150.0),
        straight(900.0, 1800.0, (830.0, 430.0), toward(180.0 + 35.0) * 115.0),
    );
    show.changes(DVec2::new(550.0, 305.0), pushed.end_ms);
    show
}

fn twisting_hand() -> Show {
    let mut show = Show::new(
        "a hand twists",
        "Land is heaped up before the thumb and before the little finger, on opposite sides of the hand.",
    );
    let (at, turn_deg) = (DVec2::new(600.0, 363.0), 60.0_f64);
    let twisted = show.push(
        &five(LEFT, 184.0),
        Push {
            from_ms: 160.0,
            for_ms: 1500.0,
            at,
            by: DVec2::ZERO,
            turn_deg,
        },
    );
    // Before the thumb and the little finger, at right angles to the arms they swing on.
    for end in [-1.0, 1.0] {
        let arm = toward(90.0 + turn_deg) * end;
        show.changes(at + arm * 92.0 + arm.perp() * 85.0, twisted.end_ms);
    }
    show
}

fn pull_apart() -> Show {
    let mut show = Show::new(
        "two hands pull apart",
        "A rift basin sinks between the hands, and water gathers in it; a range rises before each hand.",
    );
    let left = show.push(
        &five(RIGHT, 150.0),
        straight(160.0, 2200.0, (480.0, 355.0), LEFT * 95.0),
    );
    let right = show.push(
        &five(LEFT, 150.0),
        straight(240.0, 2200.0, (735.0, 355.0), RIGHT * 95.0),
    );
    show.changes(DVec2::new(607.0, 355.0), left.end_ms.max(right.end_ms));
    for pushed in [&left, &right] {
        rises(&mut show, pushed);
    }
    show
}

fn three_plates() -> Show {
    let mut show = Show::new(
        "three hands, three plates",
        "Three ranges meet where the three hands push towards one point.",
    );
    let middle = DVec2::new(605.0, 350.0);
    for (i, deg) in [(0.0, 270.0), (1.0, 30.0), (2.0, 150.0)] {
        let out = toward(deg);
        let push = Push {
            from_ms: 160.0 + 96.0 * i,
            for_ms: 1900.0,
            at: middle + out * 205.0,
            by: out * -75.0,
            turn_deg: 0.0,
        };
        let pushed = show.push(&five(-out, 125.0), push);
        show.changes(pushed.ahead(50.0), pushed.end_ms);
    }
    show
}

fn four_visitors() -> Show {
    let mut show = Show::new(
        "four visitors at once",
        "Land rises before each of the four hands; no visitor waits for another.",
    );
    let visitors = [
        (160.0, (190.0, 190.0), 20.0),
        (420.0, (1020.0, 185.0), 160.0),
        (700.0, (195.0, 500.0), -20.0),
        (930.0, (1015.0, 505.0), 200.0),
    ];
    for (from_ms, at, deg) in visitors {
        let along = toward(deg);
        let pushed = show.push(&five(along, 140.0), straight(from_ms, 1700.0, at, along * 100.0));
        rises(&mut show, &pushed);
    }
    show
}

fn slow_and_fast() -> Show {
    let mut show = Show::new(
        "a slow finger and a fast one",
        "Two alike ranges side by side: how far a finger goes counts, not how fast.",
    );
    let slow = push_finger(&mut show, straight(160.0, 4200.0, (330.0, 470.0), UP * 95.0));
    let fast = push_finger(&mut show, straight(2900.0, 240.0, (880.0, 470.0), UP * 95.0));
    rises(&mut show, &fast);
    rises(&mut show, &slow);
    show
}

fn late_finger() -> Show {
    let mut show = Show::new(
        "two fingers land late",
        "One wide range: the fingers that land on the way belong to the hand that pushes.",
    );
    let shape = five(UP, 160.0);
    let push = straight(160.0, 2000.0, (600.0, 500.0), UP * 105.0);
    let (poses, pushed) = push.poses(&shape);
    for (offset, late_ms) in shape.into_iter().zip([900.0, 0.0, 0.0, 16.0, 1300.0]) {
        let mut finger = Finger::new(poses.clone());
        finger.offset = offset;
        finger.lands_ms += late_ms;
        show.finger(finger);
    }
    rises(&mut show, &pushed);
    show
}

fn ten_fingers() -> Show {
    let mut show = Show::new(
        "ten fingers side by side",
        "Two ranges side by side, one before each hand of one visitor.",
    );
    for (x, from_ms) in [(455.0, 160.0), (735.0, 192.0)] {
        let pushed = show.push(
            &five(UP, 160.0),
            straight(from_ms, 1500.0, (x, 515.0), UP * 100.0),
        );
        rises(&mut show, &pushed);
    }
    show
}

fn finished_range_eroding() -> Show {
    let mut show = Show::new(
        "a finished range wears down",
        "Three million years after the push is spent the range is low, its valleys are wide, and rivers cross it.",
    );
    show.world(8e6, 60_000);
    show.rest(&five(RIGHT, 160.0), DVec2::new(400.0, 350.0), 160.0, 2900.0);
    let pushed = show.push(
        &three(LEFT, 130.0),
        straight(900.0, 1300.0, (850.0, 345.0), LEFT * 100.0),
    );
    show.changes(DVec2::new(580.0, 345.0), pushed.end_ms);
    show
}
