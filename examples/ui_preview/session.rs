//! A land with real marks to draw on: a gesture file, played so far.

use std::error::Error;
use std::fs::File;
use std::io::BufReader;

use glam::DVec2;
use orogen::gesture::file::read_gesture;
use orogen::gesture::hand::{HandTracker, HandView};
use orogen::gesture::params::GestureParams;
use orogen::render::Camera;
use orogen::sim::{Sim, SimParams, TICK_US, World};
use orogen::surface::rivers::{FlowGraph, drawn};
use orogen::surface::{Raster, Surface};
use orogen::terrain::{NodeId, TinRaster};
use orogen::units::{DEFAULT_SHORT_SIDE, KM, PlanMap};

/// Rivers are drawn from this drainage area on, m².
const RIVER_AREA: f64 = 15.0 * KM * KM;

/// A session at one moment.
pub(crate) struct Moment {
    /// The table.
    pub(crate) map: PlanMap,
    /// The land and its marks.
    pub(crate) surface: Surface,
    /// The hands that are down.
    pub(crate) hands: Vec<HandView>,
    /// The eye.
    pub(crate) camera: Camera,
}

/// The session of a gesture file of `gestures/` after `seconds`, on a terrain of `nodes`, rasters `width` wide.
pub(crate) fn play(name: &str, seconds: f64, nodes: usize, width: usize) -> Result<Moment, Box<dyn Error>> {
    let path = format!("{}/gestures/{name}.gesture.jsonl", env!("CARGO_MANIFEST_DIR"));
    let file = read_gesture(BufReader::new(File::open(&path)?), &path)?;
    let map = PlanMap::new(file.header.size_mm, DEFAULT_SHORT_SIDE);
    let mut sim = Sim::new(World::new(map, nodes, 7)?, SimParams::default());
    let mut tracker = HandTracker::new(GestureParams::default(), file.header.size_mm);
    let end_us = (seconds * 1e6) as u64;
    for frame in file.frames.iter().filter(|frame| frame.t_us <= end_us) {
        tracker.feed(frame);
        sim.feed(frame.clone());
    }
    for tick in 0..=end_us / TICK_US {
        tracker.tick(tick * TICK_US);
        sim.tick();
    }
    Ok(Moment {
        map,
        surface: surface(&sim, map, width),
        hands: tracker.hands().collect(),
        camera: Camera::plan(map.extent(), DVec2::ONE),
    })
}

fn surface(sim: &Sim, map: PlanMap, width: usize) -> Surface {
    let world = sim.world();
    let (tin, flow, extent) = (&world.tin, sim.flow(), map.extent());
    let height = (width as f64 * extent.height / extent.width).round() as usize;
    let pixels = TinRaster::new(tin, width, height);
    let raster = |data| Raster {
        width,
        height,
        extent,
        data,
    };
    let depth: Vec<f64> = (0..tin.len())
        .map(|i| flow.lakes().level(NodeId(i as u32), world.z[i]) - world.z[i])
        .collect();
    let receivers: Vec<u32> = flow.receivers().iter().map(|receiver| receiver.0).collect();
    let graph = FlowGraph {
        positions: tin.positions(),
        receivers: &receivers,
        drainage: flow.drainage(),
        lake: &depth.iter().map(|&d| d > 0.5).collect::<Vec<_>>(),
    };
    Surface {
        height: raster(pixels.smooth(tin, &world.z)),
        lake_depth: raster(pixels.linear(&depth)),
        drainage: raster(pixels.linear(flow.drainage())),
        spacing: tin.spacing(),
        rivers: drawn(graph, RIVER_AREA),
        plates: sim.plate_marks(),
        faults: sim.fault_traces(),
        folds: Vec::new(),
        strata: None,
        elapsed_yr: world.time_yr,
    }
}

/// The fingers of all hands, table mm.
pub(crate) fn fingers(hands: &[HandView]) -> impl Iterator<Item = DVec2> + '_ {
    hands.iter().flat_map(|hand| hand.fingers.iter().copied())
}
