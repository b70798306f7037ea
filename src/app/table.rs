//! The table without its window: who owns which contact, which phase it is, what the session is told.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use super::eye::Eye;
use super::nodes::Nodes;
use super::record::Recorder;
use super::save::Saver;
use super::setup::{door_params, globe_params, globe_samples, instrument_params, raster_width, window_map};
use super::shows::Shows;
use super::stages::{self, Chosen};
use super::worlds::Worlds;
use super::{AppError, Options};
use crate::gesture::command::{Action, Command, Mode};
use crate::gesture::contact::{Contact, ContactEvent, ContactKey, Phase as ContactPhase, Side};
use crate::gesture::file::Header;
use crate::input::calibrate::Calibrating;
use crate::input::stream::Stream;
use crate::input::window::{TouchPhase, WindowInput};
use crate::instrument::{ControlId, Instrument, Key, Route};
use crate::kiosk::{DoorPhase, Kiosk, KioskParams, Phase, StaffDoor};
use crate::live::{Frame, LiveParams};
use crate::mountain::Stages;
use crate::rock::Stratigraphy;
use crate::settings::Settings;
use crate::sim::SimParams;
use crate::units::PlanMap;

/// How long touches do nothing while the table is wiped, µs.
const CLEANING_US: u64 = 30_000_000;

/// Seed of the land that a table begins with.
const SEED: u64 = 1;

/// What the window tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Raw {
    /// A touch of a device.
    Touch {
        /// Which device.
        device: u16,
        /// The window system's name for it.
        id: u64,
        /// What it does.
        phase: TouchPhase,
        /// Where, window pixels.
        at_px: DVec2,
    },
    /// The pointer moves.
    PointerMoved {
        /// Where to, window pixels.
        at_px: DVec2,
    },
    /// The mouse's first button.
    PointerButton {
        /// Down or up.
        pressed: bool,
        /// With the Shift key.
        shift: bool,
    },
}

/// One contact event and where it went, for halos and panels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) event: ContactEvent,
    pub(super) route: Route,
}

/// The table.
pub(super) struct Table {
    unattended: bool,
    pub(super) map: PlanMap,
    pub(super) size_px: DVec2,
    pub(super) input: WindowInput,
    pub(super) stream: Stream,
    pub(super) calibrating: Option<Calibrating>,
    pub(super) instrument: Instrument,
    pub(super) kiosk: Kiosk,
    pub(super) shows: Shows,
    pub(super) door: StaffDoor,
    pub(super) wishes_fly: bool,
    pub(super) worlds: Worlds,
    /// The world that a fresh table shows, and the one that the options ask for whatever the settings say.
    pub(super) home: Mode,
    mode: Option<Mode>,
    pub(super) eye: Eye,
    pub(super) saver: Saver,
    /// Rectangles of panels, table mm.
    panels: Vec<(DVec2, DVec2)>,
    pub(super) seen: Vec<Seen>,
    /// A place on a side's sheet where somebody wants a note, parts of its size.
    pub(super) note: Option<(Side, DVec2)>,
    pub(super) visitors: u64,
    pub(super) resets: u64,
    pub(super) in_reset: bool,
    pub(super) control_presses: u64,
    pub(super) stages: Chosen,
    now_us: u64,
    cleaning_until_us: u64,
    /// When each contact that is down landed.
    since_us: BTreeMap<ContactKey, u64>,
    pub(super) layout_told: Option<(DVec2, Vec<ControlId>)>,
}

