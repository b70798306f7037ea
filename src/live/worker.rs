//! The session's thread: takes messages, plays ticks, publishes frames, and survives.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender};

use rayon::ThreadPool;

use super::chart::{Chart, Slot};
use super::exchange::Writer;
use super::ring::Ring;
use super::timeline::Timeline;
use super::{LiveParams, Start, Vitals};
use crate::gesture::command::{self, Action, Command};
use crate::gesture::contact::{ContactEvent, InputFrame};
use crate::gesture::file::Header;
use crate::rock::preset;
use crate::sim::{Checkpoint, Sim, SimParams, TICK_US, World};
use crate::terrain::TinError;
use crate::units::MYR;

/// Erosion steps after which the land is shown before more are taken: a session that lags still moves.
const MOST_STEPS: u32 = 2;
/// Ticks between two checkpoints that a session can go on from after a panic: about a second.
const CHECKPOINT_TICKS: u64 = 62;

/// What the session is told.
pub(super) enum Message {
    /// Contacts and commands, and table time, µs.
    Input(Vec<ContactEvent>, Vec<Command>, u64),
    /// Table time has come to this, µs.
    Advance(u64),
    Restart(Start),
    Save(Sender<Checkpoint>),
    Ring(Sender<Vec<u8>>),
    End,
    /// The next batch panics.
    #[cfg(test)]
    Fault,
}

/// The session and what belongs to its thread.
pub(super) struct Worker {
    params: LiveParams,
    vitals: Arc<Vitals>,
    frames: Writer<Slot>,
    sim: Sim,
    chart: Chart,
    timeline: Timeline,
    ring: Ring,
    /// The land that the session began with.
    first: World,
    /// Where to go on from after a panic.
    good: Checkpoint,
    /// Panics without a checkpoint between them.
    relapses: u32,
    panics: u64,
    steps: u64,
    sequence: u64,
    /// The session is not what the last frame shows.
    changed: bool,
    /// What the next batch is to do, beside playing.
    restart: Option<Start>,
    saves: Vec<Sender<Checkpoint>>,
    rings: Vec<Sender<Vec<u8>>>,
    #[cfg(test)]
    fault: bool,
}

impl Worker {
    /// The session of `params` on `first`, its land drawn by `chart`.
    pub(super) fn new(
        params: LiveParams,
        vitals: Arc<Vitals>,
        first: World,
        chart: Chart,
        frames: Writer<Slot>,
    ) -> Self {
        let sim = Sim::new(first.clone(), params.sim.clone());
        Self {
            ring: new_ring(&first, &params.sim),
            good: sim.checkpoint(),
            params,
            vitals,
            frames,
            sim,
            chart,
            timeline: Timeline::default(),
            first,
            relapses: 0,
            panics: 0,
            steps: 0,
            sequence: 0,
            changed: true,
            restart: None,
            saves: Vec::new(),
            rings: Vec::new(),
            #[cfg(test)]
            fault: false,
        }
    }

    /// Serves `messages` until the session ends. All work is done in `pool`.
    pub(super) fn run(mut self, messages: &Receiver<Message>, pool: &ThreadPool) {
        loop {
            // Who has nothing left to do sleeps until there is news.
            let first = if self.has_work() {
                messages.try_recv().ok()
            } else if let Ok(message) = messages.recv() {
                Some(message)
            } else {
                return;
            };
            for message in first.into_iter().chain(messages.try_iter()) {
                if !self.take(message) {
                    return;
                }
            }
            let batch = catch_unwind(AssertUnwindSafe(|| pool.install(|| self.batch())));
            if batch.is_err() {
                self.recover();
            }
            self.vitals.heartbeat.fetch_add(1, Ordering::Relaxed);
        }
    }

    fn is_behind(&self) -> bool {
        self.timeline.reaches(self.sim.ticks() * TICK_US)
    }

    /// True where another batch is due without further news: ticks are left, or a panic came first.
    fn has_work(&self) -> bool {
        self.is_behind() || self.changed || !(self.saves.is_empty() && self.rings.is_empty())
    }

