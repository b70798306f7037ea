//! The layers under the land, as rasters.

use std::sync::Arc;

use glam::DVec2;

use super::Raster;
use crate::rock::{Column, Place, Stratigraphy};

/// Where the layers are after the crust has moved, over the same extent as the land. All rasters have one size.
#[derive(Clone, Debug, PartialEq)]
pub struct StrataMap {
    /// The pile as it was laid down.
    pub stratigraphy: Arc<Stratigraphy>,
    /// How far the pile has risen as a whole, metres.
    pub base: Raster,
    /// Interfaces that folds have raised, with all above them, and by how much, metres.
    pub folds: Vec<(usize, Raster)>,
    /// Thickness of loose sediment on the rock, metres.
    pub sediment: Raster,
    /// How far the load of the mountains has pressed the base of the crust down, metres.
    pub root: Raster,
    /// Depth before folding of the rock at the surface (under any sediment), metres: negative above the first surface.
    /// Which bed that is, [`Stratigraphy::place`] tells.
    pub depth: Raster,
}

impl StrataMap {
    /// The pile at a plan position, metres; bilinear between cells.
    pub fn column(&self, p: DVec2) -> Column<'_> {
        let at = |raster: &Raster| f64::from(raster.sample(p));
        self.folds.iter().fold(
            Column::new(&self.stratigraphy, at(&self.base)),
            |column, (i, raise)| column.folded(*i, at(raise)),
        )
    }

    /// The pile at the centre of a cell, by its index.
    pub fn column_at(&self, cell: usize) -> Column<'_> {
        let at = |raster: &Raster| f64::from(raster.data[cell]);
        self.folds.iter().fold(
            Column::new(&self.stratigraphy, at(&self.base)),
            |column, (i, raise)| column.folded(*i, at(raise)),
        )
    }

    /// Depth before folding of the rock at a plan position where the ground is `ground` metres high, under any sediment:
    /// metres, negative above the first surface. What maps, cliffs and slices show at a place is read from this, with
    /// the ground of the same place, so that they agree between cells too. 0 where a raster holds no number.
    pub fn exposed_depth(&self, p: DVec2, ground: f64) -> f64 {
        let sediment = f64::from(self.sediment.sample(p).max(0.0));
        let depth = self.column(p).depth_at(ground - sediment);
        if depth.is_finite() { depth } else { 0.0 }
    }

    /// The bed at the surface of a cell, under any sediment.
    pub fn outcrop(&self, cell: usize) -> Place {
        self.stratigraphy.place(f64::from(self.depth.data[cell]))
    }
}
