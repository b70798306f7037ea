//! The session that plays where there is no display.

use glam::DVec2;

use super::Scene;
use super::hand::{five, pose, three, toward};
use super::show::{Finger, Push, Show};

pub(super) const SCENES: [Scene; 1] = [("builtin_session", builtin_session)];

/// Both hands raise the grand range first, then a lower one meets it at an angle, then a rift opens before it. All of
/// it stays 12 km clear of the border.
fn builtin_session() -> Show {
    let mut show = Show::new(
        "a grand range, a lower one, and a lake",
        "A grand range strikes north-north-east at one third of the table, a lower one stands at an angle to it, \
         and a lake lies in a small rift.",
    );
    show.world(5e6, 60_000);
    show.seed(11);
    // The range strikes 15° east of north, across the way of the hands.
    let across = toward(15.0);
    let middle = DVec2::new(415.0, 362.0);
    show.rest(&five(across, 186.0), middle - across * 195.0, 320.0, 6000.0);
    let grand = show.push(
        &five(-across, 184.0),
        Push {
            from_ms: 1200.0,
            for_ms: 3600.0,
            at: middle + across * 290.0,
            by: across * -112.0,
            turn_deg: 4.0,
        },
    );
    show.changes(grand.ahead(60.0), grand.end_ms);
    let along = toward(128.0);
    let low = show.push(
        &three(along, 120.0),
        Push {
            from_ms: 6400.0,
            for_ms: 2200.0,
            at: DVec2::new(985.0, 165.0),
            by: along * 64.0,
            turn_deg: 0.0,
        },
    );
    show.changes(low.ahead(50.0), low.end_ms);
    for (side, y) in [(-1.0, 508.0), (1.0, 492.0)] {
        let x = |apart: f64| 900.0 + side * apart;
        show.finger(Finger::new(vec![
            pose(9400.0, x(36.0), y),
            pose(9600.0, x(36.0), y),
            pose(12200.0, x(88.0), y),
            pose(13200.0, x(88.0), y),
        ]));
    }
    show.changes(DVec2::new(900.0, 500.0), 12_200.0);
    show
}
