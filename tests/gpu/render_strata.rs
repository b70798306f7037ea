//! Beds on the table's own picture: on cliffs at the heights where they crop out, never on gentle land, and as fine as
//! the pixels can show.
//!
//! Where nothing can draw, the tests say so and pass; with `OROGEN_REQUIRE_GPU=1` they fail.

use std::sync::Arc;

use crate::card;
use glam::{DVec2, DVec3};
use image::RgbaImage;
use orogen::gpu::Gpu;
use orogen::render::{Camera, Canvas, LandStyle, Oblique, RenderQuality, picture};
use orogen::rock::{Basement, Layer, Rock, Stratigraphy};
use orogen::surface::{Raster, StrataMap, Surface};
use orogen::units::{Extent, KM};

/// 50 m a cell, 25 m a pixel.
const LAND: Extent = Extent {
    width: 16.0 * KM,
    height: 9.0 * KM,
};
const CELLS: (usize, usize) = (320, 180);
const SIZE: [u32; 2] = [640, 360];
const PIXEL: f64 = 25.0;
/// Height of the plain, and northing of the foot of the cliff, metres.
const PLAIN: f64 = 100.0;
const FOOT: f64 = 3.5 * KM;
/// Height of the first surface, metres, and thickness of each of the ten beds.
const TOP: f64 = 2100.0;
const BED: f64 = 200.0;
const BEDS: usize = 10;

/// Two pictures of the same land may differ by the last step of a byte.
const SAME: u8 = 1;

/// One layer whose beds differ so much.
fn pile(contrast: f64) -> Arc<Stratigraphy> {
    let rock = |colour| Rock {
        erodibility: 1.0,
        talus_deg: 40.0,
        colour,
        stone: [176, 170, 158],
    };
    let layer = Layer {
        name: "Limestone".to_owned(),
        thickness_m: BED * BEDS as f64,
        viscosity_pa_s: 1e21,
        rock: rock([40, 80, 220]),
        beds: BEDS as u8,
        contrast,
        fold: 0.0,
        wavelength_m: None,
    };
    let basement = Basement {
        uplift: 1.0,
        name: "Gneiss".to_owned(),
        viscosity_pa_s: 1e22,
        rock: rock([240, 120, 160]),
    };
    Arc::new(Stratigraphy::new("test", "Test", vec![layer], basement).expect("a pile"))
}

/// Land that rises so steeply to the north over 2 km, over flat layers of a pile.
fn slope(rise: f64, pile: Option<&Arc<Stratigraphy>>) -> Surface {
    let raster = |value: &dyn Fn(DVec2) -> f64| Raster::from_fn(CELLS.0, CELLS.1, LAND, |p| value(p) as f32);
    let height = |p: DVec2| PLAIN + rise * (p.y - FOOT).clamp(0.0, 2.0 * KM);
    let flat = raster(&|_| 0.0);
    Surface {
        height: raster(&height),
        lake_depth: flat.clone(),
        drainage: flat.clone(),
        spacing: 100.0,
        rivers: Vec::new(),
        plates: Vec::new(),
        faults: Vec::new(),
        folds: Vec::new(),
        strata: pile.map(|pile| {
            Arc::new(StrataMap {
                stratigraphy: Arc::clone(pile),
                base: raster(&|_| TOP),
                folds: Vec::new(),
                sediment: flat.clone(),
                root: flat.clone(),
                depth: raster(&|p| TOP - height(p)),
            })
        }),
        elapsed_yr: 1e6,
    }
}

fn plan() -> Camera {
    Camera::plan(LAND, DVec2::from(SIZE.map(f64::from)))
}

fn drawn(gpu: &Gpu, surface: &Surface, camera: &Camera, style: &LandStyle) -> RgbaImage {
    picture(gpu, surface, camera, style, RenderQuality::SOFTWARE).expect("a picture")
}

/// Mean brightness of each row away from the sides.
fn rows(image: &RgbaImage) -> Vec<f64> {
    let row = |y: u32| {
        let columns = 100..SIZE[0] - 100;
        let count = f64::from(3 * columns.len() as u32);
        let sum: u32 = columns
            .flat_map(|x| image.get_pixel(x, y).0.into_iter().take(3))
            .map(u32::from)
            .sum();
        f64::from(sum) / count
    };
    (0..SIZE[1]).map(row).collect()
}

