//! What rigid plates on a sphere must do, whatever the crust is made of.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::globe_common::{
    SPHERE_KM2, area, calm, check_whole, lattice, mean, painted, rad_per_my, run, two_halves,
};
use glam::{DQuat, DVec3};
use orogen::globe::{GlobeParams, Planet, Start};
use orogen::sphere::RADIUS_KM;
use orogen::surface::planet as shown;

fn random(samples: usize, plates: u32, continental: f64, seed: u64) -> Planet {
    let start = Start::Random {
        plates,
        continental,
        seed,
    };
    Planet::new(lattice(samples), &start, GlobeParams::planet()).expect("a whole start")
}

/// Hills on land and a sloping floor.
fn relief(p: DVec3) -> f32 {
    let high = p.dot(DVec3::new(0.6, 0.64, 0.48));
    if high > 0.8 {
        (300.0 + 1_500.0 * (high - 0.8) * (6.0 * p.z).sin()) as f32
    } else {
        (-4_500.0 + 800.0 * p.x) as f32
    }
}

#[test]
fn ten_thousand_steps_leave_a_plate_rigid() {
    let lattice = lattice(1_000);
    let mut planet = painted(&lattice, &calm(), |p| (relief(p), 0));
    let omega = DVec3::new(0.36, 0.48, 0.8) * rad_per_my(100.0);
    planet.lead(0, omega);
    run(&mut planet, 10_000);
    let (rotation, _, _) = planet.plate_state(0).unwrap();
    let expected =
        DQuat::from_scaled_axis((omega * 20_000.0).normalize() * (omega.length() * 20_000.0 % TAU));
    let mut moved = 0.0_f64;
    let mut off = 0.0_f64;
    let points = lattice.points();
    for (a, b) in points.iter().zip(points.iter().skip(317)) {
        moved = moved.max(((rotation * *a).distance(rotation * *b) - a.distance(*b)).abs());
        off = off.max((rotation * *a).distance(expected * *a));
    }
    assert!(moved < 1e-12, "pair distances change by {moved:e}");
    assert!(off < 1e-9, "the way after 20,000 My is off by {off:e}");
}

#[test]
fn a_plate_alone_only_turns() {
    let lattice = lattice(8_000);
    let mut still = painted(&lattice, &calm(), |p| (relief(p), 0));
    let mut turning = still.clone();
    // Once around in 250 steps, at 80 mm/yr.
    turning.lead(0, DVec3::new(0.0, 0.6, 0.8) * (TAU / 500.0));
    run(&mut still, 250);
    run(&mut turning, 250);
    let (rotation, _, _) = turning.plate_state(0).unwrap();
    assert!(rotation.to_scaled_axis().length() % TAU < 1e-9 || rotation.w.abs() > 1.0 - 1e-12);
    let (still, turning) = (still.surface(0.0), turning.surface(0.0));
    assert_eq!(still.continental, turning.continental);
    let pairs = still.elevation_m.iter().zip(&turning.elevation_m);
    let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(most < 0.01, "heights differ by {most} m");
}

#[test]
fn a_continent_at_rest_on_its_plate_does_not_rot() {
    let lattice = lattice(20_000);
    let params = GlobeParams {
        erosion: 0.0,
        erosion_5km: 0.0,
        margin_my: f64::INFINITY,
        ..calm()
    };
    // A continent far from the borders of a plate that rifts from one side of its neighbour to the other.
    let mut planet = two_halves(
        &lattice,
        &params,
        20.0,
        |p| if p.x > 0.9 { 840.0 } else { -5_000.0 },
    );
    let before = planet.surface(0.0);
    run(&mut planet, 50);
    assert_eq!(planet.time_my(), 100.0);
    assert!(
        planet.totals().created_km2 > 1e6,
        "fifty times something was made elsewhere"
    );
    let after = planet.surface(0.0);
    let land = |shown: &shown::Planet| {
        let share = area(shown, |i| shown.continental[i]);
        (share, mean(shown, &shown.elevation_m, |i| shown.continental[i]))
    };
    let ((area_before, height_before), (area_after, height_after)) = (land(&before), land(&after));
    assert!(
        (area_after / area_before - 1.0).abs() < 0.01,
        "area {area_before} {area_after}"
    );
    assert!(
        (height_after / height_before - 1.0).abs() < 0.01,
        "height {height_before} {height_after}"
    );
}