impl Table {
    pub(super) fn new(
        options: &Options,
        settings: &Settings,
        size_px: [u32; 2],
        software: bool,
        layers: Arc<Stratigraphy>,
    ) -> Result<Self, AppError> {
        let size_px = DVec2::from(size_px.map(f64::from));
        let size_mm = settings.table_size_mm(size_px);
        let map = settings.plan_map(size_mm);
        let unattended = options.kiosk;
        let fixed = settings.quality.nodes.map(|nodes| nodes as usize);
        let nodes = Nodes::new(fixed, map, software);
        let count = nodes.count();
        let mut mountain = LiveParams {
            map,
            nodes: count,
            seed: SEED,
            layers,
            sim: SimParams::default(),
            raster_width: raster_width(software),
            threads: 0,
            stages: Stages::default(),
        };
        let (stages, chosen) = stages::choose(settings.quality.stages, software, &mountain);
        mountain.stages = stages;
        let mut worlds = Worlds::new(mountain, nodes, globe_params(size_mm, software))
            .map_err(|error| AppError::Other(format!("the session cannot begin: {error}")))?;
        let home = options.mode.unwrap_or(settings.mode);
        worlds.turn_to(home);
        if let Some(path) = &options.record {
            let (mode, seed) = (worlds.shown(), SEED);
            let nodes = match mode {
                Mode::Mountain => count,
                Mode::Globe => globe_samples(software),
            };
            let header = Header {
                title: Some("a session at the table".to_owned()),
                mode,
                seed: Some(seed),
                nodes: Some(nodes as u64),
                ..Header::new(size_mm)
            };
            let recorder = Recorder::new(path, header)
                .map_err(|error| AppError::File(path.display().to_string(), error))?;
            worlds.record(recorder);
        }
        let window = window_map(settings, &map, size_px);
        Ok(Self {
            unattended,
            map,
            size_px,
            input: WindowInput::new(window),
            stream: Stream::new(settings.input.source, window.surface()),
            calibrating: None,
            instrument: Instrument::new(instrument_params(settings, size_mm, unattended, worlds.shown())),
            kiosk: Kiosk::new(KioskParams::new(&settings.kiosk, unattended)),
            shows: Shows::new(size_mm),
            door: StaffDoor::new(door_params(settings, size_mm)),
            wishes_fly: false,
            eye: Eye::new(settings, worlds.mountain(), map.extent(), size_px),
            worlds,
            home,
            mode: options.mode,
            saver: Saver::new(options.save.clone()),
            panels: Vec::new(),
            seen: Vec::new(),
            note: None,
            visitors: 1,
            resets: 0,
            in_reset: false,
            control_presses: 0,
            stages: chosen,
            now_us: 0,
            cleaning_until_us: 0,
            since_us: BTreeMap::new(),
            layout_told: None,
        })
    }

    /// The newest frame of the mountain's session.
    pub(super) fn frame(&self) -> &Frame {
        self.worlds.mountain()
    }

    /// Both worlds.
    pub(super) fn worlds(&self) -> &Worlds {
        &self.worlds
    }

    /// Where the mountain is seen from, and the light.
    pub(super) fn eye(&self) -> &Eye {
        &self.eye
    }

    /// Table ↔ plan.
    pub(super) fn map(&self) -> PlanMap {
        self.map
    }

    /// Everything of the instrument, for drawing.
    pub(super) fn instrument(&self) -> &Instrument {
        &self.instrument
    }

    /// The circle, for drawing.
    pub(super) fn kiosk(&self) -> &Kiosk {
        &self.kiosk
    }

    /// The staff's door, to be drawn and to be typed at.
    pub(super) fn door(&mut self) -> &mut StaffDoor {
        &mut self.door
    }

    /// Where the staff's door is.
    pub(super) fn door_phase(&self) -> DoorPhase {
        self.door.phase()
    }

    /// How far the view is from the plan, 0–1. The globe is never seen aslant.
    pub(super) fn aloft(&self) -> f64 {
        match self.worlds.shown() {
            Mode::Mountain => self.eye.aloft(),
            Mode::Globe => 0.0,
        }
    }

    /// Word of what was saved, or why not, while it is news.
    pub(super) fn notice(&self) -> Option<&str> {
        self.saver.notice()
    }

    /// What contacts did since this was last asked.
    pub(super) fn take_seen(&mut self) -> Vec<Seen> {
        std::mem::take(&mut self.seen)
    }

    /// Where somebody wants a note on a sheet, if that is news.
    pub(super) fn take_note(&mut self) -> Option<(Side, DVec2)> {
        self.note.take()
    }

    /// The artist's tools are offered.
    pub(super) fn offers_layers(&self, settings: &Settings) -> bool {
        self.worlds.shown() == Mode::Mountain && !settings.view.tools.are_few(self.unattended)
    }

