//! Landslides: slopes steeper than the talus fall back towards it, implicit in time.

use rayon::prelude::*;

use super::flow::steepest_below;
use super::tin::{NodeId, Tin};

/// Nodes per task of the parallel pass.
const CHUNK: usize = 16_384;

/// Mark of a node whose slope stands.
const STABLE: NodeId = NodeId(u32::MAX);

/// The landslide law ∂z/∂t = −l (s − tan θ) where the slope s > tan θ (Cordonnier et al. 2018, §6.1; the sign as its
/// text means it).
///
/// Implicit: with q the steepest lower neighbour at distance r, z′ = (z + c (z′_q + r tan θ)) / (1 + c), c = l Δt / r,
/// after q has got its own new height. The slope nears the talus from above by the factor 1 + c per step and never
/// falls below it, whatever the time step.
#[derive(Clone, Debug, Default)]
pub struct Landslides {
    /// Steepest lower neighbour of nodes that slide.
    towards: Vec<NodeId>,
    chain: Vec<NodeId>,
}

impl Landslides {
    /// Lets slopes of `z` fall for one step and calls `slid` with each moved node, the node it slid towards, and its
    /// loss of height (m).
    ///
    /// `talus` is tan θ of a node; `reach` its l Δt in metres (0 and negative: the node stands).
    pub fn step(
        &mut self,
        tin: &Tin,
        z: &mut [f64],
        talus: impl Fn(usize) -> f64 + Sync,
        reach: impl Fn(usize) -> f64 + Sync,
        mut slid: impl FnMut(usize, usize, f64),
    ) {
        let heights = &*z;
        self.towards.resize(tin.len(), STABLE);
        self.towards
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, towards)| {
                let first = chunk * CHUNK;
                for (i, towards) in (first..).zip(towards) {
                    let moves = reach(i) > 0.0;
                    let steep = || steepest_below(tin, heights, NodeId::new(i), talus(i));
                    *towards = if moves { steep().unwrap_or(STABLE) } else { STABLE };
                }
            });
        for start in tin.nodes() {
            // Down to a node that stands or has slid already; then back up. Each step goes down, so it ends.
            let mut node = start;
            while self.towards[node.index()] != STABLE {
                self.chain.push(node);
                node = self.towards[node.index()];
            }
            while let Some(node) = self.chain.pop() {
                let i = node.index();
                let below = std::mem::replace(&mut self.towards[i], STABLE);
                let distance = tin.distance(node, below);
                let stable_height = z[below.index()] + distance * talus(i);
                let excess = z[i] - stable_height;
                if excess > 0.0 {
                    let left = excess / (1.0 + reach(i) / distance);
                    z[i] = stable_height + left;
                    slid(i, below.index(), excess - left);
                }
            }
        }
    }
}
