//! What visitors do to whom nobody explained anything.

use glam::DVec2;

use super::Scene;
use super::expected::{AHEAD_MM, push_finger, rises, straight};
use super::hand::{five, pose, through, toward};
use super::show::{Finger, Show};

pub(super) const SCENES: [Scene; 9] = [
    ("drumming", drumming),
    ("rubbing", rubbing),
    ("slapping", slapping),
    ("writing_a_name", writing_a_name),
    ("pulling_towards_oneself", pulling_towards_oneself),
    ("two_equal_pushes", two_equal_pushes),
    ("pinch_and_spread", pinch_and_spread),
    ("neighbour_leaning_in", neighbour_leaning_in),
    ("same_push_again", same_push_again),
];

const UP: DVec2 = DVec2::new(0.0, -1.0);
const DOWN: DVec2 = DVec2::new(0.0, 1.0);
const LEFT: DVec2 = DVec2::new(-1.0, 0.0);
const RIGHT: DVec2 = DVec2::new(1.0, 0.0);

fn drumming() -> Show {
    let mut show = Show::new("drumming fingers", "Small domes stand where the fingers drum.");
    show.world(4e5, 60_000);
    let middle = DVec2::new(600.0, 340.0);
    let fingers: Vec<DVec2> = five(UP, 170.0).into_iter().skip(1).map(|f| middle + f).collect();
    // From the little finger to the index finger, again and again.
    let mut t_ms = 160.0;
    for round in 0..4 {
        for at in fingers.iter().rev() {
            show.finger(Finger::new(vec![
                pose(t_ms, at.x, at.y),
                pose(t_ms + 80.0, at.x, at.y),
            ]));
            if round == 3 {
                show.changes(*at, t_ms + 80.0);
            }
            t_ms += 112.0;
        }
        t_ms += 160.0;
    }
    show
}

fn rubbing() -> Show {
    let mut show = Show::new(
        "rubbing to and fro",
        "Land rises before both turning points, most before the last: each way is a push of its own.",
    );
    let corners: Vec<(f64, f64)> = (0..8).map(|i| (560.0 + 90.0 * f64::from(i % 2), 330.0)).collect();
    show.finger(Finger::new(through(160.0, 360.0, &corners)));
    let end_ms = 160.0 + 7.0 * 360.0;
    show.changes(DVec2::new(650.0 + AHEAD_MM, 330.0), end_ms);
    show.changes(DVec2::new(560.0 - AHEAD_MM, 330.0), end_ms);
    show
}

fn slapping() -> Show {
    let mut show = Show::new(
        "slapping the table",
        "Each slap raises a dome under each finger, and none under the ball of the hand.",
    );
    show.world(4e5, 60_000);
    for (i, at) in [(0.0, DVec2::new(430.0, 350.0)), (1.0, DVec2::new(780.0, 330.0))] {
        let from_ms = 160.0 + 900.0 * i;
        for offset in five(UP, 165.0) {
            let at = at + offset;
            let mut finger = Finger::new(vec![pose(from_ms, at.x, at.y), pose(from_ms + 112.0, at.x, at.y)]);
            finger.sizes = vec![(from_ms, DVec2::new(13.0, 16.0))];
            show.finger(finger);
            show.changes(at, from_ms + 112.0);
        }
        let ball = at + DOWN * 95.0;
        let mut palm = Finger::new(vec![
            pose(from_ms + 16.0, ball.x, ball.y),
            pose(from_ms + 128.0, ball.x, ball.y),
        ]);
        palm.sizes = vec![(from_ms, DVec2::new(78.0, 52.0))];
        show.finger(palm);
    }
    show
}

