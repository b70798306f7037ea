//! Figures on request: how old the land is, how fast and how far it is pushed together, and the scale of the map.
//!
//! Every figure has a place of a width that does not change with its digits, which are all equally wide.

use egui::emath::Rot2;
use egui::{Align2, Color32, Painter, Pos2, vec2};

use super::icons::{self, Figure, Glyph};
use super::lettering;
use super::palette::{AMBER, LAMP, ROOM, faded};
use super::pen::{Line, Pen, bar};
use super::sight::Sight;
use super::words;
use crate::gesture::contact::Side;
use crate::live::Clock;
use crate::picture::round_below;
use crate::units::{KM, MYR};

/// Height of the strip, mm.
const TALL: f32 = 20.0;

/// Distance from the table's edges, mm.
const MARGIN: f32 = 12.0;

/// Size of figures and of their units, mm.
const SIZES: (f32, f32) = (10.5, 7.0);

/// Smallest letters of the strip, points.
const SMALLEST: f32 = 11.0;

/// Longest scale bar, mm.
const BAR: f64 = 70.0;

/// What is shown.
#[derive(Clone, Copy, Debug)]
pub struct Readings<'a> {
    /// The clock and what goes with it.
    pub clock: &'a Clock,
    /// Factor on heights in the view.
    pub exaggeration: f64,
}

/// One figure: what it is of, its text, the widest text it can have, and its unit.
struct Cell {
    figure: Figure,
    text: String,
    widest: &'static str,
    unit: &'static str,
    /// It stands out: something is not as usual.
    lit: bool,
}

impl Readings<'_> {
    /// The figures, or only the one that must never be left out: how much heights are exaggerated.
    fn cells(&self, all: bool) -> Vec<Cell> {
        let clock = self.clock;
        let mut cells = Vec::new();
        if all {
            cells.push(Cell {
                figure: Figure::Elapsed,
                text: decimal(clock.elapsed_yr / MYR, 2),
                widest: "888.88",
                unit: words::MY,
                lit: false,
            });
            cells.push(Cell {
                figure: Figure::Convergence,
                text: decimal(clock.convergence_m_per_yr * 1e3, 0),
                widest: "888",
                unit: "mm/yr",
                lit: false,
            });
            cells.push(Cell {
                figure: Figure::Shortening,
                text: decimal(clock.shortening * 100.0, 0),
                widest: "88",
                unit: "%",
                lit: false,
            });
            let stopped = match (clock.paused, clock.at_rest) {
                (true, _) => Some(words::PAUSED),
                (false, true) => Some(words::AT_REST),
                (false, false) => None,
            };
            cells.push(Cell {
                figure: Figure::Speed,
                text: stopped.map_or_else(|| decimal(clock.pace_yr_per_s / MYR, 2), str::to_owned),
                widest: "88.88",
                unit: if stopped.is_some() { "" } else { "My/s" },
                lit: clock.paused,
            });
        }
        if (self.exaggeration - 1.0).abs() >= 0.05 {
            cells.push(Cell {
                figure: Figure::Exaggeration,
                text: format!("×{}", decimal(self.exaggeration, 1)),
                widest: "×88.8",
                unit: "",
                lit: false,
            });
        }
        cells
    }
}

/// A number with so many decimals; a dash for one that is none.
fn decimal(value: f64, decimals: usize) -> String {
    if value.is_finite() {
        // Adding zero keeps −0 from being written with a sign.
        let scale = 10.0_f64.powi(decimals as i32);
        format!("{:.decimals$}", (value * scale).round() / scale + 0.0)
    } else {
        "–".to_owned()
    }
}

/// Draws the strip of a side at the right end of its edge. `shown` (0 to 1) is its opacity: at 0 only what must be
/// told is drawn.
pub fn draw(painter: &Painter, sight: &Sight<'_>, readings: &Readings<'_>, side: Side, shown: f32) {
    let pen = Pen::new(painter, sight);
    if shown > 0.0 {
        strip(pen, &readings.cells(true), side, shown, true);
    }
    if shown < 1.0 {
        strip(pen, &readings.cells(false), side, 1.0 - shown, false);
    }
}

/// Runs from right to left, as its side sees it.
struct Strip<'a> {
    pen: Pen<'a>,
    /// Middle of the right end.
    end: Pos2,
    turn: f32,
    /// How far from the right end, points.
    used: f32,
    shown: f32,
}

