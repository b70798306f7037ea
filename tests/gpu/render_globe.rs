//! The planet drawn off screen: what a picture must show, whatever draws it.
//!
//! Where nothing can draw, the tests say so and pass; with `OROGEN_REQUIRE_GPU=1` they fail.

use std::f64::consts::FRAC_PI_2;

use crate::card;
use crate::planet_common::planet;
use glam::{DQuat, DVec2, DVec3};
use image::RgbaImage;
use orogen::render::{Disc, globe_picture};
use orogen::surface::planet::Planet;

/// Small enough for a software adapter.
const SIZE: [u32; 2] = [400, 300];
/// Samples of the planet: cells of eight pixels.
const SAMPLES: usize = 8000;

/// North up, `longitude` (radians) in the middle.
fn view(longitude: f64) -> Disc {
    Disc {
        turn: DQuat::from_rotation_x(-FRAC_PI_2) * DQuat::from_rotation_z(-FRAC_PI_2 - longitude),
        centre_px: DVec2::new(210.0, 145.0),
        radius_px: 120.0,
    }
}

fn at(picture: &RgbaImage, px: DVec2) -> [i32; 3] {
    let [red, green, blue, _] = picture.get_pixel(px.x as u32, px.y as u32).0;
    [red, green, blue].map(i32::from)
}

/// Samples whose neighbours, three deep, are all the same kind of crust, well inside the disc and off the ice.
fn inside<'a>(planet: &'a Planet, view: &'a Disc, continental: bool) -> impl Iterator<Item = DVec2> + 'a {
    let same = move |i: u32| planet.continental[i as usize] == continental;
    let star = |i: u32| planet.lattice.neighbours(i).iter().copied();
    (0..planet.lattice.len() as u32)
        .filter(move |&i| {
            same(i) && star(i).all(|j| same(j) && star(j).all(|k| same(k) && star(k).all(same)))
        })
        .map(|i| planet.lattice.point(i))
        .filter(|p| p.z.abs() < 0.7)
        .filter_map(|p| view.project(p))
        .filter(|px| px.distance(view.centre_px) < 0.8 * view.radius_px)
}

#[test]
fn seas_are_blue_and_lands_are_not_where_the_view_projects_them() {
    let Some(gpu) = card::drawing() else { return };
    let planet = planet(SAMPLES);
    for longitude in [-1.0, 0.7, 2.9] {
        let view = view(longitude);
        let picture = globe_picture(&gpu, &planet, &view, SIZE).expect("picture");
        let blue = |px: DVec2| {
            let [red, _, blue] = at(&picture, px);
            blue > red + 15
        };
        for (continental, name) in [(false, "sea"), (true, "land")] {
            let places: Vec<DVec2> = inside(&planet, &view, continental).collect();
            assert!(places.len() > 50, "{} places of {name}", places.len());
            let right = places.iter().filter(|&&px| blue(px) != continental).count();
            assert!(
                right * 100 >= places.len() * 97,
                "{name} at {longitude}: {right} of {}",
                places.len()
            );
        }
    }
}

#[test]
fn the_disc_has_the_size_and_place_of_the_view_and_the_room_is_dark() {
    let Some(gpu) = card::drawing() else { return };
    let planet = planet(SAMPLES);
    let view = view(0.0);
    let picture = globe_picture(&gpu, &planet, &view, SIZE).expect("picture");
    let room = at(&picture, DVec2::ZERO);
    assert!(room.iter().all(|&part| part < 40), "{room:?}");
    let sum = |px: DVec2| at(&picture, px).iter().sum::<i32>();
    // The lamp stands at the upper left: that limb is bright up to its edge, and the air beyond fades into the room.
    let towards_lamp = DVec2::new(-0.68, -0.73).normalize();
    let along = |radii: f64| sum(view.centre_px + towards_lamp * view.radius_px * radii);
    assert!(along(0.97) > 250, "{}", along(0.97));
    assert_eq!(along(1.12), room.iter().sum::<i32>());
    assert!(along(0.97) > along(1.02) && along(1.02) > along(1.12));
    // The far side of the lamp is dusk, not night: whoever stands there wants to see plates too.
    let dusk = sum(view.centre_px - towards_lamp * view.radius_px * 0.8);
    assert!((60..500).contains(&dusk), "{dusk}");
}

#[test]
fn places_project_where_the_disc_shows_them() {
    let view = view(0.0);
    let east = view.project(DVec3::new(0.9, 0.3, 0.0).normalize()).expect("seen");
    let north = view.project(DVec3::new(0.9, 0.0, 0.3).normalize()).expect("seen");
    assert!(east.x > view.centre_px.x + 20.0 && (east.y - view.centre_px.y).abs() < 1e-9);
    assert!(north.y < view.centre_px.y - 20.0 && (north.x - view.centre_px.x).abs() < 1e-9);
    assert_eq!(view.project(DVec3::NEG_X), None, "the far side");
}

#[test]
fn ice_lies_at_the_poles() {
    let Some(gpu) = card::drawing() else { return };
    let planet = planet(SAMPLES);
    let view = Disc {
        turn: DQuat::IDENTITY,
        ..view(0.0)
    };
    let picture = globe_picture(&gpu, &planet, &view, SIZE).expect("picture");
    let pole = at(&picture, view.centre_px);
    assert!(pole.iter().all(|&part| part > 170), "{pole:?}");
}
