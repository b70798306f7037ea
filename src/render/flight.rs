//! The flight: a slow turn about the highest land, low enough to look up to it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::camera::{Oblique, turned};
use super::land::LandStyle;
use super::layout::EVENING_AZIMUTH;
use crate::surface::{Raster, Surface};
use crate::units::KM;

/// Time of one turn, s.
const TURN_S: f64 = 240.0;
/// The eye comes nearer and goes back once in so many seconds, by such a part of its distance.
const BREATH: (f64, f64) = (97.0, 0.06);
/// It sinks and rises once in so many seconds, by such an angle, radians.
const SWELL: (f64, f64) = (143.0, 0.022);
/// Angle at which it looks down, radians.
const DEPRESSION: f64 = 0.215;
/// Its distance from the focus, metres: from the smallest land to the largest.
const DISTANCE: (f64, f64) = (46.0 * KM, 90.0 * KM);
/// Vertical angle of view, radians.
const FIELD_OF_VIEW: f64 = 0.6;
/// Angle between the eye's way and the light's at the start: the light comes from the side, and a little from behind.
const LIGHT_FROM: f64 = 1.9;
/// Relief from which the highest land is worth looking at, and from which nothing else is, metres.
const RELIEF: (f64, f64) = (120.0, 700.0);
/// Land farther from the highest place belongs to other mountains, metres.
const NEIGHBOURHOOD: f64 = 32.0 * KM;
/// Most places along a side at which heights are read.
const PLACES: usize = 128;

/// What a flight turns about: the highest land and its surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Focus {
    /// Its middle, plan metres.
    pub at: DVec2,
    /// Height to look at, metres, not exaggerated.
    pub height: f64,
    /// Radius that holds most of it, metres.
    pub reach: f64,
    /// Direction of the first look, radians clockwise from north: along the mountains rather than across, with the
    /// light from the side.
    pub azimuth: f64,
}

impl Focus {
    /// The highest and most rugged part of a land; the middle of a flat one.
    pub fn of(surface: &Surface) -> Self {
        let raster = &surface.height;
        let places = places(raster);
        let middle = raster.extent.size() / 2.0;
        let flat = Self {
            at: middle,
            height: 0.0,
            reach: raster.extent.size().min_element() / 2.0,
            azimuth: turned(EVENING_AZIMUTH + LIGHT_FROM),
        };
        let Some(&(top, highest)) = places.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
            return flat;
        };
        let mut heights: Vec<f64> = places.iter().map(|place| place.1).collect();
        heights.sort_by(f64::total_cmp);
        let low = heights[heights.len() / 5];
        let interest = ((highest - low - RELIEF.0) / (RELIEF.1 - RELIEF.0)).clamp(0.0, 1.0);
        // Mean and spread of what is high around the top.
        let (mut sum, mut mean, mut square) = (0.0, DVec2::ZERO, [0.0; 3]);
        for &(at, height) in &places {
            let rise = ((height - low) / (highest - low).max(1.0) - 0.25).max(0.0);
            let near = (-(at - top).length_squared() / (2.0 * NEIGHBOURHOOD * NEIGHBOURHOOD)).exp();
            let (weight, from_top) = (rise * near, at - top);
            sum += weight;
            mean += weight * from_top;
            square[0] += weight * from_top.x * from_top.x;
            square[1] += weight * from_top.x * from_top.y;
            square[2] += weight * from_top.y * from_top.y;
        }
        if sum <= 0.0 || !sum.is_finite() {
            return flat;
        }
        let mean = mean / sum;
        let [xx, xy, yy] = [
            square[0] / sum - mean.x * mean.x,
            square[1] / sum - mean.x * mean.y,
            square[2] / sum - mean.y * mean.y,
        ];
        // Direction of the longest axis, clockwise from north.
        let strike = FRAC_PI_2 - 0.5 * (2.0 * xy).atan2(xx - yy);
        let high = Self {
            at: top + mean,
            height: low + 0.45 * (highest - low),
            reach: 2.0 * (xx + yy).max(0.0).sqrt(),
            azimuth: first_look(strike),
        };
        flat.towards(&high, interest)
    }

    /// The focus at `share` (0 to 1) of the way to `other`, so that an eye can follow a land that grows.
    #[must_use]
    pub fn towards(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Self {
            at: self.at.lerp(other.at, share),
            height: mix(self.height, other.height),
            reach: mix(self.reach, other.reach),
            azimuth: turned(self.azimuth + turned(other.azimuth - self.azimuth) * share),
        }
    }
}

/// The eye `seconds` into a flight about `focus`: one turn in four minutes, its distance and height gently breathing.
pub fn flight(focus: &Focus, style: &LandStyle, seconds: f64) -> Oblique {
    let wave = |(period, size): (f64, f64)| size * (seconds / period * TAU).sin();
    let distance = (20.0 * KM + 1.7 * focus.reach).clamp(DISTANCE.0, DISTANCE.1);
    Oblique {
        focus: focus.at,
        focus_height: focus.height * f64::from(style.exaggeration),
        azimuth: turned(focus.azimuth + seconds / TURN_S * TAU),
        depression: DEPRESSION + wave(SWELL),
        distance: distance * (1.0 - wave(BREATH)),
        field_of_view: FIELD_OF_VIEW,
    }
}

