//! From nodes to pixels: linear for numbers, smooth for pictures.

use glam::DVec2;
use rayon::prelude::*;

use super::smooth::SmoothSheet;
use super::tin::Tin;
use crate::units::Extent;

/// Rows that one task fills. Fixed, so that the work is cut the same way for any number of threads.
const BAND_ROWS: usize = 64;

/// Marks a pixel that no triangle covers yet.
const UNCOVERED: u32 = u32::MAX;

/// Where a pixel centre lies: a triangle and the weights of its first two corners.
#[derive(Clone, Copy, Debug)]
struct Sample {
    triangle: u32,
    weights: [f32; 2],
}

/// The pixel centres of a raster over a [`Tin`], located once and for all.
///
/// Row 0 is the northernmost and values sit at pixel centres, as in [`crate::surface::Raster`]. Pixels outside the
/// hull of the nodes take the nearest values on it. Results are the same bits for any number of threads.
#[derive(Clone, Debug)]
pub struct TinRaster {
    width: usize,
    height: usize,
    extent: Extent,
    triangles: Vec<[u32; 3]>,
    samples: Vec<Sample>,
}

impl TinRaster {
    /// Locates the centres of `width × height` pixels over the TIN's extent.
    pub fn new(tin: &Tin, width: usize, height: usize) -> Self {
        let mut raster = Self {
            width,
            height,
            extent: tin.extent(),
            triangles: tin.triangles().to_vec(),
            samples: vec![
                Sample {
                    triangle: UNCOVERED,
                    weights: [0.0; 2],
                };
                width * height
            ],
        };
        if width > 0 && height > 0 {
            raster.cover(tin);
            raster.extend_beyond_hull(tin);
        }
        raster
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The land it covers.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Centre of a pixel in the plan frame, metres.
    pub fn pixel_centre(&self, column: usize, row: usize) -> DVec2 {
        let pixel = self.pixel_size();
        DVec2::new(
            (column as f64 + 0.5) * pixel.x,
            self.extent.height - (row as f64 + 0.5) * pixel.y,
        )
    }

    /// Nodal values interpolated linearly in each triangle: exact for linear fields (to single precision).
    pub fn linear(&self, values: &[f64]) -> Vec<f32> {
        let mut pixels = Vec::new();
        self.linear_into(values, &mut pixels);
        pixels
    }

    /// The same into memory that is reused: `pixels` gets one value per pixel.
    pub fn linear_into(&self, values: &[f64], pixels: &mut Vec<f32>) {
        self.map_rows(pixels, |sample| {
            let [a, b, c] = self.triangles[sample.triangle as usize].map(|k| values[k as usize] as f32);
            let [u, v] = sample.weights;
            c + u * (a - c) + v * (b - c)
        });
    }

    /// Nodal values interpolated by a surface with continuous slopes, for shading.
    ///
    /// Exact at the nodes and for linear fields; see `Patch` for the scheme. `tin` is the one the raster was made
    /// for.
    pub fn smooth(&self, tin: &Tin, values: &[f64]) -> Vec<f32> {
        let mut pixels = Vec::new();
        self.smooth_into(tin, values, &mut SmoothSheet::default(), &mut pixels);
        pixels
    }

    /// The same into memory that is reused: `pixels` gets one value per pixel.
    pub fn smooth_into(&self, tin: &Tin, values: &[f64], sheet: &mut SmoothSheet, pixels: &mut Vec<f32>) {
        let patches = sheet.lay(tin, values);
        self.map_rows(pixels, |sample| {
            patches[sample.triangle as usize].height(sample.weights)
        });
    }

    fn map_rows(&self, pixels: &mut Vec<f32>, value: impl Fn(Sample) -> f32 + Sync) {
        pixels.resize(self.samples.len(), 0.0);
        let row = self.width.max(1);
        pixels
            .par_chunks_mut(row)
            .zip(self.samples.par_chunks(row))
            .for_each(|(pixels, samples)| {
                for (pixel, &sample) in pixels.iter_mut().zip(samples) {
                    *pixel = value(sample);
                }
            });
    }

    fn pixel_size(&self) -> DVec2 {
        DVec2::new(
            self.extent.width / self.width as f64,
            self.extent.height / self.height as f64,
        )
    }

    /// Rows whose centres lie between two heights (the northern one first), a sliver of rounding included.
    fn rows_between(&self, south: f64, north: f64) -> std::ops::Range<usize> {
        centres_between(
            (self.extent.height - north) / self.pixel_size().y,
            (self.extent.height - south) / self.pixel_size().y,
            self.height,
        )
    }

    /// Fills each pixel whose centre lies in a triangle. A centre on a shared edge may go to either side: the
    /// interpolants agree there.
    fn cover(&mut self, tin: &Tin) {
        let corners: Vec<[DVec2; 3]> = self
            .triangles
            .iter()
            .map(|triangle| triangle.map(|k| tin.positions()[k as usize]))
            .collect();
        let bands = self.height.div_ceil(BAND_ROWS);
        let mut triangles_of_band: Vec<Vec<u32>> = vec![Vec::new(); bands];
        for (index, [a, b, c]) in corners.iter().enumerate() {
            let rows = self.rows_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
            if !rows.is_empty() {
                for band in &mut triangles_of_band[rows.start / BAND_ROWS..=(rows.end - 1) / BAND_ROWS] {
                    band.push(index as u32);
                }
            }
        }
        let mut samples = std::mem::take(&mut self.samples);
        samples
            .par_chunks_mut(BAND_ROWS * self.width)
            .zip(&triangles_of_band)
            .enumerate()
            .for_each(|(band, (samples, triangles))| {
                for &triangle in triangles {
                    self.cover_triangle(samples, band * BAND_ROWS, triangle, corners[triangle as usize]);
                }
            });
        self.samples = samples;
    }

    /// Scan-converts one triangle into the rows of a band that begins at `first_row`.
    fn cover_triangle(&self, samples: &mut [Sample], first_row: usize, triangle: u32, corners: [DVec2; 3]) {
        let [a, b, c] = corners;
        let pixel = self.pixel_size();
        let doubled_area = (b - a).perp_dot(c - a);
        // A needle along the hull may have no area left in double precision, and then no pixels.
        if doubled_area <= 0.0 {
            return;
        }
        let (along_u, along_v) = ((c - b) / doubled_area, (a - c) / doubled_area);
        let rows = self.rows_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        let band_end = first_row + samples.len() / self.width;
        for row in rows.start.max(first_row)..rows.end.min(band_end) {
            let y = self.pixel_centre(0, row).y;
            let (mut west, mut east) = (f64::INFINITY, f64::NEG_INFINITY);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let t = if from.y == to.y {
                    0.0
                } else {
                    ((y - from.y) / (to.y - from.y)).clamp(0.0, 1.0)
                };
                let x = from.x + t * (to.x - from.x);
                // An edge counts where it meets the row; one that ends short of it only within rounding.
                let miss = (from.y + t * (to.y - from.y) - y).abs();
                if miss <= ROUNDING * pixel.y {
                    west = west.min(x);
                    east = east.max(x);
                    if from.y == to.y {
                        west = west.min(to.x);
                        east = east.max(to.x);
                    }
                }
            }
            if west > east {
                continue;
            }
            let columns = centres_between(west / pixel.x, east / pixel.x, self.width);
            let row_start = (row - first_row) * self.width;
            for column in columns {
                let p = DVec2::new((column as f64 + 0.5) * pixel.x, y);
                samples[row_start + column] = Sample {
                    triangle,
                    weights: [along_u.perp_dot(p - b) as f32, along_v.perp_dot(p - c) as f32],
                };
            }
        }
    }

