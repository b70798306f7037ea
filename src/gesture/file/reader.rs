//! Reads gesture files and refuses what is none.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufRead, BufReader, Read};

use glam::DVec2;
use serde_json::{Map, Value};

use super::header::Header;
use crate::gesture::command;
use crate::gesture::contact::{
    Contact, ContactEvent, ContactKey, InputFrame, MAX_CONTACTS, MAX_COORDINATE_MM, Phase, Source,
};
use crate::gesture::json::{Expected, list, millimetres, number, object, whole};

/// Most bytes of a line: 256 contacts with all they can have take a tenth of it.
pub const MAX_LINE_BYTES: usize = 256 * 1024;

/// Most lines of a file: a day at 40 moments per second.
pub const MAX_LINES: usize = 3_500_000;

/// Most bytes of a file.
pub const MAX_BYTES: u64 = 512 * 1024 * 1024;

/// Latest time of a line, ms: a month.
pub const MAX_TIME_MS: f64 = 31.0 * 86_400_000.0;

/// A gesture file, read.
#[derive(Clone, Debug, PartialEq)]
pub struct GestureFile {
    /// Line 1.
    pub header: Header,
    /// The moments in the order of time, each with its events in canonical order (phase, then id).
    pub frames: Vec<InputFrame>,
    /// What was let pass, one sentence each: a torn last line, unknown `do` words, contacts left down.
    pub warnings: Vec<String>,
}

/// Why a gesture file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{name}:{line}: {fault}")]
pub struct GestureError {
    /// The file, as the caller named it.
    pub name: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong there.
    #[source]
    pub fault: Fault,
}

