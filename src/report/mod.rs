//! `report.json`: the facts of a run, without times, so that equal inputs give equal bytes.

mod globe;
mod range;

use glam::DVec2;
use serde::Serialize;

pub use globe::{GLOBE_REPORT_VERSION, GlobeDeeds, GlobeInputs, GlobePlate, GlobeReport, Hypsometry};
pub use range::RangeFacts;

use crate::export::digest;
use crate::gesture::hand::ContactStats;
use crate::mountain::fold::FoldStats;
use crate::mountain::tectonics::TectonicReport;
use crate::mountain::transport::TransportReport;
use crate::mountain::{MountainParams, Plate, PlateState};
use crate::sim::{FoldingLayer, SessionCounts, Sim, World};
use crate::terrain::{Flow, NodeId, Tin};
use crate::units::KM;

/// Version of the report's form; raised when a field changes its meaning or goes.
pub const REPORT_VERSION: u32 = 1;

/// The whole report of a replayed session.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// [`REPORT_VERSION`].
    pub format_version: u32,
    /// Version of the program.
    pub orogen: &'static str,
    /// What went in.
    pub inputs: Inputs,
    /// How the land of the session was refined, where it was.
    pub refinement: Option<RefinementFacts>,
    /// The plates that stand at the end, oldest first.
    pub plates: Vec<PlateFacts>,
    /// The transport field at the last moment when a plate moved.
    pub transport: Option<TransportFacts>,
    /// The uplift at that moment.
    pub uplift: Option<UpliftFacts>,
    /// The folds at that moment, longest first.
    pub folds: Vec<FoldFacts>,
    /// The land.
    pub terrain: TerrainFacts,
    /// The touches.
    pub contacts: ContactFacts,
    /// Numbers that were none and never reached the land.
    pub quarantine: QuarantineFacts,
    /// The same input gives these bits on every machine. Not so where a graphics card has computed a stage: it is as
    /// right, and rounds in its own way.
    pub reproducible: bool,
    /// SHA-256 of the heights of all nodes, f64 little-endian in node order.
    pub digest: String,
}

/// How a land got its detail after the session; no time passes for it.
#[derive(Clone, Debug, Serialize)]
pub struct RefinementFacts {
    /// Nodes of the land that hands shaped.
    pub live_nodes: usize,
    /// Erosion steps on the last level.
    pub steps: usize,
    /// Length of one of them, years.
    pub dt_yr: f64,
}

/// What went into a run.
#[derive(Clone, Debug, Serialize)]
pub struct Inputs {
    /// The pile of rock layers at the end; none where the rock is all alike.
    pub layers: Option<String>,
    /// Title of the gesture file, or the map that was eroded.
    pub title: String,
    /// The one seed.
    pub seed: u64,
    /// Nodes of the TIN.
    pub nodes: usize,
    /// Ground covered, km.
    pub size_km: [f64; 2],
    /// Length of an erosion step, years.
    pub dt_yr: f64,
    /// Stream power k, y⁻¹ (for m = 0.5).
    pub k: f64,
    /// Area exponent.
    pub m: f64,
    /// Slope exponent.
    pub n: f64,
}

/// One plate.
#[derive(Clone, Debug, Serialize)]
pub struct PlateFacts {
    /// Middle of its support, km east and north of the south-west corner.
    pub anchor: [f64; 2],
    /// Arrows.
    pub fingers: usize,
    /// Turn of the (capped) motion, radians counter-clockwise.
    pub angle_rad: f64,
    /// How far the motion takes the anchor, km.
    pub translation_km: [f64; 2],
    /// What the rigid fit leaves unexplained, km.
    pub residual_km: f64,
    /// Longest diameter of the support, km.
    pub support_km: f64,
    /// `resting`, `pushing` or `standing`.
    pub state: &'static str,
    /// Share of the motion that the next hull let pass, 0–1.
    pub cap: f64,
    /// How much of the push is spent, 0–1.
    pub spent: f64,
    /// Convergence, mm/yr: the arrow over the length of a push.
    pub convergence_mm_per_yr: f64,
}

/// The transport field.
#[derive(Clone, Debug, Serialize)]
pub struct TransportFacts {
    /// Cells of the grid.
    pub cells: usize,
    /// Side of a cell, km.
    pub cell_km: f64,
    /// Least amount of crust in a cell (1 = undisturbed).
    pub q_min: f64,
    /// Most.
    pub q_max: f64,
    /// Σ q a, km².
    pub volume: f64,
    /// Signed area that the border of the map comes from, km²: equal to `volume`.
    pub preimage_area: f64,
    /// Cells turned over.
    pub folded_cells: usize,
}

impl TransportFacts {
    fn new(report: &TransportReport) -> Self {
        Self {
            cells: report.cells,
            cell_km: report.cell_km,
            q_min: report.q_min,
            q_max: report.q_max,
            volume: report.volume,
            preimage_area: report.preimage_area,
            folded_cells: report.folded_cells,
        }
    }
}

