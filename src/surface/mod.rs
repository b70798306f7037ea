//! What a tick yields for eyes and files: plain data.
//!
//! Nothing here knows how the land was made. Everything is in the plan frame (metres, x east, y north).

mod cut;
pub mod planet;
pub mod rivers;
mod strata;

use std::sync::Arc;

use glam::DVec2;

use crate::units::Extent;
pub use cut::Cut;
pub use rivers::{River, RiverPoint};
pub use strata::StrataMap;

/// A field on a regular grid of square cells over an [`Extent`]. Row 0 is the northernmost, values sit at cell
/// centres (pixel = area).
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The land it covers.
    pub extent: Extent,
    /// `width × height` values, row by row from north to south.
    pub data: Vec<f32>,
}

impl Raster {
    /// The raster whose cell centred on `p` (plan, metres) holds `value(p)`.
    pub fn from_fn(width: usize, height: usize, extent: Extent, value: impl Fn(DVec2) -> f32) -> Self {
        let mut raster = Self {
            width,
            height,
            extent,
            data: Vec::with_capacity(width * height),
        };
        for row in 0..height {
            for column in 0..width {
                raster.data.push(value(raster.centre(column, row)));
            }
        }
        raster
    }

    /// Size of one cell, metres (west–east, south–north).
    pub fn cell(&self) -> DVec2 {
        self.extent.size() / DVec2::new(self.width as f64, self.height as f64)
    }

    /// Plan position of a cell's centre, metres.
    pub fn centre(&self, column: usize, row: usize) -> DVec2 {
        let cell = self.cell();
        DVec2::new(
            (column as f64 + 0.5) * cell.x,
            self.extent.height - (row as f64 + 0.5) * cell.y,
        )
    }

    /// The value at plan position `p` (metres), bilinear between cell centres; outside the outermost centres the
    /// border cell's value. A position that is not a number reads as the north-west cell.
    pub fn sample(&self, p: DVec2) -> f32 {
        let cell = self.cell();
        let u = (p.x / cell.x - 0.5).clamp(0.0, (self.width - 1) as f64);
        let v = ((self.extent.height - p.y) / cell.y - 0.5).clamp(0.0, (self.height - 1) as f64);
        let (column, row) = (u as usize, v as usize);
        let (next_column, next_row) = ((column + 1).min(self.width - 1), (row + 1).min(self.height - 1));
        let at = |column: usize, row: usize| f64::from(self.data[row * self.width + column]);
        let (fu, fv) = (u - column as f64, v - row as f64);
        let blend = |a: f64, b: f64, t: f64| if t > 0.0 { a + (b - a) * t } else { a };
        blend(
            blend(at(column, row), at(next_column, row), fu),
            blend(at(column, next_row), at(next_column, next_row), fu),
            fv,
        ) as f32
    }

    /// The same values over other land.
    #[must_use]
    pub fn stretched(self, extent: Extent) -> Self {
        Self { extent, ..self }
    }

    /// Steepness of the field: |∇| by central differences (one-sided on the border), value per metre.
    #[must_use]
    pub fn slope(&self) -> Self {
        let cell = self.cell();
        let at = |column: usize, row: usize| f64::from(self.data[row * self.width + column]);
        let mut data = Vec::with_capacity(self.data.len());
        for row in 0..self.height {
            let (north, south) = (row.saturating_sub(1), (row + 1).min(self.height - 1));
            for column in 0..self.width {
                let (west, east) = (column.saturating_sub(1), (column + 1).min(self.width - 1));
                let rise = DVec2::new(
                    (at(east, row) - at(west, row)) / ((east - west).max(1) as f64 * cell.x),
                    (at(column, north) - at(column, south)) / ((south - north).max(1) as f64 * cell.y),
                );
                data.push(rise.length() as f32);
            }
        }
        Self { data, ..*self }
    }
}

