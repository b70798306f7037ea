//! The solver of rivers that take and lay down sediment.

use rayon::prelude::*;

use super::blocks::{Blocks, Stretch};
use super::erosion::Forcing;
use super::lakes::Lakes;
use super::params::ErosionParams;
use super::sediment::{Deposition, Moved, Sediment};
use super::stream_power::Network;
use super::tin::NodeId;

/// Nodes per task of the parallel pass.
const CHUNK: usize = 16_384;

/// Thickness from which loose sediment hides the rock, m. Thinner covers count in part, so that a node does not jump
/// between two erodibilities from step to step.
const FULL_COVER: f64 = 10.0;

/// Least drainage area that a transport capacity is worked out for, m².
const LEAST_DRAINAGE: f64 = 1.0;

/// One node while its rivers are solved: all that the sweeps need, in one line of the cache.
///
/// Heights are counted from the *surface* that there would be without erosion: ground rises, water stands.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Reach {
    /// Sediment that arrives in the step, m³: first if the surface of this node comes down by nothing, then in truth.
    volume: f64,
    /// How much more arrives for each metre by which the surface comes down, m².
    response: f64,
    /// Height of the surface over the receiver's, m.
    height: f64,
    /// The part α of the cut α + β · (fall of the receiver's surface), m; then the cut itself.
    cut: f64,
    /// Kd Aᵐ dt / distance; then β; then how far the surface of ground or water has fallen, m.
    fall: f64,
    /// Where it is dry: Kd / (Kt A), 1/m². Under water: the depth of the ground below the surface, m.
    settling: f64,
    /// Room for sediment under water, m³; 0 where it is dry.
    pool: f64,
    /// m².
    area: f64,
}

/// The solver of the shared stream power model: scratch memory.
///
/// Implicit in time and direct, in linear time (Hergarten 2020, §4). Let y be the cut of a node in the step, V = Q dt
/// the sediment that leaves it, Δ the height of its risen surface over its receiver's. With a its area,
///
/// y + g V = F (Δ − y + y′), V = Σ V of its donors + debris + a y, F = Kd dt Aᵐ / distance, g = Kd / (Kt A),
///
/// y′ the cut of the receiver. What donors send is linear in their receiver's cut: Σ V = P + R′ y. So, from the
/// sources downstream, with R = R′ + a,
///
/// y = α + β y′, α = (F Δ − g P) / (1 + F + g R), β = F / (1 + F + g R), V = (P + R α) + R β y′,
///
/// and from the outlets upstream y follows from y′. All terms are sums of numbers of one sign but for g P: any time
/// step is stable, and g = 0 is the plain law.
///
/// A node under water has no slope. It passes on the linear response of those upstream to the level of the
/// lake, which is the height of the node it spills over, and keeps as much sediment as fits under the water: deltas grow
/// along the ways of rivers. What would leave over the spill is fine and settles all over the lake; only what that has no
/// room for goes on.
///
/// A third sweep, downstream again, carries the sediment that was really moved. It makes volumes balance to round-off
/// where the linear answer is not the last word: a node that its receiver has risen above takes no more sediment
/// than comes by.
#[derive(Clone, Debug, Default)]
pub(super) struct SharedStreamPower {
    reaches: Vec<Reach>,
    basins: Basins,
    /// What goes over the edge of each block: sediment (m³) and response (m²).
    carried: Vec<Vec<[f64; 2]>>,
    /// How far surfaces beyond the edge of each block have fallen, m.
    beyond: Vec<Vec<f64>>,
}

/// Sediment in lakes.
#[derive(Clone, Debug, Default)]
struct Basins {
    /// The lake in whose basin each node lies; [`Self::NONE`] outside.
    lake: Vec<u32>,
    /// Room that is left in each lake, m³.
    room: Vec<f64>,
    /// What settles all over each lake, m³.
    fines: Vec<f64>,
    /// Nodes with room for sediment, chunk by chunk.
    pools: Vec<Vec<u32>>,
}

/// What a step of the rivers works on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rivers<'a> {
    pub(super) network: Network<'a>,
    /// How the network is cut; all that lies under water is trunk.
    pub(super) blocks: &'a Blocks,
    pub(super) lakes: &'a Lakes,
    pub(super) areas: &'a [f64],
    pub(super) forcing: &'a Forcing<'a>,
    pub(super) params: &'a ErosionParams,
    pub(super) deposition: Deposition,
    pub(super) dt_yr: f64,
}

