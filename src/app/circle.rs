//! What the kiosk's circle, its shows and the instrument ask of the table.

use super::table::{Seen, Table, millis};
use crate::gesture::command::Mode;
use crate::gesture::contact::InputFrame;
use crate::instrument::{Deed, InstrumentParams, Route};
use crate::kiosk::{DoorPhase, Effect, FlightWish, Phase};

impl Table {
    /// Plays a frame of the show: its contacts are seen, too.
    pub(super) fn show_contacts(&mut self, frame: &InputFrame, now_us: u64) {
        self.worlds
            .send(frame.events.clone(), frame.commands.clone(), now_us);
        self.seen.extend(frame.events.iter().map(|&event| Seen {
            event,
            route: Route::Land,
        }));
    }

    /// Shows another world; contacts that are down end in the one before.
    fn turn_to(&mut self, mode: Mode, now_us: u64) {
        if mode == self.worlds.shown() {
            return;
        }
        self.withdraw_contacts(now_us);
        self.stop_show(now_us);
        // What the tools leave behind belongs to the world before.
        self.instrument.reset();
        self.carry_out_deeds(now_us);
        self.eye.land();
        self.worlds.turn_to(mode);
        let params = *self.instrument.params();
        self.instrument.set_params(InstrumentParams {
            mode: self.worlds.shown(),
            ..params
        });
    }

    fn withdraw_contacts(&mut self, now_us: u64) {
        let mut events = Vec::new();
        self.input.cancel_all(&mut events);
        self.stream.cancel_all(&mut events);
        for event in &events {
            self.worlds.send(vec![*event], Vec::new(), now_us);
            self.seen.push(Seen {
                event: *event,
                route: Route::Ignored,
            });
        }
        self.instrument.cancel_all();
    }

    fn stop_show(&mut self, now_us: u64) {
        if let Some(frame) = self.shows.stop(now_us) {
            self.show_contacts(&frame, now_us);
        }
    }

    /// Where the view goes.
    pub(super) fn turn_view(&mut self, now_us: u64) {
        let wish = if !matches!(self.door.phase(), DoorPhase::Shut | DoorPhase::Holding { .. }) {
            FlightWish::Plan
        } else if self.shows.playing() {
            if self.wishes_fly {
                FlightWish::Fly
            } else {
                FlightWish::Plan
            }
        } else if self.worlds.clock().paused
            || matches!(self.kiosk.phase(), Phase::IdleWarning { .. } | Phase::Reset)
        {
            FlightWish::Plan
        } else {
            FlightWish::WhenUntouched
        };
        self.eye.turn(millis(now_us), wish, self.kiosk.untouched_ms());
    }

    /// Does what the circle asks for.
    pub(super) fn carry_out(&mut self, now_us: u64) {
        for effect in self.kiosk.drain() {
            match effect {
                Effect::StartShow => self.shows.start(&self.worlds),
                Effect::CancelShow => self.stop_show(now_us),
                Effect::CancelContacts => self.withdraw_contacts(now_us),
                Effect::FreshLand => {
                    self.visitors += 1;
                    self.worlds.restart_both(self.visitors);
                    self.turn_to(self.home, now_us);
                }
                Effect::ResetTools => self.instrument.reset(),
                Effect::ResetView => self.eye.land(),
            }
        }
        if self.kiosk.phase() == Phase::Reset && !self.in_reset {
            self.resets += 1;
        }
        self.in_reset = self.kiosk.phase() == Phase::Reset;
    }

    pub(super) fn carry_out_deeds(&mut self, now_us: u64) {
        for deed in self.instrument.drain() {
            match deed {
                Deed::Command(command) => self.worlds.send(Vec::new(), vec![command], now_us),
                Deed::Save { .. } => self.save(),
                Deed::FinalLand { on: true, .. } => self.save_final(),
                Deed::FinalLand { on: false, .. } => self.cancel_final(),
                // The instrument remembers what it shows.
                Deed::Readouts { .. } => {}
                Deed::World { mode, .. } => self.turn_to(mode, now_us),
                Deed::Note { side, at } => self.note = Some((side, at)),
            }
        }
    }
}
