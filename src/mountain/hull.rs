//! Convex support regions: where a hand holds the crust rigid.

use glam::DVec2;
use spade::{DelaunayTriangulation, Point2, Triangulation, mitigate_underflow};

use crate::gesture::rigid::RigidMotion;

/// A convex region: the hull of the finger positions (its *core*), grown by a finger radius (Minkowski sum with a
/// disc). Corners are round, one finger gives a disc, and its distances follow from those of the core, so edges
/// stay few. Plan metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    core: Vec<DVec2>,
    radius: f64,
}

/// The nearest point of a hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance to the region in metres, 0 inside (d of Eq. 2).
    pub distance: f64,
    /// The nearest point of the region, the point itself inside (π of Eq. 2).
    pub projection: DVec2,
}

impl Hull {
    /// The hull of `points` grown by `radius` metres. Points that are not finite, or beyond 10⁹ m, are left out;
    /// `None` if nothing is left.
    pub fn new(points: &[DVec2], radius: f64) -> Option<Self> {
        let sane: Vec<DVec2> = points
            .iter()
            .copied()
            .filter(|p| p.is_finite() && p.abs().max_element() < 1e9)
            .collect();
        let core = convex_core(&sane)?;
        Some(Self {
            core,
            radius: radius.max(0.0),
        })
    }

    /// Corners of the core, counter-clockwise: one for a finger, two for points on a line.
    pub fn core(&self) -> &[DVec2] {
        &self.core
    }

    /// The radius it is grown by, metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The same region after a rigid motion.
    #[must_use]
    pub fn moved(&self, motion: &RigidMotion) -> Self {
        Self {
            core: self.core.iter().map(|&p| motion.apply(p)).collect(),
            radius: self.radius,
        }
    }

    /// The hull of both regions, grown by the larger radius.
    #[must_use]
    pub fn merged(&self, other: &Self) -> Self {
        let points: Vec<DVec2> = self.core.iter().chain(&other.core).copied().collect();
        Self {
            core: convex_core(&points).unwrap_or_else(|| self.core.clone()),
            radius: self.radius.max(other.radius),
        }
    }

