//! One row of corners or cells: the inner loops of the fast stage.

use glam::DVec2;
use multiversion::multiversion;

use super::TransportProblem;
use crate::gesture::rigid::RigidMotion;
use crate::mountain::power::{exp2, log2};

/// Columns worked on at once; their accumulators stay in the first-level cache.
const BLOCK: usize = 256;

/// Distances are measured in this unit (metres) before the power is taken, so that logarithms of the distances that
/// matter are small and keep their digits.
pub(crate) const UNIT: f64 = 16_384.0;

/// Inside a body the distance is taken as this (metres): its weight then exceeds all others' a million times, and
/// Eq. 2 turns into Eq. 1 without a branch.
pub(crate) const RIM: f32 = 1e-3;

/// A body as the rows see it.
struct Caster {
    core: Vec<DVec2>,
    radius: f32,
    pivot: DVec2,
    back: Back,
}

/// `T⁻¹π − π = spin·(π − pivot) + lift`, with a pivot near the body so that `f32` keeps its digits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Back {
    /// The matrix, row by row.
    pub(crate) spin: [f32; 4],
    /// Metres.
    pub(crate) lift: [f32; 2],
}

impl Back {
    pub(crate) fn of(motion: &RigidMotion, pivot: DVec2) -> Self {
        let lift = motion.apply_inverse(pivot) - pivot;
        let sin = motion.angle.sin();
        // 1 − cos in the form that keeps its digits for small turns.
        let versine = 2.0 * (motion.angle / 2.0).sin().powi(2);
        Self {
            spin: [-versine as f32, sin as f32, -sin as f32, -versine as f32],
            lift: [lift.x as f32, lift.y as f32],
        }
    }
}

/// The rest weight for distances in [`UNIT`]s.
pub(crate) fn rest_weight(problem: &TransportProblem) -> f32 {
    (problem.rest_weight * UNIT.powf(problem.exponent)) as f32
}

/// The nearest feature of a core along a stretch of a row: its Voronoi regions are convex, so a row crosses each of
/// them at most once.
#[derive(Clone, Copy)]
enum Feature {
    /// Inside the core.
    Inside,
    /// A corner.
    Corner(DVec2),
    /// An edge through a point with an outward normal.
    Edge(DVec2, DVec2),
}

/// All that the rows of a problem share.
pub(super) struct Kernel {
    casters: Vec<Caster>,
    exponent: f32,
    rest_weight: f32,
    cell: f64,
    north_west: DVec2,
}

impl Kernel {
    pub(super) fn new(problem: &TransportProblem) -> Self {
        let casters = problem
            .bodies
            .iter()
            .map(|body| {
                let pivot = body.hull.centre();
                Caster {
                    core: body.hull.core().to_vec(),
                    radius: body.hull.radius() as f32,
                    pivot,
                    back: Back::of(&body.motion, pivot),
                }
            })
            .collect();
        Self {
            casters,
            exponent: problem.exponent as f32,
            rest_weight: rest_weight(problem),
            cell: problem.grid.cell,
            north_west: problem.grid.north_west,
        }
    }

    /// `Φ⁻¹(p) − p` for a row of corners.
    pub(super) fn row(&self, row: usize, east: &mut [f32], north: &mut [f32]) {
        let y = self.north_west.y - row as f64 * self.cell;
        let mut weights = [0.0_f32; BLOCK];
        let mut stretches = Vec::with_capacity(24);
        let mut all = Vec::with_capacity(self.casters.len());
        for caster in &self.casters {
            caster.stretches(y, self.north_west.x, self.cell, east.len(), &mut stretches);
            all.push(stretches.clone());
        }
        for (block, (east, north)) in east.chunks_mut(BLOCK).zip(north.chunks_mut(BLOCK)).enumerate() {
            let first = block * BLOCK;
            let n = east.len();
            let weights = &mut weights[..n];
            weights.fill(self.rest_weight);
            east.fill(0.0);
            north.fill(0.0);
            for (caster, stretches) in self.casters.iter().zip(&all) {
                for (k, &(begin, feature)) in stretches.iter().enumerate() {
                    let end = stretches.get(k + 1).map_or(usize::MAX, |s| s.0);
                    let (from, to) = (begin.max(first), end.min(first + n));
                    if from < to {
                        let x = self.north_west.x + from as f64 * self.cell;
                        let cut = from - first..to - first;
                        cast(
                            caster,
                            feature,
                            DVec2::new(x, y),
                            self.cell as f32,
                            self.exponent,
                            &mut Sums {
                                weights: &mut weights[cut.clone()],
                                east: &mut east[cut.clone()],
                                north: &mut north[cut],
                            },
                        );
                    }
                }
            }
            for ((east, north), &w) in east.iter_mut().zip(north.iter_mut()).zip(weights.iter()) {
                // Without plates and without rest nothing moves.
                let share = 1.0 / w.max(f32::MIN_POSITIVE);
                *east *= share;
                *north *= share;
            }
        }
    }
}

