//! One step of the land: uplift, rivers, landslides.

use rayon::prelude::*;

use super::blocks::{BLOCK, Stretch, sum_in_blocks};
use super::flow::Flow;
use super::landslide::{Landslides, Slopes};
use super::params::{Edges, ErosionParams};
use super::sediment::{Deposition, Falls, Moved, Sediment};
use super::shared_stream_power::{Rivers, SharedStreamPower};
use super::stream_power::{Network, StreamPower, Surface};
use super::tin::{NodeId, Tin};

/// What drives a step, node by node. Each slice holds one value per node.
#[derive(Clone, Copy, Debug)]
pub struct Forcing<'a> {
    /// Uplift rate, m/yr; negative subsides.
    pub uplift: &'a [f64],
    /// Factor on the erosion constant; none: 1.
    pub erodibility: Option<&'a [f64]>,
    /// Talus slope tan θ; none: [`ErosionParams::talus`].
    pub talus: Option<&'a [f64]>,
    /// Factor on the rain; none: 1.
    pub rain: Option<&'a [f64]>,
    /// Share (0 to 1) of erosion that is held off: 1 neither incises nor slides.
    pub protect: Option<&'a [f64]>,
}

impl<'a> Forcing<'a> {
    /// Uplift alone.
    pub fn uplift(uplift: &'a [f64]) -> Self {
        Self {
            uplift,
            erodibility: None,
            talus: None,
            rain: None,
            protect: None,
        }
    }

    fn check(&self, nodes: usize) {
        let all = [
            Some(self.uplift),
            self.erodibility,
            self.talus,
            self.rain,
            self.protect,
        ];
        let fits = all.iter().flatten().all(|slice| slice.len() == nodes);
        assert!(fits, "forcing needs one value per node");
    }

    /// The share of erosion that a node is exposed to.
    pub(super) fn exposure(&self, i: usize) -> f64 {
        self.protect.map_or(1.0, |protect| 1.0 - protect[i])
    }
}

/// What a step moved. To round-off, Σ a (z′ − z) = uplifted − fluvial − landslide + deposited + base level, and where
/// sediment is kept, fluvial + landslide = deposited + exported + what the debris of [`Sediment`] has grown by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepSums {
    /// Volume raised by the uplift, m³ (fixed border nodes do not rise).
    pub uplifted_m3: f64,
    /// Volume cut by rivers, m³.
    pub fluvial_m3: f64,
    /// Volume fallen in landslides, m³.
    pub landslide_m3: f64,
    /// Volume that rivers and lakes laid down, m³.
    pub deposited_m3: f64,
    /// Volume of sediment that left the land over the border, m³; 0 where no sediment is kept.
    pub exported_m3: f64,
    /// Volume added where border nodes were set to the base level, m³.
    pub base_level_m3: f64,
    /// Separate water surfaces at the start of the step.
    pub lakes: usize,
    /// Heights that are NaN or infinite after the step.
    pub not_finite: usize,
}

/// The erosion of a TIN: scratch memory and the flow of the last step. The land itself is the caller's slice of heights.
#[derive(Clone, Debug)]
pub struct Erosion {
    flow: Flow,
    landslides: Landslides,
    rivers: SharedStreamPower,
    /// Height of the water surface after the step; in use only when there are lakes.
    water: Vec<f64>,
    /// Heights at the receivers beyond the edges of blocks.
    beyond: Vec<Vec<f64>>,
}

impl Erosion {
    /// Memory for a TIN. Later steps allocate next to nothing once the lakes have been as many as they get.
    pub fn new(tin: &Tin) -> Self {
        Self::in_blocks(tin, BLOCK)
    }

    /// Memory for a TIN whose blocks have so many nodes.
    pub(super) fn in_blocks(tin: &Tin, block: usize) -> Self {
        Self {
            flow: Flow::in_blocks(tin, block),
            landslides: Landslides::default(),
            rivers: SharedStreamPower::default(),
            water: vec![0.0; tin.len()],
            beyond: Vec::new(),
        }
    }

    /// One step of `dt_yr` years: routes water over `z` (m), then raises and incises it in one implicit solve
    /// (Eq. 5), then lets steep slopes slide. What is eroded leaves the land at once, whatever
    /// [`ErosionParams::deposition`]. The same bits for any number of threads.
    ///
    /// Heights that are not finite spread, are counted in [`StepSums::not_finite`], and do no other harm.
    ///
    /// # Panics
    /// If a slice does not hold one value per node of the TIN given to [`Self::new`].
    pub fn step(
        &mut self,
        tin: &Tin,
        z: &mut [f64],
        forcing: &Forcing<'_>,
        params: &ErosionParams,
        dt_yr: f64,
    ) -> StepSums {
        self.advance(tin, z, None, forcing, params, dt_yr)
    }

