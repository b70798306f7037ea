//! From the surface to pictures.
//!
//! [`relief_map`] draws the land as an atlas would print it, in the manner of the Swiss school (Imhof 1965): light
//! from the north-west, cool shadows, quiet greens, contrast that grows towards the summits. [`geological_map`] shows the
//! rock at the surface instead, with a key, and [`paint_figure`] a slice. Everything is computed on the CPU, row by row
//! and in parallel, and does not depend on the number of threads.

pub(crate) mod colour;
pub(crate) mod cover;
mod field;
mod figure;
mod frame;
mod geology;
mod horizon;
mod ink;
mod lettering;
pub(crate) mod light;
mod noise;
pub(crate) mod paint;
pub mod planet;
mod strata;
mod style;
pub(crate) mod water;

pub use figure::paint_figure;
pub use frame::MapFrame;
pub use geology::geological_map;
#[cfg(feature = "app")]
pub(crate) use lettering::round_below;
pub use style::MapStyle;

use image::RgbaImage;
use tiny_skia::{Pixmap, PremultipliedColorU8};

use crate::surface::Surface;

/// Largest side of a picture, pixels.
pub const MAX_SIDE: u32 = 16_384;

/// The land as an atlas would print it: opaque, north up. Sides are brought into `1..=`[`MAX_SIDE`].
///
/// The land fills the picture up to the margins for caption and scale ([`MapStyle::lettering`]), undistorted; where
/// the picture has other proportions than the land, paper remains on two sides ([`MapFrame`]).
pub fn relief_map(surface: &Surface, style: &MapStyle, width: u32, height: u32) -> RgbaImage {
    let (width, height) = (width.clamp(1, MAX_SIDE), height.clamp(1, MAX_SIDE));
    draw(surface, style, width, height)
        .and_then(|sheet| RgbaImage::from_raw(width, height, sheet.take()))
        .unwrap_or_else(|| RgbaImage::new(width, height))
}

/// `None` only for sizes a pixmap cannot have.
fn draw(surface: &Surface, style: &MapStyle, width: u32, height: u32) -> Option<Pixmap> {
    let frame = MapFrame::new(surface.height.extent, style, width, height);
    let mut land = paint::land(surface, style, frame)?;
    if style.marks {
        ink::draw_marks(&mut land, surface, frame);
    }
    ink::draw_cuts(&mut land, &style.cuts, frame);
    lettering::sheet(&land, surface, style, frame, width, height)
}

/// An opaque pixel.
fn opaque([red, green, blue]: [u8; 3]) -> PremultipliedColorU8 {
    PremultipliedColorU8::from_rgba(red, green, blue, 255).unwrap_or(PremultipliedColorU8::TRANSPARENT)
}
