//! The files of a planet, read back by other means.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::picture_common;
use std::f64::consts::PI;
use std::io::Cursor;
use std::sync::Arc;

use crate::picture_common::{read_exr, read_glb};
use glam::{DQuat, DVec3, Vec3};
use orogen::export::OutDir;
use orogen::export::planet::{
    self, AGE_OF_CONTINENTS, EXAGGERATION, Equirectangular, Rotation, Sidecar, write_globe, write_plates,
    write_rotations,
};
use orogen::globe::{GlobeParams, Planet, Start};
use orogen::sphere::{Lattice, RADIUS_KM, direction};
use orogen::surface::planet as shown;
use serde_json::Value;

type Place = [f64; 2];

/// A planet that has moved for 20 My.
fn planet() -> shown::Planet {
    let lattice = Arc::new(Lattice::new(4_000).unwrap());
    let start = Start::Random {
        plates: 9,
        continental: 0.35,
        seed: 5,
    };
    let mut planet = Planet::new(lattice, &start, GlobeParams::planet()).unwrap();
    for _ in 0..10 {
        planet.step();
    }
    planet.surface(0.0)
}

/// The same planet with plates by another rule.
fn with_plates(planet: &shown::Planet, plate: impl Fn(DVec3) -> u16) -> shown::Planet {
    let mut planet = planet.clone();
    planet.plate = planet.lattice.points().iter().map(|&p| plate(p)).collect();
    let count = planet.plate.iter().max().unwrap() + 1;
    planet.plates.truncate(usize::from(count));
    planet
}

