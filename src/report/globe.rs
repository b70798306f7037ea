//! The facts of a planet.

use serde::Serialize;

use super::ContactFacts;
use crate::export::digest;
use crate::globe::{GlobeParams, Start, Totals};
use crate::sim::globe::{GlobeCounts, GlobeSim};
use crate::sphere::{RADIUS_KM, latitude_longitude};
use crate::surface::planet::{Grip, Planet, PlateFacts};

/// Version of the report's form; raised when a field changes its meaning or goes.
pub const GLOBE_REPORT_VERSION: u32 = 1;

/// Lowest and highest edge of the bins of heights, metres, and how wide each is.
const BINS_M: (f64, f64) = (-10_000.0, 9_000.0);
const BIN_M: f64 = 500.0;
/// Square kilometres of a steradian.
const SR_KM2: f64 = RADIUS_KM * RADIUS_KM;

/// The whole report of a session on the globe.
#[derive(Clone, Debug, Serialize)]
pub struct GlobeReport {
    /// [`GLOBE_REPORT_VERSION`].
    pub format_version: u32,
    /// Version of the program.
    pub orogen: &'static str,
    /// Always `globe`.
    pub mode: &'static str,
    /// What went in.
    pub inputs: GlobeInputs,
    /// Model time, My.
    pub time_my: f64,
    /// The plates at the end, by name.
    pub plates: Vec<GlobePlate>,
    /// What has happened: areas made and consumed, collisions, rifts, heights held at their limit, numbers that were none.
    pub totals: Totals,
    /// How high how much of the planet lies.
    pub hypsometry: Hypsometry,
    /// The touches.
    pub contacts: ContactFacts,
    /// What they did.
    pub deeds: GlobeDeeds,
    /// SHA-256 of the heights of all samples, f64 little-endian in their order.
    pub digest: String,
}

/// What went into a planet.
#[derive(Clone, Debug, Serialize)]
pub struct GlobeInputs {
    /// Title of the gesture file, or of the planet.
    pub title: String,
    /// The one seed.
    pub seed: u64,
    /// Samples.
    pub samples: usize,
    /// `random`, or `maps` for a planet from images.
    pub start: &'static str,
    /// Plates at the start.
    pub plates: u32,
    /// Share of continental crust that a random planet was to have.
    pub continental: Option<f64>,
    /// `planet`, `paper`, or `own` for other constants.
    pub preset: &'static str,
    /// Time of a step, My.
    pub dt_my: f64,
}

impl GlobeInputs {
    fn new(title: &str, sim: &GlobeSim) -> Self {
        let params = sim.params().globe;
        let (start, plates, continental, seed) = match sim.start() {
            Start::Random {
                plates,
                continental,
                seed,
            } => ("random", *plates, Some(*continental), *seed),
            Start::Maps { plate, seed, .. } => {
                let most = plate.iter().max().map_or(0, |&most| u32::from(most) + 1);
                ("maps", most, None, *seed)
            }
        };
        Self {
            title: title.to_owned(),
            seed,
            samples: sim.planet().lattice().len(),
            start,
            plates,
            continental,
            preset: if params == GlobeParams::planet() {
                "planet"
            } else if params == GlobeParams::paper() {
                "paper"
            } else {
                "own"
            },
            dt_my: params.dt_my,
        }
    }
}

/// A plate.
#[derive(Clone, Debug, Serialize)]
pub struct GlobePlate {
    /// Its name for life.
    pub id: u32,
    /// Area, million km².
    pub area_mkm2: f64,
    /// Share of it that is continental, 0–1.
    pub continental: f64,
    /// Euler pole, degrees north and east, about which it turns counter-clockwise; none where it stands still.
    pub pole_deg: Option<[f64; 2]>,
    /// Rate, degrees per My.
    pub rate_deg_per_my: f64,
    /// `free`, `anchored` or `led`.
    pub grip: &'static str,
}

