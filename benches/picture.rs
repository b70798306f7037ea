//! Cost of a relief map, from a surface to pixels.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec2;
use orogen::picture::{MapStyle, relief_map};
use orogen::surface::{Raster, River, RiverPoint, Surface};
use orogen::units::{Extent, KM};

const LAND: Extent = Extent {
    width: 178.0 * KM,
    height: 100.0 * KM,
};

/// Ridges and valleys on two fifths of the land, plains around, as many rivers as a real surface has.
fn surface(width: usize, height: usize) -> Surface {
    let ridges = |p: DVec2| {
        let belt = (1.0 - ((p.x - LAND.width / 2.0) / (36.0 * KM)).powi(2)).max(0.0);
        let waves = (p.y / 900.0 + (p.x / 1700.0).sin()).sin() * (p.x / 2300.0).cos();
        (belt * (2200.0 + 900.0 * waves)) as f32
    };
    let river = |i: usize| River {
        points: (0..200)
            .map(|k| RiverPoint {
                at: DVec2::new(
                    k as f64 * 0.4 * KM,
                    (i as f64 + 0.5 + 0.3 * (k as f64 / 9.0).sin()) * 0.4 * KM,
                ),
                drainage: (20.0 + 10.0 * k as f64) * KM * KM,
            })
            .collect(),
        order: 3,
    };
    Surface {
        height: Raster::from_fn(width, height, LAND, ridges),
        lake_depth: Raster::from_fn(width, height, LAND, |_| 0.0),
        drainage: Raster::from_fn(width, height, LAND, |_| 0.0),
        spacing: 545.0,
        rivers: (0..250).map(river).collect(),
        plates: Vec::new(),
        faults: Vec::new(),
        elapsed_yr: 5e6,
    }
}

fn relief(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("relief_map");
    group.sample_size(10);
    for (name, width, height) in [("1920x1080", 1920, 1080), ("3840x2160", 3840, 2160)] {
        let surface = surface(width, height);
        let style = MapStyle::default();
        group.bench_function(name, |bencher| {
            bencher.iter(|| relief_map(&surface, &style, width as u32, height as u32));
        });
    }
    group.finish();
}

criterion_group!(benches, relief);
criterion_main!(benches);
