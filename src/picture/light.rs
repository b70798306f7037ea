//! The light of a Swiss relief map (Imhof 1965, *Kartographische Geländedarstellung*): a warm sun in the north-west,
//! a cool sky, soft shadows.

use glam::Vec3;
use rayon::prelude::*;

use super::colour::smoothstep;
use super::field::Field;
use super::horizon::{horizon, sky_view};
use super::noise;

/// Height of the sun over the horizon, radians.
pub(crate) const SUN_ELEVATION: f32 = 0.70;

/// Where the sun stands, radians clockwise from north.
const SUN_AZIMUTH: f64 = 315.0 / 180.0 * std::f64::consts::PI;

/// Sun for cast shadows: lower than the one for slopes would throw them too far, so mountains are shaded by one sun
/// and cast shadows by the lower rim of a wide one. Tangents of the elevations between which the light fades.
pub(crate) const PENUMBRA: (f32, f32) = (0.36, 0.78);

/// Azimuths the sky is looked at.
const SKY_DIRECTIONS: usize = 12;

/// Most pixels the sky is computed at; above, every second (third, …) pixel serves, as the sky's light is soft.
const SKY_PIXELS: usize = 700_000;

/// Standard deviation of the blur that hides the mesh, in mesh edges.
const GRAIN: f32 = 0.16;

/// How much crests and valley floors gain over the land around.
const EDGE: f32 = 0.8;

/// Colours of light. Flat open ground receives exactly white.
const SUN: Vec3 = Vec3::new(1.0, 0.93, 0.77);
const SKY: Vec3 = Vec3::new(0.43, 0.63, 1.0);
/// Share of the light on flat ground that comes from the sun.
const SUN_SHARE: f32 = 0.66;

/// The shape of the land as light and land cover see it. All heights are in pixels, exaggerated.
pub(super) struct Relief {
    /// Heights of the solid ground, their crests and valley floors sharpened.
    ground: Field,
    /// Heights over a few mesh edges: the direction of slopes.
    slopes: Field,
    /// Steepness of `slopes` in the neighbourhood.
    ruggedness: Field,
    /// Heights over some kilometres: the big forms. A lake counts with its level.
    forms: Field,
    /// Tangent of the horizon towards the sun.
    towards_sun: Field,
    /// Part of the sky seen, on a coarser grid.
    sky: Field,
    /// Wavelength of the gullies that continue the land below the mesh, pixels; 0 for none.
    gully_wavelength: f32,
    /// Vertical exaggeration that is in the heights.
    exaggeration: f32,
    /// Metres per unit of height.
    metres_per_unit: f32,
}

/// Land and light at one pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    /// Light relative to flat open ground.
    pub(super) light: Vec3,
    /// Tangent of the true steepness that plants, stones and snow meet.
    pub(super) steepness: f32,
    /// Tangent of the true steepness over a few mesh edges, without gullies.
    pub(super) hillside: f32,
    /// Tangent of the true steepness of the big form around.
    pub(super) form_steepness: f32,
    /// 1 on north faces, −1 on south faces, 0 on flat ground.
    pub(super) northness: f32,
    /// Ridges positive, hollows negative, about −1 to 1.
    pub(super) convexity: f32,
    /// Height over the land some kilometres around, metres.
    pub(super) rise: f32,
    /// Part of the sky seen.
    pub(super) sky: f32,
}

impl Relief {
    /// From heights and depths of water in metres on pixels of `metres_per_pixel`, known every `spacing` pixels.
    pub(super) fn new(
        metres: &Field,
        depth: &Field,
        metres_per_pixel: f32,
        spacing: f32,
        exaggeration: f32,
    ) -> Self {
        let scale = exaggeration / metres_per_pixel;
        let mut ground = metres.clone();
        ground.data.par_iter_mut().for_each(|z| *z *= scale);
        let mut level = ground.clone();
        level
            .data
            .par_iter_mut()
            .zip(&depth.data)
            .for_each(|(z, depth)| *z += scale * depth.max(0.0));
        let slopes = ground.blurred((0.9 * spacing).max(2.0));
        let ruggedness = ruggedness(&slopes, spacing);
        let ground = sharpened(&ground, &slopes, &ruggedness, spacing);
        let forms = level.blurred((2200.0 / metres_per_pixel).max(2.0 * spacing));
        let towards_sun = horizon(&level, SUN_AZIMUTH);
        let pixels = ground.data.len();
        let skip = ((pixels as f64 / SKY_PIXELS as f64).sqrt().ceil() as usize).max(1);
        let sky = sky_view(&every(&level, skip), SKY_DIRECTIONS);
        let gully_wavelength = 2.0 * spacing;
        Self {
            ground,
            slopes,
            ruggedness,
            forms,
            towards_sun,
            sky,
            gully_wavelength: if gully_wavelength > 3.0 {
                gully_wavelength
            } else {
                0.0
            },
            exaggeration,
            metres_per_unit: 1.0 / scale,
        }
    }

