//! Captures of TUIO: the packets as they came, for tables whose tracker is not at hand.
//!
//! There is no standard for them; this is one packet a line, its bytes in hexadecimal, with the time of its arrival in
//! milliseconds and, where several trackers speak, the address and port it came from:
//!
//! ```text
//! {"t":0,"from":"127.0.0.1:50123","hex":"2362756e646c6500…"}
//! {"t":16.667,"hex":"2362756e646c6500…"}
//! ```
//!
//! A JSON list of such objects is read too, and one without any times as sixty packets a second. The packets are read
//! by the decoder of the live table ([`crate::input::tuio`]).

use core::net::SocketAddr;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufReader, Read};

use glam::{DAffine2, DVec2};
use serde_json::{Map, Value};

use super::lines::{Lines, MAX_LINE_BYTES};
use super::time::Span;
use super::{ImportError, ImportFault, ImportOptions, Imported};
use crate::gesture::contact::{ContactEvent, InputFrame, Phase, Source};
use crate::gesture::json::Expected;
use crate::input::touching::Tracker;
use crate::input::tuio::{MAX_PACKET_BYTES, MAX_SOURCES, TuioCounts, TuioDecoder, TuioEvent, TuioOptions};

/// Most bytes of a capture that is one list.
const MAX_LIST_BYTES: u64 = 64 << 20;

/// Time between two packets of a capture without times, µs.
const PACKET_US: u64 = 16_667;

/// Time between two looks for senders that fell silent, µs, as on the live table.
const LOOK_US: u64 = 50_000;

/// Looks after a packet until every sender that stays silent is forgotten.
const LOOKS: u64 = 61_000_000 / LOOK_US;

/// Who sent a packet that does not say so.
const SOMEBODY: SocketAddr = SocketAddr::new(core::net::IpAddr::V4(core::net::Ipv4Addr::LOCALHOST), 0);

/// Reads a capture; `name` stands for it in errors and in the title. The size of the surface has to be given, and
/// a range is not needed. Each contact takes the lowest id that is free.
///
/// # Errors
/// Anything but packets with a time each or with none, by line, or no size.
pub fn import_tuio<R: Read>(
    mut source: R,
    name: &str,
    options: &ImportOptions,
) -> Result<Imported, ImportError> {
    let size_mm = options
        .size()
        .and_then(|size| size.ok_or(ImportFault::NoSize))
        .map_err(|fault| fault.at(name, 1))?;
    let mut capture = Capture::new(size_mm);
    let mut line = 1;
    read(&mut source, &mut capture, &mut line)
        .and_then(|()| capture.finish(name, options))
        .map_err(|fault| fault.at(name, line))
}

/// Reads all packets; `line` is the one at hand.
fn read(source: &mut impl Read, capture: &mut Capture, line: &mut usize) -> Result<(), ImportFault> {
    let mut head = Vec::new();
    let mut byte = [0];
    while head.len() < MAX_LINE_BYTES && source.read(&mut byte)? > 0 {
        head.push(byte[0]);
        if !byte[0].is_ascii_whitespace() {
            break;
        }
    }
    let is_list = head.last() == Some(&b'[');
    let whole = head.chain(source);
    if is_list {
        let list: Vec<Map<String, Value>> =
            serde_json::from_reader(BufReader::new(whole.take(MAX_LIST_BYTES))).map_err(|error| {
                *line = error.line();
                form()
            })?;
        return list.iter().try_for_each(|packet| capture.packet(packet));
    }
    let mut lines = Lines::new(whole);
    while let Some(text) = lines.next()? {
        let (packet, torn, empty) = (
            serde_json::from_str(&text.text),
            text.torn,
            text.text.trim().is_empty(),
        );
        *line = lines.count;
        match packet {
            Ok(packet) => capture.packet(&packet)?,
            Err(_) if empty => {}
            Err(_) if torn => capture.torn = Some(*line),
            Err(_) => return Err(form()),
        }
    }
    Ok(())
}

fn form() -> ImportFault {
    ImportFault::Form("{\"t\":ms,\"hex\":\"…\"} of a TUIO capture".to_owned())
}

