//! Transport at 1024² cells with three plates, the whole way from a changed gesture to a new uplift, and folds.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec2;
use orogen::gesture::contact::Side;
use orogen::gesture::event::{HandEvent, HandId, Leg};
use orogen::gesture::rigid::RigidFit;
use orogen::mountain::compression::CompressionField;
use orogen::mountain::fold::lines::troughs;
use orogen::mountain::fold::{CpuFolds, FoldDrive, FoldMesh, FoldRates, FoldShape, PointRates, Skeleton};
use orogen::mountain::transport::{
    CpuTransport, MovedBody, TransportField, TransportProblem, TransportStage,
};
use orogen::mountain::{Grid, MountainParams, PlateSet, TectonicField, Tectonics};
use orogen::terrain::Tin;
use orogen::units::{DEFAULT_SHORT_SIDE, Extent, KM, PlanMap};
use rayon::prelude::*;

/// Five fingertips around a point, km.
const HAND: [[f64; 2]; 5] = [[-9.0, -4.0], [-5.5, 6.0], [0.0, 8.5], [5.0, 7.0], [9.0, 1.0]];

fn push(
    plates: &mut PlateSet,
    map: &PlanMap,
    hand: u32,
    at: DVec2,
    by: DVec2,
    turn: f64,
    params: &MountainParams,
) {
    let starts: Vec<DVec2> = HAND.iter().map(|&f| (at + DVec2::from_array(f)) * KM).collect();
    let spin = DVec2::from_angle(turn);
    let tips = starts.iter().map(|&p| spin.rotate(p - at * KM) + (at + by) * KM);
    let mm = |p: DVec2| map.to_table(p);
    let tips: Vec<DVec2> = tips.map(mm).collect();
    let starts: Vec<DVec2> = starts.into_iter().map(mm).collect();
    let event = HandEvent::Push {
        leg: Leg {
            hand: HandId(hand),
            index: 0,
        },
        side: Side::South,
        fit: RigidFit::fit(&starts, &tips),
        starts,
    };
    plates.apply(&event, map, 0.0, params);
}

fn three_plates(map: &PlanMap, params: &MountainParams) -> PlateSet {
    let mut plates = PlateSet::default();
    push(
        &mut plates,
        map,
        0,
        DVec2::new(40.0, 40.0),
        DVec2::new(3.0, 0.0),
        0.0,
        params,
    );
    push(
        &mut plates,
        map,
        1,
        DVec2::new(110.0, 28.0),
        DVec2::new(-14.0, 3.0),
        0.1,
        params,
    );
    push(
        &mut plates,
        map,
        2,
        DVec2::new(95.0, 82.0),
        DVec2::new(-6.0, -12.0),
        -0.1,
        params,
    );
    plates
}

fn problem(extent: Extent, plates: &PlateSet, params: &MountainParams) -> TransportProblem {
    TransportProblem {
        grid: Grid::over(extent, params.cells),
        bodies: plates
            .bodies(0.0)
            .iter()
            .map(|b| MovedBody {
                hull: b.support.moved(&b.motion),
                motion: b.motion,
            })
            .collect(),
        exponent: params.exponent,
        rest_weight: params.rest_weight(),
    }
}

fn stages(criterion: &mut Criterion) {
    let params = MountainParams::default();
    let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
    let extent = map.extent();
    let plates = three_plates(&map, &params);
    let problem = problem(extent, &plates, &params);
    let grid = problem.grid;
    let mut field = TransportField::new(grid);
    criterion.bench_function("transport/1024x1024/3-plates", |b| {
        b.iter(|| CpuTransport.run(&problem, &mut field));
    });
    let mut compression = CompressionField::none(grid);
    criterion.bench_function("compression/1024x1024", |b| b.iter(|| compression.fill(&field)));

    let mut tectonics = Tectonics::default();
    let mut out = TectonicField::still(extent, &params);
    criterion.bench_function("gesture-to-uplift/1024x1024/3-plates", |b| {
        b.iter(|| {
            let plates = three_plates(&map, &params);
            tectonics.compute_into(&plates, extent, 1.0, &params, &mut out);
        });
    });
}

