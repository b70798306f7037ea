//! Does a range read as a range? Divide, fronts, relief, slopes.

use glam::DVec2;
use serde::Serialize;

use crate::terrain::{Flow, Tin};
use crate::units::KM;

/// Land belongs to the range where uplift added at least this share of the most it added anywhere.
const RANGE_SHARE: f64 = 0.1;
/// Ground below this slope is valley floor, degrees.
const FLOOR_DEG: f64 = 5.0;
/// Window of the relief, metres.
const RELIEF_WINDOW: f64 = 10.0 * KM;

/// What makes a range a range. All zero where nothing has risen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RangeFacts {
    /// Area of the range, km²: where uplift added at least a tenth of the most it added anywhere.
    pub range_area_km2: f64,
    /// Direction of the main divide, degrees from north, clockwise, 0–180.
    pub divide_azimuth_deg: f64,
    /// Share of the range whose water leaves it across its long sides.
    pub front_drainage_fraction: f64,
    /// Greatest height difference within 10 km, metres.
    pub relief_10km_m: f64,
    /// Mean slope of the range over its area, degrees.
    pub mean_slope_deg: f64,
    /// Share of the range below 5°.
    pub valley_floor_fraction: f64,
}

impl RangeFacts {
    /// Facts of the land `z`; `risen_m` is what uplift added at each node.
    pub fn new(tin: &Tin, z: &[f64], flow: &Flow, risen_m: &[f64]) -> Self {
        let most = risen_m.iter().copied().fold(0.0, f64::max);
        if most < 1.0 {
            return Self::default();
        }
        let in_range: Vec<bool> = risen_m.iter().map(|&h| h >= RANGE_SHARE * most).collect();
        let areas = tin.areas();
        let range_area: f64 = (0..z.len()).filter(|&i| in_range[i]).map(|i| areas[i]).sum();
        let (mean_slope_deg, valley_floor_fraction) = slopes(tin, z, &in_range);
        let exits = exits(tin, flow, &in_range);
        let divide = Axis::of_divide(tin, &exits, 0.4 * range_area.sqrt());
        let front_drainage_fraction = divide.map_or(0.0, |axis| front_drainage(tin, &in_range, &exits, axis));
        Self {
            range_area_km2: range_area / (KM * KM),
            divide_azimuth_deg: divide.map_or(0.0, Axis::azimuth_deg),
            front_drainage_fraction,
            relief_10km_m: relief(tin, z, &in_range),
            mean_slope_deg,
            valley_floor_fraction,
        }
    }
}

/// Mean slope in degrees and share below [`FLOOR_DEG`], over the triangles of the range.
fn slopes(tin: &Tin, z: &[f64], in_range: &[bool]) -> (f64, f64) {
    let (mut area, mut slope_area, mut floor) = (0.0, 0.0, 0.0);
    for corner in tin.triangles() {
        let [a, b, c] = corner.map(|i| i as usize);
        if !(in_range[a] && in_range[b] && in_range[c]) {
            continue;
        }
        let (pa, pb, pc) = (tin.positions()[a], tin.positions()[b], tin.positions()[c]);
        let (u, v) = (pb - pa, pc - pa);
        let twice = u.perp_dot(v);
        let (du, dv) = (z[b] - z[a], z[c] - z[a]);
        let gradient = DVec2::new(du * v.y - dv * u.y, dv * u.x - du * v.x) / twice;
        let slope = gradient.length().atan().to_degrees();
        area += twice;
        slope_area += slope * twice;
        if slope < FLOOR_DEG {
            floor += twice;
        }
    }
    if area > 0.0 {
        (slope_area / area, floor / area)
    } else {
        (0.0, 0.0)
    }
}

/// Where the water of each node of the range leaves it.
fn exits(tin: &Tin, flow: &Flow, in_range: &[bool]) -> Vec<Option<DVec2>> {
    let mut exits = vec![None; tin.len()];
    for &node in flow.order() {
        let i = node.index();
        if !in_range[i] {
            continue;
        }
        let receiver = flow.receivers()[i].index();
        exits[i] = if receiver == i || !in_range[receiver] {
            Some(tin.positions()[i])
        } else {
            exits[receiver]
        };
    }
    exits
}

/// The line that fits a set of points best.
#[derive(Clone, Copy, Debug)]
struct Axis {
    centre: DVec2,
    direction: DVec2,
}

