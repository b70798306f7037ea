//! What makes folds at a place.

use glam::DVec2;

use crate::mountain::grid::{Field, Grid};

/// Fold rate below which the ground does not fold, m/yr: five metres in 5 My.
pub const LEAST_RATE: f64 = 1e-6;

/// What makes folds at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Fold rate `u_f`: how fast crests would rise over troughs in a layer that takes all of it, m/yr.
    pub rate: f64,
    /// Direction of compression `e₁`, a unit vector; its sign means nothing.
    pub direction: DVec2,
    /// Greatest rate per metre of wavelength that the shortening allows, 1/yr; ∞ allows all.
    pub limit: f64,
}

impl Drive {
    /// How fast crests rise over troughs in a layer of wavelength `wavelength` (m) that takes the share `c` of the rate,
    /// m/yr: the lesser of `c·u_f` and `λ·limit`, rounded where the two meet and above neither.
    ///
    /// A fold shortens its layer by `(πA/λ)²/4`, so all folds together can be no higher than the shortening `ε` of the
    /// crust pays for, `Σ (πA_i/λ_i)²/4 ≤ ε/(1 − ε)`. The limit is that bound as a rate.
    pub fn amplitude_rate(&self, wavelength: f64, share: f64) -> f64 {
        lesser(share * self.rate, wavelength * self.limit)
    }
}

/// The lesser of two rates, rounded where they meet; 0 unless both are positive.
fn lesser(wanted: f64, most: f64) -> f64 {
    if wanted > 0.0 && most > 0.0 {
        wanted / (1.0 + (wanted / most).powi(4)).powf(0.25)
    } else {
        0.0
    }
}

/// Makes folds everywhere: fields on the coarse grid of blocks.
///
/// Directions are kept as doubled angles, `u_f·(cos 2φ, sin 2φ)` for the azimuth φ of the compression from east: `e₁` and
/// `−e₁` are the same there, so the field can be interpolated. Beyond the land the border's values go on, so that folds do
/// not end at it.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldDrive {
    /// `u_f cos 2φ`, m/yr.
    pub cos2: Field,
    /// `u_f sin 2φ`, m/yr, on the same grid.
    pub sin2: Field,
    /// Greatest rate per metre of wavelength, 1/yr; see [`Drive::limit`].
    pub limit: Field,
}

impl FoldDrive {
    /// Nothing folds.
    pub fn still(grid: Grid) -> Self {
        Self {
            cos2: Field::constant(grid, 0.0),
            sin2: Field::constant(grid, 0.0),
            limit: Field::constant(grid, 0.0),
        }
    }

    /// The drive given at the centre of each cell of `grid`.
    pub fn from_fn(grid: Grid, drive: impl Fn(DVec2) -> Drive) -> Self {
        let mut field = Self::still(grid);
        for row in 0..grid.rows {
            for col in 0..grid.cols {
                let here = drive(grid.centre(col, row));
                let azimuth = here.direction.to_angle();
                let at = row * grid.cols + col;
                field.cos2.data[at] = (here.rate * (2.0 * azimuth).cos()) as f32;
                field.sin2.data[at] = (here.rate * (2.0 * azimuth).sin()) as f32;
                field.limit.data[at] = here.limit as f32;
            }
        }
        field
    }

    /// The same drive everywhere: `rate` in m/yr, compression along `azimuth` (radians from east), no limit.
    pub fn uniform(grid: Grid, rate: f64, azimuth: f64) -> Self {
        Self::from_fn(grid, |_| Drive {
            rate,
            direction: DVec2::from_angle(azimuth),
            limit: f64::INFINITY,
        })
    }

    /// True where it makes nothing fold.
    pub fn is_still(&self) -> bool {
        let still = |field: &Field| field.data.iter().all(|&rate| rate == 0.0);
        still(&self.cos2) && still(&self.sin2)
    }

