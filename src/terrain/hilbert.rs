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
