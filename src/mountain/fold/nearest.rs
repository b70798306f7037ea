//! Exact distances to many segments.
//!
//! Segments are sorted into square buckets by their middles, row by row, so that those near a place are a few
//! stretches of plain arrays.

use glam::DVec2;
use multiversion::multiversion;

/// Side of a bucket, in wavelengths.
const BUCKET: f64 = 1.0;

/// How far the first look goes, in buckets: most places have a crest and a trough within it.
const FIRST_LOOK: f64 = 0.5;

/// Numbers that a register of the widest target holds.
const LANES: usize = 4;

/// Segments by bucket.
#[derive(Clone, Debug, Default)]
pub(super) struct Segments {
    /// A whole number of buckets from the origin, so that all segments of one wavelength share a lattice.
    south_west: DVec2,
    bucket: f64,
    cols: usize,
    rows: usize,
    /// Segments of bucket i are those from `first[i]` to `first[i + 1]`.
    first: Vec<u32>,
    /// Half the longest.
    half_length: f64,
    columns: Columns,
}

/// Segments `from + t·along`, `t` from 0 to 1.
#[derive(Clone, Debug, Default)]
struct Columns {
    from_x: Vec<f64>,
    from_y: Vec<f64>,
    along_x: Vec<f64>,
    along_y: Vec<f64>,
    /// One over the squared length; 0 for a point.
    inverse: Vec<f64>,
}

/// Where the packed segments of one kind are, and their buckets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedLines {
    /// The south-westernmost bucket's column and row in the lattice of buckets, which are as wide as a wavelength and begin
    /// at the origin.
    pub lattice: [i32; 2],
    /// Columns and rows of buckets; none where there are no segments.
    pub size: [u32; 2],
    /// Where their starts begin.
    pub first: u32,
    /// Half the longest segment, metres.
    pub half_length: f32,
}

/// A segment relative to the middle of a tile or a corner of a bucket, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) from: [f32; 2],
    pub(super) along: [f32; 2],
    pub(super) inverse: f32,
}

impl Segments {
    pub(super) fn new(segments: &[[DVec2; 2]], wavelength: f64) -> Self {
        let middle = |[a, b]: [DVec2; 2]| (a + b) / 2.0;
        let Some(first_middle) = segments.first().map(|&s| middle(s)) else {
            return Self::default();
        };
        let (mut least, mut most, mut longest) = (first_middle, first_middle, 0.0_f64);
        for &segment in segments {
            least = least.min(middle(segment));
            most = most.max(middle(segment));
            longest = longest.max(segment[0].distance_squared(segment[1]));
        }
        let bucket = BUCKET * wavelength;
        let south_west = (least / bucket).floor() * bucket;
        let size = ((most - south_west) / bucket).floor();
        let (cols, rows) = (size.x as usize + 1, size.y as usize + 1);
        let place = |segment: [DVec2; 2]| {
            let at = (middle(segment) - south_west) / bucket;
            at.y as usize * cols + at.x as usize
        };
        let mut first = vec![0_u32; cols * rows + 1];
        for &segment in segments {
            first[place(segment) + 1] += 1;
        }
        for k in 0..cols * rows {
            first[k + 1] += first[k];
        }
        let mut next = first.clone();
        let zeros = || vec![0.0; segments.len()];
        let mut columns = Columns {
            from_x: zeros(),
            from_y: zeros(),
            along_x: zeros(),
            along_y: zeros(),
            inverse: zeros(),
        };
        for &segment in segments {
            let slot = &mut next[place(segment)];
            let at = *slot as usize;
            *slot += 1;
            let [from, to] = segment;
            let along = to - from;
            columns.from_x[at] = from.x;
            columns.from_y[at] = from.y;
            columns.along_x[at] = along.x;
            columns.along_y[at] = along.y;
            let squared = along.length_squared();
            columns.inverse[at] = if squared > 0.0 { 1.0 / squared } else { 0.0 };
        }
        Self {
            south_west,
            bucket,
            cols,
            rows,
            first,
            half_length: longest.sqrt() / 2.0,
            columns,
        }
    }

    /// As [`FoldShape::pack`](super::FoldShape::pack), of one kind of line.
    pub(super) fn pack(&self, starts: &mut Vec<u32>, lines: &mut Vec<[f32; 4]>) -> PackedLines {
        let packed = PackedLines {
            lattice: (self.south_west / self.bucket.max(f64::MIN_POSITIVE))
                .round()
                .as_ivec2()
                .to_array(),
            size: [self.cols as u32, self.rows as u32],
            first: starts.len() as u32,
            half_length: self.half_length as f32,
        };
        let begin = lines.len() as u32;
        starts.extend(self.first.iter().map(|first| begin + first));
        for (bucket, stretch) in self.first.windows(2).enumerate() {
            let place = DVec2::new((bucket % self.cols) as f64, (bucket / self.cols) as f64);
            let corner = self.south_west + place * self.bucket;
            lines.extend((stretch[0]..stretch[1]).map(|k| {
                let near = self.columns.relative(k as usize, corner);
                [near.from[0], near.from[1], near.along[0], near.along[1]]
            }));
        }
        packed
    }

