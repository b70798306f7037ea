//! One tick: hand events → plates → uplift → a step of the land.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use super::drive::Uplift;
use super::exposure::Exposure;
use super::folding::{Folding, LayerSkeleton};
use super::history::History;
use super::resume::Checkpoint;
use super::rollback::Rollback;
use super::wear::Wear;
use super::{SimParams, TICK_US, World};
use crate::gesture::contact::{ContactKey, InputFrame, Side};
use crate::gesture::event::{HandEvent, Leg};
use crate::gesture::hand::{ContactStats, HandTracker};
use crate::isostasy::{Crust, Isostasy};
use crate::mountain::fold::FoldDrive;
use crate::mountain::strata::NodeFolds;
use crate::mountain::tectonics::TectonicReport;
use crate::mountain::transport::TransportStage;
use crate::mountain::{PlateSet, TectonicField, Tectonics};
use crate::surface::Cut;
use crate::terrain::{Edges, Erosion, Flow, Sediment};

/// Numbers that were none, and what became of them. They never reach the land.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quarantine {
    /// Nodes whose uplift was not finite and was taken as zero.
    pub uplift_nodes: u64,
    /// Steps whose result held a height that was not finite and was thrown away.
    pub steps: u64,
}

/// What visitors did that the report counts, beside [`ContactStats`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SessionCounts {
    /// Pushes, taps and anchors that changed nothing anybody could see.
    pub dead_touches: u64,
    /// `do` words that mean nothing in this mode.
    pub idle_commands: u64,
    /// Times that undo brought an earlier land back.
    pub undone: u64,
    /// Times that a palm's work was taken back.
    pub rolled_back: u64,
}

/// What one tick did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Ticks so far.
    pub tick: u64,
    /// The geological clock after the tick, years.
    pub time_yr: f64,
    /// Erosion steps taken in the tick.
    pub erosion_steps: u32,
    /// True when the uplift was computed anew.
    pub uplift_changed: bool,
    /// Numbers that were none, in all.
    pub quarantine: Quarantine,
}

/// The land before a push, to be brought back by undo.
#[derive(Debug)]
pub(super) struct Snapshot {
    pub(super) side: Side,
    pub(super) world: World,
    /// It was taken before the land started over.
    pub(super) starts_over: bool,
}

/// All that a roll-back must restore.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) world: World,
    pub(super) hands: HandTracker,
    /// Ticks done.
    pub(super) tick: u64,
    /// Model time gone since the last erosion step, years.
    pub(super) pending_yr: f64,
    pub(super) paused: bool,
    pub(super) pace_yr_per_s: f64,
    pub(super) uplift: Arc<Uplift>,
    /// Plates have changed since `uplift` was computed.
    pub(super) stale: bool,
    pub(super) undo: Vec<Arc<Snapshot>>,
    /// The contact whose edits the newest snapshot was taken for.
    pub(super) edited_by: Option<u64>,
    pub(super) history: History,
    /// Cross-sections, by [`Side`].
    pub(super) cuts: [Option<Cut>; 2],
    /// The uplift that each unfinished push found.
    pub(super) found: BTreeMap<Leg, Arc<Uplift>>,
    pub(super) counts: SessionCounts,
    pub(super) quarantine: Quarantine,
    /// Figures of the last uplift that plates drove.
    pub(super) last_motion: Option<TectonicReport>,
    /// All that this state came from was computed to the bit.
    pub(super) reproducible: bool,
    /// What made layers fold at that time.
    pub(super) last_folding: Option<Arc<FoldDrive>>,
}

