//! The land itself: light times cover, seen through air.

use rayon::prelude::*;
use tiny_skia::Pixmap;

use super::colour::{Encoder, smoothstep};
use super::cover::Palette;
use super::field::Field;
use super::light::Relief;
use super::strata::Strata;
use super::water::{self, Course, Lakes, Rivers};
use super::{MapFrame, MapStyle, cover, opaque};
use crate::surface::Surface;

/// Heights that count as summits at least and at most, metres: hills are not painted as if they were the Alps.
pub(crate) const SUMMITS: (f32, f32) = (1200.0, 3600.0);

/// Heights on the pixels. The outermost nodes of a mesh are held by its border condition and make a rim around the
/// land: the land just inside goes on to the edge in their place.
fn ground(surface: &Surface, width: usize, height: usize, spacing: f32) -> Field {
    let field = Field::resampled(&surface.height, width, height);
    let rim = |side: usize| ((1.5 * spacing) as usize).min((side - 1) / 2);
    let (rim_x, rim_y) = (rim(width), rim(height));
    let mut ground = field.clone();
    ground
        .data
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            let inside = y.clamp(rim_y, height - 1 - rim_y) * width;
            for (x, z) in row.iter_mut().enumerate() {
                let value = field.data[inside + x.clamp(rim_x, width - 1 - rim_x)];
                *z = if value.is_finite() { value } else { 0.0 };
            }
        });
    ground
}

/// Height of the plains: a seventh of the land lies lower. Land that is all mountains keeps the sea's.
pub(crate) fn lowland(ground: &[f32]) -> f32 {
    const EVERY: usize = 97;
    let mut heights: Vec<f32> = ground.iter().copied().step_by(EVERY).collect();
    let seventh = heights.len() / 7;
    let (_, lowland, _) = heights.select_nth_unstable_by(seventh, f32::total_cmp);
    lowland.clamp(-400.0, 400.0)
}

/// The shape of the land and its water on the pixels of a map.
pub(super) struct Terrain {
    ground: Field,
    pub(super) lakes: Lakes,
    pub(super) relief: Relief,
    pub(super) courses: Vec<Course>,
}

impl Terrain {
    pub(super) fn new(surface: &Surface, style: &MapStyle, frame: MapFrame) -> Self {
        let (width, height) = (frame.width as usize, frame.height as usize);
        let spacing = (surface.spacing / frame.metres_per_pixel()) as f32;
        let ground = ground(surface, width, height, spacing);
        let lakes = Lakes::new(surface, width, height, spacing);
        let relief = Relief::new(
            &ground,
            &lakes.depth,
            frame.metres_per_pixel() as f32,
            spacing,
            style.vertical_exaggeration as f32,
        );
        let courses = water::courses(surface, &relief, frame);
        Self {
            ground,
            lakes,
            relief,
            courses,
        }
    }
}

/// The land's pixels, with its water and without marks and letters.
pub(super) fn land(surface: &Surface, style: &MapStyle, frame: MapFrame) -> Option<Pixmap> {
    let (width, height) = (frame.width as usize, frame.height as usize);
    let metres_per_pixel = frame.metres_per_pixel() as f32;
    let Terrain {
        ground,
        lakes,
        relief,
        courses,
    } = Terrain::new(surface, style, frame);
    let strata = Strata::new(surface, frame);
    let floodplain = water::floodplain(&courses, frame);
    let rivers = Rivers::new(&courses, frame)?;
    let palette = Palette::new(lowland(&ground.data));
    let encoder = Encoder::new();
    let summit = ground
        .data
        .iter()
        .fold(0.0_f32, |top, &z| top.max(z))
        .clamp(SUMMITS.0, SUMMITS.1);

    let mut pixmap = Pixmap::new(frame.width, frame.height)?;
    let place = |x: f32, y: f32| {
        (
            (x + 0.5) * metres_per_pixel,
            frame.extent.height as f32 - (y + 0.5) * metres_per_pixel,
        )
    };
    // A quarter of the noise's finest wave.
    let coarse = (600.0 / metres_per_pixel).max(1.0);
    let broad = {
        let columns = (width as f32 / coarse) as usize + 2;
        let rows = (height as f32 / coarse) as usize + 2;
        let at = |i: usize| place((i % columns) as f32 * coarse, (i / columns) as f32 * coarse);
        Field {
            width: columns,
            height: rows,
            data: (0..columns * rows).map(|i| cover::broad_noise(at(i))).collect(),
        }
    };
    pixmap
        .pixels_mut()
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                let i = y * width + x;
                let z = ground.data[i];
                let height_share = smoothstep(0.0, summit, z);
                let spot = relief.spot(x, y, height_share);
                let at = place(x as f32, y as f32);
                let broad = broad.sample(x as f32 / coarse, y as f32 / coarse);
                let stone = strata.as_ref().map(|strata| strata.stone(x, y));
                let land = palette.land(at, z, broad, floodplain.at(x, y), &spot, stone);
                let mut colour = land * spot.light;
                colour = rivers.over(colour, i);
                let wet = lakes.cover.data[i];
                if wet > 0.0 {
                    let still = palette.lake(lakes.depth.data[i], &spot);
                    // The shore is where the water covers half; a thin darker line runs along it.
                    let line = smoothstep(0.36, 0.48, wet) * (1.0 - smoothstep(0.52, 0.68, wet));
                    colour = colour.lerp(still, smoothstep(0.44, 0.56, wet));
                    colour = colour.lerp(palette.shore(), 0.45 * line);
                }
                *pixel = opaque(encoder.encode(palette.through_air(colour, height_share)));
            }
        });
    Some(pixmap)
}
