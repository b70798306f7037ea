//! One sender: what of its bundles is believed, and what is down by that.

use core::net::SocketAddr;

use glam::DVec2;

use super::bundle::{Bundle, PROFILES};
use super::contacts::{Contacts, Reading};
use super::pace::{Bucket, FORGET_US, Habit};
use super::{TuioCounts, TuioVersion, v1, v2};
use crate::gesture::contact::MAX_CONTACTS;
use crate::input::touching::Touching;

/// A frame number this much below the last one, or less, is a packet that was overtaken.
const LATE_FRAMES: i64 = 100;

/// Longest time that a packet is overtaken by, µs. A lower number after that is a sender that counts anew.
pub(super) const LATE_US: u64 = 1_000_000;

/// Packets of one sender that are read in a second: four tables of 240 Hz in four bundles for each frame.
const PACKETS_PER_S: u32 = 4_000;

/// What became of a bundle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Taken {
    /// There is nothing new to tell: too late, or the frame has not ended.
    Nothing,
    /// A frame is complete.
    Frame,
    /// The sender began anew: what was down is lost. Whether a frame is complete.
    Restart(bool),
}

/// What is known of a sender by those who listen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// There is none: the place is free.
    Free,
    /// It is heard, and nobody was told.
    Met,
    /// It was told of, and its states are.
    Found,
    /// Its contacts were withdrawn because it was silent.
    Silenced,
}

/// A sender and what it says.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub(super) standing: Standing,
    pub(super) peer: SocketAddr,
    pub(super) name: Vec<u8>,
    pub(super) version: TuioVersion,
    /// Columns and rows of the sensor; 0 where unknown.
    pub(super) sensor: [u16; 2],
    /// Frames so far.
    pub(super) frames: u64,
    pub(super) first_us: u64,
    /// When the last believed bundle came.
    pub(super) heard_us: u64,
    pub(super) bucket: Bucket,
    contacts: [Contacts; PROFILES],
    /// Number of the last frame and when it came, by profile; 0 before the first.
    number: [i64; PROFILES],
    numbered_us: [u64; PROFILES],
    /// TUIO 2.0: the frame of this number has ended; what still comes of it is told at once.
    ended: bool,
    habit: Habit,
}

impl Source {
    pub(super) fn new(peer: SocketAddr, t_us: u64) -> Self {
        Self {
            standing: Standing::Free,
            peer,
            name: Vec::with_capacity(super::bundle::NAME_BYTES),
            version: TuioVersion::V1,
            sensor: [0; 2],
            frames: 0,
            first_us: t_us,
            heard_us: t_us,
            bucket: Bucket::new(PACKETS_PER_S, t_us),
            contacts: [Contacts::new(), Contacts::new(), Contacts::new()],
            number: [0; PROFILES],
            numbered_us: [t_us; PROFILES],
            ended: false,
            habit: Habit::new(),
        }
    }

    /// Makes a place that may have been another sender's the place of this one.
    pub(super) fn begin(&mut self, peer: SocketAddr, version: TuioVersion, name: &[u8], t_us: u64) {
        self.standing = Standing::Met;
        self.peer = peer;
        self.name.clear();
        self.name.extend_from_slice(name);
        self.version = version;
        self.sensor = [0; 2];
        self.frames = 0;
        self.first_us = t_us;
        self.heard_us = t_us;
        self.bucket = Bucket::new(PACKETS_PER_S, t_us);
        self.habit = Habit::new();
        self.forget_frames();
    }

    /// Whether the place is taken.
    pub(super) fn is_used(&self) -> bool {
        self.standing != Standing::Free
    }

    fn forget_frames(&mut self) {
        for contacts in &mut self.contacts {
            contacts.clear();
        }
        self.number = [0; PROFILES];
        self.ended = false;
    }

    /// Contacts that are alive, whether placed or not.
    pub(super) fn alive(&self) -> usize {
        self.contacts.iter().map(Contacts::alive).sum()
    }

    /// Whether it was silent for longer than it may with fingers down.
    pub(super) fn is_silent(&self, t_us: u64) -> bool {
        self.standing == Standing::Found
            && self.alive() > 0
            && t_us.saturating_sub(self.heard_us) > self.habit.silence_us()
    }

    /// Whether it was not heard for so long that it is no sender any more.
    pub(super) fn is_gone(&self, t_us: u64) -> bool {
        t_us.saturating_sub(self.heard_us) > FORGET_US
    }

    /// Takes a bundle.
    pub(super) fn take(&mut self, t_us: u64, bundle: &Bundle, counts: &mut TuioCounts) -> Taken {
        let was_down = self.alive() > 0;
        let (taken, news) = match self.version {
            TuioVersion::V1 => self.take_v1(t_us, bundle, counts),
            TuioVersion::V2 => self.take_v2(t_us, bundle, counts),
        };
        let Some(taken) = taken else {
            return Taken::Nothing;
        };
        if was_down {
            self.habit.frame(t_us.saturating_sub(self.heard_us), news);
        }
        self.heard_us = self.heard_us.max(t_us);
        if self.standing == Standing::Silenced {
            self.standing = Standing::Met;
        }
        if taken != Taken::Nothing {
            self.frames += 1;
        }
        taken
    }

    /// Where a frame of this number stands; unless it is late, it is the last one from now on. With 0 or less the
    /// sender does not count, or tells all it knows out of turn.
    fn in_turn(&mut self, profile: usize, number: i64, late_within: i64, t_us: u64) -> Turn {
        let last = self.number[profile];
        let mut turn = Turn::Next;
        if number <= 0 {
            return turn;
        }
        if number < last {
            let recent = t_us.saturating_sub(self.numbered_us[profile]) < LATE_US;
            if recent && last - number <= late_within {
                return Turn::Late;
            }
            turn = Turn::Restart;
        } else if number == last {
            turn = Turn::Same;
        }
        self.number[profile] = number;
        self.numbered_us[profile] = t_us;
        turn
    }