/// The uplift.
#[derive(Clone, Debug, Serialize)]
pub struct UpliftFacts {
    /// Mean over the ground that rises, m/yr.
    pub mean_m_per_yr: f64,
    /// Most, m/yr.
    pub max_m_per_yr: f64,
    /// Least (subsidence is negative), m/yr.
    pub min_m_per_yr: f64,
}

impl UpliftFacts {
    fn new(report: &TectonicReport) -> Self {
        Self {
            mean_m_per_yr: report.mean_uplift,
            max_m_per_yr: report.max_uplift,
            min_m_per_yr: report.min_uplift,
        }
    }
}

impl PlateFacts {
    fn new(plate: &Plate, now_yr: f64, params: &MountainParams) -> Self {
        let anchor = plate.support.centre();
        let way = plate.motion.apply(anchor) - anchor;
        let diameter = (0..180)
            .map(|degree| {
                let direction = DVec2::from_angle(f64::from(degree).to_radians());
                plate.support.support(direction) + plate.support.support(-direction)
            })
            .fold(0.0, f64::max);
        Self {
            anchor: (anchor / KM).into(),
            fingers: plate.starts.len(),
            angle_rad: plate.motion.angle,
            translation_km: (way / KM).into(),
            residual_km: plate.fit.residual / KM,
            support_km: diameter / KM,
            state: match plate.state(now_yr) {
                PlateState::Resting => "resting",
                PlateState::Pushing => "pushing",
                PlateState::Standing => "standing",
            },
            cap: plate.cap,
            spent: plate.spent(now_yr),
            convergence_mm_per_yr: way.length() / params.push_years * 1e3,
        }
    }
}

impl ContactFacts {
    fn new(stats: &ContactStats, counts: SessionCounts) -> Self {
        Self {
            total: stats.total,
            hands: stats.hands,
            pushes: stats.pushes,
            taps: stats.taps,
            dropped_ghosts: stats.dropped_ghosts,
            stuck: stats.stuck,
            dead_touches: counts.dead_touches,
            idle_commands: counts.idle_commands,
            rolled_back: counts.rolled_back,
        }
    }
}

/// The land.
#[derive(Clone, Debug, Serialize)]
pub struct TerrainFacts {
    /// Nodes.
    pub nodes: usize,
    /// Model years.
    pub years: f64,
    /// Erosion steps.
    pub steps: u64,
    /// Lowest height, m.
    pub min_m: f64,
    /// Highest height, m.
    pub max_m: f64,
    /// Mean height over the area, m.
    pub mean_m: f64,
    /// Rock added by uplift less rock lost by subsidence, km³.
    pub uplifted_km3: f64,
    /// Rock taken by rivers and landslides, km³.
    pub eroded_km3: f64,
    /// Volume that rivers and lakes laid down, km³.
    pub deposited_km3: f64,
    /// Volume of sediment carried off the land, km³.
    pub exported_km3: f64,
    /// Area that drains over the outlets, km²: the whole map.
    pub outlet_area_km2: f64,
    /// Lakes of at least a node.
    pub lakes: usize,
    /// Area under water, km².
    pub lake_area_km2: f64,
    /// Longest way of water, km.
    pub longest_river_km: f64,
    /// What makes a range a range.
    #[serde(flatten)]
    pub range: RangeFacts,
}

impl TerrainFacts {
    /// Facts of the land `z` on `tin` with the water `flow` over it; `risen_m` is what uplift added at each node.
    pub fn new(tin: &Tin, z: &[f64], flow: &Flow, risen_m: &[f64]) -> Self {
        let areas = tin.areas();
        let total: f64 = areas.iter().sum();
        let mean = z.iter().zip(areas).map(|(z, a)| z * a).sum::<f64>() / total;
        let km2 = KM * KM;
        let lakes = flow.lakes();
        let wet = (0..z.len()).filter(|&i| lakes.level(NodeId::new(i), z[i]) > z[i]);
        // The sum of nothing is −0.
        let lake_area = wet.map(|i| areas[i]).sum::<f64>() + 0.0;
        Self {
            nodes: tin.len(),
            years: 0.0,
            steps: 0,
            min_m: z.iter().copied().fold(f64::INFINITY, f64::min),
            max_m: z.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            mean_m: mean,
            uplifted_km3: 0.0,
            eroded_km3: 0.0,
            deposited_km3: 0.0,
            exported_km3: 0.0,
            outlet_area_km2: outlet_area(flow) / km2,
            lakes: lakes.count(),
            lake_area_km2: lake_area / km2,
            longest_river_km: range::longest_way(tin, flow) / KM,
            range: RangeFacts::new(tin, z, flow, risen_m),
        }
    }
}

