//! New sea floor between plates that part (section 4.3).

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::cover::{Cover, NOBODY};
use super::crust::Crust;
use super::distance::{Nearest, Numbers};
use super::params::{GlobeParams, SeaFloor, gdh1_km};
use super::plate::Plate;
use crate::sphere::{Lattice, RADIUS_KM, arc};

/// Plates that part more slowly than this leave no gap: what opens is the lattice's own unevenness, mm/yr.
const LEAST_OPENING: f64 = 2.0;
/// The same where continents have been torn, mm/yr.
const LEAST_OPENING_ON_LAND: f64 = 6.0;
/// Height of the low swell of new sea floor, km.
const SWELL_KM: f64 = 0.12;

/// A place that no plate covers, and what will be there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// The world's sample.
    pub(super) cell: u32,
    /// The plate (index) that it falls to.
    pub(super) plate: u16,
    /// A slot of that plate near by.
    pub(super) slot: u32,
    /// Its crust, in the world's frame.
    pub(super) crust: Crust,
    /// True where it is new, false where crust is only drawn out.
    pub(super) is_new: bool,
}

/// All gaps and what will fill them. `since_my` is how long ago they were filled last.
pub(super) fn gaps(
    cover: &Cover,
    plates: &[Plate],
    noise: &[f32],
    lattice: &Lattice,
    since_my: f64,
    params: &GlobeParams,
) -> Vec<Gap> {
    let open = Open::new(cover, plates, lattice);
    let cells = open.cells.iter();
    cells
        .filter_map(|&cell| open.gap(cell, noise, since_my, params))
        .collect()
}

/// The places that no plate covers: the edges of plates around them, and the ridges between those.
struct Open<'a> {
    cover: &'a Cover,
    plates: &'a [Plate],
    lattice: &'a Lattice,
    cells: Vec<u32>,
    /// Covered samples at the edges, and where their crust is.
    edge: Vec<(u32, DVec3)>,
    to_edge: Nearest,
    /// Open samples where the nearest plate changes, and the middle between them and what is beyond.
    ridge: Vec<(u32, DVec3)>,
    to_ridge: Nearest,
    /// What is beyond each of them.
    beyond: Vec<u32>,
}

impl<'a> Open<'a> {
    fn new(cover: &'a Cover, plates: &'a [Plate], lattice: &'a Lattice) -> Self {
        let is_open = |cell: u32| cover.owner[cell as usize] == NOBODY;
        let cells: Vec<u32> = cover.band.iter().copied().filter(|&cell| is_open(cell)).collect();
        let mut edge = Vec::new();
        for &cell in &cells {
            for &n in lattice.neighbours(cell) {
                let owner = cover.owner[n as usize];
                if owner != NOBODY {
                    edge.push((
                        n,
                        plates[owner as usize].position(cover.slot[n as usize], lattice),
                    ));
                }
            }
        }
        let everywhere = std::f64::consts::PI;
        let to_edge = Nearest::new(lattice, &edge, everywhere, |_, cell| is_open(cell));
        let mut open = Self {
            cover,
            plates,
            lattice,
            cells,
            edge,
            to_edge,
            ridge: Vec::new(),
            to_ridge: Nearest::new(lattice, &[], everywhere, |_, _| false),
            beyond: Vec::new(),
        };
        for &cell in &open.cells {
            let plate = open.plate(cell);
            let is_other = |&n: &u32| ![plate, NOBODY].contains(&open.plate(n));
            if let Some(other) = lattice.neighbours(cell).iter().copied().find(is_other) {
                let middle = (lattice.point(cell) + lattice.point(other)).normalize();
                open.ridge.push((cell, middle));
                open.beyond.push(other);
            }
        }
        open.to_ridge = Nearest::new(lattice, &open.ridge, everywhere, |_, cell| is_open(cell));
        open
    }

    /// The covered sample whose crust is nearest: itself, or at an edge; and where that crust is.
    fn nearest_edge(&self, cell: u32) -> Option<(u32, DVec3)> {
        match self.cover.owner[cell as usize] {
            NOBODY => self.to_edge.source(cell).map(|source| self.edge[source as usize]),
            owner => {
                let slot = self.cover.slot[cell as usize];
                Some((cell, self.plates[owner as usize].position(slot, self.lattice)))
            }
        }
    }

