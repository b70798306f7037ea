//! TUIO 1.1 and 2.0: packets of a tracker become the contacts it sees.
//!
//! Both versions tell the state and not the changes: each frame lists who is alive, so a lost packet is healed by
//! the next list, and a contact ends only by its absence from one. [`TuioDecoder`] takes the bytes of datagrams and,
//! at the end of each frame, shows the whole state of its sender.
//!
//! # Which frames are believed
//!
//! Senders are told apart by address, port and the name they give themselves, and each profile counts its frames for
//! itself. A number just below the last one is a packet that was overtaken and is dropped; a far lower one, or one
//! that comes a second later, is a sender that was started anew: its contacts are lost and begin again. Equal numbers
//! are parts of one frame, and numbers of 0 or less (TUIO 2.0: 0) are always believed.
//!
//! # Why no finger is forgotten
//!
//! 1. A finger that is absent from the next list has lifted, whatever was lost before.
//! 2. A sender that starts anew, or comes back from another port under its name, loses what it had.
//! 3. A sender that was heard to repeat itself while nothing changed, and then is silent for eight of its longest
//!    pauses and at least a second, loses what it had. One that speaks only of changes keeps a finger that rests.
//! 4. A sender that is silent for a minute is forgotten with all it had.
//!
//! # Caps
//!
//! [`MAX_SOURCES`] senders of [`MAX_CONTACTS`] contacts each; packets of
//! [`MAX_PACKET_BYTES`]; four bundles deep; 4,000 packets a second of each sender, and 500 of all strangers together,
//! so that noise takes nothing from a table; four restarts a second. Nothing is queued, and nothing is allocated after a sender was met.

mod bundle;
mod contacts;
mod osc;
mod pace;
mod source;
mod v1;
mod v2;

use core::net::SocketAddr;

use glam::DVec2;

use crate::gesture::contact::MAX_CONTACTS;
use crate::input::touching::Touching;
use bundle::Bundle;
use osc::Element;
use pace::Bucket;
use source::{Source, Standing, Taken};

/// Most senders at once.
pub const MAX_SOURCES: usize = 16;

/// Most bytes of a packet: what a datagram can hold.
pub const MAX_PACKET_BYTES: usize = 65_536;

/// Packets of all who are no senders yet that are read in a second.
const STRANGERS_PER_S: u32 = 500;

/// Times a second that a sender may begin anew; who seems to more often is not read for a while.
const RESTARTS_PER_S: i64 = 4;

/// Version of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TuioVersion {
    /// TUIO 1.1 (and 1.0): `/tuio/2Dcur`, `/tuio/2Dobj`, `/tuio/2Dblb`.
    V1,
    /// TUIO 2.0: `/tuio2/...`.
    V2,
}

/// What the tracker does not say itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TuioOptions {
    /// Size of the touching surface, mm. Without it no contact has a size: TUIO tells sizes in parts of the surface.
    pub surface_mm: Option<DVec2>,
}

/// What a sender says: it is found, then tells states, then may be lost, and may be found again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TuioEvent<'a> {
    /// A sender is heard, for the first time or again; nothing of it is down. Its first state follows.
    Found {
        /// Which sender, below [`MAX_SOURCES`]; a number is given again once its sender was lost.
        source: u16,
        /// Its name for itself; empty where it gives none.
        name: &'a str,
        /// From where its packets come.
        peer: SocketAddr,
    },
    /// All that touches at the end of a frame.
    State {
        /// Which sender.
        source: u16,
        /// The contacts.
        touching: &'a [Touching],
    },
    /// The sender is gone or began anew: its contacts are no more.
    Lost {
        /// Which sender.
        source: u16,
    },
}

/// What was heard and what was let pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TuioCounts {
    /// Packets.
    pub packets: u64,
    /// Frames that were believed and complete.
    pub frames: u64,
    /// Packets that are torn, too long, nested too deep or not OSC.
    pub malformed: u64,
    /// Bundles without any message of TUIO, and messages outside a bundle.
    pub foreign: u64,
    /// Messages of TUIO that are too short or hold something else than they should.
    pub faulty_messages: u64,
    /// Contacts with coordinates that are no place.
    pub no_place: u64,
    /// Contacts that are placed without being alive.
    pub not_alive: u64,
    /// Bundles without the number of their frame.
    pub unnumbered: u64,
    /// Frames that came too late.
    pub late: u64,
    /// Senders that began anew.
    pub restarts: u64,
    /// Packets above the rate that is read.
    pub over_rate: u64,
    /// Contacts beyond [`MAX_CONTACTS`].
    pub over_cap: u64,
    /// Bundles of senders beyond [`MAX_SOURCES`].
    pub over_sources: u64,
    /// Bundles of TUIO 1.1 from who also speaks 2.0.
    pub other_version: u64,
    /// Times that contacts were withdrawn because their sender was silent.
    pub silenced: u64,
    /// Senders that were forgotten or replaced.
    pub forgotten: u64,
}