/// Packets as contacts.
struct Capture {
    size_mm: DVec2,
    decoder: TuioDecoder,
    session: Session,
    span: Span,
    packets: usize,
    /// Whether the packets have times; told by the first.
    timed: bool,
    torn: Option<usize>,
}

impl Capture {
    fn new(size_mm: DVec2) -> Self {
        Self {
            size_mm,
            decoder: TuioDecoder::new(TuioOptions {
                surface_mm: Some(size_mm),
            }),
            session: Session::new(size_mm),
            span: Span::default(),
            packets: 0,
            timed: true,
            torn: None,
        }
    }

    fn packet(&mut self, packet: &Map<String, Value>) -> Result<(), ImportFault> {
        if self.packets == 0 {
            self.timed = packet.contains_key("t");
        }
        let t_us = self.time(packet.get("t"))?;
        let peer = match packet.get("from") {
            None => SOMEBODY,
            Some(from) => from
                .as_str()
                .and_then(|from| from.parse().ok())
                .ok_or_else(|| Expected::new("from", "an address with a port", from))?,
        };
        let what = || format!("at most {MAX_PACKET_BYTES} bytes in hexadecimal");
        let hex = packet
            .get("hex")
            .ok_or_else(|| Expected::missing("hex", what()))?;
        let bytes = hex
            .as_str()
            .and_then(bytes)
            .ok_or_else(|| Expected::new("hex", what(), hex))?;
        let before_us = self.span.end_us();
        self.span.advance(t_us)?;
        let session = &mut self.session;
        if self.packets > 0 {
            for look in 1..=LOOKS {
                let now_us = before_us + look * LOOK_US;
                if now_us >= t_us {
                    break;
                }
                self.decoder
                    .tick(now_us, &mut |event| session.take(now_us, event));
            }
        }
        self.decoder
            .packet(t_us, peer, &bytes, &mut |event| session.take(t_us, event));
        self.packets += 1;
        Ok(())
    }

    fn time(&self, t: Option<&Value>) -> Result<u64, ImportFault> {
        let what = "milliseconds, in each packet or in none";
        match t {
            None if !self.timed => Ok(self.packets as u64 * PACKET_US),
            None => Err(Expected::missing("t", what).into()),
            Some(t) => {
                let ms = t.as_f64().filter(|ms| self.timed && *ms >= 0.0);
                let ms = ms.ok_or_else(|| Expected::new("t", what, t))?;
                // Clocks of the wall are some 10¹² ms; microseconds of them still fit.
                Ok((ms.min(1e15) * 1000.0).round() as u64)
            }
        }
    }

    fn finish(mut self, name: &str, options: &ImportOptions) -> Result<Imported, ImportFault> {
        let end_us = self.span.end_us();
        let counts = self.decoder.counts();
        let down = self.session.down();
        let session = &mut self.session;
        self.decoder.forget_all(&mut |event| session.take(end_us, event));
        if self.session.frames.is_empty() {
            return Err(ImportFault::Form("a packet of TUIO with a contact".to_owned()));
        }
        let torn = self.torn.map(|line| format!("line {line}: torn, left out"));
        let mut warnings: Vec<String> = torn.into_iter().collect();
        if !self.timed {
            warnings.push("no packet has a time: taken as sixty a second".to_owned());
        }
        if options.range.is_some() {
            warnings.push("--range left out: TUIO tells places in parts of the surface".to_owned());
        }
        warnings.extend(counted(&counts, down));
        Ok(Imported {
            title: super::title(None, name),
            size_mm: self.size_mm,
            frames: self.session.frames,
            warnings,
        })
    }
}

