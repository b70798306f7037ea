//! Maps of a planet: fields of its samples on equirectangular pixels.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::sphere::{Lattice, direction};
use crate::surface::planet::Planet;

/// What `age_my` is where there is no sea floor.
pub const AGE_OF_CONTINENTS: f32 = -1.0;

/// `elevation16.json`: what turns steps back into metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sidecar {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Height of step 0, metres above the sea.
    pub metres_at_0: f64,
    /// Height of step 65535, metres above the sea.
    pub metres_at_65535: f64,
    /// Always `equirectangular`.
    pub projection: String,
    /// Outer edges of the map, degrees: west, south, east, north.
    pub bounds_deg: [f64; 4],
    /// What a pixel stands for: always `area` (its value belongs to its centre).
    pub pixel: String,
}

impl Sidecar {
    /// Of a map of `(width, height)` pixels whose first and last steps are `low` and `high` metres.
    pub(super) fn new((width, height): (usize, usize), (low, high): (f64, f64)) -> Self {
        Self {
            width,
            height,
            metres_at_0: low,
            metres_at_65535: high,
            projection: "equirectangular".to_owned(),
            bounds_deg: [-180.0, -90.0, 180.0, 90.0],
            pixel: "area".to_owned(),
        }
    }
}

/// The pixels of an equirectangular map, and where each lies among the samples.
#[derive(Clone, Debug)]
pub struct Equirectangular {
    width: usize,
    places: Vec<Place>,
}

/// The triangle around a pixel's centre, and its barycentric weights there.
#[derive(Clone, Copy, Debug)]
struct Place {
    corners: [u32; 3],
    weights: [f32; 3],
}

impl Equirectangular {
    /// A map `width` pixels wide (at least 2; an odd one is rounded down) and half as high.
    pub fn new(lattice: &Lattice, width: usize) -> Self {
        let height = (width / 2).max(1);
        let width = 2 * height;
        let places = (0..width * height)
            .into_par_iter()
            .with_min_len(1024)
            .map(|pixel| {
                let latitude = 90.0 - 180.0 * ((pixel / width) as f64 + 0.5) / height as f64;
                let longitude = -180.0 + 360.0 * ((pixel % width) as f64 + 0.5) / width as f64;
                let (corners, weights) = lattice.locate(direction(latitude, longitude));
                Place {
                    corners,
                    weights: weights.map(|weight| weight as f32),
                }
            })
            .collect();
        Self { width, places }
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.width / 2)
    }

    /// Height above the sea, metres, row by row from the north.
    pub fn elevation(&self, planet: &Planet) -> Vec<f32> {
        let at = |corner: u32| planet.elevation_m[corner as usize];
        self.places
            .iter()
            .map(|place| {
                let parts = place.corners.iter().zip(place.weights);
                parts.map(|(&corner, weight)| weight * at(corner)).sum()
            })
            .collect()
    }

    /// Age of the sea floor, My, from the oceanic samples around a pixel; [`AGE_OF_CONTINENTS`] where most of the crust
    /// is continental.
    pub fn age(&self, planet: &Planet) -> Vec<f32> {
        self.places
            .iter()
            .map(|place| {
                let parts = place.corners.iter().zip(place.weights);
                let (mut sea, mut age) = (0.0, 0.0);
                for (&corner, weight) in parts {
                    if !planet.continental[corner as usize] {
                        sea += weight;
                        age += weight * planet.age_my[corner as usize];
                    }
                }
                if sea > 0.5 { age / sea } else { AGE_OF_CONTINENTS }
            })
            .collect()
    }
}
