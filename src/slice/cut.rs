//! What a vertical cut through the land meets.

use std::sync::Arc;

use glam::DVec2;

use super::ends::{SliceError, clipped};
use crate::rock::{Column, Place, Stratigraphy};
use crate::surface::{FaultTrace, StrataMap, Surface};

/// Most places along one slice.
pub const MAX_SAMPLES: usize = 8192;

/// Shallower water is a wet meadow, metres.
const LEAST_LAKE_DEPTH: f64 = 0.5;

/// Points of a trace, before and behind a crossing, that tell its direction there: traces are as jagged as the grid
/// they were found on.
const TRACE_REACH: usize = 3;

/// A vertical cut through the land, at places of equal distance along a straight line. All vectors have one entry per
/// place.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Where it begins and ends on the plan, metres; on the land.
    pub ends: [DVec2; 2],
    /// Distance from the first end, metres; the last is the slice's length.
    pub distance: Vec<f64>,
    /// Height of the ground, metres.
    pub ground: Vec<f64>,
    /// Level of the lake over the ground, metres; `None` on dry land.
    pub lake: Vec<Option<f64>>,
    /// The layers; `None` where nothing is known of them.
    pub strata: Option<SliceStrata>,
    /// Faults that the line crosses, in order of distance.
    pub faults: Vec<FaultCut>,
    /// Model time, years.
    pub elapsed_yr: f64,
}

/// The layers along a slice.
#[derive(Clone, Debug, PartialEq)]
pub struct SliceStrata {
    /// The pile as it was laid down.
    pub stratigraphy: Arc<Stratigraphy>,
    /// Height of each interface of the pile at each place, metres; above the ground it is what erosion has taken.
    pub interfaces: Vec<Vec<f64>>,
    /// Thickness of loose sediment on the rock, metres.
    pub sediment: Vec<f64>,
    /// How far the base of the crust is pressed down, metres.
    pub root: Vec<f64>,
    /// The bed at the surface, under any sediment.
    pub outcrop: Vec<Place>,
}

/// A fault in a slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultCut {
    /// Where it crops out, metres from the first end.
    pub distance: f64,
    /// Height of the ground there, metres.
    pub height: f64,
    /// The range, under which it dips, lies towards the second end.
    pub range_ahead: bool,
    /// Tangent of its dip as the slice shows it: less than the true one where the line crosses it at a slant.
    pub apparent_dip: f64,
}

impl Slice {
    /// Cuts the land between `ends` (plan, metres) at `samples` places, brought into 2..=[`MAX_SAMPLES`]. Ends beyond the
    /// land are moved to its border. Heights that are no numbers count as 0, as on the map.
    ///
    /// # Errors
    /// Where no part of the line lies on the land, or it has no length.
    pub fn cut(surface: &Surface, ends: [DVec2; 2], samples: usize) -> Result<Self, SliceError> {
        let ends = clipped(ends, surface.height.extent)?;
        let [from, to] = ends;
        let length = from.distance(to);
        let samples = samples.clamp(2, MAX_SAMPLES);
        let part = |i: usize| i as f64 / (samples - 1) as f64;
        let places: Vec<DVec2> = (0..samples).map(|i| from.lerp(to, part(i))).collect();
        let ground: Vec<f64> = places.iter().map(|&p| surface.ground(p)).collect();
        let depth = |p| finite(surface.lake_depth.sample(p));
        let depth: Vec<f64> = places.iter().map(|&p| depth(p)).collect();
        Ok(Self {
            ends,
            distance: (0..samples).map(|i| part(i) * length).collect(),
            lake: lake_levels(&ground, &depth),
            strata: surface
                .strata
                .as_deref()
                .map(|map| SliceStrata::read(map, &places, &ground)),
            faults: faults(surface, ends),
            elapsed_yr: surface.elapsed_yr,
            ground,
        })
    }

