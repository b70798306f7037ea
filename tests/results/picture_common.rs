//! Land for tests of pictures and files, and readers that share nothing with the writers.
#![allow(clippy::unwrap_used, reason = "readers fail tests by panicking")]

use std::collections::BTreeMap;
use std::io::Cursor;

use glam::DVec2;
use orogen::surface::{Raster, River, RiverPoint, Surface};
use orogen::units::Extent;

/// A plan wider than high.
pub(crate) const LAND: Extent = Extent {
    width: 64e3,
    height: 36e3,
};

/// A smooth round mountain of 3 km with its summit at `summit`, on flat land.
pub(crate) fn mountain(summit: DVec2) -> impl Fn(DVec2) -> f32 {
    move |p| {
        let r = p.distance(summit) / 8e3;
        (3000.0 * (-r * r).exp()) as f32
    }
}

/// Flat land with that mountain, dry, without marks.
pub(crate) fn surface(width: usize, height: usize, summit: DVec2) -> Surface {
    let flat = |_| 0.0;
    Surface {
        height: Raster::from_fn(width, height, LAND, mountain(summit)),
        lake_depth: Raster::from_fn(width, height, LAND, flat),
        drainage: Raster::from_fn(width, height, LAND, flat),
        spacing: LAND.width / width as f64,
        rivers: Vec::new(),
        plates: Vec::new(),
        faults: Vec::new(),
        folds: Vec::new(),
        strata: None,
        elapsed_yr: 5e6,
    }
}

/// A river along points, of constant drainage area.
pub(crate) fn river(points: &[DVec2], drainage: f64) -> River {
    River {
        points: points.iter().map(|&at| RiverPoint { at, drainage }).collect(),
        order: 1,
    }
}

