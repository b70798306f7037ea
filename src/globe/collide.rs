//! Continental collision: terranes that resist subduction break off and weld to the plate above (section 4.2).

use std::collections::BTreeMap;

use glam::DVec3;

use super::borders::Polarities;
use super::cover::{Contest, Cover};
use super::distance::{Nearest, Numbers};
use super::params::{GlobeParams, Reach};
use super::planet::Totals;
use super::plate::Plate;
use super::terranes::Terranes;
use super::transfer::transfer;
use crate::sphere::{Lattice, RADIUS_KM};
use crate::surface::planet::{Grip, Orogeny};

/// A terrane that has come far enough under another plate to weld to it.
#[derive(Clone, Debug)]
struct Suture {
    /// Plate it comes from, and its number there.
    from: u16,
    terrane: u32,
    /// Plate it welds to.
    to: u16,
    /// Where they overlap, samples of the world.
    cells: Vec<u32>,
}

/// Where a terrane lies below another plate.
#[derive(Clone, Debug, Default)]
struct Overlap {
    /// Far enough.
    is_due: bool,
    /// Samples where there is land above it.
    on_land: usize,
    /// Samples of the world.
    cells: Vec<u32>,
}

/// What the collisions of a step see.
pub(super) struct Scene<'a> {
    pub(super) cover: &'a Cover,
    pub(super) terranes: &'a [Terranes],
    pub(super) noise: &'a [f32],
    pub(super) lattice: &'a Lattice,
    pub(super) coarse: &'a Lattice,
    pub(super) params: &'a GlobeParams,
    pub(super) now_my: f64,
    /// Mean area of a plate in the beginning, km² (A₀).
    pub(super) mean_area_km2: f64,
}

/// Lets all terranes collide that overlap far enough. Says which plates have given or taken; one that is used up has no
/// samples afterwards.
pub(super) fn collide(
    plates: &mut [Plate],
    polarities: &mut Polarities,
    scene: &Scene<'_>,
    totals: &mut Totals,
) -> Vec<bool> {
    // A plate that has given or taken has other slots than the cover says; what else it has to do waits for the next step.
    let mut busy = vec![false; plates.len()];
    for suture in sutures(plates, polarities, scene) {
        if busy[suture.from as usize] || busy[suture.to as usize] {
            continue;
        }
        busy[suture.from as usize] = true;
        busy[suture.to as usize] = true;
        weld(plates, &suture, scene, totals);
    }
    busy
}

/// Sutures that are due, by plate and terrane.
fn sutures(plates: &[Plate], polarities: &mut Polarities, scene: &Scene<'_>) -> Vec<Suture> {
    let (cover, lattice) = (scene.cover, scene.lattice);
    // For each contested place the continental crust below another plate, if any.
    let mut under: Vec<(u16, u32, u16)> = Vec::new();
    let mut place = Numbers::new(lattice);
    for contest in &cover.contests {
        if let Some(pair) = plunging_land(plates, polarities, contest, scene) {
            place.set(contest.cell, under.len() as u32);
            under.push(pair);
        }
    }
    // How far each has come: distance to where its plate is alone.
    let mut sources = Vec::new();
    for contest in &cover.contests {
        let Some(number) = place.get(contest.cell) else {
            continue;
        };
        let (plate, _, _) = under[number as usize];
        for &n in lattice.neighbours(contest.cell) {
            if cover.owner[n as usize] == plate && place.get(n).is_none() {
                sources.push((n, lattice.point(n)));
            }
        }
    }
    let owner_of = |source: u32| cover.owner[sources[source as usize].0 as usize];
    let nearest = Nearest::new(lattice, &sources, std::f64::consts::PI, |source, cell| {
        let place = place.get(cell);
        place.is_some_and(|number| under[number as usize].0 == owner_of(source))
    });
    let mut found: BTreeMap<(u16, u32, u16), Overlap> = BTreeMap::new();
    for contest in &cover.contests {
        let Some(number) = place.get(contest.cell) else {
            continue;
        };
        let (from, slot, to) = under[number as usize];
        let depth_km = nearest
            .of(contest.cell, lattice.point(contest.cell), &sources)
            .map_or(f64::INFINITY, |(_, arc)| arc * RADIUS_KM);
        let terrane = scene.terranes[from as usize].of[slot as usize];
        let overlap = found.entry((from, terrane, to)).or_default();
        overlap.is_due |= depth_km >= scene.params.collision_overlap_km;
        let above = contest.covers().iter().find(|(plate, _)| *plate == to);
        let on_land =
            above.is_some_and(|&(plate, slot)| plates[plate as usize].crust[slot as usize].continental);
        overlap.on_land += usize::from(on_land);
        overlap.cells.push(contest.cell);
    }
    let mut due = Vec::new();
    for ((from, terrane, to), overlap) in found {
        let cells = overlap.cells;
        if !overlap.is_due {
            continue;
        }
        let slot = scene.terranes[from as usize]
            .of
            .iter()
            .position(|&t| t == terrane);
        let area = slot.map_or(0.0, |slot| scene.terranes[from as usize].area_mkm2(slot as u32));
        if 4 * overlap.on_land >= cells.len() || area < scene.params.terrane_mkm2 {
            due.push(Suture {
                from,
                terrane,
                to,
                cells,
            });
        } else {
            // A continent does not go under an ocean: the front turns around.
            for cell in cells {
                polarities.force(plates, from, to, lattice.point(cell), scene.coarse, scene.now_my);
            }
        }
    }
    due
}

