//! Troughs between crests, and both as lines to draw.

use glam::DVec2;

use super::mesh::FoldMesh;
use super::skeleton::Skeleton;
use crate::units::Extent;

/// A piece of a trough between two nodes of the bottom graph: the middles of edges (numbered as the edges are) and the
/// centres of faces (numbered on from there).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trough {
    /// The nodes it joins.
    pub nodes: [u32; 2],
    /// The face it lies in.
    pub face: u32,
}

/// The bottom skeleton: in each face, lines between the middles of the edges that are no crests; through its centre if
/// there is one such edge or three.
///
/// Troughs touch the sides of faces only in the middles of edges that are no crests, so they never meet a crest. Faces
/// that nothing compresses have theirs too: around folded ground they close it.
pub fn troughs(mesh: &FoldMesh, skeleton: &Skeleton) -> Vec<Trough> {
    let edges = mesh.edges().len() as u32;
    let mut troughs = Vec::with_capacity(mesh.edges().len());
    for (face, &sides) in (0..).zip(mesh.faces()) {
        let mut add = |nodes| troughs.push(Trough { nodes, face });
        let centre = edges + face;
        match sides.map(|side| skeleton.is_top(side as usize)) {
            [true, true, true] => {}
            [true, false, false] => add([sides[1], sides[2]]),
            [false, true, false] => add([sides[0], sides[2]]),
            [false, false, true] => add([sides[0], sides[1]]),
            top => {
                for (side, is_top) in sides.into_iter().zip(top) {
                    if !is_top {
                        add([side, centre]);
                    }
                }
            }
        }
    }
    troughs
}

/// Place of a node of the bottom graph, plan metres.
pub fn trough_node(mesh: &FoldMesh, node: u32) -> DVec2 {
    let (node, edges) = (node as usize, mesh.edges().len());
    if node < edges {
        mesh.middle(node)
    } else {
        mesh.centre(node - edges)
    }
}

/// Crests as polylines within the land, from end or joint to end or joint, plan metres.
pub fn top_lines(mesh: &FoldMesh, skeleton: &Skeleton) -> Vec<Vec<DVec2>> {
    let links: Vec<[u32; 2]> = skeleton
        .top_on(mesh)
        .map(|edge| mesh.edges()[edge].ends)
        .collect();
    let chains = Graph::of(&links).chains();
    within(mesh.extent(), &chains, |vertex| mesh.vertices()[vertex as usize])
}

/// Troughs as polylines within the land, where it is compressed, plan metres.
pub fn bottom_lines(mesh: &FoldMesh, skeleton: &Skeleton) -> Vec<Vec<DVec2>> {
    let live = |face: u32| {
        let mut sides = mesh.faces()[face as usize].iter();
        sides.any(|&side| skeleton.is_live(side as usize))
    };
    let troughs = troughs(mesh, skeleton).into_iter();
    let links: Vec<[u32; 2]> = troughs.filter(|t| live(t.face)).map(|t| t.nodes).collect();
    let chains = Graph::of(&links).chains();
    within(mesh.extent(), &chains, |node| trough_node(mesh, node))
}

/// An undirected graph on the nodes that its links name.
pub(super) struct Graph<'a> {
    links: &'a [[u32; 2]],
    /// Both ends of all links: (node, link), sorted.
    ends: Vec<(u32, u32)>,
}

impl<'a> Graph<'a> {
    pub(super) fn of(links: &'a [[u32; 2]]) -> Self {
        let mut ends: Vec<(u32, u32)> = (0..)
            .zip(links)
            .flat_map(|(link, nodes)| nodes.map(|node| (node, link)))
            .collect();
        ends.sort_unstable();
        Self { links, ends }
    }

    /// Links at a node.
    fn at(&self, node: u32) -> &[(u32, u32)] {
        let first = self.ends.partition_point(|&(other, _)| other < node);
        let count = self.ends[first..]
            .iter()
            .take_while(|&&(other, _)| other == node)
            .count();
        &self.ends[first..first + count]
    }

