//! Recordings of `evemu-record`, multi-touch protocol B (Linux kernel, "Multi-touch (MT) Protocol").
//!
//! A recording is a text of lines: `#` comments, the device's name and axes (`N:`, `A:`), and events
//! (`E: sec.usec type code value`, type and code hexadecimal). A contact lives in a *slot*; events speak of the slot
//! that `ABS_MT_SLOT` named last, a tracking id says that a contact is down there, −1 that it lifted, and
//! `SYN_REPORT` ends the frame. The kernel tells only what changes, so a slot keeps its readings from one contact to
//! the next, and what a recording never tells is not known.
//!
//! Positions become table millimetres: the `A:` lines 35 and 36 give the range, their resolution (units per mm) the
//! size; old recorders write the resolution only into the comment that describes the axis.

mod axes;
mod line;
mod slots;

use std::collections::BTreeMap;
use std::io::{self, BufRead, BufReader, Read};

use glam::DVec2;

use crate::gesture::contact::{
    Contact, ContactEvent, ContactKey, InputFrame, MAX_CONTACTS, MAX_COORDINATE_MM, Phase, Source,
    quantise_mm,
};
use crate::gesture::file::MAX_TIME_MS;
use crate::gesture::json::Expected;
use axes::{Axes, Plane};
use line::Line;
use slots::{Slots, Touch};

/// Most bytes of a line; recorders write less than a tenth of it.
pub const MAX_LINE_BYTES: usize = 4096;

/// Most lines of a recording: an hour and a half of ten fingers.
pub const MAX_LINES: usize = 4_000_000;

/// Characters of a device's name that the title keeps.
const TITLE_CHARS: usize = 120;

/// What a recording may fail to say about itself, or say wrongly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EvemuOptions {
    /// Device units at the left, right, upper and lower edge (`x0, x1, y0, y1`).
    pub range: Option<[f64; 4]>,
    /// Size of the touching surface, mm.
    pub size_mm: Option<DVec2>,
}

/// A recording, as a gesture file would hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The device's name, or else the recording's.
    pub title: String,
    /// Size of the table, mm.
    pub size_mm: DVec2,
    /// The moments in which contacts change, the first at 0, each in canonical order (phase, then id).
    pub frames: Vec<InputFrame>,
    /// What was let pass, one sentence each.
    pub warnings: Vec<String>,
}

/// Why a recording was refused.
#[derive(Debug, thiserror::Error)]
#[error("{name}:{line}: {fault}")]
pub struct EvemuError {
    /// The recording, as the caller named it.
    pub name: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong there.
    #[source]
    pub fault: EvemuFault,
}

/// What is wrong with a recording.
#[derive(Debug, thiserror::Error)]
pub enum EvemuFault {
    /// A field does not hold what it should.
    #[error(transparent)]
    Expected(#[from] Expected),
    /// The recording cannot be read on.
    #[error("expected to read on: {0}")]
    Io(#[from] io::Error),
    /// A line is longer than [`MAX_LINE_BYTES`].
    #[error("expected at most {MAX_LINE_BYTES} bytes in a line, found more")]
    LongLine,
    /// The recording has more than [`MAX_LINES`].
    #[error("expected at most {MAX_LINES} lines, found more")]
    ManyLines,
    /// Time runs backwards.
    #[error("time: expected at least {before_s:.6} s as in the event before, found {found_s:.6}")]
    Backwards {
        /// Time of the event before, s.
        before_s: f64,
        /// Time of this event, s.
        found_s: f64,
    },
    /// Longer than a gesture file may be.
    #[error("time: expected at most {} days after the first event, found more", MAX_TIME_MS / 86_400_000.0)]
    LongTime,
    /// Protocol A, which does not say which contact is which.
    #[error(
        "expected multi-touch protocol B (ABS_MT_SLOT, ABS_MT_TRACKING_ID), found SYN_MT_REPORT of protocol A, \
         which has no slots"
    )]
    ProtocolA,
    /// No positions of several fingers.
    #[error("expected multi-touch events (ABS_MT_POSITION_X, ABS_MT_POSITION_Y), found {found}")]
    NoMultiTouch {
        /// What there is instead.
        found: &'static str,
    },
    /// Nothing says what the device units mean.
    #[error(
        "expected a range of ABS_MT_POSITION_X and _Y (A: 35, A: 36), found none: give --range X0,X1,Y0,Y1"
    )]
    NoRange,
    /// Nothing says how large the surface is.
    #[error(
        "expected a resolution of ABS_MT_POSITION_X and _Y (units per mm), found none: give --size-mm W,H"
    )]
    NoSize,
    /// A position that is on no table.
    #[error(
        "position: expected at most {MAX_COORDINATE_MM} mm from the corner, found {found_mm:.0}: check --range"
    )]
    Far {
        /// The greater coordinate, mm.
        found_mm: f64,
    },
}

