//! `d^(−e)` for whole rows: base-2 logarithm and exponential from their series, in plain `f32` arithmetic that
//! vectorises on any target and gives the same bits on all of them (no fused multiply-add, no library call).

use std::f32::consts::{LN_2, LOG2_E};

/// Largest relative error of [`exp2`] ∘ scaled [`log2`] against exact powers in the range used here
/// (`|log2 d| ≤ 32`): a few roundings of a number that carries `log2` up to 32.
pub const RELATIVE_ERROR: f32 = 3e-6;

/// Bits of √½.
pub(crate) const SQRT_HALF_BITS: u32 = 0x3f35_04f3;

/// Binary logarithm of a positive, normal number: `x = m·2^k` with `m` in `[√½, √2)`, and
/// `log2 m = 2/ln 2 · artanh((m − 1)/(m + 1))`, whose series needs five terms for 1e-9.
#[inline]
pub fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    // Subtracting the bits of √½ leaves the exponent relative to it in the upper bits.
    let shifted = bits.wrapping_sub(SQRT_HALF_BITS) as i32;
    let exponent = shifted >> 23;
    let mantissa = f32::from_bits(bits.wrapping_sub((exponent << 23) as u32));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let z = s * s;
    let series = 1.0 + z * (1.0 / 3.0 + z * (1.0 / 5.0 + z * (1.0 / 7.0 + z * (1.0 / 9.0))));
    exponent as f32 + (2.0 * LOG2_E * s) * series
}

/// `2^y` for `|y| < 120`: the nearest integer goes to the exponent, the rest into the series of `e^(y ln 2)`.
#[inline]
pub fn exp2(y: f32) -> f32 {
    // Adding 1.5·2^23 rounds to an integer and leaves it in the low bits.
    const ROUND: f32 = 12_582_912.0;
    let rounded = y + ROUND;
    let whole = rounded.to_bits().wrapping_sub(ROUND.to_bits());
    let f = (y - (rounded - ROUND)) * LN_2;
    let series = 1.0
        + f * (1.0
            + f * (1.0 / 2.0
                + f * (1.0 / 6.0
                    + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0 + f * (1.0 / 5040.0)))))));
    series * f32::from_bits((whole.wrapping_add(127)) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_keep_their_accuracy_over_the_whole_range() {
        for exponent in [0.5_f32, 0.9, 1.0, 2.0] {
            for i in 0..200_000 {
                let d = (-16.0 + 32.0 * f64::from(i) / 200_000.0).exp2() as f32;
                let exact = f64::from(d).powf(-f64::from(exponent));
                let ours = f64::from(exp2(-exponent * log2(d)));
                assert!(
                    (ours / exact - 1.0).abs() < f64::from(RELATIVE_ERROR),
                    "{d}^-{exponent}: {ours} against {exact}"
                );
            }
        }
    }

    #[test]
    fn near_one_the_logarithm_is_exact_to_rounding() {
        assert_eq!(log2(1.0), 0.0);
        for d in [0.5_f32, 0.7, 1.414, 1.5, 2.0] {
            assert!((f64::from(log2(d)) - f64::from(d).log2()).abs() < 2e-7, "{d}");
        }
        assert_eq!(exp2(0.0), 1.0);
        assert_eq!(exp2(-3.0), 0.125);
    }
}
