//! Where plates meet: who closes on whom, and which of the two is on top.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::cover::{Cover, NOBODY, Over};
use super::crust::{Crust, Marks};
use super::params::GlobeParams;
use super::plate::Plate;
use super::terranes::Terranes;
use crate::sphere::{Lattice, RADIUS_KM};

/// Samples of the coarse lattice that divides borders into segments, some 770 km long.
pub(super) const SEGMENTS: usize = 1_000;
/// Segments that nobody has seen for so long are forgotten, My.
const MEMORY_MY: f64 = 40.0;
/// Share of continent at which a side of a segment counts as continental, and how much more or less it must be to turn a
/// front around.
const CONTINENT: f64 = 0.5;
const CONTINENT_MARGIN: f64 = 0.15;

/// Two neighbouring samples of the world under different plates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// The samples, the lower one first.
    pub(super) cells: [u32; 2],
    /// How fast they close, mm/yr; negative where they part.
    pub(super) closing: f64,
    /// How fast they slide past each other, mm/yr.
    pub(super) sliding: f64,
}

impl Meeting {
    /// Middle between the two samples.
    pub(super) fn at(&self, lattice: &Lattice) -> DVec3 {
        (lattice.point(self.cells[0]) + lattice.point(self.cells[1])).normalize()
    }
}

/// All meetings, in order of their samples.
///
/// Cells are corners and edges; the border that plates feel is smooth. Across the border is therefore where the cells
/// around look on average.
pub(super) fn meetings(cover: &Cover, plates: &[Plate], lattice: &Lattice) -> Vec<Meeting> {
    let owner = |cell: u32| cover.owner[cell as usize];
    let others = |cell: u32| {
        let own = owner(cell);
        let around = lattice.neighbours(cell).iter().copied();
        around.filter(move |&n| own != NOBODY && owner(n) != NOBODY && owner(n) != own)
    };
    let outward = |a: u32| -> DVec3 { others(a).map(|b| lattice.point(b) - lattice.point(a)).sum() };
    let looks = |cell: u32| -> DVec3 {
        let around = lattice.neighbours(cell).iter().copied();
        let same = around.filter(|&n| owner(n) == owner(cell));
        outward(cell) + same.map(outward).sum::<DVec3>()
    };
    let near = cover.band.iter().flat_map(|&cell| lattice.neighbours(cell));
    let near = Marks::new(lattice.len(), near.chain(&cover.band).copied());
    let near: Vec<u32> = near.iter().filter(|&a| others(a).next().is_some()).collect();
    near.into_par_iter()
        .with_min_len(256)
        .flat_map_iter(|a| {
            others(a).filter(move |&b| b > a).map(move |b| {
                let middle = (lattice.point(a) + lattice.point(b)).normalize();
                let across = looks(a) - looks(b);
                let across = (across - middle * across.dot(middle))
                    .try_normalize()
                    .unwrap_or(DVec3::ZERO);
                let [first, second] = [a, b].map(|cell| plates[owner(cell) as usize].velocity(middle));
                let relative = (first - second) * RADIUS_KM;
                Meeting {
                    cells: [a, b],
                    closing: relative.dot(across),
                    sliding: relative.dot(across.cross(middle)).abs(),
                }
            })
        })
        .collect()
}

/// A piece of the border of two plates: their ids, the lower one first, and a place in the frame of the first.
type Segment = (u32, u32, u32);

/// Which plate of a segment is on top, and since when.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Polarity {
    first_is_upper: bool,
    since_my: f64,
    seen_my: f64,
}

/// Who plunges under whom, with memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Polarities {
    known: BTreeMap<Segment, Polarity>,
    /// Times that a front turned around.
    pub(super) flips: u64,
}

/// What lies along a segment: samples, continental ones among them, and ages of the others; first plate, second plate.
#[derive(Clone, Copy, Debug, Default)]
struct Votes {
    samples: [f64; 2],
    continental: [f64; 2],
    age: [f64; 2],
}

impl Votes {
    fn add(&mut self, other: &Self, weight: f64) {
        for side in 0..2 {
            self.samples[side] += weight * other.samples[side];
            self.continental[side] += weight * other.continental[side];
            self.age[side] += weight * other.age[side];
        }
    }

    fn cast(&mut self, side: usize, crust: &Crust, is_land: bool) {
        self.samples[side] += 1.0;
        if is_land {
            self.continental[side] += 1.0;
        } else {
            self.age[side] += f64::from(crust.age);
        }
    }

    fn continent(&self, side: usize) -> f64 {
        self.continental[side] / self.samples[side].max(1e-9)
    }

    fn age(&self, side: usize) -> f64 {
        self.age[side] / (self.samples[side] - self.continental[side]).max(1e-9)
    }
}

/// What polarity is decided from.
pub(super) struct Strip<'a> {
    pub(super) plates: &'a [Plate],
    pub(super) cover: &'a Cover,
    pub(super) terranes: &'a [Terranes],
    pub(super) lattice: &'a Lattice,
    pub(super) coarse: &'a Lattice,
    pub(super) params: &'a GlobeParams,
}

