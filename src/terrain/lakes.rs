//! Lakes: flow through closed basins, by the basin graph (Cordonnier, Bovy & Braun 2019, *A versatile, linear
//! complexity algorithm for flow routing in topographies with depressions*, esurf 7, 549–562).
//!
//! Nodes that drain to the same pit form a basin; all basins with an outlet count as one, the *outside*. A pass is a
//! link between two basins, as high as its higher end. The minimum spanning tree of basins and passes holds, for each
//! basin, the lowest way out; its highest pass is the basin's spill level, which equals the level that a flood from
//! the border would leave there (Barnes et al. 2014), to the bit. Flow is *carved*: the path from the pass down to
//! the pit is reversed, so rivers cross a lake along its former bed.

use super::tin::{NodeId, Tin};

/// The basin of all nodes that reach an outlet by going down.
const OUTSIDE: u32 = 0;

/// Label of a node whose basin is not known yet.
const UNLABELLED: u32 = u32::MAX;

/// End of a list, or nothing yet.
const NONE: u32 = u32::MAX;

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
    passes: Vec<Pass>,
    /// The spanning tree.
    tree: Vec<Pass>,
    ends: PassEnds,
    union: UnionFind,
    queue: Vec<u32>,
}

/// A way from one basin to another.
#[derive(Clone, Copy, Debug)]
struct Pass {
    height: f64,
    /// Its end in the basin.
    inner: NodeId,
    /// Its end in the other basin; `inner` itself where water falls over the border.
    outer: NodeId,
}

impl Lakes {
    /// Finds the closed basins of `z` and turns `receivers`, steepest descents so far, towards their ways out.
    pub(super) fn resolve(&mut self, tin: &Tin, z: &[f64], receivers: &mut [NodeId]) {
        self.basin.clear();
        self.spill.clear();
        self.lake.clear();
        self.wet.clear();
        self.pits.clear();
        let ends = |&(i, receiver): &(usize, &NodeId)| receiver.index() == i && !tin.border()[i];
        let pits = receivers.iter().enumerate().filter(ends).map(|(_, &pit)| pit);
        self.pits.extend(pits);
        if self.pits.is_empty() {
            return;
        }
        self.label(receivers);
        self.find_passes(tin, z);
        self.span();
        self.carve(z, receivers);
    }

    /// Basins are numbered by pit, from 1. Each walk downstream ends at a labelled node and labels its path.
    fn label(&mut self, receivers: &[NodeId]) {
        self.basin.resize(receivers.len(), UNLABELLED);
        for (k, pit) in self.pits.iter().enumerate() {
            self.basin[pit.index()] = k as u32 + 1;
        }
        for start in 0..receivers.len() {
            let mut end = start;
            while self.basin[end] == UNLABELLED && receivers[end].index() != end {
                end = receivers[end].index();
            }
            // A walk that ends unlabelled has found an outlet.
            let label = if self.basin[end] == UNLABELLED {
                OUTSIDE
            } else {
                self.basin[end]
            };
            self.basin[end] = label;
            let mut i = start;
            while self.basin[i] == UNLABELLED {
                self.basin[i] = label;
                i = receivers[i].index();
            }
        }
    }

    /// All links out of closed basins, each once, and the border nodes inside them.
    fn find_passes(&mut self, tin: &Tin, z: &[f64]) {
        self.passes.clear();
        for node in tin.nodes() {
            let i = node.index();
            let basin = self.basin[i];
            if basin == OUTSIDE {
                continue;
            }
            if tin.is_border(node) {
                self.passes.push(Pass {
                    height: z[i],
                    inner: node,
                    outer: node,
                });
            }
            for outer in tin.neighbours(node) {
                let other = self.basin[outer.index()];
                if other < basin {
                    self.passes.push(Pass {
                        height: z[i].max(z[outer.index()]),
                        inner: node,
                        outer,
                    });
                }
            }
        }
    }

    /// Kruskal's minimum spanning tree. Equal heights go by the smaller node ids, so the tree is unique.
    fn span(&mut self) {
        self.passes.sort_unstable_by(|a, b| {
            a.height
                .total_cmp(&b.height)
                .then(a.inner.cmp(&b.inner))
                .then(a.outer.cmp(&b.outer))
        });
        self.union.reset(self.pits.len() + 1);
        self.tree.clear();
        let mut missing = self.pits.len();
        for k in 0..self.passes.len() {
            if missing == 0 {
                break;
            }
            let pass = self.passes[k];
            if self
                .union
                .join(self.basin[pass.inner.index()], outer_basin(&self.basin, &pass))
            {
                self.tree.push(pass);
                missing -= 1;
            }
        }
    }

    /// Walks the tree from the outside inwards: levels, lakes, and reversed paths.
    fn carve(&mut self, z: &[f64], receivers: &mut [NodeId]) {
        let basins = self.pits.len() + 1;
        self.ends.list(&self.tree, |pass| {
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
                let pass = self.tree[end as usize / 2];
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

/// Disjoint sets with path halving, joined towards the smaller representative's tree by size.
#[derive(Clone, Debug, Default)]
struct UnionFind {
    parent: Vec<u32>,
    size: Vec<u32>,
}

impl UnionFind {
    fn reset(&mut self, count: usize) {
        self.parent.clear();
        self.parent.extend(0..count as u32);
        self.size.clear();
        self.size.resize(count, 1);
    }

    fn find(&mut self, mut k: u32) -> u32 {
        while self.parent[k as usize] != k {
            let grandparent = self.parent[self.parent[k as usize] as usize];
            self.parent[k as usize] = grandparent;
            k = grandparent;
        }
        k
    }

    /// Joins two sets; false if they were one.
    fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a == b {
            return false;
        }
        let (large, small) = if self.size[a as usize] >= self.size[b as usize] {
            (a, b)
        } else {
            (b, a)
        };
        self.parent[small as usize] = large;
        self.size[large as usize] += self.size[small as usize];
        true
    }
}
