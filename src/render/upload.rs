//! A surface as the graphics card takes it.

use glam::DVec2;

use super::layout::Reach;
use crate::picture::water::drawn_width;
use crate::surface::{River, Surface};

/// Greatest lake depth that a byte holds, metres.
pub(super) const DEEPEST: f32 = 900.0;
/// Range of drainage areas that a byte holds, log₁₀ m².
pub(super) const DRAINAGE: (f32, f32) = (6.5, 10.5);
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

/// Lake depth and drainage of each cell as two bytes. Lakes take the root, so that shallow ones keep their shape.
pub(super) fn water(surface: &Surface, out: &mut Vec<u8>) {
    out.clear();
    let byte = |part: f32| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
    let cells = surface.lake_depth.data.iter().zip(&surface.drainage.data);
    out.extend(cells.flat_map(|(&depth, &area)| {
        let drained = (area.max(1.0).log10() - DRAINAGE.0) / (DRAINAGE.1 - DRAINAGE.0);
        [byte((depth / DEEPEST).max(0.0).sqrt()), byte(drained)]
    }));
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
