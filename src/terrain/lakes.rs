//! Lakes: flow through closed basins, by the basin graph (Cordonnier, Bovy & Braun 2019, *A versatile, linear
//! complexity algorithm for flow routing in topographies with depressions*, esurf 7, 549–562).
//!
//! Nodes that drain to the same pit form a basin; all basins with an outlet count as one, the *outside*. A pass is a
//! link between two basins, as high as its higher end. The minimum spanning tree of basins and passes holds, for each
//! basin, the lowest way out; its highest pass is the basin's spill level, which equals the level that a flood from
//! the border would leave there (Barnes et al. 2014), to the bit. Flow is *carved*: the path from the pass down to
//! the pit is reversed, so rivers cross a lake along its former bed.

use rayon::prelude::*;

use super::basin_graph::{BasinGraph, Pass, spread_downstream};
use super::tin::{NodeId, Tin};

/// The basin of all nodes that reach an outlet by going down.
const OUTSIDE: u32 = 0;

/// Label of a node whose basin is not known yet.
const UNLABELLED: u32 = u32::MAX;

/// End of a list, or nothing yet.
const NONE: u32 = u32::MAX;

/// Nodes per task of the parallel passes. Labels and passes are the same however the land is cut.
const CHUNK: usize = 16_384;

/// Flag of a label that stands for a way out of a chunk.
const LEAVING: u32 = 1 << 31;

/// What is found in one chunk of the land.
#[derive(Clone, Debug, Default)]
struct Chunk {
    pits: Vec<NodeId>,
    /// Where paths leave the chunk: the nodes they go to.
    exits: Vec<NodeId>,
    passes: Vec<Pass>,
}

/// The closed basins of a surface and the levels to which they fill.
#[derive(Clone, Debug, Default)]
pub struct Lakes {
    /// Basin of each node; empty where there is no pit.
    basin: Vec<u32>,
    /// Level to which each basin fills, m; −∞ outside.
    spill: Vec<f64>,
    /// The lake each basin belongs to: basins under one water surface share it.
    lake: Vec<u32>,
    /// Whether each lake has any depth: on a plain, water at the level of the ground is no lake.
    wet: Vec<bool>,
    pits: Vec<NodeId>,
    graph: BasinGraph,
    ends: PassEnds,
    queue: Vec<u32>,
    chunks: Vec<Chunk>,
    /// Labels at the exits of all chunks.
    beyond: Vec<u32>,
}

impl Lakes {
    /// Finds the closed basins of `z` and turns `receivers`, steepest descents so far, towards their ways out.
    pub(super) fn resolve(&mut self, tin: &Tin, z: &[f64], receivers: &mut [NodeId]) {
        self.basin.clear();
        self.spill.clear();
        self.lake.clear();
        self.wet.clear();
        self.pits.clear();
        self.find_pits(tin, receivers);
        if self.pits.is_empty() {
            return;
        }
        self.label(receivers);
        self.find_passes(tin, z);
        let chunks = &self.chunks;
        self.graph.span(self.pits.len() + 1, |visit| {
            chunks
                .iter()
                .flat_map(|chunk| &chunk.passes)
                .for_each(|&pass| visit(pass));
        });
        self.carve(z, receivers);
    }

    fn find_pits(&mut self, tin: &Tin, receivers: &[NodeId]) {
        self.chunks
            .resize_with(receivers.len().div_ceil(CHUNK), Chunk::default);
        self.chunks.par_iter_mut().enumerate().for_each(|(k, chunk)| {
            let first = k * CHUNK;
            let nodes = (first..).zip(&receivers[first..]).take(CHUNK);
            let ends = |&(i, receiver): &(usize, &NodeId)| receiver.index() == i && !tin.border()[i];
            chunk.pits.clear();
            chunk.pits.extend(nodes.filter(ends).map(|(_, &pit)| pit));
        });
        for chunk in &self.chunks {
            self.pits.extend(&chunk.pits);
        }
    }