impl Rivers<'_> {
    fn rise(&self, i: usize) -> f64 {
        self.dt_yr * self.forcing.uplift[i]
    }

    fn is_outlet(&self, i: usize) -> bool {
        self.network.receivers[i].index() == i
    }

    /// Height of the surface of a [`Reach`].
    fn surface(&self, z: &[f64], water: Option<&[f64]>, i: usize) -> f64 {
        match water {
            Some(water) if water[i] > z[i] => water[i],
            _ if self.is_outlet(i) => z[i],
            _ => z[i] + self.rise(i),
        }
    }

    fn reach(&self, z: &[f64], water: Option<&[f64]>, sediment: &Sediment, i: usize) -> Reach {
        let Network {
            positions,
            receivers,
            drainage,
            ..
        } = self.network;
        let receiver = receivers[i].index();
        let start = Reach {
            volume: sediment.debris[i],
            height: self.surface(z, water, i) - self.surface(z, water, receiver),
            area: self.areas[i],
            ..Reach::default()
        };
        if receiver == i {
            return start;
        }
        let depth = water.map_or(0.0, |water| water[i] - z[i]);
        if depth > 0.0 {
            return Reach {
                settling: depth - self.rise(i),
                pool: depth * self.areas[i],
                ..start
            };
        }
        let Deposition { settling, loose } = self.deposition;
        let rock = self.forcing.erodibility.map_or(1.0, |erodibility| erodibility[i]);
        let cover = (sediment.thickness[i] / FULL_COVER).min(1.0);
        let erodibility = (rock + (loose.max(rock) - rock) * cover) * self.forcing.exposure(i);
        let squared = positions[i].distance_squared(positions[receiver]);
        let power = if self.params.m == 0.5 {
            (drainage[i] / squared).sqrt()
        } else {
            drainage[i].powf(self.params.m) / squared.sqrt()
        };
        Reach {
            fall: self.params.k * (1.0 + settling) * erodibility * self.dt_yr * power,
            settling: settling * erodibility / drainage[i].max(LEAST_DRAINAGE),
            ..start
        }
    }
}

impl Basins {
    const NONE: u32 = u32::MAX;

    /// Reads which node lies in the basin of which lake, and which have room for sediment.
    fn find(&mut self, lakes: &Lakes, reaches: &[Reach]) {
        self.lake.clear();
        self.pools.iter_mut().for_each(Vec::clear);
        self.room.clear();
        self.room.resize(lakes.surfaces(), 0.0);
        if self.room.is_empty() {
            return;
        }
        self.lake.resize(reaches.len(), Self::NONE);
        self.pools.resize_with(reaches.len().div_ceil(CHUNK), Vec::new);
        (
            self.lake.par_chunks_mut(CHUNK),
            reaches.par_chunks(CHUNK),
            &mut self.pools,
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(chunk, (lake, reaches, pools))| {
                for (i, (lake, reach)) in (chunk * CHUNK..).zip(lake.iter_mut().zip(reaches)) {
                    *lake = lakes.surface_of(NodeId::new(i)).unwrap_or(Self::NONE);
                    if reach.pool > 0.0 {
                        pools.push(i as u32);
                    }
                }
            });
    }

    /// The room in each lake before any sediment has come.
    fn measure(&mut self, reaches: &[Reach]) {
        self.room.fill(0.0);
        for &i in self.pools.iter().flatten() {
            self.room[self.lake[i as usize] as usize] += reaches[i as usize].pool;
        }
        self.fines.clear();
        self.fines.resize(self.room.len(), 0.0);
    }

    /// What goes on to the `receiver` of node `i`, which is under water with room for `pool`, of the `volume` that comes
    /// to it, m³.
    fn hand_on(&mut self, pool: f64, i: usize, receiver: usize, volume: f64) -> f64 {
        let lake = self.lake[i];
        let room = &mut self.room[lake as usize];
        let kept = volume.min(pool);
        *room -= kept;
        let rest = volume - kept;
        if self.lake[receiver] == lake {
            return rest;
        }
        // All other nodes of the lake have had their share already: a lake has one way out, and they lie upstream.
        let stays = rest.min(*room).max(0.0);
        *room -= stays;
        self.fines[lake as usize] += stays;
        rest - stays
    }

    /// Spreads what has settled in each lake over the room that was left there.
    fn lay_fines(&mut self, reaches: &mut [Reach]) {
        if self.fines.iter().all(|&fines| fines == 0.0) {
            return;
        }
        for (room, fines) in self.room.iter().zip(&mut self.fines) {
            // `room` is what the fines have left.
            *fines /= (*room + *fines).max(f64::MIN_POSITIVE);
        }
        for &i in self.pools.iter().flatten() {
            let reach = &mut reaches[i as usize];
            let left = (reach.pool + reach.cut * reach.area).max(0.0);
            reach.cut -= self.fines[self.lake[i as usize] as usize] * left / reach.area;
        }
    }
}

