//! Who computes the stages at this table: as the settings say, or whoever was faster when it opened.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;

use crate::gesture::rigid::RigidMotion;
use crate::gpu::{Gpu, GpuError, GpuFolds, GpuTransport, OnCard};
use crate::live::LiveParams;
use crate::mountain::fold::shape::SHAPE_TOLERANCE;
use crate::mountain::fold::{CpuFolds, FoldDrive, FoldMesh, FoldShape, FoldStage, Skeleton};
use crate::mountain::transport::{
    CpuTransport, MovedBody, Q_TOLERANCE, TransportField, TransportProblem, TransportStage,
};
use crate::mountain::{Grid, Hull, MountainParams, Stages};
use crate::settings::Compute;
use crate::sim::folding_layers;
use crate::units::{Extent, KM};

/// Runs of which the fastest counts, after one that warms up.
const RUNS: usize = 3;

/// Part of the processor's time that the card must stay below: for less the trouble is not worth while.
const FASTER: f64 = 0.9;

/// Hands of the trial, as parts of the land: where they are, and where they push, km.
const HANDS: [([f64; 2], [f64; 2]); 3] = [
    ([0.25, 0.4], [0.0, 0.0]),
    ([0.6, 0.3], [-14.0, 3.0]),
    ([0.55, 0.8], [-6.0, -12.0]),
];

/// Fingers of a hand around its middle, km.
const FINGERS: [[f64; 2]; 5] = [[-9.0, -4.0], [-5.5, 6.0], [0.0, 8.5], [5.0, 7.0], [9.0, 1.0]];

/// One node in so many folds in the trial: about what two hands make fold.
const FOLDING: usize = 4;

/// Who computes what, for those who look.
#[derive(Clone, Debug, Default)]
pub(super) struct Chosen {
    transport: Option<OnCard>,
    folds: Option<OnCard>,
}

impl Chosen {
    /// The settings' words for who computes the transport now.
    pub(super) fn transport(&self) -> &'static str {
        word(self.transport.as_ref())
    }

    /// The same for heights of folds.
    pub(super) fn folds(&self) -> &'static str {
        word(self.folds.as_ref())
    }
}

fn word(on_card: Option<&OnCard>) -> &'static str {
    if on_card.is_some_and(OnCard::get) {
        "gpu"
    } else {
        "cpu"
    }
}

/// The stages for a session of `params` as `wish` has them. A window that a processor draws, `software`, has no card that
/// could be faster, so nothing is measured.
pub(super) fn choose(wish: Compute, software: bool, params: &LiveParams) -> (Stages, Chosen) {
    if wish == Compute::Cpu || (wish == Compute::Auto && software) {
        return (Stages::default(), Chosen::default());
    }
    try_card(wish, params).unwrap_or_else(|error| {
        tracing::info!("the processor computes all stages: {error}");
        (Stages::default(), Chosen::default())
    })
}

fn try_card(wish: Compute, params: &LiveParams) -> Result<(Stages, Chosen), GpuError> {
    let gpu = Arc::new(Gpu::computing()?);
    if wish == Compute::Auto && gpu.is_software() {
        return Err(GpuError::Refused(format!(
            "{} is none that is faster",
            gpu.info.name
        )));
    }
    let (mut stages, mut chosen) = (Stages::default(), Chosen::default());
    let extent = params.map.extent();
    let mountain = params.sim.mountain.clone().for_nodes(params.nodes);
    let mut transport = GpuTransport::new(&gpu)?;
    let trial = try_transport(&mut transport, &hands(extent, &mountain));
    if trial.told("transport", &gpu).passes(wish) && transport.on_card().get() {
        chosen.transport = Some(transport.on_card());
        stages.transport = Box::new(transport);
    }
    let mut folds = GpuFolds::new(&gpu)?;
    if let Some((shape, points)) = folded(Grid::over(extent, mountain.cells), params) {
        let trial = try_folds(&mut folds, &shape, &points);
        if trial.told("heights of folds", &gpu).passes(wish) && folds.on_card().get() {
            chosen.folds = Some(folds.on_card());
            stages.folds = Box::new(folds);
        }
    }
    Ok((stages, chosen))
}

/// What a trial of a stage has shown.
struct Trial {
    cpu_ms: f64,
    card_ms: f64,
    /// The largest difference between the two, in tolerances.
    off: f64,
}

impl Trial {
    /// Notes it in the log.
    fn told(self, stage: &str, gpu: &Gpu) -> Self {
        tracing::info!(
            "{stage}: {:.2} ms on the processor, {:.2} ms on {}, which differ by {:.2} tolerances",
            self.cpu_ms,
            self.card_ms,
            gpu.info.name,
            self.off,
        );
        self
    }

    fn passes(&self, wish: Compute) -> bool {
        let faster = self.card_ms < FASTER * self.cpu_ms;
        self.off <= 1.0 && (faster || wish == Compute::Gpu)
    }
}

