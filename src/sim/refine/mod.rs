//! From the land that people sculpted to the land that an artist takes home.
//!
//! A live land has some ten thousand nodes. [`Refinement`] lays finer ones into it, level by level, and cuts the valleys
//! that the coarse ones could not hold:
//!
//! 1. heights go over by the smooth surface that pictures show, uneven where it is steep and high (`detail`);
//! 2. rivers keep their beds (`bed`);
//! 3. then rivers and slides cut in short steps, by the same laws as on the table, while the large shape is held (`hold`):
//!    as a whole the land grows no older. Nothing is laid down, or rivers would leave their beds on the plains. Pairs of layers whose folds are too fine for the table fold meanwhile, as far as what has
//!    made layers fold so far makes them.
//!
//! A [`Region`] is a box of a land that goes the same way on nodes a few metres apart; its edges inherit rivers, heights
//! and layers.

mod bed;
mod detail;
mod folds;
mod hold;
mod region;

use std::sync::Arc;

use glam::DVec2;

use super::exposure::Exposure;
use super::{Checkpoint, SimParams, World};
use crate::mountain::PlateSet;
use crate::mountain::strata::NodeFolds;
use crate::terrain::{Edges, Erosion, ErosionParams, Flow, Forcing, Resampling, Tin, TinError};
use crate::units::PlanMap;
use hold::Hold;
use region::Crossings;
pub use region::{Region, RegionError};

/// Nodes of a final land: the paper's.
pub const FINAL_NODES: usize = 1_000_000;

/// Steps on the last level; the paper takes about as many.
const STEPS: usize = 100;
/// Steps on levels before it, which only have to hand over valleys.
const EARLIER_STEPS: usize = 30;
/// Model time that each level erodes for, years: about as long as a valley takes to grow by a spacing of the level before,
/// at the default constants. (Twice of it, and hills lose their own valleys to a uniform texture.) For m/n = ½ that is the same on all levels: a river of half the basin side is half as fast and
/// has half as far to go.
const LEVEL_YEARS: f64 = 0.4e6;
/// The same for levels of a box: its slopes have been shaped before, and rills have their places to find.
const BOX_YEARS: f64 = 0.1e6;
/// Area that a channel needs to begin in a box, m²: above it slopes creep and slide, and water cuts no rill into each of
/// their nodes. (On real slopes 10³ to 10⁵ m²; Montgomery & Dietrich 1992.)
const CHANNEL_HEAD: f64 = 1e4;
/// Most spacings of a level that fit into one of the level before.
const MOST_FINER: f64 = 3.5;
/// Standard deviation of the bell over which heights are held, in spacings of the level before.
const HOLD_SPACINGS: f64 = 2.0;
/// What laying the nodes of a level costs, in steps of that level.
const LAYING_STEPS: usize = 12;

