//! The planet: rigid plates on a sphere that subduct, collide, spread and tear.
//!
//! After "Procedural Tectonic Planets" (Cortial, Peytavie, Galin and Guérin 2019), sections 3 and 4 and Appendix A.
//!
//! # How a step goes
//!
//! plates turn → who lies over whom ([`Planet::step`] looks through `cover`) → which side of each front is on top
//! (`borders`) → uplift, trenches, erosion, ageing (`fronts`, `wear`) → slabs pull (`fronts`) → terranes collide
//! (`collide`) → sea floor goes down, and new floor fills the gaps (`spread`) → plates tear (`rift`), and what has come
//! apart finds its place (`tidy`).
//!
//! # Where it differs from the paper
//!
//! * Nothing is remeshed or resampled as a whole. Each plate keeps its crust on the lattice's samples *in its own frame*, so
//!   that a plate that only moves keeps its crust to the bit; crust is looked up anew only where it changes its plate.
//!   Sea floor is therefore made step by step at the ridge, and goes down as soon as it lies below another plate.
//! * With the printed constants no planet comes of it; [`GlobeParams::planet`] is what does, [`GlobeParams::paper`] what was
//!   printed. Each constant of our own says so.
//! * Crust that collides keeps its volume: where continents overlap their thicknesses add.

mod borders;
mod collide;
mod cover;
mod crust;
mod distance;
mod fronts;
mod noise;
mod params;
mod planet;
mod plate;
mod random;
mod rift;
mod spread;
mod start;
mod steer;
mod terranes;
mod tidy;
mod transfer;
mod view;
mod wear;

pub use collide::{influence_km, surge_km};
pub use crust::{Crust, SampleSet};
pub use fronts::uplift_mm_per_yr;
pub use params::{GlobeParams, Reach, SeaFloor, gdh1_km};
pub use planet::{Planet, StepReport, Totals};
pub use rift::{Cut, RiftError, probability as rift_probability};
pub use start::{MAX_PLATES, Start, StartError};
pub use wear::wear;
