//! The uplift rate: thickening in belts, domes, and the published rule as the alternative.

use std::f64::consts::TAU;

use glam::DVec2;
use rayon::prelude::*;

use super::belt::{Belt, Kind};
use super::grid::{Field, Grid};
use super::params::{MountainParams, UpliftRule};
use super::plate::Dome;
use super::smoother;
use super::transport::{MovedBody, TransportProblem};

/// Rows that one task computes. Fixed, so that no result depends on the number of threads.
const ROWS_PER_TASK: usize = 4;

/// No belt owns a cell.
pub(super) const NOBODY: u8 = u8::MAX;

/// Scratch and results of the stage, on the coarse grid of blocks: uplift has no detail finer than half a kilometre.
#[derive(Clone, Debug)]
pub(super) struct UpliftStage {
    grid: Grid,
    /// Mean `q` of each block.
    q: Vec<f32>,
    /// Which belt raises a block most.
    pub(super) owner: Vec<u8>,
    /// How far fronts wander at a block, metres.
    wander: Vec<[f32; 2]>,
    sorted: Vec<f32>,
}

impl UpliftStage {
    pub(super) fn new(blocks: Grid) -> Self {
        let mut stage = Self {
            grid: blocks,
            q: vec![1.0; blocks.len()],
            owner: vec![NOBODY; blocks.len()],
            wander: Vec::with_capacity(blocks.len()),
            sorted: Vec::new(),
        };
        for row in 0..blocks.rows {
            for col in 0..blocks.cols {
                let w = wander(blocks.centre(col, row));
                stage.wander.push([w.x as f32, w.y as f32]);
            }
        }
        stage
    }

