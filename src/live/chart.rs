//! A session as it is → a frame.

use rayon::prelude::*;

use super::frame::{Clock, Frame};
use crate::gesture::contact::Side;
use crate::sim::{Sim, World};
use crate::surface::{Raster, Surface};
use crate::survey::Survey;
use crate::terrain::Flow;

/// Pixels per task where each is independent of the others.
const CHUNK: usize = 16_384;

/// A frame that circulates, and what it was filled from last.
#[derive(Clone, Debug)]
pub struct Slot {
    pub(super) frame: Frame,
    /// The water of this step is drawn in it.
    water: u64,
}

impl AsRef<Frame> for Slot {
    fn as_ref(&self) -> &Frame {
        &self.frame
    }
}

/// Draws the session into frames, and draws again only what has changed.
///
/// After a step the heights and the water are drawn from the nodes. Between two steps the land is the heights plus the
/// rise of the time that has passed, which costs a pass over the pixels.
#[derive(Debug)]
pub(super) struct Chart {
    survey: Survey,
    flow: Flow,
    /// Lakes, drainage and rivers after the last step; its heights are those of the last step too.
    surface: Surface,
    /// How fast each node and each pixel rises, m/yr.
    node_rise: Vec<f64>,
    rise: Vec<f32>,
    /// The sim's revision of the land that `surface` shows.
    revision: Option<u64>,
    /// Counts the changes of `surface`, of `rise`, and of what frames show.
    water: u64,
    risen: u64,
    land: u64,
    /// What the last frame showed: `risen`, and the bits of the years since the step.
    shown: (u64, u64),
}

impl Chart {
    /// A chart for lands on the nodes of `world`, `columns` pixels wide.
    pub(super) fn new(world: &World, columns: usize) -> Self {
        let survey = Survey::new(&world.tin, columns);
        Self {
            flow: Flow::new(&world.tin),
            surface: survey.blank(),
            survey,
            node_rise: Vec::new(),
            rise: Vec::new(),
            revision: None,
            water: 0,
            risen: 0,
            land: 0,
            shown: (0, 0),
        }
    }

    /// A frame with memory for everything, and nothing in it yet.
    pub(super) fn slot(&self) -> Slot {
        Slot {
            frame: Frame::new(self.survey.blank()),
            water: 0,
        }
    }

    /// Another session, or one that has lost its place, is drawn from now on: everything is drawn again.
    pub(super) fn forget(&mut self) {
        self.revision = None;
    }

    /// The same for a world on other nodes.
    pub(super) fn move_to(&mut self, world: &World) {
        self.survey = Survey::new(&world.tin, self.surface.height.width);
        self.flow = Flow::new(&world.tin);
        self.forget();
    }

    /// Draws `sim` as it is into `slot`. `changed` tells that its uplift has been computed since the last time.
    pub(super) fn draw(&mut self, sim: &Sim, changed: bool, slot: &mut Slot) {
        let stepped = self.revision != Some(sim.land_revision());
        if stepped {
            self.draw_land(sim);
        }
        if stepped || changed {
            self.surface.folds = sim.fold_lines(1);
            sim.rise_into(&mut self.node_rise);
            self.survey.raster().linear_into(&self.node_rise, &mut self.rise);
            self.risen += 1;
        }
        let pending_yr = sim.pending_yr();
        let shown = (self.risen, pending_yr.to_bits());
        if shown != self.shown {
            self.shown = shown;
            self.land += 1;
        }
        let surface = &mut slot.frame.surface;
        if slot.frame.land != self.land {
            self.raise(&mut surface.height, pending_yr as f32);
        }
        if slot.water != self.water {
            surface.lake_depth.data.clone_from(&self.surface.lake_depth.data);
            surface.drainage.data.clone_from(&self.surface.drainage.data);
            surface.rivers.clone_from(&self.surface.rivers);
            surface.strata.clone_from(&self.surface.strata);
            surface.spacing = self.surface.spacing;
            slot.water = self.water;
        }
        surface.folds.clone_from(&self.surface.folds);
        surface.plates = sim.plate_marks();
        surface.faults = sim.fault_traces();
        slot.frame.cuts = [Side::North, Side::South].map(|side| sim.cut(side).cloned());
        slot.frame.clock = clock(sim);
        slot.frame.surface.elapsed_yr = slot.frame.clock.elapsed_yr;
        slot.frame.land = self.land;
        slot.frame.hands.clear();
        slot.frame.hands.extend(sim.hands());
        slot.frame.contacts = sim.contact_stats();
        slot.frame.counts = sim.counts();
        slot.frame.quarantine = sim.quarantine();
    }

    /// The land after a step.
    fn draw_land(&mut self, sim: &Sim) {
        // Until all is drawn, nothing is.
        self.revision = None;
        let (world, flow) = (sim.world(), &mut self.flow);
        self.survey.draw(
            &world.tin,
            &world.z,
            move || {
                sim.route(flow);
                flow
            },
            &mut self.surface,
        );
        self.survey.draw_layers(&sim.underground(), &mut self.surface);
        self.surface.spacing = world.tin.spacing();
        self.water += 1;
        self.revision = Some(sim.land_revision());
    }

    fn raise(&self, height: &mut Raster, years: f32) {
        height
            .data
            .par_chunks_mut(CHUNK)
            .zip(self.surface.height.data.par_chunks(CHUNK))
            .zip(self.rise.par_chunks(CHUNK))
            .for_each(|((out, base), rise)| {
                for ((out, base), rise) in out.iter_mut().zip(base).zip(rise) {
                    *out = base + rise * years;
                }
            });
    }
}

fn clock(sim: &Sim) -> Clock {
    Clock {
        elapsed_yr: sim.world().time_yr + sim.pending_yr(),
        paused: sim.paused(),
        at_rest: sim.at_rest(),
        pace_yr_per_s: sim.pace_yr_per_s(),
        history_yr: sim.history_yr(),
        can_undo: [Side::North, Side::South].map(|side| sim.can_undo(side)),
        convergence_m_per_yr: sim.convergence_m_per_yr(),
        shortening: sim.shortening(),
    }
}
