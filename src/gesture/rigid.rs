//! Rigid motions of the plane, and the best one for a hand.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::units::PlanMap;

/// A rotation about the origin followed by a translation: `p ↦ R p + t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// Angle of the rotation, radians, counter-clockwise where y points up, in (−π, π].
    pub angle: f64,
    /// Translation after the rotation.
    pub translation: DVec2,
}

impl RigidMotion {
    /// No motion.
    pub const IDENTITY: Self = Self {
        angle: 0.0,
        translation: DVec2::ZERO,
    };

    /// Moves `p`.
    pub fn apply(&self, p: DVec2) -> DVec2 {
        DVec2::from_angle(self.angle).rotate(p) + self.translation
    }

    /// Moves `p` back.
    pub fn apply_inverse(&self, p: DVec2) -> DVec2 {
        DVec2::from_angle(-self.angle).rotate(p - self.translation)
    }

    /// First `before`, then this motion.
    #[must_use]
    pub fn compose(&self, before: &Self) -> Self {
        Self {
            angle: wrapped(self.angle + before.angle),
            translation: self.apply(before.translation),
        }
    }

    /// The motion that takes everything back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            angle: wrapped(-self.angle),
            translation: self.apply_inverse(DVec2::ZERO),
        }
    }

    /// Part `f` of the motion: `pivot` goes that part of its straight way, and everything turns about it by that part
    /// of the angle. 0 is the identity and 1 the motion itself, whatever the pivot; between them the pivot should be
    /// a natural centre of what is moved, such as the middle of a hull.
    #[must_use]
    pub fn fraction(&self, f: f64, pivot: DVec2) -> Self {
        let angle = wrapped(self.angle * f);
        let centre = pivot + (self.apply(pivot) - pivot) * f;
        Self {
            angle,
            translation: centre - DVec2::from_angle(angle).rotate(pivot),
        }
    }

    /// The same motion of the ground: from table millimetres (y down) to plan metres (y north).
    #[must_use]
    pub fn to_plan(&self, map: &PlanMap) -> Self {
        Self {
            angle: wrapped(-self.angle),
            translation: map.to_plan(self.apply(map.to_table(DVec2::ZERO))),
        }
    }
}

/// An angle in (−π, π].
fn wrapped(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let turned = angle - TAU * (angle / TAU).round();
    if turned <= -PI { PI } else { turned }
}

/// The rigid motion that fits a set of arrows best, and what it leaves unexplained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidFit {
    /// The motion.
    pub motion: RigidMotion,
    /// Root of the summed squared misfit, in the unit of the points.
    pub residual: f64,
}

impl RigidFit {
    /// The least-squares motion that takes `from` to `to` (paper section 4.1; closed form of C16:
    /// θ = atan2(Σ x×y, Σ x·y) about the centroids, t = p̄ − R c̄). Never a reflection. One point, or points that
    /// coincide, give a translation; no points give the identity.
    pub fn fit(from: &[DVec2], to: &[DVec2]) -> Self {
        assert_eq!(from.len(), to.len(), "arrows have two ends");
        if from.is_empty() {
            return Self {
                motion: RigidMotion::IDENTITY,
                residual: 0.0,
            };
        }
        let n = from.len() as f64;
        let from_mean = from.iter().sum::<DVec2>() / n;
        let to_mean = to.iter().sum::<DVec2>() / n;
        let (mut dot, mut cross, mut from_sq, mut to_sq) = (0.0, 0.0, 0.0, 0.0);
        for (&a, &b) in from.iter().zip(to) {
            let (x, y) = (a - from_mean, b - to_mean);
            dot += x.dot(y);
            cross += x.perp_dot(y);
            from_sq += x.length_squared();
            to_sq += y.length_squared();
        }
        let angle = if dot.hypot(cross) <= 1e-12 * (from_sq + to_sq) {
            0.0
        } else {
            wrapped(cross.atan2(dot))
        };
        let turn = DVec2::from_angle(angle);
        // Summed directly: the closed form from_sq + to_sq − 2 hypot(dot, cross) loses half the digits near zero.
        let misfit = from
            .iter()
            .zip(to)
            .map(|(&a, &b)| (b - to_mean).distance_squared(turn.rotate(a - from_mean)));
        Self {
            motion: RigidMotion {
                angle,
                translation: to_mean - turn.rotate(from_mean),
            },
            residual: misfit.sum::<f64>().sqrt(),
        }
    }
}