    /// Light and land at a pixel; `height_share` is 0 in the plains and 1 at the summits (aerial perspective:
    /// contrast grows with height).
    pub(super) fn spot(&self, x: usize, y: usize, height_share: f32) -> Spot {
        let fine = self.ground.gradient(x, y);
        let middle = self.slopes.gradient(x, y);
        let form = self.forms.gradient(x, y);
        let steep = length(middle);

        // In the plains only the smoothed land counts: its finest noise is no form.
        let i = y * self.ground.width + x;
        let rugged = smoothstep(0.015, 0.10, self.ruggedness.data[i]);
        let mut slope = mix(middle, fine, rugged);
        let mut furrow = 0.0;
        if self.gully_wavelength > 0.0 && steep > 0.06 {
            let (carved, depth) = self.gullies(x, y, middle, steep);
            slope = (slope.0 + carved.0, slope.1 + carved.1);
            furrow = depth;
        }

        let gentle = lowland_gain(length(form) + 0.5 * steep);
        let lit = (slope.0 * gentle, slope.1 * gentle);
        let direct = 0.74 * sun_on(lit) + 0.26 * sun_on((form.0 * gentle * 1.3, form.1 * gentle * 1.3));

        let shadow = 1.0 - smoothstep(PENUMBRA.0, PENUMBRA.1, self.towards_sun.data[i]);
        let skip = self.ground.width as f32 / self.sky.width as f32;
        let sky = self
            .sky
            .sample((x as f32 + 0.5) / skip - 0.5, (y as f32 + 0.5) / skip - 0.5);
        let up = 1.0 / (1.0 + slope.0 * slope.0 + slope.1 * slope.1).sqrt();

        let sun = direct / SUN_ELEVATION.sin() * (0.40 + 0.60 * shadow);
        let dome = sky * sky * (0.5 + 0.5 * up);
        let white = SUN * SUN_SHARE + SKY * (1.0 - SUN_SHARE);
        let light = (SUN * (SUN_SHARE * sun) + SKY * ((1.0 - SUN_SHARE) * dome)) / white;
        // Low land is seen through more air: its lights and shadows are weaker.
        let contrast = 0.95 + 0.25 * height_share;
        let light = Vec3::ONE + (light - Vec3::ONE) * contrast;

        // Half the hillside's, half the spot's own: what grows and lies asks for both.
        let true_steepness = 0.5 * (length(slope) + steep) / self.exaggeration;
        let bend = self.ground.data[i] - self.slopes.data[i];
        Spot {
            light: shoulder(light.max(Vec3::ZERO)),
            steepness: true_steepness,
            hillside: steep / self.exaggeration,
            form_steepness: length(form) / self.exaggeration,
            northness: if steep > 1e-6 {
                -slope.1 / length(slope).max(0.15)
            } else {
                0.0
            },
            convexity: (bend / (0.25 * self.gully_wavelength.max(3.0))).clamp(-1.0, 1.0) + furrow,
            rise: (self.slopes.data[i] - self.forms.data[i]) * self.metres_per_unit,
            sky,
        }
    }

    /// True steepness (tangent) of the smoothed land at a pixel position.
    pub(super) fn steepness_at(&self, x: f32, y: f32) -> f32 {
        let x = x.clamp(0.0, (self.ground.width - 1) as f32) as usize;
        let y = y.clamp(0.0, (self.ground.height - 1) as f32) as usize;
        length(self.slopes.gradient(x, y)) / self.exaggeration
    }

    /// Gradient and profile of gullies down the slope, in two generations, the finer ones running into the coarser.
    fn gullies(&self, x: usize, y: usize, down: (f32, f32), steep: f32) -> ((f32, f32), f32) {
        let mut direction = (-down.0 / steep, -down.1 / steep);
        let mut wavelength = self.gully_wavelength;
        // Lattice coordinates with y to the north, as directions have it.
        let (east, north) = (x as f32, -(y as f32));
        // Some slopes are carved, others smooth.
        let reach = 5.0 * wavelength;
        let carving = 0.55 + 0.45 * noise::gradient(east / reach, north / reach, 0x51);
        let mut strength = 0.55 * carving * steep.min(1.0) * smoothstep(0.08, 0.40, steep);
        let (mut carved, mut profile, mut share) = ((0.0, 0.0), 0.0, 0.6);
        for generation in 0..3 {
            if wavelength < 2.5 {
                break;
            }
            let (wave, across) = noise::gullies(
                east / wavelength,
                north / wavelength,
                direction,
                0x9d1 + generation,
            );
            let sideways = (-direction.1, direction.0);
            carved.0 += strength * across * sideways.0;
            carved.1 += strength * across * sideways.1;
            profile += share * wave;
            // The next ones start from the flanks of these.
            let turned = (
                direction.0 - 0.7 * across * sideways.0,
                direction.1 - 0.7 * across * sideways.1,
            );
            let size = length(turned).max(1e-6);
            direction = (turned.0 / size, turned.1 / size);
            wavelength *= 0.5;
            strength *= 0.6;
            share *= 0.6;
        }
        (carved, profile)
    }
}