/// Positions, heights and triangles of a regular mesh.
pub(crate) struct Grid {
    pub(crate) positions: Vec<DVec2>,
    pub(crate) heights: Vec<f64>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// A mesh of `columns × rows` vertices over the land, rows from the south.
pub(crate) fn grid(columns: u32, rows: u32, height: impl Fn(DVec2) -> f32) -> Grid {
    let mut grid = Grid {
        positions: Vec::new(),
        heights: Vec::new(),
        triangles: Vec::new(),
    };
    for row in 0..rows {
        for column in 0..columns {
            let share = DVec2::new(
                f64::from(column) / f64::from(columns - 1),
                f64::from(row) / f64::from(rows - 1),
            );
            let p = share * LAND.size();
            grid.positions.push(p);
            grid.heights.push(f64::from(height(p)));
            if column > 0 && row > 0 {
                let here = row * columns + column;
                let (west, south) = (here - 1, here - columns);
                grid.triangles.push([south - 1, south, here]);
                grid.triangles.push([south - 1, here, west]);
            }
        }
    }
    grid
}

/// Size and channels of an EXR file.
pub(crate) fn read_exr(bytes: &[u8]) -> ((usize, usize), BTreeMap<String, Vec<f32>>) {
    use exr::prelude::{ReadChannels as _, ReadLayers as _};
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .unwrap();
    let layer = image.layer_data;
    let channels = layer
        .channel_data
        .list
        .iter()
        .map(|channel| {
            assert!(matches!(channel.sample_data, exr::prelude::FlatSamples::F32(_)));
            (
                channel.name.to_string(),
                channel.sample_data.values_as_f32().collect(),
            )
        })
        .collect();
    ((layer.size.0, layer.size.1), channels)
}

/// What a little-endian PLY file of floats, ints and triangles holds.
pub(crate) struct Ply {
    pub(crate) comments: Vec<String>,
    /// Each property's values; ints as floats too (they are small).
    pub(crate) vertex: BTreeMap<String, Vec<f64>>,
    pub(crate) faces: Vec<[i32; 3]>,
}

pub(crate) fn read_ply(bytes: &[u8]) -> Ply {
    let end = b"end_header\n";
    let header_length = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
    let header = std::str::from_utf8(&bytes[..header_length]).unwrap();
    let mut body = bytes[header_length..].iter().copied();
    let mut word = move || std::array::from_fn::<u8, 4, _>(|_| body.next().unwrap());
    let mut ply = Ply {
        comments: Vec::new(),
        vertex: BTreeMap::new(),
        faces: Vec::new(),
    };
    let (mut vertices, mut faces, mut properties) = (0, 0, Vec::new());
    for line in header.lines() {
        match line.split(' ').collect::<Vec<_>>().as_slice() {
            ["ply" | "end_header"]
            | ["format", "binary_little_endian", "1.0"]
            | ["property", "list", "uchar", "int", "vertex_indices"] => {}
            ["comment", words @ ..] => ply.comments.push(words.join(" ")),
            ["element", "vertex", n] => vertices = n.parse().unwrap(),
            ["element", "face", n] => faces = n.parse().unwrap(),
            ["property", kind @ ("float" | "int"), name] => properties.push((*kind, (*name).to_owned())),
            other => panic!("unexpected header line {other:?}"),
        }
    }
    for _ in 0..vertices {
        for (kind, name) in &properties {
            let value = match *kind {
                "float" => f64::from(f32::from_le_bytes(word())),
                _ => f64::from(i32::from_le_bytes(word())),
            };
            ply.vertex.entry(name.clone()).or_default().push(value);
        }
    }
    let faces_at = bytes.len() - faces * 13;
    assert_eq!(
        header_length + vertices * properties.len() * 4,
        faces_at,
        "nothing is left over"
    );
    for face in bytes[faces_at..].chunks(13) {
        assert_eq!(face[0], 3);
        ply.faces.push(std::array::from_fn(|i| {
            i32::from_le_bytes(face[1 + 4 * i..][..4].try_into().unwrap())
        }));
    }
    ply
}

/// What a GLB file holds: its JSON, and its binary chunk.
pub(crate) struct Glb {
    pub(crate) document: serde_json::Value,
    pub(crate) binary: Vec<u8>,
}

pub(crate) fn read_glb(bytes: &[u8]) -> Glb {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(&bytes[..4], b"glTF");
    assert_eq!((word(4), word(8)), (2, bytes.len()));
    let json_length = word(12);
    assert_eq!((json_length % 4, &bytes[16..20]), (0, b"JSON".as_slice()));
    let binary_at = 20 + json_length;
    assert_eq!(&bytes[binary_at + 4..binary_at + 8], b"BIN\0");
    assert_eq!(word(binary_at), bytes.len() - binary_at - 8);
    Glb {
        document: serde_json::from_slice(&bytes[20..binary_at]).unwrap(),
        binary: bytes[binary_at + 8..].to_vec(),
    }
}

impl Glb {
    fn view(&self, index: usize) -> &[u8] {
        let view = &self.document["bufferViews"][index];
        let start = view["byteOffset"].as_u64().unwrap() as usize;
        assert_eq!(start % 4, 0, "views are aligned");
        &self.binary[start..][..view["byteLength"].as_u64().unwrap() as usize]
    }

    pub(crate) fn floats<const N: usize>(&self, accessor: usize) -> Vec<[f32; N]> {
        let accessor = &self.document["accessors"][accessor];
        assert_eq!(accessor["componentType"], 5126);
        let values: Vec<[f32; N]> = self
            .view(accessor["bufferView"].as_u64().unwrap() as usize)
            .chunks(4 * N)
            .map(|item| std::array::from_fn(|i| f32::from_le_bytes(item[4 * i..][..4].try_into().unwrap())))
            .collect();
        assert_eq!(accessor["count"], values.len());
        values
    }

    pub(crate) fn indices(&self) -> Vec<u32> {
        let accessor = &self.document["accessors"][3];
        assert_eq!(accessor["componentType"], 5125);
        self.view(3)
            .chunks(4)
            .map(|word| u32::from_le_bytes(word.try_into().unwrap()))
            .collect()
    }

    pub(crate) fn texture(&self) -> Option<&[u8]> {
        let view = self.document["images"][0]["bufferView"].as_u64()?;
        Some(self.view(view as usize))
    }
}

/// `work` in a pool of `count` threads.
pub(crate) fn on_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .unwrap()
        .install(work)
}
