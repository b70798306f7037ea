//! Reports → frames: at the end of each frame of the device, all contacts that are down.
//!
//! A frame is one report (*parallel*), or several (*hybrid*: the first tells how many contacts there are, the
//! following tell 0 and the same scan time), or there are no frames and each report tells of one contact (*serial*).

use glam::DVec2;

use super::descriptor::{Descriptor, Refusal, TouchReport};
use super::feature::MOST_CONTACTS;
use super::habit::Habit;
use super::lane::{Lane, Seen};
use super::quirks::{Quirk, Quirks};
use super::scan_time::ScanClock;
use crate::gesture::contact::MAX_CONTACTS;
use crate::input::touching::Touching;

/// Frames in a row that stay incomplete before the contact count is not believed to say when a frame ends.
const MOST_TORN: u32 = 3;

/// A contact that is named again within this time, µs, and this near, parts of the surface, after it was given up
/// for silence was down all the time.
const WRONGED_US: u64 = 2_000_000;
const WRONGED_NEAR: f64 = 0.02;
const MOST_GIVEN_UP: usize = 32;

/// What was let pass, and what was put right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DecoderCounts {
    /// Reports that carried contacts.
    pub reports: u64,
    /// Frames that came to their end.
    pub frames: u64,
    /// Reports of other kinds.
    pub other: u64,
    /// Reports that were too short.
    pub short: u64,
    /// Frames that another one cut off.
    pub torn: u64,
    /// Reports in the middle of a frame whose beginning was lost.
    pub orphans: u64,
    /// Contact counts that cannot be.
    pub miscounted: u64,
    /// Contacts named twice in a frame.
    pub doubled: u64,
    /// Contacts with coordinates that are no place, or ids that are none.
    pub no_contact: u64,
    /// Contacts beyond [`MAX_CONTACTS`].
    pub over_cap: u64,
    /// Contacts that a frame did not name, where that means that they have lifted.
    pub not_seen: u64,
    /// Contacts that were given up for silence.
    pub silent: u64,
    /// Contacts that were given up and came back.
    pub wronged: u64,
}

/// Who touches the device at the end of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<'a> {
    /// When, µs of the clock that arrival times are given in.
    pub t_us: u64,
    /// All contacts that are down, in the order in which they landed.
    pub touching: &'a [Touching],
}

#[derive(Clone, Copy, Debug)]
struct Down {
    touching: Touching,
    /// Number of the frame that named it last, and when.
    frame: u64,
    seen_us: u64,
    /// It has lifted as a palm: shown as such once, then gone.
    leaves: bool,
}

/// The decoder of one device. After it is made it allocates nothing.
#[derive(Clone, Debug)]
pub struct Decoder {
    report: TouchReport,
    lanes: Vec<Lane>,
    quirks: Quirks,
    most: u32,
    clock: Option<ScanClock>,
    habit: Habit,
    down: Vec<Down>,
    given_up: Vec<Down>,
    state: Vec<Touching>,
    frame: u64,
    t_us: u64,
    scan: Option<i64>,
    expected: u32,
    received: u32,
    torn_in_a_row: u32,
    /// A contact count other than 0, and a confidence other than 0, have been seen: before that neither tells.
    counts_contacts: bool,
    tells_confidence: bool,
    counts: DecoderCounts,
}

impl Decoder {
    /// A decoder for a device that reports at most `max_contacts` at once, in the way of `quirks`. `size_mm` is its
    /// surface, where the operator has measured it.
    ///
    /// # Errors
    /// [`Refusal`] when the device is no touchscreen.
    pub fn new(
        descriptor: &Descriptor,
        quirks: Quirks,
        max_contacts: u32,
        size_mm: Option<DVec2>,
    ) -> Result<Self, Refusal> {
        let report = descriptor.touch.clone()?;
        let size_mm = size_mm.or_else(|| report.physical_mm());
        let lanes: Vec<Lane> = report
            .slots
            .iter()
            .map(|slot| Lane::new(slot, quirks, size_mm))
            .collect();
        let most = max_contacts.clamp(lanes.len() as u32, MOST_CONTACTS.max(lanes.len() as u32));
        let clock = report.scan_time.map(|(bits, max)| ScanClock::new(max, bits.len));
        Ok(Self {
            report,
            lanes,
            quirks,
            most,
            clock,
            habit: Habit::new(quirks.has(Quirk::StickyFingers)),
            down: Vec::with_capacity(MAX_CONTACTS),
            given_up: Vec::with_capacity(MOST_GIVEN_UP),
            state: Vec::with_capacity(MAX_CONTACTS),
            frame: 0,
            t_us: 0,
            scan: None,
            expected: 0,
            received: 0,
            torn_in_a_row: 0,
            counts_contacts: false,
            tells_confidence: false,
            counts: DecoderCounts::default(),
        })
    }

