//! Icons of controls and figures: few thin lines in a square from −1 to 1.

use std::f32::consts::PI;

use egui::emath::Rot2;
use egui::{Color32, Pos2, vec2};

use super::pen::{Line, Pen, arc};
use crate::gesture::command::Tool;
use crate::instrument::ControlKind;

/// A square in which an icon is drawn.
#[derive(Clone, Copy)]
pub(super) struct Glyph<'a> {
    pub(super) pen: Pen<'a>,
    pub(super) centre: Pos2,
    /// Half of the square's side, mm.
    pub(super) half: f32,
    /// Clockwise, radians.
    pub(super) turn: f32,
    pub(super) colour: Color32,
    pub(super) strength: f32,
}

impl Glyph<'_> {
    /// Width of its lines, mm.
    const WIDTH: f32 = 1.05;

    fn place(&self, (x, y): (f32, f32)) -> Pos2 {
        self.centre + Rot2::from_angle(self.turn) * vec2(x, y) * self.pen.mm(self.half)
    }

    fn line(&self, points: &[(f32, f32)], strength: f32) {
        let points: Vec<Pos2> = points.iter().map(|&p| self.place(p)).collect();
        let line = Line::solid(self.colour, self.strength * strength, Self::WIDTH);
        self.pen.line(&points, false, line);
    }

    fn fill(&self, corners: &[(f32, f32)], strength: f32) {
        let corners: Vec<Pos2> = corners.iter().map(|&p| self.place(p)).collect();
        self.pen.fill(&corners, self.colour, self.strength * strength);
    }

    /// A part of a circle: radians clockwise from the right.
    fn arc(&self, centre: (f32, f32), radius: f32, from: f32, sweep: f32) {
        let points = arc(
            self.place(centre),
            self.pen.mm(self.half * radius),
            self.turn + from,
            sweep,
        );
        let line = Line::solid(self.colour, self.strength, Self::WIDTH);
        self.pen.line(&points, false, line);
    }

    /// An arrow along x, from `from` to `to`.
    fn arrow(&self, from: f32, to: f32, y: f32) {
        let back = (to - from).signum() * 0.44;
        self.line(&[(from, y), (to - back * 0.6, y)], 1.0);
        self.fill(&[(to, y), (to - back, y - 0.26), (to - back, y + 0.26)], 1.0);
    }
}

/// The icon of a control; `on` and `value` as in its view.
pub(super) fn control(glyph: Glyph<'_>, kind: ControlKind, on: bool, value: f64) {
    match kind {
        ControlKind::Tool(Tool::Fold) => folds(glyph),
        ControlKind::Tool(Tool::Slice) => slice(glyph),
        ControlKind::Tool(Tool::Land) => brush(glyph, land),
        ControlKind::Tool(Tool::Sea) => brush(glyph, sea),
        ControlKind::Tool(Tool::Edit | Tool::Push | Tool::View) => edit(glyph),
        ControlKind::Undo => undo(glyph),
        ControlKind::PlayPause if on => {
            for x in [-0.42, 0.18] {
                glyph.fill(&[(x, -0.62), (x + 0.24, -0.62), (x + 0.24, 0.62), (x, 0.62)], 1.0);
            }
        }
        ControlKind::PlayPause => glyph.fill(&[(-0.42, -0.68), (0.72, 0.0), (-0.42, 0.68)], 1.0),
        ControlKind::Speed => speed(glyph, value),
        // The slider is drawn whole, elsewhere.
        ControlKind::Scrub => {}
        ControlKind::StartOver => start_over(glyph),
        ControlKind::Readouts => figures(glyph),
        ControlKind::Save => save(glyph),
        ControlKind::Final => final_land(glyph),
        ControlKind::World if on => globe(glyph),
        ControlKind::World => mountain(glyph),
        ControlKind::FreezeSlice => freeze(glyph),
        ControlKind::CloseSlice => {
            glyph.line(&[(-0.6, -0.6), (0.6, 0.6)], 1.0);
            glyph.line(&[(-0.6, 0.6), (0.6, -0.6)], 1.0);
        }
    }
}

/// An arrow whose tip has a handle.
fn edit(glyph: Glyph<'_>) {
    glyph.line(&[(-0.85, 0.62), (0.16, -0.12)], 1.0);
    glyph.fill(&[(0.22, -0.17), (-0.2, -0.08), (0.05, 0.26)], 1.0);
    glyph.arc((0.5, -0.38), 0.36, 0.0, 2.0 * PI);
}

