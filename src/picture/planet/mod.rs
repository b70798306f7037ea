//! Pictures of a planet: a world map, a globe, and maps of single facts.
//!
//! Heights between the samples are interpolated, and below their distance noise goes on with them: coasts wind, mountains
//! have crests, and all of it travels with its plate. Light comes from the north-west, as in the relief map.

mod ink;
mod noise;
mod palette;
mod relief;
mod theme;

use std::f64::consts::PI;

use glam::{DQuat, DVec3, Vec3};
use image::RgbaImage;
use rayon::prelude::*;

pub use theme::{Theme, theme_map};

use super::MAX_SIDE;
use super::colour::{Encoder, linear};
use crate::sphere::RADIUS_KM;
use crate::surface::planet::Planet;
use palette::{Palette, smoothstep};
use relief::{Place, Relief};

/// Heights are multiplied by this in the light, on land and under water.
const RELIEF_LAND: f32 = 21.0;
const RELIEF_SEA: f32 = 9.0;
/// A lamp above the left shoulder, the frame of the view; warm light and cool shade.
const LAMP: Vec3 = Vec3::new(-0.52, 0.56, 0.645);
const WARM: Vec3 = Vec3::new(1.06, 1.0, 0.90);
const COOL: Vec3 = Vec3::new(0.62, 0.74, 0.98);
/// The dark of a museum's room.
const ROOM: u32 = 0x0007_0a10;
/// The globe's diameter as a part of its picture.
const GLOBE_PART: f64 = 0.92;

/// What a world map shows beside the land.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorldMapStyle {
    /// Borders of plates by what they do, and arrows of their motion.
    pub borders: bool,
    /// Time, scale of heights and key, on a strip below the map.
    pub legend: bool,
}

impl Default for WorldMapStyle {
    fn default() -> Self {
        Self {
            borders: true,
            legend: true,
        }
    }
}

/// A shaded map of the world, equirectangular: 180° W to 180° E, north up, `width` pixels wide (at least 64) and half as high,
/// and a legend below where the style has one.
pub fn world_map(planet: &Planet, style: WorldMapStyle, width: u32) -> RgbaImage {
    let width = width.clamp(64, MAX_SIDE) & !1;
    let height = width / 2;
    let relief = Relief::new(planet, 2.0 * std::f32::consts::PI / width as f32);
    let direction = |x: u32, y: u32| {
        let latitude = 90.0 - 180.0 * (f64::from(y) + 0.5) / f64::from(height);
        let longitude = -180.0 + 360.0 * (f64::from(x) + 0.5) / f64::from(width);
        crate::sphere::direction(latitude, longitude)
    };
    let places: Vec<Place> = (0..width * height)
        .into_par_iter()
        .with_min_len(width as usize)
        .map(|i| relief.at(direction(i % width, i / width)))
        .collect();
    let pixel_km = PI * RADIUS_KM / f64::from(height);
    let (palette, encoder) = (Palette::new(), Encoder::new());
    let lamp = Vec3::new(LAMP.x, LAMP.y, LAMP.z);
    let mut image = RgbaImage::new(width, height);
    image
        .par_chunks_mut(4 * width as usize)
        .enumerate()
        .for_each(|(y, row)| {
            let y = y as u32;
            let at = |x: u32, y: u32| lit_height(places[(y * width + x % width) as usize].km);
            for x in 0..width {
                let p = direction(x, y);
                let place = places[(y * width + x) as usize];
                // East–west pixels shrink towards the poles.
                let across = (pixel_km * p.x.hypot(p.y).max(0.05)) as f32;
                let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
                let east = (at(x + 1, y) - at(x + width - 1, y)) / (2.0 * across);
                let north = (at(x, above) - at(x, below)) / ((below - above).max(1) as f32 * pixel_km as f32);
                let around = at(x + 1, y) + at(x + width - 1, y) + at(x, above) + at(x, below);
                let hollow = (around - 4.0 * at(x, y)) / pixel_km as f32;
                let slope = Vec3::new(east, north, 0.0);
                let normal = (Vec3::Z - slope).normalize();
                let relief = normal.dot(lamp) - lamp.z;
                let colour = surface_colour(&palette, place, p.z as f32, slope.length(), relief, hollow);
                let bytes = encoder.encode(colour * 1.04);
                row[4 * x as usize..][..3].copy_from_slice(&bytes);
                row[4 * x as usize + 3] = 255;
            }
        });
    ink::finish(image, planet, style)
}

