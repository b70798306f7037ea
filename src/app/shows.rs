//! The show of the world that is shown.

use glam::DVec2;

use super::worlds::Worlds;
use crate::gesture::contact::InputFrame;
use crate::kiosk::{Orbit, Show, ShowStep};

/// The mountain's show and the planet's; at most one of them plays.
pub(super) struct Shows {
    show: Show,
    orbit: Orbit,
}

impl Shows {
    pub(super) fn new(size_mm: DVec2) -> Self {
        Self {
            show: Show::new(size_mm),
            orbit: Orbit::default(),
        }
    }

    /// True between start and stop.
    pub(super) fn playing(&self) -> bool {
        self.show.playing() || self.orbit.playing()
    }

    /// The show of the world that is shown begins.
    pub(super) fn start(&mut self, worlds: &Worlds) {
        if worlds.globe().is_some() {
            self.orbit.start();
        } else {
            self.show.start();
        }
    }

    /// What happens up to `now_us`.
    pub(super) fn advance(&mut self, now_us: u64, worlds: &Worlds) -> ShowStep {
        match worlds.globe() {
            Some(globe) => self.orbit.advance(now_us, &globe.view),
            None => self.show.advance(now_us),
        }
    }

    /// It ends: the frame that withdraws its contacts, if any are down.
    pub(super) fn stop(&mut self, now_us: u64) -> Option<InputFrame> {
        let orbit = self.orbit.stop(now_us);
        self.show.stop(now_us).or(orbit)
    }
}