impl Strip<'_> {
    fn at(&self, left: f32, down: f32) -> Pos2 {
        self.end + Rot2::from_angle(self.turn) * vec2(-left, down)
    }

    fn letters(&self, left: f32, anchor: Align2, text: &str, size: f32, colour: Color32) {
        // All sizes stand on one line.
        let base = self.size(SIZES.0) * 0.5;
        lettering::write(
            self.pen.painter,
            self.at(left, base),
            anchor,
            text,
            size,
            faded(colour, self.shown),
            self.turn,
        );
    }

    fn size(&self, mm: f32) -> f32 {
        self.pen.mm(mm).max(SMALLEST)
    }

    fn gap(&mut self, mm: f32) {
        self.used += self.pen.mm(mm);
    }

    fn cell(&mut self, cell: &Cell) {
        let (size, small) = (self.size(SIZES.0), self.size(SIZES.1));
        let colour = if cell.lit { AMBER } else { LAMP };
        let painter = self.pen.painter;
        if !cell.unit.is_empty() {
            let width = lettering::width(painter, cell.unit, small);
            self.letters(
                self.used + width,
                Align2::LEFT_BOTTOM,
                cell.unit,
                small,
                colour.gamma_multiply(0.75),
            );
            self.used += width + self.pen.mm(1.6);
        }
        let text_size = if cell.text.starts_with(char::is_alphabetic) {
            small
        } else {
            size
        };
        let width = lettering::width(painter, &cell.text, text_size);
        let widest = lettering::width(painter, cell.widest, size);
        self.letters(self.used, Align2::RIGHT_BOTTOM, &cell.text, text_size, colour);
        self.used += width.max(widest) + small * 0.95;
        let glyph = Glyph {
            pen: self.pen,
            centre: self.at(self.used, 0.0),
            half: self.size(SIZES.1) / self.pen.mm(1.0) * 0.62,
            turn: self.turn,
            colour,
            strength: 0.8 * self.shown,
        };
        icons::figure(glyph, cell.figure);
        self.used += small * 0.6;
    }

    /// A round number of kilometres, in four alternating parts.
    fn scale_bar(&mut self) {
        let km_per_mm = self.pen.sight.map().metres_per_mm() / KM;
        let km = round_below(BAR * f64::from(self.pen.scale) * km_per_mm);
        let label = format!("{km} km");
        let small = self.size(SIZES.1);
        let width = lettering::width(self.pen.painter, &label, small);
        self.letters(
            self.used + width,
            Align2::LEFT_BOTTOM,
            &label,
            small,
            LAMP.gamma_multiply(0.75),
        );
        self.used += width + self.pen.mm(3.0);
        let length = self.pen.sight.mm((km / km_per_mm) as f32);
        for part in 0..4 {
            let (right, left) = (part as f32 / 4.0 * length, (part + 1) as f32 / 4.0 * length);
            let ends = [self.at(self.used + left, 0.0), self.at(self.used + right, 0.0)];
            let strength = if part % 2 == 1 { 0.95 } else { 0.35 };
            self.pen
                .line(&ends, false, Line::solid(LAMP, strength * self.shown, 1.4));
        }
        self.used += length;
    }
}

fn strip(pen: Pen<'_>, cells: &[Cell], side: Side, shown: f32, scale: bool) {
    if cells.is_empty() {
        return;
    }
    // The corner at the right hand of whoever stands at that side.
    let size = pen.sight.map().size_mm();
    let margin = f64::from(MARGIN * pen.scale);
    let inset = f64::from((MARGIN + TALL / 2.0) * pen.scale);
    let corner = match side {
        Side::South => glam::DVec2::new(size.x - margin, size.y - inset),
        Side::North => glam::DVec2::new(margin, inset),
    };
    let Some(end) = pen.sight.of_table(corner) else {
        return;
    };
    let mut strip = Strip {
        pen,
        end,
        turn: lettering::turn(side),
        used: 0.0,
        shown,
    };
    // The bed lies under the letters, and its length is known only after them.
    let bed = pen.painter.add(egui::Shape::Noop);
    strip.gap(6.0);
    if scale {
        strip.scale_bar();
        strip.gap(9.0);
    }
    for (i, cell) in cells.iter().rev().enumerate() {
        if i > 0 {
            strip.gap(7.0);
        }
        strip.cell(cell);
    }
    strip.gap(5.0);
    let half = vec2(strip.used, strip.size(TALL)) / 2.0;
    let laid = bar(strip.at(half.x, 0.0), half, strip.turn, ROOM, 0.58 * shown);
    pen.painter.set(bed, laid);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock() -> Clock {
        Clock {
            elapsed_yr: 6.754e6,
            pace_yr_per_s: 0.5e6,
            convergence_m_per_yr: 0.0123,
            shortening: 0.354,
            ..Clock::default()
        }
    }

    fn texts(clock: &Clock, exaggeration: f64, all: bool) -> Vec<String> {
        let readings = Readings { clock, exaggeration };
        readings
            .cells(all)
            .into_iter()
            .map(|cell| format!("{} {}", cell.text, cell.unit).trim_end().to_owned())
            .collect()
    }

    #[test]
    fn figures_are_written_in_the_units_of_the_field() {
        assert_eq!(
            texts(&clock(), 1.0, true),
            ["6.75 My", "12 mm/yr", "35 %", "0.50 My/s"]
        );
        let paused = Clock {
            paused: true,
            ..clock()
        };
        assert_eq!(texts(&paused, 1.6, true)[3..], ["paused", "×1.6"]);
    }

    #[test]
    fn exaggeration_is_told_wherever_it_is_not_one_even_when_nothing_was_asked_for() {
        assert!(texts(&clock(), 1.0, false).is_empty());
        assert_eq!(texts(&clock(), 1.6, false), ["×1.6"]);
    }

    #[test]
    fn numbers_that_are_none_are_dashes_and_nought_has_no_sign() {
        assert_eq!(decimal(f64::NAN, 2), "–");
        assert_eq!(decimal(-0.001, 2), "0.00");
    }
}