    /// Basins are numbered by pit, from 1; nodes whose path ends at none are outside.
    fn label(&mut self, receivers: &[NodeId]) {
        self.basin.resize(receivers.len(), UNLABELLED);
        let firsts = begins(&self.chunks, 1, |chunk| chunk.pits.len());
        (self.basin.par_chunks_mut(CHUNK), &mut self.chunks, firsts)
            .into_par_iter()
            .enumerate()
            .for_each(|(k, (basin, chunk, number))| chunk.label(receivers, k * CHUNK, number as u32, basin));
        // A path that leaves its chunk has the label of where it goes, which may be to leave that chunk too.
        let begins = begins(&self.chunks, 0, |chunk| chunk.exits.len());
        let basin = &self.basin;
        let target = |exit: NodeId| {
            let label = basin[exit.index()];
            (label & LEAVING != 0).then(|| begins[exit.index() / CHUNK] + (label & !LEAVING) as usize)
        };
        let exits: Vec<NodeId> = self
            .chunks
            .iter()
            .flat_map(|chunk| &chunk.exits)
            .copied()
            .collect();
        self.beyond.clear();
        self.beyond.extend(exits.iter().map(|exit| match target(*exit) {
            Some(_) => UNLABELLED,
            None => basin[exit.index()],
        }));
        spread_downstream(&mut self.beyond, UNLABELLED, |k| target(exits[k]).unwrap_or(k));
        let beyond = &self.beyond;
        (self.basin.par_chunks_mut(CHUNK), begins)
            .into_par_iter()
            .for_each(|(basin, begin)| {
                for label in basin.iter_mut().filter(|label| **label & LEAVING != 0) {
                    *label = beyond[begin + (*label & !LEAVING) as usize];
                }
            });
    }

    /// All links out of closed basins, each once, and the border nodes inside them.
    fn find_passes(&mut self, tin: &Tin, z: &[f64]) {
        let basin = &self.basin;
        self.chunks.par_iter_mut().enumerate().for_each(|(k, chunk)| {
            let nodes = k * CHUNK..((k + 1) * CHUNK).min(tin.len());
            chunk.passes.clear();
            each_pass(tin, z, basin, nodes, |pass| chunk.passes.push(pass));
        });
    }

    /// Walks the tree from the outside inwards: levels, lakes, and reversed paths.
    fn carve(&mut self, z: &[f64], receivers: &mut [NodeId]) {
        let basins = self.pits.len() + 1;
        let tree = self.graph.tree();
        self.ends.list(tree, |pass| {
            [self.basin[pass.inner.index()], outer_basin(&self.basin, pass)]
        });
        self.spill.resize(basins, f64::NEG_INFINITY);
        self.lake.resize(basins, NONE);
        self.queue.clear();
        self.queue.push(OUTSIDE);
        let mut reached = 0;
        while let Some(&basin) = self.queue.get(reached) {
            reached += 1;
            let level = self.spill[basin as usize];
            let mut end = self.ends.first[basin as usize];
            while end != NONE {
                let pass = tree[end as usize / 2];
                // Even ends are inner ones: the other basin then is the outer one.
                let (other, mouth, towards) = if end.is_multiple_of(2) {
                    (outer_basin(&self.basin, &pass), pass.outer, pass.inner)
                } else {
                    (self.basin[pass.inner.index()], pass.inner, pass.outer)
                };
                end = self.ends.next[end as usize];
                if other == OUTSIDE || self.lake[other as usize] != NONE {
                    continue;
                }
                self.spill[other as usize] = pass.height.max(level);
                // A pass under the water of the basin below joins the two into one lake.
                let lake = if basin != OUTSIDE && pass.height <= level {
                    self.lake[basin as usize]
                } else {
                    self.wet.push(false);
                    self.wet.len() as u32 - 1
                };
                self.lake[other as usize] = lake;
                let deepest = z[self.pits[other as usize - 1].index()];
                self.wet[lake as usize] |= deepest < self.spill[other as usize];
                reverse_path(receivers, mouth, towards);
                self.queue.push(other);
            }
        }
    }

    /// True if the surface has any closed basin.
    pub fn any(&self) -> bool {
        !self.pits.is_empty()
    }

    /// Number of separate water surfaces above ground.
    pub fn count(&self) -> usize {
        self.wet.iter().filter(|&&wet| wet).count()
    }

    /// Number of water surfaces, with those that have no depth: [`Self::lake`] is below it.
    pub(super) fn surfaces(&self) -> usize {
        self.wet.len()
    }

    /// The water surface in whose closed basin a node lies, dry or not; none outside.
    pub(super) fn surface_of(&self, node: NodeId) -> Option<u32> {
        let &basin = self.basin.get(node.index())?;
        (basin != OUTSIDE).then(|| self.lake[basin as usize])
    }