    /// A side does something that has no control.
    pub(super) fn command(&mut self, action: Action, side: Side) {
        let command = Command {
            side: Some(side),
            ..Command::new(action)
        };
        self.worlds.send(Vec::new(), vec![command], self.now_us);
    }

    /// Rectangles of panels, table mm: contacts that land there are the panels'.
    pub(super) fn set_panels(&mut self, panels: Vec<(DVec2, DVec2)>) {
        self.panels = panels;
    }

    /// Contacts that are down: where, table mm, and for how long, s.
    pub(super) fn contact_ages(&self) -> impl Iterator<Item = (DVec2, f64)> {
        self.contacts_down().map(|contact| {
            let since_us = self.since_us.get(&contact.key).copied().unwrap_or(self.now_us);
            (
                contact.position,
                self.now_us.saturating_sub(since_us) as f64 / 1e6,
            )
        })
    }

    /// Nodes of the land.
    pub(super) fn nodes(&self) -> usize {
        self.worlds.nodes()
    }

    /// For how long touches still do nothing, so that the table can be wiped, s.
    pub(super) fn cleaning_s(&self) -> Option<f64> {
        let left_us = self.cleaning_until_us.saturating_sub(self.now_us);
        (left_us > 0).then_some(left_us as f64 / 1e6)
    }

    /// Touches do nothing for half a minute.
    pub(super) fn clean(&mut self, now_us: u64) {
        self.cancel_all(now_us);
        self.cleaning_until_us = now_us + CLEANING_US;
    }

    /// Number of contacts that are down.
    pub(super) fn contacts(&self) -> usize {
        self.contacts_down().count()
    }

    /// The contacts that are down, of all sources.
    fn contacts_down(&self) -> impl Iterator<Item = &Contact> {
        self.input.contacts().chain(self.stream.contacts())
    }

    /// Table time.
    pub(super) fn now_us(&self) -> u64 {
        self.now_us
    }

    /// True while somebody is there or the land moves under hands: then every frame counts.
    pub(super) fn lively(&self) -> bool {
        self.kiosk.phase() != Phase::Attract || self.contacts() > 0
    }

    /// What the window tells.
    pub(super) fn raw(&mut self, raw: Raw, now_us: u64) {
        let mut events = Vec::new();
        match raw {
            Raw::Touch { .. } if !self.hears_window(now_us) => {}
            Raw::Touch {
                device,
                id,
                phase,
                at_px,
            } => self.input.touch((device, id), phase, at_px, now_us, &mut events),
            Raw::PointerMoved { at_px } => self.input.pointer_moved(at_px, &mut events),
            Raw::PointerButton { pressed, shift } => self.input.button(pressed, shift, now_us, &mut events),
        }
        self.take(events, now_us);
    }

    /// Lifts the hands that the mouse has planted. False when there are none.
    pub(super) fn lift_planted(&mut self, now_us: u64) -> bool {
        let mut events = Vec::new();
        self.input.lift_all(&mut events);
        let lifted = !events.is_empty();
        self.take(events, now_us);
        lifted
    }

    /// Withdraws all contacts: the window has lost its focus or its place.
    pub(super) fn cancel_all(&mut self, now_us: u64) {
        let mut events = Vec::new();
        self.input.cancel_all(&mut events);
        self.stream.cancel_all(&mut events);
        self.take(events, now_us);
        self.instrument.cancel_all();
    }

    /// The window has another size. The land keeps its own, and is shown as large as it fits.
    pub(super) fn resize(&mut self, settings: &Settings, size_px: [u32; 2], now_us: u64) {
        self.size_px = DVec2::from(size_px.map(f64::from));
        let mut events = Vec::new();
        let map = window_map(settings, &self.map, self.size_px);
        self.input.set_map(map, &mut events);
        self.stream.set_map(map.surface(), &mut events);
        self.take(events, now_us);
        self.layout_told = None;
    }

