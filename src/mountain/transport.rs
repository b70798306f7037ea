//! The transport field: where the crust under each point came from (Eq. 1–2), and how much thicker it is for it.
//!
//! With `B_i = T_i(A_i)` the rigid sets after the motion, `π_i`, `d_i` projection and distance to them,
//! `w_i = d_i^(−e)` and the rest weight `w_0 = 1/D^e` of the ground,
//!
//! ```text
//! Φ⁻¹(p) = p + Σ w_i (T_i⁻¹ π_i − π_i) / (Σ w_i + w_0),      Φ⁻¹(p) = T_i⁻¹ p inside B_i,
//! q(cell) = (signed area of the quad Φ⁻¹ of its corners) / (area of the cell).
//! ```
//!
//! The published text takes `π` and `d` to `A_i` outside and `T_i(A_i)` inside, which tears the crust along the
//! rim; with `B_i` in both places `Φ⁻¹` is continuous and `q = 1` inside. Evaluation at cell corners keeps `q` finite
//! where `e < 1` makes the gradient singular (the rims), and makes the sum of `q` telescope to the area of the
//! domain's preimage. Corners where the crust has turned over give `q ≤ 0`; they are counted, never NaN.

pub(crate) mod rows;

use std::fmt::Debug;

use glam::DVec2;
use rayon::prelude::*;

use super::grid::{Field, Grid};
use super::hull::Hull;
use crate::gesture::rigid::RigidMotion;

/// A rigid set after its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MovedBody {
    /// `B = T(A)`, plan metres.
    pub hull: Hull,
    /// `T`.
    pub motion: RigidMotion,
}

/// What Eq. 1–2 are asked.
#[derive(Clone, Debug, PartialEq)]
pub struct TransportProblem {
    /// Cells; the corners are where Φ⁻¹ is evaluated.
    pub grid: Grid,
    /// The rigid sets; they do not overlap.
    pub bodies: Vec<MovedBody>,
    /// `e`.
    pub exponent: f64,
    /// `1/D^e` in m^(−e), 0 for the published equation.
    pub rest_weight: f64,
}

/// Figures about a transport field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TransportReport {
    /// Number of cells.
    pub cells: usize,
    /// Size of a cell, km.
    pub cell_km: f64,
    /// Least `q`.
    pub q_min: f64,
    /// Largest `q`.
    pub q_max: f64,
    /// Crust on the grid after the motion, Σ q·cell area, km² of unit thickness.
    pub volume: f64,
    /// Signed area of the preimage of the grid's border, km²: equals `volume` up to rounding.
    pub preimage_area: f64,
    /// Cells where the crust has turned over (`q ≤ 0`).
    pub folded_cells: usize,
}

/// Result of the stage; the buffers are reused from run to run.
#[derive(Clone, Debug, PartialEq)]
pub struct TransportField {
    /// The cells.
    pub grid: Grid,
    /// East component of `Φ⁻¹(p) − p` at the `(cols + 1) × (rows + 1)` corners, metres, from the north-west.
    pub east: Vec<f32>,
    /// North component of the same.
    pub north: Vec<f32>,
    /// Thickness after the motion over thickness before, per cell.
    pub q: Field,
    /// Figures.
    pub report: TransportReport,
}

impl TransportField {
    /// An empty field for a grid: nothing has moved.
    pub fn new(grid: Grid) -> Self {
        let corners = (grid.cols + 1) * (grid.rows + 1);
        Self {
            grid,
            east: vec![0.0; corners],
            north: vec![0.0; corners],
            q: Field::constant(grid, 1.0),
            report: TransportReport::default(),
        }
    }

    /// `Φ⁻¹(p) − p` at a corner, metres.
    pub fn shift(&self, col: usize, row: usize) -> DVec2 {
        let at = row * (self.grid.cols + 1) + col;
        DVec2::new(f64::from(self.east[at]), f64::from(self.north[at]))
    }

    /// Makes it a field for `grid`; one for the same grid keeps its memory and values. For stages.
    pub fn fit(&mut self, grid: Grid) {
        if self.grid != grid {
            *self = Self::new(grid);
        }
    }

    /// Brings the report to what the field holds. For stages.
    pub fn tally(&mut self) {
        let tasks = self.q.data.par_chunks(self.grid.cols * ROWS_PER_TASK);
        let tasks: Vec<rows::QuadSums> = tasks.map(rows::sums).collect();
        self.report_of(&rows::QuadSums::in_order(&tasks));
    }

    fn report_of(&mut self, sums: &rows::QuadSums) {
        let grid = self.grid;
        self.report = TransportReport {
            cells: grid.len(),
            cell_km: grid.cell / 1e3,
            q_min: f64::from(sums.min),
            q_max: f64::from(sums.max),
            volume: sums.sum * grid.cell * grid.cell / 1e6,
            preimage_area: border_area(self) / 1e6,
            folded_cells: sums.folded,
        };
    }
}

/// The stage; a twin on another device implements it too, and answers as [`CpuTransport`] does to [`Q_TOLERANCE`].
pub trait TransportStage: Debug + Send + Sync {
    /// Fills `out` for `problem`.
    fn run(&mut self, problem: &TransportProblem, out: &mut TransportField);