/// A finger's brush, and below it what it paints.
fn brush(glyph: Glyph<'_>, paints: fn(&Glyph<'_>)) {
    glyph.line(&[(0.86, -0.92), (0.3, -0.3)], 1.0);
    glyph.fill(&[(0.44, -0.4), (0.2, -0.2), (-0.12, 0.14), (0.08, -0.34)], 1.0);
    paints(&glyph);
}

/// A coast.
fn land(glyph: &Glyph<'_>) {
    glyph.fill(
        &[(-0.95, 0.8), (-0.5, 0.3), (-0.2, 0.42), (0.3, 0.36), (0.95, 0.8)],
        0.85,
    );
}

/// Two waves.
fn sea(glyph: &Glyph<'_>) {
    for (y, strength) in [(0.42, 1.0), (0.78, 0.75)] {
        let wave: Vec<(f32, f32)> = (0..=24)
            .map(|i| i as f32 / 12.0 - 1.0)
            .map(|x| (0.95 * x, y - 0.13 * (x * 2.0 * PI).sin()))
            .collect();
        glyph.line(&wave, strength);
    }
}

/// Two beds in folds.
fn folds(glyph: Glyph<'_>) {
    for (y, strength) in [(-0.3, 1.0), (0.3, 0.75)] {
        let bed: Vec<(f32, f32)> = (0..=24)
            .map(|i| i as f32 / 12.0 - 1.0)
            .map(|x| (x, y - 0.34 * (x * 1.5 * PI).cos()))
            .collect();
        glyph.line(&bed, strength);
    }
}

/// A mountain that is cut open, with the finger at either end of the cut.
fn slice(glyph: Glyph<'_>) {
    glyph.line(
        &[
            (-0.62, 0.06),
            (-0.3, -0.16),
            (0.06, -0.78),
            (0.34, -0.3),
            (0.62, -0.06),
        ],
        1.0,
    );
    glyph.line(&[(-0.62, 0.06), (-0.62, 0.78), (0.62, 0.78), (0.62, -0.06)], 1.0);
    glyph.line(&[(-0.62, 0.5), (-0.1, 0.3), (0.2, 0.2), (0.62, 0.4)], 0.75);
    for x in [-1.0, 1.0] {
        glyph.fill(&[(x * 0.72, 0.78), (x, 0.6), (x, 0.96)], 1.0);
    }
}

/// A flake of snow.
fn freeze(glyph: Glyph<'_>) {
    for turn in [0.0, PI / 3.0, 2.0 * PI / 3.0] {
        let (y, x) = f32::sin_cos(turn + PI / 2.0);
        glyph.line(&[(-0.85 * x, -0.85 * y), (0.85 * x, 0.85 * y)], 1.0);
        for end in [-1.0, 1.0] {
            let knot = (0.5 * end * x, 0.5 * end * y);
            for side in [-1.0, 1.0] {
                let (dy, dx) = f32::sin_cos(turn + PI / 2.0 + side * PI / 4.0);
                glyph.line(&[knot, (knot.0 + 0.3 * end * dx, knot.1 + 0.3 * end * dy)], 0.9);
            }
        }
    }
}

fn undo(glyph: Glyph<'_>) {
    glyph.arc((0.06, 0.12), 0.62, -PI * 0.82, PI * 1.46);
    glyph.fill(&[(-0.92, -0.06), (-0.34, -0.46), (-0.26, 0.2)], 1.0);
}

/// One to three chevrons.
fn speed(glyph: Glyph<'_>, value: f64) {
    for i in 0..3 {
        let x = 0.56 * i as f32 - 0.86;
        let lit = value >= f64::from(i) * 0.5 - 0.25;
        glyph.line(
            &[(x, -0.55), (x + 0.5, 0.0), (x, 0.55)],
            if lit { 1.0 } else { 0.28 },
        );
    }
}

/// Round and back to flat land.
fn start_over(glyph: Glyph<'_>) {
    glyph.arc((0.0, 0.0), 0.78, -PI * 0.36, PI * 1.72);
    glyph.fill(&[(0.06, -0.78), (0.5, -1.06), (0.52, -0.48)], 1.0);
    glyph.line(&[(-0.4, 0.12), (0.4, 0.12)], 1.0);
}

/// A ruler.
fn figures(glyph: Glyph<'_>) {
    glyph.line(
        &[(-0.9, 0.4), (-0.9, -0.4), (0.9, -0.4), (0.9, 0.4), (-0.9, 0.4)],
        1.0,
    );
    for i in 1..6 {
        let x = 0.3 * i as f32 - 0.9;
        let long = if i == 3 { 0.08 } else { -0.12 };
        glyph.line(&[(x, -0.4), (x, long)], 0.9);
    }
}

