//! Pushes that go on behind the next one.
//!
//! A push lasts its years whatever comes after it: when a hand takes hold of a plate whose push is not spent, what that
//! push still does to the ground stays behind as a field of its own until its time is over. So a stranger's short
//! stroke does not undo a grand push, and rubbing raises both sides (an addition to the paper, where a plate has one
//! motion for good).

use std::sync::Arc;

use super::fold::FoldDrive;
use super::grid::Field;
use super::plate::PlateId;
use super::tectonics::TectonicField;

/// Most residues that are kept; the ones that end first go first.
pub const MAX_RESIDUES: usize = 24;

/// What is left of a push whose plate has gone on to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Residue {
    /// The plate that pushed.
    pub plate: PlateId,
    /// Its share of the uplift, m/yr, on the grid of blocks.
    pub uplift: Arc<Field>,
    /// The same share of what makes layers fold.
    pub folding: Arc<FoldDrive>,
    /// When the push is spent, years.
    pub expires_yr: f64,
}

impl Residue {
    /// The share of a push in the uplift `with` it: what is gone in the uplift `without`. Only what raised (or sank) the
    /// ground counts, not that other belts move up when one leaves.
    pub fn new(plate: PlateId, with: &TectonicField, without: &TectonicField, expires_yr: f64) -> Self {
        let share = |with: f32, without: f32| {
            let part = with - without;
            if with > 0.0 {
                part.clamp(0.0, with)
            } else {
                part.clamp(with, 0.0)
            }
        };
        let mut folding = with.folding.clone();
        let mut uplift = with.uplift.clone();
        for (at, (rate, without)) in uplift.data.iter_mut().zip(&without.uplift.data).enumerate() {
            let share = share(*rate, *without);
            let part = if *rate > 0.0 { share / *rate } else { 0.0 };
            folding.cos2.data[at] *= part;
            folding.sin2.data[at] *= part;
            *rate = share;
        }
        Self {
            plate,
            uplift: Arc::new(uplift),
            folding: Arc::new(folding),
            expires_yr,
        }
    }
}

/// Joins residues to an uplift, as belts that share a place join: in the fourth-power mean, ranges and rifts apart, so
/// that the stronger covers the weaker and the same push twice is a little more than once. Folds grow as fast as the
/// same mean of theirs, across the mean direction.
pub(super) fn join<'a>(
    uplift: &mut Field,
    folding: &mut FoldDrive,
    residues: impl Iterator<Item = &'a Residue>,
) {
    let residues: Vec<&Residue> = residues
        .filter(|residue| residue.uplift.grid == uplift.grid)
        .collect();
    if residues.is_empty() {
        return;
    }
    for (at, rate) in uplift.data.iter_mut().enumerate() {
        let (mut up, mut down) = (0.0_f64, 0.0_f64);
        for part in residues
            .iter()
            .map(|residue| residue.uplift.data[at])
            .chain([*rate])
        {
            let fourth = f64::from(part).powi(4);
            if part > 0.0 {
                up += fourth;
            } else {
                down += fourth;
            }
        }
        *rate = (up.sqrt().sqrt() - down.sqrt().sqrt()) as f32;

        let (mut x, mut y) = (folding.cos2.data[at], folding.sin2.data[at]);
        let mut fourth = f64::from(x.hypot(y)).powi(4);
        for part in residues.iter().map(|residue| &residue.folding) {
            let (east, north) = (part.cos2.data[at], part.sin2.data[at]);
            x += east;
            y += north;
            fourth += f64::from(east.hypot(north)).powi(4);
            folding.limit.data[at] = folding.limit.data[at].max(part.limit.data[at]);
        }
        let scale = fourth.sqrt().sqrt() as f32 / x.hypot(y).max(f32::MIN_POSITIVE);
        folding.cos2.data[at] = x * scale;
        folding.sin2.data[at] = y * scale;
    }
}

#[cfg(test)]
mod tests {
    use super::super::params::MountainParams;
    use super::*;
    use crate::units::Extent;

    fn field(value: f32) -> TectonicField {
        let land = Extent {
            width: 64e3,
            height: 64e3,
        };
        let params = MountainParams {
            cells: 64 * 64,
            ..MountainParams::default()
        };
        let mut field = TectonicField::still(land, &params);
        field.uplift.data.fill(value);
        field.folding.cos2.data.fill(value / 2.0);
        field
    }

    #[test]
    fn a_share_is_what_the_push_itself_did() {
        let share = |with, without| {
            let residue = Residue::new(PlateId(0), &field(with), &field(without), 1.0);
            (residue.uplift.data[0], residue.folding.cos2.data[0])
        };
        assert_eq!(share(3e-4, 0.0), (3e-4, 1.5e-4));
        assert_eq!(share(3e-4, 5e-4), (0.0, 0.0));
        assert_eq!(share(-2e-4, 0.0).0, -2e-4);
        assert_eq!(share(-2e-4, 1e-4).0, -2e-4);
    }

    #[test]
    fn the_same_push_twice_is_a_little_more_than_once() {
        let residue = Residue::new(PlateId(0), &field(8e-4), &field(0.0), 1.0);
        let joined = |value: f32, residues: &[&Residue]| {
            let mut field = field(value);
            join(&mut field.uplift, &mut field.folding, residues.iter().copied());
            (field.uplift.data[0], field.folding.cos2.data[0])
        };
        let twice = joined(8e-4, &[&residue]);
        for (rate, once) in [(twice.0, 8e-4), (twice.1, 4e-4)] {
            assert!((rate / once - 2f32.powf(0.25)).abs() < 1e-5, "{rate}");
        }
        let nothing_new = joined(0.0, &[&residue]);
        assert!((nothing_new.0 - 8e-4).abs() < 1e-9 && (nothing_new.1 - 4e-4).abs() < 1e-9);
        assert_eq!(joined(5e-4, &[]), (5e-4, 2.5e-4));
    }
}
