//! The land on the graphics card: its shape, its light and its colours, growing towards the newest surface.

use std::sync::Arc;

use super::layout::{Ground, Reach};
use super::passes::{Pipelines, Sheet};
use super::pile::Pile;
use super::quality::RenderQuality;
use super::upload;
use super::work::{Aslant, Colours, Grid, RAMP, Work, ramps, reach_buffer};
use crate::gpu::Gpu;
use crate::picture::cover::{SNOW_LINE, TREE_LINE};
use crate::picture::paint::{SUMMITS, lowland};
use crate::rock::Stratigraphy;
use crate::surface::{Raster, StrataMap, Surface};

/// Time in which the land as drawn comes two thirds of the way to the land as it is, s.
const GROWTH_S: f32 = 0.12;
/// Least time between two drawings of the rivers where the land is computed in strips, s: they move slowly, and cost as
/// much as a strip.
const RIVERS_S: f32 = 0.4;
/// Time after which it is there, s: then nothing more is computed.
const SETTLED_S: f32 = 0.9;

/// The land on the graphics card.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a thing of its own that is not drawn yet"
)]
pub(super) struct Growth {
    quality: RenderQuality,
    ground: Ground,
    /// Where `ground` goes with the next land.
    towards: (f32, f32),
    uniform: wgpu::Buffer,
    sampler: wgpu::Sampler,
    ramps: Sheet,
    pile: Pile,
    /// What the pile's table was made from.
    stratigraphy: Option<Arc<Stratigraphy>>,
    reaches: wgpu::Buffer,
    reach_count: u32,
    grid: Option<Grid>,
    colours: Option<Colours>,
    /// Which of the two lands as drawn is the newer.
    newer: usize,
    /// Nothing has been drawn of this grid yet: the first land does not grow, it is there.
    first: bool,
    since_s: f32,
    /// The land on its way is another one.
    leaps: bool,
    /// Once the heights as drawn are those of the newest land: parts of the light and colours that have not been
    /// computed from them yet.
    left: Option<u32>,
    /// The evening's light is not that of the land as drawn.
    evening_is_old: bool,
    /// All colours are to be others, at once.
    recolours: bool,
    /// Next part of the light and colours to be computed.
    strip: u32,
    rivers_changed: bool,
    /// Time since rivers were drawn, s.
    rivers_s: f32,
    heights: Vec<f32>,
    layers: Vec<[f32; 2]>,
    scratch: [Vec<f32>; 2],
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
                ramp_low: RAMP.0,
                ramp_high: RAMP.1,
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
            pile: Pile::none(gpu),
            stratigraphy: None,
            reaches: reach_buffer(device, 4096),
            reach_count: 0,
            grid: None,
            colours: None,
            newer: 0,
            first: true,
            since_s: 0.0,
            leaps: false,
            left: None,
            evening_is_old: true,
            recolours: false,
            strip: 0,
            rivers_changed: true,
            rivers_s: 0.0,
            heights: Vec::new(),
            layers: Vec::new(),
            scratch: [Vec::new(), Vec::new()],
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
        upload::heights(&raster.data, self.towards.0, &mut self.heights);
        let heights = bytemuck::cast_slice(&self.heights);
        grid.new_height.fill(&gpu.queue, heights, size_of::<f32>() as u32);
        self.take_pile(gpu, surface.strata.as_deref());
        let Some(grid) = &self.grid else { return };
        if let Some(map) = surface.strata.as_deref() {
            upload::layers(map, raster, self.pile.range_m, &mut self.layers);
            let layers = bytemuck::cast_slice(&self.layers);
            grid.new_layers
                .fill(&gpu.queue, layers, size_of::<[f32; 2]>() as u32);
        }
        upload::water(surface, &mut self.scratch, &mut self.bytes);
        grid.new_water.fill(&gpu.queue, &self.bytes, 4);
        upload::reaches(surface, &mut self.pieces);
        let bytes: &[u8] = bytemuck::cast_slice(&self.pieces);
        if bytes.len() as u64 > self.reaches.size() {
            self.reaches = reach_buffer(&gpu.device, (self.pieces.len() as u64).next_power_of_two());
        }
        gpu.queue.write_buffer(&self.reaches, 0, bytes);
        self.reach_count = self.pieces.len() as u32;
        self.rivers_changed = true;
        self.since_s = 0.0;
        self.left = None;
    }

    /// Takes the table of the pile under a land over, if it is another one: between two piles nothing grows.
    fn take_pile(&mut self, gpu: &Gpu, map: Option<&StrataMap>) {
        let pile = map.map(|map| &map.stratigraphy);
        if pile == self.stratigraphy.as_ref() {
            return;
        }
        self.pile = pile.map_or_else(|| Pile::none(gpu), |pile| Pile::new(gpu, pile));
        self.ground.pile = self.pile.range_m;
        self.stratigraphy = pile.cloned();
        self.first = true;
    }

    /// The next land is another one, not this one some years later: until it is there it is drawn whole, never in strips
    /// of which some show the one and some the other.
    pub(super) fn leap(&mut self) {
        self.leaps = true;
    }

    /// True when the land as drawn is the land as it is.
    pub(super) fn settled(&self) -> bool {
        self.left == Some(0)
    }

    /// Seen aslant, heights are lit as if they were so many times as high.
    pub(super) fn exaggerate(&mut self, factor: f32) {
        if self.ground.exaggeration != factor {
            self.ground.exaggeration = factor;
            self.evening_is_old = true;
        }
    }

    /// Shows so much of the geological map's colours, 0 to 1; none where no layers are known.
    pub(super) fn show_geology(&mut self, share: f32) {
        let share = if self.pile.range_m > 0.0 {
            share.clamp(0.0, 1.0)
        } else {
            0.0
        };
        if self.ground.geology != share {
            self.ground.geology = share;
            self.recolours = true;
        }
    }

    /// What a window looks at.
    pub(super) fn seen(&self) -> Option<Seen<'_>> {
        let colours = self.colours.as_ref()?;
        Some(Seen {
            sheet: &colours.sheet.view,
            evening: colours.aslant.as_ref().map(|aslant| &aslant.evening.view),
            rock: colours.aslant.as_ref().map(|aslant| &aslant.rock.view),
            stand: &self.grid.as_ref()?.stand.view,
            pile: &self.pile.view,
        })
    }

    /// Height of the plains, metres, as drawn now.
    pub(super) fn lowland(&self) -> f32 {
        self.ground.lowland
    }

    /// True if the layers under the land are known.
    pub(super) fn layered(&self) -> bool {
        self.stratigraphy.is_some()
    }

    /// Lets `dt_s` seconds of growth happen on a coloured land of `size` texels; `aslant`: in the evening's light too.
    pub(super) fn step(
        &mut self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        encoder: &mut wgpu::CommandEncoder,
        size: [u32; 2],
        dt_s: f32,
        aslant: bool,
    ) {
        let new_size = self
            .colours
            .as_ref()
            .is_none_or(|colours| colours.sheet.size != size);
        let new_evening = aslant && self.evening_is_old;
        if self.grid.is_none() || (self.settled() && !new_size && !new_evening && !self.recolours) {
            return;
        }
        let whole = self.first || self.leaps || new_size || new_evening || self.recolours;
        self.since_s += dt_s;
        let arrived = self.first || self.since_s > SETTLED_S;
        let blend = if arrived {
            1.0
        } else {
            1.0 - (-dt_s / GROWTH_S).exp()
        };
        let growing = self.left.is_none();
        if growing {
            self.ground.blend = blend;
            self.ground.lowland += (self.towards.0 - self.ground.lowland) * blend;
            self.ground.summit += (self.towards.1 - self.ground.summit) * blend;
            self.left = arrived.then_some(self.quality.strips);
        }
        self.ground.sheet = size.map(|side| side as f32);
        self.ground.aslant = f32::from(u8::from(aslant));
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.ground));
        if new_size {
            let colours = Colours::new(&gpu.device, size);
            colours.vary(gpu, pipelines, encoder, &self.uniform);
            self.colours = Some(colours);
            self.rivers_changed = true;
        }
        let (Some(grid), Some(colours)) = (&self.grid, &mut self.colours) else {
            return;
        };
        if aslant && colours.aslant.is_none() {
            colours.aslant = Some(Aslant::new(&gpu.device, size));
        }
        let work = Work {
            gpu,
            pipelines,
            uniform: &self.uniform,
            sampler: &self.sampler,
            grid,
            colours,
        };
        if growing {
            work.grow(encoder, self.newer);
            self.newer = 1 - self.newer;
            work.shape(encoder, self.newer);
        }
        self.rivers_s += dt_s;
        let due = whole || arrived || self.quality.strips == 1 || self.rivers_s > RIVERS_S;
        if self.rivers_changed && due {
            self.rivers_s = 0.0;
            work.rivers(encoder, &self.reaches, self.reach_count);
            self.rivers_changed = false;
        }
        let (strip, strips) = if whole {
            (0, 1)
        } else {
            (self.strip, self.quality.strips)
        };
        let part = |height: u32| {
            let from = height * strip / strips;
            (from, height * (strip + 1) / strips - from)
        };
        work.light(encoder, self.newer, part(grid.light.size[1]));
        // The rivers of a strip are looked at once in a round, and then catch up with the round's growth.
        let soaked = if whole || self.left.is_some() {
            1.0
        } else {
            (blend * strips as f32).min(1.0)
        };
        work.soak(encoder, part, soaked);
        work.sheet(
            encoder,
            self.newer,
            (&self.ramps, &self.pile),
            part(size[1]),
            aslant,
        );
        self.strip = (strip + 1) % strips;
        self.left = self
            .left
            .map(|left| if whole { 0 } else { left.saturating_sub(1) });
        self.evening_is_old = !aslant || (self.evening_is_old && !whole);
        if aslant && self.strip == 0 {
            work.halves(encoder);
        }
        self.first = false;
        self.recolours = false;
        self.leaps &= !arrived;
    }
}

/// What a window looks at.
pub(super) struct Seen<'a> {
    /// The land in the printed map's colours.
    pub(super) sheet: &'a wgpu::TextureView,
    /// The land at evening, if it has been seen aslant.
    pub(super) evening: Option<&'a wgpu::TextureView>,
    /// Which place in the pile of layers crops out, likewise.
    pub(super) rock: Option<&'a wgpu::TextureView>,
    /// The looks of that pile.
    pub(super) pile: &'a wgpu::TextureView,
    /// Height in km in the first channel.
    pub(super) stand: &'a wgpu::TextureView,
}

fn highest(raster: &Raster) -> f32 {
    let sound = raster.data.iter().copied().filter(|height| height.is_finite());
    sound.fold(0.0, f32::max)
}
