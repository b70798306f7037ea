//! The file → settings: the first thing that is wrong is told by file, line and key.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{Domain, KEYS, Key, Settings, VERSION, Value};

/// Most bytes of a settings file.
const MAX_BYTES: usize = 64 * 1024;

/// Most characters of a key or value that an error shows.
const SHOWN_CHARS: usize = 40;

/// Why a settings file was refused: file, line, key, and what was expected, in one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name}:{line}: {problem}")]
pub struct SettingsError {
    /// The file, as the caller named it.
    pub name: String,
    /// The line, from 1.
    pub line: usize,
    /// Key, what was expected, and what was found.
    pub problem: String,
}

impl Settings {
    /// Reads a settings file; `name` stands for it in errors.
    ///
    /// # Errors
    /// The first place in the file that is no TOML, holds an unknown key, or a value that its key may not hold.
    pub fn parse(bytes: &[u8], name: &str) -> Result<Self, SettingsError> {
        read(bytes).map_err(|fault| {
            let before = &bytes[..fault.at.min(bytes.len())];
            SettingsError {
                name: name.to_owned(),
                line: before.split(|&b| b == b'\n').count(),
                problem: one_line(&fault.problem),
            }
        })
    }
}

/// What is wrong, and at which byte.
struct Fault {
    at: usize,
    problem: String,
}

fn read(bytes: &[u8]) -> Result<Settings, Fault> {
    if bytes.len() > MAX_BYTES {
        return Err(Fault {
            at: 0,
            problem: format!("expected at most {MAX_BYTES} bytes, found {}", bytes.len()),
        });
    }
    let text = std::str::from_utf8(bytes).map_err(|error| Fault {
        at: error.valid_up_to(),
        problem: "expected UTF-8 text, found another byte".to_owned(),
    })?;
    let document = DeTable::parse(text).map_err(|error| Fault {
        at: error.span().map_or(0, |span| span.start),
        problem: format!("expected TOML: {}", error.message()),
    })?;
    let mut settings = Settings::default();
    let mut faults = Vec::new();
    take_table(document.get_ref(), "", &mut settings, &mut faults);
    match faults.into_iter().min_by_key(|fault| fault.at) {
        Some(first) => Err(first),
        None => Ok(settings),
    }
}

fn take_table(table: &DeTable<'_>, section: &str, settings: &mut Settings, faults: &mut Vec<Fault>) {
    for (name, value) in table {
        let at = name.span().start;
        let name: &str = name.get_ref();
        let is_section = section.is_empty() && KEYS.iter().any(|key| key.section == name && !name.is_empty());
        let result = if is_section {
            match value.get_ref() {
                DeValue::Table(inner) => {
                    take_table(inner, name, settings, faults);
                    Ok(())
                }
                other => Err(format!(
                    "{name}: expected a section [{name}], found {}",
                    found(other)
                )),
            }
        } else if section.is_empty() && name == "version" {
            take_version(value)
        } else if let Some(key) = KEYS.iter().find(|key| key.section == section && key.name == name) {
            take_value(key, value, settings)
        } else {
            Err(unknown(section, name))
        };
        if let Err(problem) = result {
            faults.push(Fault { at, problem });
        }
    }
}

fn take_version(value: &Spanned<DeValue<'_>>) -> Result<(), String> {
    let version = match value.get_ref() {
        DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
        _ => None,
    };
    if version == Some(VERSION) {
        Ok(())
    } else {
        Err(format!(
            "version: expected {VERSION}, found {}",
            found(value.get_ref())
        ))
    }
}

fn take_value(key: &Key, value: &Spanned<DeValue<'_>>, settings: &mut Settings) -> Result<(), String> {
    let taken = match (value.get_ref(), key.domain) {
        (DeValue::Integer(integer), _) => i64::from_str_radix(integer.as_str(), integer.radix())
            .ok()
            .map(|number| Value::Number(number as f64)),
        (DeValue::Float(float), _) => float.as_str().parse().ok().map(Value::Number),
        (DeValue::Boolean(on), _) => Some(Value::Switch(*on)),
        (DeValue::String(text), Domain::NumberOr(_, word)) if text == word => Some(Value::Word),
        (DeValue::String(text), _) => Some(Value::Text(text.to_string())),
        _ => None,
    };
    if taken.is_some_and(|taken| key.put(settings, &taken)) {
        return Ok(());
    }
    // What was typed for a PIN may be a PIN: it stays out of logs.
    let found = match key.domain {
        Domain::Pin => "something else".to_owned(),
        _ => found(value.get_ref()),
    };
    Err(format!(
        "{}: expected {}, found {found}",
        key.path(),
        key.expected()
    ))
}