/// Into a tray.
fn save(glyph: Glyph<'_>) {
    glyph.line(&[(0.0, -0.85), (0.0, 0.1)], 1.0);
    glyph.fill(&[(0.0, 0.4), (-0.28, 0.0), (0.28, 0.0)], 1.0);
    glyph.line(&[(-0.78, 0.2), (-0.78, 0.72), (0.78, 0.72), (0.78, 0.2)], 1.0);
}

/// A range, and over it the sparkle of what is finished.
fn final_land(glyph: Glyph<'_>) {
    glyph.line(
        &[
            (-0.98, 0.7),
            (-0.38, -0.34),
            (0.02, 0.3),
            (0.24, 0.04),
            (0.74, 0.7),
        ],
        1.0,
    );
    glyph.line(&[(-0.98, 0.7), (0.74, 0.7)], 0.75);
    glyph.line(&[(-0.38, -0.34), (-0.3, 0.2), (-0.48, 0.7)], 0.75);
    let star: Vec<(f32, f32)> = (0..8)
        .map(|k| (if k % 2 == 0 { 0.46 } else { 0.13 }, PI / 4.0 * k as f32))
        .map(|(reach, angle)| (0.52 + reach * angle.cos(), -0.52 + reach * angle.sin()))
        .collect();
    for k in 0..4 {
        let (tip, before, after) = (star[2 * k], star[(2 * k + 7) % 8], star[2 * k + 1]);
        glyph.fill(&[(0.52, -0.52), before, tip, after], 1.0);
    }
}

/// A ball with a meridian and the equator.
fn globe(glyph: Glyph<'_>) {
    glyph.arc((0.0, 0.0), 0.82, 0.0, 2.0 * PI);
    let oval = |wide: f32, tall: f32, from: f32| -> Vec<(f32, f32)> {
        (0..=16)
            .map(|i| from + PI * i as f32 / 16.0)
            .map(|angle| (wide * angle.cos(), tall * angle.sin()))
            .collect()
    };
    glyph.line(&oval(0.36, 0.82, PI / 2.0), 0.75);
    glyph.line(&oval(0.82, 0.30, 0.0), 0.75);
}

/// A summit before another.
fn mountain(glyph: Glyph<'_>) {
    glyph.line(
        &[(-0.92, 0.6), (-0.2, -0.72), (0.2, 0.0), (0.42, -0.3), (0.92, 0.6)],
        1.0,
    );
    glyph.line(&[(-0.92, 0.6), (0.92, 0.6)], 0.75);
}

/// What a figure is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Figure {
    Elapsed,
    Convergence,
    Shortening,
    Exaggeration,
    Speed,
}

pub(super) fn figure(glyph: Glyph<'_>, figure: Figure) {
    match figure {
        // An hourglass.
        Figure::Elapsed => {
            glyph.line(
                &[(-0.6, -0.9), (0.6, -0.9), (-0.6, 0.9), (0.6, 0.9), (-0.6, -0.9)],
                1.0,
            );
            glyph.fill(&[(0.0, 0.3), (0.42, 0.9), (-0.42, 0.9)], 0.8);
        }
        Figure::Convergence => {
            glyph.arrow(-1.15, -0.1, 0.0);
            glyph.arrow(1.15, 0.1, 0.0);
        }
        // A bed, folded between two walls.
        Figure::Shortening => {
            let bed: Vec<(f32, f32)> = (0..=20)
                .map(|i| i as f32 / 10.0 - 1.0)
                .map(|x| (x * 0.72, 0.42 * (x * 1.5 * PI).cos()))
                .collect();
            glyph.line(&bed, 1.0);
            glyph.line(&[(-1.0, -0.7), (-1.0, 0.7)], 1.0);
            glyph.line(&[(1.0, -0.7), (1.0, 0.7)], 1.0);
        }
        Figure::Exaggeration => {
            glyph.line(&[(-0.9, 0.75), (-0.1, -0.85), (0.7, 0.75)], 1.0);
            glyph.line(&[(0.95, 0.75), (0.95, -0.85)], 0.8);
            glyph.line(&[(0.78, -0.6), (0.95, -0.85), (1.12, -0.6)], 0.8);
        }
        Figure::Speed => speed(glyph, 1.0),
    }
}
