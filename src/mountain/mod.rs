//! Plates, transport, compression, fault and uplift of the flat world, after Cordonnier et al. 2018
//! ("Sculpting Mountains", TVCG 24(5)), sections 4, 5 and 6.2.
//!
//! The way of the data: a [`PlateSet`] turns what hands do into plates; [`Tectonics::compute`] carries the crust
//! with them ([`transport`], Eq. 1–2), reads the shortening ([`compression`]), finds where ranges and rifts stand
//! ([`belt`]), and gives the rate at which the ground rises ([`uplift`]) with the traces of its faults ([`fault`]).
//! [`strata`] sums the rates up for rock layers. [`fold`] wrinkles layers under compression.
//!
//! Everything is in the plan frame: metres, x east, y north, model time in years. Fields are row by row from the
//! north. Nothing here knows the globe, a window or a graphics card, reads a clock, or draws random numbers.

pub mod belt;
pub mod body;
mod buckling;
pub mod compression;
pub mod edit;
pub mod fault;
pub mod fold;
pub mod grid;
pub mod hull;
pub mod params;
pub mod plate;
pub mod power;
pub mod residue;
pub mod stages;
pub mod strata;
pub mod tectonics;
pub mod transport;
pub mod uplift;

pub use fault::FaultTrace;
pub use grid::{Field, Grid};
pub use hull::Hull;
pub use params::{MountainParams, UpliftRule};
pub use plate::{Applied, Dome, Plate, PlateId, PlateSet, PlateState};
pub use stages::Stages;
pub use tectonics::{TectonicField, Tectonics};

/// Smooth step of order two: 0 for `t ≤ 0`, 1 for `t ≥ 1`, with vanishing first and second derivatives at both
/// ends (Perlin 2002), so that nothing multiplied by it creases.
pub(crate) fn smoother(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}
