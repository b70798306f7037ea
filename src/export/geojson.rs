//! `rivers.geojson`: rivers as lines (Butler et al. 2016, RFC 7946).
//!
//! The land has no place on the Earth, so coordinates are not longitude and latitude but plan kilometres: x east,
//! y north, from the south-west corner. The collection says so in its member `frame`.

use std::io::{self, Write};

use serde::Serialize;

use crate::surface::River;
use crate::units::{Extent, KM};

#[derive(Serialize)]
struct Collection {
    r#type: &'static str,
    frame: &'static str,
    bbox: [f64; 4],
    features: Vec<Feature>,
}

#[derive(Serialize)]
struct Feature {
    r#type: &'static str,
    properties: Properties,
    geometry: Line,
}

#[derive(Serialize)]
struct Properties {
    strahler_order: u32,
    length_km: f64,
    /// Per vertex, downstream.
    drainage_km2: Vec<f64>,
}

#[derive(Serialize)]
struct Line {
    r#type: &'static str,
    coordinates: Vec<[f64; 2]>,
}

/// Writes rivers as a feature collection of lines, with Strahler's order, the length, and the drainage area at each
/// vertex. Positions are rounded to 0.1 m, areas to 0.001 km².
///
/// # Errors
/// Where `out` fails.
pub fn write_rivers(mut out: impl Write, extent: Extent, rivers: &[River]) -> io::Result<()> {
    let collection = Collection {
        r#type: "FeatureCollection",
        frame: "plan kilometres, x east, y north, origin south-west corner",
        bbox: [0.0, 0.0, extent.width / KM, extent.height / KM],
        features: rivers
            .iter()
            .map(|river| Feature {
                r#type: "Feature",
                properties: Properties {
                    strahler_order: river.order,
                    length_km: rounded(river.length() / KM, 1e4),
                    drainage_km2: river
                        .points
                        .iter()
                        .map(|p| rounded(p.drainage / (KM * KM), 1e3))
                        .collect(),
                },
                geometry: Line {
                    r#type: "LineString",
                    coordinates: river
                        .points
                        .iter()
                        .map(|p| [rounded(p.at.x / KM, 1e4), rounded(p.at.y / KM, 1e4)])
                        .collect(),
                },
            })
            .collect(),
    };
    serde_json::to_writer(&mut out, &collection)?;
    out.write_all(b"\n")
}

fn rounded(value: f64, steps_per_unit: f64) -> f64 {
    (value * steps_per_unit).round() / steps_per_unit
}