impl TuioCounts {
    /// Packets and bundles that were not read: no TUIO, too many, or of senders for whom there is no place.
    pub fn turned_away(&self) -> u64 {
        self.malformed + self.foreign + self.over_rate + self.over_sources
    }
}

/// A sender, for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TuioSource {
    /// Its number, as in [`TuioEvent`].
    pub source: u16,
    /// From where its packets come.
    pub peer: SocketAddr,
    /// Its name for itself; empty where it gives none.
    pub name: String,
    /// What it speaks.
    pub version: TuioVersion,
    /// Columns and rows of its sensor, where it tells.
    pub sensor: Option<[u16; 2]>,
    /// Contacts that are alive.
    pub contacts: usize,
    /// Frames so far.
    pub frames: u64,
}

/// Turns packets into states. Time is in microseconds from any start and never runs backwards.
#[derive(Clone, Debug)]
pub struct TuioDecoder {
    options: TuioOptions,
    sources: Vec<Source>,
    /// The bundle at hand, kept so that a packet allocates nothing.
    bundle: Bundle,
    state: Vec<Touching>,
    strangers: Bucket,
    counts: TuioCounts,
}

impl TuioDecoder {
    /// Nobody was heard yet.
    pub fn new(options: TuioOptions) -> Self {
        Self {
            options,
            sources: Vec::with_capacity(MAX_SOURCES),
            bundle: Bundle::new(),
            state: Vec::with_capacity(3 * MAX_CONTACTS),
            strangers: Bucket::new(STRANGERS_PER_S, 0),
            counts: TuioCounts::default(),
        }
    }

    /// What was heard and let pass so far.
    pub fn counts(&self) -> TuioCounts {
        self.counts
    }

    /// The senders that are known now.
    pub fn sources(&self) -> impl Iterator<Item = TuioSource> {
        let used = self
            .sources
            .iter()
            .enumerate()
            .filter(|(_, source)| source.is_used());
        used.map(|(i, source)| TuioSource {
            source: i as u16,
            peer: source.peer,
            name: String::from_utf8_lossy(&source.name).into_owned(),
            version: source.version,
            sensor: Some(source.sensor).filter(|sensor| *sensor != [0; 2]),
            contacts: source.alive(),
            frames: source.frames,
        })
    }

