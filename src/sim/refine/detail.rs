//! What a coarse land could not show: the unevenness between its nodes.

use fastnoise_lite::{FastNoiseLite, FractalType, NoiseType};
use glam::DVec2;
use rayon::prelude::*;

use crate::terrain::Tin;

/// Height of the unevenness against the fall of the land over a spacing of the coarse nodes. Rivers and slides do the
/// rest; more than this and hills stand in their own valleys.
const UNEVENNESS: f64 = 0.2;
/// Share of it that the lowest places have; the highest have all.
const LEAST_SHARE: f64 = 0.35;
/// Waves of the unevenness; the longest is two spacings of the coarse nodes, each next one half as long.
const OCTAVES: i32 = 3;
/// Greatest difference of a rock's strength from that of its bed, as a share of it.
const STRENGTHS: f64 = 0.3;
/// Nodes per task.
const CHUNK: usize = 4096;

/// Mean slope from each node to its neighbours.
pub(super) fn slopes(tin: &Tin, z: &[f64]) -> Vec<f64> {
    let slope = |node| {
        let links = tin.links(node);
        let falls = links
            .iter()
            .map(|link| (z[link.to.index()] - z[node.index()]).abs() * f64::from(link.inverse_distance));
        falls.sum::<f64>() / links.len() as f64
    };
    tin.nodes().map(slope).collect()
}

/// Roughens the heights `z` at `places` of the plan, where a land with nodes `spacing` metres apart has the slope
/// `slopes`: the steeper and the higher, the more (paper, section 7: noise weighted by slope and elevation; here it lies
/// under the erosion instead of on top of it). A function of place and seed, so that lands cut out side by side agree.
pub(super) fn roughen(places: &[DVec2], slopes: &[f64], spacing: f64, seed: u64, z: &mut [f64]) {
    let noise = waves(seed);
    let (low, high) = z
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &z| {
            (low.min(z), high.max(z))
        });
    let range = (high - low).max(1.0);
    let wave = 2.0 * spacing;
    z.par_iter_mut()
        .zip(places.par_iter().zip(slopes))
        .with_min_len(CHUNK)
        .for_each(|(z, (place, slope))| {
            let p = *place / wave;
            let share = LEAST_SHARE + (1.0 - LEAST_SHARE) * (*z - low) / range;
            *z +=
                UNEVENNESS * spacing * slope * share * f64::from(noise.get_noise_2d(p.x as f32, p.y as f32));
        });
}

/// How strong the rock at `places` of the plan is against what its bed says: slopes of one strength are planes.
pub(super) fn strength(places: &[DVec2], spacing: f64, seed: u64) -> Vec<f64> {
    // Another pattern than the one of heights.
    let noise = waves(!seed);
    let wave = 2.0 * spacing;
    let at = |place: &DVec2| {
        let p = *place / wave;
        1.0 + STRENGTHS * f64::from(noise.get_noise_2d(p.x as f32, p.y as f32))
    };
    places.par_iter().with_min_len(CHUNK).map(at).collect()
}

/// Fractal waves between about −1 and 1, the longest of length 1.
fn waves(seed: u64) -> FastNoiseLite {
    let mut noise = FastNoiseLite::with_seed(seed as i32);
    noise.set_noise_type(Some(NoiseType::OpenSimplex2));
    noise.set_fractal_type(Some(FractalType::FBm));
    noise.set_fractal_octaves(Some(OCTAVES));
    noise.set_frequency(Some(1.0));
    noise
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Extent;

    #[test]
    fn steep_and_high_places_are_rougher_and_plains_stay_plains() {
        let land = Extent {
            width: 40e3,
            height: 10e3,
        };
        let tin = Tin::poisson(land, 4000, 1).unwrap();
        // A plain, a low slope, a plateau, a high slope.
        let height = |p: DVec2| match p.x {
            x if x < 10e3 => 0.0,
            x if x < 20e3 => (x - 10e3) * 0.2,
            x if x < 30e3 => 2000.0,
            x => 2000.0 + (x - 30e3) * 0.2,
        };
        let smooth: Vec<f64> = tin.positions().iter().map(|&p| height(p)).collect();
        let slopes = slopes(&tin, &smooth);
        let mut rough = smooth.clone();
        roughen(tin.positions(), &slopes, 500.0, 3, &mut rough);
        let spread = |from: f64| {
            let inside = |p: &DVec2| p.x > from + 1e3 && p.x < from + 9e3;
            let squares: Vec<f64> = tin
                .positions()
                .iter()
                .zip(rough.iter().zip(&smooth))
                .filter(|(p, _)| inside(p))
                .map(|(_, (rough, smooth))| (rough - smooth).powi(2))
                .collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        let [plain, low, plateau, high] = [0.0, 10e3, 20e3, 30e3].map(spread);
        assert!(plain < 1e-9 && plateau < 1e-9, "{plain} {plateau}");
        assert!(low > 1.0 && high > 1.5 * low, "{low} {high}");
    }
}
