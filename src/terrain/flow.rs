//! Flow routing: each node's receiver, an order from the outlets upstream, and drainage areas.

use rayon::prelude::*;

use super::blocks::{BLOCK, Blocks};
use super::lakes::Lakes;
use super::params::Edges;
use super::tin::{Link, NodeId, Tin};

/// Nodes per task of the parallel passes. They are maps without sums, so any cut gives the same bits.
const CHUNK: usize = 16_384;

/// How water moves over a surface, in vectors that are reused from one call to the next.
///
/// * Each node drains to the neighbour of steepest descent; ties go to the smaller [`NodeId`].
/// * On level ground water goes to the neighbour of the same height with the smallest id below the node's own, as if
///   ids were tiny heights: a plain drains without a lake per node.
/// * Nodes without a lower neighbour, away from the border, are pits: [`Lakes`] turns their basins' flow towards the
///   lowest way out.
/// * Outlets drain to themselves: all border nodes when [`Outlets::Border`], and when [`Outlets::Lowest`] those
///   where no neighbour is lower or where a lake spills over the border.
///
/// Cost is linear in the nodes, whatever the number of lakes.
#[derive(Clone, Debug)]
pub struct Flow {
    receivers: Vec<NodeId>,
    order: Vec<NodeId>,
    drainage: Vec<f64>,
    /// Donors that have not yet passed their water on, while the order is made.
    pending: Vec<u32>,
    lakes: Lakes,
    blocks: Blocks,
}

/// Which border nodes are outlets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outlets {
    /// Every border node.
    Border,
    /// Only those border nodes that have no lower neighbour, or that a lake spills over.
    Lowest,
}

impl From<Edges> for Outlets {
    fn from(edges: Edges) -> Self {
        match edges {
            Edges::Fixed => Self::Border,
            Edges::Free => Self::Lowest,
        }
    }
}

impl Flow {
    /// Memory for a TIN; nothing is routed yet.
    pub fn new(tin: &Tin) -> Self {
        Self::in_blocks(tin, BLOCK)
    }

    /// Memory for a TIN whose blocks have so many nodes.
    pub(super) fn in_blocks(tin: &Tin, block: usize) -> Self {
        let n = tin.len();
        Self {
            receivers: vec![NodeId(0); n],
            order: vec![NodeId(0); n],
            drainage: vec![0.0; n],
            pending: vec![0; n],
            lakes: Lakes::default(),
            blocks: Blocks::new(block),
        }
    }

    /// Routes water over heights `z` (m). `rain` scales what falls on each node's cell; none means 1 everywhere.
    ///
    /// # Panics
    /// If a slice does not hold one value per node. Heights that are not finite are no reason to panic.
    pub fn route(&mut self, tin: &Tin, z: &[f64], outlets: Outlets, rain: Option<&[f64]>) {
        self.route_with(tin, z, outlets, rain, false);
    }

    /// Like [`Self::route`]; if `lakes_in_trunk`, what lies under water is put into the trunk of the network.
    pub(super) fn route_with(
        &mut self,
        tin: &Tin,
        z: &[f64],
        outlets: Outlets,
        rain: Option<&[f64]>,
        lakes_in_trunk: bool,
    ) {
        assert_eq!(z.len(), tin.len(), "one height per node");
        self.descend(tin, z, outlets);
        self.lakes.resolve(tin, z, &mut self.receivers);
        self.rain_on(tin, rain);
        let held = |node: NodeId| lakes_in_trunk && self.lakes.lake(node, z[node.index()]).is_some();
        self.blocks.sort(
            &self.receivers,
            &mut self.order,
            &mut self.drainage,
            &mut self.pending,
            held,
        );
    }

