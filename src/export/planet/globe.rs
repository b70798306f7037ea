//! `planet.glb`: the globe as a mesh.

use std::io::{self, Write};

use glam::DVec3;
use serde_json::json;

use crate::export::gltf::{Dress, Model};
use crate::sphere::RADIUS_KM;
use crate::surface::planet::Planet;

/// How many times higher the relief is than it should be.
pub const EXAGGERATION: f64 = 20.0;

/// Heights (metres) and their colours (sRGB), between which colours are blended.
const RAMP: [(f32, [f32; 3]); 9] = [
    (-8_000.0, [9.0, 26.0, 58.0]),
    (-4_500.0, [22.0, 58.0, 98.0]),
    (-2_500.0, [44.0, 96.0, 134.0]),
    (-200.0, [116.0, 165.0, 180.0]),
    (0.0, [112.0, 139.0, 94.0]),
    (600.0, [148.0, 158.0, 104.0]),
    (1_800.0, [170.0, 144.0, 104.0]),
    (3_500.0, [140.0, 112.0, 92.0]),
    (5_500.0, [240.0, 240.0, 240.0]),
];

/// Writes the lattice's triangles, raised by their heights, [`EXAGGERATION`] times; the sphere's radius is 1. glTF's y axis
/// is the north pole, and the prime meridian lies on x: `(x, z, −y)`, a rotation. Vertices are coloured by height.
///
/// # Errors
/// Where `out` fails.
pub fn write_globe(out: impl Write, planet: &Planet) -> io::Result<()> {
    let places = planet.lattice.points().iter().zip(&planet.elevation_m);
    let model = Model {
        name: "planet",
        material: "crust",
        extras: json!({
            "frame": "1 = the radius, y north pole, x prime meridian",
            "radius_km": RADIUS_KM,
            "exaggeration": EXAGGERATION,
        }),
        positions: places
            .map(|(p, &metres)| {
                let radius = 1.0 + EXAGGERATION * f64::from(metres) / 1000.0 / RADIUS_KM;
                DVec3::new(p.x, p.z, -p.y) * radius
            })
            .collect(),
        triangles: planet.lattice.triangles(),
        dress: Dress::Colours(planet.elevation_m.iter().map(|&metres| colour(metres)).collect()),
    };
    model.write(out)
}

/// Linear RGB of a height.
fn colour(metres: f32) -> [f32; 3] {
    let above = RAMP.iter().position(|&(height, _)| metres < height);
    let (low, high) = match above {
        None => (RAMP[RAMP.len() - 1], RAMP[RAMP.len() - 1]),
        Some(0) => (RAMP[0], RAMP[0]),
        Some(k) => (RAMP[k - 1], RAMP[k]),
    };
    let part = if high.0 > low.0 {
        (metres - low.0) / (high.0 - low.0)
    } else {
        0.0
    };
    std::array::from_fn(|k| linear((low.1[k] + part * (high.1[k] - low.1[k])) / 255.0))
}

/// From sRGB (IEC 61966-2-1) to linear light, both 0–1.
fn linear(value: f32) -> f32 {
    if value <= 0.040_45 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}
