//! What touchscreens, sleeves and drivers do to contacts.

use glam::DVec2;
use orogen::gesture::contact::Phase;

use super::Scene;
use super::expected::{rises, straight};
use super::hand::{five, pose, pose_at};
use super::show::{FRAME_MS, Finger, Show};

pub(super) const SCENES: [Scene; 9] = [
    ("palm_and_sleeve", palm_and_sleeve),
    ("palm_only", palm_only),
    ("sleeve_sweeps", sleeve_sweeps),
    ("confidence_lost", confidence_lost),
    ("palm_flickers", palm_flickers),
    ("flicker", flicker),
    ("stuck_contact", stuck_contact),
    ("id_reuse", id_reuse),
    ("cancel", cancel),
];

const UP: DVec2 = DVec2::new(0.0, -1.0);
const LEFT: DVec2 = DVec2::new(-1.0, 0.0);
const RIGHT: DVec2 = DVec2::new(1.0, 0.0);

/// A palm lands as small as a fingertip and spreads within 100 ms, which is why first guesses are revised.
fn landing_palm(from_ms: f64) -> Vec<(f64, DVec2)> {
    [(0.0, 14.0), (32.0, 19.0), (64.0, 34.0), (96.0, 57.0)]
        .map(|(t_ms, size)| (from_ms + t_ms, DVec2::new(size, 0.8 * size)))
        .to_vec()
}

fn palm_and_sleeve() -> Show {
    let mut show = Show::new(
        "a palm and a sleeve beside a pushing hand",
        "One range before the fingers; nothing rises under the palm or the sleeve that is dragged along.",
    );
    let push = straight(160.0, 1500.0, (560.0, 400.0), UP * 100.0);
    let shape = five(UP, 150.0);
    let (poses, _) = push.poses(&shape);
    let pushed = show.push(&shape, push);
    let mut palm = Finger::new(poses.clone());
    palm.offset = DVec2::new(-20.0, 105.0);
    palm.lands_ms += 64.0;
    palm.sizes = landing_palm(palm.lands_ms);
    show.finger(palm);
    let mut sleeve = Finger::new(poses);
    sleeve.offset = DVec2::new(15.0, 190.0);
    sleeve.lands_ms += 208.0;
    sleeve.confidence = Some(0.0);
    show.finger(sleeve);
    rises(&mut show, &pushed);
    show
}

fn palm_only() -> Show {
    let mut show = Show::new(
        "a palm alone",
        "Nothing: a palm, a bag on the table and a drop of water are no hands.",
    );
    show.nothing();
    let mut palm = Finger::new(vec![
        pose(160.0, 500.0, 470.0),
        pose(500.0, 500.0, 470.0),
        pose(1700.0, 590.0, 420.0),
        pose(2000.0, 590.0, 420.0),
    ]);
    palm.sizes = landing_palm(160.0);
    show.finger(palm);
    let mut bag = Finger::new(vec![pose(400.0, 900.0, 200.0), pose(2600.0, 903.0, 202.0)]);
    bag.sizes = vec![(0.0, DVec2::new(140.0, 96.0))];
    bag.confidence = Some(0.0);
    show.finger(bag);
    let mut drop = Finger::new(vec![pose(2000.0, 300.0, 250.0), pose(2048.0, 300.0, 250.0)]);
    drop.sizes = vec![
        (2000.0, DVec2::new(4.0, 4.0)),
        (2016.0, DVec2::new(9.0, 7.0)),
        (2032.0, DVec2::new(5.0, 3.0)),
    ];
    show.finger(drop);
    show
}

fn sleeve_sweeps() -> Show {
    let mut show = Show::new(
        "a sleeve sweeps over the table",
        "Nothing: what lands like a finger and has pushed before it is seen how large it is, is taken back.",
    );
    show.nothing();
    let mut sleeve = Finger::new(vec![
        pose(160.0, 330.0, 430.0),
        pose(304.0, 470.0, 400.0),
        pose(900.0, 900.0, 300.0),
        pose(1000.0, 900.0, 300.0),
    ]);
    sleeve.sizes = [
        (0.0, 11.0),
        (64.0, 16.0),
        (112.0, 22.0),
        (160.0, 48.0),
        (208.0, 90.0),
    ]
    .map(|(t_ms, size)| (160.0 + t_ms, DVec2::new(size, 0.6 * size)))
    .to_vec();
    show.finger(sleeve);
    show
}

