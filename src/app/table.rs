//! The table without its window: who owns which contact, which phase it is, what the session is told.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::DVec2;

use super::save::Saver;
use super::setup::{door_params, grounded, instrument_params, nodes, raster_width, window_map};
use super::{AppError, Options};
use crate::gesture::command::{Action, Command};
use crate::gesture::contact::{ContactEvent, ContactKey, Phase as ContactPhase, Side};
use crate::gesture::hand::{Doing, HandView};
use crate::input::window::{TouchPhase, WindowInput};
use crate::instrument::{ControlId, Deed, Instrument, Key, Route, Scene};
use crate::kiosk::{DoorPhase, Effect, Flight, FlightWish, Kiosk, KioskParams, Phase, Show, StaffDoor};
use crate::live::{Frame, Heartbeat, LiveParams, Session, Start};
use crate::render::{Camera, Focus, LandStyle, flight};
use crate::rock::Stratigraphy;
use crate::settings::Settings;
use crate::sim::SimParams;
use crate::units::PlanMap;

/// Time in which the room's light follows a reset, s.
const EASE_S: f64 = 0.25;
/// Time in which the eye follows a land that changes under it, s: slower than anybody notices.
const FOLLOWS_S: f64 = 6.0;
/// How long touches do nothing while the table is wiped, µs.
const CLEANING_US: u64 = 30_000_000;

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

/// What the instrument must see, borrowed for one call.
macro_rules! with_scene {
    ($table:ident, $scene:ident => $call:expr) => {{
        let frame = $table.session.current();
        let $scene = Scene {
            plates: &frame.surface.plates,
            faults: &frame.surface.faults,
            cuts: &frame.cuts,
            map: $table.map,
            clock: &frame.clock,
            in_flight: $table.flight.in_flight(),
            panels: &$table.panels,
        };
        $call
    }};
}

