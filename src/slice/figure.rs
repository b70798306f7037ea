//! A drawn slice as plain shapes.

use glam::DVec2;

use crate::rock::Colour;

/// How a slice is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureOptions {
    /// First line; empty for none.
    pub title: String,
    /// Whether title, length, age and exaggeration stand above the section.
    pub heading: bool,
    /// Letter of the first end; the second has the same with a prime.
    pub letter: char,
    /// Heights are multiplied by this; `None` chooses 1, 1.5, 2, 3 or 5. Always printed.
    pub exaggeration: Option<f64>,
    /// Most depth below the sea that the layers are shown to, metres.
    pub depth: f64,
    /// Also show the whole crust and the Moho, at true scale.
    pub crust: bool,
    /// Names of the layers beside the section.
    pub names: bool,
    /// Labels over places along the line.
    pub labels: Vec<Label>,
}

impl Default for FigureOptions {
    fn default() -> Self {
        Self {
            title: String::new(),
            heading: true,
            letter: 'A',
            exaggeration: None,
            depth: 9_000.0,
            crust: true,
            names: true,
            labels: Vec::new(),
        }
    }
}

/// A word somebody has set over a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Distance from the first end, metres.
    pub distance: f64,
    /// What it says.
    pub text: String,
}

/// A slice as shapes in pixels: x to the right, y down, from the top-left corner. Bands are painted first, then lines,
/// then texts, each in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Width and height; it may be less high than asked.
    pub size: DVec2,
    /// Colour of the ground it is drawn on.
    pub paper: Colour,
    /// Filled areas.
    pub bands: Vec<Band>,
    /// Lines.
    pub lines: Vec<Line>,
    /// Words and numbers.
    pub texts: Vec<Text>,
}

/// What a filled area shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A layer of the pile; the number of layers is the basement.
    Rock(usize),
    /// Rock of a layer that erosion has taken, above the ground.
    Eroded(usize),
    /// Land whose rock is not known.
    Ground,
    /// Loose sediment.
    Sediment,
    /// Standing water.
    Water,
    /// The whole crust or what lies under it, in the part at true scale.
    Deep,
    /// A box of the key.
    Key,
}

/// An area between two lines that share their x: easy to fill, and to cut into triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// What it shows.
    pub role: Role,
    /// Its colour.
    pub colour: Colour,
    /// Its upper edge, from left to right.
    pub top: Vec<DVec2>,
    /// Its lower edge, from left to right; as many points, at the same x.
    pub bottom: Vec<DVec2>,
}

impl Band {
    /// Its outline, closed implicitly.
    pub fn outline(&self) -> impl Iterator<Item = DVec2> {
        self.top.iter().chain(self.bottom.iter().rev()).copied()
    }

    /// Its area, square pixels.
    pub fn area(&self) -> f64 {
        let thickness: Vec<f64> = self
            .top
            .iter()
            .zip(&self.bottom)
            .map(|(t, b)| b.y - t.y)
            .collect();
        self.top
            .windows(2)
            .zip(thickness.windows(2))
            .map(|(x, thick)| (x[1].x - x[0].x) * f64::midpoint(thick[0], thick[1]))
            .sum()
    }
}

/// An open line.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its course, at least two points.
    pub points: Vec<DVec2>,
    /// Its colour.
    pub colour: Colour,
    /// Its width, pixels.
    pub width: f64,
    /// Length of dashes and gaps, pixels; `None` is solid.
    pub dash: Option<[f64; 2]>,
}

/// Which part of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// One line of letters.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Where its anchor stands, on the baseline.
    pub at: DVec2,
    /// What it says.
    pub text: String,
    /// Size of the letters, pixels.
    pub size: f64,
    /// Which part of it stands at its place.
    pub anchor: Anchor,
    /// Its colour.
    pub colour: Colour,
}
