//! What a touch device says: who touches now. And the step from there to contacts that land, move and lift.
//!
//! Raw HID and TUIO agree in one thing: at the end of each of their frames it is known which contacts are down. So
//! every decoder yields the whole state, and [`Tracker`] alone turns states into events. What is not in a state has
//! lifted; a frame that was lost is healed by the next one.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use glam::{DAffine2, DVec2};

use crate::gesture::contact::{
    Contact, ContactEvent, ContactKey, MAX_CONTACTS, MAX_COORDINATE_MM, Phase, Source, quantise_mm,
};

/// One contact that a device reports as down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touching {
    /// The device's own name for it; another contact may bear it after this one has lifted.
    pub id: u64,
    /// Where it is, in parts of the device's surface (x right, y down, 0 to 1; a little beyond is no fault).
    pub at: DVec2,
    /// Width and height of the touching area in millimetres, where the device tells.
    pub size_mm: Option<DVec2>,
    /// The device's confidence that this is a finger, 0 (palm, unsure) to 1, where it tells.
    pub confidence: Option<f32>,
}

/// What was let pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackerCounts {
    /// Contacts with coordinates that are no place.
    pub no_place: u64,
    /// Contacts beyond [`MAX_CONTACTS`].
    pub over_cap: u64,
    /// Contacts that a frame names twice.
    pub doubled: u64,
    /// Contacts that were withdrawn with their device.
    pub withdrawn: u64,
}

impl AddAssign for TrackerCounts {
    fn add_assign(&mut self, other: Self) {
        self.no_place += other.no_place;
        self.over_cap += other.over_cap;
        self.doubled += other.doubled;
        self.withdrawn += other.withdrawn;
    }
}

/// The contacts of one device: states in, events out. The events are well formed whatever the states are: each
/// contact lands, moves and then lifts or is cancelled, once, and no key names two contacts.
#[derive(Clone, Debug)]
pub struct Tracker {
    source: Source,
    device: u16,
    map: DAffine2,
    down: BTreeMap<u64, Contact>,
    /// Downs so far: the next generation.
    downs: u32,
    /// Ids of the frame at hand, kept so that a frame allocates nothing.
    named: Vec<u64>,
    counts: TrackerCounts,
}

impl Tracker {
    /// Nothing is down. `map` takes parts of the device's surface to table millimetres.
    pub fn new(source: Source, device: u16, map: DAffine2) -> Self {
        Self {
            source,
            device,
            map,
            down: BTreeMap::new(),
            downs: 0,
            named: Vec::with_capacity(MAX_CONTACTS),
            counts: TrackerCounts::default(),
        }
    }

    /// What was let pass so far.
    pub fn counts(&self) -> TrackerCounts {
        self.counts
    }

    /// Contacts that are down, by id.
    pub fn contacts(&self) -> impl Iterator<Item = &Contact> {
        self.down.values()
    }

    /// Another place of the device on the table. If that moves anything, all contacts are withdrawn.
    pub fn set_map(&mut self, map: DAffine2, out: &mut Vec<ContactEvent>) {
        if self.map != map {
            self.cancel_all(out);
            self.map = map;
        }
    }

    /// Withdraws all contacts: the device is gone, or another one is listened to.
    pub fn cancel_all(&mut self, out: &mut Vec<ContactEvent>) {
        self.counts.withdrawn += self.down.len() as u64;
        while let Some((_, contact)) = self.down.pop_first() {
            out.push(ContactEvent {
                phase: Phase::Cancel,
                contact,
            });
        }
    }

