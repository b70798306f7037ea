//! The table's own renderer, drawn off screen: what a picture must show, whatever draws it. Tolerances are wide enough
//! for any card's rounding and filtering, and far below what a mistake would change.
//!
//! Where nothing can draw, the tests say so and pass; with `OROGEN_REQUIRE_GPU=1` they fail.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::card;
use glam::DVec2;
use image::RgbaImage;
use orogen::gpu::Gpu;
use orogen::picture::{MapStyle, relief_map};
use orogen::render::{Camera, Canvas, Focus, LandStyle, RenderQuality, flight, picture};
use orogen::surface::{Raster, Surface};
use orogen::units::{Extent, KM};

/// Small enough for a software adapter, large enough for mountains: 200 m a cell, 100 m a pixel.
const LAND: Extent = Extent {
    width: 64.0 * KM,
    height: 36.0 * KM,
};
const CELLS: (usize, usize) = (320, 180);
const SIZE: [u32; 2] = [640, 360];
/// Height of the plain, metres.
const PLAIN: f64 = 100.0;

/// Two pictures of the same land may differ by the last step of a byte.
const SAME: f64 = 1.0;
/// Meadows, as the palette has them below 60 m over the plain and through valley air; groves and water meadows may
/// move their mean by a few steps.
const MEADOW: [f64; 3] = [207.0, 212.0, 187.0];
const MEADOW_TOLERANCE: f64 = 9.0;
/// Steps by which the palette's fields and groves spread about their mean on flat land; form would add tens.
const EVEN: f64 = 5.0;
/// Steps between the sunlit and the shaded side of a cone, and between shaded and open ground: about half of what there
/// is.
const LIT: f64 = 12.0;
const SHADED: f64 = 8.0;
/// Mean colours of 80 pixels square by card and by processor: gullies, shores and light are computed on other grids.
const CARD_AND_MAP: f64 = 8.0;
/// A projected place and what is drawn there, pixels: half a cell of the mesh, seen from near by.
const PLACED: f64 = 4.0;

fn land(height: impl Fn(DVec2) -> f64, depth: impl Fn(DVec2) -> f64) -> Surface {
    let raster = |value: &dyn Fn(DVec2) -> f64| Raster::from_fn(CELLS.0, CELLS.1, LAND, |p| value(p) as f32);
    Surface {
        height: raster(&height),
        lake_depth: raster(&depth),
        drainage: raster(&|_| 0.0),
        spacing: 400.0,
        rivers: Vec::new(),
        plates: Vec::new(),
        faults: Vec::new(),
        folds: Vec::new(),
        strata: None,
        elapsed_yr: 1e6,
    }
}

fn flat() -> Surface {
    land(|_| PLAIN, |_| 0.0)
}

fn middle() -> DVec2 {
    LAND.size() / 2.0
}

/// A cone in the middle of the plain.
fn cone(height: f64, radius: f64) -> Surface {
    land(
        move |p| PLAIN + height * (1.0 - p.distance(middle()) / radius).max(0.0),
        |_| 0.0,
    )
}

fn plan() -> Camera {
    Camera::plan(LAND, DVec2::from(SIZE.map(f64::from)))
}

fn drawn(gpu: &Gpu, surface: &Surface, camera: &Camera, quality: RenderQuality) -> RgbaImage {
    picture(gpu, surface, camera, &LandStyle::default(), quality).expect("a picture")
}

fn mapped(gpu: &Gpu, surface: &Surface) -> RgbaImage {
    drawn(gpu, surface, &plan(), RenderQuality::SOFTWARE)
}

/// Mean colour of the pixels within `radius` pixels of a place in plan.
fn around(image: &RgbaImage, place: DVec2, radius: f64) -> [f64; 3] {
    let px = plan().project(place.extend(0.0)).expect("in the picture");
    mean(image, |x, y| DVec2::new(x, y).distance(px) <= radius)
}

/// Mean colour of the pixels whose centres are chosen.
fn mean(image: &RgbaImage, chosen: impl Fn(f64, f64) -> bool) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for (x, y, pixel) in image.enumerate_pixels() {
        if chosen(f64::from(x) + 0.5, f64::from(y) + 0.5) {
            count += 1.0;
            for (sum, &channel) in sum.iter_mut().zip(&pixel.0) {
                *sum += f64::from(channel);
            }
        }
    }
    assert!(count > 0.0, "no pixel is chosen");
    sum.map(|sum| sum / count)
}

fn brightness(colour: [f64; 3]) -> f64 {
    colour.iter().sum::<f64>() / 3.0
}