#[test]
fn plates_tile_the_sphere_at_any_moment() {
    let mut planet = random(6_000, 14, 0.3, 5);
    for _ in 0..8 {
        run(&mut planet, 6);
        for ahead in [0.0, 1.3] {
            let shown = planet.surface(ahead);
            let sum: f64 = shown.plates.iter().map(|plate| plate.area_sr).sum();
            assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-12, "{sum}");
            for (k, plate) in shown.plates.iter().enumerate() {
                let own = area(&shown, |i| usize::from(shown.plate[i]) == k);
                assert!((plate.area_sr - own).abs() < 1e-12);
            }
        }
        // In their own frames, plates lie over each other only where one is about to go down.
        let ids: Vec<u32> = planet.plate_ids().collect();
        let sum: f64 = ids.iter().map(|&id| planet.plate_state(id).unwrap().2).sum();
        assert!((sum / SPHERE_KM2 - 1.0).abs() < 0.05, "{}", sum / SPHERE_KM2);
    }
    check_whole(&planet);
}

#[test]
fn what_opens_is_made_and_what_closes_goes_down() {
    let lattice = lattice(20_000);
    let mut planet = two_halves(&lattice, &calm(), 25.0, |_| -5_500.0);
    run(&mut planet, 10);
    let before = planet.totals();
    run(&mut planet, 40);
    let totals = planet.totals();
    // ∫ |ω × p · n| dl over half a great circle is 2 ω; both move, for 80 My.
    let closed = 2.0 * 2.0 * rad_per_my(25.0) * 80.0 * RADIUS_KM * RADIUS_KM;
    let created = totals.created_km2 + totals.drawn_out_km2 - before.created_km2 - before.drawn_out_km2;
    let consumed = totals.consumed_km2 - before.consumed_km2;
    assert!(
        (created / closed - 1.0).abs() < 0.04,
        "made {created:e} for {closed:e}"
    );
    assert!(
        (consumed / closed - 1.0).abs() < 0.06,
        "gone {consumed:e} for {closed:e}"
    );
    assert_eq!((totals.collisions, totals.rifts), (0, 0));
}

#[test]
fn the_ridge_is_a_mirror_and_its_floor_as_old_as_its_distance() {
    let lattice = lattice(60_000);
    let mut planet = two_halves(&lattice, &calm(), 30.0, |_| -5_500.0);
    run(&mut planet, 50);
    let shown = planet.surface(0.0);
    let speed = rad_per_my(30.0);
    let mut checked = 0;
    let (mut age_off, mut mirror_off, mut height_off) = (0.0, 0.0, 0.0);
    for (i, &p) in lattice.points().iter().enumerate() {
        // East of the ridge longitude counts as age; near the poles little opens.
        let angle = (p.y.atan2(p.x) - FRAC_PI_2).abs();
        if p.z.abs() > 0.7 || angle > 0.9 * speed * 100.0 {
            continue;
        }
        let twin = lattice.nearest(DVec3::new(-p.x, p.y, p.z)) as usize;
        let age = f64::from(shown.age_my[i]);
        age_off += (age - angle / speed).abs();
        mirror_off += (age - f64::from(shown.age_my[twin])).abs();
        height_off += (f64::from(shown.elevation_m[i]) + 1000.0 * orogen::globe::gdh1_km(age)).abs();
        assert!(!shown.continental[i]);
        assert!(
            angle < 1.5 * lattice.spacing() || shown.plate[i] != shown.plate[twin],
            "{p}"
        );
        checked += 1;
    }
    assert!(checked > 300, "{checked}");
    let n = f64::from(checked);
    // A cell is 3 My wide at this speed.
    assert!(
        age_off / n < 1.5 && mirror_off / n < 2.5,
        "{} {}",
        age_off / n,
        mirror_off / n
    );
    assert!(height_off / n < 150.0, "{}", height_off / n);
}

#[test]
fn an_ocean_world_neither_grows_nor_shrinks() {
    let mut planet = random(8_000, 12, 0.0, 3);
    run(&mut planet, 100);
    let totals = planet.totals();
    assert!(totals.created_km2 > 0.2 * SPHERE_KM2, "{totals:?}");
    let came = totals.created_km2 + totals.drawn_out_km2;
    assert!((totals.consumed_km2 / came - 1.0).abs() < 0.05, "{totals:?}");
}

/// Facts that do not know where north is.
#[derive(Debug)]
struct Facts {
    areas: Vec<f64>,
    land: f64,
    mean_m: f64,
    land_m: f64,
    border: f64,
    made: f64,
}

