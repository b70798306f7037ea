//! Fibonacci samples and their inverse.

use std::f64::consts::{PI, TAU};

use glam::{DMat2, DVec2, DVec3};
use rayon::prelude::*;

use super::mesh::Mesh;

/// Least and greatest number of samples.
pub const SAMPLES_RANGE: (usize, usize) = (1_000, 1_000_000);

/// Samples of a tile: points and neighbours of that many fit into the nearest cache.
const TILE: usize = 100;

/// Least weight of a corner, of all three together, at which a place still counts as inside a triangle. Rounding makes
/// 10⁻¹¹ of the smallest triangles.
const ON_EDGE: f64 = 1e-10;

/// The golden ratio.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// Why there is no lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LatticeError {
    /// The number of samples is outside [`SAMPLES_RANGE`].
    #[error("samples: expected {} to {}, found {found}", SAMPLES_RANGE.0, SAMPLES_RANGE.1)]
    Size {
        /// How many were asked for.
        found: usize,
    },
    /// The triangulation did not close: an inner fault.
    #[error("the triangulation of {0} samples does not close")]
    Open(usize),
}

/// Nearly evenly spread samples on the unit sphere, their Delaunay triangulation and the inverse look-up.
///
/// Turn `t` of `n` on the spiral is the sample at height `z = 1 − (2t + 1)/n` and longitude `2π frac(t/φ)` (spherical
/// Fibonacci point set, Keinert et al. 2015). Areas of cells differ by 12 % at most, and any rotation of the sphere can be
/// looked up in constant time: samples need not move when plates do.
///
/// Samples are numbered tile by tile, so that what lies near each other on the sphere does in memory, too.
#[derive(Clone, Debug)]
pub struct Lattice {
    points: Vec<DVec3>,
    mesh: Mesh,
    inverse: Inverse,
    /// The number of the sample at each turn of the spiral.
    numbers: Vec<u32>,
}

impl Lattice {
    /// The lattice of `samples` points.
    ///
    /// # Errors
    /// When `samples` is outside [`SAMPLES_RANGE`].
    pub fn new(samples: usize) -> Result<Self, LatticeError> {
        if !(SAMPLES_RANGE.0..=SAMPLES_RANGE.1).contains(&samples) {
            return Err(LatticeError::Size { found: samples });
        }
        let spiral = spiral(samples);
        let inverse = Inverse::new(samples);
        let turns = by_tiles(&spiral);
        let mut numbers = vec![0; samples];
        for (number, &turn) in (0..).zip(&turns) {
            numbers[turn as usize] = number;
        }
        let mesh = Mesh::new(&spiral, &inverse, &turns, &numbers).ok_or(LatticeError::Open(samples))?;
        Ok(Self {
            points: turns.iter().map(|&turn| spiral[turn as usize]).collect(),
            mesh,
            inverse,
            numbers,
        })
    }

    /// Number of samples.
    #[expect(clippy::len_without_is_empty, reason = "a lattice is never empty")]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Where the samples are, unit vectors.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Where sample `i` is.
    pub fn point(&self, i: u32) -> DVec3 {
        self.points[i as usize]
    }

    /// The samples that share an edge of the triangulation with `i`, counter-clockwise seen from outside.
    pub fn neighbours(&self, i: u32) -> &[u32] {
        self.mesh.neighbours(i)
    }

    /// Corners of the `2n − 4` triangles, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.mesh.triangles()
    }

    /// Areas of the samples' Voronoi cells, steradians; they sum to 4π.
    pub fn areas(&self) -> &[f64] {
        self.mesh.areas()
    }

    /// Distance of neighbours in a hexagonal lattice of as many samples, radians.
    pub fn spacing(&self) -> f64 {
        (2.0 * 4.0 * PI / self.len() as f64 / 3_f64.sqrt()).sqrt()
    }

    /// The sample nearest to `p`, a unit vector, in constant time (inverse Fibonacci mapping, Keinert et al. 2015).
    pub fn nearest(&self, p: DVec3) -> u32 {
        let turns = self.inverse.around(p);
        let mut best = (0, f64::NEG_INFINITY);
        for turn in turns {
            let number = self.numbers[turn];
            let dot = self.point(number).dot(p);
            if dot > best.1 {
                best = (number, dot);
            }
        }
        best.0
    }

    /// As [`Self::nearest`], from a sample that is near already: in a Delaunay triangulation a sample that has no neighbour
    /// nearer to `p` is the nearest of all.
    pub fn nearest_from(&self, p: DVec3, near: u32) -> u32 {
        let (mut best, mut best_dot) = (near, self.point(near).dot(p));
        loop {
            let from = best;
            for &n in self.neighbours(from) {
                let dot = self.point(n).dot(p);
                if dot > best_dot {
                    (best, best_dot) = (n, dot);
                }
            }
            if best == from {
                return best;
            }
        }
    }

    /// The triangle that holds `p`, a unit vector, and its barycentric weights there (they sum to 1, none is negative).
    pub fn locate(&self, p: DVec3) -> ([u32; 3], [f64; 3]) {
        let nearest = self.nearest(p);
        self.locate_near(p, nearest)
    }

    /// As [`Self::locate`], where the nearest sample is known.
    pub fn locate_near(&self, p: DVec3, nearest: u32) -> ([u32; 3], [f64; 3]) {
        let mut best = self.locate_in_star(p, nearest);
        if best.least < -ON_EDGE {
            // At the poles cells reach beyond the triangles of their sample.
            for &i in self.neighbours(nearest) {
                let other = self.locate_in_star(p, i);
                if other.least > best.least {
                    best = other;
                }
            }
        }
        let clamped = best.weights.map(|w| w.max(0.0));
        let sum = clamped[0] + clamped[1] + clamped[2];
        (best.corners, clamped.map(|w| w / sum))
    }

    /// The triangle around sample `i` between whose edges from there `p` lies; `p` may be beyond the third edge.
    fn locate_in_star(&self, p: DVec3, i: u32) -> Located {
        let star = self.neighbours(i);
        let centre = self.point(i);
        // Volume of p with the edge to a neighbour: positive to the left of it.
        let side = |k: usize| p.dot(centre.cross(self.point(star[k])));
        // At the sample itself the sides are rounding errors, and any triangle will do.
        let mut between = [(0, side(0)), (1, side(1))];
        let mut last = between[1];
        for k in (2..star.len()).chain([0]) {
            if between[0].1 >= 0.0 && between[1].1 <= 0.0 {
                break;
            }
            let next = (k, side(k));
            if last.1 >= 0.0 && next.1 <= 0.0 {
                between = [last, next];
            }
            last = next;
        }
        let corners = [i, star[between[0].0], star[between[1].0]];
        let opposite = p.dot(self.point(corners[1]).cross(self.point(corners[2])));
        let weights = [opposite, -between[1].1, between[0].1];
        let sum: f64 = weights.iter().sum();
        Located {
            corners,
            weights,
            least: weights.iter().copied().fold(f64::INFINITY, f64::min) / sum,
        }
    }
}

