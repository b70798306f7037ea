//! Values from one TIN at other places: when the number of nodes changes under a land, or a part of it is cut out.

use glam::DVec2;
use rayon::prelude::*;

use super::smooth::SmoothSheet;
use super::tin::{NodeId, Tin};

/// No triangle beyond this side.
const NONE: u32 = u32::MAX;

/// Weight below which a point lies beyond a side; rounding alone must not send a walk to and fro.
const BEYOND: f64 = -1e-12;

/// Places per task: a task finds its first place by a long walk, all others from the one before. Fixed, so that no result
/// depends on the number of threads.
const CHUNK: usize = 16_384;

/// Places in the triangles of a TIN, located once for any number of values.
///
/// Places outside its hull stand for a nearby point on it.
#[derive(Clone, Debug)]
pub struct Resampling<'a> {
    from: &'a Tin,
    samples: Vec<Sample>,
}

/// A triangle, and the weights of its first two corners.
#[derive(Clone, Copy, Debug)]
struct Sample {
    triangle: u32,
    weights: [f64; 2],
}

impl<'a> Resampling<'a> {
    /// Locates `places` (plan metres of `from`) by walks from each to the next: a few steps where they follow a curve, as
    /// the nodes of [`Tin::poisson`] do.
    pub fn new(from: &'a Tin, places: &[DVec2]) -> Self {
        let beyond = triangles_beyond(from);
        let locate = |places: &[DVec2]| {
            let mut triangle = 0;
            let mut samples = Vec::with_capacity(places.len());
            for &p in places {
                let weights = walk(from, &beyond, &mut triangle, p).map(|weight| weight.max(0.0));
                let sum: f64 = weights.iter().sum();
                samples.push(Sample {
                    triangle,
                    weights: [weights[0] / sum, weights[1] / sum],
                });
            }
            samples
        };
        let samples = places.par_chunks(CHUNK).flat_map_iter(locate).collect();
        Self { from, samples }
    }

    /// Nodal `values` interpolated linearly in each triangle: exact for linear fields, to round-off.
    ///
    /// # Panics
    /// If `values` does not hold one value per node.
    pub fn linear(&self, values: &[f64]) -> Vec<f64> {
        assert_eq!(values.len(), self.from.len(), "one value per node");
        let triangles = self.from.triangles();
        let samples = self.samples.par_iter().with_min_len(CHUNK);
        samples
            .map(|sample| {
                let [a, b, c] = triangles[sample.triangle as usize].map(|k| values[k as usize]);
                let [u, v] = sample.weights;
                // Rounding must not make it negative: amounts stay amounts.
                u * a + v * b + (1.0 - u - v).max(0.0) * c
            })
            .collect()
    }

    /// Nodal `values` interpolated by the surface with continuous slopes that pictures show, in single precision.
    ///
    /// # Panics
    /// If `values` does not hold one value per node.
    pub fn smooth(&self, values: &[f64]) -> Vec<f64> {
        assert_eq!(values.len(), self.from.len(), "one value per node");
        let mut sheet = SmoothSheet::default();
        let patches = sheet.lay(self.from, values);
        let samples = self.samples.par_iter().with_min_len(CHUNK);
        samples
            .map(|sample| {
                let weights = sample.weights.map(|weight| weight as f32);
                f64::from(patches[sample.triangle as usize].height(weights))
            })
            .collect()
    }
}

/// Walks to the triangle that holds `p`, or to one at the hull that `p` lies beyond; returns the weights of `p` there.
fn walk(tin: &Tin, beyond: &[[u32; 3]], triangle: &mut u32, p: DVec2) -> [f64; 3] {
    let mut weights = weights_in(tin, *triangle, p);
    // A walk on a Delaunay triangulation comes to no triangle twice; rounding might.
    for _ in 0..beyond.len() {
        let crossed = (0..3)
            .filter(|&k| weights[k] < BEYOND && beyond[*triangle as usize][k] != NONE)
            .min_by(|&a, &b| weights[a].total_cmp(&weights[b]));
        let Some(side) = crossed else { break };
        *triangle = beyond[*triangle as usize][side];
        weights = weights_in(tin, *triangle, p);
    }
    weights
}

