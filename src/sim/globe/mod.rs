//! The session on the globe: the sibling of [`Sim`](super::Sim), with a planet in place of the land.
//!
//! [`GlobeSim`] is handed the same input frames and ticks of 16 ms session time, and never a clock. The same frames and the
//! same parameters give the same bits, for any number of threads.
//!
//! * A hand that lands on the globe takes hold of the plate below it. Where each finger touched is a place of that plate;
//!   the plate turns about the Euler pole that brings these places to the fingers best, no faster than plates move, so
//!   that it follows on a tether ([`GlobeSim::tethers`]).
//! * A hand that rests holds its plate where it is. Two hands on one plate that go apart tear it between them.
//! * A hand that lifts lets its plate go: at once if it rested, else when the plate has come to where it was led, or after
//!   [`GlobeSimParams::carry_my`]. Then it has its own motion again.
//! * A hand that lands beside the globe, or on a side whose tool is the view, turns the globe; two of them zoom.
//! * On a side whose tool is a brush, fingers paint land or sea where they go.
//! * A tap marks the place and the plate for a while ([`GlobeSim::taps`]).
//!
//! The planet takes steps of a fixed model time. In between, eyes are shown its plates carried on by
//! [`GlobeSim::pending_my`] ([`GlobeSim::surface`]), and hands take hold of what eyes are shown.

mod brush;
mod commands;
mod hold;
mod params;
mod session;
mod turn;
mod view;

pub use hold::Grasp;
pub use params::GlobeSimParams;
pub use session::{GlobeCounts, GlobeSim, GlobeTick};
pub use view::{Tap, Tether};

use crate::globe::Start;

/// Samples of a planet that is sculpted live.
pub const LIVE_SAMPLES: usize = 60_000;

/// The planet that one begins with where nothing else is asked for: 40 plates, 30 % continental crust.
pub fn default_start(seed: u64) -> Start {
    Start::Random {
        plates: 40,
        continental: 0.3,
        seed,
    }
}
