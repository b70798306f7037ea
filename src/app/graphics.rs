//! The window's picture: surface, land and what lies on top, frame by frame, through losses of surface and device.

use std::sync::Arc;

use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::worlds::Worlds;
use crate::gesture::command::Mode;
use crate::gpu::{Gpu, GpuError};
use crate::render::{Camera, Disc, GlobeRenderer, LandRenderer, LandStyle, RenderQuality};
use crate::surface::planet::Planet;

/// Least time between two lands on a software adapter, s: taking one over costs as much as a frame, and growth makes a
/// smooth motion of fewer.
const SOFTWARE_LAND_S: f64 = 0.12;

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// It is on its way to the screen.
    Presented,
    /// The window is hidden or just changing; the next one may do better.
    Skipped,
    /// The device is gone: everything on it must be made anew.
    DeviceLost,
}

/// What egui wants drawn on top.
#[derive(Debug)]
pub(super) struct Overlay {
    pub(super) textures: egui::TexturesDelta,
    pub(super) shapes: Vec<egui::ClippedPrimitive>,
    pub(super) pixels_per_point: f32,
}

/// What lies below the overlay of a frame.
#[derive(Debug)]
pub(super) struct Scene<'a> {
    pub(super) camera: &'a Camera,
    pub(super) style: &'a LandStyle,
    /// Where the planet is, while it is shown instead of the land.
    pub(super) disc: Option<Disc>,
    /// Seconds since the frame before.
    pub(super) dt_s: f32,
}

/// All that lives on the graphics card for one window.
pub(super) struct Graphics {
    window: Arc<Window>,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    gpu: Gpu,
    config: wgpu::SurfaceConfiguration,
    land: LandRenderer,
    /// Made when the planet is shown for the first time.
    globe: Option<GlobeRenderer>,
    scale: f32,
    /// The world in the picture, and which of its lands.
    shown: Option<(Mode, u64)>,
    /// How old the mountain was, years, and when something was taken over, s.
    shown_yr: f64,
    shown_s: f64,
    overlay: egui_wgpu::Renderer,
    /// The surface must be made anew before the next frame.
    surface_lost: bool,
}

impl Graphics {
    /// Finds an adapter that can show pictures in the window, Vulkan or the system's own first, else GL.
    ///
    /// # Errors
    /// When there is none.
    pub(super) fn new(window: &Arc<Window>, display: &OwnedDisplayHandle) -> Result<Self, GpuError> {
        Self::with(crate::gpu::instance(Some(Box::new(display.clone()))), window).or_else(|first| {
            let fallback = crate::gpu::fallback_instance(Some(Box::new(display.clone())));
            Self::with(fallback, window).map_err(|_| first)
        })
    }

    fn with(instance: wgpu::Instance, window: &Arc<Window>) -> Result<Self, GpuError> {
        let surface = instance
            .create_surface(Arc::clone(window))
            .map_err(|error| GpuError::Surface(error.to_string()))?;
        let gpu = Gpu::for_window(&instance, &surface)?;
        let size = window.inner_size();
        let config = configuration(&surface, &gpu, [size.width, size.height])?;
        surface.configure(&gpu.device, &config);
        let quality = if gpu.is_software() {
            RenderQuality::SOFTWARE
        } else {
            RenderQuality::HIGH
        };
        let land = LandRenderer::new(&gpu, config.format, quality);
        let overlay =
            egui_wgpu::Renderer::new(&gpu.device, config.format, egui_wgpu::RendererOptions::default());
        tracing::info!(
            "drawing with {} ({}), {:?}, {:?}",
            gpu.info.name,
            gpu.info.backend,
            config.format,
            config.present_mode
        );
        Ok(Self {
            window: Arc::clone(window),
            instance,
            surface,
            gpu,
            config,
            land,
            globe: None,
            scale: 1.0,
            shown: None,
            shown_yr: 0.0,
            shown_s: f64::NEG_INFINITY,
            overlay,
            surface_lost: false,
        })
    }

