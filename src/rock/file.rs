//! A pile of layers as a TOML file.

use std::fmt::Write as _;
use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::stratigraphy::{
    Basement, Bound, Colour, Layer, MAX_BEDS, MAX_LAYERS, MAX_NAME, Rock, Stratigraphy, bounds,
};

/// Most bytes of such a file.
const MAX_BYTES: usize = 64 * 1024;

/// Why a pile was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StratigraphyError {
    /// A place in a file.
    #[error("{name}:{line}: {problem}")]
    File {
        /// The file, as the caller named it.
        name: String,
        /// The line, from 1.
        line: usize,
        /// Key, what was expected, what was found.
        problem: String,
    },
    /// A number outside its range, or a name.
    #[error("{0}")]
    Value(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileText {
    name: Spanned<String>,
    title: Spanned<String>,
    basement: BasementText,
    #[serde(default)]
    layer: Vec<Spanned<LayerText>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BasementText {
    name: Spanned<String>,
    #[serde(default)]
    uplift: Option<Spanned<f64>>,
    viscosity_pa_s: Spanned<f64>,
    erodibility: Spanned<f64>,
    talus_deg: Spanned<f64>,
    colour: Spanned<String>,
    stone: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LayerText {
    name: Spanned<String>,
    thickness_m: Spanned<f64>,
    viscosity_pa_s: Spanned<f64>,
    erodibility: Spanned<f64>,
    talus_deg: Spanned<f64>,
    beds: Spanned<u8>,
    contrast: Spanned<f64>,
    #[serde(default)]
    fold: Option<Spanned<f64>>,
    #[serde(default)]
    wavelength_m: Option<Spanned<f64>>,
    colour: Spanned<String>,
    stone: Spanned<String>,
}

/// What is wrong, and at which byte.
type Fault = (usize, String);

impl Stratigraphy {
    /// Reads a file; `name` stands for it in errors.
    ///
    /// # Errors
    /// The first place that is no TOML, holds an unknown key, or a value that its key may not hold.
    pub fn parse(bytes: &[u8], name: &str) -> Result<Self, StratigraphyError> {
        read(bytes).map_err(|(at, problem)| {
            let before = &bytes[..at.min(bytes.len())];
            StratigraphyError::File {
                name: name.to_owned(),
                line: before.split(|&b| b == b'\n').count(),
                problem: problem.lines().collect::<Vec<_>>().join(" "),
            }
        })
    }

    /// The file that reads back as this pile.
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let rock = |rock: &Rock| {
            format!(
                "erodibility = {}\ntalus_deg = {}\ncolour = \"{}\"\nstone = \"{}\"\n",
                number(rock.erodibility),
                number(rock.talus_deg),
                hex(rock.colour),
                hex(rock.stone)
            )
        };
        // Writing into a string cannot fail.
        let _ = writeln!(
            out,
            "name = {}\ntitle = {}",
            quoted(self.name()),
            quoted(self.title())
        );
        let basement = self.basement();
        let _ = write!(
            out,
            "\n[basement]\nname = {}\nuplift = {}\nviscosity_pa_s = {:e}\n{}",
            quoted(&basement.name),
            number(basement.uplift),
            basement.viscosity_pa_s,
            rock(&basement.rock)
        );
        for layer in self.layers() {
            let _ = write!(
                out,
                "\n[[layer]]\nname = {}\nthickness_m = {}\nviscosity_pa_s = {:e}\n{}beds = {}\ncontrast = {}\nfold = {}\n",
                quoted(&layer.name),
                number(layer.thickness_m),
                layer.viscosity_pa_s,
                rock(&layer.rock),
                layer.beds,
                number(layer.contrast),
                number(layer.fold)
            );
            if let Some(wavelength) = layer.wavelength_m {
                let _ = writeln!(out, "wavelength_m = {}", number(wavelength));
            }
        }
        out
    }
}

/// A TOML float: it has a point or an exponent.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn read(bytes: &[u8]) -> Result<Stratigraphy, Fault> {
    if bytes.len() > MAX_BYTES {
        return Err((
            0,
            format!("expected at most {MAX_BYTES} bytes, found {}", bytes.len()),
        ));
    }
    let text = std::str::from_utf8(bytes)
        .map_err(|error| (error.valid_up_to(), "expected UTF-8 text".to_owned()))?;
    let file: FileText = toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        (at, format!("expected a pile of layers: {}", error.message()))
    })?;
    if let Some(surplus) = file.layer.get(MAX_LAYERS) {
        return Err((
            surplus.span().start,
            format!(
                "layer: expected at most {MAX_LAYERS} layers, found {}",
                file.layer.len()
            ),
        ));
    }
    let title = named(&file.title, "title")?;
    let name = named(&file.name, "name")?;
    let basement = Basement {
        name: named(&file.basement.name, "basement.name")?,
        uplift: match &file.basement.uplift {
            Some(uplift) => within(uplift, bounds::UPLIFT, "basement")?,
            None => 1.0,
        },
        viscosity_pa_s: within(&file.basement.viscosity_pa_s, bounds::VISCOSITY, "basement")?,
        rock: rock(
            &file.basement.erodibility,
            &file.basement.talus_deg,
            (&file.basement.colour, &file.basement.stone),
            "basement",
        )?,
    };
    let mut layers = Vec::with_capacity(file.layer.len());
    for (index, layer) in file.layer.iter().enumerate() {
        layers.push(read_layer(layer.get_ref(), &format!("layer {}", index + 1))?);
    }
    Stratigraphy::new(name, title, layers, basement).map_err(|error| (0, error.to_string()))
}

