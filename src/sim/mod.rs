//! The session: owns the world, its clock and its history.
//!
//! [`Sim`] is handed input frames and ticks of 16 ms session time, never a clock. The same frames and the same
//! parameters give the same bits, for any number of threads. In each tick contacts become hand events, hand events
//! become plates, plates become uplift, and every `erosion_dt_yr` of model time the land takes a step.
//!
//! [`globe`] is the same for the planet.
//!
//! Four ways lead back in time: a contact that turns out to be a palm within the revision time is *rolled back*
//! (the ticks since are played again without it), *undo* restores what the last push of a side of the table found,
//! *scrub* looks at a snapshot of the history, and a step that yields a number that is none is *quarantined* (the land before it stays).

mod commands;
mod drive;
mod exposure;
mod folding;
pub mod globe;
mod history;
mod params;
pub mod refine;
mod resume;
mod rollback;
mod step;
mod view;
mod wear;
mod world;

pub use crate::surface::Cut;
pub use folding::{FoldingLayer, LayerSkeleton, folding_layers};
pub use params::SimParams;
pub use resume::Checkpoint;
pub use step::{Quarantine, SessionCounts, Sim, StepReport};
pub use world::{Totals, World};

/// Session time of one tick, µs.
pub const TICK_US: u64 = 16_000;