/// Of the looks at a slant along mountains that strike in a direction, the one with the best light.
fn first_look(strike: f64) -> f64 {
    let slant = 0.7;
    let looks = [slant, -slant, PI + slant, PI - slant].map(|turn| turned(strike + turn));
    let badness = |look: f64| {
        let light = turned(EVENING_AZIMUTH - look).abs();
        (light - LIGHT_FROM).abs()
    };
    looks
        .into_iter()
        .min_by(|a, b| badness(*a).total_cmp(&badness(*b)))
        .unwrap_or(strike)
}

/// Some places of a raster, evenly spread, with their heights, without those that have no height.
fn places(raster: &Raster) -> Vec<(DVec2, f64)> {
    let stride = raster.width.max(raster.height).div_ceil(PLACES).max(1);
    let mut places = Vec::new();
    for row in (stride / 2..raster.height).step_by(stride) {
        for column in (stride / 2..raster.width).step_by(stride) {
            let height = f64::from(raster.data[row * raster.width + column]);
            if height.is_finite() {
                places.push((raster.centre(column, row), height));
            }
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Extent;

    const LAND: Extent = Extent {
        width: 178.0 * KM,
        height: 100.0 * KM,
    };

    fn land(height: impl Fn(DVec2) -> f64) -> Surface {
        let raster = |height: &dyn Fn(DVec2) -> f64| Raster::from_fn(178, 100, LAND, |p| height(p) as f32);
        Surface {
            height: raster(&height),
            lake_depth: raster(&|_| 0.0),
            drainage: raster(&|_| 0.0),
            spacing: 545.0,
            rivers: Vec::new(),
            plates: Vec::new(),
            faults: Vec::new(),
            folds: Vec::new(),
            strata: None,
            elapsed_yr: 0.0,
        }
    }

    /// A ridge of 3 km through a place, along a direction (clockwise from north).
    fn ridge(at: DVec2, strike: f64) -> Surface {
        land(move |p| {
            let (d, along) = (p - at, DVec2::new(strike.sin(), strike.cos()));
            let (a, b) = (d.dot(along) / (30.0 * KM), d.perp_dot(along) / (8.0 * KM));
            100.0 + 3000.0 * (-a * a - b * b).exp()
        })
    }

    #[test]
    fn the_highest_land_is_the_focus() {
        let at = DVec2::new(50.0, 62.0) * KM;
        let focus = Focus::of(&ridge(at, 0.4));
        assert!(focus.at.distance(at) < 4.0 * KM, "{focus:?}");
        assert!((500.0..3100.0).contains(&focus.height), "{focus:?}");
    }

    #[test]
    fn the_first_look_is_at_a_slant_to_the_range_and_across_the_light() {
        for degrees in (0..180).step_by(15) {
            let strike = f64::from(degrees).to_radians();
            let azimuth = Focus::of(&ridge(LAND.size() / 2.0, strike)).azimuth;
            let slant = turned(2.0 * (azimuth - strike)).abs() / 2.0;
            assert!((0.5..0.9).contains(&slant), "{degrees}: {slant}");
            // Neither into the sun nor straight away from it.
            assert!(turned(azimuth - EVENING_AZIMUTH).sin().abs() > 0.6, "{degrees}");
        }
    }

    #[test]
    fn flat_land_and_land_without_numbers_have_a_focus_too() {
        let flat = Focus::of(&land(|_| 100.0));
        assert_eq!(flat.at, LAND.size() / 2.0);
        let none = Focus::of(&land(|_| f64::NAN));
        assert_eq!(none, flat);
    }

    #[test]
    fn a_flight_never_jumps_and_stays_above_the_land() {
        let focus = Focus::of(&ridge(LAND.size() / 2.0, 0.4));
        let style = LandStyle::default();
        let mut before = flight(&focus, &style, 0.0);
        for tenth in 1..6000 {
            let now = flight(&focus, &style, f64::from(tenth) / 10.0);
            assert!(turned(now.azimuth - before.azimuth).abs() < 0.003);
            assert!((now.distance / before.distance).ln().abs() < 0.001);
            let over = now.focus_height + now.distance * now.depression.sin();
            assert!(over > 3000.0 * f64::from(style.exaggeration), "{over}");
            before = now;
        }
    }

    #[test]
    fn a_focus_follows_another_by_the_shorter_way_round() {
        let mut from = Focus::of(&land(|_| 0.0));
        from.azimuth = 3.0;
        let to = Focus {
            azimuth: -3.0,
            ..from
        };
        let half = from.towards(&to, 0.5).azimuth;
        assert!((turned(half - PI)).abs() < 1e-9, "{half}");
    }
}
