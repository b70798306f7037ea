//! Folds on the land: their axes with the symbols of geological maps, lines that fingers draw along them, and the handle
//! that raises them.
//!
//! | mark | line |
//! |---|---|
//! | crest (anticline) | a line with pairs of arrows that point away from it |
//! | trough (syncline) | a dashed line with pairs of arrows that point towards it |
//! | a line being drawn | dashed vermilion |
//! | a line that has been drawn | thin vermilion, with a handle; the rail shows how far it goes |

use egui::{Pos2, Vec2};
use glam::DVec2;

use super::ink;
use super::palette::{BLUE_BLACK, PAPER, VERMILION};
use super::pen::{Line, Pen, aside, length};
use crate::instrument::FoldHandle;
use crate::surface::FoldLine;

/// Distance of the symbols along an axis, mm, and how long an axis must be to carry one.
const EVERY_MM: f32 = 58.0;
const LEAST_MM: f32 = 14.0;

/// Shaft and head of the arrows, mm.
const SHAFT_MM: f32 = 5.6;
const HEAD_MM: f32 = 2.6;

/// Draws axes with `strength` (0 to 1) of their opacity.
pub fn draw_axes(painter: &egui::Painter, sight: &super::Sight<'_>, folds: &[FoldLine], strength: f32) {
    let pen = Pen::new(painter, sight);
    for fold in folds {
        let solid = Line::solid(BLUE_BLACK, 0.85 * strength, 1.1);
        let line = if fold.crest {
            solid
        } else {
            Line {
                dash: Some((4.0, 2.6)),
                ..Line::solid(BLUE_BLACK, 0.6 * strength, 0.8)
            }
        };
        for axis in sight.line(&fold.points) {
            pen.ink(&axis, false, line);
            symbols(pen, &axis, fold.crest, solid);
        }
    }
}

/// Pairs of arrows across an axis, evenly along it; a short one has one pair in its middle.
fn symbols(pen: Pen<'_>, axis: &[Pos2], crest: bool, line: Line) {
    let whole = length(axis);
    if whole.is_nan() || whole < pen.mm(LEAST_MM) {
        return;
    }
    let count = (whole / pen.mm(EVERY_MM)).round().clamp(1.0, 64.0);
    let step = whole / count;
    let mut next = 0.5 * step;
    for pair in axis.windows(2) {
        let part = pair[0].distance(pair[1]);
        let along = (pair[1] - pair[0]).normalized();
        while next <= part {
            let at = pair[0] + along * next;
            for across in [aside(along), -aside(along)] {
                arrow(pen, at, across, crest, line);
            }
            next += step;
        }
        next -= part;
    }
}

/// One arrow beside an axis, away from it or towards it.
fn arrow(pen: Pen<'_>, axis: Pos2, across: Vec2, away: bool, line: Line) {
    let (near, far) = (
        axis + across * pen.mm(0.8),
        axis + across * pen.mm(SHAFT_MM + HEAD_MM),
    );
    let (tip, tail) = if away { (far, near) } else { (near, far) };
    let back = (tail - tip).normalized() * pen.mm(HEAD_MM);
    let wing = aside(back) * 0.55;
    pen.ink(&[tail, tip + back], false, Line { width: 0.9, ..line });
    pen.fill(
        &[tip, tip + back + wing, tip + back - wing],
        line.colour,
        line.strength,
    );
}

/// Draws what fingers with the fold tool do: lines that are being drawn (table mm), and handles.
pub fn draw_tool<'a>(
    painter: &egui::Painter,
    sight: &super::Sight<'_>,
    strokes: &[Vec<DVec2>],
    handles: impl Iterator<Item = FoldHandle<'a>>,
    strength: f32,
) {
    let pen = Pen::new(painter, sight);
    let plan = |line: &[DVec2]| -> Vec<DVec2> { line.iter().map(|&at| sight.map().to_plan(at)).collect() };
    for stroke in strokes {
        for stretch in sight.line(&plan(stroke)) {
            let dashed = Line {
                dash: Some((4.2, 2.6)),
                ..Line::solid(VERMILION, 0.95 * strength, 1.6)
            };
            pen.ink(&stretch, false, dashed);
        }
    }
    for handle in handles {
        for stretch in sight.line(&plan(handle.path)) {
            pen.ink(&stretch, false, Line::solid(VERMILION, 0.85 * strength, 1.2));
        }
        let places = [handle.middle, handle.lowest, handle.highest, handle.at].map(|at| sight.of_table(at));
        if let [Some(middle), Some(lowest), Some(highest), Some(at)] = places {
            rail(pen, [middle, lowest, highest], strength);
            pen.line(&[middle, at], false, Line::solid(VERMILION, 0.9 * strength, 2.2));
            pen.disc(at, 4.0, PAPER, 0.7 * strength);
            ink::handle(pen, at, if handle.held { 1.0 } else { 0.35 }, strength);
        }
    }
}

/// How far a handle goes: from flat to three times as high, in steps of one.
fn rail(pen: Pen<'_>, [middle, lowest, highest]: [Pos2; 3], strength: f32) {
    let line = Line::solid(BLUE_BLACK, 0.6 * strength, 0.7);
    pen.ink(&[lowest, highest], false, line);
    let unit = middle - lowest;
    let across = aside(unit.normalized());
    for step in 0..=3 {
        let at = lowest + unit * step as f32;
        // A flat bed at the foot, ever wider folds upwards.
        let half = across * pen.mm(2.0 + 1.1 * step as f32);
        pen.ink(&[at - half, at + half], false, line);
    }
}
