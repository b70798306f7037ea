//! `--quality final`: the land of a session on a million nodes, and a box of it on nodes a few metres apart.

use glam::DVec2;
use indicatif::ProgressBar;
use serde::Serialize;

use super::console::Console;
use super::failure::Failure;
use super::output::{LandFiles, Marks, Pictures, Timings, write_json};
use super::replay::write_session;
use super::{Quality, ReplayArgs, memory};
#[cfg(feature = "app")]
use crate::app::LongWork;
use crate::export::{OutDir, digest};
use crate::report::{RefinementFacts, TerrainFacts};
use crate::sim::refine::{FINAL_NODES, RefineError, Refined, Refinement, Region};
use crate::sim::{Checkpoint, Sim, SimParams};
use crate::terrain::{Flow, Outlets};
use crate::units::{Extent, KM};

/// Pixels along the width of final pictures, where the user names none: 4K.
pub(super) const SIZE: u32 = 3840;
/// Metres between the nodes of a box, where the user names none.
const SPACING_M: f64 = 5.0;
/// Parts of a progress bar.
const PARTS: u64 = 1000;
/// Folder of a box, in that of its land.
const FOLDER: &str = "region";

/// `X,Y,SIDE` or `X,Y,SIDE,METRES`.
pub(super) fn region(text: &str) -> Result<Region, String> {
    let expected = || "expected X,Y,SIDE in km, or X,Y,SIDE,METRES".to_owned();
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse::<f64>()).collect();
    let (x, y, side, spacing) = match numbers.map_err(|_| expected())?[..] {
        [x, y, side] => (x, y, side, SPACING_M),
        [x, y, side, spacing] => (x, y, side, spacing),
        _ => return Err(expected()),
    };
    Ok(Region {
        south_west: DVec2::new(x, y) * KM,
        side: side * KM,
        spacing,
    })
}

/// Refuses what can be refused before the work on a session whose live land has `live` nodes and covers `land`.
pub(super) fn check(args: &ReplayArgs, live: usize, land: Extent) -> Result<(), Failure> {
    if args.quality == Quality::Live {
        if args.region.is_some() {
            return Err(Failure::input("--region: expected --quality final beside it"));
        }
        return memory::check(live);
    }
    let nodes = nodes(args);
    if nodes <= live {
        return Err(Failure::input(format!(
            "--nodes {nodes}: expected more than the {live} of the live land"
        )));
    }
    let Some(region) = args.region else {
        return memory::check(nodes);
    };
    region
        .check(land)
        .map_err(|error| Failure::input(format!("--region: {error}")))?;
    memory::check(nodes + region.nodes())
}

/// Nodes of the final land.
fn nodes(args: &ReplayArgs) -> usize {
    args.common.nodes.map_or(FINAL_NODES, |nodes| nodes as usize)
}

/// Refines the land of `sim` and writes it.
pub(super) fn play(
    sim: Sim,
    args: &ReplayArgs,
    (title, out): (&str, &OutDir),
    pictures: &Pictures,
    mut timings: Timings,
    console: Console,
) -> Result<(), Failure> {
    let size = args.common.size.unwrap_or(SIZE);
    let live = sim.checkpoint();
    drop(sim);
    let refinement = Refinement::of_land(&live, nodes(args)).map_err(failure)?;
    let refined = run(refinement, "final land", console)?;
    timings.lap("refine");
    let region = match args.region {
        Some(region) => {
            let refinement = Refinement::of_region(live.params(), &refined, region).map_err(failure)?;
            let refined = run(refinement, "region", console)?;
            timings.lap("refine_region");
            Some((region, refined))
        }
        None => None,
    };
    let params = live.params().clone();
    let refinement = facts(&live, &refined);
    let land = Sim::resume(live.refined(refined));
    write_session((&land, Some(refinement)), title, out, (size, pictures), timings)?;
    drop(land);
    if let Some((region, refined)) = region {
        let out = OutDir::create(out.path().join(FOLDER)).map_err(Failure::input)?;
        write_region(&refined, region, &params, (title, &out), (size, pictures))?;
    }
    Ok(())
}

