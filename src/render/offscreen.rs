//! Pictures without a window.

use image::RgbaImage;

use super::camera::Camera;
use super::land::{LandRenderer, LandStyle};
use super::passes::Sheet;
use super::quality::RenderQuality;
use crate::gpu::{Gpu, GpuError};
use crate::surface::Surface;

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
    let (width, height) = (size.x as u32, size.y as u32);
    let most = gpu.device.limits().max_texture_dimension_2d.min(MAX_SIDE);
    if width > most || height > most {
        let refused = format!("a picture of {width} × {height} pixels; it draws {most} along a side");
        return Err(GpuError::Refused(refused));
    }
    let mut land = LandRenderer::new(gpu, FORMAT, quality);
    land.show(gpu, surface);
    let target = Sheet::new(&gpu.device, "picture", FORMAT, [width, height]);
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("picture"),
        });
    land.draw(
        gpu,
        &mut encoder,
        &target.view,
        [width, height],
        camera,
        style,
        1.0,
    );
    let pixels = read(gpu, encoder, &target)?;
    RgbaImage::from_raw(width, height, pixels)
        .ok_or_else(|| GpuError::Refused("the picture came back incomplete".to_owned()))
}

/// Runs what is encoded and brings the texels of `target` back, four bytes each.
fn read(gpu: &Gpu, mut encoder: wgpu::CommandEncoder, target: &Sheet) -> Result<Vec<u8>, GpuError> {
    let [width, height] = target.size;
    let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
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
    let (done, result) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |mapped| {
        // Nobody waits any more: then nobody misses it.
        let _ = done.send(mapped);
    });
    let refused = |why: &dyn std::fmt::Display| GpuError::Refused(why.to_string());
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|error| refused(&error))?;
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
