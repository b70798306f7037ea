//! Heights of folds between crests and troughs.
//!
//! With `d_t` and `d_b` the distances to the nearest crest and trough,
//!
//! ```text
//! λ(p) = 2 (d_t + d_b),     shape(p) = ½ (1 + cos(2π d_t / λ(p))):
//! ```
//!
//! 1 on crests, 0 on troughs, and continuous, since distances are. Beyond the last crests, where nothing is compressed,
//! the shape fades to nothing.

use std::f64::consts::PI;
use std::fmt::Debug;

use glam::DVec2;
use multiversion::multiversion;
use rayon::prelude::*;

use super::edit::{FoldEdit, Raises};
use super::lines::{trough_node, troughs};
use super::mesh::FoldMesh;
use super::nearest::{Near, PackedLines, Segments};
use super::skeleton::Skeleton;
use crate::mountain::grid::Grid;
use crate::mountain::smoother;

/// Distances to crests, in wavelengths, between which the shape fades out. Among compressed folds no place is as far from
/// a crest as the first.
pub(crate) const FADE: [f64; 2] = [1.5, 2.5];

/// Cells per side of a tile: within one the same few segments are in question, and a row of it fills a register.
const TILE: usize = 8;

/// Points that one task looks at. Fixed, as all sizes of tasks are, so that no result depends on the number of threads.
const POINTS_PER_TASK: usize = 1024;

/// Least sum of distances that is divided by, metres. Crests and troughs never touch.
pub(crate) const TOUCH: f64 = 1e-6;

/// Largest difference between heights on a grid, computed in `f32`, and exact ones.
pub const SHAPE_TOLERANCE: f64 = 1e-5;

/// Where folds are high and low, for one skeleton.
#[derive(Clone, Debug)]
pub struct FoldShape {
    wavelength: f64,
    crests: Segments,
    troughs: Segments,
}

/// The stage of heights; a twin on another device implements it too, and answers as [`CpuFolds`] does to
/// [`SHAPE_TOLERANCE`].
pub trait FoldStage: Debug + Send + Sync {
    /// Heights at points (plan metres) as parts of the height of crests, 0–1; `out` gets one value per point.
    fn at_points(&mut self, shape: &FoldShape, points: &[DVec2], out: &mut Vec<f64>);

    /// The same at the cell centres of a grid, row by row from the north.
    fn on_grid(&mut self, shape: &FoldShape, grid: Grid, out: &mut Vec<f32>);

    /// False where what it computes is right within the tolerance alone, and not the same bits on every machine.
    fn is_reproducible(&self) -> bool {
        true
    }
}

impl<S: FoldStage + ?Sized> FoldStage for Box<S> {
    fn at_points(&mut self, shape: &FoldShape, points: &[DVec2], out: &mut Vec<f64>) {
        (**self).at_points(shape, points, out);
    }

    fn on_grid(&mut self, shape: &FoldShape, grid: Grid, out: &mut Vec<f32>) {
        (**self).on_grid(shape, grid, out);
    }

    fn is_reproducible(&self) -> bool {
        (**self).is_reproducible()
    }
}

/// Points and tiles in parallel on the processor.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuFolds;

impl FoldStage for CpuFolds {
    fn at_points(&mut self, shape: &FoldShape, points: &[DVec2], out: &mut Vec<f64>) {
        shape.at_points(points, out);
    }

    fn on_grid(&mut self, shape: &FoldShape, grid: Grid, out: &mut Vec<f32>) {
        shape.on_grid(grid, out);
    }
}

impl FoldShape {
    /// The shape of the folds of `skeleton`, a skeleton of `mesh`; of another mesh's, flat.
    pub fn new(mesh: &FoldMesh, skeleton: &Skeleton) -> Self {
        let crests: Vec<[DVec2; 2]> = skeleton.top_on(mesh).map(|edge| mesh.ends(edge)).collect();
        let troughs: Vec<[DVec2; 2]> = if crests.is_empty() {
            Vec::new()
        } else {
            let lines = troughs(mesh, skeleton);
            lines
                .iter()
                .map(|line| line.nodes.map(|node| trough_node(mesh, node)))
                .collect()
        };
        Self {
            wavelength: mesh.wavelength(),
            crests: Segments::new(&crests, mesh.wavelength()),
            troughs: Segments::new(&troughs, mesh.wavelength()),
        }
    }

