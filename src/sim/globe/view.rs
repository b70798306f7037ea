//! What eyes and reports may ask of a session on the globe.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::super::TICK_US;
use super::GlobeSimParams;
use super::hold::Grasp;
use super::session::{GlobeCounts, GlobeSim};
use crate::gesture::contact::Side;
use crate::gesture::event::HandId;
use crate::gesture::hand::{ContactStats, HandView};
use crate::globe::{Planet, Start};
use crate::surface::planet as shown;
use crate::units::GlobeView;

/// A finger and the place that it took hold of. Places are unit vectors in the world's frame, as the surface shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tether {
    /// The hand.
    pub hand: HandId,
    /// The side of the table it belongs to.
    pub side: Side,
    /// Name of the plate.
    pub plate: u32,
    /// What the hand does with it.
    pub grasp: Grasp,
    /// Where the place is now that was below the finger when it took hold.
    pub held: DVec3,
    /// Where the finger is; of a hand that has lifted, was.
    pub finger: DVec3,
}

/// The mark of a tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Name of the plate.
    pub plate: u32,
    /// Where the place is now that was tapped.
    pub at: DVec3,
    /// How long ago, seconds of session time.
    pub age_s: f64,
}

/// A tap as it is kept.
#[derive(Clone, Copy, Debug)]
pub(super) struct TapMark {
    pub(super) plate: u32,
    /// In the plate's own frame.
    pub(super) anchor: DVec3,
    pub(super) tick: u64,
}

impl GlobeSim {
    /// The planet as its last step left it.
    pub fn planet(&self) -> &Planet {
        &self.state.planet
    }

    /// The same, shared: as cheap to keep as a pointer.
    pub fn planet_shared(&self) -> Arc<Planet> {
        Arc::clone(&self.state.planet)
    }

    /// What the planet began as.
    pub fn start(&self) -> &Start {
        &self.state.start
    }

    /// The planet at this moment, between two steps.
    pub fn surface(&self) -> shown::Planet {
        self.state.planet.surface(self.state.pending_my)
    }

    /// Model time that has passed since the planet's last step, My.
    pub fn pending_my(&self) -> f64 {
        self.state.pending_my
    }

    /// How the globe lies on the table.
    pub fn view(&self) -> GlobeView {
        self.state.view
    }

    /// The parameters.
    pub fn params(&self) -> &GlobeSimParams {
        &self.params
    }

    /// Ticks done.
    pub fn ticks(&self) -> u64 {
        self.state.tick
    }

    /// True while somebody has stopped the geological clock.
    pub fn paused(&self) -> bool {
        self.state.paused
    }

    /// Model time per second of session time while the clock runs, My.
    pub fn pace_my_per_s(&self) -> f64 {
        self.state.pace_my_per_s
    }

    /// True if `side` has something to undo.
    pub fn can_undo(&self, side: Side) -> bool {
        self.undoable(Some(side)).is_some()
    }

    /// The hands that are down, by id.
    pub fn hands(&self) -> impl Iterator<Item = HandView> {
        self.state.hands.hands()
    }

    /// What the contacts were.
    pub fn contact_stats(&self) -> ContactStats {
        self.state.hands.stats()
    }

    /// What visitors did. Motions that had to be clamped are counted by the planet ([`Planet::totals`]).
    pub fn counts(&self) -> GlobeCounts {
        self.state.counts
    }

    /// Fingers and what they hold, hand by hand, from the tick in which they land.
    pub fn tethers(&self) -> Vec<Tether> {
        let mut tethers = Vec::new();
        for (&hand, hold) in &self.state.holds {
            let Some(rotation) = self.shown_rotation(hold.plate) else {
                continue;
            };
            tethers.extend(hold.fingers.values().map(|finger| Tether {
                hand,
                side: hold.side,
                plate: hold.plate,
                grasp: hold.grasp,
                held: rotation * finger.anchor,
                finger: finger.target,
            }));
        }
        tethers
    }

    /// Marks of taps that are not yet gone, oldest first.
    pub fn taps(&self) -> Vec<Tap> {
        let taps = self.state.taps.iter();
        taps.filter_map(|tap| {
            Some(Tap {
                plate: tap.plate,
                at: self.shown_rotation(tap.plate)? * tap.anchor,
                age_s: (self.state.tick - tap.tick) as f64 * TICK_US as f64 / 1e6,
            })
        })
        .collect()
    }

    /// Name of the plate that the surface shows at a place.
    pub fn plate_shown_at(&self, place: DVec3) -> u32 {
        let planet = &self.state.planet;
        let at_step = planet.plate_at(place);
        // The plate that is there when all plates are where they are shown: it, or one that moves in.
        let back = |id| {
            let omega = planet.plate_state(id).map_or(DVec3::ZERO, |state| state.1);
            planet.plate_at(DQuat::from_scaled_axis(-omega * self.state.pending_my) * place)
        };
        let shown = back(at_step);
        if shown == at_step || back(shown) == shown {
            shown
        } else {
            at_step
        }
    }

    /// Rotation of a plate from its own frame to the world's, as the surface shows it. `None` where it is no more.
    pub(super) fn shown_rotation(&self, plate: u32) -> Option<DQuat> {
        let (rotation, omega, _) = self.state.planet.plate_state(plate)?;
        Some(DQuat::from_scaled_axis(omega * self.state.pending_my) * rotation)
    }
}
