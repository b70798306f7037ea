//! Heights of folds on the card against the stage on the processor.
//!
//! Where nothing computes, the tests say so and pass; with `OROGEN_REQUIRE_GPU=1` they fail.

use crate::fold_common;
use std::time::Duration;

use crate::card;
use crate::fold_common::RATE;
use glam::DVec2;
use orogen::gpu::GpuFolds;
use orogen::mountain::Grid;
use orogen::mountain::fold::shape::SHAPE_TOLERANCE;
use orogen::mountain::fold::{CpuFolds, Drive, FoldDrive, FoldShape, FoldStage, Skeleton};
use orogen::units::{Extent, KM};

const LAND: Extent = Extent {
    width: 100.0 * KM,
    height: 60.0 * KM,
};

/// Compression that turns slowly across the land, in the part of it that `folds` names.
fn shape(wavelength_km: f64, folds: impl Fn(DVec2) -> bool) -> FoldShape {
    let drive = FoldDrive::from_fn(fold_common::blocks(LAND), |p| Drive {
        rate: if folds(p) { RATE } else { 0.0 },
        direction: DVec2::from_angle(p.x / (60.0 * KM)),
        limit: f64::INFINITY,
    });
    let mesh = fold_common::mesh(LAND, wavelength_km, 11);
    FoldShape::new(&mesh, &Skeleton::select(&mesh, &drive, None, &[]))
}

/// A land without any, one that folds in its middle third, and folds all over, by name.
fn shapes() -> Vec<(&'static str, FoldShape)> {
    let middle = |p: DVec2| (p.x / LAND.width - 0.5).abs() < 1.0 / 6.0;
    vec![
        ("no folds", shape(5.0, |_| false)),
        ("a belt of 9 km", shape(9.0, middle)),
        ("a belt of 1 km", shape(1.0, middle)),
        ("folds of 7 km", shape(7.0, |_| true)),
        ("folds of 2.1 km", shape(2.1, |_| true)),
        ("folds of 0.8 km", shape(0.8, |_| true)),
    ]
}

/// Cells larger than this no land has, and the processor's tiles of them outgrow `f32`.
const LARGEST_CELL: f64 = 3.0 * KM;

/// A grid of any size over the land, as far as its cells reach, and `margin` metres beyond it.
fn grid(cols: usize, rows: usize, margin: f64) -> Grid {
    Grid {
        cols,
        rows,
        cell: ((LAND.width + 2.0 * margin) / cols as f64).min(LARGEST_CELL),
        north_west: DVec2::new(-margin, LAND.height + margin),
    }
}

/// Places all over the land and far beyond it, on no lattice.
fn places(count: u32) -> Vec<DVec2> {
    let golden = DVec2::new(0.754_877_666_246_693, 0.569_840_290_998_053);
    let margin = DVec2::splat(40.0 * KM);
    let place = |k| (f64::from(k) * golden).fract() * (LAND.size() + 2.0 * margin) - margin;
    (0..count).map(place).collect()
}

/// The stage, however slow the adapter is.
fn stage() -> Option<GpuFolds> {
    let stage = GpuFolds::new(&card::computing()?).expect("a stage");
    Some(stage.with_patience(Duration::from_mins(1)))
}

/// What is wrong with the answers of `stage`; nothing for a good one.
fn faults(stage: &mut dyn FoldStage, name: &str, shape: &FoldShape, grids: &[Grid]) -> Vec<String> {
    let mut faults = Vec::new();
    let mut judge = |what: String, tolerance: f64, heights: &mut dyn Iterator<Item = (f64, f64)>| {
        let off = |(found, exact): (f64, f64)| {
            let off = (found - exact).abs() / tolerance;
            if off.is_nan() { f64::INFINITY } else { off }
        };
        let worst = heights.map(off).fold(0.0, f64::max);
        if worst > 1.0 {
            faults.push(format!("{name}, {what}: off by {worst:.2} tolerances"));
        }
    };
    for &grid in grids {
        // What an earlier run left must not shine through.
        let mut heights = vec![f32::NAN; 7];
        stage.on_grid(shape, grid, &mut heights);
        assert_eq!(heights.len(), grid.len());
        let exact = |at: usize| shape.at(grid.centre(at % grid.cols, at / grid.cols));
        let mut both = heights
            .iter()
            .enumerate()
            .map(|(at, &h)| (f64::from(h), exact(at)));
        judge(
            format!("{} × {}", grid.cols, grid.rows),
            SHAPE_TOLERANCE,
            &mut both,
        );
        let mut cpu = Vec::new();
        CpuFolds.on_grid(shape, grid, &mut cpu);
        let mut both = heights
            .iter()
            .zip(&cpu)
            .map(|(&a, &b)| (f64::from(a), f64::from(b)));
        // Each of the two may be off by one.
        let what = format!("{} × {} on the processor", grid.cols, grid.rows);
        judge(what, 2.0 * SHAPE_TOLERANCE, &mut both);
    }
    for count in [0, 1, 255, 257, 4_999] {
        let points = places(count);
        let mut heights = vec![f64::NAN; 3];
        stage.at_points(shape, &points, &mut heights);
        assert_eq!(heights.len(), points.len());
        let mut both = heights.iter().zip(&points).map(|(&h, &p)| (h, shape.at(p)));
        judge(format!("{count} points"), SHAPE_TOLERANCE, &mut both);
    }
    faults
}