/// Skeletons at the sizes of the literature, and heights on 1024² cells.
fn folds(criterion: &mut Criterion) {
    let square = Extent {
        width: 100.0 * KM,
        height: 100.0 * KM,
    };
    let grid = Grid::over(square, 1024 * 1024);
    let drive = FoldDrive::uniform(grid.blocks(), 3e-4, 0.4);
    for wavelength in [7.0, 3.0, 1.0] {
        let mesh = FoldMesh::new(square, wavelength * KM, 1).expect("a mesh");
        let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
        let lines = skeleton.top_len() + troughs(&mesh, &skeleton).len();
        criterion.bench_function(&format!("fold-skeletons/{lines}-lines"), |b| {
            b.iter(|| {
                let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
                (troughs(&mesh, &skeleton), skeleton)
            });
        });
        let shape = FoldShape::new(&mesh, &skeleton);
        criterion.bench_function(&format!("fold-index/{lines}-lines"), |b| {
            b.iter(|| FoldShape::new(&mesh, &skeleton));
        });
        let mut heights = Vec::new();
        criterion.bench_function(&format!("fold-heights/1024x1024/{wavelength}-km"), |b| {
            b.iter(|| shape.on_grid(grid, &mut heights));
        });
        let rates = FoldRates {
            drive: &drive,
            share: 0.5,
            edits: &[],
        };
        let blocks = grid.blocks();
        let centre = |at: usize| blocks.centre(at % blocks.cols, at / blocks.cols);
        let points: Vec<DVec2> = (0..blocks.len()).map(centre).collect();
        let mut at_points = PointRates::default();
        criterion.bench_function(&format!("fold-rates/65536-points/{wavelength}-km"), |b| {
            b.iter(|| at_points.fill(&mut CpuFolds, &shape, &rates, &points));
        });
    }
}

/// The same stages on the graphics card, where there is one that computes.
#[cfg(feature = "app")]
fn twins(criterion: &mut Criterion) {
    use std::sync::Arc;

    use orogen::gpu::{Gpu, GpuFolds, GpuTransport};
    use orogen::mountain::fold::FoldStage;

    let Ok(gpu) = Gpu::computing() else {
        return;
    };
    let name = gpu.info.name.clone();
    let gpu = Arc::new(gpu);
    let params = MountainParams::default();
    let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
    let problem = problem(map.extent(), &three_plates(&map, &params), &params);
    if let Ok(mut stage) = GpuTransport::new(&gpu) {
        let mut field = TransportField::new(problem.grid);
        criterion.bench_function(&format!("transport/1024x1024/3-plates/{name}"), |b| {
            b.iter(|| stage.run(&problem, &mut field));
        });
    }
    if let Ok(mut stage) = GpuFolds::new(&gpu) {
        let square = Extent {
            width: 100.0 * KM,
            height: 100.0 * KM,
        };
        let grid = Grid::over(square, 1024 * 1024);
        let drive = FoldDrive::uniform(grid.blocks(), 3e-4, 0.4);
        let mut heights = Vec::new();
        for wavelength in [7.0, 3.0, 1.0] {
            let mesh = FoldMesh::new(square, wavelength * KM, 1).expect("a mesh");
            let shape = FoldShape::new(&mesh, &Skeleton::select(&mesh, &drive, None, &[]));
            criterion.bench_function(&format!("fold-heights/1024x1024/{wavelength}-km/{name}"), |b| {
                b.iter(|| stage.on_grid(&shape, grid, &mut heights));
            });
        }
    }
}

/// Nothing without graphics.
#[cfg(not(feature = "app"))]
fn twins(_: &mut Criterion) {}

/// From a push that has grown to what the nodes of a live land feel of it, with one layer of folds.
fn live(criterion: &mut Criterion) {
    let params = MountainParams::default();
    let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
    let extent = map.extent();
    let plates = three_plates(&map, &params);
    let tin = Tin::poisson(extent, 60_000, 1).expect("a land");
    let mesh = FoldMesh::new(extent, 7.0 * KM, 1).expect("a mesh");
    let mut tectonics = Tectonics::default();
    let mut field = TectonicField::still(extent, &params);
    let (mut rates, mut folds) = (Vec::new(), PointRates::default());
    criterion.bench_function("gesture-to-nodes/1024x1024/60k-nodes/1-fold-layer", |b| {
        b.iter(|| {
            tectonics.compute_into(&plates, extent, 1.0, &params, &mut field);
            let positions = tin.positions().par_iter().with_min_len(4096);
            positions
                .map(|&p| field.uplift_at(p))
                .collect_into_vec(&mut rates);
            let skeleton = Skeleton::select(&mesh, &field.folding, None, &[]);
            let growth = FoldRates {
                drive: &field.folding,
                share: 0.5,
                edits: &[],
            };
            let shape = FoldShape::new(&mesh, &skeleton);
            folds.fill(&mut CpuFolds, &shape, &growth, tin.positions());
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = stages, folds, live, twins
}
criterion_main!(benches);
