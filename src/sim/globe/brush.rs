//! Fingers that paint land and sea.

use glam::DVec3;

use super::super::TICK_US;
use super::hold::{Down, Duty};
use super::session::GlobeSim;
use crate::gesture::command::{Paint, Tool};
use crate::gesture::contact::Side;
use crate::sphere::arc;

/// Places that are painted along a finger's way are so far apart, in radii of the brush.
const STEP: f64 = 0.5;

/// Greatest radius of the brush, radians: on a globe that is seen small.
const WIDEST: f64 = 0.3;

impl GlobeSim {
    /// What a finger that lands on a side's half of the globe paints, and for whom: who stands alone at the table reaches
    /// across with the brush.
    pub(super) fn brush_at(&self, side: Side) -> Option<(Paint, Side)> {
        let state = &self.state;
        if let Some(paint) = state.tools[side as usize].paint() {
            return Some((paint, side));
        }
        let ticks = (self.params.deserted_s * 1e6 / TICK_US as f64) as u64;
        let deserted = state.stirred[side as usize].is_none_or(|tick| state.tick - tick > ticks);
        let other = side.opposite();
        let borrowed = state.tools[other as usize].paint();
        borrowed
            .filter(|_| deserted && state.tools[side as usize] == Tool::Push)
            .map(|paint| (paint, other))
    }

    /// Paints where fingers with brushes have gone since the last tick.
    pub(super) fn paint(&mut self, down: &[Down]) {
        for hand in down {
            let Duty::Paint(paint, side) = hand.duty else {
                continue;
            };
            for &(stroke, mm) in &hand.fingers {
                let Some(to) = self.state.view.cast(mm) else {
                    // Beyond the limb; where it comes back a new way begins.
                    self.state.brushes.remove(&stroke);
                    continue;
                };
                let from = self.state.brushes.insert(stroke, to);
                if from == Some(to) {
                    continue;
                }
                // All that a hand paints is undone as one.
                if self.state.remembered.insert(hand.hand) {
                    self.remember(side);
                    self.state.counts.painted += 1;
                }
                let radius = (self.params.brush_mm / self.state.view.radius_mm()).min(WIDEST);
                let from = from.unwrap_or(to);
                let pieces = (arc(from, to) / (STEP * radius)).ceil().max(1.0);
                for piece in 1..=pieces as u32 {
                    let at = from.lerp(to, f64::from(piece) / pieces).normalize_or(to);
                    self.paint_shown(at, radius, paint);
                }
            }
        }
        let duties = &self.state.duties;
        self.state.brushes.retain(|stroke, _| duties.contains_key(stroke));
    }

    /// Paints where the plates are shown at this moment.
    fn paint_shown(&mut self, at: DVec3, radius: f64, paint: Paint) {
        let plate = self.plate_shown_at(at);
        let planet = &self.state.planet;
        let step = planet.plate_state(plate).zip(self.shown_rotation(plate));
        let at = step.map_or(at, |((rotation, ..), shown)| rotation * (shown.inverse() * at));
        self.state
            .planet_mut()
            .paint(at, radius, paint == Paint::Continent);
    }
}
