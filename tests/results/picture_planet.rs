//! Pictures of planets: what is sea looks like sea, what is land like land, and the map closes behind the world.

use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};
use image::RgbaImage;
use orogen::globe::{GlobeParams, Planet, Start};
use orogen::picture::planet::{Theme, WorldMapStyle, globe, theme_map, world_map};
use orogen::sphere::{Lattice, arc, direction};
use orogen::surface::planet::{Border, BorderKind, Grip, Orogeny, Planet as Shown, PlateFacts};

const PLAIN: WorldMapStyle = WorldMapStyle {
    borders: false,
    legend: false,
};

fn planet() -> Shown {
    let lattice = Arc::new(Lattice::new(6_000).expect("in range"));
    let start = Start::Random {
        plates: 12,
        continental: 0.35,
        seed: 5,
    };
    let mut planet = Planet::new(lattice, &start, GlobeParams::planet()).expect("a planet");
    for _ in 0..20 {
        planet.step();
    }
    planet.surface(0.0)
}

#[test]
fn deep_sea_is_blue_and_low_land_is_not() {
    let planet = planet();
    let width = 400;
    let map = world_map(&planet, PLAIN, width);
    assert_eq!((map.width(), map.height()), (width, width / 2));
    let (mut seas, mut lands, mut wrong) = (0, 0, 0);
    for y in 0..map.height() {
        let latitude = 90.0 - 180.0 * (f64::from(y) + 0.5) / f64::from(map.height());
        // Ice is white on both.
        if latitude.abs() > 40.0 {
            continue;
        }
        for x in 0..width {
            let p = direction(latitude, -180.0 + 360.0 * (f64::from(x) + 0.5) / f64::from(width));
            let (corners, _) = planet.lattice.locate(p);
            let metres = corners.map(|i| planet.elevation_m[i as usize]);
            let [red, _, blue, alpha] = map.get_pixel(x, y).0;
            assert_eq!(alpha, 255);
            if metres.iter().all(|&m| m < -3_000.0) {
                seas += 1;
                wrong += u32::from(blue <= red);
            } else if metres.iter().all(|&m| (300.0..1_500.0).contains(&m)) {
                lands += 1;
                wrong += u32::from(blue >= red.saturating_add(10));
            }
        }
    }
    assert!(seas > 5_000 && lands > 500, "{seas} {lands}");
    // A coast that winds differs from the samples here and there.
    assert!(
        f64::from(wrong) < 0.02 * f64::from(seas + lands),
        "{wrong} of {seas} and {lands}"
    );
}

#[test]
fn the_map_closes_behind_the_world() {
    let map = world_map(&planet(), PLAIN, 512);
    let jump = |a: u32, b: u32| {
        let rows = 0..map.height();
        let differences = rows.map(|y| {
            let (a, b) = (map.get_pixel(a, y).0, map.get_pixel(b, y).0);
            (0..3).map(|k| f64::from(a[k].abs_diff(b[k]))).sum::<f64>()
        });
        differences.sum::<f64>() / f64::from(map.height())
    };
    let inside = (1..511).map(|x| jump(x, x + 1)).sum::<f64>() / 510.0;
    assert!(
        jump(511, 0) < 2.0 * inside + 1.0,
        "{} against {inside}",
        jump(511, 0)
    );
}

#[test]
fn the_globe_shows_the_side_that_is_looked_at() {
    let planet = planet();
    let size = 200;
    // The eye is over the north pole: the middle of the picture is ice, its corner the dark room.
    let over_the_pole = globe(&planet, DQuat::IDENTITY, size);
    let [red, green, blue, _] = over_the_pole.get_pixel(size / 2, size / 2).0;
    assert!(red > 150 && green > 150 && blue > 150, "{red} {green} {blue}");
    let corner = over_the_pole.get_pixel(1, 1).0;
    assert!(corner[..3].iter().all(|&c| c < 40), "{corner:?}");
    let other = globe(&planet, DQuat::from_rotation_x(1.5), size);
    assert_ne!(over_the_pole, other);
}