/// Barycentric weights of `p` in a triangle.
fn weights_in(tin: &Tin, triangle: u32, p: DVec2) -> [f64; 3] {
    let [a, b, c] = tin.triangles()[triangle as usize].map(|k| tin.positions()[k as usize]);
    let doubled_area = (b - a).perp_dot(c - a);
    let (u, v) = (
        (c - b).perp_dot(p - b) / doubled_area,
        (a - c).perp_dot(p - c) / doubled_area,
    );
    [u, v, 1.0 - u - v]
}

/// For each triangle the one beyond the side opposite to each corner.
fn triangles_beyond(tin: &Tin) -> Vec<[u32; 3]> {
    // Half-edges ordered by their nodes: the two of a side become neighbours in the list of the smaller node.
    let mut sides_of: Vec<Vec<(u32, u32, u8)>> = vec![Vec::new(); tin.len()];
    let mut beyond = vec![[NONE; 3]; tin.triangles().len()];
    for (index, corners) in tin.triangles().iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let (low, high) = (NodeId(a.min(b)), a.max(b));
            let sides = &mut sides_of[low.index()];
            if let Some(found) = sides.iter().position(|&(other, ..)| other == high) {
                let (_, twin, twin_k) = sides.swap_remove(found);
                beyond[index][k] = twin;
                beyond[twin as usize][twin_k as usize] = index as u32;
            } else {
                sides.push((high, index as u32, k as u8));
            }
        }
    }
    beyond
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::Border;
    use crate::units::Extent;

    const LAND: Extent = Extent {
        width: 1600.0,
        height: 1000.0,
    };

    fn plane(p: DVec2) -> f64 {
        3.0 + 0.5 * p.x - 0.25 * p.y
    }

    #[test]
    fn linear_fields_survive_between_any_numbers_of_nodes() {
        for (few, many) in [(20, 3000), (3000, 20), (700, 701)] {
            let from = Tin::poisson(LAND, few, 1).unwrap();
            let to = Tin::poisson(LAND, many, 2).unwrap();
            let values: Vec<f64> = from.positions().iter().map(|&p| plane(p)).collect();
            let places = Resampling::new(&from, to.positions());
            let both = places.linear(&values).into_iter().zip(places.smooth(&values));
            for ((value, smooth), &p) in both.zip(to.positions()) {
                assert!((value - plane(p)).abs() < 1e-9);
                assert!((smooth - plane(p)).abs() < 1e-3, "single precision");
            }
        }
    }

    #[test]
    fn a_tin_resamples_to_itself() {
        let tin = Tin::poisson(LAND, 500, 3).unwrap();
        let values: Vec<f64> = (0..tin.len()).map(|i| (i as f64).sin()).collect();
        for (a, b) in Resampling::new(&tin, tin.positions())
            .linear(&values)
            .iter()
            .zip(&values)
        {
            assert!((a - b).abs() < 1e-9);
        }
    }

    #[test]
    fn nodes_beyond_the_hull_take_values_on_it() {
        let corners = [(400.0, 300.0), (1200.0, 300.0), (1200.0, 700.0), (400.0, 700.0)];
        let corners = corners.map(|(x, y)| DVec2::new(x, y));
        let from = Tin::from_nodes(LAND, &corners, Border::Hull).unwrap();
        let to = Tin::poisson(LAND, 300, 4).unwrap();
        let values = Resampling::new(&from, to.positions()).linear(&[0.0, 1.0, 1.0, 0.0]);
        let round_off = 1e-12;
        assert!(
            values
                .iter()
                .all(|value| (-round_off..=1.0 + round_off).contains(value))
        );
        for (p, value) in to.positions().iter().zip(&values) {
            if p.x > 1200.0 && p.y > 300.0 && p.y < 700.0 {
                assert!((value - 1.0).abs() < 1e-12, "{value} at {p}");
            }
        }
    }
}
