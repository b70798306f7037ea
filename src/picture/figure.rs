//! Paints a drawn slice.

use glam::DVec2;
use image::RgbaImage;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::MAX_SIDE;
use super::lettering::{Letters, font};
use crate::rock::Colour;
use crate::slice::{Anchor, Band, Figure, Line, Text};

/// The figure as pixels, opaque, with the lettering of the maps.
pub fn paint_figure(figure: &Figure) -> RgbaImage {
    let side = |length: f64| (length as u32).clamp(1, MAX_SIDE);
    let (width, height) = (side(figure.size.x), side(figure.size.y));
    painted(figure, width, height)
        .and_then(|sheet| RgbaImage::from_raw(width, height, sheet.take()))
        .unwrap_or_else(|| RgbaImage::new(width, height))
}

/// `None` only for sizes a pixmap cannot have.
fn painted(figure: &Figure, width: u32, height: u32) -> Option<Pixmap> {
    let mut sheet = Pixmap::new(width, height)?;
    let [red, green, blue] = figure.paper;
    sheet.fill(Color::from_rgba8(red, green, blue, 255));
    for band in &figure.bands {
        fill(&mut sheet, band);
    }
    for line in &figure.lines {
        stroke(&mut sheet, line);
    }
    if let Some(font) = font() {
        for text in &figure.texts {
            let letters = Letters {
                font: &font,
                size: text.size as f32,
                colour: text.colour,
                strength: 1.0,
            };
            write(&mut sheet, letters, text);
        }
    }
    Some(sheet)
}

fn fill(sheet: &mut Pixmap, band: &Band) {
    let mut path = PathBuilder::new();
    push(&mut path, band.outline());
    path.close();
    if let Some(path) = path.finish() {
        sheet.fill_path(
            &path,
            &paint(band.colour),
            FillRule::Winding,
            Transform::identity(),
            None,
        );
    }
}

fn stroke(sheet: &mut Pixmap, line: &Line) {
    let mut path = PathBuilder::new();
    push(&mut path, line.points.iter().copied());
    let stroke = Stroke {
        width: line.width as f32,
        line_cap: LineCap::Butt,
        line_join: LineJoin::Round,
        dash: line
            .dash
            .and_then(|dash| StrokeDash::new(dash.map(|d| d as f32).to_vec(), 0.0)),
        ..Stroke::default()
    };
    if let Some(path) = path.finish() {
        sheet.stroke_path(&path, &paint(line.colour), &stroke, Transform::identity(), None);
    }
}

fn write(sheet: &mut Pixmap, letters: Letters<'_>, text: &Text) {
    let width = letters.width(&text.text);
    let left = text.at.x as f32
        - match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
    letters.write(sheet, &text.text, left, text.at.y as f32);
}

fn paint([red, green, blue]: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

/// Points that are no places are left out.
fn push(path: &mut PathBuilder, points: impl Iterator<Item = DVec2>) {
    for (i, p) in points.filter(|p| p.is_finite()).enumerate() {
        if i == 0 {
            path.move_to(p.x as f32, p.y as f32);
        } else {
            path.line_to(p.x as f32, p.y as f32);
        }
    }
}