/// The globe under a lamp in a dark room, `size` pixels wide and high (at least 32), orthographic. `view` turns the world's
/// frame into the view's: x right, y up, z towards the eye.
pub fn globe(planet: &Planet, view: DQuat, size: u32) -> RgbaImage {
    let size = size.clamp(32, MAX_SIDE);
    let radius = GLOBE_PART * f64::from(size) / 2.0;
    let relief = Relief::new(planet, 1.0 / radius as f32);
    let back = view.inverse();
    let (palette, encoder, room) = (Palette::new(), Encoder::new(), linear(ROOM));
    let away = |x: u32, y: u32| {
        let middle = f64::from(size) / 2.0;
        let dx = (f64::from(x) + 0.5 - middle) / radius;
        (dx, (middle - f64::from(y) - 0.5) / radius)
    };
    let seen = |x: u32, y: u32| {
        let (dx, dy) = away(x, y);
        let square = dx * dx + dy * dy;
        if square < 1.0 {
            DVec3::new(dx, dy, (1.0 - square).sqrt())
        } else {
            DVec3::new(dx, dy, 0.0) / square.sqrt()
        }
    };
    let places: Vec<Place> = (0..size * size)
        .into_par_iter()
        .with_min_len(size as usize)
        .map(|i| {
            let (dx, dy) = away(i % size, i / size);
            if dx.hypot(dy) > 1.0 + 3.0 / radius {
                return Place::default();
            }
            relief.at(back * seen(i % size, i / size))
        })
        .collect();
    let mut image = RgbaImage::new(size, size);
    image
        .par_chunks_mut(4 * size as usize)
        .enumerate()
        .for_each(|(y, row)| {
            let y = y as u32;
            let at =
                |x: u32, y: u32| lit_height(places[(y.min(size - 1) * size + x.min(size - 1)) as usize].km);
            for x in 0..size {
                let (dx, dy) = away(x, y);
                let distance = dx.hypot(dy) as f32;
                let p = seen(x, y).as_vec3();
                let day = p.dot(LAMP);
                let mut colour = beside(distance, day, room);
                let inside = ((1.0 - distance) * radius as f32 + 0.5).clamp(0.0, 1.0);
                if inside > 0.0 {
                    let place = places[(y * size + x) as usize];
                    let (left, up) = (x.saturating_sub(1), y.saturating_sub(1));
                    let per_km = 0.5 * (radius / RADIUS_KM) as f32;
                    let rise = per_km * Vec3::new(at(x + 1, y) - at(left, y), at(x, up) - at(x, y + 1), 0.0);
                    let around = at(x + 1, y) + at(left, y) + at(x, up) + at(x, y + 1);
                    let hollow = (around - 4.0 * at(x, y)) * 2.0 * per_km;
                    let slope = rise - p * rise.dot(p);
                    let relief = (p - slope).normalize().dot(LAMP) - day;
                    let sine = (back * p.as_dvec3()).z as f32;
                    let ground = surface_colour(&palette, place, sine, slope.length(), relief, hollow);
                    colour = colour.lerp(in_air(ground, p, day), inside);
                }
                row[4 * x as usize..][..3].copy_from_slice(&encoder.encode(colour));
                row[4 * x as usize + 3] = 255;
            }
        });
    image
}

/// Height as the light sees it, km.
fn lit_height(km: f32) -> f32 {
    km * if km < 0.0 { RELIEF_SEA } else { RELIEF_LAND }
}

/// Sea or land in the light of its own slope. `relief` is how much brighter than level ground it faces the lamp.
fn surface_colour(palette: &Palette, place: Place, sine: f32, steep: f32, relief: f32, hollow: f32) -> Vec3 {
    let [broad, middling, fine] = place.variation;
    if place.km < 0.0 {
        let cold = 29.0 - 50.0 * sine * sine + 3.0 * broad + 2.5 * middling + 1.5 * fine;
        let (pack, cover) = palette.pack(cold);
        let sea = palette.sea(-place.km).lerp(pack, cover);
        return sea * (1.0 + (1.0 - 0.7 * cover) * (0.95 * relief).clamp(-0.30, 0.30));
    }
    let ground = palette.land(place.km, sine, steep, place.variation);
    let bright =
        (relief * 1.5).clamp(-0.62, 0.55) - (hollow * 2.2).clamp(-0.10, 0.16) * (1.0 - 0.5 * ground.ice);
    ground.colour * COOL.lerp(Vec3::ONE, smoothstep(-0.5, 0.05, bright)) * (1.0 + bright)
}

/// Day, dusk and the air over a place of the globe.
fn in_air(colour: Vec3, p: Vec3, day: f32) -> Vec3 {
    let open = 0.10 + 0.90 * smoothstep(-0.42, 0.80, day);
    let lit = colour * (COOL * 0.55).lerp(WARM, smoothstep(-0.3, 0.5, day)) * open * 1.08;
    let thick = (1.0 - p.z).powf(3.2);
    let sky = linear(0x001c_3d6e).lerp(linear(0x009f_c6ee), smoothstep(-0.25, 0.75, day));
    lit.lerp(sky, 0.62 * thick * (0.15 + 0.85 * smoothstep(-0.35, 0.5, day)))
}

/// The room beside the globe, and the air that glows around it.
fn beside(distance: f32, day: f32, room: Vec3) -> Vec3 {
    let over = (distance - 1.0).max(0.0);
    let glow =
        (-over / 0.011).exp() * smoothstep(-0.45, 0.7, day) * (1.0 - smoothstep(0.6, 1.0, over / 0.05));
    room + linear(0x005f_8fd0) * 0.45 * glow
}
