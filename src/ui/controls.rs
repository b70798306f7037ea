//! The controls of each side: quiet discs with thin-lined icons, lit where a hand is near.

use std::f32::consts::{FRAC_PI_2, TAU};

use egui::emath::Rot2;
use egui::{Align2, Color32, Painter, Pos2, Vec2, vec2};

use super::icons::{self, Glyph};
use super::lettering;
use super::palette::{AMBER, LAMP, ROOM, between, faded};
use super::pen::{Line, Pen, bar};
use super::sight::Sight;
use super::words;
use crate::instrument::{ControlKind, ControlView};

/// Part of a disc's radius that its icon fills.
const ICON: f32 = 0.56;

/// Size of a label, mm.
const LABEL: f32 = 7.0;

/// Smallest letters of a label, points.
const SMALLEST: f32 = 11.0;

/// Glow from which a label begins to show.
const LABEL_FROM: f32 = 0.35;

/// Draws the controls, with `strength` (0 to 1) of their opacity.
pub fn draw(painter: &Painter, sight: &Sight<'_>, controls: &[ControlView], strength: f32) {
    let pen = Pen::new(painter, sight);
    for view in controls {
        if let Some(centre) = sight.of_table(view.centre_mm) {
            let control = Control::new(pen, view, centre, strength);
            // Where the slider lies behind the row, labels stand before it.
            let behind = controls
                .iter()
                .any(|other| other.side == view.side && other.kind == ControlKind::Scrub);
            if view.kind == ControlKind::Scrub {
                control.slider();
            } else {
                control.disc(behind);
            }
        }
    }
}

struct Control<'a> {
    pen: Pen<'a>,
    view: &'a ControlView,
    centre: Pos2,
    /// How near a hand is, 0 to 1.
    glow: f32,
    /// Opacity of icon and lines.
    ink: f32,
    strength: f32,
    colour: Color32,
    turn: f32,
}

impl<'a> Control<'a> {
    fn new(pen: Pen<'a>, view: &'a ControlView, centre: Pos2, strength: f32) -> Self {
        let glow = if view.pressed {
            1.0
        } else {
            view.glow.clamp(0.0, 1.0) as f32
        };
        let enabled = if view.enabled { 1.0 } else { 0.34 };
        // Only switches of which "on" is the unusual state are lit for it.
        let lit = view.on
            && matches!(
                view.kind,
                ControlKind::Tool(_) | ControlKind::Readouts | ControlKind::Final | ControlKind::FreezeSlice
            );
        let colour = if lit || view.pressed {
            AMBER
        } else {
            between(LAMP, AMBER, 0.25 * glow)
        };
        Self {
            pen,
            view,
            centre,
            glow,
            ink: strength * enabled * (0.72 + 0.28 * glow),
            strength,
            colour,
            turn: view.rotation as f32,
        }
    }

    /// Half of its size, in millimetres of the pen.
    fn half(&self) -> Vec2 {
        vec2(self.view.half_size_mm.x as f32, self.view.half_size_mm.y as f32) / self.pen.scale
    }

    fn disc(&self, label_before: bool) {
        let (pen, view) = (self.pen, self.view);
        let radius = self.half().min_elem() * if view.pressed { 0.95 } else { 1.0 };
        let enabled = if view.enabled { 1.0 } else { 0.6 };
        if view.enabled {
            let near = self.strength * self.glow * if view.pressed { 0.55 } else { 0.28 };
            pen.glow(self.centre, radius, 2.0, 12.0, faded(AMBER, near));
        }
        pen.disc(
            self.centre,
            radius,
            ROOM,
            self.strength * enabled * (0.50 + 0.22 * self.glow),
        );
        pen.ring(
            self.centre,
            radius - 0.4,
            Line::solid(self.colour, 0.62 * self.ink, 0.6 + 0.3 * self.glow),
        );
        let glyph = Glyph {
            pen,
            centre: self.centre,
            half: radius * ICON,
            turn: self.turn,
            colour: self.colour,
            strength: self.ink,
        };
        icons::control(glyph, view.kind, view.on, view.value);
        // While it is held, how long; else how much is done of what it has set off.
        let done = match view.kind {
            ControlKind::Final if view.on && view.progress <= 0.0 => view.value.max(0.01),
            _ => view.progress,
        };
        if done > 0.0 {
            let sweep = TAU * done.min(1.0) as f32;
            let line = Line::solid(AMBER, self.strength, 2.0);
            pen.arc(self.centre, radius + 2.6, self.turn - FRAC_PI_2, sweep, line);
        }
        self.label(radius, label_before);
    }

    /// A word behind the disc, or before it, as its side sees it, while a hand is near.
    fn label(&self, radius: f32, before: bool) {
        let shown = ((self.glow - LABEL_FROM) / (1.0 - LABEL_FROM)).max(0.0) * self.strength;
        if shown <= 0.0 || !self.view.enabled {
            return;
        }
        let towards = if before { 1.0 } else { -1.0 };
        let away = Rot2::from_angle(self.turn) * vec2(0.0, towards);
        let word = words::control(self.view.kind, self.view.on);
        let size = self.pen.mm(LABEL).max(SMALLEST);
        let at = self.centre + away * (self.pen.mm(radius + 0.6) + size * 0.75);
        let half = lettering::width(self.pen.painter, word, size) / 2.0;
        // A bed like a long disc, as under figures.
        let bed = vec2(half + size * 0.6, size * 0.75);
        self.pen.painter.add(bar(at, bed, self.turn, ROOM, 0.6 * shown));
        lettering::write(
            self.pen.painter,
            at,
            Align2::CENTER_CENTER,
            word,
            size,
            faded(LAMP, shown),
            self.turn,
        );
    }

    /// The land's history: a line with ticks, and a bead where the clock stands.
    fn slider(&self) {
        let (pen, view) = (self.pen, self.view);
        let half = self.half();
        let along = Rot2::from_angle(self.turn) * vec2(1.0, 0.0);
        let across = along.rot90();
        let rail = pen.mm(half.x - half.y);
        let (left, right) = (self.centre - along * rail, self.centre + along * rail);
        let bed = vec2(pen.mm(half.x), pen.mm(half.y));
        let opacity = self.strength * (0.50 + 0.22 * self.glow);
        pen.painter.add(bar(self.centre, bed, self.turn, ROOM, opacity));
        let value = if view.value.is_finite() {
            view.value.clamp(0.0, 1.0) as f32
        } else {
            0.0
        };
        let bead = left.lerp(right, value);
        for tick in 0..=20 {
            let at = left.lerp(right, tick as f32 / 20.0);
            let tall = pen.mm(if tick % 5 == 0 { 2.6 } else { 1.3 });
            let strength = self.ink * if tick as f32 / 20.0 <= value { 0.9 } else { 0.4 };
            let line = Line::solid(self.colour, strength, 0.5);
            pen.line(&[at - across * tall, at + across * tall], false, line);
        }
        pen.line(
            &[left, right],
            false,
            Line::solid(self.colour, 0.4 * self.ink, 0.6),
        );
        pen.line(&[left, bead], false, Line::solid(self.colour, self.ink, 1.2));
        let radius = 5.2 + 1.6 * self.glow;
        pen.glow(
            bead,
            radius,
            2.0,
            9.0,
            faded(AMBER, 0.5 * self.strength * self.glow),
        );
        pen.disc(bead, radius, ROOM, 0.9 * self.ink);
        pen.ring(bead, radius, Line::solid(self.colour, self.ink, 1.1));
        pen.disc(bead, 1.4, self.colour, self.ink);
    }
}
