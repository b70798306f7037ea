//! From what makes layers fold to the folds of the land: meshes, skeletons, rates at the nodes, edits.

use std::sync::Arc;

use super::World;
use crate::mountain::Stages;
use crate::mountain::fold::{
    FoldDrive, FoldEdit, FoldMesh, FoldRates, FoldShape, FoldStage, PointRates, Skeleton, wavelength,
};
use crate::mountain::strata::NodeFolds;
use crate::rock::Stratigraphy;

/// Folds shorter than this many distances between nodes cannot be told apart on the land.
const SHORTEST_SPACINGS: f64 = 4.0;

/// The crests of one pair of layers, as the land last felt them.
#[derive(Clone, Debug)]
pub struct LayerSkeleton {
    /// The interface that folds.
    pub interface: usize,
    /// The mesh that crests are chosen from; never changed, so shared by all snapshots.
    pub mesh: Arc<FoldMesh>,
    /// Its crests.
    pub skeleton: Skeleton,
}

/// A pair of layers that folds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoldingLayer {
    /// The interface between the two.
    pub interface: usize,
    /// Wavelength: Eq. 3, or what the pile says, metres.
    pub wavelength: f64,
    /// Folding speed as a part of the uplift.
    pub share: f64,
}

/// The pairs of layers of `pile` that fold on a land whose nodes are `spacing` metres apart: the `most` longest folds,
/// longest first.
pub fn folding_layers(pile: &Stratigraphy, spacing: f64, most: usize) -> Vec<FoldingLayer> {
    let mut layers: Vec<FoldingLayer> = pile
        .folding()
        .map(|interface| {
            let above = &pile.layers()[interface - 1];
            let law = || {
                // A basement has no thickness of its own; it yields to about the depth of the layer above.
                let (thickness, viscosity) = pile
                    .layers()
                    .get(interface)
                    .map_or((above.thickness_m, pile.basement().viscosity_pa_s), |below| {
                        (below.thickness_m, below.viscosity_pa_s)
                    });
                wavelength::wavelength(above.thickness_m, thickness, above.viscosity_pa_s / viscosity)
            };
            FoldingLayer {
                interface,
                wavelength: above.wavelength_m.unwrap_or_else(law),
                share: above.fold,
            }
        })
        .filter(|layer| layer.wavelength >= SHORTEST_SPACINGS * spacing)
        .collect();
    layers.sort_by(|a, b| {
        b.wavelength
            .total_cmp(&a.wavelength)
            .then(a.interface.cmp(&b.interface))
    });
    layers.truncate(most);
    layers
}

/// Meshes and shapes of a land's folds, kept from one time to the next.
#[derive(Debug)]
pub(super) struct Folding {
    stage: Box<dyn FoldStage>,
    meshes: Vec<Arc<FoldMesh>>,
    shapes: Vec<(Skeleton, FoldShape)>,
    rates: PointRates,
}

impl Default for Folding {
    fn default() -> Self {
        Self::new(Stages::default().folds)
    }
}

impl Folding {
    /// Folds whose heights `stage` computes.
    pub(super) fn new(stage: Box<dyn FoldStage>) -> Self {
        Self {
            stage,
            meshes: Vec::new(),
            shapes: Vec::new(),
            rates: PointRates::default(),
        }
    }

    /// What computes heights.
    pub(super) fn stage(&self) -> &dyn FoldStage {
        &*self.stage
    }

    /// Uses another stage from now on, and gives the old one back.
    pub(super) fn replace_stage(&mut self, stage: Box<dyn FoldStage>) -> Box<dyn FoldStage> {
        std::mem::replace(&mut self.stage, stage)
    }

