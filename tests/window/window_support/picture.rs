//! What the screen shows.

use std::path::Path;

use image::RgbImage;

use super::At;

/// A picture of the screen.
pub(crate) struct Picture(pub RgbImage);

impl Picture {
    pub(super) fn read(file: &Path) -> Self {
        Self(image::open(file).unwrap().into_rgb8())
    }

    /// How much a square around `at` differs from what it was: mean over its pixels of the largest difference of a
    /// channel, 0–255.
    pub(crate) fn difference(&self, before: &Self, at: At, half: u32) -> f64 {
        let (width, height) = self.0.dimensions();
        assert_eq!((width, height), before.0.dimensions());
        let span = |middle: f64, size: u32| {
            let middle = middle as u32;
            middle.saturating_sub(half)..(middle + half).min(size)
        };
        let (columns, rows) = (span(at.0, width), span(at.1, height));
        let pixels = f64::from(columns.len() as u32 * rows.len() as u32);
        let mut sum = 0.0;
        for y in rows {
            for x in columns.clone() {
                let (now, then) = (self.0.get_pixel(x, y).0, before.0.get_pixel(x, y).0);
                let most = now.iter().zip(then).map(|(&now, then)| now.abs_diff(then)).max();
                sum += f64::from(most.unwrap_or(0));
            }
        }
        sum / pixels
    }
}
