//! From layers to wavelength (Eq. 3), with its prefactor.
//!
//! A stiff layer of thickness `h` and viscosity `μ` lies on a soft one of thickness `H` and viscosity `μ_s`, on a rigid
//! floor. Shortened at the rate `ε̇`, a wave of wavenumber `k` and height `w` grows against
//!
//! * the stiff layer's bending, `D k⁴ ẇ` with `D = μ h³ / 3`;
//! * the soft layer, which has to flow from under troughs to under crests in a thin film that sticks to the floor and to
//!   the layer: its flux `−(H³ / 12 μ_s) ∂p/∂x` must feed `ẇ`, so `p = 12 μ_s ẇ / (H³ k²)`;
//!
//! driven by the layer's compression `P = 4 μ ε̇ h`, which pushes with `P k² w`. So
//!
//! ```text
//! ẇ/w = P / (D k² + 12 μ_s / (H³ k⁴)),
//! ```
//!
//! largest where the denominator's derivative vanishes: `k⁶ = 24 μ_s / (D H³) = 72 μ_s / (μ h³ H³)`, and `λ = 2π/k`.
//! If the film slips along the layer, its flux is four times as large and 72 becomes 18 (prefactor 3.88). On a soft base
//! thicker than the wavelength the law is Biot's, `λ = 2πh (μ / 6 μ_s)^(1/3)` (Schmalholz, Podladchikov & Burg 2002,
//! JGR 107(B1), has all three regimes).

use std::f64::consts::TAU;

/// Wavelength of the fastest growing fold, metres: `2π·72^(−1/6) (hH)^(1/2) (μ/μ_s)^(1/6)`.
///
/// `stiff` is the thickness `h` of the layer that buckles, `soft` that of the layer `H` below it, both in metres;
/// `viscosity_ratio` is `μ/μ_s`, some 10–1000 for sandstone or limestone over shale, marl or salt.
pub fn wavelength(stiff: f64, soft: f64, viscosity_ratio: f64) -> f64 {
    TAU * 72.0_f64.powf(-1.0 / 6.0) * (stiff * soft).sqrt() * viscosity_ratio.powf(1.0 / 6.0)
}

#[cfg(test)]
mod tests {
    use super::wavelength;

    #[test]
    fn has_its_prefactor_and_powers() {
        assert!((wavelength(1.0, 1.0, 1.0) - 3.0806).abs() < 1e-4);
        // 2.5 km of limestone over 1 km of marl.
        assert!((wavelength(2_500.0, 1_000.0, 100.0) - 10_500.0).abs() < 20.0);
        let base = wavelength(2_000.0, 500.0, 50.0);
        assert!((wavelength(8_000.0, 500.0, 50.0) / base - 2.0).abs() < 1e-12);
        assert!((wavelength(2_000.0, 500.0, 50.0 * 64.0) / base - 2.0).abs() < 1e-12);
    }

    #[test]
    fn grows_faster_than_its_neighbours() {
        let (h, soft, ratio) = (2_000.0_f64, 700.0_f64, 80.0_f64);
        let growth = |wavelength: f64| {
            let k = std::f64::consts::TAU / wavelength;
            1.0 / (ratio * h.powi(3) / 3.0 * k.powi(2) + 12.0 / (soft.powi(3) * k.powi(4)))
        };
        let best = wavelength(h, soft, ratio);
        assert!(growth(best) > growth(best * 1.01) && growth(best) > growth(best * 0.99));
    }
}