impl GlobePlate {
    fn new(plate: &PlateFacts) -> Self {
        let rate = plate.omega.length();
        let pole = (rate > 0.0).then(|| latitude_longitude(plate.omega / rate));
        Self {
            id: plate.id,
            area_mkm2: plate.area_sr * SR_KM2 / 1e6,
            continental: plate.continental,
            pole_deg: pole.map(|(latitude, longitude)| [latitude, longitude]),
            rate_deg_per_my: rate.to_degrees(),
            grip: match plate.grip {
                Grip::Free => "free",
                Grip::Anchored => "anchored",
                Grip::Led => "led",
            },
        }
    }
}

/// How high how much of a planet lies. Shares are of the planet's area, 0–1, unless they say otherwise.
#[derive(Clone, Debug, Serialize)]
pub struct Hypsometry {
    /// Lowest, metres.
    pub min_m: f64,
    /// Highest, metres.
    pub max_m: f64,
    /// Share above the sea.
    pub land_share: f64,
    /// Share of continental crust.
    pub continental_share: f64,
    /// Mean height of land, metres; 0 without land.
    pub mean_land_m: f64,
    /// Mean height of the sea floor, metres; 0 without sea.
    pub mean_ocean_m: f64,
    /// Share of land above 1 km.
    pub land_above_1_km: f64,
    /// Share of land above 3 km.
    pub land_above_3_km: f64,
    /// Lower edge of the first bin, metres.
    pub bins_from_m: f64,
    /// Width of a bin, metres.
    pub bin_m: f64,
    /// Share per bin, upwards; what lies beyond is in the outermost.
    pub bins: Vec<f64>,
    /// Middles of the two fullest bins that are fuller than those beside them, metres, the lower first.
    pub modes_m: Vec<f64>,
    /// Middle of the emptiest bin between them, metres.
    pub valley_m: Option<f64>,
}

impl Hypsometry {
    /// Of a planet.
    pub fn new(planet: &Planet) -> Self {
        let count = ((BINS_M.1 - BINS_M.0) / BIN_M) as usize;
        let mut bins = vec![0.0; count];
        let (mut whole, mut continental) = (0.0, 0.0);
        let mut land = Part::default();
        let mut ocean = Part::default();
        let (mut above_1, mut above_3) = (0.0, 0.0);
        let samples = planet.elevation_m.iter().zip(planet.lattice.areas());
        for ((&metres, &area), &is_continental) in samples.zip(&planet.continental) {
            let metres = f64::from(metres);
            whole += area;
            continental += if is_continental { area } else { 0.0 };
            let part = if metres > 0.0 { &mut land } else { &mut ocean };
            part.area += area;
            part.moment += area * metres;
            above_1 += if metres > 1_000.0 { area } else { 0.0 };
            above_3 += if metres > 3_000.0 { area } else { 0.0 };
            let bin = ((metres - BINS_M.0) / BIN_M).max(0.0) as usize;
            bins[bin.min(count - 1)] += area;
        }
        for bin in &mut bins {
            *bin /= whole;
        }
        let of_land = |area: f64| if land.area > 0.0 { area / land.area } else { 0.0 };
        let heights = planet.elevation_m.iter().copied().map(f64::from);
        let modes = modes(&bins);
        let middle = |bin: usize| BINS_M.0 + (bin as f64 + 0.5) * BIN_M;
        Self {
            min_m: heights.clone().fold(f64::INFINITY, f64::min),
            max_m: heights.fold(f64::NEG_INFINITY, f64::max),
            land_share: land.area / whole,
            continental_share: continental / whole,
            mean_land_m: land.mean(),
            mean_ocean_m: ocean.mean(),
            land_above_1_km: of_land(above_1),
            land_above_3_km: of_land(above_3),
            bins_from_m: BINS_M.0,
            bin_m: BIN_M,
            valley_m: valley(&bins, &modes).map(middle),
            modes_m: modes.into_iter().map(middle).collect(),
            bins,
        }
    }
}

