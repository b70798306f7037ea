//! The files of a planet: maps, the globe as a mesh, plates as polygons, and how they turned.
//!
//! | file | what it holds |
//! |---|---|
//! | `elevation.exr` | channel `elevation_m`: height above the sea, 32-bit float |
//! | `elevation16.png`, `elevation16.json` | the same as 16-bit steps, and the metres of the first and the last step |
//! | `age.exr` | channel `age_my`: age of the sea floor, My; −1 on continents |
//! | `planet.glb` | the globe with exaggerated relief and coloured heights |
//! | `plates.geojson` | the plates' outlines (RFC 7946) and their motions |
//! | `plates.rot` | the plates' rotations through time, for `GPlates` |
//!
//! Maps are equirectangular, twice as wide as high, pixel = area: row 0 lies in the north, column 0 begins at 180° W.

mod globe;
mod map;
mod outline;
mod plates;
mod rotations;
mod unroll;

use std::io;

use super::height16::{Steps, write_png};
use super::{ExportError, OutDir, exr};
use crate::surface::planet::Planet;

pub use globe::{EXAGGERATION, write_globe};
pub use map::{AGE_OF_CONTINENTS, Equirectangular, Sidecar};
pub use plates::write_plates;
pub use rotations::{Rotation, write_rotations};

/// Writes all files of a planet into `out`; maps are `width` pixels wide. `history` says how its plates turned, the last
/// entries being those of `planet`.
///
/// # Errors
/// [`ExportError::File`] names the file that could not be written.
pub fn write(out: &OutDir, planet: &Planet, history: &[Rotation], width: usize) -> Result<(), ExportError> {
    let map = Equirectangular::new(&planet.lattice, width);
    let (width, height) = map.size();
    let elevation = map.elevation(planet);
    out.write("elevation.exr", |w| {
        exr::write(w, width, height, &[("elevation_m", &elevation)])
    })?;
    let steps = Steps::new(&elevation).map_err(|source| ExportError::File {
        file: out.path().join("elevation16.png"),
        source,
    })?;
    out.write("elevation16.png", |w| write_png(w, map.size(), &steps.values))?;
    let sidecar = Sidecar::new(map.size(), (steps.low, steps.high));
    out.write("elevation16.json", |w| {
        serde_json::to_writer_pretty(&mut *w, &sidecar)?;
        io::Write::write_all(w, b"\n")
    })?;
    let age = map.age(planet);
    out.write("age.exr", |w| exr::write(w, width, height, &[("age_my", &age)]))?;
    out.write("planet.glb", |w| write_globe(w, planet))?;
    out.write("plates.geojson", |w| write_plates(w, planet))?;
    out.write("plates.rot", |w| write_rotations(w, history))?;
    Ok(())
}
