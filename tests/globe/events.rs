//! Fronts, collisions, rifts, and input that must not break a planet.

use std::sync::Arc;

use crate::globe_common::{area, calm, check_whole, lattice, painted, rad_per_my, run, two_halves};
use glam::DVec3;
use orogen::globe::{Crust, Cut, GlobeParams, MAX_PLATES, Planet, RiftError, Start, StartError};
use orogen::surface::planet::{BorderKind, Grip};

#[test]
fn a_steady_front_keeps_its_polarity() {
    let lattice = lattice(20_000);
    // Land on one side of the closing border, old floor on the other.
    let mut planet = two_halves(&lattice, &calm(), 20.0, |p| {
        if p.x > 0.0 && p.x < 0.7 && p.y < 0.0 {
            400.0
        } else {
            -5_500.0
        }
    });
    run(&mut planet, 3);
    let settled = planet.totals().polarity_flips;
    run(&mut planet, 50);
    assert_eq!(planet.totals().polarity_flips, settled);
    let shown = planet.surface(0.0);
    let land = shown.plates.iter().position(|plate| plate.id == 0).unwrap();
    let fronts = shown.borders.iter().filter(|b| b.kind == BorderKind::Subduction);
    let (mut above, mut all) = (0, 0);
    for front in fronts {
        let middle = (front.ends[0] + front.ends[1]).as_dvec3().normalize();
        if middle.y < -0.5 && middle.z.abs() < 0.5 {
            all += 1;
            above += usize::from(usize::from(shown.plate[front.samples[0] as usize]) == land);
        }
    }
    assert!(all > 20, "a front of {all} pieces");
    assert!(above * 50 >= all * 49, "land is on top in {above} of {all}");
}

/// Two continents of different size on two halves that close on each other.
fn before_collision() -> Planet {
    let centres = [DVec3::new(0.5, -0.866, 0.0), DVec3::new(-0.5, -0.866, 0.0)];
    let lattice = lattice(20_000);
    let params = GlobeParams {
        margin_my: f64::INFINITY,
        basin_mkm2: 0.0,
        ..calm()
    };
    two_halves(&lattice, &params, 40.0, move |p| {
        if p.dot(centres[0]) > 0.93 || p.dot(centres[1]) > 0.965 {
            500.0
        } else {
            -5_200.0
        }
    })
}

#[test]
fn colliding_continents_keep_their_crust() {
    let mut planet = before_collision();
    let land = |planet: &Planet| {
        let shown = planet.surface(0.0);
        area(&shown, |i| shown.continental[i])
    };
    let before = land(&planet);
    let mut steps = 0;
    while planet.totals().collisions == 0 && steps < 120 {
        planet.step();
        steps += 1;
    }
    let totals = planet.totals();
    assert!(totals.collisions >= 1, "{totals:?} after {steps} steps");
    let given = totals.terranes_given_km2;
    assert!(given > 1e6, "{totals:?}");
    let kept = totals.terranes_added_km2 + totals.terranes_stacked_km2;
    assert!(
        (kept / given - 1.0).abs() < 0.02,
        "given {given:e}, kept {kept:e}"
    );
    // What is seen: nothing is lost but what lies doubled, and what rose from the sea.
    let radius2 = orogen::sphere::RADIUS_KM.powi(2);
    let expected = before + (totals.emerged_km2 - totals.terranes_stacked_km2) / radius2;
    let after = land(&planet);
    assert!(
        (after / expected - 1.0).abs() < 0.03,
        "{before} {after} for {expected}: {totals:?}"
    );
    let shown = planet.surface(0.0);
    let raised = area(&shown, |i| shown.elevation_m[i] > 1_500.0);
    assert!(raised > 0.0, "the suture is raised");
    check_whole(&planet);
}

#[test]
fn starts_that_name_what_is_not_there_are_refused() {
    let lattice = lattice(2_000);
    let refused = |start: Start| {
        let error = Planet::new(Arc::clone(&lattice), &start, GlobeParams::planet()).unwrap_err();
        assert!(!error.to_string().contains('\n'));
        error
    };
    let random = |plates, continental| Start::Random {
        plates,
        continental,
        seed: 1,
    };
    for plates in [0, MAX_PLATES as u32 + 1, 101, u32::MAX] {
        assert_eq!(refused(random(plates, 0.3)), StartError::Plates(plates));
    }
    for share in [-0.1, 1.1, f64::INFINITY] {
        assert_eq!(refused(random(8, share)), StartError::Continental(share));
    }
    assert!(matches!(refused(random(8, f64::NAN)), StartError::Continental(share) if share.is_nan()));
    let maps = |elevation_m: Vec<f32>, plate: Vec<u16>| Start::Maps {
        elevation_m,
        plate,
        seed: 1,
    };
    let (flat, one) = (vec![0.0; 2_000], vec![0; 2_000]);
    assert!(matches!(
        refused(maps(flat[1..].to_vec(), one.clone())),
        StartError::Size {
            what: "elevation",
            samples: 2_000,
            found: 1_999
        }
    ));
    assert!(matches!(
        refused(maps(flat.clone(), vec![])),
        StartError::Size {
            what: "plates",
            found: 0,
            ..
        }
    ));
    for wrong in [f32::NAN, f32::INFINITY, -1e6] {
        let mut elevation = flat.clone();
        elevation[77] = wrong;
        assert!(matches!(
            refused(maps(elevation, one.clone())),
            StartError::Elevation { sample: 77, .. }
        ));
    }
    let mut hole = one.clone();
    hole[5] = 2;
    assert_eq!(refused(maps(flat.clone(), hole.clone())), StartError::Empty(1));
    hole[5] = u16::MAX;
    assert!(matches!(refused(maps(flat, hole)), StartError::Plates(_)));
}