fn confidence_lost() -> Show {
    let mut show = Show::new(
        "a finger that turns out to be none",
        "Nothing: within a quarter of a second the screen is no longer sure, and what was pushed is taken back.",
    );
    show.nothing();
    let push = straight(160.0, 700.0, (520.0, 360.0), RIGHT * 140.0);
    let (poses, _) = push.poses(&[DVec2::ZERO]);
    let mut doubted = Finger::new(poses);
    doubted.doubted_ms = Some(160.0 + 224.0);
    show.finger(doubted);
    show
}

fn palm_flickers() -> Show {
    let mut show = Show::new(
        "a palm that the screen cannot measure",
        "One range before the hand; the palm beside it comes and goes, and after its first touches is none.",
    );
    let pushed = show.push(
        &five(UP, 150.0),
        straight(960.0, 1500.0, (800.0, 470.0), UP * 100.0),
    );
    for i in 0..36_u32 {
        let lands_ms = 160.0 + 80.0 * f64::from(i);
        // It wanders: three places, 3 mm apart.
        let x = 330.0 + 3.0 * f64::from(i % 3);
        let mut palm = Finger::new(vec![pose(lands_ms, x, 500.0), pose(lands_ms + 48.0, x, 500.0)]);
        palm.id = Some(90);
        show.finger(palm);
    }
    rises(&mut show, &pushed);
    show
}

fn flicker() -> Show {
    let mut show = Show::new(
        "a contact that flickers",
        "One range, as of one push: the contact was lost and found again three times on its way.",
    );
    let push = straight(160.0, 1600.0, (480.0, 345.0), RIGHT * 110.0);
    let (poses, pushed) = push.poses(&[DVec2::ZERO]);
    let pieces = [
        (160.0, 720.0),
        (752.0, 1040.0),
        (1072.0, 1312.0),
        (1344.0, 2096.0),
    ];
    for (lands_ms, leaves_ms) in pieces {
        let mut finger = Finger::new(poses.clone());
        (finger.lands_ms, finger.leaves_ms) = (lands_ms, leaves_ms);
        show.finger(finger);
    }
    rises(&mut show, &pushed);
    show
}

fn stuck_contact() -> Show {
    let mut show = Show::new(
        "a contact that never leaves",
        "Both hands raise their ranges, the first and the one 21 seconds later, as if the contact were not there.",
    );
    let mut stuck = Finger::new(vec![pose(0.0, 1090.0, 130.0), pose(24_800.0, 1090.0, 130.0)]);
    stuck.frozen = true;
    show.finger(stuck);
    let first = show.push(
        &five(LEFT, 150.0),
        straight(960.0, 1300.0, (820.0, 420.0), LEFT * 90.0),
    );
    rises(&mut show, &first);
    let second = show.push(
        &[DVec2::ZERO, DVec2::new(-8.0, 52.0)],
        straight(22_000.0, 1300.0, (420.0, 400.0), UP * 95.0),
    );
    rises(&mut show, &second);
    show
}

fn id_reuse() -> Show {
    let mut show = Show::new(
        "one id for three fingers",
        "Three short ranges, one before each finger: an id that lands again is another finger.",
    );
    let mut from_ms = 160.0;
    for (at, by) in [
        ((250.0, 470.0), UP * 80.0),
        ((950.0, 470.0), UP * 80.0),
        ((600.0, 470.0), UP * 80.0),
    ] {
        let push = straight(from_ms, 720.0, at, by);
        let (poses, pushed) = push.poses(&[DVec2::ZERO]);
        let mut finger = Finger::new(poses);
        finger.id = Some(1);
        // The next finger lands in the moment in which this one lifts.
        from_ms = finger.leaves_ms;
        show.finger(finger);
        rises(&mut show, &pushed);
    }
    show
}

fn cancel() -> Show {
    let mut show = Show::new(
        "withdrawn contacts",
        "One range before the hand, which was withdrawn half-way; nothing where a finger was withdrawn at once.",
    );
    let push = straight(160.0, 1800.0, (700.0, 350.0), LEFT * 160.0);
    let shape = five(LEFT, 150.0);
    let (poses, _) = push.poses(&shape);
    let gone_ms = 1200.0;
    for offset in shape {
        let mut finger = Finger::new(poses.clone());
        finger.offset = offset;
        finger.leaves_ms = gone_ms;
        finger.leaves = Phase::Cancel;
        show.finger(finger);
    }
    let half_way = pose_at(&poses, gone_ms - f64::from(FRAME_MS)).at;
    show.changes(half_way + LEFT * 105.0, gone_ms);
    let mut never = Finger::new(vec![
        pose(400.0, 300.0, 180.0),
        pose(416.0, 300.0, 180.0),
        pose(560.0, 340.0, 180.0),
    ]);
    never.leaves = Phase::Cancel;
    show.finger(never);
    show
}
