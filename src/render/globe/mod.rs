//! The planet in a window: a disc, each pixel of which looks its place up by direction.
//!
//! No mesh is drawn: the samples lie in the faces of a cube, so that a planet costs by the pixel, on a software adapter
//! too. A first pass finds heights, with detail finer than the samples that travels with the plates; a second one lights
//! and colours them. Both are left out while nothing changes.

mod atlas;

use bytemuck::Zeroable as _;
use glam::{DMat3, DQuat, DVec2, DVec3};

use super::layout::{self, DISC_CORNERS, FINEST_DETAIL, Frames, Globe, PLANET_DETAIL, ROOM};
use super::passes::{self, Recipe, Sheet, group};
use super::quality::RenderQuality;
use crate::gpu::Gpu;
use crate::surface::planet::Planet;
use crate::units::GlobeView;
use atlas::Atlas;

/// Heights and what goes with them, on the screen.
const FORM: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Most generations of detail.
const MOST_OCTAVES: u32 = 9;

/// Where the planet is in the window, and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// From the world's frame to the view's: x to the right, y up, z towards the eye.
    pub turn: DQuat,
    /// Middle of the disc, pixels from the window's top-left corner.
    pub centre_px: DVec2,
    /// Its radius, pixels; at least 1.
    pub radius_px: f64,
}

impl Disc {
    /// The disc of a table's view, where the table's top-left corner lies at `corner_px` and a millimetre takes so many
    /// pixels.
    pub fn of(view: &GlobeView, corner_px: DVec2, px_per_mm: f64) -> Self {
        Self {
            turn: view.orientation(),
            centre_px: corner_px + view.centre_mm() * px_per_mm,
            radius_px: (view.radius_mm() * px_per_mm).max(1.0),
        }
    }

    /// The pixel on which a place (unit vector, the world's frame) lies; `None` on the far side.
    pub fn project(&self, place: DVec3) -> Option<DVec2> {
        let seen = self.turn * place;
        (seen.z > 0.0).then(|| self.centre_px + DVec2::new(seen.x, -seen.y) * self.radius_px)
    }
}

/// Draws one planet.
pub struct GlobeRenderer {
    pipelines: Pipelines,
    globe: wgpu::Buffer,
    frames: wgpu::Buffer,
    smooth: wgpu::Sampler,
    nearest: wgpu::Sampler,
    encodes: bool,
    atlas: Option<Atlas>,
    crust: Option<Cube>,
    plates: Option<Cube>,
    sheets: Option<Sheets>,
    scale: f32,
    /// What the sheet shows; none when it has to be drawn.
    drawn: Option<Globe>,
}

struct Pipelines {
    form: wgpu::RenderPipeline,
    shade: wgpu::RenderPipeline,
    lay: wgpu::RenderPipeline,
}

/// Heights and colours of the disc.
struct Sheets {
    forms: Sheet,
    colours: Sheet,
}

/// Six faces.
struct Cube {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl GlobeRenderer {
    /// A renderer without a planet, for targets of `format`.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let device = &gpu.device;
        let buffer = |name, size: usize| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(name),
                size: (size as u64).next_multiple_of(16),
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let sampler = |filter| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("globe"),
                mag_filter: filter,
                min_filter: filter,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        Self {
            pipelines: Pipelines::new(device, format),
            globe: buffer("globe", size_of::<Globe>()),
            frames: buffer("frames", size_of::<Frames>()),
            smooth: sampler(wgpu::FilterMode::Linear),
            nearest: sampler(wgpu::FilterMode::Nearest),
            encodes: format.is_srgb(),
            atlas: None,
            crust: None,
            plates: None,
            sheets: None,
            scale: 1.0,
            drawn: None,
        }
    }

    /// Takes a planet over; the next picture shows it.
    pub fn show(&mut self, gpu: &Gpu, planet: &Planet) {
        let atlas = match self.atlas.take() {
            Some(atlas) if atlas.is_of(&planet.lattice) => atlas,
            _ => {
                self.crust = None;
                self.plates = None;
                Atlas::new(&planet.lattice)
            }
        };
        let width = atlas.width();
        Cube::fill(
            &mut self.crust,
            gpu,
            ("crust", wgpu::TextureFormat::Rgba16Float),
            width,
            bytemuck::cast_slice(&atlas.crust(planet)),
        );
        Cube::fill(
            &mut self.plates,
            gpu,
            ("plates", wgpu::TextureFormat::Rgba8Unorm),
            width,
            bytemuck::cast_slice(&atlas.plates(planet)),
        );
        let mut frames = Frames::zeroed();
        for (frame, plate) in frames.turns.iter_mut().zip(&planet.plates) {
            *frame = plate.rotation.inverse().as_quat().to_array();
        }
        gpu.queue
            .write_buffer(&self.frames, 0, bytemuck::bytes_of(&frames));
        self.atlas = Some(atlas);
        self.drawn = None;
    }

    /// Draws the planet with so many texels per pixel along a side, 0.25 to 2.
    pub fn set_scale(&mut self, scale: f32) {
        self.scale = scale.clamp(0.25, 2.0);
    }