    /// Gives pixels outside the hull the nearest covered pixel's triangle, and the point of it nearest in weights.
    fn extend_beyond_hull(&mut self, tin: &Tin) {
        let covered = |samples: &[Sample], k: usize| samples[k].triangle != UNCOVERED;
        let mut front: Vec<usize> = (0..self.samples.len())
            .filter(|&k| covered(&self.samples, k))
            .collect();
        if front.len() == self.samples.len() {
            return;
        }
        if front.is_empty() {
            // The whole hull lies between pixel centres.
            self.samples[0] = self.clamped_sample(tin, 0, 0);
            front.push(0);
        }
        while !front.is_empty() {
            let mut next = Vec::new();
            for k in front {
                let (row, column) = (k / self.width, k % self.width);
                let beside = [
                    (column > 0).then(|| k - 1),
                    (column + 1 < self.width).then(|| k + 1),
                    (row > 0).then(|| k - self.width),
                    (row + 1 < self.height).then(|| k + self.width),
                ];
                for to in beside.into_iter().flatten() {
                    if !covered(&self.samples, to) {
                        self.samples[to] = self.clamped_sample(tin, to, self.samples[k].triangle);
                        next.push(to);
                    }
                }
            }
            front = next;
        }
    }

    /// The weights of pixel `index` in a triangle it lies outside of, without the negative ones.
    fn clamped_sample(&self, tin: &Tin, index: usize, triangle: u32) -> Sample {
        let p = self.pixel_centre(index % self.width, index / self.width);
        let [a, b, c] = self.triangles[triangle as usize].map(|k| tin.positions()[k as usize]);
        let weights = [
            (c - b).perp_dot(p - b),
            (a - c).perp_dot(p - c),
            (b - a).perp_dot(p - a),
        ];
        let weights = weights.map(|w| w.max(0.0));
        let sum: f64 = weights.iter().sum();
        Sample {
            triangle,
            weights: [(weights[0] / sum) as f32, (weights[1] / sum) as f32],
        }
    }
}

/// Share of a pixel by which spans are widened, so that no centre on a shared edge falls between two triangles.
const ROUNDING: f64 = 1e-9;

/// Indices `k` below `count` with `from ≤ k + ½ ≤ to`, rounding included.
fn centres_between(from: f64, to: f64, count: usize) -> std::ops::Range<usize> {
    let first = (from - 0.5 - ROUNDING).ceil().max(0.0) as usize;
    let end = ((to - 0.5 + ROUNDING).floor() + 1.0).max(0.0) as usize;
    first..end.min(count).max(first)
}
