//! What the tests of folds share.

use orogen::mountain::Grid;
use orogen::mountain::fold::FoldMesh;
use orogen::units::{Extent, KM};

/// Fold rate, m/yr.
pub(crate) const RATE: f64 = 3e-4;

/// The coarse grid over a land.
pub(crate) fn blocks(land: Extent) -> Grid {
    Grid::over(land, 512 * 512).blocks()
}

/// The mesh of a land for a wavelength in km.
pub(crate) fn mesh(land: Extent, wavelength_km: f64, seed: u64) -> FoldMesh {
    FoldMesh::new(land, wavelength_km * KM, seed).expect("a mesh")
}
