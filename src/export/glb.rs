//! `terrain.glb`: the mesh as glTF 2.0 binary (Khronos 2021), with normals and map coordinates.
//!
//! glTF's y axis points up, so plan (x east, y north, z up) becomes (x east, y up, z *south*): `(x, h, −y)`. That is
//! a rotation, so triangles keep their sense. Units are metres, the origin stays in the south-west corner. Texture
//! coordinates run from the north-west (0, 0) to the south-east (1, 1), as the map's pixels do.

use std::io::{self, Write};

use glam::DVec3;
use serde_json::json;

use super::gltf::{Dress, Model};
use super::{Mesh, check_mesh};
use crate::units::Extent;

/// Writes the mesh, with the map's PNG as its base colour where one is given.
///
/// # Errors
/// Where slices are not parallel, the mesh has no triangles or passes 4 GiB, or `out` fails.
pub fn write(out: impl Write, mesh: Mesh<'_>, extent: Extent, map_png: Option<&[u8]>) -> io::Result<()> {
    check_mesh(mesh)?;
    let heights = mesh.positions.iter().zip(mesh.heights);
    let coordinates = mesh
        .positions
        .iter()
        .map(|p| [(p.x / extent.width) as f32, (1.0 - p.y / extent.height) as f32]);
    let model = Model {
        name: "terrain",
        material: "land",
        extras: json!({"frame": "metres, x east, y up, z south, origin south-west corner"}),
        positions: heights.map(|(p, &h)| DVec3::new(p.x, h, -p.y)).collect(),
        triangles: mesh.triangles,
        dress: Dress::Map(coordinates.collect(), map_png),
    };
    model.write(out)
}
