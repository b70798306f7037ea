//! Plates, arrows and faults, in a cartographer's ink.
//!
//! Two inks that stay apart for every kind of colour vision (Okabe & Ito 2008): vermilion for what moves, blue-black
//! for what stands. Each line lies on a pale halo, so that it reads on dark slopes and on snow.

use ab_glyph::FontRef;
use glam::DVec2;
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::MapFrame;
use super::lettering::{self, Letters};
use crate::slice::colour::INK;
use crate::surface::{FaultTrace, PlateMark, PlateState, Surface};

const VERMILION: [u8; 3] = [176, 62, 22];
const BLUE_BLACK: [u8; 3] = [34, 44, 58];
const PAPER: [u8; 3] = [250, 246, 236];

/// Draws on the land's own pixels.
pub(super) fn draw_marks(pixmap: &mut Pixmap, surface: &Surface, frame: MapFrame) {
    draw_faults(pixmap, surface, frame);
    let mut pen = Pen { pixmap, frame };
    for plate in &surface.plates {
        pen.plate(plate);
    }
}

/// Draws faults alone.
pub(super) fn draw_faults(pixmap: &mut Pixmap, surface: &Surface, frame: MapFrame) {
    let mut pen = Pen { pixmap, frame };
    for fault in &surface.faults {
        pen.fault(fault);
    }
}

/// Draws a piece of fault on a sheet as the map of `frame` has them, from `from` to the right.
pub(super) fn draw_fault_sample(sheet: &mut Pixmap, from: DVec2, length: f64, frame: MapFrame) {
    let mut pen = Pen { pixmap: sheet, frame };
    pen.toothed(&[from, from + DVec2::new(length, 0.0)], true);
}

/// Draws the lines of slices, each with its letter at both ends.
pub(super) fn draw_cuts(pixmap: &mut Pixmap, cuts: &[[DVec2; 2]], frame: MapFrame) {
    let font = lettering::font();
    for (cut, letter) in cuts.iter().zip('A'..='Z') {
        let mut pen = Pen { pixmap, frame };
        let ends = cut.map(|end| pen.to_map(end));
        pen.cut(ends);
        if let Some(font) = &font {
            pen.end(font, ends[0], &letter.to_string());
            pen.end(font, ends[1], &format!("{letter}'"));
        }
    }
}

struct Pen<'a> {
    pixmap: &'a mut Pixmap,
    frame: MapFrame,
}