#[test]
fn young_sea_floor_and_old_are_told_apart_and_every_map_has_its_key() {
    let mut planet = planet();
    for (i, age) in planet.age_my.iter_mut().enumerate() {
        planet.continental[i] = false;
        *age = if planet.lattice.points()[i].z > 0.0 {
            0.0
        } else {
            190.0
        };
    }
    planet.borders.clear();
    let map = theme_map(&planet, Theme::Age, 200);
    let (north, south) = (map.get_pixel(100, 20).0, map.get_pixel(100, 80).0);
    assert!(north[0] > north[2] && south[2] > south[0], "{north:?} {south:?}");
    for theme in [Theme::Plates, Theme::Age, Theme::Crust, Theme::Orogeny] {
        assert!(theme_map(&planet, theme, 200).height() > 100, "{theme:?}");
    }
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    let planet = planet();
    let draw = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| world_map(&planet, WorldMapStyle::default(), 256))
    };
    assert_eq!(draw(1), draw(3));
}

const WIDTH: u32 = 512;
/// Middle of the one continent, degrees north and east, and its radius, radians.
const CONTINENT: (f64, f64) = (10.0, 40.0);
const RADIUS: f64 = 0.45;

/// A round continent in a sea that is oldest in the far west, on two plates.
fn one_continent() -> Shown {
    let lattice = Arc::new(Lattice::new(8_000).expect("in range"));
    let centre = direction(CONTINENT.0, CONTINENT.1);
    let within = |sea: f32, land: f32| -> Vec<f32> {
        let points = lattice.points().iter();
        points
            .map(|&p| if arc(p, centre) < RADIUS { land } else { sea })
            .collect()
    };
    let n = lattice.len();
    let plate = |id: u32, axis| PlateFacts {
        id,
        rotation: DQuat::from_axis_angle(axis, 0.3),
        omega: axis * 0.008,
        area_sr: 6.0,
        continental: 0.1,
        grip: Grip::Free,
    };
    let continental: Vec<bool> = within(0.0, 1.0).iter().map(|&x| x > 0.5).collect();
    let age_my = lattice.points().iter().zip(&continental);
    Shown {
        time_my: 40.0,
        elevation_m: within(-4500.0, 600.0),
        plate: lattice.points().iter().map(|p| u16::from(p.x < 0.0)).collect(),
        thickness_km: within(7.0, 38.0),
        age_my: age_my
            .map(|(p, &land)| if land { 0.0 } else { 100.0 - 90.0 * p.x as f32 })
            .collect(),
        orogeny: continental
            .iter()
            .map(|&land| if land { Orogeny::Himalayan } else { Orogeny::None })
            .collect(),
        continental,
        orogeny_age_my: vec![0.0; n],
        fold: vec![Vec3::ZERO; n],
        ridge: vec![Vec3::Z; n],
        plates: vec![plate(3, DVec3::Z), plate(8, DVec3::Y)],
        borders: Vec::new(),
        hot_spots: Vec::new(),
        lattice,
    }
}

fn at(map: &RgbaImage, latitude: f64, longitude: f64) -> [i32; 3] {
    let scale = f64::from(WIDTH) / 360.0;
    let (x, y) = ((longitude + 180.0) * scale, (90.0 - latitude) * scale);
    let [red, green, blue, _] = map.get_pixel(x as u32, y as u32).0;
    [red, green, blue].map(i32::from)
}

fn distance(a: [i32; 3], b: [i32; 3]) -> i32 {
    (0..3).map(|k| (a[k] - b[k]).abs()).max().unwrap_or(0)
}

#[test]
fn a_coast_winds_more_finely_than_the_samples() {
    let map = world_map(&one_continent(), PLAIN, 1024);
    let centre = direction(CONTINENT.0, CONTINENT.1);
    let blue = |x: u32, y: u32| {
        let [red, _, blue, _] = map.get_pixel(x, y).0;
        i32::from(blue) > i32::from(red) + 15
    };
    let mut reach = Vec::new();
    for y in 1..511 {
        for x in 1..1023 {
            if blue(x, y) != blue(x + 1, y) && y > 80 && y < 430 {
                let place = direction(
                    90.0 - f64::from(y) * 360.0 / 1024.0,
                    f64::from(x) * 360.0 / 1024.0 - 180.0,
                );
                reach.push(arc(place, centre) - RADIUS);
            }
        }
    }
    let mean = reach.iter().sum::<f64>() / reach.len() as f64;
    let spread = (reach.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / reach.len() as f64).sqrt();
    let spacing = one_continent().lattice.spacing();
    assert!(
        spread > 0.1 * spacing && spread < 1.2 * spacing,
        "{spread} of {spacing}"
    );
}

