//! Figures of a fold graph, as the literature reports them.

use glam::DVec2;

use super::drive::{FoldDrive, LEAST_RATE};
use super::lines::{Graph, troughs};
use super::mesh::FoldMesh;
use super::shape::FoldShape;
use super::skeleton::Skeleton;

/// Places per wavelength at which the local wavelength is read.
const SAMPLES_PER_WAVELENGTH: f64 = 4.0;

/// Most places at which it is read.
const MOST_SAMPLES: f64 = 40_000.0;

/// Figures of the folds of one layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FoldStats {
    /// Wavelength asked for, metres.
    pub wavelength: f64,
    /// Mean local wavelength where the land is compressed, weighted by the rate of folding, metres; 0 without folds.
    pub realised_wavelength: f64,
    /// Edges of the top skeleton.
    pub top_edges: usize,
    /// Lines of the bottom skeleton.
    pub bottom_edges: usize,
    /// Part of the nodes of the top skeleton where a crest ends (one edge).
    pub end_fraction: f64,
    /// Part of the nodes of the top skeleton where crests meet (three edges or more).
    pub triple_fraction: f64,
    /// Mean length of crests from end or joint to end or joint, metres.
    pub mean_chain_length: f64,
}

impl FoldStats {
    /// Figures of `skeleton` on the whole mesh, margins included.
    pub fn of(mesh: &FoldMesh, skeleton: &Skeleton, drive: &FoldDrive) -> Self {
        let mut stats = Self {
            wavelength: mesh.wavelength(),
            ..Self::default()
        };
        if skeleton.is_empty() || !skeleton.is_of(mesh) {
            return stats;
        }
        stats.top_edges = skeleton.top_len();
        stats.bottom_edges = troughs(mesh, skeleton).len();
        let links: Vec<[u32; 2]> = skeleton
            .top_on(mesh)
            .map(|edge| mesh.edges()[edge].ends)
            .collect();
        let graph = Graph::of(&links);
        let (mut nodes, mut ends, mut joints) = (0_usize, 0_usize, 0_usize);
        for (_, degree) in graph.degrees() {
            nodes += 1;
            ends += usize::from(degree == 1);
            joints += usize::from(degree > 2);
        }
        stats.end_fraction = ends as f64 / nodes as f64;
        stats.triple_fraction = joints as f64 / nodes as f64;
        let length = |edge: usize| {
            let [a, b] = mesh.ends(edge);
            a.distance(b)
        };
        stats.mean_chain_length =
            skeleton.top_on(mesh).map(length).sum::<f64>() / graph.chains().len() as f64;
        stats.realised_wavelength = realised(mesh, skeleton, drive);
        stats
    }
}

fn realised(mesh: &FoldMesh, skeleton: &Skeleton, drive: &FoldDrive) -> f64 {
    let extent = mesh.extent();
    let step = (mesh.wavelength() / SAMPLES_PER_WAVELENGTH).max((extent.area() / MOST_SAMPLES).sqrt());
    let (cols, rows) = ((extent.width / step).ceil(), (extent.height / step).ceil());
    let shape = FoldShape::new(mesh, skeleton);
    let (mut sum, mut weights) = (0.0, 0.0);
    for row in 0..rows as usize {
        for col in 0..cols as usize {
            let at = DVec2::new((col as f64 + 0.5) / cols, (row as f64 + 0.5) / rows);
            let p = at * extent.size();
            let rate = drive.at(p).rate;
            if rate >= LEAST_RATE
                && let Some(wavelength) = shape.wavelength_at(p)
            {
                sum += rate * wavelength;
                weights += rate;
            }
        }
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}
