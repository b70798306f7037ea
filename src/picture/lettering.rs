//! The sheet around the land: paper, neat line, caption, scale.

use ab_glyph::{Font as _, FontRef, PxScale, ScaleFont as _, point};
use tiny_skia::{Color, IntRect, Paint, Pixmap, PixmapPaint, Rect, Transform};

use super::{MapFrame, MapStyle};
use crate::rock::Colour;
use crate::slice::colour::{INK, PAPER};
use crate::surface::Surface;
use crate::units::{KM, MYR};

/// The program's own font; `None` where it does not parse, as a picture without letters is still a picture.
pub(super) fn font() -> Option<FontRef<'static>> {
    FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).ok()
}

/// Letters of one size and colour.
#[derive(Clone, Copy)]
pub(super) struct Letters<'a> {
    pub(super) font: &'a FontRef<'a>,
    /// Size, pixels.
    pub(super) size: f32,
    pub(super) colour: Colour,
    /// Opacity, 0–1.
    pub(super) strength: f32,
}

/// The whole picture: the land in its place on the paper, lettered where the style has lettering.
pub(super) fn sheet(
    land: &Pixmap,
    surface: &Surface,
    style: &MapStyle,
    frame: MapFrame,
    width: u32,
    height: u32,
) -> Option<Pixmap> {
    let mut sheet = Pixmap::new(width, height)?;
    sheet.fill(Color::from_rgba8(PAPER[0], PAPER[1], PAPER[2], 255));
    let (left, top) = (frame.left as i32, frame.top as i32);
    sheet.draw_pixmap(
        left,
        top,
        land.as_ref(),
        &PixmapPaint::default(),
        Transform::identity(),
        None,
    );
    if style.lettering {
        neat_line(&mut sheet, frame);
        if let Some(font) = font() {
            letter(&mut sheet, &font, surface, style, frame);
        }
    }
    Some(sheet)
}

/// A thin line around the land.
fn neat_line(sheet: &mut Pixmap, frame: MapFrame) {
    let thick = frame.scale().round().max(1.0) as i32;
    let (left, top) = (frame.left as i32 - thick, frame.top as i32 - thick);
    let (width, height) = (frame.width + 2 * thick as u32, frame.height + 2 * thick as u32);
    let sides = [
        IntRect::from_xywh(left, top, width, thick as u32),
        IntRect::from_xywh(left, top + height as i32 - thick, width, thick as u32),
        IntRect::from_xywh(left, top, thick as u32, height),
        IntRect::from_xywh(left + width as i32 - thick, top, thick as u32, height),
    ];
    for side in sides.into_iter().flatten() {
        fill(sheet, side.to_rect(), 0.75);
    }
}

fn fill(sheet: &mut Pixmap, rect: Rect, strength: f32) {
    let mut paint = Paint::default();
    paint.set_color_rgba8(INK[0], INK[1], INK[2], (strength * 255.0) as u8);
    sheet.fill_rect(rect, &paint, Transform::identity(), None);
}

/// Title and facts to the left, the scale to the right, on one line under the land.
fn letter(sheet: &mut Pixmap, font: &FontRef<'_>, surface: &Surface, style: &MapStyle, frame: MapFrame) {
    let scale = frame.scale();
    let (left, right) = (frame.left as f32, (frame.left + frame.width) as f32);
    let bottom = (frame.top + frame.height) as f32;
    let foot = sheet.height() as f32 - bottom;
    let baseline = bottom + 0.5 * foot + 6.0 * scale;
    let mut pen = left;
    if !style.title.is_empty() {
        // A title begins with a capital, however its file writes it.
        let mut letters = style.title.chars();
        let title: String = letters
            .next()
            .into_iter()
            .flat_map(char::to_uppercase)
            .chain(letters)
            .collect();
        pen = Letters::ink(font, 25.0 * scale, 0.95).write(sheet, &title, pen, baseline) + 20.0 * scale;
    }
    let scale_left = scale_bar(sheet, font, frame, right, baseline);
    let facts = facts(surface, style);
    let letters = Letters::ink(font, 17.0 * scale, 0.75);
    if pen + letters.width(&facts) + 20.0 * scale < scale_left {
        letters.write(sheet, &facts, pen, baseline);
    }
}

