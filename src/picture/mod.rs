//! From the surface to pictures.

mod style;

pub use style::MapStyle;

use crate::surface::Surface;

/// The land as an atlas would print it.
pub fn relief_map(surface: &Surface, style: &MapStyle, width: u32, height: u32) -> image::RgbaImage {
    let _ = (surface, style);
    image::RgbaImage::new(width, height)
}