/// Drainage area of all outlets together, m².
fn outlet_area(flow: &Flow) -> f64 {
    let outlets = flow.order().iter().filter(|&&node| flow.receiver(node).is_none());
    outlets.map(|node| flow.drainage()[node.index()]).sum()
}

/// The touches.
#[derive(Clone, Debug, Serialize)]
pub struct ContactFacts {
    /// Contacts that went down.
    pub total: u64,
    /// Hands.
    pub hands: u64,
    /// Pushes (each reversal begins a new one).
    pub pushes: u64,
    /// Touches that did not move: each raises a dome.
    pub taps: u64,
    /// Contacts taken for palms, sleeves or ghosts, or withdrawn by their source.
    pub dropped_ghosts: u64,
    /// Contacts that were stuck.
    pub stuck: u64,
    /// Touches that changed nothing anybody could see.
    pub dead_touches: u64,
    /// Commands that mean nothing in this mode.
    pub idle_commands: u64,
    /// Times that a palm's work was taken back.
    pub rolled_back: u64,
}

/// The folds of one pair of layers.
#[derive(Clone, Debug, Serialize)]
pub struct FoldFacts {
    /// The layer that folds, and the one it folds over.
    pub layers: [String; 2],
    /// Wavelength asked for, m.
    pub wavelength_m: f64,
    /// Mean wavelength where the land is compressed, m.
    pub realised_m: f64,
    /// Edges of the top skeleton.
    pub top_edges: usize,
    /// Lines of the bottom skeleton.
    pub bottom_edges: usize,
    /// Part of the crests' nodes where a crest ends.
    pub end_fraction: f64,
    /// Part where crests meet.
    pub triple_fraction: f64,
    /// Mean length of crests, m.
    pub mean_length: f64,
}

impl FoldFacts {
    fn new(world: &World, layer: FoldingLayer, stats: &FoldStats) -> Self {
        let name = |layer| world.stratigraphy.layer_name(layer).to_owned();
        Self {
            layers: [name(layer.interface - 1), name(layer.interface)],
            wavelength_m: stats.wavelength,
            realised_m: stats.realised_wavelength,
            top_edges: stats.top_edges,
            bottom_edges: stats.bottom_edges,
            end_fraction: stats.end_fraction,
            triple_fraction: stats.triple_fraction,
            mean_length: stats.mean_chain_length,
        }
    }
}

/// Numbers that were none.
#[derive(Clone, Debug, Serialize)]
pub struct QuarantineFacts {
    /// Nodes whose uplift was not finite.
    pub uplift_nodes: u64,
    /// Steps thrown away.
    pub steps: u64,
}

impl Report {
    /// The report of a session as it stands, with the water `flow` over its land.
    pub fn of_session(title: &str, sim: &Sim, flow: &Flow) -> Self {
        let world = sim.world();
        let params = sim.params();
        let extent = world.map.extent();
        let risen = world.strata.base();
        let mut terrain = TerrainFacts::new(&world.tin, &world.z, flow, risen);
        terrain.years = world.time_yr;
        terrain.steps = world.totals.steps;
        terrain.uplifted_km3 = world.totals.uplifted_m3 / 1e9;
        terrain.eroded_km3 = world.totals.eroded_m3 / 1e9;
        terrain.deposited_km3 = world.totals.deposited_m3 / 1e9;
        terrain.exported_km3 = world.totals.exported_m3 / 1e9;
        let counts = sim.counts();
        let quarantine = sim.quarantine();
        let motion = sim.last_motion();
        Self {
            format_version: REPORT_VERSION,
            orogen: env!("CARGO_PKG_VERSION"),
            inputs: Inputs {
                layers: Some(world.stratigraphy.name().to_owned()),
                title: title.to_owned(),
                seed: world.seed,
                nodes: world.tin.len(),
                size_km: [extent.width / KM, extent.height / KM],
                dt_yr: params.erosion_dt_yr,
                k: params.erosion.k,
                m: params.erosion.m,
                n: params.erosion.n,
            },
            refinement: None,
            plates: world
                .plates
                .plates()
                .iter()
                .map(|plate| PlateFacts::new(plate, world.time_yr, &params.mountain))
                .collect(),
            transport: motion.map(|report| TransportFacts::new(&report.transport)),
            uplift: motion.map(|report| UpliftFacts::new(&report)),
            folds: sim
                .fold_stats()
                .into_iter()
                .map(|(layer, stats)| FoldFacts::new(world, layer, &stats))
                .collect(),
            terrain,
            contacts: ContactFacts::new(&sim.contact_stats(), counts),
            quarantine: QuarantineFacts {
                uplift_nodes: quarantine.uplift_nodes,
                steps: quarantine.steps,
            },
            reproducible: sim.is_reproducible(),
            digest: digest(&world.z),
        }
    }
}
