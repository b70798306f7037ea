//! Which plates lie over which place of the world.

use rayon::prelude::*;

use super::plate::Plate;
use crate::sphere::Lattice;

/// Marks a place that no plate covers.
pub(super) const NOBODY: u16 = u16::MAX;

/// Plates that may be seen at one place at once.
const MOST: usize = 4;

/// A place that more than one plate covers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Contest {
    /// The world's sample.
    pub(super) cell: u32,
    /// Plates (index) and the slots there, in order of the plates; the first `count` count.
    covers: [(u16, u32); MOST],
    count: u8,
}

impl Contest {
    /// Which of the plates `near` (up to the first [`NOBODY`]) lie over a sample.
    fn new(cell: u32, near: [u16; MOST], plates: &[Plate], lattice: &Lattice) -> Self {
        let mut contest = Self {
            cell,
            covers: [(NOBODY, 0); MOST],
            count: 0,
        };
        for &plate in near.iter().take_while(|p| **p != NOBODY) {
            if let Some(slot) = plates[plate as usize].slot_at(lattice.point(cell), lattice) {
                contest.covers[contest.count as usize] = (plate, slot);
                contest.count += 1;
            }
        }
        contest
    }

    /// Plates and slots.
    pub(super) fn covers(&self) -> &[(u16, u32)] {
        &self.covers[..self.count as usize]
    }
}

/// The world's samples and the plates above them.
#[derive(Clone, Debug, Default)]
pub(super) struct Cover {
    /// Plate on top (index), or [`NOBODY`].
    pub(super) owner: Vec<u16>,
    /// Its slot there.
    pub(super) slot: Vec<u32>,
    /// Places with several plates, ascending.
    pub(super) contests: Vec<Contest>,
    /// For each plate and slot the world's sample that holds it.
    pub(super) cells: Vec<Vec<u32>>,
}

impl Cover {
    /// The cover of `plates` where they are.
    ///
    /// Each plate's samples fall into cells of the world; where only one plate's fall, and around, it is alone. Everywhere
    /// else the plates in question are asked by the inverse look-up, which finds also the cells between samples.
    pub(super) fn new(plates: &[Plate], lattice: &Lattice) -> Self {
        let cells: Vec<Vec<u32>> = plates.par_iter().map(|plate| plate.cells(lattice)).collect();
        let samples = lattice.len();
        let mut seen = vec![[NOBODY; MOST]; samples];
        let mut hit = vec![0_u32; samples];
        for (plate, cells) in cells.iter().enumerate() {
            let plate = plate as u16;
            for (slot, &cell) in cells.iter().enumerate() {
                let here = &mut seen[cell as usize];
                if here.contains(&plate) {
                    continue;
                }
                if let Some(free) = here.iter_mut().find(|p| **p == NOBODY) {
                    *free = plate;
                    if here[1] == NOBODY {
                        hit[cell as usize] = slot as u32;
                    }
                }
            }
        }
        let alone = |cell: u32| {
            let here = seen[cell as usize];
            let own = here[0];
            let around = lattice.neighbours(cell).iter().flat_map(|&n| &seen[n as usize]);
            let mut others = here[1..].iter().chain(around);
            own != NOBODY && others.all(|&plate| plate == own || plate == NOBODY)
        };
        let (mut owner, mut slot) = (vec![NOBODY; samples], hit);
        owner
            .par_iter_mut()
            .enumerate()
            .with_min_len(2048)
            .for_each(|(cell, owner)| {
                if alone(cell as u32) {
                    *owner = seen[cell][0];
                }
            });
        let unclear: Vec<u32> = (0..samples as u32)
            .filter(|&cell| owner[cell as usize] == NOBODY)
            .collect();
        let asked: Vec<Contest> = unclear
            .into_par_iter()
            .with_min_len(512)
            .map(|cell| {
                let mut near = seen[cell as usize];
                for &n in lattice.neighbours(cell) {
                    for &plate in seen[n as usize].iter().take_while(|p| **p != NOBODY) {
                        if !near.contains(&plate)
                            && let Some(free) = near.iter_mut().find(|p| **p == NOBODY)
                        {
                            *free = plate;
                        }
                    }
                }
                near.sort_unstable();
                Contest::new(cell, near, plates, lattice)
            })
            .collect();
        let mut contests = Vec::new();
        for contest in asked {
            if let Some(&first) = contest.covers().first() {
                (owner[contest.cell as usize], slot[contest.cell as usize]) = first;
            }
            if contest.count > 1 {
                contests.push(contest);
            }
        }
        Self {
            owner,
            slot,
            contests,
            cells,
        }
    }

    /// Lets the plate that `upper` names be on top of a contested place.
    pub(super) fn settle(&mut self, upper: impl Fn(&Contest) -> (u16, u32)) {
        for contest in &self.contests {
            let (owner, slot) = upper(contest);
            self.owner[contest.cell as usize] = owner;
            self.slot[contest.cell as usize] = slot;
        }
    }
}
