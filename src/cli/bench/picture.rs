//! From nodes to pixels, and from pixels to a picture.

use glam::DVec2;

use super::{Bench, SEED};
use crate::cli::failure::Failure;
use crate::picture::{MapStyle, relief_map};
use crate::surface::{Raster, Surface};
use crate::terrain::{StartLand, Tin, TinRaster};
use crate::units::{DEFAULT_SHORT_SIDE, PlanMap};

impl Bench {
    /// The relief map at 1920 × 1080.
    pub(super) fn picture(&mut self) -> Result<(), Failure> {
        let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
        let tin = Tin::poisson(map.extent(), 60_000, SEED).map_err(Failure::other)?;
        let z = StartLand::new(SEED).heights(&tin);
        let raster = self.time(("rasterise", 1920 * 1080, "60k nodes"), None, 3, || {
            TinRaster::new(&tin, 1920, 1080)
        });
        let field = |data| Raster {
            width: 1920,
            height: 1080,
            extent: tin.extent(),
            data,
        };
        let height = field(raster.smooth(&tin, &z));
        let surface = Surface {
            lake_depth: field(vec![0.0; 1920 * 1080]),
            drainage: field(vec![0.0; 1920 * 1080]),
            height,
            spacing: (tin.extent().area() / tin.len() as f64).sqrt(),
            rivers: Vec::new(),
            plates: Vec::new(),
            faults: Vec::new(),
            folds: Vec::new(),
            strata: None,
            elapsed_yr: 0.0,
        };
        self.time(("relief_map", 1920 * 1080, "–"), None, 3, || {
            relief_map(&surface, &MapStyle::default(), 1920, 1080)
        });
        Ok(())
    }
}
