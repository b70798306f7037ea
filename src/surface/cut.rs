//! Cross-sections that people look at.

use glam::DVec2;

/// A cross-section that a side of the table looks at.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// Its ends, plan metres.
    pub ends: [DVec2; 2],
    /// It stays as it is, whatever becomes of the land.
    pub frozen: bool,
    /// Notes: part of its length (0–1), and text.
    pub notes: Vec<(f64, String)>,
}
