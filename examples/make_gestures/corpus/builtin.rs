//! The session that plays where there is no display.

use glam::DVec2;

use super::Scene;
use super::hand::{five, pose, three, toward};
use super::show::{Finger, Push, Show};

pub(super) const SCENES: [Scene; 1] = [("builtin_session", builtin_session)];

/// A rift opens, a low range rises beyond it, and both hands raise the grand range last, all within six seconds, so that
/// nothing is worn down when the session is over. All of it stays 12 km clear of the border.
fn builtin_session() -> Show {
    let mut show = Show::new(
        "a grand range, a lower one, and a filled rift",
        "A grand range strikes north-north-east at one third of the table, a lower one stands at an angle to it, \
         and rivers have filled a small rift between two hills.",
    );
    show.world(5e6, 60_000);
    show.seed(11);
    for (side, y) in [(-1.0, 512.0), (1.0, 500.0)] {
        let x = |apart: f64| 925.0 + side * apart;
        show.finger(Finger::new(vec![
            pose(160.0, x(36.0), y),
            pose(320.0, x(36.0), y),
            pose(1400.0, x(80.0), y),
            pose(1500.0, x(80.0), y),
        ]));
    }
    show.changes(DVec2::new(925.0, 506.0), 1400.0);
    let along = toward(140.0);
    let low = show.push(
        &three(along, 120.0),
        Push {
            from_ms: 1800.0,
            for_ms: 1200.0,
            at: DVec2::new(1010.0, 165.0),
            by: along * 84.0,
            turn_deg: 0.0,
        },
    );
    // It rises between the hand and the ground that the rift has moved.
    show.changes(DVec2::new(937.0, 368.0), low.end_ms);
    // The range strikes 15° east of north, across the way of the hands.
    let across = toward(15.0);
    let middle = DVec2::new(440.0, 362.0);
    show.rest(&five(-across, 184.0), middle + across * 182.0, 2900.0, 6000.0);
    let grand = show.push(
        &five(across, 184.0),
        Push {
            from_ms: 3400.0,
            for_ms: 2200.0,
            at: middle - across * 312.0,
            by: across * 128.0,
            turn_deg: -4.0,
        },
    );
    show.changes(middle, grand.end_ms);
    show
}
