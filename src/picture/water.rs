//! Rivers and lakes.

use glam::DVec2;
use glam::Vec3;
use rayon::prelude::*;
use tiny_skia::{FillRule, Mask, PathBuilder, Transform};

use super::colour::{linear, smoothstep};
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
        let soft = (0.55 * spacing).max(0.6);
        let cover = cover.blurred(soft);
        // Depths are known on straight mesh edges; their bends are no form of the bottom.
        let depth = depth.blurred(if spacing > 1.0 { soft } else { 0.0 });
        Self { cover, depth }
    }
}

/// Width of a river of some drainage area (m²) on a map 1000 pixels high, pixels: hydraulic geometry's square root
/// (Leopold & Maddock 1953) would make brooks vanish beside streams, so maps flatten it.
pub(crate) fn drawn_width(drainage: f64) -> f64 {
    let km2 = drainage / (KM * KM);
    (0.54 * (km2.max(0.1) / 20.0).powf(0.31)).min(2.9)
}

/// Distance over which a river grows to its width below its source, in pixels of a map 1000 pixels high.
const TAPER: f64 = 70.0;

/// A river in pixels of the map.
pub(super) struct Course {
    line: Vec<DVec2>,
    drainage: Vec<f64>,
}

/// Below this true steepness rivers wander freely, and not at all at four times as much.
const WANDERING: f32 = 0.02;

/// How far wandering takes a river from its line, in mesh edges: below what the data knows.
const WANDER_REACH: f64 = 0.35;

/// Wavelength of the wandering, in mesh edges: long, so that lines stay smooth.
const WANDER_WAVE: f64 = 5.0;

/// The surface's rivers on the map. On flat land they wander off the straight mesh edges; the way they do depends on
/// the place alone, so that tributaries still meet their main stem.
pub(super) fn courses(surface: &Surface, relief: &Relief, frame: MapFrame) -> Vec<Course> {
    let origin = DVec2::new(f64::from(frame.left), f64::from(frame.top));
    let wander = |plan: DVec2, pixel: DVec2| {
        let steep = relief.steepness_at(pixel.x as f32, pixel.y as f32);
        let freedom = f64::from(1.0 - smoothstep(WANDERING, 4.0 * WANDERING, steep));
        let p = (plan / (0.5 * WANDER_WAVE * surface.spacing)).as_vec2();
        let aside = DVec2::new(
            f64::from(noise::gradient(p.x, p.y, 71)),
            f64::from(noise::gradient(p.x, p.y, 72)),
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

/// Cover (0–255) of the outlines of all courses at once, so that they do not darken each other where they meet.
/// `shrink` pixels of the map are one of the mask's; widths are pixels of a map 1000 pixels high.
fn cover(
    (columns, rows): (u32, u32),
    courses: &[Course],
    scale: f64,
    shrink: f64,
    width: impl Fn(f64) -> f64,
) -> Option<Mask> {
    let mut mask = Mask::new(columns, rows)?;
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
            let taper = 0.45 + 0.55 * (walked / (TAPER * scale)).min(1.0);
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
        mask.fill_path(&path, FillRule::Winding, true, Transform::identity());
    }
    Some(mask)
}

/// Colour of rivers, `0xRRGGBB`.
pub(crate) const RIVER: u32 = 0x4a_8bb2;

/// Rivers on the pixels.
pub(super) struct Rivers {
    water: Mask,
    casing: Mask,
    blue: Vec3,
    dark: Vec3,
}

/// Strength of the casing, a darker line that shows along large rivers.
const CASING: f32 = 0.36;

impl Rivers {
    /// `None` only for sizes a mask cannot have.
    pub(super) fn new(courses: &[Course], frame: MapFrame) -> Option<Self> {
        let scale = f64::from(frame.scale());
        let size = (frame.width, frame.height);
        Some(Self {
            water: cover(size, courses, scale, 1.0, drawn_width)?,
            casing: cover(size, courses, scale, 1.0, |drainage| {
                let width = drawn_width(drainage);
                width + 0.9 * (width / 1.6).min(1.0)
            })?,
            blue: linear(RIVER),
            dark: linear(0x34_586e),
        })
    }

    /// The colour of pixel `i` of the map with its river over it.
    #[inline]
    pub(super) fn over(&self, colour: Vec3, i: usize) -> Vec3 {
        let casing = self.casing.data()[i];
        if casing == 0 {
            return colour;
        }
        // Pixels half covered look nearly bare when mixed in linear light.
        let ink = |cover: u8| {
            let part = f32::from(cover) / 255.0;
            part * (1.5 - 0.5 * part)
        };
        colour
            .lerp(self.dark, CASING * ink(casing))
            .lerp(self.blue, ink(self.water.data()[i]))
    }
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
    let scale = f64::from(frame.scale());
    let mask = self::cover(
        (width, height),
        courses,
        scale,
        f64::from(COARSENESS),
        |drainage| {
            let km2 = drainage / (KM * KM);
            22.0 * f64::from(smoothstep(15.0, 2400.0, km2 as f32).sqrt())
        },
    );
    if let Some(mask) = mask {
        for (value, &alpha) in cover.data.iter_mut().zip(mask.data()) {
            *value = f32::from(alpha) / 255.0;
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