    /// Adds `years` of another drive on the same grid to a sum of drives, whose rates are metres. Drives that are not
    /// finite add nothing.
    ///
    /// # Panics
    /// If the grids differ.
    pub fn add(&mut self, drive: &Self, years: f64) {
        let fields = [
            (&mut self.cos2, &drive.cos2),
            (&mut self.sin2, &drive.sin2),
            (&mut self.limit, &drive.limit),
        ];
        for (sum, rates) in fields {
            assert_eq!(sum.grid, rates.grid, "one grid");
            for (sum, &rate) in sum.data.iter_mut().zip(&rates.data) {
                let part = (f64::from(rate) * years) as f32;
                if part.is_finite() {
                    *sum += part;
                }
            }
        }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        3 * size_of_val(self.cos2.data.as_slice())
    }

    /// The drive at `p` (plan metres), interpolated.
    pub fn at(&self, p: DVec2) -> Drive {
        let [x, y] = self.doubled(p);
        Drive {
            rate: x.hypot(y),
            direction: DVec2::from_angle(y.atan2(x) / 2.0),
            limit: self.limit.at(p),
        }
    }

    /// [`Drive::amplitude_rate`] of the drive at `p`, without its direction, which costs more than the rest.
    pub fn amplitude_rate_at(&self, p: DVec2, wavelength: f64, share: f64) -> f64 {
        let [x, y] = self.doubled(p);
        if x == 0.0 && y == 0.0 {
            return 0.0;
        }
        lesser(share * x.hypot(y), wavelength * self.limit.at(p))
    }

    /// `u_f·(cos 2φ, sin 2φ)` at `p`.
    pub(super) fn doubled(&self, p: DVec2) -> [f64; 2] {
        let grid = self.cos2.grid;
        let (col, row, fx, fy) = grid.bilinear(p);
        let (east, south) = ((col + 1).min(grid.cols - 1), (row + 1).min(grid.rows - 1));
        let cells = [(col, row), (east, row), (col, south), (east, south)].map(|(c, r)| r * grid.cols + c);
        let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        let value = |field: &Field| (0..4).map(|k| weights[k] * f64::from(field.data[cells[k]])).sum();
        [value(&self.cos2), value(&self.sin2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Extent;

    fn grid() -> Grid {
        let extent = Extent {
            width: 80_000.0,
            height: 50_000.0,
        };
        Grid::over(extent, 40 * 25)
    }

    #[test]
    fn directions_survive_interpolation_across_the_sign() {
        // 170° and −170° are 20° apart, not 340°.
        let drive = FoldDrive::from_fn(grid(), |p| Drive {
            rate: 3e-4,
            direction: DVec2::from_angle(if p.x < 40_000.0 { 170.0_f64 } else { -170.0 }.to_radians()),
            limit: 1.0,
        });
        let between = drive.at(DVec2::new(40_000.0, 20_000.0));
        assert!(between.direction.perp_dot(DVec2::X).abs() < 1e-6 && between.rate > 2.5e-4);
        let beyond = drive.at(DVec2::new(-9_000.0, 99_000.0));
        assert!((beyond.rate - 3e-4).abs() < 1e-9 && beyond.limit == 1.0);
    }

    #[test]
    fn the_lesser_of_rate_and_limit_rules() {
        let drive = |limit| Drive {
            rate: 4e-4,
            direction: DVec2::X,
            limit,
        };
        assert_eq!(drive(f64::INFINITY).amplitude_rate(7_000.0, 0.5), 2e-4);
        assert_eq!(drive(0.0).amplitude_rate(7_000.0, 0.5), 0.0);
        assert_eq!(drive(1.0).amplitude_rate(7_000.0, 0.0), 0.0);
        let bound = drive(1e-9).amplitude_rate(7_000.0, 1.0);
        assert!(bound <= 7e-6 && bound > 6.99e-6);
        let mut last = 0.0;
        for k in 0..100 {
            let limit = 2e-8 * f64::from(k) / 10.0;
            let now = drive(limit).amplitude_rate(7_000.0, 0.5);
            assert!(now >= last && now <= (7_000.0 * limit).min(2e-4));
            last = now;
        }
    }
}
