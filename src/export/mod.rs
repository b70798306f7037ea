//! The files Orogen writes. Encoders are pure (`Write` in, bytes out); [`OutDir`] puts them on disk whole or not
//! at all.
//!
//! Rasters have their first row in the north, pixel = area. Meshes and lines are in the plan frame, x east, y north,
//! origin in the south-west corner; [`glb`] turns it for glTF.

mod digest;
pub mod evemu;
pub mod exr;
pub mod geojson;
pub mod glb;
mod gltf;
pub mod height16;
mod out_dir;
pub mod planet;
pub mod ply;
pub mod svg;

use glam::DVec2;

pub use digest::digest;
pub use out_dir::{ExportError, OutDir};

/// A terrain mesh, borrowed: parallel slices, one entry per vertex.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// Plan positions, metres.
    pub positions: &'a [DVec2],
    /// Heights, metres.
    pub heights: &'a [f64],
    /// Corners of each triangle, counter-clockwise seen from above.
    pub triangles: &'a [[u32; 3]],
}

/// Wrong input to an encoder, in the terms of [`std::io`].
fn invalid(what: impl Into<String>) -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::InvalidInput, what.into())
}

/// Refuses slices that are not parallel and corners that are no vertices.
fn check_mesh(mesh: Mesh<'_>) -> std::io::Result<()> {
    let count = mesh.positions.len();
    if mesh.heights.len() != count {
        return Err(invalid(format!(
            "mesh: {count} positions but {} heights",
            mesh.heights.len()
        )));
    }
    if mesh
        .triangles
        .iter()
        .flatten()
        .any(|&corner| corner as usize >= count)
    {
        return Err(invalid(format!(
            "mesh: a triangle names a vertex beyond the {count} there are"
        )));
    }
    Ok(())
}
