//! A TUIO sender of its own, which shares no code with the decoder: packets are written with `rosc`.

#![allow(dead_code, reason = "each test file uses a part of it")]

use std::net::SocketAddr;

use glam::{DAffine2, DVec2};
use orogen::gesture::contact::{ContactEvent, Source};
use orogen::input::touching::{Touching, Tracker};
use orogen::input::tuio::{MAX_SOURCES, TuioDecoder, TuioEvent, TuioOptions};
use rosc::{OscBundle, OscMessage, OscPacket, OscTime, OscType, encoder};

/// The profiles of TUIO 1.1.
pub(crate) const CURSOR: &str = "/tuio/2Dcur";
/// Objects.
pub(crate) const OBJECT: &str = "/tuio/2Dobj";
/// Blobs.
pub(crate) const BLOB: &str = "/tuio/2Dblb";

/// A message to `address`.
pub(crate) fn message(address: &str, args: Vec<OscType>) -> OscPacket {
    OscPacket::Message(OscMessage {
        addr: address.to_owned(),
        args,
    })
}

/// A bundle "at once", as bytes.
pub(crate) fn bundle(content: Vec<OscPacket>) -> Vec<u8> {
    encoder::encode(&nested(content)).expect("a packet")
}

/// A bundle to stand in another one.
pub(crate) fn nested(content: Vec<OscPacket>) -> OscPacket {
    let timetag = OscTime {
        seconds: 0,
        fractional: 1,
    };
    OscPacket::Bundle(OscBundle { timetag, content })
}

/// `source name`.
pub(crate) fn source(profile: &str, name: &str) -> OscPacket {
    message(profile, vec!["source".into(), name.into()])
}

/// `alive s_id...`.
pub(crate) fn alive(profile: &str, ids: &[i32]) -> OscPacket {
    let ids = ids.iter().map(|id| OscType::Int(*id));
    message(profile, std::iter::once("alive".into()).chain(ids).collect())
}

/// `fseq n`.
pub(crate) fn fseq(profile: &str, number: i32) -> OscPacket {
    message(profile, vec!["fseq".into(), number.into()])
}

/// `set s_id x y X Y m`.
pub(crate) fn cursor(id: i32, x: f32, y: f32) -> OscPacket {
    floats(CURSOR, vec!["set".into(), id.into()], &[x, y, 0.0, 0.0, 0.0])
}

/// `set s_id x y a w h f X Y A m r`.
pub(crate) fn blob(id: i32, x: f32, y: f32, w: f32, h: f32) -> OscPacket {
    let numbers = [x, y, 0.0, w, h, w * h, 0.0, 0.0, 0.0, 0.0, 0.0];
    floats(BLOB, vec!["set".into(), id.into()], &numbers)
}

/// `set s_id i_id x y a X Y A m r`.
pub(crate) fn object(id: i32, marker: i32, x: f32, y: f32) -> OscPacket {
    let head = vec!["set".into(), id.into(), marker.into()];
    floats(OBJECT, head, &[x, y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
}

/// A message of `head` and then floats.
pub(crate) fn floats(address: &str, mut head: Vec<OscType>, numbers: &[f32]) -> OscPacket {
    head.extend(numbers.iter().map(|number| OscType::Float(*number)));
    message(address, head)
}

/// A frame of cursors: source (unless empty), alive, set of all, fseq.
pub(crate) fn cursors(name: &str, number: i32, down: &[(i32, f32, f32)]) -> Vec<u8> {
    let ids: Vec<i32> = down.iter().map(|(id, ..)| *id).collect();
    let mut content = Vec::new();
    if !name.is_empty() {
        content.push(source(CURSOR, name));
    }
    content.push(alive(CURSOR, &ids));
    content.extend(down.iter().map(|&(id, x, y)| cursor(id, x, y)));
    content.push(fseq(CURSOR, number));
    bundle(content)
}

/// `/tuio2/frm f_id time dim source`.
pub(crate) fn frm(id: i32, name: &str) -> OscPacket {
    let time = OscTime {
        seconds: 1,
        fractional: 0,
    };
    let sensor = 0x0780_0438; // 1920 by 1080
    message(
        "/tuio2/frm",
        vec![id.into(), OscType::Time(time), OscType::Int(sensor), name.into()],
    )
}

/// `/tuio2/ptr s_id tu_id c_id x y angle shear radius press`.
pub(crate) fn ptr(id: i32, x: f32, y: f32, radius: f32, press: f32) -> OscPacket {
    let head = vec![id.into(), 0.into(), 0.into()];
    floats("/tuio2/ptr", head, &[x, y, 0.0, 0.0, radius, press])
}

/// `/tuio2/tok s_id tu_id c_id x y angle`.
pub(crate) fn tok(id: i32, x: f32, y: f32) -> OscPacket {
    floats("/tuio2/tok", vec![id.into(), 0.into(), 5.into()], &[x, y, 0.0])
}

/// `/tuio2/bnd s_id x y angle w h area`.
pub(crate) fn bnd(id: i32, x: f32, y: f32, w: f32, h: f32) -> OscPacket {
    floats("/tuio2/bnd", vec![id.into()], &[x, y, 0.0, w, h, w * h])
}

/// `/tuio2/alv s_id...`.
pub(crate) fn alv(ids: &[i32]) -> OscPacket {
    message("/tuio2/alv", ids.iter().map(|id| OscType::Int(*id)).collect())
}

/// A frame of pointers.
pub(crate) fn pointers(name: &str, id: i32, down: &[(i32, f32, f32)]) -> Vec<u8> {
    let ids: Vec<i32> = down.iter().map(|(id, ..)| *id).collect();
    let mut content = vec![frm(id, name)];
    content.extend(down.iter().map(|&(id, x, y)| ptr(id, x, y, 0.0, 0.5)));
    content.push(alv(&ids));
    bundle(content)
}

/// A port of this machine.
pub(crate) fn peer(port: u16) -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], port))
}

