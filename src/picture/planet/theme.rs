//! Maps of single facts: plates, age of the sea floor, kind and thickness of crust, mountain building.

use glam::{DVec3, Vec3};
use image::RgbaImage;
use rayon::prelude::*;

use super::ink;
use super::relief::Relief;
use crate::picture::MAX_SIDE;
use crate::picture::colour::{Encoder, Ramp, linear};
use crate::sphere::direction;
use crate::surface::planet::{Orogeny, Planet};

/// Where a pixel is looked at, parts of it from its upper left corner: its edges are soft.
const QUARTERS: [(f64, f64); 4] = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];

/// Oldest sea floor on the scale, My.
const OLDEST_MY: f32 = 200.0;

/// What a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Theme {
    /// Plates in colours of their own, continents darker.
    Plates,
    /// Age of the sea floor, on a fixed scale.
    Age,
    /// Oceanic crust, and the thickness of continental crust.
    Crust,
    /// Mountains by what built them, and when.
    Orogeny,
}

impl Theme {
    /// Its title and the entries of its key: colour and words.
    pub(super) fn key(self) -> (&'static str, Vec<(u32, String)>) {
        let my = |age: f32| format!("{age:.0} My");
        match self {
            Self::Plates => (
                "Plates",
                vec![(0x009a_9a9a, "sea".into()), (0x0058_5858, "land".into())],
            ),
            Self::Age => {
                let ages = [0.0, 25.0, 50.0, 100.0, 150.0, 200.0];
                let entries = ages.map(|age| (AGES[index_of(age)].1, my(age)));
                ("Age of the sea floor", entries.into())
            }
            Self::Crust => (
                "Crust",
                vec![
                    (SEA, "oceanic".into()),
                    (THICK[0].1, "30 km".into()),
                    (THICK[1].1, "40 km".into()),
                    (THICK[2].1, "55 km".into()),
                    (THICK[3].1, "70 km".into()),
                ],
            ),
            Self::Orogeny => (
                "Mountain building",
                vec![
                    (LAND, "none".into()),
                    (ANDEAN, "over a plunging plate".into()),
                    (HIMALAYAN, "continents collided".into()),
                    (OLD, "older than 200 My".into()),
                ],
            ),
        }
    }
}

/// Colours of ages, My.
const AGES: [(f32, u32); 6] = [
    (0.0, 0x00b8_2e2e),
    (25.0, 0x00e0_7b3c),
    (50.0, 0x00ed_c464),
    (100.0, 0x0086_b98b),
    (150.0, 0x0041_7fa8),
    (OLDEST_MY, 0x0035_3a7d),
];
/// Colours of continental thickness, km.
const THICK: [(f32, u32); 4] = [
    (30.0, 0x00c9_c3ac),
    (40.0, 0x00a8_9c78),
    (55.0, 0x008a_6a4c),
    (70.0, 0x005c_3a30),
];
const SEA: u32 = 0x0024_4664;
const LAND: u32 = 0x00b9_b5a6;
const ANDEAN: u32 = 0x00b5_7a3a;
const HIMALAYAN: u32 = 0x009c_3b34;
const OLD: u32 = 0x008f_8a80;

fn index_of(age: f32) -> usize {
    AGES.iter()
        .position(|(at, _)| *at >= age)
        .unwrap_or(AGES.len() - 1)
}

/// A map of one fact, equirectangular as [`super::world_map`], with its key below.
pub fn theme_map(planet: &Planet, theme: Theme, width: u32) -> RgbaImage {
    let width = width.clamp(64, MAX_SIDE) & !1;
    let height = width / 2;
    let (encoder, tints) = (Encoder::new(), Tints::new(planet, theme, width));
    let mut image = RgbaImage::new(width, height);
    image
        .par_chunks_mut(4 * width as usize)
        .enumerate()
        .for_each(|(y, row)| {
            for x in 0..width {
                let mut colour = Vec3::ZERO;
                for (across, down) in QUARTERS {
                    let latitude = 90.0 - 180.0 * (y as f64 + down) / f64::from(height);
                    let longitude = -180.0 + 360.0 * (f64::from(x) + across) / f64::from(width);
                    colour += tints.at(direction(latitude, longitude)) / QUARTERS.len() as f32;
                }
                row[4 * x as usize..][..3].copy_from_slice(&encoder.encode(colour));
                row[4 * x as usize + 3] = 255;
            }
        });
    ink::finish_theme(image, planet, theme)
}

