//! Heights of folds on the card: the twin of [`CpuFolds`].

use std::sync::Arc;
use std::time::Duration;

use glam::DVec2;
use rayon::prelude::*;

use super::layout::{Folds, Lines, Place};
use super::program::{Program, Run};
use super::stage::{OnCard, Twin};
use super::{Gpu, GpuError};
use crate::mountain::Grid;
use crate::mountain::fold::shape::SHAPE_TOLERANCE;
use crate::mountain::fold::{CpuFolds, FoldShape, FoldStage, PackedLines};

/// Entries of the shader.
const ON_GRID: usize = 0;
const AT_POINTS: usize = 1;

/// Columns of the rectangle in which points are worked on.
const COLUMNS: usize = 256;

/// Points or cells per task on the processor.
const CHUNK: usize = 1 << 14;

/// [`FoldStage`] on a graphics card, in `f32` relative to buckets as wide as a fold; where the card fails, the processor
/// goes on within the same run.
#[derive(Debug)]
pub struct GpuFolds {
    twin: Twin<OnTheCard>,
    cpu: CpuFolds,
}

#[derive(Debug)]
struct OnTheCard {
    program: Program,
    starts: Vec<u32>,
    lines: Vec<[f32; 4]>,
    places: Vec<[Place; 2]>,
}

impl GpuFolds {
    /// The stage on `gpu`.
    ///
    /// # Errors
    /// When the adapter does not compute, or refuses the shader.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let program = Program::new(gpu, "folds", &["on_grid", "at_points"])?;
        let twin = OnTheCard {
            program,
            starts: Vec::new(),
            lines: Vec::new(),
            places: Vec::new(),
        };
        Ok(Self {
            twin: Twin::new("heights of folds", twin),
            cpu: CpuFolds,
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

impl FoldStage for GpuFolds {
    fn at_points(&mut self, shape: &FoldShape, points: &[DVec2], out: &mut Vec<f64>) {
        if !self.twin.does(|twin| twin.at_points(shape, points, out)) {
            self.cpu.at_points(shape, points, out);
        }
    }

    fn on_grid(&mut self, shape: &FoldShape, grid: Grid, out: &mut Vec<f32>) {
        if !self.twin.does(|twin| twin.on_grid(shape, grid, out)) {
            self.cpu.on_grid(shape, grid, out);
        }
    }

    fn is_reproducible(&self) -> bool {
        !self.twin.works()
    }
}

impl OnTheCard {
    fn at_points(&mut self, shape: &FoldShape, points: &[DVec2], out: &mut Vec<f64>) -> Result<(), GpuError> {
        let place = |p: &DVec2| [p.x, p.y].map(|at| place(at, shape));
        points
            .par_iter()
            .with_min_len(CHUNK)
            .map(place)
            .collect_into_vec(&mut self.places);
        let size = [COLUMNS, points.len().div_ceil(COLUMNS)];
        out.resize(points.len(), 0.0);
        self.run(shape, (AT_POINTS, size, points.len()), |heights| {
            out.par_chunks_mut(CHUNK)
                .zip(heights.par_chunks(CHUNK))
                .all(|(out, heights)| {
                    for (out, &height) in out.iter_mut().zip(heights) {
                        *out = f64::from(height);
                    }
                    sane(heights)
                })
        })
    }

    fn on_grid(&mut self, shape: &FoldShape, grid: Grid, out: &mut Vec<f32>) -> Result<(), GpuError> {
        let columns = (0..grid.cols).map(|col| grid.centre(col, 0).x);
        let rows = (0..grid.rows).map(|row| grid.centre(0, row).y);
        let mut both = columns.chain(rows).map(|at| place(at, shape));
        self.places.clear();
        while let Some(first) = both.next() {
            self.places.push([first, both.next().unwrap_or_default()]);
        }
        out.resize(grid.len(), 0.0);
        self.run(shape, (ON_GRID, [grid.cols, grid.rows], grid.len()), |heights| {
            out.par_chunks_mut(CHUNK)
                .zip(heights.par_chunks(CHUNK))
                .all(|(out, heights)| {
                    out.copy_from_slice(heights);
                    sane(heights)
                })
        })
    }

    /// Runs an entry over `size` for so many heights and hands them to `take`, which says whether they can be true.
    fn run(
        &mut self,
        shape: &FoldShape,
        (entry, size, count): (usize, [usize; 2], usize),
        take: impl FnOnce(&[f32]) -> bool,
    ) -> Result<(), GpuError> {
        if count == 0 {
            return Ok(());
        }
        let [crests, troughs] = shape.pack(&mut self.starts, &mut self.lines).map(lines_of);
        let uniform = Folds {
            crests,
            troughs,
            size: size.map(|side| side as u32),
            count: count as u32,
            bucket: shape.wavelength() as f32,
            reach: shape.reach() as f32,
            padding: [0; 3],
        };
        let run = Run {
            uniform: bytemuck::bytes_of(&uniform),
            inputs: [
                bytemuck::cast_slice(&self.starts),
                bytemuck::cast_slice(&self.lines),
                bytemuck::cast_slice(&self.places),
            ],
            results: count,
            passes: &[(entry, size)],
        };
        let mut true_ones = false;
        self.program.run(&run, |heights| true_ones = take(heights))?;
        if true_ones {
            Ok(())
        } else {
            Err(GpuError::Refused("heights of folds beyond 0 to 1".to_owned()))
        }
    }
}

/// Where a coordinate lies in the lattice of buckets.
fn place(at: f64, shape: &FoldShape) -> Place {
    let bucket = (at / shape.wavelength()).floor();
    Place {
        bucket: bucket as i32,
        offset: (at - bucket * shape.wavelength()) as f32,
    }
}

fn lines_of(packed: PackedLines) -> Lines {
    let ([col, row], [cols, rows]) = (packed.lattice, packed.size);
    Lines {
        buckets: [col, row, cols as i32, rows as i32],
        first: packed.first,
        half_length: packed.half_length,
        padding: [0; 2],
    }
}

/// True for heights that folds can have, rounding allowed for.
fn sane(heights: &[f32]) -> bool {
    let least = -SHAPE_TOLERANCE as f32;
    heights
        .iter()
        .all(|height| (least..=1.0 - least).contains(height))
}
