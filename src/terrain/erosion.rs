//! One step of the land: uplift, rivers, landslides.

use super::flow::{Flow, Outlets};
use super::landslide::Landslides;
use super::sediment::{Deposition, Moved, Rivers, Sediment, SharedStreamPower};
use super::stream_power::{Network, StreamPower};
use super::tin::{NodeId, Tin};

/// What the border of the land does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Edges {
    /// Every border node is an outlet and keeps its height (or [`ErosionParams::base_level`]); it neither rises nor
    /// erodes. The land drains over all its sides.
    #[default]
    Fixed,
    /// Border nodes rise, erode and slide like any other. Water leaves where a border node has no lower neighbour, or
    /// where a lake spills over the border; there is always at least one such outlet. Outlets rise with the uplift
    /// and are cut down only by [`ErosionParams::base_level`].
    Free,
}

/// How the land erodes. Passed to each step, never stored in the land.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErosionParams {
    /// Erosion constant k of Eq. 5, 1/yr at m = 0.5 and n = 1. Smaller leaves plateaus, larger wears ranges down
    /// before they are high. The paper: 2.5e-7–8e-7.
    pub k: f64,
    /// Exponent m of the drainage area. m/n near 0.5 gives the concavity of real rivers.
    pub m: f64,
    /// Exponent n of the slope. 1 is solved exactly; others cost some iterations per node.
    pub n: f64,
    /// Talus slope tan θ above which slopes slide. 0 slides everywhere, large values never.
    pub talus: f64,
    /// Landslide rate l, m/yr. The steady slope exceeds the talus by U/l.
    pub landslide_rate: f64,
    /// Whether slopes slide at all.
    pub landslides: bool,
    /// What the border of the land does.
    pub edges: Edges,
    /// Height of the base level, m. None: with fixed edges each border node stays where it is, with free edges nothing
    /// cuts outlets down. Some: with fixed edges all border nodes are set to it; with free edges outlets above it
    /// incise towards it as if it lay one node spacing beyond the border.
    pub base_level: Option<f64>,
    /// How rivers lay down what they carry, in steps that keep sediment. None: what is eroded leaves the land at once,
    /// as in the paper. Some: n must be 1; with another n nothing is laid down.
    pub deposition: Option<Deposition>,
}

impl Default for ErosionParams {
    fn default() -> Self {
        Self {
            k: 1.8e-6,
            m: 0.5,
            n: 1.0,
            // 30°
            talus: 1.0 / 3.0_f64.sqrt(),
            landslide_rate: 1e-2,
            landslides: true,
            edges: Edges::Fixed,
            base_level: None,
            deposition: None,
        }
    }
}

/// Range of a parameter: validates settings and drives controls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Field of [`ErosionParams`] or [`Deposition`].
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

/// A parameter outside its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{} is {found} {}: expected {} to {}", bound.name, bound.unit, bound.min, bound.max)]
pub struct OutOfBounds {
    /// The range.
    pub bound: Bound,
    /// What was found.
    pub found: f64,
}

impl ErosionParams {
    /// Ranges of the numeric parameters.
    pub const BOUNDS: [Bound; 5] = [
        bound("k", "1/yr", 0.0, 1e-2),
        bound("m", "", 0.0, 2.0),
        bound("n", "", 0.2, 4.0),
        bound("talus", "", 0.0, 10.0),
        bound("landslide_rate", "m/yr", 0.0, 10.0),
    ];

    /// Checks each parameter against its range; the base level against ±20 km; and n against 1 where there is
    /// deposition.
    ///
    /// # Errors
    /// The first parameter outside its range (NaN is outside every range).
    pub fn check(&self) -> Result<(), OutOfBounds> {
        let values = [self.k, self.m, self.n, self.talus, self.landslide_rate];
        let base = (
            bound("base_level", "m", -2e4, 2e4),
            self.base_level.unwrap_or(0.0),
        );
        for (bound, found) in Self::BOUNDS.into_iter().zip(values).chain([base]) {
            if !(bound.min..=bound.max).contains(&found) {
                return Err(OutOfBounds { bound, found });
            }
        }
        let Some(deposition) = self.deposition else {
            return Ok(());
        };
        if self.n != 1.0 {
            return Err(OutOfBounds {
                bound: bound("n, with deposition,", "", 1.0, 1.0),
                found: self.n,
            });
        }
        deposition.check()
    }
}

pub(super) const fn bound(name: &'static str, unit: &'static str, min: f64, max: f64) -> Bound {
    Bound { name, unit, min, max }
}

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
}

impl Erosion {
    /// Memory for a TIN. Later steps allocate nothing once the lakes have been as many as they get.
    pub fn new(tin: &Tin) -> Self {
        Self {
            flow: Flow::new(tin),
            landslides: Landslides::default(),
            rivers: SharedStreamPower::default(),
            water: vec![0.0; tin.len()],
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
        let fixed = params.edges == Edges::Fixed;
        let outlets = if fixed { Outlets::Border } else { Outlets::Lowest };
        self.flow.route(tin, z, outlets, forcing.rain);
        let mut sums = StepSums {
            lakes: self.flow.lakes().count(),
            ..StepSums::default()
        };
        if sediment.is_some() && self.flow.lakes().any() {
            for (node, (water, z)) in tin.nodes().zip(self.water.iter_mut().zip(&*z)) {
                *water = self.flow.lakes().level(node, *z);
            }
        }
        self.move_outlets(tin, z, forcing, params, dt_yr, &mut sums);
        if let Some((sediment, deposition)) = &mut sediment {
            // What outlets lose is over the border.
            sums.exported_m3 = sums.fluvial_m3;
            let rivers = Rivers {
                network: network(&self.flow, tin),
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
            let areas = tin.areas();
            let talus = |i: usize| forcing.talus.map_or(params.talus, |talus| talus[i]);
            let reach = |i: usize| {
                let held = fixed && tin.border()[i];
                if held {
                    0.0
                } else {
                    params.landslide_rate * dt_yr * forcing.exposure(i)
                }
            };
            let slid = |i: usize, below: usize, depth: f64| {
                sums.landslide_m3 += areas[i] * depth;
                if let Some((sediment, _)) = &mut sediment {
                    sediment.cut(i, depth);
                    sediment.debris[below] += areas[i] * depth;
                }
            };
            self.landslides.step(tin, z, talus, reach, slid);
        }
        self.settle_water(z);
        sums.not_finite = z.iter().filter(|height| !height.is_finite()).count();
        sums
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
        let rise = |i: usize| dt_yr * forcing.uplift[i];
        let risen = tin.nodes().filter(|&node| self.flow.receiver(node).is_some());
        sums.uplifted_m3 += risen
            .map(|node| areas[node.index()] * rise(node.index()))
            .sum::<f64>();
        let water = self.flow.lakes().any().then_some(&mut self.water[..]);
        let eroded = |i: usize, depth: f64| sums.fluvial_m3 += areas[i] * depth;
        let duration = |i: usize| dt_yr * factor(forcing, i);
        StreamPower::from(params).step(&network, z, water, rise, duration, eroded);
    }

    /// Water stands, along the flow, at the highest ground further down.
    fn settle_water(&mut self, z: &[f64]) {
        if self.flow.lakes().any() {
            for node in self.flow.order() {
                let i = node.index();
                let receiver = self.flow.receivers()[i].index();
                self.water[i] = if receiver == i {
                    z[i]
                } else {
                    z[i].max(self.water[receiver])
                };
            }
        }
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