/// The land at one instant, with what lies on it.
///
/// All rasters cover the same extent; they may have different resolutions.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Height of the solid ground, metres.
    pub height: Raster,
    /// Depth of standing water, metres; 0 on dry land. (A depth, not a level: a level would have to be interpolated
    /// exactly as the heights are, or slopes would be under water.)
    pub lake_depth: Raster,
    /// Area that drains through each place, m²: water, meadows and forests follow it.
    pub drainage: Raster,
    /// Typical distance between the points the heights come from, metres. Finer detail than this is not in the
    /// data, and only a picture may add it.
    pub spacing: f64,
    /// Rivers, smoothed for drawing.
    pub rivers: Vec<River>,
    /// Plates that stand on the land, in the order they were made.
    pub plates: Vec<PlateMark>,
    /// Faults between plates.
    pub faults: Vec<FaultTrace>,
    /// Crests and troughs of its folds.
    pub folds: Vec<FoldLine>,
    /// The layers under it; `None` where nothing is known of them. Shared, because frames circulate.
    pub strata: Option<Arc<StrataMap>>,
    /// Model time since the land was new, years.
    pub elapsed_yr: f64,
}

impl Surface {
    /// Height of the ground at a plan position, metres; 0 where the raster holds no number.
    pub fn ground(&self, p: DVec2) -> f64 {
        let height = self.height.sample(p);
        if height.is_finite() {
            f64::from(height)
        } else {
            0.0
        }
    }
}

/// One plate as the map shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateMark {
    /// The support's outline, closed implicitly.
    pub hull: Vec<DVec2>,
    /// One arrow per finger: where it started, and where the fitted motion takes it.
    pub arrows: Vec<(DVec2, DVec2)>,
    /// Part of the push that has already happened, 0–1.
    pub spent: f64,
    /// What the plate does now.
    pub state: PlateState,
    /// Where along the arrow (0–1) the motion was capped because the crust would turn over; `None` when it was not.
    pub cap: Option<f64>,
}

/// What a plate does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateState {
    /// Held still: a reference for the others.
    Resting,
    /// Its push is under way.
    Pushing,
    /// Its push is spent; it stands until it is removed.
    Standing,
}

/// A fault line on the map.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultTrace {
    /// The trace, at least two points.
    pub points: Vec<DVec2>,
    /// Seen along the trace, the hanging wall (the range) is on the left; the teeth point there.
    pub range_on_left: bool,
}

impl FaultTrace {
    /// Dip of a fault under its range, degrees: thrusts stand at a few tens of degrees where they crop out.
    pub const DIP_DEG: f64 = 30.0;
}

/// The axis of a fold on the map.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldLine {
    /// The axis, at least two points.
    pub points: Vec<DVec2>,
    /// True for a crest (an anticline), false for a trough (a syncline).
    pub crest: bool,
    /// The layer that folds, 0 the topmost.
    pub layer: usize,
    /// Wavelength of its folds, metres.
    pub wavelength_m: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAND: Extent = Extent {
        width: 4000.0,
        height: 2000.0,
    };

    #[test]
    fn bilinear_sampling_reproduces_a_plane_and_clamps_outside() {
        let plane = Raster::from_fn(8, 4, LAND, |p| (2.0 * p.x - 3.0 * p.y) as f32);
        let inside = DVec2::new(1234.0, 789.0);
        assert!((f64::from(plane.sample(inside)) - (2.0 * inside.x - 3.0 * inside.y)).abs() < 1e-2);
        assert_eq!(plane.sample(DVec2::new(-1e9, 1e9)), plane.data[0]);
        assert_eq!(plane.sample(DVec2::new(1e9, -1e9)), plane.data[31]);
        assert_eq!(plane.sample(DVec2::NAN), plane.data[0]);
    }

    #[test]
    fn first_row_is_north() {
        let northing = Raster::from_fn(4, 2, LAND, |p| p.y as f32);
        assert_eq!(
            northing.data,
            [1500.0, 1500.0, 1500.0, 1500.0, 500.0, 500.0, 500.0, 500.0]
        );
    }

    #[test]
    fn slope_of_a_plane_is_its_gradient_also_on_the_border() {
        let plane = Raster::from_fn(8, 4, LAND, |p| (0.3 * p.x + 0.4 * p.y) as f32);
        for s in plane.slope().data {
            assert!((s - 0.5).abs() < 1e-5, "{s}");
        }
    }
}
