//! Traces of the main faults, for drawing and for the hand that flips them.
//!
//! The fault is the iso-level of what is raised (`fault_level` of its 95th percentile in a belt) on the belt's fault
//! side: the foot of the steep front. It crops out there and dips about 30° under the range.

use glam::DVec2;

use super::belt::Belt;
use super::grid::Field;
use super::plate::Pair;

/// Dip of the main thrust under the range, degrees (the paper prescribes none; a few tens of degrees are usual).
pub const DIP_DEG: f64 = 30.0;

/// Traces shorter than this (metres) are not drawn.
const SHORTEST: f64 = 5_000.0;

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
    join(segments)
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
    // Going clockwise round the square, the line comes in where values fall below zero and leaves where they rise:
    // walking from fall to rise keeps the positive corners to the left.
    let mut falls = Vec::new();
    let mut rises = Vec::new();
    for side in 0..4 {
        let (a, b) = (values[side], values[(side + 1) % 4]);
        if (a >= 0.0) != (b >= 0.0) {
            let cut = places[side].lerp(places[(side + 1) % 4], a / (a - b));
            if a >= 0.0 {
                falls.push((side, cut))
            } else {
                rises.push((side, cut))
            }
        }
    }
    match (falls.as_slice(), rises.as_slice()) {
        ([fall], [rise]) => segment(fall.1, rise.1),
        ([f0, f1], [r0, r1]) => {
            // A saddle: cut off the negative corners if the middle is positive, else the positive ones.
            let positive = values.iter().sum::<f64>() >= 0.0;
            let after = |from: usize| if (from + 1) % 4 == r0.0 { r0.1 } else { r1.1 };
            let before = |from: usize| if (from + 3) % 4 == r0.0 { r0.1 } else { r1.1 };
            for fall in [f0, f1] {
                segment(fall.1, if positive { after(fall.0) } else { before(fall.0) });
            }
        }
        _ => {}
    }
}

/// Joins directed segments end to start. Neighbouring squares compute their shared cut from the same two values, but
/// in opposite order, so ends are matched on a lattice of centimetres.
fn join(segments: Vec<(DVec2, DVec2)>) -> Vec<Vec<DVec2>> {
    use std::collections::BTreeMap;
    let key = |p: DVec2| ((p.x * 100.0).round() as i64, (p.y * 100.0).round() as i64);
    let mut starts: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    let mut ends: BTreeMap<(i64, i64), usize> = BTreeMap::new();
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
