//! The slots of protocol B: readings in, what contacts do out.

use std::collections::{BTreeMap, BTreeSet};

use super::codes::ABS_MT_TRACKING_ID;
use super::touch::{RawEvent, Readings, Touch};
use crate::gesture::contact::Phase;

/// Who is in a slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tracking {
    /// Not told since the recording began, or since events were dropped.
    #[default]
    Unknown,
    /// A contact that was there before anything was told.
    Unnamed,
    /// A contact with its tracking id.
    Named(i32),
    /// Nobody.
    Free,
}

#[derive(Debug, Default)]
struct Slot {
    tracking: Tracking,
    /// Contacts inherit what the kernel does not repeat.
    readings: Readings,
    /// The contact that is down after the last frame.
    shown: Option<Touch>,
    /// True if that one lifted since.
    lifted: bool,
    /// How often a contact went down here.
    downs: u32,
}

/// All slots of a device.
#[derive(Debug, Default)]
pub(super) struct Slots {
    by_number: BTreeMap<u16, Slot>,
    /// The slot that events speak of.
    selected: u16,
    /// The slots of which the frame speaks.
    touched: BTreeSet<u16>,
    /// Contacts that were down before anything was told of them.
    pub(super) mid_touch: usize,
    /// Contacts of which no frame knew the whole position.
    pub(super) unplaced: usize,
}

impl Slots {
    pub(super) fn select(&mut self, slot: u16) {
        self.selected = slot;
    }

    /// Takes a reading of the selected slot.
    pub(super) fn read(&mut self, code: u16, value: i32) {
        self.touched.insert(self.selected);
        if code == ABS_MT_TRACKING_ID {
            self.track(value);
        } else {
            let slot = self.by_number.entry(self.selected).or_default();
            slot.readings.tell(code, value);
        }
    }

    /// The tracking id of the selected slot changes.
    fn track(&mut self, id: i32) {
        let slot = self.by_number.entry(self.selected).or_default();
        let now = if id < 0 {
            Tracking::Free
        } else {
            Tracking::Named(id)
        };
        let before = std::mem::replace(&mut slot.tracking, now);
        if before != now && matches!(before, Tracking::Named(_) | Tracking::Unnamed) {
            if slot.shown.is_some() && !slot.lifted {
                slot.lifted = true;
            } else {
                self.unplaced += 1;
            }
        }
    }

    /// The frame is complete: what its contacts do, slot by slot.
    pub(super) fn report(&mut self) -> Vec<RawEvent> {
        let mut events = Vec::new();
        for number in std::mem::take(&mut self.touched) {
            let slot = self.by_number.entry(number).or_default();
            let mut say = |phase, downs: u32, touch| {
                events.push(RawEvent {
                    phase,
                    slot: number,
                    generation: downs - 1,
                    touch,
                });
            };
            if std::mem::take(&mut slot.lifted)
                && let Some(touch) = slot.shown.take()
            {
                say(Phase::Up, slot.downs, touch);
            }
            let Some(touch) = slot.readings.touch() else {
                continue;
            };
            if slot.tracking == Tracking::Unknown {
                slot.tracking = Tracking::Unnamed;
                self.mid_touch += 1;
            }
            if slot.tracking == Tracking::Free {
                continue;
            }
            match slot.shown.replace(touch) {
                None => {
                    slot.downs += 1;
                    say(Phase::Down, slot.downs, touch);
                }
                Some(before) if before != touch => say(Phase::Move, slot.downs, touch),
                Some(_) => {}
            }
        }
        events
    }

    /// Cancels all contacts and forgets what slots read: events are missing, or the recording is over.
    pub(super) fn drop_all(&mut self) -> Vec<RawEvent> {
        self.touched.clear();
        let mut events = Vec::new();
        for (&number, slot) in &mut self.by_number {
            if let Some(touch) = slot.shown {
                events.push(RawEvent {
                    phase: Phase::Cancel,
                    slot: number,
                    generation: slot.downs - 1,
                    touch,
                });
            } else if matches!(slot.tracking, Tracking::Named(_)) {
                self.unplaced += 1;
            }
            *slot = Slot {
                downs: slot.downs,
                ..Slot::default()
            };
        }
        events
    }
}
