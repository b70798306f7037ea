//! Values of gesture files: what is expected of a field, what is found, and how numbers are written.

use std::fmt::Write as _;

use glam::DVec2;
use serde_json::{Map, Value};

use super::contact::{MAX_COORDINATE_MM, quantise_mm};

/// Characters of an unexpected value that an error shows.
const SHOWN_CHARS: usize = 40;

/// A field of a gesture file that does not hold what it should.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: expected {expected}, found {found}")]
pub struct Expected {
    /// The field, as a path from the line's object (`surface.size_mm`, `down[2]`).
    pub field: String,
    /// What it should hold, with its range.
    pub expected: String,
    /// What it holds, cut to a few characters.
    pub found: String,
}

impl Expected {
    /// `field` should hold `expected`, but holds `found`.
    pub fn new(field: impl Into<String>, expected: impl Into<String>, found: &Value) -> Self {
        Self {
            field: field.into(),
            expected: expected.into(),
            found: shown(found),
        }
    }

    /// `field` should hold `expected`, but is not there.
    pub fn missing(field: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            field: field.into(),
            expected: expected.into(),
            found: "nothing".to_owned(),
        }
    }
}

/// A value as an error shows it: compact JSON, one line, cut to a few characters.
fn shown(value: &Value) -> String {
    let text = value.to_string();
    let mut chars = text.chars();
    let head: String = chars.by_ref().take(SHOWN_CHARS).collect();
    if chars.next().is_some() {
        head + "…"
    } else {
        head
    }
}

/// A finite number in `min..=max`.
pub(super) fn number(value: &Value, field: &str, what: &str, min: f64, max: f64) -> Result<f64, Expected> {
    value
        .as_f64()
        .filter(|v| (min..=max).contains(v))
        .ok_or_else(|| Expected::new(field, format!("{what} ({min}..={max})"), value))
}

/// A whole number that fits in 64 bits without sign.
pub(super) fn whole(value: &Value, field: &str, what: &str) -> Result<u64, Expected> {
    value.as_u64().ok_or_else(|| Expected::new(field, what, value))
}

/// A text.
pub(super) fn text<'a>(value: &'a Value, field: &str) -> Result<&'a str, Expected> {
    value
        .as_str()
        .ok_or_else(|| Expected::new(field, "a text", value))
}

/// An object.
pub(super) fn object<'a>(
    value: &'a Value,
    field: &str,
    what: &str,
) -> Result<&'a Map<String, Value>, Expected> {
    value.as_object().ok_or_else(|| Expected::new(field, what, value))
}

/// A list.
pub(super) fn list<'a>(value: &'a Value, field: &str, what: &str) -> Result<&'a [Value], Expected> {
    value
        .as_array()
        .map(Vec::as_slice)
        .ok_or_else(|| Expected::new(field, what, value))
}

/// A coordinate or size in millimetres, on the raster of gesture files.
pub(super) fn millimetres(value: &Value, field: &str, min: f64) -> Result<f64, Expected> {
    number(value, field, "millimetres", min, MAX_COORDINATE_MM).map(quantise_mm)
}

/// A table position `[x, y]` in millimetres.
pub(super) fn position(value: &Value, field: &str) -> Result<DVec2, Expected> {
    match list(value, field, "[x, y] in mm")? {
        [x, y] => Ok(DVec2::new(
            millimetres(x, field, -MAX_COORDINATE_MM)?,
            millimetres(y, field, -MAX_COORDINATE_MM)?,
        )),
        _ => Err(Expected::new(field, "[x, y] in mm", value)),
    }
}

/// A text as JSON.
pub(super) fn write_text(out: &mut String, text: &str) {
    let _ = write!(out, "{}", Value::from(text));
}

/// A number in the shorter of its two exact forms (`0.5`, `5e6`).
pub(super) fn write_number(out: &mut String, value: f64) {
    let (plain, scientific) = (format!("{value}"), format!("{value:e}"));
    out.push_str(if scientific.len() < plain.len() {
        &scientific
    } else {
        &plain
    });
}

/// A table position, mm with two decimals.
pub(super) fn write_position(out: &mut String, at: DVec2) {
    let _ = write!(out, "[{:.2},{:.2}]", quantise_mm(at.x), quantise_mm(at.y));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn found_values_are_cut_and_stay_on_one_line() {
        let long = Value::String("a\nb".repeat(100));
        let error = Expected::new("title", "a number", &long);
        assert!(!error.to_string().contains('\n'));
        assert!(error.found.chars().count() == SHOWN_CHARS + 1);
    }

    #[test]
    fn positions_are_two_numbers_within_reach() {
        let at = |json: &str| position(&serde_json::from_str(json).unwrap(), "remove");
        assert_eq!(at("[1.004,-2]"), Ok(DVec2::new(1.0, -2.0)));
        for bad in ["[1]", "[1,2,3]", "[1,\"2\"]", "[1e9,0]", "{}", "null"] {
            assert!(at(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_take_their_shorter_form() {
        for (value, json) in [
            (5e6, "5e6"),
            (0.0, "0"),
            (0.5, "0.5"),
            (1209.6, "1209.6"),
            (1e-30, "1e-30"),
        ] {
            let mut out = String::new();
            write_number(&mut out, value);
            assert_eq!(out, json);
        }
    }
}
