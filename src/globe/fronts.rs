//! Subduction: fronts, the uplift behind them, trenches before them, and the pull of slabs (section 4.1).

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::borders::{Meeting, Polarities};
use super::cover::Cover;
use super::crust::Crust;
use super::distance::{Nearest, Numbers};
use super::params::GlobeParams;
use super::plate::Plate;
use crate::sphere::{Lattice, RADIUS_KM};
use crate::surface::planet::{Grip, Orogeny};

/// Into so many parts the plates are divided to find what is near their fronts.
const FLOODS: usize = 4;

/// A place on the upper plate from which a front is felt.
#[derive(Clone, Copy, Debug)]
struct Front {
    /// The upper plate (index).
    upper: u16,
    /// How fast the two close, mm/yr.
    closing: f64,
    /// Height of the plate that plunges, without trench, km.
    plunging_km: f64,
    /// Motion of the plunging plate against the upper one, km/My.
    motion: DVec3,
}

/// All fronts of a moment and how far they are felt.
#[derive(Clone, Debug)]
pub(super) struct Fronts {
    felt: Vec<Front>,
    sources: Vec<(u32, DVec3)>,
    /// For the plates (index) of each remainder by [`FLOODS`].
    nearest: Vec<Nearest>,
    /// For each sample of the world how deep a trench is there, 0–1.
    trench: Vec<f32>,
    /// For each plate: where it plunges, weighted with the length of the front, and its share of the border.
    pulls: Vec<Pull>,
}

/// How slabs pull a plate.
#[derive(Clone, Copy, Debug, Default)]
struct Pull {
    /// Sum of `(c × q)/|c × q|` over the front, weighted with its length.
    turn: DVec3,
    /// Length of the front.
    slab: f64,
    /// Length of the border.
    border: f64,
}

impl Fronts {
    pub(super) fn new(
        cover: &Cover,
        plates: &[Plate],
        polarities: &Polarities,
        meetings: &[Meeting],
        (lattice, coarse): (&Lattice, &Lattice),
        params: &GlobeParams,
    ) -> Self {
        let centroids: Vec<DVec3> = plates.par_iter().map(|plate| plate.centroid(lattice)).collect();
        let mut pulls = vec![Pull::default(); plates.len()];
        let mut trench = vec![0.0_f32; lattice.len()];
        // Meetings of one sample are summed.
        let mut at = Numbers::new(lattice);
        let mut fronts: Vec<(Front, f64)> = Vec::new();
        let mut sources = Vec::new();
        let firsts_up: Vec<bool> = meetings
            .par_iter()
            .with_min_len(256)
            .map(|meeting| {
                let covers = meeting.cells.map(|cell| cover.top(cell));
                meeting.closing > params.least_closing
                    && polarities.first_is_upper(plates, covers, meeting.at(lattice), coarse)
            })
            .collect();
        for (meeting, first_is_upper) in meetings.iter().zip(firsts_up) {
            let covers = meeting.cells.map(|cell| cover.top(cell));
            let middle = meeting.at(lattice);
            for (plate, _) in covers {
                pulls[plate as usize].border += 1.0;
            }
            if meeting.closing <= params.least_closing {
                continue;
            }
            let (up, low) = if first_is_upper { (0, 1) } else { (1, 0) };
            let (upper, lower) = (covers[up].0 as usize, covers[low].0 as usize);
            let crust = &plates[lower].crust[covers[low].1 as usize];
            pulls[lower].slab += 1.0;
            pulls[lower].turn += centroids[lower]
                .cross(middle)
                .try_normalize()
                .unwrap_or(DVec3::ZERO);
            if !crust.continental {
                let deep = (meeting.closing / params.trench_speed).min(1.0) as f32;
                let here = &mut trench[meeting.cells[low] as usize];
                *here = here.max(deep);
            }
            let speed = if params.least_closing > 0.0 {
                meeting.closing
            } else {
                meeting.closing.hypot(meeting.sliding)
            };
            let front = Front {
                upper: upper as u16,
                closing: speed,
                plunging_km: f64::from(crust.z),
                motion: (plates[lower].velocity(middle) - plates[upper].velocity(middle)) * RADIUS_KM,
            };
            let cell = meeting.cells[up];
            if let Some(number) = at.get(cell) {
                let (sum, count) = &mut fronts[number as usize];
                sum.closing += front.closing;
                sum.plunging_km += front.plunging_km;
                sum.motion += front.motion;
                *count += 1.0;
            } else {
                at.set(cell, fronts.len() as u32);
                sources.push((cell, middle));
                fronts.push((front, 1.0));
            }
        }
        let mut fronts: Vec<Front> = fronts
            .into_iter()
            .map(|(sum, count)| Front {
                closing: sum.closing / count,
                plunging_km: sum.plunging_km / count,
                motion: sum.motion / count,
                ..sum
            })
            .collect();
        for _ in 0..2 {
            fronts = smoothed(&fronts, &sources, &at, lattice);
        }
        let reach = params.subduction_km.max(params.arc_km) / RADIUS_KM;
        // What is felt on one plate is no matter to the others.
        let nearest = (0..FLOODS as u16).into_par_iter().map(|flood| {
            let mine: Vec<u32> = (0..fronts.len() as u32)
                .filter(|&source| fronts[source as usize].upper % FLOODS as u16 == flood)
                .collect();
            Nearest::of_some(lattice, &sources, &mine, reach, |source, cell| {
                cover.owner[cell as usize] == fronts[source as usize].upper
            })
        });
        let nearest = nearest.collect();
        Self {
            felt: fronts,
            sources,
            nearest,
            trench,
            pulls,
        }
    }

    /// Depth of the trench at a sample of the world, 0–1.
    pub(super) fn trench(&self, cell: u32) -> f32 {
        self.trench[cell as usize]
    }

