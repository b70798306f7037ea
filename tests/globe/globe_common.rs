//! Planets for tests, and what is measured on them.
use std::sync::Arc;

use glam::DVec3;
use orogen::globe::{GlobeParams, Planet, Start};
use orogen::sphere::{Lattice, RADIUS_KM};
use orogen::surface::planet as shown;

/// Area of the planet, km².
pub(crate) const SPHERE_KM2: f64 = 4.0 * std::f64::consts::PI * RADIUS_KM * RADIUS_KM;

pub(crate) fn lattice(samples: usize) -> Arc<Lattice> {
    Arc::new(Lattice::new(samples).expect("a size within range"))
}

/// Angular speed of a speed at the equator of the motion, mm/yr, in rad/My.
pub(crate) fn rad_per_my(mm_per_yr: f64) -> f64 {
    mm_per_yr / RADIUS_KM
}

/// The planet's constants, without anything that happens by chance or drives plates.
pub(crate) fn calm() -> GlobeParams {
    GlobeParams {
        rifts: 0.0,
        hot_spots: 0,
        slab_pull_deg: 0.0,
        speed_relaxation_my: f64::INFINITY,
        ..GlobeParams::planet()
    }
}

/// A planet painted by a function: height in metres and plate. Nobody moves.
pub(crate) fn painted(
    lattice: &Arc<Lattice>,
    params: &GlobeParams,
    paint: impl Fn(DVec3) -> (f32, u16),
) -> Planet {
    let (elevation_m, plate) = lattice.points().iter().map(|&p| paint(p)).unzip();
    let start = Start::Maps {
        elevation_m,
        plate,
        seed: 1,
    };
    let mut planet = Planet::new(Arc::clone(lattice), &start, *params).expect("a whole start");
    let ids: Vec<u32> = planet.plate_ids().collect();
    for id in ids {
        planet.lead(id, DVec3::ZERO);
    }
    planet
}

/// Two hemispheres that turn against each other about the north pole, `mm_per_yr` each at the equator: they part at 90° east
/// and close at 90° west.
pub(crate) fn two_halves(
    lattice: &Arc<Lattice>,
    params: &GlobeParams,
    mm_per_yr: f64,
    height_m: impl Fn(DVec3) -> f32,
) -> Planet {
    let mut planet = painted(lattice, params, |p| (height_m(p), u16::from(p.x < 0.0)));
    planet.lead(0, -DVec3::Z * rad_per_my(mm_per_yr));
    planet.lead(1, DVec3::Z * rad_per_my(mm_per_yr));
    planet
}

pub(crate) fn run(planet: &mut Planet, steps: usize) {
    for _ in 0..steps {
        planet.step();
    }
}

/// Area of the samples that are meant, steradians.
pub(crate) fn area(shown: &shown::Planet, is_meant: impl Fn(usize) -> bool) -> f64 {
    let areas = shown.lattice.areas().iter().enumerate();
    areas.filter(|(i, _)| is_meant(*i)).map(|(_, area)| area).sum()
}

/// Mean over the samples that are meant, by area.
pub(crate) fn mean(shown: &shown::Planet, values: &[f32], is_meant: impl Fn(usize) -> bool) -> f64 {
    let areas = shown.lattice.areas();
    let sum: f64 = (0..values.len())
        .filter(|&i| is_meant(i))
        .map(|i| areas[i] * f64::from(values[i]))
        .sum();
    sum / area(shown, is_meant)
}

/// Nothing that is no number, nothing beyond the planet.
pub(crate) fn check_whole(planet: &Planet) {
    let shown = planet.surface(0.0);
    assert!(shown.elevation_m.iter().all(|z| z.abs() <= 15_000.0), "heights");
    assert!(
        shown.thickness_km.iter().all(|e| (0.0..200.0).contains(e)),
        "thickness"
    );
    assert!(
        shown.age_my.iter().all(|age| (0.0..10_000.0).contains(age)),
        "ages"
    );
    assert!(
        shown.fold.iter().chain(&shown.ridge).all(|v| v.is_finite()),
        "directions"
    );
    assert!(
        shown.plate.iter().all(|&k| usize::from(k) < shown.plates.len()),
        "plates"
    );
    for plate in &shown.plates {
        assert!(
            plate.rotation.is_normalized() && plate.omega.is_finite(),
            "motions"
        );
    }
}
