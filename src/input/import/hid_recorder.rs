//! Recordings of `hid-recorder`: the very bytes that devices sent.
//!
//! ```text
//! D: 0
//! R: 8 05 0d 09 04 a1 01 … c0
//! N: Touch table
//! I: 3 056a 005d
//! E: 000001.016000 11 01 03 00 e8 03 f4 01 00 00 00 01
//! ```
//!
//! `R:` is the report descriptor and `E:` a report, each with its length in decimal and its bytes in hexadecimal; `D:`
//! says of which device the lines after it speak, where several are recorded; other lines say nothing here. The
//! reports are read by the decoder of the live table ([`crate::input::hid`]). Of several devices the touchscreen
//! counts, and of several touchscreens the one that was touched most.

use std::collections::BTreeMap;
use std::io::Read;

use glam::{DAffine2, DVec2};
use serde_json::Value;

use super::devices::{Candidate, choose};
use super::lines::Lines;
use super::time::{Span, micros};
use super::{ImportError, ImportFault, ImportOptions, Imported};
use crate::gesture::contact::{ContactEvent, InputFrame, Phase, Source};
use crate::gesture::json::Expected;
use crate::input::hid::{Decoder, DecoderCounts, Descriptor, Quirks, Refusal};
use crate::input::touching::Tracker;

/// Time after a report at which the decoder is asked what a moment without one means, µs.
const MOMENT_US: u64 = 10_000;

/// Reads a recording; `name` stands for it in errors, and in the title where the device has no name. A size in
/// `options` wins over what the descriptor says; a range is not needed.
///
/// # Errors
/// Anything but a touchscreen whose size is known, by line.
pub fn import_hid_recorder<R: Read>(
    source: R,
    name: &str,
    options: &ImportOptions,
) -> Result<Imported, ImportError> {
    let mut lines = Lines::new(source);
    let mut recording = Recording::default();
    let read = options
        .size()
        .and_then(|size_mm| recording.read(&mut lines, size_mm));
    read.and_then(|()| recording.import(name, options))
        .map_err(|fault| fault.at(name, lines.count))
}

/// All devices of a recording.
#[derive(Default)]
struct Recording {
    devices: BTreeMap<u32, Device>,
    /// The device of which the lines speak.
    selected: u32,
    torn: Option<usize>,
}

impl Recording {
    fn read<R: Read>(&mut self, lines: &mut Lines<R>, size_mm: Option<DVec2>) -> Result<(), ImportFault> {
        while let Some(line) = lines.next()? {
            let (read, torn) = (self.line(line.text.trim(), size_mm), line.torn);
            match read {
                Err(ImportFault::Expected(_)) if torn => self.torn = Some(lines.count),
                read => read?,
            }
        }
        Ok(())
    }

    fn line(&mut self, line: &str, size_mm: Option<DVec2>) -> Result<(), ImportFault> {
        if line.is_empty() || line.starts_with('#') {
            return Ok(());
        }
        let (kind, rest) = line
            .split_once(':')
            .filter(|(kind, _)| kind.len() == 1)
            .ok_or_else(|| {
                let what = "D:, R:, N:, P:, I:, E: or # of a hid-recorder recording";
                Expected::new("line", what, &Value::from(line))
            })?;
        if kind == "D" {
            let what = || Expected::new("D", "D: number of a device", &Value::from(rest));
            self.selected = rest.trim().parse().map_err(|_| what())?;
            return Ok(());
        }
        match kind {
            "R" => {
                let descriptor = Descriptor::parse(&sized_bytes("R", rest)?)?;
                self.devices
                    .entry(self.selected)
                    .or_default()
                    .describe(descriptor, size_mm)
            }
            "N" => {
                let device = self.devices.entry(self.selected).or_default();
                rest.trim().clone_into(&mut device.name);
                Ok(())
            }
            "I" => {
                let device = self.devices.entry(self.selected).or_default();
                device.id = identity(rest)?;
                Ok(())
            }
            "E" => {
                let (time, report) = rest.trim_start().split_once(' ').unwrap_or((rest, ""));
                let (t_us, report) = (micros(time.trim())?, sized_bytes("E", report)?);
                let device = self.devices.get_mut(&self.selected);
                let described = device.filter(|device| device.descriptor.is_some());
                described
                    .ok_or_else(|| {
                        Expected::missing("R", "R: the descriptor of a device before its reports")
                    })?
                    .report(t_us, &report)
            }
            _ => Ok(()),
        }
    }

