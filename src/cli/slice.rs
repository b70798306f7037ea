//! `--slice`: cross-sections of the computed land.

use std::io::Write as _;

use glam::DVec2;

use super::failure::Failure;
use super::output::png;
use crate::export::{OutDir, svg};
use crate::picture::paint_figure;
use crate::slice::{FigureOptions, Label, Slice, SliceError, clipped};
use crate::surface::{Cut, Surface};
use crate::units::Extent;

/// Most slices of one run: they are called A to Z.
pub(super) const MOST: usize = 26;

/// Slices that are seen on the land, clipped to it.
pub(super) fn on_land(slices: &[[DVec2; 2]], land: Extent) -> Result<Vec<[DVec2; 2]>, Failure> {
    slices
        .iter()
        .map(|&ends| clipped(ends, land).map_err(|error| refused(&error)))
        .collect()
}

fn refused(error: &SliceError) -> Failure {
    Failure::input(format!("--slice: {error}"))
}

/// Writes each slice as SVG and PNG, `width` pixels wide: `slice.svg`, `slice.png`, then `slice-2.svg`, …
pub(super) fn write(
    out: &OutDir,
    surface: &Surface,
    cuts: &[Cut],
    title: &str,
    width: u32,
) -> Result<(), Failure> {
    for (i, (cut, letter)) in cuts.iter().zip('A'..='Z').enumerate() {
        // A place per pixel or so: finer ones are not seen.
        let slice = Slice::cut(surface, cut.ends, width as usize).map_err(|error| refused(&error))?;
        let note = |(part, text): &(f64, String)| Label {
            distance: part * slice.length(),
            text: text.clone(),
        };
        let options = FigureOptions {
            title: title.to_owned(),
            letter,
            labels: cut.notes.iter().map(note).collect(),
            ..FigureOptions::default()
        };
        let width = f64::from(width);
        let figure = slice.figure(DVec2::new(width, 0.5625 * width), &options);
        let name = if i == 0 {
            "slice".to_owned()
        } else {
            format!("slice-{}", i + 1)
        };
        out.write(&format!("{name}.svg"), |w| svg::write(w, &figure))
            .map_err(Failure::other)?;
        let png = png(&paint_figure(&figure))?;
        out.write(&format!("{name}.png"), |w| w.write_all(&png))
            .map_err(Failure::other)?;
    }
    Ok(())
}
