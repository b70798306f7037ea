//! Plates that are led while a step is under way.

use glam::{DQuat, DVec3};

use super::planet::Planet;

impl Planet {
    /// As [`Planet::lead`], when `ahead_my` of the step are over: the plate goes on from where it is shown at this moment
    /// ([`Planet::surface`]), so that however often it is led anew it neither jumps nor is faster than plates move.
    pub fn steer(&mut self, id: u32, omega: DVec3, ahead_my: f64) -> bool {
        let ahead_my = ahead_my.clamp(0.0, self.params.dt_my);
        let before = self.plate_state(id);
        let clamped = self.lead(id, omega);
        let after = self.plate_state(id);
        if let (Some((_, before, _)), Some((_, after, _))) = (before, after)
            && let Some(plate) = self.plates.iter_mut().find(|plate| plate.id == id)
        {
            let shown = DQuat::from_scaled_axis(before * ahead_my) * plate.rotation;
            plate.rotation = (DQuat::from_scaled_axis(-after * ahead_my) * shown).normalize();
        }
        clamped
    }
}
