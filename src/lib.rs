//! Orogen: a multi-touch sculpting table. Each hand is a tectonic plate.

pub mod units;

pub mod gesture;
pub mod input;
pub mod mountain;
pub mod surface;
pub mod terrain;