    /// Takes a message; false for the last one.
    fn take(&mut self, message: Message) -> bool {
        match message {
            Message::Input(mut events, commands, table_us) => {
                for event in &mut events {
                    event.contact = event.contact.as_recorded();
                }
                let commands = commands.iter().filter_map(as_recorded).collect();
                self.timeline.take(events, commands, table_us);
            }
            Message::Advance(table_us) => self.timeline.advance(table_us),
            Message::Restart(start) => {
                self.timeline = Timeline::beginning(self.timeline.table_us());
                self.restart = Some(start);
            }
            Message::Save(reply) => self.saves.push(reply),
            Message::Ring(reply) => self.rings.push(reply),
            Message::End => return false,
            #[cfg(test)]
            Message::Fault => self.fault = true,
        }
        true
    }

    /// Plays the ticks that are due (or some of them, where they are many), and shows what has become of the land.
    fn batch(&mut self) {
        if let Some(start) = self.restart.take() {
            self.begin(start);
        }
        self.timeline.keep_up(self.sim.ticks() * TICK_US);
        self.vitals
            .slowed_us
            .store(self.timeline.slowed_us(), Ordering::Relaxed);
        let mut steps = 0;
        while self.is_behind() && steps < MOST_STEPS {
            let tick_us = self.sim.ticks() * TICK_US;
            while let Some(frame) = self.timeline.due(tick_us) {
                self.ring.record(&frame);
                self.sim.feed(frame);
            }
            steps += self.sim.tick().erosion_steps;
            self.changed = true;
        }
        self.steps += u64::from(steps);
        #[cfg(test)]
        assert!(!std::mem::take(&mut self.fault), "injected");
        if self.changed {
            self.publish();
        }
        if self.sim.ticks() >= self.good.ticks() + CHECKPOINT_TICKS {
            self.good = self.sim.checkpoint();
            self.relapses = 0;
        }
        // Whoever asked may have gone meanwhile.
        for reply in self.saves.drain(..) {
            let _ = reply.send(self.sim.checkpoint());
        }
        for reply in self.rings.drain(..) {
            if let Ok(bytes) = self.ring.write(Vec::new()) {
                let _ = reply.send(bytes);
            }
        }
    }

    /// Draws the session as it is and hands the frame over.
    pub(super) fn publish(&mut self) {
        let changed = self.sim.refresh_uplift();
        let slot = self.frames.back();
        self.chart.draw(&self.sim, changed, slot);
        self.sequence += 1;
        slot.frame.sequence = self.sequence;
        slot.frame.panics = self.panics;
        slot.frame.steps = self.steps;
        self.frames.publish();
        self.changed = false;
    }

    /// A session afresh. Where a land cannot be made the one that the session began with comes back.
    fn begin(&mut self, start: Start) {
        let world = match start {
            Start::Seed(seed) if seed == self.first.seed => self.first.clone(),
            Start::Seed(seed) => new_world(&self.params, seed).unwrap_or_else(|_| self.first.clone()),
            Start::World(world) => *world,
        };
        self.sim = Sim::new(world.clone(), self.params.sim.clone());
        self.good = self.sim.checkpoint();
        self.ring = new_ring(&world, &self.params.sim);
        if Arc::ptr_eq(&world.tin, &self.first.tin) {
            self.chart.forget();
        } else {
            self.chart.move_to(&world);
        }
        self.first = world;
        self.changed = true;
    }

    /// After a panic: the last good moment comes back, without contacts. If that panics again within a second, its land
    /// alone; if that does too, the land that the session began with.
    fn recover(&mut self) {
        self.panics += 1;
        let tick = self.sim.ticks();
        let afresh = |world: &World| Sim::new(world.clone(), self.params.sim.clone()).checkpoint();
        let checkpoint = match self.relapses {
            0 => self.good.clone(),
            1 => afresh(self.good.world()),
            _ => afresh(&self.first),
        };
        self.relapses += 1;
        self.good = checkpoint.at_tick(tick);
        self.sim = Sim::resume(self.good.clone());
        self.sim.cancel_contacts();
        self.ring.cancel_contacts(tick * TICK_US);
        // The panic may have come while the chart was half-way to another land.
        self.chart.move_to(self.sim.world());
        self.changed = true;
    }
}

/// The land of `seed` on a table as `params` has it.
pub(super) fn new_world(params: &LiveParams, seed: u64) -> Result<World, TinError> {
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

/// The command as a gesture file gives it back; none where a file could not hold it.
fn as_recorded(command: &Command) -> Option<Command> {
    let mut json = String::new();
    command.write_json(&mut json);
    let parsed = command::parse(&serde_json::from_str(&json).ok()?).ok()?;
    parsed.commands.into_iter().next()
}