    /// Number of links at each node, in order of nodes.
    pub(super) fn degrees(&self) -> impl Iterator<Item = (u32, usize)> + '_ {
        self.ends
            .chunk_by(|a, b| a.0 == b.0)
            .map(|links| (links[0].0, links.len()))
    }

    /// Paths that cover each link once and run from node to node with other than two links; rings begin anywhere.
    pub(super) fn chains(&self) -> Vec<Vec<u32>> {
        let mut walked = vec![false; self.links.len()];
        let mut chains = Vec::new();
        let mut walk = |start: u32| {
            for &(_, first) in self.at(start) {
                if walked[first as usize] {
                    continue;
                }
                let (mut chain, mut node, mut link) = (vec![start], start, first);
                loop {
                    walked[link as usize] = true;
                    let [a, b] = self.links[link as usize];
                    node = if a == node { b } else { a };
                    chain.push(node);
                    match self.at(node) {
                        &[(_, a), (_, b)] if node != start => link = if a == link { b } else { a },
                        _ => break,
                    }
                }
                chains.push(chain);
            }
        };
        for (node, degree) in self.degrees() {
            if degree != 2 {
                walk(node);
            }
        }
        // What is left are rings.
        for (node, _) in self.degrees() {
            walk(node);
        }
        chains
    }
}

/// Chains as polylines, cut where they leave the land.
fn within(extent: Extent, chains: &[Vec<u32>], place: impl Fn(u32) -> DVec2) -> Vec<Vec<DVec2>> {
    let mut lines: Vec<Vec<DVec2>> = Vec::with_capacity(chains.len());
    for chain in chains {
        let mut line: Vec<DVec2> = Vec::with_capacity(chain.len());
        for pair in chain.windows(2) {
            let Some([from, to]) = clip(extent, [place(pair[0]), place(pair[1])]) else {
                continue;
            };
            if line.last() != Some(&from) {
                if line.len() > 1 {
                    lines.push(std::mem::take(&mut line));
                }
                line.clear();
                line.push(from);
            }
            line.push(to);
        }
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

/// The part of a segment within the land (Liang & Barsky 1984).
fn clip(extent: Extent, [a, b]: [DVec2; 2]) -> Option<[DVec2; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let along = b - a;
    for (from, step, size) in [(a.x, along.x, extent.width), (a.y, along.y, extent.height)] {
        if step == 0.0 {
            if from < 0.0 || from > size {
                return None;
            }
        } else {
            let (first, last) = (-from / step, (size - from) / step);
            enter = enter.max(first.min(last));
            leave = leave.min(first.max(last));
        }
    }
    let at = |t: f64, end: DVec2| if t == 0.0 || t == 1.0 { end } else { a + along * t };
    (enter < leave).then(|| [at(enter, a), at(leave, b)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_cover_each_link_once_and_end_at_joints() {
        // A ring 7-8-9, and a fork at 2: 0-1-2, 2-3, 2-4-5.
        let links = [[0, 1], [2, 1], [3, 2], [2, 4], [4, 5], [7, 8], [8, 9], [9, 7]];
        let chains = Graph::of(&links).chains();
        assert_eq!(
            chains,
            [vec![0, 1, 2], vec![2, 3], vec![2, 4, 5], vec![7, 8, 9, 7],]
        );
        let covered: usize = chains.iter().map(|chain| chain.len() - 1).sum();
        assert_eq!(covered, links.len());
    }

    #[test]
    fn lines_end_at_the_border_of_the_land() {
        let extent = Extent {
            width: 10.0,
            height: 10.0,
        };
        let places = [
            [-5.0, 5.0],
            [5.0, 5.0],
            [15.0, 5.0],
            [15.0, 8.0],
            [5.0, 8.0],
            [20.0, 30.0],
        ];
        let line = within(extent, &[vec![0, 1, 2, 3, 4], vec![2, 5]], |node| {
            DVec2::from_array(places[node as usize])
        });
        let points = |line: &[[f64; 2]]| line.iter().map(|&p| DVec2::from_array(p)).collect::<Vec<_>>();
        assert_eq!(
            line,
            [
                points(&[[0.0, 5.0], [5.0, 5.0], [10.0, 5.0]]),
                points(&[[10.0, 8.0], [5.0, 8.0]]),
            ]
        );
    }
}