/// Sums of Eq. 2 along a stretch.
struct Sums<'a> {
    weights: &'a mut [f32],
    east: &'a mut [f32],
    north: &'a mut [f32],
}

impl Caster {
    /// Cuts the row at height `y` where the nearest feature changes: columns at which each begins.
    fn stretches(&self, y: f64, west: f64, cell: f64, corners: usize, out: &mut Vec<(usize, Feature)>) {
        let n = self.core.len();
        let reach = corners as f64 * cell;
        let mut found: Vec<(f64, f64, Feature)> = Vec::with_capacity(2 * n + 1);
        let mut add = |feature: Feature, walls: &[(DVec2, DVec2)]| {
            // Each wall keeps the points with normal·(p − base) ≥ 0.
            let (mut low, mut high) = (west - cell, west + reach);
            for &(normal, base) in walls {
                let at_west = normal.x * (west - base.x) + normal.y * (y - base.y);
                if normal.x > 0.0 {
                    low = low.max(west - at_west / normal.x);
                } else if normal.x < 0.0 {
                    high = high.min(west - at_west / normal.x);
                } else if at_west < 0.0 {
                    return;
                }
            }
            if low < high {
                found.push((low, high, feature));
            }
        };
        if n == 1 {
            add(Feature::Corner(self.core[0]), &[]);
        } else {
            let at = |i: usize| self.core[i % n];
            let along = |i: usize| (at(i + 1) - at(i)).normalize();
            for i in 0..n {
                let (tangent, before) = (along(i), along(i + n - 1));
                let normal = -tangent.perp();
                add(
                    Feature::Edge(at(i), normal),
                    &[(normal, at(i)), (tangent, at(i)), (-tangent, at(i + 1))],
                );
                add(Feature::Corner(at(i)), &[(-tangent, at(i)), (before, at(i))]);
            }
            if n > 2 {
                let walls: Vec<(DVec2, DVec2)> = (0..n).map(|i| (along(i).perp(), at(i))).collect();
                add(Feature::Inside, &walls);
            }
        }
        // Where stretches touch, rounding may leave a gap or an overlap: each goes on to where the next begins, and
        // distance and projection are continuous there.
        found.sort_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1)));
        out.clear();
        for &(low, _, feature) in &found {
            let begin = ((low - west) / cell).ceil().max(0.0) as usize;
            out.push((begin.min(corners), feature));
        }
        if let Some(first) = out.first_mut() {
            first.0 = 0;
        }
    }
}

