//! Planets to begin with.

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng as _;
use rayon::prelude::*;

use super::crust::Crust;
use super::distance::Nearest;
use super::noise::Noise;
use super::params::{GlobeParams, gdh1_km};
use super::plate::Plate;
use super::random::{direction, unit, word};
use crate::sphere::{Lattice, RADIUS_KM};

/// Most plates of a planet.
pub const MAX_PLATES: usize = 512;
/// How far the borders of the first plates wind, km.
const WINDING_KM: f64 = 700.0;
/// Oldest sea floor in the beginning, My, and the speed at which it spread, mm/yr to either side.
const OLDEST_MY: f64 = 160.0;
const HALF_SPREADING: f64 = 28.0;
/// Speeds in the beginning, mm/yr.
const SPEEDS: (f64, f64) = (15.0, 60.0);

/// What a planet begins as.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// Plates around random places, and continents between their borders.
    Random {
        /// Number of plates, 1 to [`MAX_PLATES`].
        plates: u32,
        /// Share of the sphere that is continental crust, 0–1; some of it lies below the sea.
        continental: f64,
        /// Everything random follows from it.
        seed: u64,
    },
    /// Heights and plates of each sample.
    Maps {
        /// Height, metres. What is above −2,000 m is continental.
        elevation_m: Vec<f32>,
        /// Number of the plate, 0 to [`MAX_PLATES`] − 1, without holes.
        plate: Vec<u16>,
        /// For motions.
        seed: u64,
    },
}

/// Why there is no planet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StartError {
    /// Number of plates.
    #[error("plates: expected 1 to {MAX_PLATES}, found {0}")]
    Plates(u32),
    /// Share of continents.
    #[error("continental: expected 0 to 1, found {0}")]
    Continental(f64),
    /// A map of another size than the lattice.
    #[error("{what}: expected {samples} samples, found {found}")]
    Size {
        /// Which map.
        what: &'static str,
        /// Samples of the lattice.
        samples: usize,
        /// Samples of the map.
        found: usize,
    },
    /// A number that is none, or out of range.
    #[error("elevation: expected −12,000 to 12,000 m, found {found} at sample {sample}")]
    Elevation {
        /// Where.
        sample: usize,
        /// What is there.
        found: f32,
    },
    /// A plate without samples.
    #[error("plate {0} has no samples")]
    Empty(u16),
}

/// Height that is the edge of continents in maps, metres: the shelf's foot.
const CONTINENT_ABOVE_M: f32 = -2_000.0;

impl Start {
    /// Seed of everything random.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Random { seed, .. } | Self::Maps { seed, .. } => *seed,
        }
    }

    /// The first plates.
    pub(super) fn plates(&self, lattice: &Lattice, params: &GlobeParams) -> Result<Vec<Plate>, StartError> {
        let mut rng = Pcg64Mcg::seed_from_u64(self.seed());
        let (labels, count, crust) = match self {
            Self::Random {
                plates, continental, ..
            } => {
                if *plates == 0 || *plates as usize > MAX_PLATES || *plates as usize * 20 > lattice.len() {
                    return Err(StartError::Plates(*plates));
                }
                if !(0.0..=1.0).contains(continental) {
                    return Err(StartError::Continental(*continental));
                }
                let labels = voronoi(*plates, lattice, &mut rng);
                let crust = random_crust(&labels, *continental, lattice, &mut rng);
                (labels, *plates as usize, crust)
            }
            Self::Maps {
                elevation_m, plate, ..
            } => {
                for (what, found) in [("elevation", elevation_m.len()), ("plates", plate.len())] {
                    if found != lattice.len() {
                        let samples = lattice.len();
                        return Err(StartError::Size { what, samples, found });
                    }
                }
                if let Some(sample) = elevation_m.iter().position(|z| z.is_nan() || z.abs() > 12_000.0) {
                    let found = elevation_m[sample];
                    return Err(StartError::Elevation { sample, found });
                }
                let count = plate.iter().max().map_or(0, |&most| most as usize + 1);
                if count > MAX_PLATES {
                    return Err(StartError::Plates(count as u32));
                }
                (plate.clone(), count, mapped_crust(elevation_m))
            }
        };
        let mut members = vec![Vec::new(); count];
        for (i, &label) in labels.iter().enumerate() {
            members[label as usize].push(i as u32);
        }
        if let Some(empty) = members.iter().position(Vec::is_empty) {
            return Err(StartError::Empty(empty as u16));
        }
        let plates = members.into_iter().enumerate().map(|(id, members)| {
            let crust = members.iter().map(|&i| crust[i as usize]).collect();
            let mut plate = Plate::new(id as u32, DQuat::IDENTITY, members, crust, lattice);
            let speed = SPEEDS.0 + (SPEEDS.1 - SPEEDS.0) * unit(&mut rng);
            plate.omega = direction(&mut rng) * (speed.min(params.max_speed) / RADIUS_KM);
            plate
        });
        Ok(plates.collect())
    }
}

