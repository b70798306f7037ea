//! What the kernel tells of a touchscreen (Linux kernel, "Multi-touch (MT) Protocol") → contacts.
//!
//! *Protocol B*: a contact lives in a *slot*; events speak of the slot that `ABS_MT_SLOT` named last, a tracking id
//! says that a contact is down there, −1 that it lifted, and `SYN_REPORT` ends the frame. The kernel tells only what
//! changes, so a slot keeps its readings from one contact to the next, and what a recording never tells is not known.
//!
//! *Protocol A*, of older drivers: each frame tells all contacts, each ended by `SYN_MT_REPORT`, in any order; a
//! tracking id is rare. They are matched with those of the frame before ([`unslotted`]). A frame that tells no
//! contact and takes `BTN_TOUCH` away lifts them all.

mod axes;
pub(super) mod codes;
mod slots;
mod touch;
mod unslotted;

use std::collections::BTreeMap;

use glam::DVec2;

use super::time::Span;
use super::{ImportFault, ImportOptions, Imported};
use crate::gesture::contact::{
    Contact, ContactEvent, ContactKey, InputFrame, MAX_CONTACTS, MAX_COORDINATE_MM, Phase, Source,
    quantise_mm,
};
use crate::gesture::json::Expected;
pub(super) use axes::Axis;
use axes::{Axes, Plane};
pub(super) use codes::Event;
use slots::Slots;
use touch::{RawEvent, Readings, Touch};
use unslotted::{MAX_PACKETS, Packet, Unslotted};

/// How contacts are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Protocol {
    /// Not known yet.
    #[default]
    Unknown,
    /// Protocol A.
    Packets,
    /// Protocol B.
    Slots,
}

/// What a frame tells, in device units.
#[derive(Debug)]
enum Told {
    /// What contacts do (protocol B).
    Events(Vec<RawEvent>),
    /// All contacts that are down (protocol A).
    State(Vec<Packet>),
    /// Events are missing (protocol A).
    Lost,
}

/// A moment in device units.
#[derive(Debug)]
struct RawFrame {
    t_us: u64,
    line: usize,
    told: Told,
}

/// What a recording says, in device units.
#[derive(Debug, Default)]
pub(super) struct Recording {
    name: Option<String>,
    axes: Axes,
    protocol: Protocol,
    slots: Slots,
    /// The contact of which protocol A speaks.
    packet: Readings,
    /// The contacts of the frame in protocol A, if it tells of them.
    state: Option<Vec<Packet>>,
    frames: Vec<RawFrame>,
    span: Span,
    /// True from `SYN_DROPPED` to the next `SYN_REPORT`.
    dropping: bool,
    drops: usize,
    /// True while a frame has events but no `SYN_REPORT` yet.
    open: bool,
    /// The first line with an event of any absolute axis, and with one of a contact's position along x and y.
    first_axis: Option<usize>,
    first_x: Option<usize>,
    first_y: Option<usize>,
    /// Contacts of protocol A without a place, and those beyond the most.
    unplaced: usize,
    over_cap: usize,
    torn: Option<usize>,
}

impl Recording {
    /// The device's name.
    pub(super) fn name(&mut self, name: String) {
        self.name = Some(name);
    }

    /// A comment of the device's description.
    pub(super) fn comment(&mut self, text: &str) {
        if let Some(slot) = self.axes.comment(text) {
            self.slots.select(slot);
        }
    }

    /// Range and resolution of an axis.
    pub(super) fn axis(&mut self, code: u16, axis: Axis) {
        self.axes.line(code, axis);
    }

    /// The recording ends in half a line.
    pub(super) fn torn(&mut self, line: usize) {
        self.torn = Some(line);
    }

    /// Moments in which contacts changed or were told.
    pub(super) fn moments(&self) -> usize {
        self.frames.len()
    }

