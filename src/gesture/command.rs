//! What visitors do outside the contacts: the closed vocabulary of `do` lines.
//!
//! A `do` is an object with one word of this table, or a list of such objects:
//!
//! | word | value | meaning |
//! |---|---|---|
//! | `tool` | `"push"`, `"edit"`, `"fold"`, `"slice"`, `"view"`; on the globe the brushes `"land"`, `"sea"` | the side takes this tool |
//! | `mode` | `"mountain"`, `"globe"` | turn to this world |
//! | `play` | `true` | the geological clock goes on |
//! | `pause` | `true` | the geological clock stops |
//! | `speed` | 0 to 100 | My of model time per second of session time |
//! | `undo` | `true` | land and time from before the side's last push come back |
//! | `remove` | `[x, y]` mm | the plate or arrow there goes (a long press) |
//! | `add_arrow` | `{"from": [x, y], "to": [x, y]}` mm | an arrow is added to the plate under `from` |
//! | `edit_arrow` | `{"from": [x, y], "to": [x, y]}` mm | the arrow tip at `from` is dragged to `to` |
//! | `flip_fault` | `[x, y]` mm | the fault there leans the other way |
//! | `start_over` | `true` | the land starts afresh, from the seed |
//! | `layers` | a text of 1 to 64 characters | the rock under the land becomes this preset |
//! | `pile` | the text of a pile's TOML file | the rock under the land becomes this pile |
//! | `turn_folds` | 2 to 64 positions `[[x, y], …]` mm | fold ridges near this line turn to its direction |
//! | `raise_folds` | `{"path": positions, "by": 0 to 3}` | folds along the line grow by this factor (1: as they would) |
//! | `slice` | `{"from": [x, y], "to": [x, y]}` mm | the cross-section runs between these ends |
//! | `freeze_slice` | `true` or `false` | the cross-section stays as it is, or follows the land again |
//! | `label_slice` | `{"at": 0 to 1, "text": 1 to 64 characters}` | a note at this part of the cross-section's length |
//! | `close_slice` | `true` | the cross-section and its notes go |
//! | `view` | `{"lon": degrees, "lat": degrees, "zoom": factor}` | the globe is looked at from there |
//! | `earth` | `true` | the globe starts from Earth |
//! | `planet` | `{"plates": 1 to 512, "continental": 0 to 1, "seed": whole number}` | the globe starts from such a random planet |
//! | `cut` | 2 to 64 places `[[lat, lon], …]`, degrees | the plate below this line tears along it |
//! | `paint` | `{"at": [lat, lon], "radius": 0 to 90 degrees, "crust": "continent"` or `"ocean"}` | the crust around the place becomes this |
//! | `scrub` | 0 to 1e9 | the land comes back as it was after these years, and the clock stops |
//!
//! Beside its word an object may name the `side` (`"north"`, `"south"`) and the `contact` (the id in the same file)
//! it came from. Words, tools and modes that are not in the table belong to a newer program: they are ignored and
//! counted. A word of the table with a value of the wrong kind is refused.

mod choice;
mod globe;
mod write;

pub use choice::{Mode, Tool};
pub use globe::{MAX_BRUSH_DEG, MAX_PLATES, Paint, Place};

use std::sync::Arc;

use glam::DVec2;
use serde_json::{Map, Value};

use super::contact::Side;
use super::json::{Expected, number, object, position, text, whole};
use crate::rock::Stratigraphy;

/// Greatest speed of the geological clock, My per second.
pub const MAX_SPEED: f64 = 100.0;

/// Greatest age of a world, years.
pub const MAX_YEARS: f64 = 1e9;

/// Most characters of the name of a layer preset and of a note.
pub const MAX_TEXT_CHARS: usize = 64;

/// Fewest and most positions of a line drawn along folds.
pub const PATH_POINTS: (usize, usize) = (2, 64);

/// Greatest factor on the height of folds.
pub const MAX_RAISE: f64 = 3.0;

/// How near to a tip or a fault an edit must be, table mm: the width of a finger and a bit.
pub const REACH_MM: f64 = 25.0;

