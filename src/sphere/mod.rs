//! The sphere: samples that never move, who neighbours whom, and which sample is nearest to any point.
//!
//! Directions are unit vectors in a right-handed frame: `z` is the north pole, `x` is where the prime meridian meets the
//! equator, `y` is 90° east. Lengths on the unit sphere are radians.

mod lattice;
mod mesh;

pub use lattice::{Lattice, LatticeError, SAMPLES_RANGE};

use glam::DVec3;

/// Mean radius of the planet, km (Cortial et al. 2019, Appendix A).
pub const RADIUS_KM: f64 = 6370.0;

/// The direction of a place; degrees north and east.
pub fn direction(latitude_deg: f64, longitude_deg: f64) -> DVec3 {
    let (sin_lat, cos_lat) = latitude_deg.to_radians().sin_cos();
    let (sin_lon, cos_lon) = longitude_deg.to_radians().sin_cos();
    DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
}

/// The place of a direction: degrees north (−90 to 90) and degrees east (−180 to 180).
pub fn latitude_longitude(p: DVec3) -> (f64, f64) {
    let latitude = p.z.atan2(p.x.hypot(p.y)).to_degrees();
    (latitude, p.y.atan2(p.x).to_degrees())
}

/// Great-circle distance of two unit vectors, radians. Exact for small and for large angles.
pub fn arc(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}
