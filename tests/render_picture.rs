//! Pictures of the table's renderer, drawn without a window: light, cover, water and places as a cartographer would
//! have them.
//!
//! Needs an adapter; software will do. Without one the tests say so and pass, unless `OROGEN_REQUIRE_GPU=1` is set.

#![cfg(feature = "app")]

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{DVec2, DVec3};
use image::RgbaImage;
use orogen::gpu::Gpu;
use orogen::picture::{MapStyle, relief_map};
use orogen::render::{Camera, LandStyle, Oblique, RenderQuality, picture};
use orogen::surface::{Raster, Surface};
use orogen::units::Extent;

const LAND: Extent = Extent {
    width: 64e3,
    height: 36e3,
};
/// Pixels of the pictures: no multiple of anything a card likes.
const SIZE: [u32; 2] = [322, 181];
/// Cells of the rasters.
const CELLS: [usize; 2] = [256, 144];

/// Steps of eight bits by which even ground may vary: the map gives plains soft fields of tone.
const EVEN: f64 = 9.0;
/// Steps by which the renderer and the printed map may differ in the mean colour of a picture: they share palette and
/// light, but not noise, sharpening and the sampling of the sky.
const SAME_MEAN: f64 = 8.0;
/// Steps by which the plan and a mesh seen from so far above that it is a plan may differ on average: outlines are
/// smoothed in one of them, and the light turns to evening as soon as the eye moves.
const SAME_PLAN: f64 = 6.0;
/// Pixels by which a place may miss its pixel: half of one, and the blur of its shore.
const PLACE: f64 = 1.5;

/// The card, for one test at a time: a software adapter uses all cores, and its device is not needed twice.
static CARD: Mutex<()> = Mutex::new(());

#[expect(clippy::print_stderr, reason = "a test that is skipped says so")]
fn card() -> Option<(Gpu, MutexGuard<'static, ()>)> {
    let turn = CARD.lock().unwrap_or_else(PoisonError::into_inner);
    match Gpu::offscreen() {
        Ok(gpu) => Some((gpu, turn)),
        Err(error) => {
            assert!(
                std::env::var_os("OROGEN_REQUIRE_GPU").is_none_or(|wanted| wanted != "1"),
                "{error}"
            );
            eprintln!("skipped: {error}");
            None
        }
    }
}

fn raster(value: impl Fn(DVec2) -> f64) -> Raster {
    Raster::from_fn(CELLS[0], CELLS[1], LAND, |p| value(p) as f32)
}

/// Dry land of some height.
fn land(height: impl Fn(DVec2) -> f64) -> Surface {
    Surface {
        height: raster(height),
        lake_depth: raster(|_| 0.0),
        drainage: raster(|_| 0.0),
        spacing: 500.0,
        rivers: Vec::new(),
        plates: Vec::new(),
        faults: Vec::new(),
        elapsed_yr: 0.0,
    }
}

fn middle() -> DVec2 {
    LAND.size() / 2.0
}

/// A cone on a plain of 20 m.
fn cone(summit: f64, radius: f64) -> Surface {
    land(move |p| 20.0 + summit * (1.0 - p.distance(middle()) / radius).max(0.0))
}

fn viewport() -> DVec2 {
    DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]))
}

fn seen(gpu: &Gpu, surface: &Surface, camera: &Camera) -> RgbaImage {
    let style = LandStyle {
        exaggeration: 1.0,
        ..LandStyle::default()
    };
    picture(gpu, surface, camera, &style, RenderQuality::SOFTWARE).expect("a picture")
}

fn plan(gpu: &Gpu, surface: &Surface) -> RgbaImage {
    seen(gpu, surface, &Camera::plan(LAND, viewport()))
}

/// Mean colour around a plan position on a plan, over a square of 5 pixels.
fn colour(image: &RgbaImage, at: DVec2) -> DVec3 {
    let px = Camera::plan(LAND, viewport())
        .project(at.extend(0.0))
        .expect("on the plan");
    let mut sum = DVec3::ZERO;
    for dy in -2..=2 {
        for dx in -2..=2 {
            let (x, y) = (px.x as i64 + dx, px.y as i64 + dy);
            sum += rgb(
                image,
                x.clamp(0, i64::from(SIZE[0]) - 1) as u32,
                y.clamp(0, i64::from(SIZE[1]) - 1) as u32,
            );
        }
    }
    sum / 25.0
}

fn rgb(image: &RgbaImage, x: u32, y: u32) -> DVec3 {
    let [r, g, b, _] = image.get_pixel(x, y).0.map(f64::from);
    DVec3::new(r, g, b)
}

