//! A thin elastic plate on a fluid mantle, under loads on a grid.

use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use rustdct::{DctPlanner, TransformType2And3};

use crate::units::Extent;

/// Young's modulus of the plate, Pa.
const YOUNG: f64 = 7e10;
/// Poisson's ratio of the plate.
const POISSON: f64 = 0.25;
/// Gravity, m/s².
const GRAVITY: f64 = 9.81;
/// Density of crust and sediment, kg/m³.
const CRUST_DENSITY: f64 = 2750.0;
/// Density of the mantle, kg/m³.
const MANTLE_DENSITY: f64 = 3300.0;

/// How much of a layer of rock of wavelength `wavelength` (m) sinks into the mantle, for an elastic thickness in m:
/// φ of [`Plate`].
pub(super) fn sunk_share(elastic_thickness: f64, wavelength: f64) -> f64 {
    share(elastic_thickness, (2.0 * PI / wavelength).powi(2))
}

/// Length over which the plate hands a line load to its sides, m: α = (4 D / ρm g)^¼.
pub(super) fn flexural_length(elastic_thickness: f64) -> f64 {
    (4.0 * stiffness(elastic_thickness)).powf(0.25)
}

/// D / (ρm g), m⁴, with the flexural rigidity D = E Te³ / 12 (1 − ν²).
fn stiffness(elastic_thickness: f64) -> f64 {
    let rigidity = YOUNG * elastic_thickness.powi(3) / (12.0 * (1.0 - POISSON * POISSON));
    rigidity / (MANTLE_DENSITY * GRAVITY)
}

fn share(elastic_thickness: f64, wavenumber_squared: f64) -> f64 {
    CRUST_DENSITY / MANTLE_DENSITY / (1.0 + stiffness(elastic_thickness) * wavenumber_squared.powi(2))
}

/// The plate: the response of a grid of cells to loads on them.
///
/// Rock of thickness h on the surface presses with ρc g h and bends the plate down by w until its stiffness and the
/// mantle it pushes aside carry the load:
///
/// D ∇⁴w + ρm g w = ρc g h.
///
/// The restoring density is the mantle's alone, since what fills the hollow above is air: rock that gathers there
/// is a load of its own when it arrives. A cosine of wavenumber k so sinks by φ(k) h,
///
/// φ(k) = (ρc / ρm) / (1 + D k⁴ / ρm g),
///
/// ρc / ρm = 5/6 for wide loads and for a plate without strength (Airy), nothing for narrow loads on a stiff one
/// (Turcotte & Schubert 2014, *Geodynamics*, §§ 3.13–3.16, whose constants these are). The crust beyond the border
/// mirrors the land, so that no rim needs a condition and cosines are the eigenfunctions.
#[derive(Clone)]
pub struct Plate {
    size: [usize; 2],
    along_x: Arc<dyn TransformType2And3<f64>>,
    along_y: Arc<dyn TransformType2And3<f64>>,
    /// φ of each pair of wavenumbers over the scale of the two transforms, column by column.
    shares: Vec<f64>,
    /// The grid column by column.
    turned: Vec<f64>,
    scratch: Vec<f64>,
}

impl Plate {
    /// A plate under `size` cells (west–east, south–north) of `extent`, with an elastic thickness in metres; 0 has no
    /// strength.
    ///
    /// # Panics
    /// If a side has no cells.
    pub fn new(extent: Extent, size: [usize; 2], elastic_thickness: f64) -> Self {
        assert!(size[0] > 0 && size[1] > 0, "a plate needs cells");
        let mut planner = DctPlanner::new();
        let along_x = planner.plan_dct2(size[0]);
        let along_y = planner.plan_dct2(size[1]);
        let scratch = along_x.get_scratch_len().max(along_y.get_scratch_len());
        let cells = size[0] * size[1];
        // The third transform undoes the second but for half the length.
        let scale = 4.0 / cells as f64;
        let square = |index: usize, side: f64| (PI * index as f64 / side).powi(2);
        let shares = (0..cells).map(|cell| {
            let (column, row) = (cell / size[1], cell % size[1]);
            let squared = square(column, extent.width) + square(row, extent.height);
            scale * share(elastic_thickness, squared)
        });
        Self {
            size,
            along_x,
            along_y,
            shares: shares.collect(),
            turned: vec![0.0; cells],
            scratch: vec![0.0; scratch],
        }
    }

    /// Replaces the thickness of rock on each cell (m, row by row) by the depth to which the plate sinks under it (m).
    ///
    /// # Panics
    /// If there is not one value per cell.
    pub fn sink(&mut self, cells: &mut [f64]) {
        let [columns, rows] = self.size;
        assert_eq!(cells.len(), columns * rows, "one load per cell");
        for row in cells.chunks_exact_mut(columns) {
            self.along_x.process_dct2_with_scratch(row, &mut self.scratch);
        }
        turn(cells, columns, &mut self.turned);
        for (column, shares) in self
            .turned
            .chunks_exact_mut(rows)
            .zip(self.shares.chunks_exact(rows))
        {
            self.along_y.process_dct2_with_scratch(column, &mut self.scratch);
            for (amplitude, share) in column.iter_mut().zip(shares) {
                *amplitude *= share;
            }
            self.along_y.process_dct3_with_scratch(column, &mut self.scratch);
        }
        turn(&self.turned, rows, cells);
        for row in cells.chunks_exact_mut(columns) {
            self.along_x.process_dct3_with_scratch(row, &mut self.scratch);
        }
    }
}

impl fmt::Debug for Plate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Plate")
            .field("size", &self.size)
            .finish_non_exhaustive()
    }
}