/// A session: the world and all that moves it.
#[derive(Debug)]
pub struct Sim {
    pub(super) params: SimParams,
    pub(super) state: State,
    /// Frames that wait for their tick.
    pub(super) queue: VecDeque<InputFrame>,
    pub(super) rollback: Rollback<State>,
    /// Contacts found out to be none, whatever checkpoint comes back.
    pub(super) banned: Vec<ContactKey>,
    pub(super) tectonics: Tectonics<Box<dyn TransportStage>>,
    /// Scratch of the stages.
    pub(super) field: TectonicField,
    /// The plates and the time that `field` and `rates` were computed for.
    pub(super) field_of: Option<(PlateSet, f64)>,
    /// `field` and `fold_rates` were computed to the bit.
    pub(super) exact: bool,
    /// Uplift of `field` at each node, m/yr; not yet looked through for numbers that are none.
    pub(super) rates: Vec<f64>,
    /// The same for folds.
    pub(super) fold_rates: Vec<NodeFolds>,
    /// The crests that go with them.
    pub(super) skeletons: Vec<LayerSkeleton>,
    pub(super) folding: Folding,
    /// `rates` are newer than the uplift that the land has felt.
    pub(super) ahead: bool,
    /// The rock at the surface, as the last step found it.
    pub(super) exposure: Exposure,
    pub(super) isostasy: Option<Isostasy>,
    /// Rise of the pile as a whole in the last step, m/yr.
    pub(super) base: Vec<f64>,
    pub(super) erosion: Erosion,
    /// The land and its crust before the step, for the quarantine.
    pub(super) before: Vec<f64>,
    pub(super) before_crust: Crust,
    pub(super) before_sediment: Sediment,
    pub(super) wear: Wear,
    pub(super) land_revision: u64,
}

impl Sim {
    /// A session on `world`, whose grid is no finer than its nodes feel
    /// ([`MountainParams::for_nodes`](crate::mountain::MountainParams::for_nodes)).
    pub fn new(world: World, mut params: SimParams) -> Self {
        params.mountain = params.mountain.for_nodes(world.tin.len());
        let field = TectonicField::still(world.map.extent(), &params.mountain);
        let still = Uplift::still(&field, world.tin.len());
        let mut state = State {
            hands: HandTracker::new(params.gesture, world.map.size_mm()),
            tick: 0,
            pending_yr: 0.0,
            paused: false,
            pace_yr_per_s: params.pace_yr_per_s,
            uplift: Arc::new(still),
            stale: false,
            undo: Vec::new(),
            edited_by: None,
            history: History::default(),
            cuts: [None, None],
            found: BTreeMap::new(),
            counts: SessionCounts::default(),
            quarantine: Quarantine::default(),
            last_motion: None,
            reproducible: true,
            last_folding: None,
            world,
        };
        state.history.record(&state.world, params.history_bytes);
        Self::resume(Checkpoint { params, state })
    }

    /// The world as it is.
    pub fn world(&self) -> &World {
        &self.state.world
    }

    /// The parameters.
    pub fn params(&self) -> &SimParams {
        &self.params
    }

    /// Uplift rate of the crust at each node as the last step used it, m/yr, without folds.
    pub fn node_uplift(&self) -> &[f64] {
        &self.state.uplift.at_nodes
    }

    /// Figures of the last uplift that plates drove; `None` where nobody has pushed.
    pub fn last_motion(&self) -> Option<TectonicReport> {
        self.state.last_motion
    }

    /// True where the same input gives these bits on every machine: no stage on another device has had a part in them.
    pub fn is_reproducible(&self) -> bool {
        self.state.reproducible
    }

    /// Ticks done.
    pub fn ticks(&self) -> u64 {
        self.state.tick
    }

    /// Numbers that were none.
    pub fn quarantine(&self) -> Quarantine {
        self.state.quarantine
    }

