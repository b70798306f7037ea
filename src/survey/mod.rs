//! A land on its nodes → a [`Surface`]: rasters, lakes and rivers, for files and for the live table alike.
//!
//! A [`Survey`] locates the pixels over the nodes once and keeps its scratch memory, so that drawing the same land again
//! after a step costs no large allocation.

use crate::surface::rivers::{self, FlowGraph};
use crate::surface::{Raster, Surface};
use crate::terrain::{Flow, NodeId, SmoothSheet, Tin, TinRaster};
use crate::units::KM;

/// Drainage area from which a stream is drawn on the map, m².
const DRAWN_RIVER_AREA: f64 = 15.0 * KM * KM;

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
        self.lake.clear();
        self.lake.extend(self.lake_depth.iter().map(|&depth| depth > 0.0));
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

    /// The surface of `ground` at `elapsed_yr`, with nothing standing on it.
    pub fn surface(&mut self, ground: Ground<'_>, elapsed_yr: f64) -> Surface {
        let mut surface = self.blank();
        self.draw(ground.tin, ground.z, || ground.flow, &mut surface);
        surface.elapsed_yr = elapsed_yr;
        surface
    }
}