    /// Settings have changed: everything but the land's size follows at once.
    pub(super) fn apply(&mut self, settings: &Settings, now_us: u64) {
        let size_mm = self.map.size_mm();
        self.instrument.set_params(instrument_params(
            settings,
            size_mm,
            self.unattended,
            self.worlds.shown(),
        ));
        self.kiosk
            .set_params(KioskParams::new(&settings.kiosk, self.unattended));
        self.door.set_params(door_params(settings, size_mm));
        self.eye.apply(settings);
        self.home = self.mode.unwrap_or(settings.mode);
        let size_px = [self.size_px.x as u32, self.size_px.y as u32];
        self.resize(settings, size_px, now_us);
        self.apply_input(settings, now_us);
    }

    /// A key that stands in for a control.
    pub(super) fn key(&mut self, key: Key, down: bool, now_us: u64) {
        self.kiosk.stir(millis(now_us));
        self.carry_out(now_us);
        {
            let scene = self.worlds.scene(self.map, self.eye.in_flight(), &self.panels);
            self.instrument.key(key, down, now_us, &scene);
        }
        self.carry_out_deeds(now_us);
    }

    /// Staff want the table fresh.
    pub(super) fn start_afresh(&mut self, now_us: u64) {
        self.kiosk.reset(millis(now_us));
        self.carry_out(now_us);
    }

    pub(super) fn take(&mut self, events: Vec<ContactEvent>, now_us: u64) {
        for event in events {
            self.contact(&event, now_us);
        }
    }

    /// One event of one contact, to its owner.
    fn contact(&mut self, event: &ContactEvent, now_us: u64) {
        self.now_us = now_us;
        let now_ms = millis(now_us);
        match event.phase {
            ContactPhase::Down => drop(self.since_us.insert(event.contact.key, now_us)),
            ContactPhase::Up | ContactPhase::Cancel => drop(self.since_us.remove(&event.contact.key)),
            ContactPhase::Move => {}
        }
        if self.calibrates(event, now_us) {
            return;
        }
        if self.cleaning_s().is_some() {
            self.seen.push(Seen {
                event: *event,
                route: Route::Ignored,
            });
            return;
        }
        self.kiosk.feed(event, now_ms);
        self.carry_out(now_us);
        self.turn_view(now_us);
        let scene = self.worlds.scene(self.map, self.eye.in_flight(), &self.panels);
        let route = self.instrument.feed(event, now_us, &scene);
        self.door.feed(event, now_ms);
        match route {
            Route::Land => self.worlds.send(vec![*event], Vec::new(), now_us),
            Route::Control if event.phase == ContactPhase::Down => self.control_presses += 1,
            Route::Panel => self.door.stir(now_ms),
            _ => {}
        }
        self.seen.push(Seen { event: *event, route });
        self.carry_out_deeds(now_us);
    }

    /// Time goes on: the circle, the show, the view, the session. Once a frame, before it is drawn.
    pub(super) fn step(&mut self, settings: &Settings, now_us: u64, dt_s: f64) {
        self.now_us = now_us;
        let now_ms = millis(now_us);
        self.kiosk.tick(now_ms);
        self.door.tick(now_ms);
        self.carry_out(now_us);
        let show = self.shows.advance(now_us, &self.worlds);
        if let Some(seed) = show.fresh {
            self.worlds.restart(seed);
        }
        for frame in &show.frames {
            self.show_contacts(frame, now_us);
        }
        {
            let scene = self.worlds.scene(self.map, self.eye.in_flight(), &self.panels);
            self.instrument.tick(now_us, &scene);
        }
        self.carry_out_deeds(now_us);
        self.worlds.advance(now_us);
        if self.lively() {
            self.worlds.watch_pace(now_us);
        }
        // (Counts would not do: those of the session before may be in the frame still.)
        if self.worlds.pushed() && !self.shows.playing() {
            self.kiosk.pushed(now_ms);
            self.carry_out(now_us);
        }
        self.wishes_fly = show.fly;
        self.turn_view(now_us);
        self.eye.look(
            self.worlds.mountain(),
            (self.map.extent(), self.size_px),
            self.kiosk.phase() != Phase::Reset,
            settings,
            dt_s,
        );
        self.saver.step(now_us);
        self.instrument.set_making(self.saver.final_done().map(f64::from));
    }
}

/// Table time in the milliseconds of the circle.
pub(super) fn millis(now_us: u64) -> u64 {
    now_us / 1000
}