/// Greatest difference of two pictures, steps of a byte.
fn most(a: &RgbaImage, b: &RgbaImage) -> u8 {
    a.iter()
        .zip(b.iter())
        .map(|(&a, &b)| a.abs_diff(b))
        .max()
        .unwrap_or(0)
}

#[test]
fn hard_and_weak_beds_alternate_on_a_cliff_at_their_heights() {
    let Some(gpu) = card::drawing() else { return };
    let style = LandStyle::default();
    let [bedded, even] =
        [1.0, 0.0].map(|contrast| rows(&drawn(&gpu, &slope(1.0, Some(&pile(contrast))), &plan(), &style)));
    // What the beds alone do.
    let light: Vec<f64> = bedded.iter().zip(&even).map(|(a, b)| a - b).collect();
    // Row of the top of a bed, counted from the topmost: at 45° heights are northings.
    let top_of = |bed: f64| (LAND.height - FOOT - (TOP - PLAIN - bed * BED)) / PIXEL;
    let mean = |from: f64, to: f64| {
        let rows = &light[from as usize..to as usize];
        rows.iter().sum::<f64>() / rows.len() as f64
    };
    // The topmost and the lowest border on gentle ground.
    let middles: Vec<f64> = (1..BEDS - 1)
        .map(|bed| mean(top_of(bed as f64 + 0.25), top_of(bed as f64 + 0.75)))
        .collect();
    let alternations = middles
        .windows(2)
        .enumerate()
        .filter(|(i, pair)| {
            let (hard, weak) = if i % 2 == 0 {
                (pair[1], pair[0])
            } else {
                (pair[0], pair[1])
            };
            hard > weak + 2.0
        })
        .count();
    assert_eq!(alternations, BEDS - 3, "{middles:?}");
    // Moved by two rows either way the bands fit less well.
    let fit = |shift: i32| -> f64 {
        (top_of(1.0) as i32..top_of(9.0) as i32)
            .map(|row| {
                let bed = (f64::from(row) + 0.5 - top_of(0.0)) / (BED / PIXEL);
                let sign = if (bed as i32) % 2 == 0 { 1.0 } else { -1.0 };
                sign * light[(row + shift) as usize]
            })
            .sum()
    };
    assert!(
        fit(0) > fit(2) && fit(0) > fit(-2),
        "{:?}",
        [-2, -1, 0, 1, 2].map(fit)
    );
}

#[test]
fn a_gentle_slope_shows_no_beds() {
    let Some(gpu) = card::drawing() else { return };
    let style = LandStyle::default();
    let rise = 10_f64.to_radians().tan();
    let [bedded, unknown] =
        [Some(pile(1.0)), None].map(|pile| drawn(&gpu, &slope(rise, pile.as_ref()), &plan(), &style));
    assert!(most(&bedded, &unknown) <= SAME);
}

#[test]
fn beds_finer_than_pixels_merge_and_come_out_on_coming_closer() {
    let Some(gpu) = card::drawing() else { return };
    let style = LandStyle {
        haze: 0.0,
        ..LandStyle::default()
    };
    let [bedded, even] = [1.0, 0.0].map(|contrast| slope(1.0, Some(&pile(contrast))));
    // How much the beds change the middle of the picture, seen from the south.
    let beds = |distance: f64| {
        let eye = Oblique {
            focus: DVec2::new(LAND.width / 2.0, FOOT + KM),
            focus_height: (PLAIN + KM) * f64::from(style.exaggeration),
            azimuth: 0.0,
            depression: 0.2,
            distance,
            field_of_view: 0.6,
        };
        let camera = Camera::between(LAND, DVec2::from(SIZE.map(f64::from)), &eye, 1.0);
        let [a, b] = [&bedded, &even].map(|surface| drawn(&gpu, surface, &camera, &style));
        let at = |east: f64, northing: f64| {
            let height = (PLAIN + northing) * f64::from(style.exaggeration);
            let place = DVec3::new(LAND.width / 2.0 + east, FOOT + northing, height);
            let px = camera.project(place).expect("in the picture");
            let [a, b] = [&a, &b].map(|image| f64::from(image.get_pixel(px.x as u32, px.y as u32).0[1]));
            a - b
        };
        let places: Vec<f64> = (0..60)
            .flat_map(|i| (0..20).map(move |j| (f64::from(j) * 60.0, 500.0 + f64::from(i) * 20.0)))
            .map(|(east, northing)| at(east, northing).abs())
            .collect();
        places.iter().sum::<f64>() / places.len() as f64
    };
    let (near, far) = (beds(7.0 * KM), beds(160.0 * KM));
    assert!(near > 2.0, "{near}");
    assert!(far < 0.3 * near, "{far} from afar, {near} from near by");
}

