//! The section itself: layers, beds, water, faults, ground.

use glam::DVec2;

use super::colour::{self, FAULT, INK};
use super::cut::{FaultCut, Slice, SliceStrata};
use super::figure::{Band, Figure, Line, Role};
use super::panel::Panel;
use super::profile::{Profile, between};
use crate::rock::Colour;
use crate::units::KM;

/// Thinner beds are not drawn, pixels.
const LEAST_BED: f64 = 3.0;

/// Distance between two kilometre marks at least, pixels of a figure 1600 wide.
const TICK_ROOM: f64 = 70.0;

/// A section being drawn into a figure.
pub(super) struct Section<'a> {
    pub(super) slice: &'a Slice,
    pub(super) profile: Profile,
    pub(super) panel: Panel,
    /// Pixels per pixel of a figure 1600 wide.
    pub(super) unit: f64,
}

impl Section<'_> {
    /// Draws all that is in the panel, from the back to the front.
    pub(super) fn draw(&self, figure: &mut Figure) {
        if let Some(strata) = &self.slice.strata {
            self.eroded(strata, figure);
            self.rock(strata, figure);
        } else {
            let floor = self.level(self.panel.floor);
            let ground = (Role::Ground, colour::UNKNOWN);
            figure.bands.extend(self.panel.bands(
                &self.profile.distance,
                (&self.profile.ground, &floor),
                ground,
            ));
        }
        self.water(figure);
        self.sea(figure);
        for fault in &self.slice.faults {
            self.fault(fault, figure);
        }
        self.curve(&self.profile.ground, (None, None), (INK, 1.7, None), figure);
        self.frame(figure);
    }

    /// Heights of a curve, brought into the panel.
    fn inside(&self, heights: impl Iterator<Item = f64>) -> Vec<f64> {
        heights.map(|h| self.panel.inside(h)).collect()
    }

    /// A level line.
    fn level(&self, height: f64) -> Vec<f64> {
        vec![height; self.profile.distance.len()]
    }

    /// Interface `k` where it is in the ground, else the rock's surface.
    fn buried(&self, k: usize) -> Vec<f64> {
        let rock = self.profile.bedrock.iter();
        self.inside(
            rock.zip(&self.profile.interfaces[k])
                .map(|(rock, h)| h.min(*rock)),
        )
    }

    /// Interface `k` where it is in the air, else the ground.
    fn aloft(&self, k: usize) -> Vec<f64> {
        let ground = self.profile.ground.iter();
        self.inside(
            ground
                .zip(&self.profile.interfaces[k])
                .map(|(ground, h)| h.max(*ground)),
        )
    }

    /// What erosion has taken, pale, with the interfaces as dashes.
    fn eroded(&self, strata: &SliceStrata, figure: &mut Figure) {
        let pile = &strata.stratigraphy;
        let last = pile.layers().len();
        let ground = self.inside(self.profile.ground.iter().copied());
        for layer in 0..=last {
            let upper = self.aloft(layer);
            let lower = if layer < last {
                self.aloft(layer + 1)
            } else {
                ground.clone()
            };
            let look = (Role::Eroded(layer), colour::eroded(pile.rock(layer).colour));
            figure
                .bands
                .extend(self.panel.bands(&self.profile.distance, (&upper, &lower), look));
        }
        let clear = self.panel.metres(1.5 * self.unit);
        let over: Vec<f64> = self.profile.ground.iter().map(|g| g + clear).collect();
        let ceiling = self.level(self.panel.ceiling);
        for (k, heights) in self.profile.interfaces.iter().enumerate() {
            let colour = colour::outline(pile.rock(k.min(last)).colour, 0.45);
            let dash = Some([5.0, 3.5]);
            self.curve(
                heights,
                (Some(&over), Some(&ceiling)),
                (colour, 0.9, dash),
                figure,
            );
        }
    }

    /// The layers in the ground, their beds, and loose sediment.
    fn rock(&self, strata: &SliceStrata, figure: &mut Figure) {
        let pile = &strata.stratigraphy;
        let last = pile.layers().len();
        let floor = self.level(self.panel.floor);
        let bedrock = self.inside(self.profile.bedrock.iter().copied());
        for layer in 0..=last {
            // Above the first surface the topmost layer goes on.
            let upper = if layer == 0 {
                bedrock.clone()
            } else {
                self.buried(layer)
            };
            let lower = if layer < last {
                self.buried(layer + 1)
            } else {
                floor.clone()
            };
            let look = (Role::Rock(layer), colour::printed(pile.rock(layer).colour));
            figure
                .bands
                .extend(self.panel.bands(&self.profile.distance, (&upper, &lower), look));
        }
        let ground = self.inside(self.profile.ground.iter().copied());
        let loose = (Role::Sediment, colour::SEDIMENT);
        figure.bands.extend(
            self.panel
                .bands(&self.profile.distance, (&ground, &bedrock), loose),
        );
        for layer in 0..last {
            self.beds(strata, layer, &floor, figure);
        }
        for k in 1..=last {
            let colour = colour::outline(pile.rock(k - 1).colour, 0.75);
            let bounds = (Some(floor.as_slice()), Some(self.profile.bedrock.as_slice()));
            self.curve(&self.profile.interfaces[k], bounds, (colour, 1.0, None), figure);
        }
    }

    /// Lines between the beds of a layer, where they are wide enough apart.
    fn beds(&self, strata: &SliceStrata, layer: usize, floor: &[f64], figure: &mut Figure) {
        let beds = strata.stratigraphy.layers()[layer].beds;
        let (top, base) = (
            &self.profile.interfaces[layer],
            &self.profile.interfaces[layer + 1],
        );
        let least = self.panel.metres(LEAST_BED * self.unit.max(1.0)) * f64::from(beds);
        // Where the layer is too thin, nothing is above the bound.
        let low: Vec<f64> = top
            .iter()
            .zip(base)
            .zip(floor)
            .map(|((top, base), floor)| if top - base >= least { *floor } else { f64::MAX })
            .collect();
        let colour = colour::outline(strata.stratigraphy.rock(layer).colour, 0.38);
        for bed in 1..beds {
            let part = f64::from(bed) / f64::from(beds);
            let heights: Vec<f64> = top.iter().zip(base).map(|(t, b)| t + (b - t) * part).collect();
            let bounds = (Some(low.as_slice()), Some(self.profile.bedrock.as_slice()));
            self.curve(&heights, bounds, (colour, 0.6, None), figure);
        }
    }

    /// Lakes, up to their level.
    fn water(&self, figure: &mut Figure) {
        let distance = &self.slice.distance;
        for lake in (0..distance.len())
            .collect::<Vec<_>>()
            .chunk_by(|&a, &b| self.slice.lake[a] == self.slice.lake[b])
        {
            let (first, last) = (lake[0], lake[lake.len() - 1]);
            let Some(level) = self.slice.lake[first] else {
                continue;
            };
            // The shore lies between the last wet place and the first dry one.
            let shore = first.saturating_sub(1)..=(last + 1).min(distance.len() - 1);
            let x = &distance[shore.clone()];
            let ground = self.inside(self.slice.ground[shore].iter().copied());
            let level = self.panel.inside(level);
            let bed: Vec<f64> = ground.iter().map(|g| g.min(level)).collect();
            let look = (Role::Water, colour::WATER);
            figure
                .bands
                .extend(self.panel.bands(x, (&vec![level; x.len()], &bed), look));
        }
    }

    /// The sea's level.
    fn sea(&self, figure: &mut Figure) {
        let (a, b) = ((0.0, 0.0), (self.slice.length(), 0.0));
        if (self.panel.floor..=self.panel.ceiling).contains(&0.0) {
            let points = vec![self.panel.at(a), self.panel.at(b)];
            self.line(figure, points, (colour::SEA, 0.9, Some([9.0, 5.0])));
        }
    }

    /// A fault from its outcrop down, with half arrows that tell how its sides have moved.
    fn fault(&self, fault: &FaultCut, figure: &mut Figure) {
        let sign = if fault.range_ahead { 1.0 } else { -1.0 };
        let room = if fault.range_ahead {
            self.slice.length() - fault.distance
        } else {
            fault.distance
        };
        let reach = room.min((fault.height - self.panel.floor).max(0.0) / fault.apparent_dip.max(1e-3));
        let foot = (
            fault.distance + sign * reach,
            fault.height - reach * fault.apparent_dip,
        );
        let (top, foot) = (self.panel.at((fault.distance, fault.height)), self.panel.at(foot));
        self.line(figure, vec![top, foot], (FAULT, 2.4, None));
        let length = top.distance(foot);
        if length < 90.0 * self.unit {
            return;
        }
        let down = (foot - top) / length;
        // The range lies on the fault, so its side is the upper one in the picture.
        let up = if down.perp().y < 0.0 {
            down.perp()
        } else {
            -down.perp()
        };
        let middle = top + down * (0.5 * length).min(130.0 * self.unit);
        for (side, along) in [(up, -down), (-up, down)] {
            let beside = middle + side * 7.0 * self.unit;
            let (tail, head) = (
                beside - along * 17.0 * self.unit,
                beside + along * 17.0 * self.unit,
            );
            let barb = head - along * 9.0 * self.unit + side * 5.0 * self.unit;
            self.line(figure, vec![tail, head, barb], (FAULT, 1.6, None));
        }
    }

    /// Sides and floor of the panel, with kilometres along and up.
    fn frame(&self, figure: &mut Figure) {
        let panel = &self.panel;
        let side = |x: f64, height: f64| {
            vec![
                DVec2::new(x, panel.y(panel.inside(height))),
                DVec2::new(x, panel.bottom()),
            ]
        };
        let last = self.slice.ground.len() - 1;
        for line in [
            side(panel.left, self.slice.ground[0]),
            side(panel.right(), self.slice.ground[last]),
            vec![
                DVec2::new(panel.left, panel.bottom()),
                DVec2::new(panel.right(), panel.bottom()),
            ],
        ] {
            self.line(figure, line, (INK, 1.0, None));
        }
    }

    /// Kilometres between marks so that they have room.
    pub(super) fn tick(&self, pixels_per_metre: f64) -> f64 {
        const STEPS: [f64; 10] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];
        let enough = |step: &&f64| **step * KM * pixels_per_metre >= TICK_ROOM * self.unit;
        STEPS.iter().find(enough).copied().unwrap_or(1000.0)
    }

    /// A curve between two bounds as lines.
    fn curve(
        &self,
        heights: &[f64],
        (low, high): (Option<&[f64]>, Option<&[f64]>),
        look: (Colour, f64, Option<[f64; 2]>),
        figure: &mut Figure,
    ) {
        let floor = self.level(self.panel.floor);
        let ceiling = self.level(self.panel.ceiling);
        let pieces = between(
            &self.profile.distance,
            heights,
            low.unwrap_or(&floor),
            high.unwrap_or(&ceiling),
        );
        for piece in pieces {
            let points = piece.into_iter().map(|p| self.panel.at(p)).collect();
            self.line(figure, points, look);
        }
    }

    /// Draws a line of some colour, width and dash, both in pixels of a figure 1600 wide.
    pub(super) fn line(
        &self,
        figure: &mut Figure,
        points: Vec<DVec2>,
        (colour, width, dash): (Colour, f64, Option<[f64; 2]>),
    ) {
        figure.lines.push(Line {
            points,
            colour,
            width: width * self.unit,
            dash: dash.map(|dash| dash.map(|d| d * self.unit)),
        });
    }

    /// Middle of a layer where it is in the ground at the second end, pixels.
    pub(super) fn end_of_layer(&self, layer: usize) -> Option<f64> {
        let end = self.profile.distance.len() - 1;
        let last = self.profile.interfaces.len() - 1;
        let height = |k: usize| {
            let buried = |k: usize| self.profile.interfaces[k][end].min(self.profile.bedrock[end]);
            self.panel.inside(match k {
                0 => self.profile.bedrock[end],
                k if k > last => self.panel.floor,
                k => buried(k),
            })
        };
        let (top, base) = (self.panel.y(height(layer)), self.panel.y(height(layer + 1)));
        (base - top >= 1.0).then(|| f64::midpoint(top, base))
    }
}

/// A box of the key.
pub(super) fn swatch(corner: DVec2, size: DVec2, colour: Colour) -> Band {
    let right = DVec2::new(size.x, 0.0);
    let down = DVec2::new(0.0, size.y);
    Band {
        role: Role::Key,
        colour,
        top: vec![corner, corner + right],
        bottom: vec![corner + down, corner + right + down],
    }
}
