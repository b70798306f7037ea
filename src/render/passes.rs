//! Pipelines, textures and what passes have in common.

use super::layout::{self, LightQuality, Reach};
use crate::picture::light::PENUMBRA;

/// Heights, metres.
pub(super) const HEIGHT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// Water of a new land.
pub(super) const NEW_WATER: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// The same of the land as drawn, fine enough to be mixed in small steps.
pub(super) const WATER: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Slopes and heights that are looked at between cells.
pub(super) const SHAPE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Light, river and noise.
pub(super) const LIGHT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Rivers and meadows.
pub(super) const RIVERS: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
/// The coloured land: sRGB, or roots of linear light, both without the card's own coding, which costs software more.
pub(super) const SHEET: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Layers under a new land.
pub(super) const NEW_LAYERS: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;
/// The same of the land as drawn.
pub(super) const LAYERS: wgpu::TextureFormat = wgpu::TextureFormat::Rg16Float;
/// Places in the pile of layers.
pub(super) const ROCK: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;
/// Colours by height.
pub(super) const RAMP: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Depth of the mesh.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// All pipelines.
pub(super) struct Pipelines {
    pub(super) grow: wgpu::RenderPipeline,
    pub(super) relief: wgpu::RenderPipeline,
    pub(super) forms: wgpu::RenderPipeline,
    pub(super) form_slopes: wgpu::RenderPipeline,
    pub(super) light: wgpu::RenderPipeline,
    pub(super) variation: wgpu::RenderPipeline,
    pub(super) river: wgpu::RenderPipeline,
    pub(super) meadow: wgpu::RenderPipeline,
    pub(super) soak: wgpu::RenderPipeline,
    pub(super) sheet: wgpu::RenderPipeline,
    pub(super) sheets: wgpu::RenderPipeline,
    pub(super) shrink: wgpu::RenderPipeline,
    pub(super) plan: wgpu::RenderPipeline,
    pub(super) sky: wgpu::RenderPipeline,
    pub(super) terrain: wgpu::RenderPipeline,
    pub(super) dusk: wgpu::RenderPipeline,
}

/// One pipeline, before it is made.
pub(super) struct Recipe<'a> {
    pub(super) name: &'a str,
    pub(super) module: &'a wgpu::ShaderModule,
    pub(super) vertex: &'a str,
    pub(super) fragment: &'a str,
    pub(super) targets: &'a [wgpu::ColorTargetState],
    pub(super) buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub(super) strip: bool,
    pub(super) depth: Option<wgpu::CompareFunction>,
    pub(super) samples: u32,
}

impl Pipelines {
    pub(super) fn new(
        device: &wgpu::Device,
        target: wgpu::TextureFormat,
        light: LightQuality,
        samples: u32,
    ) -> Self {
        let module = |name: &str| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(name),
                source: wgpu::ShaderSource::Wgsl(layout::source(name, light, PENUMBRA).into()),
            })
        };
        let [grow, relief, noise, rivers, sheet, land, shrink] =
            ["grow", "relief", "noise", "rivers", "sheet", "land", "shrink"].map(module);
        let onto = |name, module, fragment, targets| {
            Recipe {
                name,
                module,
                vertex: "cover",
                fragment,
                targets,
                buffers: &[],
                strip: false,
                depth: None,
                samples: 1,
            }
            .make(device)
        };
        let reaches = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Reach>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &Reach::ATTRIBUTES,
        })];
        let ribbons = |name, vertex, fragment| {
            Recipe {
                name,
                module: &rivers,
                vertex,
                fragment,
                targets: &[blended(RIVERS, GREATEST)],
                buffers: &reaches,
                strip: true,
                depth: None,
                samples: 1,
            }
            .make(device)
        };
        let window = [plain(target)];
        let seen = |name, vertex, fragment, depth, samples| {
            Recipe {
                name,
                module: &land,
                vertex,
                fragment,
                targets: &window,
                buffers: &[],
                strip: vertex == "plan_quad",
                depth,
                samples,
            }
            .make(device)
        };
        Self {
            grow: onto(
                "grow",
                &grow,
                "grow",
                &[plain(HEIGHT), plain(WATER), plain(LAYERS)],
            ),
            relief: onto("relief", &relief, "relief", &[plain(SHAPE), plain(SHAPE)]),
            forms: onto("forms", &relief, "forms", &[plain(HEIGHT)]),
            form_slopes: onto("form slopes", &relief, "form_slopes", &[plain(SHAPE)]),
            light: onto("light", &relief, "light", &[plain(LIGHT)]),
            variation: onto("variation", &noise, "variation", &[plain(LIGHT)]),
            river: ribbons("river", "ribbon", "river"),
            meadow: ribbons("meadow", "meadow_ribbon", "meadow"),
            soak: onto("soak", &rivers, "soak", &[blended(RIVERS, BY_CONSTANT)]),
            sheet: onto("sheet", &sheet, "sheet", &[plain(SHEET)]),
            sheets: onto(
                "sheets",
                &sheet,
                "sheets",
                &[plain(SHEET), plain(SHEET), plain(ROCK)],
            ),
            shrink: onto("shrink", &shrink, "shrink", &[plain(SHEET)]),
            plan: seen("plan", "plan_quad", "plan", None, 1),
            sky: seen(
                "sky",
                "sky_cover",
                "sky",
                Some(wgpu::CompareFunction::LessEqual),
                samples,
            ),
            terrain: seen(
                "terrain",
                "mesh",
                "terrain",
                Some(wgpu::CompareFunction::Less),
                samples,
            ),
            dusk: seen("dusk", "mesh", "dusk", Some(wgpu::CompareFunction::Less), samples),
        }
    }
}

