//! River incision by the stream power law, implicit in time.

use glam::DVec2;

use super::blocks::Stretch;
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

/// The land that a stretch of a network lies in, from its first node on.
#[derive(Debug)]
pub(super) struct Surface<'a> {
    /// Heights, m.
    pub(super) z: &'a mut [f64],
    /// Heights of the water surface, m; none where there are no lakes.
    pub(super) water: Option<&'a mut [f64]>,
}

impl Surface<'_> {
    /// The same, one block after the other.
    pub(super) fn in_blocks(self, size: usize) -> Vec<Self> {
        let mut water = self.water.map(|water| water.chunks_mut(size));
        let ground = self.z.chunks_mut(size);
        let part = |z| Surface {
            z,
            water: water.as_mut().and_then(Iterator::next),
        };
        ground.map(part).collect()
    }
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
        let surface = Surface { z, water };
        let all = Stretch::whole(network.order);
        self.sweep(network, all, surface, rise, duration, eroded);
    }

    /// [`Self::step`] of one stretch of the network.
    pub(super) fn sweep(
        &self,
        network: &Network<'_>,
        stretch: Stretch<'_>,
        surface: Surface<'_>,
        rise: impl Fn(usize) -> f64,
        duration: impl Fn(usize) -> f64,
        eroded: impl FnMut(usize, f64),
    ) {
        match (surface.z, surface.water) {
            (z, Some(water)) => self.climb::<true>(network, stretch, (z, water), rise, duration, eroded),
            (z, None) => self.climb::<false>(network, stretch, (z, &mut []), rise, duration, eroded),
        }
    }

    fn climb<const WET: bool>(
        &self,
        network: &Network<'_>,
        stretch: Stretch<'_>,
        land: (&mut [f64], &mut [f64]),
        rise: impl Fn(usize) -> f64,
        duration: impl Fn(usize) -> f64,
        eroded: impl FnMut(usize, f64),
    ) {
        let Self { m, n, .. } = *self;
        // Each law compiled in.
        if n != 1.0 {
            let general = |i: usize, a: f64, dd: f64, x: f64| self.remaining(duration(i), a, dd, x);
            sweep::<WET>(network, stretch, land, rise, general, eroded);
        } else if m == 0.5 {
            let root = |i: usize, area: f64, squared: f64, excess: f64| {
                excess / (1.0 + self.k * duration(i) * (area / squared).sqrt())
            };
            sweep::<WET>(network, stretch, land, rise, root, eroded);
        } else {
            let power = |i: usize, area: f64, squared: f64, excess: f64| {
                excess / (1.0 + self.k * duration(i) * area.powf(m) / squared.sqrt())
            };
            sweep::<WET>(network, stretch, land, rise, power, eroded);
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
/// distance, excess)`. Compiled once for lands with water and once for those without.
fn sweep<const WET: bool>(
    network: &Network<'_>,
    mut stretch: Stretch<'_>,
    (z, water): (&mut [f64], &mut [f64]),
    rise: impl Fn(usize) -> f64,
    settle: impl Fn(usize, f64, f64, f64) -> f64,
    mut eroded: impl FnMut(usize, f64),
) {
    let positions = network.positions;
    // One length, one check of bounds.
    let (first, nodes) = (stretch.first, z.len());
    let receivers = &network.receivers[first..first + nodes];
    let drainage = &network.drainage[first..first + nodes];
    let water = if WET { &mut water[..nodes] } else { water };
    for node in stretch.order {
        let (i, k) = (node.index(), node.index() - first);
        let receiver = receivers[k].index();
        if receiver == i {
            if WET {
                water[k] = z[k];
            }
            continue;
        }
        let base = stretch.below(receiver, if WET { water } else { z });
        let risen = z[k] + rise(i);
        let excess = risen - base;
        let (mut ground, mut level) = (risen, base);
        if excess > 0.0 {
            let squared = positions[i].distance_squared(positions[receiver]);
            let left = settle(i, drainage[k], squared, excess);
            (ground, level) = (base + left, base + left);
            eroded(i, excess - left);
        }
        z[k] = ground;
        if WET {
            water[k] = level;
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
