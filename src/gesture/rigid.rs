//! Rigid motions of the plane, and the best one for a hand.

use glam::DVec2;

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
            cross.atan2(dot)
        };
        let translation = to_mean - DVec2::from_angle(angle).rotate(from_mean);
        let residual_sq = from_sq + to_sq - 2.0 * (dot * angle.cos() + cross * angle.sin());
        Self {
            motion: RigidMotion { angle, translation },
            residual: residual_sq.max(0.0).sqrt(),
        }
    }
}