/// The colours of a theme everywhere.
struct Tints<'a> {
    planet: &'a Planet,
    theme: Theme,
    relief: Relief<'a>,
    ages: Ramp,
    thick: Ramp,
}

impl<'a> Tints<'a> {
    fn new(planet: &'a Planet, theme: Theme, width: u32) -> Self {
        Self {
            planet,
            theme,
            relief: Relief::new(planet, std::f32::consts::TAU / width as f32),
            ages: Ramp::new(&AGES),
            thick: Ramp::new(&THICK),
        }
    }

    /// The colour at `p`: continents end where half of the crust is theirs, and what changes gradually is interpolated
    /// among samples of the same crust.
    fn at(&self, p: DVec3) -> Vec3 {
        let planet = self.planet;
        let (corners, weights) = planet.lattice.locate(self.relief.bent(p));
        let corners = corners.map(|i| i as usize);
        let share = |of: &dyn Fn(usize) -> bool| -> f64 {
            let near = corners.iter().zip(weights).filter(|&(&i, _)| of(i));
            near.map(|(_, weight)| weight).sum()
        };
        let land = share(&|i| planet.continental[i]) > 0.5;
        let same = |i: usize| planet.continental[i] == land;
        let all = share(&same);
        let mean = |values: &[f32]| {
            let near = corners.iter().zip(weights).filter(|&(&i, _)| same(i));
            near.map(|(&i, weight)| (weight / all) as f32 * values[i])
                .sum::<f32>()
        };
        match self.theme {
            Theme::Plates => {
                // Plates end at the borders that are drawn, which do not wind.
                let plate = planet.plate[planet.lattice.nearest(p) as usize];
                let hue = plate_colour(planet.plates[plate as usize].id);
                if land { hue * 0.45 } else { hue }
            }
            Theme::Age if land => linear(LAND) * 0.8,
            Theme::Age => self.ages.at(mean(&planet.age_my)),
            Theme::Crust | Theme::Orogeny if !land => linear(SEA),
            Theme::Crust => self.thick.at(mean(&planet.thickness_km)),
            Theme::Orogeny => {
                let of = |kind| share(&|i| same(i) && planet.orogeny[i] == kind);
                let [none, andean, himalayan] = [Orogeny::None, Orogeny::Andean, Orogeny::Himalayan].map(of);
                if none >= andean.max(himalayan) {
                    return linear(LAND);
                }
                let (kind, built) = if andean >= himalayan {
                    (Orogeny::Andean, linear(ANDEAN))
                } else {
                    (Orogeny::Himalayan, linear(HIMALAYAN))
                };
                let near = corners
                    .iter()
                    .zip(weights)
                    .filter(|&(&i, _)| same(i) && planet.orogeny[i] == kind);
                let age: f64 = near
                    .map(|(&i, weight)| weight * f64::from(planet.orogeny_age_my[i]))
                    .sum();
                let age = (age / andean.max(himalayan)) as f32;
                built.lerp(linear(OLD), (age / 200.0).clamp(0.0, 1.0))
            }
        }
    }
}

/// A quiet colour that a plate keeps for life: hues by the golden angle.
fn plate_colour(id: u32) -> Vec3 {
    let hue = (f64::from(id) * 0.618_033_988_75).fract() as f32;
    let value = 0.30 + 0.14 * ((id * 7) % 3) as f32 / 2.0;
    let channel = |shift: f32| {
        let t = ((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0;
        value * (0.45 + 0.55 * t.clamp(0.0, 1.0))
    };
    Vec3::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}