    /// Takes an event, and the line on which it stands.
    pub(super) fn event(&mut self, event: Event, line: usize) -> Result<(), ImportFault> {
        self.span.advance(event.t_us)?;
        match (event.kind, event.code) {
            (codes::EV_SYN, codes::SYN_REPORT) => self.report(event.t_us, line),
            (codes::EV_SYN, codes::SYN_MT_REPORT) => self.packet()?,
            (codes::EV_SYN, codes::SYN_DROPPED) => self.lose(event.t_us, line),
            (codes::EV_KEY, codes::BTN_TOUCH) if event.value == 0 && self.protocol == Protocol::Packets => {
                self.state.get_or_insert_default();
            }
            (codes::EV_ABS, codes::ABS_MT_SLOT) => {
                if self.protocol == Protocol::Packets {
                    return Err(ImportFault::BothProtocols);
                }
                self.protocol = Protocol::Slots;
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
            (codes::EV_ABS, code) => self.absolute(code, event.value, line),
            _ => {}
        }
        Ok(())
    }

    fn absolute(&mut self, code: u16, value: i32, line: usize) {
        self.first_axis.get_or_insert(line);
        match code {
            codes::ABS_MT_POSITION_X => _ = self.first_x.get_or_insert(line),
            codes::ABS_MT_POSITION_Y => _ = self.first_y.get_or_insert(line),
            _ => {}
        }
        if self.dropping || !Readings::are_told_by(code) {
            return;
        }
        self.open = true;
        if self.protocol != Protocol::Slots {
            self.packet.tell(code, value);
        }
        if self.protocol != Protocol::Packets {
            self.slots.read(code, value);
        }
    }

    /// `SYN_MT_REPORT`: one contact is told, or that there is none.
    fn packet(&mut self) -> Result<(), ImportFault> {
        match self.protocol {
            Protocol::Slots => return Err(ImportFault::BothProtocols),
            // What the slots have read so far was this contact.
            Protocol::Unknown => self.slots = Slots::default(),
            Protocol::Packets => {}
        }
        self.protocol = Protocol::Packets;
        let readings = std::mem::take(&mut self.packet);
        if self.dropping {
            return Ok(());
        }
        self.open = true;
        let state = self.state.get_or_insert_default();
        match Packet::of(&readings) {
            Some(_) if state.len() >= MAX_PACKETS => self.over_cap += 1,
            Some(packet) => state.push(packet),
            None if !readings.is_empty() => self.unplaced += 1,
            None => {}
        }
        Ok(())
    }

    /// `SYN_REPORT`: the frame is complete.
    fn report(&mut self, t_us: u64, line: usize) {
        self.open = false;
        let state = self.state.take();
        if std::mem::take(&mut self.dropping) {
            return;
        }
        if self.protocol == Protocol::Packets {
            // (What no SYN_MT_REPORT ended is no contact.)
            self.packet = Readings::default();
            if let Some(state) = state {
                self.push(t_us, line, Told::State(state));
            }
            return;
        }
        let events = self.slots.report();
        if !events.is_empty() {
            self.protocol = Protocol::Slots;
            self.push(t_us, line, Told::Events(events));
        }
    }

    /// `SYN_DROPPED`: events are missing.
    fn lose(&mut self, t_us: u64, line: usize) {
        self.open = false;
        self.dropping = true;
        self.drops += 1;
        self.packet = Readings::default();
        self.state = None;
        let told = if self.protocol == Protocol::Packets {
            Told::Lost
        } else {
            Told::Events(self.slots.drop_all())
        };
        self.push(t_us, line, told);
    }

    fn push(&mut self, t_us: u64, line: usize, told: Told) {
        self.frames.push(RawFrame { t_us, line, told });
    }

    /// What was read, as contacts; `line`, of its last event, becomes that of a fault.
    pub(super) fn import(
        mut self,
        name: &str,
        options: &ImportOptions,
        line: &mut usize,
    ) -> Result<Imported, ImportFault> {
        let last_line = *line;
        let position = self.first_x.into_iter().chain(self.first_y).min();
        *line = position.or(self.first_axis).unwrap_or(last_line);
        if self.first_x.is_none() || self.first_y.is_none() {
            return Err(ImportFault::NoMultiTouch {
                found: match (position, self.first_axis) {
                    (Some(_), _) => "only one of them",
                    (None, Some(_)) => "only single-touch axes",
                    (None, None) => "no events of any axis",
                },
            });
        }
        let mut warnings = Vec::new();
        let plane = self.axes.plane(options, &mut warnings)?;
        let end_us = self.span.end_us();
        let left = self.slots.drop_all();
        let mut down = left.len();
        self.push(end_us, last_line, Told::Events(left));
        let mut unslotted = Unslotted::default();
        let mut frames = Frames::new(plane);
        for raw in std::mem::take(&mut self.frames) {
            *line = raw.line;
            let events = match raw.told {
                Told::Events(events) => events,
                Told::State(state) => unslotted.frame(&plane, &state),
                Told::Lost => unslotted.drop_all(),
            };
            frames.push(raw.t_us, &events)?;
        }
        *line = last_line;
        let left = unslotted.drop_all();
        down += left.len();
        frames.push(end_us, &left)?;
        self.warn(down, &mut warnings);
        Ok(Imported {
            title: super::title(self.name.as_deref(), name),
            size_mm: plane.size_mm,
            frames: frames.done,
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
                self.slots.unplaced + self.unplaced,
                "contact(s) left out: no frame has them down with both coordinates",
            ),
            (
                self.over_cap,
                "contact(s) left out: more in a frame than protocol A was ever used for",
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

/// The frames in table millimetres, as they are made.
struct Frames {
    plane: Plane,
    /// Time of the first one, µs.
    start_us: Option<u64>,
    shown: BTreeMap<u16, Contact>,
    done: Vec<InputFrame>,
}

impl Frames {
    fn new(plane: Plane) -> Self {
        Self {
            plane,
            start_us: None,
            shown: BTreeMap::new(),
            done: Vec::new(),
        }
    }

    fn push(&mut self, t_us: u64, raw: &[RawEvent]) -> Result<(), ImportFault> {
        let mut events = Vec::with_capacity(raw.len());
        for event in raw {
            let phase = event.phase;
            let contact = contact(&self.plane, event)?;
            // Readings of no known unit change without changing the contact.
            if self.shown.insert(event.slot, contact) != Some(contact) || phase != Phase::Move {
                events.push(ContactEvent { phase, contact });
            }
        }
        if events.is_empty() {
            return Ok(());
        }
        events.sort_by_key(|event| (event.phase.order(), event.contact.key));
        self.done.push(InputFrame {
            t_us: t_us - *self.start_us.get_or_insert(t_us),
            events,
            commands: Vec::new(),
        });
        Ok(())
    }
}

/// The contact of an event, in table millimetres.
fn contact(plane: &Plane, event: &RawEvent) -> Result<Contact, ImportFault> {
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
        return Err(ImportFault::Far { found_mm: far });
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
