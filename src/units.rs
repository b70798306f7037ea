//! Frames and quantities: the only place that converts table millimetres ↔ plan metres or places on the globe.
//!
//! * **Table frame**: millimetres from the table's top-left corner, x to the right, y *down* (gesture files, contacts).
//! * **Plan frame**: metres on the ground, x east, y *north*, origin at the south-west corner (all of `mountain`,
//!   `terrain`, and every exported mesh). The top of the table is north, so pictures, whose first row is the
//!   northern one, show the land as the table does.
//! * **Globe**: unit vectors, z north pole; [`GlobeView`] says where the table shows which of them.
//!
//! Quantities without a unit in their name are SI; model time is in years and says so (`_yr`).

mod globe;

pub use globe::{GlobeView, ZOOM_LIMITS};

use glam::DVec2;

/// Metres in a kilometre.
pub const KM: f64 = 1000.0;

/// Years in a million years.
pub const MYR: f64 = 1.0e6;

/// Length of the short side of the table on the ground, metres (the paper's terrain is 100 × 100 km).
pub const DEFAULT_SHORT_SIDE: f64 = 100.0 * KM;

/// A rectangle of land in the plan frame: `[0, width] × [0, height]`, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// West–east size, metres.
    pub width: f64,
    /// South–north size, metres.
    pub height: f64,
}

impl Extent {
    /// Area in m².
    pub fn area(self) -> f64 {
        self.width * self.height
    }

    /// The corner farthest from the origin (north-east).
    pub fn size(self) -> DVec2 {
        DVec2::new(self.width, self.height)
    }

    /// True for points inside or on the border.
    pub fn contains(self, p: DVec2) -> bool {
        p.x >= 0.0 && p.y >= 0.0 && p.x <= self.width && p.y <= self.height
    }
}

/// The map between a table's surface and the ground: a fixed number of metres per millimetre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanMap {
    size_mm: DVec2,
    metres_per_mm: f64,
}

impl PlanMap {
    /// The map that lays `short_side` metres of ground along the short side of a table of `size_mm`.
    pub fn new(size_mm: DVec2, short_side: f64) -> Self {
        Self {
            size_mm,
            metres_per_mm: short_side / size_mm.min_element(),
        }
    }

    /// The table's size in millimetres.
    pub fn size_mm(&self) -> DVec2 {
        self.size_mm
    }

    /// Metres of ground per millimetre of table.
    pub fn metres_per_mm(&self) -> f64 {
        self.metres_per_mm
    }

    /// The land under the whole table.
    pub fn extent(&self) -> Extent {
        let size = self.size_mm * self.metres_per_mm;
        Extent {
            width: size.x,
            height: size.y,
        }
    }

    /// A table position (mm, y down) on the ground (m, y north).
    pub fn to_plan(&self, table_mm: DVec2) -> DVec2 {
        DVec2::new(table_mm.x, self.size_mm.y - table_mm.y) * self.metres_per_mm
    }

    /// A ground position (m, y north) on the table (mm, y down).
    pub fn to_table(&self, plan: DVec2) -> DVec2 {
        let mm = plan / self.metres_per_mm;
        DVec2::new(mm.x, self.size_mm.y - mm.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plan_and_table_are_inverse_and_north_is_up() {
        let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
        assert!((map.extent().height - 100.0 * KM).abs() < 1e-6);
        let north_west = map.to_plan(DVec2::ZERO);
        assert!(north_west.x == 0.0 && (north_west.y - map.extent().height).abs() < 1e-6);
        let p = DVec2::new(300.25, 17.5);
        assert!((map.to_table(map.to_plan(p)) - p).length() < 1e-9);
    }
}
