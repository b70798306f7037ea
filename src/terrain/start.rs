//! The land before the first push: smooth hills with a little noise, from a seed.

use fastnoise_lite::{FastNoiseLite, NoiseType};
use glam::DVec2;

use super::tin::Tin;
use crate::units::KM;

/// Height of the hills above and below zero, metres.
const HILLS: f64 = 150.0;

/// Wavelengths of the hills and their shares of the height.
const HILL_WAVES: [(f64, f64); 2] = [(40.0 * KM, 0.7), (15.0 * KM, 0.3)];

/// Amplitude of the noise that keeps the first rivers from running in parallel, metres.
const NOISE: f64 = 1.0;

/// The start land of a seed: ±150 m of smooth hills plus ±1 m of noise that differs from place to place.
///
/// A pure function of position and seed, so that every TIN of one seed sees the same hills.
pub struct StartLand {
    seed: u64,
    waves: [FastNoiseLite; 2],
}

impl StartLand {
    /// The land of a seed.
    pub fn new(seed: u64) -> Self {
        let wave = |k: u64| {
            // The low bits of a mixed seed; each wave gets its own.
            let mut wave = FastNoiseLite::with_seed(mix(seed.wrapping_add(k)) as i32);
            wave.set_noise_type(Some(NoiseType::OpenSimplex2));
            wave.set_frequency(Some(1.0));
            wave
        };
        Self {
            seed,
            waves: [wave(0), wave(1)],
        }
    }

    /// Height of the smooth hills at a position, metres.
    pub fn hills(&self, position: DVec2) -> f64 {
        let share: f64 = self
            .waves
            .iter()
            .zip(HILL_WAVES)
            .map(|(wave, (length, share))| {
                let p = position / length;
                share * f64::from(wave.get_noise_2d(p.x as f32, p.y as f32)).clamp(-1.0, 1.0)
            })
            .sum();
        HILLS * share
    }

    /// Height at a position, metres.
    pub fn height(&self, position: DVec2) -> f64 {
        let word = mix(mix(self.seed ^ position.x.to_bits()) ^ position.y.to_bits());
        let unit = (word >> 11) as f64 / (1_u64 << 53) as f64;
        self.hills(position) + NOISE * (2.0 * unit - 1.0)
    }

    /// Heights at all nodes of a TIN, metres.
    pub fn heights(&self, tin: &Tin) -> Vec<f64> {
        tin.positions().iter().map(|&p| self.height(p)).collect()
    }
}

/// A bijection of words that spreads every bit over all (`SplitMix64`, Steele, Lea & Flood 2014).
fn mix(word: u64) -> u64 {
    let word = word.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let word = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    word ^ (word >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Extent;

    #[test]
    fn hills_fill_their_range_and_stay_in_it_and_noise_is_small() {
        let extent = Extent {
            width: 400.0 * KM,
            height: 400.0 * KM,
        };
        let tin = Tin::poisson(extent, 4000, 1).unwrap();
        let land = StartLand::new(5);
        let (mut low, mut high, mut roughest) = (f64::MAX, f64::MIN, 0.0_f64);
        for &p in tin.positions() {
            low = low.min(land.hills(p));
            high = high.max(land.hills(p));
            roughest = roughest.max((land.height(p) - land.hills(p)).abs());
        }
        assert!(low >= -HILLS && high <= HILLS);
        assert!(low < -0.6 * HILLS && high > 0.6 * HILLS, "{low} … {high}");
        assert!(roughest <= NOISE && roughest > 0.99 * NOISE);
        let elsewhere = StartLand::new(6);
        assert_ne!(land.heights(&tin), elsewhere.heights(&tin));
    }

    #[test]
    fn hills_are_smooth() {
        let land = StartLand::new(5);
        let step = 100.0;
        let steepest = (0..2000)
            .map(|k| {
                let at = |k: usize| land.hills(DVec2::new(step * k as f64, 33.0 * KM));
                ((at(k + 1) - at(k)) / step).abs()
            })
            .fold(0.0, f64::max);
        assert!(steepest < 0.05, "{steepest}");
    }
}
