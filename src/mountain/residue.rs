//! Pushes that go on behind the next one.
//!
//! A push lasts its years whatever comes after it: when a hand takes hold of a plate whose push is not spent, what that
//! push still does to the ground stays behind as a field of its own until its time is over. So a stranger's short
//! stroke does not undo a grand push, and rubbing raises both sides (an addition to the paper, where a plate has one
//! motion for good).

use std::sync::Arc;

use super::grid::Field;
use super::plate::PlateId;

/// Most residues that are kept; the ones that end first go first.
pub const MAX_RESIDUES: usize = 24;

/// What is left of a push whose plate has gone on to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Residue {
    /// The plate that pushed.
    pub plate: PlateId,
    /// Its share of the uplift, m/yr, on the grid of blocks.
    pub uplift: Arc<Field>,
    /// When the push is spent, years.
    pub expires_yr: f64,
}

impl Residue {
    /// The share of a push in the uplift `with` it: what is gone in the uplift `without`. Only what raised (or sank) the
    /// ground counts, not that other belts move up when one leaves.
    pub fn new(plate: PlateId, with: &Field, without: &Field, expires_yr: f64) -> Self {
        let share = |(&with, &without): (&f32, &f32)| {
            let part = with - without;
            if with > 0.0 {
                part.clamp(0.0, with)
            } else {
                part.clamp(with, 0.0)
            }
        };
        let data = with.data.iter().zip(&without.data).map(share).collect();
        Self {
            plate,
            uplift: Arc::new(Field {
                grid: with.grid,
                data,
            }),
            expires_yr,
        }
    }
}

/// Joins residues to an uplift, as belts that share a place join: in the fourth-power mean, ranges and rifts apart, so
/// that the stronger covers the weaker and the same push twice is a little more than once.
pub(super) fn join<'a>(uplift: &mut Field, residues: impl Iterator<Item = &'a Residue>) {
    let residues: Vec<&Field> = residues
        .map(|residue| &*residue.uplift)
        .filter(|field| field.grid == uplift.grid)
        .collect();
    if residues.is_empty() {
        return;
    }
    for (at, rate) in uplift.data.iter_mut().enumerate() {
        let (mut up, mut down) = (0.0_f64, 0.0_f64);
        for part in residues.iter().map(|field| field.data[at]).chain([*rate]) {
            let fourth = f64::from(part).powi(4);
            if part > 0.0 {
                up += fourth;
            } else {
                down += fourth;
            }
        }
        *rate = (up.sqrt().sqrt() - down.sqrt().sqrt()) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::Grid;
    use super::*;
    use crate::units::Extent;

    fn field(value: f32) -> Field {
        Field::constant(
            Grid::over(
                Extent {
                    width: 64e3,
                    height: 64e3,
                },
                64 * 64,
            ),
            value,
        )
    }

    #[test]
    fn a_share_is_what_the_push_itself_did() {
        let share = |with, without| {
            Residue::new(PlateId(0), &field(with), &field(without), 1.0)
                .uplift
                .data[0]
        };
        assert_eq!(share(3e-4, 1e-4), 3e-4 - 1e-4);
        assert_eq!(share(3e-4, 5e-4), 0.0);
        assert_eq!(share(-2e-4, 0.0), -2e-4);
        assert_eq!(share(-2e-4, 1e-4), -2e-4);
    }

    #[test]
    fn the_same_push_twice_is_a_little_more_than_once() {
        let residue = Residue::new(PlateId(0), &field(8e-4), &field(0.0), 1.0);
        let mut uplift = field(8e-4);
        join(&mut uplift, [&residue].into_iter());
        let ratio = uplift.data[0] / 8e-4;
        assert!((ratio - 2f32.powf(0.25)).abs() < 1e-5, "{ratio}");
        let mut nothing_new = field(0.0);
        join(&mut nothing_new, [&residue].into_iter());
        assert!((nothing_new.data[0] - 8e-4).abs() < 1e-9);
        let mut alone = field(5e-4);
        join(&mut alone, std::iter::empty());
        assert_eq!(alone, field(5e-4));
    }
}
