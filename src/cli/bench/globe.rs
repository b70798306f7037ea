//! The planet at the sizes of Cortial et al. 2019, Table 2: forty plates, a third of it land.

use std::sync::Arc;

use super::{Bench, SEED};
use crate::cli::failure::Failure;
use crate::globe::{Cut, GlobeParams, Planet, Start};
use crate::sphere::Lattice;

/// Number of samples, and the table's times for a step, for new sea floor and for a rift, ms.
const SIZES: [(usize, f64, f64, f64); 4] = [
    (60_000, 190.0, 580.0, 230.0),
    (100_000, 280.0, 1_220.0, 210.0),
    (250_000, 1_240.0, 3_580.0, 1_500.0),
    (500_000, 1_900.0, 13_100.0, 7_700.0),
];

/// The table's planet.
const START: Start = Start::Random {
    plates: 40,
    continental: 0.3,
    seed: SEED,
};

/// Steps until fronts and ridges have formed.
const DEVELOPED_STEPS: usize = 10;

/// Steps for which gaps are left open before new sea floor fills them all.
const GAP_STEPS: u32 = 10;

impl Bench {
    /// Lattice, start, step, the step that fills the gaps of ten, rift, and what is shown.
    pub(super) fn globe(&mut self) -> Result<(), Failure> {
        for (samples, step_ms, sea_floor_ms, rift_ms) in SIZES {
            let lattice = self.time(("lattice", samples, "–"), None, 3, || Lattice::new(samples));
            let lattice = Arc::new(lattice.map_err(Failure::other)?);
            let make = |params| Planet::new(Arc::clone(&lattice), &START, params);
            let planet = self.time(("globe_start", samples, "40 plates"), None, 3, || {
                make(GlobeParams::planet())
            });
            let mut planet = planet.map_err(Failure::other)?;
            for _ in 0..DEVELOPED_STEPS {
                planet.step();
            }
            self.time(("globe_step", samples, "developed"), Some(step_ms), 9, || {
                planet.step()
            });
            self.time(("globe_surface", samples, "developed"), None, 5, || {
                planet.surface(0.0)
            });
            self.rift(samples, &planet, rift_ms);
            let params = GlobeParams {
                spread_steps: GAP_STEPS,
                ..GlobeParams::planet()
            };
            let mut planet = make(params).map_err(Failure::other)?;
            for _ in 1..GAP_STEPS {
                planet.step();
            }
            self.time(
                ("globe_sea_floor", samples, "20 My"),
                Some(sea_floor_ms),
                1,
                || planet.step(),
            );
        }
        Ok(())
    }

    /// Tears the greatest plate.
    fn rift(&mut self, samples: usize, planet: &Planet, paper_ms: f64) {
        const RUNS: usize = 3;
        let area = |id: &u32| planet.plate_state(*id).map_or(0.0, |(_, _, area)| area);
        let Some(greatest) = planet.plate_ids().max_by(|a, b| area(a).total_cmp(&area(b))) else {
            return;
        };
        let mut copies = vec![planet.clone(); RUNS];
        let mut fresh = copies.iter_mut();
        self.time(("globe_rift", samples, "3 parts"), Some(paper_ms), RUNS, || {
            fresh.next().map(|planet| planet.rift(greatest, &Cut::Parts(3)))
        });
    }
}