/// What is wrong with a line.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// A field does not hold what it should.
    #[error(transparent)]
    Expected(#[from] Expected),
    /// The file cannot be read on.
    #[error("expected to read on: {0}")]
    Io(#[from] io::Error),
    /// There is nothing in the file.
    #[error("expected a header line, found an empty file")]
    Empty,
    /// The line is longer than [`MAX_LINE_BYTES`].
    #[error("expected at most {MAX_LINE_BYTES} bytes in a line, found more")]
    LongLine,
    /// The file has more than [`MAX_LINES`].
    #[error("expected at most {MAX_LINES} lines, found more")]
    ManyLines,
    /// The file has more than [`MAX_BYTES`].
    #[error("expected at most {MAX_BYTES} bytes in a file, found more")]
    ManyBytes,
    /// Bytes that are no text.
    #[error("expected UTF-8 text, found another byte in column {column}")]
    NotUtf8 {
        /// Where, in bytes from 1.
        column: usize,
    },
    /// The line is no JSON.
    #[error("expected one JSON object, found {detail} (column {column})")]
    NotJson {
        /// What the JSON parser says.
        detail: String,
        /// Where, in bytes from 1.
        column: usize,
    },
    /// Time runs backwards.
    #[error("t: expected at least {before_ms} as in the line before, found {found_ms}")]
    Backwards {
        /// The time of the line before, ms.
        before_ms: f64,
        /// The time of this line, ms.
        found_ms: f64,
    },
    /// A contact lands that is down.
    #[error("down: expected an id that is not down, found {id}, down since line {since}")]
    DoubleDown {
        /// The contact.
        id: u64,
        /// The line in which it went down.
        since: usize,
    },
    /// A contact moves, lifts or is cancelled that is not down.
    #[error("{list}: expected an id that is down, found {id}")]
    NotDown {
        /// `up`, `cancel` or `move`.
        list: &'static str,
        /// The contact.
        id: u64,
    },
    /// A contact moves twice in a line.
    #[error("move: expected each id once, found {id} again")]
    TwiceMoved {
        /// The contact.
        id: u64,
    },
    /// Too many contacts at once.
    #[error("down: expected at most {MAX_CONTACTS} contacts at once, found more")]
    ManyContacts,
}

/// Reads a gesture file; `name` stands for it in errors. The format is described in [the module](super).
///
/// # Errors
/// Anything but a gesture file, by line and, where it lies in one, field.
pub fn read_gesture<R: Read>(source: R, name: &str) -> Result<GestureFile, GestureError> {
    let mut lines = Lines::new(source);
    read_lines(&mut lines).map_err(|fault| GestureError {
        name: name.to_owned(),
        line: lines.number.max(1),
        fault,
    })
}

fn read_lines<R: Read>(lines: &mut Lines<R>) -> Result<GestureFile, Fault> {
    if !lines.next()? {
        return Err(Fault::Empty);
    }
    let header = Header::from_map(&lines.object()?)?;
    let mut session = Session::default();
    let mut frames = Vec::new();
    let mut warnings = Vec::new();
    while lines.next()? {
        match lines.object() {
            Ok(map) => frames.push(session.frame(&map, lines.number)?),
            // A line that a power cut tore has no newline, and an object without its end is no JSON.
            Err(Fault::NotJson { .. } | Fault::NotUtf8 { .. }) if !lines.ended() => {
                warnings.push(format!("line {}: torn, left out", lines.number));
            }
            Err(fault) => return Err(fault),
        }
    }
    if session.unknown > 0 {
        let (count, first) = (session.unknown, &session.first_unknown);
        warnings.push(format!("{count} unknown do word(s) left out, first {first}"));
    }
    if !session.live.is_empty() {
        warnings.push(format!(
            "{} contact(s) still down at the end, cancelled",
            session.live.len()
        ));
        frames.push(session.end());
    }
    Ok(GestureFile {
        header,
        frames,
        warnings,
    })
}

/// The lines of a file, within the caps.
struct Lines<R: Read> {
    source: BufReader<R>,
    line: Vec<u8>,
    number: usize,
    bytes: u64,
}

impl<R: Read> Lines<R> {
    fn new(source: R) -> Self {
        Self {
            source: BufReader::new(source),
            line: Vec::new(),
            number: 0,
            bytes: 0,
        }
    }

    /// Goes to the next line; false at the end of the file.
    fn next(&mut self) -> Result<bool, Fault> {
        self.line.clear();
        self.number += 1;
        let mut within = (&mut self.source).take(MAX_LINE_BYTES as u64 + 1);
        let read = within.read_until(b'\n', &mut self.line)?;
        self.bytes += read as u64;
        if read > MAX_LINE_BYTES {
            return Err(Fault::LongLine);
        }
        if self.bytes > MAX_BYTES {
            return Err(Fault::ManyBytes);
        }
        if read > 0 && self.number > MAX_LINES {
            return Err(Fault::ManyLines);
        }
        Ok(read > 0)
    }

    /// True if the line has its newline.
    fn ended(&self) -> bool {
        self.line.last() == Some(&b'\n')
    }

    /// The object that the line holds.
    fn object(&self) -> Result<Map<String, Value>, Fault> {
        let text = std::str::from_utf8(&self.line).map_err(|error| Fault::NotUtf8 {
            column: error.valid_up_to() + 1,
        })?;
        let value: Value = serde_json::from_str(text.trim_end()).map_err(|error| {
            let column = error.column();
            let message = error.to_string();
            let detail = message.split(" at line ").next().unwrap_or_default().to_owned();
            Fault::NotJson { detail, column }
        })?;
        match value {
            Value::Object(map) => Ok(map),
            other => Err(Expected::new("line", "one JSON object", &other).into()),
        }
    }
}

/// What lines leave behind for the lines after them.
#[derive(Default)]
struct Session {
    t_us: u64,
    /// The contacts that are down, as they last were, with the line in which they went down.
    live: BTreeMap<u64, (Contact, usize)>,
    /// How often each id went down.
    generations: BTreeMap<u64, u32>,
    unknown: u64,
    first_unknown: String,
}

impl Session {
    fn frame(&mut self, map: &Map<String, Value>, line: usize) -> Result<InputFrame, Fault> {
        let time = map
            .get("t")
            .ok_or_else(|| Expected::missing("t", "milliseconds"))?;
        let t_us = time_us(time, "t")?;
        if t_us < self.t_us {
            return Err(Fault::Backwards {
                before_ms: self.t_us as f64 / 1000.0,
                found_ms: t_us as f64 / 1000.0,
            });
        }
        self.t_us = t_us;
        let mut events = Vec::new();
        self.lift(map, "up", Phase::Up, &mut events)?;
        self.lift(map, "cancel", Phase::Cancel, &mut events)?;
        self.shift(map, &mut events)?;
        self.land(map, line, &mut events)?;
        events.sort_by_key(|event: &ContactEvent| (event.phase.order(), event.contact.key));
        let mut commands = Vec::new();
        if let Some(value) = map.get("do") {
            let parsed = command::parse(value)?;
            commands = parsed.commands;
            if let Some(word) = parsed.unknown.first().filter(|_| self.unknown == 0) {
                self.first_unknown = format!("\"{}\" in line {line}", word.escape_debug());
            }
            self.unknown += parsed.unknown.len() as u64;
        }
        Ok(InputFrame {
            t_us,
            events,
            commands,
        })
    }

    /// The moment after the last line, in which all that is down is cancelled.
    fn end(&mut self) -> InputFrame {
        let events = std::mem::take(&mut self.live)
            .into_values()
            .map(|(contact, _)| ContactEvent {
                phase: Phase::Cancel,
                contact,
            });
        InputFrame {
            t_us: self.t_us,
            events: events.collect(),
            commands: Vec::new(),
        }
    }

    fn lift(
        &mut self,
        map: &Map<String, Value>,
        name: &'static str,
        phase: Phase,
        events: &mut Vec<ContactEvent>,
    ) -> Result<(), Fault> {
        let Some(value) = map.get(name) else { return Ok(()) };
        for (i, item) in list(value, name, "a list of ids")?.iter().enumerate() {
            let id = whole(item, &format!("{name}[{i}]"), "an id (whole number)")?;
            let (contact, _) = self.live.remove(&id).ok_or(Fault::NotDown { list: name, id })?;
            events.push(ContactEvent { phase, contact });
        }
        Ok(())
    }

    fn shift(&mut self, map: &Map<String, Value>, events: &mut Vec<ContactEvent>) -> Result<(), Fault> {
        let Some(value) = map.get("move") else {
            return Ok(());
        };
        let mut moved = BTreeSet::new();
        for (i, item) in list(value, "move", "a list of [id, x, y]")?.iter().enumerate() {
            let touch = Touch::from_value(item, &format!("move[{i}]"))?;
            let id = touch.id;
            let (contact, _) = self
                .live
                .get_mut(&id)
                .ok_or(Fault::NotDown { list: "move", id })?;
            if !moved.insert(id) {
                return Err(Fault::TwiceMoved { id });
            }
            *contact = touch.contact(contact.key);
            events.push(ContactEvent {
                phase: Phase::Move,
                contact: *contact,
            });
        }
        Ok(())
    }

    fn land(
        &mut self,
        map: &Map<String, Value>,
        line: usize,
        events: &mut Vec<ContactEvent>,
    ) -> Result<(), Fault> {
        let Some(value) = map.get("down") else {
            return Ok(());
        };
        for (i, item) in list(value, "down", "a list of [id, x, y]")?.iter().enumerate() {
            let touch = Touch::from_value(item, &format!("down[{i}]"))?;
            let id = touch.id;
            if let Some(&(_, since)) = self.live.get(&id) {
                return Err(Fault::DoubleDown { id, since });
            }
            if self.live.len() == MAX_CONTACTS {
                return Err(Fault::ManyContacts);
            }
            let generation = self.generations.entry(id).or_default();
            let contact = touch.contact(ContactKey {
                source: Source::File,
                device: 0,
                id,
                generation: *generation,
            });
            *generation += 1;
            self.live.insert(id, (contact, line));
            events.push(ContactEvent {
                phase: Phase::Down,
                contact,
            });
        }
        Ok(())
    }
}

/// One element of `move` or `down`.
struct Touch {
    id: u64,
    position: DVec2,
    size_mm: Option<DVec2>,
    confidence: Option<f32>,
}

impl Touch {
    fn from_value(value: &Value, field: &str) -> Result<Self, Expected> {
        let what = "[id, x, y] or [id, x, y, {\"w\",\"h\",\"conf\"}]";
        let (id, x, y, extra) = match list(value, field, what)? {
            [id, x, y] => (id, x, y, None),
            [id, x, y, extra] => (
                id,
                x,
                y,
                Some(object(extra, &format!("{field}[3]"), "an object")?),
            ),
            _ => return Err(Expected::new(field, what, value)),
        };
        let inside = |key: &str| {
            extra
                .and_then(|map| map.get(key))
                .map(|v| (v, format!("{field}[3].{key}")))
        };
        let length = |key| {
            inside(key)
                .map(|(v, path)| millimetres(v, &path, 0.0))
                .transpose()
        };
        let (width, height) = (length("w")?, length("h")?);
        let confidence = inside("conf")
            .map(|(v, path)| number(v, &path, "a confidence", 0.0, 1.0))
            .transpose()?
            .map(quantise_confidence);
        Ok(Self {
            id: whole(id, &format!("{field}[0]"), "an id (whole number)")?,
            position: DVec2::new(
                millimetres(x, &format!("{field}[1]"), -MAX_COORDINATE_MM)?,
                millimetres(y, &format!("{field}[2]"), -MAX_COORDINATE_MM)?,
            ),
            // A device that tells one length only tells a diameter.
            size_mm: width.or(height).zip(height.or(width)).map(DVec2::from),
            confidence,
        })
    }

    fn contact(&self, key: ContactKey) -> Contact {
        Contact {
            key,
            position: self.position,
            size_mm: self.size_mm,
            confidence: self.confidence,
        }
    }
}

/// Confidence on the raster of gesture files, 0.001.
fn quantise_confidence(confidence: f64) -> f32 {
    ((confidence * 1000.0).round() / 1000.0) as f32
}

/// A session time in ms as µs.
pub(super) fn time_us(value: &Value, field: &str) -> Result<u64, Expected> {
    number(value, field, "milliseconds", 0.0, MAX_TIME_MS).map(|ms| (ms * 1000.0).round() as u64)
}
