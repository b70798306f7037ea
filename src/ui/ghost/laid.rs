//! A shape laid so that its fingertips and its wrist are where they are asked for.

use egui::Pos2;
use glam::DVec2;

use super::hand::{Shape, WRIST};
use crate::kiosk::GhostHand;

/// Least and greatest size against a grown-up's hand.
const SCALE: (f64, f64) = (0.5, 1.6);

/// Softness of the pull of tips and wrist on what is between them, mm.
const SOFT: f64 = 12.0;

/// First the best similarity takes the shape's pins (tips and wrist) to where they are to be; then what is left over
/// is spread over the shape, each pin pulling what is near.
pub(super) struct Laid {
    mirrored: bool,
    middle: DVec2,
    target: DVec2,
    /// Rotation and scale, as a complex number.
    spiral: DVec2,
    /// Pins after the similarity, and what is left over there, mm.
    pulls: Vec<(DVec2, DVec2)>,
}

fn vector(p: Pos2) -> DVec2 {
    DVec2::new(f64::from(p.x), f64::from(p.y))
}

impl Laid {
    /// The hand must have a finger, and its places must be finite.
    pub(super) fn new(shape: &Shape, hand: &GhostHand) -> Self {
        let tips = shape.tips.iter().map(|&tip| vector(tip));
        let mut pins: Vec<(DVec2, DVec2)> = tips.zip(hand.fingers.iter().copied()).collect();
        pins.push((vector(WRIST), hand.wrist));
        if !hand.right {
            for (from, _) in &mut pins {
                from.x = -from.x;
            }
        }
        let n = pins.len() as f64;
        let middle = pins.iter().map(|pin| pin.0).sum::<DVec2>() / n;
        let target = pins.iter().map(|pin| pin.1).sum::<DVec2>() / n;
        let (mut spiral, mut weight) = (DVec2::ZERO, 0.0);
        for (from, to) in &pins {
            let (from, to) = (*from - middle, *to - target);
            spiral += DVec2::new(from.dot(to), from.perp_dot(to));
            weight += from.length_squared();
        }
        let spiral = spiral / f64::max(weight, 1.0);
        let mut laid = Self {
            mirrored: !hand.right,
            middle,
            target,
            spiral: if spiral.length() > 1e-6 {
                spiral.clamp_length(SCALE.0, SCALE.1)
            } else {
                DVec2::X
            },
            pulls: Vec::new(),
        };
        laid.pulls = pins
            .iter()
            .map(|&(from, to)| {
                let at = laid.similar(from);
                (at, to - at)
            })
            .collect();
        laid
    }

    fn similar(&self, from: DVec2) -> DVec2 {
        self.target + self.spiral.rotate(from - self.middle)
    }

    /// A point of the shape on the table, mm.
    pub(super) fn place(&self, p: Pos2) -> DVec2 {
        let mut p = vector(p);
        if self.mirrored {
            p.x = -p.x;
        }
        let at = self.similar(p);
        let (mut pull, mut weight) = (DVec2::ZERO, 0.0);
        for (pin, left_over) in &self.pulls {
            let near = 1.0 / (pin.distance_squared(at) + SOFT * SOFT).powi(2);
            pull += *left_over * near;
            weight += near;
        }
        at + pull / weight
    }
}

#[cfg(test)]
mod tests {
    use super::super::hand::{Pose, shape};
    use super::*;

    fn hand(right: bool) -> GhostHand {
        let fingers: Vec<DVec2> = [
            (-60.0, 10.0),
            (-40.0, -60.0),
            (-8.0, -72.0),
            (22.0, -64.0),
            (52.0, -40.0),
        ]
        .map(|(x, y)| DVec2::new(if right { x } else { -x }, y) + DVec2::new(600.0, 400.0))
        .to_vec();
        GhostHand {
            starts: fingers.clone(),
            fingers,
            wrist: DVec2::new(600.0, 500.0),
            right,
            touching: 1.0,
            opacity: 1.0,
        }
    }

    #[test]
    fn tips_and_wrist_come_near_to_where_they_are_asked_for_on_both_hands() {
        for right in [true, false] {
            let hand = hand(right);
            let shape = shape(Pose::Spread);
            let laid = Laid::new(shape, &hand);
            for (&tip, finger) in shape.tips.iter().zip(&hand.fingers) {
                assert!(laid.place(tip).distance(*finger) < 4.0, "{tip:?}");
            }
            assert!(laid.place(WRIST).distance(hand.wrist) < 4.0);
        }
    }

    #[test]
    fn hands_that_no_body_fits_are_still_places() {
        let mut hand = hand(true);
        hand.fingers = vec![hand.wrist];
        let laid = Laid::new(shape(Pose::Pointing), &hand);
        assert!(
            shape(Pose::Pointing)
                .rim
                .iter()
                .all(|&p| laid.place(p).is_finite())
        );
    }
}
