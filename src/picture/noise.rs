//! Noise from position hashes: the same place gives the same value, on any machine and with any thread count.

/// A well mixed word from a lattice point (after Jarzynski & Olano 2020, "Hash functions for GPU rendering", pcg).
#[inline]
fn hash(x: i32, y: i32, seed: u32) -> u32 {
    let mut v = (x as u32)
        .wrapping_mul(0x9E37_79B1)
        .wrapping_add((y as u32).wrapping_mul(0x85EB_CA77))
        .wrapping_add(seed.wrapping_mul(0xC2B2_AE3D));
    v = v.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    v = ((v >> ((v >> 28) + 4)) ^ v).wrapping_mul(277_803_737);
    (v >> 22) ^ v
}

/// Upper bits of a word as a number in [0, 1).
#[inline]
fn unit(word: u32) -> f32 {
    (word >> 8) as f32 / (1 << 24) as f32
}

/// Gradient noise in about [−1, 1], of wavelength about two (Perlin 2002).
#[inline]
pub(super) fn gradient(x: f32, y: f32, seed: u32) -> f32 {
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let (ix, iy) = (x0 as i32, y0 as i32);
    let ease = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (ease(fx), ease(fy));
    // The two halves of a word make a slope in each direction: all directions, no table.
    let at = |dx: i32, dy: i32| {
        let word = hash(ix.wrapping_add(dx), iy.wrapping_add(dy), seed);
        let east = (word & 0xffff) as f32 * (1.0 / 32768.0) - 1.0;
        let north = (word >> 16) as f32 * (1.0 / 32768.0) - 1.0;
        east * (fx - dx as f32) + north * (fy - dy as f32)
    };
    let south = at(0, 0) + (at(1, 0) - at(0, 0)) * u;
    let north = at(0, 1) + (at(1, 1) - at(0, 1)) * u;
    1.6 * (south + (north - south) * v)
}

/// Octaves of [`gradient`], each half as large and twice as fine, scaled to about [−1, 1]. Octaves are turned against
/// each other, so that the lattice does not show.
#[inline]
pub(super) fn fractal(mut x: f32, mut y: f32, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut amplitude, mut total) = (0.0, 1.0, 0.0);
    for octave in 0..octaves {
        sum += amplitude * gradient(x, y, seed.wrapping_add(octave));
        total += amplitude;
        amplitude *= 0.5;
        (x, y) = (1.6 * x + 1.2 * y + 17.3, -1.2 * x + 1.6 * y - 9.1);
    }
    1.4 * sum / total
}

/// Waves whose crests run along `(ux, uy)` (unit vector), of wavelength one: the profile in [−1, 1], and its
/// derivative across the crests.
///
/// A sum of local plane waves of random phase, one per lattice cell, each weighted by a bump around a jittered centre
/// (sparse convolution as in Lagae et al. 2009). With crests down the slope it has the look of gullies and spurs
/// where the data ends.
#[inline]
pub(super) fn gullies(x: f32, y: f32, (ux, uy): (f32, f32), seed: u32) -> (f32, f32) {
    let (ix, iy) = (x.floor() as i32, y.floor() as i32);
    let (mut profile, mut steepness, mut total) = (0.0, 0.0, 1e-4);
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (cx, cy) = (ix.wrapping_add(dx), iy.wrapping_add(dy));
            let word = hash(cx, cy, seed);
            let px = x - (cx as f32 + 0.2 + 0.6 * unit(word));
            let py = y - (cy as f32 + 0.2 + 0.6 * unit(word.wrapping_mul(0x9E37_79B1)));
            let near = 1.0 - (px * px + py * py) / (1.2 * 1.2);
            if near > 0.0 {
                let weight = near * near;
                let (wave, slope) = wave(px * -uy + py * ux + unit(word.wrapping_mul(0x85EB_CA77)) * 0.35);
                profile += weight * wave;
                steepness += weight * slope;
                total += weight;
            }
        }
    }
    (profile / total, steepness / total)
}

/// A roof-shaped wave of period one in [−1, 1], and its derivative in units of its flanks': crests and floors are
/// edges, rounded over an eighth of the period only.
#[inline]
fn wave(t: f32) -> (f32, f32) {
    let f = t - t.floor() - 0.5;
    let profile = 1.0 - 4.0 * f.abs();
    // Triangle waves a quarter period apart stand in for each other's slope.
    let quarter = t + 0.25;
    let g = quarter - quarter.floor() - 0.5;
    (profile, -((4.0 * g.abs() - 1.0) * STEEP_FLANK).clamp(-1.0, 1.0))
}

/// The larger, the narrower crests and floors.
const STEEP_FLANK: f32 = 4.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_bounded_centred_and_continuous() {
        let (mut sum, mut low, mut high) = (0.0_f64, 0.0_f32, 0.0_f32);
        for i in 0..20_000 {
            let (x, y) = (i as f32 * 0.37 - 2000.0, i as f32 * 0.11);
            let v = fractal(x, y, 4, 5);
            (low, high) = (low.min(v), high.max(v));
            sum += f64::from(v);
            assert!((fractal(x + 1e-3, y, 1, 5) - fractal(x, y, 1, 5)).abs() < 0.02);
        }
        assert!(
            low > -1.4 && high < 1.4 && low < -0.6 && high > 0.6,
            "{low} {high}"
        );
        assert!((sum / 20_000.0).abs() < 0.05);
    }

    #[test]
    fn gullies_run_along_their_direction() {
        let (mut along, mut across) = (0.0, 0.0);
        let (ux, uy) = (0.6, 0.8);
        for i in 0..4000 {
            let (x, y) = (i as f32 * 0.713, i as f32 * 0.291);
            let here = gullies(x, y, (ux, uy), 3).0;
            along += (gullies(x + 0.1 * ux, y + 0.1 * uy, (ux, uy), 3).0 - here).abs();
            across += (gullies(x - 0.1 * uy, y + 0.1 * ux, (ux, uy), 3).0 - here).abs();
        }
        assert!(across > 3.0 * along, "{across} against {along}");
    }
}