    /// The contacts of the touchscreen among the devices.
    fn import(&mut self, name: &str, options: &ImportOptions) -> Result<Imported, ImportFault> {
        let mut devices: Vec<Device> = std::mem::take(&mut self.devices).into_values().collect();
        let candidates: Vec<Candidate> = devices.iter().map(Device::candidate).collect();
        let (chosen, warning) = choose(&candidates)?;
        let device = devices.swap_remove(chosen);
        let mut warnings: Vec<String> = self
            .torn
            .map(|line| format!("line {line}: torn, left out"))
            .into_iter()
            .collect();
        if options.range.is_some() {
            warnings.push("--range left out: the descriptor tells it".to_owned());
        }
        let (title, size_mm) = (device.title(name), device.size_mm.ok_or(ImportFault::NoSize)?);
        let frames = device.finish(&mut warnings);
        warnings.extend(warning);
        Ok(Imported {
            title,
            size_mm,
            frames,
            warnings,
        })
    }
}

/// A device with what it did.
#[derive(Default)]
struct Device {
    name: String,
    /// Maker and product.
    id: (u16, u16),
    descriptor: Option<Descriptor>,
    size_mm: Option<DVec2>,
    span: Span,
    touch: Option<Touch>,
}

impl Device {
    fn describe(&mut self, descriptor: Descriptor, size_mm: Option<DVec2>) -> Result<(), ImportFault> {
        if self.descriptor.is_some() {
            return Err(Expected::new("R", "one descriptor for each device", &Value::from("another")).into());
        }
        if let Ok(report) = &descriptor.touch {
            self.size_mm = size_mm.or_else(|| report.physical_mm());
        }
        self.descriptor = Some(descriptor);
        Ok(())
    }

    fn report(&mut self, t_us: u64, bytes: &[u8]) -> Result<(), ImportFault> {
        self.span.advance(t_us)?;
        // Only now is it known whose the device is: `I:` stands after `R:`.
        if self.touch.is_none()
            && let Some(descriptor) = &self.descriptor
        {
            self.touch = Touch::new(descriptor, self.id, self.size_mm);
        }
        if let Some(touch) = &mut self.touch {
            touch.report(t_us, bytes);
        }
        Ok(())
    }

    fn candidate(&self) -> Candidate {
        let kind = match self.descriptor.as_ref().map(|descriptor| &descriptor.touch) {
            Some(Ok(_)) => "touchscreen",
            Some(Err(Refusal::Touchpad)) => "touchpad",
            Some(Err(Refusal::Pen)) => "pen",
            Some(Err(Refusal::Mouse)) => "mouse",
            Some(Err(Refusal::NoPositions)) => "touchscreen without positions",
            Some(Err(Refusal::NoDigitizer)) | None => "device",
        };
        Candidate {
            name: format!("{kind} {:?}", self.name),
            touched: (kind == "touchscreen")
                .then(|| self.touch.as_ref().map_or(0, |touch| touch.frames.len())),
        }
    }

    fn title(&self, name: &str) -> String {
        super::title(Some(self.name.as_str()).filter(|name| !name.is_empty()), name)
    }

    fn finish(self, warnings: &mut Vec<String>) -> Vec<InputFrame> {
        let end_us = self.span.end_us();
        self.touch
            .map_or_else(Vec::new, |touch| touch.finish(end_us, warnings))
    }
}

/// What a touchscreen sent, as contacts.
struct Touch {
    decoder: Decoder,
    tracker: Tracker,
    /// When the last report came, µs.
    heard_us: u64,
    /// How often a contact went down under each id.
    downs: BTreeMap<u64, u32>,
    /// The frames so far, and when the first was, µs.
    frames: Vec<InputFrame>,
    start_us: Option<u64>,
    events: Vec<ContactEvent>,
}

impl Touch {
    fn new(descriptor: &Descriptor, (vid, pid): (u16, u16), size_mm: Option<DVec2>) -> Option<Self> {
        let most = descriptor.features.max_contacts(None);
        let quirks = Quirks::choose(vid, pid, descriptor, most);
        let decoder = Decoder::new(descriptor, quirks, most, size_mm).ok()?;
        let map = DAffine2::from_scale(size_mm.unwrap_or(DVec2::ONE));
        Some(Self {
            decoder,
            tracker: Tracker::new(Source::File, 0, map),
            heard_us: 0,
            downs: BTreeMap::new(),
            frames: Vec::new(),
            start_us: None,
            events: Vec::new(),
        })
    }