impl SharedStreamPower {
    /// Raises all nodes but outlets, and lets rivers take and lay down sediment. `water` is the level at which water
    /// stands before the step, for lands with lakes.
    pub(super) fn step(
        &mut self,
        rivers: &Rivers<'_>,
        z: &mut [f64],
        water: Option<&[f64]>,
        sediment: &mut Sediment,
    ) -> Moved {
        self.reaches.resize(z.len(), Reach::default());
        let (heights, cover) = (&*z, &*sediment);
        self.reaches
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, reaches)| {
                for (i, reach) in (chunk * CHUNK..).zip(reaches) {
                    *reach = rivers.reach(heights, water, cover, i);
                }
            });
        self.basins.find(rivers.lakes, &self.reaches);
        self.basins.measure(&self.reaches);
        self.eliminate(rivers);
        self.substitute(rivers, &sediment.debris);
        self.basins.measure(&self.reaches);
        let exported = self.carry(rivers);
        self.basins.lay_fines(&mut self.reaches);
        Moved {
            exported,
            ..self.settle(rivers, z, sediment)
        }
    }

    /// From the sources downstream: how the cut of each node depends on the fall of its receiver.
    fn eliminate(&mut self, rivers: &Rivers<'_>) {
        self.down(rivers, eliminate);
    }

    /// From the outlets upstream: the cuts.
    fn substitute(&mut self, rivers: &Rivers<'_>, debris: &[f64]) {
        let Rivers { network, blocks, .. } = rivers;
        let sweep = |mut stretch: Stretch<'_>, reaches: &mut [Reach]| {
            for node in stretch.order {
                let i = node.index();
                let receiver = network.receivers[i].index();
                let k = i - stretch.first;
                reaches[k].volume = debris[i];
                if receiver == i {
                    continue;
                }
                let below = match reaches.get(receiver.wrapping_sub(stretch.first)) {
                    Some(below) => below.fall,
                    None => stretch.next_beyond(),
                };
                reaches[k].substitute(below);
            }
        };
        sweep(blocks.trunk(network.order), &mut self.reaches);
        let headwaters = blocks.headwaters(network.order, &mut self.beyond, |node| self.reaches[node].fall);
        (headwaters, self.reaches.par_chunks_mut(blocks.size()))
            .into_par_iter()
            .for_each(|(stretch, reaches)| sweep(stretch, reaches));
    }

    /// From the sources downstream: moves the sediment. Returns what leaves over the border, m³.
    fn carry(&mut self, rivers: &Rivers<'_>) -> f64 {
        self.down(rivers, carry)
    }

    /// From the sources downstream: each node hands on to its receiver what `pass` says. Returns the volumes at
    /// outlets, m³.
    fn down(&mut self, rivers: &Rivers<'_>, pass: impl Fn(Step<'_>) -> [f64; 2] + Sync) -> f64 {
        let Rivers { network, blocks, .. } = rivers;
        let sweep = |stretch: Stretch<'_>,
                     reaches: &mut [Reach],
                     mut basins: Option<&mut Basins>,
                     carried: &mut Vec<[f64; 2]>,
                     mut exported: f64| {
            let first = stretch.first;
            for node in stretch.order.iter().rev() {
                let i = node.index();
                let receiver = network.receivers[i].index();
                if receiver == i {
                    exported += reaches[i - first].volume;
                    continue;
                }
                let [volume, response] = pass(Step {
                    reach: &mut reaches[i - first],
                    i,
                    receiver,
                    basins: basins.as_deref_mut(),
                });
                match reaches.get_mut(receiver.wrapping_sub(first)) {
                    Some(below) => {
                        below.volume += volume;
                        below.response += response;
                    }
                    None => carried.push([volume, response]),
                }
            }
            exported
        };
        let headwaters = blocks.headwaters(network.order, &mut self.beyond, |_| 0.0);
        self.carried.resize_with(headwaters.len(), Vec::new);
        let reaches = self.reaches.par_chunks_mut(blocks.size());
        let exported: Vec<f64> = (headwaters, reaches, &mut self.carried)
            .into_par_iter()
            .map(|(stretch, reaches, carried)| {
                carried.clear();
                sweep(stretch, reaches, None, carried, 0.0)
            })
            .collect();
        for (to, [volume, response]) in blocks.exits().flatten().zip(self.carried.iter().flatten()) {
            let below = &mut self.reaches[to.index()];
            below.volume += volume;
            below.response += response;
        }
        let trunk = blocks.trunk(network.order);
        let basins = Some(&mut self.basins);
        sweep(
            trunk,
            &mut self.reaches,
            basins,
            &mut Vec::new(),
            exported.iter().sum(),
        )
    }

    /// Node by node: new heights and covers, and the sums.
    fn settle(&self, rivers: &Rivers<'_>, z: &mut [f64], sediment: &mut Sediment) -> Moved {
        let size = rivers.blocks.size();
        let Sediment { thickness, debris } = sediment;
        let parts = (
            z.par_chunks_mut(size),
            thickness.par_chunks_mut(size),
            debris.par_chunks_mut(size),
        );
        let moved: Vec<Moved> = parts
            .into_par_iter()
            .enumerate()
            .map(|(block, (z, thickness, debris))| {
                let mut moved = Moved::default();
                let covers = thickness.iter_mut().zip(debris);
                for (i, (z, (cover, debris))) in (block * size..).zip(z.iter_mut().zip(covers)) {
                    *debris = 0.0;
                    if rivers.is_outlet(i) {
                        continue;
                    }
                    let (rise, Reach { cut, area, .. }) = (rivers.rise(i), self.reaches[i]);
                    *z += rise - cut;
                    // The larger of zero and what is no number is zero.
                    *cover = (*cover - cut).max(0.0);
                    moved.uplifted += area * rise;
                    moved.eroded += area * cut.max(0.0);
                    moved.deposited += area * (-cut).max(0.0);
                }
                moved
            })
            .collect();
        let mut all = Moved::default();
        for Moved {
            uplifted,
            eroded,
            deposited,
            ..
        } in moved
        {
            all.uplifted += uplifted;
            all.eroded += eroded;
            all.deposited += deposited;
        }
        all
    }
}

