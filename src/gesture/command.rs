//! What visitors do outside the contacts: the closed vocabulary of `do` lines.
//!
//! A `do` is an object with one word of this table, or a list of such objects:
//!
//! | word | value | meaning |
//! |---|---|---|
//! | `tool` | `"push"`, `"edit"`, `"fold"`, `"slice"`, `"view"` | the side takes this tool |
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
//! | `layers` | a text of 1 to 64 characters | the rock layers become this preset |
//! | `view` | `{"lon": degrees, "lat": degrees, "zoom": factor}` | the globe is looked at from there |
//! | `earth` | `true` | the globe starts from Earth |
//! | `scrub` | 0 to 1e9 | the land comes back as it was after these years, and the clock stops |
//!
//! Beside its word an object may name the `side` (`"north"`, `"south"`) and the `contact` (the id in the same file)
//! it came from. Words, tools and modes that are not in the table belong to a newer program: they are ignored and
//! counted. A word of the table with a value of the wrong kind is refused.

use std::fmt::Write as _;

use glam::DVec2;
use serde_json::{Map, Value};

use super::contact::Side;
use super::json::{
    Expected, number, object, position, text, whole, write_number, write_position, write_text,
};

/// Greatest speed of the geological clock, My per second.
pub const MAX_SPEED: f64 = 100.0;

/// Greatest age of a world, years.
pub const MAX_YEARS: f64 = 1e9;

/// Most characters of the name of a layer preset.
pub const MAX_PRESET_CHARS: usize = 64;

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
    /// Take a preset of rock layers.
    Layers(String),
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
    /// Bring back the land as it was after these years, 0 to [`MAX_YEARS`], and stop the clock.
    Scrub(f64),
}

/// Two ends of an arrow on the table, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Where the arrow begins (`add_arrow`), or where its tip was (`edit_arrow`).
    pub from: DVec2,
    /// Where its tip is now.
    pub to: DVec2,
}

/// What fingers on the table do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Hands are plates.
    #[default]
    Push,
    /// Arrows and plates are changed.
    Edit,
    /// Fold ridges are turned and raised.
    Fold,
    /// Two fingers set the ends of a cross-section.
    Slice,
    /// The view is moved.
    View,
}

/// Which world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The flat one.
    #[default]
    Mountain,
    /// The round one.
    Globe,
}

impl Tool {
    const ALL: [Self; 5] = [Self::Push, Self::Edit, Self::Fold, Self::Slice, Self::View];

    /// Its name in gesture files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Push => "push",
            Self::Edit => "edit",
            Self::Fold => "fold",
            Self::Slice => "slice",
            Self::View => "view",
        }
    }

    /// The tool of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|tool| tool.name() == name)
    }
}

impl Mode {
    /// Its name in gesture files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mountain => "mountain",
            Self::Globe => "globe",
        }
    }

    /// The world of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Mountain, Self::Globe]
            .into_iter()
            .find(|mode| mode.name() == name)
    }
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
        "layers" => {
            let name = text(value, field)?;
            if name.is_empty() || name.chars().count() > MAX_PRESET_CHARS {
                let what = format!("a preset's name of 1..={MAX_PRESET_CHARS} characters");
                return Err(Expected::new(field, what, value));
            }
            Some(Action::Layers(name.to_owned()))
        }
        "view" => Some(parse_view(value, field)?),
        "earth" => pressed(Action::Earth)?,
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