/// The continental crust at a contested place that goes under another plate: its plate, its slot, and the plate above.
fn plunging_land(
    plates: &[Plate],
    polarities: &Polarities,
    contest: &Contest,
    scene: &Scene<'_>,
) -> Option<(u16, u32, u16)> {
    let at = scene.lattice.point(contest.cell);
    for &low in contest.covers() {
        if !plates[low.0 as usize].crust[low.1 as usize].continental {
            continue;
        }
        for &up in contest.covers() {
            if up.0 != low.0 && polarities.first_is_upper(plates, [up, low], at, scene.coarse) {
                return Some((low.0, low.1, up.0));
            }
        }
    }
    None
}

/// Moves a terrane to the plate above it, and raises the land around the suture.
fn weld(plates: &mut [Plate], suture: &Suture, scene: &Scene<'_>, totals: &mut Totals) {
    let lattice = scene.lattice;
    let (from, to) = (suture.from as usize, suture.to as usize);
    let of = &scene.terranes[from].of;
    let sample_km2 = 4.0 * std::f64::consts::PI * RADIUS_KM * RADIUS_KM / lattice.len() as f64;
    let members: Vec<u32> = (0..plates[from].len() as u32)
        .filter(|&slot| of[slot as usize] == suture.terrane)
        .collect();
    let area_km2 = members.len() as f64 * sample_km2;
    let centre: DVec3 = members
        .iter()
        .map(|&slot| plates[from].position(slot, lattice))
        .sum::<DVec3>()
        .try_normalize()
        .unwrap_or(DVec3::Z);
    let speed = (plates[from].velocity(centre) - plates[to].velocity(centre)).length() * RADIUS_KM;
    let whole = members.len() as f64 > scene.params.merge_share * plates[from].len() as f64;
    let goes = |slot: u32| whole || of[slot as usize] == suture.terrane;
    let (added, moved) = transfer(&plates[from], &plates[to], goes, lattice);
    // The joint plate keeps the angular momentum of both (globe-physics GD9, with equal mass per area).
    let (a, b) = (plates[to].len() as f64, members.len() as f64);
    if plates[to].grip == Grip::Free {
        plates[to].omega = (plates[to].omega * a + plates[from].omega * b) / (a + b);
    }
    plates[from].change(goes, Vec::new(), lattice);
    plates[to].change(|_| false, added, lattice);
    surge(&mut plates[to], suture, area_km2, speed, centre, scene);
    totals.collisions += 1;
    totals.terranes_given_km2 += f64::from(moved.given) * sample_km2;
    totals.terranes_added_km2 += f64::from(moved.added) * sample_km2;
    totals.terranes_stacked_km2 += f64::from(moved.stacked) * sample_km2;
}

/// How far a collision is felt, km (r of section 4.2).
pub fn influence_km(speed: f64, area_km2: f64, mean_area_km2: f64, params: &GlobeParams) -> f64 {
    let (v, a) = (speed / params.max_speed, area_km2 / mean_area_km2);
    let r = match params.reach {
        Reach::Root => (v * a).sqrt(),
        Reach::Product => v.sqrt() * a,
    };
    (params.collision_km * r).min(params.collision_limit_km)
}

/// Height that a surge adds at `x` = distance / influence, km: `Δ_c A (1 − x²)²`, which approaches a limit.
pub fn surge_km(z_km: f64, x: f64, area_km2: f64, params: &GlobeParams) -> f64 {
    let kernel = (1.0 - (x * x).min(1.0)).powi(2);
    let room = (params.collision_summit_km - z_km).max(0.0);
    room * (1.0 - (-params.collision * area_km2 * kernel / params.collision_summit_km).exp())
}

fn surge(plate: &mut Plate, suture: &Suture, area_km2: f64, speed: f64, centre: DVec3, scene: &Scene<'_>) {
    let (lattice, params) = (scene.lattice, scene.params);
    let spacing_km = lattice.spacing() * RADIUS_KM;
    let reach = influence_km(speed, area_km2, scene.mean_area_km2, params).max(1.5 * spacing_km);
    let back = plate.rotation.inverse();
    let sources: Vec<(u32, DVec3)> = suture
        .cells
        .iter()
        .map(|&cell| back * lattice.point(cell))
        .map(|p| (lattice.nearest(p), p))
        .collect();
    let nearest = Nearest::new(lattice, &sources, reach / RADIUS_KM, |_, i| plate.contains(i));
    let centre = back * centre;
    let (members, crust) = plate.members_and_crust();
    for (&i, crust) in members.iter().zip(crust) {
        let p = lattice.point(i);
        let Some((_, arc)) = nearest.of(i, p, &sources) else {
            continue;
        };
        if !crust.continental {
            continue;
        }
        let uneven = 1.0 + params.uplift_noise * f64::from(scene.noise[i as usize]);
        let dz = surge_km(f64::from(crust.z), arc * RADIUS_KM / reach, area_km2, params) * uneven;
        let dz = dz.min(params.summit_km - f64::from(crust.z)).max(0.0);
        crust.raise(dz as f32);
        if dz > 0.05 {
            crust.orogeny = Orogeny::Himalayan;
            crust.orogeny_age = 0.0;
            // Away from the terrane's middle, in the tangent plane: (n × d) × n.
            let away = p - centre;
            crust.fold = p.cross(away).cross(p).as_vec3().normalize_or_zero();
        }
    }
}