    /// Like [`Self::step`], but what rivers and slides take is carried down the rivers, and laid down where they are
    /// weak or end in a lake, as [`ErosionParams::deposition`] says. Without that law it is the same step to the bit,
    /// and `sediment` is cleared.
    ///
    /// # Panics
    /// If a slice does not hold one value per node of the TIN given to [`Self::new`].
    pub fn step_with_sediment(
        &mut self,
        tin: &Tin,
        z: &mut [f64],
        sediment: &mut Sediment,
        forcing: &Forcing<'_>,
        params: &ErosionParams,
        dt_yr: f64,
    ) -> StepSums {
        let fits = [&sediment.thickness, &sediment.debris];
        assert!(
            fits.iter().all(|values| values.len() == tin.len()),
            "one value of sediment per node"
        );
        let law = params.deposition.filter(|_| params.n == 1.0);
        if law.is_none() {
            sediment.clear();
        }
        let kept = law.map(|deposition| (sediment, deposition));
        self.advance(tin, z, kept, forcing, params, dt_yr)
    }

    fn advance(
        &mut self,
        tin: &Tin,
        z: &mut [f64],
        mut sediment: Option<(&mut Sediment, Deposition)>,
        forcing: &Forcing<'_>,
        params: &ErosionParams,
        dt_yr: f64,
    ) -> StepSums {
        forcing.check(tin.len());
        let outlets = params.edges.into();
        self.flow
            .route_with(tin, z, outlets, forcing.rain, sediment.is_some());
        let mut sums = StepSums {
            lakes: self.flow.lakes().count(),
            ..StepSums::default()
        };
        if sediment.is_some() && self.flow.lakes().any() {
            let (lakes, z) = (self.flow.lakes(), &*z);
            let levels = self.water.par_iter_mut().with_min_len(self.flow.blocks().size());
            levels
                .enumerate()
                .for_each(|(i, water)| *water = lakes.level(NodeId::new(i), z[i]));
        }
        self.move_outlets(tin, z, forcing, params, dt_yr, &mut sums);
        if let Some((sediment, deposition)) = &mut sediment {
            // What outlets lose is over the border.
            sums.exported_m3 = sums.fluvial_m3;
            let rivers = Rivers {
                network: network(&self.flow, tin),
                blocks: self.flow.blocks(),
                lakes: self.flow.lakes(),
                areas: tin.areas(),
                forcing,
                params,
                deposition: *deposition,
                dt_yr,
            };
            let water = self.flow.lakes().any().then_some(&self.water[..]);
            let moved = self.rivers.step(&rivers, z, water, sediment);
            sums.add(&moved);
        } else {
            self.incise(tin, z, forcing, params, dt_yr, &mut sums);
        }
        if params.landslides {
            let kept = sediment.map(|(sediment, _)| sediment);
            sums.landslide_m3 = self.slide(tin, z, kept, forcing, params, dt_yr);
        }
        self.settle_water(z);
        let heights = z.par_iter().with_min_len(self.flow.blocks().size());
        sums.not_finite = heights.filter(|height| !height.is_finite()).count();
        sums
    }