    /// The graphics card.
    pub(super) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Size of the picture, pixels.
    pub(super) fn size_px(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// The window has another size now.
    pub(super) fn resize(&mut self, width: u32, height: u32) {
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        let (width, height) = (width.clamp(1, most), height.clamp(1, most));
        if [width, height] != self.size_px() {
            (self.config.width, self.config.height) = (width, height);
            self.surface.configure(&self.gpu.device, &self.config);
        }
    }

    /// Part of the window's resolution at which the land is drawn from now on.
    pub(super) fn set_scale(&mut self, scale: f32) {
        self.scale = scale;
        self.land.set_scale(scale);
    }

    fn show_planet(&mut self, planet: &Planet) {
        let (gpu, format) = (&self.gpu, self.config.format);
        let globe = self.globe.get_or_insert_with(|| GlobeRenderer::new(gpu, format));
        globe.show(gpu, planet);
    }

    /// Takes over what the session of the world that is shown has drawn anew; `now_s` is the table's time. A land grows
    /// into the picture.
    pub(super) fn follow(&mut self, worlds: &Worlds, now_s: f64) {
        let now = (worlds.shown(), worlds.land());
        let turned = self.shown.is_none_or(|(mode, _)| mode != now.0);
        let rests = self.gpu.is_software() && now_s - self.shown_s < SOFTWARE_LAND_S;
        if self.shown == Some(now) || (rests && !turned) {
            return;
        }
        self.shown = Some(now);
        self.shown_s = now_s;
        if let Some(globe) = worlds.globe() {
            self.show_planet(&globe.planet);
            return;
        }
        let surface = &worlds.mountain().surface;
        if surface.elapsed_yr < self.shown_yr {
            // It is another one, not the last some years later.
            self.land.leap();
        }
        self.land.show(&self.gpu, surface);
        self.shown_yr = surface.elapsed_yr;
    }

    /// Draws a frame and presents it.
    pub(super) fn draw(&mut self, scene: &Scene<'_>, mut overlay: Overlay) -> Shown {
        if self.gpu.lost() || (self.surface_lost && !self.renew_surface()) {
            // egui insists that changes of textures are taken or given up.
            overlay.textures.clear();
            return Shown::DeviceLost;
        }
        let (texture, suboptimal) = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture) => (texture, false),
            wgpu::CurrentSurfaceTexture::Suboptimal(texture) => (texture, true),
            wgpu::CurrentSurfaceTexture::Outdated => {
                let size = self.window.inner_size();
                self.resize(size.width, size.height);
                self.surface.configure(&self.gpu.device, &self.config);
                return self.skip(overlay);
            }
            wgpu::CurrentSurfaceTexture::Lost => {
                self.surface_lost = true;
                return self.skip(overlay);
            }
            wgpu::CurrentSurfaceTexture::Timeout
            | wgpu::CurrentSurfaceTexture::Occluded
            | wgpu::CurrentSurfaceTexture::Validation => return self.skip(overlay),
        };
        let view = texture
            .texture
            .create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        let size_px = self.size_px();
        match (&scene.disc, &mut self.globe) {
            (Some(disc), Some(globe)) => {
                globe.set_scale(self.scale);
                globe.draw(&self.gpu, &mut encoder, &view, size_px, disc, scene.style.lamp);
            }
            _ => self.land.draw(
                &self.gpu,
                &mut encoder,
                &view,
                size_px,
                scene.camera,
                scene.style,
                scene.dt_s,
            ),
        }
        let mut commands = self.draw_overlay(&mut encoder, &view, overlay);
        commands.push(encoder.finish());
        self.gpu.queue.submit(commands);
        self.window.pre_present_notify();
        self.gpu.queue.present(texture);
        if suboptimal {
            self.surface.configure(&self.gpu.device, &self.config);
        }
        Shown::Presented
    }

    /// Keeps what egui changed in its textures for a frame that could not be shown.
    fn skip(&mut self, mut overlay: Overlay) -> Shown {
        self.take_textures(&mut overlay.textures);
        self.free_textures(&mut overlay.textures);
        Shown::Skipped
    }

    fn draw_overlay(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        mut overlay: Overlay,
    ) -> Vec<wgpu::CommandBuffer> {
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: self.size_px(),
            pixels_per_point: overlay.pixels_per_point,
        };
        self.take_textures(&mut overlay.textures);
        let commands = self.overlay.update_buffers(
            &self.gpu.device,
            &self.gpu.queue,
            encoder,
            &overlay.shapes,
            &screen,
        );
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("overlay"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Load,
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..wgpu::RenderPassDescriptor::default()
            })
            .forget_lifetime();
        self.overlay.render(&mut pass, &overlay.shapes, &screen);
        drop(pass);
        self.free_textures(&mut overlay.textures);
        commands
    }

    fn take_textures(&mut self, delta: &mut egui::TexturesDelta) {
        let mut all: Vec<_> = delta.set.drain().collect();
        all.sort_by_key(|(id, _)| *id);
        for (id, changes) in all {
            for change in changes {
                self.overlay
                    .update_texture(&self.gpu.device, &self.gpu.queue, id, &change);
            }
        }
    }

    fn free_textures(&mut self, delta: &mut egui::TexturesDelta) {
        let mut all: Vec<_> = delta.free.drain().collect();
        all.sort_unstable();
        for id in &all {
            self.overlay.free_texture(id);
        }
    }

    /// A new surface for the same window; false when the system gives none.
    fn renew_surface(&mut self) -> bool {
        match self.instance.create_surface(Arc::clone(&self.window)) {
            Ok(surface) => {
                surface.configure(&self.gpu.device, &self.config);
                self.surface = surface;
                self.surface_lost = false;
                tracing::warn!("the window's surface was lost and made anew");
                true
            }
            Err(error) => {
                tracing::error!("no new surface: {error}");
                false
            }
        }
    }
}

/// Vertical sync, one frame in flight, and a format that takes gamma-encoded colours as they are.
fn configuration(
    surface: &wgpu::Surface<'_>,
    gpu: &Gpu,
    [width, height]: [u32; 2],
) -> Result<wgpu::SurfaceConfiguration, GpuError> {
    let mut config = surface
        .get_default_config(&gpu.adapter, width.max(1), height.max(1))
        .ok_or_else(|| GpuError::Surface("the adapter cannot draw into the window".to_owned()))?;
    let formats = surface.get_capabilities(&gpu.adapter).formats;
    let plain = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
    config.format = plain
        .into_iter()
        .find(|format| formats.contains(format))
        .unwrap_or(config.format);
    config.present_mode = wgpu::PresentMode::AutoVsync;
    config.desired_maximum_frame_latency = 1;
    Ok(config)
}