impl Recipe<'_> {
    pub(super) fn make(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let targets: Vec<_> = self.targets.iter().cloned().map(Some).collect();
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.name),
            layout: None,
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(self.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: self.buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology: if self.strip {
                    wgpu::PrimitiveTopology::TriangleStrip
                } else {
                    wgpu::PrimitiveTopology::TriangleList
                },
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: self.depth.map(|compare| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(compare == wgpu::CompareFunction::Less),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: self.samples,
                ..wgpu::MultisampleState::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(self.fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// The greater of what is there and what comes.
const GREATEST: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::One,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Max,
};
/// What comes, in a share that the pass sets.
const BY_CONSTANT: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Constant,
    dst_factor: wgpu::BlendFactor::OneMinusConstant,
    operation: wgpu::BlendOperation::Add,
};

fn plain(format: wgpu::TextureFormat) -> wgpu::ColorTargetState {
    format.into()
}

fn blended(format: wgpu::TextureFormat, blend: wgpu::BlendComponent) -> wgpu::ColorTargetState {
    wgpu::ColorTargetState {
        format,
        blend: Some(wgpu::BlendState {
            color: blend,
            alpha: blend,
        }),
        write_mask: wgpu::ColorWrites::ALL,
    }
}

/// A texture to draw into and look at, and its whole view.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub(super) texture: wgpu::Texture,
    pub(super) view: wgpu::TextureView,
    pub(super) size: [u32; 2],
}

impl Sheet {
    pub(super) fn new(
        device: &wgpu::Device,
        name: &str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
    ) -> Self {
        Self::with(device, name, format, size, 1, 1)
    }

    /// With its halves, down to a few texels.
    pub(super) fn with_halves(
        device: &wgpu::Device,
        name: &str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
    ) -> Self {
        let levels = size[0].min(size[1]).ilog2().saturating_sub(2).max(1);
        Self::with(device, name, format, size, levels, 1)
    }

    /// Sampled `samples` times per pixel; those of more than one cannot be looked at.
    pub(super) fn with_samples(
        device: &wgpu::Device,
        name: &str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        samples: u32,
    ) -> Self {
        Self::with(device, name, format, size, 1, samples)
    }

    fn with(
        device: &wgpu::Device,
        name: &str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        levels: u32,
        samples: u32,
    ) -> Self {
        let size = size.map(|side| side.max(1));
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let usage = if samples > 1 {
            drawn
        } else {
            drawn
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::COPY_SRC
        };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(name),
            size: wgpu::Extent3d {
                width: size[0],
                height: size[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: levels,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view, size }
    }

    /// The view of one level.
    pub(super) fn level(&self, level: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..wgpu::TextureViewDescriptor::default()
        })
    }

    /// Writes all texels of the first level, `bytes` each, row by row.
    pub(super) fn fill(&self, queue: &wgpu::Queue, texels: &[u8], bytes: u32) {
        queue.write_texture(
            self.texture.as_image_copy(),
            texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(self.size[0] * bytes),
                rows_per_image: None,
            },
            self.texture.size(),
        );
    }
}

/// Groups what a pass looks at, in the order of the shader's bindings from 0.
pub(super) fn group(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    entries: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries: Vec<wgpu::BindGroupEntry<'_>> = entries
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: resource.clone(),
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}

/// A pass that draws into `targets`, which are kept where `load` says so.
pub(super) fn pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    name: &str,
    targets: &[&wgpu::TextureView],
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPass<'a> {
    let attachments: Vec<_> = targets
        .iter()
        .map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load,
                    store: wgpu::StoreOp::Store,
                },
            })
        })
        .collect();
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        color_attachments: &attachments,
        ..wgpu::RenderPassDescriptor::default()
    })
}