/// Cells around random places, with winding borders.
fn voronoi(plates: u32, lattice: &Lattice, rng: &mut Pcg64Mcg) -> Vec<u16> {
    let centres: Vec<DVec3> = (0..plates).map(|_| direction(rng)).collect();
    let noise = Noise::new(word(rng), 2_400.0, 4);
    let mut labels: Vec<u16> = lattice
        .points()
        .par_iter()
        .with_min_len(512)
        .map(|&p| {
            let p = noise.warped(p, WINDING_KM);
            let mut best = 0;
            for k in 1..centres.len() {
                if centres[k].dot(p) > centres[best].dot(p) {
                    best = k;
                }
            }
            best as u16
        })
        .collect();
    // A centre that winding has swallowed keeps its own place.
    for (k, &centre) in centres.iter().enumerate() {
        if !labels.contains(&(k as u16)) {
            let i = lattice.nearest(centre);
            labels[i as usize] = k as u16;
            for &n in lattice.neighbours(i) {
                labels[n as usize] = k as u16;
            }
        }
    }
    labels
}

/// Continents where noise is high, away from the borders of plates, and sea floor that is younger near ridges.
fn random_crust(labels: &[u16], continental: f64, lattice: &Lattice, rng: &mut Pcg64Mcg) -> Vec<Crust> {
    let shape = Noise::new(word(rng), 3_800.0, 5);
    let relief = Noise::new(word(rng), 900.0, 4);
    let at_border = |i: u32| {
        lattice
            .neighbours(i)
            .iter()
            .any(|&n| labels[n as usize] != labels[i as usize])
    };
    let borders: Vec<(u32, DVec3)> = (0..lattice.len() as u32)
        .filter(|&i| at_border(i))
        .map(|i| (i, lattice.point(i)))
        .collect();
    let nearest = Nearest::new(lattice, &borders, std::f64::consts::PI, |_, _| true);
    let border_km: Vec<f64> = (0..lattice.len() as u32)
        .map(|i| {
            nearest
                .of(i, lattice.point(i), &borders)
                .map_or(20_000.0, |(_, arc)| arc * RADIUS_KM)
        })
        .collect();
    let score: Vec<f64> = lattice
        .points()
        .par_iter()
        .zip(&border_km)
        .with_min_len(512)
        .map(|(&p, &km)| shape.at(p) - 0.6 * (-km / 450.0).exp())
        .collect();
    let mut sorted = score.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let sea = ((1.0 - continental) * (sorted.len() - 1) as f64) as usize;
    let level = if continental <= 0.0 {
        f64::INFINITY
    } else {
        sorted[sea]
    };
    // A tenth of the crust is shelf.
    let shelf = sorted[(sea + (sorted.len() - sea) / 10).min(sorted.len() - 1)];
    (0..lattice.len())
        .map(|i| {
            let uneven = relief.at(lattice.points()[i]);
            if score[i] < level {
                let age = (border_km[i] / HALF_SPREADING).min(OLDEST_MY);
                return Crust::oceanic((0.12 * uneven - gdh1_km(age)) as f32, age as f32);
            }
            let inland = ((score[i] - level) / (shelf - level).max(1e-6)).min(4.0);
            let z = if inland < 1.0 {
                -0.25 + 0.3 * inland
            } else {
                0.05 + 0.15 * (inland - 1.0) + 0.12 * (1.0 + uneven)
            };
            let mut crust = Crust::continental(z as f32);
            crust.orogeny_age = 1_000.0;
            crust
        })
        .collect()
}

fn mapped_crust(elevation_m: &[f32]) -> Vec<Crust> {
    elevation_m
        .iter()
        .map(|&metres| {
            let z = metres / 1000.0;
            if metres > CONTINENT_ABOVE_M {
                let mut crust = Crust::continental(z);
                crust.orogeny_age = 1_000.0;
                crust
            } else {
                Crust::oceanic(z, age_of_depth(-f64::from(z)) as f32)
            }
        })
        .collect()
}

/// Age at which sea floor lies at a depth, My: GDH1 turned around.
fn age_of_depth(depth_km: f64) -> f64 {
    if depth_km < gdh1_km(20.0) {
        ((depth_km - 2.6).max(0.0) / 0.365).powi(2)
    } else {
        let left = ((5.651 - depth_km) / 2.473).max(1e-3);
        (-left.ln() / 0.0278).min(OLDEST_MY)
    }
}