/// Least and greatest magnification of the globe.
pub const ZOOM_RANGE: (f64, f64) = (0.01, 100.0);

/// One `do` of a gesture file.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// What is done.
    pub action: Action,
    /// The side of the table it came from.
    pub side: Option<Side>,
    /// The contact it came from: its source's id, as in the file.
    pub contact: Option<u64>,
}

/// The closed vocabulary.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// The side takes a tool.
    Tool(Tool),
    /// Turn to a world.
    Mode(Mode),
    /// Go on.
    Play,
    /// Stop the geological clock.
    Pause,
    /// My of model time per second of session time, 0 to [`MAX_SPEED`].
    Speed(f64),
    /// Bring back land and time from before the side's last push.
    Undo,
    /// Take away the plate or arrow at a place.
    Remove {
        /// Table mm.
        at: DVec2,
    },
    /// Add an arrow to a standing plate.
    AddArrow(Arrow),
    /// Drag the tip of an arrow.
    EditArrow(Arrow),
    /// Let the fault at a place lean the other way.
    FlipFault {
        /// Table mm.
        at: DVec2,
    },
    /// Start the land afresh.
    StartOver,
    /// Lay a preset of rock layers under the land.
    Layers(String),
    /// Lay a pile of rock layers under the land.
    Pile(Arc<Stratigraphy>),
    /// Turn fold ridges to a line.
    TurnFolds {
        /// Table mm, [`PATH_POINTS`] of them.
        path: Vec<DVec2>,
    },
    /// Raise or lower the folds along a line.
    RaiseFolds {
        /// Table mm, [`PATH_POINTS`] of them.
        path: Vec<DVec2>,
        /// Factor on their height, 0 to [`MAX_RAISE`].
        by: f64,
    },
    /// Set the ends of the cross-section.
    Slice(Arrow),
    /// Let the cross-section stay as it is, or follow the land again.
    FreezeSlice(bool),
    /// Put a note on the cross-section.
    LabelSlice {
        /// Part of its length, 0 to 1.
        at: f64,
        /// The note.
        text: String,
    },
    /// Take the cross-section away.
    CloseSlice,
    /// Look at the globe from somewhere.
    View {
        /// Longitude, degrees, −180 to 180.
        lon: f64,
        /// Latitude, degrees, −90 to 90.
        lat: f64,
        /// Magnification; 1 shows the whole globe. In [`ZOOM_RANGE`].
        zoom: f64,
    },
    /// Start the globe from Earth.
    Earth,
    /// Start the globe from a random planet.
    Planet {
        /// Number of plates, 1 to [`MAX_PLATES`].
        plates: u32,
        /// Share of the sphere that is continental, 0 to 1.
        continental: f64,
        /// Everything random follows from it.
        seed: u64,
    },
    /// Tear the plate below a line.
    Cut {
        /// [`PATH_POINTS`] of them.
        path: Vec<Place>,
    },
    /// Make crust continental or oceanic.
    Paint {
        /// Middle of the stroke.
        at: Place,
        /// Radius, degrees, 0 to [`MAX_BRUSH_DEG`].
        radius_deg: f64,
        /// What it becomes.
        paint: Paint,
    },
    /// Bring back the land as it was after these years, 0 to [`MAX_YEARS`], and stop the clock.
    Scrub(f64),
}

/// Two ends of an arrow, or of a cross-section, on the table, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Where it begins (`edit_arrow`: where its tip was).
    pub from: DVec2,
    /// Where it ends (`edit_arrow`: where its tip is now).
    pub to: DVec2,
}

/// What a `do` says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parsed {
    /// The commands, in the order of the list (several words of one object: in alphabetical order).
    pub commands: Vec<Command>,
    /// Words, tools and modes that are not in the table.
    pub unknown: Vec<String>,
}