/// A surface of 1000 mm by 500 mm with a decoder, and what is down by it.
pub(crate) struct Table {
    /// Under test.
    pub(crate) decoder: TuioDecoder,
    /// The contacts of each sender.
    pub(crate) trackers: Vec<Tracker>,
    /// All events.
    pub(crate) events: Vec<ContactEvent>,
    /// States so far.
    pub(crate) states: usize,
    /// Senders found so far.
    pub(crate) found: usize,
    /// Senders lost so far.
    pub(crate) lost: usize,
    /// The last state.
    pub(crate) last: Vec<Touching>,
}

impl Default for Table {
    fn default() -> Self {
        let size = DVec2::new(1000.0, 500.0);
        let options = TuioOptions {
            surface_mm: Some(size),
        };
        let tracker = |device| Tracker::new(Source::Tuio, device, DAffine2::from_scale(size));
        Self {
            decoder: TuioDecoder::new(options),
            trackers: (0..MAX_SOURCES as u16).map(tracker).collect(),
            events: Vec::new(),
            states: 0,
            found: 0,
            lost: 0,
            last: Vec::new(),
        }
    }
}

impl Table {
    /// A packet from the first port.
    pub(crate) fn hear(&mut self, t_us: u64, bytes: &[u8]) {
        self.hear_from(t_us, 5000, bytes);
    }

    /// A packet from a port of this machine.
    pub(crate) fn hear_from(&mut self, t_us: u64, port: u16, bytes: &[u8]) {
        self.with(|decoder, sink| decoder.packet(t_us, peer(port), bytes, &mut |event| sink(event)));
    }

    /// Time passes.
    pub(crate) fn tick(&mut self, t_us: u64) {
        self.with(|decoder, sink| decoder.tick(t_us, &mut |event| sink(event)));
    }

    fn with(&mut self, act: impl FnOnce(&mut TuioDecoder, &mut dyn FnMut(TuioEvent<'_>))) {
        let Self {
            decoder,
            trackers,
            events,
            states,
            found,
            lost,
            last,
        } = self;
        act(decoder, &mut |event| match event {
            TuioEvent::Found { source, .. } => {
                let down = trackers[usize::from(source)].contacts().count();
                assert_eq!(down, 0, "nothing is down of who was just found");
                *found += 1;
            }
            TuioEvent::State { source, touching } => {
                trackers[usize::from(source)].frame(touching, events);
                *states += 1;
                last.clear();
                last.extend_from_slice(touching);
            }
            TuioEvent::Lost { source } => {
                trackers[usize::from(source)].cancel_all(events);
                *lost += 1;
            }
        });
    }

    /// Ids that are down, over all senders.
    pub(crate) fn down(&self) -> Vec<u64> {
        let contacts = self.trackers.iter().flat_map(Tracker::contacts);
        contacts.map(|contact| contact.key.id).collect()
    }

    /// Where the contact of this id is, mm.
    pub(crate) fn place(&self, id: u64) -> Option<DVec2> {
        let mut contacts = self.trackers.iter().flat_map(Tracker::contacts);
        contacts
            .find(|contact| contact.key.id == id)
            .map(|contact| contact.position)
    }
}
