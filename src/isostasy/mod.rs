//! The crust floats: a range has a root, what is eroded rebounds, and its weight bends the land beside it down.
//!
//! [`Plate`] is the mechanics, on one coarse grid; [`Isostasy`] carries rock from nodes to the grid and the answer
//! back; [`Crust`] is what a world keeps.

mod plate;

use std::ops::RangeInclusive;

use crate::terrain::Tin;
use crate::units::Extent;

pub use plate::Plate;

/// Cells of the grid: 128 × 72 on a table of 16 : 9. Flexure is smooth over tens of kilometres.
const CELLS: f64 = 128.0 * 72.0;

/// How the crust floats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsostasyParams {
    /// Effective elastic thickness Te of the plate, metres. Real ranges: 5–40 km. 0 has no strength (Airy): each
    /// column floats alone. Large values spread a range's weight over all of the land.
    pub elastic_thickness: f64,
    /// Factor on the thickening of the crust. A range without help keeps a sixth to all of its thickening as height,
    /// the less the wider it is; the factor is the answer for lands that must rise within minutes. The root, the
    /// rebound and the volumes follow the thickening so enlarged: `1 / rise_share(wavelength)` makes a range of that
    /// wavelength rise as fast as if it did not float.
    pub boost: f64,
    /// Width of crust beyond each border that carries no load, as a share of the land's sides; taken when the nodes are
    /// placed. 0 mirrors the land at its border: ranges stand side by side without end, and push down all there is
    /// between them. The default of 0.5 leaves a range alone in a quiet plate, which helps to carry it.
    pub margin: f64,
}

impl Default for IsostasyParams {
    fn default() -> Self {
        Self {
            elastic_thickness: 12e3,
            boost: 1.0,
            margin: 0.5,
        }
    }
}

impl IsostasyParams {
    /// Range of [`Self::elastic_thickness`], metres.
    pub const ELASTIC_THICKNESS: RangeInclusive<f64> = 0.0..=60e3;
    /// Range of [`Self::boost`].
    pub const BOOST: RangeInclusive<f64> = 0.0..=10.0;
    /// Range of [`Self::margin`].
    pub const MARGIN: RangeInclusive<f64> = 0.0..=2.0;

    /// Share of a thickening of the crust of some wavelength (m) that becomes height, 1/6 to 1; the rest is root.
    pub fn rise_share(&self, wavelength: f64) -> f64 {
        1.0 - plate::sunk_share(self.elastic_thickness, wavelength)
    }

    /// Length over which the plate bends beside a load, m: the foredeep of a narrow range reaches as far as 2.4 of it,
    /// and the bulge beyond is highest at π of it.
    pub fn flexural_length(&self) -> f64 {
        plate::flexural_length(self.elastic_thickness)
    }
}

/// What a world keeps of its crust, one value per node.
#[derive(Clone, Debug, PartialEq)]
pub struct Crust {
    /// How far the base of the crust has sunk, m; negative where it has risen.
    pub root: Vec<f64>,
    /// Rock that the surface has gained since the mantle last answered, m; negative where it was lost.
    pub unanswered: Vec<f64>,
}

impl Crust {
    /// A crust at rest under `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        Self {
            root: vec![0.0; nodes],
            unanswered: vec![0.0; nodes],
        }
    }

    /// Books what a step of the land took and laid down: the heights `after` it, against the heights `before` and
    /// the `uplift` (m/yr) of its `dt_yr` years. An edge that is held at its height erodes what rises there and is
    /// filled where it sinks.
    ///
    /// # Panics
    /// If a slice does not hold one value per node.
    pub fn book(&mut self, before: &[f64], after: &[f64], uplift: &[f64], dt_yr: f64) {
        let nodes = self.unanswered.len();
        assert!(
            [before, after, uplift].iter().all(|slice| slice.len() == nodes),
            "one value per node"
        );
        for (i, gained) in self.unanswered.iter_mut().enumerate() {
            *gained += after[i] - before[i] - uplift[i] * dt_yr;
        }
    }
}

/// Between nodes and the plate: weights and scratch memory. It holds nothing that the next step depends on.
#[derive(Clone, Debug)]
pub struct Isostasy {
    /// The land and the crust beyond it.
    extent: Extent,
    size: [usize; 2],
    elastic_thickness: f64,
    plate: Plate,
    places: Vec<Place>,
    cells: Vec<f64>,
}

/// A node on the grid.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// The cell whose centre is next to the south-west.
    cell: u32,
    /// Steps to the next cell to the east and to the north; none beyond the outermost centres, where the mirror image
    /// of the outermost cell is that cell.
    steps: [u32; 2],
    /// Share of the eastern and of the northern cells.
    shares: [f32; 2],
    /// Area of the node over that of a cell.
    area: f64,
}

impl Place {
    /// The four cells around the node and their weights, which sum to one.
    fn corners(&self) -> [(usize, f64); 4] {
        let [x, y] = self.shares.map(f64::from);
        let south_west = self.cell as usize;
        let [east, north] = self.steps.map(|step| step as usize);
        [
            (south_west, (1.0 - x) * (1.0 - y)),
            (south_west + east, x * (1.0 - y)),
            (south_west + north, (1.0 - x) * y),
            (south_west + east + north, x * y),
        ]
    }
}

