//! The land on the graphics card: its shape, its light and its colours, growing towards the newest surface.

use super::layout::{FORM_CELLS, Ground, LIGHT_CELLS, RAMP_ROWS, Reach};
use super::passes::{self, Pipelines, Sheet, group, pass};
use super::quality::RenderQuality;
use super::upload;
use crate::gpu::Gpu;
use crate::picture::colour::Encoder;
use crate::picture::cover::{Palette, SNOW_LINE, TREE_LINE};
use crate::picture::light::SUN_ELEVATION;
use crate::picture::paint::{SUMMITS, lowland};
use crate::surface::{Raster, Surface};

/// Time in which the land as drawn comes two thirds of the way to the land as it is, s.
const GROWTH_S: f32 = 0.12;
/// Time after which it is there, s: then nothing more is computed.
const SETTLED_S: f32 = 0.9;
/// Heights between which ramps are read, metres, and texels between them.
const RAMP: (f32, f32, u32) = (-500.0, 5000.0, 512);
/// Part of the light that comes anew with each look, while the land grows: the rest is what was there.
const FIRST: f32 = 1.0;

/// Textures of one grid of heights.
struct Grid {
    size: [u32; 2],
    new_height: Sheet,
    new_water: Sheet,
    /// The land as drawn, before and after a step.
    height: [Sheet; 2],
    water: [Sheet; 2],
    slopes: Sheet,
    stand: Sheet,
    form: Sheet,
    light: Sheet,
}

/// Textures of one size of the coloured land.
struct Colours {
    fresh_rivers: Sheet,
    rivers: Sheet,
    variation: Sheet,
    sheet: Sheet,
}

/// The land on the graphics card.
pub(super) struct Growth {
    quality: RenderQuality,
    ground: Ground,
    /// Where `ground` goes with the next land.
    towards: (f32, f32),
    uniform: wgpu::Buffer,
    sampler: wgpu::Sampler,
    ramps: Sheet,
    reaches: wgpu::Buffer,
    reach_count: u32,
    grid: Option<Grid>,
    colours: Option<Colours>,
    /// Which of the two lands as drawn is the newer.
    newer: usize,
    /// Nothing has been drawn of this grid yet: the first land does not grow, it is there.
    first: bool,
    since_s: f32,
    /// Next part of the light and colours to be computed.
    strip: u32,
    rivers_changed: bool,
    bytes: Vec<u8>,
    pieces: Vec<Reach>,
}

