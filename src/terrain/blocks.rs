//! River networks in blocks: what lets several cores sweep over one land.
//!
//! A block is a run of consecutive nodes; where nodes are numbered along a curve it is a patch of land. A node whose
//! whole catchment lies in its own block belongs to the block's *headwaters*; all others are the *trunk*, a small part
//! of the land that holds the receivers of all its nodes. Sweeps from the sources down take the headwaters of all
//! blocks side by side and then the trunk; sweeps from the outlets up take the trunk first. Blocks have a fixed size,
//! so every sum has one order, and with it the same bits, for any number of threads. A land of one block is all trunk.

use rayon::prelude::*;

use super::tin::NodeId;

/// Nodes per block: what a sweep needs of them about fills a core's own cache.
pub(super) const BLOCK: usize = 131_072;

/// Flag of a node that belongs to the trunk whatever drains to it.
const HELD: u32 = 1 << 31;

/// Mark of a node that has passed its water on.
const DONE: u32 = u32::MAX;

/// One block of a network.
#[derive(Clone, Debug, Default)]
struct Block {
    /// Number of its headwaters.
    headwaters: usize,
    /// Where its headwaters leave the block: their receivers, from the sources down.
    exits: Vec<NodeId>,
    /// The water that leaves there.
    carried: Vec<f64>,
    /// Where any of its nodes leaves the block: their receivers.
    outflows: Vec<NodeId>,
    /// Its nodes that are held in the trunk.
    held: Vec<NodeId>,
}

/// Which nodes of an order are the trunk, and which are whose headwaters.
#[derive(Clone, Debug)]
pub(super) struct Blocks {
    size: usize,
    /// Number of trunk nodes: they come first in the order.
    trunk: usize,
    /// Empty where the land is one block.
    parts: Vec<Block>,
}

impl Block {
    /// Nodes at which the trunk may begin.
    fn trunk_sources(&self) -> impl Iterator<Item = &NodeId> {
        self.outflows.iter().chain(&self.held)
    }
}

impl Blocks {
    pub(super) fn new(size: usize) -> Self {
        Self {
            size,
            trunk: 0,
            parts: Vec::new(),
        }
    }

    /// Nodes per block.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Sorts nodes into an `order` where each comes after its receiver, and adds each one's `drainage` to its
    /// receiver's. `pending` is scratch memory. Nodes that are `held` are put into the trunk.
    pub(super) fn sort(
        &mut self,
        receivers: &[NodeId],
        order: &mut [NodeId],
        drainage: &mut [f64],
        pending: &mut [u32],
        held: impl Fn(NodeId) -> bool + Sync,
    ) {
        let n = receivers.len();
        if n <= self.size {
            self.parts.clear();
            self.trunk = n;
            count_donors(receivers, 0, pending, |_| {});
            return drain(receivers, 0..n, order, drainage, pending);
        }
        self.parts.resize_with(n.div_ceil(self.size), Block::default);
        self.find_trunk(receivers, pending, held);
        self.drain_headwaters(receivers, order, drainage, pending);
        for block in &self.parts {
            for (to, water) in block.exits.iter().zip(&block.carried) {
                drainage[to.index()] += water;
                pending[to.index()] -= 1;
            }
        }
        self.trunk = n - self.parts.iter().map(|block| block.headwaters).sum::<usize>();
        self.gather(order);
        let sources = self
            .parts
            .iter()
            .flat_map(Block::trunk_sources)
            .map(|node| node.index());
        drain(receivers, sources, &mut order[..self.trunk], drainage, pending);
    }

    /// Counts donors, and marks the nodes where the trunk begins.
    fn find_trunk(
        &mut self,
        receivers: &[NodeId],
        pending: &mut [u32],
        held: impl Fn(NodeId) -> bool + Sync,
    ) {
        let size = self.size;
        self.parts
            .par_iter_mut()
            .zip(pending.par_chunks_mut(size))
            .enumerate()
            .for_each(|(k, (block, pending))| {
                let first = k * size;
                block.outflows.clear();
                block.held.clear();
                count_donors(&receivers[first..], first, pending, |to| block.outflows.push(to));
                for (node, pending) in (first..).map(NodeId::new).zip(pending) {
                    if held(node) {
                        *pending |= HELD;
                        block.held.push(node);
                    }
                }
            });
        for to in self.parts.iter().flat_map(|block| &block.outflows) {
            let pending = &mut pending[to.index()];
            *pending = (*pending + 1) | HELD;
        }
    }

    /// Sweeps down over the headwaters of each block; they end up at the end of the block's part of the order.
    fn drain_headwaters(
        &mut self,
        receivers: &[NodeId],
        order: &mut [NodeId],
        drainage: &mut [f64],
        pending: &mut [u32],
    ) {
        let size = self.size;
        self.parts
            .par_iter_mut()
            .zip(order.par_chunks_mut(size))
            .zip(drainage.par_chunks_mut(size))
            .zip(pending.par_chunks_mut(size))
            .enumerate()
            .for_each(|(k, (((block, order), drainage), pending))| {
                let first = k * size;
                block.exits.clear();
                block.carried.clear();
                // One length, one check of bounds.
                let nodes = pending.len();
                let (receivers, drainage) = (&receivers[first..first + nodes], &mut drainage[..nodes]);
                let mut slots = order.iter_mut().rev();
                for source in 0..nodes {
                    let mut i = source;
                    while pending[i] == 0 {
                        pending[i] = DONE;
                        if let Some(slot) = slots.next() {
                            *slot = NodeId::new(first + i);
                        }
                        let receiver = receivers[i];
                        let below = receiver.index().wrapping_sub(first);
                        if below == i {
                            break;
                        }
                        let water = drainage[i];
                        let Some(waiting) = pending.get_mut(below) else {
                            block.exits.push(receiver);
                            block.carried.push(water);
                            break;
                        };
                        *waiting -= 1;
                        drainage[below] += water;
                        i = below;
                    }
                }
                block.headwaters = nodes - slots.len();
            });
    }

