//! Maps from files: one value per pixel, from EXR or PNG.

use std::path::{Path, PathBuf};

use exr::prelude::{ReadChannels as _, ReadLayers as _};
use image::ImageDecoder as _;

use crate::export::height16::Sidecar;
use crate::surface::Raster;
use crate::units::{Extent, KM};

/// What a map's values mean, and with that which channel is looked for and what full-scale white stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapKind {
    /// Uplift rate, m/yr. EXR channel `uplift_m_per_yr`; PNG white is 10⁻³ m/yr.
    Uplift,
    /// Heights to start from, metres. EXR channel `height_m`; PNG black and white as `<stem>.json` beside the file
    /// says, otherwise 0 and 6553.5 m (0.1 m per 16-bit step).
    Start,
    /// Factor on the erodibility *k*, ≥ 0. EXR channel `erodibility`; PNG white is 2, so that mid-grey changes
    /// nothing.
    Erodibility,
    /// Factor on the rain, ≥ 0. EXR channel `rain`; PNG white is 2.
    Rain,
    /// Part of the change that is held back, 0–1. EXR channel `protect`; PNG white is 1.
    Protect,
}

impl MapKind {
    fn name(self) -> &'static str {
        match self {
            Self::Uplift => "uplift",
            Self::Start => "start height",
            Self::Erodibility => "erodibility",
            Self::Rain => "rain",
            Self::Protect => "protection",
        }
    }

    fn channel(self) -> &'static str {
        match self {
            Self::Uplift => "uplift_m_per_yr",
            Self::Start => "height_m",
            Self::Erodibility => "erodibility",
            Self::Rain => "rain",
            Self::Protect => "protect",
        }
    }

    /// Value of PNG white.
    fn full_scale(self) -> f64 {
        match self {
            Self::Uplift => 1e-3,
            Self::Start => 6553.5,
            Self::Erodibility | Self::Rain => 2.0,
            Self::Protect => 1.0,
        }
    }

    /// Values that have a meaning.
    fn range(self) -> (f32, f32) {
        match self {
            Self::Uplift | Self::Start => (f32::MIN, f32::MAX),
            Self::Erodibility | Self::Rain => (0.0, f32::MAX),
            Self::Protect => (0.0, 1.0),
        }
    }
}

/// Largest file that is opened, bytes.
pub const MAX_FILE_BYTES: u64 = 2 << 30;

/// Most pixels × channels that are read: four channels of 8192².
pub const MAX_SAMPLES: u64 = 4 * 8192 * 8192;

/// Why a map was refused. Every message names the file and what was expected.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", file.display())]
pub struct MapError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong with it.
    pub fault: MapFault,
}

