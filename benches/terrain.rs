//! Times of the terrain stages. `OROGEN_BENCH_LARGE=1` adds a million nodes.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use orogen::terrain::{Erosion, ErosionParams, Forcing, StartLand, Tin, TinRaster};
use orogen::units::{Extent, KM};

const LAND: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};

/// The setting in which the figures of other engines were taken.
const UPLIFT: f64 = 5e-4;
const DT_YR: f64 = 1e5;
const STEPS_TO_DEVELOP: usize = 60;

fn params(landslides: bool) -> ErosionParams {
    ErosionParams {
        k: 5.5e-7,
        landslides,
        ..ErosionParams::default()
    }
}

fn sizes() -> Vec<usize> {
    let mut sizes = vec![10_000, 100_000];
    if std::env::var_os("OROGEN_BENCH_LARGE").is_some() {
        sizes.push(1_000_000);
    }
    sizes
}

fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tin");
    group.sample_size(10);
    for nodes in sizes() {
        group.bench_function(BenchmarkId::new("build", nodes), |bencher| {
            bencher.iter(|| Tin::poisson(LAND, nodes, 1));
        });
    }
    group.finish();
}

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("erosion");
    group.sample_size(20);
    for nodes in sizes() {
        let tin = Tin::poisson(LAND, nodes, 1).expect("a square");
        let uplift = vec![UPLIFT; nodes];
        let start = StartLand::new(1).heights(&tin);
        for landslides in [false, true] {
            let params = params(landslides);
            let forcing = Forcing::uplift(&uplift);
            let name = if landslides {
                "with landslides"
            } else {
                "rivers only"
            };
            let mut erosion = Erosion::new(&tin);
            group.bench_function(BenchmarkId::new(format!("cold, {name}"), nodes), |bencher| {
                bencher.iter_batched_ref(
                    || start.clone(),
                    |z| erosion.step(&tin, z, &forcing, &params, DT_YR),
                    BatchSize::LargeInput,
                );
            });
            let mut z = start.clone();
            for _ in 0..STEPS_TO_DEVELOP {
                erosion.step(&tin, &mut z, &forcing, &params, DT_YR);
            }
            group.bench_function(BenchmarkId::new(format!("developed, {name}"), nodes), |bencher| {
                bencher.iter(|| erosion.step(&tin, &mut z, &forcing, &params, DT_YR));
            });
        }
    }
    group.finish();
}

fn raster(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("raster 1920×1080");
    group.sample_size(10);
    let nodes = 60_000;
    let tin = Tin::poisson(LAND, nodes, 1).expect("a square");
    let z = StartLand::new(1).heights(&tin);
    group.bench_function("locate", |bencher| {
        bencher.iter(|| TinRaster::new(&tin, 1920, 1080));
    });
    let raster = TinRaster::new(&tin, 1920, 1080);
    group.bench_function("linear", |bencher| bencher.iter(|| raster.linear(&z)));
    group.bench_function("smooth", |bencher| bencher.iter(|| raster.smooth(&tin, &z)));
    group.finish();
}

criterion_group!(benches, build, step, raster);
criterion_main!(benches);
