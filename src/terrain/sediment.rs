//! Sediment: what rivers and slides take goes down the rivers, and comes to rest where they are weak.

use super::params::{Bound, OutOfBounds, bound};

/// How rivers lay sediment down: the shared stream power model (Hergarten 2020, esurf 8, 841–854).
///
/// Erosion E (negative: deposition) and the flux of sediment Q share the power of the stream,
///
/// E / Kd + Q / (Kt A) = Aᵐ S,
///
/// with Kd = k (1 + G) and Kt = k (1 + G) / G. Where E is the same everywhere Q = A E, the two terms add up to E / k,
/// and the steady land is that of the plain law. G = 0 lays nothing down in rivers; a large G makes a river that is
/// always as loaded as it can be. Lakes catch sediment whatever G.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deposition {
    /// G = Kd / Kt, 0 to 10. Real rivers: near 1 (0.3 to 3).
    pub settling: f64,
    /// Factor on Kd where loose sediment covers the rock; not below the rock's own.
    pub loose: f64,
}

impl Default for Deposition {
    fn default() -> Self {
        Self {
            settling: 1.0,
            loose: 2.0,
        }
    }
}

impl Deposition {
    /// Ranges of the parameters.
    pub const BOUNDS: [Bound; 2] = [bound("settling", "", 0.0, 10.0), bound("loose", "", 0.1, 100.0)];

    /// Checks each parameter against its range.
    ///
    /// # Errors
    /// The first parameter outside its range (NaN is outside every range).
    pub fn check(&self) -> Result<(), OutOfBounds> {
        let values = [self.settling, self.loose];
        for (bound, found) in Self::BOUNDS.into_iter().zip(values) {
            if !(bound.min..=bound.max).contains(&found) {
                return Err(OutOfBounds { bound, found });
            }
        }
        Ok(())
    }
}

/// The loose sediment of a land, one value per node. It rises and sinks with the rock under it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sediment {
    /// Thickness of the loose cover, m, never negative: it grows by deposition and is eroded before the rock.
    pub thickness: Vec<f64>,
    /// What slid to the foot of a slope and waits for the river, m³. It is in no height until the river lays it down.
    pub debris: Vec<f64>,
}

impl Sediment {
    /// Bare rock on `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        Self {
            thickness: vec![0.0; nodes],
            debris: vec![0.0; nodes],
        }
    }

    /// Back to bare rock: what lies is taken as rock, what waits is gone.
    pub fn clear(&mut self) {
        self.thickness.fill(0.0);
        self.debris.fill(0.0);
    }
}

/// What slides, and the sediment of the nodes from `first` on that it takes and leaves.
#[derive(Debug, Default)]
pub(super) struct Falls<'a> {
    /// m³.
    pub(super) volume: f64,
    first: usize,
    thickness: &'a mut [f64],
    debris: &'a mut [f64],
}

impl<'a> Falls<'a> {
    /// On all nodes; no sediment is kept where there is none.
    pub(super) fn whole(sediment: Option<&'a mut Sediment>) -> Self {
        sediment.map_or_else(Self::default, |Sediment { thickness, debris }| Self {
            thickness,
            debris,
            ..Self::default()
        })
    }

    /// On each block of so many nodes.
    pub(super) fn in_blocks(sediment: Option<&'a mut Sediment>, nodes: usize, size: usize) -> Vec<Self> {
        let Self {
            thickness, debris, ..
        } = Self::whole(sediment);
        let (mut thickness, mut debris) = (thickness.chunks_mut(size), debris.chunks_mut(size));
        let firsts = (0..nodes).step_by(size);
        let part = |first| Self {
            first,
            thickness: thickness.next().unwrap_or_default(),
            debris: debris.next().unwrap_or_default(),
            ..Self::default()
        };
        firsts.map(part).collect()
    }

    /// A node of the given area (m²) has come down by `depth` (m) and slid to another one.
    pub(super) fn add(&mut self, area: f64, i: usize, below: usize, depth: f64) {
        self.volume += area * depth;
        if let Some(debris) = self.debris.get_mut(below - self.first) {
            *debris += area * depth;
            let cover = &mut self.thickness[i - self.first];
            // The larger of zero and what is no number is zero.
            *cover = (*cover - depth).max(0.0);
        }
    }
}

/// Volumes of one step, m³.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moved {
    pub(super) uplifted: f64,
    pub(super) eroded: f64,
    pub(super) deposited: f64,
    pub(super) exported: f64,
}
