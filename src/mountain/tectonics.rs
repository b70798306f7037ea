//! The whole half: plates → transport → compression → belts → uplift and faults.

use glam::DVec2;

use super::belt::{Kind, belts};
use super::buckling;
use super::compression::CompressionField;
use super::fault::{FaultTrace, trace};
use super::fold::FoldDrive;
use super::grid::{Field, Grid};
use super::params::MountainParams;
use super::plate::{Pair, PlateSet};
use super::residue;
use super::transport::{
    CpuTransport, MovedBody, TransportField, TransportProblem, TransportReport, TransportStage,
};
use super::uplift::{NOBODY, UpliftStage};
use crate::gesture::rigid::RigidMotion;
use crate::units::Extent;

/// A belt crops out in a fault of its own only where it rises at least this fast against the fastest: slower ones drape
/// the flanks of others.
const LEAST_FAULTED: f64 = 0.3;

/// Figures about an uplift field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TectonicReport {
    /// Figures of the transport.
    pub transport: TransportReport,
    /// Mean uplift where the ground rises, m/yr; 0 if it rises nowhere.
    pub mean_uplift: f64,
    /// Largest uplift, m/yr.
    pub max_uplift: f64,
    /// Fastest subsidence, m/yr, as a negative rate.
    pub min_uplift: f64,
    /// Cells that turned over in blocks that rise: a motion that should have been capped.
    pub folded_rising_cells: usize,
}

/// What the plates do to the crust: plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct TectonicField {
    /// The transport: displacements at cell corners and thickening `q` per cell.
    pub transport: TransportField,
    /// Shortening per cell.
    pub compression: CompressionField,
    /// Uplift rate in m/yr on the grid of blocks of the transport's cells.
    pub uplift: Field,
    /// What makes the layers fold, on the same grid.
    pub folding: FoldDrive,
    /// Traces of the main faults.
    pub faults: Vec<FaultTrace>,
    /// Figures.
    pub report: TectonicReport,
}

impl TectonicField {
    /// A field in which nothing moves.
    pub fn still(extent: Extent, params: &MountainParams) -> Self {
        let grid = Grid::over(extent, params.cells);
        Self {
            transport: TransportField::new(grid),
            compression: CompressionField::none(grid),
            uplift: Field::constant(grid.blocks(), 0.0),
            folding: FoldDrive::still(grid.blocks()),
            faults: Vec::new(),
            report: TectonicReport::default(),
        }
    }

    /// Uplift rate at `p` (plan metres), m/yr, bilinear.
    pub fn uplift_at(&self, p: DVec2) -> f64 {
        self.uplift.at(p)
    }

    /// The fault nearest to `p` within `reach` metres.
    pub fn fault_near(&self, p: DVec2, reach: f64) -> Option<Pair> {
        self.faults
            .iter()
            .map(|fault| (fault.distance(p), fault.pair))
            .filter(|(distance, _)| *distance <= reach)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, pair)| pair)
    }
}

/// Computes tectonic fields; keeps scratch from one to the next.
#[derive(Debug)]
pub struct Tectonics<S = CpuTransport> {
    stage: S,
    uplift: Option<(Grid, UpliftStage)>,
    sorted: Vec<f32>,
}

impl Default for Tectonics {
    fn default() -> Self {
        Self::with_stage(CpuTransport)
    }
}

impl<S: TransportStage> Tectonics<S> {
    /// Uses another implementation of the transport.
    pub fn with_stage(stage: S) -> Self {
        Self {
            stage,
            uplift: None,
            sorted: Vec::new(),
        }
    }

    /// The implementation of the transport.
    pub fn stage(&self) -> &S {
        &self.stage
    }

    /// Uses another implementation from now on, and gives the old one back.
    pub fn replace_stage(&mut self, stage: S) -> S {
        std::mem::replace(&mut self.stage, stage)
    }

