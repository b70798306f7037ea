//! The geological map: which layer is at the surface, over a quiet relief.

use ab_glyph::FontRef;
use glam::{DVec2, Vec3};
use image::RgbaImage;
use rayon::prelude::*;
use tiny_skia::{Paint, PathBuilder, Pixmap, Rect, Stroke, Transform};

use super::colour::{Encoder, light, smoothstep};
use super::lettering::{self, Letters, font};
use super::paint::Terrain;
use super::strata::Strata;
use super::water::Rivers;
use super::{MAX_SIDE, MapFrame, MapStyle, ink, opaque};
use crate::rock::Colour;
use crate::slice::colour::{INK, SEDIMENT, WATER, printed};
use crate::surface::Surface;

/// How much of the relief's light and shade is left under the colours.
const RELIEF: f32 = 0.62;

/// Sediment is shown from this thickness on, metres, and in full from the second.
const SEDIMENT_SHOWN: (f32, f32) = (3.0, 8.0);

/// Width of borders between layers, pixels of a map 1000 pixels high.
const BORDER: f32 = 1.1;

/// Strength of those borders.
const BORDER_STRENGTH: f32 = 0.62;

/// Width of the key, pixels of a map 1000 pixels high.
const KEY_WIDTH: f32 = 320.0;

/// Size of a box of the key, likewise.
const BOX: (f32, f32) = (40.0, 22.0);

/// The land by its rock, with a key of the layers beside it (where the style has lettering), opaque, north up; `None` where
/// the surface knows no layers. Sides are brought into `1..=`[`MAX_SIDE`]. At each pixel it shows the layer that a slice
/// through that place has at its surface. Beds are not drawn: on gentle land they would look like contours.
pub fn geological_map(surface: &Surface, style: &MapStyle, width: u32, height: u32) -> Option<RgbaImage> {
    let (width, height) = (width.clamp(1, MAX_SIDE), height.clamp(1, MAX_SIDE));
    let key = if style.lettering {
        ((width.min(height) as f32 / 1000.0 * KEY_WIDTH) as u32).min(width / 3)
    } else {
        0
    };
    let frame = MapFrame::new(surface.height.extent, style, width - key, height);
    let strata = Strata::new(surface, frame)?;
    let mut land = land(surface, style, &strata, frame)?;
    ink::draw_faults(&mut land, surface, frame);
    ink::draw_cuts(&mut land, &style.cuts, frame);
    let titled = MapStyle {
        title: match style.title.as_str() {
            "" => "Geology".to_owned(),
            title => format!("{title}: geology"),
        },
        ..style.clone()
    };
    let mut sheet = lettering::sheet(&land, surface, &titled, frame, width, height)?;
    if style.lettering
        && let Some(font) = font()
    {
        Key::new(&mut sheet, &font, frame).draw(surface, &strata);
    }
    RgbaImage::from_raw(width, height, sheet.take())
}

/// The land's pixels.
fn land(surface: &Surface, style: &MapStyle, strata: &Strata<'_>, frame: MapFrame) -> Option<Pixmap> {
    let terrain = Terrain::new(surface, style, frame);
    let rivers = Rivers::new(&terrain.courses, frame)?;
    let encoder = Encoder::new();
    let [sediment, water, ink] = [SEDIMENT, WATER, INK].map(light);
    let border = BORDER * frame.scale();
    let width = frame.width as usize;
    let mut pixmap = Pixmap::new(frame.width, frame.height)?;
    pixmap
        .pixels_mut()
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                let i = y * width + x;
                let rock = strata.outcrop(x, y, border);
                let loose = smoothstep(SEDIMENT_SHOWN.0, SEDIMENT_SHOWN.1, rock.sediment);
                let mut colour = rock
                    .colour
                    .lerp(ink, BORDER_STRENGTH * rock.border)
                    .lerp(sediment, loose);
                let shade = terrain
                    .relief
                    .spot(x, y, 0.5)
                    .light
                    .dot(Vec3::new(0.21, 0.72, 0.07));
                colour *= 1.0 + RELIEF * (shade - 1.0);
                colour = rivers.over(colour, i);
                let wet = terrain.lakes.cover.data[i];
                let shore = smoothstep(0.36, 0.48, wet) * (1.0 - smoothstep(0.52, 0.68, wet));
                colour = colour
                    .lerp(water, smoothstep(0.44, 0.56, wet))
                    .lerp(ink, 0.45 * shore);
                *pixel = opaque(encoder.encode(colour));
            }
        });
    Some(pixmap)
}