#[test]
fn layers_under_land_in_strips_are_those_of_the_whole() {
    let Some(gpu) = card::drawing() else { return };
    let style = LandStyle::default();
    let pile = pile(1.0);
    let last = drawn(&gpu, &slope(1.0, Some(&pile)), &plan(), &style);
    let mut canvas = Canvas::new(&gpu, SIZE, RenderQuality::SOFTWARE).expect("a canvas");
    canvas.land.show(&gpu, &slope(0.9, Some(&pile)));
    canvas.draw(&gpu, &plan(), &style, 1.0).expect("a frame");
    canvas.land.show(&gpu, &slope(1.0, Some(&pile)));
    let mut frames = 0;
    while !canvas.land.settled() {
        canvas.draw(&gpu, &plan(), &style, 0.05).expect("a frame");
        frames += 1;
        assert!(frames < 60, "it never settles");
    }
    assert!(frames > 5, "it grew in {frames} frames");
    assert!(most(&canvas.image(&gpu).expect("an image"), &last) <= SAME);
}

#[test]
fn the_geological_map_is_mixed_in_and_goes_without_a_trace() {
    let Some(gpu) = card::drawing() else { return };
    let geology = |geology| LandStyle {
        geology,
        ..LandStyle::default()
    };
    let surface = slope(1.0, Some(&pile(1.0)));
    let mut canvas = Canvas::new(&gpu, SIZE, RenderQuality::SOFTWARE).expect("a canvas");
    canvas.land.show(&gpu, &surface);
    let mut shown = |share: f64| {
        canvas
            .draw(&gpu, &plan(), &geology(share as f32), 1.0)
            .expect("a frame");
        canvas.image(&gpu).expect("an image")
    };
    let [before, half, whole, after] = [0.0, 0.5, 1.0, 0.0].map(&mut shown);
    // The plateau in the north is of the blue layer.
    let blue = |image: &RgbaImage| {
        let [r, _, b, _] = image.get_pixel(320, 60).0;
        f64::from(b) - f64::from(r)
    };
    let [none, some, all] = [&before, &half, &whole].map(blue);
    assert!(
        all > 60.0 && some > none + 15.0 && some < all - 15.0,
        "{none} {some} {all}"
    );
    assert_eq!(before, after);

    // Where nothing is known of the layers there is no such map.
    let unknown = slope(1.0, None);
    let [plain, asked] = [0.0, 1.0].map(|share| drawn(&gpu, &unknown, &plan(), &geology(share)));
    assert_eq!(plain, asked);
}

#[test]
fn thick_sediment_on_flat_ground_is_smooth() {
    let Some(gpu) = card::drawing() else { return };
    let style = LandStyle::default();
    let flat = slope(0.0, Some(&pile(1.0)));
    let mut filled = flat.clone();
    if let Some(map) = &mut filled.strata {
        let deep = |p: DVec2| ((p.x - LAND.width / 2.0) / 100.0).clamp(0.0, 20.0) as f32;
        Arc::make_mut(map).sediment = Raster::from_fn(CELLS.0, CELLS.1, LAND, deep);
    }
    let [without, with] = [&flat, &filled].map(|surface| drawn(&gpu, surface, &plan(), &style));
    let changed = |x: u32| {
        let [a, b] = [&without, &with].map(|image| image.get_pixel(x, 180).0);
        a.iter()
            .zip(b)
            .map(|(&a, b)| i32::from(b) - i32::from(a))
            .sum::<i32>()
    };
    assert_eq!(changed(100), 0);
    assert!(changed(600) != 0);
    let steps = (101..600).map(|x| (changed(x) - changed(x - 1)).abs());
    assert!(steps.max() <= Some(6));
}