impl Growth {
    pub(super) fn new(gpu: &Gpu, quality: RenderQuality) -> Self {
        let device = &gpu.device;
        let ramps = ramps(gpu);
        Self {
            quality,
            ground: Ground {
                blend: 1.0,
                exaggeration: 1.0,
                tree_line: TREE_LINE,
                snow_line: SNOW_LINE,
                deepest: upload::DEEPEST,
                drainage_low: upload::DRAINAGE.0,
                drainage_high: upload::DRAINAGE.1,
                ramp_low: RAMP.0,
                ramp_high: RAMP.1,
                sun_elevation: SUN_ELEVATION,
                ..Ground::default()
            },
            towards: (0.0, SUMMITS.0),
            uniform: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("ground"),
                size: size_of::<Ground>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("between cells"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..wgpu::SamplerDescriptor::default()
            }),
            ramps,
            reaches: reach_buffer(device, 4096),
            reach_count: 0,
            grid: None,
            colours: None,
            newer: 0,
            first: true,
            since_s: 0.0,
            strip: 0,
            rivers_changed: true,
            bytes: Vec::new(),
            pieces: Vec::new(),
        }
    }

    /// Takes a new land over.
    pub(super) fn show(&mut self, gpu: &Gpu, surface: &Surface) {
        let raster = &surface.height;
        let size = [raster.width as u32, raster.height as u32];
        if self.grid.as_ref().is_none_or(|grid| grid.size != size) {
            self.grid = Some(Grid::new(&gpu.device, size));
            self.first = true;
        }
        let Some(grid) = &self.grid else { return };
        let extent = raster.extent;
        self.ground.extent = [extent.width as f32, extent.height as f32];
        self.ground.grid = size.map(|side| side as f32);
        self.ground.spacing = surface.spacing as f32;
        let rim = (1.5 * surface.spacing / raster.cell().x).min(f64::from(size[0].min(size[1])) / 4.0);
        self.ground.rim = rim.floor() as f32;
        self.towards = (lowland(&raster.data), highest(raster).clamp(SUMMITS.0, SUMMITS.1));
        grid.new_height.fill(
            &gpu.queue,
            bytemuck::cast_slice(&raster.data),
            size_of::<f32>() as u32,
        );
        upload::water(surface, &mut self.bytes);
        grid.new_water.fill(&gpu.queue, &self.bytes, 2);
        upload::reaches(surface, &mut self.pieces);
        let bytes: &[u8] = bytemuck::cast_slice(&self.pieces);
        if bytes.len() as u64 > self.reaches.size() {
            self.reaches = reach_buffer(&gpu.device, (self.pieces.len() as u64).next_power_of_two());
        }
        gpu.queue.write_buffer(&self.reaches, 0, bytes);
        self.reach_count = self.pieces.len() as u32;
        self.rivers_changed = true;
        self.since_s = 0.0;
    }

    /// True when the land as drawn is the land as it is.
    pub(super) fn settled(&self) -> bool {
        self.since_s > SETTLED_S && self.strip == 0
    }

    /// Heights are lit as if they were so many times as high.
    pub(super) fn exaggerate(&mut self, factor: f32) {
        if self.ground.exaggeration != factor {
            self.ground.exaggeration = factor;
            self.since_s = self.since_s.min(SETTLED_S / 2.0);
        }
    }

    /// The coloured land, and the texture whose first channel is the height in km.
    pub(super) fn seen(&self) -> Option<(&wgpu::TextureView, &wgpu::TextureView)> {
        Some((
            &self.colours.as_ref()?.sheet.view,
            &self.grid.as_ref()?.stand.view,
        ))
    }

    /// Height of the plains and height of summits, metres, as drawn now.
    pub(super) fn heights(&self) -> (f32, f32) {
        (self.ground.lowland, self.ground.summit)
    }

    /// Lets `dt_s` seconds of growth happen on a coloured land of `size` texels; `halves`: with its smaller copies.
    pub(super) fn step(
        &mut self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        encoder: &mut wgpu::CommandEncoder,
        size: [u32; 2],
        dt_s: f32,
        halves: bool,
    ) {
        let new_size = self
            .colours
            .as_ref()
            .is_none_or(|colours| colours.sheet.size != size);
        if self.settled() && !new_size {
            return;
        }
        let whole = self.first || new_size;
        self.since_s += dt_s;
        let last = self.since_s > SETTLED_S;
        let blend = if self.first || last {
            1.0
        } else {
            1.0 - (-dt_s / GROWTH_S).exp()
        };
        self.ground.blend = blend;
        self.ground.lowland += (self.towards.0 - self.ground.lowland) * blend;
        self.ground.summit += (self.towards.1 - self.ground.summit) * blend;
        self.ground.sheet = size.map(|side| side as f32);
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.ground));
        if new_size {
            self.colours = Some(self.new_colours(gpu, pipelines, encoder, size));
            self.rivers_changed = true;
        }
        let (Some(grid), Some(colours)) = (&self.grid, &self.colours) else {
            return;
        };
        let work = Work {
            gpu,
            pipelines,
            uniform: &self.uniform,
            sampler: &self.sampler,
            grid,
            colours,
        };
        work.grow(encoder, self.newer);
        self.newer = 1 - self.newer;
        work.shape(encoder, self.newer);
        if self.rivers_changed {
            work.rivers(encoder, &self.reaches, self.reach_count);
            self.rivers_changed = false;
        }
        let strips = if whole || last { 1 } else { self.quality.strips };
        let strip = if strips == 1 { 0 } else { self.strip };
        let part = |height: u32| {
            let from = height * strip / strips;
            (from, height * (strip + 1) / strips - from)
        };
        work.light(encoder, self.newer, part(grid.light.size[1]));
        let soaked = if whole || last {
            FIRST
        } else {
            (blend * strips as f32).min(1.0)
        };
        work.soak(encoder, part(size[1]), soaked);
        work.sheet(encoder, self.newer, &self.ramps, part(size[1]));
        self.strip = if strip + 1 >= strips { 0 } else { strip + 1 };
        if halves && self.strip == 0 {
            work.halves(encoder);
        }
        self.first = false;
    }

    fn new_colours(
        &self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        encoder: &mut wgpu::CommandEncoder,
        size: [u32; 2],
    ) -> Colours {
        let device = &gpu.device;
        let colours = Colours {
            fresh_rivers: Sheet::new(device, "fresh rivers", passes::RIVERS, size),
            rivers: Sheet::new(device, "rivers", passes::RIVERS, size),
            variation: Sheet::new(device, "variation", passes::LIGHT, size),
            sheet: Sheet::with_halves(device, "sheet", passes::SHEET, size),
        };
        let looks = group(
            device,
            &pipelines.variation,
            &[(0, self.uniform.as_entire_binding())],
        );
        let mut pass = pass(encoder, "variation", &[&colours.variation.view], CLEAR);
        pass.set_pipeline(&pipelines.variation);
        pass.set_bind_group(0, &looks, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        colours
    }
}

/// Everything is drawn over.
const CLEAR: wgpu::LoadOp<wgpu::Color> = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);