/// The key to the right of the land.
struct Key<'a> {
    sheet: &'a mut Pixmap,
    font: &'a FontRef<'a>,
    frame: MapFrame,
    scale: f32,
    left: f32,
    /// Middle of the next row.
    y: f32,
}

impl<'a> Key<'a> {
    fn new(sheet: &'a mut Pixmap, font: &'a FontRef<'a>, frame: MapFrame) -> Self {
        let scale = frame.scale();
        Self {
            sheet,
            font,
            frame,
            scale,
            left: (frame.left + frame.width) as f32 + 30.0 * scale,
            y: frame.top as f32 + 14.0 * scale,
        }
    }

    /// The pile, youngest on top, then what lies on it.
    fn draw(mut self, surface: &Surface, strata: &Strata<'_>) {
        let pile = strata.pile();
        self.words(pile.title(), 21.0, self.left, 0.95);
        self.y += 38.0 * self.scale;
        let row = 34.0 * self.scale;
        if strata.has_sediment(SEDIMENT_SHOWN.1) {
            self.layer(SEDIMENT, "Loose sediment", "");
            self.y += row;
        }
        for (i, layer) in pile.layers().iter().enumerate() {
            let thickness = format!("{} m", layer.thickness_m.round());
            self.layer(printed(pile.rock(i).colour), &layer.name, &thickness);
            self.y += row;
        }
        let basement = pile.basement();
        self.layer(printed(basement.rock.colour), &basement.name, "");
        self.y += 1.6 * row;
        if surface.lake_depth.data.iter().any(|&depth| depth > 0.5) {
            self.layer(WATER, "Lake", "");
            self.y += row;
        }
        if !surface.faults.is_empty() {
            let from = DVec2::new(f64::from(self.left), f64::from(self.y + 4.0 * self.scale));
            let length = BOX.0 * self.scale;
            ink::draw_fault_sample(self.sheet, from, f64::from(length), self.frame);
            let left = self.left + length + 12.0 * self.scale;
            self.words("Fault, teeth on the range", 16.0, left, 0.9);
        }
    }

    /// A box, a name and a thickness.
    fn layer(&mut self, colour: Colour, name: &str, more: &str) {
        let (wide, high) = (BOX.0 * self.scale, BOX.1 * self.scale);
        if let Some(rect) = Rect::from_xywh(self.left, self.y - 0.5 * high, wide, high) {
            let mut paint = Paint::default();
            paint.set_color_rgba8(colour[0], colour[1], colour[2], 255);
            self.sheet.fill_rect(rect, &paint, Transform::identity(), None);
            paint.set_color_rgba8(INK[0], INK[1], INK[2], 180);
            let stroke = Stroke {
                width: 0.9 * self.scale,
                ..Stroke::default()
            };
            let path = PathBuilder::from_rect(rect);
            self.sheet
                .stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
        let left = self.left + wide + 12.0 * self.scale;
        let end = self.words(name, 16.0, left, 0.9);
        self.words(more, 14.0, end + 10.0 * self.scale, 0.6);
    }

    /// Words in the row; returns where they end.
    fn words(&mut self, text: &str, size: f32, left: f32, strength: f32) -> f32 {
        let letters = Letters {
            font: self.font,
            size: size * self.scale,
            colour: INK,
            strength,
        };
        letters.write(self.sheet, text, left, self.y + 0.33 * size * self.scale)
    }
}
