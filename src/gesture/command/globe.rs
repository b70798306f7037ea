//! The words of the globe.

use serde_json::Value;

use super::super::json::{Expected, list, number, object, text, whole};
use super::{Action, PATH_POINTS, ZOOM_RANGE, member};

/// Most plates of a random planet.
pub const MAX_PLATES: u32 = 512;

/// Greatest radius of what is painted on the globe at once, degrees.
pub const MAX_BRUSH_DEG: f64 = 90.0;

/// A place on the globe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Degrees north, −90 to 90.
    pub lat: f64,
    /// Degrees east, −180 to 180.
    pub lon: f64,
}

/// What a finger paints on the globe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paint {
    /// Continental crust.
    Continent,
    /// Oceanic crust.
    Ocean,
}

impl Paint {
    /// Its name in gesture files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Continent => "continent",
            Self::Ocean => "ocean",
        }
    }

    /// The crust of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Continent, Self::Ocean]
            .into_iter()
            .find(|paint| paint.name() == name)
    }
}

pub(super) fn parse_view(value: &Value, field: &str) -> Result<Action, Expected> {
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

pub(super) fn parse_planet(value: &Value, field: &str) -> Result<Action, Expected> {
    let map = object(
        value,
        field,
        "{\"plates\":number,\"continental\":share,\"seed\":number}",
    )?;
    let what = format!("a whole number (1..={MAX_PLATES})");
    let (value, path) = member(map, "plates", field, &what)?;
    let plates = value
        .as_u64()
        .filter(|plates| (1..=u64::from(MAX_PLATES)).contains(plates))
        .ok_or_else(|| Expected::new(path, what, value))? as u32;
    let (value, path) = member(map, "continental", field, "a share")?;
    let continental = number(value, &path, "a share", 0.0, 1.0)?;
    let (value, path) = member(map, "seed", field, "a whole number below 2^64")?;
    let seed = whole(value, &path, "a whole number below 2^64")?;
    Ok(Action::Planet {
        plates,
        continental,
        seed,
    })
}

pub(super) fn parse_line(value: &Value, field: &str) -> Result<Vec<Place>, Expected> {
    let (least, most) = PATH_POINTS;
    let places = value
        .as_array()
        .filter(|places| (least..=most).contains(&places.len()));
    let places =
        places.ok_or_else(|| Expected::new(field, format!("{least} to {most} places [lat, lon]"), value))?;
    let place = |(i, value)| parse_place(value, &format!("{field}[{i}]"));
    places.iter().enumerate().map(place).collect()
}

pub(super) fn parse_paint(value: &Value, field: &str) -> Result<Action, Expected> {
    let map = object(
        value,
        field,
        "{\"at\":[lat, lon],\"radius\":degrees,\"crust\":\"continent\"}",
    )?;
    let (at, path) = member(map, "at", field, "[lat, lon]")?;
    let at = parse_place(at, &path)?;
    let (radius, path) = member(map, "radius", field, "degrees")?;
    let radius_deg = number(radius, &path, "degrees", 0.0, MAX_BRUSH_DEG)?;
    let (crust, path) = member(map, "crust", field, "\"continent\" or \"ocean\"")?;
    let paint = Paint::from_name(text(crust, &path)?)
        .ok_or_else(|| Expected::new(path, "\"continent\" or \"ocean\"", crust))?;
    Ok(Action::Paint {
        at,
        radius_deg,
        paint,
    })
}

/// A place `[lat, lon]`.
fn parse_place(value: &Value, field: &str) -> Result<Place, Expected> {
    match list(value, field, "[lat, lon] in degrees")? {
        [lat, lon] => Ok(Place {
            lat: number(lat, field, "degrees north", -90.0, 90.0)?,
            lon: number(lon, field, "degrees east", -180.0, 180.0)?,
        }),
        _ => Err(Expected::new(field, "[lat, lon] in degrees", value)),
    }
}
