//! A planet from two images: its heights, and its plates as areas of one colour each.
//!
//! Both are equirectangular: twice as wide as high, the north pole along the upper edge, the meridian of 180° at both sides,
//! the prime meridian in the middle. They need not have the same size.

use std::collections::{BTreeMap, VecDeque};
use std::io::Cursor;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use glam::DVec3;
use image::codecs::{openexr::OpenExrDecoder, png::PngDecoder};
use image::{DynamicImage, ImageDecoder, ImageError};
use rayon::prelude::*;

use super::maps::{
    MapFault, MapFormat, MapKind, check_size, check_values, decode_exr, decode_png, file_bytes, format_of,
};
use crate::sphere::{Lattice, latitude_longitude};
use crate::surface::Raster;

/// Widths that are read, pixels: from twelve degrees per pixel to five kilometres.
pub const WIDTH_RANGE: RangeInclusive<usize> = 32..=8192;

/// Heights that are taken, metres.
pub const HEIGHT_RANGE_M: RangeInclusive<f32> = -12_000.0..=12_000.0;

/// Most plates of an image.
pub const MAX_PLATES: usize = 256;

/// Fewest samples of a plate. A colour that has fewer is a stray.
pub const LEAST_SAMPLES: usize = 12;

/// A colour's red, green and blue.
type Colour = [u16; 3];

/// Why there is no planet from a pair of images. Every message names the file and what was expected.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", file.display())]
pub struct PlanetError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong with it.
    pub fault: PlanetFault,
}

/// What can be wrong with an image of a planet.
#[derive(Debug, thiserror::Error)]
pub enum PlanetFault {
    /// It cannot be read as an image, or holds values that are no heights.
    #[error(transparent)]
    Map(#[from] MapFault),
    /// Not twice as wide as high, too small or too large.
    #[error(
        "{width} × {height} pixels; expected an equirectangular image, twice as wide as high, {} to {} pixels wide",
        WIDTH_RANGE.start(),
        WIDTH_RANGE.end()
    )]
    Shape {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The metres of black and white are no numbers, or beyond [`HEIGHT_RANGE_M`].
    #[error(
        "black at {black} m and white at {white} m; expected heights from {} to {} m",
        HEIGHT_RANGE_M.start(),
        HEIGHT_RANGE_M.end()
    )]
    Scale {
        /// Metres of black.
        black: f64,
        /// Metres of white.
        white: f64,
    },
    /// No colour covers an area.
    #[error("no area of one colour has {LEAST_SAMPLES} samples; expected a plate in a colour of its own")]
    NoPlates,
    /// More colours cover areas than there may be plates.
    #[error("areas of {0} colours; expected one colour for each of at most {MAX_PLATES} plates")]
    TooManyColours(usize),
}

/// A planet's heights and plates on the samples of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanetMaps {
    /// Height above the sea, metres.
    pub elevation_m: Vec<f32>,
    /// Number of the plate, from 0 on without holes, in the order of their colours (red, then green, then blue).
    pub plate: Vec<u16>,
}

/// Reads a planet from its two images. `png_metres` are the heights of black and of white where the heights are a PNG.
///
/// # Errors
/// [`PlanetError`] with the file and what was expected.
pub fn read_planet(
    elevation: &Path,
    plates: &Path,
    png_metres: [f64; 2],
    lattice: &Lattice,
) -> Result<PlanetMaps, PlanetError> {
    let blame = |file: &Path| {
        let file = file.to_owned();
        |fault: PlanetFault| PlanetError { file, fault }
    };
    let heights = file_bytes(elevation)
        .map_err(PlanetFault::from)
        .and_then(|bytes| Heights::decode(&bytes, png_metres))
        .map_err(blame(elevation))?;
    let plate = file_bytes(plates)
        .map_err(PlanetFault::from)
        .and_then(|bytes| Colours::decode(&bytes)?.on(lattice))
        .map_err(blame(plates))?;
    Ok(PlanetMaps {
        elevation_m: heights.on(lattice),
        plate,
    })
}

/// An image of a planet's heights.
#[derive(Clone, Debug)]
pub struct Heights(Raster);

