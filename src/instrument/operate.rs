//! What controls and keys do, and how controls are shown.

use super::control::{ControlId, ControlKind, ControlView};
use super::deed::{Deed, Key, Scene};
use super::history;
use super::layout::Placed;
use super::press::{Finger, Press};
use super::speed::Speeds;
use super::table::Instrument;
use crate::gesture::command::{Action, Mode, Tool};
use crate::gesture::contact::Side;

impl Instrument {
    /// A key that stands in for a control of the south side goes down or up. Repeats of a key that is down do no harm,
    /// and let speed and history go on.
    pub fn key(&mut self, key: Key, down: bool, now_us: u64, scene: &Scene<'_>) {
        self.look(now_us, scene);
        let kind = match key {
            Key::PlayPause => ControlKind::PlayPause,
            Key::Undo => ControlKind::Undo,
            Key::Tool(tool) => ControlKind::Tool(tool),
            Key::Readouts => ControlKind::Readouts,
            Key::Save => ControlKind::Save,
            Key::Final => ControlKind::Final,
            Key::World => ControlKind::World,
            Key::StartOver => ControlKind::StartOver,
            Key::Faster | Key::Slower if down => {
                let pace = self
                    .speeds()
                    .stepped(self.clock.pace_yr_per_s, key == Key::Faster);
                return self.command(Some(Action::Speed(pace)), Side::South, None);
            }
            Key::Back | Key::Forward if down => {
                let years = history::stepped(&self.clock, key == Key::Forward);
                return self.command(years.map(Action::Scrub), Side::South, None);
            }
            Key::Faster | Key::Slower | Key::Back | Key::Forward => return,
        };
        let id = ControlId(Side::South, kind);
        if !self.placed.iter().any(|placed| placed.id == id) {
            return;
        }
        if down {
            self.presses.entry(id).or_insert(Press::new(Finger::Key, now_us));
        } else {
            self.release(id, Finger::Key, true);
        }
    }

    /// The controls as they are now, north side first.
    pub fn controls(&self) -> Vec<ControlView> {
        let each = self.placed.iter().zip(&self.glow);
        each.filter(|(placed, _)| self.is_there(placed.id))
            .map(|(placed, &glow)| self.view(placed, glow))
            .collect()
    }

    pub(super) fn release(&mut self, id: ControlId, finger: Finger, lifted: bool) {
        if self.presses.get(&id).is_none_or(|press| press.finger != finger) {
            return;
        }
        if lifted {
            self.follow_slider(id, u64::MAX);
        }
        if let Some(press) = self.presses.remove(&id)
            && lifted
            // Between two looks of a slow machine it may have been held long enough.
            && (press.acts_on_lift(id.1) || press.held_long_enough(id.1, self.now_us))
        {
            self.act(id, finger);
        }
    }

    /// A control does what it does.
    pub(super) fn act(&mut self, ControlId(side, kind): ControlId, finger: Finger) {
        let action = match kind {
            ControlKind::Tool(tool) => {
                let tool = if self.tool(side) == tool { Tool::Push } else { tool };
                self.take_up(side, tool);
                Action::Tool(tool)
            }
            ControlKind::Undo if self.clock.can_undo[side as usize] => {
                // The handle may be that of the line that is undone.
                self.drawn[side as usize] = None;
                Action::Undo
            }
            ControlKind::PlayPause if self.clock.paused => Action::Play,
            ControlKind::PlayPause => Action::Pause,
            ControlKind::Speed => Action::Speed(self.speeds().next(self.clock.pace_yr_per_s)),
            ControlKind::StartOver => Action::StartOver,
            ControlKind::Readouts => return self.toggle_readouts(side),
            ControlKind::Save if self.making.is_none() => return self.deeds.push(Deed::Save { side }),
            ControlKind::Final => {
                let on = self.making.is_none();
                return self.deeds.push(Deed::FinalLand { side, on });
            }
            ControlKind::World => {
                let mode = match self.params.mode {
                    Mode::Mountain => Mode::Globe,
                    Mode::Globe => Mode::Mountain,
                };
                return self.deeds.push(Deed::World { side, mode });
            }
            ControlKind::FreezeSlice => Action::FreezeSlice(self.cuts[side as usize] != Some(true)),
            ControlKind::CloseSlice => Action::CloseSlice,
            ControlKind::Undo | ControlKind::Save | ControlKind::Scrub => return,
        };
        self.command(Some(action), side, finger.contact());
    }

    pub(super) fn toggle_readouts(&mut self, side: Side) {
        let on = !self.readouts(side);
        self.readouts[side as usize] = on;
        self.deeds.push(Deed::Readouts { side, on });
    }

    /// Sends the clock after the finger on a slider, not more often than the session can follow.
    pub(super) fn follow_slider(&mut self, id: ControlId, now_us: u64) {
        let placed = self.placed.iter().find(|placed| placed.id == id);
        let (Some(placed), Some(press)) = (placed, self.presses.get_mut(&id)) else {
            return;
        };
        if id.1 != ControlKind::Scrub || !history::exists(&self.clock) {
            return;
        }
        if let Some(part) = press.follow(placed.along(press.at), now_us) {
            let contact = press.finger.contact();
            let years = history::years_at(&self.clock, part);
            self.command(Some(Action::Scrub(years)), id.0, contact);
        }
    }

    fn speeds(&self) -> &'static Speeds {
        Speeds::of(self.params.mode)
    }

    fn view(&self, placed: &Placed, glow: f64) -> ControlView {
        let ControlId(side, kind) = placed.id;
        let press = self.presses.get(&placed.id);
        ControlView {
            id: placed.id,
            side,
            kind,
            centre_mm: placed.centre,
            half_size_mm: placed.half,
            rotation: placed.rotation(),
            pressed: press.is_some_and(|press| press.inside),
            progress: press.map_or(0.0, |press| press.progress(kind, self.now_us)),
            on: match kind {
                ControlKind::Tool(tool) => self.tool(side) == tool,
                ControlKind::PlayPause => !self.clock.paused,
                ControlKind::Readouts => self.readouts(side),
                ControlKind::Final => self.making.is_some(),
                ControlKind::World => self.params.mode == Mode::Mountain,
                ControlKind::FreezeSlice => self.cuts[side as usize] == Some(true),
                _ => false,
            },
            enabled: match kind {
                ControlKind::Undo => self.clock.can_undo[side as usize],
                ControlKind::Scrub => history::exists(&self.clock),
                // One after the other.
                ControlKind::Save => self.making.is_none(),
                _ => true,
            },
            value: match kind {
                ControlKind::Final => self.making.unwrap_or(0.0),
                ControlKind::Speed => self.speeds().place(self.clock.pace_yr_per_s),
                // While a finger drags it, the slider is where the finger is: the land follows.
                ControlKind::Scrub => {
                    press.map_or_else(|| history::place(&self.clock), |p| placed.along(p.at))
                }
                _ => 0.0,
            },
            glow: if press.is_some() { 1.0 } else { glow },
        }
    }
}
