//! Rifting: a plate is torn into parts that leave each other (section 4.4).

use glam::DVec3;
use rand_pcg::Pcg64Mcg;

use super::noise::Noise;
use super::params::GlobeParams;
use super::plate::Plate;
use super::random::{unit, word};
use crate::sphere::{Lattice, RADIUS_KM, arc};
use crate::surface::planet::Grip;

/// Least share of a plate that a part must be.
const LEAST_PART: f64 = 0.08;
/// Fewest samples of a part.
const LEAST_SAMPLES: usize = 12;
/// How far a fracture winds, km, and how long its windings are.
const WINDING_KM: f64 = 260.0;
const WINDING_LENGTH_KM: f64 = 900.0;
/// Draws of random centres before a plate counts as too small.
const DRAWS: usize = 8;

/// How a plate is to be torn.
#[derive(Clone, Debug, PartialEq)]
pub enum Cut {
    /// Into 2 to 4 parts around random places.
    Parts(u8),
    /// Along a line of two or more directions in the world, which goes on straight beyond its ends.
    Line(Vec<DVec3>),
}

/// Why a plate was not torn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RiftError {
    /// No such plate.
    #[error("plate {0}: there is no such plate")]
    NoPlate(u32),
    /// A part would be less than a twelfth of the plate, or a dozen samples.
    #[error("plate {0}: too small to tear there")]
    TooSmall(u32),
    /// Fewer than two different points, or a number that is none.
    #[error("the line of the cut: expected two or more places that differ")]
    NoLine,
    /// Parts outside 2 to 4.
    #[error("parts: expected 2 to 4, found {0}")]
    Parts(u8),
}

/// The part (0 …) that each slot of `plate` falls to.
pub(super) fn parts(
    plate: &Plate,
    cut: &Cut,
    lattice: &Lattice,
    rng: &mut Pcg64Mcg,
) -> Result<Vec<u8>, RiftError> {
    let noise = Noise::new(word(rng), WINDING_LENGTH_KM, 3);
    let positions: Vec<DVec3> = plate
        .members()
        .iter()
        .map(|&i| noise.warped(lattice.point(i), WINDING_KM))
        .collect();
    match cut {
        Cut::Parts(count) => {
            if !(2..=4).contains(count) {
                return Err(RiftError::Parts(*count));
            }
            for _ in 0..DRAWS {
                let centres: Vec<DVec3> = (0..*count)
                    .map(|_| positions[(unit(rng) * positions.len() as f64) as usize % positions.len()])
                    .collect();
                let nearest = |p: &DVec3| {
                    let mut best = 0;
                    for k in 1..centres.len() {
                        if centres[k].dot(*p) > centres[best].dot(*p) {
                            best = k;
                        }
                    }
                    best as u8
                };
                let parts: Vec<u8> = positions.iter().map(nearest).collect();
                if all_large(&parts, *count) {
                    return Ok(parts);
                }
            }
            Err(RiftError::TooSmall(plate.id))
        }
        Cut::Line(line) => {
            let back = plate.rotation.inverse();
            let line: Vec<DVec3> = line.iter().map(|&p| back * p).collect();
            let sides = sides(&line).ok_or(RiftError::NoLine)?;
            let parts: Vec<u8> = positions
                .iter()
                .map(|&p| u8::from(is_left(p, &line, &sides)))
                .collect();
            if all_large(&parts, 2) {
                Ok(parts)
            } else {
                Err(RiftError::TooSmall(plate.id))
            }
        }
    }
}

fn all_large(parts: &[u8], count: u8) -> bool {
    let least = (LEAST_PART * parts.len() as f64).max(LEAST_SAMPLES as f64) as usize;
    let mut sizes = vec![0; count as usize];
    for &part in parts {
        sizes[part as usize] += 1;
    }
    sizes.into_iter().all(|size: usize| size >= least)
}

/// Poles of the great circles of a line's pieces; `None` where it has no length.
fn sides(line: &[DVec3]) -> Option<Vec<DVec3>> {
    if line.len() < 2 || line.iter().any(|p| !p.is_finite()) {
        return None;
    }
    line.windows(2)
        .map(|ends| ends[0].cross(ends[1]).try_normalize())
        .collect()
}

/// True for points to the left of a line of great circles.
fn is_left(p: DVec3, line: &[DVec3], sides: &[DVec3]) -> bool {
    let distance = |k: usize| {
        let (a, b, pole) = (line[k], line[k + 1], sides[k]);
        let foot = p - pole * p.dot(pole);
        let (after_a, before_b) = (pole.cross(a).dot(foot) >= 0.0, pole.cross(b).dot(foot) <= 0.0);
        // The first and the last piece go on.
        if (after_a || k == 0) && (before_b || k + 1 == sides.len()) {
            p.dot(pole).abs().min(1.0).asin()
        } else {
            arc(p, a).min(arc(p, b))
        }
    };
    let mut nearest = 0;
    for k in 1..sides.len() {
        if distance(k) < distance(nearest) {
            nearest = k;
        }
    }
    p.dot(sides[nearest]) > 0.0
}

/// Splits a plate into the parts of its slots. The parts leave its middle; names of the new ones come from `next_id`.
pub(super) fn split(
    plate: &Plate,
    parts: &[u8],
    mut next_id: impl FnMut() -> u32,
    lattice: &Lattice,
    params: &GlobeParams,
) -> Vec<Plate> {
    let count = parts.iter().max().map_or(0, |&most| most + 1);
    let middle = plate.centroid(lattice);
    (0..count)
        .map(|k| {
            let slots: Vec<usize> = (0..parts.len()).filter(|&slot| parts[slot] == k).collect();
            let members = slots.iter().map(|&slot| plate.members()[slot]).collect();
            let crust = slots.iter().map(|&slot| plate.crust[slot]).collect();
            let id = if k == 0 { plate.id } else { next_id() };
            let mut part = Plate::new(id, plate.rotation, members, crust, lattice);
            let centre = part.centroid(lattice);
            // Directly away from each other, so that no edge of the new parts collides (section 7.5).
            let apart = middle.cross(centre).try_normalize().unwrap_or(DVec3::Z);
            let own = if plate.grip == Grip::Free {
                plate.omega
            } else {
                DVec3::ZERO
            };
            let omega = own * 0.5 + apart * (params.rift_speed / 2.0 / RADIUS_KM);
            part.omega = omega.clamp_length_max(params.max_speed / RADIUS_KM);
            part
        })
        .collect()
}

/// Probability that a plate rifts in a step: `λ e^(−λ)` with `λ = λ₀ f(x) A/A₀`, at most 1 (section 4.4).
pub fn probability(continental: f64, area_km2: f64, mean_area_km2: f64, params: &GlobeParams) -> f64 {
    let lambda = params.rifts * continental.max(params.least_rift_share) * area_km2 / mean_area_km2;
    let lambda = lambda.clamp(0.0, 1.0);
    lambda * (-lambda).exp()
}
