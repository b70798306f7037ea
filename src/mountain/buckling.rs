//! What makes layers fold: the uplift where the crust is shortened, and the direction of the shortening.
//!
//! The folding speed is `σ_i |C|` with `σ_i` a part of the uplift (section 5.2). Raw `|C|` is about 0.1 and would make
//! folds nobody sees, so it counts against its 97th percentile where the land rises; the uplift brings its tapers and
//! the mask of the fault. No fold is higher than the shortening `ε = |C|` that is there pays for:
//! `(πA/λ)²/4 ≤ ε/(1 − ε)` (a sine of height `A` is longer than its chord by that part).

use super::compression::CompressionField;
use super::fold::FoldDrive;
use super::grid::{Field, Grid};
use super::params::MountainParams;

/// The percentile of `|C|` that counts as full shortening.
const FULL: f64 = 0.97;

/// Fills `drive` from the `uplift` of belts (m/yr, on the blocks of the compression's grid). `sorted` is scratch.
pub(super) fn fill(
    compression: &CompressionField,
    uplift: &Field,
    params: &MountainParams,
    sorted: &mut Vec<f32>,
    drive: &mut FoldDrive,
) {
    const B: usize = Grid::BLOCK;
    let (blocks, cols) = (uplift.grid, compression.cos2.grid.cols);
    let mean = |field: &Field, col: usize, row: usize| {
        let cell = |r: usize| &field.data[(row * B + r) * cols + col * B..][..B];
        (0..B).map(|r| cell(r).iter().sum::<f32>()).sum::<f32>() / (B * B) as f32
    };
    sorted.clear();
    for row in 0..blocks.rows {
        for col in 0..blocks.cols {
            let at = row * blocks.cols + col;
            let rising = uplift.data[at] > 0.0;
            let (x, y) = if rising {
                (
                    mean(&compression.cos2, col, row),
                    mean(&compression.sin2, col, row),
                )
            } else {
                (0.0, 0.0)
            };
            drive.cos2.data[at] = x;
            drive.sin2.data[at] = y;
            if rising {
                sorted.push(x.hypot(y));
            }
        }
    }
    let full = if sorted.is_empty() {
        0.0
    } else {
        let at = ((sorted.len() - 1) as f64 * FULL) as usize;
        *sorted.select_nth_unstable_by(at, f32::total_cmp).1
    };
    for (at, &rate) in uplift.data.iter().enumerate() {
        let (x, y) = (drive.cos2.data[at], drive.sin2.data[at]);
        let shortening = x.hypot(y);
        let scale = if shortening > 0.0 && full > 0.0 {
            rate.max(0.0) * (1.0 / full).min(1.0 / shortening)
        } else {
            0.0
        };
        drive.cos2.data[at] = x * scale;
        drive.sin2.data[at] = y * scale;
        let paid = f64::from(shortening) / (1.0 - f64::from(shortening)).max(1e-3);
        drive.limit.data[at] = (std::f64::consts::FRAC_2_PI * paid.sqrt() / params.push_years) as f32;
    }
}