fn facts(planet: &Planet) -> Facts {
    let shown = planet.surface(0.0);
    let mut areas: Vec<(u32, f64)> = shown
        .plates
        .iter()
        .map(|plate| (plate.id, plate.area_sr))
        .collect();
    areas.sort_by_key(|(id, _)| *id);
    Facts {
        areas: areas.into_iter().map(|(_, area)| area).collect(),
        land: area(&shown, |i| shown.continental[i]),
        mean_m: mean(&shown, &shown.elevation_m, |_| true),
        land_m: mean(&shown, &shown.elevation_m, |i| shown.continental[i]),
        border: shown
            .borders
            .iter()
            .map(|b| f64::from(b.ends[0].distance(b.ends[1])))
            .sum(),
        made: planet.totals().created_km2 + planet.totals().drawn_out_km2,
    }
}

#[test]
fn a_turned_planet_does_the_same_elsewhere() {
    let lattice = lattice(20_000);
    let params = GlobeParams {
        uplift_noise: 0.0,
        ..calm()
    };
    let axes = [
        DVec3::Z,
        DVec3::X,
        DVec3::new(-0.6, 0.0, 0.8),
        DVec3::new(0.0, -0.8, -0.6),
    ];
    let centres = [DVec3::X, DVec3::Y, -DVec3::X, DVec3::new(0.0, -0.6, -0.8)];
    let make = |turn: DQuat| {
        let back = turn.inverse();
        let mut planet = painted(&lattice, &params, |p| {
            let p = back * p;
            let mut nearest = 0;
            for k in 1..centres.len() {
                if centres[k].dot(p) > centres[nearest].dot(p) {
                    nearest = k;
                }
            }
            // Land on the first plate only, so that polarity is plain; its floor is younger.
            let height = if nearest == 0 && p.dot(centres[0]) > 0.75 {
                600.0
            } else {
                [-3_800.0, -4_600.0, -5_200.0, -5_600.0][nearest]
            };
            (height, nearest as u16)
        });
        for (k, axis) in axes.iter().enumerate() {
            planet.lead(k as u32, turn * *axis * rad_per_my(30.0));
        }
        run(&mut planet, 25);
        facts(&planet)
    };
    let plain = make(DQuat::IDENTITY);
    for turn in [
        DQuat::from_rotation_x(1.1),
        DQuat::from_axis_angle(DVec3::new(0.48, -0.6, 0.64), 2.5),
    ] {
        let turned = make(turn);
        assert_eq!(plain.areas.len(), turned.areas.len());
        for (a, b) in plain.areas.iter().zip(&turned.areas) {
            assert!((a - b).abs() < 0.02 * 4.0 * PI, "{plain:?} {turned:?}");
        }
        assert!(
            (plain.land / turned.land - 1.0).abs() < 0.04,
            "{plain:?} {turned:?}"
        );
        assert!(
            (plain.mean_m - turned.mean_m).abs() < 60.0,
            "{plain:?} {turned:?}"
        );
        assert!(
            (plain.land_m / turned.land_m - 1.0).abs() < 0.1,
            "{plain:?} {turned:?}"
        );
        assert!(
            (plain.border / turned.border - 1.0).abs() < 0.06,
            "{plain:?} {turned:?}"
        );
        assert!(
            (plain.made / turned.made - 1.0).abs() < 0.06,
            "{plain:?} {turned:?}"
        );
    }
}

#[test]
fn any_number_of_threads_makes_the_same_planet() {
    let make = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut planet = random(8_000, 16, 0.3, 11);
            run(&mut planet, 40);
            (planet.totals(), planet.surface(0.7))
        })
    };
    let (totals, one) = make(1);
    assert!(
        totals.collisions > 0 || totals.rifts > 0,
        "something happens: {totals:?}"
    );
    for threads in [2, 7] {
        let (other_totals, other) = make(threads);
        assert_eq!(totals, other_totals);
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<u32>>();
        assert_eq!(bits(&one.elevation_m), bits(&other.elevation_m));
        assert_eq!(bits(&one.age_my), bits(&other.age_my));
        assert_eq!(bits(&one.thickness_km), bits(&other.thickness_km));
        assert_eq!(one.plate, other.plate);
        assert_eq!(one.plates, other.plates);
        assert_eq!(one.borders, other.borders);
        assert_eq!((&one.fold, &one.ridge), (&other.fold, &other.ridge));
    }
}

#[test]
fn plates_are_carried_on_between_steps() {
    let planet = two_halves(&lattice(2_000), &calm(), 50.0, |_| -5_000.0);
    let now = planet.surface(0.0);
    for (ahead, expected) in [(0.5, 0.5), (2.0, 2.0), (99.0, 2.0), (-1.0, 0.0)] {
        let then = planet.surface(ahead);
        assert_eq!(then.time_my, now.time_my + expected);
        for (a, b) in now.plates.iter().zip(&then.plates) {
            let moved = DQuat::from_scaled_axis(a.omega * expected) * a.rotation;
            assert!(moved.angle_between(b.rotation) < 1e-9);
        }
    }
}
