//! The land: a triangulated irregular network whose heights rise with the uplift and erode under rivers and slides.

mod raster;
mod sampling;
mod smooth;
mod tin;
mod voronoi;

pub use raster::TinRaster;
pub use tin::{Border, Link, MAX_NODES, MIN_POISSON_NODES, NodeId, Tin, TinError};
