//! The globe: plates under hands.

use glam::DVec2;
use orogen::gesture::command::{Action, Paint, Place};
use orogen::sphere::direction;
use orogen::units::GlobeView;

use super::Scene;
use super::expected::straight;
use super::hand::five;
use super::show::{Show, TABLE_MM};

pub(super) const SCENES: [Scene; 2] = [
    ("planet_collide_and_tear", collide_and_tear),
    ("planet_island_arc", island_arc),
];

const UP: DVec2 = DVec2::new(0.0, -1.0);
const DOWN: DVec2 = DVec2::new(0.0, 1.0);

/// From thumb to little finger, mm.
const SPAN: f64 = 160.0;

/// A planet of which nothing is known but its sea, and how it lies on the table.
struct Globe {
    show: Show,
    view: GlobeView,
}

impl Globe {
    /// A random planet without continents, looked at from above `middle` (degrees north and east).
    fn new((title, see): (&str, &str), (plates, seed): (u32, u64), middle: (f64, f64), zoom: f64) -> Self {
        let mut show = Show::new(title, see);
        show.on_globe();
        show.command(
            0.0,
            Action::Planet {
                plates,
                continental: 0.0,
                seed,
            },
        );
        let (lat, lon) = middle;
        show.command(0.0, Action::View { lon, lat, zoom });
        Self {
            show,
            view: GlobeView::new(TABLE_MM).looking_at(lon, lat, zoom),
        }
    }

    /// Raises a continent, or an arc of islands, out of discs.
    fn continent(&mut self, discs: &[(f64, f64, f64)]) {
        for &(lat, lon, radius_deg) in discs {
            self.show.command(
                0.0,
                Action::Paint {
                    at: Place { lat, lon },
                    radius_deg,
                    paint: Paint::Continent,
                },
            );
        }
    }

    /// Where a place lies on the table, mm.
    fn mm(&self, lat: f64, lon: f64) -> DVec2 {
        self.view
            .project(direction(lat, lon))
            .expect("a place that is seen")
    }

    /// A hand goes from one place to another, and stays there until `to_ms`.
    fn lead(
        &mut self,
        from: (f64, f64),
        to: (f64, f64),
        (from_ms, for_ms, to_ms): (f64, f64, f64),
        facing: DVec2,
    ) {
        let (start, end) = (self.mm(from.0, from.1), self.mm(to.0, to.1));
        let push = straight(from_ms, for_ms, start.into(), end - start);
        let (mut poses, _) = push.poses(&five(facing, SPAN));
        if let Some(last) = poses.last_mut() {
            last.t_ms = to_ms;
        }
        self.show.hand(&five(facing, SPAN), &poses);
    }
}

/// The northern plate is held while the southern one comes; later both hands hold what has become one.
fn collide_and_tear() -> Show {
    let about = (
        "two continents collide, and are torn again",
        "A high range stands along the seam of two continents; then a new sea opens between the hands.",
    );
    let mut globe = Globe::new(about, (8, 1), (-2.0, 35.0), 1.15);
    globe.continent(&[
        (22.0, 35.0, 10.0),
        (28.0, 25.0, 8.0),
        (25.0, 47.0, 8.0),
        (13.0, 32.0, 7.0),
        (15.0, 43.0, 5.0),
    ]);
    globe.continent(&[
        (-25.0, 35.0, 10.0),
        (-31.0, 45.0, 8.0),
        (-28.0, 25.0, 7.0),
        (-17.0, 37.0, 7.0),
    ]);
    let seam = globe.mm(7.0, 35.0);
    globe
        .show
        .rest(&five(DOWN, SPAN), globe.mm(22.0, 35.0), 320.0, 7600.0);
    globe.lead((-26.0, 35.0), (2.0, 35.0), (800.0, 3200.0, 7600.0), UP);
    globe.show.changes(seam, 7600.0);
    globe.lead((20.0, 35.0), (29.0, 35.0), (9600.0, 2000.0, 15_000.0), DOWN);
    globe.lead((-11.0, 35.0), (-25.0, 35.0), (9600.0, 2000.0, 15_000.0), UP);
    globe.show.world(10e6, 60_000);
    globe.show
}

/// A plate that bears islands runs onto the coast of a continent, and they stay there.
fn island_arc() -> Show {
    let about = (
        "an arc of islands joins a continent",
        "The islands have come to lie along the continent's southern coast, and mountains stand where they joined it.",
    );
    let mut globe = Globe::new(about, (8, 1), (-2.0, 35.0), 1.15);
    globe.continent(&[
        (10.0, 35.0, 11.0),
        (16.0, 24.0, 8.0),
        (13.0, 48.0, 8.0),
        (3.0, 28.0, 4.5),
        (3.0, 43.0, 4.5),
    ]);
    globe.continent(&[
        (-13.0, 20.0, 2.2),
        (-15.0, 25.0, 2.6),
        (-16.5, 31.0, 2.4),
        (-17.0, 37.0, 2.8),
        (-16.0, 43.0, 2.3),
        (-14.0, 49.0, 2.5),
    ]);
    let coast = globe.mm(-1.0, 35.0);
    globe
        .show
        .rest(&five(DOWN, SPAN), globe.mm(20.0, 35.0), 320.0, 8400.0);
    globe.lead((-24.0, 35.0), (-9.0, 35.0), (800.0, 3600.0, 8400.0), UP);
    globe.show.changes(coast, 8400.0);
    globe.show.world(2e6, 60_000);
    globe.show
}
