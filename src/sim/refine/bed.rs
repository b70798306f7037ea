//! Lays the rivers of a coarse land into a finer one.

use glam::DVec2;

use crate::terrain::{Flow, NodeId, Tin};
use crate::units::KM;

/// Step along a river, in spacings of the finer nodes: short enough that no cell on the way is missed by much.
const STEP: f64 = 0.3;

/// Rivers that drain at least this many cells of the coarse land are laid. Smaller ones are accidents of its nodes.
const LEAST_CELLS: f64 = 8.0;

/// Depth of a bed below the land around it: this many metres where it drains a square kilometre, and more with this power
/// of the area, a little less than beds of rivers have (Leopold & Maddock 1953: 0.4). Enough that water finds it on a plain,
/// and too little for a lake where a plain falls by nothing.
const DEPTH: f64 = 1.0;
const DEEPER: f64 = 0.3;

/// Lowers the nodes of `fine` whose cells a river of `coarse` crosses to the river's bed there, so that water goes on
/// the way it went; over a lake, below its surface. `origin` is the south-west corner of `fine` in the plan of `coarse`,
/// metres, and `share` the part of its depth that a bed has at a place of `fine`.
pub(super) fn lay_beds(
    (coarse, z, flow): (&Tin, &[f64], &Flow),
    fine: &Tin,
    origin: DVec2,
    share: impl Fn(DVec2) -> f64,
    heights: &mut [f64],
) {
    let least = LEAST_CELLS * coarse.spacing().powi(2);
    let step = STEP * fine.spacing();
    // The fine node nearest to each river node, so that walks begin near their end.
    let mut nearest = vec![NodeId::new(0); coarse.len()];
    let mut last = NodeId::new(0);
    // Height of the river's surface: over a lake, that of the lake.
    let mut surface = vec![0.0; coarse.len()];
    for &node in flow.order() {
        let i = node.index();
        if flow.drainage()[i] < least {
            continue;
        }
        let Some(receiver) = flow.receiver(node) else {
            surface[i] = z[i];
            last = walk(fine, last, coarse.position(node) - origin);
            nearest[i] = last;
            continue;
        };
        let r = receiver.index();
        let (mouth, head) = (coarse.position(receiver) - origin, coarse.position(node) - origin);
        surface[i] = z[i].max(surface[r]);
        let steps = (mouth.distance(head) / step).ceil().max(1.0);
        let mut at = nearest[r];
        let depth = DEPTH * (flow.drainage()[i] / (KM * KM)).powf(DEEPER);
        for k in 0..=steps as usize {
            let part = k as f64 / steps;
            let p = mouth.lerp(head, part);
            at = walk(fine, at, p);
            if fine.extent().contains(p) {
                let bed = surface[r] + part * (surface[i] - surface[r]) - share(p) * depth;
                let height = &mut heights[at.index()];
                if bed < *height {
                    *height = bed;
                }
            }
        }
        nearest[i] = at;
    }
}

/// The node nearest to `p`: from any node there is a neighbour that is nearer, until there is none (Delaunay).
fn walk(tin: &Tin, from: NodeId, p: DVec2) -> NodeId {
    let (mut node, mut distance) = (from, tin.position(from).distance_squared(p));
    loop {
        let nearer = tin
            .neighbours(node)
            .map(|to| (to, tin.position(to).distance_squared(p)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match nearer {
            Some((to, less)) if less < distance => (node, distance) = (to, less),
            _ => return node,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::Outlets;
    use crate::units::Extent;

    const LAND: Extent = Extent {
        width: 20e3,
        height: 20e3,
    };

    #[test]
    fn a_walk_ends_at_the_nearest_node() {
        let tin = Tin::poisson(LAND, 500, 2).unwrap();
        for k in 0..200 {
            let p = DVec2::new(f64::from(k * 97 % 200) * 100.0, f64::from(k * 31 % 200) * 100.0);
            let nearest = tin.nodes().min_by(|&a, &b| {
                tin.position(a)
                    .distance(p)
                    .total_cmp(&tin.position(b).distance(p))
            });
            assert_eq!(Some(walk(&tin, NodeId::new(k as usize), p)), nearest);
        }
    }

    #[test]
    fn water_follows_the_rivers_of_the_coarse_land() {
        let coarse = Tin::poisson(LAND, 600, 1).unwrap();
        // A valley that winds northwards, closed on the other sides.
        let valley = |p: DVec2| {
            let middle = 10e3 + 4e3 * (p.y / 4e3).sin();
            (p.x - middle).abs() * 0.05 + (20e3 - p.y) * 0.005
        };
        let z: Vec<f64> = coarse.positions().iter().map(|&p| valley(p)).collect();
        let mut flow = Flow::new(&coarse);
        flow.route(&coarse, &z, Outlets::Border, None);
        let fine = Tin::poisson(LAND, 10_000, 5).unwrap();
        // On a rough plateau the rivers are the only thing that drains.
        let mut heights: Vec<f64> = fine
            .positions()
            .iter()
            .map(|p| 2000.0 + (p.x * 7.7).sin())
            .collect();
        lay_beds((&coarse, &z, &flow), &fine, DVec2::ZERO, |_| 1.0, &mut heights);
        let mut after = Flow::new(&fine);
        after.route(&fine, &heights, Outlets::Border, None);
        let least = 40.0 * coarse.spacing().powi(2);
        let rivers = |tin: &Tin, flow: &Flow, least: f64| -> Vec<DVec2> {
            tin.nodes()
                .filter(|node| flow.drainage()[node.index()] > least && !tin.is_border(*node))
                .map(|node| tin.position(node))
                .collect()
        };
        // The land between rivers is not the same: a half of the area is known anywhere along one.
        let (before, after) = (rivers(&coarse, &flow, least), rivers(&fine, &after, 0.5 * least));
        assert!(before.len() > 20, "{}", before.len());
        for p in before {
            let distance = after.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
            assert!(distance < 2.0 * fine.spacing(), "{distance} m at {p}");
        }
    }
}
