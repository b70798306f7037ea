//! `height16.png`, `height16.r16` and `height16.json`: 16-bit heights for engines, and what the numbers mean.

use std::io::{self, Write};

use image::ImageEncoder as _;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use serde::{Deserialize, Serialize};

use super::invalid;
use crate::surface::Raster;
use crate::units::KM;

/// Heights as 16-bit steps between the lowest and the highest.
#[derive(Clone, Debug, PartialEq)]
pub struct Height16 {
    /// Steps, rows from north to south.
    pub steps: Vec<u16>,
    /// What they mean.
    pub sidecar: Sidecar,
}

/// `height16.json`: what turns steps back into metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sidecar {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Height of step 0, metres.
    pub metres_at_0: f64,
    /// Height of step 65535, metres.
    pub metres_at_65535: f64,
    /// Size of a pixel, kilometres, west–east and north–south.
    pub km_per_pixel: [f64; 2],
    /// Where the first pixel lies: always `north-west`.
    pub row_origin: String,
    /// What a pixel stands for: always `area` (its value belongs to its centre).
    pub pixel: String,
    /// Byte order of the `.r16` file: always `little-endian`.
    pub r16: String,
}

/// Values as 16-bit steps over their own range.
pub(super) struct Steps {
    /// One per value.
    pub(super) values: Vec<u16>,
    /// The value of step 0.
    pub(super) low: f64,
    /// The value of step 65535.
    pub(super) high: f64,
}

impl Steps {
    /// Rounds to the nearest step. Values that are all alike get a range of 1.
    pub(super) fn new(values: &[f32]) -> io::Result<Self> {
        if values.is_empty() {
            return Err(invalid("16-bit heights: there are none"));
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for &value in values {
            if !value.is_finite() {
                return Err(invalid("16-bit heights: a height is not a finite number"));
            }
            (low, high) = (low.min(f64::from(value)), high.max(f64::from(value)));
        }
        if high <= low {
            high = low + 1.0;
        }
        let steps_per_unit = 65535.0 / (high - low);
        let step = |&value: &f32| ((f64::from(value) - low) * steps_per_unit).round() as u16;
        Ok(Self {
            values: values.iter().map(step).collect(),
            low,
            high,
        })
    }
}

/// Writes steps as a 16-bit grey PNG of `(width, height)` pixels.
pub(super) fn write_png(out: impl Write, (width, height): (usize, usize), steps: &[u16]) -> io::Result<()> {
    let bytes: Vec<u8> = steps.iter().flat_map(|step| step.to_ne_bytes()).collect();
    PngEncoder::new_with_quality(out, CompressionType::Default, FilterType::Adaptive)
        .write_image(&bytes, width as u32, height as u32, image::ExtendedColorType::L16)
        .map_err(io::Error::other)
}

impl Height16 {
    /// Rounds a height raster to 16 bits over its own range; the error is at most half a step. Flat land is given
    /// a range of one metre, so that the steps still have a meaning.
    ///
    /// # Errors
    /// Where the raster has no pixels, or a height is not a finite number.
    pub fn new(heights: &Raster) -> io::Result<Self> {
        if heights.data.len() != heights.width * heights.height {
            return Err(invalid("16-bit heights: values and size disagree"));
        }
        let Steps {
            values: steps,
            low,
            high,
        } = Steps::new(&heights.data)?;
        let cell = heights.cell() / KM;
        Ok(Self {
            steps,
            sidecar: Sidecar {
                width: heights.width,
                height: heights.height,
                metres_at_0: low,
                metres_at_65535: high,
                km_per_pixel: [cell.x, cell.y],
                row_origin: "north-west".to_owned(),
                pixel: "area".to_owned(),
                r16: "little-endian".to_owned(),
            },
        })
    }

    /// 16-bit grey PNG.
    ///
    /// # Errors
    /// Where `out` fails.
    pub fn write_png(&self, out: impl Write) -> io::Result<()> {
        write_png(out, (self.sidecar.width, self.sidecar.height), &self.steps)
    }

    /// Bare little-endian steps without a header.
    ///
    /// # Errors
    /// Where `out` fails.
    pub fn write_r16(&self, mut out: impl Write) -> io::Result<()> {
        for step in &self.steps {
            out.write_all(&step.to_le_bytes())?;
        }
        Ok(())
    }

    /// The sidecar as indented JSON.
    ///
    /// # Errors
    /// Where `out` fails.
    pub fn write_json(&self, mut out: impl Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut out, &self.sidecar)?;
        out.write_all(b"\n")
    }
}