    /// Moves headwaters to the end of the order, so that those of all blocks lie side by side.
    fn gather(&self, order: &mut [NodeId]) {
        let mut end = order.len();
        for (k, block) in self.parts.iter().enumerate().rev() {
            let block_end = ((k + 1) * self.size).min(order.len());
            order.copy_within(block_end - block.headwaters..block_end, end - block.headwaters);
            end -= block.headwaters;
        }
    }

    /// The trunk in a sweep over all values of the land.
    pub(super) fn trunk<'a>(&self, order: &'a [NodeId]) -> Stretch<'a> {
        Stretch::whole(&order[..self.trunk])
    }

    /// The headwaters of each block. For sweeps from the outlets up, `beyond` is filled with the value at each receiver
    /// that lies outside its donor's block.
    pub(super) fn headwaters<'a>(
        &self,
        order: &'a [NodeId],
        beyond: &'a mut Vec<Vec<f64>>,
        value: impl Fn(usize) -> f64,
    ) -> Vec<Stretch<'a>> {
        beyond.resize_with(self.parts.len(), Vec::new);
        let mut begin = self.trunk;
        let blocks = self.parts.iter().zip(beyond).enumerate();
        let stretch = |(k, (block, beyond)): (usize, (&Block, &'a mut Vec<f64>))| {
            beyond.clear();
            beyond.extend(block.exits.iter().map(|to| value(to.index())));
            let end = begin + block.headwaters;
            let order = &order[std::mem::replace(&mut begin, end)..end];
            Stretch {
                order,
                first: k * self.size,
                beyond,
            }
        };
        blocks.map(stretch).collect()
    }

    /// Where the headwaters of each block leave it, in the order of a sweep from the sources down.
    pub(super) fn exits(&self) -> impl Iterator<Item = &[NodeId]> {
        self.parts.iter().map(|block| &block.exits[..])
    }
}

/// The trunk or the headwaters of one block, in a sweep over the values of the land or the block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch<'a> {
    /// Its nodes, each after its receiver.
    pub(super) order: &'a [NodeId],
    /// The node of the first value.
    pub(super) first: usize,
    /// Values at receivers outside the block, the last one first when sweeping up.
    beyond: &'a [f64],
}

impl<'a> Stretch<'a> {
    /// All nodes of an order.
    pub(super) fn whole(order: &'a [NodeId]) -> Self {
        Self {
            order,
            first: 0,
            beyond: &[],
        }
    }

    /// In a sweep from the outlets up, the value at the next node's receiver.
    #[inline]
    pub(super) fn below(&mut self, receiver: usize, values: &[f64]) -> f64 {
        values
            .get(receiver.wrapping_sub(self.first))
            .copied()
            .unwrap_or_else(|| self.next_beyond())
    }

    /// In a sweep from the outlets up, the value at the next receiver outside the block.
    #[cold]
    pub(super) fn next_beyond(&mut self) -> f64 {
        let Some((&value, rest)) = self.beyond.split_last() else {
            return f64::NAN;
        };
        self.beyond = rest;
        value
    }
}

/// The sum of a value over so many nodes, block by block.
pub(super) fn sum_in_blocks(nodes: usize, size: usize, value: impl Fn(usize) -> f64 + Sync) -> f64 {
    let sum = |k: usize| (k * size..nodes.min((k + 1) * size)).map(&value).sum::<f64>();
    let sums: Vec<f64> = (0..nodes.div_ceil(size)).into_par_iter().map(sum).collect();
    sums.iter().sum()
}

/// Counts how many of the nodes from `first` on drain to each of them; hands on receivers that are not among them.
fn count_donors(receivers: &[NodeId], first: usize, pending: &mut [u32], mut outflow: impl FnMut(NodeId)) {
    pending.fill(0);
    for (i, &receiver) in receivers.iter().enumerate().take(pending.len()) {
        let below = receiver.index().wrapping_sub(first);
        match pending.get_mut(below) {
            Some(pending) => *pending += u32::from(below != i),
            None => outflow(receiver),
        }
    }
}

/// From each source downstream, as long as all donors of the next node have passed on their water. Short walks between
/// memory neighbours, and no list of donors. The order is filled from its end: donors are met before receivers.
fn drain(
    receivers: &[NodeId],
    sources: impl Iterator<Item = usize>,
    order: &mut [NodeId],
    drainage: &mut [f64],
    pending: &mut [u32],
) {
    // One length, one check of bounds.
    let n = receivers.len();
    let (drainage, pending) = (&mut drainage[..n], &mut pending[..n]);
    let mut slots = order.iter_mut().rev();
    for source in sources {
        let mut i = source;
        while pending[i] & !HELD == 0 {
            pending[i] = DONE;
            if let Some(slot) = slots.next() {
                *slot = NodeId::new(i);
            }
            let receiver = receivers[i].index();
            if receiver == i {
                break;
            }
            drainage[receiver] += drainage[i];
            pending[receiver] -= 1;
            i = receiver;
        }
    }
}

#[cfg(test)]
mod tests;
