//! Recordings of `evemu-record`.
//!
//! A recording is a text of lines: `#` comments, the device's name and axes (`N:`, `A:`), and events
//! (`E: sec.usec type code value`, type and code hexadecimal) of one of the kernel's two multi-touch protocols.
//!
//! The `A:` lines 35 and 36 give the range of the positions, their resolution (units per mm) the size; old recorders
//! write the resolution only into the comment that describes the axis.

use std::io::Read;

use serde_json::Value;

use super::evdev::{Axis, Event, Recording};
use super::lines::Lines;
use super::time::micros;
use super::{ImportError, ImportFault, ImportOptions, Imported};
use crate::gesture::json::Expected;

/// Reads a recording; `name` stands for it in errors, and in the title where the device has no name. `options` win
/// over what the recording says about itself.
///
/// With protocol B ids are slots; with protocol A the contacts are matched from frame to frame. A contact lands when
/// both its coordinates are known; what is down at the end is cancelled.
///
/// # Errors
/// Anything but a multi-touch recording with known range and size, by line.
pub fn import_evemu<R: Read>(
    source: R,
    name: &str,
    options: &ImportOptions,
) -> Result<Imported, ImportError> {
    let mut lines = Lines::new(source);
    let mut recording = Recording::default();
    if let Err(fault) = read(&mut lines, &mut recording) {
        return Err(fault.at(name, lines.count));
    }
    let mut line = lines.count;
    recording
        .import(name, options, &mut line)
        .map_err(|fault| fault.at(name, line))
}

fn read<R: Read>(lines: &mut Lines<R>, recording: &mut Recording) -> Result<(), ImportFault> {
    while let Some(line) = lines.next()? {
        let (parsed, torn) = (Line::parse(&line.text), line.torn);
        match parsed {
            Ok(Line::Nothing) => {}
            Ok(Line::Name(name)) => recording.name(name),
            Ok(Line::Comment(text)) => recording.comment(&text),
            Ok(Line::Axis(code, axis)) => recording.axis(code, axis),
            Ok(Line::Event(event)) => recording.event(event, lines.count)?,
            Err(_) if torn => recording.torn(lines.count),
            Err(fault) => return Err(fault.into()),
        }
    }
    Ok(())
}

/// What a line says.
#[derive(Clone, Debug, PartialEq)]
enum Line {
    /// Nothing of interest: identity, properties, key masks, lamps, switches, or an empty line.
    Nothing,
    /// `N:` the device's name.
    Name(String),
    /// `#`, with what follows it.
    Comment(String),
    /// `A:` an absolute axis: its code and range.
    Axis(u16, Axis),
    /// `E:` an event.
    Event(Event),
}

impl Line {
    fn parse(text: &str) -> Result<Self, Expected> {
        let text = text.trim();
        if let Some(comment) = text.strip_prefix('#') {
            return Ok(Self::Comment(comment.to_owned()));
        }
        let Some((kind, rest)) = text.split_once(':') else {
            return if text.is_empty() {
                Ok(Self::Nothing)
            } else {
                Err(unknown(text))
            };
        };
        match kind {
            "N" => Ok(match rest.trim() {
                "" => Self::Nothing,
                name => Self::Name(name.to_owned()),
            }),
            "I" | "P" | "B" | "L" | "S" => Ok(Self::Nothing),
            "A" => axis(uncommented(rest)),
            "E" => event(uncommented(rest)),
            _ => Err(unknown(text)),
        }
    }
}

fn unknown(text: &str) -> Expected {
    Expected::new(
        "line",
        "N:, I:, P:, B:, A:, L:, S:, E: or # of an evemu recording",
        &Value::from(text),
    )
}

/// Recorders name every event in a comment behind it.
fn uncommented(rest: &str) -> &str {
    rest.split('#').next().unwrap_or_default()
}