/// A node in a sweep from the sources down.
struct Step<'a> {
    reach: &'a mut Reach,
    i: usize,
    receiver: usize,
    /// The lakes; none where nothing is under water.
    basins: Option<&'a mut Basins>,
}

impl Step<'_> {
    /// What goes on to the receiver of a node under water of the `volume` that comes to it, m³.
    fn hand_on(self, volume: f64) -> f64 {
        let Self {
            reach,
            i,
            receiver,
            basins,
        } = self;
        basins.map_or(volume, |basins| basins.hand_on(reach.pool, i, receiver, volume))
    }
}

/// Eliminates the cut of a node: the sediment (m³) and the response (m²) that its receiver gets.
fn eliminate(step: Step<'_>) -> [f64; 2] {
    let reach = &mut *step.reach;
    if reach.pool == 0.0 {
        let response = reach.response + reach.area;
        let scale = 1.0 / (1.0 + reach.fall + reach.settling * response);
        reach.cut = (reach.fall * reach.height - reach.settling * reach.volume) * scale;
        reach.fall *= scale;
        return [reach.volume + response * reach.cut, response * reach.fall];
    }
    let Reach {
        volume,
        response,
        height,
        ..
    } = *reach;
    let over = step.hand_on(volume);
    if over > 0.0 {
        // Water falls with the spill, whose surface is another one.
        [over + response * height, response]
    } else {
        [0.0, 0.0]
    }
}

/// Moves the sediment of a node: what its receiver gets, m³.
fn carry(step: Step<'_>) -> [f64; 2] {
    let reach = &mut *step.reach;
    let mut left = reach.volume + reach.area * reach.cut;
    // Under water it fills the room there is; elsewhere no more is laid down than arrives.
    if reach.pool > 0.0 {
        let volume = reach.volume;
        reach.cut = -volume.min(reach.pool) / reach.area;
        left = step.hand_on(volume);
    } else if left < 0.0 {
        left = 0.0;
        reach.cut = -reach.volume / reach.area;
    }
    [left, 0.0]
}

impl Reach {
    /// Solves the cut, now that the receiver's surface is known to have fallen by `below`.
    fn substitute(&mut self, below: f64) {
        let excess = self.height + below;
        self.fall = if self.pool == 0.0 {
            // Sediment that a drowned node seemed to send back must not dig below the water.
            // (Comparisons, not minima: what is no number must be seen.)
            let (cut, most) = (self.cut + self.fall * below, excess.max(0.0));
            self.cut = if cut > most { most } else { cut };
            if excess < self.cut { excess } else { self.cut }
        } else {
            excess.min(self.settling)
        };
    }
}