    /// The plate that covers a sample, or the nearest one.
    fn plate(&self, cell: u32) -> u16 {
        self.nearest_edge(cell)
            .map_or(NOBODY, |(edge, _)| self.cover.owner[edge as usize])
    }

    /// Crust at a covered sample, in the world's frame.
    fn crust(&self, covered: u32) -> Crust {
        let plate = &self.plates[self.cover.owner[covered as usize] as usize];
        plate.crust[self.cover.slot[covered as usize] as usize].turned(plate.rotation)
    }

    fn gap(&self, cell: u32, noise: &[f32], since_my: f64, params: &GlobeParams) -> Option<Gap> {
        let (lattice, p) = (self.lattice, self.lattice.point(cell));
        let (edge, edge_at) = self.nearest_edge(cell)?;
        let around = lattice.neighbours(cell);
        let is_covered = |n: &u32| self.cover.owner[*n as usize] != NOBODY;
        let is_land = |n: &u32| is_covered(n) && self.crust(*n).continental;
        let on_land = 3 * around.iter().filter(|n| is_land(n)).count() >= 2 * around.len();
        let least = if on_land {
            LEAST_OPENING_ON_LAND
        } else {
            LEAST_OPENING
        };
        let plate = self.cover.owner[edge as usize];
        let ridge = self.to_ridge.of(cell, p, &self.ridge).and_then(|(ridge, arc)| {
            let (other, other_at) = self.nearest_edge(self.beyond[ridge as usize])?;
            let parting = [plate, self.cover.owner[other as usize]].map(|plate| &self.plates[plate as usize]);
            let opens = opening_mm_per_yr(parting, [edge_at, other_at]) > least;
            opens.then_some((self.ridge[ridge as usize].1, arc, other))
        });
        let Some((ridge_at, to_ridge, other)) = ridge else {
            // Drawn out from the sea where there is one, so that land does not grow along borders that slide. Land itself
            // closes only over cracks: slivers of it would be left behind in every sea that opens.
            let sea = around.iter().find(|n| is_covered(n) && !is_land(n));
            let from = sea.copied().unwrap_or(edge);
            let crust = self.crust(from);
            let is_new = crust.continental && !on_land;
            return Some(Gap {
                cell,
                plate: self.cover.owner[from as usize],
                slot: self.cover.slot[from as usize],
                crust: if is_new {
                    Crust::oceanic(ridge_km(params) as f32, 0.0)
                } else {
                    crust
                },
                is_new,
            });
        };
        let to_edge = arc(edge_at, p);
        // α of section 4.3.
        let share = to_ridge / (to_ridge + to_edge).max(1e-12);
        let age = share * since_my;
        let z = match params.sea_floor {
            SeaFloor::Gdh1 => -gdh1_km(age) + SWELL_KM * f64::from(noise[cell as usize]),
            SeaFloor::Damping => {
                let (own, across) = (to_edge, to_edge + 2.0 * to_ridge);
                let [z_own, z_other] = [edge, other].map(|cell| f64::from(self.crust(cell).z));
                let between = (z_own * across + z_other * own) / (own + across).max(1e-12);
                blended_km(share, between, params.ridge_km)
            }
        };
        let mut crust = Crust::oceanic(z as f32, age as f32);
        let other = self.cover.owner[other as usize];
        let [own, other] = [plate, other].map(|plate| self.plates[plate as usize].velocity(ridge_at));
        let along = if to_ridge > lattice.spacing() {
            (p - ridge_at).cross(p)
        } else {
            p.cross(own - other)
        };
        crust.ridge = along.as_vec3().normalize_or_zero();
        Some(Gap {
            cell,
            plate,
            slot: self.cover.slot[edge as usize],
            crust,
            is_new: true,
        })
    }
}

/// Height of new sea floor at a ridge, km.
pub(super) fn ridge_km(params: &GlobeParams) -> f64 {
    match params.sea_floor {
        SeaFloor::Gdh1 => -gdh1_km(0.0),
        SeaFloor::Damping => params.ridge_km,
    }
}