fn axis(rest: &str) -> Result<Line, Expected> {
    let whole = || Expected::new("A", "A: code min max fuzz flat [resolution]", &Value::from(rest));
    let fields: Vec<&str> = rest.split_whitespace().collect();
    let (code, numbers) = fields.split_first().ok_or_else(whole)?;
    let code = hexadecimal("A: code", code)?;
    let numbers: Vec<i32> = numbers
        .iter()
        .map(|text| decimal("A", text))
        .collect::<Result<_, _>>()?;
    let (min, max, resolution) = match numbers[..] {
        [min, max, _, _] => (min, max, None),
        [min, max, _, _, resolution] => (min, max, Some(resolution)),
        _ => return Err(whole()),
    };
    Ok(Line::Axis(
        code,
        Axis {
            min: Some(min),
            max: Some(max),
            resolution,
        },
    ))
}

fn event(rest: &str) -> Result<Line, Expected> {
    let mut fields = rest.split_whitespace();
    let mut next = || fields.next();
    let (Some(time), Some(kind), Some(code), Some(value), None) = (next(), next(), next(), next(), next())
    else {
        return Err(Expected::new(
            "E",
            "E: sec.usec type code value",
            &Value::from(rest),
        ));
    };
    Ok(Line::Event(Event {
        t_us: micros(time)?,
        kind: hexadecimal("E: type", kind)?,
        code: hexadecimal("E: code", code)?,
        value: decimal("E: value", value)?,
    }))
}

fn hexadecimal(field: &str, text: &str) -> Result<u16, Expected> {
    Some(text)
        .filter(|text| text.bytes().all(|b| b.is_ascii_hexdigit()))
        .and_then(|text| u16::from_str_radix(text, 16).ok())
        .ok_or_else(|| {
            Expected::new(
                field,
                "a hexadecimal number of at most 16 bits",
                &Value::from(text),
            )
        })
}

fn decimal(field: &str, text: &str) -> Result<i32, Expected> {
    text.parse()
        .map_err(|_| Expected::new(field, "a whole number of at most 32 bits", &Value::from(text)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::import::evdev::codes::{ABS_MT_POSITION_X, ABS_MT_TRACKING_ID, EV_ABS};

    #[test]
    fn events_have_hexadecimal_codes_and_padded_decimal_values() {
        let parse = |text| Line::parse(text).unwrap();
        let event = |t_us, kind, code, value| {
            Line::Event(Event {
                t_us,
                kind,
                code,
                value,
            })
        };
        assert_eq!(
            parse("E: 1369413382.137926 0003 0039 -001\t# EV_ABS / ABS_MT_TRACKING_ID   -1\n"),
            event(1_369_413_382_137_926, EV_ABS, ABS_MT_TRACKING_ID, -1)
        );
        assert_eq!(
            parse("E: 0.000001 0003 0035 0605\r\n"),
            event(1, EV_ABS, ABS_MT_POSITION_X, 605)
        );
        for bad in [
            "E: 1.5 0003 0035 1",
            "E: -1.000000 0003 0035 1",
            "E: 1.000000 0003 0035",
            "E: 1.000000 0003 0035 1 1",
            "E: 1.000000 00g3 0035 1",
            "E: 1.000000 0003 +35 1",
            "E: 1.000000 0003 0035 99999999999",
            "E: 99999999999999999999.000000 0003 0035 1",
            "E:",
            "Q: 1",
            "nonsense",
        ] {
            assert!(Line::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn axes_may_have_a_resolution() {
        let parse = |text| match Line::parse(text) {
            Ok(Line::Axis(code, axis)) => Some((code, axis.min, axis.max, axis.resolution)),
            _ => None,
        };
        assert_eq!(
            parse("A: 35 -5 1279 0 0"),
            Some((0x35, Some(-5), Some(1279), None))
        );
        assert_eq!(
            parse("A: 36 0 767 0 0 10"),
            Some((0x36, Some(0), Some(767), Some(10)))
        );
        for bad in ["A:", "A: 35", "A: 35 0 1", "A: 35 0 1 2 3 4 5", "A: 35 0 x 0 0"] {
            assert!(Line::parse(bad).is_err(), "{bad}");
        }
    }
}
