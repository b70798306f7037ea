//! The shape of a hand, seen from above.
//!
//! A hand is a union of tapered limbs, blended where they meet as skin is. The union is a distance field; the outline
//! is walked along its rim, the inside is cut out of a grid. Millimetres; the fingers point up (−y), the forearm
//! leaves downwards, the thumb is on the left: a right hand with its palm on the table.

use std::sync::LazyLock;

use egui::{Pos2, Vec2, pos2, vec2};

/// How softly limbs flow into each other, mm.
const BLEND: f32 = 7.0;

/// Size of a cell of the grid that the inside is cut from, mm.
const CELL: f32 = 4.0;

/// Step along the outline, mm.
const STRIDE: f32 = 2.0;

/// Where the forearm ends, mm below the palm's middle; it has faded away there.
pub(super) const END: f32 = 165.0;

/// Middle of the wrist.
pub(super) const WRIST: Pos2 = pos2(0.0, 60.0);

/// The box that holds every hand.
const LEFT_TOP: Pos2 = pos2(-84.0, -128.0);

/// How the fingers are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pose {
    /// The index finger is stretched, the others are curled.
    Pointing,
    /// All five touch the table.
    Spread,
}

/// A hand, ready to be placed.
pub(super) struct Shape {
    /// The outline, from one side of the forearm round the fingers to the other.
    pub(super) rim: Vec<Pos2>,
    /// Corners of the inside, with their depth below the rim, mm.
    pub(super) corners: Vec<(Pos2, f32)>,
    /// Triangles of corners.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Where the fingers that touch have their pads, from the thumb on.
    pub(super) tips: Vec<Pos2>,
}

/// A limb that tapers from one round end to the other.
struct Limb {
    from: (f32, f32, f32),
    to: (f32, f32, f32),
}

const fn limb(from: (f32, f32, f32), to: (f32, f32, f32)) -> Limb {
    Limb { from, to }
}

/// Palm and forearm: `(x, y, radius)` of both ends.
const PALM: [Limb; 6] = [
    limb((-24.0, -26.0, 14.0), (-12.0, 48.0, 19.0)),
    limb((-7.0, -31.0, 15.0), (0.0, 46.0, 21.0)),
    limb((11.0, -28.0, 14.0), (5.0, 46.0, 21.0)),
    limb((27.0, -17.0, 12.0), (12.0, 48.0, 18.0)),
    limb((-24.0, 22.0, 15.0), (-6.0, 44.0, 20.0)),
    limb((0.0, 60.0, 24.0), (0.0, 190.0, 32.0)),
];

const SPREAD: [Limb; 9] = [
    limb((-24.0, -28.0, 9.6), (-35.0, -60.0, 8.6)),
    limb((-35.0, -60.0, 8.6), (-42.0, -88.0, 7.2)),
    limb((-7.0, -33.0, 9.8), (-10.0, -70.0, 9.0)),
    limb((-10.0, -70.0, 9.0), (-12.0, -104.0, 7.4)),
    limb((11.0, -30.0, 9.4), (19.0, -64.0, 8.4)),
    limb((19.0, -64.0, 8.4), (24.0, -94.0, 7.0)),
    limb((28.0, -18.0, 8.4), (49.0, -68.0, 6.2)),
    limb((-28.0, 20.0, 13.0), (-51.0, -8.0, 10.4)),
    limb((-51.0, -8.0, 10.4), (-66.0, -38.0, 8.2)),
];

const POINTING: [Limb; 7] = [
    limb((-24.0, -28.0, 9.8), (-28.0, -64.0, 8.8)),
    limb((-28.0, -64.0, 8.8), (-29.0, -100.0, 7.2)),
    limb((-6.0, -32.0, 10.5), (-4.0, -54.0, 10.0)),
    limb((12.0, -28.0, 10.0), (13.0, -49.0, 9.4)),
    limb((27.0, -18.0, 9.0), (29.0, -38.0, 8.2)),
    limb((-28.0, 20.0, 13.0), (-43.0, -10.0, 10.0)),
    limb((-43.0, -10.0, 10.0), (-33.0, -36.0, 8.4)),
];

/// Which limbs of a pose end in a pad that touches, from the thumb on.
const SPREAD_TIPS: [usize; 5] = [8, 1, 3, 5, 6];
const POINTING_TIPS: [usize; 1] = [1];

impl Limb {
    /// Distance from its skin, negative inside. Exact for round ends of equal size, near enough for these.
    fn distance(&self, p: Pos2) -> f32 {
        let (a, b) = (pos2(self.from.0, self.from.1), pos2(self.to.0, self.to.1));
        let axis = b - a;
        let t = ((p - a).dot(axis) / axis.length_sq()).clamp(0.0, 1.0);
        p.distance(a + axis * t) - (self.from.2 + (self.to.2 - self.from.2) * t)
    }
}

/// The union of two distances, blended over [`BLEND`] (a quadratic smooth minimum).
fn union(a: f32, b: f32) -> f32 {
    let overlap = (BLEND - (a - b).abs()).max(0.0) / BLEND;
    a.min(b) - overlap * overlap * BLEND * 0.25
}

/// The shape of a pose; made once.
pub(super) fn shape(pose: Pose) -> &'static Shape {
    static POINT: LazyLock<Shape> = LazyLock::new(|| Shape::new(&POINTING, &POINTING_TIPS));
    static FLAT: LazyLock<Shape> = LazyLock::new(|| Shape::new(&SPREAD, &SPREAD_TIPS));
    match pose {
        Pose::Pointing => &POINT,
        Pose::Spread => &FLAT,
    }
}