    /// Takes the state of the device and appends what has changed to `out`: ends first, then moves and landings in
    /// the order of `state`. Of two contacts with one id the first counts.
    pub fn frame(&mut self, state: &[Touching], out: &mut Vec<ContactEvent>) {
        self.named.clear();
        self.named.extend(state.iter().map(|touching| touching.id));
        self.named.sort_unstable();
        let Self { named, down, .. } = self;
        down.retain(|id, contact| {
            let stays = named.binary_search(id).is_ok();
            if !stays {
                out.push(ContactEvent {
                    phase: Phase::Up,
                    contact: *contact,
                });
            }
            stays
        });
        for (i, touching) in state.iter().enumerate() {
            // (A frame names at most some hundred; two of one name are rare.)
            if self.named.windows(2).any(|pair| pair == [touching.id; 2])
                && state[..i].iter().any(|before| before.id == touching.id)
            {
                self.counts.doubled += 1;
            } else {
                self.touching(touching, out);
            }
        }
    }

    fn touching(&mut self, touching: &Touching, out: &mut Vec<ContactEvent>) {
        let at = self.map.transform_point2(touching.at);
        if !at.is_finite() || at.abs().max_element() > MAX_COORDINATE_MM {
            self.counts.no_place += 1;
            return;
        }
        let before = self.down.get(&touching.id).copied();
        if before.is_none() && self.down.len() >= MAX_CONTACTS {
            self.counts.over_cap += 1;
            return;
        }
        let generation = before.map_or(self.downs, |contact| contact.key.generation);
        let contact = Contact {
            key: ContactKey {
                source: self.source,
                device: self.device,
                id: touching.id,
                generation,
            },
            position: DVec2::new(quantise_mm(at.x), quantise_mm(at.y)),
            size_mm: touching.size_mm,
            confidence: touching.confidence,
        }
        .as_recorded();
        if before == Some(contact) {
            return;
        }
        let phase = if before.is_some() {
            Phase::Move
        } else {
            self.downs = self.downs.wrapping_add(1);
            Phase::Down
        };
        self.down.insert(touching.id, contact);
        out.push(ContactEvent { phase, contact });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touching(id: u64, x: f64) -> Touching {
        Touching {
            id,
            at: DVec2::new(x, 0.5),
            size_mm: None,
            confidence: None,
        }
    }

    fn phases(events: &[ContactEvent]) -> Vec<(Phase, u64, u32)> {
        let brief = |e: &ContactEvent| (e.phase, e.contact.key.id, e.contact.key.generation);
        events.iter().map(brief).collect()
    }

    #[test]
    fn states_become_downs_moves_and_ups_and_a_used_id_is_another_contact() {
        use Phase::{Cancel, Down, Move, Up};
        let scale = DAffine2::from_scale(DVec2::new(1000.0, 500.0));
        let mut tracker = Tracker::new(Source::Tuio, 3, scale);
        let mut out = Vec::new();
        tracker.frame(&[touching(7, 0.1), touching(9, 0.2), touching(7, 0.9)], &mut out);
        tracker.frame(&[touching(9, 0.2), touching(7, 0.15)], &mut out);
        tracker.frame(&[touching(9, 0.2)], &mut out);
        tracker.frame(&[touching(7, 0.4), touching(9, f64::NAN)], &mut out);
        tracker.cancel_all(&mut out);
        let expected = [
            (Down, 7, 0),
            (Down, 9, 1),
            (Move, 7, 0),
            (Up, 7, 0),
            (Down, 7, 2),
            (Cancel, 7, 2),
            (Cancel, 9, 1),
        ];
        assert_eq!(phases(&out), expected);
        assert_eq!(out[2].contact.position, DVec2::new(150.0, 250.0));
        let counts = TrackerCounts {
            no_place: 1,
            over_cap: 0,
            doubled: 1,
            withdrawn: 2,
        };
        assert_eq!(tracker.counts(), counts);
    }

    #[test]
    fn there_is_room_for_so_many_and_no_more() {
        let mut tracker = Tracker::new(Source::Hid, 0, DAffine2::IDENTITY);
        let mut out = Vec::new();
        let state: Vec<Touching> = (0..=MAX_CONTACTS as u64).map(|id| touching(id, 0.5)).collect();
        tracker.frame(&state, &mut out);
        assert_eq!(out.len(), MAX_CONTACTS);
        assert_eq!(tracker.counts().over_cap, 1);
    }
}
