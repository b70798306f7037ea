//! Times of what goes with the steps of the land: sediment, the crust below, the layers of rock, what is shown of it, and
//! what is written of it.

use std::io::{Cursor, sink};

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec2;
use orogen::export::height16::Height16;
use orogen::export::{Mesh, exr, glb, ply};
use orogen::isostasy::{Crust, Isostasy, IsostasyParams};
use orogen::sim::{Sim, SimParams, World};
use orogen::survey::Survey;
use orogen::terrain::{Deposition, Erosion, ErosionParams, Forcing, Sediment};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

const NODES: usize = 60_000;
const UPLIFT: f64 = 5e-4;
const DT_YR: f64 = 5e4;
/// Steps until rivers have found their ways and carry what they take.
const STEPS_TO_DEVELOP: usize = 40;
/// Columns of the rasters that a window shows.
const COLUMNS: usize = 1024;

fn world() -> World {
    let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
    World::new(map, NODES, 1).expect("a table")
}

/// A session that nobody touches, with rivers.
fn session() -> Sim {
    let params = SimParams {
        // It never comes to rest.
        run_on_yr: f64::INFINITY,
        ..SimParams::default()
    };
    let mut sim = Sim::new(world(), params);
    let mut steps = 0;
    sim.run_on(|_, _| {
        steps += 1;
        steps < STEPS_TO_DEVELOP
    });
    sim
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("land, 60k nodes");
    group.sample_size(20);
    let World { tin, mut z, .. } = world();
    let uplift = vec![UPLIFT; NODES];
    let params = ErosionParams {
        deposition: Some(Deposition::default()),
        ..ErosionParams::default()
    };
    let (mut erosion, mut sediment) = (Erosion::new(&tin), Sediment::new(NODES));
    let mut step = || {
        let forcing = Forcing::uplift(&uplift);
        erosion.step_with_sediment(&tin, &mut z, &mut sediment, &forcing, &params, DT_YR)
    };
    for _ in 0..STEPS_TO_DEVELOP {
        step();
    }
    group.bench_function("step with sediment", |bencher| bencher.iter(&mut step));

    let floats = IsostasyParams::default();
    let (mut isostasy, mut crust) = (Isostasy::new(&tin, &floats), Crust::new(NODES));
    let mut rise = vec![0.0; NODES];
    group.bench_function("flexure", |bencher| {
        bencher.iter(|| isostasy.uplift(&mut crust, &uplift, &floats, DT_YR, &mut rise));
    });

    let mut sim = session();
    group.bench_function("step of the session", |bencher| {
        bencher.iter(|| sim.run_on(|_, _| false));
    });
    group.finish();
}

fn shown(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("shown, 60k nodes on 1024 columns");
    group.sample_size(10);
    let sim = session();
    let world = sim.world();
    group.bench_function("survey", |bencher| {
        bencher.iter(|| Survey::new(&world.tin, COLUMNS));
    });
    let mut survey = Survey::new(&world.tin, COLUMNS);
    let (mut surface, mut flow) = (survey.blank(), sim.flow());
    group.bench_function("land and water", |bencher| {
        bencher.iter(|| {
            sim.route(&mut flow);
            survey.draw(&world.tin, &world.z, || &flow, &mut surface);
        });
    });
    group.bench_function("layers", |bencher| {
        bencher.iter(|| survey.draw_layers(&sim.underground(), &mut surface));
    });
    group.finish();
}

fn written(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("written, 60k nodes and 1920 columns");
    group.sample_size(10);
    let sim = session();
    let World { tin, z, .. } = sim.world();
    let mut survey = Survey::new(tin, 1920);
    let mut surface = survey.blank();
    let flow = sim.flow();
    survey.draw(tin, z, || &flow, &mut surface);
    let height = &surface.height;
    group.bench_function("height.exr", |bencher| {
        bencher.iter(|| {
            let out = Cursor::new(Vec::new());
            exr::write(out, height.width, height.height, &[("height_m", &height.data)])
        });
    });
    group.bench_function("height16.png", |bencher| {
        bencher.iter(|| Height16::new(height).and_then(|steps| steps.write_png(sink())));
    });
    let mesh = Mesh {
        positions: tin.positions(),
        heights: z,
        triangles: tin.triangles(),
    };
    group.bench_function("terrain.glb", |bencher| {
        bencher.iter(|| glb::write(sink(), mesh, tin.extent(), None));
    });
    let receivers: Vec<u32> = (0..NODES as u32).collect();
    let layers = vec![0; NODES];
    let values = ply::NodeValues {
        drainage: z,
        uplift: z,
        receivers: &receivers,
        layers: &layers,
        erodibility: z,
    };
    group.bench_function("terrain.ply", |bencher| {
        bencher.iter(|| ply::write(sink(), mesh, values));
    });
    group.finish();
}

criterion_group!(benches, steps, shown, written);
criterion_main!(benches);
