//! Pictures without a window.

use image::RgbaImage;

use super::camera::Camera;
use super::globe::{Disc, GlobeRenderer};
use super::land::{LandRenderer, LandStyle};
use super::passes::Sheet;
use super::quality::RenderQuality;
use crate::gpu::{Gpu, GpuError};
use crate::surface::Surface;
use crate::surface::planet::Planet;

/// How bytes of a pixel lie in pictures.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Most pixels along a side.
const MAX_SIDE: u32 = 8192;

/// The land as `camera` sees it, in the camera's size.
///
/// # Errors
/// When the size is more than the card can draw, or the card is lost meanwhile.
pub fn picture(
    gpu: &Gpu,
    surface: &Surface,
    camera: &Camera,
    style: &LandStyle,
    quality: RenderQuality,
) -> Result<RgbaImage, GpuError> {
    let size = camera.viewport_px().round();
    let mut canvas = Canvas::new(gpu, [size.x as u32, size.y as u32], quality)?;
    canvas.land.show(gpu, surface);
    canvas.draw(gpu, camera, style, 1.0)?;
    canvas.image(gpu)
}

/// A planet as `view` has it, on a picture of `size_px`.
///
/// # Errors
/// As [`picture`].
pub fn globe_picture(
    gpu: &Gpu,
    planet: &Planet,
    view: &Disc,
    size_px: [u32; 2],
) -> Result<RgbaImage, GpuError> {
    let target = target(gpu, size_px)?;
    let mut globe = GlobeRenderer::new(gpu, FORMAT);
    globe.show(gpu, planet);
    let mut encoder = encoder(gpu);
    globe.draw(gpu, &mut encoder, &target.view, size_px, view, 1.0);
    gpu.queue.submit([encoder.finish()]);
    done(gpu)?;
    image(gpu, &target)
}

/// A land and a picture to draw it into, frame after frame, as a window would.
pub struct Canvas {
    /// The land.
    pub land: LandRenderer,
    target: Sheet,
}

impl Canvas {
    /// A picture of so many pixels.
    ///
    /// # Errors
    /// When that is none, or more than the card can draw.
    pub fn new(gpu: &Gpu, size_px: [u32; 2], quality: RenderQuality) -> Result<Self, GpuError> {
        Ok(Self {
            target: target(gpu, size_px)?,
            land: LandRenderer::new(gpu, FORMAT, quality),
        })
    }

    /// Draws a frame, `dt_s` seconds after the one before, and waits until the card has done it.
    ///
    /// # Errors
    /// When the card refuses, or is lost.
    pub fn draw(&mut self, gpu: &Gpu, camera: &Camera, style: &LandStyle, dt_s: f32) -> Result<(), GpuError> {
        let mut encoder = encoder(gpu);
        let size_px = self.target.size;
        self.land
            .draw(gpu, &mut encoder, &self.target.view, size_px, camera, style, dt_s);
        gpu.queue.submit([encoder.finish()]);
        done(gpu)
    }

    /// The picture as it was drawn last.
    ///
    /// # Errors
    /// When the card refuses, or is lost.
    pub fn image(&self, gpu: &Gpu) -> Result<RgbaImage, GpuError> {
        image(gpu, &self.target)
    }
}

/// What a picture is drawn into.
fn target(gpu: &Gpu, size_px: [u32; 2]) -> Result<Sheet, GpuError> {
    let most = gpu.device.limits().max_texture_dimension_2d.min(MAX_SIDE);
    if size_px.iter().any(|side| !(1..=most).contains(side)) {
        let [width, height] = size_px;
        let refused = format!("a picture of {width} × {height} pixels; it draws 1 to {most} along a side");
        return Err(GpuError::Refused(refused));
    }
    Ok(Sheet::new(&gpu.device, "picture", FORMAT, size_px))
}

fn image(gpu: &Gpu, target: &Sheet) -> Result<RgbaImage, GpuError> {
    let [width, height] = target.size;
    RgbaImage::from_raw(width, height, read(gpu, target)?)
        .ok_or_else(|| GpuError::Refused("the picture came back incomplete".to_owned()))
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("picture"),
        })
}

/// Waits until the card has done what was submitted.
fn done(gpu: &Gpu) -> Result<(), GpuError> {
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|error| GpuError::Refused(error.to_string()))?;
    gpu.sound()
}

/// Brings the texels of `target` back, four bytes each.
fn read(gpu: &Gpu, target: &Sheet) -> Result<Vec<u8>, GpuError> {
    let [width, height] = target.size;
    let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = encoder(gpu);
    encoder.copy_texture_to_buffer(
        target.texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
        },
        target.texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    let (mapping, result) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |mapped| {
        // Nobody waits any more: then nobody misses it.
        let _ = mapping.send(mapped);
    });
    done(gpu)?;
    let refused = |why: &dyn std::fmt::Display| GpuError::Refused(why.to_string());
    result
        .recv()
        .map_err(|error| refused(&error))?
        .map_err(|error| refused(&error))?;
    let mapped = buffer.get_mapped_range(..).map_err(|error| refused(&error))?;
    let texels = mapped
        .chunks_exact(row as usize)
        .flat_map(|row| &row[..4 * width as usize])
        .copied()
        .collect();
    Ok(texels)
}