    /// Fills `uplift` (on the grid of blocks, m/yr).
    #[expect(
        clippy::too_many_arguments,
        reason = "every input of the stage, each used once"
    )]
    pub(super) fn run(
        &mut self,
        q: &Field,
        problem: &TransportProblem,
        belts: &mut [Belt],
        domes: &[Dome],
        now_yr: f64,
        params: &MountainParams,
        uplift: &mut Field,
    ) {
        self.mean_over_blocks(q);
        match params.rule {
            UpliftRule::Belts => self.belts(problem, belts, params, uplift),
            UpliftRule::Paper => self.paper(problem, belts, params, uplift),
        }
        for dome in domes {
            raise_dome(dome, now_yr, params, uplift);
        }
    }

    fn mean_over_blocks(&mut self, q: &Field) {
        const B: usize = Grid::BLOCK;
        let cols = q.grid.cols;
        self.q
            .par_chunks_mut(self.grid.cols)
            .zip(q.data.par_chunks(cols * B))
            .for_each(|(means, cells)| {
                for (col, mean) in means.iter_mut().enumerate() {
                    let mut sum = 0.0;
                    for row in cells.chunks_exact(cols) {
                        sum += row[col * B..(col + 1) * B].iter().sum::<f32>();
                    }
                    *mean = sum / (B * B) as f32;
                }
            });
    }

    /// `u0 = α (q − 1)` after localisation in the belts, softly capped.
    fn belts(
        &mut self,
        problem: &TransportProblem,
        belts: &mut [Belt],
        params: &MountainParams,
        uplift: &mut Field,
    ) {
        let grid = self.grid;
        let cols = grid.cols;
        let q = Field {
            grid,
            data: std::mem::take(&mut self.q),
        };
        for belt in belts.iter_mut() {
            belt.gather(|p| q.at(p) - 1.0);
        }
        self.q = q.data;
        let belts = &*belts;
        let wander = &self.wander;
        uplift
            .data
            .par_chunks_mut(cols * ROWS_PER_TASK)
            .zip(self.owner.par_chunks_mut(cols * ROWS_PER_TASK))
            .enumerate()
            .for_each(|(task, (uplift, owner))| {
                for (k, (u, owner)) in uplift.iter_mut().zip(owner.iter_mut()).enumerate() {
                    let at = task * ROWS_PER_TASK * cols + k;
                    *u = 0.0;
                    *owner = NOBODY;
                    let p = grid.centre(at % cols, at / cols);
                    let [east, north] = wander[at];
                    let warped = p + DVec2::new(f64::from(east), f64::from(north)) * params.sinuosity;
                    // Belts that share a place join in the fourth-power mean: the stronger covers the weaker one's
                    // edges, and neither ends in a crease.
                    let (mut range, mut rift, mut most) = (0.0, 0.0, 0.0);
                    for (index, belt) in belts.iter().enumerate() {
                        let thickness = belt.localised(warped);
                        let square = thickness * thickness;
                        match belt.kind {
                            Kind::Range => range += square * square,
                            Kind::Rift => rift += square * square,
                        }
                        if thickness > most {
                            most = thickness;
                            *owner = index.min(usize::from(NOBODY) - 1) as u8;
                        }
                    }
                    if most > 0.0 {
                        let rate = |sum: f64, limit: f64| {
                            softly_capped(params.rise_per_thickening * sum.sqrt().sqrt(), limit)
                        };
                        let net = rate(range, params.rise_limit) - rate(rift, params.sink_limit);
                        *u =
                            (net * off_rims(&problem.bodies, p, params) * off_border(grid, p, params)) as f32;
                    }
                }
            });
    }

    /// Section 4.3 as published, in the reading of the fault as the iso-level `ε = level · p95(q − 1)` on the stable
    /// side, offset into the region.
    fn paper(
        &mut self,
        problem: &TransportProblem,
        belts: &[Belt],
        params: &MountainParams,
        uplift: &mut Field,
    ) {
        let thicker = self.q.iter().map(|q| q - 1.0).filter(|t| *t > 1e-4);
        let thickest = percentile(&mut self.sorted, thicker, 0.95);
        let level = (params.fault_level * thickest).max(1e-9);
        let resting: Vec<bool> = problem
            .bodies
            .iter()
            .map(|b| b.motion == crate::gesture::rigid::RigidMotion::IDENTITY)
            .collect();
        let mut sum = 0.0;
        let mut count = 0_usize;
        for row in 0..self.grid.rows {
            for col in 0..self.grid.cols {
                let at = row * self.grid.cols + col;
                let p = self.grid.centre(col, row);
                let thicker = f64::from(self.q[at]) - 1.0;
                let (mut weights, mut stable, mut gap) =
                    (problem.rest_weight, problem.rest_weight, f64::INFINITY);
                for (body, &rests) in problem.bodies.iter().zip(&resting) {
                    let d = body.hull.nearest(p).distance.max(1.0);
                    let w = d.powf(-problem.exponent);
                    weights += w;
                    if rests {
                        stable += w;
                        gap = gap.min(d);
                    }
                }
                let share = smoother((stable / weights.max(1e-300) - 0.4) / 0.2);
                let beyond = smoother((thicker - level) / level)
                    * smoother((gap - params.rim_offset) / params.rim_offset);
                let rate = thicker.max(0.0) * (1.0 - share * (1.0 - beyond));
                if rate > 0.0 {
                    sum += rate;
                    count += 1;
                }
                uplift.data[at] = rate as f32;
                self.owner[at] = belts
                    .iter()
                    .position(|belt| belt.mask(p) > 0.0)
                    .map_or(NOBODY, |index| index.min(usize::from(NOBODY) - 1) as u8);
            }
        }
        if count > 0 {
            let scale = params.paper_mean * count as f64 / sum;
            for u in &mut uplift.data {
                *u = (f64::from(*u) * scale) as f32;
            }
        }
    }

    /// The `part` percentile of the uplift where `belt` raises most; `None` where it raises nothing.
    pub(super) fn percentile_of(&mut self, belt: u8, uplift: &Field, part: f64) -> Option<f64> {
        let values = uplift
            .data
            .iter()
            .zip(&self.owner)
            .filter(|(u, owner)| **owner == belt && **u > 0.0)
            .map(|(u, _)| *u);
        let value = percentile(&mut self.sorted, values, part);
        (value > 0.0).then_some(value)
    }
}