    /// True while input waits for its tick.
    pub fn input_waits(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Water over the land as it is: receivers, drainage, lakes.
    pub fn flow(&self) -> Flow {
        let mut flow = Flow::new(&self.state.world.tin);
        self.route(&mut flow);
        flow
    }

    /// The same into memory for this land's nodes, which is reused.
    pub fn route(&self, flow: &mut Flow) {
        let world = &self.state.world;
        flow.route(&world.tin, &world.z, self.params.erosion.edges.into(), None);
    }

    /// What the contacts were.
    pub fn contact_stats(&self) -> ContactStats {
        self.state.hands.stats()
    }

    /// What else is counted.
    pub fn counts(&self) -> SessionCounts {
        self.state.counts
    }

    /// True when nothing moves any more: no input waits, no hand is down, and the world has run on for as long as
    /// it may.
    pub fn at_rest(&self) -> bool {
        self.queue.is_empty() && self.state.hands.hands().next().is_none() && !self.runs()
    }

    /// Hands over input. It is played in the first tick that is not before its time.
    pub fn feed(&mut self, frame: InputFrame) {
        self.queue.push_back(frame);
    }

    /// One tick of 16 ms session time.
    pub fn tick(&mut self) -> StepReport {
        let now_us = self.state.tick * TICK_US;
        let due = self.queue.partition_point(|frame| frame.t_us <= now_us);
        let frames: Vec<InputFrame> = self.queue.drain(..due).collect();
        for frame in &frames {
            self.rollback.record(frame);
        }
        self.play_tick(&frames)
    }

    /// Lets the world run on without input until it rests: one erosion step after the other, whatever the pace. A
    /// clock that was stopped stays so. Calls `progress` after each step with the model time left, years; false stops.
    pub fn run_on(&mut self, mut progress: impl FnMut(&Self, f64) -> bool) {
        if self.state.paused || self.state.pace_yr_per_s <= 0.0 {
            return;
        }
        while self.runs() {
            self.update_uplift();
            self.step_land();
            let left = self.state.world.last_push_yr + self.params.run_on_yr - self.state.world.time_yr;
            if !progress(self, left.max(0.0)) {
                return;
            }
        }
    }

    /// Ends all contacts, as the end of a recording does.
    pub fn finish_input(&mut self) {
        let now_us = self.state.tick * TICK_US;
        let events = self.state.hands.finish(now_us);
        for event in events {
            self.apply(&event);
        }
    }

    fn runs(&self) -> bool {
        let world = &self.state.world;
        world.time_yr < world.last_push_yr + self.params.run_on_yr
    }

    fn play_tick(&mut self, frames: &[InputFrame]) -> StepReport {
        let now_us = self.state.tick * TICK_US;
        for frame in frames {
            self.state.hands.feed(frame);
            for command in &frame.commands {
                self.command(command);
            }
        }
        let events = self.state.hands.tick(now_us);
        for event in &events {
            if let HandEvent::Retract { contacts, since_us } = event {
                if self.roll_back(contacts, *since_us) {
                    // The ticks up to this one have been played again without those contacts.
                    return self.report(0, true);
                }
                continue;
            }
            self.apply(event);
        }
        self.release_absent();
        let mut erosion_steps = 0;
        let mut uplift_changed = false;
        if !self.state.paused && (self.runs() || self.state.hands.hands().next().is_some()) {
            self.state.pending_yr += self.state.pace_yr_per_s * (TICK_US as f64 / 1e6);
            while self.state.pending_yr >= self.params.erosion_dt_yr {
                self.state.pending_yr -= self.params.erosion_dt_yr;
                uplift_changed |= self.update_uplift();
                self.step_land();
                erosion_steps += 1;
            }
        }
        self.state.tick += 1;
        if erosion_steps > 0 || self.rollback.is_due(now_us as i64) {
            self.rollback.checkpoint(now_us as i64, &self.state);
        }
        self.report(erosion_steps, uplift_changed)
    }

    fn report(&self, erosion_steps: u32, uplift_changed: bool) -> StepReport {
        StepReport {
            tick: self.state.tick,
            time_yr: self.state.world.time_yr,
            erosion_steps,
            uplift_changed,
            quarantine: self.state.quarantine,
        }
    }

    /// Plays the time since `since_us` again without `contacts`. False when no checkpoint reaches back so far: then
    /// what they did stays, and they do nothing more.
    fn roll_back(&mut self, contacts: &[ContactKey], since_us: u64) -> bool {
        self.banned.extend_from_slice(contacts);
        let until = self.state.tick;
        let rewound = self.rollback.rewind(since_us);
        let Some((state, frames)) = rewound else {
            for &key in contacts {
                self.state.hands.ban(key);
            }
            return false;
        };
        let counts = self.state.counts;
        self.state = state;
        self.ahead = false;
        self.field_of = None;
        self.land_revision += 1;
        self.state.counts.rolled_back = counts.rolled_back + 1;
        for &key in &self.banned {
            self.state.hands.ban(key);
        }
        let mut frames = frames.into_iter().peekable();
        while self.state.tick <= until {
            let now_us = self.state.tick * TICK_US;
            let mut due = Vec::new();
            while let Some(frame) = frames.next_if(|frame| frame.t_us <= now_us) {
                due.push(frame);
            }
            self.play_tick(&due);
        }
        true
    }

    /// One erosion step of the land.
    fn step_land(&mut self) {
        self.depart(self.state.world.time_yr);
        self.land_revision += 1;
        let state = &mut self.state;
        let world = &mut state.world;
        let dt_yr = self.params.erosion_dt_yr;
        self.before.clone_from(&world.z);
        self.before_crust.clone_from(&world.crust);
        self.before_sediment.clone_from(&world.sediment);
        let uplift = &state.uplift;
        let edited = world.strata.pay(dt_yr);
        let folds: Vec<&NodeFolds> = uplift.folds.iter().chain(&edited).collect();
        self.base.clone_from(&uplift.at_nodes);
        if let (Some(isostasy), Some(params)) = (&mut self.isostasy, &self.params.isostasy) {
            isostasy.uplift(&mut world.crust, &uplift.at_nodes, params, dt_yr, &mut self.base);
        }
        if self.params.erosion.edges == Edges::Fixed {
            // No plate raises the border, but it sinks with the crust beyond it.
            let border = world
                .tin
                .border()
                .iter()
                .enumerate()
                .filter(|(_, border)| **border);
            for (i, _) in border {
                let boost = self.params.isostasy.map_or(1.0, |floats| floats.boost);
                self.base[i] -= boost * uplift.at_nodes[i];
                let sunk = self.base[i] * dt_yr;
                world.z[i] += sunk;
                world.totals.uplifted_m3 += world.tin.areas()[i] * sunk;
            }
        }
        self.exposure.read(world, &self.base, &folds);
        let rise = &self.exposure.rise;
        let sums = self.erosion.step_with_sediment(
            &world.tin,
            &mut world.z,
            &mut world.sediment,
            &self.exposure.forcing(),
            &self.params.erosion,
            dt_yr,
        );
        world.time_yr += dt_yr;
        if world.z.iter().any(|z| !z.is_finite()) {
            world.z.clone_from(&self.before);
            world.crust.clone_from(&self.before_crust);
            world.sediment.clone_from(&self.before_sediment);
            self.wear.forget();
            state.quarantine.steps += 1;
            return;
        }
        self.wear.learn(&self.before, &world.z, rise, dt_yr);
        for folds in [&uplift.folds, &edited] {
            world.strata.advance(|_| 0.0, folds, dt_yr);
        }
        world.strata.advance(|i| self.base[i], &[], dt_yr);
        if let Some(drive) = &uplift.folding {
            world.has_folded(drive, dt_yr);
        }
        if self.isostasy.is_some() {
            // Folds bring rock that the thickening does not count.
            world.crust.book(&self.before, &world.z, &self.base, dt_yr);
        }
        world.totals.steps += 1;
        world.totals.uplifted_m3 += sums.uplifted_m3;
        world.totals.eroded_m3 += sums.fluvial_m3 + sums.landslide_m3;
        world.totals.deposited_m3 += sums.deposited_m3;
        world.totals.exported_m3 += sums.exported_m3;
        self.keep_history();
    }
}