fn brightness(colour: DVec3) -> f64 {
    colour.dot(DVec3::new(0.30, 0.59, 0.11))
}

fn mean(image: &RgbaImage) -> DVec3 {
    let pixels = image.pixels().map(|pixel| {
        let [r, g, b, _] = pixel.0.map(f64::from);
        DVec3::new(r, g, b)
    });
    pixels.sum::<DVec3>() / f64::from(image.width() * image.height())
}

fn mean_difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let differences = a.pixels().zip(b.pixels()).map(|(a, b)| {
        let steps: f64 = (0..3).map(|k| f64::from(a.0[k].abs_diff(b.0[k]))).sum();
        steps / 3.0
    });
    differences.sum::<f64>() / f64::from(a.width() * a.height())
}

fn deg(degrees: f64) -> f64 {
    degrees.to_radians()
}

/// A place at some distance from the middle, in a direction clockwise from north.
fn around(degrees: f64, metres: f64) -> DVec2 {
    let (east, north) = deg(degrees).sin_cos();
    middle() + DVec2::new(east, north) * metres
}

const NORTH_WEST: f64 = 315.0;
const SOUTH_EAST: f64 = 135.0;

#[test]
fn flat_land_is_an_even_meadow() {
    let Some((gpu, _turn)) = card() else { return };
    let image = plan(&gpu, &land(|_| 50.0));
    let mean = mean(&image);
    assert!(mean.y > mean.x && mean.x > mean.z, "a yellowish green: {mean}");
    assert!(brightness(mean) > 170.0, "quiet and light: {mean}");
    for x in (8..SIZE[0] - 8).step_by(7) {
        for y in (8..SIZE[1] - 8).step_by(7) {
            let off = (rgb(&image, x, y) - mean).abs().max_element();
            assert!(off < EVEN, "{off} at {x}, {y}");
        }
    }
}

#[test]
fn light_comes_from_the_north_west() {
    let Some((gpu, _turn)) = card() else { return };
    // Below the tree line all around, so that only light differs.
    let image = plan(&gpu, &cone(700.0, 6e3));
    let lit = brightness(colour(&image, around(NORTH_WEST, 3e3)));
    let dark = brightness(colour(&image, around(SOUTH_EAST, 3e3)));
    assert!(lit > dark + 15.0, "{lit} against {dark}");
}

#[test]
fn a_shadow_falls_to_the_south_east() {
    let Some((gpu, _turn)) = card() else { return };
    let cliff = land(|p| if p.distance(middle()) < 3e3 { 3000.0 } else { 20.0 });
    let image = plan(&gpu, &cliff);
    let shade = brightness(colour(&image, around(SOUTH_EAST, 5e3)));
    let open = brightness(colour(&image, around(SOUTH_EAST, 15e3)));
    let beside = brightness(colour(&image, around(NORTH_WEST, 5.5e3)));
    assert!(shade < open - 12.0, "{shade} against {open}");
    assert!(shade < beside - 6.0, "{shade} against {beside}");
}

#[test]
fn snow_lies_above_its_line() {
    let Some((gpu, _turn)) = card() else { return };
    // A high plateau beside a low one, with a slope between.
    let steps = land(|p| 200.0 + 3000.0 * ((p.x - 24e3) / 16e3).clamp(0.0, 1.0));
    let image = plan(&gpu, &steps);
    let high = colour(&image, DVec2::new(56e3, 18e3));
    let low = colour(&image, DVec2::new(8e3, 18e3));
    assert!(high.min_element() > 205.0, "white: {high}");
    assert!(
        high.max_element() - high.min_element() < 25.0,
        "without colour: {high}"
    );
    assert!(low.y - low.z > 15.0, "green: {low}");
}

#[test]
fn a_lake_is_blue_where_the_water_is_and_nowhere_else() {
    let Some((gpu, _turn)) = card() else { return };
    let radius = 5e3;
    let mut surface = land(|p| 30.0 - 40.0 * (1.0 - p.distance(middle()) / radius).max(0.0));
    surface.lake_depth = raster(|p| 40.0 * (1.0 - p.distance(middle()) / radius).max(0.0));
    let image = plan(&gpu, &surface);
    for degrees in (0..360).step_by(30).map(f64::from) {
        let inside = colour(&image, around(degrees, 0.7 * radius));
        let outside = colour(&image, around(degrees, 1.3 * radius));
        assert!(inside.z > inside.x + 15.0, "{degrees}: {inside}");
        assert!(outside.x > outside.z, "{degrees}: {outside}");
    }
}

