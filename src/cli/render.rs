//! What the command line has of the graphics card: the land at evening, drawn by the table's own renderer, and stages.

use std::io::Write as _;
use std::sync::Arc;

use glam::DVec2;

use super::PictureChoice;
use super::console::Console;
use super::failure::Failure;
use super::output::png;
use crate::export::OutDir;
use crate::gpu::{Gpu, GpuError, GpuFolds, GpuTransport};
use crate::mountain::Stages;
use crate::render::{Camera, Focus, LandStyle, RenderQuality, flight, picture};
use crate::surface::Surface;

/// What the picture is called.
pub(super) const FILE: &str = "render.png";
/// Width over height of the picture, as screens have it.
const ASPECT: f64 = 16.0 / 9.0;
/// Most pixels along its width: more than that nobody looks at.
const WIDEST: f64 = 3840.0;
/// What helps where nothing can draw.
const REMEDY: &str =
    "install a Vulkan driver (mesa-vulkan-drivers draws without a graphics card), or use `--picture map`";
/// What helps where nothing can compute.
const STAGES_REMEDY: &str = "install a Vulkan driver, or use `--stages cpu`";

/// What draws the picture, if `choice` wants one.
pub(super) fn adapter(choice: PictureChoice) -> Result<Option<Gpu>, Failure> {
    if !matches!(choice, PictureChoice::Render | PictureChoice::Both) {
        return Ok(None);
    }
    match Gpu::offscreen() {
        Ok(gpu) => Ok(Some(gpu)),
        Err(error) if choice == PictureChoice::Both => {
            Console::warn(&format!("no {FILE}: {error}; {REMEDY}"));
            Ok(None)
        }
        Err(error) => Err(Failure::no_display(format!("{error}; {REMEDY}"))),
    }
}

/// Stages on the best adapter.
pub(super) fn stages() -> Result<Stages, Failure> {
    let on_card = || -> Result<Stages, GpuError> {
        let gpu = Arc::new(Gpu::computing()?);
        Ok(Stages {
            transport: Box::new(GpuTransport::new(&gpu)?),
            folds: Box::new(GpuFolds::new(&gpu)?),
        })
    };
    on_card().map_err(|error| Failure::no_display(format!("{error}; {STAGES_REMEDY}")))
}

/// Draws the land as the flight over it begins, as wide as `surface` has columns, or 4K.
pub(super) fn write(gpu: &Gpu, surface: &Surface, out: &OutDir) -> Result<(), Failure> {
    let width = (surface.height.width as f64).min(WIDEST);
    let viewport = DVec2::new(width, (width / ASPECT).round());
    let style = LandStyle::default();
    let eye = flight(&Focus::of(surface), &style, 0.0);
    let camera = Camera::between(surface.height.extent, viewport, &eye, 1.0);
    let image = picture(gpu, surface, &camera, &style, RenderQuality::PICTURE).map_err(Failure::other)?;
    let png = png(&image)?;
    out.write(FILE, |w| w.write_all(&png))
        .map(drop)
        .map_err(Failure::other)
}
