//! A planet that nobody computed: a few plates, continents by noise, sea floor that sinks with age, ranges along some
//! borders.

use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};
use orogen::sphere::{Lattice, arc, direction};
use orogen::surface::planet::{Grip, Orogeny, Planet, PlateFacts};

/// Middles of the plates, degrees north and east.
const SEEDS: [(f64, f64); 12] = [
    (72.0, 10.0),
    (38.0, -95.0),
    (45.0, 60.0),
    (8.0, 20.0),
    (-18.0, -58.0),
    (5.0, -150.0),
    (-25.0, 135.0),
    (-75.0, 80.0),
    (25.0, 150.0),
    (-35.0, -110.0),
    (-20.0, 70.0),
    (20.0, -30.0),
];

/// Smooth in about −1 to 1, features of about `1 / f` radians.
fn waves(p: DVec3, f: f64, seed: f64) -> f64 {
    let axes = [
        DVec3::new(0.8, 0.55, -0.25),
        DVec3::new(-0.35, 0.75, 0.56),
        DVec3::new(0.5, -0.3, 0.81),
        DVec3::new(-0.62, -0.61, 0.49),
        DVec3::new(0.1, 0.95, -0.3),
    ];
    let terms = axes
        .iter()
        .enumerate()
        .map(|(i, axis)| (f * (1.0 + 0.23 * i as f64) * axis.dot(p) + seed * (1.7 + i as f64)).sin());
    terms.sum::<f64>() / 2.5
}

/// The planet on a lattice of `samples`.
pub(crate) fn planet(samples: usize) -> Planet {
    let lattice = Arc::new(Lattice::new(samples).expect("lattice"));
    let seeds = SEEDS.map(|(north, east)| direction(north, east));
    let n = lattice.len();
    let mut planet = Planet {
        time_my: 120.0,
        elevation_m: vec![0.0; n],
        plate: vec![0; n],
        continental: vec![false; n],
        thickness_km: vec![7.0; n],
        age_my: vec![0.0; n],
        orogeny: vec![Orogeny::None; n],
        orogeny_age_my: vec![0.0; n],
        fold: vec![Vec3::ZERO; n],
        ridge: vec![Vec3::ZERO; n],
        plates: (0..seeds.len())
            .map(|i| PlateFacts {
                id: i as u32,
                rotation: DQuat::from_axis_angle(seeds[(i + 3) % seeds.len()], 0.4),
                omega: seeds[(i + 5) % seeds.len()] * 0.006,
                area_sr: 1.0,
                continental: 0.4,
                grip: Grip::Free,
            })
            .collect(),
        borders: Vec::new(),
        hot_spots: Vec::new(),
        lattice: Arc::clone(&lattice),
    };
    for (i, &p) in lattice.points().iter().enumerate() {
        let bent =
            (p + 0.09 * DVec3::new(waves(p, 9.0, 1.0), waves(p, 9.0, 2.0), waves(p, 9.0, 3.0))).normalize();
        let mut near: Vec<(f64, usize)> = seeds
            .iter()
            .enumerate()
            .map(|(k, &s)| (arc(bent, s), k))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (plate, other) = (near[0].1, near[1].1);
        let border = (near[1].0 - near[0].0) / 2.0;
        let closes = (plate + 2 * other + other * plate) % 5 < 2;
        planet.plate[i] = plate as u16;
        let land = waves(p, 2.6, 5.0) + 0.55 * waves(p, 6.0, 7.0) + 0.3 * waves(p, 13.0, 8.0) - 0.25;
        let continental = land > 0.0;
        planet.continental[i] = continental;
        planet.elevation_m[i] = if continental {
            let range = if closes {
                (-(border / 0.06).powi(2)).exp()
            } else {
                0.0
            };
            if range > 0.1 {
                planet.orogeny[i] = Orogeny::Andean;
                planet.orogeny_age_my[i] = 20.0;
            }
            (120.0 + 550.0 * land.min(1.0) + 3900.0 * range * (0.8 + 0.35 * waves(p, 30.0, 9.0))) as f32
        } else {
            let age = if closes { 90.0 } else { border / 0.012 };
            planet.age_my[i] = age as f32;
            let trench = if closes {
                (-(border / 0.02).powi(2)).exp()
            } else {
                0.0
            };
            let shelf = (-(land / 0.05).powi(2)).exp();
            let floor = -2600.0 - 350.0 * age.min(80.0).sqrt();
            (floor + (-150.0 - floor) * 0.8 * shelf - 3500.0 * trench) as f32
        };
    }
    planet
}
