//! What one bundle says, before it is known whether it comes too late.
//!
//! The number of a frame may stand behind everything else, so nothing is believed before the bundle ends.

use super::contacts::Reading;
use super::osc::{Argument, Message};
use super::{TuioCounts, v1, v2};
use crate::gesture::contact::MAX_CONTACTS;

/// Profiles of TUIO 1.1 that are listened to.
pub(super) const PROFILES: usize = 3;

/// Readings of a bundle that are kept: one for each contact of each profile.
const MAX_READINGS: usize = PROFILES * MAX_CONTACTS;

/// Bytes of a sender's name that tell it from others.
pub(super) const NAME_BYTES: usize = 128;

/// Farthest from the surface that a place may be, in parts of it. Beyond that somebody sends pixels.
const FARTHEST: f64 = 1.0;

/// A list of those alive: ascending, each once.
#[derive(Clone, Debug)]
pub(super) struct Alive {
    pub(super) ids: Vec<u32>,
    /// False while the bundle has no such list.
    pub(super) listed: bool,
}

impl Alive {
    fn new() -> Self {
        Self {
            ids: Vec::with_capacity(MAX_CONTACTS),
            listed: false,
        }
    }

    /// Another list, which replaces what an earlier message listed.
    pub(super) fn list<'a>(&mut self, ids: impl Iterator<Item = Argument<'a>>, counts: &mut TuioCounts) {
        self.listed = true;
        self.ids.clear();
        for argument in ids {
            match session_id(argument) {
                Some(_) if self.ids.len() == MAX_CONTACTS => counts.over_cap += 1,
                Some(id) => self.ids.push(id),
                None => counts.faulty_messages += 1,
            }
        }
        self.ids.sort_unstable();
        self.ids.dedup();
    }
}

/// The head of a frame of TUIO 2.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FrameHead {
    /// Frame id; 0 where the sender does not count.
    pub(super) id: u32,
    /// Columns and rows of the sensor; 0 where unknown.
    pub(super) sensor: [u16; 2],
}

/// What one bundle says.
#[derive(Clone, Debug)]
pub(super) struct Bundle {
    /// The sender's name for itself; empty where it has none.
    pub(super) name: Vec<u8>,
    /// TUIO 1.1: who is alive, by profile. TUIO 2.0 uses the first.
    pub(super) alive: [Alive; PROFILES],
    /// TUIO 1.1: number of the frame, by profile.
    pub(super) number: [Option<i32>; PROFILES],
    /// Profile and reading, in the order of the messages.
    pub(super) readings: Vec<(usize, Reading)>,
    /// True when it speaks TUIO 1.1.
    pub(super) speaks_v1: bool,
    /// True when it speaks TUIO 2.0.
    pub(super) speaks_v2: bool,
    pub(super) head: Option<FrameHead>,
}

impl Bundle {
    pub(super) fn new() -> Self {
        Self {
            name: Vec::with_capacity(NAME_BYTES),
            alive: [Alive::new(), Alive::new(), Alive::new()],
            number: [None; PROFILES],
            readings: Vec::with_capacity(MAX_READINGS),
            speaks_v1: false,
            speaks_v2: false,
            head: None,
        }
    }

    pub(super) fn clear(&mut self) {
        self.name.clear();
        for alive in &mut self.alive {
            alive.ids.clear();
            alive.listed = false;
        }
        self.number = [None; PROFILES];
        self.readings.clear();
        self.speaks_v1 = false;
        self.speaks_v2 = false;
        self.head = None;
    }

    /// Takes a message; what is neither TUIO 1.1 nor 2.0 is let pass.
    pub(super) fn message(&mut self, message: Message<'_>, counts: &mut TuioCounts) {
        let understood = if let Some(profile) = message.address.strip_prefix(b"/tuio/") {
            v1::message(self, profile, message.arguments(), counts)
        } else if let Some(kind) = message.address.strip_prefix(b"/tuio2/") {
            v2::message(self, kind, message.arguments(), counts)
        } else {
            Some(())
        };
        if understood.is_none() {
            counts.faulty_messages += 1;
        }
    }

    pub(super) fn name(&mut self, name: &[u8]) {
        self.name.clear();
        self.name.extend_from_slice(&name[..name.len().min(NAME_BYTES)]);
    }

    /// Takes what a message says about a contact, if that is a place.
    pub(super) fn reading(&mut self, profile: usize, reading: Reading, counts: &mut TuioCounts) {
        let beyond = (reading.at - 0.5).abs().max_element() - 0.5;
        if !reading.at.is_finite() || beyond > FARTHEST {
            counts.no_place += 1;
        } else if self.readings.len() == MAX_READINGS {
            counts.over_cap += 1;
        } else {
            self.readings.push((profile, reading));
        }
    }
}

/// A session id: 32 bits, which some senders call a signed number and some know only as a float.
pub(super) fn session_id(argument: Argument<'_>) -> Option<u32> {
    match argument {
        Argument::Int(id) => u32::try_from(id)
            .ok()
            .or_else(|| Some(i32::try_from(id).ok()? as u32)),
        Argument::Float(id) if (0.0..=f64::from(u32::MAX)).contains(&id) && id.fract() == 0.0 => {
            Some(id as u32)
        }
        _ => None,
    }
}

/// A number; some senders call 0 and 1 whole ones.
pub(super) fn number(argument: Argument<'_>) -> Option<f64> {
    match argument {
        Argument::Int(number) => Some(number as f64),
        Argument::Float(number) => Some(number),
        _ => None,
    }
}