impl Shape {
    fn new(fingers: &[Limb], tips: &[usize]) -> Self {
        let field = |p: Pos2| {
            // Each finger flows into the palm, but not into its neighbours: they only touch.
            let palm = PALM.iter().map(|limb| limb.distance(p)).reduce(union);
            let palm = palm.unwrap_or(f32::INFINITY);
            fingers
                .iter()
                .map(|finger| union(palm, finger.distance(p)))
                .fold(palm, f32::min)
        };
        let (corners, triangles) = inside(&field);
        Self {
            rim: rim(&field),
            corners,
            triangles,
            tips: tips
                .iter()
                .map(|&i| pos2(fingers[i].to.0, fingers[i].to.1 + 1.5))
                .collect(),
        }
    }
}

/// Where the field grows, per mm.
fn gradient(field: &impl Fn(Pos2) -> f32, p: Pos2) -> Vec2 {
    const H: f32 = 0.25;
    let (dx, dy) = (vec2(H, 0.0), vec2(0.0, H));
    vec2(field(p + dx) - field(p - dx), field(p + dy) - field(p - dy)) / (2.0 * H)
}

/// Walks along the rim, from the left side of the forearm round the fingers to its right side.
fn rim(field: &impl Fn(Pos2) -> f32) -> Vec<Pos2> {
    /// More steps than any hand's rim has.
    const LONGEST: usize = 800;
    let mut at = pos2(-30.0, END);
    let mut rim = Vec::new();
    while rim.len() < LONGEST && (rim.is_empty() || at.y <= END) {
        // Back onto the rim, by Newton's steps.
        for _ in 0..4 {
            let slope = gradient(field, at);
            at -= slope * field(at) / slope.length_sq().max(0.05);
        }
        rim.push(at);
        let outwards = gradient(field, at).normalized();
        // Clockwise on the screen: the inside is on the right.
        at += vec2(-outwards.y, outwards.x) * STRIDE;
    }
    rim
}

/// The inside, cut out of a grid: its corners with their depth, and triangles.
fn inside(field: &impl Fn(Pos2) -> f32) -> (Vec<(Pos2, f32)>, Vec<[u32; 3]>) {
    let (mut corners, mut triangles) = (Vec::new(), Vec::new());
    let columns = (-2.0 * LEFT_TOP.x / CELL) as usize;
    let rows = ((END - LEFT_TOP.y) / CELL) as usize;
    for row in 0..rows {
        for column in 0..columns {
            let corner = LEFT_TOP + vec2(column as f32, row as f32) * CELL;
            let square = [vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(1.0, 1.0), vec2(0.0, 1.0)]
                .map(|offset| corner + offset * CELL)
                .map(|p| (p, field(p)));
            let first = corners.len() as u32;
            for i in 0..4 {
                let ((a, at_a), (b, at_b)) = (square[i], square[(i + 1) % 4]);
                if at_a <= 0.0 {
                    corners.push((a, -at_a));
                }
                if (at_a <= 0.0) != (at_b <= 0.0) {
                    corners.push((a.lerp(b, at_a / (at_a - at_b)), 0.0));
                }
            }
            for next in first + 1..(corners.len() as u32).saturating_sub(1) {
                triangles.push([first, next, next + 1]);
            }
        }
    }
    (corners, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rim_goes_once_round_the_fingers_from_the_left_to_the_right() {
        for (pose, fingertips) in [(Pose::Pointing, 1), (Pose::Spread, 5)] {
            let shape = shape(pose);
            let (first, last) = (shape.rim[0], shape.rim[shape.rim.len() - 1]);
            assert!(first.x < 0.0 && last.x > 0.0, "{first:?} to {last:?}");
            assert!(first.y > END - 5.0 && last.y > END - 5.0);
            assert!(
                shape
                    .rim
                    .windows(2)
                    .all(|pair| pair[0].distance(pair[1]) < 2.0 * STRIDE)
            );
            assert_eq!(shape.tips.len(), fingertips);
            for tip in &shape.tips {
                let near = shape
                    .rim
                    .iter()
                    .map(|p| p.distance(*tip))
                    .fold(f32::MAX, f32::min);
                assert!(near < 10.0, "the rim passes round the tip at {tip:?}");
            }
        }
    }

    #[test]
    fn the_inside_has_about_the_area_of_its_rim() {
        for pose in [Pose::Pointing, Pose::Spread] {
            let shape = shape(pose);
            let cross = |a: Pos2, b: Pos2| a.x * b.y - a.y * b.x;
            let rim = shape.rim.iter().zip(shape.rim.iter().cycle().skip(1));
            let rim: f32 = rim.map(|(&a, &b)| cross(a, b) / 2.0).sum();
            let at = |i: u32| shape.corners[i as usize].0;
            let inside: f32 = shape
                .triangles
                .iter()
                .map(|&[a, b, c]| {
                    ((at(b) - at(a)).x * (at(c) - at(a)).y - (at(b) - at(a)).y * (at(c) - at(a)).x) / 2.0
                })
                .sum();
            assert!((rim - inside).abs() < 0.04 * inside, "{rim} and {inside} mm²");
        }
    }
}
