//! A table with an instrument on it, for tests.

use glam::DVec2;
use orogen::gesture::command::Mode;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, Phase, Side, Source};
use orogen::gesture::params::GestureParams;
use orogen::instrument::{ControlKind, ControlView, Instrument, InstrumentParams, Key, Route, Scene};
use orogen::live::Clock;
use orogen::settings::Corner;
use orogen::surface::{Cut, FaultTrace, PlateMark};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

pub(crate) const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);

/// A millisecond in µs.
pub(crate) const MS: u64 = 1000;

pub(crate) fn params() -> InstrumentParams {
    InstrumentParams {
        size_mm: SIZE_MM,
        corner: Corner::NorthWest,
        unattended: false,
        artists: true,
        mode: Mode::Mountain,
        readouts: false,
        gesture: GestureParams::default(),
    }
}

pub(crate) fn contact(id: u64, position: DVec2) -> Contact {
    Contact {
        key: ContactKey {
            source: Source::Window,
            device: 0,
            id,
            generation: 0,
        },
        position,
        size_mm: None,
        confidence: None,
    }
}

/// A table whose clock runs at half a million years per second and where both sides can undo.
pub(crate) struct Table {
    pub(crate) instrument: Instrument,
    pub(crate) now_us: u64,
    pub(crate) set: Set,
}

/// What the instrument sees.
pub(crate) struct Set {
    pub(crate) clock: Clock,
    pub(crate) plates: Vec<PlateMark>,
    pub(crate) faults: Vec<FaultTrace>,
    pub(crate) cuts: [Option<Cut>; 2],
    pub(crate) in_flight: bool,
    pub(crate) panels: Vec<(DVec2, DVec2)>,
    pub(crate) map: PlanMap,
}

impl Set {
    pub(crate) fn scene(&self) -> Scene<'_> {
        Scene {
            plates: &self.plates,
            faults: &self.faults,
            cuts: &self.cuts,
            map: self.map,
            clock: &self.clock,
            in_flight: self.in_flight,
            panels: &self.panels,
        }
    }
}

impl Table {
    pub(crate) fn new() -> Self {
        let mut table = Self {
            instrument: Instrument::new(params()),
            now_us: 0,
            set: Set {
                clock: Clock {
                    pace_yr_per_s: 0.5e6,
                    can_undo: [true; 2],
                    ..Clock::default()
                },
                plates: Vec::new(),
                faults: Vec::new(),
                cuts: [None, None],
                in_flight: false,
                panels: Vec::new(),
                map: PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE),
            },
        };
        table.wait(0);
        table
    }

    /// Looks every 16 ms, and at the end.
    pub(crate) fn wait(&mut self, ms: u64) {
        let end = self.now_us + ms * MS;
        loop {
            self.tick();
            if self.now_us == end {
                break;
            }
            self.now_us = (self.now_us + 16 * MS).min(end);
        }
    }

    pub(crate) fn tick(&mut self) {
        self.instrument.tick(self.now_us, &self.set.scene());
    }

    pub(crate) fn event(&mut self, phase: Phase, contact: Contact) -> Route {
        let event = ContactEvent { phase, contact };
        self.instrument.feed(&event, self.now_us, &self.set.scene())
    }

    pub(crate) fn down(&mut self, id: u64, at: DVec2) -> Route {
        self.event(Phase::Down, contact(id, at))
    }

    pub(crate) fn shift(&mut self, id: u64, at: DVec2) -> Route {
        self.event(Phase::Move, contact(id, at))
    }

    /// Lifts where it last was: the instrument must not look at the position of an end.
    pub(crate) fn up(&mut self, id: u64) -> Route {
        self.event(Phase::Up, contact(id, DVec2::ZERO))
    }

    pub(crate) fn cancel(&mut self, id: u64) -> Route {
        self.event(Phase::Cancel, contact(id, DVec2::ZERO))
    }

    pub(crate) fn tap(&mut self, id: u64, at: DVec2) {
        self.down(id, at);
        self.up(id);
    }

    pub(crate) fn key(&mut self, key: Key, down: bool) {
        self.instrument.key(key, down, self.now_us, &self.set.scene());
    }

    pub(crate) fn control(&self, side: Side, kind: ControlKind) -> ControlView {
        let controls = self.instrument.controls();
        let found = controls.iter().find(|c| c.side == side && c.kind == kind);
        *found.expect("a control that is shown")
    }

    /// The middle of a control, whether it is shown or not.
    pub(crate) fn place(&self, side: Side, kind: ControlKind) -> DVec2 {
        let mut paused = Instrument::new(*self.instrument.params());
        let clock = Clock {
            paused: true,
            ..self.set.clock
        };
        paused.tick(
            0,
            &Scene {
                clock: &clock,
                ..self.set.scene()
            },
        );
        let controls = paused.controls();
        let found = controls.iter().find(|c| c.side == side && c.kind == kind);
        found.expect("a control").centre_mm
    }
}