fn plates(planet: &shown::Planet) -> Value {
    let mut bytes = Vec::new();
    write_plates(&mut bytes, planet).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

/// The polygons of a feature: rings of longitude and latitude.
fn polygons(feature: &Value) -> Vec<Vec<Vec<Place>>> {
    assert_eq!(feature["geometry"]["type"], "MultiPolygon");
    serde_json::from_value(feature["geometry"]["coordinates"].clone()).unwrap()
}

/// Solid angle to the left of a ring on the map: ∮ −sin φ dλ, exact along straight lines of the map.
fn steradians(ring: &[Place]) -> f64 {
    let edge = |a: Place, b: Place| {
        let (f0, f1) = (a[1].to_radians(), b[1].to_radians());
        let mean = if (f1 - f0).abs() < 1e-9 {
            f0.sin()
        } else {
            (f0.cos() - f1.cos()) / (f1 - f0)
        };
        -mean * (b[0] - a[0]).to_radians()
    };
    ring.windows(2).map(|ends| edge(ends[0], ends[1])).sum()
}

/// Checks the form of all rings, and that each feature's area is that of its samples.
fn check(planet: &shown::Planet) -> Vec<f64> {
    let collection = plates(planet);
    let features = collection["features"].as_array().unwrap();
    assert_eq!(features.len(), planet.plates.len());
    let areas: Vec<f64> = features
        .iter()
        .map(|feature| {
            let mut area = 0.0;
            for polygon in polygons(feature) {
                for (k, ring) in polygon.iter().enumerate() {
                    assert!(ring.len() >= 4, "four places at least");
                    assert_eq!(ring.first(), ring.last(), "closed");
                    for [longitude, latitude] in ring {
                        assert!((-180.0..=180.0).contains(longitude) && (-90.0..=90.0).contains(latitude));
                    }
                    for ends in ring.windows(2) {
                        let along_edge = ends[0][1] == ends[1][1] && ends[0][1].abs() == 90.0;
                        let wide = (ends[0][0] - ends[1][0]).abs();
                        assert!(along_edge || wide < 30.0, "no line across the map: {ends:?}");
                    }
                    let signed = steradians(ring);
                    assert_eq!(signed > 0.0, k == 0, "right-hand rule");
                    area += signed;
                }
            }
            area
        })
        .collect();
    let mut expected = vec![0.0; planet.plates.len()];
    for (&plate, area) in planet.plate.iter().zip(planet.lattice.areas()) {
        expected[usize::from(plate)] += area;
    }
    for (found, expected) in areas.iter().zip(&expected) {
        assert!(
            (found - expected).abs() < 0.01 * expected + 1e-4,
            "{found} sr for {expected} sr"
        );
    }
    let all: f64 = areas.iter().sum();
    assert!((all / (4.0 * PI) - 1.0).abs() < 0.001, "{all} sr");
    areas
}

#[test]
fn plates_tile_the_sphere_by_right_handed_rings() {
    let planet = planet();
    check(&planet);
    let collection = plates(&planet);
    assert_eq!(collection["type"], "FeatureCollection");
    assert!(collection.get("frame").is_none(), "degrees need no word");
    for (feature, plate) in collection["features"]
        .as_array()
        .unwrap()
        .iter()
        .zip(&planet.plates)
    {
        let about = &feature["properties"];
        assert_eq!(about["id"], plate.id);
        let pole = direction(
            about["pole_latitude"].as_f64().unwrap(),
            about["pole_longitude"].as_f64().unwrap(),
        );
        let rate = about["rate_deg_per_my"].as_f64().unwrap();
        assert!((pole * rate.to_radians()).distance(plate.omega) < 1e-6);
        let mkm2 = plate.area_sr * RADIUS_KM * RADIUS_KM / 1e6;
        assert!((about["area_mkm2"].as_f64().unwrap() - mkm2).abs() < 1e-3);
        assert!((about["continental"].as_f64().unwrap() - plate.continental).abs() < 1e-3);
    }
}

#[test]
fn poles_islands_and_the_antimeridian_are_no_exceptions() {
    let planet = planet();
    // A cap on each pole, off the axis.
    check(&with_plates(&planet, |p| {
        let (north, south) = (direction(80.0, 30.0), direction(-75.0, -170.0));
        match p {
            p if p.dot(north) > 0.9 => 1,
            p if p.dot(south) > 0.8 => 2,
            _ => 0,
        }
    }));
    // All is one plate but for an island away from the edge of the map: the plate has a hole and nothing to cross.
    let island = with_plates(&planet, |p| u16::from(p.dot(direction(10.0, 20.0)) > 0.95));
    check(&island);
    let found = polygons(&plates(&island)["features"][0]);
    assert_eq!((found.len(), found[0].len()), (1, 2));
    // An island on the antimeridian falls into two polygons.
    let split = with_plates(&planet, |p| u16::from(p.dot(direction(-20.0, 179.0)) > 0.95));
    check(&split);
    assert_eq!(polygons(&plates(&split)["features"][1]).len(), 2);
    // Northern and southern half, and four quarters that meet at the poles.
    check(&with_plates(&planet, |p| u16::from(p.z > 0.0)));
    check(&with_plates(&planet, |p| {
        u16::from(p.x > 0.0) + 2 * u16::from(p.y > 0.0)
    }));
    // A single plate is the whole map.
    let whole = with_plates(&planet, |_| 0);
    check(&whole);
}

#[test]
fn maps_are_equirectangular_and_hold_the_samples() {
    let planet = planet();
    let folder = tempfile::tempdir().unwrap();
    let out = OutDir::create(folder.path()).unwrap();
    planet::write(&out, &planet, &[], 400).unwrap();
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();

    let (size, channels) = read_exr(&read("elevation.exr"));
    assert_eq!(size, (400, 200));
    let elevation = &channels["elevation_m"];
    let (age_size, ages) = read_exr(&read("age.exr"));
    assert_eq!(age_size, (400, 200));
    let age = &ages["age_my"];
    // The pixel under a sample is about as high as the sample, and of its kind.
    let pixel = |p: DVec3| {
        let (latitude, longitude) = orogen::sphere::latitude_longitude(p);
        let row = ((90.0 - latitude) / 180.0 * 200.0) as usize;
        let column = ((longitude + 180.0) / 360.0 * 400.0) as usize;
        row.min(199) * 400 + column.min(399)
    };
    let (mut off, mut other) = (0.0, 0);
    for (i, &p) in planet.lattice.points().iter().enumerate() {
        off += (elevation[pixel(p)] - planet.elevation_m[i]).abs();
        other += usize::from((age[pixel(p)] == AGE_OF_CONTINENTS) != planet.continental[i]);
    }
    let count = planet.lattice.len();
    assert!(
        off / (count as f32) < 150.0,
        "{} m off in the mean",
        off / count as f32
    );
    assert!(other < count / 50, "{other} of {count} samples of another kind");
    assert!(age.iter().all(|&my| my == AGE_OF_CONTINENTS || my >= 0.0));

    let sidecar: Sidecar = serde_json::from_slice(&read("elevation16.json")).unwrap();
    let steps = image::load_from_memory(&read("elevation16.png"))
        .unwrap()
        .into_luma16();
    assert_eq!(steps.dimensions(), (400, 200));
    let step_m = (sidecar.metres_at_65535 - sidecar.metres_at_0) / 65535.0;
    for (step, &metres) in steps.as_raw().iter().zip(elevation) {
        let found = sidecar.metres_at_0 + step_m * f64::from(*step);
        assert!((found - f64::from(metres)).abs() <= 0.51 * step_m + 1e-3);
    }
    assert_eq!(sidecar.bounds_deg, [-180.0, -90.0, 180.0, 90.0]);
}

#[test]
fn a_map_of_odd_width_is_still_two_to_one() {
    let lattice = Lattice::new(1_000).unwrap();
    assert_eq!(Equirectangular::new(&lattice, 101).size(), (100, 50));
    assert_eq!(Equirectangular::new(&lattice, 0).size(), (2, 1));
}

#[test]
fn the_globe_is_closed_raised_and_coloured() {
    let planet = planet();
    let mut bytes = Vec::new();
    write_globe(&mut bytes, &planet).unwrap();
    let glb = read_glb(&bytes);
    assert_eq!(glb.document["asset"]["extras"]["exaggeration"], EXAGGERATION);
    let primitive = &glb.document["meshes"][0]["primitives"][0];
    let floats = |attribute: &str| -> Vec<f32> {
        let accessor = primitive["attributes"][attribute].as_u64().unwrap() as usize;
        let view = &glb.document["bufferViews"][accessor];
        let start = view["byteOffset"].as_u64().unwrap() as usize;
        let bytes = &glb.binary[start..][..view["byteLength"].as_u64().unwrap() as usize];
        let words = bytes.chunks_exact(4);
        words
            .map(|word| f32::from_le_bytes(word.try_into().unwrap()))
            .collect()
    };
    let (positions, normals) = (floats("POSITION"), floats("NORMAL"));
    assert_eq!(positions.len(), 3 * planet.lattice.len());
    for (i, (at, normal)) in positions.chunks(3).zip(normals.chunks(3)).enumerate() {
        let (at, normal) = (Vec3::from_slice(at), Vec3::from_slice(normal));
        let km = (f64::from(at.length()) - 1.0) * RADIUS_KM / EXAGGERATION;
        assert!((km * 1000.0 - f64::from(planet.elevation_m[i])).abs() < 1.0);
        assert!(normal.dot(at) > 0.0, "normals point outwards");
        let p = planet.lattice.points()[i];
        assert!(
            at.normalize()
                .distance(Vec3::new(p.x as f32, p.z as f32, -p.y as f32))
                < 1e-5
        );
    }
    let colours = floats("COLOR_0");
    assert!(colours.iter().all(|value| (0.0..=1.0).contains(value)));
    let (deepest, _) = extreme(&planet.elevation_m, f32::lt);
    let (highest, _) = extreme(&planet.elevation_m, f32::gt);
    assert!(
        colours[3 * deepest + 2] > colours[3 * deepest],
        "the deep sea is blue"
    );
    assert!(
        colours[3 * highest] > colours[3 * highest + 2],
        "high land is not"
    );
}

fn extreme(values: &[f32], wins: impl Fn(&f32, &f32) -> bool) -> (usize, f32) {
    let mut best = (0, values[0]);
    for (i, value) in values.iter().enumerate() {
        if wins(value, &best.1) {
            best = (i, *value);
        }
    }
    best
}

/// Lines of a rotation file: plate, age, rotation.
fn read_rot(text: &str) -> Vec<(u32, f64, DQuat)> {
    text.lines()
        .map(|line| {
            let (numbers, comment) = line.split_once('!').unwrap();
            assert!(comment.starts_with(" plate "));
            let columns: Vec<f64> = numbers.split_whitespace().map(|n| n.parse().unwrap()).collect();
            let [plate, age, latitude, longitude, angle, fixed] = columns[..] else {
                panic!("six columns: {line}");
            };
            assert_eq!(fixed, 0.0, "the world's frame");
            let turn = DQuat::from_axis_angle(direction(latitude, longitude), angle.to_radians());
            (plate as u32, age, turn)
        })
        .collect()
}

#[test]
fn rotations_take_plates_back_to_where_they_were() {
    let lattice = Arc::new(Lattice::new(4_000).unwrap());
    let start = Start::Random {
        plates: 6,
        continental: 0.4,
        seed: 3,
    };
    let mut planet = Planet::new(lattice, &start, GlobeParams::planet()).unwrap();
    let mut history = Vec::new();
    let record = |planet: &Planet, history: &mut Vec<Rotation>| {
        for plate in planet.surface(0.0).plates {
            history.push(Rotation {
                time_my: planet.time_my(),
                plate: plate.id,
                rotation: plate.rotation,
            });
        }
    };
    record(&planet, &mut history);
    let mut born = None;
    for step in 0..15 {
        planet.step();
        if step == 6 {
            let first = planet.plate_ids().next().unwrap();
            let parts = planet.rift(first, &orogen::globe::Cut::Parts(2)).unwrap();
            born = parts.last().copied();
        }
        record(&planet, &mut history);
    }
    let mut text = Vec::new();
    write_rotations(&mut text, &history).unwrap();
    let lines = read_rot(std::str::from_utf8(&text).unwrap());
    assert_eq!(lines.len(), history.len());
    assert!(lines.iter().all(|(plate, ..)| *plate > 0), "0 is the world");
    for entry in &history {
        let of_plate = || history.iter().filter(|other| other.plate == entry.plate);
        let last = of_plate().next_back().unwrap();
        let (_, _, turn) = lines
            .iter()
            .find(|(plate, age, _)| *plate == entry.plate + 1 && (30.0 - age - entry.time_my).abs() < 1e-3)
            .unwrap();
        for probe in [DVec3::X, DVec3::Y, DVec3::Z] {
            let found = *turn * (last.rotation * probe);
            assert!(found.distance(entry.rotation * probe) < 1e-6);
        }
    }
    let oldest = lines
        .iter()
        .filter(|(plate, ..)| Some(*plate - 1) == born)
        .map(|line| line.1)
        .fold(0.0, f64::max);
    assert!(
        (oldest - 16.0).abs() < 1e-3,
        "born 14 My after the start: {oldest}"
    );
    // Ages of a plate ascend from 0.
    for pair in lines.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        assert!(pair[0].1 < pair[1].1);
    }
}

#[test]
fn the_same_planet_gives_the_same_bytes() {
    let planet = planet();
    let bytes = || {
        let (mut glb, mut json) = (Cursor::new(Vec::new()), Vec::new());
        write_globe(&mut glb, &planet).unwrap();
        write_plates(&mut json, &planet).unwrap();
        (glb.into_inner(), json)
    };
    let [one, two] = [1, 2].map(|threads| picture_common::on_threads(threads, bytes));
    assert!(one == two);
}