fn failure(error: RefineError) -> Failure {
    match error {
        RefineError::Nodes(_) | RefineError::Region(_) | RefineError::Coarser { .. } => Failure::input(error),
        RefineError::NotFinite { .. } => Failure::other(error),
    }
}

/// All steps, with a progress bar.
fn run(mut refinement: Refinement, label: &str, console: Console) -> Result<Refined, Failure> {
    let bar: ProgressBar = console.progress(PARTS, label);
    while refinement.step().map_err(failure)? {
        bar.set_message(format!("{label}: {} nodes", refinement.nodes()));
        bar.set_position((refinement.progress() * PARTS as f64) as u64);
    }
    bar.finish_and_clear();
    Ok(refinement.finish())
}

/// Part of the work on a final land that is done when its files begin (19 of 38 s).
#[cfg(feature = "app")]
const REFINED: f64 = 0.5;

/// The final land of `live`, while `work` goes on.
#[cfg(feature = "app")]
pub(super) fn watched(live: &Checkpoint, work: &LongWork) -> Result<(Sim, RefinementFacts), Failure> {
    memory::check(FINAL_NODES)?;
    let mut refinement = Refinement::of_land(live, FINAL_NODES).map_err(failure)?;
    loop {
        go_on(work, REFINED * refinement.progress())?;
        if !refinement.step().map_err(failure)? {
            break;
        }
    }
    let refined = refinement.finish();
    let facts = facts(live, &refined);
    Ok((Sim::resume(live.clone().refined(refined)), facts))
}

/// Says how much of the work is done; an error where nobody wants it any more.
#[cfg(feature = "app")]
pub(super) fn go_on(work: &LongWork, done: f64) -> Result<(), Failure> {
    if work.goes_on(done) {
        Ok(())
    } else {
        Err(Failure::other("cancelled"))
    }
}

fn facts(live: &Checkpoint, refined: &Refined) -> RefinementFacts {
    RefinementFacts {
        live_nodes: live.world().tin.len(),
        steps: refined.steps,
        dt_yr: refined.dt_yr,
    }
}

/// `report.json` of a box.
#[derive(Serialize)]
struct RegionReport<'a> {
    title: &'a str,
    /// South-west corner in the plan of the land, km.
    south_west_km: [f64; 2],
    side_km: f64,
    /// Metres between nodes.
    spacing_m: f64,
    terrain: TerrainFacts,
    digest: String,
}

fn write_region(
    refined: &Refined,
    region: Region,
    params: &SimParams,
    (title, out): (&str, &OutDir),
    (size, pictures): (u32, &Pictures),
) -> Result<(), Failure> {
    let mut timings = Timings::start();
    let world = &refined.world;
    let mut flow = Flow::new(&world.tin);
    flow.route(&world.tin, &world.z, Outlets::Border, refined.rain.as_deref());
    let k = vec![params.erosion.k; world.tin.len()];
    let mut terrain = TerrainFacts::new(&world.tin, &world.z, &flow, world.strata.base());
    terrain.years = world.time_yr;
    terrain.steps = refined.steps as u64;
    let report = RegionReport {
        title,
        south_west_km: (region.south_west / KM).into(),
        side_km: region.side / KM,
        spacing_m: region.spacing,
        terrain,
        digest: digest(&world.z),
    };
    let land = LandFiles {
        title,
        tin: &world.tin,
        z: &world.z,
        uplift: &refined.uplift,
        flow: &flow,
        k: &k,
        marks: Marks::default(),
        under: Some(world.underground()),
        elapsed_yr: world.time_yr,
    };
    land.write(out, size, &pictures.without_slices(), &mut timings)?;
    write_json(out, "report.json", &report)?;
    write_json(out, "timings.json", &timings.finish())
}
