//! The one table of keys.

use super::form::{Form, addresses, affine, affine_text};
use super::keys::{Bound, Domain, Key, Value};
use super::{Compute, Corner, Listen, Orientation, Tools};
use crate::gesture::command::Mode;

const fn bound(unit: &'static str, min: f64, max: f64, step: f64) -> Bound {
    Bound {
        unit,
        min,
        max,
        step,
        whole: false,
    }
}

const NODES: Bound = Bound {
    unit: "1",
    min: 1000.0,
    max: 1_000_000.0,
    step: 1000.0,
    whole: true,
};

const PORT: Bound = Bound {
    unit: "1",
    min: 1024.0,
    max: 65_535.0,
    step: 1.0,
    whole: true,
};

/// The first of each pair.
const fn names<T: Copy, const N: usize>(table: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = table[i].0;
        i += 1;
    }
    names
}

const ORIENTATIONS: [&str; 8] = names(&Orientation::ALL);
const CORNERS: [&str; 4] = names(&Corner::ALL);
const SOURCES: [&str; 4] = names(&Listen::ALL);
const COMPUTE: [&str; 3] = names(&Compute::ALL);
const TOOLS: [&str; 3] = names(&Tools::ALL);

fn name_of<T: PartialEq>(table: &[(&'static str, T)], value: &T) -> Value {
    let found = table.iter().find(|(_, v)| v == value);
    Value::Text(found.map_or_else(String::new, |(name, _)| (*name).to_owned()))
}

fn set_named<T: Copy>(table: &[(&'static str, T)], field: &mut T, value: &Value) {
    if let Value::Text(word) = value
        && let Some((_, named)) = table.iter().find(|(name, _)| name == word)
    {
        *field = *named;
    }
}

fn set_number(field: &mut f64, value: &Value) {
    if let Value::Number(number) = value {
        *field = *number;
    }
}

fn number_or(value: Option<f64>) -> Value {
    value.map_or(Value::Word, Value::Number)
}

fn set_number_or(field: &mut Option<f64>, value: &Value) {
    match value {
        Value::Number(number) => *field = Some(*number),
        Value::Word => *field = None,
        Value::Switch(_) | Value::Text(_) => {}
    }
}

fn set_switch(field: &mut bool, value: &Value) {
    if let Value::Switch(on) = value {
        *field = *on;
    }
}

fn path_or(path: Option<&String>) -> Value {
    Value::Text(path.cloned().unwrap_or_default())
}

fn set_path(field: &mut Option<String>, value: &Value) {
    if let Value::Text(path) = value {
        *field = (!path.is_empty()).then(|| path.clone());
    }
}

/// All keys, in the order of the file. Keys of one section stand together, those without one first.
pub const KEYS: &[Key] = &[
    Key {
        section: "",
        name: "mode",
        help: "The world that a fresh table shows.",
        domain: Domain::Choice(&["mountain", "globe"]),
        get: |s| Value::Text(s.mode.name().to_owned()),
        set: |s, v| {
            if let Value::Text(word) = v {
                s.mode = Mode::from_name(word).unwrap_or(s.mode);
            }
        },
    },
    Key {
        section: "table",
        name: "width_mm",
        help: "Width of the picture on the table. Measure it: controls and hands are sized by it.",
        domain: Domain::Number(bound("mm", 200.0, 5000.0, 0.1)),
        get: |s| Value::Number(s.table.width_mm),
        set: |s, v| set_number(&mut s.table.width_mm, v),
    },
    Key {
        section: "table",
        name: "height_mm",
        help: "Height of the picture on the table; \"auto\" takes it from the shape of the window.",
        domain: Domain::NumberOr(bound("mm", 100.0, 5000.0, 0.1), "auto"),
        get: |s| number_or(s.table.height_mm),
        set: |s, v| set_number_or(&mut s.table.height_mm, v),
    },
    Key {
        section: "table",
        name: "orientation",
        help: "How touches are turned (clockwise, degrees) and mirrored to lie under the fingers.",
        domain: Domain::Choice(&ORIENTATIONS),
        get: |s| name_of(&Orientation::ALL, &s.table.orientation),
        set: |s, v| set_named(&Orientation::ALL, &mut s.table.orientation, v),
    },
    Key {
        section: "table",
        name: "calibration",
        help: "What four touches at the staff menu's crosses have shown; empty for none.",
        domain: Domain::Text(Form::Affine),
        get: |s| Value::Text(s.table.calibration.map_or_else(String::new, affine_text)),
        set: |s, v| {
            if let Value::Text(text) = v {
                s.table.calibration = affine(text);
            }
        },
    },
    Key {
        section: "table",
        name: "short_side_km",
        help: "Ground that lies along the short side of the table.",
        domain: Domain::Number(bound("km", 20.0, 500.0, 5.0)),
        get: |s| Value::Number(s.table.short_side_km),
        set: |s, v| set_number(&mut s.table.short_side_km, v),
    },
    Key {
        section: "input",
        name: "source",
        help: "Where touches come from: \"window\", \"hid\", \"tuio\"; \"auto\" takes the best that speaks, never two at once.",
        domain: Domain::Choice(&SOURCES),
        get: |s| name_of(&Listen::ALL, &s.input.source),
        set: |s, v| set_named(&Listen::ALL, &mut s.input.source, v),
    },
    Key {
        section: "input",
        name: "surface_width_mm",
        help: "Width of a raw touchscreen's surface, where it tells none or a wrong one.",
        domain: Domain::NumberOr(bound("mm", 50.0, 5000.0, 0.1), "auto"),
        get: |s| number_or(s.input.surface_mm[0]),
        set: |s, v| set_number_or(&mut s.input.surface_mm[0], v),
    },
    Key {
        section: "input",
        name: "surface_height_mm",
        help: "Its height.",
        domain: Domain::NumberOr(bound("mm", 50.0, 5000.0, 0.1), "auto"),
        get: |s| number_or(s.input.surface_mm[1]),
        set: |s, v| set_number_or(&mut s.input.surface_mm[1], v),
    },
    Key {
        section: "input",
        name: "tuio_port",
        help: "UDP port on which TUIO is heard.",
        domain: Domain::Number(PORT),
        get: |s| Value::Number(s.input.tuio_port.into()),
        set: |s, v| {
            if let Value::Number(port) = v {
                s.input.tuio_port = *port as u16;
            }
        },
    },
    Key {
        section: "input",
        name: "tuio_allow",
        help: "Other machines whose TUIO is heard, in the settings file: addresses with commas between, 0.0.0.0 for all.",
        domain: Domain::Text(Form::Addresses),
        get: |s| {
            let addresses = s.input.tuio_allow.iter().map(ToString::to_string);
            Value::Text(addresses.collect::<Vec<_>>().join(", "))
        },
        set: |s, v| {
            if let Value::Text(text) = v {
                s.input.tuio_allow = addresses(text).unwrap_or_default();
            }
        },
    },
    Key {
        section: "land",
        name: "layers",
        help: "Rock: plain, jura, zagros, andes, southern_alps, digne, or a TOML file (from this folder); after a restart.",
        domain: Domain::Path,
        get: |s| Value::Text(s.land.layers.clone()),
        set: |s, v| {
            if let Value::Text(name) = v {
                s.land.layers.clone_from(name);
            }
        },
    },
    Key {
        section: "kiosk",
        name: "idle_s",
        help: "When nobody has touched for so long, the warning begins.",
        domain: Domain::Number(bound("s", 20.0, 600.0, 5.0)),
        get: |s| Value::Number(s.kiosk.idle_s),
        set: |s, v| set_number(&mut s.kiosk.idle_s, v),
    },
    Key {
        section: "kiosk",
        name: "countdown_s",
        help: "Length of the warning, which any touch ends. Less than 20 s is too short for some visitors.",
        domain: Domain::Number(bound("s", 20.0, 120.0, 5.0)),
        get: |s| Value::Number(s.kiosk.countdown_s),
        set: |s, v| set_number(&mut s.kiosk.countdown_s, v),
    },
    Key {
        section: "kiosk",
        name: "flight_after_s",
        help: "When nobody has touched for so long, the view eases into a slow flight.",
        domain: Domain::Number(bound("s", 5.0, 600.0, 5.0)),
        get: |s| Value::Number(s.kiosk.flight_after_s),
        set: |s, v| set_number(&mut s.kiosk.flight_after_s, v),
    },
    Key {
        section: "kiosk",
        name: "attract",
        help: "The show plays while nobody is there.",
        domain: Domain::Switch,
        get: |s| Value::Switch(s.kiosk.attract),
        set: |s, v| set_switch(&mut s.kiosk.attract, v),
    },
    Key {
        section: "kiosk",
        name: "reset_hours",
        help: "A visit that lasts longer is ended whatever touches the table; \"never\" lets it go on.",
        domain: Domain::NumberOr(bound("h", 0.5, 48.0, 0.5), "never"),
        get: |s| number_or(s.kiosk.reset_hours),
        set: |s, v| set_number_or(&mut s.kiosk.reset_hours, v),
    },
    Key {
        section: "staff",
        name: "pin",
        help: "Opens the staff menu. Change it.",
        domain: Domain::Pin,
        get: |s| Value::Text(s.staff.pin.clone()),
        set: |s, v| {
            if let Value::Text(pin) = v {
                s.staff.pin.clone_from(pin);
            }
        },
    },
    Key {
        section: "staff",
        name: "corner",
        help: "The corner that is held for 3 s to be asked for the PIN; north is the top of the picture.",
        domain: Domain::Choice(&CORNERS),
        get: |s| name_of(&Corner::ALL, &s.staff.corner),
        set: |s, v| set_named(&Corner::ALL, &mut s.staff.corner, v),
    },
    Key {
        section: "quality",
        name: "nodes",
        help: "Points of the terrain; \"auto\" suits the machine.",
        domain: Domain::NumberOr(NODES, "auto"),
        get: |s| number_or(s.quality.nodes.map(|nodes| nodes as f64)),
        set: |s, v| {
            let mut nodes = None;
            set_number_or(&mut nodes, v);
            s.quality.nodes = nodes.map(|nodes| nodes as u64);
        },
    },
    Key {
        section: "quality",
        name: "scale",
        help: "Pixels rendered per pixel shown, along one side; \"auto\" follows the frame rate.",
        domain: Domain::NumberOr(bound("1", 0.25, 2.0, 0.05), "auto"),
        get: |s| number_or(s.quality.scale),
        set: |s, v| set_number_or(&mut s.quality.scale, v),
    },
    Key {
        section: "quality",
        name: "attract_hz",
        help: "Most frames per second while the show plays.",
        domain: Domain::Number(bound("Hz", 5.0, 240.0, 5.0)),
        get: |s| Value::Number(s.quality.attract_hz),
        set: |s, v| set_number(&mut s.quality.attract_hz, v),
    },
    Key {
        section: "quality",
        name: "attract_software_hz",
        help: "The same where a processor stands in for the graphics card.",
        domain: Domain::Number(bound("Hz", 1.0, 60.0, 1.0)),
        get: |s| Value::Number(s.quality.attract_software_hz),
        set: |s, v| set_number(&mut s.quality.attract_software_hz, v),
    },
    Key {
        section: "quality",
        name: "stages",
        help: "Who computes transport and folds: \"cpu\", \"gpu\"; \"auto\" takes the faster one; after a restart.",
        domain: Domain::Choice(&COMPUTE),
        get: |s| name_of(&Compute::ALL, &s.quality.stages),
        set: |s, v| set_named(&Compute::ALL, &mut s.quality.stages, v),
    },
    Key {
        section: "view",
        name: "reduced_motion",
        help: "No flight and no eased motion.",
        domain: Domain::Switch,
        get: |s| Value::Switch(s.view.reduced_motion),
        set: |s, v| set_switch(&mut s.view.reduced_motion, v),
    },
    Key {
        section: "view",
        name: "readouts",
        help: "Figures (age, speed, shortening) are shown from the start.",
        domain: Domain::Switch,
        get: |s| Value::Switch(s.view.readouts),
        set: |s, v| set_switch(&mut s.view.readouts, v),
    },
    Key {
        section: "view",
        name: "tools",
        help: "Tools: \"visitor\" hides the artist's (folds, layers); \"auto\" does so in `orogen kiosk` only.",
        domain: Domain::Choice(&TOOLS),
        get: |s| name_of(&Tools::ALL, &s.view.tools),
        set: |s, v| set_named(&Tools::ALL, &mut s.view.tools, v),
    },
    Key {
        section: "files",
        name: "metrics",
        help: "File for a line of figures each second; empty for none.",
        domain: Domain::Path,
        get: |s| path_or(s.files.metrics.as_ref()),
        set: |s, v| set_path(&mut s.files.metrics, v),
    },
    Key {
        section: "files",
        name: "log",
        help: "Folder for the log; empty for the usual one.",
        domain: Domain::Path,
        get: |s| path_or(s.files.log.as_ref()),
        set: |s, v| set_path(&mut s.files.log, v),
    },
];