impl Axis {
    /// The main divide: edges of the TIN whose ends drain to exits that are at least `apart` from each other,
    /// weighted by length, and the principal axis of their midpoints.
    fn of_divide(tin: &Tin, exits: &[Option<DVec2>], apart: f64) -> Option<Self> {
        let mut points = Vec::new();
        for corner in tin.triangles() {
            for k in 0..3 {
                let (a, b) = (corner[k] as usize, corner[(k + 1) % 3] as usize);
                // Each inner edge is met from both sides; once is enough.
                if a > b {
                    continue;
                }
                if let (Some(ea), Some(eb)) = (exits[a], exits[b])
                    && ea.distance(eb) > apart
                {
                    let (pa, pb) = (tin.positions()[a], tin.positions()[b]);
                    points.push(((pa + pb) / 2.0, pa.distance(pb)));
                }
            }
        }
        let weight: f64 = points.iter().map(|(_, w)| w).sum();
        if points.len() < 3 || weight <= 0.0 {
            return None;
        }
        let centre = points.iter().map(|(p, w)| *p * *w).sum::<DVec2>() / weight;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (p, w) in points {
            let d = p - centre;
            xx += w * d.x * d.x;
            xy += w * d.x * d.y;
            yy += w * d.y * d.y;
        }
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        Some(Self {
            centre,
            direction: DVec2::from_angle(angle),
        })
    }

    fn azimuth_deg(self) -> f64 {
        self.direction
            .x
            .atan2(self.direction.y)
            .to_degrees()
            .rem_euclid(180.0)
    }

    /// Coordinates along and across.
    fn local(self, p: DVec2) -> DVec2 {
        let d = p - self.centre;
        DVec2::new(d.dot(self.direction), d.perp_dot(self.direction))
    }
}

/// Share of the range's area whose exit lies on a long side: relative to the range's half width it is farther out
/// than relative to its half length.
fn front_drainage(tin: &Tin, in_range: &[bool], exits: &[Option<DVec2>], axis: Axis) -> f64 {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for i in (0..tin.len()).filter(|&i| in_range[i]) {
        let p = axis.local(tin.positions()[i]);
        low = low.min(p);
        high = high.max(p);
    }
    let (middle, half) = ((low + high) / 2.0, ((high - low) / 2.0).max(DVec2::ONE));
    let (mut all, mut front) = (0.0, 0.0);
    for (exit, area) in exits.iter().zip(tin.areas()) {
        let Some(exit) = *exit else { continue };
        all += area;
        let at = ((axis.local(exit) - middle) / half).abs();
        if at.y > at.x {
            front += area;
        }
    }
    if all > 0.0 { front / all } else { 0.0 }
}

/// Greatest difference of height within a window of [`RELIEF_WINDOW`] (in half-window steps).
fn relief(tin: &Tin, z: &[f64], in_range: &[bool]) -> f64 {
    let step = RELIEF_WINDOW / 2.0;
    let extent = tin.extent();
    let (nx, ny) = (
        (extent.width / step).ceil() as usize + 1,
        (extent.height / step).ceil() as usize + 1,
    );
    let mut low = vec![f64::INFINITY; nx * ny];
    let mut high = vec![f64::NEG_INFINITY; nx * ny];
    for (i, p) in tin.positions().iter().enumerate() {
        if in_range[i] {
            let cell = (p.y / step) as usize * nx + (p.x / step) as usize;
            low[cell] = low[cell].min(z[i]);
            high[cell] = high[cell].max(z[i]);
        }
    }
    let mut most: f64 = 0.0;
    for y in 0..ny - 1 {
        for x in 0..nx - 1 {
            let cells = [y * nx + x, y * nx + x + 1, (y + 1) * nx + x, (y + 1) * nx + x + 1];
            let bottom = cells.iter().map(|&c| low[c]).fold(f64::INFINITY, f64::min);
            let top = cells.iter().map(|&c| high[c]).fold(f64::NEG_INFINITY, f64::max);
            most = most.max(top - bottom);
        }
    }
    most
}

/// Longest way of water to its outlet, metres.
pub(super) fn longest_way(tin: &Tin, flow: &Flow) -> f64 {
    let mut way = vec![0.0f64; tin.len()];
    let mut longest: f64 = 0.0;
    for &node in flow.order() {
        let i = node.index();
        let receiver = flow.receivers()[i].index();
        if receiver != i {
            way[i] = way[receiver] + tin.positions()[i].distance(tin.positions()[receiver]);
            longest = longest.max(way[i]);
        }
    }
    longest
}