/// A place in a triangle.
struct Located {
    corners: [u32; 3],
    /// Barycentric weights, not scaled.
    weights: [f64; 3],
    /// The least of them, scaled so that they sum to 1.
    least: f64,
}

/// The samples in the order of the spiral.
fn spiral(samples: usize) -> Vec<DVec3> {
    let sample = |turn: usize| {
        let z = 1.0 - (2 * turn + 1) as f64 / samples as f64;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (TAU * (turn as f64 * (GOLDEN - 1.0)).fract()).sin_cos();
        DVec3::new(radius * cos, radius * sin, z)
    };
    (0..samples).into_par_iter().map(sample).collect()
}

/// Turns of the spiral, tile by tile: the tiles are the cells of a much coarser spiral.
fn by_tiles(points: &[DVec3]) -> Vec<u32> {
    let tiles = spiral(points.len() / TILE);
    let inverse = Inverse::new(tiles.len());
    let tile_of = |p: &DVec3| {
        let turns = inverse.around(*p).into_iter();
        turns.max_by(|&a, &b| tiles[a].dot(*p).total_cmp(&tiles[b].dot(*p)))
    };
    let tile: Vec<Option<usize>> = points.par_iter().map(tile_of).collect();
    let mut turns: Vec<u32> = (0..points.len() as u32).collect();
    turns.par_sort_by_key(|&turn| tile[turn as usize]);
    turns
}

/// For each zone of latitude, the cell of the lattice that neighbouring samples span there.
#[derive(Clone, Debug)]
pub(super) struct Inverse {
    n: f64,
    /// From the poles to the equator.
    zones: Vec<Zone>,
}

/// Steps from a sample to the ones `F(k)` and `F(k+1)` further on.
#[derive(Clone, Copy, Debug)]
struct Zone {
    /// Columns: change of (longitude, height) for either step.
    basis: DMat2,
    inverse: DMat2,
    /// `1 − z²` from which on it holds.
    from: f64,
}

impl Inverse {
    fn new(samples: usize) -> Self {
        let n = samples as f64;
        // k = ⌊log_φ²(n π √5 (1 − z²))⌋, at least 2.
        let from = |k: i32| GOLDEN.powi(2 * k) / (n * PI * 5_f64.sqrt());
        let zones = (2..SAMPLES_RANGE.1.ilog2() as i32)
            .take_while(|&k| k == 2 || from(k) <= 1.0)
            .map(|k| {
                let fibonacci = GOLDEN.powi(k) / 5_f64.sqrt();
                let step = |f: f64| {
                    let turn = ((f + 1.0) * (GOLDEN - 1.0)).fract() - (GOLDEN - 1.0);
                    DVec2::new(TAU * turn, -2.0 * f / n)
                };
                let basis = DMat2::from_cols(step(fibonacci.round()), step((fibonacci * GOLDEN).round()));
                Zone {
                    basis,
                    inverse: basis.inverse(),
                    from: if k == 2 { 0.0 } else { from(k) },
                }
            })
            .collect();
        Self { n, zones }
    }

    /// The zone at height `z`; its steps are `F(k)` and `F(k+1)` with `k` two more.
    pub(super) fn zone(&self, z: f64) -> usize {
        let across = 1.0 - z * z;
        // Most of the sphere lies in the last zones.
        self.zones
            .iter()
            .rposition(|zone| across >= zone.from)
            .unwrap_or(0)
    }

    /// Turns of the spiral among which the one nearest to `p` is.
    fn around(&self, p: DVec3) -> [usize; 4] {
        let z = p.z.clamp(-1.0, 1.0);
        let zone = &self.zones[self.zone(z)];
        let top = 1.0 - 1.0 / self.n;
        let corner = zone.inverse * DVec2::new(p.y.atan2(p.x), z - top);
        let corner = DVec2::new(floor(corner.x), floor(corner.y));
        std::array::from_fn(|s| {
            let step = corner + DVec2::new((s % 2) as f64, (s / 2) as f64);
            let height = (zone.basis * step).y + top;
            // Beyond a pole the lattice goes on on the other side.
            let height = 2.0 * height.clamp(-1.0, 1.0) - height;
            let turn = (self.n - height * self.n) * 0.5;
            (turn.max(0.0) as usize).min(self.n as usize - 1)
        })
    }
}

/// The greatest whole number that is not above `x`: far from the limits of integers this is quicker than the library's.
fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}
