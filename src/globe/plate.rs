//! A plate: a set of samples in a frame that turns, and the crust on them.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::crust::{Crust, Marks, SampleSet};
use crate::sphere::{Lattice, RADIUS_KM};
use crate::surface::planet::Grip;

/// Slots that are looked up one after the other.
const BLOCK: usize = 4096;

/// A plate. Its samples are samples of the one lattice, seen in the plate's own frame: when it moves, only `rotation`
/// changes, and its crust stays as it is, to the bit.
#[derive(Clone, Debug)]
pub(super) struct Plate {
    /// Its name for life.
    pub(super) id: u32,
    /// From its frame to the world's.
    pub(super) rotation: DQuat,
    /// Angular velocity in the world's frame, rad/My.
    pub(super) omega: DVec3,
    /// What a hand does with it.
    pub(super) grip: Grip,
    // What a snapshot shares with its planet until one of them changes it.
    set: Arc<SampleSet>,
    /// Its samples, ascending.
    members: Arc<Vec<u32>>,
    /// Their crust.
    pub(super) crust: Arc<Vec<Crust>>,
    /// A cap in its frame that holds it: centre and the cosine of the radius.
    cap: (DVec3, f64),
}

impl Plate {
    /// A plate on `members`, which ascend.
    pub(super) fn new(
        id: u32,
        rotation: DQuat,
        members: Vec<u32>,
        crust: Vec<Crust>,
        lattice: &Lattice,
    ) -> Self {
        let mut plate = Self {
            id,
            rotation,
            omega: DVec3::ZERO,
            grip: Grip::Free,
            set: Arc::default(),
            members: Arc::default(),
            crust: Arc::default(),
            cap: (DVec3::Z, -1.0),
        };
        plate.replace(members, crust, lattice);
        plate
    }

    fn replace(&mut self, members: Vec<u32>, crust: Vec<Crust>, lattice: &Lattice) {
        debug_assert!(
            members.is_sorted() && members.len() == crust.len(),
            "members ascend"
        );
        self.set = Arc::new(SampleSet::new(lattice.len(), &members));
        let sum: DVec3 = members.iter().map(|&i| lattice.point(i)).sum();
        let centre = sum.try_normalize().unwrap_or(DVec3::Z);
        let least = members
            .iter()
            .map(|&i| lattice.point(i).dot(centre))
            .fold(1.0, f64::min);
        // A cell reaches beyond its sample.
        let radius = least.clamp(-1.0, 1.0).acos() + 1.5 * lattice.spacing();
        self.cap = (centre, radius.min(std::f64::consts::PI).cos());
        self.members = Arc::new(members);
        self.crust = Arc::new(crust);
    }

    /// Its samples, ascending.
    pub(super) fn members(&self) -> &[u32] {
        &self.members
    }

    /// Its samples, and their crust to be changed.
    pub(super) fn members_and_crust(&mut self) -> (&[u32], &mut [Crust]) {
        let crust: &mut Vec<Crust> = Arc::make_mut(&mut self.crust);
        (&self.members, crust)
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.members.len()
    }

    /// True for a sample of its own.
    pub(super) fn contains(&self, i: u32) -> bool {
        self.set.contains(i)
    }

    /// The number of a sample of its own.
    pub(super) fn slot(&self, i: u32) -> Option<u32> {
        self.set.slot(i)
    }

    /// The slot whose cell holds the world point `p`, if the plate reaches there.
    pub(super) fn slot_at(&self, p: DVec3, lattice: &Lattice) -> Option<u32> {
        let local = self.rotation.inverse() * p;
        if local.dot(self.cap.0) < self.cap.1 {
            return None;
        }
        self.slot(lattice.nearest(local))
    }

    /// As [`Self::slot_at`], from a slot that is near.
    pub(super) fn slot_near(&self, p: DVec3, near: u32, lattice: &Lattice) -> Option<u32> {
        let local = self.rotation.inverse() * p;
        self.slot(lattice.nearest_from(local, self.members[near as usize]))
    }

    /// Where a slot is in the world.
    pub(super) fn position(&self, slot: u32, lattice: &Lattice) -> DVec3 {
        self.rotation * lattice.point(self.members[slot as usize])
    }

    /// Velocity at the world point `p`, rad/My.
    pub(super) fn velocity(&self, p: DVec3) -> DVec3 {
        self.omega.cross(p)
    }