fn parse_view(value: &Value, field: &str) -> Result<Action, Expected> {
    let map = object(value, field, "{\"lon\":degrees,\"lat\":degrees,\"zoom\":factor}")?;
    let angle = |key, limit: f64| {
        let (value, path) = member(map, key, field, "degrees")?;
        number(value, &path, "degrees", -limit, limit)
    };
    let (lon, lat) = (angle("lon", 180.0)?, angle("lat", 90.0)?);
    let (value, path) = member(map, "zoom", field, "a factor")?;
    let zoom = number(value, &path, "a factor", ZOOM_RANGE.0, ZOOM_RANGE.1)?;
    Ok(Action::View { lon, lat, zoom })
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
            Self::View { .. } => "view",
            Self::Earth => "earth",
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

    /// Writes the canonical form: the word, then side and contact where known; no spaces; mm with two decimals.
    pub fn write_json(&self, out: &mut String) {
        let _ = write!(out, "{{\"{}\":", self.action.word());
        match &self.action {
            Action::Tool(tool) => write_text(out, tool.name()),
            Action::Mode(mode) => write_text(out, mode.name()),
            Action::Play | Action::Pause | Action::Undo | Action::StartOver | Action::Earth => {
                out.push_str("true");
            }
            Action::Speed(v) | Action::Scrub(v) => write_number(out, *v),
            Action::Remove { at } | Action::FlipFault { at } => write_position(out, *at),
            Action::AddArrow(arrow) | Action::EditArrow(arrow) => {
                out.push_str("{\"from\":");
                write_position(out, arrow.from);
                out.push_str(",\"to\":");
                write_position(out, arrow.to);
                out.push('}');
            }
            Action::Layers(name) => write_text(out, name),
            Action::View { lon, lat, zoom } => {
                for (start, value) in [("{\"lon\":", lon), (",\"lat\":", lat), (",\"zoom\":", zoom)] {
                    out.push_str(start);
                    write_number(out, *value);
                }
                out.push('}');
            }
        }
        match self.side {
            None => {}
            Some(Side::North) => out.push_str(",\"side\":\"north\""),
            Some(Side::South) => out.push_str(",\"side\":\"south\""),
        }
        if let Some(contact) = self.contact {
            let _ = write!(out, ",\"contact\":{contact}");
        }
        out.push('}');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_of_each() -> Vec<Action> {
        let arrow = Arrow {
            from: DVec2::new(1.25, 2.0),
            to: DVec2::new(-3.0, 4.5),
        };
        let mut all: Vec<Action> = Tool::ALL.into_iter().map(Action::Tool).collect();
        all.extend([
            Action::Mode(Mode::Mountain),
            Action::Mode(Mode::Globe),
            Action::Play,
            Action::Pause,
            Action::Speed(0.25),
            Action::Undo,
            Action::Remove { at: arrow.from },
            Action::AddArrow(arrow),
            Action::EditArrow(arrow),
            Action::FlipFault { at: arrow.to },
            Action::StartOver,
            Action::Layers("thin \"skin\"".to_owned()),
            Action::View {
                lon: -12.5,
                lat: 80.0,
                zoom: 1.5,
            },
            Action::Earth,
            Action::Scrub(2.5e6),
        ]);
        all
    }

    fn reread(json: &str) -> Result<Parsed, Expected> {
        parse(&serde_json::from_str(json).unwrap())
    }

    #[test]
    fn every_word_comes_back_as_it_was_written() {
        for (i, action) in one_of_each().into_iter().enumerate() {
            let command = Command {
                action,
                side: [None, Some(Side::North), Some(Side::South)][i % 3],
                contact: [None, Some(u64::MAX)][i % 2],
            };
            let mut json = String::new();
            command.write_json(&mut json);
            let parsed = reread(&json).unwrap();
            assert_eq!(parsed.commands, [command], "{json}");
            assert!(parsed.unknown.is_empty());
        }
    }

    #[test]
    fn unknown_words_and_names_are_counted_and_the_rest_is_done() {
        let parsed = reread(r#"[{"dance":1},{"tool":"rake"},{"tool":"slice","side":"south"}]"#).unwrap();
        assert_eq!(parsed.unknown, ["dance", "tool \"rake\""]);
        assert_eq!(parsed.commands.len(), 1);
        assert_eq!(parsed.commands[0].side, Some(Side::South));
    }

    #[test]
    fn known_words_of_the_wrong_kind_are_refused_by_path() {
        for (json, field) in [
            (r#"{"tool":3}"#, "do.tool"),
            (r#"{"mode":null}"#, "do.mode"),
            (r#"{"play":1}"#, "do.play"),
            (r#"{"pause":false}"#, "do.pause"),
            (r#"{"speed":"fast"}"#, "do.speed"),
            (r#"{"speed":-1}"#, "do.speed"),
            (r#"{"remove":[1]}"#, "do.remove"),
            (r#"{"add_arrow":{"from":[0,0]}}"#, "do.add_arrow.to"),
            (
                r#"{"edit_arrow":{"from":[0,0],"to":[1e30,0]}}"#,
                "do.edit_arrow.to",
            ),
            (r#"{"layers":""}"#, "do.layers"),
            (r#"{"view":{"lon":0,"lat":91,"zoom":1}}"#, "do.view.lat"),
            (r#"{"scrub":1e10}"#, "do.scrub"),
            (r#"{"undo":true,"side":"east"}"#, "do.side"),
            (r#"{"undo":true,"contact":-1}"#, "do.contact"),
            (r#"[{"undo":true},{"play":2}]"#, "do[1].play"),
            ("7", "do"),
        ] {
            assert_eq!(reread(json).unwrap_err().field, field, "{json}");
        }
    }
}