    /// Corner-to-corner edges of the core (a segment has two, a single point none).
    pub fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        let n = if self.core.len() < 2 { 0 } else { self.core.len() };
        (0..n).map(move |i| (self.core[i], self.core[(i + 1) % n]))
    }

    /// Area of the grown region in m² (Steiner's formula), at least that of the disc.
    pub fn area(&self) -> f64 {
        let (mut twice, mut perimeter) = (0.0, 0.0);
        for (a, b) in self.edges() {
            twice += (a - self.core[0]).perp_dot(b - self.core[0]);
            perimeter += a.distance(b);
        }
        0.5 * twice + perimeter * self.radius + std::f64::consts::PI * self.radius * self.radius
    }

    /// Centre of the region: its core's edge-weighted mean and area centroid, weighted by what Steiner's formula
    /// gives each, so that it moves smoothly when points fall on a line.
    pub fn centre(&self) -> DVec2 {
        let origin = self.core[0];
        let mut sum = self.core.iter().map(|&p| p - origin).sum::<DVec2>() / self.core.len() as f64
            * (std::f64::consts::PI * self.radius * self.radius).max(1e-6);
        let mut weight = (std::f64::consts::PI * self.radius * self.radius).max(1e-6);
        for (a, b) in self.edges() {
            let (a, b) = (a - origin, b - origin);
            let strip = a.distance(b) * self.radius;
            let triangle = 0.5 * a.perp_dot(b);
            sum += (a + b) / 2.0 * strip + (a + b) / 3.0 * triangle;
            weight += strip + triangle;
        }
        origin + sum / weight
    }

    /// Farthest reach along `direction` (unit): max of `p·direction` over the region.
    pub fn support(&self, direction: DVec2) -> f64 {
        self.core
            .iter()
            .map(|p| p.dot(direction))
            .fold(f64::NEG_INFINITY, f64::max)
            + self.radius
    }

    /// Distance and projection of `p` (exact; the grown region is handled through its core).
    pub fn nearest(&self, p: DVec2) -> Nearest {
        let on_core = self.nearest_on_core(p);
        let offset = p - on_core;
        let core_distance = offset.length();
        if core_distance <= self.radius {
            return Nearest {
                distance: 0.0,
                projection: p,
            };
        }
        Nearest {
            distance: core_distance - self.radius,
            projection: on_core + offset * (self.radius / core_distance),
        }
    }

    /// True inside and on the rim.
    pub fn contains(&self, p: DVec2) -> bool {
        self.nearest(p).distance == 0.0
    }

    /// Gap to another region in metres, 0 when they overlap.
    pub fn distance_to(&self, other: &Self) -> f64 {
        if self.cores_cross(other) {
            return 0.0;
        }
        // Disjoint convex polygons are nearest at a corner of one of them.
        let from = |a: &Self, b: &Self| {
            a.core
                .iter()
                .map(|&p| p.distance(b.nearest_on_core(p)))
                .fold(f64::INFINITY, f64::min)
        };
        (from(self, other).min(from(other, self)) - self.radius - other.radius).max(0.0)
    }

    /// True when the regions touch or share points.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.distance_to(other) == 0.0
    }

    /// The rim as a closed counter-clockwise polygon for drawing; arcs are cut into chords of at most `step` metres.
    pub fn outline(&self, step: f64) -> Vec<DVec2> {
        let n = self.core.len();
        let chords_per_turn = (std::f64::consts::TAU * self.radius / step.max(1.0))
            .ceil()
            .max(8.0);
        let mut outline = Vec::new();
        for i in 0..n {
            let corner = self.core[i];
            let (from, turn) = if n == 1 {
                (0.0, std::f64::consts::TAU)
            } else {
                let before = corner - self.core[(i + n - 1) % n];
                let after = self.core[(i + 1) % n] - corner;
                // Half a turn at the ends of a segment, where the cross product would lose its sign.
                let turn = if n == 2 {
                    std::f64::consts::PI
                } else {
                    before.perp_dot(after).atan2(before.dot(after))
                };
                // Starts at the outward normal of the edge that arrives (the core runs counter-clockwise).
                ((-before.perp()).to_angle(), turn)
            };
            let chords = (chords_per_turn * turn / std::f64::consts::TAU).ceil().max(1.0) as usize;
            let last = if n == 1 { chords - 1 } else { chords };
            for k in 0..=last {
                let angle = from + turn * k as f64 / chords as f64;
                outline.push(corner + DVec2::from_angle(angle) * self.radius);
            }
        }
        outline
    }

    fn inside_core(&self, p: DVec2) -> bool {
        self.core.len() > 2 && self.edges().all(|(a, b)| (b - a).perp_dot(p - a) >= 0.0)
    }

    fn nearest_on_core(&self, p: DVec2) -> DVec2 {
        if self.inside_core(p) {
            return p;
        }
        let mut best = self.core[0];
        for (a, b) in self.edges() {
            let along = b - a;
            let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let q = a + along * t;
            if q.distance_squared(p) < best.distance_squared(p) {
                best = q;
            }
        }
        best
    }

    /// Separating axes: convex cores are disjoint iff some edge normal (or, for points and segments, some
    /// corner-to-corner direction, which the distances then find) separates them.
    fn cores_cross(&self, other: &Self) -> bool {
        if self.core.iter().any(|&p| other.inside_core(p)) || other.core.iter().any(|&p| self.inside_core(p))
        {
            return true;
        }
        self.edges()
            .any(|(a, b)| other.edges().any(|(c, d)| segments_cross(a, b, c, d)))
    }
}