/// Time of the fastest run, ms.
fn fastest(mut run: impl FnMut()) -> f64 {
    run();
    let timed = |()| {
        let begun = Instant::now();
        run();
        begun.elapsed().as_secs_f64() * 1e3
    };
    [(); RUNS].map(timed).into_iter().fold(f64::INFINITY, f64::min)
}

/// The largest of some differences; ∞ where one is none.
fn largest(differences: impl Iterator<Item = f64>) -> f64 {
    differences.fold(0.0, |most, off| {
        if off.is_nan() {
            f64::INFINITY
        } else {
            most.max(off)
        }
    })
}

fn try_transport(card: &mut impl TransportStage, problem: &TransportProblem) -> Trial {
    let fields = [(); 2].map(|()| TransportField::new(problem.grid));
    let [mut exact, mut field] = fields;
    let card_ms = fastest(|| card.run(problem, &mut field));
    let cpu_ms = fastest(|| CpuTransport.run(problem, &mut exact));
    let cells = field.q.data.iter().zip(&exact.q.data);
    // Both may be off by one.
    let off = cells.map(|(q, exact)| f64::from((q - exact).abs() / exact.abs().max(1.0)));
    Trial {
        cpu_ms,
        card_ms,
        off: largest(off) / (2.0 * Q_TOLERANCE),
    }
}

fn try_folds(card: &mut impl FoldStage, shape: &FoldShape, points: &[DVec2]) -> Trial {
    let (mut exact, mut heights) = (Vec::new(), Vec::new());
    let card_ms = fastest(|| card.at_points(shape, points, &mut heights));
    let cpu_ms = fastest(|| CpuFolds.at_points(shape, points, &mut exact));
    let off = heights
        .iter()
        .zip(&exact)
        .map(|(height, exact)| (height - exact).abs());
    Trial {
        cpu_ms,
        card_ms,
        off: largest(off) / SHAPE_TOLERANCE,
    }
}

/// Three hands on the land.
fn hands(extent: Extent, params: &MountainParams) -> TransportProblem {
    let body = |(at, by): ([f64; 2], [f64; 2])| {
        let at = DVec2::from_array(at) * extent.size();
        let fingers = FINGERS.map(|finger| at + DVec2::from_array(finger) * KM);
        let motion = RigidMotion {
            angle: 0.0,
            translation: DVec2::from_array(by) * KM,
        };
        let hull = Hull::new(&fingers, params.finger_radius)?.moved(&motion);
        Some(MovedBody { hull, motion })
    };
    TransportProblem {
        grid: Grid::over(extent, params.cells),
        bodies: HANDS.into_iter().filter_map(body).collect(),
        exponent: params.exponent,
        rest_weight: params.rest_weight(),
    }
}

/// The longest folds of the land's rock, all over it, and places on it; `None` for rock that does not fold.
fn folded(grid: Grid, params: &LiveParams) -> Option<(FoldShape, Vec<DVec2>)> {
    let extent = params.map.extent();
    let spacing = (extent.area() / params.nodes.max(1) as f64).sqrt();
    let layer = *folding_layers(&params.layers, spacing, 1).first()?;
    let mesh = FoldMesh::new(extent, layer.wavelength, params.seed).ok()?;
    let drive = FoldDrive::uniform(grid.blocks(), 1e-3, 0.4);
    let shape = FoldShape::new(&mesh, &Skeleton::select(&mesh, &drive, None, &[]));
    let places = Grid::over(extent, params.nodes / FOLDING);
    let points = (0..places.len()).map(|at| places.centre(at % places.cols, at / places.cols));
    Some((shape, points.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_card_is_taken_where_it_is_faster_and_right() {
        let trial = |card_ms, off| Trial {
            cpu_ms: 5.0,
            card_ms,
            off,
        };
        assert!(trial(1.0, 0.3).passes(Compute::Auto));
        assert!(!trial(4.9, 0.3).passes(Compute::Auto) && trial(4.9, 0.3).passes(Compute::Gpu));
        assert!(!trial(1.0, 1.1).passes(Compute::Auto) && !trial(1.0, 1.1).passes(Compute::Gpu));
        let wrong = largest([0.1, f64::NAN, 0.2].into_iter());
        assert!(!trial(1.0, wrong).passes(Compute::Gpu));
    }

    #[test]
    fn a_twin_that_is_wrong_fails_its_trial() {
        #[derive(Debug)]
        struct Inverted;
        impl TransportStage for Inverted {
            fn run(&mut self, problem: &TransportProblem, out: &mut TransportField) {
                CpuTransport.run(problem, out);
                out.q.data.iter_mut().for_each(|q| *q = 2.0 - *q);
            }
        }
        let extent = Extent {
            width: 178_000.0,
            height: 100_000.0,
        };
        let params = MountainParams {
            cells: 64 * 64,
            ..MountainParams::default()
        };
        let problem = hands(extent, &params);
        assert_eq!(problem.bodies.len(), HANDS.len());
        assert!(!try_transport(&mut Inverted, &problem).passes(Compute::Gpu));
        assert!(try_transport(&mut CpuTransport, &problem).passes(Compute::Gpu));
    }
}
