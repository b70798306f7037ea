//! Times of the planet at the sizes of Cortial et al. 2019, Table 2: forty plates, a third of it land.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DQuat;
use orogen::globe::{Cut, GlobeParams, Planet, Start};
use orogen::sphere::Lattice;

const SIZES: [usize; 4] = [60_000, 100_000, 250_000, 500_000];

/// Steps until fronts and ridges have formed.
const DEVELOPED_STEPS: usize = 10;

/// Steps for which gaps are left open before new sea floor fills them all.
const GAP_STEPS: u32 = 10;

fn lattice(samples: usize) -> Arc<Lattice> {
    Arc::new(Lattice::new(samples).expect("a size within range"))
}

fn planet(lattice: &Arc<Lattice>, spread_steps: u32) -> Planet {
    let start = Start::Random {
        plates: 40,
        continental: 0.3,
        seed: 1,
    };
    let params = GlobeParams {
        spread_steps,
        ..GlobeParams::planet()
    };
    Planet::new(Arc::clone(lattice), &start, params).expect("a whole start")
}

/// The lattice, and look-ups of as many places as it has samples.
fn sphere(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sphere");
    group.sample_size(10);
    let turn = DQuat::from_rotation_y(0.7);
    for samples in SIZES {
        group.bench_function(BenchmarkId::new("lattice", samples), |bencher| {
            bencher.iter(|| Lattice::new(samples));
        });
        let lattice = lattice(samples);
        let queries: Vec<_> = lattice.points().iter().map(|&p| turn * p).collect();
        group.throughput(Throughput::Elements(samples as u64));
        group.bench_function(BenchmarkId::new("nearest", samples), |bencher| {
            bencher.iter(|| {
                queries
                    .iter()
                    .map(|&p| u64::from(lattice.nearest(p)))
                    .sum::<u64>()
            });
        });
        group.bench_function(BenchmarkId::new("locate", samples), |bencher| {
            bencher.iter(|| {
                for &p in &queries {
                    black_box(lattice.locate(p));
                }
            });
        });
    }
    group.finish();
}

fn globe(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("globe, 40 plates");
    group.sample_size(10);
    for samples in SIZES {
        let lattice = lattice(samples);
        group.bench_function(BenchmarkId::new("start", samples), |bencher| {
            bencher.iter(|| planet(&lattice, 1));
        });
        let mut developed = planet(&lattice, 1);
        for _ in 0..DEVELOPED_STEPS {
            developed.step();
        }
        group.bench_function(BenchmarkId::new("step", samples), |bencher| {
            bencher.iter_batched_ref(|| developed.clone(), Planet::step, BatchSize::LargeInput);
        });
        group.bench_function(BenchmarkId::new("surface", samples), |bencher| {
            bencher.iter(|| developed.surface(0.0));
        });
        let shown = developed.surface(0.0);
        let greatest = shown.plates.iter().max_by(|a, b| a.area_sr.total_cmp(&b.area_sr));
        let greatest = greatest.expect("a planet has plates").id;
        group.bench_function(BenchmarkId::new("rift", samples), |bencher| {
            bencher.iter_batched_ref(
                || developed.clone(),
                |planet| planet.rift(greatest, &Cut::Parts(3)),
                BatchSize::LargeInput,
            );
        });
        let mut open = planet(&lattice, GAP_STEPS);
        for _ in 1..GAP_STEPS {
            open.step();
        }
        group.bench_function(BenchmarkId::new("step that fills ten", samples), |bencher| {
            bencher.iter_batched_ref(|| open.clone(), Planet::step, BatchSize::LargeInput);
        });
    }
    group.finish();
}

criterion_group!(benches, sphere, globe);
criterion_main!(benches);
