//! Scalar fields on the picture's pixels: resampling, blurring, gradients.

use rayon::prelude::*;

use crate::surface::Raster;

/// Values on the map's pixels, row 0 in the north.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) data: Vec<f32>,
}

impl Field {
    /// A raster brought to `width × height` pixels over the same land: cubic between cells where pixels are finer,
    /// a weighted mean of cells where they are coarser.
    pub(super) fn resampled(raster: &Raster, width: usize, height: usize) -> Self {
        if (raster.width, raster.height) == (width, height) {
            return Self {
                width,
                height,
                data: raster.data.clone(),
            };
        }
        let columns = Taps::new(raster.width, width);
        let mut narrow = vec![0.0; width * raster.height];
        narrow
            .par_chunks_mut(width)
            .zip(raster.data.par_chunks(raster.width))
            .for_each(|(out, row)| {
                for (value, (first, weights)) in out.iter_mut().zip(columns.iter()) {
                    *value = weights.iter().zip(&row[first..]).map(|(w, v)| w * v).sum();
                }
            });
        let rows = Taps::new(raster.height, height);
        let mut data = vec![0.0; width * height];
        data.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
            let (first, weights) = rows.at(y);
            for (i, weight) in weights.iter().enumerate() {
                let row = &narrow[(first + i) * width..][..width];
                for (value, v) in out.iter_mut().zip(row) {
                    *value += weight * v;
                }
            }
        });
        Self { width, height, data }
    }

    /// Gaussian blur of standard deviation `sigma` pixels, by three box filters a side (Wells 1986); borders repeat.
    pub(super) fn blurred(&self, sigma: f32) -> Self {
        let radius = box_radius(sigma);
        let mut field = self.clone();
        if radius <= 0.0 {
            return field;
        }
        let mut other = vec![0.0; field.data.len()];
        for _ in 0..3 {
            box_rows(&field.data, &mut other, self.width, radius);
            box_columns(&other, &mut field.data, self.width, self.height, radius);
        }
        field
    }

    /// Gradient at a pixel (east, north), per pixel, by central differences.
    #[inline]
    pub(super) fn gradient(&self, x: usize, y: usize) -> (f32, f32) {
        let (west, east) = (x.saturating_sub(1), (x + 1).min(self.width - 1));
        let (north, south) = (y.saturating_sub(1), (y + 1).min(self.height - 1));
        let row = y * self.width;
        (
            (self.data[row + east] - self.data[row + west]) * 0.5,
            (self.data[north * self.width + x] - self.data[south * self.width + x]) * 0.5,
        )
    }

    /// Value between pixels (pixel centres at whole numbers), bilinear, clamped.
    #[inline]
    pub(super) fn sample(&self, x: f32, y: f32) -> f32 {
        let x = x.clamp(0.0, (self.width - 1) as f32);
        let y = y.clamp(0.0, (self.height - 1) as f32);
        let (x0, y0) = (x as usize, y as usize);
        let (x1, y1) = ((x0 + 1).min(self.width - 1), (y0 + 1).min(self.height - 1));
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        let at = |x: usize, y: usize| self.data[y * self.width + x];
        let north = at(x0, y0) + (at(x1, y0) - at(x0, y0)) * fx;
        let south = at(x0, y1) + (at(x1, y1) - at(x0, y1)) * fx;
        north + (south - north) * fy
    }
}

/// Which source cells make up each target pixel along one axis.
struct Taps {
    count: usize,
    first: Vec<usize>,
    weights: Vec<f32>,
}

impl Taps {
    fn new(from: usize, to: usize) -> Self {
        let ratio = from as f64 / to as f64;
        // The kernel spans two cells a side, or two pixels where those are larger.
        let stretch = ratio.max(1.0);
        let count = ((4.0 * stretch).ceil() as usize + 1).min(from);
        let mut first = Vec::with_capacity(to);
        let mut weights = Vec::with_capacity(to * count);
        for target in 0..to {
            let centre = (target as f64 + 0.5) * ratio - 0.5;
            let start = ((centre - 2.0 * stretch).ceil().max(0.0) as usize).min(from - count);
            let raw: Vec<f64> = (start..start + count)
                .map(|cell| catmull_rom((cell as f64 - centre) / stretch))
                .collect();
            let sum: f64 = raw.iter().sum();
            first.push(start);
            weights.extend(raw.iter().map(|w| (w / sum) as f32));
        }
        Self {
            count,
            first,
            weights,
        }
    }

    fn at(&self, target: usize) -> (usize, &[f32]) {
        (
            self.first[target],
            &self.weights[target * self.count..][..self.count],
        )
    }

    fn iter(&self) -> impl Iterator<Item = (usize, &[f32])> {
        self.first.iter().copied().zip(self.weights.chunks(self.count))
    }
}

/// Interpolating cubic kernel (Catmull & Rom 1974).
fn catmull_rom(x: f64) -> f64 {
    let x = x.abs();
    if x < 1.0 {
        (1.5 * x - 2.5) * x * x + 1.0
    } else if x < 2.0 {
        ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0
    } else {
        0.0
    }
}