impl Isostasy {
    /// Places the nodes of `tin` on a grid of cells as square as its sides allow.
    pub fn new(tin: &Tin, params: &IsostasyParams) -> Self {
        let land = tin.extent();
        let beyond = params.margin * land.size();
        let extent = Extent {
            width: land.width + 2.0 * beyond.x,
            height: land.height + 2.0 * beyond.y,
        };
        let size = grid_size(extent);
        let cell_area = extent.area() / (size[0] * size[1]) as f64;
        // The cell before a coordinate, whether there is one after it, and its share.
        let split = |at: f64, side: f64, cells: usize| {
            let along = (at / side * cells as f64 - 0.5).clamp(0.0, (cells - 1) as f64);
            let before = (along as usize).min(cells.saturating_sub(2));
            (before, u32::from(cells > 1), (along - before as f64) as f32)
        };
        let place = |(at, area): (&glam::DVec2, &f64)| {
            let (column, east, x) = split(at.x + beyond.x, extent.width, size[0]);
            let (row, north, y) = split(at.y + beyond.y, extent.height, size[1]);
            Place {
                cell: (row * size[0] + column) as u32,
                steps: [east, north * size[0] as u32],
                shares: [x, y],
                area: area / cell_area,
            }
        };
        Self {
            extent,
            size,
            elastic_thickness: params.elastic_thickness,
            plate: Plate::new(extent, size, params.elastic_thickness),
            places: tin.positions().iter().zip(tin.areas()).map(place).collect(),
            cells: vec![0.0; size[0] * size[1]],
        }
    }

    /// The uplift of the surface (m/yr) for a step of `dt_yr` years in which the crust thickens by `thickening` (m/yr,
    /// before the boost), and the sinking of its root:
    ///
    /// u = ṫ − Flex[ṫ − ė + ḋ],
    ///
    /// ṫ the thickening with its boost, ė and ḋ what was eroded and laid down since the last call, as
    /// [`Crust::book`] was told. One call may stand for several steps of the land: `dt_yr` is the time until the next.
    /// What is not finite weighs nothing. The same bits for any number of threads.
    ///
    /// # Panics
    /// If a slice does not hold one value per node.
    pub fn uplift(
        &mut self,
        crust: &mut Crust,
        thickening: &[f64],
        params: &IsostasyParams,
        dt_yr: f64,
        uplift: &mut [f64],
    ) {
        let nodes = self.places.len();
        let fits = [
            thickening.len(),
            uplift.len(),
            crust.root.len(),
            crust.unanswered.len(),
        ];
        assert!(fits.iter().all(|&len| len == nodes), "one value per node");
        if params.elastic_thickness != self.elastic_thickness {
            self.elastic_thickness = params.elastic_thickness;
            self.plate = Plate::new(self.extent, self.size, params.elastic_thickness);
        }
        self.cells.fill(0.0);
        let gains = thickening.iter().zip(&crust.unanswered);
        for (place, (rate, unanswered)) in self.places.iter().zip(gains) {
            let gained = (params.boost * rate * dt_yr + unanswered) * place.area;
            if gained.is_finite() {
                for (cell, weight) in place.corners() {
                    self.cells[cell] += weight * gained;
                }
            }
        }
        self.plate.sink(&mut self.cells);
        crust.unanswered.fill(0.0);
        let kept = crust.root.iter_mut().zip(uplift.iter_mut().zip(thickening));
        for (place, (root, (uplift, rate))) in self.places.iter().zip(kept) {
            let sunk: f64 = place
                .corners()
                .iter()
                .map(|&(cell, weight)| weight * self.cells[cell])
                .sum();
            *root += sunk;
            *uplift = params.boost * rate - sunk / dt_yr;
        }
    }
}

/// Columns and rows of the grid: multiples of eight, which transform fast.
fn grid_size(extent: Extent) -> [usize; 2] {
    let cell = (extent.area() / CELLS).sqrt();
    [extent.width, extent.height].map(|side| ((side / cell / 8.0).round().clamp(1.0, 128.0) * 8.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::KM;

    #[test]
    fn cells_are_square_on_any_land() {
        let size = |width: f64, height: f64| {
            grid_size(Extent {
                width: width * KM,
                height: height * KM,
            })
        };
        assert_eq!(size(177.8, 100.0), [128, 72]);
        assert_eq!(size(100.0, 100.0), [96, 96]);
        assert_eq!(size(1e6, 1.0), [1024, 8]);
    }

    #[test]
    fn a_range_keeps_a_sixth_to_all_of_its_thickening() {
        let params = IsostasyParams::default();
        assert!((params.rise_share(1e9) - 1.0 / 6.0).abs() < 1e-6);
        assert!(params.rise_share(1e3) > 0.999);
        // α = (4 D / ρm g)^¼ with D = E Te³ / 12 (1 − ν²), for 12 km.
        assert!((params.flexural_length() / KM - 34.1).abs() < 0.2);
    }
}