#[test]
fn plates_are_led_at_their_speed_and_no_faster() {
    let mut planet = two_halves(&lattice(2_000), &calm(), 10.0, |_| -4_000.0);
    let most = rad_per_my(planet.params().max_speed);
    assert!(!planet.lead(0, DVec3::Y * most));
    assert_eq!(planet.totals().clamped, 0);
    assert!(planet.lead(0, DVec3::Y * (3.0 * most)));
    assert_eq!(planet.totals().clamped, 1);
    let omega = |planet: &Planet| planet.plate_state(0).unwrap().1;
    assert!((omega(&planet) - DVec3::Y * most).length() < 1e-12);
    for wrong in [
        DVec3::NAN,
        DVec3::new(f64::INFINITY, 0.0, 0.0),
        DVec3::splat(1e200),
    ] {
        planet.lead(0, wrong);
        assert!(
            omega(&planet).is_finite() && omega(&planet).length() <= most * (1.0 + 1e-9),
            "{wrong}"
        );
    }
    assert!(!planet.lead(99, DVec3::X), "nobody there");
    planet.anchor(0);
    let (before, _, _) = planet.plate_state(0).unwrap();
    run(&mut planet, 5);
    assert_eq!(planet.plate_state(0).unwrap().0, before);
    assert_eq!(
        planet
            .surface(0.0)
            .plates
            .iter()
            .find(|p| p.id == 0)
            .unwrap()
            .grip,
        Grip::Anchored
    );
    planet.release(0);
    assert_eq!(
        planet
            .surface(0.0)
            .plates
            .iter()
            .find(|p| p.id == 0)
            .unwrap()
            .grip,
        Grip::Free
    );
    check_whole(&planet);
}

#[test]
fn plates_are_torn_where_there_is_room() {
    let lattice = lattice(6_000);
    let speck = |p: DVec3| u16::from(p.z > 0.996);
    let mut planet = painted(&lattice, &calm(), |p| (-4_000.0, speck(p)));
    let same = planet.clone();
    assert_eq!(planet.rift(7, &Cut::Parts(2)), Err(RiftError::NoPlate(7)));
    assert_eq!(planet.rift(1, &Cut::Parts(2)), Err(RiftError::TooSmall(1)));
    for parts in [0, 1, 5, 255] {
        assert_eq!(planet.rift(0, &Cut::Parts(parts)), Err(RiftError::Parts(parts)));
    }
    let equator = [DVec3::X, DVec3::Y, -DVec3::X];
    for line in [
        vec![],
        vec![DVec3::X],
        vec![DVec3::X, DVec3::X],
        vec![DVec3::X, DVec3::NAN],
    ] {
        assert_eq!(planet.rift(0, &Cut::Line(line)), Err(RiftError::NoLine));
    }
    assert_eq!(planet.totals().rifts, 0);
    assert_eq!(
        planet.surface(0.0).plate,
        same.surface(0.0).plate,
        "what is refused changes nothing"
    );
    let ids = planet.rift(0, &Cut::Line(equator.to_vec())).unwrap();
    assert_eq!((ids.len(), ids[0]), (2, 0));
    assert!(!ids.contains(&1));
    let shown = planet.surface(0.0);
    for id in ids {
        let share =
            shown.plates.iter().find(|plate| plate.id == id).unwrap().area_sr / (4.0 * std::f64::consts::PI);
        assert!((share - 0.5).abs() < 0.06, "{share}");
    }
    let four = planet.clone().rift(0, &Cut::Parts(4)).unwrap();
    assert_eq!(four.len(), 4);
    run(&mut planet, 10);
    assert!(planet.totals().created_km2 > 0.0, "the parts leave each other");
    check_whole(&planet);
}

#[test]
fn nothing_from_outside_makes_a_planet_ill() {
    let lattice = lattice(3_000);
    let mut planet = painted(&lattice, &GlobeParams::planet(), |p| {
        (if p.x > 0.5 { 200.0 } else { -5_000.0 }, u16::from(p.y > 0.0))
    });
    planet.paint(DVec3::Z, 0.4, true);
    let land = |planet: &Planet| {
        planet
            .surface(0.0)
            .continental
            .iter()
            .filter(|land| **land)
            .count()
    };
    let painted = land(&planet);
    assert!(painted > 3_000 / 4 && painted < 3_000 / 2, "{painted}");
    for (at, radius) in [
        (DVec3::NAN, 0.3),
        (DVec3::X, f64::NAN),
        (DVec3::X, -1.0),
        (DVec3::ZERO, 0.3),
        (DVec3::X, f64::NEG_INFINITY),
    ] {
        planet.paint(at, radius, true);
        check_whole(&planet);
    }
    run(&mut planet, 20);
    check_whole(&planet);
    // Everything land, and everything sea, at full speed.
    for continental in [true, false] {
        planet.paint(DVec3::Z, 4.0, continental);
        let ids: Vec<u32> = planet.plate_ids().collect();
        for (k, id) in ids.into_iter().enumerate() {
            planet.lead(id, if k % 2 == 0 { DVec3::Z } else { DVec3::X });
        }
        run(&mut planet, 20);
        check_whole(&planet);
    }
}

#[test]
fn any_time_ahead_shows_a_whole_planet() {
    let planet = two_halves(&lattice(2_000), &calm(), 50.0, |_| -5_000.0);
    for ahead in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let shown = planet.surface(ahead);
        assert!(shown.time_my.is_finite(), "{ahead}");
        assert!(shown.elevation_m.iter().all(|z| z.is_finite()), "{ahead}");
    }
}

#[test]
fn a_sample_of_crust_is_small() {
    // Half a million samples, and a second copy for those who look: 64 MiB.
    assert!(size_of::<Crust>() <= 64);
}