/// Sizes that workgroups divide, and that they do not.
fn grids() -> [Grid; 5] {
    [
        grid(1, 1, 0.0),
        grid(1, 97, 0.0),
        grid(97, 61, 3.0 * KM),
        grid(64, 48, 0.0),
        // Most of it is beyond every fold.
        grid(131, 115, 90.0 * KM),
    ]
}

#[test]
fn the_twin_agrees_on_every_shape() {
    let Some(mut stage) = stage() else { return };
    // One stage for all: buffers of one size must serve the next.
    for (name, shape) in shapes() {
        let found = faults(&mut stage, name, &shape, &grids());
        assert!(found.is_empty(), "{found:#?}");
    }
    assert!(stage.on_card().get(), "the card has done all of it");
}

#[test]
fn the_twin_agrees_on_a_million_cells() {
    let Some(mut stage) = stage() else { return };
    let found = faults(
        &mut stage,
        "1 km",
        &shape(1.0, |_| true),
        &[grid(1024, 1024, 0.0)],
    );
    assert!(found.is_empty(), "{found:#?}");
    assert!(stage.on_card().get());
}

/// A twin with a mistake.
#[derive(Debug)]
enum Broken {
    /// Crests are troughs.
    Inverted,
    /// Looks a little beside.
    Beside,
    /// A cell that no workgroup reached.
    Missed,
    /// Knows no fade.
    Unfaded,
}

impl Broken {
    fn spoil(&self, shape: &FoldShape, p: DVec2, height: f64, last: bool) -> f64 {
        match self {
            Self::Inverted => 1.0 - height,
            Self::Beside => shape.at(p + DVec2::new(20.0, 0.0)),
            Self::Missed if last => f64::NAN,
            Self::Missed => height,
            Self::Unfaded => shape.distances(p).map_or(0.0, |(crest, trough)| {
                let phase = std::f64::consts::PI * crest / (crest + trough).max(1e-6);
                0.5 * (1.0 + phase.cos())
            }),
        }
    }
}

impl FoldStage for Broken {
    fn at_points(&mut self, shape: &FoldShape, points: &[DVec2], out: &mut Vec<f64>) {
        CpuFolds.at_points(shape, points, out);
        for (at, (height, &p)) in out.iter_mut().zip(points).enumerate() {
            *height = self.spoil(shape, p, *height, at + 1 == points.len());
        }
    }

    fn on_grid(&mut self, shape: &FoldShape, grid: Grid, out: &mut Vec<f32>) {
        CpuFolds.on_grid(shape, grid, out);
        for (at, height) in out.iter_mut().enumerate() {
            let p = grid.centre(at % grid.cols, at / grid.cols);
            *height = self.spoil(shape, p, f64::from(*height), at + 1 == grid.len()) as f32;
        }
    }
}

#[test]
fn broken_twins_are_caught() {
    let (name, shape) = &shapes()[1];
    let grids = grids();
    for mut stage in [Broken::Inverted, Broken::Beside, Broken::Missed, Broken::Unfaded] {
        let found = faults(&mut stage, name, shape, &grids);
        // Once on a grid and once at points.
        assert!(found.iter().any(|fault| fault.contains('×')), "{stage:?}");
        assert!(found.iter().any(|fault| fault.contains("points")), "{stage:?}");
    }
    assert!(faults(&mut CpuFolds, name, shape, &grids).is_empty());
}

/// After a failure the processor answers: in the same run, to its own bits, and from then on.
fn falls_back(mut stage: GpuFolds) {
    let on_card = stage.on_card();
    let (_, shape) = &shapes()[3];
    let (grid, points) = (grid(97, 61, 0.0), places(300));
    let (mut exact, mut exact_points) = (Vec::new(), Vec::new());
    CpuFolds.on_grid(shape, grid, &mut exact);
    CpuFolds.at_points(shape, &points, &mut exact_points);
    for _ in 0..2 {
        let (mut heights, mut at_points) = (Vec::new(), Vec::new());
        stage.on_grid(shape, grid, &mut heights);
        assert_eq!(heights, exact);
        stage.at_points(shape, &points, &mut at_points);
        assert_eq!(at_points, exact_points);
        assert!(!on_card.get());
    }
}

#[test]
fn a_lost_device_leaves_the_work_to_the_processor() {
    let Some(gpu) = card::computing() else { return };
    let mut stage = GpuFolds::new(&gpu).expect("a stage");
    let (_, shape) = &shapes()[1];
    stage.on_grid(shape, grid(97, 61, 0.0), &mut Vec::new());
    gpu.device.destroy();
    falls_back(stage);
}

#[test]
fn a_card_that_does_not_answer_is_not_waited_for() {
    let Some(stage) = stage() else { return };
    let mut stage = stage.with_patience(Duration::ZERO);
    // More than an adapter can have done at once.
    stage.on_grid(&shape(0.8, |_| true), grid(2048, 1024, 0.0), &mut Vec::new());
    falls_back(stage);
}