/// Adds a body's share for corners `from`, `from + cell`, … eastwards.
#[multiversion(targets("x86_64+avx2"))]
fn cast(caster: &Caster, feature: Feature, from: DVec2, cell: f32, exponent: f32, sums: &mut Sums<'_>) {
    let here = from - caster.pivot;
    let (x0, y) = (here.x as f32, here.y as f32);
    let [xx, xy, yx, yy] = caster.back.spin;
    let [lift_x, lift_y] = caster.back.lift;
    let radius = caster.radius;
    let power = |d: f32| exp2(-exponent * log2(d * (1.0 / UNIT) as f32));
    let columns = sums
        .weights
        .iter_mut()
        .zip(sums.east.iter_mut())
        .zip(sums.north.iter_mut())
        .enumerate();
    match feature {
        Feature::Inside => {
            let w = power(RIM);
            for (k, ((weight, east), north)) in columns {
                let x = x0 + k as i32 as f32 * cell;
                *weight += w;
                *east += w * (xx * x + xy * y + lift_x);
                *north += w * (yx * x + yy * y + lift_y);
            }
        }
        Feature::Corner(corner) => {
            let corner = corner - caster.pivot;
            let (cx, cy) = (corner.x as f32, corner.y as f32);
            let dy = y - cy;
            for (k, ((weight, east), north)) in columns {
                let dx = x0 + k as i32 as f32 * cell - cx;
                let core_distance = (dx * dx + dy * dy).sqrt();
                let d = (core_distance - radius).max(RIM);
                let w = power(d);
                // Projection: from the corner towards the point, no farther than the radius.
                let part = radius.min(core_distance) / core_distance.max(RIM);
                let (px, py) = (cx + dx * part, cy + dy * part);
                *weight += w;
                *east += w * (xx * px + xy * py + lift_x);
                *north += w * (yx * px + yy * py + lift_y);
            }
        }
        Feature::Edge(base, normal) => {
            let base = base - caster.pivot;
            let (nx, ny) = (normal.x as f32, normal.y as f32);
            let offset = ((here - base).dot(normal)) as f32;
            for (k, ((weight, east), north)) in columns {
                let step = k as i32 as f32 * cell;
                let beyond = offset + step * nx - radius;
                let w = power(beyond.max(RIM));
                let back = beyond.max(0.0);
                let (px, py) = (x0 + step - back * nx, y - back * ny);
                *weight += w;
                *east += w * (xx * px + xy * py + lift_x);
                *north += w * (yx * px + yy * py + lift_y);
            }
        }
    }
}

/// Sums over cells, in an order that does not depend on threads.
#[derive(Clone, Copy, Debug)]
pub(super) struct QuadSums {
    pub(super) sum: f64,
    pub(super) min: f32,
    pub(super) max: f32,
    pub(super) folded: usize,
}

impl Default for QuadSums {
    fn default() -> Self {
        Self {
            sum: 0.0,
            min: f32::INFINITY,
            max: f32::NEG_INFINITY,
            folded: 0,
        }
    }
}

impl QuadSums {
    /// The sums of `tasks` together.
    pub(super) fn in_order(tasks: &[Self]) -> Self {
        let mut sums = Self::default();
        for task in tasks {
            sums.add(task);
        }
        sums
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.sum += other.sum;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.folded += other.folded;
    }
}

/// `q` of a row of cells from two rows of corners (the northern one first).
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn quads(east: &[f32], north: &[f32], cell: f32, q: &mut [f32]) {
    let n = q.len();
    let (east_above, east_below) = east.split_at(n + 1);
    let (north_above, north_below) = north.split_at(n + 1);
    let per_cell = 1.0 / cell;
    for (i, q) in q.iter_mut().enumerate() {
        // Diagonals of the quad in cells: rising (1, 1), falling (−1, 1), and what the shifts add.
        let rx = (east_above[i + 1] - east_below[i]) * per_cell;
        let ry = (north_above[i + 1] - north_below[i]) * per_cell;
        let fx = (east_above[i] - east_below[i + 1]) * per_cell;
        let fy = (north_above[i] - north_below[i + 1]) * per_cell;
        // ½ (1 + rx)(1 + fy) − ½ (1 + ry)(fx − 1), with the unit part taken out so that rounding is relative to
        // the change.
        *q = 1.0 + 0.5 * ((rx + fy + rx * fy) + (ry - fx - ry * fx));
    }
}

/// Sums over some cells.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn sums(q: &[f32]) -> QuadSums {
    const LANES: usize = 8;
    let mut sum = [0.0_f64; LANES];
    let mut min = [f32::INFINITY; LANES];
    let mut max = [f32::NEG_INFINITY; LANES];
    let mut folded = [0_u32; LANES];
    for lane in q.chunks(LANES) {
        for (k, &v) in lane.iter().enumerate() {
            sum[k] += f64::from(v);
            min[k] = if v < min[k] { v } else { min[k] };
            max[k] = if v > max[k] { v } else { max[k] };
            folded[k] += u32::from(v <= 0.0);
        }
    }
    let mut total = QuadSums::default();
    for k in 0..LANES {
        total.add(&QuadSums {
            sum: sum[k],
            min: min[k],
            max: max[k],
            folded: folded[k] as usize,
        });
    }
    total
}
