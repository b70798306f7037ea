//! Letters, upright for whoever stands at either long side.

use std::f32::consts::PI;
use std::sync::Arc;

use egui::emath::Rot2;
use egui::epaint::TextShape;
use egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect};

use crate::gesture::contact::Side;

/// Smallest letters, points: below this they are no longer read.
const SMALLEST: f32 = 9.0;

/// How far things are turned (radians, clockwise) that are read from `side`.
pub(super) fn turn(side: Side) -> f32 {
    match side {
        Side::North => PI,
        Side::South => 0.0,
    }
}

/// Writes `text` with its `anchor` at `at`, turned clockwise about it by `turn` radians. Returns where it is.
pub(super) fn write(
    painter: &Painter,
    at: Pos2,
    anchor: Align2,
    text: &str,
    size: f32,
    colour: Color32,
    turn: f32,
) -> Rect {
    let galley = layout(painter, text, size, colour);
    let corner = anchor.pos_in_rect(&galley.rect).to_vec2();
    let shape = TextShape::new(at - Rot2::from_angle(turn) * corner, galley, colour).with_angle(turn);
    let rect = shape.visual_bounding_rect();
    painter.add(shape);
    rect
}

/// The width of `text`, points.
pub(super) fn width(painter: &Painter, text: &str, size: f32) -> f32 {
    layout(painter, text, size, Color32::WHITE).rect.width()
}

/// Sizes are whole half points, so that the atlas of glyphs stays small while things grow.
fn layout(painter: &Painter, text: &str, size: f32, colour: Color32) -> Arc<Galley> {
    let size = ((size * 2.0).round() / 2.0).max(SMALLEST);
    painter.layout_no_wrap(text.to_owned(), FontId::proportional(size), colour)
}
