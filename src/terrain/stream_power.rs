//! River incision by the stream power law, implicit in time.

use glam::DVec2;

use super::tin::NodeId;

/// Most iterations for one node when n ≠ 1. Ten are rare; the cap is there for input that is not finite.
const MAX_ITERATIONS: usize = 60;

/// Relative step below which a node's equation counts as solved: a few units of round-off.
const TOLERANCE: f64 = 1e-15;

/// The stream power law ∂z/∂t = u − k Aᵐ sⁿ (Cordonnier et al. 2018, Eq. 5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamPower {
    /// Erosion constant; 1/yr for m = 0.5 and n = 1, in general m^(1 − 2m)/yr.
    pub k: f64,
    /// Exponent of the drainage area.
    pub m: f64,
    /// Exponent of the slope.
    pub n: f64,
}

/// A river network: for each node a receiver (outlets name themselves) and a drainage area.
#[derive(Clone, Copy, Debug)]
pub struct Network<'a> {
    /// Positions in the plan, metres.
    pub positions: &'a [DVec2],
    /// Where each node's water goes.
    pub receivers: &'a [NodeId],
    /// Every node once, each after its receiver.
    pub order: &'a [NodeId],
    /// Drainage area, m².
    pub drainage: &'a [f64],
}

impl StreamPower {
    /// Raises all nodes but outlets by `rise` (m), and incises them for `duration` years (times the
    /// erodibility of the node).
    ///
    /// Implicit in time (Braun & Willett 2013): from the outlets upstream, each height follows from its own and from
    /// the *new* height of its receiver, so any time step is stable and dt → ∞ gives the steady state. For n = 1 the
    /// node's equation is solved exactly, else by a monotone Newton's method. First order in time and
    /// along the stream: knickpoints spread by ½ c Δx (1 + c Δt/Δx) at celerity c.
    ///
    /// `water` holds the height of the water surface where it lies above the ground, and is kept up to date: with
    /// receivers carved through lakes it is the running maximum of heights along the flow, nodes under water rise
    /// but are not incised, and no node is incised below the water it drains to. Outlets are read, not moved.
    ///
    /// Returns the incised depth of each node through `eroded` (node, m).
    ///
    /// # Panics
    /// If a slice is shorter than the network.
    pub fn step(
        &self,
        network: &Network<'_>,
        z: &mut [f64],
        water: Option<&mut [f64]>,
        rise: impl Fn(usize) -> f64,
        duration: impl Fn(usize) -> f64,
        eroded: impl FnMut(usize, f64),
    ) {
        let Self { m, n, .. } = *self;
        // Three copies of the sweep, each with its own law compiled in.
        if n != 1.0 {
            sweep(
                network,
                z,
                water,
                rise,
                |i, a, dd, x| self.remaining(duration(i), a, dd, x),
                eroded,
            );
        } else if m == 0.5 {
            let root = |i: usize, area: f64, squared: f64, excess: f64| {
                excess / (1.0 + self.k * duration(i) * (area / squared).sqrt())
            };
            sweep(network, z, water, rise, root, eroded);
        } else {
            let power = |i: usize, area: f64, squared: f64, excess: f64| {
                excess / (1.0 + self.k * duration(i) * area.powf(m) / squared.sqrt())
            };
            sweep(network, z, water, rise, power, eroded);
        }
    }

    /// What is left, after `duration` years (times the erodibility), of an `excess` (m, positive) of a node with the
    /// given drainage area (m²) over a base at a squared distance (m²).
    pub(super) fn remaining(&self, duration: f64, area: f64, squared: f64, excess: f64) -> f64 {
        let factor = self.k * duration * area.powf(self.m) / squared.powf(0.5 * self.n);
        if self.n == 1.0 {
            excess / (1.0 + factor)
        } else {
            excess * remaining_share(factor * excess.powf(self.n - 1.0), self.n)
        }
    }
}