/// Heights with sharper crests and valley floors: between nodes `spacing` pixels apart the interpolant rounds what in
/// nature is an edge, so what it has over its own mean `slopes` over a few edges is raised again, in the mountains.
fn sharpened(heights: &Field, slopes: &Field, ruggedness: &Field, spacing: f32) -> Field {
    if spacing <= 1.0 {
        return heights.clone();
    }
    // Just wide enough to take out the bends of the interpolant at the mesh's sides.
    let mut sharp = heights.blurred(GRAIN * spacing);
    sharp
        .data
        .par_iter_mut()
        .zip(&slopes.data)
        .zip(&ruggedness.data)
        .for_each(|((z, mean), steep)| *z += EDGE * smoothstep(0.06, 0.25, *steep) * (*z - mean));
    sharp
}

/// Steepness of smoothed heights around each pixel: on a crest, that of its flanks.
fn ruggedness(slopes: &Field, spacing: f32) -> Field {
    let mut steepness = slopes.clone();
    let width = steepness.width;
    steepness
        .data
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            for (x, value) in row.iter_mut().enumerate() {
                *value = length(slopes.gradient(x, y));
            }
        });
    steepness.blurred((1.2 * spacing).max(1.0))
}

/// Every `skip`-th pixel's neighbourhood as one pixel, heights in its own pixels.
fn every(heights: &Field, skip: usize) -> Field {
    if skip == 1 {
        return heights.clone();
    }
    let (width, height) = (heights.width.div_ceil(skip), heights.height.div_ceil(skip));
    let mut data = vec![0.0; width * height];
    data.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        for (x, value) in out.iter_mut().enumerate() {
            let middle = (skip as f32 - 1.0) * 0.5;
            *value = heights.sample((x * skip) as f32 + middle, (y * skip) as f32 + middle) / skip as f32;
        }
    });
    Field { width, height, data }
}

/// Cosine of the sun's incidence on a slope (east, north).
///
/// Seven tenths by the sun itself, the rest by suns in the west-south-west to north weighted by how much the slope
/// faces across them (Mark 1992, "Multidirectional, oblique-weighted, shaded-relief image"), so that ridges that run
/// towards the sun keep their form.
fn sun_on(slope: (f32, f32)) -> f32 {
    let up = 1.0 / (1.0 + slope.0 * slope.0 + slope.1 * slope.1).sqrt();
    let (sin, cos) = SUN_ELEVATION.sin_cos();
    let towards = |east: f32, north: f32| (up * (sin - cos * (slope.0 * east + slope.1 * north))).max(0.0);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let sun = towards(-half, half);
    let (e2, n2) = (slope.0 * slope.0, slope.1 * slope.1);
    let steep2 = e2 + n2;
    if steep2 < 1e-8 {
        return sun;
    }
    // Sine squared of the angle between aspect and each sun.
    let (west, north) = (n2 / steep2, e2 / steep2);
    let oblique = (west * towards(-1.0, 0.0) + north * towards(0.0, 1.0)) / (west + north);
    0.72 * sun + 0.28 * oblique
}

/// Factor by which slopes of some steepness are lit steeper than they are, as draughtsmen do in the lowlands: eleven
/// where it is almost flat, next to none in the mountains. `s + 0.09 (1 − exp(−s/0.009))` lights no steeper slope
/// less.
fn lowland_gain(steepness: f32) -> f32 {
    const LIFT: f32 = 0.09;
    const TURN: f32 = 0.009;
    let s = steepness.max(1e-5);
    1.0 + LIFT * (1.0 - (-s / TURN).exp()) / s
}

/// Light pressed together away from that on flat ground, so that snow in the sun and rock in the shade keep their
/// form.
fn shoulder(light: Vec3) -> Vec3 {
    let over = (light - Vec3::ONE).max(Vec3::ZERO);
    let under = (Vec3::ONE - light).max(Vec3::ZERO);
    Vec3::ONE + over / (Vec3::ONE + 1.6 * over) - under / (Vec3::ONE + 0.22 * under)
}

fn length(v: (f32, f32)) -> f32 {
    (v.0 * v.0 + v.1 * v.1).sqrt()
}

fn mix(a: (f32, f32), b: (f32, f32), t: f32) -> (f32, f32) {
    (a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t)
}
