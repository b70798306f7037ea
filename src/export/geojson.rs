//! `rivers.geojson` and `folds.geojson`: rivers, crests and troughs as lines (Butler et al. 2016, RFC 7946).
//!
//! The land has no place on the Earth, so coordinates are not longitude and latitude but plan kilometres: x east,
//! y north, from the south-west corner. The collection says so in its member `frame`.

use std::io::{self, Write};

use glam::DVec2;
use serde::Serialize;

use crate::surface::{FoldLine, River};
use crate::units::{Extent, KM};

#[derive(Serialize)]
struct Collection<P, C> {
    r#type: &'static str,
    /// What the coordinates mean where they are not longitude and latitude.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<&'static str>,
    bbox: [f64; 4],
    features: Vec<Feature<P, C>>,
}

/// A thing with properties; `C` are the coordinates of its geometry.
#[derive(Serialize)]
pub(super) struct Feature<P, C> {
    r#type: &'static str,
    properties: P,
    geometry: Geometry<C>,
}

#[derive(Serialize)]
struct Geometry<C> {
    r#type: &'static str,
    coordinates: C,
}

impl<P, C> Feature<P, C> {
    /// A feature of the geometry type `kind`.
    pub(super) fn new(properties: P, kind: &'static str, coordinates: C) -> Self {
        Self {
            r#type: "Feature",
            properties,
            geometry: Geometry {
                r#type: kind,
                coordinates,
            },
        }
    }
}

type Line = Vec<[f64; 2]>;

#[derive(Serialize)]
struct RiverProperties {
    strahler_order: u32,
    length_km: f64,
    /// Per vertex, downstream.
    drainage_km2: Vec<f64>,
}

/// Writes rivers as a feature collection of lines, with Strahler's order, the length, and the drainage area at each
/// vertex. Positions are rounded to 0.1 m, areas to 0.001 km².
///
/// # Errors
/// Where `out` fails.
pub fn write_rivers(out: impl Write, extent: Extent, rivers: &[River]) -> io::Result<()> {
    let features = rivers.iter().map(|river| {
        let properties = RiverProperties {
            strahler_order: river.order,
            length_km: rounded(river.length() / KM, 1e4),
            drainage_km2: river
                .points
                .iter()
                .map(|p| rounded(p.drainage / (KM * KM), 1e3))
                .collect(),
        };
        feature(properties, river.points.iter().map(|p| p.at))
    });
    write_lines(out, extent, features.collect())
}

#[derive(Serialize)]
struct FoldProperties {
    kind: &'static str,
    layer: usize,
    wavelength_m: f64,
}

/// Writes crests and troughs of folds as a feature collection of lines, with `kind` (`top` or `bottom`), the layer that
/// folds, and the wavelength. Positions are rounded to 0.1 m, wavelengths too.
///
/// # Errors
/// Where `out` fails.
pub fn write_folds(out: impl Write, extent: Extent, folds: &[FoldLine]) -> io::Result<()> {
    let features = folds.iter().map(|fold| {
        let properties = FoldProperties {
            kind: if fold.crest { "top" } else { "bottom" },
            layer: fold.layer,
            wavelength_m: rounded(fold.wavelength_m, 10.0),
        };
        feature(properties, fold.points.iter().copied())
    });
    write_lines(out, extent, features.collect())
}

fn feature<P>(properties: P, line: impl Iterator<Item = DVec2>) -> Feature<P, Line> {
    let points = line.map(|p| [rounded(p.x / KM, 1e4), rounded(p.y / KM, 1e4)]);
    Feature::new(properties, "LineString", points.collect())
}

fn write_lines(
    out: impl Write,
    extent: Extent,
    features: Vec<Feature<impl Serialize, Line>>,
) -> io::Result<()> {
    let frame = "plan kilometres, x east, y north, origin south-west corner";
    let bbox = [0.0, 0.0, extent.width / KM, extent.height / KM];
    write_collection(out, Some(frame), bbox, features)
}

/// Writes a feature collection on one line. `frame` says what the coordinates are where they are not degrees.
pub(super) fn write_collection(
    mut out: impl Write,
    frame: Option<&'static str>,
    bbox: [f64; 4],
    features: Vec<Feature<impl Serialize, impl Serialize>>,
) -> io::Result<()> {
    let collection = Collection {
        r#type: "FeatureCollection",
        frame,
        bbox,
        features,
    };
    serde_json::to_writer(&mut out, &collection)?;
    out.write_all(b"\n")
}

/// The nearest number with so many steps per unit.
pub(super) fn rounded(value: f64, steps_per_unit: f64) -> f64 {
    (value * steps_per_unit).round() / steps_per_unit
}