/// What can be wrong with a map.
#[derive(Debug, thiserror::Error)]
pub enum MapFault {
    /// The file cannot be read at all.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// The file is beyond [`MAX_FILE_BYTES`].
    #[error("{0} bytes; expected at most {MAX_FILE_BYTES}")]
    FileTooLarge(u64),
    /// Neither signature.
    #[error("expected an EXR or a PNG file, it is neither")]
    UnknownFormat,
    /// It has the signature of its format, but cannot be decoded.
    #[error("expected a complete {format} file: {reason}")]
    Broken {
        /// `EXR` or `PNG`.
        format: &'static str,
        /// The decoder's words.
        reason: String,
    },
    /// No pixels, or more than [`MAX_SAMPLES`].
    #[error("{width} × {height} pixels of {channels} channels; expected 1 to {MAX_SAMPLES} samples in all")]
    Size {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
        /// Channels.
        channels: u64,
    },
    /// No channel that could be meant.
    #[error("channels {found}; expected `{expected}`, `Y`, or `R`, `G` and `B`, or a single channel")]
    Channels {
        /// Those there are.
        found: String,
        /// The one looked for first.
        expected: &'static str,
    },
    /// A value without meaning.
    #[error("{value} at column {column}, row {row}; expected {what} values from {low:e} to {high:e}")]
    Value {
        /// The value.
        value: f32,
        /// Column from the west.
        column: usize,
        /// Row from the north.
        row: usize,
        /// Name of the quantity.
        what: &'static str,
        /// Smallest allowed.
        low: f32,
        /// Largest allowed.
        high: f32,
    },
    /// The `.json` beside a start surface does not belong to it.
    #[error("the description beside it, {}, {reason}", sidecar.display())]
    Sidecar {
        /// The description's path.
        sidecar: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

/// Reads a map of one quantity. The first row is the northern one.
///
/// * EXR: values are physical. The channel is the kind's own name (also as `layer.name`), else `Y`, else the
///   luminance of `R`, `G`, `B` (ITU-R BT.709), else the only channel there is; of several layers the first that
///   has one.
/// * PNG, 8 or 16 bits, grey or colour (its luminance; transparency is ignored): black is 0, white is the kind's full
///   scale. A start surface with a `<stem>.json` as [`Height16`](crate::export::height16::Height16) writes it takes
///   its metres, and its size on the ground, from there.
///
/// The raster lies over one metre of ground per pixel unless a description says more; [`Raster::stretched`] lays it
/// over the land.
///
/// # Errors
/// [`MapError`] with the file and what was expected.
pub fn read_map(path: &Path, kind: MapKind) -> Result<Raster, MapError> {
    read(path, kind).map_err(|fault| MapError {
        file: path.to_owned(),
        fault,
    })
}

fn read(path: &Path, kind: MapKind) -> Result<Raster, MapFault> {
    let bytes = file_bytes(path)?;
    let mut raster = match format_of(&bytes)? {
        MapFormat::Exr => decode_exr(&bytes, kind)?,
        MapFormat::Png => {
            let mut raster = decode_png(&bytes)?;
            scale_png(path, kind, &mut raster)?;
            raster
        }
    };
    check_values(&raster, kind.name(), kind.range())?;
    // −0 and 0 are one value; files should not decide which.
    for value in &mut raster.data {
        *value += 0.0;
    }
    Ok(raster)
}

/// What the file holds, unless it is too large.
pub(super) fn file_bytes(path: &Path) -> Result<Vec<u8>, MapFault> {
    let length = std::fs::metadata(path)?.len();
    if length > MAX_FILE_BYTES {
        return Err(MapFault::FileTooLarge(length));
    }
    Ok(std::fs::read(path)?)
}

/// Formats of maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MapFormat {
    /// `OpenEXR`.
    Exr,
    /// PNG.
    Png,
}

/// The format by its signature.
pub(super) fn format_of(bytes: &[u8]) -> Result<MapFormat, MapFault> {
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        Ok(MapFormat::Exr)
    } else if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        Ok(MapFormat::Png)
    } else {
        Err(MapFault::UnknownFormat)
    }
}

/// Refuses values outside a range, and what is no number.
pub(super) fn check_values(
    raster: &Raster,
    what: &'static str,
    (low, high): (f32, f32),
) -> Result<(), MapFault> {
    match raster.data.iter().position(|v| !(low..=high).contains(v)) {
        None => Ok(()),
        Some(i) => Err(MapFault::Value {
            value: raster.data[i],
            column: i % raster.width,
            row: i / raster.width,
            what,
            low,
            high,
        }),
    }
}

pub(super) fn check_size(width: u64, height: u64, channels: u64) -> Result<(), MapFault> {
    let samples = width
        .checked_mul(height)
        .and_then(|pixels| pixels.checked_mul(channels));
    match samples {
        Some(1..=MAX_SAMPLES) => Ok(()),
        _ => Err(MapFault::Size {
            width,
            height,
            channels,
        }),
    }
}

/// A raster over one metre of ground per pixel.
fn per_pixel(width: usize, height: usize, data: Vec<f32>) -> Raster {
    Raster {
        width,
        height,
        extent: Extent {
            width: width as f64,
            height: height as f64,
        },
        data,
    }
}

/// Luminance of linear red, green and blue (ITU-R BT.709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

fn luminance(rgb: [f32; 3]) -> f32 {
    // Greys come out exact: the weights' rounding errors must not tint a map that has none.
    if rgb[0] == rgb[1] && rgb[1] == rgb[2] {
        rgb[0]
    } else {
        LUMINANCE[0] * rgb[0] + LUMINANCE[1] * rgb[1] + LUMINANCE[2] * rgb[2]
    }
}