fn segments_cross(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Corners of the convex hull, counter-clockwise, found by the exact predicates of the Delaunay triangulation.
fn convex_core(points: &[DVec2]) -> Option<Vec<DVec2>> {
    let mut triangulation = DelaunayTriangulation::<Point2<f64>>::new();
    for p in points {
        // Coordinates are finite and bounded here, and underflow is flushed: insertion has nothing left to refuse.
        if triangulation
            .insert(mitigate_underflow(Point2::new(p.x, p.y)))
            .is_err()
        {
            return None;
        }
    }
    let at = |p: Point2<f64>| DVec2::new(p.x, p.y);
    if triangulation.num_inner_faces() > 0 {
        let mut hull: Vec<DVec2> = triangulation
            .convex_hull()
            .map(|edge| at(edge.from().position()))
            .collect();
        if signed_area(&hull) < 0.0 {
            hull.reverse();
        }
        return Some(without_collinear(&hull));
    }
    // All on one line: its two ends, in lexicographic order.
    let order = |a: &DVec2, b: &DVec2| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
    let vertices = || triangulation.vertices().map(|v| at(v.position()));
    let first = vertices().min_by(order)?;
    let last = vertices().max_by(order)?;
    Some(if first == last {
        vec![first]
    } else {
        vec![first, last]
    })
}

fn signed_area(polygon: &[DVec2]) -> f64 {
    let n = polygon.len();
    (0..n)
        .map(|i| (polygon[i] - polygon[0]).perp_dot(polygon[(i + 1) % n] - polygon[0]))
        .sum::<f64>()
        / 2.0
}

/// Drops corners at which the hull does not turn, and starts at the lexicographically first corner, so that equal
/// sets of points give equal hulls whatever their order.
fn without_collinear(hull: &[DVec2]) -> Vec<DVec2> {
    let n = hull.len();
    let mut corners: Vec<DVec2> = (0..n)
        .filter(|&i| {
            let (before, here, after) = (hull[(i + n - 1) % n], hull[i], hull[(i + 1) % n]);
            (here - before).perp_dot(after - here) > 0.0
        })
        .map(|i| hull[i])
        .collect();
    if corners.len() < 3 {
        corners = hull.to_vec();
    }
    let first = (0..corners.len())
        .min_by(|&a, &b| {
            let (a, b) = (corners[a], corners[b]);
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
        })
        .unwrap_or(0);
    corners.rotate_left(first);
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Hull {
        let points = [
            [0.0, 0.0],
            [10.0, 0.0],
            [10.0, 10.0],
            [0.0, 10.0],
            [5.0, 5.0],
            [5.0, 0.0],
        ];
        Hull::new(&points.map(DVec2::from_array), 2.0).unwrap()
    }

    #[test]
    fn hull_of_points_one_two_and_many() {
        assert_eq!(Hull::new(&[], 1.0), None);
        assert_eq!(Hull::new(&[DVec2::NAN, DVec2::splat(1e300)], 1.0), None);
        let disc = Hull::new(&[DVec2::ONE; 3], 2.0).unwrap();
        assert_eq!(disc.core(), [DVec2::ONE]);
        assert!((disc.area() - 4.0 * std::f64::consts::PI).abs() < 1e-12);
        let segment = Hull::new(&[DVec2::ZERO, DVec2::X * 4.0, DVec2::X * 2.0], 1.0).unwrap();
        assert_eq!(segment.core(), [DVec2::ZERO, DVec2::X * 4.0]);
        assert!((segment.area() - (8.0 + std::f64::consts::PI)).abs() < 1e-12);
        let square = square();
        assert_eq!(
            square.core().len(),
            4,
            "inner points and points on edges are dropped"
        );
        assert!((square.area() - (100.0 + 80.0 + 4.0 * std::f64::consts::PI)).abs() < 1e-9);
        assert!((square.centre() - DVec2::splat(5.0)).length() < 1e-9);
    }

    #[test]
    fn nearest_points_on_edges_corners_and_inside() {
        let hull = square();
        let at = |x: f64, y: f64| hull.nearest(DVec2::new(x, y));
        assert_eq!(at(5.0, 11.5).distance, 0.0);
        assert_eq!(at(5.0, 11.5).projection, DVec2::new(5.0, 11.5));
        assert!((at(15.0, 4.0).distance - 3.0).abs() < 1e-12);
        assert!((at(15.0, 4.0).projection - DVec2::new(12.0, 4.0)).length() < 1e-12);
        let corner = at(13.0, 14.0);
        assert!((corner.distance - 3.0).abs() < 1e-12);
        assert!((corner.projection - DVec2::new(11.2, 11.6)).length() < 1e-12);
        assert!((hull.support(DVec2::X) - 12.0).abs() < 1e-12);
    }

    #[test]
    fn gaps_and_overlaps() {
        let hull = square();
        let moved = |x: f64, y: f64| {
            hull.moved(&RigidMotion {
                angle: 0.0,
                translation: DVec2::new(x, y),
            })
        };
        assert!((hull.distance_to(&moved(20.0, 3.0)) - 6.0).abs() < 1e-12);
        assert!(hull.overlaps(&moved(13.0, 0.0)) && !hull.overlaps(&moved(14.5, 0.0)));
        assert!(hull.overlaps(&moved(1.0, 1.0)), "one inside the other's reach");
        // Two bars that cross without a corner of one inside the other.
        let bar =
            |a: [f64; 2], b: [f64; 2]| Hull::new(&[DVec2::from_array(a), DVec2::from_array(b)], 0.1).unwrap();
        assert!(bar([-5.0, 0.0], [5.0, 0.0]).overlaps(&bar([0.0, -5.0], [0.0, 5.0])));
        assert!(hull.merged(&moved(20.0, 0.0)).contains(DVec2::new(15.0, 5.0)));
    }

    #[test]
    fn outlines_run_round_the_rim() {
        for hull in [
            square(),
            Hull::new(&[DVec2::ZERO], 3.0).unwrap(),
            Hull::new(&[DVec2::ZERO, DVec2::Y * 4.0], 3.0).unwrap(),
        ] {
            let rim = hull.outline(0.0);
            assert!(
                (signed_area(&rim) / hull.area() - 1.0).abs() < 0.05,
                "{}",
                signed_area(&rim)
            );
            for &p in &rim {
                let off = p - hull.nearest_on_core(p);
                assert!((off.length() - hull.radius()).abs() < 1e-9);
            }
        }
    }
}
