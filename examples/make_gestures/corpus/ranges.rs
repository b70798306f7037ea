//! Ranges of the world: the same hands over other rock.

use glam::DVec2;
use orogen::gesture::command::{Action, Arrow};

use super::Scene;
use super::expected::straight;
use super::hand::{five, toward};
use super::show::{Push, Show};

pub(super) const SCENES: [Scene; 6] = [
    ("range_jura", jura),
    ("range_zagros", zagros),
    ("range_andes", andes),
    ("range_southern_alps", southern_alps),
    ("range_digne", digne),
    ("folds_edited", folds_edited),
];

const UP: DVec2 = DVec2::new(0.0, -1.0);
const DOWN: DVec2 = DVec2::new(0.0, 1.0);
const LEFT: DVec2 = DVec2::new(-1.0, 0.0);
const RIGHT: DVec2 = DVec2::new(1.0, 0.0);

/// From thumb to little finger, mm.
const SPAN: f64 = 184.0;

/// A show over a pile of layers.
fn over(layers: &str, title: &str, see: &str) -> Show {
    let mut show = Show::new(title, see);
    show.world(5e6, 60_000);
    show.command(0.0, Action::Layers(layers.to_owned()));
    show
}

/// Hands that rest, pointing one way, and hands that are pushed towards them: one person after the other. Returns when
/// the last one stands, ms.
fn meet(
    show: &mut Show,
    rests: &[(f64, f64)],
    pushes: &[(f64, f64)],
    facing: DVec2,
    by: DVec2,
    turn_deg: f64,
) -> f64 {
    let times = || (0..).map(|k| f64::from(k) * 416.0);
    let begin = 1200.0 + 416.0 * rests.len() as f64;
    let end = begin + 416.0 * pushes.len() as f64 + 2800.0;
    for (&at, after) in rests.iter().zip(times()) {
        show.rest(&five(facing, SPAN), DVec2::from(at), 160.0 + after, end);
    }
    let mut last = 0.0;
    for (&at, after) in pushes.iter().zip(times()) {
        let push = Push {
            turn_deg,
            ..straight(begin + after, 2400.0, at, by)
        };
        last = show.push(&five(-facing, SPAN), push).end_ms;
    }
    last
}

fn jura() -> Show {
    let mut show = over(
        "jura",
        "the Jura",
        "Ridges of folded limestone, side by side, strike north-south between the hands of two visitors.",
    );
    let rests = [(330.0, 230.0), (330.0, 450.0)];
    let pushes = [(800.0, 230.0), (800.0, 450.0)];
    let end = meet(&mut show, &rests, &pushes, RIGHT, LEFT * 135.0, 0.0);
    show.changes(DVec2::new(520.0, 340.0), end);
    show
}

fn zagros() -> Show {
    let mut show = over(
        "zagros",
        "the Zagros",
        "Long whalebacks, one behind the other, cross the table from west to east.",
    );
    let rests = [(330.0, 580.0), (550.0, 585.0), (770.0, 580.0)];
    let pushes = [(360.0, 110.0), (580.0, 100.0), (800.0, 110.0)];
    let end = meet(&mut show, &rests, &pushes, UP, DOWN * 140.0, 0.0);
    show.changes(DVec2::new(560.0, 390.0), end);
    show
}

fn andes() -> Show {
    let mut show = over(
        "andes",
        "the Andes",
        "One high range stands along the whole table, with plains of gravel on both sides.",
    );
    let rests = [(800.0, 130.0), (800.0, 340.0), (800.0, 550.0)];
    let pushes = [(430.0, 130.0), (430.0, 340.0), (430.0, 550.0)];
    let end = meet(&mut show, &rests, &pushes, LEFT, RIGHT * 130.0, 0.0);
    show.changes(DVec2::new(690.0, 340.0), end);
    show
}

fn southern_alps() -> Show {
    let mut show = over(
        "southern_alps",
        "the Southern Alps",
        "A straight range of one rock stands askew between plates that slide past each other as they meet; nothing folds.",
    );
    show.rest(&five(RIGHT, SPAN), DVec2::new(420.0, 300.0), 160.0, 4600.0);
    let pushed = show.push(
        &five(LEFT, SPAN),
        straight(900.0, 2400.0, (800.0, 420.0), toward(180.0 + 40.0) * 120.0),
    );
    show.changes(DVec2::new(570.0, 300.0), pushed.end_ms);
    show
}

fn digne() -> Show {
    let mut show = over(
        "digne",
        "Digne and its Vélodrome",
        "A small range of bent bowls: hard sandstones stand as walls around hollows of weak rock.",
    );
    let end = meet(
        &mut show,
        &[(420.0, 340.0)],
        &[(800.0, 340.0)],
        RIGHT,
        LEFT * 120.0,
        8.0,
    );
    show.changes(DVec2::new(570.0, 340.0), end);
    show
}

/// While the push is spent, an artist turns a ridge, raises it, and looks into the mountains.
fn folds_edited() -> Show {
    let mut show = over(
        "plain",
        "an artist refines the folds",
        "A ridge runs askew across the range along the drawn line, higher than the others; a slice cuts the range.",
    );
    let end = meet(
        &mut show,
        &[(412.0, 363.0)],
        &[(916.0, 363.0)],
        RIGHT,
        LEFT * 130.0,
        0.0,
    );
    let ridge = vec![
        DVec2::new(560.0, 260.0),
        DVec2::new(600.0, 330.0),
        DVec2::new(650.0, 410.0),
    ];
    show.command(7000.0, Action::TurnFolds { path: ridge.clone() });
    show.command(7400.0, Action::RaiseFolds { path: ridge, by: 1.6 });
    show.command(
        8000.0,
        Action::Slice(Arrow {
            from: DVec2::new(400.0, 360.0),
            to: DVec2::new(820.0, 330.0),
        }),
    );
    show.changes(DVec2::new(600.0, 360.0), end);
    show
}
