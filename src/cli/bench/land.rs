//! The land at all sizes: triangulation, steps of rivers and landslides, sediment, the crust below.

use super::{Bench, SEED, SQUARE, UPLIFT};
use crate::cli::failure::Failure;
use crate::cli::on_threads;
use crate::isostasy::{Crust, Isostasy, IsostasyParams};
use crate::terrain::{Deposition, Erosion, ErosionParams, Forcing, Sediment, StartLand, Tin};

/// Length of a step, and erosion constant, at which the literature's figures were taken.
const DT_YR: f64 = 1e5;
const K: f64 = 5.5e-7;

/// Steps until a network counts as developed (6 My).
const DEVELOPED_STEPS: usize = 60;
/// Steps until rivers carry what they take along.
const LOADED_STEPS: usize = 6;

/// From so many nodes on the gain of two threads over one is measured, and few runs must do.
const MANY_NODES: usize = 1_000_000;

impl Bench {
    /// TIN build, the cold first step, and steps on a developed network with landslides and without.
    pub(super) fn terrain(&mut self, nodes: usize) -> Result<(), Failure> {
        let (builds, runs) = if nodes >= MANY_NODES { (2, 7) } else { (7, 21) };
        let tin = self
            .time(("tin_build", nodes, "–"), None, builds, || {
                Tin::poisson(SQUARE, nodes, SEED)
            })
            .map_err(Failure::other)?;
        // The paper: 10 ms at 10,000 nodes and 4 s at a million.
        let paper_ms = match nodes {
            10_000 => Some(10.0),
            1_000_000 => Some(4000.0),
            _ => None,
        };
        let params = ErosionParams {
            k: K,
            ..ErosionParams::default()
        };
        let bare = ErosionParams {
            landslides: false,
            ..params
        };
        let uplift = vec![UPLIFT; tin.len()];
        let forcing = Forcing::uplift(&uplift);
        let start = StartLand::new(SEED).heights(&tin);

        let cold = ("erosion_step", nodes, "cold");
        let fresh = || (Erosion::new(&tin), start.clone());
        let (mut erosion, mut z) = self.time_each(cold, paper_ms, builds, fresh, |(erosion, z)| {
            erosion.step(&tin, z, &forcing, &params, DT_YR);
        });
        for _ in 0..DEVELOPED_STEPS {
            erosion.step(&tin, &mut z, &forcing, &params, DT_YR);
        }
        let developed = ("erosion_step", nodes, "developed");
        let mut step = || {
            erosion.step(&tin, &mut z, &forcing, &params, DT_YR);
        };
        self.time(developed, paper_ms, runs, &mut step);
        if nodes >= MANY_NODES {
            for threads in [1, 2] {
                if threads != rayon::current_num_threads() {
                    on_threads(Some(threads as u16), || {
                        self.time(developed, paper_ms, runs, &mut step);
                        Ok(())
                    })?;
                }
            }
        }
        let state = ("erosion_no_landslides", nodes, "developed");
        self.time(state, paper_ms, runs, || {
            erosion.step(&tin, &mut z, &forcing, &bare, DT_YR)
        });
        drop(erosion);
        self.floating(&tin, &mut z, &params, runs);
        Ok(())
    }

    /// Steps of a developed land that keeps its sediment, and the answer of the crust under it.
    fn floating(&mut self, tin: &Tin, z: &mut [f64], params: &ErosionParams, runs: usize) {
        let nodes = tin.len();
        let params = ErosionParams {
            deposition: Some(Deposition::default()),
            ..*params
        };
        let mut uplift = vec![UPLIFT; nodes];
        let forcing = Forcing::uplift(&uplift);
        let mut sediment = Sediment::new(nodes);
        let mut erosion = Erosion::new(tin);
        for _ in 0..LOADED_STEPS {
            erosion.step_with_sediment(tin, z, &mut sediment, &forcing, &params, DT_YR);
        }
        self.time(("erosion_step", nodes, "deposition"), None, runs, || {
            erosion.step_with_sediment(tin, z, &mut sediment, &forcing, &params, DT_YR)
        });
        let thickening = vec![UPLIFT; nodes];
        let floats = IsostasyParams::default();
        let mut isostasy = Isostasy::new(tin, &floats);
        let mut crust = Crust::new(nodes);
        self.time(("flexure", nodes, "–"), None, runs, || {
            isostasy.uplift(&mut crust, &thickening, &floats, DT_YR, &mut uplift);
        });
    }
}
