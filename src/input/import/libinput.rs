//! Recordings of `libinput record`: YAML with one or several devices, each with its description and its events.
//!
//! ```text
//! version: 1
//! ndevices: 1
//! devices:
//! - node: /dev/input/event4
//!   evdev:
//!     name: "Touch table"
//!     absinfo:
//!       53: [0, 32767, 0, 0, 27]
//!     properties: [1]
//!   udev:
//!     properties:
//!     - ID_INPUT_TOUCHSCREEN=1
//!   events:
//!   - evdev:
//!     - [  0,      0,   3,  57,      45] # EV_ABS / ABS_MT_TRACKING_ID
//!     - [  0,      0,   0,   0,       0] # ------------ SYN_REPORT (0) ----------
//! ```
//!
//! The YAML is read as a stream of events: a recording of any length takes no more memory than its contacts. Of several
//! devices the touchscreen counts, and of several touchscreens the one that was touched most.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::Read;
use std::vec;

use saphyr_parser::{BufferedInput, Event as Node, Parser, ScalarStyle};
use serde_json::Value;

use super::devices::{Candidate, choose};
use super::evdev::codes::{ABS_MT_POSITION_X, ABS_MT_POSITION_Y};
use super::evdev::{Axis, Event, Recording};
use super::lines::Lines;
use super::{ImportError, ImportFault, ImportOptions, Imported};
use crate::gesture::json::Expected;

/// Deepest nesting that is followed: what the tool writes has six levels.
const MAX_DEPTH: usize = 32;

// Linux kernel, include/uapi/linux/input-event-codes.h.
const INPUT_PROP_POINTER: i64 = 0;
const INPUT_PROP_DIRECT: i64 = 1;

/// Reads a recording; `name` stands for it in errors, and in the title where the device has no name. `options` win
/// over what the recording says about itself.
///
/// # Errors
/// Anything but version 1 with a touchscreen of several fingers, of known range and size, by line.
pub fn import_libinput<R: Read>(
    source: R,
    name: &str,
    options: &ImportOptions,
) -> Result<Imported, ImportError> {
    let input = Input::default();
    let chars = Chars {
        lines: Lines::new(source),
        line: Vec::new().into_iter(),
        input: &input,
    };
    let mut yaml = Yaml {
        parser: Parser::new_from_iter(chars),
        input: &input,
        line: 1,
        depth: 0,
    };
    let devices = match yaml.recording() {
        Ok(devices) => devices,
        Err(fault) => return Err(fault.at(name, yaml.line)),
    };
    let mut line = yaml.line;
    import(devices, name, options, &input, &mut line).map_err(|fault| fault.at(name, line))
}

/// The contacts of the touchscreen among the devices.
fn import(
    mut devices: Vec<Device>,
    name: &str,
    options: &ImportOptions,
    input: &Input,
    line: &mut usize,
) -> Result<Imported, ImportFault> {
    let candidates: Vec<Candidate> = devices.iter().map(Device::candidate).collect();
    let (chosen, warning) = choose(&candidates)?;
    let mut device = devices.swap_remove(chosen);
    if let Some(torn) = input.torn.take() {
        device.recording.torn(torn);
    }
    *line = device.line;
    let mut imported = device.recording.import(name, options, line)?;
    imported.warnings.extend(warning);
    Ok(imported)
}

/// What a device is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Touchscreen,
    Touchpad,
    Other,
}

/// What tells the kind of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Mark {
    /// It has axes of a contact's position.
    MultiTouch,
    /// The kernel: fingers are on the picture.
    Direct,
    /// The kernel: fingers are beside it.
    Pointer,
    /// udev: it is a touchscreen.
    Touchscreen,
    /// udev: it is a touchpad.
    Touchpad,
}

/// A device with what it did.
#[derive(Debug, Default)]
struct Device {
    /// The line on which it begins.
    line: usize,
    node: String,
    name: String,
    marks: BTreeSet<Mark>,
    recording: Recording,
}

impl Device {
    fn kind(&self) -> Kind {
        let is = |mark| self.marks.contains(&mark);
        let on_picture = is(Mark::Direct) || is(Mark::Touchscreen);
        if is(Mark::Touchpad) || (is(Mark::Pointer) && !on_picture) {
            Kind::Touchpad
        } else if is(Mark::MultiTouch) || is(Mark::Touchscreen) {
            Kind::Touchscreen
        } else {
            Kind::Other
        }
    }

    fn candidate(&self) -> Candidate {
        let (kind, touched) = match self.kind() {
            Kind::Touchscreen => ("touchscreen", Some(self.recording.moments())),
            Kind::Touchpad => ("touchpad", None),
            Kind::Other => ("device", None),
        };
        Candidate {
            name: format!("{kind} {:?} ({})", self.name, self.node.escape_debug()),
            touched,
        }
    }
}

/// What the characters' source has to say beside them.
#[derive(Default)]
struct Input {
    fault: RefCell<Option<ImportFault>>,
    /// The last line, if it was torn: it is left out.
    torn: RefCell<Option<usize>>,
}

