//! The planet: its state, and a step of it.

use std::sync::Arc;

use glam::DVec3;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng as _;
use rayon::prelude::*;

use super::borders::{Meeting, Polarities, SEGMENTS, Strip, meetings};
use super::collide::{self, collide};
use super::cover::{Contest, Cover};
use super::crust::{CONTINENTAL_KM, Crust, ROOT};
use super::distance::Numbers;
use super::fronts::Fronts;
use super::noise::Noise;
use super::params::GlobeParams;
use super::plate::Plate;
use super::random::{direction, unit};
use super::rift::{self, Cut, RiftError};
use super::spread::{self, Gap};
use super::start::{Start, StartError};
use super::terranes::Terranes;
use super::tidy;
use super::wear::wear;
use crate::sphere::{Lattice, LatticeError, RADIUS_KM};
use crate::surface::planet::Grip;

/// Wavelength of the unevenness of uplift, km.
const UNEVEN_KM: f64 = 420.0;
/// Steps between two looks at enclosed seas and at plates that have come apart.
const TIDY_STEPS: u64 = 3;

/// What has happened on a planet since its beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Totals {
    /// New sea floor, km².
    pub created_km2: f64,
    /// Crust that was drawn out where plates part too slowly for a ridge, km².
    pub drawn_out_km2: f64,
    /// Sea floor that rose from the sea and became land, km².
    pub emerged_km2: f64,
    /// Sea floor that plunged, km².
    pub consumed_km2: f64,
    /// Terranes that welded to another plate.
    pub collisions: u64,
    /// Their area where they came from, km².
    pub terranes_given_km2: f64,
    /// Their area where they went, as far as it lies side by side with what was there, km².
    pub terranes_added_km2: f64,
    /// The rest: crust doubled in the collision, km².
    pub terranes_stacked_km2: f64,
    /// Plates torn.
    pub rifts: u64,
    /// Plates that joined another because they were too small.
    pub absorbed: u64,
    /// Fronts that turned around.
    pub polarity_flips: u64,
    /// Heights held at their limit, samples times steps.
    pub saturated: u64,
    /// Numbers that were none and were taken out.
    pub quarantined: u64,
    /// Motions that were asked for and were faster than plates move.
    pub clamped: u64,
}

/// What a step did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Model time after it, My.
    pub time_my: f64,
    /// Plates there are.
    pub plates: usize,
    /// Terranes that welded in it.
    pub collisions: u64,
    /// Plates torn in it.
    pub rifts: u64,
}

/// A planet of moving plates. Plain data: a snapshot is a clone.
#[derive(Clone, Debug)]
pub struct Planet {
    pub(super) lattice: Arc<Lattice>,
    pub(super) coarse: Arc<Lattice>,
    pub(super) params: GlobeParams,
    pub(super) noise: Arc<Vec<f32>>,
    pub(super) plates: Vec<Plate>,
    pub(super) polarities: Polarities,
    pub(super) hot_spots: Vec<DVec3>,
    next_id: u32,
    mean_area_km2: f64,
    pub(super) time_my: f64,
    steps: u64,
    /// When gaps were filled last, My.
    pub(super) spread_my: f64,
    rng: Pcg64Mcg,
    pub(super) totals: Totals,
}

impl Planet {
    /// The planet of `start` on the samples of `lattice`.
    ///
    /// # Errors
    /// When the start names what there is not: see [`StartError`].
    pub fn new(lattice: Arc<Lattice>, start: &Start, params: GlobeParams) -> Result<Self, StartError> {
        let plates = start.plates(&lattice, &params)?;
        let mut rng = Pcg64Mcg::seed_from_u64(start.seed() ^ 0x6f72_6f67_656e);
        let hot_spots = (0..params.hot_spots).map(|_| direction(&mut rng)).collect();
        let noise = Noise::new(start.seed(), UNEVEN_KM, 2).on(&lattice);
        Ok(Self {
            coarse: Arc::new(coarse()),
            noise: Arc::new(noise),
            next_id: plates.len() as u32,
            mean_area_km2: 4.0 * std::f64::consts::PI * RADIUS_KM * RADIUS_KM / plates.len() as f64,
            lattice,
            params,
            plates,
            polarities: Polarities::default(),
            hot_spots,
            time_my: 0.0,
            steps: 0,
            spread_my: 0.0,
            rng,
            totals: Totals::default(),
        })
    }