    /// The level to which water stands at a node whose height was `z` when routed: `z` itself where it is dry.
    pub fn level(&self, node: NodeId, z: f64) -> f64 {
        match self.basin.get(node.index()) {
            Some(&basin) => z.max(self.spill[basin as usize]),
            None => z,
        }
    }

    /// The lake over a node whose height was `z` when routed; none where it is dry.
    pub fn lake(&self, node: NodeId, z: f64) -> Option<u32> {
        let &basin = self.basin.get(node.index())?;
        (z < self.spill[basin as usize]).then(|| self.lake[basin as usize])
    }
}

/// The numbers with which the items of each chunk begin.
fn begins(chunks: &[Chunk], from: usize, items: impl Fn(&Chunk) -> usize) -> Vec<usize> {
    let mut next = from;
    let mut begins = Vec::with_capacity(chunks.len());
    for chunk in chunks {
        begins.push(next);
        next += items(chunk);
    }
    begins
}

impl Chunk {
    /// Labels the nodes from `first` on, whose pits are numbered from `number` on.
    fn label(&mut self, receivers: &[NodeId], first: usize, number: u32, basin: &mut [u32]) {
        let receivers = &receivers[first..first + basin.len()];
        for (k, (label, receiver)) in basin.iter_mut().zip(receivers).enumerate() {
            *label = if receiver.index() == first + k {
                OUTSIDE
            } else {
                UNLABELLED
            };
        }
        for (number, pit) in (number..).zip(&self.pits) {
            basin[pit.index() - first] = number;
        }
        self.exits.clear();
        for start in 0..basin.len() {
            let mut end = start;
            while basin[end] == UNLABELLED {
                let next = receivers[end].index().wrapping_sub(first);
                if next < basin.len() {
                    end = next;
                } else {
                    basin[end] = LEAVING | self.exits.len() as u32;
                    self.exits.push(receivers[end]);
                }
            }
            let label = basin[end];
            let mut place = start;
            while basin[place] == UNLABELLED {
                basin[place] = label;
                place = receivers[place].index() - first;
            }
        }
    }
}

/// All links out of closed basins from the given nodes, each once, and the border nodes inside them.
fn each_pass(
    tin: &Tin,
    z: &[f64],
    basin: &[u32],
    nodes: std::ops::Range<usize>,
    mut visit: impl FnMut(Pass),
) {
    for node in nodes.map(NodeId::new) {
        let i = node.index();
        let inside = basin[i];
        if inside == OUTSIDE {
            continue;
        }
        if tin.is_border(node) {
            visit(Pass {
                height: z[i],
                inner: node,
                outer: node,
                basins: [inside, OUTSIDE],
            });
        }
        for outer in tin.neighbours(node) {
            let beyond = basin[outer.index()];
            if beyond < inside {
                visit(Pass {
                    height: z[i].max(z[outer.index()]),
                    inner: node,
                    outer,
                    basins: [inside, beyond],
                });
            }
        }
    }
}

/// The basin at the outer end of a pass.
fn outer_basin(basin: &[u32], pass: &Pass) -> u32 {
    if pass.inner == pass.outer {
        OUTSIDE
    } else {
        basin[pass.outer.index()]
    }
}

/// The passes at each basin, as linked lists: end 2k of pass k is its inner one, end 2k + 1 its outer one.
#[derive(Clone, Debug, Default)]
struct PassEnds {
    first: Vec<u32>,
    next: Vec<u32>,
}

impl PassEnds {
    /// Lists the ends of a tree's passes; a tree of k passes has k + 1 basins.
    fn list(&mut self, tree: &[Pass], basins_of: impl Fn(&Pass) -> [u32; 2]) {
        self.first.clear();
        self.first.resize(tree.len() + 1, NONE);
        self.next.clear();
        for pass in tree {
            for basin in basins_of(pass) {
                let end = self.next.len() as u32;
                self.next
                    .push(std::mem::replace(&mut self.first[basin as usize], end));
            }
        }
    }
}

/// Turns the flow along the path from `mouth` to its pit: it leaves the basin at `mouth` `towards` the outside.
fn reverse_path(receivers: &mut [NodeId], mouth: NodeId, towards: NodeId) {
    let (mut node, mut receiver) = (mouth, towards);
    loop {
        let next = std::mem::replace(&mut receivers[node.index()], receiver);
        if next == node {
            return;
        }
        (receiver, node) = (node, next);
    }
}
