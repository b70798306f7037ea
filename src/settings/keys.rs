//! What a key of the file is: name, help, what is allowed, and where in [`Settings`] it lives.

use super::form::Form;
use super::{PIN_DIGITS, Settings};

/// Unit, range and step of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Its unit; `1` for ratios and numbers of things.
    pub unit: &'static str,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Step of a slider. Values between steps are allowed; of numbers of things only whole ones.
    pub step: f64,
    /// True for numbers of things.
    pub whole: bool,
}

/// What a key may hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// A number.
    Number(Bound),
    /// A number, or the word that stands for none.
    NumberOr(Bound, &'static str),
    /// `true` or `false`.
    Switch,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Digits, as many as [`PIN_DIGITS`] says.
    Pin,
    /// A path, or an empty text for none.
    Path,
    /// A text of a certain form.
    Text(Form),
}

/// The value of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Of [`Domain::Number`] and [`Domain::NumberOr`].
    Number(f64),
    /// The word of [`Domain::NumberOr`].
    Word,
    /// Of [`Domain::Switch`].
    Switch(bool),
    /// Of [`Domain::Choice`], [`Domain::Pin`], [`Domain::Path`] and [`Domain::Text`].
    Text(String),
}

/// One key of the file.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The table of the file that it stands in; empty for the file itself.
    pub section: &'static str,
    /// Its name there.
    pub name: &'static str,
    /// What it means, in one line; also the comment above it in the file.
    pub help: &'static str,
    /// What it may hold.
    pub domain: Domain,
    /// Reads the field.
    pub get: fn(&Settings) -> Value,
    /// Writes the field. A value that [`Key::admits`] says no to leaves it as it is or makes it something allowed.
    pub(super) set: fn(&mut Settings, &Value),
}

impl Key {
    /// The key with its section, as errors name it (`table.width_mm`).
    pub fn path(&self) -> String {
        if self.section.is_empty() {
            self.name.to_owned()
        } else {
            format!("{}.{}", self.section, self.name)
        }
    }

    /// True when the key may hold `value`.
    pub fn admits(&self, value: &Value) -> bool {
        match (self.domain, value) {
            (Domain::Number(bound) | Domain::NumberOr(bound, _), Value::Number(number)) => {
                bound.contains(*number)
            }
            (Domain::NumberOr(..), Value::Word) | (Domain::Switch, Value::Switch(_)) => true,
            (Domain::Choice(words), Value::Text(word)) => words.contains(&word.as_str()),
            (Domain::Pin, Value::Text(pin)) => {
                (PIN_DIGITS.0..=PIN_DIGITS.1).contains(&pin.len()) && pin.bytes().all(|b| b.is_ascii_digit())
            }
            (Domain::Path, Value::Text(path)) => !path.chars().any(char::is_control),
            (Domain::Text(form), Value::Text(text)) => form.admits(text),
            _ => false,
        }
    }

    /// Puts `value` into its field; false, and nothing changes, when the key may not hold it.
    pub fn put(&self, settings: &mut Settings, value: &Value) -> bool {
        let admitted = self.admits(value);
        if admitted {
            (self.set)(settings, value);
        }
        admitted
    }

    /// What the key may hold, in words.
    pub fn expected(&self) -> String {
        match self.domain {
            Domain::Number(bound) => bound.in_words(),
            Domain::NumberOr(bound, word) => format!("{} or \"{word}\"", bound.in_words()),
            Domain::Switch => "true or false".to_owned(),
            Domain::Choice(words) => {
                let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                format!("one of {}", quoted.join(", "))
            }
            Domain::Pin => format!("{} to {} digits in quotes", PIN_DIGITS.0, PIN_DIGITS.1),
            Domain::Path => "a path in quotes".to_owned(),
            Domain::Text(form) => form.expected().to_owned(),
        }
    }
}

impl Bound {
    /// True for numbers in the range (and whole, where only these mean anything).
    pub fn contains(&self, number: f64) -> bool {
        (self.min..=self.max).contains(&number) && !(self.whole && number.fract() != 0.0)
    }

    fn in_words(&self) -> String {
        let kind = if self.whole { "a whole number" } else { "a number" };
        let unit = if self.unit == "1" { "" } else { self.unit };
        let words = format!("{kind} from {} to {} {unit}", self.min, self.max);
        words.trim_end().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::KEYS;

    #[test]
    fn every_default_is_admitted_and_every_name_is_there_once() {
        let defaults = Settings::default();
        let mut paths: Vec<String> = KEYS.iter().map(Key::path).collect();
        for key in KEYS {
            assert!(key.admits(&(key.get)(&defaults)), "{}", key.path());
        }
        paths.sort();
        let before = paths.len();
        paths.dedup();
        assert_eq!(paths.len(), before);
    }

    #[test]
    fn each_key_writes_its_own_field_and_no_other() {
        for key in KEYS {
            let other = match (key.domain, (key.get)(&Settings::default())) {
                (Domain::Number(b) | Domain::NumberOr(b, _), _) => Value::Number(b.max),
                (Domain::Switch, Value::Switch(on)) => Value::Switch(!on),
                (Domain::Choice(words), _) => Value::Text(words[words.len() - 1].to_owned()),
                (Domain::Pin, _) => Value::Text("00000000".to_owned()),
                (Domain::Path, _) => Value::Text("a/b".to_owned()),
                (Domain::Text(form), _) => Value::Text(form.example().to_owned()),
                (domain, value) => panic!("{domain:?} with {value:?}"),
            };
            let mut settings = Settings::default();
            assert!(key.put(&mut settings, &other), "{}", key.path());
            for each in KEYS {
                let expected = if each.path() == key.path() {
                    other.clone()
                } else {
                    (each.get)(&Settings::default())
                };
                assert_eq!(
                    (each.get)(&settings),
                    expected,
                    "{} by {}",
                    each.path(),
                    key.path()
                );
            }
        }
    }

    #[test]
    fn values_of_another_kind_or_out_of_range_are_not_put() {
        let mut settings = Settings::default();
        for key in KEYS {
            let wrong = match key.domain {
                Domain::Number(b) | Domain::NumberOr(b, _) => vec![
                    Value::Number(b.min - 1.0),
                    Value::Number(b.max * 1.01),
                    Value::Number(f64::NAN),
                    Value::Switch(true),
                ],
                Domain::Switch => vec![Value::Number(1.0), Value::Word],
                Domain::Choice(_) => vec![Value::Text("sideways".to_owned()), Value::Word],
                Domain::Pin => ["123", "123456789", "12a4", "１２３４"]
                    .map(|pin| Value::Text(pin.to_owned()))
                    .to_vec(),
                Domain::Path => vec![Value::Text("a\nb".to_owned())],
                Domain::Text(_) => vec![Value::Text("a, b".to_owned()), Value::Number(1.0)],
            };
            for value in wrong {
                assert!(!key.put(&mut settings, &value), "{} takes {value:?}", key.path());
            }
        }
        assert_eq!(settings, Settings::default());
        let nodes = KEYS.iter().find(|key| key.name == "nodes").map(|key| key.domain);
        assert!(matches!(nodes, Some(Domain::NumberOr(nodes, _)) if !nodes.contains(2000.5)));
    }
}
