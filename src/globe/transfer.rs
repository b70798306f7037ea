//! Crust that goes from one plate to another.

use std::collections::BTreeMap;

use super::crust::Crust;
use super::plate::Plate;
use crate::sphere::Lattice;

/// Thickest crust, km: what lies deeper flows.
const THICKEST_KM: f32 = 75.0;

/// What became of crust that changed its plate. Counts are samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Moved {
    /// Continental samples that the plate had.
    pub(super) given: u32,
    /// Continental samples that the other has more.
    pub(super) added: u32,
    /// Continental samples that lie doubled: they were thrust over continental crust and thickened it.
    pub(super) stacked: u32,
}

/// Crust of the slots of `from` that `goes` names, on the samples of `to`: what to add there, in the frame of `to`.
///
/// Each sample of `to` asks for the sample of `from` that lies over it, so that the region keeps its area and has no holes.
/// Continental crust takes the place of oceanic crust; where continents lie over each other the crust is doubled.
pub(super) fn transfer(
    from: &Plate,
    to: &Plate,
    goes: impl Fn(u32) -> bool,
    lattice: &Lattice,
) -> (Vec<(u32, Crust)>, Moved) {
    let turn = to.rotation.inverse() * from.rotation;
    let back = turn.inverse();
    let mut moved = Moved::default();
    let mut added: BTreeMap<u32, Crust> = BTreeMap::new();
    let mut asked = |i: u32, moved: &mut Moved| {
        if added.contains_key(&i) {
            return;
        }
        let Some(slot) = from
            .slot(lattice.nearest(back * lattice.point(i)))
            .filter(|&slot| goes(slot))
        else {
            return;
        };
        let mut crust = from.crust[slot as usize].turned(turn);
        if let Some(below) = to.slot(i).map(|slot| to.crust[slot as usize]) {
            match (crust.continental, below.continental) {
                (true, false) => moved.added += 1,
                (true, true) => {
                    moved.stacked += 1;
                    let thickness = (crust.thickness + below.thickness).min(THICKEST_KM);
                    crust = if crust.z > below.z { crust } else { below };
                    crust.thickness = thickness.max(crust.thickness);
                }
                (false, _) => return,
            }
        } else if crust.continental {
            moved.added += 1;
        }
        added.insert(i, crust);
    };
    for slot in 0..from.len() as u32 {
        if !goes(slot) {
            continue;
        }
        moved.given += u32::from(from.crust[slot as usize].continental);
        let i = lattice.nearest(turn * lattice.point(from.members()[slot as usize]));
        asked(i, &mut moved);
        for &n in lattice.neighbours(i) {
            asked(n, &mut moved);
        }
    }
    (added.into_iter().collect(), moved)
}
