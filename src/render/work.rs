//! The passes that shape, light and colour the land, and the textures they fill.

use super::layout::{FORM_CELLS, LIGHT_CELLS, MEADOW_TEXELS, RAMP_ROWS, RAMP_STEPS, Reach};
use super::passes::{self, Pipelines, Sheet, group, pass};
use super::pile::Pile;
use crate::gpu::Gpu;
use crate::picture::cover::Palette;

/// Heights between which ramps are read, metres.
pub(super) const RAMP: (f32, f32) = (-500.0, 5000.0);

/// Textures of one grid of heights.
pub(super) struct Grid {
    pub(super) size: [u32; 2],
    pub(super) new_height: Sheet,
    pub(super) new_water: Sheet,
    /// The land as drawn, before and after a step.
    height: [Sheet; 2],
    water: [Sheet; 2],
    pub(super) new_layers: Sheet,
    layers: [Sheet; 2],
    slopes: Sheet,
    /// Height in km in the first channel.
    pub(super) stand: Sheet,
    /// Heights of the big forms, and with their slopes.
    form_heights: Sheet,
    form: Sheet,
    pub(super) light: Sheet,
}

/// Textures of one size of the coloured land.
pub(super) struct Colours {
    /// As they are, and as drawn.
    rivers: [Sheet; 2],
    meadows: [Sheet; 2],
    variation: Sheet,
    /// The land in the printed map's colours.
    pub(super) sheet: Sheet,
    /// The land seen aslant, if it has been.
    pub(super) aslant: Option<Aslant>,
}

/// What is known of the land where it is seen aslant.
pub(super) struct Aslant {
    /// The land at evening, with its smaller copies.
    pub(super) evening: Sheet,
    /// Which place in the pile of layers crops out.
    pub(super) rock: Sheet,
}

/// Everything is drawn over.
const CLEAR: wgpu::LoadOp<wgpu::Color> = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);

/// What the passes of one step use.
pub(super) struct Work<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) pipelines: &'a Pipelines,
    pub(super) uniform: &'a wgpu::Buffer,
    pub(super) sampler: &'a wgpu::Sampler,
    pub(super) grid: &'a Grid,
    pub(super) colours: &'a Colours,
}