/// Writes a grid of rows of `width` values column by column.
fn turn(from: &[f64], width: usize, to: &mut [f64]) {
    let height = from.len() / width;
    for (column, values) in to.chunks_exact_mut(height).enumerate() {
        for (value, row) in values.iter_mut().zip(from.chunks_exact(width)) {
            *value = row[column];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::KM;

    const LAND: Extent = Extent {
        width: 180.0 * KM,
        height: 100.0 * KM,
    };
    const SIZE: [usize; 2] = [128, 72];

    fn grid(extent: Extent, size: [usize; 2], value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let centre = |k: usize, n: usize, side: f64| (k as f64 + 0.5) / n as f64 * side;
        (0..size[0] * size[1])
            .map(|cell| {
                let (row, column) = (cell / size[0], cell % size[0]);
                value(
                    centre(column, size[0], extent.width),
                    centre(row, size[1], extent.height),
                )
            })
            .collect()
    }

    #[test]
    fn a_cosine_sinks_by_its_share() {
        for elastic_thickness in [0.0_f64, 5e3, 20e3, 60e3] {
            for [p, q] in [[0.0, 0.0], [1.0, 0.0], [0.0, 3.0], [2.0, 1.0], [40.0, 17.0]] {
                let wave =
                    |x: f64, y: f64| (PI * p * x / LAND.width).cos() * (PI * q * y / LAND.height).cos();
                let load = grid(LAND, SIZE, |x, y| 1000.0 * wave(x, y));
                let squared = (PI * p / LAND.width).powi(2) + (PI * q / LAND.height).powi(2);
                let rigidity = 7e10 * elastic_thickness.powi(3) / 11.25;
                let expected = (2750.0 / 3300.0) / (1.0 + rigidity * squared * squared / (3300.0 * 9.81));
                let mut sunk = load.clone();
                Plate::new(LAND, SIZE, elastic_thickness).sink(&mut sunk);
                for (sunk, load) in sunk.iter().zip(&load) {
                    assert!((sunk - expected * load).abs() < 1e-10 * 1000.0);
                }
            }
        }
    }

    #[test]
    fn no_strength_is_airy_and_endless_strength_moves_as_one() {
        let load = grid(
            LAND,
            SIZE,
            |x, y| if x < 30e3 && y > 40e3 { 2000.0 } else { 10.0 },
        );
        let mut airy = load.clone();
        Plate::new(LAND, SIZE, 0.0).sink(&mut airy);
        for (sunk, load) in airy.iter().zip(&load) {
            assert!((sunk - load / 1.2).abs() < 1e-9);
        }
        let mean = load.iter().sum::<f64>() / load.len() as f64;
        let mut rigid = load;
        Plate::new(LAND, SIZE, 1e8).sink(&mut rigid);
        for sunk in rigid {
            assert!((sunk - mean / 1.2).abs() < 1e-3 * mean);
        }
    }

    #[test]
    fn a_line_of_rock_bends_the_plate_as_the_closed_form_says() {
        // w = w0 e^(−x/α) (cos x/α + sin x/α), w0 = V α³ / 8 D for a weight V per length (T&S § 3.16); the land is so
        // long that its mirror image is far away.
        let land = Extent {
            width: 1000.0 * KM,
            height: 20.0 * KM,
        };
        let size = [1000, 4];
        let elastic_thickness: f64 = 15e3;
        let mut cells = vec![0.0; 4000];
        for row in 0..4 {
            cells[row * 1000 + 500] = 3000.0;
        }
        Plate::new(land, size, elastic_thickness).sink(&mut cells);
        let alpha = flexural_length(elastic_thickness);
        let rigidity = YOUNG * elastic_thickness.powi(3) / 11.25;
        assert!((alpha - (4.0 * rigidity / (3300.0 * 9.81)).powf(0.25)).abs() < 1e-6);
        let weight = 2750.0 * 9.81 * 3000.0 * 1e3;
        let w0 = weight * alpha.powi(3) / (8.0 * rigidity);
        for k in 0..400 {
            let x = k as f64 * 1e3 / alpha;
            let expected = w0 * (-x).exp() * (x.cos() + x.sin());
            let found = cells[1000 + 500 + k];
            assert!(
                (found - expected).abs() < 0.002 * w0,
                "{k} km: {found}, {expected}"
            );
        }
        // The forebulge is highest at x = π α, by e^−π of the depth.
        let bulge = cells[..1000].iter().copied().fold(f64::INFINITY, f64::min);
        assert!((bulge / (-w0 * (-PI).exp()) - 1.0).abs() < 0.01, "{bulge}");
    }

    #[test]
    fn the_response_is_linear_and_keeps_the_weight() {
        let mut plate = Plate::new(LAND, SIZE, 12e3);
        let a = grid(LAND, SIZE, |x, y| (x * 1e-4).sin() + (y * 3e-4).cos());
        let b = grid(LAND, SIZE, |x, y| (x * y * 1e-9).sin());
        let mut sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 3.0 * a - 2.0 * b).collect();
        let (mut of_a, mut of_b) = (a.clone(), b);
        plate.sink(&mut sum);
        plate.sink(&mut of_a);
        plate.sink(&mut of_b);
        for k in 0..sum.len() {
            assert!((sum[k] - (3.0 * of_a[k] - 2.0 * of_b[k])).abs() < 1e-12);
        }
        let mean = |cells: &[f64]| cells.iter().sum::<f64>() / cells.len() as f64;
        assert!((mean(&of_a) / mean(&a) * 1.2 - 1.0).abs() < 1e-12);
    }
}