    /// Model time, My.
    pub fn time_my(&self) -> f64 {
        self.time_my
    }

    /// The samples.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// The constants.
    pub fn params(&self) -> &GlobeParams {
        &self.params
    }

    /// What has happened so far.
    pub fn totals(&self) -> Totals {
        Totals {
            polarity_flips: self.polarities.flips,
            ..self.totals
        }
    }

    /// One step of `params.dt_my`.
    pub fn step(&mut self) -> StepReport {
        let before = self.totals;
        let dt = self.params.dt_my;
        for plate in &mut self.plates {
            plate.turn(dt);
        }
        self.time_my += dt;
        self.steps += 1;
        let lattice = Arc::clone(&self.lattice);
        let (terranes, mut cover) = rayon::join(
            || Terranes::of_all(&self.plates, &lattice),
            || Cover::new(&self.plates, &lattice),
        );
        self.settle(&mut cover);
        let met = meetings(&cover, &self.plates, &lattice);
        let strip = Strip {
            plates: &self.plates,
            cover: &cover,
            terranes: &terranes,
            lattice: &lattice,
            coarse: &self.coarse,
            params: &self.params,
        };
        self.polarities.decide(&strip, &met, self.time_my);
        self.settle(&mut cover);
        let fronts = Fronts::new(
            &cover,
            &self.plates,
            &self.polarities,
            &met,
            (&lattice, &self.coarse),
            &self.params,
        );
        self.change_crust(&cover, &fronts);
        fronts.drive(&mut self.plates, &self.params);
        // From here on slots change: first what falls to gaps is found, then crust goes, then it comes.
        let spreads = self
            .steps
            .is_multiple_of(u64::from(self.params.spread_steps.max(1)));
        let since_my = self.time_my - self.spread_my;
        let gaps = || {
            let (plates, noise) = (&self.plates, &self.noise);
            spread::gaps(&cover, plates, noise, &lattice, since_my, &self.params)
        };
        let (gaps, consumed) = rayon::join(
            || if spreads { gaps() } else { Vec::new() },
            || self.consumed(&cover),
        );
        if spreads {
            self.spread_my = self.time_my;
        }
        let scene = collide::Scene {
            cover: &cover,
            terranes: &terranes,
            noise: &self.noise,
            lattice: &lattice,
            coarse: &self.coarse,
            params: &self.params,
            now_my: self.time_my,
            mean_area_km2: self.mean_area_km2,
        };
        let touched = collide(&mut self.plates, &mut self.polarities, &scene, &mut self.totals);
        // Slots of a plate that has just taken or given part in a collision are others now; what it has below others is
        // found again in the next step.
        let gone = consumed.into_iter().zip(touched);
        let gone = gone.map(|(gone, touched)| if touched { Vec::new() } else { gone });
        self.exchange(&gone.collect::<Vec<_>>(), &gaps);
        self.rift_by_chance();
        if self.steps.is_multiple_of(TIDY_STEPS) {
            tidy::reunite(
                &mut self.plates,
                &lattice,
                &self.params,
                &mut self.next_id,
                &mut self.totals,
            );
            tidy::fill_basins(&mut self.plates, &lattice, &self.params, TIDY_STEPS as f64 * dt);
        }
        StepReport {
            time_my: self.time_my,
            plates: self.plates.len(),
            collisions: self.totals.collisions - before.collisions,
            rifts: self.totals.rifts - before.rifts,
        }
    }

    /// Says for each contested place which plate is on top.
    pub(super) fn settle(&self, cover: &mut Cover) {
        cover.settle(|contest| self.upper(contest));
    }

