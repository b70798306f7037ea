//! Poisson-disc samples of a rectangle: irregular, isotropic, without clumps or holes.
//!
//! The radius is chosen so that the requested number of nodes falls three or four per cent short of saturation;
//! throwing stops at that number exactly.

use glam::DVec2;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::dart_board::DartBoard;
use crate::units::Extent;

/// Mean spacing of nodes along the border, in disc radii. With [`BORDER_JITTER`] the gaps lie between 1.0 and 1.5
/// radii: no two border nodes are closer than a radius, and no inner node fits between two of them and the border.
const BORDER_SPACING: f64 = 1.25;

/// Largest shift of a border node along its side, in border spacings.
const BORDER_JITTER: f64 = 0.1;

/// Nodes per squared radius that are aimed at. Random insertion saturates at 0.696 (a jamming coverage of 0.547).
const FILL: f64 = 0.672;

/// Width in radii by which the border nodes keep inner nodes away from the border, as seen by their number.
const BORDER_STRIP: f64 = 0.95;

/// Factor by which the radius shrinks when a set saturates before it has enough nodes.
const SHRINK: f64 = 0.98;

/// Positions of a Poisson-disc sample, the border nodes first, and the number of border nodes.
pub(super) struct Samples {
    /// All positions, metres.
    pub(super) positions: Vec<DVec2>,
    /// The first `border` positions lie on the border of the rectangle.
    pub(super) border: usize,
}

/// Exactly `nodes` (at least 16) Poisson-disc samples of `extent`, with nodes along its border, corners included.
pub(super) fn poisson_disc(extent: Extent, nodes: usize, seed: u64) -> Samples {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut radius = disc_radius(extent, nodes);
    let border = border_nodes(extent, radius, nodes, &mut rng);
    loop {
        let mut throw = DartBoard::new(extent, radius, border.clone());
        throw.fill(nodes, &mut rng);
        if throw.positions.len() >= nodes {
            return Samples {
                positions: throw.positions,
                border: border.len(),
            };
        }
        radius *= SHRINK;
    }
}

/// Poisson-disc samples of `extent` that leave no room for another: no two are nearer than `radius` metres, and no place
/// is farther than that from all. Border nodes as in [`poisson_disc`].
pub(super) fn saturated(extent: Extent, radius: f64, seed: u64) -> Samples {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let border = border_nodes(extent, radius, usize::MAX, &mut rng);
    let count = border.len();
    let mut throw = DartBoard::new(extent, radius, border);
    throw.fill(usize::MAX, &mut rng);
    Samples {
        positions: throw.positions,
        border: count,
    }
}

/// How many samples [`saturated`] has room for at most: discs of half the radius, packed as tightly as they go, on the
/// rectangle grown by half a radius.
pub(super) fn saturated_at_most(extent: Extent, radius: f64) -> f64 {
    (extent.width + radius) * (extent.height + radius) / (radius * radius * 3.0_f64.sqrt() / 2.0)
}

/// The disc radius at which about `nodes` samples nearly saturate `extent`.
fn disc_radius(extent: Extent, nodes: usize) -> f64 {
    let expected = |r: f64| {
        let inner = (extent.width - BORDER_STRIP * r).max(0.0) * (extent.height - BORDER_STRIP * r).max(0.0);
        2.0 * (extent.width + extent.height) / (BORDER_SPACING * r) + FILL * inner / (r * r)
    };
    let (mut low, mut high) = (0.0, extent.width.max(extent.height));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if expected(middle) > nodes as f64 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high.min(extent.width).min(extent.height)
}

/// Nodes along the border: the four corners, and jittered regular nodes between them, `nodes` at most.
fn border_nodes(extent: Extent, radius: f64, nodes: usize, rng: &mut Pcg64Mcg) -> Vec<DVec2> {
    let segments = |length: f64| ((length / (BORDER_SPACING * radius)).round() as usize).max(1);
    let (mut columns, mut rows) = (segments(extent.width), segments(extent.height));
    let excess = (2 * (columns + rows)).saturating_sub(nodes).div_ceil(2);
    let long = columns.max(rows);
    let shortened = long.saturating_sub(excess).max(1);
    if columns >= rows {
        columns = shortened;
    } else {
        rows = shortened;
    }
    let mut border = Vec::with_capacity(2 * (columns + rows));
    let corners = [
        DVec2::ZERO,
        DVec2::new(extent.width, 0.0),
        extent.size(),
        DVec2::new(0.0, extent.height),
    ];
    for side in 0..4 {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        let count = if side % 2 == 0 { columns } else { rows };
        border.push(from);
        for k in 1..count {
            let shift = BORDER_JITTER * (2.0 * unit(rng.next_u64()) - 1.0);
            let t = (k as f64 + shift) / count as f64;
            // One coordinate is the same at both ends and stays exactly on the side.
            border.push(from + (to - from) * t);
        }
    }
    border
}

/// A number in [0, 1) from the upper bits of a random word.
fn unit(word: u64) -> f64 {
    (word >> 11) as f64 / (1_u64 << 53) as f64
}
