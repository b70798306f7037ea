//! Places where contacts come and go faster than a finger can: palms, on devices that tell no size.
//!
//! A palm that rests is lost and found again and again, and moves little (Schwarz et al. 2014). A finger that drums
//! comes eight times a second at best and stays away for longer than a flicker; so a place where contacts that were
//! no more than taps follow each other within a flicker, several times within the time of a tap, is no finger's.

use glam::DVec2;

use super::params::{GestureParams, micros};

/// Most places that are watched; the oldest are forgotten first.
const MOST_SPOTS: usize = 64;

/// A place where a contact lifted that was no more than a tap.
#[derive(Clone, Debug)]
struct Spot {
    at: DVec2,
    lifted_us: u64,
    /// When contacts landed here within a flicker, µs: the latest ones.
    flickers_us: Vec<u64>,
    palm: bool,
}

/// The places that are watched.
#[derive(Clone, Debug, Default)]
pub(super) struct Spots(Vec<Spot>);

impl Spots {
    /// A contact that was no more than a tap lifts.
    pub(super) fn lift(&mut self, params: &GestureParams, t_us: u64, at: DVec2) {
        self.forget(params, t_us);
        if let Some(spot) = self.nearest(params, at) {
            (spot.at, spot.lifted_us) = (at, t_us);
            return;
        }
        if self.0.len() == MOST_SPOTS {
            self.0.remove(0);
        }
        self.0.push(Spot {
            at,
            lifted_us: t_us,
            flickers_us: Vec::new(),
            palm: false,
        });
    }

    /// A contact that acts on nothing lifts: what is a palm's place stays one.
    pub(super) fn keep(&mut self, params: &GestureParams, t_us: u64, at: DVec2) {
        self.forget(params, t_us);
        if let Some(spot) = self.nearest(params, at).filter(|spot| spot.palm) {
            (spot.at, spot.lifted_us) = (at, t_us);
        }
    }

    /// A contact lands; true if only a palm can have.
    pub(super) fn is_palm(&mut self, params: &GestureParams, t_us: u64, at: DVec2) -> bool {
        self.forget(params, t_us);
        let Some(spot) = self.nearest(params, at) else {
            return false;
        };
        if t_us.saturating_sub(spot.lifted_us) <= micros(params.bridge_ms) {
            let since_us = t_us.saturating_sub(micros(params.rest_ms));
            spot.flickers_us.retain(|flicker_us| *flicker_us >= since_us);
            spot.flickers_us.push(t_us);
            spot.palm |= spot.flickers_us.len() as f64 >= params.palm_flickers;
        }
        spot.palm
    }

    /// The place around `at`: of several the nearest one, the older of two.
    fn nearest(&mut self, params: &GestureParams, at: DVec2) -> Option<&mut Spot> {
        let near = |spot: &Spot| spot.at.distance(at);
        self.0
            .iter_mut()
            .filter(|spot| near(spot) <= params.bridge_mm)
            .min_by(|a, b| near(a).total_cmp(&near(b)))
    }

    /// Forgets the places where nothing has lifted for as long as a tap lasts.
    fn forget(&mut self, params: &GestureParams, t_us: u64) {
        let since_us = t_us.saturating_sub(micros(params.rest_ms));
        self.0.retain(|spot| spot.lifted_us >= since_us);
    }
}
