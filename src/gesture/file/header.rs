//! The first line of a gesture file.

use std::fmt::Write as _;

use glam::DVec2;
use serde_json::{Map, Value};

use super::reader::{Fault, time_us};
use super::writer::write_time;
use super::{FORMAT, VERSION};
use crate::gesture::command::{MAX_YEARS, Mode};
use crate::gesture::json::{
    Expected, list, number, object, position, text, whole, write_number, write_position, write_text,
};

/// A table's side is shorter than this, mm.
pub const MAX_SIZE_MM: f64 = 10_000.0;

/// Least and greatest number of terrain nodes.
pub const NODES_RANGE: (u64, u64) = (16, 4_000_000);

/// What a gesture file says about itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// What it shows, in a few words.
    pub title: Option<String>,
    /// Size of the table, mm, each side positive and below [`MAX_SIZE_MM`].
    pub size_mm: DVec2,
    /// The world it starts in.
    pub mode: Mode,
    /// Seed of the land.
    pub seed: Option<u64>,
    /// Years to play, 0 to [`MAX_YEARS`].
    pub years: Option<f64>,
    /// Terrain nodes, in [`NODES_RANGE`].
    pub nodes: Option<u64>,
    /// What a replay should show.
    pub expect: Option<Expectation>,
}

/// What a replay of the file should show; the regression corpus checks it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expectation {
    /// What a person sees, in one sentence.
    pub see: Option<String>,
    /// Places where the land has changed within a second of session time after a moment.
    pub land_changes_at: Vec<LandChange>,
    /// True when the land must stay as it would be without the contacts.
    pub nothing: bool,
}

/// A place and the moment from which its land changes within a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandChange {
    /// Table mm.
    pub at: DVec2,
    /// Session time, µs.
    pub t_us: u64,
}

impl Header {
    /// A header with nothing but a table, in mountain mode.
    pub fn new(size_mm: DVec2) -> Self {
        Self {
            title: None,
            size_mm,
            mode: Mode::default(),
            seed: None,
            years: None,
            nodes: None,
            expect: None,
        }
    }

    /// Reads the object of line 1.
    pub(super) fn from_map(map: &Map<String, Value>) -> Result<Self, Fault> {
        check_format(map)?;
        let optional = |key: &str| map.get(key);
        let mode = match optional("mode") {
            None => Mode::default(),
            Some(value) => value
                .as_str()
                .and_then(Mode::from_name)
                .ok_or_else(|| Expected::new("mode", "\"mountain\" or \"globe\"", value))?,
        };
        let title = optional("title")
            .map(|v| text(v, "title"))
            .transpose()?
            .map(str::to_owned);
        let seed = optional("seed")
            .map(|v| whole(v, "seed", "a whole number below 2^64"))
            .transpose()?;
        let years = optional("years")
            .map(|v| number(v, "years", "years", 0.0, MAX_YEARS))
            .transpose()?;
        let nodes = optional("nodes").map(read_nodes).transpose()?;
        let expect = optional("expect").map(Expectation::from_value).transpose()?;
        Ok(Self {
            title,
            size_mm: read_size(map)?,
            mode,
            seed,
            years,
            nodes,
            expect,
        })
    }

    /// The canonical line, without the newline.
    pub(super) fn write_json(&self, out: &mut String) {
        let Self {
            title,
            size_mm,
            mode,
            seed,
            years,
            nodes,
            expect,
        } = self;
        let _ = write!(out, "{{\"format\":\"{FORMAT}\",\"version\":{VERSION}");
        if let Some(title) = title {
            out.push_str(",\"title\":");
            write_text(out, title);
        }
        out.push_str(",\"surface\":{\"size_mm\":[");
        write_number(out, size_mm.x);
        out.push(',');
        write_number(out, size_mm.y);
        let _ = write!(out, "]}},\"mode\":\"{}\"", mode.name());
        if let Some(seed) = seed {
            let _ = write!(out, ",\"seed\":{seed}");
        }
        if let Some(years) = years {
            out.push_str(",\"years\":");
            write_number(out, *years);
        }
        if let Some(nodes) = nodes {
            let _ = write!(out, ",\"nodes\":{nodes}");
        }
        if let Some(expect) = expect {
            out.push_str(",\"expect\":");
            expect.write_json(out);
        }
        out.push('}');
    }
}

