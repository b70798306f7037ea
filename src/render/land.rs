//! The land in a window: a quad in plan, a mesh under a sky aslant.

use glam::{DVec2, Vec3};
use wgpu::util::DeviceExt as _;

use super::camera::{Camera, plan_rect};
use super::growth::Growth;
use super::layout::{Air, RINGS, ROOM, View};
use super::passes::{self, Pipelines, Sheet, group};
use super::quality::RenderQuality;
use crate::gpu::Gpu;
use crate::picture::colour::{linear, smoothstep};
use crate::surface::Surface;
use crate::units::Extent;

/// How the land is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandStyle {
    /// Heights are multiplied by this in the oblique view, 1 to 5. The plan is never exaggerated; on the way from one
    /// to the other heights grow ([`LandStyle::drawn_exaggeration`]). To be printed wherever it is not 1.
    pub exaggeration: f32,
    /// How thick the air is: 0 none, 1 as usual.
    pub haze: f32,
    /// Part of the light that is left: 1 all, 0 dark.
    pub lamp: f32,
    /// Share of the geological map's colours, 0 (the land as it looks) to 1 (each layer in the colour of its
    /// [`Rock`](crate::rock::Rock)); to be moved from one to the other in half a second or so. While it moves, all colours
    /// are computed anew in each frame. Without effect where no layers are known.
    pub geology: f32,
}

impl Default for LandStyle {
    fn default() -> Self {
        Self {
            exaggeration: 1.8,
            haze: 1.0,
            lamp: 1.0,
            geology: 0.0,
        }
    }
}

impl LandStyle {
    /// How many times as high heights are drawn when the camera has so much tilt ([`Camera::tilt`]).
    pub fn drawn_exaggeration(&self, tilt: f64) -> f64 {
        1.0 + (f64::from(self.exaggeration) - 1.0) * tilt
    }
}

/// Colours of air and room, `0xRRGGBB`.
mod colours {
    /// Mist over low land.
    pub(super) const MIST: u32 = 0xb9_b3c0;
    /// The blue of distance.
    pub(super) const DISTANCE: u32 = 0x6f_8fbe;
    /// The sky low towards the sun.
    pub(super) const GLOW: u32 = 0xff_c585;
    /// The sky low elsewhere.
    pub(super) const HORIZON: u32 = 0xc7_b3bf;
    /// The sky above that.
    pub(super) const MIDDLE: u32 = 0x86_a3d0;
    /// The sky overhead.
    pub(super) const ZENITH: u32 = 0x2f_5190;
}

/// Tilt at which it is evening: the way down from the plan begins at noon.
const DUSK: f32 = 0.6;

/// Draws one land.
pub struct LandRenderer {
    quality: RenderQuality,
    encodes: bool,
    pipelines: Pipelines,
    growth: Growth,
    view: wgpu::Buffer,
    air: wgpu::Buffer,
    sampler: wgpu::Sampler,
    mesh: Option<Mesh>,
    depth: Option<(Sheet, Option<Sheet>)>,
    format: wgpu::TextureFormat,
    extent: Extent,
    scale: f32,
}

/// Triangles between the vertices that the shader places.
struct Mesh {
    indices: wgpu::Buffer,
    count: u32,
    cells: [u32; 2],
}