    /// Its length, metres.
    pub fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }

    /// Height of the ground at a distance from the first end (metres), linear between places.
    pub fn ground_at(&self, distance: f64) -> f64 {
        let last = self.ground.len() - 1;
        let at = (distance / self.length() * last as f64).clamp(0.0, last as f64);
        let i = (at as usize).min(last - 1);
        self.ground[i] + (self.ground[i + 1] - self.ground[i]) * (at - i as f64)
    }
}

impl SliceStrata {
    fn read(map: &StrataMap, places: &[DVec2], ground: &[f64]) -> Self {
        let count = map.stratigraphy.depths().len();
        let mut strata = Self {
            stratigraphy: Arc::clone(&map.stratigraphy),
            interfaces: vec![Vec::with_capacity(places.len()); count],
            sediment: Vec::with_capacity(places.len()),
            root: Vec::with_capacity(places.len()),
            outcrop: Vec::with_capacity(places.len()),
        };
        for (&p, &ground) in places.iter().zip(ground) {
            let mut column = map.column(p);
            if !column.height(0).is_finite() {
                column = Column::new(&map.stratigraphy, 0.0);
            }
            for (i, heights) in strata.interfaces.iter_mut().enumerate() {
                heights.push(column.height(i));
            }
            strata.sediment.push(finite(map.sediment.sample(p)).max(0.0));
            strata.root.push(finite(map.root.sample(p)));
            strata
                .outcrop
                .push(map.stratigraphy.place(map.exposed_depth(p, ground)));
        }
        strata
    }
}

/// The number, or 0 where it is none.
fn finite(value: f32) -> f64 {
    if value.is_finite() { f64::from(value) } else { 0.0 }
}

/// Levels of lakes: each lake has one, that over its deepest place, as interpolated depths bend at the shores.
fn lake_levels(ground: &[f64], depth: &[f64]) -> Vec<Option<f64>> {
    let mut levels = vec![None; ground.len()];
    let mut start = 0;
    for shore in depth.chunk_by(|a, b| (*a > LEAST_LAKE_DEPTH) == (*b > LEAST_LAKE_DEPTH)) {
        let places = start..start + shore.len();
        start = places.end;
        if shore[0] > LEAST_LAKE_DEPTH {
            let deepest = places.clone().max_by(|&a, &b| depth[a].total_cmp(&depth[b]));
            levels[places].fill(deepest.map(|i| ground[i] + depth[i]));
        }
    }
    levels
}

/// Where the line between `ends` crosses the land's faults.
fn faults(surface: &Surface, ends: [DVec2; 2]) -> Vec<FaultCut> {
    let [from, to] = ends;
    let length = from.distance(to);
    let along = (to - from) / length;
    let dip = FaultTrace::DIP_DEG.to_radians().tan();
    let mut found = Vec::new();
    for fault in &surface.faults {
        let last = fault.points.len().saturating_sub(1);
        for (i, pair) in fault.points.windows(2).enumerate() {
            // Distances of both ends from the line, to its left: they differ in sign where it is crossed.
            let left = [pair[0], pair[1]].map(|p| along.perp_dot(p - from));
            if (left[0] >= 0.0) == (left[1] >= 0.0) || !(left[0] - left[1]).is_finite() {
                continue;
            }
            let at = pair[0].lerp(pair[1], left[0] / (left[0] - left[1]));
            let distance = (at - from).dot(along);
            if !(0.0..=length).contains(&distance) {
                continue;
            }
            let (behind, before) = (
                fault.points[i.saturating_sub(TRACE_REACH)],
                fault.points[(i + 1 + TRACE_REACH).min(last)],
            );
            let strike = (before - behind).normalize_or_zero();
            let towards_range = if fault.range_on_left {
                strike.perp()
            } else {
                -strike.perp()
            };
            let across = along.dot(towards_range);
            found.push(FaultCut {
                distance,
                height: surface.ground(at),
                range_ahead: across >= 0.0,
                apparent_dip: dip * across.abs(),
            });
        }
    }
    found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    found
}
