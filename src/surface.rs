//! What a tick yields for eyes and files: plain data.

use crate::units::Extent;

/// A field on a regular grid of square cells over an [`Extent`]. Row 0 is the northernmost, values sit at cell
/// centres (pixel = area).
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The land it covers.
    pub extent: Extent,
    /// `width × height` values, row by row from north to south.
    pub data: Vec<f32>,
}