/// What the passes of one step use.
struct Work<'a> {
    gpu: &'a Gpu,
    pipelines: &'a Pipelines,
    uniform: &'a wgpu::Buffer,
    sampler: &'a wgpu::Sampler,
    grid: &'a Grid,
    colours: &'a Colours,
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

    fn grow(&self, encoder: &mut wgpu::CommandEncoder, newer: usize) {
        let grid = self.grid;
        self.run(
            encoder,
            &self.pipelines.grow,
            (&[&grid.height[1 - newer], &grid.water[1 - newer]], CLEAR),
            &[
                (1, look(&grid.height[newer])),
                (2, look(&grid.water[newer])),
                (3, look(&grid.new_height)),
                (4, look(&grid.new_water)),
            ],
            (0, grid.size[1]),
        );
    }

    fn shape(&self, encoder: &mut wgpu::CommandEncoder, newer: usize) {
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
            (&[&grid.form], CLEAR),
            &[(1, look(&grid.height[newer])), (2, look(&grid.water[newer]))],
            (0, grid.form.size[1]),
        );
    }

    fn light(&self, encoder: &mut wgpu::CommandEncoder, newer: usize, rows: (u32, u32)) {
        let grid = self.grid;
        self.run(
            encoder,
            &self.pipelines.light,
            (&[&grid.light], wgpu::LoadOp::Load),
            &[(1, look(&grid.height[newer])), (2, look(&grid.water[newer]))],
            rows,
        );
    }

    fn rivers(&self, encoder: &mut wgpu::CommandEncoder, reaches: &wgpu::Buffer, count: u32) {
        let pipeline = &self.pipelines.river;
        let looks = group(
            &self.gpu.device,
            pipeline,
            &[(0, self.uniform.as_entire_binding())],
        );
        let mut pass = pass(encoder, "rivers", &[&self.colours.fresh_rivers.view], CLEAR);
        if count > 0 {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &looks, &[]);
            pass.set_vertex_buffer(0, reaches.slice(..));
            pass.draw(0..4, 0..count);
        }
    }

    fn soak(&self, encoder: &mut wgpu::CommandEncoder, (from, rows): (u32, u32), share: f32) {
        if rows == 0 {
            return;
        }
        let pipeline = &self.pipelines.soak;
        let looks = group(
            &self.gpu.device,
            pipeline,
            &[(1, look(&self.colours.fresh_rivers))],
        );
        let mut pass = pass(encoder, "soak", &[&self.colours.rivers.view], wgpu::LoadOp::Load);
        let share = f64::from(share);
        pass.set_blend_constant(wgpu::Color {
            r: share,
            g: share,
            b: share,
            a: share,
        });
        pass.set_scissor_rect(0, from, self.colours.rivers.size[0], rows);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &looks, &[]);
        pass.draw(0..3, 0..1);
    }

    fn sheet(&self, encoder: &mut wgpu::CommandEncoder, newer: usize, ramps: &Sheet, rows: (u32, u32)) {
        let (grid, colours) = (self.grid, self.colours);
        self.run(
            encoder,
            &self.pipelines.sheet,
            (&[&colours.sheet], wgpu::LoadOp::Load),
            &[
                (1, wgpu::BindingResource::Sampler(self.sampler)),
                (2, look(&grid.slopes)),
                (3, look(&grid.stand)),
                (4, look(&grid.form)),
                (5, look(&grid.light)),
                (6, look(&grid.water[newer])),
                (7, look(&colours.rivers)),
                (8, look(&colours.variation)),
                (9, look(ramps)),
            ],
            rows,
        );
    }

    fn halves(&self, encoder: &mut wgpu::CommandEncoder) {
        let (device, sheet) = (&self.gpu.device, &self.colours.sheet);
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

fn look(sheet: &Sheet) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&sheet.view)
}

impl Grid {
    fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
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
            slopes: sheet("slopes", passes::SHAPE, 1),
            stand: sheet("stand", passes::SHAPE, 1),
            form: sheet("form", passes::SHAPE, FORM_CELLS),
            light: sheet("light", passes::LIGHT, LIGHT_CELLS),
        }
    }
}

fn highest(raster: &Raster) -> f32 {
    raster.data.iter().copied().fold(0.0, f32::max)
}

fn reach_buffer(device: &wgpu::Device, pieces: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("reaches"),
        size: pieces * size_of::<Reach>() as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// The printed map's palette as a texture, one row per colour scale.
fn ramps(gpu: &Gpu) -> Sheet {
    let palette = Palette::new(0.0);
    let encoder = Encoder::new();
    let columns = RAMP.2;
    let mut texels = Vec::with_capacity(4 * RAMP_ROWS.len() * columns as usize);
    for row in RAMP_ROWS {
        for column in 0..columns {
            let height = RAMP.0 + (RAMP.1 - RAMP.0) * (column as f32 + 0.5) / columns as f32;
            let colour = match row {
                "OPEN" => palette.open.at(height),
                "WOOD" => palette.wood.at(height),
                "ROCK" => palette.rock.at(height),
                "SCREE" => palette.scree,
                "SNOW" => palette.snow,
                "WATER_MEADOW" => palette.water_meadow,
                "SHALLOW" => palette.shallow,
                "DEEP" => palette.deep,
                _ => palette.shore,
            };
            let [red, green, blue] = encoder.encode(colour);
            texels.extend([red, green, blue, 255]);
        }
    }
    let sheet = Sheet::new(
        &gpu.device,
        "ramps",
        passes::SHEET,
        [columns, RAMP_ROWS.len() as u32],
    );
    sheet.fill(&gpu.queue, &texels, 4);
    sheet
}