/// What was let pass, in words.
fn counted(counts: &TuioCounts, down: usize) -> impl Iterator<Item = String> {
    let counted = [
        (counts.malformed, "packet(s) torn or no OSC"),
        (
            counts.foreign,
            "message(s) or bundle(s) that are not TUIO, left out",
        ),
        (
            counts.faulty_messages,
            "message(s) left out: too short, or of other types",
        ),
        (counts.unnumbered, "bundle(s) left out: no frame number"),
        (counts.late, "frame(s) left out: they came too late"),
        (counts.over_rate, "packet(s) left out: too many in a second"),
        (counts.over_sources, "bundle(s) left out: too many senders"),
        (
            counts.other_version,
            "bundle(s) left out: their sender speaks TUIO 2.0 too",
        ),
        (counts.no_place, "contact(s) left out: no place on a table"),
        (counts.over_cap, "contact(s) left out: more than can be down"),
        (
            counts.restarts,
            "time(s) a sender began anew: all its contacts cancelled",
        ),
        (
            counts.silenced,
            "time(s) a sender fell silent: all its contacts cancelled",
        ),
        (down as u64, "contact(s) still down at the end, cancelled"),
    ];
    let some = counted.into_iter().filter(|(count, _)| *count > 0);
    some.map(|(count, what)| format!("{count} {what}"))
}

/// The contacts of all senders as one table's.
struct Session {
    trackers: Vec<Tracker>,
    /// Which id of the table a sender's contact has.
    ids: BTreeMap<(u16, u64), u64>,
    /// How often a contact went down under each id.
    downs: Vec<u32>,
    frames: Vec<InputFrame>,
    start_us: Option<u64>,
    events: Vec<ContactEvent>,
}

impl Session {
    fn new(size_mm: DVec2) -> Self {
        let map = DAffine2::from_scale(size_mm);
        let tracker = |device| Tracker::new(Source::File, device, map);
        Self {
            trackers: (0..MAX_SOURCES as u16).map(tracker).collect(),
            ids: BTreeMap::new(),
            downs: Vec::new(),
            frames: Vec::new(),
            start_us: None,
            events: Vec::new(),
        }
    }

    fn down(&self) -> usize {
        self.ids.len()
    }

    fn take(&mut self, t_us: u64, event: TuioEvent<'_>) {
        match event {
            TuioEvent::Found { .. } => return,
            TuioEvent::State { source, touching } => {
                self.trackers[usize::from(source)].frame(touching, &mut self.events);
            }
            TuioEvent::Lost { source } => self.trackers[usize::from(source)].cancel_all(&mut self.events),
        }
        if self.events.is_empty() {
            return;
        }
        let mut events = std::mem::take(&mut self.events);
        for event in &mut events {
            self.rename(event);
        }
        events.sort_by_key(|event| (event.phase.order(), event.contact.key));
        let start_us = *self.start_us.get_or_insert(t_us);
        self.frames.push(InputFrame {
            t_us: t_us - start_us,
            events,
            commands: Vec::new(),
        });
    }

    /// Gives the contact its id of the table. (What ends comes before what lands, so an id that is set free can be
    /// taken at the same moment.)
    fn rename(&mut self, event: &mut ContactEvent) {
        let key = &mut event.contact.key;
        let own = (key.device, key.id);
        let id = match (self.ids.get(&own), event.phase) {
            (Some(&id), Phase::Up | Phase::Cancel) => {
                self.ids.remove(&own);
                id
            }
            (Some(&id), _) => id,
            (None, _) => {
                let taken: BTreeSet<u64> = self.ids.values().copied().collect();
                let free = (0..).zip(&taken).find(|(free, taken)| free != *taken);
                let id = free.map_or(taken.len() as u64, |(free, _)| free);
                self.ids.insert(own, id);
                if id == self.downs.len() as u64 {
                    self.downs.push(0);
                }
                self.downs[id as usize] += 1;
                id
            }
        };
        key.device = 0;
        key.id = id;
        key.generation = self.downs[id as usize] - 1;
    }
}

/// Bytes in hexadecimal.
fn bytes(text: &str) -> Option<Vec<u8>> {
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let (pairs, rest) = text.as_bytes().as_chunks::<2>();
    if !rest.is_empty() || pairs.len() > MAX_PACKET_BYTES {
        return None;
    }
    let byte = |pair: &[u8; 2]| Some((digit(pair[0])? << 4 | digit(pair[1])?) as u8);
    pairs.iter().map(byte).collect()
}