fn read_layer(layer: &LayerText, path: &str) -> Result<Layer, Fault> {
    let beds = *layer.beds.get_ref();
    if !(1..=MAX_BEDS).contains(&beds) {
        let problem = format!("{path}: beds: expected 1 to {MAX_BEDS}, found {beds}");
        return Err((layer.beds.span().start, problem));
    }
    let optional = |value: &Option<Spanned<f64>>, bound| {
        value.as_ref().map(|value| within(value, bound, path)).transpose()
    };
    Ok(Layer {
        name: named(&layer.name, &format!("{path}: name"))?,
        thickness_m: within(&layer.thickness_m, bounds::THICKNESS, path)?,
        viscosity_pa_s: within(&layer.viscosity_pa_s, bounds::VISCOSITY, path)?,
        rock: rock(
            &layer.erodibility,
            &layer.talus_deg,
            (&layer.colour, &layer.stone),
            path,
        )?,
        beds,
        contrast: within(&layer.contrast, bounds::CONTRAST, path)?,
        fold: optional(&layer.fold, bounds::FOLD)?.unwrap_or(0.0),
        wavelength_m: optional(&layer.wavelength_m, bounds::WAVELENGTH)?,
    })
}

fn rock(
    erodibility: &Spanned<f64>,
    talus_deg: &Spanned<f64>,
    (map, stone): (&Spanned<String>, &Spanned<String>),
    path: &str,
) -> Result<Rock, Fault> {
    Ok(Rock {
        erodibility: within(erodibility, bounds::ERODIBILITY, path)?,
        talus_deg: within(talus_deg, bounds::TALUS, path)?,
        colour: colour(map, "colour", path)?,
        stone: colour(stone, "stone", path)?,
    })
}

fn within(value: &Spanned<f64>, bound: Bound, path: &str) -> Result<f64, Fault> {
    let found = *value.get_ref();
    if bound.holds(found) {
        Ok(found)
    } else {
        Err((value.span().start, outside(bound, found, path)))
    }
}

fn outside(bound: Bound, found: f64, path: &str) -> String {
    let Bound { key, unit, min, max } = bound;
    let space = if unit.is_empty() { "" } else { " " };
    format!("{path}: {key}: expected {min:?} to {max:?}{space}{unit}, found {found:?}")
}

fn named(name: &Spanned<String>, path: &str) -> Result<String, Fault> {
    let Range { start, .. } = name.span();
    check_name(name.get_ref(), path).map_err(|problem| (start, problem))?;
    Ok(name.get_ref().clone())
}

fn check_name(name: &str, path: &str) -> Result<(), String> {
    let fits = (1..=MAX_NAME).contains(&name.chars().count()) && !name.chars().any(char::is_control);
    if fits {
        Ok(())
    } else {
        Err(format!("{path}: expected 1 to {MAX_NAME} printable characters"))
    }
}

fn colour(text: &Spanned<String>, key: &str, path: &str) -> Result<Colour, Fault> {
    let fault = || {
        let problem = format!("{path}: {key}: expected \"#rrggbb\", found {:?}", text.get_ref());
        (text.span().start, problem)
    };
    let digits = text.get_ref().strip_prefix('#').ok_or_else(fault)?;
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return Err(fault());
    }
    let value = u32::from_str_radix(digits, 16).map_err(|_| fault())?;
    let [_, red, green, blue] = value.to_be_bytes();
    Ok([red, green, blue])
}

fn hex([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Refuses what no pile may be, wherever it comes from.
pub(super) fn check(
    name: &str,
    title: &str,
    layers: &[Layer],
    basement: &Basement,
) -> Result<(), StratigraphyError> {
    let value = StratigraphyError::Value;
    check_name(name, "name").map_err(value)?;
    check_name(title, "title").map_err(value)?;
    if layers.len() > MAX_LAYERS {
        return Err(value(format!(
            "expected at most {MAX_LAYERS} layers, found {}",
            layers.len()
        )));
    }
    let number = |bound: Bound, found: f64, path: &str| {
        if bound.holds(found) {
            Ok(())
        } else {
            Err(value(outside(bound, found, path)))
        }
    };
    number(bounds::UPLIFT, basement.uplift, "basement")?;
    number(bounds::VISCOSITY, basement.viscosity_pa_s, "basement")?;
    number(bounds::ERODIBILITY, basement.rock.erodibility, "basement")?;
    number(bounds::TALUS, basement.rock.talus_deg, "basement")?;
    check_name(&basement.name, "basement.name").map_err(value)?;
    for (index, layer) in layers.iter().enumerate() {
        let path = format!("layer {}", index + 1);
        check_name(&layer.name, &format!("{path}: name")).map_err(value)?;
        number(bounds::THICKNESS, layer.thickness_m, &path)?;
        number(bounds::VISCOSITY, layer.viscosity_pa_s, &path)?;
        number(bounds::ERODIBILITY, layer.rock.erodibility, &path)?;
        number(bounds::TALUS, layer.rock.talus_deg, &path)?;
        number(bounds::CONTRAST, layer.contrast, &path)?;
        number(bounds::FOLD, layer.fold, &path)?;
        if let Some(wavelength) = layer.wavelength_m {
            number(bounds::WAVELENGTH, wavelength, &path)?;
        }
        if !(1..=MAX_BEDS).contains(&layer.beds) {
            return Err(value(format!(
                "{path}: beds: expected 1 to {MAX_BEDS}, found {}",
                layer.beds
            )));
        }
    }
    Ok(())
}
