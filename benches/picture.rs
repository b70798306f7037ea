//! Cost of a relief map from a surface to pixels, and of the table's frames.

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
        folds: Vec::new(),
        strata: None,
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

/// Frames and uploads of the table's renderer at the quality of software adapters. Surfaces are of a third of the
/// window's size and more, as the session makes them there.
#[cfg(feature = "app")]
fn frames(criterion: &mut Criterion) {
    use std::time::Instant;

    use orogen::gpu::Gpu;
    use orogen::render::{Camera, Canvas, Focus, LandStyle, RenderQuality, flight};

    /// Time between two frames, s.
    const FRAME_S: f32 = 0.033;
    // Nothing to draw with: nothing to measure.
    let Ok(gpu) = Gpu::offscreen() else { return };
    let mut group = criterion.benchmark_group(format!("frames on {}", gpu.info.name));
    group.sample_size(10);
    for (name, [width, height]) in [
        ("1280x720", [1280, 720]),
        ("1920x1080", [1920, 1080]),
        ("3840x2160", [3840, 2160]),
    ] {
        let surface = surface(640, 360);
        let style = LandStyle::default();
        let viewport = DVec2::new(f64::from(width), f64::from(height));
        let eye = flight(&Focus::of(&surface), &style, 0.0);
        for (view, t) in [("plan", 0.0), ("oblique", 1.0)] {
            let camera = Camera::between(LAND, viewport, &eye, t);
            for state in ["settled", "growing"] {
                let Ok(mut canvas) = Canvas::new(&gpu, [width, height], RenderQuality::SOFTWARE) else {
                    continue;
                };
                canvas.land.show(&gpu, &surface);
                let _ = canvas.draw(&gpu, &camera, &style, 1.0);
                let growing = state == "growing";
                group.bench_function(format!("{view} {name} {state}"), |bencher| {
                    bencher.iter_custom(|frames| {
                        (0..frames)
                            .map(|_| {
                                if growing {
                                    canvas.land.show(&gpu, &surface);
                                }
                                let began = Instant::now();
                                let _ = std::hint::black_box(canvas.draw(&gpu, &camera, &style, FRAME_S));
                                began.elapsed()
                            })
                            .sum()
                    });
                });
            }
        }
    }
    for (width, height) in [(640, 360), (1024, 576)] {
        let surface = surface(width, height);
        let mut land = Canvas::new(&gpu, [64, 36], RenderQuality::SOFTWARE).map(|canvas| canvas.land);
        group.bench_function(format!("upload {width}x{height}"), |bencher| {
            bencher.iter(|| {
                if let Ok(land) = &mut land {
                    land.show(&gpu, &surface);
                }
                gpu.queue.submit([]);
            });
        });
    }
    group.finish();
}

#[cfg(not(feature = "app"))]
fn frames(_: &mut Criterion) {}

criterion_group!(benches, relief, frames);
criterion_main!(benches);
