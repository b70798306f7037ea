//! Contacts → a recording of `evemu-record`, multi-touch protocol B, so that Linux can play them into any program.
//!
//! Units are 0.01 mm, as fine as gesture files, so that nothing is rounded. What the format cannot say is left out
//! and named: a confidence is a finger or, at 0, a palm; a contact that once told its size keeps the last one. A
//! contact that is withdrawn ends as a palm, and what is withdrawn in the last moment stays down, as in a recording
//! that was stopped: [`crate::input::import::import_evemu`] gives both back as they were.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec2;

use crate::gesture::contact::{
    Contact, ContactEvent, InputFrame, MAX_CONTACTS, MAX_COORDINATE_MM, Phase, Source,
};
use crate::input::evdev_codes::{
    ABS_MT_ORIENTATION, ABS_MT_POSITION_X, ABS_MT_POSITION_Y, ABS_MT_SLOT, ABS_MT_TOOL_TYPE,
    ABS_MT_TOUCH_MAJOR, ABS_MT_TOUCH_MINOR, ABS_MT_TRACKING_ID, ABS_X, ABS_Y, BTN_TOUCH, EV_ABS, EV_KEY,
    EV_SYN, INPUT_PROP_DIRECT, MT_TOOL_PALM, SYN_REPORT,
};

/// Device units in a millimetre: the raster of gesture files.
const UNITS_PER_MM: f64 = 100.0;

/// Tracking ids count up to here and begin again.
const MAX_TRACKING: i32 = 0xffff;

/// Writes the contacts of `frames` on a surface of `size_mm` (mm), and returns what had to be left out, one sentence
/// each. `title` becomes the name of the device.
///
/// # Errors
/// What `out` reports.
pub fn write_evemu<W: Write>(
    mut out: W,
    title: &str,
    size_mm: DVec2,
    frames: &[InputFrame],
) -> io::Result<Vec<String>> {
    let mut writer = Writer::default();
    let last = frames.iter().rposition(|frame| !frame.events.is_empty());
    for (i, frame) in frames.iter().enumerate() {
        writer.frame(frame, Some(i) == last)?;
    }
    head(&mut out, title, size_mm, writer.slots)?;
    out.write_all(&writer.events)?;
    Ok(writer.left_out.sentences())
}

/// Describes a touchscreen as the kernel would.
fn head<W: Write>(mut out: W, title: &str, size_mm: DVec2, slots: u16) -> io::Result<()> {
    let units = |mm: f64| (mm * UNITS_PER_MM).round() as i64;
    let most = units(MAX_COORDINATE_MM);
    let per_mm = UNITS_PER_MM as i64;
    let (width, height) = (units(size_mm.x), units(size_mm.y));
    let axes = [
        (ABS_X, width, per_mm),
        (ABS_Y, height, per_mm),
        (ABS_MT_SLOT, i64::from(slots.max(1)) - 1, 0),
        (ABS_MT_TOUCH_MAJOR, most, per_mm),
        (ABS_MT_TOUCH_MINOR, most, per_mm),
        (ABS_MT_ORIENTATION, 1, 0),
        (ABS_MT_POSITION_X, width, per_mm),
        (ABS_MT_POSITION_Y, height, per_mm),
        (ABS_MT_TOOL_TYPE, i64::from(MT_TOOL_PALM), 0),
        (ABS_MT_TRACKING_ID, i64::from(MAX_TRACKING), 0),
    ];
    let name: String = title
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    writeln!(out, "# EVEMU 1.3")?;
    writeln!(out, "# {} × {} mm, {per_mm} units per mm", size_mm.x, size_mm.y)?;
    writeln!(out, "N: {}", name.trim())?;
    writeln!(out, "I: 0000 0000 0000 0000")?;
    bits(&mut out, "P:", &[INPUT_PROP_DIRECT])?;
    bits(&mut out, "B: 00", &[EV_SYN, EV_KEY, EV_ABS])?;
    bits(&mut out, "B: 01", &[BTN_TOUCH])?;
    bits(&mut out, "B: 03", &axes.map(|(code, ..)| code))?;
    for (code, max, resolution) in axes {
        writeln!(out, "A: {code:02x} 0 {max} 0 0 {resolution}")?;
    }
    Ok(())
}

