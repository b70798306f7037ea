//! The minimum spanning tree of basins and passes, in linear time.
//!
//! Borůvka's algorithm (1926): each basin joins across its lowest pass, joined basins become one, and of the passes
//! between the same two basins only the lowest stays. Contractions of a planar graph are planar, so V basins never
//! keep more than 3 V passes (4 V with the outside, which may touch them all); each round at least halves V, and the
//! sum over all rounds is O(n) (Mareš 2004, *Two linear time algorithms for MST on minor closed graph classes*, §2;
//! used for flow routing by Cordonnier, Bovy & Braun 2019, esurf 7, 549).

use super::tin::NodeId;

/// No number yet.
const UNNUMBERED: u32 = u32::MAX;

/// A way from one basin to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Height of its higher end, m.
    pub(super) height: f64,
    /// Its end in the basin of the larger number.
    pub(super) inner: NodeId,
    /// Its end in the other basin; `inner` itself where water falls over the border.
    pub(super) outer: NodeId,
    /// The basins at the inner and the outer end.
    pub(super) basins: [u32; 2],
}

impl Pass {
    /// Higher than every pass, and at no node.
    const NONE: Self = Self {
        height: f64::NAN,
        inner: NodeId(u32::MAX),
        outer: NodeId(u32::MAX),
        basins: [UNNUMBERED; 2],
    };

    /// Equal heights go by the smaller node ids, so that the tree is unique.
    fn is_below(&self, other: &Self) -> bool {
        self.height
            .total_cmp(&other.height)
            .then((self.inner, self.outer).cmp(&(other.inner, other.outer)))
            .is_lt()
    }

    fn is(&self, other: &Self) -> bool {
        (self.inner, self.outer) == (other.inner, other.outer)
    }
}

/// Vectors for [`BasinGraph::span`], kept from one call to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct BasinGraph {
    tree: Vec<Pass>,
    /// The lowest pass of each basin.
    lowest: Vec<Pass>,
    /// The basin each one joins; itself where others join it.
    towards: Vec<u32>,
    /// The number each basin has from the next round on.
    number: Vec<u32>,
    passes: Vec<Pass>,
    /// Passes by their smaller basin: those of basin b begin at `first[b]`.
    sorted: Vec<Pass>,
    first: Vec<u32>,
}

impl BasinGraph {
    /// The minimum spanning tree of `basins` basins and the passes that `each_pass` hands, each time the same, to the
    /// function it is given. The graph is connected.
    pub(super) fn span(&mut self, basins: usize, each_pass: impl Fn(&mut dyn FnMut(Pass))) {
        let mut basins = self.first_round(basins, each_pass);
        while basins > 1 && !self.passes.is_empty() {
            basins = self.round(basins);
        }
    }

    /// The first round reads passes where they are, so that only what it leaves is ever stored. Returns the number of
    /// basins that are left, like each round.
    fn first_round(&mut self, basins: usize, each_pass: impl Fn(&mut dyn FnMut(Pass))) -> usize {
        self.tree.clear();
        self.passes.clear();
        self.lowest.clear();
        self.lowest.resize(basins, Pass::NONE);
        let lowest = &mut self.lowest;
        each_pass(&mut |pass| consider(lowest, pass));
        let left = self.join();
        let (number, passes) = (&self.number, &mut self.passes);
        each_pass(&mut |mut pass| {
            if renumber(number, &mut pass) {
                passes.push(pass);
            }
        });
        left
    }

    fn round(&mut self, basins: usize) -> usize {
        self.drop_parallels(basins);
        self.lowest.clear();
        self.lowest.resize(basins, Pass::NONE);
        for &pass in &self.passes {
            consider(&mut self.lowest, pass);
        }
        let left = self.join();
        let number = &self.number;
        self.passes.retain_mut(|pass| renumber(number, pass));
        left
    }

    /// The passes of the tree; their `basins` are those of the round that chose them.
    pub(super) fn tree(&self) -> &[Pass] {
        &self.tree
    }

    /// Joins each basin to the one across its lowest pass, and numbers what arises; returns how many there are.
    fn join(&mut self) -> usize {
        self.towards.clear();
        for (basin, pass) in (0..).zip(&self.lowest) {
            let [a, b] = pass.basins;
            let other = if a == basin { b } else { a };
            // Passes are ordered strictly, so the only cycles are two basins that choose the same pass.
            let chosen_twice = || self.lowest[other as usize].is(pass);
            if other == UNNUMBERED || (basin < other && chosen_twice()) {
                self.towards.push(basin);
            } else {
                self.towards.push(other);
                self.tree.push(*pass);
            }
        }
        self.number.clear();
        self.number.resize(self.towards.len(), UNNUMBERED);
        let mut count = 0;
        for (basin, &towards) in self.towards.iter().enumerate() {
            if towards as usize == basin {
                self.number[basin] = count;
                count += 1;
            }
        }
        spread_downstream(&mut self.number, UNNUMBERED, |basin| self.towards[basin] as usize);
        count as usize
    }