/// Uplift fades towards the hulls, inside which the crust does not thicken.
fn off_rims(bodies: &[MovedBody], p: DVec2, params: &MountainParams) -> f64 {
    bodies
        .iter()
        .map(|body| smoother(body.hull.nearest(p).distance / (3.0 * params.rim_offset).max(1.0)))
        .product()
}

/// Fades towards the border of the map.
fn off_border(grid: Grid, p: DVec2, params: &MountainParams) -> f64 {
    let size = DVec2::new(grid.cols as f64, grid.rows as f64) * grid.cell;
    let at = DVec2::new(p.x - grid.north_west.x, grid.north_west.y - p.y);
    let inside = at.min(size - at).min_element();
    smoother(inside / params.border_fade.max(1.0))
}

/// Follows `rate` while it is small and levels off at `limit`.
fn softly_capped(rate: f64, limit: f64) -> f64 {
    if limit <= 0.0 {
        return 0.0;
    }
    let x = rate / limit;
    rate / (1.0 + x * x).sqrt()
}

/// The `part` percentile of values, 0 for none.
fn percentile(scratch: &mut Vec<f32>, values: impl Iterator<Item = f32>, part: f64) -> f64 {
    scratch.clear();
    scratch.extend(values);
    if scratch.is_empty() {
        return 0.0;
    }
    let rank = ((scratch.len() - 1) as f64 * part) as usize;
    f64::from(*scratch.select_nth_unstable_by(rank, f32::total_cmp).1)
}

/// How far a front wanders at `p`, in parts of the sinuosity: a fixed sum of plane waves of 9–31 km in directions
/// that do not repeat, smooth and without a lattice.
fn wander(p: DVec2) -> DVec2 {
    /// Wavelength (m), azimuth (rad), amplitude, phase (turns).
    const WAVES: [[f64; 4]; 7] = [
        [31_000.0, 0.35, 0.50, 0.11],
        [26_000.0, 1.62, 0.45, 0.73],
        [19_000.0, 2.71, 0.30, 0.39],
        [15_500.0, 0.93, 0.22, 0.87],
        [12_300.0, 2.05, 0.14, 0.21],
        [10_700.0, 3.02, 0.10, 0.58],
        [9_100.0, 1.24, 0.07, 0.95],
    ];
    WAVES
        .iter()
        .fold(DVec2::ZERO, |sum, &[length, azimuth, amplitude, phase]| {
            let turns = p.dot(DVec2::from_angle(azimuth)) / length;
            sum + amplitude
                * DVec2::new(
                    (TAU * (turns + phase)).sin(),
                    (TAU * (turns + 0.37 + 1.7 * phase)).sin(),
                )
        })
}

/// A Gaussian dome, risen at a constant rate while it lasts.
fn raise_dome(dome: &Dome, now_yr: f64, params: &MountainParams, uplift: &mut Field) {
    if now_yr >= dome.begun_yr + params.dome_years || params.dome_years <= 0.0 {
        return;
    }
    let grid = uplift.grid;
    let rate = params.dome_height / params.dome_years;
    let reach = 4.0 * params.dome_radius;
    let from = (dome.centre - grid.north_west) / grid.cell;
    let cells = reach / grid.cell;
    let range = |centre: f64, n: usize| {
        let low = (centre - cells).floor().clamp(0.0, n as f64) as usize;
        let high = (centre + cells).ceil().clamp(0.0, n as f64) as usize;
        low..high
    };
    for row in range(-from.y, grid.rows) {
        for col in range(from.x, grid.cols) {
            let d = grid.centre(col, row).distance(dome.centre);
            // Faded out at the reach, where the Gaussian is 3e-4.
            let bell =
                (-0.5 * (d / params.dome_radius).powi(2)).exp() * smoother((reach - d) / params.dome_radius);
            uplift.data[row * grid.cols + col] += (rate * bell) as f32;
        }
    }
}
