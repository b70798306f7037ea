//! A surface as the graphics card takes it.

use glam::DVec2;

use super::layout::Reach;
use crate::picture::colour::smoothstep;
use crate::picture::water::drawn_width;
use crate::surface::{Raster, River, StrataMap, Surface};

/// Greatest lake depth that a byte holds, metres.
pub(super) const DEEPEST: f32 = 900.0;
/// Range of drainage areas that a byte holds, log₁₀ m².
pub(super) const DRAINAGE: (f32, f32) = (6.5, 10.5);
/// Deeper water is a lake and no wet meadow, metres.
const WET: f32 = 1.0;
/// Radius over which shores are smoothed (twice), in mesh edges.
pub(super) const SHORE_BLUR: f64 = 0.62;
/// Drainage area from which a river has meadows beside it, and from which they are at their widest, m².
const MEADOWS: (f64, f64) = (60e6, 1500e6);
/// Length over which a river grows to its width below its source, parts of the land's short side.
const TAPER: f64 = 0.07;

/// Heights, metres; `lowland` where there is none: a single one would spread over the land as it grows.
pub(super) fn heights(metres: &[f32], lowland: f32, out: &mut Vec<f32>) {
    out.clear();
    let sound = |&height: &f32| if height.is_finite() { height } else { lowland };
    out.extend(metres.iter().map(sound));
}

/// For each cell of `grid`, the place in the pile of the rock at its surface, less a half (0 is the middle of the
/// `range_m` metres that the pile's table reaches over), and the thickness of the sediment on it, metres.
pub(super) fn layers(map: &StrataMap, grid: &Raster, range_m: f32, out: &mut Vec<[f32; 2]>) {
    let sound = |value: f32, least: f32, most: f32| {
        if value.is_finite() {
            value.clamp(least, most)
        } else {
            0.0
        }
    };
    let texel = |depth: f32, sediment: f32| {
        let place = sound(depth / range_m - 0.5, -2.0, 2.0);
        [place, sound(sediment, 0.0, DEEPEST)]
    };
    out.clear();
    if (map.depth.width, map.depth.height) == (grid.width, grid.height) {
        let cells = map.depth.data.iter().zip(&map.sediment.data);
        out.extend(cells.map(|(&depth, &sediment)| texel(depth, sediment)));
        return;
    }
    for row in 0..grid.height {
        out.extend((0..grid.width).map(|column| {
            let at = grid.centre(column, row);
            texel(map.depth.sample(at), map.sediment.sample(at))
        }));
    }
}

/// Water of each cell as four bytes: part of the ground around that is under water (the shore is at a half), drainage,
/// lake depth (its root, so that shallow lakes keep their shape), nothing.
///
/// Lakes are known on the mesh: where their borders are taken cell by cell, they show its edges.
pub(super) fn water(surface: &Surface, scratch: &mut [Vec<f32>; 2], out: &mut Vec<u8>) {
    let raster = &surface.lake_depth;
    let [cover, between] = scratch;
    cover.clear();
    cover.extend(raster.data.iter().map(|&depth| smoothstep(0.0, WET, depth)));
    let cell = raster.cell().x;
    blur(
        cover,
        between,
        raster.width,
        (SHORE_BLUR * surface.spacing / cell).round() as usize,
    );
    let byte = |part: f32| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
    out.clear();
    let cells = raster.data.iter().zip(&surface.drainage.data).zip(&*cover);
    out.extend(cells.flat_map(|((&depth, &area), &cover)| {
        let drained = (area.max(1.0).log10() - DRAINAGE.0) / (DRAINAGE.1 - DRAINAGE.0);
        [
            byte(cover),
            byte(drained),
            byte((depth / DEEPEST).max(0.0).sqrt()),
            0,
        ]
    }));
}