/// Reads a recording; `name` stands for it in errors, and in the title where the device has no name.
///
/// What a recording says about itself comes before `options`. Ids are slots. A contact lands when both its
/// coordinates are known; what is down at the end is cancelled.
///
/// # Errors
/// Anything but a protocol B recording with known range and size, by line.
pub fn import_evemu<R: Read>(source: R, name: &str, options: &EvemuOptions) -> Result<Imported, EvemuError> {
    let mut recording = Recording::default();
    let mut number = 0;
    recording
        .read(source, &mut number)
        .and_then(|()| recording.import(name, options, &mut number))
        .map_err(|fault| EvemuError {
            name: name.to_owned(),
            line: number.max(1),
            fault,
        })
}

/// A moment in device units.
struct RawFrame {
    t_us: u64,
    line: usize,
    events: Vec<slots::RawEvent>,
}

/// What the lines say, in device units.
#[derive(Default)]
struct Recording {
    name: Option<String>,
    axes: Axes,
    slots: Slots,
    frames: Vec<RawFrame>,
    /// Time of the first event and of the last one, µs.
    span_us: Option<(u64, u64)>,
    /// True from `SYN_DROPPED` to the next `SYN_REPORT`.
    dropping: bool,
    drops: usize,
    /// True while a frame has events but no `SYN_REPORT` yet.
    open: bool,
    /// The first line with an event of any absolute axis, and with one of a contact's position.
    first_axis: Option<usize>,
    first_position: Option<usize>,
    torn: Option<usize>,
}

