//! Traces of the main faults, for drawing and for the hand that flips them.
//!
//! The fault is the iso-level of what is raised (`fault_level` of its 95th percentile in a belt) on the belt's fault
//! side: the foot of the steep front. It crops out there and dips about 30° under the range.

use std::collections::BTreeMap;

use glam::DVec2;

use super::belt::Belt;
use super::grid::{Field, Grid};
use super::plate::Pair;

/// Traces shorter than this (metres) are not drawn.
const SHORTEST: f64 = 10_000.0;

/// A fault on the map.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultTrace {
    /// Whose fault it is.
    pub pair: Pair,
    /// Its course in plan metres. The range, and so the teeth, lie to the left of the course.
    pub points: Vec<DVec2>,
}

impl FaultTrace {
    /// Distance of `p` to the trace, metres.
    pub fn distance(&self, p: DVec2) -> f64 {
        self.points
            .windows(2)
            .map(|ends| {
                let (a, along) = (ends[0], ends[1] - ends[0]);
                let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
                p.distance(a + along * t)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Its longest stretch that keeps `margin` metres off the border of the grid: nearer, uplift fades with the border and
    /// its level follows that. `None` if too little is left to draw.
    pub(super) fn within(self, grid: Grid, margin: f64) -> Option<Self> {
        let size = DVec2::new(grid.cols as f64, grid.rows as f64) * grid.cell;
        let inside = |p: &DVec2| {
            let at = DVec2::new(p.x - grid.north_west.x, grid.north_west.y - p.y);
            at.min(size - at).min_element() > margin
        };
        let longest = self
            .points
            .split(|p| !inside(p))
            .max_by_key(|stretch| stretch.len())?;
        let kept = Self {
            pair: self.pair,
            points: longest.to_vec(),
        };
        (kept.length() >= SHORTEST).then_some(kept)
    }

    /// Its length, metres.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
    }
}

/// Traces `level` of `field` where `belt` is the owner (`owner[cell] == index`) and on its fault half.
pub(super) fn trace(field: &Field, owner: &[u8], index: u8, belt: &Belt, level: f64) -> Vec<FaultTrace> {
    let grid = field.grid;
    let mut segments: Vec<(DVec2, DVec2)> = Vec::new();
    for row in 0..grid.rows.saturating_sub(1) {
        for col in 0..grid.cols.saturating_sub(1) {
            let at = row * grid.cols + col;
            let corners = [at, at + 1, at + grid.cols + 1, at + grid.cols];
            if !corners.iter().any(|&c| owner[c] == index) {
                continue;
            }
            let values = corners.map(|c| f64::from(field.data[c]) - level);
            let places = [
                grid.centre(col, row),
                grid.centre(col + 1, row),
                grid.centre(col + 1, row + 1),
                grid.centre(col, row + 1),
            ];
            marching_square(values, places, |a, b| {
                if belt.on_fault_half((a + b) / 2.0) {
                    segments.push((a, b));
                }
            });
        }
    }
    join(&segments)
        .into_iter()
        .map(|points| FaultTrace {
            pair: belt.pair,
            points,
        })
        .filter(|trace| trace.length() >= SHORTEST)
        .collect()
}

/// Segments of the zero line through a square with corners NW, NE, SE, SW (clockwise), with the positive side to the
/// left.
fn marching_square(values: [f64; 4], places: [DVec2; 4], mut segment: impl FnMut(DVec2, DVec2)) {
    // Going clockwise round the square: walking from where values rise above zero to where they fall below it keeps
    // the positive corners to the left.
    let mut falls = Vec::new();
    let mut rises = Vec::new();
    for side in 0..4 {
        let (a, b) = (values[side], values[(side + 1) % 4]);
        if (a >= 0.0) != (b >= 0.0) {
            let cut = places[side].lerp(places[(side + 1) % 4], a / (a - b));
            if a >= 0.0 {
                falls.push((side, cut));
            } else {
                rises.push((side, cut));
            }
        }
    }
    match (falls.as_slice(), rises.as_slice()) {
        ([fall], [rise]) => segment(rise.1, fall.1),
        ([f0, f1], [r0, r1]) => {
            // A saddle: cut off the negative corners if the middle is positive, else the positive ones.
            let positive = values.iter().sum::<f64>() >= 0.0;
            let after = |from: usize| if (from + 1) % 4 == r0.0 { r0.1 } else { r1.1 };
            let before = |from: usize| if (from + 3) % 4 == r0.0 { r0.1 } else { r1.1 };
            for fall in [f0, f1] {
                segment(if positive { after(fall.0) } else { before(fall.0) }, fall.1);
            }
        }
        _ => {}
    }
}

/// Joins directed segments end to start. Neighbouring squares compute their shared cut from the same two values, but
/// in opposite order, so ends are matched on a lattice of centimetres.
fn join(segments: &[(DVec2, DVec2)]) -> Vec<Vec<DVec2>> {
    let key = |p: DVec2| ((p.x * 100.0).round() as i64, (p.y * 100.0).round() as i64);
    let mut starts: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    let mut ends: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    // A line through a corner leaves segments without length there, which would hide their neighbours.
    let segments: Vec<(DVec2, DVec2)> = segments
        .iter()
        .copied()
        .filter(|&(a, b)| key(a) != key(b))
        .collect();
    for (index, &(a, b)) in segments.iter().enumerate() {
        starts.insert(key(a), index);
        ends.insert(key(b), index);
    }
    let mut used = vec![false; segments.len()];
    let mut lines = Vec::new();
    // Open lines begin at starts that no segment ends at; what is left then are rings.
    let heads = (0..segments.len()).filter(|&i| !ends.contains_key(&key(segments[i].0)));
    let order: Vec<usize> = heads.chain(0..segments.len()).collect();
    for head in order {
        if used[head] {
            continue;
        }
        let mut line = vec![segments[head].0];
        let mut next = Some(head);
        while let Some(index) = next.filter(|&i| !used[i]) {
            used[index] = true;
            line.push(segments[index].1);
            next = starts.get(&key(segments[index].1)).copied();
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Traces a function on a 40 × 30 grid of unit squares, everywhere.
    fn lines(f: impl Fn(DVec2) -> f64) -> Vec<Vec<DVec2>> {
        let mut segments = Vec::new();
        for row in 0..30 {
            for col in 0..40 {
                let place = |c: i32, r: i32| DVec2::new(f64::from(col + c), f64::from(-(row + r)));
                let places = [place(0, 0), place(1, 0), place(1, 1), place(0, 1)];
                marching_square(places.map(&f), places, |a, b| segments.push((a, b)));
            }
        }
        join(&segments)
    }

    #[test]
    fn a_disc_gives_one_ring_with_the_inside_to_the_left() {
        let centre = DVec2::new(20.3, -14.6);
        let found = lines(|p| 100.0 - p.distance_squared(centre));
        assert_eq!(found.len(), 1);
        let ring = &found[0];
        assert!(ring[0].distance(ring[ring.len() - 1]) < 0.02, "closed");
        let area: f64 = ring
            .windows(2)
            .map(|e| (e[0] - centre).perp_dot(e[1] - centre))
            .sum::<f64>()
            / 2.0;
        assert!(
            (area / (std::f64::consts::PI * 100.0) - 1.0).abs() < 0.02,
            "counter-clockwise: {area}"
        );
    }

    #[test]
    fn a_line_across_the_grid_stays_in_one_piece_and_saddles_do_not_cross() {
        let found = lines(|p| p.x + 0.3 * p.y - 12.2);
        assert_eq!(found.len(), 1);
        // Around a saddle every piece still has the positive side to its left.
        let saddle = |p: DVec2| (p.x - 20.4) * (p.y + 14.7);
        for line in lines(saddle) {
            for ends in line.windows(2).filter(|e| e[0].distance(e[1]) > 0.1) {
                let left = (ends[1] - ends[0]).perp().normalize() * 0.02;
                let middle = (ends[0] + ends[1]) / 2.0;
                assert!(saddle(middle + left) > saddle(middle - left));
            }
        }
    }
}
