//! The whole figure: heading, section, axes, names, the crust, the key.

use glam::DVec2;

use super::colour::{self, INK, PAPER, mixed};
use super::crust;
use super::cut::Slice;
use super::figure::{Anchor, Figure, FigureOptions, Text};
use super::panel::Panel;
use super::profile::Profile;
use super::section::{Section, swatch};
use crate::rock::Colour;
use crate::units::{KM, MYR};

/// Width of letters as a part of their size, about: where words end is only needed to keep them apart.
const LETTER: f64 = 0.5;

/// Margins of a figure 1600 wide, pixels.
mod margin {
    pub(super) const LEFT: f64 = 104.0;
    pub(super) const RIGHT: f64 = 40.0;
    /// For the names of layers.
    pub(super) const NAMES: f64 = 270.0;
    pub(super) const TOP: f64 = 118.0;
    /// For the kilometres under the section.
    pub(super) const AXIS: f64 = 46.0;
    pub(super) const BOTTOM: f64 = 22.0;
}

impl Slice {
    /// Lays the slice out within `size` pixels. The figure is as wide as asked, and as high as it needs.
    pub fn figure(&self, size: DVec2, options: &FigureOptions) -> Figure {
        let size = DVec2::new(size.x.clamp(64.0, 32_768.0), size.y.clamp(64.0, 32_768.0));
        let unit = (size.x / 1600.0).min(size.y / 720.0);
        let deep = options.crust && self.strata.is_some();
        let names = options.names && self.strata.is_some();
        let right = if names { margin::NAMES } else { margin::RIGHT };
        let foot = margin::AXIS + margin::BOTTOM + if deep { crust::HEIGHT } else { 0.0 };
        let corner = DVec2::new(margin::LEFT, margin::TOP) * unit;
        let room = size - corner - DVec2::new(right, foot) * unit;
        let profile = Profile::new(self);
        let panel = Panel::new(
            &profile,
            corner,
            room.max(DVec2::splat(24.0)),
            options.depth,
            options.exaggeration,
        );
        let mut figure = Figure {
            size: DVec2::new(size.x, (panel.bottom() + foot * unit).min(size.y).round()),
            paper: PAPER,
            bands: Vec::new(),
            lines: Vec::new(),
            texts: Vec::new(),
        };
        let section = Section {
            slice: self,
            profile,
            panel,
            unit,
        };
        section.draw(&mut figure);
        if options.heading {
            section.heading(options, &mut figure);
        }
        section.ends(options, &mut figure);
        section.axes(&mut figure);
        section.labels(options, &mut figure);
        if names {
            section.names(&mut figure);
        }
        if deep {
            section.crust(&mut figure);
        }
        figure
    }

    /// Which way the line leads from its first to its second end, in words of the compass.
    fn compass(&self) -> [&'static str; 2] {
        const WINDS: [&str; 8] = ["E", "NE", "N", "NW", "W", "SW", "S", "SE"];
        let way = self.ends[1] - self.ends[0];
        let eighth = (way.y.atan2(way.x) / std::f64::consts::FRAC_PI_4).round() as i32;
        let wind = |turned: i32| WINDS[(eighth + turned).rem_euclid(8) as usize];
        [wind(4), wind(0)]
    }
}

