//! `plates.geojson`: the plates' outlines (Butler et al. 2016, RFC 7946).

use std::io::{self, Write};

use glam::DVec3;
use serde::Serialize;

use super::outline::rings;
use super::unroll::polygons;
use crate::export::geojson::{Feature, rounded, write_collection};
use crate::sphere::{RADIUS_KM, latitude_longitude};
use crate::surface::planet::Planet;

#[derive(Serialize)]
struct PlateProperties {
    /// Its name for life.
    id: u32,
    /// Its number in `plates.rot`.
    gplates_id: u32,
    /// The Euler pole about which it turns counter-clockwise; none where it stands still.
    pole_latitude: Option<f64>,
    pole_longitude: Option<f64>,
    rate_deg_per_my: f64,
    area_mkm2: f64,
    /// Share of its area, 0–1.
    continental: f64,
}

/// Writes one feature per plate, a multi-polygon of longitude and latitude: outer rings counter-clockwise, cut at the
/// antimeridian, led along the edge of the map around a pole. Outlines are the Voronoi edges between samples. Places are
/// rounded to a millionth of a degree.
///
/// # Errors
/// Where `out` fails.
pub fn write_plates(out: impl Write, planet: &Planet) -> io::Result<()> {
    let lattice = &planet.lattice;
    let outlines = rings(lattice, &planet.plate, planet.plates.len());
    let on_edge = planet.plate[lattice.nearest(DVec3::NEG_X) as usize];
    let features = planet.plates.iter().zip(outlines).enumerate();
    let features = features.map(|(index, (plate, rings))| {
        let turns = plate.omega.length();
        let pole = (turns > 0.0).then(|| latitude_longitude(plate.omega / turns));
        let properties = PlateProperties {
            id: plate.id,
            gplates_id: super::rotations::gplates_id(plate.id),
            pole_latitude: pole.map(|(latitude, _)| rounded(latitude, 1e4)),
            pole_longitude: pole.map(|(_, longitude)| rounded(longitude, 1e4)),
            rate_deg_per_my: rounded(turns.to_degrees(), 1e6),
            area_mkm2: rounded(plate.area_sr * RADIUS_KM * RADIUS_KM / 1e6, 1e6),
            continental: rounded(plate.continental, 1e6),
        };
        let polygons = polygons(&rings, usize::from(on_edge) == index);
        Feature::new(properties, "MultiPolygon", polygons)
    });
    write_collection(out, None, [-180.0, -90.0, 180.0, 90.0], features.collect())
}
