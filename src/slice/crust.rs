//! The whole crust at true scale: how deep the root of a range reaches, and how thin what is seen of it is.

use glam::DVec2;

use super::colour::{self, INK, PAPER, mixed};
use super::figure::{Anchor, Figure, Role};
use super::panel::Panel;
use super::section::Section;
use crate::surface::FaultTrace;
use crate::units::KM;

/// Depth of the Moho under land at the sea's level where nothing weighs on the crust, metres.
pub const MOHO_DEPTH: f64 = 35.0 * KM;

/// Height of this part of the figure, pixels of a figure 1600 wide.
pub(super) const HEIGHT: f64 = 230.0;

/// Height over the panel for its heading, likewise.
const HEADING: f64 = 34.0;

/// What it shows, metres.
const CEILING: f64 = 7.0 * KM;
const FLOOR: f64 = -60.0 * KM;

/// Most of the section's width it takes.
const WIDEST: f64 = 0.55;

impl Section<'_> {
    /// Draws crust and mantle under the section, and the key beside them.
    pub(super) fn crust(&self, figure: &mut Figure) {
        let Some(strata) = &self.slice.strata else { return };
        let length = self.slice.length();
        let room = (HEIGHT - HEADING) * self.unit;
        let scale = (room / (CEILING - FLOOR)).min(WIDEST * self.panel.width / length);
        let panel = Panel {
            left: self.panel.left,
            top: figure.size.y - (HEIGHT - HEADING) * self.unit - 22.0 * self.unit,
            width: length * scale,
            height: (CEILING - FLOOR) * scale,
            ceiling: CEILING,
            floor: FLOOR,
            exaggeration: 1.0,
            scale,
        };
        let distance = &self.profile.distance;
        let level = |height: f64| vec![height; distance.len()];
        let limited = |heights: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
            heights.map(|h| h.clamp(FLOOR, CEILING)).collect()
        };
        let ground = limited(&mut self.profile.ground.iter().copied());
        let moho = limited(&mut self.profile.root.iter().map(|root| -MOHO_DEPTH - root));
        let pile = &strata.stratigraphy;
        let last = pile.layers().len();
        let buried = |k: usize| {
            let heights = self.profile.interfaces[k].iter().zip(&self.profile.bedrock);
            limited(&mut heights.map(|(h, rock)| h.min(*rock)))
        };
        for layer in 0..=last {
            let upper = if layer == 0 { ground.clone() } else { buried(layer) };
            let lower = if layer < last {
                buried(layer + 1)
            } else {
                moho.clone()
            };
            let chart = pile.rock(layer).colour;
            let colour = if layer < last {
                colour::printed(chart)
            } else {
                colour::deep(chart)
            };
            let look = (Role::Deep, colour);
            figure.bands.extend(panel.bands(distance, (&upper, &lower), look));
        }
        let look = (Role::Deep, colour::MANTLE);
        figure
            .bands
            .extend(panel.bands(distance, (&moho, &level(FLOOR)), look));

        let points = |heights: &[f64]| {
            distance
                .iter()
                .zip(heights)
                .map(|(&d, &h)| panel.at((d, h)))
                .collect()
        };
        let undisturbed = level(-MOHO_DEPTH);
        for (heights, look) in [
            (
                &undisturbed,
                (mixed(colour::MANTLE, INK, 0.5), 0.8, Some([4.0, 4.0])),
            ),
            (&moho, (INK, 1.6, None)),
            (&ground, (INK, 0.9, None)),
        ] {
            self.line(figure, points(heights), look);
        }
        self.deep_words(&panel, &moho, figure);
        self.deep_key(&panel, &moho, figure);
    }

    /// Heading, depths and the names of crust, Moho and mantle.
    fn deep_words(&self, panel: &Panel, moho: &[f64], figure: &mut Figure) {
        let small = 13.5;
        let quiet = mixed(PAPER, INK, 0.8);
        let at = DVec2::new(panel.left, panel.top - 8.0 * self.unit);
        self.write(
            figure,
            at,
            "The whole crust, at true scale",
            (15.0, Anchor::Start, quiet),
        );
        for km in [0, 20, 40, 60] {
            let at = DVec2::new(panel.left, panel.y(-KM * f64::from(km)));
            let tick = vec![at, at - DVec2::new(5.0 * self.unit, 0.0)];
            self.line(figure, tick, (INK, 0.8, None));
            let word = match km {
                0 => "0".to_owned(),
                60 => "−60 km".to_owned(),
                km => format!("−{km}"),
            };
            let at = at + DVec2::new(-10.0, 4.5) * self.unit;
            self.write(figure, at, &word, (small, Anchor::End, INK));
        }
        let left = panel.right() + 10.0 * self.unit;
        let end = moho[moho.len() - 1];
        for (height, word) in [(0.55 * end, "Crust"), (end, "Moho"), (end - 13.0 * KM, "Mantle")] {
            let at = DVec2::new(left, panel.y(height) + 4.5 * self.unit);
            self.write(figure, at, word, (small, Anchor::Start, INK));
        }
    }

    /// What colours and lines mean that are no layers.
    fn deep_key(&self, panel: &Panel, moho: &[f64], figure: &mut Figure) {
        // Beside the names of crust and mantle, and beside the heading where the section is narrow.
        let left = panel.left + (panel.width + 110.0 * self.unit).max(250.0 * self.unit);
        let row = 25.0 * self.unit;
        let mut y = panel.top + 8.0 * self.unit;
        let shows = |role: Role| figure.bands.iter().any(|band| band.role == role);
        let mut boxes = Vec::new();
        let eroded = figure
            .bands
            .iter()
            .filter(|band| matches!(band.role, Role::Eroded(_)));
        if let Some(most) = eroded.max_by(|a, b| a.area().total_cmp(&b.area())) {
            let words = format!(
                "Eroded: {:.0} km² of this section",
                self.eroded_area() / (KM * KM)
            );
            boxes.push((most.colour, words));
        }
        if shows(Role::Sediment) {
            boxes.push((colour::SEDIMENT, "Loose sediment".to_owned()));
        }
        if shows(Role::Water) {
            boxes.push((colour::WATER, "Lake".to_owned()));
        }
        for (colour, words) in boxes {
            self.key(left, y, colour, &words, figure);
            y += row;
        }
        let words = |x: f64| left + x * self.unit;
        if !self.slice.faults.is_empty() {
            let sample = vec![DVec2::new(left, y), DVec2::new(words(24.0), y)];
            self.line(figure, sample, (colour::FAULT, 2.4, None));
            let text = format!("Fault, dips {:.0}° under the range", FaultTrace::DIP_DEG);
            let at = DVec2::new(words(33.0), y + 5.0 * self.unit);
            self.write(figure, at, &text, (15.0, Anchor::Start, INK));
            y += row;
        }
        let deepest = moho.iter().copied().fold(0.0, f64::min);
        let sample = vec![DVec2::new(left, y), DVec2::new(words(24.0), y)];
        self.line(figure, sample, (INK, 1.6, None));
        let text = format!(
            "Moho, deepest at {:.1} km; {:.0} km where nothing weighs on it",
            -deepest / KM,
            MOHO_DEPTH / KM
        );
        let at = DVec2::new(words(33.0), y + 5.0 * self.unit);
        self.write(figure, at, &text, (15.0, Anchor::Start, INK));
    }

    /// Area between the first surface and the ground, m².
    fn eroded_area(&self) -> f64 {
        let Some(top) = self.profile.interfaces.first() else {
            return 0.0;
        };
        let over: Vec<f64> = top
            .iter()
            .zip(&self.profile.ground)
            .map(|(top, ground)| (top - ground).max(0.0))
            .collect();
        self.profile
            .distance
            .windows(2)
            .zip(over.windows(2))
            .map(|(x, over)| (x[1] - x[0]) * f64::midpoint(over[0], over[1]))
            .sum()
    }
}