    /// Exact distances from `p` to the nearest crest and the nearest trough, metres; `None` where there is no crest within
    /// two and a half wavelengths.
    pub fn distances(&self, p: DVec2) -> Option<(f64, f64)> {
        let reach = self.reach();
        let crest = self.crests.distance(p, reach);
        (crest < reach).then(|| (crest, self.troughs.distance(p, reach)))
    }

    /// Local wavelength `2 (d_t + d_b)` at `p`, metres; `None` without folds.
    pub fn wavelength_at(&self, p: DVec2) -> Option<f64> {
        self.distances(p).map(|(crest, trough)| 2.0 * (crest + trough))
    }

    /// Height at `p` (plan metres) as a part of the height of crests, 0–1.
    pub fn at(&self, p: DVec2) -> f64 {
        self.distances(p).map_or(0.0, |(crest, trough)| {
            let phase = PI * crest / (crest + trough).max(TOUCH);
            0.5 * (1.0 + phase.cos())
                * (1.0 - smoother((crest / self.wavelength - FADE[0]) / (FADE[1] - FADE[0])))
        })
    }

    /// The same at many points; `out` gets one value per point.
    pub fn at_points(&self, points: &[DVec2], out: &mut Vec<f64>) {
        fill_points(points, out, |p| self.at(p));
    }

    /// The same with what `edits` raise; `out` gets one value per point.
    pub fn raised_at_points(&self, edits: &[FoldEdit], points: &[DVec2], out: &mut Vec<f32>) {
        let raises = Raises::of(edits, self.wavelength);
        fill_points(points, out, |p| (self.at(p) * raises.at(p)) as f32);
    }

    /// The same at the cell centres of a grid, row by row from the north, to [`SHAPE_TOLERANCE`].
    pub fn on_grid(&self, grid: Grid, out: &mut Vec<f32>) {
        out.resize(grid.len(), 0.0);
        let reach = self.reach();
        let far = (reach * reach) as f32;
        let radius = std::f64::consts::SQRT_2 * MIDDLE * grid.cell;
        let places = Places::of(grid.cell);
        out.par_chunks_mut(grid.cols.max(1) * TILE)
            .enumerate()
            .for_each(|(band, cells)| {
                let mut scratch = Vec::new();
                let (mut crests, mut troughs) = (Vec::new(), Vec::new());
                for first in (0..grid.cols).step_by(TILE) {
                    let centre =
                        grid.corner(first, band * TILE) + DVec2::new(0.5, -0.5) * (TILE as f64 * grid.cell);
                    let mut shape = [0.0; CELLS];
                    self.crests
                        .gather(centre, radius, reach, &mut scratch, &mut crests);
                    if !crests.is_empty() {
                        self.troughs
                            .gather(centre, radius, reach, &mut scratch, &mut troughs);
                        let (mut to_crest, mut to_trough) = ([far; CELLS], [far; CELLS]);
                        lower(&crests, &places, &mut to_crest);
                        lower(&troughs, &places, &mut to_trough);
                        heights(&to_crest, &to_trough, self.wavelength as f32, &mut shape);
                    }
                    let columns = TILE.min(grid.cols - first);
                    for (cells, shape) in cells.chunks_mut(grid.cols).zip(shape.chunks(TILE)) {
                        cells[first..first + columns].copy_from_slice(&shape[..columns]);
                    }
                }
            });
    }

    /// Length of the folds' mesh, metres.
    pub fn wavelength(&self) -> f64 {
        self.wavelength
    }

    /// Crests and troughs by bucket, for a stage on another device: `starts` gets where the segments of each bucket begin
    /// and where the last one's end, row by row from the south, and `lines` the segments, from where and along which way,
    /// metres, the former from the south-west corner of their bucket.
    pub fn pack(&self, starts: &mut Vec<u32>, lines: &mut Vec<[f32; 4]>) -> [PackedLines; 2] {
        starts.clear();
        lines.clear();
        [&self.crests, &self.troughs].map(|segments| segments.pack(starts, lines))
    }

    /// Farther than this from every crest there are no folds, metres.
    pub fn reach(&self) -> f64 {
        FADE[1] * self.wavelength
    }
}

/// One value per point, in parallel.
pub(super) fn fill_points<T: Copy + Default + Send>(
    points: &[DVec2],
    out: &mut Vec<T>,
    value: impl Fn(DVec2) -> T + Sync,
) {
    out.resize(points.len(), T::default());
    out.par_chunks_mut(POINTS_PER_TASK)
        .zip(points.par_chunks(POINTS_PER_TASK))
        .for_each(|(out, points)| {
            for (out, &p) in out.iter_mut().zip(points) {
                *out = value(p);
            }
        });
}

