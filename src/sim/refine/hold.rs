//! Keeps the large shape of a land while its details are cut.

use glam::DVec2;

use crate::terrain::Tin;

/// Cells per standard deviation of the mean: fine enough that the grid itself does not show.
const CELLS_PER_RADIUS: f64 = 3.0;

/// Passes of a running mean that make a bell: three are within 3 % of a Gaussian.
const PASSES: usize = 3;

/// The uplift that keeps a land, averaged over some kilometres, at the heights of another.
///
/// While a land is refined no geological time passes for it as a whole: what rivers and slides take, averaged over a
/// bell of some radius, rises again in the next step. Valleys and ridges narrower than that are free.
#[derive(Clone, Debug)]
pub(super) struct Hold {
    cols: usize,
    rows: usize,
    /// Half the width of a running mean, cells.
    half: usize,
    /// For each node the cell centre to its south-west, and how far it lies beyond it (0–1).
    places: Vec<(u32, [f32; 2])>,
    /// Area of the nodes of each cell, m², averaged like the sums.
    weights: Vec<f64>,
    cells: Vec<f64>,
    scratch: Vec<f64>,
}

impl Hold {
    /// For the nodes of `tin`, with a bell whose standard deviation is `radius` metres.
    pub(super) fn new(tin: &Tin, radius: f64) -> Self {
        let extent = tin.extent();
        let cell = radius / CELLS_PER_RADIUS;
        let count = |length: f64| ((length / cell).ceil() as usize).max(2);
        let (cols, rows) = (count(extent.width), count(extent.height));
        let size = extent.size() / DVec2::new(cols as f64, rows as f64);
        let places = tin.positions().iter().map(|&p| {
            let at = (p / size - 0.5).clamp(DVec2::ZERO, DVec2::new((cols - 1) as f64, (rows - 1) as f64));
            let (col, row) = ((at.x as usize).min(cols - 2), (at.y as usize).min(rows - 2));
            let part = at - DVec2::new(col as f64, row as f64);
            ((row * cols + col) as u32, [part.x as f32, part.y as f32])
        });
        // The variance of a running mean over 2 h + 1 cells is ((2 h + 1)² − 1) / 12.
        let width = (12.0 * CELLS_PER_RADIUS * CELLS_PER_RADIUS / PASSES as f64 + 1.0).sqrt();
        let mut hold = Self {
            cols,
            rows,
            half: ((width - 1.0) / 2.0).round().max(1.0) as usize,
            places: places.collect(),
            weights: Vec::new(),
            cells: vec![0.0; cols * rows],
            scratch: vec![0.0; cols * rows],
        };
        hold.spread(tin.areas().iter().copied());
        hold.weights = hold.cells.clone();
        hold
    }

    /// The mean around each node of what `wanted` is above `z` (both metres), into `rise`.
    pub(super) fn rise(&mut self, tin: &Tin, wanted: &[f64], z: &[f64], rise: &mut Vec<f64>) {
        let missing = tin.areas().iter().zip(wanted.iter().zip(z));
        self.spread(missing.map(|(area, (wanted, z))| area * (wanted - z)));
        for (sum, weight) in self.cells.iter_mut().zip(&self.weights) {
            // Far from all nodes nobody asks.
            *sum /= weight.max(f64::MIN_POSITIVE);
        }
        rise.clear();
        rise.extend(self.places.iter().map(|&(cell, [east, north])| {
            let cell = cell as usize;
            let (east, north) = (f64::from(east), f64::from(north));
            let row = |first: usize| self.cells[first] * (1.0 - east) + self.cells[first + 1] * east;
            row(cell) * (1.0 - north) + row(cell + self.cols) * north
        }));
    }

    /// Sums `amounts` of the nodes in cells, and averages the cells over the bell.
    fn spread(&mut self, amounts: impl Iterator<Item = f64>) {
        self.cells.fill(0.0);
        for (&(cell, [east, north]), amount) in self.places.iter().zip(amounts) {
            let (cell, east, north) = (cell as usize, f64::from(east), f64::from(north));
            for (first, part) in [(cell, 1.0 - north), (cell + self.cols, north)] {
                self.cells[first] += amount * part * (1.0 - east);
                self.cells[first + 1] += amount * part * east;
            }
        }
        for _ in 0..PASSES {
            for row in 0..self.rows {
                let line = row * self.cols;
                running_sum(&self.cells, &mut self.scratch, (line, 1, self.cols), self.half);
            }
            for col in 0..self.cols {
                running_sum(
                    &self.scratch,
                    &mut self.cells,
                    (col, self.cols, self.rows),
                    self.half,
                );
            }
        }
    }
}

/// Sums over `2 half + 1` cells of a line of `count` cells from `first` in steps of `step`, fewer at its ends.
fn running_sum(from: &[f64], to: &mut [f64], (first, step, count): (usize, usize, usize), half: usize) {
    for k in 0..count {
        let near = k.saturating_sub(half)..=(k + half).min(count - 1);
        to[first + k * step] = near.map(|k| from[first + k * step]).sum();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Extent;

    const LAND: Extent = Extent {
        width: 40e3,
        height: 30e3,
    };

    fn mean(tin: &Tin, values: &[f64]) -> f64 {
        values.iter().zip(tin.areas()).map(|(v, a)| v * a).sum::<f64>() / LAND.area()
    }

    #[test]
    fn a_plain_difference_is_made_up_everywhere() {
        let tin = Tin::poisson(LAND, 3000, 1).unwrap();
        let mut hold = Hold::new(&tin, 3e3);
        let mut rise = Vec::new();
        hold.rise(&tin, &vec![250.0; tin.len()], &vec![100.0; tin.len()], &mut rise);
        assert!(rise.iter().all(|rise| (rise - 150.0).abs() < 1e-9));
    }

    #[test]
    fn wide_waves_are_made_up_and_narrow_ones_are_free() {
        let tin = Tin::poisson(LAND, 20_000, 1).unwrap();
        let mut hold = Hold::new(&tin, 1e3);
        let zero = vec![0.0; tin.len()];
        let mut share = |wavelength: f64| {
            let wave: Vec<f64> = tin
                .positions()
                .iter()
                .map(|p| 100.0 * (std::f64::consts::TAU * p.x / wavelength).sin())
                .collect();
            let mut rise = Vec::new();
            hold.rise(&tin, &wave, &zero, &mut rise);
            let product: Vec<f64> = rise.iter().zip(&wave).map(|(a, b)| a * b).collect();
            let square: Vec<f64> = wave.iter().map(|a| a * a).collect();
            mean(&tin, &product) / mean(&tin, &square)
        };
        // A Gaussian of 1 km passes exp(−2 (π σ / λ)²) of a wave.
        let (wide, middle, narrow) = (share(20e3), share(6e3), share(2e3));
        assert!((0.9..1.0).contains(&wide), "{wide}");
        assert!((0.45..0.7).contains(&middle), "{middle}");
        assert!(narrow.abs() < 0.05, "{narrow}");
    }
}
