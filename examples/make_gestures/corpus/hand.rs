//! How hands are built and how they move.

use glam::DVec2;

/// Where a hand or finger is at a moment. Between two poses it moves with the least jerk.
#[derive(Clone, Copy)]
pub(super) struct Pose {
    /// Session time, ms.
    pub(super) t_ms: f64,
    /// The middle of the hand, or the finger; table mm.
    pub(super) at: DVec2,
    /// Turn from how the hand landed, degrees, clockwise as seen.
    pub(super) turn_deg: f64,
}

/// A place at a moment, not turned.
pub(super) fn pose(t_ms: f64, x: f64, y: f64) -> Pose {
    Pose {
        t_ms,
        at: DVec2::new(x, y),
        turn_deg: 0.0,
    }
}

/// Poses of one finger that goes from corner to corner, resting on each for a moment as a writing finger does.
pub(super) fn through(from_ms: f64, per_stretch_ms: f64, corners: &[(f64, f64)]) -> Vec<Pose> {
    let places = corners.iter().zip(0..);
    places
        .map(|(&(x, y), i)| pose(from_ms + per_stretch_ms * f64::from(i), x, y))
        .collect()
}

/// The pose at `t_ms` by the minimum-jerk profile of reaching movements (Flash & Hogan 1985, Eq. 3 with rest at
/// both ends): x = x₀ + Δx·(10τ³ − 15τ⁴ + 6τ⁵).
pub(super) fn pose_at(poses: &[Pose], t_ms: f64) -> Pose {
    let after = poses.partition_point(|pose| pose.t_ms <= t_ms);
    if after == 0 || after == poses.len() {
        return poses[after.saturating_sub(1)];
    }
    let (a, b) = (poses[after - 1], poses[after]);
    let tau = (t_ms - a.t_ms) / (b.t_ms - a.t_ms);
    let part = tau * tau * tau * (10.0 + tau * (6.0 * tau - 15.0));
    Pose {
        t_ms,
        at: a.at.lerp(b.at, part),
        turn_deg: a.turn_deg + (b.turn_deg - a.turn_deg) * part,
    }
}

/// Five fingertips on an arc, thumb first, around the middle of the hand.
///
/// `front` points where the fingers point, `span` (mm) is from thumb to little finger; an adult's hand spread on a
/// table spans 150 to 190 mm. Seen from above with the fingers pointing up, the thumb is on the left.
pub(super) fn five(front: DVec2, span: f64) -> Vec<DVec2> {
    // How far each finger reaches, as a part of the span: the middle finger farthest, the thumb least.
    const REACH: [f64; 5] = [-0.10, 0.06, 0.12, 0.08, -0.03];
    let (front, side) = axes(front);
    let fingers = REACH.iter().zip(0..);
    fingers
        .map(|(&reach, i)| front * (reach * span) + side * ((f64::from(i) / 4.0 - 0.5) * span))
        .collect()
}

/// The first three fingertips beside the thumb.
pub(super) fn three(front: DVec2, span: f64) -> Vec<DVec2> {
    let (front, side) = axes(front);
    vec![
        side * (-0.5 * span) - front * (0.06 * span),
        front * (0.12 * span),
        side * (0.5 * span) - front * (0.06 * span),
    ]
}

fn axes(front: DVec2) -> (DVec2, DVec2) {
    let front = front.normalize();
    // Clockwise from the front, with y down.
    (front, DVec2::new(-front.y, front.x))
}

/// The direction at `deg` clockwise (as seen, y down) from the right.
pub(super) fn toward(deg: f64) -> DVec2 {
    DVec2::from_angle(deg.to_radians())
}