    /// Raises crust of the plate on top, `upper`, at a sample of the world. `p` is where the crust is, `noise` −1 to 1, `turn` leads
    /// from the world's frame to the plate's. True where it rose.
    pub(super) fn raise(
        &self,
        crust: &mut Crust,
        (upper, cell, p): (u16, u32, DVec3),
        noise: f32,
        turn: DQuat,
        params: &GlobeParams,
    ) -> bool {
        let nearest = &self.nearest[usize::from(upper) % FLOODS];
        let Some((source, arc)) = nearest.of(cell, p, &self.sources) else {
            return false;
        };
        let front = &self.felt[source as usize];
        let rate = uplift_mm_per_yr(crust, arc * RADIUS_KM, front.closing, front.plunging_km, params);
        let dz = rate * (1.0 + params.uplift_noise * f64::from(noise)) * params.dt_my;
        if dz <= 0.0 {
            return false;
        }
        crust.raise(dz as f32);
        crust.z = crust.z.min(params.summit_km as f32);
        let is_land = crust.continental || f64::from(crust.z) > params.emergence_km;
        if is_land && dz > params.least_orogeny * params.dt_my {
            crust.orogeny = Orogeny::Andean;
            crust.orogeny_age = 0.0;
        }
        // A sum of motions, kept in the tangent plane and to unit length.
        let motion = turn * (front.motion * (params.folding * params.dt_my));
        let up = (turn * p).as_vec3();
        let mut motion = motion.as_vec3();
        if motion.dot(crust.fold) < 0.0 {
            motion = -motion;
        }
        let sum = crust.fold + motion;
        crust.fold = (sum - up * sum.dot(up)).normalize_or_zero();
        true
    }

    /// Lets slabs turn and speed up the plates they hang on.
    pub(super) fn drive(&self, plates: &mut [Plate], params: &GlobeParams) {
        let fastest = params.max_speed / RADIUS_KM;
        for (plate, pull) in plates.iter_mut().zip(&self.pulls) {
            if plate.grip != Grip::Free {
                continue;
            }
            let border = pull.border.max(1.0);
            let speed = plate.omega.length();
            let axis = plate.omega.try_normalize().unwrap_or(DVec3::ZERO);
            let turned = axis + pull.turn / border * (params.slab_pull_deg.to_radians() * params.dt_my);
            let axis = turned.try_normalize().unwrap_or(axis);
            let speed = if params.speed_relaxation_my.is_finite() {
                let goal = goal_speed(pull.slab / border, plate.continental_share(), params);
                let share = (params.dt_my / params.speed_relaxation_my).min(1.0);
                speed + (goal / RADIUS_KM - speed) * share
            } else {
                speed
            };
            plate.omega = axis * speed.min(fastest);
        }
    }
}

/// Speed that a plate comes to, mm/yr: `slab` is the share of its border that plunges, `land` its share of continent.
fn goal_speed(slab: f64, land: f64, params: &GlobeParams) -> f64 {
    let slab = slab.min(params.slab_share);
    params.free_speed * (1.2 - 0.5 * land) + params.slab_speed * slab * (1.0 - 0.4 * land)
}

/// Each front takes part in what its neighbours along the border feel.
fn smoothed(fronts: &[Front], sources: &[(u32, DVec3)], at: &Numbers, lattice: &Lattice) -> Vec<Front> {
    fronts
        .par_iter()
        .zip(sources)
        .with_min_len(256)
        .map(|(front, &(cell, _))| {
            let mut sum = *front;
            let mut count = 1.0;
            for &n in lattice.neighbours(cell) {
                let other = at.get(n).map(|number| &fronts[number as usize]);
                if let Some(other) = other.filter(|other| other.upper == front.upper) {
                    sum.closing += other.closing;
                    sum.plunging_km += other.plunging_km;
                    sum.motion += other.motion;
                    count += 1.0;
                }
            }
            Front {
                closing: sum.closing / count,
                plunging_km: sum.plunging_km / count,
                motion: sum.motion / count,
                ..*front
            }
        })
        .collect()
}

/// Rate of uplift `u₀ f(d) g(v) h(z)` on the upper plate (section 4.1), mm/yr: `distance_km` from the front, where a plate
/// whose surface is at `plunging_km` plunges at `closing` mm/yr.
pub fn uplift_mm_per_yr(
    crust: &Crust,
    distance_km: f64,
    closing: f64,
    plunging_km: f64,
    params: &GlobeParams,
) -> f64 {
    let (reach, factor) = if crust.continental {
        (params.subduction_km, 1.0)
    } else {
        (params.arc_km, params.arc_factor)
    };
    let f = profile(distance_km / reach, params);
    let g = (closing / params.max_speed).clamp(0.0, 1.0);
    let depth = (plunging_km - params.trench_km) / (params.summit_km - params.trench_km);
    let h = depth.clamp(0.0, 1.0).powf(params.height_power);
    let left = (1.0 - f64::from(crust.z) / params.uplift_limit_km).clamp(0.0, 1.0);
    params.uplift * factor * f * g * h * if f64::from(crust.z) > 0.0 { left } else { 1.0 }
}

/// f: a piecewise cubic of the distance (1 at the reach), strongest at a stated place, 0 with zero slope at the reach.
fn profile(x: f64, params: &GlobeParams) -> f64 {
    let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
    if x <= 0.0 {
        params.uplift_at_front
    } else if x < params.uplift_peak {
        params.uplift_at_front + (1.0 - params.uplift_at_front) * smooth(x / params.uplift_peak)
    } else if x < 1.0 {
        1.0 - smooth((x - params.uplift_peak) / (1.0 - params.uplift_peak))
    } else {
        0.0
    }
}
