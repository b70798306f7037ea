//! The layers of rock on the map's pixels.

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use super::MapFrame;
use super::colour::{light, smoothstep};
use super::field::Field;
use crate::rock::Stratigraphy;
use crate::surface::{StrataMap, Surface};

/// Beds are drawn from this thickness on the map on, pixels, and in full from the second; finer ones merge into the
/// colour of their layer.
const DRAWN_BED: (f32, f32) = (3.0, 4.5);

/// How much lighter a hard bed and darker a weak one is than their layer, at full contrast.
const BED_TONE: f32 = 0.30;

/// Part of that which beds of a layer without contrast have: joints and bedding planes show in any rock.
const LEAST_CONTRAST: f32 = 0.35;

/// Steeper borders between layers than this, metres of depth before folding per pixel, are drawn as lines: where a layer's
/// surface lies in the land's, its border has no place.
const STEEP_ENOUGH: (f32, f32) = (0.4, 2.0);

/// What lies under the pixels.
pub(super) struct Strata<'a> {
    map: &'a StrataMap,
    frame: MapFrame,
    /// Depth before folding of the rock at the surface, metres.
    depth: Field,
    /// Map colours of the layers and the basement.
    printed: Vec<Vec3>,
    /// Their colours in the light.
    stone: Vec<Vec3>,
}

/// Rock on a cliff.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stone {
    /// Its layer's colour.
    pub(super) layer: Vec3,
    /// The same with its beds.
    pub(super) bedded: Vec3,
}

/// Rock on the geological map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcrop {
    /// Its layer's colour, mixed on the border.
    pub(super) colour: Vec3,
    /// 1 on the border of two layers, 0 beside it.
    pub(super) border: f32,
    /// Thickness of loose sediment on it, metres.
    pub(super) sediment: f32,
}

impl<'a> Strata<'a> {
    /// The layers of a surface on the pixels of `frame`; `None` where nothing is known of them.
    pub(super) fn new(surface: &'a Surface, frame: MapFrame) -> Option<Self> {
        let map = surface.strata.as_deref()?;
        let (width, height) = (frame.width as usize, frame.height as usize);
        let mut depth = Field {
            width,
            height,
            data: vec![0.0; width * height],
        };
        depth.data.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, depth) in row.iter_mut().enumerate() {
                let p = frame.centre(x, y);
                *depth = map.exposed_depth(p, surface.ground(p)) as f32;
            }
        });
        let pile = &map.stratigraphy;
        let rocks = || (0..=pile.layers().len()).map(|layer| pile.rock(layer));
        Some(Self {
            map,
            frame,
            depth,
            printed: rocks()
                .map(|r| light(crate::slice::colour::printed(r.colour)))
                .collect(),
            stone: rocks().map(|rock| light(rock.stone)).collect(),
        })
    }

    /// The pile.
    pub(super) fn pile(&self) -> &Stratigraphy {
        &self.map.stratigraphy
    }

    /// Somewhere lies more loose sediment than `thickness`, metres.
    pub(super) fn has_sediment(&self, thickness: f32) -> bool {
        self.map.sediment.data.iter().any(|&t| t > thickness)
    }

    /// Depth at a pixel, and how fast it changes, metres per pixel.
    fn depth_at(&self, x: usize, y: usize) -> (f32, f32) {
        let (east, north) = self.depth.gradient(x, y);
        let depth = self.depth.data[y * self.depth.width + x];
        (depth, (east * east + north * north).sqrt().max(1e-3))
    }

    /// Colour by layer at a depth that changes by `rate` metres per pixel: mixed where the border crosses the pixel.
    /// Also how far that border is, pixels.
    fn by_layer(&self, colours: &[Vec3], depth: f32, rate: f32) -> (Vec3, f32) {
        let borders = &self.pile().depths()[1..];
        let layer = self.pile().place(f64::from(depth)).layer;
        let mut colour = colours[layer];
        let mut nearest = f32::MAX;
        for neighbour in [layer.checked_sub(1), Some(layer)].into_iter().flatten() {
            let Some(&border) = borders.get(neighbour) else {
                continue;
            };
            let away = (depth - border as f32) / rate;
            if away.abs() < nearest.abs() {
                nearest = away;
                let below = (0.5 + away).clamp(0.0, 1.0);
                colour = colours[neighbour].lerp(colours[neighbour + 1], below);
            }
        }
        (colour, nearest.abs())
    }

    /// The rock on the geological map at a pixel; borders are `width` pixels wide.
    pub(super) fn outcrop(&self, x: usize, y: usize, width: f32) -> Outcrop {
        let (depth, rate) = self.depth_at(x, y);
        let (colour, away) = self.by_layer(&self.printed, depth, rate);
        let line = 1.0 - smoothstep(0.5 * width - 0.5, 0.5 * width + 0.5, away);
        let sediment = self.map.sediment.sample(self.frame.centre(x, y));
        Outcrop {
            colour,
            border: line * smoothstep(STEEP_ENOUGH.0, STEEP_ENOUGH.1, rate) * self.line_strength(depth, rate),
            sediment: if sediment.is_finite() { sediment } else { 0.0 },
        }
    }

    /// Where a layer is only a few pixels wide, its two borders would leave nothing of its colour: they fade.
    fn line_strength(&self, depth: f32, rate: f32) -> f32 {
        let layer = self.pile().place(f64::from(depth)).layer;
        let wide = self
            .pile()
            .layers()
            .get(layer)
            .map_or(f32::MAX, |layer| layer.thickness_m as f32 / rate);
        0.35 + 0.65 * smoothstep(3.0, 9.0, wide)
    }

    /// The rock as a cliff shows it at a pixel.
    pub(super) fn stone(&self, x: usize, y: usize) -> Stone {
        let (depth, rate) = self.depth_at(x, y);
        let (layer, _) = self.by_layer(&self.stone, depth, rate);
        let place = self.pile().place(f64::from(depth));
        let Some(found) = self.pile().layers().get(place.layer) else {
            return Stone { layer, bedded: layer };
        };
        let bed = found.thickness_m as f32 / f32::from(found.beds);
        let drawn = smoothstep(DRAWN_BED.0, DRAWN_BED.1, bed / rate);
        let contrast = LEAST_CONTRAST + (1.0 - LEAST_CONTRAST) * found.contrast as f32;
        // Within the layer, in beds; hard ones are even, and lighter.
        let beds = (depth - self.pile().depths()[place.layer] as f32) / bed;
        let border = beds.round();
        let tone_of = |bed: f32| if bed.rem_euclid(2.0) < 1.0 { 1.0 } else { -1.0 };
        let tone = if border < 0.5 || border > f32::from(found.beds) - 0.5 {
            tone_of(f32::from(place.bed))
        } else {
            let below = (0.5 + (beds - border) * bed / rate).clamp(0.0, 1.0);
            tone_of(border - 1.0) * (1.0 - below) + tone_of(border) * below
        };
        let tone = if found.beds > 1 {
            tone * drawn * contrast * BED_TONE
        } else {
            0.0
        };
        Stone {
            layer,
            bedded: layer * (1.0 + tone),
        }
    }
}

impl MapFrame {
    /// Plan position of the centre of a pixel of the land, metres.
    fn centre(&self, x: usize, y: usize) -> DVec2 {
        let share = DVec2::new(
            (x as f64 + 0.5) / f64::from(self.width),
            1.0 - (y as f64 + 0.5) / f64::from(self.height),
        );
        share * self.extent.size()
    }
}