    fn upper(&self, contest: &Contest) -> (u16, u32) {
        let at = self.lattice.point(contest.cell);
        let mut best = contest.covers()[0];
        for &next in &contest.covers()[1..] {
            let land = |cover: (u16, u32)| self.plates[cover.0 as usize].crust[cover.1 as usize].continental;
            // Land is never below the sea.
            let wins = match (land(next), land(best)) {
                (true, false) => true,
                (false, true) => false,
                _ => self
                    .polarities
                    .first_is_upper(&self.plates, [next, best], at, &self.coarse),
            };
            if wins {
                best = next;
            }
        }
        best
    }

    /// True where the first plate of a meeting is on top.
    pub(super) fn first_is_upper(&self, meeting: &Meeting, cover: &Cover) -> bool {
        let covers = meeting.cells.map(|cell| cover.top(cell));
        self.polarities
            .first_is_upper(&self.plates, covers, meeting.at(&self.lattice), &self.coarse)
    }

    /// Uplift, erosion, ageing, trenches, volcanoes.
    fn change_crust(&mut self, cover: &Cover, fronts: &Fronts) {
        let (lattice, params, noise) = (&self.lattice, &self.params, &self.noise);
        let spots: Vec<(u32, u16)> = self
            .hot_spots
            .iter()
            .map(|&at| lattice.nearest(at))
            .map(|cell| (cell, cover.owner[cell as usize]))
            .collect();
        let counts: Vec<[u64; 3]> = self
            .plates
            .par_iter_mut()
            .enumerate()
            .map(|(index, plate)| {
                let (rotation, back) = (plate.rotation, plate.rotation.inverse());
                let margins = tidy::margins(plate, lattice, params);
                let (members, crust) = plate.members_and_crust();
                crust
                    .par_iter_mut()
                    .zip(members)
                    .zip(&cover.cells[index])
                    .zip(&margins)
                    .with_min_len(2048)
                    .map(|(((crust, &i), &cell), &margin)| {
                        let mut rose = false;
                        if cover.owner[cell as usize] == index as u16 {
                            let at = rotation * lattice.point(i);
                            rose = fronts.raise(
                                crust,
                                (index as u16, cell, at),
                                noise[i as usize],
                                back,
                                params,
                            );
                            if spots.contains(&(cell, index as u16)) {
                                tidy::erupt(crust, params);
                            }
                        }
                        if margin && !rose {
                            tidy::subside(crust, params);
                        }
                        let saturated = f64::from(crust.z) >= params.summit_km;
                        wear(crust, fronts.trench(cell), params);
                        let lost =
                            !(crust.z.is_finite() && crust.thickness.is_finite() && crust.fold.is_finite());
                        let emerges = !crust.continental && f64::from(crust.z) > params.emergence_km;
                        if lost {
                            *crust = Crust::oceanic(params.abyss_km as f32, 0.0);
                        } else if emerges {
                            crust.continental = true;
                            crust.thickness = CONTINENTAL_KM + ROOT * crust.z;
                            crust.age = 0.0;
                        }
                        [saturated, lost, emerges].map(u64::from)
                    })
                    .reduce(|| [0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
            })
            .collect();
        let sample_km2 = 4.0 * std::f64::consts::PI * RADIUS_KM * RADIUS_KM / lattice.len() as f64;
        for [saturated, lost, emerged] in counts {
            self.totals.saturated += saturated;
            self.totals.quarantined += lost;
            self.totals.emerged_km2 += emerged as f64 * sample_km2;
        }
    }

    /// For each plate and slot: it lies under another plate and goes down.
    fn consumed(&self, cover: &Cover) -> Vec<Vec<bool>> {
        let mut contest_at = Numbers::new(&self.lattice);
        for (number, contest) in (0..).zip(&cover.contests) {
            contest_at.set(contest.cell, number);
        }
        let plates = &self.plates;
        plates
            .par_iter()
            .enumerate()
            .map(|(index, plate)| {
                let goes = |slot: usize, cell: u32| {
                    let Some(number) = contest_at.get(cell) else {
                        return false;
                    };
                    let contest = &cover.contests[number as usize];
                    let at = self.lattice.point(cell);
                    let own = (index as u16, slot as u32);
                    let land = plate.crust[slot].continental;
                    contest.covers().iter().filter(|up| up.0 != own.0).any(|&up| {
                        let above = &plates[up.0 as usize];
                        let is_upper = self
                            .polarities
                            .first_is_upper(plates, [up, own], at, &self.coarse);
                        let other_land = above.crust[up.1 as usize].continental;
                        if land {
                            // Continents that only touch overlap by the lattice's unevenness.
                            let apart = plate.velocity(at) - above.velocity(at);
                            return is_upper
                                && other_land
                                && apart.length() * RADIUS_KM < self.params.least_closing;
                        }
                        is_upper
                    })
                };
                let cells = cover.cells[index].iter().enumerate();
                cells.map(|(slot, &cell)| goes(slot, cell)).collect()
            })
            .collect()
    }

    /// Crust goes where `gone` says (for each plate and slot; nothing for a plate without), and gaps are filled.
    fn exchange(&mut self, gone: &[Vec<bool>], gaps: &[Gap]) {
        let lattice = &self.lattice;
        let grown = spread::grown(gaps, &self.plates, gone, lattice);
        let consumed: Vec<f64> = self
            .plates
            .par_iter_mut()
            .zip(gone)
            .zip(grown.crust)
            .map(|((plate, gone), added)| {
                let areas = plate.members().iter().zip(gone).filter(|(_, gone)| **gone);
                let area: f64 = areas.map(|(&i, _)| lattice.areas()[i as usize]).sum();
                if area > 0.0 || !added.is_empty() {
                    let goes = |slot: u32| gone.get(slot as usize).is_some_and(|gone| *gone);
                    plate.change(goes, added, lattice);
                }
                area
            })
            .collect();
        self.totals.consumed_km2 += consumed.iter().sum::<f64>() * RADIUS_KM * RADIUS_KM;
        self.totals.created_km2 += grown.new_km2;
        self.totals.drawn_out_km2 += grown.drawn_km2;
        self.plates.retain(|plate| plate.len() > 0);
    }

    fn rift_by_chance(&mut self) {
        let count = self.plates.len();
        for index in 0..count {
            let plate = &self.plates[index];
            let area = plate.area_km2(&self.lattice);
            let chance = rift::probability(plate.continental_share(), area, self.mean_area_km2, &self.params);
            // Drawn for every plate, so that what one does is no matter to the chances of the others.
            let (draw, kind) = (unit(&mut self.rng), unit(&mut self.rng));
            if draw >= chance || plate.grip != Grip::Free {
                continue;
            }
            let parts = match kind {
                k if k < 0.7 => 2,
                k if k < 0.92 => 3,
                _ => 4,
            };
            // A plate that is too small stays whole.
            let _ = self.tear(index, &Cut::Parts(parts));
        }
    }

    pub(super) fn tear(&mut self, index: usize, cut: &Cut) -> Result<Vec<u32>, RiftError> {
        let parts = rift::parts(&self.plates[index], cut, &self.lattice, &mut self.rng)?;
        let next_id = &mut self.next_id;
        let new_id = || {
            *next_id += 1;
            *next_id - 1
        };
        let torn = rift::split(&self.plates[index], &parts, new_id, &self.lattice, &self.params);
        let ids = torn.iter().map(|plate| plate.id).collect();
        let mut torn = torn.into_iter();
        if let Some(first) = torn.next() {
            self.plates[index] = first;
        }
        self.plates.extend(torn);
        self.totals.rifts += 1;
        Ok(ids)
    }
}

/// The coarse lattice of segments.
fn coarse() -> Lattice {
    match Lattice::new(SEGMENTS) {
        Ok(lattice) => lattice,
        Err(LatticeError::Size { .. } | LatticeError::Open(_)) => unreachable!("a fixed size that is tested"),
    }
}