    /// Profiles that a bundle speaks of are in turn or late each by itself: some senders count them apart.
    fn take_v1(&mut self, t_us: u64, bundle: &Bundle, counts: &mut TuioCounts) -> (Option<Taken>, bool) {
        // One number often stands for all profiles of a bundle.
        let any_number = bundle.number.iter().flatten().next();
        let mut taken = None;
        let mut believed = [false; PROFILES];
        for (profile, believed) in believed.iter_mut().enumerate() {
            let own = bundle.number[profile].as_ref();
            let speaks = bundle.alive[profile].listed || bundle.readings.iter().any(|(of, _)| *of == profile);
            let Some(&number) = own.or(any_number.filter(|_| speaks)) else {
                continue;
            };
            let turn = self.in_turn(profile, number.into(), LATE_FRAMES, t_us);
            if turn == Turn::Late {
                counts.late += 1;
                continue;
            }
            *believed = true;
            if turn == Turn::Restart {
                self.forget_frames();
                self.number[profile] = number.into();
                taken = Some(Taken::Restart(true));
            } else {
                taken = taken.or(Some(Taken::Frame));
            }
        }
        counts.unnumbered += u64::from(any_number.is_none());
        let mut news = false;
        for profile in (0..PROFILES).filter(|profile| believed[*profile]) {
            let alive = &bundle.alive[profile];
            if alive.listed {
                self.doubt_silence(profile, &alive.ids);
                news |= self.contacts[profile].keep(&alive.ids);
            }
        }
        for (profile, reading) in bundle.readings.iter().filter(|(of, _)| believed[*of]) {
            match self.contacts[*profile].place(reading) {
                Some(changed) => news |= changed,
                None => counts.not_alive += 1,
            }
        }
        (taken, news)
    }

    fn take_v2(&mut self, t_us: u64, bundle: &Bundle, counts: &mut TuioCounts) -> (Option<Taken>, bool) {
        let mut taken = Taken::Nothing;
        if let Some(head) = bundle.head {
            self.sensor = head.sensor;
            match self.in_turn(v2::ALL, head.id.into(), i64::MAX, t_us) {
                Turn::Late => {
                    counts.late += 1;
                    return (None, false);
                }
                Turn::Restart => {
                    self.forget_frames();
                    self.number[v2::ALL] = head.id.into();
                    taken = Taken::Restart(false);
                }
                Turn::Next => self.ended = false,
                Turn::Same => {}
            }
        }
        let mut news = false;
        let contacts = &mut self.contacts[v2::ALL];
        // A frame whose end was lost placed contacts that no list has named yet: the next list does.
        for (_, reading) in &bundle.readings {
            match contacts.place_ahead(reading) {
                Some(changed) => news |= changed,
                None => counts.over_cap += 1,
            }
        }
        let alive = &bundle.alive[v2::ALL];
        if alive.listed {
            self.ended = true;
            self.doubt_silence(v2::ALL, &alive.ids);
            news |= self.contacts[v2::ALL].keep(&alive.ids);
        }
        if self.ended {
            taken = match taken {
                Taken::Restart(_) => Taken::Restart(true),
                Taken::Nothing | Taken::Frame => Taken::Frame,
            };
        }
        (Some(taken), news)
    }

    /// A sender that comes back from its silence with the fingers it had was not gone.
    fn doubt_silence(&mut self, profile: usize, alive: &[u32]) {
        if self.standing == Standing::Silenced && self.contacts[profile].any_alive(alive) {
            self.habit.mistaken();
        }
    }

    /// Replaces `out` by all that touches.
    pub(super) fn state(&self, surface_mm: Option<DVec2>, out: &mut Vec<Touching>) {
        out.clear();
        let size_mm = |reading: &Reading| reading.extent?.on(surface_mm?);
        let touching = |profile: usize, reading: &Reading| Touching {
            id: (profile as u64) << 32 | u64::from(reading.id),
            at: reading.at,
            size_mm: size_mm(reading),
            confidence: None,
        };
        for profile in [v1::CURSORS, v1::OBJECTS] {
            let contacts = self.contacts[profile].touching();
            out.extend(contacts.map(|reading| touching(profile, reading)));
            if profile == v1::CURSORS {
                self.blobs(out, &touching);
            }
        }
        out.truncate(MAX_CONTACTS);
    }

    /// Adds the blobs to the cursors. A blob around a cursor is the same finger and tells how large it is; a blob
    /// around several is their hand.
    fn blobs(&self, out: &mut Vec<Touching>, touching: &impl Fn(usize, &Reading) -> Touching) {
        let cursors = out.len();
        for blob in self.contacts[v1::BLOBS].touching() {
            let size = blob.extent.and_then(|extent| extent.on(DVec2::ONE));
            let reach = size.unwrap_or(DVec2::ZERO) / 2.0;
            let within = |cursor: &Touching| (cursor.at - blob.at).abs().cmple(reach).all();
            let mut around = (0..cursors).filter(|&i| within(&out[i]));
            match (around.next(), around.next()) {
                (None, _) => out.push(touching(v1::BLOBS, blob)),
                (Some(only), None) => out[only].size_mm = touching(v1::BLOBS, blob).size_mm,
                _ => {}
            }
        }
    }
}

/// Where the number of a frame stands among those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    Next,
    Same,
    Late,
    Restart,
}
