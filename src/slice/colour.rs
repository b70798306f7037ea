//! Colours of printed sections and geological maps.

use crate::rock::Colour;

/// Paper of the atlas.
pub(crate) const PAPER: Colour = [247, 243, 234];

/// Ink of lines and letters.
pub(crate) const INK: Colour = [52, 50, 47];

/// Loose sediment of the present: the Quaternary's pale yellow.
pub(crate) const SEDIMENT: Colour = [246, 236, 178];

/// Standing water.
pub(crate) const WATER: Colour = [134, 181, 205];

/// Faults.
pub(crate) const FAULT: Colour = [158, 34, 27];

/// The sea's level.
pub(super) const SEA: Colour = [62, 110, 148];

/// Rock of which nothing is known.
pub(super) const UNKNOWN: Colour = [205, 197, 182];

/// The mantle below the Moho.
pub(super) const MANTLE: Colour = [172, 176, 160];

/// Colours of the chart are made for screens and office printers; an atlas prints them quieter, on warm paper. Neighbours
/// stay apart, as all move alike.
pub(crate) fn printed(chart: Colour) -> Colour {
    const SATURATION: f64 = 0.74;
    const STRENGTH: f64 = 0.78;
    let [red, green, blue] = chart.map(f64::from);
    let grey = 0.30 * red + 0.59 * green + 0.11 * blue;
    let quiet = [red, green, blue].map(|c| (grey + SATURATION * (c - grey)).clamp(0.0, 255.0) as u8);
    mixed(PAPER, quiet, STRENGTH)
}

/// Deep rock, of which there is much: the colour of the basement, held back.
pub(super) fn deep(chart: Colour) -> Colour {
    mixed(PAPER, printed(chart), 0.60)
}

/// A trace of the printed colour: rock that is no longer there.
pub(super) fn eroded(chart: Colour) -> Colour {
    mixed(PAPER, printed(chart), 0.30)
}

/// Lines in the colour of what they divide.
pub(super) fn outline(chart: Colour, strength: f64) -> Colour {
    mixed(printed(chart), INK, strength)
}

/// From one colour to another.
pub(super) fn mixed(from: Colour, to: Colour, part: f64) -> Colour {
    std::array::from_fn(|i| {
        (f64::from(from[i]) + part * (f64::from(to[i]) - f64::from(from[i]))).round() as u8
    })
}
