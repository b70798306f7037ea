//! The transport field on the card: the twin of [`CpuTransport`].

use std::sync::Arc;
use std::time::Duration;

use glam::DVec2;
use rayon::prelude::*;

use super::layout::{Body, Edge, Problem};
use super::program::{Program, Run};
use super::stage::{OnCard, Twin};
use super::{Gpu, GpuError};
use crate::mountain::transport::rows::{Back, rest_weight};
use crate::mountain::transport::{CpuTransport, MovedBody, TransportField, TransportProblem, TransportStage};

/// Entries of the shader.
const CORNERS: usize = 0;
const CELLS: usize = 1;

/// Numbers that one task copies.
const CHUNK: usize = 1 << 16;

/// Largest part of the crust that a field from the card may have lost or won beside its border: rounding takes a
/// thousandth of this, and a card that computes wrongly far more.
const LEAK: f64 = 1e-3;

/// [`TransportStage`] on a graphics card, in `f32` relative to each body; where the card fails, the processor goes on
/// within the same run.
#[derive(Debug)]
pub struct GpuTransport {
    twin: Twin<OnTheCard>,
    cpu: CpuTransport,
}

#[derive(Debug)]
struct OnTheCard {
    program: Program,
    bodies: Vec<Body>,
    edges: Vec<Edge>,
    places: Vec<f32>,
}

impl GpuTransport {
    /// The stage on `gpu`.
    ///
    /// # Errors
    /// When the adapter does not compute, or refuses the shader.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let program = Program::new(gpu, "transport", &["corners", "cells"])?;
        let twin = OnTheCard {
            program,
            bodies: Vec::new(),
            edges: Vec::new(),
            places: Vec::new(),
        };
        Ok(Self {
            twin: Twin::new("transport", twin),
            cpu: CpuTransport,
        })
    }

    /// The same with another longest wait for the card.
    #[must_use]
    pub fn with_patience(mut self, patience: Duration) -> Self {
        if let Some(twin) = self.twin.get_mut() {
            twin.program.patience = patience;
        }
        self
    }

    /// Whether the card still does the work, to be asked from elsewhere.
    pub fn on_card(&self) -> OnCard {
        self.twin.on_card()
    }
}

impl TransportStage for GpuTransport {
    fn run(&mut self, problem: &TransportProblem, out: &mut TransportField) {
        if !self.twin.does(|twin| twin.run(problem, out)) {
            self.cpu.run(problem, out);
        }
    }

    fn is_reproducible(&self) -> bool {
        !self.twin.works()
    }
}

impl OnTheCard {
    fn run(&mut self, problem: &TransportProblem, out: &mut TransportField) -> Result<(), GpuError> {
        let grid = problem.grid;
        self.describe(problem);
        out.fit(grid);
        let uniform = Problem {
            cols: grid.cols as u32,
            rows: grid.rows as u32,
            bodies: self.bodies.len() as u32,
            exponent: problem.exponent as f32,
            rest_weight: rest_weight(problem),
            per_cell: (1.0 / grid.cell) as f32,
        };
        let corners = out.east.len();
        let run = Run {
            uniform: bytemuck::bytes_of(&uniform),
            inputs: [
                bytemuck::cast_slice(&self.bodies),
                bytemuck::cast_slice(&self.edges),
                bytemuck::cast_slice(&self.places),
            ],
            results: 2 * corners + grid.len(),
            passes: &[
                (CORNERS, [grid.cols + 1, grid.rows + 1]),
                (CELLS, [grid.cols, grid.rows]),
            ],
        };
        self.program.run(&run, |field| {
            let (east, rest) = field.split_at(corners);
            let (north, q) = rest.split_at(corners);
            copy(east, &mut out.east);
            copy(north, &mut out.north);
            copy(q, &mut out.q.data);
        })?;
        out.tally();
        let (volume, expected) = (out.report.volume, out.report.preimage_area);
        let scale = grid.len() as f64 * (grid.cell / 1e3).powi(2) * (1.0 + out.report.q_max.abs());
        // Written so that a number that is none fails too.
        if (volume - expected).abs() <= LEAK * scale {
            Ok(())
        } else {
            Err(GpuError::Refused(format!(
                "crust is lost: {volume} km² of {expected} km²"
            )))
        }
    }

    /// Puts the bodies into words that the shader knows.
    fn describe(&mut self, problem: &TransportProblem) {
        self.bodies.clear();
        self.edges.clear();
        self.places.clear();
        let grid = problem.grid;
        let middle = (grid.corner(0, 0) + grid.corner(grid.cols, grid.rows)) / 2.0;
        for body in &problem.bodies {
            // The point of the body that the land is nearest to: what is far from it needs no digits.
            let pivot = body.hull.nearest(middle).projection;
            let first = self.edges.len() as u32;
            edges_of(body, pivot, &mut self.edges);
            let back = Back::of(&body.motion, pivot);
            self.bodies.push(Body {
                spin: back.spin,
                lift: back.lift,
                radius: body.hull.radius() as f32,
                first,
                edges: self.edges.len() as u32 - first,
                solid: u32::from(body.hull.core().len() > 2),
                padding: [0; 2],
            });
            let columns = (0..=grid.cols).map(|col| grid.corner(col, 0).x - pivot.x);
            let rows = (0..=grid.rows).map(|row| grid.corner(0, row).y - pivot.y);
            self.places.extend(columns.chain(rows).map(|at| at as f32));
        }
    }
}

/// The edges of a body's core as seen from `pivot`.
fn edges_of(body: &MovedBody, pivot: DVec2, out: &mut Vec<Edge>) {
    let edge = |from: DVec2, tangent: DVec2, length: f64| {
        let normal = -tangent.perp();
        Edge {
            normal: normal.as_vec2().to_array(),
            beyond: (pivot - from).dot(normal) as f32,
            along: (pivot - from).dot(tangent) as f32,
            length: length as f32,
            padding: 0.0,
        }
    };
    if let [corner] = body.hull.core() {
        out.push(edge(*corner, DVec2::X, 0.0));
    }
    out.extend(
        body.hull
            .edges()
            .map(|(from, to)| edge(from, (to - from).normalize(), from.distance(to))),
    );
}

fn copy(from: &[f32], to: &mut [f32]) {
    to.par_chunks_mut(CHUNK)
        .zip(from.par_chunks(CHUNK))
        .for_each(|(to, from)| to.copy_from_slice(from));
}
