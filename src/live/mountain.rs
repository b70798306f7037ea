//! The mountain, played live.

use std::io;
use std::sync::Arc;

use super::chart::{Chart, Slot};
use super::play::{Play, Published};
use super::{Frame, Ring};
use crate::gesture::command::{Action, Command};
use crate::gesture::contact::InputFrame;
use crate::gesture::file::Header;
use crate::mountain::Stages;
use crate::rock::{Stratigraphy, preset};
use crate::sim::{Checkpoint, Sim, SimParams, TICK_US, World};
use crate::terrain::TinError;
use crate::units::{MYR, PlanMap};

/// What a session of the mountain needs to know.
#[derive(Debug)]
pub struct LiveParams {
    /// How the table lies on the land.
    pub map: PlanMap,
    /// Nodes of the land.
    pub nodes: usize,
    /// Seed of the first land.
    pub seed: u64,
    /// The rock under every fresh land.
    pub layers: Arc<Stratigraphy>,
    /// Parameters of the session itself.
    pub sim: SimParams,
    /// Columns of the rasters in a frame; cells are square.
    pub raster_width: usize,
    /// Threads that compute; 0 takes one per core.
    pub threads: usize,
    /// Who computes transport and folds.
    pub stages: Stages,
}

/// What a session of the mountain begins again with.
#[derive(Clone, Debug)]
pub enum Start {
    /// The land of a seed. The seed that the session had is quicker than another.
    Seed(u64),
    /// The land of a seed on so many nodes, which every land from a seed has from then on.
    Nodes {
        /// The seed.
        seed: u64,
        /// Nodes of the land.
        nodes: usize,
    },
    /// A land that was kept. Its table must be that of the session.
    World(Box<World>),
}

/// The mountain on its session's thread.
#[derive(Debug)]
pub struct Mountain {
    params: LiveParams,
    sim: Sim,
    chart: Chart,
    ring: Ring,
    /// The land that the session began with.
    first: World,
    /// Where to go on from after a panic.
    good: Checkpoint,
}

impl Play for Mountain {
    type Params = LiveParams;
    type Start = Start;
    type Kept = Checkpoint;
    type Frame = Frame;
    type Slot = Slot;

    fn threads(params: &LiveParams) -> usize {
        params.threads
    }

    fn open(mut params: LiveParams) -> io::Result<Self> {
        let first = new_world(&params, params.seed)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        let mut sim = Sim::new(first.clone(), params.sim.clone());
        sim.replace_stages(std::mem::take(&mut params.stages));
        Ok(Self {
            chart: Chart::new(&first, params.raster_width),
            ring: new_ring(&first, &params.sim),
            good: sim.checkpoint(),
            params,
            sim,
            first,
        })
    }

    fn slot(&self) -> Slot {
        self.chart.slot()
    }

    fn ticks(&self) -> u64 {
        self.sim.ticks()
    }

    fn feed(&mut self, frame: InputFrame) {
        self.ring.record(&frame);
        self.sim.feed(frame);
    }

    fn tick(&mut self) -> u32 {
        self.sim.tick().erosion_steps
    }

    fn draw(&mut self, slot: &mut Slot, published: Published) {
        let changed = self.sim.refresh_uplift();
        self.chart.draw(&self.sim, changed, slot);
        slot.frame.sequence = published.sequence;
        slot.frame.panics = published.panics;
        slot.frame.steps = published.steps;
    }

    /// A session afresh.
    fn begin(&mut self, start: Start) {
        let world = match start {
            Start::Seed(seed) => self.land(seed),
            Start::Nodes { seed, nodes } => {
                self.params.nodes = nodes;
                self.land(seed)
            }
            Start::World(world) => *world,
        };
        let stages = self.sim.replace_stages(Stages::default());
        self.sim = Sim::new(world.clone(), self.params.sim.clone());
        self.sim.replace_stages(stages);
        self.good = self.sim.checkpoint();
        self.ring = new_ring(&world, &self.params.sim);
        if Arc::ptr_eq(&world.tin, &self.first.tin) {
            self.chart.forget();
        } else {
            self.chart.move_to(&world);
        }
        self.first = world;
    }

    fn remember(&mut self) {
        self.good = self.sim.checkpoint();
    }

    /// After a panic: the last good moment comes back, without contacts. If that panics again within a second, its land
    /// alone; if that does too, the land that the session began with. From then on the processor computes all stages:
    /// nobody knows whose fault it was.
    fn recover(&mut self, relapses: u32) {
        let tick = self.sim.ticks();
        let afresh = |world: &World| Sim::new(world.clone(), self.params.sim.clone()).checkpoint();
        let checkpoint = match relapses {
            0 => self.good.clone(),
            1 => afresh(self.good.world()),
            _ => afresh(&self.first),
        };
        self.good = checkpoint.at_tick(tick);
        self.sim = Sim::resume(self.good.clone());
        self.sim.cancel_contacts();
        self.ring.cancel_contacts(tick * TICK_US);
        // The panic may have come while the chart was half-way to another land.
        self.chart.move_to(self.sim.world());
    }

    fn kept(&self) -> Checkpoint {
        self.sim.checkpoint()
    }

    fn ring(&self) -> &Ring {
        &self.ring
    }
}

impl Mountain {
    /// The land of `seed`. Where it cannot be made, the one that the session began with.
    fn land(&self, seed: u64) -> World {
        let first = &self.first;
        if seed == first.seed && self.params.nodes == first.tin.len() {
            return first.clone();
        }
        new_world(&self.params, seed).unwrap_or_else(|_| first.clone())
    }
}

/// The land of `seed` on a table as `params` has it.
fn new_world(params: &LiveParams, seed: u64) -> Result<World, TinError> {
    let world = World::new(params.map, params.nodes, seed)?;
    Ok(world.with_layers(Arc::clone(&params.layers)))
}

/// A ring for a session that begins with `world`.
fn new_ring(world: &World, params: &SimParams) -> Ring {
    let header = Header {
        title: Some("the last minute at the table".to_owned()),
        seed: Some(world.seed),
        nodes: Some(world.tin.len() as u64),
        ..Header::new(world.map.size_mm())
    };
    let usual = params.pace_yr_per_s == SimParams::default().pace_yr_per_s;
    let mut ring = Ring::new(header, (!usual).then_some(params.pace_yr_per_s / MYR));
    if *world.stratigraphy != *preset::default() {
        // A replay lays it first.
        ring.record(&InputFrame {
            t_us: 0,
            events: Vec::new(),
            commands: vec![Command::new(Action::Pile(Arc::clone(&world.stratigraphy)))],
        });
    }
    ring
}