    /// False where what it computes is right within the tolerance alone, and not the same bits on every machine.
    fn is_reproducible(&self) -> bool {
        true
    }
}

impl<S: TransportStage + ?Sized> TransportStage for Box<S> {
    fn run(&mut self, problem: &TransportProblem, out: &mut TransportField) {
        (**self).run(problem, out);
    }

    fn is_reproducible(&self) -> bool {
        (**self).is_reproducible()
    }
}

/// Rows in parallel on the CPU, in `f32` relative to each body: displacements are exact to about 2 mm, `q` to
/// [`Q_TOLERANCE`].
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuTransport;

/// How far `q` of [`CpuTransport`] may lie from the exact one on grids of about 1024² cells: displacements of tens
/// of kilometres are rounded at 2 mm, and four of them are divided by a cell of 130 m.
pub const Q_TOLERANCE: f64 = 2e-4;

/// Corner rows that one task computes. Fixed, so that no result depends on the number of threads.
const ROWS_PER_TASK: usize = 8;

impl TransportStage for CpuTransport {
    fn run(&mut self, problem: &TransportProblem, out: &mut TransportField) {
        let grid = problem.grid;
        out.fit(grid);
        let corners = grid.cols + 1;
        let kernel = rows::Kernel::new(problem);
        out.east
            .par_chunks_mut(corners * ROWS_PER_TASK)
            .zip(out.north.par_chunks_mut(corners * ROWS_PER_TASK))
            .enumerate()
            .for_each(|(task, (east, north))| {
                for (k, (east, north)) in east
                    .chunks_exact_mut(corners)
                    .zip(north.chunks_exact_mut(corners))
                    .enumerate()
                {
                    kernel.row(task * ROWS_PER_TASK + k, east, north);
                }
            });
        let (east, north) = (&out.east, &out.north);
        let tasks: Vec<rows::QuadSums> = out
            .q
            .data
            .par_chunks_mut(grid.cols * ROWS_PER_TASK)
            .enumerate()
            .map(|(task, q)| {
                let mut sums = rows::QuadSums::default();
                for (k, q) in q.chunks_exact_mut(grid.cols).enumerate() {
                    let at = (task * ROWS_PER_TASK + k) * corners;
                    let rows = at..at + 2 * corners;
                    rows::quads(&east[rows.clone()], &north[rows], grid.cell as f32, q);
                    // While the row is in the cache.
                    sums.add(&rows::sums(q));
                }
                sums
            })
            .collect();
        out.report_of(&rows::QuadSums::in_order(&tasks));
    }
}

/// Signed area of the preimage of the grid's border polygon, m².
fn border_area(field: &TransportField) -> f64 {
    let grid = field.grid;
    let origin = grid.corner(0, 0);
    let at = |col: usize, row: usize| grid.corner(col, row) - origin + field.shift(col, row);
    // Down the west side, east along the south, up the east side, west along the north: counter-clockwise.
    let border = (0..grid.rows)
        .map(|row| (0, row))
        .chain((0..grid.cols).map(|col| (col, grid.rows)))
        .chain((1..=grid.rows).rev().map(|row| (grid.cols, row)))
        .chain((1..=grid.cols).rev().map(|col| (col, 0)));
    let mut twice = 0.0;
    let mut last = at(1, 0);
    for (col, row) in border {
        let here = at(col, row);
        twice += last.perp_dot(here);
        last = here;
    }
    twice / 2.0
}

/// Eq. 1–2 as they stand, one point at a time in `f64` with exact powers: the oracle of the fast stage.
pub mod reference {
    use super::{DVec2, TransportProblem};

    /// `Φ⁻¹(p) − p` in metres.
    pub fn shift(problem: &TransportProblem, p: DVec2) -> DVec2 {
        let (mut sum, mut weights) = (DVec2::ZERO, problem.rest_weight);
        for body in &problem.bodies {
            let near = body.hull.nearest(p);
            let moved = body.motion.apply_inverse(near.projection) - near.projection;
            if near.distance == 0.0 {
                return moved;
            }
            let w = near.distance.powf(-problem.exponent);
            sum += moved * w;
            weights += w;
        }
        if weights > 0.0 { sum / weights } else { DVec2::ZERO }
    }

    /// `q` of every cell, row by row from the north.
    pub fn thickness(problem: &TransportProblem) -> Vec<f64> {
        let grid = problem.grid;
        let preimage = |row: usize| -> Vec<DVec2> {
            (0..=grid.cols)
                .map(|col| {
                    let p = grid.corner(col, row);
                    p - grid.north_west + shift(problem, p)
                })
                .collect()
        };
        let mut q = Vec::with_capacity(grid.len());
        let mut above = preimage(0);
        for row in 1..=grid.rows {
            let below = preimage(row);
            for col in 0..grid.cols {
                // Half the cross product of the diagonals, south-west → north-east and south-east → north-west.
                let rising = above[col + 1] - below[col];
                let falling = above[col] - below[col + 1];
                q.push(0.5 * rising.perp_dot(falling) / (grid.cell * grid.cell));
            }
            above = below;
        }
        q
    }
}