impl Heights {
    /// Heights from the bytes of a file.
    ///
    /// * EXR: metres, in the channel `height_m`, else as [`read_map`](super::maps::read_map) says.
    /// * PNG, 8 or 16 bits, grey or colour (its luminance): from `png_metres[0]` at black to `png_metres[1]` at white.
    ///
    /// # Errors
    /// Where it is no such image, or a height is outside [`HEIGHT_RANGE_M`].
    pub fn decode(bytes: &[u8], png_metres: [f64; 2]) -> Result<Self, PlanetFault> {
        let mut raster = match format_of(bytes)? {
            MapFormat::Exr => decode_exr(bytes, MapKind::Start)?,
            MapFormat::Png => {
                let [black, white] = png_metres;
                let is_height = |metres: f64| HEIGHT_RANGE_M.contains(&(metres as f32));
                if !is_height(black) || !is_height(white) {
                    return Err(PlanetFault::Scale { black, white });
                }
                let mut raster = decode_png(bytes)?;
                for value in &mut raster.data {
                    *value = (black + (white - black) * f64::from(*value)) as f32;
                }
                raster
            }
        };
        check_shape(raster.width, raster.height)?;
        check_values(
            &raster,
            "elevation",
            (*HEIGHT_RANGE_M.start(), *HEIGHT_RANGE_M.end()),
        )?;
        // −0 and 0 are one value.
        for value in &mut raster.data {
            *value += 0.0;
        }
        Ok(Self(raster))
    }

    /// Height at each sample, metres: the mean over a square as wide as the lattice's spacing, or as a pixel where that is
    /// wider, which is then the same as going straight between the nearest four.
    pub fn on(&self, lattice: &Lattice) -> Vec<f32> {
        let raster = &self.0;
        let spacing_px = lattice.spacing() / std::f64::consts::PI * raster.height as f64;
        let height = |p: &DVec3| {
            let (column, row) = pixel(*p, raster.width, raster.height);
            // Meridians meet at the poles.
            let cos_latitude = p.x.hypot(p.y).max(1e-9);
            let columns = (spacing_px / cos_latitude).clamp(1.0, raster.width as f64);
            mean(raster, [column, row], [columns, spacing_px.max(1.0)])
        };
        lattice.points().par_iter().map(height).collect()
    }
}

/// An image whose plates are areas of one colour each.
#[derive(Clone, Debug)]
pub struct Colours {
    width: usize,
    pixels: Vec<Colour>,
}

impl Colours {
    /// Colours from the bytes of a PNG or an EXR file. Transparency is ignored; EXR colours count from 0 to 1, in steps of
    /// 1/65,535.
    ///
    /// # Errors
    /// Where it is no such image.
    pub fn decode(bytes: &[u8]) -> Result<Self, PlanetFault> {
        let image = match format_of(bytes)? {
            MapFormat::Exr => decode_image("EXR", OpenExrDecoder::new(Cursor::new(bytes))),
            MapFormat::Png => decode_image("PNG", PngDecoder::new(Cursor::new(bytes))),
        }?;
        check_shape(image.width() as usize, image.height() as usize)?;
        let image = image.into_rgb16();
        Ok(Self {
            width: image.width() as usize,
            pixels: image.pixels().map(|pixel| pixel.0).collect(),
        })
    }

    /// Plate of each sample, numbered in the order of their colours.
    ///
    /// A colour is a plate where it covers an area: [`LEAST_SAMPLES`] samples, and at least one pixel with only its own
    /// like around. Other colours are strays, as smoothed edges leave them; their samples join the nearest plate.
    ///
    /// # Errors
    /// Where no colour is a plate, or more than [`MAX_PLATES`] are.
    pub fn on(&self, lattice: &Lattice) -> Result<Vec<u16>, PlanetFault> {
        let height = self.width / 2;
        let seen: Vec<(Colour, bool)> = lattice
            .points()
            .par_iter()
            .map(|&p| {
                let (column, row) = pixel(p, self.width, height);
                let column = column.round().rem_euclid(self.width as f64) as usize;
                let row = (row.round().max(0.0) as usize).min(height - 1);
                (
                    self.pixels[row * self.width + column],
                    self.is_inside(column, row),
                )
            })
            .collect();
        let mut found: BTreeMap<Colour, (usize, bool)> = BTreeMap::new();
        for &(colour, inside) in &seen {
            let entry = found.entry(colour).or_default();
            entry.0 += 1;
            entry.1 |= inside;
        }
        found.retain(|_, (samples, inside)| *inside && *samples >= LEAST_SAMPLES);
        match found.len() {
            0 => return Err(PlanetFault::NoPlates),
            1..=MAX_PLATES => {}
            many => return Err(PlanetFault::TooManyColours(many)),
        }
        let plates: BTreeMap<Colour, u16> = found.into_keys().zip(0..).collect();
        let mut plate: Vec<Option<u16>> = seen
            .iter()
            .map(|(colour, _)| plates.get(colour).copied())
            .collect();
        let mut open: VecDeque<(u32, u16)> = (0_u32..)
            .zip(&plate)
            .filter_map(|(i, plate)| Some((i, (*plate)?)))
            .collect();
        while let Some((i, number)) = open.pop_front() {
            for &n in lattice.neighbours(i) {
                if plate[n as usize].is_none() {
                    plate[n as usize] = Some(number);
                    open.push_back((n, number));
                }
            }
        }
        // The lattice is connected and there is a plate, so everyone has been reached.
        Ok(plate.into_iter().flatten().collect())
    }