fn writing_a_name() -> Show {
    let mut show = Show::new(
        "writing a name",
        "Land rises before the ends of the strokes of the name MIA.",
    );
    let strokes: [&[(f64, f64)]; 4] = [
        &[
            (380.0, 410.0),
            (385.0, 280.0),
            (435.0, 375.0),
            (485.0, 280.0),
            (490.0, 410.0),
        ],
        &[(575.0, 280.0), (575.0, 410.0)],
        &[(660.0, 410.0), (715.0, 280.0), (770.0, 410.0)],
        &[(685.0, 365.0), (750.0, 365.0)],
    ];
    let mut t_ms = 160.0;
    for stroke in strokes {
        let poses = through(t_ms, 320.0, stroke);
        if let [.., before, last] = poses.as_slice() {
            let along = (last.at - before.at).normalize();
            // The bar of the A lies on ground that has just moved: it joins what the letter raised.
            if stroke.len() > 2 || along == DOWN {
                show.changes(last.at + along * AHEAD_MM, last.t_ms);
            }
            t_ms = last.t_ms + 300.0;
        }
        show.finger(Finger::new(poses));
    }
    show
}

fn pulling_towards_oneself() -> Show {
    let mut show = Show::new(
        "pulling the land towards oneself",
        "A range rises on the near side of the hand.",
    );
    let push = straight(160.0, 1200.0, (600.0, 290.0), DOWN * 130.0);
    let pulled = show.push(&five(UP, 140.0), push);
    rises(&mut show, &pulled);
    show
}

fn two_equal_pushes() -> Show {
    let mut show = Show::new(
        "two equal pushes against each other",
        "One range rises half-way between the hands.",
    );
    for (x, toward) in [(375.0, RIGHT), (835.0, LEFT)] {
        let push = straight(160.0, 1600.0, (x, 350.0), toward * 75.0);
        let pushed = show.push(&five(toward, 150.0), push);
        // Half-way, a little to either side.
        show.changes(DVec2::new(605.0, 345.0) - toward * 20.0, pushed.end_ms);
    }
    show
}

fn pinch_and_spread() -> Show {
    let mut show = Show::new(
        "pinching, then spreading",
        "A short range rises between the fingers that pinch; a small rift opens between those that spread.",
    );
    let mut pair = |x: f64, from_ms: f64, apart: f64, then: f64| {
        for (side, y) in [(-1.0, 338.0), (1.0, 352.0)] {
            let at = |apart: f64| x + side * apart / 2.0;
            show.finger(Finger::new(vec![
                pose(from_ms, at(apart), y),
                pose(from_ms + 112.0, at(apart), y),
                pose(from_ms + 900.0, at(then), y),
                pose(from_ms + 1050.0, at(then), y),
            ]));
        }
        show.changes(DVec2::new(x, 345.0), from_ms + 900.0);
    };
    pair(400.0, 160.0, 180.0, 85.0);
    pair(820.0, 1900.0, 75.0, 185.0);
    show
}

fn neighbour_leaning_in() -> Show {
    let mut show = Show::new(
        "a neighbour leans in",
        "One range, before the hand that pushes: the palm and the arm on the edge of the table do nothing.",
    );
    let push = straight(900.0, 1500.0, (720.0, 350.0), LEFT * 105.0);
    let pushed = show.push(&five(LEFT, 150.0), push);
    let mut palm = Finger::new(vec![
        pose(160.0, 330.0, 655.0),
        pose(1000.0, 330.0, 655.0),
        pose(2300.0, 372.0, 648.0),
        pose(3400.0, 372.0, 648.0),
    ]);
    palm.confidence = Some(0.0);
    show.finger(palm);
    let mut arm = Finger::new(vec![
        pose(240.0, 452.0, 668.0),
        pose(900.0, 452.0, 668.0),
        pose(2100.0, 500.0, 660.0),
        pose(3300.0, 500.0, 660.0),
    ]);
    arm.sizes = vec![(0.0, DVec2::new(92.0, 41.0))];
    show.finger(arm);
    rises(&mut show, &pushed);
    show
}

fn same_push_again() -> Show {
    let mut show = Show::new(
        "the same push again",
        "The second push, like the first to a hand's breadth, raises the range further.",
    );
    for (from_ms, y) in [(160.0, 350.0), (4600.0, 354.0)] {
        let push = straight(from_ms, 1100.0, (460.0, y), toward(-3.0) * 90.0);
        let pushed = push_finger(&mut show, push);
        rises(&mut show, &pushed);
    }
    show
}