impl Recording {
    /// Reads to the end; `number` counts the lines.
    fn read<R: Read>(&mut self, source: R, number: &mut usize) -> Result<(), EvemuFault> {
        let mut source = BufReader::new(source);
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            let within = &mut (&mut source).take(MAX_LINE_BYTES as u64 + 1);
            let read = within.read_until(b'\n', &mut bytes)?;
            if read == 0 {
                return Ok(());
            }
            *number += 1;
            if *number > MAX_LINES {
                return Err(EvemuFault::ManyLines);
            }
            if read > MAX_LINE_BYTES {
                return Err(EvemuFault::LongLine);
            }
            // Names of devices and comments may be in any encoding; numbers are ASCII.
            match Line::parse(&String::from_utf8_lossy(&bytes)) {
                Ok(line) => self.line(line, *number)?,
                // A recorder that was killed leaves half a line.
                Err(_) if bytes.last() != Some(&b'\n') => self.torn = Some(*number),
                Err(fault) => return Err(fault.into()),
            }
        }
    }

    fn line(&mut self, line: Line, number: usize) -> Result<(), EvemuFault> {
        match line {
            Line::Nothing => Ok(()),
            Line::Name(name) => {
                self.name = Some(name);
                Ok(())
            }
            Line::Comment(text) => {
                if let Some(slot) = self.axes.comment(&text) {
                    self.slots.select(slot);
                }
                Ok(())
            }
            Line::Axis(code, axis) => {
                self.axes.line(code, axis);
                Ok(())
            }
            Line::Event(event) => self.event(event, number),
        }
    }

    fn event(&mut self, event: line::Event, number: usize) -> Result<(), EvemuFault> {
        let (first, last) = self.span_us.unwrap_or((event.t_us, event.t_us));
        if event.t_us < last {
            return Err(EvemuFault::Backwards {
                before_s: last as f64 / 1e6,
                found_s: event.t_us as f64 / 1e6,
            });
        }
        if (event.t_us - first) as f64 > MAX_TIME_MS * 1e3 {
            return Err(EvemuFault::LongTime);
        }
        self.span_us = Some((first, event.t_us));
        match (event.kind, event.code) {
            (line::EV_SYN, line::SYN_REPORT) => {
                self.open = false;
                if !std::mem::take(&mut self.dropping) {
                    let events = self.slots.report();
                    self.push(event.t_us, number, events);
                }
            }
            (line::EV_SYN, line::SYN_MT_REPORT) => return Err(EvemuFault::ProtocolA),
            (line::EV_SYN, line::SYN_DROPPED) => {
                self.open = false;
                self.dropping = true;
                self.drops += 1;
                let events = self.slots.drop_all();
                self.push(event.t_us, number, events);
            }
            (line::EV_ABS, line::ABS_MT_SLOT) => {
                // Also among what is to be ignored: it tells the truth about the events after that.
                let slot = u16::try_from(event.value).ok();
                let slot = slot.filter(|slot| usize::from(*slot) < MAX_CONTACTS);
                self.slots.select(slot.ok_or_else(|| {
                    Expected::new(
                        "ABS_MT_SLOT",
                        format!("a slot (0..={})", MAX_CONTACTS - 1),
                        &event.value.into(),
                    )
                })?);
            }
            (line::EV_ABS, code) => {
                self.first_axis.get_or_insert(number);
                if matches!(code, line::ABS_MT_POSITION_X | line::ABS_MT_POSITION_Y) {
                    self.first_position.get_or_insert(number);
                }
                if !self.dropping {
                    self.open |= self.slots.read(code, event.value);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn push(&mut self, t_us: u64, line: usize, events: Vec<slots::RawEvent>) {
        if !events.is_empty() {
            self.frames.push(RawFrame { t_us, line, events });
        }
    }

    /// What was read, as contacts; `number` becomes the line of a fault.
    fn import(
        &mut self,
        name: &str,
        options: &EvemuOptions,
        number: &mut usize,
    ) -> Result<Imported, EvemuFault> {
        let last_line = *number;
        *number = self.first_position.or(self.first_axis).unwrap_or(last_line);
        if !(self.slots.has_positions()) {
            return Err(EvemuFault::NoMultiTouch {
                found: match (self.first_position, self.first_axis) {
                    (Some(_), _) => "only one of them",
                    (None, Some(_)) => "only single-touch axes",
                    (None, None) => "no events of any axis",
                },
            });
        }
        let mut warnings = Vec::new();
        let plane = self.axes.plane(options, &mut warnings)?;
        let still_down = self.slots.drop_all();
        let down = still_down.len();
        self.push(self.span_us.map_or(0, |span| span.1), last_line, still_down);
        let start_us = self.frames.first().map_or(0, |frame| frame.t_us);
        let mut frames = Vec::with_capacity(self.frames.len());
        let mut shown = BTreeMap::new();
        for raw in std::mem::take(&mut self.frames) {
            *number = raw.line;
            let mut events = Vec::with_capacity(raw.events.len());
            for event in &raw.events {
                let phase = event.phase;
                let contact = contact(&plane, event)?;
                // Readings of no known unit change without changing the contact.
                if shown.insert(event.slot, contact) != Some(contact) || phase != Phase::Move {
                    events.push(ContactEvent { phase, contact });
                }
            }
            if events.is_empty() {
                continue;
            }
            events.sort_by_key(|event| (event.phase.order(), event.contact.key));
            frames.push(InputFrame {
                t_us: raw.t_us - start_us,
                events,
                commands: Vec::new(),
            });
        }
        self.warn(down, &mut warnings);
        let title = self.name.as_deref().unwrap_or(name);
        Ok(Imported {
            title: title.chars().take(TITLE_CHARS).collect(),
            size_mm: plane.size_mm,
            frames,
            warnings,
        })
    }

    fn warn(&self, down: usize, warnings: &mut Vec<String>) {
        if let Some(line) = self.torn {
            warnings.push(format!("line {line}: torn, left out"));
        }
        if self.open {
            warnings.push("the last frame has no SYN_REPORT, left out".to_owned());
        }
        let counted = [
            (
                self.drops,
                "SYN_DROPPED: events are missing, all contacts cancelled",
            ),
            (
                self.slots.mid_touch,
                "contact(s) already down when the recording begins or goes on, taken to land where first seen",
            ),
            (
                self.slots.unplaced,
                "contact(s) left out: no frame has them down with both coordinates",
            ),
            (down, "contact(s) still down at the end, cancelled"),
        ];
        warnings.extend(
            counted
                .iter()
                .filter(|(count, _)| *count > 0)
                .map(|(count, what)| format!("{count} {what}")),
        );
    }
}

/// The contact of an event, in table millimetres.
fn contact(plane: &Plane, event: &slots::RawEvent) -> Result<Contact, EvemuFault> {
    let Touch {
        x,
        y,
        area,
        approach,
        orientation,
        palm,
    } = event.touch;
    let at = plane.position(x, y);
    let far = at.abs().max_element();
    if far > MAX_COORDINATE_MM {
        return Err(EvemuFault::Far { found_mm: far });
    }
    let length = |mm: f64| quantise_mm(mm.clamp(0.0, MAX_COORDINATE_MM));
    let area = area.zip(plane.touch_mm_per_unit);
    let area = area.or_else(|| approach.zip(plane.approach_mm_per_unit));
    let size_mm = area.map(|((major, minor), mm_per_unit)| {
        // The major axis stands upright at 0 and lies at the greatest orientation (or its negative).
        let (width, height) = if plane.lies(orientation) {
            (major, minor)
        } else {
            (minor, major)
        };
        let size = DVec2::new(width.into(), height.into()) * mm_per_unit;
        DVec2::new(length(size.x), length(size.y))
    });
    Ok(Contact {
        key: ContactKey {
            source: Source::File,
            device: 0,
            id: event.slot.into(),
            generation: event.generation,
        },
        position: DVec2::new(quantise_mm(at.x), quantise_mm(at.y)),
        size_mm,
        confidence: palm.then_some(0.0),
    })
}