/// Mean and greatest difference of two pictures, steps of a byte.
fn difference(a: &RgbaImage, b: &RgbaImage) -> (f64, f64) {
    let steps = a.iter().zip(b.iter()).map(|(&a, &b)| f64::from(a.abs_diff(b)));
    let (sum, most) = steps.fold((0.0, 0.0), |(sum, most), step| (sum + step, f64::max(most, step)));
    (sum / a.len() as f64, most)
}

fn towards(east: f64, north: f64, distance: f64) -> DVec2 {
    middle() + DVec2::new(east, north).normalize() * distance
}

#[test]
fn flat_land_is_even_and_of_meadow_colour() {
    let Some(gpu) = card::drawing() else { return };
    let image = mapped(&gpu, &flat());
    let whole = mean(&image, |_, _| true);
    for (channel, expected) in whole.iter().zip(MEADOW) {
        assert!((channel - expected).abs() < MEADOW_TOLERANCE, "{whole:?}");
    }
    let spread = image
        .pixels()
        .map(|pixel| (f64::from(pixel.0[1]) - whole[1]).powi(2))
        .sum::<f64>();
    let spread = (spread / f64::from(SIZE[0] * SIZE[1])).sqrt();
    assert!(spread < EVEN, "{spread}");
}

#[test]
fn a_cone_is_bright_in_the_north_west_and_its_shadow_falls_south_east() {
    let Some(gpu) = card::drawing() else { return };
    let image = mapped(&gpu, &cone(1200.0, 8.0 * KM));
    let side = |east, north| brightness(around(&image, towards(east, north, 4.0 * KM), 8.0));
    let (lit, shaded) = (side(-1.0, 1.0), side(1.0, -1.0));
    assert!(lit > shaded + LIT, "{lit} against {shaded}");

    // A needle: from 5.4 km away its top stands higher than the sun.
    let image = mapped(&gpu, &cone(5000.0, 4.0 * KM));
    let ground = |east, north| brightness(around(&image, towards(east, north, 5.4 * KM), 5.0));
    let (open, shaded) = (ground(-1.0, 1.0), ground(1.0, -1.0));
    assert!(open > shaded + SHADED, "{open} against {shaded}");
}

#[test]
fn snow_lies_above_its_line_and_nowhere_below() {
    let Some(gpu) = card::drawing() else { return };
    let (height, radius) = (3600.0, 15.0 * KM);
    let image = mapped(&gpu, &cone(height, radius));
    let white = |pixel: &image::Rgba<u8>| pixel.0[..3].iter().all(|&channel| channel > 200);
    let (mut above, mut snow, mut low) = (0, 0, 0);
    for (x, y, pixel) in image.enumerate_pixels() {
        let place = plan()
            .unproject(DVec2::new(f64::from(x), f64::from(y)) + 0.5)
            .expect("ground");
        let here = PLAIN + height * (1.0 - place.distance(middle()) / radius).max(0.0);
        // Far enough from the line that neither aspect nor noise matters; on the lit side, where snow is white.
        let lit = (place - middle()).dot(DVec2::new(-FRAC_1_SQRT_2, FRAC_1_SQRT_2)) > 0.0;
        if here > 2900.0 && lit {
            above += 1;
            snow += u32::from(white(pixel));
        }
        low += u32::from(here < 1400.0 && white(pixel));
    }
    assert!(above > 50 && snow * 10 > above * 8, "{snow} of {above}");
    assert_eq!(low, 0);
}

#[test]
fn a_lake_is_blue_and_fills_its_mask() {
    let Some(gpu) = card::drawing() else { return };
    let (centre, radius) = (DVec2::new(20.0, 20.0) * KM, 6.0 * KM);
    let lake = land(
        |_| PLAIN,
        |p| if p.distance(centre) < radius { 40.0 } else { 0.0 },
    );
    let image = mapped(&gpu, &lake);
    for (x, y, pixel) in image.enumerate_pixels() {
        let place = plan()
            .unproject(DVec2::new(f64::from(x), f64::from(y)) + 0.5)
            .expect("ground");
        let blue = pixel.0[2] > pixel.0[0].saturating_add(10);
        // Shores are smoothed over a few hundred metres.
        let from_shore = radius - place.distance(centre);
        assert!(
            from_shore.abs() < 400.0 || blue == (from_shore > 0.0),
            "{place}: {pixel:?}"
        );
    }
}