    /// What was let pass so far.
    pub fn counts(&self) -> DecoderCounts {
        self.counts
    }

    /// What the device has been found to make a habit of.
    pub fn habit(&self) -> &Habit {
        &self.habit
    }

    /// Takes what the device sent, with its report number if it numbers its reports. A frame is handed out when it is
    /// complete.
    pub fn decode(&mut self, bytes: &[u8], arrival_us: u64) -> Option<Frame<'_>> {
        if self.report.id.is_some() && bytes.first().copied() != self.report.id {
            self.counts.other += 1;
            return None;
        }
        if bytes.len() < self.report.bytes {
            self.counts.short += 1;
            return None;
        }
        self.counts.reports += 1;
        if !self.begin(bytes, arrival_us) {
            return None;
        }
        let accurate = self.quirks.has(Quirk::ContactCountAccurate);
        for i in 0..self.lanes.len() {
            if accurate && self.received >= self.expected {
                break;
            }
            let seen = self.lanes[i].read(bytes);
            self.name(seen);
            self.received += 1;
        }
        if self.received < self.expected {
            // A count that never comes true does not say when a frame ends.
            if self.torn_in_a_row < MOST_TORN {
                return None;
            }
            return Some(self.publish());
        }
        self.torn_in_a_row = 0;
        Some(self.end())
    }

    /// Time passes without a report. A frame is handed out when that changes who is down: contacts have been silent
    /// for longer than the device makes a habit of.
    pub fn tick(&mut self, now_us: u64) -> Option<Frame<'_>> {
        let before = self.down.len();
        self.let_leave();
        self.give_up(now_us);
        if self.down.len() == before {
            return None;
        }
        self.t_us = self.t_us.max(now_us);
        Some(self.publish())
    }

    /// Forgets the contacts: the device is gone, or starts afresh.
    pub fn clear(&mut self) {
        self.down.clear();
        self.given_up.clear();
        (self.expected, self.received) = (0, 0);
        self.torn_in_a_row = 0;
    }

    /// The part of the frame that the report is; false when it is none.
    fn begin(&mut self, bytes: &[u8], arrival_us: u64) -> bool {
        let scan = self.report.scan_time.map(|(bits, _)| bits.read(bytes));
        let count = self.report.count.map(|bits| bits.read(bytes) as u32);
        let slots = self.lanes.len() as u32;
        let is_open = self.received < self.expected;
        let touched = || self.lanes.iter().any(|lane| lane.touches(bytes));
        let expected = match count {
            None => slots,
            Some(0) if is_open && scan == self.scan => return true,
            Some(0) if !self.counts_contacts && touched() => slots,
            // Of a device that never needs a second report, a count of 0 is plain.
            Some(0) if self.most > slots && touched() => {
                self.counts.orphans += 1;
                return false;
            }
            Some(0) => 0,
            Some(n) if n > self.most => {
                self.counts.miscounted += 1;
                slots
            }
            Some(n) => {
                self.counts_contacts = true;
                n
            }
        };
        if is_open {
            self.counts.torn += 1;
            self.torn_in_a_row += 1;
        }
        let stamp = match (&mut self.clock, scan) {
            (Some(clock), Some(scan)) => clock.stamp(scan as u64, arrival_us),
            _ => arrival_us,
        };
        self.t_us = self.t_us.max(stamp);
        self.scan = scan;
        (self.expected, self.received) = (expected, 0);
        self.frame += 1;
        self.let_leave();
        true
    }

    /// A slot names a contact, or none.
    fn name(&mut self, seen: Seen) {
        let quirk = |quirk| self.quirks.has(quirk);
        let mut valid = true;
        if !quirk(Quirk::AlwaysValid) {
            valid = !(quirk(Quirk::ValidIsInRange) && !seen.in_range
                || quirk(Quirk::NotSeenMeansUp) && !seen.tip
                || quirk(Quirk::ValidIsConfidence) && seen.confidence == Some(false));
        }
        if !valid {
            return;
        }
        let Some(id) = self.id(seen.id) else {
            self.counts.no_contact += 1;
            return;
        };
        self.tells_confidence |= seen.confidence == Some(true);
        let tells = self.tells_confidence && !quirk(Quirk::ValidIsConfidence);
        let confidence = seen
            .confidence
            .filter(|_| tells)
            .map(|sure| if sure { 1.0 } else { 0.0 });
        let known = self.down.iter().position(|down| down.touching.id == id);
        if let Some(i) = known
            && self.down[i].frame == self.frame
        {
            self.counts.doubled += 1;
            // A slot that is empty never takes back what another one names.
            if !seen.tip || quirk(Quirk::IgnoreDuplicates) {
                return;
            }
        }
        match known {
            Some(i) if !seen.tip => self.lift(i, confidence),
            None if !seen.tip => {}
            _ => self.touch(known, id, seen, confidence),
        }
    }

    /// The contact's name by what the slot says.
    fn id(&self, told: u64) -> Option<u64> {
        let below_most = |id: &u64| *id < u64::from(self.most);
        if self.quirks.has(Quirk::SlotIsContactNumber) {
            Some(u64::from(self.received))
        } else if self.quirks.has(Quirk::SlotIsContactId) {
            Some(told).filter(below_most)
        } else if self.quirks.has(Quirk::SlotIsContactIdMinusOne) {
            told.checked_sub(1).filter(below_most)
        } else {
            Some(told)
        }
    }

    fn lift(&mut self, i: usize, confidence: Option<f32>) {
        let down = &mut self.down[i];
        if confidence == Some(0.0) && down.touching.confidence == Some(1.0) {
            // It was taken for a finger until now; that it was none must be known before it is gone.
            down.touching.confidence = confidence;
            down.leaves = true;
            down.frame = self.frame;
            down.seen_us = self.t_us;
        } else {
            self.down.remove(i);
        }
    }

    fn touch(&mut self, known: Option<usize>, id: u64, seen: Seen, confidence: Option<f32>) {
        let (frame, seen_us) = (self.frame, self.t_us);
        let Some(at) = seen.at else {
            // It is somewhere, and where it was is the best guess.
            self.counts.no_contact += 1;
            if let Some(i) = known {
                (self.down[i].frame, self.down[i].seen_us) = (frame, seen_us);
            }
            return;
        };
        let touching = Touching {
            id,
            at,
            size_mm: seen.size_mm,
            confidence,
        };
        let now = Down {
            touching,
            frame,
            seen_us,
            leaves: false,
        };
        if let Some(i) = known {
            let before = &mut self.down[i];
            if before.frame != frame {
                let gap_us = seen_us.saturating_sub(before.seen_us);
                self.habit.named(gap_us, before.touching == touching);
            }
            *before = now;
            return;
        }
        if self.down.len() >= MAX_CONTACTS {
            self.counts.over_cap += 1;
            return;
        }
        self.note_if_wronged(&now);
        self.down.push(now);
    }

    fn note_if_wronged(&mut self, back: &Down) {
        let is_same = |gone: &Down| {
            gone.touching.id == back.touching.id
                && gone.touching.at.distance(back.touching.at) <= WRONGED_NEAR
        };
        if let Some(i) = self.given_up.iter().position(is_same) {
            let gap_us = back.seen_us.saturating_sub(self.given_up.remove(i).seen_us);
            if gap_us <= WRONGED_US {
                self.counts.wronged += 1;
                self.habit.wronged(gap_us);
            }
        }
    }

    /// All contacts of the frame are named.
    fn end(&mut self) -> Frame<'_> {
        self.counts.frames += 1;
        let none = self.report.count.is_some() && self.expected == 0;
        if none || self.quirks.has(Quirk::NotSeenMeansUp) {
            let before = self.down.len();
            let frame = self.frame;
            self.down.retain(|down| down.frame == frame);
            self.counts.not_seen += (before - self.down.len()) as u64;
        }
        self.give_up(self.t_us);
        self.publish()
    }

    fn let_leave(&mut self) {
        self.down.retain(|down| !down.leaves);
    }

    /// Lifts those of which the device has been silent for too long.
    fn give_up(&mut self, now_us: u64) {
        let Some(silence_us) = self.habit.silence_us() else {
            return;
        };
        let Self { down, given_up, .. } = self;
        let before = down.len();
        down.retain(|contact| {
            let stays = now_us.saturating_sub(contact.seen_us) <= silence_us;
            if !stays {
                if given_up.len() == MOST_GIVEN_UP {
                    given_up.remove(0);
                }
                given_up.push(*contact);
            }
            stays
        });
        self.counts.silent += (before - self.down.len()) as u64;
    }

    fn publish(&mut self) -> Frame<'_> {
        self.state.clear();
        self.state.extend(self.down.iter().map(|down| down.touching));
        Frame {
            t_us: self.t_us,
            touching: &self.state,
        }
    }
}
