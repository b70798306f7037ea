//! The land that the program saved.

use std::path::Path;

use orogen::input::maps::{MapKind, read_map};
use orogen::surface::Raster;
use serde_json::Value;

use super::At;

/// A saved land under a window.
pub(crate) struct Land {
    pub(crate) report: Value,
    height: Raster,
    window: (f64, f64),
}

impl Land {
    /// What has to be there before a saved land is read.
    pub(crate) const FILES: [&'static str; 3] = ["height.exr", "report.json", "picture.png"];

    /// Reads the land that lay under a window of that many pixels.
    pub(crate) fn read(folder: &Path, (width, height): (u32, u32)) -> Self {
        let report = std::fs::read(folder.join("report.json")).unwrap();
        Self {
            report: serde_json::from_slice(&report).unwrap(),
            height: read_map(&folder.join("height.exr"), MapKind::Start).unwrap(),
            window: (width.into(), height.into()),
        }
    }

    /// By how much the land around `at` rose (the most within `radius` pixels) since it was `before`, metres.
    pub(crate) fn risen(&self, before: &Self, at: At, radius: f64) -> f64 {
        self.changes(before, at, radius).fold(f64::NEG_INFINITY, f64::max)
    }

    /// By how much the land around `at` changed, up or down (the most within `radius` pixels), metres.
    pub(crate) fn changed(&self, before: &Self, at: At, radius: f64) -> f64 {
        self.changes(before, at, radius).map(f64::abs).fold(0.0, f64::max)
    }

    fn changes<'a>(&'a self, before: &'a Self, at: At, radius: f64) -> impl Iterator<Item = f64> + 'a {
        let (columns, rows) = (self.height.width, self.height.height);
        assert_eq!((columns, rows), (before.height.width, before.height.height));
        let pixel = self.window.0 / columns as f64;
        (0..rows * columns).filter_map(move |i| {
            let centre = ((i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5);
            let away = (centre.0 * pixel - at.0).hypot(centre.1 * self.window.1 / rows as f64 - at.1);
            (away <= radius).then(|| f64::from(self.height.data[i]) - f64::from(before.height.data[i]))
        })
    }
}
