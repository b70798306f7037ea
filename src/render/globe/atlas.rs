//! A planet's samples → the faces of a cube, as the graphics card looks things up by direction.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::picture::colour::smoothstep;
use crate::sphere::Lattice;
use crate::surface::planet::{Orogeny, Planet};

/// Texels of a face along one cell of the lattice: enough that no triangle falls between them.
const TEXELS_PER_CELL: f64 = 1.9;
/// Least and greatest width of a face, texels.
const WIDTHS: (u32, u32) = (64, 768);

/// Roughness of plains, what hills add, and the sea floor's, km: that of a ridge, and of old floor.
const PLAIN_KM: f32 = 0.15;
const HILLS_KM: f32 = 0.45;
const RIDGE_KM: f32 = 0.24;
const ABYSS_KM: f32 = 0.07;
/// Time in which the sea floor is buried, and in which mountains are worn to hills, My.
const BURIAL_MY: f32 = 45.0;
const WEAR_MY: f32 = 180.0;

/// How much of the detail is the other plate's at a border, and a sample further on.
const SHARES: [f32; 2] = [0.46, 0.18];

/// What of the crust a texel holds: height (km), roughness (km), share of mountains, and nothing.
type Crust = [f32; 4];

/// The plate of a sample, the nearest other one, and how much the detail is the other's, out of 255.
pub(super) type Pair = [u8; 4];

/// Where each texel of six faces looks on a lattice. Made once; then a planet is laid out by look-ups.
pub(super) struct Atlas {
    lattice: Arc<Lattice>,
    width: u32,
    looks: Vec<Look>,
}

/// A triangle of the lattice, the weights of its corners, and the nearest of them.
#[derive(Clone, Copy)]
struct Look {
    corners: [u32; 3],
    weights: [f32; 3],
    nearest: u32,
}

impl Atlas {
    pub(super) fn new(lattice: &Arc<Lattice>) -> Self {
        let cells = std::f64::consts::FRAC_PI_2 / lattice.spacing();
        let width = ((cells * TEXELS_PER_CELL) as u32).clamp(WIDTHS.0, WIDTHS.1);
        let texels = 6 * width * width;
        let looks = (0..texels)
            .into_par_iter()
            .map(|texel| {
                let (face, place) = (texel / (width * width), texel % (width * width));
                let part = |at: u32| (2.0 * f64::from(at) + 1.0) / f64::from(width) - 1.0;
                let p = direction(face, part(place % width), part(place / width));
                let nearest = lattice.nearest(p);
                let (corners, weights) = lattice.locate_near(p, nearest);
                Look {
                    corners,
                    weights: weights.map(|weight| weight as f32),
                    nearest,
                }
            })
            .collect();
        Self {
            lattice: Arc::clone(lattice),
            width,
            looks,
        }
    }

    /// True if it is of this lattice.
    pub(super) fn is_of(&self, lattice: &Arc<Lattice>) -> bool {
        Arc::ptr_eq(&self.lattice, lattice)
    }

    /// Texels along a side of a face.
    pub(super) fn width(&self) -> u32 {
        self.width
    }

    /// The crust as texels of four half floats.
    pub(super) fn crust(&self, planet: &Planet) -> Vec<[u16; 4]> {
        let samples: Vec<Crust> = (0..planet.elevation_m.len())
            .into_par_iter()
            .map(|i| crust(planet, i))
            .collect();
        self.looks
            .par_iter()
            .map(|look| {
                let mut mixed = [0.0; 4];
                for (&corner, weight) in look.corners.iter().zip(look.weights) {
                    for (sum, value) in mixed.iter_mut().zip(samples[corner as usize]) {
                        *sum += weight * value;
                    }
                }
                mixed.map(half)
            })
            .collect()
    }

    /// The plates, as far as a byte holds their numbers.
    pub(super) fn plates(&self, planet: &Planet) -> Vec<Pair> {
        let at_border: Vec<Option<u16>> = (0..planet.plate.len() as u32)
            .into_par_iter()
            .map(|i| {
                let plates = self
                    .lattice
                    .neighbours(i)
                    .iter()
                    .map(|&j| planet.plate[j as usize]);
                plates
                    .into_iter()
                    .find(|&plate| plate != planet.plate[i as usize])
            })
            .collect();
        let samples: Vec<Pair> = (0..planet.plate.len() as u32)
            .into_par_iter()
            .map(|i| {
                let own = planet.plate[i as usize];
                let near = self.lattice.neighbours(i).iter();
                let (other, share) = match at_border[i as usize] {
                    Some(other) => (other, SHARES[0]),
                    None => match near
                        .filter_map(|&j| at_border[j as usize])
                        .find(|&plate| plate != own)
                    {
                        Some(other) => (other, SHARES[1]),
                        None => (own, 0.0),
                    },
                };
                [own.min(255) as u8, other.min(255) as u8, (share * 255.0) as u8, 0]
            })
            .collect();
        self.looks
            .par_iter()
            .map(|look| {
                let [own, other, ..] = samples[look.nearest as usize];
                let shares = look.corners.map(|corner| f32::from(samples[corner as usize][2]));
                let share: f32 = shares
                    .iter()
                    .zip(look.weights)
                    .map(|(share, weight)| share * weight)
                    .sum();
                [own, other, share as u8, 0]
            })
            .collect()
    }
}