/// An area and the sum of its heights.
#[derive(Default)]
struct Part {
    area: f64,
    moment: f64,
}

impl Part {
    fn mean(&self) -> f64 {
        if self.area > 0.0 {
            self.moment / self.area
        } else {
            0.0
        }
    }
}

/// The two fullest bins that are fuller than those beside them, ascending; fewer where there are not two.
fn modes(bins: &[f64]) -> Vec<usize> {
    let at = |bin: Option<usize>| bin.and_then(|bin| bins.get(bin)).copied().unwrap_or(0.0);
    let mut peaks: Vec<usize> = (0..bins.len())
        .filter(|&bin| bins[bin] > at(bin.checked_sub(1)) && bins[bin] >= at(Some(bin + 1)))
        .collect();
    peaks.sort_by(|&a, &b| bins[b].total_cmp(&bins[a]));
    peaks.truncate(2);
    peaks.sort_unstable();
    peaks
}

fn valley(bins: &[f64], modes: &[usize]) -> Option<usize> {
    let &[low, high] = modes else { return None };
    (low + 1..high).min_by(|&a, &b| bins[a].total_cmp(&bins[b]))
}

/// What visitors did with a planet.
#[derive(Clone, Debug, Serialize)]
pub struct GlobeDeeds {
    /// Hands that led a plate.
    pub led: u64,
    /// Hands that held a plate where it was.
    pub anchored: u64,
    /// Plates torn by two hands.
    pub torn: u64,
    /// Plates cut along a drawn line.
    pub cut: u64,
    /// Tears and cuts that were refused.
    pub refused: u64,
    /// Strokes of the brush.
    pub painted: u64,
    /// Times that the view was turned or zoomed.
    pub views: u64,
    /// Times that undo brought an earlier planet back.
    pub undone: u64,
}

impl GlobeDeeds {
    fn new(counts: GlobeCounts) -> Self {
        Self {
            led: counts.led,
            anchored: counts.anchored,
            torn: counts.torn,
            cut: counts.cut,
            refused: counts.refused,
            painted: counts.painted,
            views: counts.views,
            undone: counts.undone,
        }
    }
}

impl GlobeReport {
    /// The report of a session whose planet looks like `surface`.
    pub fn of_session(title: &str, sim: &GlobeSim, surface: &Planet) -> Self {
        let heights: Vec<f64> = surface.elevation_m.iter().copied().map(f64::from).collect();
        let mut plates: Vec<GlobePlate> = surface.plates.iter().map(GlobePlate::new).collect();
        plates.sort_by_key(|plate| plate.id);
        let (stats, counts) = (sim.contact_stats(), sim.counts());
        Self {
            format_version: GLOBE_REPORT_VERSION,
            orogen: env!("CARGO_PKG_VERSION"),
            mode: "globe",
            inputs: GlobeInputs::new(title, sim),
            time_my: surface.time_my,
            plates,
            totals: sim.planet().totals(),
            hypsometry: Hypsometry::new(surface),
            contacts: ContactFacts {
                total: stats.total,
                hands: stats.hands,
                pushes: counts.led,
                taps: counts.taps,
                dropped_ghosts: stats.dropped_ghosts,
                stuck: stats.stuck,
                dead_touches: counts.dead_touches,
                idle_commands: counts.idle_commands,
                rolled_back: counts.rolled_back,
            },
            deeds: GlobeDeeds::new(counts),
            digest: digest(&heights),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_the_two_fullest_peaks_and_the_valley_lies_between() {
        let bins = [0.1, 0.3, 0.2, 0.0, 0.05, 0.04, 0.25, 0.06];
        let found = modes(&bins);
        assert_eq!(found, [1, 6]);
        assert_eq!(valley(&bins, &found), Some(3));
        assert_eq!(modes(&[0.0, 1.0, 0.0]), [1]);
        assert_eq!(valley(&[0.0, 1.0, 0.0], &[1]), None);
    }
}
