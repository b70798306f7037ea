//! The irregular network, drainage, lakes, erosion, sediment.

mod erosion;
mod lakes;
mod raster;
mod reference;
mod sediment;
mod statistics;
mod stream_power;
mod terrain_common;
mod tin;
