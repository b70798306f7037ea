//! A mesh as glTF 2.0 binary (Khronos 2021): y up, right-handed.

use std::io::{self, Write};

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::invalid;

/// A mesh in glTF's frame, with what it wears.
pub(super) struct Model<'a> {
    /// Name of the node and the mesh.
    pub(super) name: &'static str,
    /// Name of the material.
    pub(super) material: &'static str,
    /// What the numbers mean, into `asset.extras`.
    pub(super) extras: Value,
    /// Vertices.
    pub(super) positions: Vec<DVec3>,
    /// Corners, counter-clockwise seen from outside.
    pub(super) triangles: &'a [[u32; 3]],
    /// Colours or map coordinates.
    pub(super) dress: Dress<'a>,
}

/// What gives a mesh its colour.
pub(super) enum Dress<'a> {
    /// Map coordinates per vertex, and the map as PNG where there is one.
    Map(Vec<[f32; 2]>, Option<&'a [u8]>),
    /// Linear RGB per vertex, 0–1.
    Colours(Vec<[f32; 3]>),
}

impl Model<'_> {
    /// Writes it with vertex normals.
    ///
    /// # Errors
    /// Where there are no triangles, they pass 4 GiB, or `out` fails.
    pub(super) fn write(&self, out: impl Write) -> io::Result<()> {
        if self.triangles.is_empty() {
            return Err(invalid("GLB: no triangles"));
        }
        let positions: Vec<Vec3> = self.positions.iter().map(|p| p.as_vec3()).collect();
        let mut bin = Bin::default();
        bin.put(positions.iter().flat_map(Vec3::to_array));
        bin.put(self.normals().iter().flat_map(Vec3::to_array));
        let (attribute, kind) = match &self.dress {
            Dress::Map(coordinates, _) => {
                bin.put(coordinates.iter().copied().flatten());
                ("TEXCOORD_0", "VEC2")
            }
            Dress::Colours(colours) => {
                bin.put(colours.iter().copied().flatten());
                ("COLOR_0", "VEC3")
            }
        };
        bin.put_triangles(self.triangles);
        let map = match self.dress {
            Dress::Map(_, map) => map,
            Dress::Colours(_) => None,
        };
        if let Some(png) = map {
            bin.put_bytes(png);
        }

        let low = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let count = positions.len();
        let mut document = json!({
            "asset": {"version": "2.0", "generator": "orogen", "extras": self.extras},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": self.name}],
            "meshes": [{"name": self.name, "primitives": [{
                "attributes": {"POSITION": 0, "NORMAL": 1, attribute: 2}, "indices": 3, "material": 0}]}],
            "materials": [{"name": self.material,
                "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}}],
            "accessors": [
                {"bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3",
                    "min": low.to_array(), "max": high.to_array()},
                {"bufferView": 1, "componentType": FLOAT, "count": count, "type": "VEC3"},
                {"bufferView": 2, "componentType": FLOAT, "count": count, "type": kind},
                {"bufferView": 3, "componentType": UNSIGNED_INT, "count": self.triangles.len() * 3,
                    "type": "SCALAR"}],
            "bufferViews": bin.views,
            "buffers": [{"byteLength": bin.bytes.len()}],
        });
        if map.is_some() {
            document["images"] = json!([{"bufferView": 4, "mimeType": "image/png", "name": "map"}]);
            document["samplers"] = json!([{"wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE}]);
            document["textures"] = json!([{"source": 0, "sampler": 0}]);
            document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
        }
        write_container(out, &document, &bin.bytes)
    }

    /// Unit normals: the sum of the faces' around a vertex, weighted by their areas. A vertex without faces points up.
    fn normals(&self) -> Vec<Vec3> {
        let at = |i: u32| self.positions[i as usize];
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for &[a, b, c] in self.triangles {
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
}

/// Header, JSON chunk, binary chunk.
fn write_container(mut out: impl Write, document: &Value, buffer: &[u8]) -> io::Result<()> {
    let mut text = serde_json::to_vec(document)?;
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
    out.write_all(buffer)
}

const GLB_MAGIC: u32 = 0x4654_6C67;
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const CLAMP_TO_EDGE: u32 = 33071;

/// The binary buffer and its views.
#[derive(Default)]
struct Bin {
    bytes: Vec<u8>,
    views: Vec<Value>,
}

impl Bin {
    fn put(&mut self, values: impl Iterator<Item = f32>) {
        let start = self.bytes.len();
        for value in values {
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
        self.view(start, Some(ARRAY_BUFFER));
    }

    fn put_triangles(&mut self, triangles: &[[u32; 3]]) {
        let start = self.bytes.len();
        for corner in triangles.iter().flatten() {
            self.bytes.extend_from_slice(&corner.to_le_bytes());
        }
        self.view(start, Some(ELEMENT_ARRAY_BUFFER));
    }

    fn put_bytes(&mut self, bytes: &[u8]) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.view(start, None);
    }

    /// Notes what was put from `start` on, and fills up to whole words.
    fn view(&mut self, start: usize, target: Option<u32>) {
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }
}