impl Pen<'_> {
    fn to_map(&self, plan: DVec2) -> DVec2 {
        self.frame.to_pixel(plan) - DVec2::new(f64::from(self.frame.left), f64::from(self.frame.top))
    }

    fn plate(&mut self, plate: &PlateMark) {
        let spent = plate.spent.clamp(0.0, 1.0) as f32;
        let (colour, strength) = match plate.state {
            PlateState::Resting => (BLUE_BLACK, 0.80),
            PlateState::Pushing => (VERMILION, 0.95 - 0.45 * spent),
            PlateState::Standing => (BLUE_BLACK, 0.38),
        };
        let hull: Vec<DVec2> = plate.hull.iter().map(|&p| self.to_map(p)).collect();
        if let Some(outline) = polyline(&hull, true) {
            let dash = match plate.state {
                PlateState::Resting => {
                    StrokeDash::new(vec![7.0 * self.frame.scale(), 4.5 * self.frame.scale()], 0.0)
                }
                PlateState::Pushing | PlateState::Standing => None,
            };
            self.stroke(&outline, colour, 0.75 * strength, 1.1, dash);
        }
        for &(from, to) in &plate.arrows {
            self.arrow(self.to_map(from), self.to_map(to), colour, strength);
            if let Some(cap) = plate.cap {
                self.cap(self.to_map(from), self.to_map(to), cap, colour, strength);
            }
        }
    }

    /// A slender arrow that swells towards its head; only a dot where nothing moved.
    fn arrow(&mut self, from: DVec2, to: DVec2, colour: [u8; 3], strength: f32) {
        let scale = f64::from(self.frame.scale());
        let mut dot = PathBuilder::new();
        dot.push_circle(from.x as f32, from.y as f32, 2.6 * self.frame.scale());
        if let Some(dot) = dot.finish() {
            self.fill(&dot, colour, strength);
        }
        let length = from.distance(to);
        if length.is_nan() || length < 3.0 * scale {
            return;
        }
        let along = (to - from) / length;
        let aside = along.perp();
        let head = (13.0 * scale).min(0.6 * length);
        let neck = to - along * head * 0.82;
        let outline = [
            from + aside * 0.5 * scale,
            neck + aside * 1.4 * scale,
            to - along * head + aside * head * 0.34,
            to,
            to - along * head - aside * head * 0.34,
            neck - aside * 1.4 * scale,
            from - aside * 0.5 * scale,
        ];
        if let Some(path) = polyline(&outline, true) {
            self.stroke(&path, PAPER, 0.35 * strength, 2.2, None);
            self.fill(&path, colour, strength);
        }
    }

    /// A bar across the arrow where the motion was capped.
    fn cap(&mut self, from: DVec2, to: DVec2, part: f64, colour: [u8; 3], strength: f32) {
        let at = from.lerp(to, part.clamp(0.0, 1.0));
        let aside = (to - from).normalize_or_zero().perp() * 8.0 * f64::from(self.frame.scale());
        if let Some(bar) = polyline(&[at - aside, at + aside], false) {
            self.stroke(&bar, colour, strength, 2.0, None);
        }
    }

    /// The dashed line of a slice.
    fn cut(&mut self, ends: [DVec2; 2]) {
        if let Some(line) = polyline(&ends, false) {
            let scale = self.frame.scale();
            let dash = StrokeDash::new(vec![12.0 * scale, 5.0 * scale], 0.0);
            self.stroke(&line, INK, 0.95, 1.5, dash);
        }
    }

    /// A letter on a disc of paper, moved inside where it would hang over the edge.
    fn end(&mut self, font: &FontRef<'_>, at: DVec2, name: &str) {
        let scale = self.frame.scale();
        let radius = 14.0 * f64::from(scale);
        let room = DVec2::new(f64::from(self.frame.width), f64::from(self.frame.height)) - radius;
        let at = at.max(DVec2::splat(radius)).min(room.max(DVec2::splat(radius)));
        let mut disc = PathBuilder::new();
        disc.push_circle(at.x as f32, at.y as f32, radius as f32);
        if let Some(disc) = disc.finish() {
            self.fill(&disc, PAPER, 0.92);
            self.stroke(&disc, INK, 0.8, 0.9, None);
        }
        let letters = Letters {
            font,
            size: 20.0 * scale,
            colour: INK,
            strength: 1.0,
        };
        let left = at.x as f32 - 0.5 * letters.width(name);
        letters.write(self.pixmap, name, left, at.y as f32 + 6.5 * scale);
    }

    /// The trace with triangular teeth on the side of the hanging wall.
    fn fault(&mut self, fault: &FaultTrace) {
        let line: Vec<DVec2> = fault.points.iter().map(|&p| self.to_map(p)).collect();
        self.toothed(&line, fault.range_on_left);
    }

    /// A line with teeth on one side.
    fn toothed(&mut self, line: &[DVec2], on_left: bool) {
        let Some(trace) = polyline(line, false) else {
            return;
        };
        self.stroke(&trace, BLUE_BLACK, 0.80, 1.5, None);
        // Seen along the line, left is to the north of a line to the east: up, −y in pixels.
        let side = if on_left { -1.0 } else { 1.0 };
        let scale = f64::from(self.frame.scale());
        let (every, base, tall) = (26.0 * scale, 9.0 * scale, 7.5 * scale);
        let mut teeth = PathBuilder::new();
        let mut next = every * 0.5;
        for pair in line.windows(2) {
            let length = pair[0].distance(pair[1]);
            let along = (pair[1] - pair[0]).normalize_or_zero();
            while next <= length {
                let foot = pair[0] + along * next;
                let corners = [
                    foot - along * base * 0.5,
                    foot + along * base * 0.5,
                    foot + along.perp() * side * tall,
                ];
                push(&mut teeth, &corners, true);
                next += every;
            }
            next -= length;
        }
        if let Some(teeth) = teeth.finish() {
            self.fill(&teeth, BLUE_BLACK, 0.80);
        }
    }

    /// A line of `width` (pixels of a map 1000 pixels high) on its halo.
    fn stroke(&mut self, path: &Path, colour: [u8; 3], strength: f32, width: f32, dash: Option<StrokeDash>) {
        let scale = self.frame.scale();
        for (colour, strength, width, dash) in [
            (PAPER, 0.30 * strength, width + 2.0, None),
            (colour, strength, width, dash),
        ] {
            let stroke = Stroke {
                width: width * scale,
                line_cap: LineCap::Round,
                line_join: LineJoin::Round,
                dash,
                ..Stroke::default()
            };
            self.pixmap.stroke_path(
                path,
                &paint(colour, strength),
                &stroke,
                Transform::identity(),
                None,
            );
        }
    }

    fn fill(&mut self, path: &Path, colour: [u8; 3], strength: f32) {
        self.pixmap.fill_path(
            path,
            &paint(colour, strength),
            FillRule::Winding,
            Transform::identity(),
            None,
        );
    }
}

fn paint(colour: [u8; 3], strength: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    let [red, green, blue] = colour;
    paint.set_color_rgba8(red, green, blue, (strength.clamp(0.0, 1.0) * 255.0).round() as u8);
    paint
}

/// A path through points; `None` where there are fewer than two, or one is not a place.
fn polyline(points: &[DVec2], closed: bool) -> Option<Path> {
    if points.len() < 2 || points.iter().any(|p| !p.is_finite()) {
        return None;
    }
    let mut path = PathBuilder::new();
    push(&mut path, points, closed);
    path.finish()
}

fn push(path: &mut PathBuilder, points: &[DVec2], closed: bool) {
    for (i, p) in points.iter().enumerate() {
        if i == 0 {
            path.move_to(p.x as f32, p.y as f32);
        } else {
            path.line_to(p.x as f32, p.y as f32);
        }
    }
    if closed {
        path.close();
    }
}