#[test]
fn no_streak_is_seen_at_a_pole() {
    let map = world_map(&one_continent(), PLAIN, WIDTH);
    let colour = |x: u32, y: u32| {
        let [red, green, blue, _] = map.get_pixel(x, y).0;
        [red, green, blue].map(i32::from)
    };
    for y in [0, WIDTH / 2 - 1] {
        let farthest = (1..WIDTH).map(|x| distance(colour(0, y), colour(x, y))).max();
        assert!(farthest < Some(60), "row {y}: {farthest:?}");
    }
}

#[test]
fn a_globe_is_lit_from_the_upper_left_and_turned_to_the_eye() {
    let planet = one_continent();
    let centre = direction(CONTINENT.0, CONTINENT.1);
    let towards = |p| DQuat::from_rotation_arc(p, DVec3::Z);
    let middle = |picture: &RgbaImage| {
        let [red, _, blue, _] = picture.get_pixel(150, 150).0.map(i32::from);
        blue > red + 10
    };
    let (front, back) = (
        globe(&planet, towards(centre), 300),
        globe(&planet, towards(-centre), 300),
    );
    assert!(!middle(&front) && middle(&back));
    // Lit from the upper left.
    let light = |x: u32, y: u32| -> i32 { back.get_pixel(x, y).0[..3].iter().map(|&v| i32::from(v)).sum() };
    assert!(light(100, 100) > light(210, 210) + 30);
}

#[test]
fn themes_colour_what_they_name() {
    let planet = one_continent();
    let map = |theme| theme_map(&planet, theme, WIDTH);
    // The sea by its age: youngest at the prime meridian, oldest on the far side.
    let ages = map(Theme::Age);
    let (young, old) = (at(&ages, -60.0, 0.0), at(&ages, -5.0, 178.0));
    assert!(young[0] > young[2] && old[2] > old[0], "{young:?} {old:?}");
    // Two plates, two colours; the plate of each half is one colour at sea.
    let plates = map(Theme::Plates);
    let (here, there) = (at(&plates, -50.0, 20.0), at(&plates, -50.0, 160.0));
    assert!(distance(here, there) > 20 && distance(here, at(&plates, -50.0, -60.0)) <= 2);
    for theme in [Theme::Crust, Theme::Orogeny] {
        let map = map(theme);
        let (land, sea) = (at(&map, CONTINENT.0, CONTINENT.1), at(&map, -50.0, 160.0));
        assert!(
            land[0] > land[2] && sea[2] > sea[0],
            "{theme:?}: {land:?} {sea:?}"
        );
    }
}

#[test]
fn teeth_stand_on_the_plate_that_stays_on_top() {
    let mut planet = one_continent();
    // A meridian in the empty sea, 100° west, from 20° south to 20° north; the upper plate lies east or west of it.
    let line = |upper: f64| -> Vec<Border> {
        let [east, west] =
            [upper, -upper].map(|by| planet.lattice.nearest(direction(0.0, -100.0 + 4.0 * by)));
        (-20..20)
            .map(|k| Border {
                ends: [k, k + 1].map(|k| direction(f64::from(k), -100.0).as_vec3()),
                samples: [east, west],
                kind: BorderKind::Subduction,
                closing_mm_per_yr: 50.0,
            })
            .collect()
    };
    let lines = [line(1.0), line(-1.0)];
    let style = WorldMapStyle {
        borders: true,
        legend: false,
    };
    for plate in &mut planet.plates {
        plate.omega = DVec3::ZERO;
    }
    let bare = world_map(&planet, style, 2048);
    for (borders, east_on_top) in lines.into_iter().zip([true, false]) {
        planet.borders = borders;
        let map = world_map(&planet, style, 2048);
        let column = (80.0 * 2048.0 / 360.0) as i64;
        let inked = |from: i64, to: i64| {
            let pixels = (from..to).flat_map(|x| (420..600).map(move |y| ((column + x) as u32, y)));
            pixels
                .filter(|&(x, y)| map.get_pixel(x, y) != bare.get_pixel(x, y))
                .count()
        };
        let (east, west) = (inked(3, 9), inked(-8, -2));
        let (upper, lower) = if east_on_top { (east, west) } else { (west, east) };
        assert!(upper > 40 && lower == 0, "{east} east, {west} west");
    }
}
