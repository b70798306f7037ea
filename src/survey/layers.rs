//! The layers under a land on its nodes → rasters.

use std::sync::Arc;

use rayon::prelude::*;

use crate::rock::Stratigraphy;
use crate::surface::{Raster, StrataMap};
use crate::terrain::TinRaster;

/// Cells per task where each is independent of the others.
const CHUNK: usize = 16_384;

/// What lies under a land: one value per node each.
#[derive(Clone, Debug)]
pub struct Underground<'a> {
    /// The pile as it was laid down.
    pub stratigraphy: &'a Arc<Stratigraphy>,
    /// Rise of the pile as a whole, metres.
    pub base: &'a [f64],
    /// Interfaces that folds have raised, with all above them, and by how much, metres.
    pub folds: Vec<(usize, &'a [f64])>,
    /// Thickness of loose sediment, metres.
    pub sediment: &'a [f64],
    /// How far the base of the crust has been pressed down, metres.
    pub root: &'a [f64],
}

/// Draws `under` on the cells of `raster`, for a land of the heights `height`.
pub(super) fn draw(raster: &TinRaster, under: &Underground<'_>, height: &Raster, out: &mut StrataMap) {
    let fresh = |out: &mut Raster| {
        out.width = height.width;
        out.height = height.height;
        out.extent = height.extent;
    };
    out.stratigraphy = Arc::clone(under.stratigraphy);
    out.folds.truncate(under.folds.len());
    while out.folds.len() < under.folds.len() {
        out.folds.push((0, empty(height)));
    }
    for (values, drawn) in [
        (under.base, &mut out.base),
        (under.sediment, &mut out.sediment),
        (under.root, &mut out.root),
    ] {
        fresh(drawn);
        raster.linear_into(values, &mut drawn.data);
    }
    for ((interface, values), (known, drawn)) in under.folds.iter().zip(&mut out.folds) {
        fresh(drawn);
        *known = *interface;
        raster.linear_into(values, &mut drawn.data);
    }
    fresh(&mut out.depth);
    let mut depth = std::mem::take(&mut out.depth.data);
    depth.resize(height.data.len(), 0.0);
    let map = &*out;
    depth
        .par_chunks_mut(CHUNK)
        .enumerate()
        .for_each(|(chunk, depths)| {
            for (k, depth) in depths.iter_mut().enumerate() {
                let cell = chunk * CHUNK + k;
                let rock = height.data[cell] - map.sediment.data[cell];
                *depth = map.column_at(cell).depth_at(f64::from(rock)) as f32;
            }
        });
    out.depth.data = depth;
}

/// A map with nothing in it, of the size of `height`.
pub(super) fn blank(stratigraphy: &Arc<Stratigraphy>, height: &Raster) -> StrataMap {
    StrataMap {
        stratigraphy: Arc::clone(stratigraphy),
        base: empty(height),
        folds: Vec::new(),
        sediment: empty(height),
        root: empty(height),
        depth: empty(height),
    }
}

fn empty(like: &Raster) -> Raster {
    Raster {
        data: Vec::new(),
        ..*like
    }
}
