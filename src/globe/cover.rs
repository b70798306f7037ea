//! Which plates lie over which place of the world.

use rayon::prelude::*;

use super::crust::Marks;
use super::plate::Plate;
use crate::sphere::Lattice;

/// Marks a place that no plate covers.
pub(super) const NOBODY: u16 = u16::MAX;

/// Plates that may be seen at one place at once.
const MOST: usize = 4;

/// A plate (index) and one of its slots.
pub(super) type Over = (u16, u32);

/// A place that more than one plate covers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Contest {
    /// The world's sample.
    pub(super) cell: u32,
    /// Plates and the slots there, in order of the plates; the first `count` count.
    covers: [Over; MOST],
    count: u8,
}

impl Contest {
    /// Which of the plates `near` lie over a sample; their slots are near it.
    fn new(cell: u32, near: &[Over], plates: &[Plate], lattice: &Lattice) -> Self {
        let mut contest = Self {
            cell,
            covers: [(NOBODY, 0); MOST],
            count: 0,
        };
        for &(index, guess) in near {
            if let Some(slot) = plates[index as usize].slot_near(lattice.point(cell), guess, lattice) {
                contest.covers[contest.count as usize] = (index, slot);
                contest.count += 1;
            }
        }
        contest
    }

    /// Plates and slots.
    pub(super) fn covers(&self) -> &[Over] {
        &self.covers[..self.count as usize]
    }
}

/// Whose samples fall into which cell of the world.
struct Fallen {
    /// The first plate whose samples do, or [`NOBODY`].
    first: Vec<u16>,
    /// The first of its slots.
    slot: Vec<u32>,
    /// All others: cell, plate and its first slot there, by cell and then by plate.
    more: Vec<(u32, Over)>,
    /// The cells of these.
    several: Marks,
}

impl Fallen {
    fn new(cells: &[Vec<u32>], lattice: &Lattice) -> Self {
        let mut first = vec![NOBODY; lattice.len()];
        let mut slot = vec![0; lattice.len()];
        let mut more = Vec::new();
        for (plate, cells) in cells.iter().enumerate() {
            let plate = plate as u16;
            for (number, &cell) in cells.iter().enumerate() {
                let (number, owner) = (number as u32, &mut first[cell as usize]);
                if *owner == NOBODY {
                    *owner = plate;
                    slot[cell as usize] = number;
                } else if *owner != plate {
                    more.push((cell, (plate, number)));
                }
            }
        }
        more.sort_unstable();
        more.dedup_by_key(|(cell, (plate, _))| (*cell, *plate));
        let several = Marks::new(lattice.len(), more.iter().map(|(cell, _)| *cell));
        Self {
            first,
            slot,
            more,
            several,
        }
    }

    /// True where one plate's samples fall, and no other's here or around.
    fn is_alone(&self, cell: u32, lattice: &Lattice) -> bool {
        let own = self.first[cell as usize];
        let others = |n: &u32| {
            let first = self.first[*n as usize];
            (first == own || first == NOBODY) && !self.several.contains(*n)
        };
        own != NOBODY && !self.several.contains(cell) && lattice.neighbours(cell).iter().all(others)
    }

    /// Plates whose samples fall into a cell.
    fn plates(&self, cell: u32) -> impl Iterator<Item = Over> {
        let first = (self.first[cell as usize], self.slot[cell as usize]);
        let from = if self.several.contains(cell) {
            self.more.partition_point(|more| more.0 < cell)
        } else {
            self.more.len()
        };
        let more = self.more[from..].iter().take_while(move |more| more.0 == cell);
        let all = std::iter::once(first).chain(more.map(|more| more.1));
        all.filter(|over| over.0 != NOBODY)
    }

    /// The plates, at most [`MOST`], whose samples fall into a cell and those around it, in order of the plates.
    fn around(&self, cell: u32, lattice: &Lattice) -> ([Over; MOST], usize) {
        let (mut near, mut count) = ([(NOBODY, 0); MOST], 0);
        let cells = std::iter::once(cell).chain(lattice.neighbours(cell).iter().copied());
        for over in cells.flat_map(|cell| self.plates(cell)) {
            if count < MOST && near[..count].iter().all(|(plate, _)| *plate != over.0) {
                near[count] = over;
                count += 1;
            }
        }
        near[..count].sort_unstable();
        (near, count)
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
    /// Places that were looked at closely, ascending: of two neighbours under different plates, or under none, one is here.
    pub(super) band: Vec<u32>,
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
        let fallen = Fallen::new(&cells, lattice);
        let band: Vec<u32> = (0..lattice.len() as u32)
            .into_par_iter()
            .with_min_len(2048)
            .filter(|&cell| !fallen.is_alone(cell, lattice))
            .collect();
        let asked: Vec<Contest> = band
            .par_iter()
            .with_min_len(512)
            .map(|&cell| {
                let (near, count) = fallen.around(cell, lattice);
                Contest::new(cell, &near[..count], plates, lattice)
            })
            .collect();
        let (mut owner, mut slot) = (fallen.first, fallen.slot);
        let mut contests = Vec::new();
        for contest in asked {
            let first = contest.covers().first().copied();
            (owner[contest.cell as usize], slot[contest.cell as usize]) = first.unwrap_or((NOBODY, 0));
            if contest.count > 1 {
                contests.push(contest);
            }
        }
        Self {
            owner,
            slot,
            contests,
            band,
            cells,
        }
    }

    /// The plate on top of a place that some plate covers, and its slot there.
    pub(super) fn top(&self, cell: u32) -> Over {
        (self.owner[cell as usize], self.slot[cell as usize])
    }

    /// Lets the plate that `upper` names be on top of a contested place.
    pub(super) fn settle(&mut self, upper: impl Fn(&Contest) -> Over + Sync + Send) {
        let contests = self.contests.par_iter().with_min_len(256);
        let tops: Vec<Over> = contests.map(upper).collect();
        for (contest, (owner, slot)) in self.contests.iter().zip(tops) {
            self.owner[contest.cell as usize] = owner;
            self.slot[contest.cell as usize] = slot;
        }
    }
}