    /// Takes the bytes of a datagram that came from `peer` at `t_us`, and shows `sink` what follows from it.
    pub fn packet(
        &mut self,
        t_us: u64,
        peer: SocketAddr,
        bytes: &[u8],
        sink: &mut impl FnMut(TuioEvent<'_>),
    ) {
        self.counts.packets += 1;
        self.tick(t_us, sink);
        let known = self
            .sources
            .iter_mut()
            .find(|source| source.is_used() && source.peer == peer);
        let bucket = known.map_or(&mut self.strangers, |source| &mut source.bucket);
        if !bucket.take(t_us, bytes.len()) {
            self.counts.over_rate += 1;
            return;
        }
        if bytes.len() > MAX_PACKET_BYTES {
            self.counts.malformed += 1;
            return;
        }
        self.bundle.clear();
        let mut outside = false;
        let outcome = osc::read(bytes, &mut |element| match element {
            Element::Message(message) => {
                outside = true;
                self.bundle.message(message, &mut self.counts);
            }
            Element::EndOfBundle => {
                outside = false;
                self.end_of_bundle(t_us, peer, sink);
                self.bundle.clear();
            }
        });
        self.counts.foreign += u64::from(outside);
        self.counts.malformed += u64::from(outcome.is_err());
    }

    /// Lets time pass without a packet: senders that are silent for too long lose their contacts. To be called some
    /// times a second.
    pub fn tick(&mut self, t_us: u64, sink: &mut impl FnMut(TuioEvent<'_>)) {
        for i in 0..self.sources.len() {
            let source = &self.sources[i];
            if !source.is_used() {
                continue;
            }
            if source.is_gone(t_us) || self.is_succeeded(source, t_us) {
                self.forget(i, sink);
            } else if source.is_silent(t_us) {
                self.counts.silenced += 1;
                self.lose(i, Standing::Silenced, sink);
            }
        }
    }

    /// Forgets all senders: nobody is listened to any more.
    pub fn forget_all(&mut self, sink: &mut impl FnMut(TuioEvent<'_>)) {
        for i in 0..self.sources.len() {
            if self.sources[i].is_used() {
                self.forget(i, sink);
            }
        }
    }

    /// Whether a namesake from the same machine was heard for a while since this one spoke last: it was started anew
    /// and got another port.
    fn is_succeeded(&self, old: &Source, t_us: u64) -> bool {
        !old.name.is_empty()
            && self.sources.iter().any(|new| {
                new.is_used()
                    && new.first_us > old.heard_us
                    && t_us.saturating_sub(new.first_us) >= source::LATE_US
                    && new.peer.ip() == old.peer.ip()
                    && new.name == old.name
            })
    }

    fn forget(&mut self, i: usize, sink: &mut impl FnMut(TuioEvent<'_>)) {
        self.counts.forgotten += 1;
        self.lose(i, Standing::Free, sink);
    }

    fn lose(&mut self, i: usize, standing: Standing, sink: &mut impl FnMut(TuioEvent<'_>)) {
        if std::mem::replace(&mut self.sources[i].standing, standing) == Standing::Found {
            sink(TuioEvent::Lost { source: i as u16 });
        }
    }

    fn end_of_bundle(&mut self, t_us: u64, peer: SocketAddr, sink: &mut impl FnMut(TuioEvent<'_>)) {
        let version = match (self.bundle.speaks_v1, self.bundle.speaks_v2) {
            (false, false) => {
                self.counts.foreign += 1;
                return;
            }
            (true, false) => TuioVersion::V1,
            (_, true) => TuioVersion::V2,
        };
        let Some(i) = self.source(t_us, peer, version, sink) else {
            return;
        };
        let taken = self.sources[i].take(t_us, &self.bundle, &mut self.counts);
        if matches!(taken, Taken::Restart(_)) {
            self.counts.restarts += 1;
            self.sources[i].bucket.charge(RESTARTS_PER_S);
            self.lose(i, Standing::Met, sink);
        }
        if matches!(taken, Taken::Frame | Taken::Restart(true)) {
            self.counts.frames += 1;
            self.tell(i, sink);
        }
    }

    fn tell(&mut self, i: usize, sink: &mut impl FnMut(TuioEvent<'_>)) {
        let sender = &mut self.sources[i];
        let source = i as u16;
        if std::mem::replace(&mut sender.standing, Standing::Found) != Standing::Found {
            sink(TuioEvent::Found {
                source,
                name: &String::from_utf8_lossy(&sender.name),
                peer: sender.peer,
            });
        }
        sender.state(self.options.surface_mm, &mut self.state);
        sink(TuioEvent::State {
            source,
            touching: &self.state,
        });
    }

    /// The sender of the bundle at hand, who may be a new one.
    fn source(
        &mut self,
        t_us: u64,
        peer: SocketAddr,
        version: TuioVersion,
        sink: &mut impl FnMut(TuioEvent<'_>),
    ) -> Option<usize> {
        let name = &self.bundle.name;
        let of_peer = |source: &Source, of: TuioVersion| {
            source.is_used() && source.peer == peer && source.version == of
        };
        if version == TuioVersion::V1 && self.sources.iter().any(|source| of_peer(source, TuioVersion::V2)) {
            self.counts.other_version += 1;
            return None;
        }
        // A sender may leave its name out of some bundles.
        let mut known = self
            .sources
            .iter_mut()
            .enumerate()
            .filter(|(_, source)| of_peer(source, version));
        let found = if name.is_empty() {
            known.max_by_key(|(_, source)| source.heard_us)
        } else {
            known.find(|(_, source)| source.name.is_empty() || source.name == *name)
        };
        if let Some((i, source)) = found {
            if source.name.is_empty() {
                source.name.extend_from_slice(name);
            }
            return Some(i);
        }
        let numbered = match version {
            TuioVersion::V1 => self.bundle.number.iter().any(Option::is_some),
            TuioVersion::V2 => self.bundle.head.is_some(),
        };
        if !numbered {
            self.counts.unnumbered += 1;
            return None;
        }
        self.meet(t_us, peer, version, sink)
    }

    /// A place for a new sender: a free one, or that of the one longest silent.
    fn meet(
        &mut self,
        t_us: u64,
        peer: SocketAddr,
        version: TuioVersion,
        sink: &mut impl FnMut(TuioEvent<'_>),
    ) -> Option<usize> {
        // Who speaks both versions tells of each finger twice; 2.0 tells more.
        for i in 0..self.sources.len() {
            if self.sources[i].is_used() && self.sources[i].peer == peer && self.sources[i].version != version
            {
                self.forget(i, sink);
            }
        }
        let free = self.sources.iter().position(|source| !source.is_used());
        let i = match free {
            Some(i) => i,
            None if self.sources.len() < MAX_SOURCES => {
                self.sources.push(Source::new(peer, t_us));
                self.sources.len() - 1
            }
            None => {
                let (i, longest) = self
                    .sources
                    .iter()
                    .enumerate()
                    .min_by_key(|(_, source)| source.heard_us)?;
                if t_us.saturating_sub(longest.heard_us) < source::LATE_US {
                    self.counts.over_sources += 1;
                    return None;
                }
                self.forget(i, sink);
                i
            }
        };
        self.sources[i].begin(peer, version, &self.bundle.name, t_us);
        Some(i)
    }
}
