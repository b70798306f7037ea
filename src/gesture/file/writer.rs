//! Writes gesture files in their canonical form.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write};

use super::header::Header;
use super::reader::GestureFile;
use crate::gesture::admission::Admission;
use crate::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, Phase};
use crate::gesture::json::write_position;

/// Writes a gesture file moment by moment, one `write` per line, so that a power cut tears at most the last one.
///
/// Whatever moments it is given, the file can be read: events of contacts that are not down are left out, a
/// second down cancels the first, several sources get ids that differ, and time never runs back. Where the events
/// of a moment do not fit the canonical order (a contact lands and lifts at once), they take several lines of equal
/// time.
#[derive(Debug)]
pub struct GestureWriter<W: Write> {
    sink: W,
    line: String,
    admission: Admission,
    /// Ids in the file of the contacts that are down.
    ids: BTreeMap<ContactKey, u64>,
    t_us: u64,
}

impl<W: Write> GestureWriter<W> {
    /// Begins a file with its header.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn new(sink: W, header: &Header) -> io::Result<Self> {
        let mut writer = Self {
            sink,
            line: String::new(),
            admission: Admission::default(),
            ids: BTreeMap::new(),
            t_us: 0,
        };
        header.write_json(&mut writer.line);
        writer.end_line()?;
        Ok(writer)
    }

    /// Writes one moment.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn write_frame(&mut self, frame: &InputFrame) -> io::Result<()> {
        self.t_us = self.t_us.max(frame.t_us);
        let rounds = self.admission.admit(&frame.events);
        let mut rounds = rounds.iter();
        let first = rounds.next().map_or(&[][..], Vec::as_slice);
        self.begin_line(first);
        if !frame.commands.is_empty() {
            self.line.push_str(",\"do\":");
            let several = frame.commands.len() > 1;
            for (i, command) in frame.commands.iter().enumerate() {
                match (several, i) {
                    (true, 0) => self.line.push('['),
                    (true, _) => self.line.push(','),
                    (false, _) => {}
                }
                command.write_json(&mut self.line);
            }
            if several {
                self.line.push(']');
            }
        }
        self.line.push('}');
        self.end_line()?;
        for round in rounds {
            self.begin_line(round);
            self.line.push('}');
            self.end_line()?;
        }
        Ok(())
    }

    /// Hands everything on to the device.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }

    /// Flushes, and gives the sink back.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn into_inner(mut self) -> io::Result<W> {
        self.sink.flush()?;
        Ok(self.sink)
    }

    fn end_line(&mut self) -> io::Result<()> {
        self.line.push('\n');
        let result = self.sink.write_all(self.line.as_bytes());
        self.line.clear();
        result
    }

    /// The line up to its commands; `round` is in the order of [`Admission::admit`].
    fn begin_line(&mut self, round: &[ContactEvent]) {
        self.line.push_str("{\"t\":");
        write_time(&mut self.line, self.t_us);
        let mut written: Vec<(Phase, u64, Contact)> = Vec::with_capacity(round.len());
        for event in round {
            let key = event.contact.key;
            let id = match event.phase {
                Phase::Up | Phase::Cancel => self.ids.remove(&key).unwrap_or(key.id),
                Phase::Move => self.ids.get(&key).copied().unwrap_or(key.id),
                Phase::Down => self.name(key),
            };
            written.push((event.phase, id, event.contact));
        }
        written.sort_by_key(|&(phase, id, _)| (phase.order(), id));
        let mut last = None;
        for (phase, id, contact) in &written {
            if last == Some(*phase) {
                self.line.push(',');
            } else {
                if last.is_some() {
                    self.line.push(']');
                }
                let name = match phase {
                    Phase::Up => "up",
                    Phase::Cancel => "cancel",
                    Phase::Move => "move",
                    Phase::Down => "down",
                };
                let _ = write!(self.line, ",\"{name}\":[");
                last = Some(*phase);
            }
            match phase {
                Phase::Up | Phase::Cancel => {
                    let _ = write!(self.line, "{id}");
                }
                Phase::Move | Phase::Down => write_touch(&mut self.line, *id, contact),
            }
        }
        if last.is_some() {
            self.line.push(']');
        }
    }

    /// The source's own id if no other contact has it, else the first free one.
    fn name(&mut self, key: ContactKey) -> u64 {
        let taken = |ids: &BTreeMap<ContactKey, u64>, id| ids.values().any(|&other| other == id);
        let mut id = key.id;
        if taken(&self.ids, id) {
            id = 0;
            while taken(&self.ids, id) {
                id += 1;
            }
        }
        self.ids.insert(key, id);
        id
    }
}

impl GestureFile {
    /// Writes the file in its canonical form.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn write<W: Write>(&self, sink: W) -> io::Result<W> {
        let mut writer = GestureWriter::new(sink, &self.header)?;
        for frame in &self.frames {
            writer.write_frame(frame)?;
        }
        writer.into_inner()
    }
}

/// A session time in ms, with as many decimals (at most three) as it needs.
pub(super) fn write_time(out: &mut String, t_us: u64) {
    let _ = write!(out, "{}", t_us / 1000);
    if !t_us.is_multiple_of(1000) {
        let decimals = format!(".{:03}", t_us % 1000);
        out.push_str(decimals.trim_end_matches('0'));
    }
}

fn write_touch(out: &mut String, id: u64, contact: &Contact) {
    let contact = contact.as_recorded();
    let _ = write!(out, "[{id},");
    let mut at = String::new();
    write_position(&mut at, contact.position);
    // Without the brackets of a bare position.
    out.push_str(&at[1..at.len() - 1]);
    if contact.size_mm.is_some() || contact.confidence.is_some() {
        out.push_str(",{");
        if let Some(size) = contact.size_mm {
            let _ = write!(out, "\"w\":{:.2},\"h\":{:.2}", size.x, size.y);
        }
        if let Some(confidence) = contact.confidence {
            let separator = if contact.size_mm.is_some() { "," } else { "" };
            let thousandths = (f64::from(confidence) * 1000.0).round() / 1000.0;
            let _ = write!(out, "{separator}\"conf\":{thousandths}");
        }
        out.push('}');
    }
    out.push(']');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_keep_their_microseconds_and_no_zeros() {
        for (t_us, text) in [
            (0, "0"),
            (16_000, "16"),
            (16_500, "16.5"),
            (16_667, "16.667"),
            (7, "0.007"),
        ] {
            let mut out = String::new();
            write_time(&mut out, t_us);
            assert_eq!(out, text);
        }
    }
}