#[test]
fn places_lie_on_the_pixels_the_camera_names() {
    let Some((gpu, _turn)) = card() else { return };
    // Square lakes with shores that can be found to the pixel.
    let (centre, half) = (DVec2::new(44e3, 12e3), 4e3);
    let inside = move |p: DVec2| (p - centre).abs().max_element() < half;
    let mut surface = land(|p| if inside(p) { -20.0 } else { 0.0 });
    surface.lake_depth = raster(|p| if inside(p) { 20.0 } else { 0.0 });
    surface.spacing = 250.0;
    let eye = Oblique {
        focus: middle(),
        focus_height: 0.0,
        azimuth: 0.3,
        depression: 1.1,
        distance: 90e3,
        field_of_view: 0.5,
    };
    let flat = Camera::plan(LAND, viewport());
    let aslant = Camera::between(LAND, viewport(), &eye, 1.0);
    for (name, camera) in [("plan", flat), ("aslant", aslant)] {
        let image = seen(&gpu, &surface, &camera);
        let blue = |px: DVec2| {
            let c = rgb(&image, px.x.round() as u32, px.y.round() as u32);
            c.z - c.x
        };
        for corner in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(DVec2::from) {
            // A little inside and outside the middle of each side and along its diagonal.
            let side = DVec2::new(corner.x, 0.0);
            let shore = camera.project((centre + side * half).extend(0.0)).expect("seen");
            let heart = camera.project(centre.extend(0.0)).expect("seen");
            let inwards = (heart - shore).normalize() * (PLACE + 1.0);
            assert!(
                blue(shore + inwards) > blue(shore - inwards) + 12.0,
                "{name} at {shore}: {} inside, {} outside",
                blue(shore + inwards),
                blue(shore - inwards)
            );
        }
    }
}

#[test]
fn the_mesh_from_above_is_the_plan() {
    let Some((gpu, _turn)) = card() else { return };
    let surface = cone(1500.0, 9e3);
    let eye = Oblique {
        focus: middle(),
        focus_height: 0.0,
        azimuth: 0.0,
        depression: deg(90.0),
        distance: 100e3,
        field_of_view: 0.3,
    };
    let begun = Camera::between(LAND, viewport(), &eye, 0.02);
    assert!(begun.tilt() > 0.0, "the mesh is drawn");
    let flat = plan(&gpu, &surface);
    let difference = mean_difference(&flat, &seen(&gpu, &surface, &begun));
    assert!(difference < SAME_PLAN, "{difference}");
    let other = plan(&gpu, &cone(1500.0, 4e3));
    let unlike = mean_difference(&flat, &other);
    assert!(unlike > difference, "another land differs more: {unlike}");
}

#[test]
fn the_plan_looks_like_the_printed_map() {
    let Some((gpu, _turn)) = card() else { return };
    let surface = cone(2600.0, 10e3);
    let style = MapStyle {
        marks: false,
        lettering: false,
        ..MapStyle::default()
    };
    let printed = mean(&relief_map(&surface, &style, SIZE[0], SIZE[1]));
    let drawn = mean(&plan(&gpu, &surface));
    let off = (printed - drawn).abs().max_element();
    assert!(off < SAME_MEAN, "{printed} printed, {drawn} drawn");
}

#[test]
fn numbers_that_are_none_leave_the_rest_of_the_land_alone() {
    let Some((gpu, _turn)) = card() else { return };
    let mut surface = land(|_| 50.0);
    let at = (CELLS[1] / 2) * CELLS[0] + 20;
    surface.height.data[at] = f32::NAN;
    surface.lake_depth.data[at + 40] = f32::INFINITY;
    let broken = plan(&gpu, &surface);
    let sound = plan(&gpu, &land(|_| 50.0));
    for at in [(40e3, 18e3), (60e3, 30e3), (50e3, 5e3)].map(|(x, y)| DVec2::new(x, y)) {
        let off = (colour(&broken, at) - colour(&sound, at)).abs().max_element();
        assert!(off < 2.0, "{off} at {at}");
    }
}

#[test]
fn what_a_card_cannot_draw_is_refused_in_words() {
    let Some((gpu, _turn)) = card() else { return };
    let camera = Camera::plan(LAND, DVec2::new(100_000.0, 10.0));
    let refused = picture(
        &gpu,
        &land(|_| 0.0),
        &camera,
        &LandStyle::default(),
        RenderQuality::SOFTWARE,
    );
    assert!(refused.is_err_and(|error| error.to_string().contains("100000")));
}
