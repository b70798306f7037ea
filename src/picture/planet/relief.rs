//! Heights between the samples: interpolated, with coasts that wind and mountains that have crests.

use glam::{DVec3, Quat, Vec3};

use super::noise::{drift, finer, gradient};
use super::palette::smoothstep;
use crate::surface::planet::Planet;

/// How far a place is displaced before the samples are looked at, in spacings of the samples: a coast does not show them.
const WARP: f32 = 0.55;
/// Cells per radian of the first octave of detail, and of the broad variation of the cover.
const DETAIL: f32 = 9.0;
const COVER: f32 = 3.1;
/// Height of the detail of plains and of mountains, km.
const PLAIN_KM: f32 = 0.06;
const HILLS_KM: f32 = 0.42;
/// Height of the stripes that young sea floor keeps of its ridge, km, and their number per radian.
const ABYSSAL_KM: f32 = 0.16;
const ABYSSAL: f32 = 60.0;

/// What is at a place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// Height above the sea, km.
    pub(super) km: f32,
    /// Variation of the cover, −1 to 1: broad, middling, fine.
    pub(super) variation: [f32; 3],
}

/// Detail that belongs to a plate and travels with it.
#[derive(Clone, Copy, Debug, Default)]
struct Detail {
    away: Vec3,
    middling: f32,
    broad: f32,
    soft: f32,
    sharp: f32,
}

/// A planet's heights everywhere.
pub(super) struct Relief<'a> {
    planet: &'a Planet,
    octaves: u32,
    /// From the world's frame to each plate's.
    turns: Vec<Quat>,
}

impl<'a> Relief<'a> {
    /// For a picture whose pixels are `pixel` radians wide.
    pub(super) fn new(planet: &'a Planet, pixel: f32) -> Self {
        let octaves = (0.7 / (pixel * DETAIL)).log2().ceil().clamp(1.0, 9.0) as u32;
        let turns = planet
            .plates
            .iter()
            .map(|plate| plate.rotation.inverse().as_quat());
        Self {
            planet,
            octaves,
            turns: turns.collect(),
        }
    }

    /// What is at the direction `p`.
    pub(super) fn at(&self, p: DVec3) -> Place {
        let planet = self.planet;
        let (corners, weights) = planet.lattice.locate(p);
        // Where plates meet, the detail of one passes into that of the other.
        let mut all = Detail::default();
        let mut done = [u16::MAX; 3];
        for k in 0..3 {
            let plate = planet.plate[corners[k] as usize];
            if done[..k].contains(&plate) {
                continue;
            }
            done[k] = plate;
            let share: f64 = (k..3)
                .filter(|&j| planet.plate[corners[j] as usize] == plate)
                .map(|j| weights[j])
                .sum();
            let turn = self.turns[plate as usize];
            let one = self.detail(turn * p.as_vec3());
            let share = share as f32;
            all.away += share * (turn.inverse() * one.away);
            all.middling += share * one.middling;
            all.broad += share * one.broad;
            all.soft += share * one.soft;
            all.sharp += share * one.sharp;
        }
        let reach = WARP * planet.lattice.spacing() as f32;
        let (km, rough, crests, stripes) = self.ground(p + (reach * all.away).as_dvec3());
        Place {
            km: km + rough * (all.soft + crests * 2.0 * all.sharp) + stripes,
            variation: [all.broad, all.middling, all.soft],
        }
    }

    /// Where to look for the kind of ground at `p`, so that its outline winds as coasts do.
    pub(super) fn bent(&self, p: DVec3) -> DVec3 {
        let planet = self.planet;
        let turn = self.turns[planet.plate[planet.lattice.nearest(p) as usize] as usize];
        let own = turn * p.as_vec3();
        let reach = WARP * planet.lattice.spacing() as f32;
        (p + (reach * (turn.inverse() * away(own, wide(own)))).as_dvec3()).normalize()
    }

    fn detail(&self, own: Vec3) -> Detail {
        let wide = wide(own);
        let mut all = Detail {
            away: away(own, wide),
            middling: 1.3 * gradient(own * 12.0, 4),
            broad: gradient(own * COVER, 3),
            soft: 0.0,
            sharp: 0.0,
        };
        let (mut p, mut amplitude) = (own * DETAIL, 1.0);
        for octave in 0..self.octaves {
            let value = gradient(p, 11 + octave);
            all.soft += amplitude * value;
            // Crests: sharp above, wide between.
            all.sharp += amplitude * (0.58 - 1.9 * value.abs());
            amplitude *= 0.6;
            p = finer(p);
        }
        all
    }

    /// Between the samples: height, roughness, share of mountains, and the stripes of young sea floor, km.
    fn ground(&self, p: DVec3) -> (f32, f32, f32, f32) {
        let planet = self.planet;
        let p = p.normalize();
        let (corners, weights) = planet.lattice.locate(p);
        let (mut km, mut crests, mut young) = (0.0, 0.0, 0.0);
        let mut along = Vec3::ZERO;
        for (corner, weight) in corners.into_iter().zip(weights) {
            let (i, weight) = (corner as usize, weight as f32);
            km += weight * planet.elevation_m[i] / 1000.0;
            if planet.continental[i] {
                let age = planet.orogeny_age_my[i];
                crests +=
                    weight * smoothstep(0.5, 2.5, planet.elevation_m[i] / 1000.0) * (-age / 150.0).exp();
            } else {
                young += weight * (-planet.age_my[i] / 40.0).exp();
                let ridge = planet.ridge[i];
                along += weight * if ridge.dot(along) < 0.0 { -ridge } else { ridge };
            }
        }
        let rough = PLAIN_KM + HILLS_KM * smoothstep(0.2, 2.4, km);
        let stripes = if young > 0.05 && along.length_squared() > 0.1 {
            // Fracture zones run across the ridge: the floor varies along it.
            let at = p.as_vec3();
            ABYSSAL_KM * young * gradient(Vec3::new(at.dot(along) * ABYSSAL, at.x * 6.0, at.y * 6.0), 31)
        } else {
            0.0
        };
        (km, rough, crests.min(1.0), stripes)
    }
}

/// The widest windings, in a plate's frame.
fn wide(own: Vec3) -> Vec3 {
    drift(own * 21.0, 5)
}

/// The windings, and finer ones on them.
fn away(own: Vec3, wide: Vec3) -> Vec3 {
    wide + 0.6 * drift(own * 47.0, 7) + 0.35 * drift(own * 103.0, 9)
}