    /// The field of the plates at `now_yr` over `extent`.
    pub fn compute(
        &mut self,
        plates: &PlateSet,
        extent: Extent,
        now_yr: f64,
        params: &MountainParams,
    ) -> TectonicField {
        let mut field = TectonicField::still(extent, params);
        self.compute_into(plates, extent, now_yr, params, &mut field);
        field
    }

    /// The same into a field of an earlier frame, whose memory is reused.
    pub fn compute_into(
        &mut self,
        plates: &PlateSet,
        extent: Extent,
        now_yr: f64,
        params: &MountainParams,
        out: &mut TectonicField,
    ) {
        let grid = Grid::over(extent, params.cells);
        if out.transport.grid != grid {
            *out = TectonicField::still(extent, params);
        }
        let bodies = plates.bodies(now_yr);
        let moving = bodies.iter().any(|b| b.motion != RigidMotion::IDENTITY);
        let problem = TransportProblem {
            grid,
            bodies: if moving {
                bodies
                    .iter()
                    .map(|b| MovedBody {
                        hull: b.support.moved(&b.motion),
                        motion: b.motion,
                    })
                    .collect()
            } else {
                // Anchors alone move nothing.
                Vec::new()
            },
            exponent: params.exponent,
            rest_weight: params.rest_weight(),
        };
        self.stage.run(&problem, &mut out.transport);
        out.compression.fill(&out.transport);
        let mut belts = belts(&bodies, params, |pair| plates.fault_side(pair));

        let blocks = grid.blocks();
        if self.uplift.as_ref().is_none_or(|(known, _)| *known != blocks) {
            self.uplift = Some((blocks, UpliftStage::new(blocks)));
        }
        let Some((_, stage)) = &mut self.uplift else {
            return;
        };
        stage.run(
            &out.transport.q,
            &problem,
            &mut belts,
            plates.domes(),
            now_yr,
            params,
            &mut out.uplift,
        );
        out.faults.clear();
        let most = out.uplift.data.iter().copied().fold(0.0, f32::max);
        for (index, belt) in belts.iter().enumerate().take(usize::from(NOBODY)) {
            if belt.kind == Kind::Rift {
                continue;
            }
            if let Some(top) = stage.percentile_of(index as u8, &out.uplift, 0.95)
                && top >= LEAST_FAULTED * f64::from(most)
            {
                let level = params.fault_level * top;
                let traces = trace(&out.uplift, &stage.owner, index as u8, belt, level);
                out.faults.extend(
                    traces
                        .into_iter()
                        .filter_map(|fault| fault.within(grid, params.border_fade)),
                );
            }
        }
        buckling::fill(
            &out.compression,
            &out.uplift,
            params,
            &mut self.sorted,
            &mut out.folding,
        );
        residue::join(
            &mut out.uplift,
            &mut out.folding,
            plates.residues().iter().filter(|r| now_yr < r.expires_yr),
        );
        out.report = report(out);
    }
}

fn report(field: &TectonicField) -> TectonicReport {
    let (mut sum, mut rising) = (0.0, 0_usize);
    let (mut max, mut min) = (0.0_f64, 0.0_f64);
    for &u in &field.uplift.data {
        let u = f64::from(u);
        if u > 0.0 {
            sum += u;
            rising += 1;
        }
        max = max.max(u);
        min = min.min(u);
    }
    let folded = if field.transport.report.folded_cells == 0 {
        0
    } else {
        let (fine, coarse) = (field.transport.grid.cols, field.uplift.grid.cols);
        field
            .transport
            .q
            .data
            .iter()
            .enumerate()
            .filter(|(at, q)| {
                let (row, col) = (at / fine / Grid::BLOCK, at % fine / Grid::BLOCK);
                **q <= 0.0 && field.uplift.data[row * coarse + col] > 0.0
            })
            .count()
    };
    TectonicReport {
        transport: field.transport.report,
        mean_uplift: if rising > 0 { sum / rising as f64 } else { 0.0 },
        max_uplift: max,
        min_uplift: min,
        folded_rising_cells: folded,
    }
}