/// From the outlets upstream: what is left of each node's excess over its receiver is `settle(node, drainage, squared
/// distance, excess)`.
fn sweep(
    network: &Network<'_>,
    z: &mut [f64],
    water: Option<&mut [f64]>,
    rise: impl Fn(usize) -> f64,
    settle: impl Fn(usize, f64, f64, f64) -> f64,
    mut eroded: impl FnMut(usize, f64),
) {
    let &Network {
        positions,
        receivers,
        order,
        drainage,
    } = network;
    let remaining = |i: usize, receiver: usize, excess: f64| {
        settle(
            i,
            drainage[i],
            positions[i].distance_squared(positions[receiver]),
            excess,
        )
    };
    if let Some(water) = water {
        for node in order {
            let i = node.index();
            let receiver = receivers[i].index();
            if receiver == i {
                water[i] = z[i];
                continue;
            }
            let base = water[receiver];
            let risen = z[i] + rise(i);
            let excess = risen - base;
            if excess > 0.0 {
                let left = remaining(i, receiver, excess);
                z[i] = base + left;
                water[i] = z[i];
                eroded(i, excess - left);
            } else {
                z[i] = risen;
                water[i] = base;
            }
        }
    } else {
        for node in order {
            let i = node.index();
            let receiver = receivers[i].index();
            if receiver == i {
                continue;
            }
            let base = z[receiver];
            let risen = z[i] + rise(i);
            let excess = risen - base;
            if excess > 0.0 {
                let left = remaining(i, receiver, excess);
                z[i] = base + left;
                eroded(i, excess - left);
            } else {
                z[i] = risen;
            }
        }
    }
}

/// The root y in [0, 1] of y + φ yⁿ = 1, for φ ≥ 0 and n > 0; 1 for no erosion, 0 for endless erosion.
///
/// For n ≥ 1 the left-hand side is convex in y, for n < 1 it is so in x = yⁿ: x^(1/n) + φ x. Newton's method on a
/// convex increasing function, started above the root, comes down to it monotonically; it starts where the larger
/// term alone reaches 1, so few steps are left. Once rounding stops the descent, it is there.
fn remaining_share(phi: f64, n: f64) -> f64 {
    if phi <= 0.0 {
        return 1.0;
    }
    let (linear, curved, power) = if n >= 1.0 {
        (1.0, phi, n)
    } else {
        (phi, 1.0, 1.0 / n)
    };
    let mut x = (1.0 / linear).min(curved.powf(-1.0 / power));
    if x > 0.0 {
        for _ in 0..MAX_ITERATIONS {
            let term = curved * x.powf(power);
            let step = (linear * x + term - 1.0) / (linear + power * term / x);
            if step > TOLERANCE * x {
                x -= step;
            } else {
                break;
            }
        }
    }
    if n >= 1.0 { x } else { x.powf(power) }
}

#[cfg(test)]
mod tests {
    use super::remaining_share;

    #[test]
    fn remaining_share_solves_its_equation_from_no_to_total_erosion() {
        for n in [0.3, 0.5, 0.8, 1.0, 1.5, 2.0, 4.0] {
            for exponent in -12..=12 {
                let phi = 10_f64.powi(exponent);
                let y = remaining_share(phi, n);
                assert!((0.0..=1.0).contains(&y));
                let residual = y + phi * y.powf(n) - 1.0;
                assert!(residual.abs() < 1e-12, "n {n}, φ {phi}: y {y} leaves {residual}");
            }
        }
    }

    #[test]
    fn remaining_share_at_its_ends() {
        assert_eq!(remaining_share(0.0, 2.0), 1.0);
        assert_eq!(remaining_share(f64::INFINITY, 0.5), 0.0);
        // y + y² = 1 is the golden ratio's.
        assert!((remaining_share(1.0, 2.0) - 0.618_033_988_749_894_9).abs() < 1e-14);
    }
}
