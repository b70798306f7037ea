//! Where heights and distances lie in a figure, and which part of them it shows.

use glam::DVec2;

use super::figure::{Band, Role};
use super::profile::Profile;
use crate::rock::Colour;
use crate::units::KM;

/// Vertical exaggerations a figure chooses from.
const EXAGGERATIONS: [f64; 5] = [1.0, 1.5, 2.0, 3.0, 5.0];

/// The least of them is chosen with which the section fills this part of the height there is.
const FULL_ENOUGH: f64 = 0.38;

/// Most height that eroded rock is shown to over the highest ground, metres.
const MOST_ERODED: f64 = 8.0 * KM;

/// Air over all that is drawn, metres.
const AIR: f64 = 400.0;

/// Least depth shown under the lowest ground, metres.
const LEAST_DEPTH: f64 = 1.5 * KM;

/// Depth shown where no layers are known, metres.
const BARE_DEPTH: f64 = 1.0 * KM;

/// Rock shown under the lowest layer, metres.
const BASEMENT: f64 = 1.5 * KM;

/// Thinner bands of eroded rock are not drawn, pixels.
const LEAST_THICKNESS: f64 = 0.7;

/// A rectangle of pixels that shows distances across and heights up.
pub(super) struct Panel {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    /// Height of its upper and lower edge, metres.
    pub(super) ceiling: f64,
    pub(super) floor: f64,
    pub(super) exaggeration: f64,
    /// Pixels per metre across; up it is this times the exaggeration.
    pub(super) scale: f64,
}

impl Panel {
    /// The panel for a profile within `room` pixels from `corner`; not deeper than `depth` metres below the sea.
    pub(super) fn new(
        profile: &Profile,
        corner: DVec2,
        room: DVec2,
        depth: f64,
        exaggeration: Option<f64>,
    ) -> Self {
        let highest = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let lowest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let length = profile.distance.last().copied().unwrap_or(1.0).max(1.0);
        let summit = highest(&profile.ground);
        let valley = lowest(&profile.ground);
        let roof = profile
            .interfaces
            .first()
            .map_or(summit, |top| highest(top).clamp(summit, summit + MOST_ERODED));
        let shallow = valley - LEAST_DEPTH;
        let mut ceiling = roof.max(0.0) + AIR;
        let mut floor = match profile.interfaces.last() {
            Some(base) => (lowest(base) - BASEMENT).min(shallow).max(-depth.abs()),
            None => (valley - BARE_DEPTH).min(0.0),
        }
        .min(shallow.max(-depth.abs()));
        let mut scale = room.x / length;
        let tall = |times: f64| (ceiling - floor) * scale * times;
        let exaggeration = exaggeration
            .filter(|e| e.is_finite() && *e > 0.0)
            .unwrap_or_else(|| {
                let mut fitting = EXAGGERATIONS.iter().copied().filter(|&e| tall(e) <= room.y);
                let full = fitting.clone().find(|&e| tall(e) >= FULL_ENOUGH * room.y);
                full.or(fitting.next_back()).unwrap_or(EXAGGERATIONS[0])
            });
        // Too tall even so: less basement, then less of what has been eroded, then a narrower section.
        let too_much = |ceiling: f64, floor: f64| (ceiling - floor) - room.y / (scale * exaggeration);
        floor += too_much(ceiling, floor).clamp(0.0, (shallow - floor).max(0.0));
        ceiling -= too_much(ceiling, floor).clamp(0.0, (roof - summit.max(0.0)).max(0.0));
        scale = scale.min(room.y / ((ceiling - floor) * exaggeration));
        Self {
            left: corner.x,
            top: corner.y,
            width: length * scale,
            height: (ceiling - floor) * scale * exaggeration,
            ceiling,
            floor,
            exaggeration,
            scale,
        }
    }

    pub(super) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Column of a distance, metres.
    pub(super) fn x(&self, distance: f64) -> f64 {
        self.left + distance * self.scale
    }

    /// Row of a height, metres.
    pub(super) fn y(&self, height: f64) -> f64 {
        self.top + (self.ceiling - height) * self.scale * self.exaggeration
    }

    /// Metres of height in a number of pixels.
    pub(super) fn metres(&self, pixels: f64) -> f64 {
        pixels / (self.scale * self.exaggeration)
    }

    pub(super) fn at(&self, (distance, height): (f64, f64)) -> DVec2 {
        DVec2::new(self.x(distance), self.y(height))
    }

    /// A height within the panel, metres.
    pub(super) fn inside(&self, height: f64) -> f64 {
        height.clamp(self.floor, self.ceiling)
    }

    /// The pieces of the area between two curves where the upper one is above the lower. Both must lie inside.
    pub(super) fn bands(
        &self,
        distance: &[f64],
        (upper, lower): (&[f64], &[f64]),
        (role, colour): (Role, Colour),
    ) -> Vec<Band> {
        let mut bands = Vec::new();
        let mut start = 0;
        while start < distance.len() {
            if upper[start] <= lower[start] {
                start += 1;
                continue;
            }
            // From the last place without thickness to the next one.
            let first = start.saturating_sub(1);
            let mut end = start;
            while end + 1 < distance.len() && upper[end] > lower[end] {
                end += 1;
            }
            let edge = |heights: &[f64]| -> Vec<DVec2> {
                (first..=end)
                    .map(|i| self.at((distance[i], heights[i])))
                    .collect()
            };
            let thin = (first..=end).all(|i| upper[i] - lower[i] < self.metres(LEAST_THICKNESS));
            if !(thin && matches!(role, Role::Eroded(_))) {
                bands.push(Band {
                    role,
                    colour,
                    top: edge(upper),
                    bottom: edge(lower),
                });
            }
            start = end + 1;
        }
        bands
    }
}