/// Means over squares of `2 radius + 1` cells, of rows that hold anything; twice, so that no squares are seen.
fn blur(field: &mut [f32], between: &mut Vec<f32>, width: usize, radius: usize) {
    if radius == 0 || width == 0 || field.iter().all(|&value| value == 0.0) {
        return;
    }
    let rows = field.len() / width;
    let part = 1.0 / (2 * radius + 1) as f32;
    for _ in 0..2 {
        between.clear();
        between.resize(field.len(), 0.0);
        for (source, mean) in field.chunks_exact(width).zip(between.chunks_exact_mut(width)) {
            if source.iter().all(|&value| value == 0.0) {
                continue;
            }
            let at = |column: usize| source[column.min(width - 1)];
            let mut sum = at(0) * radius as f32 + (0..=radius).map(at).sum::<f32>();
            for (column, mean) in mean.iter_mut().enumerate() {
                *mean = (sum * part).max(0.0);
                sum += at(column + radius + 1) - at(column.saturating_sub(radius));
            }
        }
        field.fill(0.0);
        for row in 0..rows {
            let source = &between[row * width..(row + 1) * width];
            if source.iter().all(|&value| value == 0.0) {
                continue;
            }
            let (first, last) = (row.saturating_sub(radius), (row + radius).min(rows - 1));
            for to in first..=last {
                // What would fall outside stays on the border.
                let missing = usize::from(row == 0) * radius.saturating_sub(to)
                    + usize::from(row == rows - 1) * (to + radius).saturating_sub(rows - 1);
                let share = part * (1 + missing) as f32;
                let target = &mut field[to * width..(to + 1) * width];
                for (target, &source) in target.iter_mut().zip(source) {
                    *target += share * source;
                }
            }
        }
    }
}

/// Rivers as straight pieces with widths on the ground.
pub(super) fn reaches(surface: &Surface, out: &mut Vec<Reach>) {
    out.clear();
    let short_side = surface.height.extent.size().min_element();
    for river in &surface.rivers {
        pieces(river, short_side, out);
    }
}

fn pieces(river: &River, short_side: f64, out: &mut Vec<Reach>) {
    let sound = |at: DVec2, drainage: f64| at.is_finite() && drainage.is_finite();
    if !river.points.iter().all(|p| sound(p.at, p.drainage)) {
        return;
    }
    // Widths are given for a map 1000 pixels high.
    let half = |drainage: f64, walked: f64| {
        let taper = 0.45 + 0.55 * (walked / (TAPER * short_side)).min(1.0);
        (0.5 * drawn_width(drainage) * taper * short_side / 1000.0) as f32
    };
    let large = |drainage: f64| {
        let part = (drainage / MEADOWS.0).max(1.0).ln() / (MEADOWS.1 / MEADOWS.0).ln();
        part.min(1.0) as f32
    };
    let mut walked = 0.0;
    for pair in river.points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let before = walked;
        walked += from.at.distance(to.at);
        out.push(Reach {
            from_to: [from.at.x, from.at.y, to.at.x, to.at.y].map(|metres| metres as f32),
            half_widths: [half(from.drainage, before), half(to.drainage, walked)],
            large: [large(from.drainage), large(to.drainage)],
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blurring_keeps_what_there_is_and_what_is_even() {
        let (width, rows, radius) = (23, 17, 2);
        let mut even = vec![1.0; width * rows];
        blur(&mut even, &mut Vec::new(), width, radius);
        assert!(even.iter().all(|value| (value - 1.0).abs() < 1e-5), "{even:?}");
        let mut spot = vec![0.0; width * rows];
        spot[8 * width + 11] = 1.0;
        blur(&mut spot, &mut Vec::new(), width, radius);
        assert!((spot.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        assert!((spot[8 * width + 11] - 0.04).abs() < 1e-5);
        assert_eq!(spot[8 * width + 16], 0.0);
    }

    #[test]
    fn heights_that_are_none_become_plains() {
        let mut out = Vec::new();
        heights(&[1.0, f32::NAN, f32::INFINITY, 4.0], 7.0, &mut out);
        assert_eq!(out, [1.0, 7.0, 7.0, 4.0]);
    }
}
