//! The pictures of a computed land: the relief map, and the view in perspective where there are graphics.

use std::io::{Cursor, Write};

use image::{ImageFormat, RgbaImage};

use super::PictureChoice;
#[cfg(feature = "app")]
use super::console::Console;
use super::failure::Failure;
use crate::export::OutDir;
#[cfg(feature = "app")]
use crate::gpu::Gpu;
use crate::picture::{MapStyle, relief_map};
#[cfg(feature = "app")]
use crate::render::{Camera, Focus, LandStyle, RenderQuality, flight};
use crate::surface::Surface;

/// The relief map's file.
const MAP: &str = "picture.png";
/// The file of the view in perspective.
#[cfg(feature = "app")]
const RENDER: &str = "render.png";

/// What can be drawn on this machine of what was asked for.
#[derive(Debug)]
pub(super) struct Pictures {
    map: bool,
    #[cfg(feature = "app")]
    card: Option<Gpu>,
}

impl Pictures {
    /// The relief map alone, which can be drawn everywhere.
    #[cfg(feature = "app")]
    pub(super) const MAP: Self = Self {
        map: true,
        card: None,
    };

    /// Looks for graphics where the choice needs them: before the work, so that a choice that cannot be met costs no
    /// waiting. `size` is the pictures' width in pixels.
    pub(super) fn new(
        choice: PictureChoice,
        #[cfg_attr(not(feature = "app"), expect(unused))] size: u32,
    ) -> Result<Self, Failure> {
        Ok(Self {
            map: choice.has_map(),
            #[cfg(feature = "app")]
            card: card(choice, size)?,
        })
    }

    /// Draws `surface` into `out`. Yields the map without marks and letters, for the mesh to wear, where there is a
    /// map.
    pub(super) fn write(
        &self,
        out: &OutDir,
        surface: &Surface,
        title: &str,
    ) -> Result<Option<Vec<u8>>, Failure> {
        #[cfg(feature = "app")]
        if let Some(gpu) = &self.card {
            let image = in_perspective(gpu, surface).map_err(Failure::other)?;
            put(out, RENDER, &png(&image)?)?;
        }
        if !self.map {
            return Ok(None);
        }
        put(out, MAP, &map_png(surface, title)?)?;
        // The mesh wears the land alone, to the edge.
        let bare = MapStyle {
            marks: false,
            lettering: false,
            ..MapStyle::default()
        };
        map(surface, &bare).map(Some)
    }

    /// The files that were drawn; `other` where none was.
    pub(super) fn shown<'a>(&self, other: &'a str) -> Vec<&'a str> {
        let mut shown = Vec::new();
        if self.map {
            shown.push(MAP);
        }
        #[cfg(feature = "app")]
        if self.card.is_some() {
            shown.push(RENDER);
        }
        if shown.is_empty() {
            shown.push(other);
        }
        shown
    }
}

/// The map of a surface with its title, as large as the surface's rasters.
pub(super) fn map_png(surface: &Surface, title: &str) -> Result<Vec<u8>, Failure> {
    let style = MapStyle {
        title: title.to_owned(),
        ..MapStyle::default()
    };
    map(surface, &style)
}

fn map(surface: &Surface, style: &MapStyle) -> Result<Vec<u8>, Failure> {
    let [width, height] = size_of(surface);
    png(&relief_map(surface, style, width, height))
}

/// Pixels of the pictures: one for each cell of the rasters.
fn size_of(surface: &Surface) -> [u32; 2] {
    [surface.height.width as u32, surface.height.height as u32]
}

fn png(image: &RgbaImage) -> Result<Vec<u8>, Failure> {
    let mut png = Cursor::new(Vec::new());
    image
        .write_to(&mut png, ImageFormat::Png)
        .map_err(Failure::other)?;
    Ok(png.into_inner())
}

fn put(out: &OutDir, name: &str, bytes: &[u8]) -> Result<(), Failure> {
    out.write(name, |w| w.write_all(bytes))
        .map(drop)
        .map_err(Failure::other)
}

/// The graphics card, if the choice needs one. Without it a choice that also has the map goes on with a warning.
#[cfg(feature = "app")]
fn card(choice: PictureChoice, size: u32) -> Result<Option<Gpu>, Failure> {
    if !choice.has_render() {
        return Ok(None);
    }
    let failure = match Gpu::offscreen() {
        Ok(gpu) => {
            let most = gpu.device.limits().max_texture_dimension_2d.min(MOST_PIXELS);
            if size <= most {
                return Ok(Some(gpu));
            }
            Failure::Input(format!("--size {size}: expected at most {most} for {RENDER}"))
        }
        Err(error) => Failure::NoDisplay(format!(
            "{RENDER}: {error}; install a Vulkan or OpenGL driver (Debian: mesa-vulkan-drivers), or ask for \
             --picture map"
        )),
    };
    if choice.has_map() {
        Console::warn(&failure.to_string());
        return Ok(None);
    }
    Err(failure)
}

/// Largest side of a view in perspective, pixels.
#[cfg(feature = "app")]
const MOST_PIXELS: u32 = 8192;

/// Pixels up to which the land's colours are computed more finely than the picture; above, their textures would be
/// larger than what cards promise.
#[cfg(feature = "app")]
const FINE_PIXELS: u32 = 4096;

/// The land from where the table's flight first looks at it.
#[cfg(feature = "app")]
fn in_perspective(gpu: &Gpu, surface: &Surface) -> Result<RgbaImage, crate::gpu::GpuError> {
    let [width, height] = size_of(surface);
    let viewport = glam::DVec2::new(f64::from(width), f64::from(height));
    let style = LandStyle::default();
    let eye = flight(&Focus::of(surface), &style, 0.0);
    let camera = Camera::between(surface.height.extent, viewport, &eye, 1.0);
    let quality = RenderQuality {
        sheet_per_pixel: if width.max(height) > FINE_PIXELS {
            1.0
        } else {
            RenderQuality::PICTURE.sheet_per_pixel
        },
        ..RenderQuality::PICTURE
    };
    crate::render::picture(gpu, surface, &camera, &style, quality)
}