    /// Lets slopes slide; returns the volume, m³.
    fn slide(
        &mut self,
        tin: &Tin,
        z: &mut [f64],
        mut sediment: Option<&mut Sediment>,
        forcing: &Forcing<'_>,
        params: &ErosionParams,
        dt_yr: f64,
    ) -> f64 {
        let fixed = params.edges == Edges::Fixed;
        let reach = |i: usize| {
            if fixed && tin.border()[i] {
                0.0
            } else {
                params.landslide_rate * dt_yr * forcing.exposure(i)
            }
        };
        let slopes = Slopes {
            tin,
            talus: |i: usize| forcing.talus.map_or(params.talus, |talus| talus[i]),
            reach,
        };
        let areas = tin.areas();
        self.landslides.find(&slopes, z);
        let mut volume = 0.0;
        let size = self.flow.blocks().size();
        if tin.len() > size {
            let mut parts = Falls::in_blocks(sediment.as_deref_mut(), tin.len(), size);
            let slid = |falls: &mut Falls<'_>, i: usize, below: usize, depth: f64| {
                falls.add(areas[i], i, below, depth);
            };
            self.landslides
                .slide_in_blocks(&slopes, z, size, &mut parts, slid);
            volume = parts.iter().map(|part| part.volume).sum();
        }
        let mut rest = Falls::whole(sediment);
        rest.volume = volume;
        self.landslides.slide_across(&slopes, z, |i, below, depth| {
            rest.add(areas[i], i, below, depth);
        });
        rest.volume
    }

    /// Outlets have no receiver: the edges say how they move.
    fn move_outlets(
        &self,
        tin: &Tin,
        z: &mut [f64],
        forcing: &Forcing<'_>,
        params: &ErosionParams,
        dt_yr: f64,
        sums: &mut StepSums,
    ) {
        let areas = tin.areas();
        let cut = StreamPower::from(params);
        for node in tin
            .nodes()
            .filter(|&node| tin.is_border(node) && self.flow.receiver(node).is_none())
        {
            let i = node.index();
            match (params.edges, params.base_level) {
                (Edges::Fixed, None) => {}
                (Edges::Fixed, Some(level)) => {
                    sums.base_level_m3 += areas[i] * (level - z[i]);
                    z[i] = level;
                }
                (Edges::Free, level) => {
                    let rise = dt_yr * forcing.uplift[i];
                    sums.uplifted_m3 += areas[i] * rise;
                    z[i] += rise;
                    let excess = level.map_or(0.0, |level| z[i] - level);
                    if excess > 0.0 {
                        let duration = dt_yr * factor(forcing, i);
                        let left =
                            cut.remaining(duration, self.flow.drainage()[i], tin.spacing().powi(2), excess);
                        z[i] -= excess - left;
                        sums.fluvial_m3 += areas[i] * (excess - left);
                    }
                }
            }
        }
    }

    fn incise(
        &mut self,
        tin: &Tin,
        z: &mut [f64],
        forcing: &Forcing<'_>,
        params: &ErosionParams,
        dt_yr: f64,
        sums: &mut StepSums,
    ) {
        let areas = tin.areas();
        let network = network(&self.flow, tin);
        let blocks = self.flow.blocks();
        let rise = |i: usize| dt_yr * forcing.uplift[i];
        let duration = |i: usize| dt_yr * factor(forcing, i);
        let law = StreamPower::from(params);
        let run = |stretch: Stretch<'_>, surface: Surface<'_>, volume: &mut f64| {
            let eroded = |i: usize, depth: f64| *volume += areas[i] * depth;
            law.sweep(&network, stretch, surface, rise, duration, eroded);
        };
        sums.uplifted_m3 += sum_in_blocks(tin.len(), blocks.size(), |i| {
            let risen = self.flow.receivers()[i].index() != i;
            if risen { areas[i] * rise(i) } else { 0.0 }
        });
        let mut water = self.flow.lakes().any().then_some(&mut self.water[..]);
        let surface = Surface {
            z,
            water: water.as_deref_mut(),
        };
        run(blocks.trunk(network.order), surface, &mut sums.fluvial_m3);
        let levels = water.as_deref().unwrap_or(z);
        let headwaters = blocks.headwaters(network.order, &mut self.beyond, |node| levels[node]);
        let volumes = (headwaters, Surface { z, water }.in_blocks(blocks.size()))
            .into_par_iter()
            .map(|(stretch, surface)| {
                let mut volume = 0.0;
                run(stretch, surface, &mut volume);
                volume
            });
        sums.fluvial_m3 += volumes.collect::<Vec<f64>>().iter().sum::<f64>();
    }

    /// Water stands, along the flow, at the highest ground further down.
    fn settle_water(&mut self, z: &[f64]) {
        if !self.flow.lakes().any() {
            return;
        }
        let (blocks, order, receivers) = (self.flow.blocks(), self.flow.order(), self.flow.receivers());
        let settle = |mut stretch: Stretch<'_>, water: &mut [f64]| {
            for node in stretch.order {
                let i = node.index();
                let receiver = receivers[i].index();
                water[i - stretch.first] = if receiver == i {
                    z[i]
                } else {
                    z[i].max(stretch.below(receiver, water))
                };
            }
        };
        settle(blocks.trunk(order), &mut self.water);
        let headwaters = blocks.headwaters(order, &mut self.beyond, |node| self.water[node]);
        headwaters
            .into_par_iter()
            .zip(self.water.par_chunks_mut(blocks.size()))
            .for_each(|(stretch, water)| settle(stretch, water));
    }

    /// The flow over the heights with which the last step began.
    pub fn flow(&self) -> &Flow {
        &self.flow
    }

    /// Where each node's water went in the last step; outlets name themselves.
    pub fn receivers(&self) -> &[NodeId] {
        self.flow.receivers()
    }

    /// Every node once, each after its receiver.
    pub fn order(&self) -> &[NodeId] {
        self.flow.order()
    }

    /// Drainage area in the last step, m².
    pub fn drainage(&self) -> &[f64] {
        self.flow.drainage()
    }

    /// Height of the water surface at each node after the last step, m: `z`, the heights that step left, where the
    /// node is dry.
    pub fn water_level<'a>(&'a self, z: &'a [f64]) -> &'a [f64] {
        if self.flow.lakes().any() { &self.water } else { z }
    }
}

impl StepSums {
    fn add(&mut self, moved: &Moved) {
        self.uplifted_m3 += moved.uplifted;
        self.fluvial_m3 += moved.eroded;
        self.deposited_m3 += moved.deposited;
        self.exported_m3 += moved.exported;
    }
}

/// The rivers of a flow.
fn network<'a>(flow: &'a Flow, tin: &'a Tin) -> Network<'a> {
    Network {
        positions: tin.positions(),
        receivers: flow.receivers(),
        order: flow.order(),
        drainage: flow.drainage(),
    }
}

impl From<&ErosionParams> for StreamPower {
    fn from(params: &ErosionParams) -> Self {
        let &ErosionParams { k, m, n, .. } = params;
        Self { k, m, n }
    }
}

/// Factor on the erosion constant at a node.
fn factor(forcing: &Forcing<'_>, i: usize) -> f64 {
    forcing.erodibility.map_or(1.0, |erodibility| erodibility[i]) * forcing.exposure(i)
}