fn check_format(map: &Map<String, Value>) -> Result<(), Fault> {
    let what = format!("\"{FORMAT}\"");
    match map.get("format") {
        Some(Value::String(format)) if format == FORMAT => {}
        Some(other) => return Err(Expected::new("format", what, other).into()),
        None => return Err(Expected::missing("format", what).into()),
    }
    let what = format!("major version {VERSION}");
    let version = map
        .get("version")
        .ok_or_else(|| Expected::missing("version", what.clone()))?;
    match version.as_f64() {
        Some(number) if number.floor() == VERSION as f64 => Ok(()),
        _ => Err(Expected::new("version", what, version).into()),
    }
}

fn read_size(map: &Map<String, Value>) -> Result<DVec2, Expected> {
    let what = format!("[width, height] in mm, both above 0 and below {MAX_SIZE_MM}");
    let field = "surface.size_mm";
    let surface = map
        .get("surface")
        .ok_or_else(|| Expected::missing("surface", "{\"size_mm\":[width, height]}"))?;
    let surface = object(surface, "surface", "{\"size_mm\":[width, height]}")?;
    let value = surface
        .get("size_mm")
        .ok_or_else(|| Expected::missing(field, what.clone()))?;
    let side = |v: &Value| v.as_f64().filter(|v| *v > 0.0 && *v < MAX_SIZE_MM);
    let sides = match value.as_array().map(Vec::as_slice) {
        Some([x, y]) => side(x).zip(side(y)),
        _ => None,
    };
    sides
        .map(DVec2::from)
        .ok_or_else(|| Expected::new(field, what, value))
}

fn read_nodes(value: &Value) -> Result<u64, Expected> {
    let (min, max) = NODES_RANGE;
    value
        .as_u64()
        .filter(|n| (min..=max).contains(n))
        .ok_or_else(|| Expected::new("nodes", format!("a whole number ({min}..={max})"), value))
}

impl Expectation {
    fn from_value(value: &Value) -> Result<Self, Expected> {
        let map = object(value, "expect", "an object")?;
        let see = map
            .get("see")
            .map(|v| text(v, "expect.see"))
            .transpose()?
            .map(str::to_owned);
        let nothing = match map.get("nothing") {
            None => false,
            Some(Value::Bool(nothing)) => *nothing,
            Some(other) => return Err(Expected::new("expect.nothing", "true or false", other)),
        };
        let mut land_changes_at = Vec::new();
        if let Some(value) = map.get("land_changes_at") {
            let what = "a list of [x mm, y mm, t ms]";
            for (i, item) in list(value, "expect.land_changes_at", what)?.iter().enumerate() {
                land_changes_at.push(LandChange::from_value(
                    item,
                    &format!("expect.land_changes_at[{i}]"),
                )?);
            }
            if nothing && !land_changes_at.is_empty() {
                return Err(Expected::new(
                    "expect.land_changes_at",
                    "an empty list where nothing changes",
                    value,
                ));
            }
        }
        Ok(Self {
            see,
            land_changes_at,
            nothing,
        })
    }

    fn write_json(&self, out: &mut String) {
        let Self {
            see,
            land_changes_at,
            nothing,
        } = self;
        out.push('{');
        let mut separator = "";
        if let Some(see) = see {
            out.push_str("\"see\":");
            write_text(out, see);
            separator = ",";
        }
        if !land_changes_at.is_empty() {
            out.push_str(separator);
            out.push_str("\"land_changes_at\":[");
            for (i, change) in land_changes_at.iter().enumerate() {
                if i > 0 {
                    out.push(',');
                }
                write_position(out, change.at);
                out.pop();
                out.push(',');
                write_time(out, change.t_us);
                out.push(']');
            }
            out.push(']');
            separator = ",";
        }
        if *nothing {
            out.push_str(separator);
            out.push_str("\"nothing\":true");
        }
        out.push('}');
    }
}

impl LandChange {
    fn from_value(value: &Value, field: &str) -> Result<Self, Expected> {
        match list(value, field, "[x mm, y mm, t ms]")? {
            [x, y, t] => Ok(Self {
                at: position(&Value::from(vec![x.clone(), y.clone()]), field)?,
                t_us: time_us(t, field)?,
            }),
            _ => Err(Expected::new(field, "[x mm, y mm, t ms]", value)),
        }
    }
}
