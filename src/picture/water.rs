//! Rivers and lakes.

use glam::DVec2;
use rayon::prelude::*;
use tiny_skia::{FillRule, Paint, PathBuilder, Pixmap, Transform};

use super::colour::smoothstep;
use super::field::Field;
use super::light::Relief;
use super::{MapFrame, noise};
use crate::surface::Surface;
use crate::units::KM;

/// Standing water on the pixels.
pub(super) struct Lakes {
    /// Part of the pixel under water; the shore is at ½.
    pub(super) cover: Field,
    /// Depth, metres.
    pub(super) depth: Field,
}

/// Shallower water is a wet meadow, metres.
const LEAST_DEPTH: f32 = 0.5;

impl Lakes {
    /// Water on `width × height` pixels, known every `spacing` pixels.
    pub(super) fn new(surface: &Surface, width: usize, height: usize, spacing: f32) -> Self {
        let depth = Field::resampled(&surface.lake_depth, width, height);
        let mut cover = depth.clone();
        cover
            .data
            .par_iter_mut()
            .for_each(|depth| *depth = smoothstep(0.0, 2.0 * LEAST_DEPTH, *depth));
        let cover = cover.blurred((0.55 * spacing).max(0.6));
        Self { cover, depth }
    }
}

/// Width of a river of some drainage area (m²) on a map 1000 pixels high, pixels: hydraulic geometry's square root
/// (Leopold & Maddock 1953) would make brooks vanish beside streams, so maps flatten it.
fn drawn_width(drainage: f64) -> f64 {
    let km2 = drainage / (KM * KM);
    (0.5 * (km2.max(0.1) / 20.0).powf(0.30)).min(1.9)
}

/// Distance over which a river grows to its width below its source, in pixels of a map 1000 pixels high.
const TAPER: f64 = 14.0;

/// A river in pixels of the map.
pub(super) struct Course {
    line: Vec<DVec2>,
    drainage: Vec<f64>,
}

/// Below this true steepness rivers wander freely, and not at all at four times as much.
const WANDERING: f32 = 0.02;

/// How far wandering takes a river from its line, in mesh edges: below what the data knows.
const WANDER_REACH: f64 = 0.2;

/// The surface's rivers on the map. On flat land they wander off the straight mesh edges; the way they do depends on
/// the place alone, so that tributaries still meet their main stem.
pub(super) fn courses(surface: &Surface, relief: &Relief, frame: MapFrame) -> Vec<Course> {
    let origin = DVec2::new(f64::from(frame.left), f64::from(frame.top));
    let wander = |plan: DVec2, pixel: DVec2| {
        let steep = relief.steepness_at(pixel.x as f32, pixel.y as f32);
        let freedom = f64::from(1.0 - smoothstep(WANDERING, 4.0 * WANDERING, steep));
        let p = (plan / (1.3 * surface.spacing)).as_vec2();
        let aside = DVec2::new(
            f64::from(noise::fractal(p.x, p.y, 2, 71)),
            f64::from(noise::fractal(p.x, p.y, 2, 72)),
        );
        plan + aside * (WANDER_REACH * surface.spacing * freedom)
    };
    surface
        .rivers
        .iter()
        .filter(|river| river.points.len() >= 2)
        .filter(|river| {
            river
                .points
                .iter()
                .all(|p| p.at.is_finite() && p.drainage.is_finite())
        })
        .map(|river| Course {
            line: river
                .points
                .iter()
                .map(|p| frame.to_pixel(wander(p.at, frame.to_pixel(p.at) - origin)) - origin)
                .collect(),
            drainage: river.points.iter().map(|p| p.drainage).collect(),
        })
        .collect()
}

/// Fills the outlines of all courses at once, so that they do not darken each other where they meet. `shrink` pixels
/// of the map are one of `pixmap`; widths are pixels of a map 1000 pixels high.
fn fill(
    pixmap: &mut Pixmap,
    courses: &[Course],
    scale: f64,
    shrink: f64,
    ink: [u8; 4],
    width: impl Fn(f64) -> f64,
) {
    let mut path = PathBuilder::new();
    for Course { line, drainage } in courses {
        let mut walked = 0.0;
        let mut banks = Vec::with_capacity(line.len());
        for (i, &here) in line.iter().enumerate() {
            let ahead = line[(i + 1).min(line.len() - 1)];
            let behind = line[i.saturating_sub(1)];
            if i > 0 {
                walked += here.distance(behind);
            }
            let taper = 0.25 + 0.75 * (walked / (TAPER * scale)).min(1.0);
            let half = 0.5 * scale * width(drainage[i]) * taper;
            banks.push((here, (ahead - behind).normalize_or_zero().perp() * half));
        }
        let left = banks.iter().map(|&(here, aside)| here + aside);
        let right = banks.iter().rev().map(|&(here, aside)| here - aside);
        for (i, p) in left.chain(right).map(|p| (p / shrink).as_vec2()).enumerate() {
            if i == 0 {
                path.move_to(p.x, p.y);
            } else {
                path.line_to(p.x, p.y);
            }
        }
        path.close();
    }
    if let Some(path) = path.finish() {
        let mut paint = Paint::default();
        let [red, green, blue, alpha] = ink;
        paint.set_color_rgba8(red, green, blue, alpha);
        pixmap.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
    }
}

/// Rivers over the land: a darker casing that shows along the large ones, then the water.
pub(super) fn draw(pixmap: &mut Pixmap, courses: &[Course], frame: MapFrame) {
    let scale = f64::from(frame.scale());
    fill(pixmap, courses, scale, 1.0, [52, 88, 110, 90], |drainage| {
        let width = drawn_width(drainage);
        width + 0.9 * (width / 1.6).min(1.0)
    });
    fill(pixmap, courses, scale, 1.0, [106, 156, 184, 255], drawn_width);
}

/// Where rivers have spread their gravels: 1 beside large rivers, 0 away from them.
pub(super) struct Floodplain {
    cover: Field,
}

/// Pixels of the map per pixel of the floodplain: it is soft.
const COARSENESS: u32 = 4;

/// The floodplain of all courses.
pub(super) fn floodplain(courses: &[Course], frame: MapFrame) -> Floodplain {
    let (width, height) = (
        frame.width.div_ceil(COARSENESS),
        frame.height.div_ceil(COARSENESS),
    );
    let mut cover = Field {
        width: width as usize,
        height: height as usize,
        data: vec![0.0; width as usize * height as usize],
    };
    if let Some(mut pixmap) = Pixmap::new(width, height) {
        let scale = f64::from(frame.scale());
        let shrink = f64::from(COARSENESS);
        fill(&mut pixmap, courses, scale, shrink, [0, 0, 0, 255], |drainage| {
            let km2 = drainage / (KM * KM);
            26.0 * f64::from(smoothstep(15.0, 1200.0, km2 as f32).sqrt())
        });
        for (value, pixel) in cover.data.iter_mut().zip(pixmap.pixels()) {
            *value = f32::from(pixel.alpha()) / 255.0;
        }
    }
    Floodplain {
        cover: cover.blurred(1.6 * frame.scale()),
    }
}

impl Floodplain {
    /// At a pixel of the map.
    pub(super) fn at(&self, x: usize, y: usize) -> f32 {
        let skip = COARSENESS as f32;
        self.cover
            .sample((x as f32 + 0.5) / skip - 0.5, (y as f32 + 0.5) / skip - 0.5)
    }
}