/// Half-width of each of three boxes that together have variance `sigma²`: `w` whole values a side, and a part `f`
/// of the next ones, have variance `(w(w+1)(2w+1)/3 + 2f(w+1)²) / (2w+1+2f)`, solved for `f`.
fn box_radius(sigma: f32) -> f32 {
    let variance = sigma * sigma / 3.0;
    let whole = (((12.0 * variance + 1.0).sqrt() - 1.0) * 0.5).floor();
    let count = 2.0 * whole + 1.0;
    let spread = whole * (whole + 1.0) * count / 3.0;
    whole + (variance * count - spread) / (2.0 * ((whole + 1.0).powi(2) - variance))
}

/// Mean over `2 radius + 1` values along one line, ends weighted by the fraction of the radius; borders repeat.
fn box_line(line: &[f32], out: &mut [f32], radius: f32) {
    let whole = radius as usize;
    let part = radius - whole as f32;
    let scale = 1.0 / (2.0 * radius + 1.0);
    let last = line.len() - 1;
    let at = |i: isize| line[i.clamp(0, last as isize) as usize];
    let reach = whole as isize;
    // f64 keeps the running sum exact enough over the whole line.
    let mut sum: f64 = (-reach..=reach).map(|i| f64::from(at(i))).sum();
    for (i, value) in out.iter_mut().enumerate() {
        let i = i as isize;
        let ends = at(i - reach - 1) + at(i + reach + 1);
        *value = ((sum as f32) + part * ends) * scale;
        sum += f64::from(at(i + reach + 1)) - f64::from(at(i - reach));
    }
}

fn box_rows(data: &[f32], out: &mut [f32], width: usize, radius: f32) {
    out.par_chunks_mut(width)
        .zip(data.par_chunks(width))
        .for_each(|(out, line)| box_line(line, out, radius));
}

/// Columns, in bands of neighbouring ones so that memory is read in rows. Bands are fixed: sums do not depend on
/// the number of threads.
fn box_columns(data: &[f32], out: &mut [f32], width: usize, height: usize, radius: f32) {
    let whole = radius as usize;
    let part = radius - whole as f32;
    let scale = 1.0 / (2.0 * radius + 1.0);
    let row = |y: isize| &data[y.clamp(0, height as isize - 1) as usize * width..][..width];
    let reach = whole as isize;
    let rows_per_band = height.div_ceil(BANDS).max(1);
    out.par_chunks_mut(rows_per_band * width)
        .enumerate()
        .for_each(|(band, out)| {
            let start = (band * rows_per_band) as isize;
            let mut sums = vec![0.0_f64; width];
            for y in start - reach..=start + reach {
                for (sum, v) in sums.iter_mut().zip(row(y)) {
                    *sum += f64::from(*v);
                }
            }
            for (i, out) in out.chunks_mut(width).enumerate() {
                let y = start + i as isize;
                let (above, below, leaving) = (row(y - reach - 1), row(y + reach + 1), row(y - reach));
                for x in 0..width {
                    out[x] = ((sums[x] as f32) + part * (above[x] + below[x])) * scale;
                    sums[x] += f64::from(below[x]) - f64::from(leaving[x]);
                }
            }
        });
}

/// Bands a blur over columns is cut into.
const BANDS: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Extent;

    #[test]
    fn resampling_keeps_a_plane_and_its_orientation() {
        let extent = Extent {
            width: 900.0,
            height: 600.0,
        };
        let plane = Raster::from_fn(45, 30, extent, |p| (p.x + 10.0 * p.y) as f32);
        for (width, height) in [(90, 60), (30, 20), (45, 30)] {
            let field = Field::resampled(&plane, width, height);
            let expected = Raster::from_fn(width, height, extent, |p| (p.x + 10.0 * p.y) as f32);
            let inner = (height / 2) * width + width / 2;
            // Averaging kernels centre on fractions of cells: three hundredths of a cell is what that costs.
            let error = (field.data[inner] - expected.data[inner]).abs();
            assert!(error < 0.03 * 220.0, "{error}");
            assert!(
                field.data[0] > field.data[(height - 1) * width],
                "north stays the first row"
            );
        }
    }

    #[test]
    fn blur_has_the_variance_it_was_asked_for_and_keeps_the_sum() {
        for sigma in [0.4_f32, 1.0, 3.3, 9.0] {
            let mut spike = Field {
                width: 101,
                height: 91,
                data: vec![0.0; 101 * 91],
            };
            spike.data[45 * 101 + 50] = 1.0;
            let blurred = spike.blurred(sigma);
            let (mut sum, mut variance) = (0.0, 0.0);
            for y in 0..91 {
                for x in 0..101 {
                    let v = blurred.data[y * 101 + x];
                    sum += v;
                    variance += v * (x as f32 - 50.0).powi(2);
                }
            }
            assert!((sum - 1.0).abs() < 1e-3, "σ {sigma}: sum {sum}");
            assert!(
                (variance.sqrt() - sigma).abs() < 0.01 * sigma,
                "σ {sigma}: {}",
                variance.sqrt()
            );
        }
    }
}
