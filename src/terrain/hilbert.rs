//! Order along a Hilbert curve: what is near in the plane is near in memory.

use glam::DVec2;

use crate::units::Extent;

/// A permutation of `positions` along a Hilbert curve over `extent`: nodes near in the plane are near in memory.
pub(super) fn hilbert_order(extent: Extent, positions: &[DVec2]) -> Vec<u32> {
    let scale = 65_535.0 / extent.width.max(extent.height);
    let mut keys: Vec<u64> = positions
        .iter()
        .enumerate()
        .map(|(index, p)| hilbert_key((p.x * scale) as u32, (p.y * scale) as u32) << 32 | index as u64)
        .collect();
    keys.sort_unstable();
    keys.into_iter().map(|key| key as u32).collect()
}

/// Distance along the Hilbert curve of order 16 at cell (`x`, `y`).
fn hilbert_key(mut x: u32, mut y: u32) -> u64 {
    let mut key = 0_u64;
    for bit in (0..16).rev() {
        let (rx, ry) = (x >> bit & 1, y >> bit & 1);
        key = key << 2 | u64::from((3 * rx) ^ ry);
        if ry == 0 {
            if rx == 1 {
                x = !x;
                y = !y;
            }
            std::mem::swap(&mut x, &mut y);
        }
    }
    key
}

/// Nodes along the curve for one of the first pass.
const FIRST_PASS: usize = 8;

/// Every [`FIRST_PASS`]th node along a curve, then back along it the others. They come into triangles between nodes on
/// all sides; at the end of a curve that grows, most triangles are slivers that are flipped again and again.
pub(super) fn in_two_passes(along_curve: &[u32]) -> Vec<u32> {
    let first = along_curve.iter().step_by(FIRST_PASS);
    let others = along_curve
        .chunks(FIRST_PASS)
        .rev()
        .flat_map(|chunk| chunk[1..].iter().rev());
    first.chain(others).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_passes_together_have_each_node_once() {
        for count in [0, 1, 7, 8, 9, 100] {
            let along: Vec<u32> = (0..count).map(|k| (7 * k) % 101).collect();
            let mut order = in_two_passes(&along);
            assert_eq!(order.first(), along.first());
            order.sort_unstable();
            let mut all = along.clone();
            all.sort_unstable();
            assert_eq!(order, all);
        }
    }
}
