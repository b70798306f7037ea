//! Calibration: four touches at known places, and the map that brings them there.

use glam::{DAffine2, DMat2, DMat3, DVec2, DVec3};

/// Where the crosses are, parts of the picture, in the order in which they are touched.
pub const TARGETS: [DVec2; 4] = [
    DVec2::new(0.1, 0.1),
    DVec2::new(0.9, 0.1),
    DVec2::new(0.9, 0.9),
    DVec2::new(0.1, 0.9),
];

/// Farthest that a touch may be from its cross under the best map, parts of the picture: more is a slip.
const MOST_MISS: f64 = 0.03;

/// Least determinant of the touched places: with less they lie on a line.
const LEAST: f64 = 1e-6;

/// How long nobody may touch before all is left as it was, µs.
const PATIENCE_US: u64 = 30_000_000;

/// Touches at the crosses, one after the other.
#[derive(Clone, Debug)]
pub struct Calibrating {
    places: Vec<DVec2>,
    since_us: u64,
}

impl Calibrating {
    /// Nothing has been touched.
    pub fn new(now_us: u64) -> Self {
        Self {
            places: Vec::with_capacity(TARGETS.len()),
            since_us: now_us,
        }
    }

    /// Number of crosses that have been touched.
    pub fn touched(&self) -> usize {
        self.places.len()
    }

    /// A touch has ended at a place, in parts of the picture as the surface lies now.
    pub fn touch(&mut self, at: DVec2, now_us: u64) {
        if self.places.len() < TARGETS.len() {
            self.places.push(at);
            self.since_us = now_us;
        }
    }

    /// Time until it is given up, µs.
    pub fn left_us(&self, now_us: u64) -> u64 {
        (self.since_us + PATIENCE_US).saturating_sub(now_us)
    }

    /// What has come of it, once it is over: the map on top of the present one, or nothing.
    pub fn done(&self, now_us: u64) -> Option<Option<DAffine2>> {
        match <&[DVec2; 4]>::try_from(self.places.as_slice()) {
            Ok(places) => Some(calibration(places)),
            Err(_) => (self.left_us(now_us) == 0).then_some(None),
        }
    }
}

/// The map (of least squares) that takes four touched places to [`TARGETS`]; `None` where no map does nearly.
pub fn calibration(touched: &[DVec2; 4]) -> Option<DAffine2> {
    // Normal equations for rows (a, b, c) with a x + b y + c = target, for both coordinates.
    let mut normal = DMat3::ZERO;
    let (mut to_x, mut to_y) = (DVec3::ZERO, DVec3::ZERO);
    for (at, target) in touched.iter().zip(TARGETS) {
        let row = at.extend(1.0);
        normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
        to_x += row * target.x;
        to_y += row * target.y;
    }
    // (A determinant that is no number is not large enough either.)
    if normal.determinant().abs().max(LEAST) <= LEAST {
        return None;
    }
    let inverse = normal.inverse();
    let (x, y) = (inverse * to_x, inverse * to_y);
    let map = DAffine2::from_mat2_translation(
        DMat2::from_cols(DVec2::new(x.x, y.x), DVec2::new(x.y, y.y)),
        DVec2::new(x.z, y.z),
    );
    let miss = |(at, target): (&DVec2, DVec2)| map.transform_point2(*at).distance(target);
    let worst = touched.iter().zip(TARGETS).map(miss).fold(0.0, f64::max);
    (map.is_finite() && worst <= MOST_MISS).then_some(map)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Orientation;

    #[test]
    fn any_way_that_a_surface_lies_is_found_from_four_touches() {
        for (name, orientation) in Orientation::ALL {
            let true_map = DAffine2::from_scale_angle_translation(
                DVec2::new(1.04, 0.97),
                0.01,
                DVec2::new(-0.02, 0.015),
            ) * orientation.affine();
            let touched = TARGETS.map(|target| true_map.inverse().transform_point2(target));
            let found = calibration(&touched).expect(name);
            for place in [DVec2::ZERO, DVec2::ONE, DVec2::new(0.3, 0.8)] {
                let miss = found
                    .transform_point2(place)
                    .distance(true_map.transform_point2(place));
                assert!(miss < 1e-12, "{name}: {miss}");
            }
        }
    }

    #[test]
    fn slips_are_refused() {
        let mut touched = TARGETS;
        touched[2] = DVec2::new(0.7, 0.9);
        assert_eq!(calibration(&touched), None);
        assert_eq!(calibration(&[DVec2::splat(0.5); 4]), None);
        assert_eq!(calibration(&[DVec2::splat(f64::NAN); 4]), None);
        let trembling = TARGETS.map(|target| target + DVec2::new(0.004, -0.003) * (target.x - 0.5).signum());
        assert!(calibration(&trembling).is_some());
    }
}
