//! Random numbers of the planet: one generator, in its state.

use glam::DVec3;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng as _;

/// Any 64 bits.
pub(super) fn word(rng: &mut Pcg64Mcg) -> u64 {
    rng.next_u64()
}

/// From 0 to below 1.
pub(super) fn unit(rng: &mut Pcg64Mcg) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Any direction, all alike.
pub(super) fn direction(rng: &mut Pcg64Mcg) -> DVec3 {
    let z = 2.0 * unit(rng) - 1.0;
    let (sin, cos) = (std::f64::consts::TAU * unit(rng)).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}
