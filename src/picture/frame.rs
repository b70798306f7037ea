//! Where the land lies in a picture.

use glam::DVec2;

use super::MapStyle;
use crate::units::Extent;

/// The rectangle of pixels that shows the land, north up, undistorted and centred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapFrame {
    /// Column of its first pixel.
    pub left: u32,
    /// Row of its first pixel.
    pub top: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The land it shows.
    pub extent: Extent,
}

impl MapFrame {
    /// The largest such rectangle in a picture of `width × height` pixels; inside the margins for caption and scale
    /// where the style has lettering.
    pub fn new(extent: Extent, style: &MapStyle, width: u32, height: u32) -> Self {
        let short = f64::from(width.min(height));
        let (margin, foot) = if style.lettering {
            (0.022 * short, 0.062 * short)
        } else {
            (0.0, 0.0)
        };
        let (across, down) = (f64::from(width) - 2.0 * margin, f64::from(height) - margin - foot);
        let pixels_per_metre = (across / extent.width).min(down / extent.height);
        let size =
            |metres: f64, most: u32| ((metres * pixels_per_metre).round() as u32).clamp(1, most.max(1));
        let (map_width, map_height) = (size(extent.width, width), size(extent.height, height));
        Self {
            left: (width - map_width) / 2,
            top: (margin.round() as u32 + ((down - f64::from(map_height)) / 2.0).max(0.0) as u32)
                .min(height.saturating_sub(map_height)),
            width: map_width,
            height: map_height,
            extent,
        }
    }

    /// Metres of ground per pixel.
    pub fn metres_per_pixel(&self) -> f64 {
        self.extent.width / f64::from(self.width)
    }

    /// Picture position (pixels from the top-left corner of the picture) of a plan position (metres).
    pub fn to_pixel(&self, plan: DVec2) -> DVec2 {
        DVec2::new(
            f64::from(self.left) + plan.x / self.extent.width * f64::from(self.width),
            f64::from(self.top) + (1.0 - plan.y / self.extent.height) * f64::from(self.height),
        )
    }

    /// Factor on line widths and letters: 1 where the land is 1000 pixels high.
    pub(super) fn scale(&self) -> f32 {
        (self.width.min(self.height) as f32 / 1000.0).max(0.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn north_is_up_and_the_map_stays_inside() {
        let extent = Extent {
            width: 178e3,
            height: 100e3,
        };
        for (width, height) in [(1920, 1080), (1000, 1000), (300, 1000), (64, 64), (1, 1)] {
            for lettering in [false, true] {
                let style = MapStyle {
                    lettering,
                    ..MapStyle::default()
                };
                let frame = MapFrame::new(extent, &style, width, height);
                assert!(frame.left + frame.width <= width && frame.top + frame.height <= height);
                let north_west = frame.to_pixel(DVec2::new(0.0, extent.height));
                assert!((north_west.x - f64::from(frame.left)).abs() < 1e-9);
                assert!((north_west.y - f64::from(frame.top)).abs() < 1e-9);
            }
        }
    }
}