    /// Receivers by steepest descent.
    fn descend(&mut self, tin: &Tin, z: &[f64], outlets: Outlets) {
        self.receivers
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, receivers)| {
                let first = chunk * CHUNK;
                for (node, receiver) in (first..).map(NodeId::new).zip(receivers) {
                    *receiver = if outlets == Outlets::Border && tin.is_border(node) {
                        node
                    } else {
                        steepest_below(tin, z, node, 0.0)
                            .or_else(|| level_below(tin, z, node))
                            .unwrap_or(node)
                    };
                }
            });
    }

    fn rain_on(&mut self, tin: &Tin, rain: Option<&[f64]>) {
        match rain {
            None => self.drainage.copy_from_slice(tin.areas()),
            Some(rain) => {
                assert_eq!(rain.len(), tin.len(), "one rain factor per node");
                for (drainage, (area, rain)) in self.drainage.iter_mut().zip(tin.areas().iter().zip(rain)) {
                    *drainage = area * rain;
                }
            }
        }
    }

    /// Where each node's water goes; outlets name themselves.
    pub fn receivers(&self) -> &[NodeId] {
        &self.receivers
    }

    /// Where a node's water goes; none at outlets.
    pub fn receiver(&self, node: NodeId) -> Option<NodeId> {
        let receiver = self.receivers[node.index()];
        (receiver != node).then_some(receiver)
    }

    /// Every node once, each after its receiver.
    pub fn order(&self) -> &[NodeId] {
        &self.order
    }

    /// Drainage area of each node, its own cell included, m² (times the rain factor).
    pub fn drainage(&self) -> &[f64] {
        &self.drainage
    }

    /// The lakes of the surface that was routed.
    pub fn lakes(&self) -> &Lakes {
        &self.lakes
    }

    /// How sweeps over the network are cut.
    pub(super) fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    /// Checks that the order holds each node once and after its receiver, and that all water leaves at the border.
    ///
    /// # Errors
    /// What is broken, in words.
    pub fn sanity_check(&self, tin: &Tin) -> Result<(), String> {
        let mut place = vec![usize::MAX; tin.len()];
        for (k, node) in self.order.iter().enumerate() {
            if place[node.index()] != usize::MAX {
                return Err(format!("{node:?} is twice in the order"));
            }
            place[node.index()] = k;
        }
        for node in tin.nodes() {
            match self.receiver(node) {
                None if !tin.is_border(node) => return Err(format!("{node:?} ends its river inland")),
                Some(receiver) if place[receiver.index()] >= place[node.index()] => {
                    return Err(format!("{node:?} comes before its receiver {receiver:?}"));
                }
                Some(receiver) if !tin.neighbours(node).any(|k| k == receiver) => {
                    return Err(format!("{node:?} drains to {receiver:?}, which is no neighbour"));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// The neighbour of the same height with the smallest id, if that is smaller than the node's. Border nodes have none:
/// they let water out.
fn level_below(tin: &Tin, z: &[f64], node: NodeId) -> Option<NodeId> {
    let level = |to: &NodeId| *to < node && z[to.index()] == z[node.index()];
    if tin.is_border(node) {
        return None;
    }
    tin.neighbours(node).filter(level).min()
}

/// The neighbour towards which the descent is steepest, if it is steeper than `slope` (≥ 0); ties go to the smaller id.
#[inline]
pub(super) fn steepest_below(tin: &Tin, z: &[f64], node: NodeId, slope: f64) -> Option<NodeId> {
    let height = z[node.index()];
    let descent = |link: &Link| (height - z[link.to.index()]) * f64::from(link.inverse_distance);
    // Which neighbour wins is a coin toss to the processor, so the loop has no branches; ties are rare and wait.
    let (mut steepest, mut found, mut tie) = (slope, None, false);
    for link in tin.links(node) {
        let descent = descent(link);
        let better = descent > steepest;
        tie |= descent == steepest;
        found = if better { Some(link.to) } else { found };
        steepest = if better { descent } else { steepest };
    }
    if tie && found.is_some() {
        found = tin
            .links(node)
            .iter()
            .filter(|link| descent(link) == steepest)
            .map(|link| link.to)
            .min();
    }
    found
}