/// `z = α z̄ + (1 − α) z_Γ` (section 4.3), km: `between_km` (z̄) is interpolated between the edges of the plates, and the
/// template `z_Γ` is a level ridge.
fn blended_km(share: f64, between_km: f64, ridge_km: f64) -> f64 {
    share * between_km + (1.0 - share) * ridge_km
}

/// How fast two plates part between two places, mm/yr.
fn opening_mm_per_yr([a, b]: [&Plate; 2], [at_a, at_b]: [DVec3; 2]) -> f64 {
    let middle = (at_a + at_b).try_normalize().unwrap_or(at_a);
    let across = (at_a - at_b).try_normalize().unwrap_or(DVec3::ZERO);
    (a.velocity(middle) - b.velocity(middle)).dot(across) * RADIUS_KM
}

/// What plates grow by.
pub(super) struct Grown {
    /// For each plate the samples it takes, in its frame.
    pub(super) crust: Vec<Vec<(u32, Crust)>>,
    /// New area, km².
    pub(super) new_km2: f64,
    /// Area of crust that was drawn out, km².
    pub(super) drawn_km2: f64,
}

/// Gives gaps to their plates, of which the slots that `gone` names are about to go.
pub(super) fn grown(gaps: &[Gap], plates: &[Plate], gone: &[Vec<bool>], lattice: &Lattice) -> Grown {
    let mut gap_at = Numbers::new(lattice);
    for (number, gap) in (0..).zip(gaps) {
        gap_at.set(gap.cell, number);
    }
    let mut own: Vec<Vec<&Gap>> = vec![Vec::new(); plates.len()];
    for gap in gaps {
        own[gap.plate as usize].push(gap);
    }
    let taken: Vec<Taken> = plates
        .par_iter()
        .zip(gone)
        .zip(own)
        .enumerate()
        .map(|(index, ((plate, gone), own))| {
            let stays = |slot: u32| gone.get(slot as usize).is_none_or(|gone| !gone);
            let has = |i: u32| plate.slot(i).is_some_and(stays);
            let mut added: BTreeMap<u32, &Gap> = BTreeMap::new();
            for gap in own {
                let i = lattice.nearest(plate.rotation.inverse() * lattice.point(gap.cell));
                if !has(i) {
                    added.entry(i).or_insert(gap);
                }
                // Samples of the plate whose cells no sample of the world falls into.
                for &n in lattice.neighbours(i) {
                    if has(n) || added.contains_key(&n) {
                        continue;
                    }
                    let cell = lattice.nearest_from(plate.rotation * lattice.point(n), gap.cell);
                    let there = gap_at.get(cell).map(|number| &gaps[number as usize]);
                    if let Some(there) = there.filter(|there| there.plate as usize == index) {
                        added.insert(n, there);
                    }
                }
            }
            taken(plate, added, lattice)
        })
        .collect();
    let mut grown = Grown {
        crust: Vec::with_capacity(taken.len()),
        new_km2: 0.0,
        drawn_km2: 0.0,
    };
    for taken in taken {
        grown.crust.push(taken.crust);
        grown.new_km2 += taken.new_km2;
        grown.drawn_km2 += taken.drawn_km2;
    }
    grown
}

/// Samples that a plate takes, with their crust in its frame; new area and drawn-out area.
struct Taken {
    crust: Vec<(u32, Crust)>,
    new_km2: f64,
    drawn_km2: f64,
}

fn taken(plate: &Plate, added: BTreeMap<u32, &Gap>, lattice: &Lattice) -> Taken {
    let (mut new_km2, mut drawn_km2) = (0.0, 0.0);
    let back = plate.rotation.inverse();
    let crust = added.into_iter().map(|(i, gap)| {
        let area = lattice.areas()[i as usize] * RADIUS_KM * RADIUS_KM;
        *(if gap.is_new { &mut new_km2 } else { &mut drawn_km2 }) += area;
        (i, gap.crust.turned(back))
    });
    let crust = crust.collect();
    Taken {
        crust,
        new_km2,
        drawn_km2,
    }
}