    /// How fast folds rise at the nodes of `world` under `drive`, and the crests they rise to. Where nothing is
    /// compressed any more, crests stay as they were.
    pub(super) fn rates(
        &mut self,
        world: &World,
        drive: &FoldDrive,
        layers: &[FoldingLayer],
    ) -> (Vec<NodeFolds>, Vec<LayerSkeleton>) {
        // What the shortening pays for is shared.
        let mut drive = drive.clone();
        let part = (layers.len().max(1) as f32).sqrt();
        for limit in &mut drive.limit.data {
            *limit /= part;
        }
        let drive = &drive;
        let (mut rates, mut skeletons) = (Vec::new(), Vec::new());
        for layer in layers {
            let Some(mesh) = self.mesh(world, layer.wavelength) else {
                continue;
            };
            let previous = world
                .skeletons
                .iter()
                .find(|known| known.interface == layer.interface);
            let before = previous.map(|previous| &previous.skeleton);
            let skeleton = Skeleton::select(&mesh, drive, before, &world.fold_edits);
            if skeleton.is_empty() {
                skeletons.extend(previous.cloned());
                continue;
            }
            let shape = shape_of(&mut self.shapes, &mesh, &skeleton);
            let fold_rates = FoldRates {
                drive,
                share: layer.share,
                edits: &world.fold_edits,
            };
            self.rates.fill(
                &mut *self.stage,
                &self.shapes[shape].1,
                &fold_rates,
                world.tin.positions(),
            );
            rates.push(NodeFolds {
                interface: layer.interface,
                raised: self.rates.raised.iter().map(|&rate| f64::from(rate)).collect(),
                crests: self.rates.crests.clone(),
            });
            skeletons.push(LayerSkeleton {
                interface: layer.interface,
                mesh,
                skeleton,
            });
        }
        self.shapes
            .retain(|(known, _)| skeletons.iter().any(|layer| layer.skeleton == *known));
        (rates, skeletons)
    }

    /// Lets the folds that stand follow `edits` instead of those `world` has: crests turn at once, heights are owed to
    /// the land.
    pub(super) fn edit(&mut self, world: &mut World, edits: Vec<FoldEdit>) {
        for layer in &mut world.skeletons {
            let turned = layer.skeleton.with_edits(&layer.mesh, &edits);
            let mut heights = [Vec::new(), Vec::new()];
            for ((skeleton, edits), heights) in [(&layer.skeleton, &world.fold_edits), (&turned, &edits)]
                .into_iter()
                .zip(&mut heights)
            {
                let shape = shape_of(&mut self.shapes, &layer.mesh, skeleton);
                self.shapes[shape]
                    .1
                    .raised_at_points(edits, world.tin.positions(), heights);
            }
            let [before, after] = heights;
            world
                .strata
                .owe(layer.interface, |i| f64::from(after[i] - before[i]));
            layer.skeleton = turned;
        }
        world.fold_edits = edits;
    }

    /// The mesh for a wavelength on this land. Wavelengths of piles are within the range of meshes; a land without a mesh
    /// has no folds.
    fn mesh(&mut self, world: &World, wavelength: f64) -> Option<Arc<FoldMesh>> {
        let extent = world.tin.extent();
        let fits = |mesh: &FoldMesh| {
            mesh.wavelength() == wavelength && mesh.seed() == world.seed && mesh.extent() == extent
        };
        let known = world
            .skeletons
            .iter()
            .map(|layer| &layer.mesh)
            .chain(&self.meshes);
        if let Some(mesh) = known.into_iter().find(|mesh| fits(mesh)) {
            return Some(Arc::clone(mesh));
        }
        let mesh = Arc::new(FoldMesh::new(extent, wavelength, world.seed).ok()?);
        self.meshes.push(Arc::clone(&mesh));
        Some(mesh)
    }
}

fn shape_of(shapes: &mut Vec<(Skeleton, FoldShape)>, mesh: &FoldMesh, skeleton: &Skeleton) -> usize {
    let known = shapes.iter().position(|(known, _)| known == skeleton);
    known.unwrap_or_else(|| {
        shapes.push((skeleton.clone(), FoldShape::new(mesh, skeleton)));
        shapes.len() - 1
    })
}
