//! The slice: a vertical cut through the land, as geologists draw sections.
//!
//! [`Slice::cut`] reads everything from the rasters the pictures are made of, through the same
//! [`StrataMap`](crate::surface::StrataMap), so layers on cliffs and in the slice are the same layers.
//! [`Slice::figure`] lays it out as plain shapes in pixels, for any painter.

pub(crate) mod colour;
mod crust;
mod cut;
mod ends;
mod figure;
mod layout;
mod panel;
mod profile;
mod section;

pub use crust::MOHO_DEPTH;
pub use cut::{FaultCut, MAX_SAMPLES, Slice, SliceStrata};
pub use ends::{SliceError, clipped, parse_ends};
pub use figure::{Anchor, Band, Figure, FigureOptions, Label, Line, Role, Text};