/// Values of the channel that `kind` looks for.
pub(super) fn decode_exr(bytes: &[u8], kind: MapKind) -> Result<Raster, MapFault> {
    let broken = |error: exr::error::Error| MapFault::Broken {
        format: "EXR",
        reason: error.to_string(),
    };
    // Sizes are checked before anything is allocated for pixels.
    let meta = exr::meta::MetaData::read_from_buffered(std::io::Cursor::new(bytes), false).map_err(broken)?;
    for header in &meta.headers {
        check_size(
            header.layer_size.width() as u64,
            header.layer_size.height() as u64,
            header.channels.list.len() as u64,
        )?;
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(std::io::Cursor::new(bytes))
        .map_err(broken)?;
    let mut found = Vec::new();
    for layer in &image.layer_data {
        let channels = &layer.channel_data.list;
        let (width, height) = (layer.size.width(), layer.size.height());
        let full = |values: &[f32]| values.len() == width * height;
        let named = |wanted: &str| {
            let suffix = format!(".{wanted}");
            let channel = channels.iter().find(|channel| {
                let name = channel.name.to_string();
                name == wanted || name.ends_with(&suffix)
            })?;
            Some(channel.sample_data.values_as_f32().collect::<Vec<f32>>())
        };
        let chosen = named(kind.channel())
            .or_else(|| named("Y"))
            .or_else(|| {
                let [r, g, b] = [named("R")?, named("G")?, named("B")?];
                (full(&r) && full(&g) && full(&b))
                    .then(|| (0..r.len()).map(|i| luminance([r[i], g[i], b[i]])).collect())
            })
            .or_else(|| match channels.as_slice() {
                [only] => Some(only.sample_data.values_as_f32().collect()),
                _ => None,
            });
        // Subsampled channels have fewer values than pixels.
        if let Some(data) = chosen.filter(|values| full(values)) {
            return Ok(per_pixel(width, height, data));
        }
        found.extend(channels.iter().map(|channel| format!("`{}`", channel.name)));
    }
    Err(MapFault::Channels {
        found: found.join(", "),
        expected: kind.channel(),
    })
}

/// Grey values from 0 (black) to 1 (white).
pub(super) fn decode_png(bytes: &[u8]) -> Result<Raster, MapFault> {
    let broken = |error: image::ImageError| MapFault::Broken {
        format: "PNG",
        reason: error.to_string(),
    };
    let decoder = image::codecs::png::PngDecoder::new(std::io::Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let colour = decoder.color_type();
    check_size(
        u64::from(width),
        u64::from(height),
        u64::from(colour.channel_count()),
    )?;
    let image = image::DynamicImage::from_decoder(decoder).map_err(broken)?;
    let data = if colour.has_color() {
        image
            .into_rgb32f()
            .pixels()
            .map(|pixel| luminance(pixel.0))
            .collect()
    } else {
        image
            .into_luma16()
            .into_raw()
            .into_iter()
            .map(|step| (f64::from(step) / 65535.0) as f32)
            .collect()
    };
    Ok(per_pixel(width as usize, height as usize, data))
}

/// Turns grey values into the kind's unit, by the description beside a start surface where there is one.
fn scale_png(path: &Path, kind: MapKind, raster: &mut Raster) -> Result<(), MapFault> {
    let (mut black, mut white) = (0.0, kind.full_scale());
    if kind == MapKind::Start
        && let Some(sidecar) = read_sidecar(&path.with_extension("json"), raster)?
    {
        (black, white) = (sidecar.metres_at_0, sidecar.metres_at_65535);
        raster.extent = Extent {
            width: sidecar.km_per_pixel[0] * KM * raster.width as f64,
            height: sidecar.km_per_pixel[1] * KM * raster.height as f64,
        };
    }
    for value in &mut raster.data {
        *value = (black + (white - black) * f64::from(*value)) as f32;
    }
    Ok(())
}

/// The description at `path`; `None` where there is no such file.
fn read_sidecar(path: &Path, raster: &Raster) -> Result<Option<Sidecar>, MapFault> {
    let fault = |reason: String| MapFault::Sidecar {
        sidecar: path.to_owned(),
        reason,
    };
    let text = match std::fs::read(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(fault(format!("cannot be read: {error}"))),
    };
    let sidecar: Sidecar =
        serde_json::from_slice(&text).map_err(|error| fault(format!("is not one of Orogen's: {error}")))?;
    if (sidecar.width, sidecar.height) != (raster.width, raster.height) {
        return Err(fault(format!(
            "is for {} × {} pixels; expected {} × {}",
            sidecar.width, sidecar.height, raster.width, raster.height
        )));
    }
    let numbers_fit = sidecar.metres_at_0.is_finite()
        && sidecar.metres_at_65535.is_finite()
        && sidecar.km_per_pixel.iter().all(|km| km.is_finite() && *km > 0.0);
    if !numbers_fit {
        return Err(fault("has metres or pixel sizes that are no sizes".to_owned()));
    }
    Ok(Some(sidecar))
}