impl Work<'_> {
    fn run(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::RenderPipeline,
        (targets, load): (&[&Sheet], wgpu::LoadOp<wgpu::Color>),
        looks: &[(u32, wgpu::BindingResource<'_>)],
        (from, rows): (u32, u32),
    ) {
        if rows == 0 {
            return;
        }
        let mut entries = vec![(0, self.uniform.as_entire_binding())];
        entries.extend_from_slice(looks);
        let looks = group(&self.gpu.device, pipeline, &entries);
        let views: Vec<wgpu::TextureView> = targets.iter().map(|target| target.level(0)).collect();
        let views: Vec<&wgpu::TextureView> = views.iter().collect();
        let mut pass = pass(encoder, "land", &views, load);
        pass.set_scissor_rect(0, from, targets[0].size[0], rows);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &looks, &[]);
        pass.draw(0..3, 0..1);
    }

    pub(super) fn grow(&self, encoder: &mut wgpu::CommandEncoder, newer: usize) {
        let grid = self.grid;
        self.run(
            encoder,
            &self.pipelines.grow,
            (
                &[
                    &grid.height[1 - newer],
                    &grid.water[1 - newer],
                    &grid.layers[1 - newer],
                ],
                CLEAR,
            ),
            &[
                (1, look(&grid.height[newer])),
                (2, look(&grid.water[newer])),
                (3, look(&grid.new_height)),
                (4, look(&grid.new_water)),
                (5, look(&grid.layers[newer])),
                (6, look(&grid.new_layers)),
            ],
            (0, grid.size[1]),
        );
    }

    pub(super) fn shape(&self, encoder: &mut wgpu::CommandEncoder, newer: usize) {
        let grid = self.grid;
        self.run(
            encoder,
            &self.pipelines.relief,
            (&[&grid.slopes, &grid.stand], CLEAR),
            &[(1, look(&grid.height[newer]))],
            (0, grid.size[1]),
        );
        self.run(
            encoder,
            &self.pipelines.forms,
            (&[&grid.form_heights], CLEAR),
            &[(1, look(&grid.height[newer])), (2, look(&grid.water[newer]))],
            (0, grid.form.size[1]),
        );
        self.run(
            encoder,
            &self.pipelines.form_slopes,
            (&[&grid.form], CLEAR),
            &[(3, look(&grid.form_heights))],
            (0, grid.form.size[1]),
        );
    }

    pub(super) fn light(&self, encoder: &mut wgpu::CommandEncoder, newer: usize, rows: (u32, u32)) {
        let grid = self.grid;
        self.run(
            encoder,
            &self.pipelines.light,
            (&[&grid.light], wgpu::LoadOp::Load),
            &[(1, look(&grid.height[newer])), (2, look(&grid.water[newer]))],
            rows,
        );
    }

    pub(super) fn rivers(&self, encoder: &mut wgpu::CommandEncoder, reaches: &wgpu::Buffer, count: u32) {
        let colours = self.colours;
        for (pipeline, target) in [
            (&self.pipelines.river, &colours.rivers[0]),
            (&self.pipelines.meadow, &colours.meadows[0]),
        ] {
            let looks = group(
                &self.gpu.device,
                pipeline,
                &[(0, self.uniform.as_entire_binding())],
            );
            let mut pass = pass(encoder, "rivers", &[&target.view], CLEAR);
            if count > 0 {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &looks, &[]);
                pass.set_vertex_buffer(0, reaches.slice(..));
                pass.draw(0..4, 0..count);
            }
        }
    }

    /// Mixes a share of the rivers and meadows as they are into those as drawn, in the rows that `part` names.
    pub(super) fn soak(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        part: impl Fn(u32) -> (u32, u32),
        share: f32,
    ) {
        let share = f64::from(share);
        for [fresh, drawn] in [&self.colours.rivers, &self.colours.meadows] {
            let (from, rows) = part(drawn.size[1]);
            if rows == 0 {
                continue;
            }
            let pipeline = &self.pipelines.soak;
            let looks = group(&self.gpu.device, pipeline, &[(1, look(fresh))]);
            let mut pass = pass(encoder, "soak", &[&drawn.view], wgpu::LoadOp::Load);
            pass.set_blend_constant(wgpu::Color {
                r: share,
                g: share,
                b: share,
                a: share,
            });
            pass.set_scissor_rect(0, from, drawn.size[0], rows);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &looks, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    /// Colours some rows; with the evening's light if they are seen `aslant`.
    pub(super) fn sheet(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        newer: usize,
        (ramps, pile): (&Sheet, &Pile),
        rows: (u32, u32),
        aslant: bool,
    ) {
        let (grid, colours) = (self.grid, self.colours);
        let mut targets = vec![&colours.sheet];
        let mut pipeline = &self.pipelines.sheet;
        if let Some(Aslant { evening, rock }) = colours.aslant.as_ref().filter(|_| aslant) {
            targets.extend([evening, rock]);
            pipeline = &self.pipelines.sheets;
        }
        self.run(
            encoder,
            pipeline,
            (&targets, wgpu::LoadOp::Load),
            &[
                (1, wgpu::BindingResource::Sampler(self.sampler)),
                (2, look(&grid.slopes)),
                (3, look(&grid.stand)),
                (4, look(&grid.form)),
                (5, look(&grid.light)),
                (6, look(&grid.water[newer])),
                (7, look(&colours.rivers[1])),
                (8, look(&colours.variation)),
                (9, look(ramps)),
                (10, look(&colours.meadows[1])),
                (11, look(&grid.layers[newer])),
                (12, wgpu::BindingResource::TextureView(&pile.view)),
            ],
            rows,
        );
    }

    /// Makes the smaller copies of the evening.
    pub(super) fn halves(&self, encoder: &mut wgpu::CommandEncoder) {
        let device = &self.gpu.device;
        let Some(Aslant { evening: sheet, .. }) = &self.colours.aslant else {
            return;
        };
        for level in 1..sheet.texture.mip_level_count() {
            let larger = sheet.level(level - 1);
            let looks = group(
                device,
                &self.pipelines.shrink,
                &[
                    (0, wgpu::BindingResource::TextureView(&larger)),
                    (1, wgpu::BindingResource::Sampler(self.sampler)),
                ],
            );
            let target = sheet.level(level);
            let mut pass = pass(encoder, "halves", &[&target], CLEAR);
            pass.set_pipeline(&self.pipelines.shrink);
            pass.set_bind_group(0, &looks, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

impl Aslant {
    pub(super) fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        Self {
            evening: Sheet::with_halves(device, "evening", passes::SHEET, size),
            rock: Sheet::new(device, "rock", passes::ROCK, size),
        }
    }
}

impl Colours {
    pub(super) fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        let coarse = size.map(|side| side.div_ceil(MEADOW_TEXELS));
        Self {
            rivers: [(); 2].map(|()| Sheet::new(device, "rivers", passes::RIVERS, size)),
            meadows: [(); 2].map(|()| Sheet::new(device, "meadows", passes::RIVERS, coarse)),
            variation: Sheet::new(device, "variation", passes::LIGHT, size),
            sheet: Sheet::new(device, "sheet", passes::SHEET, size),
            aslant: None,
        }
    }

    /// Fills in what depends on the place alone.
    pub(super) fn vary(
        &self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        encoder: &mut wgpu::CommandEncoder,
        uniform: &wgpu::Buffer,
    ) {
        let looks = group(
            &gpu.device,
            &pipelines.variation,
            &[(0, uniform.as_entire_binding())],
        );
        let mut pass = pass(encoder, "variation", &[&self.variation.view], CLEAR);
        pass.set_pipeline(&pipelines.variation);
        pass.set_bind_group(0, &looks, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn look(sheet: &Sheet) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&sheet.view)
}

impl Grid {
    pub(super) fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        let sheet = |name, format, cells: u32| {
            Sheet::new(device, name, format, size.map(|side| side.div_ceil(cells)))
        };
        Self {
            size,
            new_height: sheet("new height", passes::HEIGHT, 1),
            new_water: sheet("new water", passes::NEW_WATER, 1),
            height: [
                sheet("height", passes::HEIGHT, 1),
                sheet("height", passes::HEIGHT, 1),
            ],
            water: [sheet("water", passes::WATER, 1), sheet("water", passes::WATER, 1)],
            new_layers: sheet("new layers", passes::NEW_LAYERS, 1),
            layers: [
                sheet("layers", passes::LAYERS, 1),
                sheet("layers", passes::LAYERS, 1),
            ],
            slopes: sheet("slopes", passes::SHAPE, 1),
            stand: sheet("stand", passes::SHAPE, 1),
            form_heights: sheet("form heights", passes::HEIGHT, FORM_CELLS),
            form: sheet("form", passes::SHAPE, FORM_CELLS),
            light: sheet("light", passes::LIGHT, LIGHT_CELLS),
        }
    }
}

pub(super) fn reach_buffer(device: &wgpu::Device, pieces: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("reaches"),
        size: pieces * size_of::<Reach>() as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// The printed map's colours by height as a texture, one row each.
pub(super) fn ramps(gpu: &Gpu) -> Sheet {
    let palette = Palette::new(0.0);
    let mut texels: Vec<[f32; 4]> = Vec::with_capacity(RAMP_ROWS.len() * RAMP_STEPS as usize);
    for ramp in [&palette.open, &palette.wood, &palette.rock] {
        for step in 0..RAMP_STEPS {
            let height = RAMP.0 + (RAMP.1 - RAMP.0) * step as f32 / (RAMP_STEPS - 1) as f32;
            texels.push(ramp.at(height).extend(1.0).to_array());
        }
    }
    let size = [RAMP_STEPS, RAMP_ROWS.len() as u32];
    let sheet = Sheet::new(&gpu.device, "ramps", passes::RAMP, size);
    sheet.fill(
        &gpu.queue,
        bytemuck::cast_slice(&texels),
        size_of::<[f32; 4]>() as u32,
    );
    sheet
}