/// Why a land cannot be refined.
#[derive(Debug, thiserror::Error)]
pub enum RefineError {
    /// The nodes cannot be laid.
    #[error(transparent)]
    Nodes(#[from] TinError),
    /// The box cannot be cut out.
    #[error(transparent)]
    Region(#[from] RegionError),
    /// Fewer nodes than the land has.
    #[error("{wanted} nodes: the land has {found} already; expected more")]
    Coarser {
        /// Nodes asked for.
        wanted: usize,
        /// Nodes there are.
        found: usize,
    },
    /// A step gave a height that is no number.
    #[error("the land lost its heights in step {step} on {nodes} nodes; nothing was written")]
    NotFinite {
        /// The step.
        step: usize,
        /// Nodes of its level.
        nodes: usize,
    },
}

/// A land being refined: one [`Self::step`] after the other. Dropping it leaves nothing behind.
#[derive(Debug)]
pub struct Refinement {
    erosion: ErosionParams,
    /// The land so far: that of the last level, or the one it is cut from.
    land: Arc<World>,
    /// Rain on its nodes as a factor, where rivers flow into a box; none: 1.
    rain: Option<Vec<f64>>,
    /// Uplift rate of the land it began with, at its nodes, m/yr.
    uplift: (Arc<Tin>, Vec<f64>),
    cut: Option<Cut>,
    /// Nodes of the levels to come, the next one last.
    levels: Vec<usize>,
    work: Option<Work>,
    /// Node steps done, and in all.
    done: usize,
    all: usize,
}

/// What a box knows of the land around it.
#[derive(Debug)]
struct Cut {
    region: Region,
    crossings: Crossings,
    /// The land around.
    around: Arc<World>,
}

/// A level that is being eroded.
#[derive(Debug)]
struct Work {
    world: World,
    /// Heights whose means are held, m.
    wanted: Vec<f64>,
    hold: Hold,
    /// What holds them, m/yr.
    base: Vec<f64>,
    folds: Vec<NodeFolds>,
    rain: Option<Vec<f64>>,
    exposure: Exposure,
    solver: Erosion,
    /// How strong the rock is against what its bed says, in a box: factor on the talus.
    strength: Option<Vec<f64>>,
    years: f64,
    step: usize,
    steps: usize,
}

/// A refined land.
#[derive(Debug)]
pub struct Refined {
    /// The land. That of a box has no plates, and lies in a plan of its own.
    pub world: World,
    /// Uplift rate of the crust at each node as the coarse land last felt it, m/yr.
    pub uplift: Vec<f64>,
    /// Rain on each node as a factor, where rivers flow in over an edge; none: 1.
    pub rain: Option<Vec<f64>>,
    /// Steps on the last level.
    pub steps: usize,
    /// Length of one of them, years.
    pub dt_yr: f64,
}

impl Refinement {
    /// Of the whole land of `live`, to `nodes` nodes.
    ///
    /// # Errors
    /// When the nodes are fewer than the land has, or too many.
    pub fn of_land(live: &Checkpoint, nodes: usize) -> Result<Self, RefineError> {
        let found = live.world().tin.len();
        if nodes <= found {
            return Err(RefineError::Coarser { wanted: nodes, found });
        }
        Tin::check_nodes(nodes)?;
        let uplift = live.state.uplift.at_nodes.clone();
        let land = Arc::new(live.world().clone());
        Ok(Self::new(&live.params, land, uplift, None, nodes))
    }

    /// Of a box of a `land` that has been refined as a whole.
    ///
    /// # Errors
    /// When the box cannot be cut out.
    pub fn of_region(params: &SimParams, land: &Refined, region: Region) -> Result<Self, RefineError> {
        let around = Arc::new(land.world.clone());
        region.check(around.tin.extent())?;
        let flow = routed(&around, params.erosion.edges, None);
        let cut = Cut {
            crossings: Crossings::of(&around.tin, &flow, &region),
            around: Arc::clone(&around),
            region,
        };
        let uplift = land.uplift.clone();
        Ok(Self::new(params, around, uplift, Some(cut), region.nodes()))
    }

    fn new(params: &SimParams, land: Arc<World>, uplift: Vec<f64>, cut: Option<Cut>, nodes: usize) -> Self {
        let mut erosion = params.erosion;
        if cut.is_some() {
            // Rivers leave a box where they left it, at the heights they had there.
            erosion.edges = Edges::Fixed;
            erosion.base_level = None;
        }
        let area = cut
            .as_ref()
            .map_or(land.tin.extent().area(), |cut| cut.region.extent().area());
        let levels = levels(area / land.tin.spacing().powi(2), nodes);
        let cost = |(k, nodes): (usize, &usize)| nodes * (steps_of(k) + LAYING_STEPS);
        Self {
            all: levels.iter().enumerate().map(cost).sum(),
            uplift: (Arc::clone(&land.tin), uplift),
            erosion,
            land,
            rain: None,
            cut,
            levels,
            work: None,
            done: 0,
        }
    }

    /// How much of the work is done, 0–1.
    pub fn progress(&self) -> f64 {
        self.done as f64 / self.all as f64
    }

    /// Nodes of the level that is worked on.
    pub fn nodes(&self) -> usize {
        let next = self.levels.last().copied();
        let now = self.work.as_ref().map(|work| work.world.tin.len());
        now.or(next).unwrap_or(self.land.tin.len())
    }

    /// Does the next piece of work: lays the nodes of a level, or takes one step on it. False when all is done.
    ///
    /// # Errors
    /// When the land cannot be refined. It must not be stepped on then.
    pub fn step(&mut self) -> Result<bool, RefineError> {
        let Some(work) = &mut self.work else {
            let Some(nodes) = self.levels.pop() else {
                return Ok(false);
            };
            self.work = Some(self.lay(nodes)?);
            self.done += nodes * LAYING_STEPS;
            return Ok(true);
        };
        work.erode(&self.erosion)?;
        self.done += work.world.tin.len();
        if work.step < work.steps {
            return Ok(true);
        }
        if let Some(Work { mut world, rain, .. }) = self.work.take() {
            if let Some(cut) = &self.cut {
                cut.blend(&mut world);
            }
            self.land = Arc::new(world);
            self.rain = rain;
        }
        Ok(!self.levels.is_empty())
    }

    /// The land as it is now: refined when [`Self::step`] has said so.
    pub fn finish(self) -> Refined {
        let dt_yr = self.years() / STEPS as f64;
        let places = shifted(&self.land.tin, self.south_west());
        let (tin, rates) = self.uplift;
        Refined {
            uplift: Resampling::new(&tin, &places).linear(&rates),
            rain: self.rain,
            world: Arc::unwrap_or_clone(self.land),
            steps: STEPS,
            dt_yr,
        }
    }

    /// Model time that a level erodes for.
    fn years(&self) -> f64 {
        if self.cut.is_some() {
            BOX_YEARS
        } else {
            LEVEL_YEARS
        }
    }

    /// Where the plan of the refined land begins in that of the land it comes from, metres.
    fn south_west(&self) -> DVec2 {
        self.cut.as_ref().map_or(DVec2::ZERO, |cut| cut.region.south_west)
    }

    /// The box, if the next level is the first one in it: later ones have its own plan.
    fn cutting(&self) -> Option<&Cut> {
        self.cut
            .as_ref()
            .filter(|cut| Arc::ptr_eq(&cut.around, &self.land))
    }

    /// Lays `nodes` into the land so far.
    fn lay(&self, nodes: usize) -> Result<Work, RefineError> {
        let coarse = &*self.land;
        let extent = self
            .cut
            .as_ref()
            .map_or(coarse.tin.extent(), |cut| cut.region.extent());
        let origin = self.cutting().map_or(DVec2::ZERO, |cut| cut.region.south_west);
        let tin = Tin::poisson(extent, nodes, coarse.seed)?;
        let places = shifted(&tin, origin);
        let places = Resampling::new(&coarse.tin, &places);
        let mut world = coarse.resampled(Arc::new(tin), &places);
        let wanted = world.z.clone();
        let mut rain = None;
        if let Some(cut) = &self.cut {
            let outlets = cut.crossings.outlets(&world.tin, &wanted);
            rain = Some(cut.crossings.rain(&world.tin, &outlets));
            world.tin = Arc::new(Arc::unwrap_or_clone(world.tin).with_border(outlets)?);
        }
        if let Some(cut) = self.cutting() {
            cut.detach(&mut world);
        }
        let everywhere = shifted(&world.tin, self.south_west());
        let slopes = places.linear(&detail::slopes(&coarse.tin, &coarse.z));
        let spacing = coarse.tin.spacing();
        detail::roughen(&everywhere, &slopes, spacing, world.seed, &mut world.z);
        for (i, &border) in world.tin.border().iter().enumerate() {
            if border {
                world.z[i] = wanted[i];
            }
        }
        self.lay_beds(&mut world, origin);
        let last = self.levels.is_empty();
        let folds = if last && self.cut.is_none() {
            folds::finer(&mut world, self.years())
        } else {
            Vec::new()
        };
        let strength = || detail::strength(&everywhere, spacing, world.seed);
        Ok(Work {
            hold: Hold::new(&world.tin, HOLD_SPACINGS * spacing),
            wanted,
            base: Vec::new(),
            folds,
            rain,
            exposure: Exposure::default(),
            solver: Erosion::new(&world.tin),
            strength: self.cut.is_some().then(strength),
            years: self.years(),
            step: 0,
            steps: steps_of(self.levels.len()),
            world,
        })
    }

    /// Lays the rivers of the land so far into `world`, whose plan begins at `origin` of its.
    fn lay_beds(&self, world: &mut World, origin: DVec2) {
        let coarse = &*self.land;
        let flow = routed(coarse, self.erosion.edges, self.rain.as_deref());
        let depth = |p: DVec2| self.cut.as_ref().map_or(1.0, |cut| cut.share(p));
        bed::lay_beds(
            (&coarse.tin, &coarse.z, &flow),
            &world.tin,
            origin,
            depth,
            &mut world.z,
        );
    }
}

impl Work {
    /// One step.
    fn erode(&mut self, params: &ErosionParams) -> Result<(), RefineError> {
        let dt_yr = self.years / self.steps as f64;
        let world = &mut self.world;
        self.hold.rise(&world.tin, &self.wanted, &world.z, &mut self.base);
        for rate in &mut self.base {
            *rate /= dt_yr;
        }
        let folds: Vec<&NodeFolds> = self.folds.iter().collect();
        self.exposure.read(world, &self.base, &folds);
        if let Some(strength) = &self.strength {
            let drained = self.solver.drainage();
            self.exposure
                .weaken(|i| [drained[i] / (drained[i] + CHANNEL_HEAD), strength[i]]);
        }
        let forcing = Forcing {
            rain: self.rain.as_deref(),
            ..self.exposure.forcing()
        };
        let before = world.z.clone();
        let sums = self
            .solver
            .step(&world.tin, &mut world.z, &forcing, params, dt_yr);
        let heights = before.iter().zip(&world.z).zip(&self.exposure.rise);
        for (cover, ((before, after), rise)) in world.sediment.thickness.iter_mut().zip(heights) {
            let cut = before + rise * dt_yr - after;
            *cover = (*cover - cut.max(0.0)).max(0.0);
        }
        self.step += 1;
        if sums.not_finite > 0 {
            return Err(RefineError::NotFinite {
                step: self.step,
                nodes: world.tin.len(),
            });
        }
        if !self.folds.is_empty() {
            world.strata.advance(|_| 0.0, &self.folds, dt_yr);
            let risen = self.exposure.rise.iter().zip(&self.base);
            for (wanted, (rise, base)) in self.wanted.iter_mut().zip(risen) {
                *wanted += (rise - base) * dt_yr;
            }
        }
        Ok(())
    }
}

impl Cut {
    /// How much of the refined box counts at `p`.
    fn share(&self, p: DVec2) -> f64 {
        self.region.share(p, self.around.tin.spacing())
    }

    /// Makes a part of the land around a land of its own.
    fn detach(&self, world: &mut World) {
        world.map = PlanMap::new(DVec2::splat(1000.0), self.region.side);
        world.plates = PlateSet::default();
        world.skeletons.clear();
        world.fold_edits.clear();
        world.folded = None;
    }

    /// Lets a refined box pass into the land around it at its edges.
    fn blend(&self, world: &mut World) {
        let places = shifted(&world.tin, self.region.south_west);
        let around = Resampling::new(&self.around.tin, &places);
        let share: Vec<f64> = world.tin.positions().iter().map(|&p| self.share(p)).collect();
        let blend = |values: &mut Vec<f64>, outside: &[f64]| {
            for (value, (outside, share)) in values.iter_mut().zip(outside.iter().zip(&share)) {
                *value = outside + share * (*value - outside);
            }
        };
        blend(&mut world.z, &around.smooth(&self.around.z));
        blend(
            &mut world.sediment.thickness,
            &around.linear(&self.around.sediment.thickness),
        );
    }
}

impl Checkpoint {
    /// The session on its refined land: for pictures and files. Nothing of what was before it can be undone there.
    #[must_use]
    pub fn refined(mut self, refined: Refined) -> Self {
        let state = &mut self.state;
        let mut uplift = state.uplift.still_on(refined.world.tin.len());
        uplift.at_nodes = refined.uplift;
        state.uplift = Arc::new(uplift);
        state.world = refined.world;
        state.undo.clear();
        state.history = super::history::History::default();
        state.found.clear();
        state.stale = true;
        self.params.fold_layers = usize::MAX;
        self
    }
}

/// Nodes of the levels from `from` nodes to `to`, the last one first.
fn levels(from: f64, to: usize) -> Vec<usize> {
    let finer = (to as f64 / from).sqrt().max(1.0);
    let count = (finer.ln() / MOST_FINER.ln()).ceil().max(1.0);
    (0..count as usize)
        .map(|k| (to as f64 / finer.powf(2.0 * k as f64 / count)).round() as usize)
        .collect()
}

/// Steps on the level before which `later` ones are left to come.
fn steps_of(later: usize) -> usize {
    if later == 0 { STEPS } else { EARLIER_STEPS }
}

/// The water over a land.
fn routed(land: &World, edges: Edges, rain: Option<&[f64]>) -> Flow {
    let mut flow = Flow::new(&land.tin);
    flow.route(&land.tin, &land.z, edges.into(), rain);
    flow
}

/// Positions of nodes in a plan whose origin lies at `−origin` of theirs.
fn shifted(tin: &Tin, origin: DVec2) -> Vec<DVec2> {
    tin.positions().iter().map(|&p| p + origin).collect()
}
