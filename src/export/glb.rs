//! `terrain.glb`: the mesh as glTF 2.0 binary (Khronos 2021), with normals and map coordinates.
//!
//! glTF's y axis points up, so plan (x east, y north, z up) becomes (x east, y up, z *south*): `(x, h, −y)`. That is
//! a rotation, so triangles keep their sense. Units are metres, the origin stays in the south-west corner. Texture
//! coordinates run from the north-west (0, 0) to the south-east (1, 1), as the map's pixels do.

use std::io::{self, Write};

use glam::{DVec3, Vec3};
use serde_json::json;

use super::{Mesh, check_mesh, invalid};
use crate::units::Extent;

/// Writes the mesh, with the map's PNG as its base colour where one is given.
///
/// # Errors
/// Where slices are not parallel, the mesh has no triangles or passes 4 GiB, or `out` fails.
pub fn write(mut out: impl Write, mesh: Mesh<'_>, extent: Extent, map_png: Option<&[u8]>) -> io::Result<()> {
    check_mesh(mesh)?;
    if mesh.triangles.is_empty() {
        return Err(invalid("GLB: no triangles"));
    }
    let positions: Vec<Vec3> = mesh
        .positions
        .iter()
        .zip(mesh.heights)
        .map(|(p, &h)| DVec3::new(p.x, h, -p.y).as_vec3())
        .collect();
    let normals = vertex_normals(mesh);

    let mut buffer = Vec::new();
    let mut views = Vec::new();
    let mut view = |buffer: &mut Vec<u8>, start: usize, target: Option<u32>| {
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": buffer.len() - start});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        views.push(view);
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        buffer.len()
    };
    put(&mut buffer, positions.iter().flat_map(Vec3::to_array));
    let start = view(&mut buffer, 0, Some(ARRAY_BUFFER));
    put(&mut buffer, normals.iter().flat_map(Vec3::to_array));
    let start = view(&mut buffer, start, Some(ARRAY_BUFFER));
    put(
        &mut buffer,
        mesh.positions
            .iter()
            .flat_map(|p| [(p.x / extent.width) as f32, (1.0 - p.y / extent.height) as f32]),
    );
    let start = view(&mut buffer, start, Some(ARRAY_BUFFER));
    for corner in mesh.triangles.iter().flatten() {
        buffer.extend_from_slice(&corner.to_le_bytes());
    }
    let start = view(&mut buffer, start, Some(ELEMENT_ARRAY_BUFFER));
    if let Some(png) = map_png {
        buffer.extend_from_slice(png);
        view(&mut buffer, start, None);
    }

    let low = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let count = positions.len();
    let mut document = json!({
        "asset": {"version": "2.0", "generator": "orogen",
            "extras": {"frame": "metres, x east, y up, z south, origin south-west corner"}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "terrain"}],
        "meshes": [{"name": "terrain", "primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}]}],
        "materials": [{"name": "land",
            "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}}],
        "accessors": [
            {"bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3",
                "min": low.to_array(), "max": high.to_array()},
            {"bufferView": 1, "componentType": FLOAT, "count": count, "type": "VEC3"},
            {"bufferView": 2, "componentType": FLOAT, "count": count, "type": "VEC2"},
            {"bufferView": 3, "componentType": UNSIGNED_INT, "count": mesh.triangles.len() * 3, "type": "SCALAR"}],
        "bufferViews": views,
        "buffers": [{"byteLength": buffer.len()}],
    });
    if map_png.is_some() {
        document["images"] = json!([{"bufferView": 4, "mimeType": "image/png", "name": "map"}]);
        document["samplers"] = json!([{"wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE}]);
        document["textures"] = json!([{"source": 0, "sampler": 0}]);
        document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    }
    let mut text = serde_json::to_vec(&document)?;
    text.resize(text.len().next_multiple_of(4), b' ');

    let total = 12 + 8 + text.len() + 8 + buffer.len();
    let total = u32::try_from(total).map_err(|_| invalid("GLB: the mesh passes 4 GiB"))?;
    for word in [GLB_MAGIC, 2, total, text.len() as u32, CHUNK_JSON] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(&text)?;
    for word in [buffer.len() as u32, CHUNK_BIN] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(&buffer)
}

const GLB_MAGIC: u32 = 0x4654_6C67;
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const CLAMP_TO_EDGE: u32 = 33071;

fn put(buffer: &mut Vec<u8>, values: impl Iterator<Item = f32>) {
    for value in values {
        buffer.extend_from_slice(&value.to_le_bytes());
    }
}

/// Unit normals in glTF's frame: the sum of the faces' around a vertex, weighted by their areas. A vertex without
/// faces points up.
fn vertex_normals(mesh: Mesh<'_>) -> Vec<Vec3> {
    let at = |i: u32| {
        let p = mesh.positions[i as usize];
        DVec3::new(p.x, mesh.heights[i as usize], -p.y)
    };
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for &[a, b, c] in mesh.triangles {
        let face = (at(b) - at(a)).cross(at(c) - at(a));
        for corner in [a, b, c] {
            normals[corner as usize] += face;
        }
    }
    normals
        .iter()
        .map(|n| n.normalize_or(DVec3::Y).as_vec3())
        .collect()
}
