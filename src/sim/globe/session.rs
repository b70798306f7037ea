//! One tick: hands → holds and view → a step of the planet.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::super::TICK_US;
use super::super::rollback::Rollback;
use super::GlobeSimParams;
use super::hold::{Duty, Hold};
use super::turn::Turning;
use super::view::TapMark;
use crate::gesture::command::Tool;
use crate::gesture::contact::{ContactEvent, ContactKey, InputFrame, Phase, Side};
use crate::gesture::event::{HandEvent, HandId};
use crate::gesture::hand::HandTracker;
use crate::gesture::stroke::StrokeId;
use crate::globe::{Planet, Start, StartError};
use crate::sphere::Lattice;
use crate::units::GlobeView;

/// What visitors did on the globe, for the report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct GlobeCounts {
    /// Hands that led a plate.
    pub led: u64,
    /// Hands that held a plate where it was.
    pub anchored: u64,
    /// Taps on the globe.
    pub taps: u64,
    /// Plates torn by two hands.
    pub torn: u64,
    /// Plates cut along a drawn line.
    pub cut: u64,
    /// Tears and cuts that were refused: the plate is too small there.
    pub refused: u64,
    /// Strokes of the brush.
    pub painted: u64,
    /// Times that hands began to turn or zoom the view, and views that were asked for.
    pub views: u64,
    /// Taps beside the globe: they change nothing that anybody could see.
    pub dead_touches: u64,
    /// `do` words that mean nothing here.
    pub idle_commands: u64,
    /// Times that undo brought an earlier planet back.
    pub undone: u64,
    /// Times that a palm's work was taken back.
    pub rolled_back: u64,
}

/// What one tick did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GlobeTick {
    /// Ticks so far.
    pub tick: u64,
    /// Model time of the planet's last step, My.
    pub time_my: f64,
    /// Steps taken in the tick.
    pub steps: u32,
}

/// The planet before a push, to be brought back by undo.
#[derive(Debug)]
pub(super) struct Snapshot {
    pub(super) side: Side,
    pub(super) planet: Arc<Planet>,
    pub(super) pending_my: f64,
    pub(super) start: Arc<Start>,
}

/// All that a roll-back must restore.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Shared with snapshots and checkpoints until it changes.
    pub(super) planet: Arc<Planet>,
    /// What it began as.
    pub(super) start: Arc<Start>,
    pub(super) hands: HandTracker,
    pub(super) view: GlobeView,
    /// By [`Side`].
    pub(super) tools: [Tool; 2],
    /// Ticks done.
    pub(super) tick: u64,
    /// Model time gone since the last step, My.
    pub(super) pending_my: f64,
    pub(super) paused: bool,
    pub(super) pace_my_per_s: f64,
    /// What each finger was taken for where it landed, and its hand.
    pub(super) duties: BTreeMap<StrokeId, (HandId, Duty)>,
    pub(super) holds: BTreeMap<HandId, Hold>,
    /// Plates that the planet takes for led or anchored.
    pub(super) held: BTreeSet<u32>,
    /// Hands for which undo has a snapshot.
    pub(super) remembered: BTreeSet<HandId>,
    pub(super) turning: Turning,
    pub(super) taps: Vec<TapMark>,
    pub(super) undo: Vec<Arc<Snapshot>>,
    /// Where fingers that paint were last.
    pub(super) brushes: BTreeMap<StrokeId, DVec3>,
    /// The tick in which each side last held a plate or said something.
    pub(super) stirred: [Option<u64>; 2],
    /// The contact whose strokes of the brush the newest snapshot was taken for.
    pub(super) painted_by: Option<u64>,
    pub(super) counts: GlobeCounts,
}

/// A session on the globe: the planet and all that moves it. A clone goes on as the original does, to the bit.
#[derive(Clone, Debug)]
pub struct GlobeSim {
    pub(super) params: GlobeSimParams,
    pub(super) state: State,
    /// Frames that wait for their tick.
    queue: VecDeque<InputFrame>,
    rollback: Rollback<State>,
    /// Contacts found out to be none, whatever checkpoint comes back.
    banned: Vec<ContactKey>,
}

impl GlobeSim {
    /// A session on a table of `size_mm`, with the planet of `start` on the samples of `lattice`.
    ///
    /// # Errors
    /// When `start` names what there is not: see [`StartError`].
    pub fn new(
        lattice: Arc<Lattice>,
        start: Start,
        size_mm: DVec2,
        params: GlobeSimParams,
    ) -> Result<Self, StartError> {
        let planet = Planet::new(lattice, &start, params.globe)?;
        let state = State {
            planet: Arc::new(planet),
            start: Arc::new(start),
            hands: HandTracker::new(params.gesture, size_mm),
            view: GlobeView::new(size_mm),
            tools: [Tool::Push; 2],
            tick: 0,
            pending_my: 0.0,
            paused: false,
            pace_my_per_s: params.pace_my_per_s,
            duties: BTreeMap::new(),
            holds: BTreeMap::new(),
            held: BTreeSet::new(),
            remembered: BTreeSet::new(),
            turning: Turning::default(),
            taps: Vec::new(),
            undo: Vec::new(),
            brushes: BTreeMap::new(),
            stirred: [None; 2],
            painted_by: None,
            counts: GlobeCounts::default(),
        };
        let mut rollback = Rollback::new();
        rollback.checkpoint(-(TICK_US as i64), &state);
        Ok(Self {
            params,
            state,
            queue: VecDeque::new(),
            rollback,
            banned: Vec::new(),
        })
    }