impl Section<'_> {
    /// Title and facts.
    fn heading(&self, options: &FigureOptions, figure: &mut Figure) {
        let left = self.panel.left;
        if !options.title.is_empty() {
            let at = DVec2::new(left, 40.0 * self.unit);
            self.write(figure, at, &options.title, (25.0, Anchor::Start, INK));
        }
        let letter = options.letter;
        let [from, to] = self.slice.compass();
        let exaggeration = if self.panel.exaggeration == 1.0 {
            "true scale".to_owned()
        } else {
            format!("heights × {}", (self.panel.exaggeration * 100.0).round() / 100.0)
        };
        let facts = format!(
            "Slice {letter}–{letter}' from {from} to {to}   ·   {:.1} km   ·   {:.2} My   ·   {exaggeration}",
            self.slice.length() / KM,
            self.slice.elapsed_yr / MYR,
        );
        let at = DVec2::new(left, 66.0 * self.unit);
        let quiet = mixed(PAPER, INK, 0.8);
        self.write(figure, at, &facts, (16.0, Anchor::Start, quiet));
    }

    /// The names of the ends, over them.
    fn ends(&self, options: &FigureOptions, figure: &mut Figure) {
        let letter = options.letter;
        let [from, to] = self.slice.compass();
        let left = self.panel.left;
        let y = self.panel.top - 12.0 * self.unit;
        for (x, anchor, name) in [
            (left, Anchor::Start, format!("{letter}   {from}")),
            (self.panel.right(), Anchor::End, format!("{to}   {letter}'")),
        ] {
            self.write(figure, DVec2::new(x, y), &name, (22.0, anchor, INK));
        }
    }

    /// Kilometres along under the section, and up beside it.
    fn axes(&self, figure: &mut Figure) {
        let panel = &self.panel;
        let small = 14.5;
        let step = self.tick(panel.scale);
        let count = (self.slice.length() / KM / step).floor() as i32;
        for i in 0..=count {
            let km = step * f64::from(i);
            let at = DVec2::new(panel.x(km * KM), panel.bottom());
            let tick = vec![at, at + DVec2::new(0.0, 5.0 * self.unit)];
            self.line(figure, tick, (INK, 1.0, None));
            let unit = if i == count { " km" } else { "" };
            let at = at + DVec2::new(0.0, 21.0 * self.unit);
            self.write(figure, at, &format!("{km}{unit}"), (small, Anchor::Middle, INK));
        }
        let step = self.tick(2.0 * panel.scale * panel.exaggeration);
        let lowest = (panel.floor / KM / step).ceil() as i32;
        let highest = (panel.ceiling / KM / step).floor() as i32;
        for i in lowest..=highest {
            let km = step * f64::from(i);
            let at = DVec2::new(panel.left, panel.y(km * KM));
            let tick = vec![at, at - DVec2::new(5.0 * self.unit, 0.0)];
            self.line(figure, tick, (INK, 1.0, None));
            let at = at + DVec2::new(-10.0, 5.0) * self.unit;
            let (word, colour) = match i {
                0 => ("sea level".to_owned(), colour::SEA),
                i if i == highest => (format!("{km} km"), INK),
                _ => (format!("{km}").replace('-', "−"), INK),
            };
            self.write(figure, at, &word, (small, Anchor::End, colour));
        }
    }

    /// Words over places, each with a thin line to the ground; one row higher where they would meet.
    fn labels(&self, options: &FigureOptions, figure: &mut Figure) {
        let size = 16.0;
        let mut labels: Vec<_> = options
            .labels
            .iter()
            .filter(|label| (0.0..=self.slice.length()).contains(&label.distance))
            .collect();
        labels.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut row_ends: Vec<f64> = Vec::new();
        for label in labels {
            let x = self.panel.x(label.distance);
            let half = 0.5 * width(&label.text, size * self.unit) + 6.0 * self.unit;
            let row = row_ends
                .iter()
                .position(|&end| end < x - half)
                .unwrap_or(row_ends.len());
            if row == row_ends.len() {
                row_ends.push(0.0);
            }
            row_ends[row] = x + half;
            let ground = self
                .panel
                .y(self.panel.inside(self.slice.ground_at(label.distance)));
            let over = (8.0 + 20.0 * row as f64) * self.unit;
            let foot = DVec2::new(x, ground - 2.0 * self.unit);
            let head = DVec2::new(x, self.roof(x - half, x + half) - over);
            self.line(figure, vec![foot, head], (INK, 0.7, None));
            let at = head - DVec2::new(0.0, 4.0 * self.unit);
            self.write(figure, at, &label.text, (size, Anchor::Middle, INK));
        }
    }

    /// Row of the highest thing drawn between two columns: ground, or rock that is gone.
    fn roof(&self, left: f64, right: f64) -> f64 {
        let Profile {
            distance,
            ground,
            interfaces,
            ..
        } = &self.profile;
        let height = |i: usize| interfaces.first().map_or(ground[i], |top| top[i].max(ground[i]));
        (0..distance.len())
            .filter(|&i| (left..=right).contains(&self.panel.x(distance[i])))
            .map(|i| self.panel.y(self.panel.inside(height(i))))
            .fold(self.panel.bottom(), f64::min)
    }

    /// The pile beside the section, youngest on top, each layer led to where it ends.
    fn names(&self, figure: &mut Figure) {
        let Some(strata) = &self.slice.strata else { return };
        let pile = &strata.stratigraphy;
        let (row, left) = (25.0 * self.unit, self.panel.right() + 34.0 * self.unit);
        let layers = pile.layers().len() + 1;
        // Each name beside its layer where there is room, else as near as those above and below allow; what does not
        // reach the end stands over what does.
        let mut rows = vec![self.panel.bottom(); layers];
        for layer in (0..layers).rev() {
            let below = rows.get(layer + 1).map_or(self.panel.bottom(), |y| y - row);
            rows[layer] = self.end_of_layer(layer).unwrap_or(below);
        }
        for layer in 1..layers {
            rows[layer] = rows[layer].max(rows[layer - 1] + row);
        }
        let mut limit = self.panel.bottom() - 0.4 * row;
        for y in rows.iter_mut().rev() {
            *y = y.min(limit);
            limit = *y - row;
        }
        let quiet = mixed(PAPER, INK, 0.55);
        for (layer, &y) in rows.iter().enumerate() {
            if let Some(end) = self.end_of_layer(layer) {
                let edge = self.panel.right();
                let leader = vec![
                    DVec2::new(edge + 3.0 * self.unit, end),
                    DVec2::new(edge + 12.0 * self.unit, end),
                    DVec2::new(left - 12.0 * self.unit, y),
                    DVec2::new(left - 4.0 * self.unit, y),
                ];
                self.line(figure, leader, (quiet, 0.7, None));
            }
            let words = match pile.layers().get(layer) {
                Some(found) => format!("{}  {} m", found.name, found.thickness_m.round()),
                None => pile.basement().name.clone(),
            };
            self.key(left, y, colour::printed(pile.rock(layer).colour), &words, figure);
        }
    }

    /// A box of a colour and what it means.
    pub(super) fn key(&self, left: f64, y: f64, colour: Colour, words: &str, figure: &mut Figure) {
        let size = DVec2::new(24.0, 14.0) * self.unit;
        let corner = DVec2::new(left, y - 0.5 * size.y);
        let sample = swatch(corner, size, colour);
        let mut frame: Vec<DVec2> = sample.outline().collect();
        frame.push(corner);
        self.line(figure, frame, (mixed(PAPER, INK, 0.7), 0.7, None));
        figure.bands.push(sample);
        let at = DVec2::new(left + size.x + 9.0 * self.unit, y + 5.0 * self.unit);
        self.write(figure, at, words, (15.0, Anchor::Start, INK));
    }

    /// Writes letters of a size in pixels of a figure 1600 wide.
    pub(super) fn write(
        &self,
        figure: &mut Figure,
        at: DVec2,
        text: &str,
        (size, anchor, colour): (f64, Anchor, Colour),
    ) {
        figure.texts.push(Text {
            at,
            text: text.to_owned(),
            size: size * self.unit,
            anchor,
            colour,
        });
    }
}

/// About how wide a text is, pixels.
fn width(text: &str, size: f64) -> f64 {
    LETTER * size * text.chars().count() as f64
}