impl Polarities {
    /// Decides for all segments that close. Continents stay on top of oceans; between oceans the younger side does; a front
    /// that exists turns around only where that is clear, and not soon.
    pub(super) fn decide(&mut self, strip: &Strip<'_>, meetings: &[Meeting], now_my: f64) {
        let closing: Vec<(Segment, bool, [Over; 2])> = meetings
            .par_iter()
            .with_min_len(256)
            .filter(|meeting| meeting.closing > strip.params.least_closing)
            .map(|meeting| {
                let covers = meeting.cells.map(|cell| strip.cover.top(cell));
                let (pair, at) = (covers.map(|cover| cover.0), meeting.at(strip.lattice));
                let (segment, swapped) = segment(strip.plates, pair, at, strip.coarse);
                (segment, swapped, covers)
            })
            .collect();
        let mut votes: BTreeMap<Segment, Votes> = BTreeMap::new();
        for (segment, swapped, covers) in closing {
            let vote = votes.entry(segment).or_default();
            for (k, (plate, slot)) in covers.into_iter().enumerate() {
                let crust = &strip.plates[plate as usize].crust[slot as usize];
                let is_land = crust.continental
                    && strip.terranes[plate as usize].area_mkm2(slot) >= strip.params.terrane_mkm2;
                vote.cast(if swapped { 1 - k } else { k }, crust, is_land);
            }
        }
        let sizes: Vec<usize> = strip.plates.iter().map(Plate::len).collect();
        let size_of = |id: u32| {
            let index = strip.plates.iter().position(|plate| plate.id == id);
            index.map_or(0, |index| sizes[index])
        };
        let mut decided = Vec::new();
        for (&segment, own) in &votes {
            let mut all = *own;
            let mut neighbours = [0_u32; 2];
            for &k in strip.coarse.neighbours(segment.2) {
                let near = (segment.0, segment.1, k);
                if let Some(vote) = votes.get(&near) {
                    all.add(vote, 0.5);
                }
                if let Some(polarity) = self.known.get(&near) {
                    neighbours[usize::from(!polarity.first_is_upper)] += 1;
                }
            }
            let inherited = (neighbours[0] != neighbours[1]).then(|| Polarity {
                first_is_upper: neighbours[0] > neighbours[1],
                since_my: now_my,
                seen_my: now_my,
            });
            let before = self.known.get(&segment).copied().or(inherited);
            let first_is_larger = size_of(segment.0) >= size_of(segment.1);
            let now = polarity(&all, before, first_is_larger, strip.params, now_my);
            if before.is_some_and(|before| before.first_is_upper != now.first_is_upper) {
                self.flips += 1;
            }
            decided.push((segment, now));
        }
        self.known.extend(decided);
        self.known
            .retain(|_, polarity| now_my - polarity.seen_my <= MEMORY_MY);
    }

    /// True where the first of two plates is on top of the second at the world point `at`.
    pub(super) fn first_is_upper(
        &self,
        plates: &[Plate],
        covers: [(u16, u32); 2],
        at: DVec3,
        coarse: &Lattice,
    ) -> bool {
        let (segment, swapped) = segment(plates, [covers[0].0, covers[1].0], at, coarse);
        let near = coarse
            .neighbours(segment.2)
            .iter()
            .filter_map(|&k| self.known.get(&(segment.0, segment.1, k)));
        let known = self.known.get(&segment).or_else(|| near.into_iter().next());
        if let Some(polarity) = known {
            return polarity.first_is_upper != swapped;
        }
        let [a, b] = covers.map(|(plate, slot)| &plates[plate as usize].crust[slot as usize]);
        if a.continental == b.continental {
            a.age < b.age || a.age == b.age && !swapped
        } else {
            a.continental
        }
    }

    /// Puts a plate on top of another around `at`: an ocean gives way to a continent that has come.
    pub(super) fn force(
        &mut self,
        plates: &[Plate],
        upper: u16,
        lower: u16,
        at: DVec3,
        coarse: &Lattice,
        now_my: f64,
    ) {
        let (segment, swapped) = segment(plates, [upper, lower], at, coarse);
        let now = Polarity {
            first_is_upper: !swapped,
            since_my: now_my,
            seen_my: now_my,
        };
        let before = self.known.insert(segment, now);
        if before.is_some_and(|before| before.first_is_upper != now.first_is_upper) {
            self.flips += 1;
        }
    }
}

/// The segment of the border of two plates at `at`, and whether its first plate is the second of the two.
fn segment(plates: &[Plate], pair: [u16; 2], at: DVec3, coarse: &Lattice) -> (Segment, bool) {
    let [a, b] = pair.map(|index| &plates[index as usize]);
    let swapped = b.id < a.id;
    let (first, second) = if swapped { (b, a) } else { (a, b) };
    let place = coarse.nearest(first.rotation.inverse() * at);
    ((first.id, second.id, place), swapped)
}

fn polarity(
    votes: &Votes,
    before: Option<Polarity>,
    first_is_larger: bool,
    params: &GlobeParams,
    now_my: f64,
) -> Polarity {
    let land = [votes.continent(0), votes.continent(1)];
    // How much more of a continent the first side is, where one is and the other is not.
    let is_land = land.map(|share| share >= CONTINENT);
    let younger = votes.age(1) - votes.age(0);
    let Some(before) = before else {
        let first_is_upper = match is_land {
            [true, false] => true,
            [false, true] => false,
            [false, false] => younger > 0.0,
            [true, true] => first_is_larger,
        };
        return Polarity {
            first_is_upper,
            since_my: now_my,
            seen_my: now_my,
        };
    };
    let (upper, lower) = if before.first_is_upper { (0, 1) } else { (1, 0) };
    let ocean_under_which =
        land[upper] < CONTINENT - CONTINENT_MARGIN && land[lower] > CONTINENT + CONTINENT_MARGIN;
    let both_oceanic = !is_land[0] && !is_land[1];
    let upper_is_older = votes.age(upper) - votes.age(lower) > params.polarity_age_my;
    let held = now_my - before.since_my >= params.polarity_my;
    if ocean_under_which || (both_oceanic && upper_is_older && held) {
        return Polarity {
            first_is_upper: !before.first_is_upper,
            since_my: now_my,
            seen_my: now_my,
        };
    }
    Polarity {
        seen_my: now_my,
        ..before
    }
}