    /// Distance from `p` to the nearest segment, at most `reach`.
    pub(super) fn distance(&self, p: DVec2, reach: f64) -> f64 {
        if self.cols == 0 {
            return reach;
        }
        let mut looked = (FIRST_LOOK * self.bucket).min(reach);
        loop {
            let mut squared = [looked * looked; LANES];
            self.stretches(p, looked, |from, to| {
                self.columns.nearest(p, from, to, &mut squared);
            });
            let found = squared.iter().copied().fold(f64::INFINITY, f64::min).sqrt();
            if found < looked || looked >= reach {
                return found;
            }
            looked = (2.0 * looked).min(reach);
        }
    }

    /// Collects the segments that can be the nearest one of any place within `radius` of `centre`, unless all are
    /// farther than `reach` from all these places.
    pub(super) fn gather(
        &self,
        centre: DVec2,
        radius: f64,
        reach: f64,
        scratch: &mut Vec<f64>,
        out: &mut Vec<Near>,
    ) {
        out.clear();
        if self.cols == 0 {
            return;
        }
        // All segments within `seen` of the centre have been looked at.
        let most = reach + 3.0 * radius;
        let mut seen = (FIRST_LOOK * self.bucket + 2.0 * radius).min(most);
        loop {
            scratch.clear();
            self.stretches(centre, seen, |from, to| {
                self.columns.squared_distances(centre, from, to, scratch);
            });
            let nearest = scratch.iter().copied().fold(f64::INFINITY, f64::min).sqrt();
            // The nearest to the centre is within `nearest + radius` of every place; others have to beat that.
            if nearest + 2.0 * radius > seen && seen < most {
                seen = (2.0 * seen).min(most);
                continue;
            }
            if nearest > reach + radius {
                return;
            }
            // A little more, for the rounding of `f32`.
            let bound = ((nearest + 2.0 * radius) * (1.0 + 1e-6)).powi(2);
            let mut at = 0;
            self.stretches(centre, seen, |from, to| {
                for k in from..to {
                    if scratch[at] <= bound {
                        out.push(self.columns.relative(k, centre));
                    }
                    at += 1;
                }
            });
            return;
        }
    }

    /// Stretches of segments that hold all those within `reach` of `p`.
    fn stretches(&self, p: DVec2, reach: f64, mut stretch: impl FnMut(usize, usize)) {
        let reach = reach + self.half_length;
        let low = (p - reach - self.south_west) / self.bucket;
        let high = (p + reach - self.south_west) / self.bucket;
        if high.x < 0.0 || high.y < 0.0 || low.x >= self.cols as f64 || low.y >= self.rows as f64 {
            return;
        }
        // Casts saturate: below nothing is 0.
        let (west, east) = (low.x as usize, (high.x as usize).min(self.cols - 1));
        for row in low.y as usize..=(high.y as usize).min(self.rows - 1) {
            let from = self.first[row * self.cols + west];
            let to = self.first[row * self.cols + east + 1];
            if from < to {
                stretch(from as usize, to as usize);
            }
        }
    }
}

impl Columns {
    /// Squared distances from `p` to some segments, added to `out`.
    fn squared_distances(&self, p: DVec2, from: usize, to: usize, out: &mut Vec<f64>) {
        let first = out.len();
        out.resize(first + to - from, 0.0);
        squared_distances(
            p,
            [
                &self.from_x[from..to],
                &self.from_y[from..to],
                &self.along_x[from..to],
                &self.along_y[from..to],
                &self.inverse[from..to],
            ],
            &mut out[first..],
        );
    }

    /// Lowers `least` to the squared distances from `p` to some segments.
    fn nearest(&self, p: DVec2, from: usize, to: usize, least: &mut [f64; LANES]) {
        let mut squared = [f64::INFINITY; 4 * LANES];
        for begin in (from..to).step_by(squared.len()) {
            let end = to.min(begin + squared.len());
            squared_distances(
                p,
                [
                    &self.from_x[begin..end],
                    &self.from_y[begin..end],
                    &self.along_x[begin..end],
                    &self.along_y[begin..end],
                    &self.inverse[begin..end],
                ],
                &mut squared[..end - begin],
            );
            for some in squared[..end - begin].chunks(LANES) {
                for (least, &squared) in least.iter_mut().zip(some) {
                    *least = if squared < *least { squared } else { *least };
                }
            }
        }
    }

    fn relative(&self, k: usize, centre: DVec2) -> Near {
        Near {
            from: [
                (self.from_x[k] - centre.x) as f32,
                (self.from_y[k] - centre.y) as f32,
            ],
            along: [self.along_x[k] as f32, self.along_y[k] as f32],
            inverse: self.inverse[k] as f32,
        }
    }
}

/// Squared distances from `p` to segments in columns.
#[multiversion(targets("x86_64+avx2"))]
fn squared_distances(p: DVec2, columns: [&[f64]; 5], out: &mut [f64]) {
    let [from_x, from_y, along_x, along_y, inverse] = columns;
    let columns = from_x.iter().zip(from_y).zip(along_x).zip(along_y).zip(inverse);
    for (out, ((((from_x, from_y), along_x), along_y), inverse)) in out.iter_mut().zip(columns) {
        let (x, y) = (p.x - from_x, p.y - from_y);
        let t = (x * along_x + y * along_y) * inverse;
        let t = if t > 0.0 { t } else { 0.0 };
        let t = if t < 1.0 { t } else { 1.0 };
        let (x, y) = (x - t * along_x, y - t * along_y);
        *out = x * x + y * y;
    }
}
