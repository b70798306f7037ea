//! From nodes to pixels: exactness, continuity, bounds, determinism.

use glam::DVec2;
use orogen::terrain::{Border, Tin, TinRaster};
use orogen::units::Extent;

const LAND: Extent = Extent {
    width: 1600.0,
    height: 1000.0,
};

fn plane(p: DVec2) -> f64 {
    3.0 + 0.5 * p.x - 0.25 * p.y
}

fn check_plane(raster: &TinRaster, pixels: &[f32], tolerance: f64) {
    for row in 0..raster.height() {
        for column in 0..raster.width() {
            let exact = plane(raster.pixel_centre(column, row));
            let found = f64::from(pixels[row * raster.width() + column]);
            assert!(
                (found - exact).abs() < tolerance,
                "({column}, {row}): {found} for {exact}"
            );
        }
    }
}

#[test]
fn both_interpolations_are_exact_for_a_plane() {
    let tin = Tin::poisson(LAND, 500, 4).unwrap();
    let values: Vec<f64> = tin.positions().iter().map(|&p| plane(p)).collect();
    for (width, height) in [(1, 1), (16, 10), (333, 207)] {
        let raster = TinRaster::new(&tin, width, height);
        // Single precision of values below 1000.
        check_plane(&raster, &raster.linear(&values), 1e-3);
        check_plane(&raster, &raster.smooth(&tin, &values), 1e-3);
    }
}

#[test]
fn row_zero_is_the_northern_one() {
    let tin = Tin::poisson(LAND, 200, 4).unwrap();
    let north: Vec<f64> = tin.positions().iter().map(|p| p.y).collect();
    let raster = TinRaster::new(&tin, 10, 10);
    assert!((raster.linear(&north)[0] - 950.0).abs() < 1e-3);
    assert_eq!(raster.pixel_centre(0, 0), DVec2::new(80.0, 950.0));
}

#[test]
fn smooth_meets_the_nodes_and_linear_fields_stay_between_their_corners() {
    let nodes = [
        DVec2::ZERO,
        DVec2::new(1600.0, 0.0),
        DVec2::new(1600.0, 1000.0),
        DVec2::new(0.0, 1000.0),
        DVec2::new(800.0, 500.0),
    ];
    let tin = Tin::from_nodes(LAND, &nodes, Border::Hull).unwrap();
    // The middle of an odd raster is the node.
    let raster = TinRaster::new(&tin, 17, 9);
    let peak = [0.0, 0.0, 0.0, 0.0, 10.0];
    for pixels in [raster.linear(&peak), raster.smooth(&tin, &peak)] {
        assert_eq!(pixels[4 * 17 + 8], 10.0);
        assert!(pixels.iter().all(|&z| (0.0..=10.0).contains(&z)), "{pixels:?}");
    }
}

/// The largest jump of the slope from pixel to pixel, along rows, for a smooth hill.
fn slope_jump(pixels: &[f32], width: usize) -> f32 {
    pixels
        .chunks(width)
        .flat_map(|row| row.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()))
        .fold(0.0, f32::max)
}

#[test]
fn smooth_slopes_are_continuous_where_linear_ones_break() {
    let tin = Tin::poisson(LAND, 400, 8).unwrap();
    let hill = |p: DVec2| 100.0 * (p.x / 150.0).sin() * (p.y / 130.0).cos();
    let values: Vec<f64> = tin.positions().iter().map(|&p| hill(p)).collect();
    // Twice the pixels halve the second difference of a broken slope, and quarter that of a continuous one.
    let jumps = |smooth: bool| {
        [800, 1600, 3200].map(|width| {
            let raster = TinRaster::new(&tin, width, 40);
            let pixels = if smooth {
                raster.smooth(&tin, &values)
            } else {
                raster.linear(&values)
            };
            slope_jump(&pixels, width)
        })
    };
    let (linear, smooth) = (jumps(false), jumps(true));
    assert!(linear[2] / linear[0] > 0.2, "{linear:?}");
    assert!(smooth[2] / smooth[0] < 0.1, "{smooth:?}");
}

#[test]
fn smooth_does_not_leave_the_range_of_the_nodes_much() {
    let tin = Tin::poisson(LAND, 400, 8).unwrap();
    // A cliff: the worst case for a cubic.
    let values: Vec<f64> = tin
        .positions()
        .iter()
        .map(|p| if p.x < 800.0 { 0.0 } else { 100.0 })
        .collect();
    let raster = TinRaster::new(&tin, 640, 400);
    let pixels = raster.smooth(&tin, &values);
    let (low, high) = pixels
        .iter()
        .fold((f32::MAX, f32::MIN), |(l, h), &z| (l.min(z), h.max(z)));
    assert!(low > -5.0 && high < 105.0, "{low} … {high}");
}

#[test]
fn pixels_beyond_the_hull_take_the_nearest_values() {
    let nodes = [
        DVec2::new(400.0, 300.0),
        DVec2::new(1200.0, 300.0),
        DVec2::new(1200.0, 700.0),
        DVec2::new(400.0, 700.0),
    ];
    let tin = Tin::from_nodes(LAND, &nodes, Border::Hull).unwrap();
    let raster = TinRaster::new(&tin, 32, 20);
    let pixels = raster.linear(&[0.0, 1.0, 1.0, 0.0]);
    assert!(pixels.iter().all(|z| (0.0..=1.0).contains(z)));
    assert_eq!((pixels[0], pixels[31]), (0.0, 1.0));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let tin = Tin::poisson(LAND, 3000, 6).unwrap();
    let values: Vec<f64> = tin.positions().iter().map(|p| (0.01 * p.x).sin() * p.y).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let raster = TinRaster::new(&tin, 301, 203);
            (raster.linear(&values), raster.smooth(&tin, &values))
        })
    };
    let alone = run(1);
    assert!(alone == run(2) && alone == run(7));
}