/// What is drawn of sample `i`.
fn crust(planet: &Planet, i: usize) -> Crust {
    let km = planet.elevation_m[i] / 1000.0;
    let km = if km.is_finite() { km } else { 0.0 };
    let built = match planet.orogeny[i] {
        Orogeny::None => 0.0,
        Orogeny::Andean | Orogeny::Himalayan => (-planet.orogeny_age_my[i] / WEAR_MY).exp(),
    };
    let high = smoothstep(0.7, 3.2, km);
    if planet.continental[i] {
        let mountains = high.max(0.6 * built * smoothstep(0.2, 1.2, km));
        let rough = PLAIN_KM + HILLS_KM * smoothstep(0.2, 2.4, km);
        [km, rough, mountains, 0.0]
    } else {
        let young = (-planet.age_my[i] / BURIAL_MY).exp();
        [km, ABYSS_KM + (RIDGE_KM - ABYSS_KM) * young, high, 0.0]
    }
}

/// The direction of a place of a face, −1 to 1 from its top-left corner, in the order and orientation of cube maps.
fn direction(face: u32, x: f64, y: f64) -> DVec3 {
    let way = match face {
        0 => DVec3::new(1.0, -y, -x),
        1 => DVec3::new(-1.0, -y, x),
        2 => DVec3::new(x, 1.0, y),
        3 => DVec3::new(x, -1.0, -y),
        4 => DVec3::new(x, -y, 1.0),
        _ => DVec3::new(-x, -y, -1.0),
    };
    way.normalize()
}

/// The half float nearest to `value` (IEEE 754 binary16); what is too small becomes 0, what is too large the largest.
fn half(value: f32) -> u16 {
    let bits = value.to_bits();
    let sign = (bits >> 16 & 0x8000) as u16;
    // Rounded to the ten digits that are left, then the exponent's bias is changed from 127 to 15.
    let rounded = (bits & 0x7fff_ffff) + 0x1000;
    match (rounded >> 13).checked_sub(112 << 10) {
        None | Some(0..0x400) => sign,
        Some(kept) => sign | kept.min(0x7bff) as u16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a half float stands for.
    fn whole(half: u16) -> f32 {
        let exponent = i32::from(half >> 10 & 31) - 15;
        let digits = 1.0 + f32::from(half & 0x3ff) / 1024.0;
        let size = if matches!(half, 0 | 0x8000) {
            0.0
        } else {
            digits * 2.0_f32.powi(exponent)
        };
        if half & 0x8000 == 0 { size } else { -size }
    }

    #[test]
    fn halves_keep_three_digits() {
        for value in [1.0, -1.0, 0.333_3, -10.97, 8.848, 0.001, 65504.0, 1.999_9] {
            let kept = whole(half(value));
            assert!(((kept - value) / value).abs() < 1.0 / 2048.0, "{value}: {kept}");
        }
        assert_eq!(half(0.0), 0);
        assert_eq!(half(1e-9), 0);
        assert_eq!(whole(half(1e9)), 65504.0);
    }

    #[test]
    fn every_texel_looks_where_its_face_does() {
        let lattice = Arc::new(Lattice::new(2000).expect("lattice"));
        let atlas = Atlas::new(&lattice);
        let middle = |face: u32| {
            let texel = face * atlas.width * atlas.width + atlas.width / 2 * (atlas.width + 1);
            lattice.point(atlas.looks[texel as usize].nearest)
        };
        let axes = [
            DVec3::X,
            DVec3::NEG_X,
            DVec3::Y,
            DVec3::NEG_Y,
            DVec3::Z,
            DVec3::NEG_Z,
        ];
        for (face, axis) in axes.into_iter().enumerate() {
            assert!(middle(face as u32).dot(axis) > 0.99, "face {face}");
        }
    }
}
