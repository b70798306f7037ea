//! A surface with continuous slopes through the nodes, one cubic patch per triangle.

use glam::DVec2;
use rayon::prelude::*;

use super::tin::{NodeId, Tin};

/// Nodes or triangles per task.
const CHUNK: usize = 4096;

/// A cubic Bézier triangle whose middle control value is blended from three (Foley & Opitz 1992, *Hybrid cubic
/// Bézier triangle patches*): each of them makes the slope across one side vary linearly along that side, so that
/// neighbouring patches, which share the slopes at the two nodes, meet with continuous slopes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Heights of the corners.
    corners: [f32; 3],
    /// Control values a third of the way from corner k to the next, and to the one before.
    towards_next: [f32; 3],
    towards_before: [f32; 3],
    /// Middle control values for the side from corner k to the next.
    middles: [f32; 3],
}

impl Patch {
    fn new(nodes: [NodeId; 3], tin: &Tin, values: &[f64], slopes: &[DVec2]) -> Self {
        let p = nodes.map(|node| tin.position(node));
        let z = nodes.map(|node| values[node.index()]);
        let g = nodes.map(|node| slopes[node.index()]);
        let next = [0, 1, 2].map(|k: usize| z[k] + g[k].dot(p[(k + 1) % 3] - p[k]) / 3.0);
        let before = [0, 1, 2].map(|k: usize| z[k] + g[k].dot(p[(k + 2) % 3] - p[k]) / 3.0);
        let middles = [0, 1, 2].map(|k: usize| {
            let (from, to, apex) = (k, (k + 1) % 3, (k + 2) % 3);
            let side = p[to] - p[from];
            // The apex' foot on the side, as a share of the side.
            let foot = (p[apex] - p[from]).dot(side) / side.length_squared();
            let across_from = before[from] - (1.0 - foot) * z[from] - foot * next[from];
            let across_to = next[to] - (1.0 - foot) * before[to] - foot * z[to];
            (1.0 - foot) * next[from] + foot * before[to] + 0.5 * (across_from + across_to)
        });
        Self {
            corners: z.map(|v| v as f32),
            towards_next: next.map(|v| v as f32),
            towards_before: before.map(|v| v as f32),
            middles: middles.map(|v| v as f32),
        }
    }

    /// Height at barycentric weights (u, v, 1 − u − v).
    pub(super) fn height(&self, [u, v]: [f32; 2]) -> f32 {
        let w = 1.0 - u - v;
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = self.towards_next;
        let [ac, ba, cb] = self.towards_before;
        let (uv, vw, wu) = (u * v, v * w, w * u);
        let sum = uv + vw + wu;
        let middle = if sum > 0.0 {
            (uv * self.middles[0] + vw * self.middles[1] + wu * self.middles[2]) / sum
        } else {
            0.0
        };
        u * u * (u * a + 3.0 * (v * ab + w * ac))
            + v * v * (v * b + 3.0 * (w * bc + u * ba))
            + w * w * (w * c + 3.0 * (u * ca + v * cb))
            + 6.0 * uv * w * middle
    }
}

/// The patches of a smooth surface, in memory that is reused from one surface to the next.
#[derive(Clone, Debug, Default)]
pub struct SmoothSheet {
    slopes: Vec<DVec2>,
    patches: Vec<Patch>,
}

impl SmoothSheet {
    /// Lays the sheet through nodal `values`: a patch for each triangle.
    pub(super) fn lay(&mut self, tin: &Tin, values: &[f64]) -> &[Patch] {
        (0..tin.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| nodal_slope(tin, NodeId::new(i), values))
            .collect_into_vec(&mut self.slopes);
        let slopes = &self.slopes;
        tin.triangles()
            .par_iter()
            .with_min_len(CHUNK)
            .map(|&triangle| Patch::new(triangle.map(NodeId), tin, values, slopes))
            .collect_into_vec(&mut self.patches);
        &self.patches
    }
}

/// Slope at a node: the plane through it that fits its neighbours best (least squares, weights 1/d²), flattened
/// where its control values would leave the range of heights around the node (Barth & Jespersen 1989). Summits and
/// pits thus get a level tangent, and ridges do not ring.
fn nodal_slope(tin: &Tin, node: NodeId, values: &[f64]) -> DVec2 {
    let (p, z) = (tin.position(node), values[node.index()]);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    let mut right = DVec2::ZERO;
    let (mut lowest, mut highest) = (0.0_f64, 0.0_f64);
    for link in tin.links(node) {
        let d = tin.position(link.to) - p;
        let rise = values[link.to.index()] - z;
        let weight = f64::from(link.inverse_distance * link.inverse_distance);
        xx += weight * d.x * d.x;
        xy += weight * d.x * d.y;
        yy += weight * d.y * d.y;
        right += weight * rise * d;
        lowest = lowest.min(rise);
        highest = highest.max(rise);
    }
    let determinant = xx * yy - xy * xy;
    // Weighted by 1/d², xx + yy is the number of neighbours; below this they lie on a line.
    if determinant <= 1e-9 {
        return DVec2::ZERO;
    }
    let slope = DVec2::new(yy * right.x - xy * right.y, xx * right.y - xy * right.x) / determinant;
    let mut share = 1.0_f64;
    for neighbour in tin.neighbours(node) {
        let control = slope.dot(tin.position(neighbour) - p) / 3.0;
        if control > highest {
            share = share.min(highest / control);
        } else if control < lowest {
            share = share.min(lowest / control);
        }
    }
    share * slope
}
