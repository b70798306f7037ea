//! A land on its nodes → a [`Surface`]: rasters, lakes and rivers, for files and for the live table alike.
//!
//! A [`Survey`] locates the pixels over the nodes once and keeps its scratch memory, so that drawing the same land again
//! after a step costs no large allocation.

mod layers;

use std::sync::Arc;

use crate::surface::rivers::{self, FlowGraph};
use crate::surface::{Raster, Surface};
use crate::terrain::{Flow, NodeId, SmoothSheet, Tin, TinRaster};
use crate::units::KM;

pub use layers::Underground;

/// Drainage area from which a stream is drawn on the map, m².
const DRAWN_RIVER_AREA: f64 = 15.0 * KM * KM;

/// Least greatest depth of a lake that is drawn, metres.
const LEAST_LAKE: f64 = 8.0;

/// A land on its nodes, and the water over it.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// The nodes.
    pub tin: &'a Tin,
    /// Height at each node, metres.
    pub z: &'a [f64],
    /// The water, routed over `z`.
    pub flow: &'a Flow,
}

/// Water as writers and rivers want it: one entry per node.
#[derive(Clone, Debug, Default)]
pub struct Water {
    receivers: Vec<u32>,
    lake_depth: Vec<f64>,
    lake: Vec<bool>,
    /// Greatest depth of each water surface, metres.
    deepest: Vec<f64>,
}

impl Water {
    /// The water over `ground`.
    pub fn new(ground: Ground<'_>) -> Self {
        let mut water = Self::default();
        water.read(ground);
        water
    }

    /// Takes the water over `ground` instead, in the same memory.
    pub fn read(&mut self, ground: Ground<'_>) {
        let Ground { z, flow, .. } = ground;
        let lakes = flow.lakes();
        self.receivers.clear();
        self.receivers.extend(flow.receivers().iter().map(|node| node.0));
        self.lake_depth.clear();
        let depth = |(i, &z): (usize, &f64)| lakes.level(NodeId::new(i), z) - z;
        self.lake_depth.extend(z.iter().enumerate().map(depth));
        self.drain_puddles(ground);
        self.lake.clear();
        self.lake.extend(self.lake_depth.iter().map(|&depth| depth > 0.0));
    }

    /// Water that is nowhere deeper than [`LEAST_LAKE`] is no lake: a growing plain is full of hollows.
    fn drain_puddles(&mut self, ground: Ground<'_>) {
        let Ground { tin, z, flow } = ground;
        let lakes = flow.lakes();
        let of = |i: usize| lakes.lake(NodeId::new(i), z[i]);
        self.deepest.clear();
        for i in 0..tin.len() {
            if let Some(lake) = of(i) {
                let lake = lake as usize;
                if self.deepest.len() <= lake {
                    self.deepest.resize(lake + 1, 0.0);
                }
                self.deepest[lake] = self.deepest[lake].max(self.lake_depth[i]);
            }
        }
        for i in 0..tin.len() {
            if of(i).is_some_and(|lake| self.deepest[lake as usize] < LEAST_LAKE) {
                self.lake_depth[i] = 0.0;
            }
        }
    }

    /// The node each one drains to; an outlet drains to itself.
    pub fn receivers(&self) -> &[u32] {
        &self.receivers
    }

    /// The graph to read rivers from. `ground` is the one that was read.
    pub fn graph<'a>(&'a self, ground: Ground<'a>) -> FlowGraph<'a> {
        FlowGraph {
            positions: ground.tin.positions(),
            receivers: &self.receivers,
            drainage: ground.flow.drainage(),
            lake: &self.lake,
        }
    }
}

/// Draws lands on one TIN at one resolution.
#[derive(Clone, Debug)]
pub struct Survey {
    raster: TinRaster,
    /// Typical distance between nodes, metres.
    spacing: f64,
    sheet: SmoothSheet,
    water: Water,
}

impl Survey {
    /// Locates the pixels of rasters with `columns` columns of square cells over `tin`.
    pub fn new(tin: &Tin, columns: usize) -> Self {
        let extent = tin.extent();
        let rows = ((columns as f64 * extent.height / extent.width).round() as usize).max(1);
        Self {
            raster: TinRaster::new(tin, columns, rows),
            spacing: tin.spacing(),
            sheet: SmoothSheet::default(),
            water: Water::default(),
        }
    }

    /// The located pixels.
    pub fn raster(&self) -> &TinRaster {
        &self.raster
    }

    /// A flat, dry surface of this survey's size, to be drawn into.
    pub fn blank(&self) -> Surface {
        let flat = Raster {
            width: self.raster.width(),
            height: self.raster.height(),
            extent: self.raster.extent(),
            data: vec![0.0; self.raster.width() * self.raster.height()],
        };
        Surface {
            height: flat.clone(),
            lake_depth: flat.clone(),
            drainage: flat,
            spacing: self.spacing,
            rivers: Vec::new(),
            plates: Vec::new(),
            faults: Vec::new(),
            folds: Vec::new(),
            strata: None,
            elapsed_yr: 0.0,
        }
    }

    /// Draws heights, lakes, drainage and rivers of the land `z` on `tin` into `out`, a surface of this survey's size.
    /// `tin` is the one the survey was made for; `flow` routes the water over `z` meanwhile.
    pub fn draw<'a>(
        &mut self,
        tin: &Tin,
        z: &[f64],
        flow: impl FnOnce() -> &'a Flow + Send,
        out: &mut Surface,
    ) {
        let Self {
            raster, sheet, water, ..
        } = self;
        let (height, lake_depth, drainage, rivers) = (
            &mut out.height.data,
            &mut out.lake_depth.data,
            &mut out.drainage.data,
            &mut out.rivers,
        );
        rayon::join(
            || raster.smooth_into(tin, z, sheet, height),
            || {
                let ground = Ground { tin, z, flow: flow() };
                water.read(ground);
                raster.linear_into(&water.lake_depth, lake_depth);
                raster.linear_into(ground.flow.drainage(), drainage);
                *rivers = rivers::drawn(water.graph(ground), DRAWN_RIVER_AREA);
            },
        );
    }

    /// Draws the layers `under` the land that `out` shows into it. Memory that no other frame shares is used again.
    pub fn draw_layers(&self, under: &Underground<'_>, out: &mut Surface) {
        let mut map = out
            .strata
            .take()
            .and_then(|shared| Arc::try_unwrap(shared).ok())
            .unwrap_or_else(|| layers::blank(under.stratigraphy, &out.height));
        layers::draw(&self.raster, under, &out.height, &mut map);
        out.strata = Some(Arc::new(map));
    }

    /// The surface of `ground` at `elapsed_yr`, with nothing standing on it.
    pub fn surface(&mut self, ground: Ground<'_>, elapsed_yr: f64) -> Surface {
        let mut surface = self.blank();
        self.draw(ground.tin, ground.z, || ground.flow, &mut surface);
        surface.elapsed_yr = elapsed_yr;
        surface
    }
}