    /// Keeps the lowest of the passes between the same two basins: sorted by the smaller basin by counting, those of
    /// one basin find each other at the larger one.
    fn drop_parallels(&mut self, basins: usize) {
        self.first.clear();
        self.first.resize(basins + 1, 0);
        for pass in &self.passes {
            self.first[smaller(pass) as usize + 1] += 1;
        }
        for basin in 0..basins {
            self.first[basin + 1] += self.first[basin];
        }
        self.sorted.clear();
        self.sorted.resize(self.passes.len(), Pass::NONE);
        for pass in &self.passes {
            let place = &mut self.first[smaller(pass) as usize];
            self.sorted[*place as usize] = *pass;
            *place += 1;
        }
        // Where the pass to each basin is kept. Places before those of the current basin are another basin's.
        let place = &mut self.number;
        place.clear();
        place.resize(basins, UNNUMBERED);
        self.passes.clear();
        let (mut current, mut begin) = (UNNUMBERED, 0);
        for pass in &self.sorted {
            let [a, b] = pass.basins;
            if a.min(b) != current {
                (current, begin) = (a.min(b), self.passes.len());
            }
            let place = &mut place[a.max(b) as usize];
            match self.passes.get_mut(*place as usize) {
                Some(kept) if *place as usize >= begin => {
                    if pass.is_below(kept) {
                        *kept = *pass;
                    }
                }
                _ => {
                    *place = self.passes.len() as u32;
                    self.passes.push(*pass);
                }
            }
        }
    }
}

fn smaller(pass: &Pass) -> u32 {
    pass.basins[0].min(pass.basins[1])
}

/// Gives a pass the basins of the next round; false if they have become one.
fn renumber(number: &[u32], pass: &mut Pass) -> bool {
    pass.basins = pass.basins.map(|basin| number[basin as usize]);
    pass.basins[0] != pass.basins[1]
}

/// Offers a pass to the basins at its ends.
fn consider(lowest: &mut [Pass], pass: Pass) {
    for basin in pass.basins {
        let lowest = &mut lowest[basin as usize];
        if lowest.basins[0] == UNNUMBERED || pass.is_below(lowest) {
            *lowest = pass;
        }
    }
}

/// Gives each place that is still `blank` the label that the path from it leads to by `next`. Paths end at labels;
/// each place is walked over twice at most.
pub(super) fn spread_downstream(labels: &mut [u32], blank: u32, next: impl Fn(usize) -> usize) {
    for start in 0..labels.len() {
        let mut end = start;
        while labels[end] == blank {
            end = next(end);
        }
        let label = labels[end];
        let mut place = start;
        while labels[place] == blank {
            labels[place] = label;
            place = next(place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::Tin;
    use crate::units::Extent;

    /// Passes handled in all rounds after the first, per basin, where each node of a TIN is a basin.
    fn work_per_basin(nodes: usize) -> f64 {
        let land = Extent {
            width: 1.0,
            height: 1.0,
        };
        let tin = Tin::poisson(land, nodes, 1).unwrap();
        // Equal heights too.
        let height = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 20);
        let each_pass = |visit: &mut dyn FnMut(Pass)| {
            for inner in tin.nodes() {
                for outer in tin.neighbours(inner).filter(|&outer| outer < inner) {
                    visit(Pass {
                        height: height(inner.0).max(height(outer.0)),
                        inner,
                        outer,
                        basins: [inner.0, outer.0],
                    });
                }
            }
        };
        let mut graph = BasinGraph::default();
        let mut left = graph.first_round(nodes, each_pass);
        assert!(left <= nodes / 2);
        let mut work = graph.passes.len();
        while left > 1 {
            let before = left;
            left = graph.round(before);
            assert!(left <= before / 2, "a round leaves {left} of {before} basins");
            // What the round kept of its passes is planar.
            assert!(graph.passes.len() < 3 * before);
            work += graph.passes.len();
        }
        assert_eq!(graph.tree().len(), nodes - 1);
        work as f64 / nodes as f64
    }

    #[test]
    fn work_is_linear_in_the_basins() {
        for nodes in [1000, 4000, 16_000, 64_000] {
            // 3 V passes of V basins, and V halves from round to round: 3 (1 + ½ + ¼ + …).
            let work = work_per_basin(nodes);
            assert!(work < 6.0, "{work} passes per basin of {nodes}");
        }
    }

    #[test]
    fn broken_heights_still_span() {
        let pass = |height: f64, a: u32, b: u32| Pass {
            height,
            inner: NodeId(a),
            outer: NodeId(b),
            basins: [a, b],
        };
        let passes = [
            pass(f64::NAN, 1, 0),
            pass(f64::INFINITY, 2, 1),
            pass(f64::NEG_INFINITY, 3, 2),
            pass(f64::NAN, 3, 0),
            pass(1.0, 3, 1),
        ];
        let mut graph = BasinGraph::default();
        graph.span(4, |visit| passes.iter().for_each(|&pass| visit(pass)));
        let mut tree: Vec<_> = graph.tree().iter().map(|p| (p.inner.0, p.outer.0)).collect();
        tree.sort_unstable();
        assert_eq!(tree, [(1, 0), (3, 1), (3, 2)]);
    }
}