fn unknown(section: &str, name: &str) -> String {
    let path = if section.is_empty() {
        name.to_owned()
    } else {
        format!("{section}.{name}")
    };
    let shown: String = path.chars().take(SHOWN_CHARS).collect();
    // A known name in the wrong section is one step away from where it belongs.
    let keys = KEYS.iter().map(|key| {
        let distance = edits(&shown, &key.path()).min(edits(name, key.name) + 1);
        (distance, key.path())
    });
    let sections = KEYS
        .iter()
        .filter(|key| section.is_empty() && !key.section.is_empty())
        .map(|key| (edits(&shown, key.section), format!("[{}]", key.section)));
    let nearest = keys.chain(sections).min_by_key(|(distance, _)| *distance);
    let nearest = nearest.map(|(_, path)| path).unwrap_or_default();
    format!("{shown}: expected a known key (the nearest is {nearest}), found an unknown one")
}

/// Least number of letters to insert, delete or exchange to turn one word into the other (Levenshtein 1966).
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &cb) in b.iter().enumerate() {
            let exchanged = diagonal + usize::from(ca != cb);
            diagonal = row[j + 1];
            row[j + 1] = exchanged.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// A value as an error shows it.
fn found(value: &DeValue<'_>) -> String {
    let text = match value {
        DeValue::String(text) => format!("{text:?}"),
        DeValue::Integer(integer) => integer.as_str().to_owned(),
        DeValue::Float(float) => float.as_str().to_owned(),
        DeValue::Boolean(on) => on.to_string(),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a section".to_owned(),
    };
    let mut chars = text.chars();
    let head: String = chars.by_ref().take(SHOWN_CHARS).collect();
    if chars.next().is_some() {
        head + "…"
    } else {
        head
    }
}

fn one_line(text: &str) -> String {
    text.split(char::is_control)
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> String {
        Settings::parse(text.as_bytes(), "orogen.toml")
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn an_empty_file_is_the_defaults() {
        assert_eq!(Settings::parse(b"", "x"), Ok(Settings::default()));
    }

    #[test]
    fn unknown_keys_are_told_with_line_and_nearest_key() {
        assert_eq!(
            problem("version = 1\n\n[table]\nwidht_mm = 900\n"),
            "orogen.toml:4: table.widht_mm: expected a known key (the nearest is table.width_mm), found an unknown one"
        );
        assert!(problem("[kisok]\nidle_s = 30").contains("nearest is [kiosk]"));
        assert!(problem("[table]\nidle_s = 30").contains("nearest is kiosk.idle_s"));
    }

    #[test]
    fn the_first_fault_of_the_file_is_told() {
        let text = "[table]\nwidth_mm = 1\n[kiosk]\nattract = 7\n";
        assert!(
            problem(text)
                .starts_with("orogen.toml:2: table.width_mm: expected a number from 200 to 5000 mm, found 1")
        );
        let text = "[staff]\ncorner = 3\n[kiosk]\nattract = 7\n";
        assert!(problem(text).starts_with("orogen.toml:2: staff.corner"));
    }

    #[test]
    fn each_kind_of_fault_is_one_line_that_says_what_was_expected() {
        for (text, part) in [
            ("version = 2", "1: version: expected 1, found 2"),
            ("version = \"1\"", "version: expected 1"),
            (
                "mode = \"moon\"",
                "mode: expected one of \"mountain\", \"globe\", found \"moon\"",
            ),
            ("table = 3", "table: expected a section [table], found 3"),
            (
                "[table]\nheight_mm = \"tall\"",
                "2: table.height_mm: expected a number from 100 to 5000 mm or \"auto\"",
            ),
            ("[table]\nwidth_mm = nan", "found nan"),
            (
                "[quality]\nnodes = 2000.5",
                "expected a whole number from 1000 to 1000000 or \"auto\", found 2000.5",
            ),
            (
                "[staff]\npin = 2580",
                "staff.pin: expected 4 to 8 digits in quotes, found something else",
            ),
            ("[files]\nlog = \"a\\u0007b\"", "files.log: expected a path"),
            ("[table]\nwidth_mm = 300\nwidth_mm = 400", "3: expected TOML"),
            ("[table", "1: expected TOML"),
        ] {
            let problem = problem(text);
            assert!(problem.contains(part), "{problem}");
            assert!(!problem.contains('\n'));
        }
        let error = Settings::parse(b"mode = \"\xff\"", "x").unwrap_err().to_string();
        assert_eq!(error, "x:1: expected UTF-8 text, found another byte");
        let long = vec![b'\n'; MAX_BYTES + 1];
        assert!(
            Settings::parse(&long, "x")
                .unwrap_err()
                .to_string()
                .contains("at most")
        );
    }

    #[test]
    fn numbers_may_be_whole_or_not_and_words_stand_for_none() {
        let text = "[table]\nwidth_mm = 900\nheight_mm = 506.25\n[quality]\nnodes = 60_000\n[kiosk]\nreset_hours = \"never\"";
        let settings = Settings::parse(text.as_bytes(), "x").unwrap();
        assert_eq!(settings.table.width_mm, 900.0);
        assert_eq!(settings.table.height_mm, Some(506.25));
        assert_eq!(settings.quality.nodes, Some(60_000));
        assert_eq!(settings.kiosk.reset_hours, None);
    }

    #[test]
    fn distance_of_words() {
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("same", "same"), 0);
    }
}
