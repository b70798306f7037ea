//! Smooth noise on the sphere.

use fastnoise_lite::{FastNoiseLite, FractalType, NoiseType};
use glam::DVec3;
use rayon::prelude::*;

use crate::sphere::{Lattice, RADIUS_KM};

/// Gradient noise of a wavelength, with octaves below it.
pub(super) struct Noise {
    noise: FastNoiseLite,
    scale: f64,
}

impl Noise {
    /// Noise of `wavelength_km` and `octaves` of half the wavelength and half the strength each.
    pub(super) fn new(seed: u64, wavelength_km: f64, octaves: i32) -> Self {
        let mut noise = FastNoiseLite::with_seed((seed ^ (seed >> 32)) as i32);
        noise.set_noise_type(Some(NoiseType::OpenSimplex2));
        noise.set_fractal_type(Some(if octaves > 1 {
            FractalType::FBm
        } else {
            FractalType::None
        }));
        noise.set_fractal_octaves(Some(octaves));
        noise.set_frequency(Some(1.0));
        Self {
            noise,
            scale: RADIUS_KM / wavelength_km,
        }
    }

    /// Between −1 and 1.
    pub(super) fn at(&self, p: DVec3) -> f64 {
        // Away from the axes, along which lattices of noise can be seen.
        let p = p * self.scale + DVec3::new(17.3, -5.1, 41.7);
        f64::from(self.noise.get_noise_3d(p.x as f32, p.y as f32, p.z as f32)).clamp(-1.0, 1.0)
    }

    /// At each sample of a lattice.
    pub(super) fn on(&self, lattice: &Lattice) -> Vec<f32> {
        let points = lattice.points().par_iter().with_min_len(1024);
        points.map(|&p| self.at(p) as f32).collect()
    }

    /// A point displaced by up to `by_km` in a random direction that changes smoothly: for borders that wind.
    pub(super) fn warped(&self, p: DVec3, by_km: f64) -> DVec3 {
        let shift = DVec3::new(
            self.at(p),
            self.at(DVec3::new(p.y, p.z, p.x) + DVec3::splat(3.7)),
            self.at(DVec3::new(p.z, p.x, p.y) - DVec3::splat(5.3)),
        );
        (p + shift * (by_km / RADIUS_KM)).normalize()
    }
}
