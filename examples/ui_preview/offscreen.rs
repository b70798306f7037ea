//! Runs an egui frame and draws it over a picture, without a window.

use std::error::Error;
use std::iter::once;

use egui::{
    ClippedPrimitive, Color32, ColorImage, Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect,
    TextureOptions, Vec2,
};
use egui_wgpu::wgpu;
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use image::RgbaImage;
use orogen::gpu::{Gpu, GpuError};

/// Draws egui's frames into pictures.
pub(crate) struct Offscreen {
    /// The graphics card, or the software one.
    pub(crate) gpu: Gpu,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

impl Offscreen {
    pub(crate) fn new() -> Result<Self, GpuError> {
        Gpu::offscreen().map(|gpu| Self { gpu })
    }

    /// Draws `scene` over `background`. The frame is run some times, so that what egui lays out in one pass is there in
    /// the next; between two of them a finger taps where `press` says.
    pub(crate) fn draw(
        &self,
        background: &RgbaImage,
        mut scene: impl FnMut(&Context, Rect),
        press: impl Fn(&Context) -> Option<Pos2>,
    ) -> Result<RgbaImage, Box<dyn Error>> {
        let (width, height) = background.dimensions();
        let context = Context::default();
        let screen = Rect::from_min_size(Pos2::ZERO, Vec2::new(width as f32, height as f32));
        let pixels =
            ColorImage::from_rgba_unmultiplied([width as usize, height as usize], background.as_raw());
        let land = context.load_texture("land", pixels, TextureOptions::NEAREST);
        let mut renderer = Renderer::new(&self.gpu.device, FORMAT, RendererOptions::default());
        let mut primitives = Vec::new();
        for pass in 0..6 {
            let tap = press(&context)
                .filter(|_| (2..4).contains(&pass))
                .map(|pos| Event::PointerButton {
                    pos,
                    button: PointerButton::Primary,
                    pressed: pass == 2,
                    modifiers: Modifiers::default(),
                });
            let input = RawInput {
                events: tap.into_iter().collect(),
                screen_rect: Some(screen),
                time: Some(f64::from(pass) * 0.3),
                ..RawInput::default()
            };
            let mut output = context.run_pass(input, |context| {
                let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                context.layer_painter(egui::LayerId::background()).image(
                    land.id(),
                    screen,
                    whole,
                    Color32::WHITE,
                );
                scene(context, screen);
            });
            #[expect(clippy::iter_over_hash_type, reason = "textures do not depend on each other")]
            for (id, images) in output.textures_delta.set.drain() {
                for image in images {
                    renderer.update_texture(&self.gpu.device, &self.gpu.queue, id, &image);
                }
            }
            primitives = context.tessellate(output.shapes, 1.0);
        }
        self.render(&mut renderer, &primitives, width, height)
    }

    fn render(
        &self,
        renderer: &mut Renderer,
        primitives: &[ClippedPrimitive],
        width: u32,
        height: u32,
    ) -> Result<RgbaImage, Box<dyn Error>> {
        let size = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let target = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let descriptor = ScreenDescriptor {
            size_in_pixels: [width, height],
            pixels_per_point: 1.0,
        };
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let buffers = renderer.update_buffers(
            &self.gpu.device,
            &self.gpu.queue,
            &mut encoder,
            primitives,
            &descriptor,
        );
        {
            let view = target.create_view(&wgpu::TextureViewDescriptor::default());
            let mut pass = encoder
                .begin_render_pass(&wgpu::RenderPassDescriptor {
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: &view,
                        resolve_target: None,
                        ops: wgpu::Operations::default(),
                        depth_slice: None,
                    })],
                    ..wgpu::RenderPassDescriptor::default()
                })
                .forget_lifetime();
            renderer.render(&mut pass, primitives, &descriptor);
        }
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row * height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        encoder.copy_texture_to_buffer(
            target.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            size,
        );
        self.gpu
            .queue
            .submit(buffers.into_iter().chain(once(encoder.finish())));
        buffer.slice(..).map_async(wgpu::MapMode::Read, |_| ());
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
        let bytes = buffer.slice(..).get_mapped_range()?;
        let pixels: Vec<u8> = bytes
            .chunks_exact(row as usize)
            .flat_map(|line| &line[..4 * width as usize])
            .copied()
            .collect();
        RgbaImage::from_raw(width, height, pixels).ok_or_else(|| "the picture has another size".into())
    }
}