/// A set of numbers as lines of eight bytes, up to the last number.
fn bits<W: Write>(mut out: W, prefix: &str, set: &[u16]) -> io::Result<()> {
    let last = set.iter().copied().max().unwrap_or(0);
    for line in 0..=last / 64 {
        write!(out, "{prefix}")?;
        for byte in 0..8 {
            let first = line * 64 + byte * 8;
            let within = set.iter().filter(|bit| (first..first + 8).contains(*bit));
            write!(
                out,
                " {:02x}",
                within.fold(0_u8, |mask, bit| mask | 1 << (bit - first))
            )?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// What the format has no words for.
#[derive(Default)]
struct LeftOut {
    contacts: u64,
    confidences: u64,
    sizes: u64,
    commands: u64,
}

impl LeftOut {
    fn sentences(&self) -> Vec<String> {
        let counted = [
            (
                self.contacts,
                "contact(s) left out: more than can be down at once",
            ),
            (
                self.confidences,
                "confidence(s) left out: evemu knows fingers and palms, nothing between",
            ),
            (
                self.sizes,
                "contact(s) whose size was no longer told keep their last one",
            ),
            (self.commands, "command(s) left out: evemu knows contacts alone"),
        ];
        counted
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{count} {what}"))
            .collect()
    }
}

/// Tells, like the kernel, only what changes, and selects slots only when it has to.
#[derive(Default)]
struct Writer {
    events: Vec<u8>,
    t_us: u64,
    /// True if the frame has told anything.
    told_any: bool,
    /// The slot of each contact that is down, by its own name.
    down: BTreeMap<(Source, u16, u64), u16>,
    /// What each slot told last.
    told: BTreeMap<(u16, u16), i32>,
    selected: Option<u16>,
    tracking: i32,
    /// Slots in use so far.
    slots: u16,
    left_out: LeftOut,
}

impl Writer {
    fn frame(&mut self, frame: &InputFrame, last: bool) -> io::Result<()> {
        self.t_us = frame.t_us;
        self.told_any = false;
        self.left_out.commands += frame.commands.len() as u64;
        let was_down = !self.down.is_empty();
        for event in &frame.events {
            self.contact(event, last)?;
        }
        let is_down = !self.down.is_empty();
        if was_down != is_down {
            self.event(EV_KEY, BTN_TOUCH, is_down.into())?;
        }
        // The last moment is told even if all it does is to leave contacts down.
        if self.told_any || (last && !frame.events.is_empty()) {
            self.event(EV_SYN, SYN_REPORT, 0)?;
        }
        Ok(())
    }

    fn contact(&mut self, event: &ContactEvent, last: bool) -> io::Result<()> {
        let name = event.contact.key.slot();
        match event.phase {
            Phase::Down => {
                let Some(slot) = self.free_slot(&event.contact) else {
                    self.left_out.contacts += 1;
                    return Ok(());
                };
                self.down.insert(name, slot);
                self.slots = self.slots.max(slot + 1);
                self.tracking = (self.tracking + 1) % (MAX_TRACKING + 1);
                self.tell(slot, ABS_MT_TRACKING_ID, self.tracking)?;
                self.show(slot, &event.contact)
            }
            Phase::Move => match self.down.get(&name) {
                Some(&slot) => self.show(slot, &event.contact),
                None => Ok(()),
            },
            Phase::Cancel if last => Ok(()),
            Phase::Up | Phase::Cancel => {
                let Some(slot) = self.down.remove(&name) else {
                    return Ok(());
                };
                if event.phase == Phase::Cancel {
                    self.tell(slot, ABS_MT_TOOL_TYPE, MT_TOOL_PALM)?;
                }
                self.tell(slot, ABS_MT_TRACKING_ID, -1)
            }
        }
    }

    /// A slot for a contact that lands: the one of its own number if it can be, so that slots that became ids become
    /// slots again. A contact that tells no size must not inherit one.
    fn free_slot(&self, contact: &Contact) -> Option<u16> {
        let fits = |slot: &u16| {
            let sized = self.told.contains_key(&(*slot, ABS_MT_TOUCH_MAJOR));
            (!sized || contact.size_mm.is_some()) && !self.down.values().any(|taken| taken == slot)
        };
        let most = MAX_CONTACTS as u16;
        let own = u16::try_from(contact.key.id).ok().filter(|own| *own < most);
        own.into_iter().chain(0..most).find(fits)
    }

    /// Tells where the contact is and what it looks like.
    fn show(&mut self, slot: u16, contact: &Contact) -> io::Result<()> {
        let units = |mm: f64| (mm * UNITS_PER_MM).round() as i32;
        self.tell(slot, ABS_MT_POSITION_X, units(contact.position.x))?;
        self.tell(slot, ABS_MT_POSITION_Y, units(contact.position.y))?;
        if let Some(size) = contact.size_mm {
            self.tell(slot, ABS_MT_TOUCH_MAJOR, units(size.max_element()))?;
            self.tell(slot, ABS_MT_TOUCH_MINOR, units(size.min_element()))?;
            // The major axis lies along x at the greatest orientation.
            self.tell_unless_zero(slot, ABS_MT_ORIENTATION, i32::from(size.x > size.y))?;
        } else if self.told.contains_key(&(slot, ABS_MT_TOUCH_MAJOR)) {
            self.left_out.sizes += 1;
        }
        let palm = contact.confidence == Some(0.0);
        if contact.confidence.is_some() && !palm {
            self.left_out.confidences += 1;
        }
        self.tell_unless_zero(slot, ABS_MT_TOOL_TYPE, if palm { MT_TOOL_PALM } else { 0 })
    }

    /// Tells a value, but no zero in a slot that never told another.
    fn tell_unless_zero(&mut self, slot: u16, code: u16, value: i32) -> io::Result<()> {
        if value == 0 && !self.told.contains_key(&(slot, code)) {
            return Ok(());
        }
        self.tell(slot, code, value)
    }

    fn tell(&mut self, slot: u16, code: u16, value: i32) -> io::Result<()> {
        if self.told.insert((slot, code), value) == Some(value) {
            return Ok(());
        }
        if self.selected.replace(slot) != Some(slot) {
            self.event(EV_ABS, ABS_MT_SLOT, slot.into())?;
        }
        self.event(EV_ABS, code, value)
    }

    fn event(&mut self, kind: u16, code: u16, value: i32) -> io::Result<()> {
        self.told_any = true;
        let (s, us) = (self.t_us / 1_000_000, self.t_us % 1_000_000);
        writeln!(self.events, "E: {s}.{us:06} {kind:04x} {code:04x} {value:04}")
    }
}