/// Reads the value of a `do`.
///
/// # Errors
/// A word of the table with a value of the wrong kind or out of range, by its path (`do.speed`).
pub fn parse(value: &Value) -> Result<Parsed, Expected> {
    let mut parsed = Parsed::default();
    if let Value::Array(items) = value {
        for (i, item) in items.iter().enumerate() {
            parse_object(item, &format!("do[{i}]"), &mut parsed)?;
        }
    } else {
        parse_object(value, "do", &mut parsed)?;
    }
    Ok(parsed)
}

fn parse_object(value: &Value, path: &str, parsed: &mut Parsed) -> Result<(), Expected> {
    let words = object(
        value,
        path,
        "an object with a word of the vocabulary, or a list of such objects",
    )?;
    let side = match words.get("side") {
        None => None,
        Some(value) => Some(parse_side(value, &format!("{path}.side"))?),
    };
    let contact = match words.get("contact") {
        None => None,
        Some(value) => Some(whole(
            value,
            &format!("{path}.contact"),
            "a contact id (whole number)",
        )?),
    };
    for (word, value) in words {
        if word == "side" || word == "contact" {
            continue;
        }
        match parse_word(word, value, &format!("{path}.{word}"))? {
            Some(action) => parsed.commands.push(Command {
                action,
                side,
                contact,
            }),
            // The word is known, the name is not.
            None if word == "tool" || word == "mode" => parsed.unknown.push(format!("{word} {value}")),
            None => parsed.unknown.push(word.clone()),
        }
    }
    Ok(())
}

fn parse_side(value: &Value, field: &str) -> Result<Side, Expected> {
    match value.as_str() {
        Some("north") => Ok(Side::North),
        Some("south") => Ok(Side::South),
        _ => Err(Expected::new(field, "\"north\" or \"south\"", value)),
    }
}

/// `None` for words, tools and modes that are not in the table.
fn parse_word(word: &str, value: &Value, field: &str) -> Result<Option<Action>, Expected> {
    let pressed = |action| match value {
        Value::Bool(true) => Ok(Some(action)),
        _ => Err(Expected::new(field, "true", value)),
    };
    Ok(match word {
        "tool" => Tool::from_name(text(value, field)?).map(Action::Tool),
        "mode" => Mode::from_name(text(value, field)?).map(Action::Mode),
        "play" => pressed(Action::Play)?,
        "pause" => pressed(Action::Pause)?,
        "speed" => Some(Action::Speed(number(
            value,
            field,
            "My per second",
            0.0,
            MAX_SPEED,
        )?)),
        "undo" => pressed(Action::Undo)?,
        "remove" => Some(Action::Remove {
            at: position(value, field)?,
        }),
        "add_arrow" => Some(Action::AddArrow(parse_arrow(value, field)?)),
        "edit_arrow" => Some(Action::EditArrow(parse_arrow(value, field)?)),
        "flip_fault" => Some(Action::FlipFault {
            at: position(value, field)?,
        }),
        "start_over" => pressed(Action::StartOver)?,
        "layers" => Some(Action::Layers(short_text(value, field)?)),
        "pile" => {
            let pile = Stratigraphy::parse(text(value, field)?.as_bytes(), "pile")
                .map_err(|error| Expected::new(field, format!("a pile ({error})"), value))?;
            Some(Action::Pile(Arc::new(pile)))
        }
        "turn_folds" => Some(Action::TurnFolds {
            path: parse_path(value, field)?,
        }),
        "raise_folds" => Some(parse_raise(value, field)?),
        "slice" => Some(Action::Slice(parse_arrow(value, field)?)),
        "freeze_slice" => match value {
            Value::Bool(frozen) => Some(Action::FreezeSlice(*frozen)),
            _ => return Err(Expected::new(field, "true or false", value)),
        },
        "label_slice" => Some(parse_label(value, field)?),
        "close_slice" => pressed(Action::CloseSlice)?,
        "view" => Some(globe::parse_view(value, field)?),
        "earth" => pressed(Action::Earth)?,
        "planet" => Some(globe::parse_planet(value, field)?),
        "cut" => Some(Action::Cut {
            path: globe::parse_line(value, field)?,
        }),
        "paint" => Some(globe::parse_paint(value, field)?),
        "scrub" => Some(Action::Scrub(number(value, field, "years", 0.0, MAX_YEARS)?)),
        _ => None,
    })
}