    /// Hands over input. It is played in the first tick that is not before its time.
    pub fn feed(&mut self, frame: InputFrame) {
        self.queue.push_back(frame);
    }

    /// One tick of 16 ms session time.
    pub fn tick(&mut self) -> GlobeTick {
        let now_us = self.state.tick * TICK_US;
        let due = self.queue.partition_point(|frame| frame.t_us <= now_us);
        let frames: Vec<InputFrame> = self.queue.drain(..due).collect();
        for frame in &frames {
            self.rollback.record(frame);
        }
        self.play_tick(&frames)
    }

    /// True while input waits for its tick.
    pub fn input_waits(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Ends all contacts, as the end of a recording does.
    pub fn finish_input(&mut self) {
        let events = self.state.hands.finish(self.state.tick * TICK_US);
        self.hear(&events);
        self.follow_hands();
    }

    /// Withdraws every contact that is down, at the next tick.
    pub fn cancel_contacts(&mut self) {
        let withdrawn = |contact: &_| ContactEvent {
            phase: Phase::Cancel,
            contact: *contact,
        };
        let contacts = self.state.hands.contacts();
        let events = contacts.map(|(contact, ..)| withdrawn(contact)).collect();
        self.queue.push_front(InputFrame {
            t_us: self.state.tick * TICK_US,
            events,
            commands: Vec::new(),
        });
    }

    /// The same moment at a later session time: what lies between is not played. For going on after a fault, or after a
    /// while in the other world, with input that is of now.
    pub fn skip_to(&mut self, tick: u64) {
        self.state.tick = self.state.tick.max(tick);
    }

    /// Lets the planet go on without input until it is `time_my` old, whatever the pace. A clock that was stopped stays so.
    /// Calls `progress` after each step; false stops.
    pub fn run_until(&mut self, time_my: f64, mut progress: impl FnMut(&Self) -> bool) {
        if self.state.paused || self.state.pace_my_per_s <= 0.0 {
            return;
        }
        self.state.pending_my = 0.0;
        // Half a step: time adds up to a hair beside the whole.
        while self.state.planet.time_my() + self.params.globe.dt_my / 2.0 < time_my {
            self.step_planet();
            if !progress(self) {
                return;
            }
        }
    }

    fn play_tick(&mut self, frames: &[InputFrame]) -> GlobeTick {
        let now_us = self.state.tick * TICK_US;
        for frame in frames {
            self.state.hands.feed(frame);
            for command in &frame.commands {
                self.command(command);
            }
        }
        let events = self.state.hands.tick(now_us);
        for event in &events {
            if let HandEvent::Retract { contacts, since_us } = event
                && self.roll_back(contacts, *since_us)
            {
                // The ticks up to this one have been played again without those contacts.
                return self.told(0);
            }
        }
        self.hear(&events);
        self.follow_hands();
        let mut steps = 0;
        if !self.state.paused {
            self.state.pending_my += self.state.pace_my_per_s * (TICK_US as f64 / 1e6);
            while self.state.pending_my >= self.params.globe.dt_my {
                self.state.pending_my -= self.params.globe.dt_my;
                self.step_planet();
                steps += 1;
            }
        }
        self.state.tick += 1;
        if steps > 0 || self.rollback.is_due(now_us as i64) {
            self.rollback.checkpoint(now_us as i64, &self.state);
        }
        self.told(steps)
    }

    fn told(&self, steps: u32) -> GlobeTick {
        GlobeTick {
            tick: self.state.tick,
            time_my: self.state.planet.time_my(),
            steps,
        }
    }

    fn step_planet(&mut self) {
        self.state.planet_mut().step();
        self.after_step();
    }

    /// Plays the time since `since_us` again without `contacts`. False when no checkpoint reaches back so far: then
    /// what they did stays, and they do nothing more.
    fn roll_back(&mut self, contacts: &[ContactKey], since_us: u64) -> bool {
        self.banned.extend_from_slice(contacts);
        let until = self.state.tick;
        let Some((state, frames)) = self.rollback.rewind(since_us) else {
            for &key in contacts {
                self.state.hands.ban(key);
            }
            return false;
        };
        let rolled_back = self.state.counts.rolled_back + 1;
        self.state = state;
        self.state.counts.rolled_back = rolled_back;
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
}

impl State {
    /// The planet, to change it: snapshots keep theirs.
    pub(super) fn planet_mut(&mut self) -> &mut Planet {
        Arc::make_mut(&mut self.planet)
    }
}
