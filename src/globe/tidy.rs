//! What keeps a planet whole: plates in one piece, enclosed seas that fill, margins that sink, volcanoes over hot spots.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::crust::{Crust, Marks};
use super::params::GlobeParams;
use super::planet::Totals;
use super::plate::Plate;
use super::transfer::transfer;
use crate::sphere::{Lattice, RADIUS_KM};

/// Pieces of a plate above this share of the sphere become plates of their own.
const LEAST_PIECE: f64 = 0.004;
/// How fast an enclosed sea fills, km/My, and where it becomes land, km.
const BASIN_FILL: f64 = 0.15;
const BASIN_FULL_KM: f32 = -0.1;
/// Height that margins sink to, km.
const MARGIN_KM: f64 = -0.18;
/// Highest volcano over a hot spot, km.
const VOLCANO_KM: f64 = 1.2;

/// Pieces that have come off their plate join the neighbour that they touch most, or become plates; plates that are too
/// small join a neighbour.
pub(super) fn reunite(
    plates: &mut Vec<Plate>,
    lattice: &Lattice,
    params: &GlobeParams,
    next_id: &mut u32,
    totals: &mut Totals,
) {
    let least_piece = (LEAST_PIECE * lattice.len() as f64) as u32;
    let pieces: Vec<_> = plates
        .par_iter()
        .map(|plate| plate.regions(lattice, |_| true))
        .collect();
    let mut given = vec![false; plates.len()];
    for (index, (region, sizes)) in pieces.into_iter().enumerate() {
        // A plate that has been given a piece has other slots now; it is looked at the next time.
        if sizes.len() < 2 || given[index] {
            continue;
        }
        let mut main = 0;
        for (number, &size) in sizes.iter().enumerate() {
            if size > sizes[main] {
                main = number;
            }
        }
        for (number, &size) in sizes.iter().enumerate() {
            if number == main {
                continue;
            }
            let in_piece = |slot: u32| region[slot as usize] == number as u32;
            if size >= least_piece {
                let slots = (0..plates[index].len()).filter(|&slot| in_piece(slot as u32));
                let (members, crust) = slots
                    .map(|slot| (plates[index].members()[slot], plates[index].crust[slot]))
                    .unzip();
                let mut piece = Plate::new(*next_id, plates[index].rotation, members, crust, lattice);
                piece.omega = plates[index].omega;
                *next_id += 1;
                plates.push(piece);
            } else if let Some(to) = give(plates, index, in_piece, lattice)
                && let Some(given) = given.get_mut(to)
            {
                *given = true;
            }
        }
        plates[index].change(|slot| region[slot as usize] != main as u32, Vec::new(), lattice);
    }
    let least = (params.least_plate * lattice.len() as f64) as usize;
    for index in 0..plates.len() {
        if plates[index].len() >= least || plates.len() < 2 {
            continue;
        }
        if give(plates, index, |_| true, lattice).is_some() {
            plates[index].change(|_| true, Vec::new(), lattice);
            totals.absorbed += 1;
        }
    }
    plates.retain(|plate| plate.len() > 0);
}

/// Gives the slots of a plate that `goes` names to the plate that they touch most; they stay where they were, too. Says to
/// which; `None` where nobody is near.
fn give(plates: &mut [Plate], from: usize, goes: impl Fn(u32) -> bool, lattice: &Lattice) -> Option<usize> {
    let mut touched: BTreeMap<usize, u32> = BTreeMap::new();
    for slot in (0..plates[from].len() as u32).filter(|&slot| goes(slot)) {
        let i = plates[from].members()[slot as usize];
        for &n in lattice.neighbours(i) {
            let outside = plates[from].slot(n).is_none_or(|slot| !goes(slot));
            if !outside {
                continue;
            }
            let at = plates[from].rotation * lattice.point(n);
            for (index, plate) in plates.iter().enumerate() {
                if index != from && plate.slot_at(at, lattice).is_some() {
                    *touched.entry(index).or_default() += 1;
                }
            }
        }
    }
    let mut most: Option<(usize, u32)> = None;
    for (index, count) in touched {
        if most.is_none_or(|(_, best)| count > best) {
            most = Some((index, count));
        }
    }
    let (to, _) = most?;
    let (added, _) = transfer(&plates[from], &plates[to], goes, lattice);
    plates[to].change(|_| false, added, lattice);
    Some(to)
}

/// Seas that a plate's land encloses fill with sediment where they are small, for `my`.
pub(super) fn fill_basins(plates: &mut [Plate], lattice: &Lattice, params: &GlobeParams, my: f64) {
    if params.basin_mkm2 <= 0.0 {
        return;
    }
    let sample_mkm2 = 4.0 * std::f64::consts::PI * RADIUS_KM * RADIUS_KM / 1e6 / lattice.len() as f64;
    let most = (params.basin_mkm2 / sample_mkm2).max(3.0) as u32;
    plates.par_iter_mut().for_each(|plate| {
        let (region, sizes) = plate.regions(lattice, |slot| !plate.crust[slot as usize].continental);
        // What is larger does not fill, whether it is open or not.
        let mut open: Vec<bool> = sizes.iter().map(|size| *size > most).collect();
        for (&number, &i) in region.iter().zip(plate.members()) {
            if number != u32::MAX && !open[number as usize] {
                open[number as usize] = lattice.neighbours(i).iter().any(|&n| !plate.contains(n));
            }
        }
        let (_, crust) = plate.members_and_crust();
        for (&number, crust) in region.iter().zip(crust) {
            if number == u32::MAX || open[number as usize] {
                continue;
            }
            crust.z += (BASIN_FILL * my) as f32;
            crust.trench = 0.0;
            if crust.z >= BASIN_FULL_KM {
                *crust = Crust::continental(BASIN_FULL_KM);
                crust.orogeny_age = 1_000.0;
            }
        }
    });
}

/// For each slot: continental crust next to sea floor of its own plate.
pub(super) fn margins(plate: &Plate, lattice: &Lattice, params: &GlobeParams) -> Vec<bool> {
    if !params.margin_my.is_finite() {
        return vec![false; plate.len()];
    }
    let is_sea = |slot: u32| !plate.crust[slot as usize].continental;
    let sea = Marks::new(lattice.len(), plate.samples_where(is_sea));
    let at_sea = |i: u32| lattice.neighbours(i).iter().any(|&n| sea.contains(n));
    let slots = plate.crust.iter().zip(plate.members());
    slots.map(|(crust, &i)| crust.continental && at_sea(i)).collect()
}

/// A margin without mountain building cools and sinks to a shelf.
pub(super) fn subside(crust: &mut Crust, params: &GlobeParams) {
    let above = f64::from(crust.z) - MARGIN_KM;
    if above > 0.0 {
        crust.z -= (above * params.dt_my / params.margin_my).min(above) as f32;
    }
}

/// A hot spot builds a volcano on the crust above it.
pub(super) fn erupt(crust: &mut Crust, params: &GlobeParams) {
    let room = VOLCANO_KM - f64::from(crust.z);
    if !crust.continental && room > 0.0 {
        crust.z += (params.hot_spot_growth * params.dt_my).min(room) as f32;
    }
}