/// Model time, size of the land, and the exaggeration wherever it is not 1.
fn facts(surface: &Surface, style: &MapStyle) -> String {
    let extent = surface.height.extent;
    let mut facts = format!(
        "{:.2} My   ·   {:.0} × {:.0} km",
        surface.elapsed_yr / MYR,
        extent.width / KM,
        extent.height / KM
    );
    if style.vertical_exaggeration != 1.0 {
        use std::fmt::Write as _;
        // Writing into a string cannot fail.
        let _ = write!(facts, "   ·   heights × {}", style.vertical_exaggeration);
    }
    facts
}

/// A bar of a round number of kilometres, about a seventh of the map wide, in four alternating parts. Returns where
/// it begins.
fn scale_bar(sheet: &mut Pixmap, font: &FontRef<'_>, frame: MapFrame, right: f32, baseline: f32) -> f32 {
    let scale = frame.scale();
    let pixels_per_km = KM / frame.metres_per_pixel();
    let km = round_below(f64::from(frame.width) / 7.0 / pixels_per_km);
    let length = (km * pixels_per_km) as f32;
    let label = format!("{km} km");
    let letters = Letters::ink(font, 15.0 * scale, 0.85);
    let label_left = right - letters.width(&label);
    letters.write(sheet, &label, label_left, baseline);
    let zero_width = letters.width("0");
    let start = label_left - 9.0 * scale - length;
    let thick = 3.2 * scale;
    let top = baseline - 5.2 * scale - 0.5 * thick;
    for part in 0..4 {
        let strength = if part % 2 == 0 { 0.85 } else { 0.28 };
        if let Some(rect) = Rect::from_xywh(start + length * 0.25 * part as f32, top, length * 0.25, thick) {
            fill(sheet, rect, strength);
        }
    }
    let zero_left = start - 9.0 * scale - zero_width;
    letters.write(sheet, "0", zero_left, baseline);
    zero_left
}

/// The largest 1, 2 or 5 times a power of ten that is not above `value`.
pub(crate) fn round_below(value: f64) -> f64 {
    let power = 10.0_f64.powi(value.log10().floor() as i32);
    let digit = value / power;
    power
        * if digit >= 5.0 {
            5.0
        } else if digit >= 2.0 {
            2.0
        } else {
            1.0
        }
}

impl Letters<'_> {
    /// Ink of a strength.
    fn ink<'a>(font: &'a FontRef<'a>, size: f32, strength: f32) -> Letters<'a> {
        Letters {
            font,
            size,
            colour: INK,
            strength,
        }
    }

    /// How wide a text is, pixels.
    pub(super) fn width(&self, text: &str) -> f32 {
        let scaled = self.font.as_scaled(PxScale::from(self.size));
        text.chars().map(|c| scaled.h_advance(scaled.glyph_id(c))).sum()
    }

    /// Writes `text` from `left` on the baseline; returns where it ends.
    pub(super) fn write(&self, sheet: &mut Pixmap, text: &str, left: f32, baseline: f32) -> f32 {
        let scale = PxScale::from(self.size);
        let scaled = self.font.as_scaled(scale);
        let (width, height) = (sheet.width() as i32, sheet.height() as i32);
        let mut pen = left;
        for c in text.chars() {
            let id = scaled.glyph_id(c);
            let glyph = id.with_scale_and_position(scale, point(pen, baseline));
            pen += scaled.h_advance(id);
            let Some(outline) = self.font.outline_glyph(glyph) else {
                continue;
            };
            let origin = outline.px_bounds().min;
            outline.draw(|dx, dy, coverage| {
                let (x, y) = (origin.x as i32 + dx as i32, origin.y as i32 + dy as i32);
                if (0..width).contains(&x) && (0..height).contains(&y) {
                    let pixel = &mut sheet.pixels_mut()[(y * width + x) as usize];
                    let part = coverage.min(1.0) * self.strength;
                    let blend = |paper: u8, ink: u8| {
                        (f32::from(paper) + (f32::from(ink) - f32::from(paper)) * part).round() as u8
                    };
                    *pixel = super::opaque([
                        blend(pixel.red(), self.colour[0]),
                        blend(pixel.green(), self.colour[1]),
                        blend(pixel.blue(), self.colour[2]),
                    ]);
                }
            });
        }
        pen
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round_numbers() {
        assert_eq!(round_below(25.4), 20.0);
        assert_eq!(round_below(5.0), 5.0);
        assert_eq!(round_below(0.19), 0.1);
        assert_eq!(round_below(99.0), 50.0);
    }
}
