//! Landslides: slopes steeper than the talus fall back towards it, implicit in time.

use rayon::prelude::*;

use super::flow::steepest_below;
use super::tin::{NodeId, Tin};

/// Nodes per task of the parallel pass.
const CHUNK: usize = 16_384;

/// Mark of a node whose slope stands.
const STABLE: NodeId = NodeId(u32::MAX);

/// Flag of a node from which the way down leaves the block.
const LEAVING: u32 = 1 << 31;

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
    /// One for each block, and one for what crosses from block to block.
    chains: Vec<Chains>,
}

/// Nodes of one block, to slide one after the other.
#[derive(Clone, Debug, Default)]
struct Chains {
    /// From a node downwards.
    chain: Vec<NodeId>,
    /// Nodes from which the way down leaves the block.
    leaving: Vec<NodeId>,
}

/// Where and how far slopes slide.
pub(super) struct Slopes<'a, T, R> {
    pub(super) tin: &'a Tin,
    /// tan θ of a node.
    pub(super) talus: T,
    /// l Δt of a node, m; 0 and negative: the node stands.
    pub(super) reach: R,
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
        slid: impl FnMut(usize, usize, f64),
    ) {
        let slopes = Slopes { tin, talus, reach };
        self.find(&slopes, z);
        self.chains.clear();
        self.slide_across(&slopes, z, slid);
    }

    /// Finds where each node slides to.
    pub(super) fn find<T, R>(&mut self, slopes: &Slopes<'_, T, R>, z: &[f64])
    where
        T: Fn(usize) -> f64 + Sync,
        R: Fn(usize) -> f64 + Sync,
    {
        let Slopes { tin, talus, reach } = slopes;
        self.towards.resize(tin.len(), STABLE);
        self.towards
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, towards)| {
                let first = chunk * CHUNK;
                for (i, towards) in (first..).zip(towards) {
                    let moves = reach(i) > 0.0;
                    let steep = || steepest_below(tin, z, NodeId::new(i), talus(i));
                    *towards = if moves { steep().unwrap_or(STABLE) } else { STABLE };
                }
            });
    }

    /// Slides what comes to rest in its own block of so many nodes, blocks side by side: each has a `part` of what
    /// is told, by `slid`, about each moved node. [`Self::slide_across`] does the rest.
    pub(super) fn slide_in_blocks<T, R, P: Send>(
        &mut self,
        slopes: &Slopes<'_, T, R>,
        z: &mut [f64],
        size: usize,
        parts: &mut [P],
        slid: impl Fn(&mut P, usize, usize, f64) + Sync,
    ) where
        T: Fn(usize) -> f64 + Sync,
        R: Fn(usize) -> f64 + Sync,
    {
        self.chains.resize_with(parts.len(), Chains::default);
        (
            &mut self.chains,
            self.towards.par_chunks_mut(size),
            z.par_chunks_mut(size),
            parts,
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(k, (chains, towards, z, part))| {
                let starts = k * size..k * size + z.len();
                chains.leaving.clear();
                chains.slide(slopes, (towards, z), starts.start, starts, |i, below, depth| {
                    slid(part, i, below, depth);
                });
            });
    }

    /// Slides what has not slid in its own block.
    pub(super) fn slide_across<T, R>(
        &mut self,
        slopes: &Slopes<'_, T, R>,
        z: &mut [f64],
        slid: impl FnMut(usize, usize, f64),
    ) where
        T: Fn(usize) -> f64,
        R: Fn(usize) -> f64,
    {
        let mut whole = Chains::default();
        let towards = &mut self.towards[..];
        if self.chains.is_empty() {
            return whole.slide(slopes, (towards, z), 0, 0..slopes.tin.len(), slid);
        }
        let leaving = || {
            self.chains
                .iter()
                .flat_map(|chains| &chains.leaving)
                .map(|node| node.index())
        };
        for i in leaving() {
            towards[i].0 &= !LEAVING;
        }
        whole.slide(slopes, (towards, z), 0, leaving(), slid);
    }
}

impl Chains {
    /// Slides nodes after those that they slide towards; those whose way down leaves the block are only marked. Values
    /// are those of the nodes from `first` on.
    fn slide<T, R>(
        &mut self,
        slopes: &Slopes<'_, T, R>,
        (towards, z): (&mut [NodeId], &mut [f64]),
        first: usize,
        starts: impl Iterator<Item = usize>,
        mut slid: impl FnMut(usize, usize, f64),
    ) where
        T: Fn(usize) -> f64,
        R: Fn(usize) -> f64,
    {
        let Slopes { tin, talus, reach } = slopes;
        for start in starts {
            // Down to a node that stands or has slid already; then back up. Each step goes down, so it ends.
            let mut node = NodeId::new(start);
            let leaves = loop {
                match towards.get(node.index().wrapping_sub(first)) {
                    Some(&STABLE) => break false,
                    Some(&below) if below.0 & LEAVING == 0 => {
                        self.chain.push(node);
                        node = below;
                    }
                    _ => break true,
                }
            };
            if leaves {
                for node in self.chain.drain(..) {
                    towards[node.index() - first].0 |= LEAVING;
                    self.leaving.push(node);
                }
            }
            while let Some(node) = self.chain.pop() {
                let i = node.index();
                let below = std::mem::replace(&mut towards[i - first], STABLE);
                let distance = tin.distance(node, below);
                let stable_height = z[below.index() - first] + distance * talus(i);
                let excess = z[i - first] - stable_height;
                if excess > 0.0 {
                    let left = excess / (1.0 + reach(i) / distance);
                    z[i - first] = stable_height + left;
                    slid(i, below.index(), excess - left);
                }
            }
        }
    }
}
