//! The land: a triangulated irregular network whose heights rise with the uplift and erode under rivers and slides.
//!
//! Everything here is written on nodes and their neighbours. [`Tin`] holds those; [`Flow`] routes water, through
//! [`Lakes`] where there are pits; [`StreamPower`] incises, [`Landslides`] slide; [`Erosion`] makes a step of all three,
//! and keeps what they take as [`Sediment`] where a [`Deposition`] law says so.
//! [`StartLand`] is the land before the first step, [`TinRaster`] turns nodes into pixels.

mod basin_graph;
mod blocks;
mod dart_board;
mod erosion;
mod flow;
mod hilbert;
mod lakes;
mod landslide;
mod params;
mod priority_flood;
mod raster;
mod resample;
mod sampling;
mod sediment;
mod shared_stream_power;
mod smooth;
mod start;
mod stream_power;
mod tin;
mod voronoi;

pub use erosion::{Erosion, Forcing, StepSums};
pub use flow::{Flow, Outlets};
pub use lakes::Lakes;
pub use landslide::Landslides;
pub use params::{Bound, Edges, ErosionParams, OutOfBounds};
pub use priority_flood::priority_flood;
pub use raster::TinRaster;
pub use resample::Resampling;
pub use sediment::{Deposition, Sediment};
pub use smooth::SmoothSheet;
pub use start::StartLand;
pub use stream_power::{Network, StreamPower};
pub use tin::{Border, Link, MAX_NODES, MIN_POISSON_NODES, NodeId, Tin, TinError};
