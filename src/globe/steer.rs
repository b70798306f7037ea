//! What a planet is told from outside: which plate is meant, where it goes, where it tears, where there is land.

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::crust::Crust;
use super::params::gdh1_km;
use super::planet::Planet;
use super::plate::Plate;
use super::rift::{Cut, RiftError};
use crate::sphere::RADIUS_KM;
use crate::surface::planet::Grip;

impl Planet {
    fn index_of(&self, id: u32) -> Option<usize> {
        self.plates.iter().position(|plate| plate.id == id)
    }

    /// Names of the plates.
    pub fn plate_ids(&self) -> impl Iterator<Item = u32> {
        self.plates.iter().map(|plate| plate.id)
    }

    /// The plate on top at a direction, by its name.
    pub fn plate_at(&self, p: DVec3) -> u32 {
        let mut best: Option<(u16, u32)> = None;
        let cell = self.lattice.nearest(p);
        for (index, plate) in self.plates.iter().enumerate() {
            let Some(slot) = plate.slot_at(p, &self.lattice) else {
                continue;
            };
            let next = (index as u16, slot);
            let wins = best.is_none_or(|best| {
                let at = self.lattice.point(cell);
                self.polarities
                    .first_is_upper(&self.plates, [next, best], at, &self.coarse)
            });
            if wins {
                best = Some(next);
            }
        }
        // In a gap the plate whose crust is nearest.
        let index = best.map_or_else(|| self.nearest_plate(p), |(index, _)| index as usize);
        self.plates[index].id
    }

    fn nearest_plate(&self, p: DVec3) -> usize {
        let distance = |plate: &Plate| {
            let local = plate.rotation.inverse() * p;
            let points = plate.members().iter().map(|&i| self.lattice.point(i).dot(local));
            points.fold(f64::NEG_INFINITY, f64::max)
        };
        let mut best = (0, f64::NEG_INFINITY);
        for (index, plate) in self.plates.iter().enumerate() {
            let near = distance(plate);
            if near > best.1 {
                best = (index, near);
            }
        }
        best.0
    }

    /// Leads a plate: from now on it turns with `omega`, rad/My, until it is let go. True where that was faster than plates
    /// move and was held to [`GlobeParams::max_speed`](super::GlobeParams::max_speed). A plate that there is not is no matter.
    pub fn lead(&mut self, id: u32, omega: DVec3) -> bool {
        let fastest = self.params.max_speed / RADIUS_KM;
        let Some(index) = self.index_of(id) else {
            return false;
        };
        if !omega.is_finite() {
            self.totals.quarantined += 1;
            return false;
        }
        let plate = &mut self.plates[index];
        plate.grip = Grip::Led;
        plate.omega = omega.clamp_length_max(fastest);
        let clamped = omega.length() > fastest * (1.0 + 1e-9);
        self.totals.clamped += u64::from(clamped);
        clamped
    }

    /// Holds a plate where it is until it is let go.
    pub fn anchor(&mut self, id: u32) {
        if let Some(index) = self.index_of(id) {
            self.plates[index].grip = Grip::Anchored;
            self.plates[index].omega = DVec3::ZERO;
        }
    }

    /// Lets a plate go: it keeps its motion, and slabs and chance work on it again.
    pub fn release(&mut self, id: u32) {
        if let Some(index) = self.index_of(id) {
            self.plates[index].grip = Grip::Free;
        }
    }

    /// Tears a plate. The parts' names come back; the first keeps the plate's.
    ///
    /// # Errors
    /// When there is no such plate, or the parts would be too small: see [`RiftError`].
    pub fn rift(&mut self, id: u32, cut: &Cut) -> Result<Vec<u32>, RiftError> {
        let index = self.index_of(id).ok_or(RiftError::NoPlate(id))?;
        self.tear(index, cut)
    }

    /// Makes crust within `radius` (radians) of a direction continental or oceanic.
    pub fn paint(&mut self, at: DVec3, radius: f64, continental: bool) {
        let reach = radius.clamp(0.0, std::f64::consts::PI).cos();
        let (lattice, noise) = (&self.lattice, &self.noise);
        self.plates.par_iter_mut().for_each(|plate| {
            let back = plate.rotation.inverse() * at;
            let (members, crust) = plate.members_and_crust();
            for (&i, crust) in members.iter().zip(crust) {
                if lattice.point(i).dot(back) < reach || crust.continental == continental {
                    continue;
                }
                *crust = if continental {
                    Crust::continental(0.3 + 0.15 * noise[i as usize])
                } else {
                    Crust::oceanic(-gdh1_km(40.0) as f32, 40.0)
                };
            }
        });
    }

    /// Tells a plate's rotation, angular velocity and area (km²), for those who measure.
    pub fn plate_state(&self, id: u32) -> Option<(DQuat, DVec3, f64)> {
        let plate = &self.plates[self.index_of(id)?];
        Some((plate.rotation, plate.omega, plate.area_km2(&self.lattice)))
    }

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
