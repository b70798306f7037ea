//! Water levels by flooding from the border: slow, short, and the measure for [`super::Lakes`].

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::tin::{NodeId, Tin};

/// A node the flood has reached, ordered by level, then by id.
#[derive(PartialEq)]
struct Reached {
    level: f64,
    node: NodeId,
}

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        self.level
            .total_cmp(&other.level)
            .then(self.node.cmp(&other.node))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The level to which water stands at each node when it may leave at all border nodes: the lowest, over all paths
/// to the border, of the highest point on the path (priority-flood, Barnes, Lehman & Mulla 2014).
pub fn priority_flood(tin: &Tin, z: &[f64]) -> Vec<f64> {
    let mut levels = vec![f64::NAN; tin.len()];
    let mut reached = vec![false; tin.len()];
    let mut flood = BinaryHeap::new();
    for node in tin.nodes().filter(|&node| tin.is_border(node)) {
        reached[node.index()] = true;
        flood.push(Reverse(Reached {
            level: z[node.index()],
            node,
        }));
    }
    while let Some(Reverse(Reached { level, node })) = flood.pop() {
        levels[node.index()] = level;
        for node in tin.neighbours(node) {
            if !std::mem::replace(&mut reached[node.index()], true) {
                flood.push(Reverse(Reached {
                    level: level.max(z[node.index()]),
                    node,
                }));
            }
        }
    }
    levels
}
