//! Both worlds at the table: one is shown and lives, the other one waits as it was left.

use std::sync::mpsc::Receiver;
use std::sync::{Arc, OnceLock};

use glam::DVec2;

use super::nodes::Nodes;
use super::record::Recorder;
use crate::gesture::command::{Command, Mode};
use crate::gesture::contact::ContactEvent;
use crate::gesture::hand::{Doing, HandView};
use crate::instrument::Scene;
use crate::live::{
    Clock, Frame, GlobeFrame, GlobeSession, Heartbeat, LiveGlobeParams, LiveParams, Session, Start,
};
use crate::sim::globe::default_start;
use crate::surface::Cut;
use crate::units::PlanMap;

/// The globe has no cross-sections.
const NO_CUTS: [Option<Cut>; 2] = [None, None];

/// The sessions of both worlds.
pub(super) struct Worlds {
    shown: Mode,
    mountain: Session,
    nodes: Nodes,
    /// Made when it is shown for the first time.
    globe: Option<GlobeSession>,
    globe_params: LiveGlobeParams,
    globe_beats: Arc<OnceLock<Heartbeat>>,
    recorder: Option<Recorder>,
}

impl Worlds {
    /// Begins with the mountain, whose later lands have as many nodes as `nodes` says; [`Self::turn_to`] shows the other.
    pub(super) fn new(mountain: LiveParams, nodes: Nodes, globe: LiveGlobeParams) -> std::io::Result<Self> {
        Ok(Self {
            shown: Mode::Mountain,
            mountain: Session::spawn(mountain)?,
            nodes,
            globe: None,
            globe_params: globe,
            globe_beats: Arc::default(),
            recorder: None,
        })
    }

    /// Records what goes to the world that is shown now.
    pub(super) fn record(&mut self, recorder: Recorder) {
        self.recorder = Some(recorder);
    }

    /// The world that is shown.
    pub(super) fn shown(&self) -> Mode {
        match &self.globe {
            Some(_) => self.shown,
            None => Mode::Mountain,
        }
    }

    /// Shows a world from now on. A planet that cannot be made is not shown, and the log says why.
    pub(super) fn turn_to(&mut self, mode: Mode) {
        if mode == Mode::Globe && self.globe.is_none() {
            match GlobeSession::spawn(self.globe_params.clone()) {
                Ok(session) => {
                    // It is made once.
                    let _ = self.globe_beats.set(session.heartbeat());
                    self.globe = Some(session);
                }
                Err(error) => tracing::error!("there is no planet: {error}"),
            }
        }
        self.shown = mode;
    }

    /// The planet, while it is shown.
    pub(super) fn globe(&self) -> Option<&GlobeFrame> {
        let globe = self.globe.as_ref().filter(|_| self.shown == Mode::Globe);
        globe.map(GlobeSession::current)
    }

    /// The mountain, whether it is shown or not.
    pub(super) fn mountain(&self) -> &Frame {
        self.mountain.current()
    }

    /// Nodes of the mountain's land.
    pub(super) fn nodes(&self) -> usize {
        self.nodes.count()
    }

    /// The mountain's session, to be saved.
    pub(super) fn session(&self) -> &Session {
        &self.mountain
    }

    /// Rises when the world that is shown was drawn anew.
    pub(super) fn land(&self) -> u64 {
        self.globe().map_or(self.mountain().land, |globe| globe.land)
    }

    /// The clock of the world that is shown.
    pub(super) fn clock(&self) -> &Clock {
        self.globe().map_or(&self.mountain().clock, |globe| &globe.clock)
    }

    /// The hands on the world that is shown.
    pub(super) fn hands(&self) -> &[HandView] {
        self.globe().map_or(&self.mountain().hands, |globe| &globe.hands)
    }

    /// Somebody moves the ground.
    pub(super) fn pushed(&self) -> bool {
        let pushing = |hand: &HandView| matches!(hand.doing, Doing::Pushing { .. });
        match self.globe() {
            Some(globe) => !globe.tethers.is_empty(),
            None => self.mountain().hands.iter().any(pushing),
        }
    }

    /// What the instrument must see.
    pub(super) fn scene<'a>(
        &'a self,
        map: PlanMap,
        in_flight: bool,
        panels: &'a [(DVec2, DVec2)],
    ) -> Scene<'a> {
        let flat = self.globe().is_none().then(|| self.mountain());
        Scene {
            plates: flat.map_or(&[], |frame| &frame.surface.plates),
            faults: flat.map_or(&[], |frame| &frame.surface.faults),
            cuts: flat.map_or(&NO_CUTS, |frame| &frame.cuts),
            map,
            clock: self.clock(),
            in_flight: in_flight && flat.is_some(),
            panels,
        }
    }

    /// Hands input over to the world that is shown.
    pub(super) fn send(&mut self, events: Vec<ContactEvent>, commands: Vec<Command>, now_us: u64) {
        let shown = self.shown();
        if let Some(recorder) = &mut self.recorder {
            recorder.take(shown, &events, &commands, now_us);
        }
        match self.globe.as_ref().filter(|_| self.shown == Mode::Globe) {
            Some(globe) => globe.send(events, commands, now_us),
            None => self.mountain.send(events, commands, now_us),
        }
    }

    /// Asks for the last minute of contacts of the world that is shown, as the bytes of a gesture file.
    pub(super) fn ring_file(&self) -> Receiver<Vec<u8>> {
        match self.globe.as_ref().filter(|_| self.shown == Mode::Globe) {
            Some(globe) => globe.ring_file(),
            None => self.mountain.ring_file(),
        }
    }

    /// Time goes on in the world that is shown, and its newest frame is taken.
    pub(super) fn advance(&mut self, now_us: u64) {
        if let Some(globe) = self.globe.as_mut().filter(|_| self.shown == Mode::Globe) {
            globe.advance(now_us);
            globe.frame();
        } else {
            self.mountain.advance(now_us);
            self.mountain.frame();
        }
    }

    /// Every frame counts, and the mountain's session is to keep up with them.
    pub(super) fn watch_pace(&mut self, now_us: u64) {
        if self.globe().is_none() {
            self.nodes.look(now_us, self.mountain.slowed_us());
        }
    }

    /// The world that is shown begins again from `seed`.
    pub(super) fn restart(&mut self, seed: u64) {
        match self.globe.as_ref().filter(|_| self.shown == Mode::Globe) {
            Some(globe) => globe.restart(default_start(seed)),
            None => self.restart_mountain(seed),
        }
        self.note_fresh(seed);
    }

    /// Both worlds begin again from `seed`.
    pub(super) fn restart_both(&mut self, seed: u64) {
        self.restart_mountain(seed);
        if let Some(globe) = &self.globe {
            globe.restart(default_start(seed));
        }
        self.note_fresh(seed);
    }

    /// Nobody sees that the next land has more nodes, or fewer.
    fn restart_mountain(&mut self, seed: u64) {
        let nodes = self.nodes.fresh();
        self.mountain.restart(Start::Nodes { seed, nodes });
    }

    fn note_fresh(&mut self, seed: u64) {
        if let Some(recorder) = &mut self.recorder {
            recorder.fresh(seed, self.nodes.count());
        }
    }

    /// Counts the beats of the sessions' threads: they rise as long as the world that is shown lives.
    pub(super) fn pulse(&self) -> impl Fn() -> u64 + Send + 'static {
        let (mountain, globe) = (self.mountain.heartbeat(), Arc::clone(&self.globe_beats));
        move || mountain.beats() + globe.get().map_or(0, Heartbeat::beats)
    }
}