#[test]
fn corners_of_the_plan_lie_on_the_pixels_of_the_camera() {
    let Some(gpu) = card::drawing() else { return };
    let camera = Camera::plan(LAND, DVec2::new(400.0, 400.0));
    let image = drawn(&gpu, &flat(), &camera, RenderQuality::SOFTWARE);
    for (corner, inward) in [
        (DVec2::new(0.0, LAND.height), DVec2::new(1.0, 1.0)),
        (DVec2::new(LAND.width, 0.0), DVec2::new(-1.0, -1.0)),
    ] {
        let px = camera.project(corner.extend(0.0)).expect("in the picture");
        let at = |p: DVec2| {
            image
                .get_pixel(p.x.clamp(0.0, 399.0) as u32, p.y.clamp(0.0, 399.0) as u32)
                .0
        };
        let (land, table) = (at(px + 2.0 * inward), at(px + DVec2::new(2.0, -2.0) * inward));
        assert!(land[1] > 150 && table[1] < 60, "{corner}: {land:?} {table:?}");
    }
}

#[test]
fn places_seen_aslant_lie_on_the_pixels_of_the_camera() {
    let Some(gpu) = card::drawing() else { return };
    let style = LandStyle::default();
    for (place, seconds) in [
        (DVec2::new(24.0, 14.0) * KM, 0.0),
        (DVec2::new(40.0, 22.0) * KM, 70.0),
    ] {
        let hill = cone(1500.0, 6.0 * KM);
        let mut pond = hill.clone();
        pond.lake_depth = Raster::from_fn(CELLS.0, CELLS.1, LAND, |p| {
            if p.distance(place) < 2.0 * KM { 30.0 } else { 0.0 }
        });
        let eye = flight(&Focus::of(&hill), &style, seconds);
        let camera = Camera::between(LAND, DVec2::from(SIZE.map(f64::from)), &eye, 1.0);
        let [dry, wet] = [&hill, &pond].map(|land| drawn(&gpu, land, &camera, RenderQuality::SOFTWARE));
        let height = PLAIN * f64::from(style.exaggeration);
        let px = camera.project(place.extend(height)).expect("in the picture");
        // Beyond the border the pond is there again, as in a mirror.
        let (mut sum, mut count) = (DVec2::ZERO, 0.0);
        for ((x, y, a), b) in dry.enumerate_pixels().zip(wet.pixels()) {
            let at = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            if at.distance(px) < 60.0 && a.0.iter().zip(&b.0).any(|(a, b)| a.abs_diff(*b) > 12) {
                sum += at;
                count += 1.0;
            }
        }
        assert!(count > 20.0, "the pond is seen");
        assert!((sum / count).distance(px) < PLACED, "{} for {px}", sum / count);
    }
}

#[test]
fn a_new_land_grows_steadily_and_is_there_when_it_is_settled() {
    let Some(gpu) = card::drawing() else { return };
    // Low enough that colours change in one sense only: woods and snow would come and go on the way.
    let (before, after) = (flat(), cone(70.0, 12.0 * KM));
    let style = LandStyle::default();
    let last = mapped(&gpu, &after);
    let whole = RenderQuality {
        strips: 1,
        ..RenderQuality::SOFTWARE
    };
    for quality in [whole, RenderQuality::SOFTWARE] {
        let mut canvas = Canvas::new(&gpu, SIZE, quality).expect("a canvas");
        canvas.land.show(&gpu, &before);
        canvas.draw(&gpu, &plan(), &style, 1.0).expect("a frame");
        assert!(canvas.land.settled());
        canvas.land.show(&gpu, &after);
        assert!(!canvas.land.settled());
        let mut left = difference(&canvas.image(&gpu).expect("an image"), &last).0;
        let (first, mut frames) = (left, 0);
        while !canvas.land.settled() {
            canvas.draw(&gpu, &plan(), &style, 0.05).expect("a frame");
            let now = difference(&canvas.image(&gpu).expect("an image"), &last).0;
            // Bytes are rounded.
            assert!(now <= left + 0.02 * first, "frame {frames}: {now} after {left}");
            left = now;
            frames += 1;
            assert!(frames < 60, "it never settles");
        }
        assert!(frames > 5, "it grew in {frames} frames");
        let (_, most) = difference(&canvas.image(&gpu).expect("an image"), &last);
        assert!(most <= SAME, "{most} steps from the land drawn at once");
        // A settled land stands still.
        let still = canvas.image(&gpu).expect("an image");
        canvas.draw(&gpu, &plan(), &style, 0.05).expect("a frame");
        assert_eq!(still, canvas.image(&gpu).expect("an image"));
    }
}