    fn report(&mut self, t_us: u64, bytes: &[u8]) {
        self.wait(t_us);
        self.heard_us = t_us;
        if let Some(frame) = self.decoder.decode(bytes, t_us) {
            self.tracker.frame(frame.touching, &mut self.events);
            self.push(t_us);
        }
    }

    /// No report comes until `t_us`: a live table would notice a moment after the last one, and where the device is
    /// known never to be silent while it is touched, after such a silence.
    fn wait(&mut self, t_us: u64) {
        let silence_us = self.decoder.habit().silence_us();
        for wait_us in [Some(MOMENT_US), silence_us.map(|silence_us| silence_us + 1)] {
            let Some(now_us) = wait_us.map(|wait_us| self.heard_us.saturating_add(wait_us)) else {
                continue;
            };
            if now_us < t_us
                && let Some(frame) = self.decoder.tick(now_us)
            {
                self.tracker.frame(frame.touching, &mut self.events);
                self.push(now_us);
            }
        }
    }

    /// Keeps what happened. Each id counts its own contacts, as a gesture file does.
    fn push(&mut self, t_us: u64) {
        if self.events.is_empty() {
            return;
        }
        let mut events = std::mem::take(&mut self.events);
        for event in &mut events {
            let downs = self.downs.entry(event.contact.key.id).or_default();
            if event.phase == Phase::Down {
                *downs += 1;
            }
            event.contact.key.generation = downs.saturating_sub(1);
        }
        events.sort_by_key(|event| (event.phase.order(), event.contact.key));
        let start_us = *self.start_us.get_or_insert(t_us);
        self.frames.push(InputFrame {
            t_us: t_us - start_us,
            events,
            commands: Vec::new(),
        });
    }

    fn finish(mut self, end_us: u64, warnings: &mut Vec<String>) -> Vec<InputFrame> {
        self.tracker.cancel_all(&mut self.events);
        let down = self.events.len() as u64;
        self.push(end_us);
        let decoder: DecoderCounts = self.decoder.counts();
        let tracker = self.tracker.counts();
        let counted = [
            (decoder.short, "report(s) left out: too short"),
            (decoder.torn, "frame(s) cut off by another"),
            (
                decoder.orphans,
                "report(s) left out: the beginning of their frame is missing",
            ),
            (
                decoder.no_contact + tracker.no_place,
                "contact(s) left out: no place on a table",
            ),
            (
                decoder.over_cap + tracker.over_cap,
                "contact(s) left out: more than can be down",
            ),
            (
                decoder.not_seen + decoder.silent,
                "contact(s) that the device forgot to lift, lifted",
            ),
            (down, "contact(s) still down at the end, cancelled"),
        ];
        warnings.extend(
            counted
                .iter()
                .filter(|(count, _)| *count > 0)
                .map(|(count, what)| format!("{count} {what}")),
        );
        self.frames
    }
}

/// `len b0 b1 …`: a length in decimal and that many bytes in hexadecimal.
fn sized_bytes(field: &str, text: &str) -> Result<Vec<u8>, Expected> {
    let whole = || {
        let what = format!("{field}: a length and that many bytes in hexadecimal");
        Expected::new(field, what, &Value::from(text))
    };
    let mut words = text.split_whitespace();
    let count: usize = words
        .next()
        .and_then(|word| word.parse().ok())
        .ok_or_else(whole)?;
    let byte = |word: &str| {
        let plain = word.len() == 2 && word.bytes().all(|b| b.is_ascii_hexdigit());
        plain.then(|| u8::from_str_radix(word, 16).ok()).flatten()
    };
    let bytes: Vec<u8> = words.map(byte).collect::<Option<_>>().ok_or_else(whole)?;
    if bytes.len() == count {
        Ok(bytes)
    } else {
        Err(whole())
    }
}

/// `bus vendor product`, hexadecimal: maker and product.
fn identity(text: &str) -> Result<(u16, u16), Expected> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let number = |word: &str| u16::from_str_radix(word, 16).ok();
    match words[..] {
        [_, vendor, product] => number(vendor).zip(number(product)),
        _ => None,
    }
    .ok_or_else(|| Expected::new("I", "I: bus vendor product", &Value::from(text)))
}