impl LandRenderer {
    /// A renderer without a land, for targets of `format`.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, quality: RenderQuality) -> Self {
        let device = &gpu.device;
        let rgb = |hex: u32| linear(hex).extend(1.0).to_array();
        let air = Air {
            mist: rgb(colours::MIST),
            distance: rgb(colours::DISTANCE),
            glow: rgb(colours::GLOW),
            horizon: rgb(colours::HORIZON),
            middle: rgb(colours::MIDDLE),
            zenith: rgb(colours::ZENITH),
            table: rgb(ROOM),
        };
        Self {
            quality,
            encodes: format.is_srgb(),
            pipelines: Pipelines::new(device, format, quality.light, quality.samples),
            growth: Growth::new(gpu, quality),
            view: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("view"),
                size: (size_of::<View>() as u64).next_multiple_of(16),
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            air: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("air"),
                contents: bytemuck::bytes_of(&air),
                usage: wgpu::BufferUsages::UNIFORM,
            }),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("sheet"),
                address_mode_u: wgpu::AddressMode::MirrorRepeat,
                address_mode_v: wgpu::AddressMode::MirrorRepeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                anisotropy_clamp: if gpu.is_software() { 1 } else { 8 },
                ..wgpu::SamplerDescriptor::default()
            }),
            mesh: None,
            depth: None,
            format,
            extent: Extent {
                width: 1.0,
                height: 1.0,
            },
            scale: 1.0,
        }
    }

    /// Takes a new land over; what is drawn grows towards it. The first one is there at once.
    pub fn show(&mut self, gpu: &Gpu, surface: &Surface) {
        self.extent = surface.height.extent;
        self.growth.show(gpu, surface);
    }

    /// The land that is shown next is another one, not this one some years later (fresh, undone, looked back at).
    pub fn leap(&mut self) {
        self.growth.leap();
    }

    /// Draws the land with so many texels per pixel along a side, 0.25 to 2.
    pub fn set_scale(&mut self, scale: f32) {
        self.scale = scale.clamp(0.25, 2.0);
    }

    /// True when what is drawn is the land that was shown last.
    pub fn settled(&self) -> bool {
        self.growth.settled()
    }

    /// Draws the land, `dt_s` seconds after the frame before, over all of a target of `size_px`.
    #[expect(
        clippy::too_many_arguments,
        reason = "where, what, how and when of one picture"
    )]
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        size_px: [u32; 2],
        camera: &Camera,
        style: &LandStyle,
        dt_s: f32,
    ) {
        let viewport = DVec2::from(size_px.map(f64::from));
        let (corner, size) = plan_rect(self.extent, viewport);
        let tilted = camera.tilt() > 0.0;
        let most = gpu.device.limits().max_texture_dimension_2d;
        let per_pixel = f64::from(self.scale * if tilted { self.quality.sheet_per_pixel } else { 1.0 });
        let texels = (size * per_pixel).round();
        let texels = [texels.x, texels.y].map(|side| (side as u32).clamp(16, most));
        self.growth.exaggerate(style.exaggeration);
        self.growth.show_geology(style.geology);
        self.growth
            .step(gpu, &self.pipelines, encoder, texels, dt_s, tilted);
        let cells = self.mesh_cells();
        let (half_width, half_height) = camera.half_view();
        let [right, up, forward] = camera.axes();
        let view = View {
            view_proj: camera.view_proj().as_mat4().to_cols_array_2d(),
            eye: camera.eye().as_vec3().extend(1.0).to_array(),
            right: (right * half_width).as_vec3().extend(0.0).to_array(),
            up: (up * half_height).as_vec3().extend(0.0).to_array(),
            forward: forward.as_vec3().extend(0.0).to_array(),
            extent: [self.extent.width as f32, self.extent.height as f32],
            mesh: cells.map(|cells| cells as f32),
            focus: self.densest(camera),
            gathering: self.quality.mesh_gathering,
            lowland: self.growth.lowland(),
            plan: clip_rect(corner, size, viewport),
            tilt: camera.tilt() as f32,
            exaggeration: style.drawn_exaggeration(camera.tilt()) as f32,
            haze: style.haze,
            lamp: style.lamp,
            encodes: f32::from(u8::from(self.encodes)),
            dusk: smoothstep(0.0, DUSK, camera.tilt() as f32),
            layered: f32::from(u8::from(self.growth.layered())),
        };
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        if tilted {
            self.draw_aslant(gpu, encoder, target, size_px, cells, camera.tilt() < 1.0);
        } else {
            self.draw_plan(gpu, encoder, target);
        }
    }

    fn looks(&self, gpu: &Gpu, pipeline: &wgpu::RenderPipeline, bindings: &[u32]) -> Option<wgpu::BindGroup> {
        let seen = self.growth.seen()?;
        let texture = wgpu::BindingResource::TextureView;
        let all = [
            (0, Some(self.view.as_entire_binding())),
            (1, Some(wgpu::BindingResource::Sampler(&self.sampler))),
            (2, Some(texture(seen.sheet))),
            (3, Some(texture(seen.stand))),
            (4, Some(self.air.as_entire_binding())),
            (5, seen.evening.map(texture)),
            (6, seen.rock.map(texture)),
            (7, Some(texture(seen.pile))),
        ];
        let entries: Vec<_> = all
            .into_iter()
            .filter(|(binding, _)| bindings.contains(binding))
            .map(|(binding, resource)| Some((binding, resource?)))
            .collect::<Option<_>>()?;
        Some(group(&gpu.device, pipeline, &entries))
    }

    fn draw_plan(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView) {
        let table = self.table_colour();
        let mut pass = passes::pass(encoder, "plan", &[target], wgpu::LoadOp::Clear(table));
        let Some(looks) = self.looks(gpu, &self.pipelines.plan, &[0, 1, 2]) else {
            return;
        };
        pass.set_pipeline(&self.pipelines.plan);
        pass.set_bind_group(0, &looks, &[]);
        pass.draw(0..4, 0..1);
    }

    fn draw_aslant(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        size_px: [u32; 2],
        cells: [u32; 2],
        dusk: bool,
    ) {
        let device = &gpu.device;
        if self.mesh.as_ref().is_none_or(|mesh| mesh.cells != cells) {
            self.mesh = Some(Mesh::new(device, cells));
        }
        if self.depth.as_ref().is_none_or(|(depth, _)| depth.size != size_px) {
            let samples = self.quality.samples;
            let depth = Sheet::with_samples(device, "depth", passes::DEPTH, size_px, samples);
            let colour =
                (samples > 1).then(|| Sheet::with_samples(device, "samples", self.format, size_px, samples));
            self.depth = Some((depth, colour));
        }
        let (Some(mesh), Some((depth, colour))) = (&self.mesh, &self.depth) else {
            return;
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("aslant"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: colour.as_ref().map_or(target, |colour| &colour.view),
                depth_slice: None,
                resolve_target: colour.as_ref().map(|_| target),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(self.table_colour()),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        let (pipeline, bindings): (_, &[u32]) = if dusk {
            (&self.pipelines.dusk, &[0, 1, 2, 3, 4, 5, 6, 7])
        } else {
            (&self.pipelines.terrain, &[0, 1, 3, 4, 5, 6, 7])
        };
        let (Some(sky), Some(land)) = (
            self.looks(gpu, &self.pipelines.sky, &[0, 4]),
            self.looks(gpu, pipeline, bindings),
        ) else {
            return;
        };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &land, &[]);
        pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..mesh.count, 0, 0..1);
        // Where no land is.
        pass.set_pipeline(&self.pipelines.sky);
        pass.set_bind_group(0, &sky, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Where the mesh is densest: at what the camera looks at, as parts of the land from its north-west corner.
    fn densest(&self, camera: &Camera) -> [f32; 2] {
        let at = camera.target().truncate() / self.extent.size();
        [at.x, 1.0 - at.y].map(|part| (part as f32).clamp(0.1, 0.9))
    }

    fn mesh_cells(&self) -> [u32; 2] {
        let columns = self.quality.mesh_columns;
        let rows = f64::from(columns) * self.extent.height / self.extent.width;
        [columns, (rows.round() as u32).clamp(1, 4 * columns)]
    }

    /// What is around the plan, as the target takes it.
    fn table_colour(&self) -> wgpu::Color {
        let hex = ROOM;
        let colour = if self.encodes {
            linear(hex)
        } else {
            Vec3::new(
                (hex >> 16 & 0xff) as f32,
                (hex >> 8 & 0xff) as f32,
                (hex & 0xff) as f32,
            ) / 255.0
        };
        wgpu::Color {
            r: f64::from(colour.x),
            g: f64::from(colour.y),
            b: f64::from(colour.z),
            a: 1.0,
        }
    }
}

/// Corner (lower left) and size in clip space of a rectangle of the viewport given by its top-left corner.
fn clip_rect(corner: DVec2, size: DVec2, viewport: DVec2) -> [f32; 4] {
    let low = DVec2::new(corner.x, viewport.y - corner.y - size.y) / viewport * 2.0 - 1.0;
    let size = size / viewport * 2.0;
    [low.x, low.y, size.x, size.y].map(|part| part as f32)
}

impl Mesh {
    /// Two triangles for each of `cells` and for the rings around them.
    fn new(device: &wgpu::Device, cells: [u32; 2]) -> Self {
        let [columns, rows] = cells.map(|cells| cells + 1 + 2 * RINGS);
        let mut indices = Vec::with_capacity(6 * ((columns - 1) * (rows - 1)) as usize);
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let corner = row * columns + column;
                let [a, b, c, d] = [corner, corner + 1, corner + columns, corner + columns + 1];
                indices.extend([a, c, b, b, c, d]);
            }
        }
        Self {
            indices: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("mesh"),
                contents: bytemuck::cast_slice(&indices),
                usage: wgpu::BufferUsages::INDEX,
            }),
            count: indices.len() as u32,
            cells,
        }
    }
}
