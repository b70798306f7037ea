//! The compression field C: how much the crust was shortened, and in which direction.
//!
//! With `G = ∇Φ⁻¹` the deformation is `F = G⁻¹` (the printed minus wants `u = Id − Φ⁻¹`; as printed, compression
//! comes out as stretch), and shortening at the points where it is now drawn is read from `V = √(F Fᵀ)`. Since
//! `F Fᵀ = (GᵀG)⁻¹`, its least stretch is `ν₁ = 1/σ₁(G)` along the right singular vector of `G`'s largest singular
//! value. `C = (1 − ν₁) e₁` where `ν₁ < 1`, else 0.

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use super::grid::{Field, Grid};
use super::transport::TransportField;

/// Shortening of a deformation gradient `G = ∇Φ⁻¹` (columns are derivatives towards east and north).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortening {
    /// `1 − ν₁`, 0–1; 0 where nothing is shortened.
    pub strength: f64,
    /// `e₁`, a unit vector; its sign means nothing.
    pub direction: DVec2,
}

impl Shortening {
    /// The closed form for a 2 × 2 gradient.
    pub fn of(gradient: DMat2) -> Self {
        let doubled = doubled(
            gradient.x_axis.x as f32,
            gradient.y_axis.x as f32,
            gradient.x_axis.y as f32,
            gradient.y_axis.y as f32,
        );
        Self::from_doubled(f64::from(doubled.0), f64::from(doubled.1))
    }

    fn from_doubled(x: f64, y: f64) -> Self {
        Self {
            strength: x.hypot(y),
            direction: DVec2::from_angle(y.atan2(x) / 2.0),
        }
    }
}

/// C on the cells of the transport grid, kept as `(1 − ν₁)·(cos 2φ, sin 2φ)` for a direction of azimuth φ from east:
/// `e₁` and `−e₁` are the same there, so the field can be interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct CompressionField {
    /// `(1 − ν₁) cos 2φ`.
    pub cos2: Field,
    /// `(1 − ν₁) sin 2φ`.
    pub sin2: Field,
}

impl CompressionField {
    /// No compression anywhere.
    pub fn none(grid: Grid) -> Self {
        Self {
            cos2: Field::constant(grid, 0.0),
            sin2: Field::constant(grid, 0.0),
        }
    }

    /// Interpolated shortening at `p` (plan metres).
    pub fn at(&self, p: DVec2) -> Shortening {
        Shortening::from_doubled(self.cos2.at(p), self.sin2.at(p))
    }

    /// Fills the field from a transport field.
    pub fn fill(&mut self, transport: &TransportField) {
        let grid = transport.grid;
        if self.cos2.grid != grid {
            *self = Self::none(grid);
        }
        let corners = grid.cols + 1;
        let half_per_cell = (0.5 / grid.cell) as f32;
        self.cos2
            .data
            .par_chunks_mut(grid.cols)
            .zip(self.sin2.data.par_chunks_mut(grid.cols))
            .enumerate()
            .for_each(|(row, (cos2, sin2))| {
                let rows = row * corners..(row + 2) * corners;
                let (east_above, east_below) = transport.east[rows.clone()].split_at(corners);
                let (north_above, north_below) = transport.north[rows].split_at(corners);
                for (i, (cos2, sin2)) in cos2.iter_mut().zip(sin2.iter_mut()).enumerate() {
                    let slope = |above: &[f32], below: &[f32]| {
                        let rising = above[i + 1] - below[i];
                        let falling = above[i] - below[i + 1];
                        (
                            (rising - falling) * half_per_cell,
                            (rising + falling) * half_per_cell,
                        )
                    };
                    let (ux, uy) = slope(east_above, east_below);
                    let (vx, vy) = slope(north_above, north_below);
                    (*cos2, *sin2) = doubled(1.0 + ux, uy, vx, 1.0 + vy);
                }
            });
    }
}

/// `(1 − ν₁)·(cos 2φ, sin 2φ)` of the gradient `[[ux, uy], [vx, vy]]`.
#[inline]
fn doubled(ux: f32, uy: f32, vx: f32, vy: f32) -> (f32, f32) {
    // GᵀG = mean·I + [[difference, cross], [cross, −difference]]; its largest eigenvalue is mean + radius.
    let (a, b, c) = (ux * ux + vx * vx, ux * uy + vx * vy, uy * uy + vy * vy);
    let (mean, difference) = (0.5 * (a + c), 0.5 * (a - c));
    let radius = (difference * difference + b * b).sqrt();
    let strength = (1.0 - 1.0 / (mean + radius).max(1.0).sqrt()).max(0.0);
    let scale = strength / radius.max(1e-30);
    (difference * scale, b * scale)
}
