//! Rivers and lakes.

use glam::DVec2;
use rayon::prelude::*;
use tiny_skia::{FillRule, Paint, PathBuilder, Pixmap, Transform};

use super::MapFrame;
use super::colour::smoothstep;
use super::field::Field;
use crate::surface::{River, Surface};
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
    (0.55 * (km2.max(0.1) / 20.0).powf(0.34)).min(5.0)
}

/// Distance over which a river grows to its width below its source, in pixels of a map 1000 pixels high.
const TAPER: f64 = 14.0;

/// A closed outline around a river, `widening` pixels wider than it is drawn, in pixels of the map.
fn push_outline(
    path: &mut PathBuilder,
    river: &River,
    frame: MapFrame,
    scale: f64,
    width: impl Fn(f64) -> f64,
) {
    let origin = DVec2::new(f64::from(frame.left), f64::from(frame.top));
    let line: Vec<DVec2> = river
        .points
        .iter()
        .map(|p| frame.to_pixel(p.at) - origin)
        .collect();
    let mut walked = 0.0;
    let mut banks = Vec::with_capacity(line.len());
    for (i, &here) in line.iter().enumerate() {
        let ahead = line[(i + 1).min(line.len() - 1)];
        let behind = line[i.saturating_sub(1)];
        if i > 0 {
            walked += here.distance(behind);
        }
        let taper = 0.25 + 0.75 * (walked / (TAPER * scale)).min(1.0);
        let half = 0.5 * scale * width(river.points[i].drainage) * taper;
        banks.push((here, (ahead - behind).normalize_or_zero().perp() * half));
    }
    let left = banks.iter().map(|&(here, aside)| here + aside);
    let right = banks.iter().rev().map(|&(here, aside)| here - aside);
    for (i, p) in left.chain(right).enumerate() {
        if i == 0 {
            path.move_to(p.x as f32, p.y as f32);
        } else {
            path.line_to(p.x as f32, p.y as f32);
        }
    }
    path.close();
}

fn fill_rivers(
    pixmap: &mut Pixmap,
    surface: &Surface,
    frame: MapFrame,
    ink: [u8; 4],
    width: impl Fn(f64) -> f64 + Copy,
) {
    let scale = f64::from(frame.scale());
    let mut path = PathBuilder::new();
    for river in &surface.rivers {
        if river.points.len() >= 2
            && river
                .points
                .iter()
                .all(|p| p.at.is_finite() && p.drainage.is_finite())
        {
            push_outline(&mut path, river, frame, scale, width);
        }
    }
    if let Some(path) = path.finish() {
        let mut paint = Paint::default();
        let [red, green, blue, alpha] = ink;
        paint.set_color_rgba8(red, green, blue, alpha);
        pixmap.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
    }
}

/// Rivers over the land: a darker casing that shows along the large ones, then the water.
pub(super) fn draw_rivers(pixmap: &mut Pixmap, surface: &Surface, frame: MapFrame) {
    fill_rivers(pixmap, surface, frame, [52, 88, 110, 90], |drainage| {
        let width = drawn_width(drainage);
        width + 0.9 * (width / 1.6).min(1.0)
    });
    fill_rivers(pixmap, surface, frame, [106, 156, 184, 255], drawn_width);
}

/// Where rivers have spread their gravels: 1 beside large rivers, 0 away from them.
pub(super) struct Floodplain {
    cover: Field,
    skip: f32,
}

/// Pixels of the map per pixel of the floodplain: it is soft.
const COARSENESS: u32 = 4;

/// The floodplain of all rivers.
pub(super) fn floodplain(surface: &Surface, frame: MapFrame) -> Floodplain {
    let coarse = MapFrame {
        left: 0,
        top: 0,
        width: frame.width.div_ceil(COARSENESS),
        height: frame.height.div_ceil(COARSENESS),
        ..frame
    };
    let (width, height) = (coarse.width as usize, coarse.height as usize);
    let mut data = vec![0.0; width * height];
    if let Some(mut pixmap) = Pixmap::new(coarse.width, coarse.height) {
        let finer = f64::from(frame.scale()) / f64::from(coarse.scale()) / f64::from(COARSENESS);
        fill_rivers(&mut pixmap, surface, coarse, [0, 0, 0, 255], |drainage| {
            let km2 = drainage / (KM * KM);
            finer * 26.0 * smoothstep(15.0, 1200.0, km2 as f32).sqrt() as f64
        });
        for (value, pixel) in data.iter_mut().zip(pixmap.pixels()) {
            *value = f32::from(pixel.alpha()) / 255.0;
        }
    }
    let cover = Field { width, height, data }.blurred(1.6 * frame.scale());
    Floodplain {
        cover,
        skip: COARSENESS as f32,
    }
}

impl Floodplain {
    /// At a pixel of the map.
    pub(super) fn at(&self, x: usize, y: usize) -> f32 {
        self.cover.sample(
            (x as f32 + 0.5) / self.skip - 0.5,
            (y as f32 + 0.5) / self.skip - 0.5,
        )
    }
}
