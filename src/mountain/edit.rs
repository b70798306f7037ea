//! Editing standing plates: the operations behind the edit tool and the `do` vocabulary.

use glam::DVec2;

use super::params::MountainParams;
use super::plate::{FaultSide, Pair, PlateId, PlateSet};
use crate::gesture::rigid::RigidFit;

impl PlateSet {
    /// The plate whose moved support holds `p` (plan metres), the youngest first.
    pub fn plate_at(&self, p: DVec2) -> Option<PlateId> {
        self.plates()
            .iter()
            .rev()
            .find(|plate| plate.moved_support().contains(p) || plate.support.contains(p))
            .map(|plate| plate.id)
    }

    /// Removes the plate at `p`.
    pub fn remove_at(&mut self, p: DVec2, now_yr: f64, params: &MountainParams) -> Option<PlateId> {
        let id = self.plate_at(p)?;
        self.forget(id);
        self.settle(now_yr, params);
        Some(id)
    }

    /// Adds an arrow to the plate at its foot: the plate's motion is refitted to all its arrows, and its push
    /// starts anew.
    pub fn add_arrow(
        &mut self,
        from: DVec2,
        to: DVec2,
        now_yr: f64,
        params: &MountainParams,
    ) -> Option<PlateId> {
        let id = self.plate_at(from)?;
        self.refit(id, now_yr, params, |starts, tips| {
            starts.push(from);
            tips.push(to);
        })
    }

    /// Drags the arrow tip nearest to `from` (within `reach` metres) to `to` and refits its plate.
    pub fn drag_tip(
        &mut self,
        from: DVec2,
        to: DVec2,
        reach: f64,
        now_yr: f64,
        params: &MountainParams,
    ) -> Option<PlateId> {
        let mut best: Option<(f64, PlateId, usize)> = None;
        for plate in self.plates() {
            for (index, (_, tip)) in plate.arrows().enumerate() {
                let distance = tip.distance(from);
                if distance <= reach && best.is_none_or(|b| distance < b.0) {
                    best = Some((distance, plate.id, index));
                }
            }
        }
        let (_, id, index) = best?;
        self.refit(id, now_yr, params, |_, tips| tips[index] = to)
    }

    /// Puts the fault of a pair on its other side (see `TectonicField::fault_near` for which one was tapped).
    pub fn flip_fault(&mut self, pair: Pair) {
        let flipped = match self.fault_side(pair) {
            FaultSide::First => FaultSide::Second,
            FaultSide::Second => FaultSide::First,
        };
        self.sides.insert(pair, flipped);
    }

    fn refit(
        &mut self,
        id: PlateId,
        now_yr: f64,
        params: &MountainParams,
        change: impl FnOnce(&mut Vec<DVec2>, &mut Vec<DVec2>),
    ) -> Option<PlateId> {
        let plate = self.plates.iter_mut().find(|p| p.id == id)?;
        // Tips as drawn, that is after the cap: what is not touched stays where it is seen.
        let mut tips: Vec<DVec2> = plate.arrows().map(|(_, tip)| tip).collect();
        change(&mut plate.starts, &mut tips);
        plate.fit = RigidFit::fit(&plate.starts, &tips);
        plate.motion = plate.fit.motion;
        plate.begun_yr = now_yr;
        plate.expires_yr = now_yr + params.push_years;
        self.settle(now_yr, params);
        Some(id)
    }
}