    /// Draws the planet over all of a target of `size_px`. `lamp` is the part of the light that is left, 0 to 1.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        size_px: [u32; 2],
        view: &Disc,
        lamp: f32,
    ) {
        let globe = self.globe(size_px, view, lamp);
        self.make_sheets(&gpu.device, globe.size.map(|side| side as u32));
        if self.drawn != Some(globe) {
            gpu.queue.write_buffer(&self.globe, 0, bytemuck::bytes_of(&globe));
            self.draw_sheet(gpu, encoder);
            self.drawn = Some(globe);
        }
        let Some(sheets) = &self.sheets else { return };
        let looks = self.looks(gpu, &self.pipelines.lay, &[0, 2, 7], sheets);
        let mut pass = passes::pass(
            encoder,
            "globe",
            &[target],
            wgpu::LoadOp::Clear(wgpu::Color::BLACK),
        );
        pass.set_pipeline(&self.pipelines.lay);
        pass.set_bind_group(0, &looks, &[]);
        pass.draw(0..3, 0..1);
    }

    fn globe(&self, size_px: [u32; 2], view: &Disc, lamp: f32) -> Globe {
        let window = size_px.map(|side| side.max(1) as f32);
        let size = window.map(|side| (side * self.scale).round().max(1.0));
        let scale = f64::from(size[0] / window[0]);
        let radius = (view.radius_px * scale).max(1.0);
        let turn = DMat3::from_quat(view.turn.inverse());
        let finest = (FINEST_DETAIL * radius / PLANET_DETAIL).log2().ceil();
        Globe {
            turn: [turn.x_axis, turn.y_axis, turn.z_axis].map(|axis| axis.as_vec3().extend(0.0).to_array()),
            centre: (view.centre_px * scale).as_vec2().to_array(),
            size,
            radius: radius as f32,
            octaves: (finest.max(0.0) as u32).min(MOST_OCTAVES),
            lamp: lamp.clamp(0.0, 1.0),
            encodes: f32::from(u8::from(self.encodes)),
            window,
        }
    }

    fn make_sheets(&mut self, device: &wgpu::Device, size: [u32; 2]) {
        if self
            .sheets
            .as_ref()
            .is_none_or(|sheets| sheets.forms.size != size)
        {
            self.sheets = Some(Sheets {
                forms: Sheet::new(device, "forms", FORM, size),
                colours: Sheet::new(device, "globe's sheet", passes::SHEET, size),
            });
            self.drawn = None;
        }
    }

    fn draw_sheet(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        let Some(sheets) = &self.sheets else { return };
        let steps = [
            (&self.pipelines.form, &sheets.forms, &[0, 1, 2, 3, 4, 5][..]),
            (&self.pipelines.shade, &sheets.colours, &[0, 6]),
        ];
        for (pipeline, sheet, bindings) in steps {
            let room = wgpu::LoadOp::Clear(room());
            let mut pass = passes::pass(encoder, "disc", &[&sheet.view], room);
            if self.crust.is_none() {
                continue;
            }
            let looks = self.looks(gpu, pipeline, bindings, sheets);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &looks, &[]);
            pass.draw(0..3 * DISC_CORNERS, 0..1);
        }
    }

    fn looks(
        &self,
        gpu: &Gpu,
        pipeline: &wgpu::RenderPipeline,
        bindings: &[u32],
        sheets: &Sheets,
    ) -> wgpu::BindGroup {
        let texture = wgpu::BindingResource::TextureView;
        let cube = |cube: &'_ Option<Cube>| cube.as_ref().map(|cube| cube.view.clone());
        let (crust, plates) = (cube(&self.crust), cube(&self.plates));
        let all = [
            Some(self.globe.as_entire_binding()),
            Some(self.frames.as_entire_binding()),
            Some(wgpu::BindingResource::Sampler(&self.smooth)),
            Some(wgpu::BindingResource::Sampler(&self.nearest)),
            crust.as_ref().map(texture),
            plates.as_ref().map(texture),
            Some(texture(&sheets.forms.view)),
            Some(texture(&sheets.colours.view)),
        ];
        let entries: Vec<_> = bindings
            .iter()
            .filter_map(|&binding| Some((binding, all[binding as usize].clone()?)))
            .collect();
        group(&gpu.device, pipeline, &entries)
    }
}

impl Pipelines {
    fn new(device: &wgpu::Device, target: wgpu::TextureFormat) -> Self {
        let text = layout::source("globe", RenderQuality::HIGH.light, (0.0, 1.0));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("globe"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let made = |vertex, fragment, format: wgpu::TextureFormat| {
            Recipe {
                name: fragment,
                module: &module,
                vertex,
                fragment,
                targets: &[format.into()],
                buffers: &[],
                strip: false,
                depth: None,
                samples: 1,
            }
            .make(device)
        };
        Self {
            form: made("disc", "form", FORM),
            shade: made("disc", "shade", passes::SHEET),
            lay: made("cover", "lay", target),
        }
    }
}

impl Cube {
    /// Brings the texels of six faces into `cube`, which is made where there is none.
    fn fill(
        cube: &mut Option<Self>,
        gpu: &Gpu,
        (name, format): (&str, wgpu::TextureFormat),
        width: u32,
        texels: &[u8],
    ) {
        let descriptor = wgpu::TextureDescriptor {
            label: Some(name),
            size: wgpu::Extent3d {
                width,
                height: width,
                depth_or_array_layers: 6,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let there = cube.get_or_insert_with(|| {
            let texture = gpu.device.create_texture(&descriptor);
            let view = texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::Cube),
                ..wgpu::TextureViewDescriptor::default()
            });
            Self { texture, view }
        });
        gpu.queue.write_texture(
            there.texture.as_image_copy(),
            texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(width * format.block_copy_size(None).unwrap_or(1)),
                rows_per_image: Some(width),
            },
            descriptor.size,
        );
    }
}

/// The room, as the sheet's bytes hold it.
fn room() -> wgpu::Color {
    let channel = |shift: u32| f64::from(ROOM >> shift & 0xff) / 255.0;
    wgpu::Color {
        r: channel(16),
        g: channel(8),
        b: channel(0),
        a: 1.0,
    }
}
