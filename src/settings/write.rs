//! Settings → the file, with every key's help as a comment.

use std::fmt::Write as _;

use super::{Domain, KEYS, Key, Settings, VERSION, Value};

impl Settings {
    /// The file: every key with its help, unit and range as a comment above it.
    pub fn to_toml(&self) -> String {
        let mut text = format!(
            "# Settings of Orogen. Every key may be left out: then it has the value of the sample file.\n\nversion = {VERSION}\n"
        );
        let mut section = "";
        for key in KEYS {
            if key.section != section {
                section = key.section;
                let _ = write!(text, "\n[{section}]\n");
            }
            let (help, expected) = (key.help, key.expected());
            let value = literal(key, &(key.get)(self));
            let _ = write!(
                text,
                "\n# {help}\n# Expected: {expected}.\n{} = {value}\n",
                key.name
            );
        }
        text
    }
}

/// A value as TOML writes it.
fn literal(key: &Key, value: &Value) -> String {
    match (value, key.domain) {
        // Bounds keep numbers far from where floats lose units.
        (Value::Number(number), _) if number.fract() == 0.0 => format!("{number:.0}"),
        (Value::Number(number), _) => toml::Value::Float(*number).to_string(),
        (Value::Word, Domain::NumberOr(_, word)) => format!("\"{word}\""),
        (Value::Word, _) => String::new(),
        (Value::Switch(on), _) => on.to_string(),
        (Value::Text(text), _) => toml::Value::String(text.clone()).to_string(),
    }
}