/// The characters of a recording, line by line.
struct Chars<'a, R> {
    lines: Lines<R>,
    line: vec::IntoIter<char>,
    input: &'a Input,
}

impl<R: Read> Iterator for Chars<'_, R> {
    type Item = char;

    fn next(&mut self) -> Option<char> {
        loop {
            if let Some(char) = self.line.next() {
                return Some(char);
            }
            match self.lines.next() {
                Ok(Some(line)) if !line.torn => {
                    self.line = line.text.chars().collect::<Vec<_>>().into_iter();
                }
                Ok(Some(_)) => {
                    self.input.torn.replace(Some(self.lines.count));
                }
                Ok(None) => return None,
                Err(fault) => {
                    self.input.fault.replace(Some(fault));
                    return None;
                }
            }
        }
    }
}

/// Follows what the tool writes, and skips the rest.
struct Yaml<'a, R: Read> {
    parser: Parser<'a, BufferedInput<Chars<'a, R>>>,
    input: &'a Input,
    /// The line of what was read last.
    line: usize,
    depth: usize,
}

impl<'a, R: Read> Yaml<'a, R> {
    fn next(&mut self) -> Result<Node<'a>, ImportFault> {
        let next = self.parser.next_event();
        // The source's fault looks like an early end.
        if let Some(fault) = self.input.fault.take() {
            return Err(fault);
        }
        let (node, span) = next
            .ok_or_else(|| wanted("a recording with an end"))?
            .map_err(|error| {
                self.line = error.marker().line();
                wanted(&format!("YAML ({})", error.info().escape_debug()))
            })?;
        self.line = span.start.line();
        match node {
            Node::Alias(_) => return Err(wanted("no aliases")),
            Node::SequenceStart(..) | Node::MappingStart(..) => self.depth += 1,
            Node::SequenceEnd | Node::MappingEnd => self.depth -= 1,
            _ => {}
        }
        if self.depth > MAX_DEPTH {
            return Err(wanted(&format!("at most {MAX_DEPTH} levels")));
        }
        Ok(node)
    }

    /// Leaves out the rest of a node.
    fn skip(&mut self, first: &Node<'_>) -> Result<(), ImportFault> {
        if matches!(first, Node::SequenceStart(..) | Node::MappingStart(..)) {
            let outside = self.depth - 1;
            while self.depth > outside {
                self.next()?;
            }
        }
        Ok(())
    }

    /// Reads a mapping: `each` gets key and beginning of the value. An empty value stands for an empty mapping.
    fn mapping(
        &mut self,
        first: &Node<'_>,
        what: &str,
        mut each: impl FnMut(&mut Self, &str, Node<'a>) -> Result<(), ImportFault>,
    ) -> Result<(), ImportFault> {
        match first {
            Node::MappingStart(..) => {}
            first if is_empty(first) => return Ok(()),
            _ => return Err(wanted(what)),
        }
        loop {
            match self.next()? {
                Node::MappingEnd => return Ok(()),
                Node::Scalar(key, ..) => {
                    let value = self.next()?;
                    each(self, &key, value)?;
                }
                _ => return Err(wanted(what)),
            }
        }
    }

    /// Reads a list: `each` gets the beginning of each item. An empty value stands for an empty list.
    fn list(
        &mut self,
        first: &Node<'_>,
        what: &str,
        mut each: impl FnMut(&mut Self, Node<'a>) -> Result<(), ImportFault>,
    ) -> Result<(), ImportFault> {
        match first {
            Node::SequenceStart(..) => {}
            first if is_empty(first) => return Ok(()),
            _ => return Err(wanted(what)),
        }
        loop {
            match self.next()? {
                Node::SequenceEnd => return Ok(()),
                item => each(self, item)?,
            }
        }
    }

    /// Reads a list of `N` numbers.
    fn numbers<const N: usize>(&mut self, first: &Node<'_>, what: &str) -> Result<[i64; N], ImportFault> {
        let mut numbers = [0; N];
        let mut count = 0;
        self.list(first, what, |_, item| {
            *numbers.get_mut(count).ok_or_else(|| wanted(what))? = number(&item, what)?;
            count += 1;
            Ok(())
        })?;
        if count == N {
            Ok(numbers)
        } else {
            Err(wanted(what))
        }
    }

    /// The whole recording.
    fn recording(&mut self) -> Result<Vec<Device>, ImportFault> {
        let mut devices = Vec::new();
        let first = loop {
            match self.next()? {
                Node::StreamStart | Node::DocumentStart(_) => {}
                first => break first,
            }
        };
        self.mapping(
            &first,
            "version:, devices: of libinput record",
            |yaml, key, value| match key {
                "version" => match number(&value, "version: 1")? {
                    1 => Ok(()),
                    _ => Err(wanted("version: 1")),
                },
                "devices" => yaml.list(&value, "a list of devices", |yaml, item| {
                    let mut device = Device {
                        line: yaml.line,
                        ..Device::default()
                    };
                    yaml.device(&item, &mut device)?;
                    devices.push(device);
                    Ok(())
                }),
                _ => yaml.skip(&value),
            },
        )?;
        Ok(devices)
    }

    fn device(&mut self, first: &Node<'_>, device: &mut Device) -> Result<(), ImportFault> {
        self.mapping(
            first,
            "a device: node:, evdev:, events:",
            |yaml, key, value| match key {
                "node" => {
                    device.node = text(&value, "node: a device file")?;
                    Ok(())
                }
                "evdev" => yaml.description(&value, device),
                "udev" => yaml.mapping(&value, "udev: properties:", |yaml, key, value| match key {
                    "properties" => yaml.list(&value, "a list of NAME=VALUE", |_, item| {
                        match text(&item, "NAME=VALUE")?.as_str() {
                            "ID_INPUT_TOUCHSCREEN=1" => _ = device.marks.insert(Mark::Touchscreen),
                            "ID_INPUT_TOUCHPAD=1" => _ = device.marks.insert(Mark::Touchpad),
                            _ => {}
                        }
                        Ok(())
                    }),
                    _ => yaml.skip(&value),
                }),
                "events" => yaml.list(&value, "a list of events", |yaml, item| {
                    yaml.mapping(&item, "evdev: of an event", |yaml, key, value| match key {
                        "evdev" => yaml.list(&value, EVENT, |yaml, item| {
                            let event = event(yaml.numbers(&item, EVENT)?)?;
                            device.recording.event(event, yaml.line)
                        }),
                        _ => yaml.skip(&value),
                    })
                }),
                _ => yaml.skip(&value),
            },
        )
    }

    /// What the kernel says about the device.
    fn description(&mut self, first: &Node<'_>, device: &mut Device) -> Result<(), ImportFault> {
        self.mapping(first, "evdev: name:, absinfo:", |yaml, key, value| match key {
            "name" => {
                device.name = text(&value, "name: a text")?;
                if !device.name.is_empty() {
                    device.recording.name(device.name.clone());
                }
                Ok(())
            }
            "absinfo" => yaml.mapping(&value, AXIS, |yaml, key, value| {
                let code = key.parse().map_err(|_| wanted(AXIS))?;
                let [min, max, _, _, resolution] = yaml.numbers(&value, AXIS)?.map(whole);
                if matches!(code, ABS_MT_POSITION_X | ABS_MT_POSITION_Y) {
                    device.marks.insert(Mark::MultiTouch);
                }
                let axis = Axis {
                    min: Some(min?),
                    max: Some(max?),
                    resolution: Some(resolution?),
                };
                device.recording.axis(code, axis);
                Ok(())
            }),
            "properties" => yaml.list(&value, "a list of properties", |_, item| {
                match number(&item, "a list of properties")? {
                    INPUT_PROP_POINTER => _ = device.marks.insert(Mark::Pointer),
                    INPUT_PROP_DIRECT => _ = device.marks.insert(Mark::Direct),
                    _ => {}
                }
                Ok(())
            }),
            _ => yaml.skip(&value),
        })
    }
}

const EVENT: &str = "[sec, usec, type, code, value] of an event";
const AXIS: &str = "code: [min, max, fuzz, flat, resolution] of an axis";

fn event([sec, usec, kind, code, value]: [i64; 5]) -> Result<Event, ImportFault> {
    let time = || {
        let usec = u64::try_from(usec).ok().filter(|usec| *usec < 1_000_000)?;
        u64::try_from(sec).ok()?.checked_mul(1_000_000)?.checked_add(usec)
    };
    let small = |number: i64| u16::try_from(number).map_err(|_| wanted(EVENT));
    Ok(Event {
        t_us: time().ok_or_else(|| wanted(EVENT))?,
        kind: small(kind)?,
        code: small(code)?,
        value: whole(value)?,
    })
}

fn whole(number: i64) -> Result<i32, ImportFault> {
    i32::try_from(number).map_err(|_| {
        Expected::new(
            "number",
            "a whole number of at most 32 bits",
            &Value::from(number),
        )
        .into()
    })
}

/// True for a key without a value.
fn is_empty(node: &Node<'_>) -> bool {
    matches!(node, Node::Scalar(text, ScalarStyle::Plain, ..) if matches!(&**text, "" | "~" | "null"))
}

fn text(node: &Node<'_>, what: &str) -> Result<String, ImportFault> {
    match node {
        Node::Scalar(text, ..) => Ok(text.clone().into_owned()),
        _ => Err(wanted(what)),
    }
}

fn number(node: &Node<'_>, what: &str) -> Result<i64, ImportFault> {
    match node {
        Node::Scalar(text, ScalarStyle::Plain, ..) => text
            .parse()
            .map_err(|_| Expected::new("number", what, &Value::from(&**text)).into()),
        _ => Err(wanted(what)),
    }
}

/// The recording does not go on as it should.
fn wanted(what: &str) -> ImportFault {
    ImportFault::Form(what.to_owned())
}
