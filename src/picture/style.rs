//! Choices a map may make.

use glam::DVec2;

/// How a relief map is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct MapStyle {
    /// First line of the caption; empty for none.
    pub title: String,
    /// Heights are multiplied by this before they are lit. Printed on the map wherever it is not 1.
    pub vertical_exaggeration: f64,
    /// Draw plates, arrows and faults.
    pub marks: bool,
    /// Draw caption, scale bar and neat line.
    pub lettering: bool,
    /// Ends of slices (plan, metres), drawn as dashed lines from A to A', B to B', …
    pub cuts: Vec<[DVec2; 2]>,
}

impl Default for MapStyle {
    fn default() -> Self {
        Self {
            title: String::new(),
            vertical_exaggeration: 1.0,
            marks: true,
            lettering: true,
            cuts: Vec::new(),
        }
    }
}