#[test]
fn the_card_and_the_printed_map_agree_over_broad_areas() {
    let Some(gpu) = card::drawing() else { return };
    let ridge = land(
        |p| {
            let across = ((p.x - middle().x) / (9.0 * KM)).powi(2);
            let along = ((p.y - middle().y) / (14.0 * KM)).powi(2);
            PLAIN + 2800.0 * (-across - along).exp() * (1.0 + 0.2 * (p.y / (1.3 * KM)).sin())
        },
        |p| {
            if p.distance(DVec2::new(9.0, 9.0) * KM) < 5.0 * KM {
                60.0
            } else {
                0.0
            }
        },
    );
    let style = MapStyle {
        marks: false,
        lettering: false,
        ..MapStyle::default()
    };
    let card = drawn(&gpu, &ridge, &plan(), RenderQuality::HIGH);
    let map = relief_map(&ridge, &style, SIZE[0], SIZE[1]);
    let square = 80.0;
    for row in 0..4 {
        for column in 0..8 {
            let corner = DVec2::new(f64::from(column), f64::from(row)) * square;
            let inside = |x: f64, y: f64| {
                (corner.x..corner.x + square).contains(&x) && (corner.y..corner.y + square).contains(&y)
            };
            let [a, b] = [&card, &map].map(|image| mean(image, inside));
            for (a, b) in a.iter().zip(b) {
                assert!(
                    (a - b).abs() < CARD_AND_MAP,
                    "square {column}, {row}: {a} against {b}"
                );
            }
        }
    }
}

#[test]
fn heights_that_are_no_numbers_spoil_nothing() {
    let Some(gpu) = card::drawing() else { return };
    let good = cone(2000.0, 8.0 * KM);
    let mut bad = good.clone();
    for (cell, height) in bad.height.data.iter_mut().enumerate().take(4000) {
        match cell % 3 {
            0 => *height = f32::NAN,
            1 => *height = f32::INFINITY,
            _ => {}
        }
    }
    bad.lake_depth.data[9000] = f32::NAN;
    bad.drainage.data[9001] = f32::NAN;
    let style = LandStyle::default();
    let mut canvas = Canvas::new(&gpu, SIZE, RenderQuality::SOFTWARE).expect("a canvas");
    canvas.land.show(&gpu, &bad);
    canvas.draw(&gpu, &plan(), &style, 1.0).expect("a frame");
    let spoilt = canvas.image(&gpu).expect("an image");
    // Rows well below those without heights.
    let low = |x: f64, y: f64| x > 0.0 && y > 120.0;
    let clean = mapped(&gpu, &good);
    for (a, b) in mean(&spoilt, low).iter().zip(mean(&clean, low)) {
        assert!((a - b).abs() < 2.0 * SAME, "{a} against {b}");
    }
    canvas.land.show(&gpu, &good);
    for _ in 0..60 {
        canvas.draw(&gpu, &plan(), &style, 0.05).expect("a frame");
    }
    let healed = canvas.image(&gpu).expect("an image");
    assert!(difference(&healed, &clean).1 <= SAME);
}

#[test]
fn the_evening_has_a_bright_and_a_blue_side() {
    let Some(gpu) = card::drawing() else { return };
    let hill = cone(2600.0, 10.0 * KM);
    let style = LandStyle::default();
    let focus = Focus::of(&hill);
    let eye = flight(&focus, &style, 0.0);
    let camera = Camera::between(LAND, DVec2::from(SIZE.map(f64::from)), &eye, 1.0);
    let image = drawn(&gpu, &hill, &camera, RenderQuality::SOFTWARE);
    let at = |east: f64, north: f64| {
        let place = towards(east, north, 4.0 * KM);
        let height = (PLAIN + 2600.0 * 0.6) * f64::from(style.exaggeration);
        let px = camera.project(place.extend(height)).expect("in the picture");
        mean(&image, |x, y| DVec2::new(x, y).distance(px) < 5.0)
    };
    // The sun is in the west, and a little to the north.
    let (lit, shaded) = (at(-1.0, 0.36), at(1.0, -0.36));
    assert!(brightness(lit) > brightness(shaded) + LIT, "{lit:?} {shaded:?}");
    assert!(
        lit[0] / lit[2] > 1.15 * shaded[0] / shaded[2],
        "{lit:?} {shaded:?}"
    );
}

#[test]
fn a_lost_device_is_told_and_draws_no_more() {
    let Some(gpu) = card::drawing() else { return };
    assert!(!gpu.lost());
    let mut canvas = Canvas::new(&gpu, [64, 36], RenderQuality::SOFTWARE).expect("a canvas");
    canvas.land.show(&gpu, &flat());
    gpu.device.destroy();
    let drawn = canvas.draw(&gpu, &plan(), &LandStyle::default(), 0.1);
    assert!(gpu.lost());
    assert!(drawn.is_err());
}
