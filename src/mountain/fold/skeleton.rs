//! Which edges of a mesh are crests of folds: the top skeleton.
//!
//! An edge is a crest if it lies better across the compression than each of its four dual edges (on a lattice of
//! equilateral triangles: within 30° of the fold direction). The published text says "below one of its four dual edges";
//! only *all four* gives its own figures of ends and joints. Crests need both faces and compression at their middle. A
//! face whose three edges are crests loses the one along which there is most compression.

use rayon::prelude::*;

use super::drive::{FoldDrive, LEAST_RATE};
use super::edge_set::EdgeSet;
use super::edit::{self, FoldEdit};
use super::mesh::{FoldMesh, MeshKey};

/// By how much the energy of an edge has to pass that of a dual edge before an earlier choice is changed: compression
/// that turns by two degrees changes few folds.
pub const HYSTERESIS: f64 = 0.06;

/// Words of 64 edges that one task chooses from.
const WORDS_PER_TASK: usize = 8;

/// The crests of one layer: three bits per edge of its mesh. Clones share them.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    mesh: MeshKey,
    /// Crests by compression alone.
    grown: EdgeSet,
    /// Crests after edits.
    top: EdgeSet,
    /// Edges whose middle is compressed.
    live: EdgeSet,
}

impl Skeleton {
    /// No folds.
    pub fn none(mesh: &FoldMesh) -> Self {
        let set = EdgeSet::of(vec![0; mesh.edges().len().div_ceil(EdgeSet::WORD)]);
        Self {
            mesh: mesh.key(),
            grown: set.clone(),
            top: set.clone(),
            live: set,
        }
    }

    /// The crests under `drive`, then changed by `edits`, in order.
    ///
    /// With a `previous` skeleton of the same mesh, edges that were compressed then change only where they pass their
    /// duals by [`HYSTERESIS`]; without one the rule is exact. Edits leave no trace in what is chosen next.
    pub fn select(mesh: &FoldMesh, drive: &FoldDrive, previous: Option<&Self>, edits: &[FoldEdit]) -> Self {
        let previous = previous.filter(|previous| previous.is_of(mesh));
        let bias = |edge: usize| match previous {
            Some(previous) if previous.live.contains(edge) => {
                if previous.grown.contains(edge) {
                    HYSTERESIS
                } else {
                    -HYSTERESIS
                }
            }
            _ => 0.0,
        };
        let edges = mesh.edges().len();
        let words: Vec<(u64, u64)> = (0..edges.div_ceil(EdgeSet::WORD))
            .into_par_iter()
            .with_min_len(WORDS_PER_TASK)
            .map(|word| {
                let first = word * EdgeSet::WORD;
                let (mut live, mut chosen) = (0, 0);
                for edge in first..edges.min(first + EdgeSet::WORD) {
                    let here = mesh.drive_on(edge, drive);
                    // False for NaN too.
                    if here[0] * here[0] + here[1] * here[1] >= LEAST_RATE * LEAST_RATE {
                        live |= 1 << (edge - first);
                        let (own, mut duals) = mesh.energies(edge, here, drive);
                        let own = own - bias(edge);
                        if mesh.edges()[edge].other.is_some() && duals.all(|dual| own < dual) {
                            chosen |= 1 << (edge - first);
                        }
                    }
                }
                (live, chosen)
            })
            .collect();
        let (live, chosen): (Vec<u64>, Vec<u64>) = words.into_iter().unzip();
        let (live, chosen) = (EdgeSet::of(live), EdgeSet::of(chosen));
        // Of three crests around a face the worst leaves; of equals the last.
        let too_many = mesh.faces().iter().filter_map(|sides| {
            if !sides.iter().all(|&side| chosen.contains(side as usize)) {
                return None;
            }
            let energy = |edge: usize| {
                let here = mesh.drive_on(edge, drive);
                mesh.energies(edge, here, drive).0 - bias(edge)
            };
            sides
                .iter()
                .map(|&side| (energy(side as usize), side as usize))
                .max_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
                .map(|(_, edge)| (edge, false))
        });
        let grown = chosen.with(too_many);
        let top = edit::turned(mesh, &grown, &live, edits);
        Self {
            mesh: mesh.key(),
            grown,
            top,
            live,
        }
    }

    /// The same crests by compression with other `edits`.
    #[must_use]
    pub fn with_edits(&self, mesh: &FoldMesh, edits: &[FoldEdit]) -> Self {
        Self {
            top: edit::turned(mesh, &self.grown, &self.live, edits),
            ..self.clone()
        }
    }

    /// True if an edge of the mesh is a crest.
    pub fn is_top(&self, edge: usize) -> bool {
        self.top.contains(edge)
    }

    /// True if the middle of an edge is compressed.
    pub fn is_live(&self, edge: usize) -> bool {
        self.live.contains(edge)
    }

    /// The crests: edges of the mesh, in order.
    pub fn top(&self) -> impl Iterator<Item = usize> + '_ {
        self.top.iter()
    }

    /// True if the skeleton was chosen from this mesh, or from its equal. On another mesh it has no lines and no shape.
    pub fn is_of(&self, mesh: &FoldMesh) -> bool {
        self.mesh == mesh.key()
    }

    /// The crests if the skeleton is one of `mesh`, else none.
    pub(super) fn top_on(&self, mesh: &FoldMesh) -> impl Iterator<Item = usize> + '_ {
        let fits = self.is_of(mesh);
        self.top().filter(move |_| fits)
    }

    /// Number of crests.
    pub fn top_len(&self) -> usize {
        self.top.len()
    }

    /// True if nothing folds.
    pub fn is_empty(&self) -> bool {
        self.top_len() == 0
    }
}