    /// True for pixels whose eight neighbours have their colour.
    fn is_inside(&self, column: usize, row: usize) -> bool {
        let (width, height) = (self.width, self.width / 2);
        let colour = self.pixels[row * width + column];
        (row.saturating_sub(1)..=(row + 1).min(height - 1)).all(|row| {
            let columns = [column + width - 1, column, column + 1];
            columns
                .iter()
                .all(|c| self.pixels[row * width + c % width] == colour)
        })
    }
}

fn check_shape(width: usize, height: usize) -> Result<(), PlanetFault> {
    if WIDTH_RANGE.contains(&width) && width == 2 * height {
        Ok(())
    } else {
        Err(PlanetFault::Shape { width, height })
    }
}

fn decode_image<D: ImageDecoder>(
    format: &'static str,
    decoder: Result<D, ImageError>,
) -> Result<DynamicImage, PlanetFault> {
    let broken = |error: ImageError| MapFault::Broken {
        format,
        reason: error.to_string(),
    };
    let decoder = decoder.map_err(broken)?;
    let (width, height) = decoder.dimensions();
    // Sizes are checked before anything is allocated for pixels.
    check_shape(width as usize, height as usize)?;
    let channels = u64::from(decoder.color_type().channel_count());
    check_size(u64::from(width), u64::from(height), channels)?;
    Ok(DynamicImage::from_decoder(decoder).map_err(broken)?)
}

/// Where a direction is in an image, in pixels from the middle of the first one: column and row.
fn pixel(p: DVec3, width: usize, height: usize) -> (f64, f64) {
    let (latitude, longitude) = latitude_longitude(p);
    (
        (longitude + 180.0) / 360.0 * width as f64 - 0.5,
        (90.0 - latitude) / 180.0 * height as f64 - 0.5,
    )
}

/// Value of a pixel. Columns go around; beyond a pole the image goes on along the opposite meridian.
fn at(raster: &Raster, column: i64, row: i64) -> f64 {
    let (width, height) = (raster.width as i64, raster.height as i64);
    let (row, turn) = if row < 0 {
        (-1 - row, width / 2)
    } else if row >= height {
        (2 * height - 1 - row, width / 2)
    } else {
        (row, 0)
    };
    let column = (column + turn).rem_euclid(width);
    f64::from(raster.data[(row * width + column) as usize])
}

/// Mean over a rectangle of `columns` × `rows` pixels around a place.
fn mean(raster: &Raster, [column, row]: [f64; 2], [columns, rows]: [f64; 2]) -> f32 {
    let sum: f64 = shares(row, rows)
        .flat_map(|(r, share)| shares(column, columns).map(move |(c, part)| at(raster, c, r) * part * share))
        .sum();
    (sum / (columns * rows)) as f32
}

/// Pixels that an interval of `width` around `centre` touches, and how much of each.
fn shares(centre: f64, width: f64) -> impl Iterator<Item = (i64, f64)> {
    let (low, high) = (centre - width / 2.0, centre + width / 2.0);
    (low.round() as i64..=high.round() as i64).map(move |k| {
        let (from, to) = (low.max(k as f64 - 0.5), high.min(k as f64 + 0.5));
        (k, (to - from).max(0.0))
    })
}