/// The table.
pub(super) struct Table {
    unattended: bool,
    pub(super) map: PlanMap,
    pub(super) size_px: DVec2,
    pub(super) input: WindowInput,
    pub(super) instrument: Instrument,
    pub(super) kiosk: Kiosk,
    show: Show,
    door: StaffDoor,
    flight: Flight,
    /// The flight on the ground, to begin anew with.
    grounded: Flight,
    wishes_fly: bool,
    pub(super) session: Session,
    saver: Saver,
    /// Rectangles of panels, table mm.
    panels: Vec<(DVec2, DVec2)>,
    seen: Vec<Seen>,
    /// A place on a side's sheet where somebody wants a note, parts of its size.
    note: Option<(Side, DVec2)>,
    focus: Focus,
    focus_goal: Focus,
    /// The land that the goal was found on.
    focus_land: u64,
    camera: Camera,
    style: LandStyle,
    visitors: u64,
    pub(super) resets: u64,
    in_reset: bool,
    pub(super) control_presses: u64,
    pub(super) nodes: usize,
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
        let nodes = nodes(settings, software);
        let session = Session::spawn(LiveParams {
            map,
            nodes,
            seed: 1,
            layers,
            sim: SimParams::default(),
            raster_width: raster_width(software),
            threads: 0,
        })
        .map_err(|error| AppError::Other(format!("the session cannot begin: {error}")))?;
        let focus = Focus::of(&session.current().surface);
        Ok(Self {
            unattended,
            map,
            size_px,
            input: WindowInput::new(window_map(settings, &map, size_px)),
            instrument: Instrument::new(instrument_params(settings, size_mm, unattended)),
            kiosk: Kiosk::new(KioskParams::new(&settings.kiosk, unattended)),
            show: Show::new(size_mm),
            door: StaffDoor::new(door_params(settings, size_mm)),
            flight: grounded(settings),
            grounded: grounded(settings),
            wishes_fly: false,
            session,
            saver: Saver::new(options.save.clone()),
            panels: Vec::new(),
            seen: Vec::new(),
            note: None,
            focus,
            focus_goal: focus,
            focus_land: 0,
            camera: Camera::plan(map.extent(), size_px),
            style: LandStyle::default(),
            visitors: 1,
            resets: 0,
            in_reset: false,
            control_presses: 0,
            nodes,
            now_us: 0,
            cleaning_until_us: 0,
            since_us: BTreeMap::new(),
            layout_told: None,
        })
    }

    /// The newest frame of the session.
    pub(super) fn frame(&self) -> &Frame {
        self.session.current()
    }

    /// Counts the beats of the session's thread.
    pub(super) fn session_beats(&self) -> Heartbeat {
        self.session.heartbeat()
    }

    /// The eye of the next picture.
    pub(super) fn camera(&self) -> &Camera {
        &self.camera
    }

    /// How the land is shown in the next picture.
    pub(super) fn style(&self) -> &LandStyle {
        &self.style
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

    /// How far the view is from the plan, 0–1.
    pub(super) fn aloft(&self) -> f64 {
        self.flight.amount()
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
        !settings.view.tools.are_few(self.unattended)
    }

    /// A side does something that has no control.
    pub(super) fn command(&mut self, action: Action, side: Side) {
        let command = Command {
            side: Some(side),
            ..Command::new(action)
        };
        self.session.send(Vec::new(), vec![command], self.now_us);
    }

    /// Rectangles of panels, table mm: contacts that land there are the panels'.
    pub(super) fn set_panels(&mut self, panels: Vec<(DVec2, DVec2)>) {
        self.panels = panels;
    }

    /// Contacts that are down: where, table mm, and for how long, s.
    pub(super) fn contact_ages(&self) -> impl Iterator<Item = (DVec2, f64)> {
        self.input.contacts().map(|contact| {
            let since_us = self.since_us.get(&contact.key).copied().unwrap_or(self.now_us);
            (
                contact.position,
                self.now_us.saturating_sub(since_us) as f64 / 1e6,
            )
        })
    }

    /// Nodes of the land.
    pub(super) fn nodes(&self) -> usize {
        self.nodes
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
        self.input.contacts().count()
    }

    /// True while somebody is there or the land moves under hands: then every frame counts.
    pub(super) fn lively(&self) -> bool {
        self.kiosk.phase() != Phase::Attract || self.contacts() > 0
    }

    /// What the window tells.
    pub(super) fn raw(&mut self, raw: Raw, now_us: u64) {
        let mut events = Vec::new();
        match raw {
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
        self.take(events, now_us);
        self.instrument.cancel_all();
    }

    /// The window has another size. The land keeps its own, and is shown as large as it fits.
    pub(super) fn resize(&mut self, settings: &Settings, size_px: [u32; 2], now_us: u64) {
        self.size_px = DVec2::from(size_px.map(f64::from));
        let mut events = Vec::new();
        let map = window_map(settings, &self.map, self.size_px);
        self.input.set_map(map, &mut events);
        self.take(events, now_us);
        self.layout_told = None;
    }

    /// Settings have changed: everything but the land's size follows at once.
    pub(super) fn apply(&mut self, settings: &Settings, now_us: u64) {
        let size_mm = self.map.size_mm();
        self.instrument
            .set_params(instrument_params(settings, size_mm, self.unattended));
        self.kiosk
            .set_params(KioskParams::new(&settings.kiosk, self.unattended));
        self.door.set_params(door_params(settings, size_mm));
        self.grounded = grounded(settings);
        self.flight = self.grounded.clone();
        let size_px = [self.size_px.x as u32, self.size_px.y as u32];
        self.resize(settings, size_px, now_us);
    }

    /// A key that stands in for a control.
    pub(super) fn key(&mut self, key: Key, down: bool, now_us: u64) {
        self.kiosk.stir(millis(now_us));
        self.carry_out(now_us);
        with_scene!(self, scene => self.instrument.key(key, down, now_us, &scene));
        self.carry_out_deeds(now_us);
    }

    /// Staff want the table fresh.
    pub(super) fn start_afresh(&mut self, now_us: u64) {
        self.kiosk.reset(millis(now_us));
        self.carry_out(now_us);
    }

    /// The land is to be saved.
    pub(super) fn save(&mut self) {
        self.saver.ask(&self.session);
    }

    /// The last minute of contacts is to be saved.
    pub(super) fn save_contacts(&mut self) {
        self.saver.ask_contacts(&self.session);
    }

    /// Writes the settings, if there is a file for them.
    pub(super) fn save_settings(&mut self, settings: &Settings, path: Option<&Path>) {
        self.saver.settings(settings, path);
    }

    fn take(&mut self, events: Vec<ContactEvent>, now_us: u64) {
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
        let route = with_scene!(self, scene => self.instrument.feed(event, now_us, &scene));
        self.door.feed(event, now_ms);
        match route {
            Route::Land => self.session.send(vec![*event], Vec::new(), now_us),
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
        let show = self.show.advance(now_us);
        if let Some(seed) = show.fresh {
            self.session.restart(Start::Seed(seed));
        }
        for frame in &show.frames {
            self.session
                .send(frame.events.clone(), frame.commands.clone(), now_us);
            self.seen.extend(frame.events.iter().map(|&event| Seen {
                event,
                route: Route::Land,
            }));
        }
        with_scene!(self, scene => self.instrument.tick(now_us, &scene));
        self.carry_out_deeds(now_us);
        self.session.advance(now_us);
        self.session.frame();
        // (Counts would not do: those of the session before may be in the frame still.)
        let pushing = |hand: &HandView| matches!(hand.doing, Doing::Pushing { .. });
        if self.frame().hands.iter().any(pushing) && !self.show.playing() {
            self.kiosk.pushed(now_ms);
            self.carry_out(now_us);
        }
        self.wishes_fly = show.fly;
        self.turn_view(now_us);
        self.look(settings, dt_s);
        self.saver.step(now_us);
    }

    /// Where the view goes.
    fn turn_view(&mut self, now_us: u64) {
        let wish = if !matches!(self.door.phase(), DoorPhase::Shut | DoorPhase::Holding { .. }) {
            FlightWish::Plan
        } else if self.show.playing() {
            if self.wishes_fly {
                FlightWish::Fly
            } else {
                FlightWish::Plan
            }
        } else if self.frame().clock.paused
            || matches!(self.kiosk.phase(), Phase::IdleWarning { .. } | Phase::Reset)
        {
            FlightWish::Plan
        } else {
            FlightWish::WhenUntouched
        };
        self.flight.tick(millis(now_us), wish, self.kiosk.untouched_ms());
    }

    /// Camera, exaggeration and light of the next picture.
    fn look(&mut self, settings: &Settings, dt_s: f64) {
        let aloft = self.flight.amount();
        if self.focus_land != self.frame().land {
            // Looked for only where the eye may be needed: when the land has changed.
            self.focus_land = self.frame().land;
            self.focus_goal = Focus::of(&self.frame().surface);
        }
        let follows = if aloft > 0.0 {
            1.0 - (-dt_s / FOLLOWS_S).exp()
        } else {
            1.0
        };
        self.focus = self.focus.towards(&self.focus_goal, follows);
        let eye = flight(&self.focus, &self.style, self.flight.aloft_s());
        self.camera = Camera::between(self.map.extent(), self.size_px, &eye, aloft);
        let lamp_goal = match self.kiosk.phase() {
            Phase::Reset => 0.0,
            _ => 1.0,
        };
        let eased = if settings.view.reduced_motion {
            1.0
        } else {
            1.0 - (-dt_s / EASE_S).exp()
        };
        self.style.lamp += (lamp_goal - self.style.lamp) * eased as f32;
    }

    /// Does what the circle asks for.
    fn carry_out(&mut self, now_us: u64) {
        for effect in self.kiosk.drain() {
            match effect {
                Effect::StartShow => self.show.start(),
                Effect::CancelShow => {
                    if let Some(frame) = self.show.stop(now_us) {
                        self.session.send(frame.events.clone(), Vec::new(), now_us);
                        self.seen.extend(frame.events.iter().map(|&event| Seen {
                            event,
                            route: Route::Land,
                        }));
                    }
                }
                Effect::CancelContacts => {
                    let mut events = Vec::new();
                    self.input.cancel_all(&mut events);
                    for event in &events {
                        self.session.send(vec![*event], Vec::new(), now_us);
                        self.seen.push(Seen {
                            event: *event,
                            route: Route::Ignored,
                        });
                    }
                    self.instrument.cancel_all();
                }
                Effect::FreshLand => {
                    self.visitors += 1;
                    self.session.restart(Start::Seed(self.visitors));
                }
                Effect::ResetTools => self.instrument.reset(),
                Effect::ResetView => self.flight = self.grounded.clone(),
            }
        }
        if self.kiosk.phase() == Phase::Reset && !self.in_reset {
            self.resets += 1;
        }
        self.in_reset = self.kiosk.phase() == Phase::Reset;
    }

    fn carry_out_deeds(&mut self, now_us: u64) {
        for deed in self.instrument.drain() {
            match deed {
                Deed::Command(command) => self.session.send(Vec::new(), vec![command], now_us),
                Deed::Save { .. } => self.save(),
                // The instrument remembers what it shows.
                Deed::Readouts { .. } => {}
                Deed::Note { side, at } => self.note = Some((side, at)),
            }
        }
    }
}

/// Table time in the milliseconds of the circle.
fn millis(now_us: u64) -> u64 {
    now_us / 1000
}