    /// Middle of its area in the world's frame.
    pub(super) fn centroid(&self, lattice: &Lattice) -> DVec3 {
        let sum: DVec3 = self.members.iter().map(|&i| lattice.point(i)).sum();
        (self.rotation * sum).try_normalize().unwrap_or(DVec3::Z)
    }

    /// Its area, km².
    pub(super) fn area_km2(&self, lattice: &Lattice) -> f64 {
        self.members
            .iter()
            .map(|&i| lattice.areas()[i as usize])
            .sum::<f64>()
            * RADIUS_KM
            * RADIUS_KM
    }

    /// Share of its samples that is continental.
    pub(super) fn continental_share(&self) -> f64 {
        let continental = self.crust.iter().filter(|crust| crust.continental).count();
        continental as f64 / self.len().max(1) as f64
    }

    /// Moves on for `my`.
    pub(super) fn turn(&mut self, my: f64) {
        self.rotation = (DQuat::from_scaled_axis(self.omega * my) * self.rotation).normalize();
    }

    /// Takes samples away (`gone` says for each slot) and adds others; where an added one is there already it replaces it.
    pub(super) fn change(
        &mut self,
        gone: impl Fn(u32) -> bool,
        mut added: Vec<(u32, Crust)>,
        lattice: &Lattice,
    ) {
        added.sort_by_key(|(i, _)| *i);
        added.dedup_by_key(|(i, _)| *i);
        let mut members = Vec::with_capacity(self.len() + added.len());
        let mut crust = Vec::with_capacity(self.len() + added.len());
        let mut news = added.into_iter().peekable();
        for (slot, &i) in self.members.iter().enumerate() {
            while let Some((new, new_crust)) = news.next_if(|(new, _)| *new < i) {
                members.push(new);
                crust.push(new_crust);
            }
            if let Some((new, new_crust)) = news.next_if(|(new, _)| *new == i) {
                members.push(new);
                crust.push(new_crust);
            } else if !gone(slot as u32) {
                members.push(i);
                crust.push(self.crust[slot]);
            }
        }
        for (new, new_crust) in news {
            members.push(new);
            crust.push(new_crust);
        }
        self.replace(members, crust, lattice);
    }

    /// Connected regions among the slots that `belongs` names: for each slot the number of its region, and the slots' count
    /// of each; slots outside get `u32::MAX`. Regions are numbered in the order of their first slot.
    pub(super) fn regions(&self, lattice: &Lattice, belongs: impl Fn(u32) -> bool) -> (Vec<u32>, Vec<u32>) {
        let mut region = vec![u32::MAX; self.len()];
        let mut sizes = Vec::new();
        let mut open = Vec::new();
        // Those that no region has yet.
        let mut left = Marks::new(lattice.len(), self.samples_where(belongs));
        for (start, &i) in self.members.iter().enumerate() {
            if !left.remove(i) {
                continue;
            }
            let number = sizes.len() as u32;
            let mut size = 0;
            region[start] = number;
            open.push(i);
            while let Some(i) = open.pop() {
                size += 1;
                for &n in lattice.neighbours(i) {
                    if left.remove(n)
                        && let Some(slot) = self.slot(n)
                    {
                        region[slot as usize] = number;
                        open.push(n);
                    }
                }
            }
            sizes.push(size);
        }
        (region, sizes)
    }

    /// The samples of the slots that `belongs` names.
    pub(super) fn samples_where(&self, belongs: impl Fn(u32) -> bool) -> impl Iterator<Item = u32> {
        let slots = (0..).zip(self.members.iter());
        slots.filter(move |&(slot, _)| belongs(slot)).map(|(_, &i)| i)
    }

    /// The world's sample whose cell holds each of the plate's samples.
    pub(super) fn cells(&self, lattice: &Lattice) -> Vec<u32> {
        let mut cells = vec![0; self.len()];
        let blocks = cells.par_chunks_mut(BLOCK).enumerate();
        blocks.for_each(|(block, cells)| {
            let first = block * BLOCK;
            for k in 0..cells.len() {
                let i = self.members[first + k];
                let p = self.rotation * lattice.point(i);
                // Neighbours fall side by side. (Those before it in the block are known.)
                let before = lattice.neighbours(i).iter().filter(|&&n| n < i);
                let known = before
                    .filter_map(|&n| self.slot(n))
                    .find(|&slot| slot as usize >= first);
                cells[k] = match known {
                    Some(slot) => lattice.nearest_from(p, cells[slot as usize - first]),
                    None => lattice.nearest(p),
                };
            }
        });
        cells
    }
}