/// Place of the middle of a tile between its cell centres.
const MIDDLE: f64 = (TILE as f64 - 1.0) / 2.0;

/// Cells of a tile.
const CELLS: usize = TILE * TILE;

/// Cell centres of a tile relative to its middle, row by row from the north, metres.
struct Places {
    x: [f32; CELLS],
    y: [f32; CELLS],
}

impl Places {
    fn of(cell: f64) -> Self {
        let x = |k: usize| ((k % TILE) as f64 - MIDDLE) * cell;
        let y = |k: usize| (MIDDLE - (k / TILE) as f64) * cell;
        Self {
            x: std::array::from_fn(|k| x(k) as f32),
            y: std::array::from_fn(|k| y(k) as f32),
        }
    }
}

/// Lowers `squared` to the squared distances from `places` to a segment.
///
/// One loop over all cells: a loop over a row of eight is unrolled into single numbers before it can become vectors.
#[multiversion(targets("x86_64+avx2"))]
fn lower(segments: &[Near], places: &Places, squared: &mut [f32; CELLS]) {
    for segment in segments {
        let ([from_x, from_y], [along_x, along_y]) = (segment.from, segment.along);
        let inverse = segment.inverse;
        for ((squared, x), y) in squared.iter_mut().zip(&places.x).zip(&places.y) {
            let (x, y) = (x - from_x, y - from_y);
            let t = (x * along_x + y * along_y) * inverse;
            let t = if t > 0.0 { t } else { 0.0 };
            let t = if t < 1.0 { t } else { 1.0 };
            let (x, y) = (x - t * along_x, y - t * along_y);
            let here = x * x + y * y;
            *squared = if here < *squared { here } else { *squared };
        }
    }
}

/// Heights in a tile from squared distances to crests and troughs.
#[multiversion(targets("x86_64+avx2"))]
fn heights(to_crest: &[f32; CELLS], to_trough: &[f32; CELLS], wavelength: f32, out: &mut [f32; CELLS]) {
    let (fade_from, per_fade) = (
        FADE[0] as f32 * wavelength,
        1.0 / ((FADE[1] - FADE[0]) as f32 * wavelength),
    );
    for ((out, crest), trough) in out.iter_mut().zip(to_crest).zip(to_trough) {
        let (crest, trough) = (crest.sqrt(), trough.sqrt());
        let sum = crest + trough;
        let half = half_turn_cos(crest / if sum > TOUCH as f32 { sum } else { TOUCH as f32 });
        let t = (crest - fade_from) * per_fade;
        let t = if t > 0.0 { t } else { 0.0 };
        let t = if t < 1.0 { t } else { 1.0 };
        let fade = 1.0 - t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        *out = half * half * fade;
    }
}

/// `cos(πx/2)` for x from 0 to 1, to 5e-8: its square is the shape, and it vanishes at 1 exactly.
#[inline]
fn half_turn_cos(x: f32) -> f32 {
    let z = x * x;
    // cos(πx/2) = (1 − x²) p(x²): the zero is taken out, and p is its Taylor series divided by (1 − z).
    let p = QUOTIENT;
    (1.0 - z) * (p[0] + z * (p[1] + z * (p[2] + z * (p[3] + z * (p[4] + z * p[5])))))
}

/// Coefficients of `cos(π√z/2) / (1 − z)`: partial sums of those of the cosine.
pub(crate) const QUOTIENT: [f32; 6] = quotient();

const fn quotient() -> [f32; 6] {
    let square = PI * PI / 4.0;
    let mut out = [0.0; 6];
    let (mut term, mut sum, mut k) = (1.0, 0.0, 0);
    while k < 6 {
        sum += term;
        out[k] = sum as f32;
        term *= -square / ((2 * k + 1) * (2 * k + 2)) as f64;
        k += 1;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cosine_is_one() {
        for k in 0..=1_000 {
            let x = f64::from(k) / 1_000.0;
            let error = f64::from(half_turn_cos(x as f32)) - (PI * x / 2.0).cos();
            assert!(error.abs() < 3e-7, "{error} at {x}");
        }
        assert_eq!((half_turn_cos(0.0), half_turn_cos(1.0)), (1.0, 0.0));
    }
}