/// The value of `key`, which must be there.
fn member<'a>(
    map: &'a Map<String, Value>,
    key: &str,
    field: &str,
    what: &str,
) -> Result<(&'a Value, String), Expected> {
    let path = format!("{field}.{key}");
    match map.get(key) {
        Some(value) => Ok((value, path)),
        None => Err(Expected::missing(path, what)),
    }
}

fn parse_arrow(value: &Value, field: &str) -> Result<Arrow, Expected> {
    let map = object(value, field, "{\"from\":[x,y],\"to\":[x,y]}")?;
    let end = |key| {
        let (value, path) = member(map, key, field, "[x, y] in mm")?;
        position(value, &path)
    };
    Ok(Arrow {
        from: end("from")?,
        to: end("to")?,
    })
}

fn short_text(value: &Value, field: &str) -> Result<String, Expected> {
    let found = text(value, field)?;
    if found.is_empty() || found.chars().count() > MAX_TEXT_CHARS {
        let what = format!("a text of 1..={MAX_TEXT_CHARS} characters");
        return Err(Expected::new(field, what, value));
    }
    Ok(found.to_owned())
}

fn parse_path(value: &Value, field: &str) -> Result<Vec<DVec2>, Expected> {
    let (least, most) = PATH_POINTS;
    let points = value
        .as_array()
        .filter(|points| (least..=most).contains(&points.len()));
    let points =
        points.ok_or_else(|| Expected::new(field, format!("{least} to {most} positions [x, y]"), value))?;
    let point = |(i, value)| position(value, &format!("{field}[{i}]"));
    points.iter().enumerate().map(point).collect()
}

fn parse_raise(value: &Value, field: &str) -> Result<Action, Expected> {
    let map = object(value, field, "{\"path\":[[x,y],…],\"by\":factor}")?;
    let (points, path_field) = member(map, "path", field, "positions [x, y]")?;
    let path = parse_path(points, &path_field)?;
    let (by, by_field) = member(map, "by", field, "a factor")?;
    let by = number(by, &by_field, "a factor", 0.0, MAX_RAISE)?;
    Ok(Action::RaiseFolds { path, by })
}

fn parse_label(value: &Value, field: &str) -> Result<Action, Expected> {
    let map = object(value, field, "{\"at\":part,\"text\":\"…\"}")?;
    let (at, at_field) = member(map, "at", field, "a part of the length")?;
    let at = number(at, &at_field, "a part of the length", 0.0, 1.0)?;
    let (note, note_field) = member(map, "text", field, "a note")?;
    let text = short_text(note, &note_field)?;
    Ok(Action::LabelSlice { at, text })
}

impl Action {
    /// The word of the table.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Tool(_) => "tool",
            Self::Mode(_) => "mode",
            Self::Play => "play",
            Self::Pause => "pause",
            Self::Speed(_) => "speed",
            Self::Undo => "undo",
            Self::Remove { .. } => "remove",
            Self::AddArrow(_) => "add_arrow",
            Self::EditArrow(_) => "edit_arrow",
            Self::FlipFault { .. } => "flip_fault",
            Self::StartOver => "start_over",
            Self::Layers(_) => "layers",
            Self::Pile(_) => "pile",
            Self::TurnFolds { .. } => "turn_folds",
            Self::RaiseFolds { .. } => "raise_folds",
            Self::Slice(_) => "slice",
            Self::FreezeSlice(_) => "freeze_slice",
            Self::LabelSlice { .. } => "label_slice",
            Self::CloseSlice => "close_slice",
            Self::View { .. } => "view",
            Self::Earth => "earth",
            Self::Planet { .. } => "planet",
            Self::Cut { .. } => "cut",
            Self::Paint { .. } => "paint",
            Self::Scrub(_) => "scrub",
        }
    }
}

impl Command {
    /// An action of nobody in particular.
    pub fn new(action: Action) -> Self {
        Self {
            action,
            side: None,
            contact: None,
        }
    }
}

#[cfg(test)]
mod tests;
