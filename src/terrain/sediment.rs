//! Sediment: what rivers and slides take goes down the rivers, and comes to rest where they are weak.

use rayon::prelude::*;

use super::erosion::{Bound, ErosionParams, Forcing, OutOfBounds, bound};
use super::lakes::Lakes;
use super::stream_power::Network;
use super::tin::NodeId;

/// Nodes per task of the parallel pass.
const CHUNK: usize = 16_384;

/// Thickness from which loose sediment hides the rock, m. Thinner covers count in part, so that a node does not jump
/// between two erodibilities from step to step.
const FULL_COVER: f64 = 10.0;

/// Least drainage area that a transport capacity is worked out for, m².
const LEAST_DRAINAGE: f64 = 1.0;

/// How rivers lay sediment down: the shared stream power model (Hergarten 2020, esurf 8, 841–854).
///
/// Erosion E (negative: deposition) and the flux of sediment Q share the power of the stream,
///
/// E / Kd + Q / (Kt A) = Aᵐ S,
///
/// with Kd = k (1 + G) and Kt = k (1 + G) / G. Where E is the same everywhere Q = A E, the two terms add up to E / k,
/// and the steady land is that of the plain law. G = 0 lays nothing down in rivers; a large G makes a river that is
/// always as loaded as it can be. Lakes catch sediment whatever G.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deposition {
    /// G = Kd / Kt, 0 to 10. Real rivers: near 1 (0.3 to 3).
    pub settling: f64,
    /// Factor on Kd where loose sediment covers the rock; not below the rock's own.
    pub loose: f64,
}

impl Default for Deposition {
    fn default() -> Self {
        Self {
            settling: 1.0,
            loose: 2.0,
        }
    }
}

impl Deposition {
    /// Ranges of the parameters.
    pub const BOUNDS: [Bound; 2] = [bound("settling", "", 0.0, 10.0), bound("loose", "", 0.1, 100.0)];

    /// Checks each parameter against its range.
    ///
    /// # Errors
    /// The first parameter outside its range (NaN is outside every range).
    pub fn check(&self) -> Result<(), OutOfBounds> {
        let values = [self.settling, self.loose];
        for (bound, found) in Self::BOUNDS.into_iter().zip(values) {
            if !(bound.min..=bound.max).contains(&found) {
                return Err(OutOfBounds { bound, found });
            }
        }
        Ok(())
    }
}

/// The loose sediment of a land, one value per node. It rises and sinks with the rock under it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sediment {
    /// Thickness of the loose cover, m, never negative: it grows by deposition and is eroded before the rock.
    pub thickness: Vec<f64>,
    /// What slid to the foot of a slope and waits for the river, m³. It is in no height until the river lays it down.
    pub debris: Vec<f64>,
}

impl Sediment {
    /// Bare rock on `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        Self {
            thickness: vec![0.0; nodes],
            debris: vec![0.0; nodes],
        }
    }

    /// Back to bare rock: what lies is taken as rock, what waits is gone.
    pub fn clear(&mut self) {
        self.thickness.fill(0.0);
        self.debris.fill(0.0);
    }

    /// The surface of a node is cut by `depth` (m); negative lays sediment down.
    pub(super) fn cut(&mut self, i: usize, depth: f64) {
        // The larger of zero and what is no number is zero.
        self.thickness[i] = (self.thickness[i] - depth).max(0.0);
    }
}

/// Volumes of one step, m³.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moved {
    pub(super) uplifted: f64,
    pub(super) eroded: f64,
    pub(super) deposited: f64,
    pub(super) exported: f64,
}

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
}

/// What a step of the rivers works on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rivers<'a> {
    pub(super) network: Network<'a>,
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

    /// Reads which of so many nodes lies in the basin of which lake.
    fn find(&mut self, lakes: &Lakes, nodes: usize) {
        self.lake.clear();
        self.room.clear();
        self.room.resize(lakes.surfaces(), 0.0);
        if !self.room.is_empty() {
            let of = |i| lakes.surface_of(NodeId::new(i)).unwrap_or(Self::NONE);
            self.lake.extend((0..nodes).map(of));
        }
    }

    /// The room in each lake before any sediment has come.
    fn measure(&mut self, reaches: &[Reach]) {
        self.room.fill(0.0);
        for (reach, &lake) in reaches
            .iter()
            .zip(&self.lake)
            .filter(|(reach, _)| reach.pool > 0.0)
        {
            self.room[lake as usize] += reach.pool;
        }
        self.fines.clear();
        self.fines.resize(self.room.len(), 0.0);
    }

    /// What goes on to the `receiver` of node `i`, which is under water, of the `volume` that comes to it, m³.
    fn hand_on(&mut self, reaches: &[Reach], i: usize, receiver: usize, volume: f64) -> f64 {
        let lake = self.lake[i];
        let room = &mut self.room[lake as usize];
        let kept = volume.min(reaches[i].pool);
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
        for (reach, &lake) in reaches
            .iter_mut()
            .zip(&self.lake)
            .filter(|(reach, _)| reach.pool > 0.0)
        {
            let left = (reach.pool + reach.cut * reach.area).max(0.0);
            reach.cut -= self.fines[lake as usize] * left / reach.area;
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
        self.basins.find(rivers.lakes, heights.len());
        self.basins.measure(&self.reaches);
        self.eliminate(&rivers.network);
        self.substitute(&rivers.network, &sediment.debris);
        self.basins.measure(&self.reaches);
        let exported = self.carry(&rivers.network);
        self.basins.lay_fines(&mut self.reaches);
        Moved {
            exported,
            ..self.settle(rivers, z, sediment)
        }
    }

    /// From the sources downstream: how the cut of each node depends on the fall of its receiver.
    fn eliminate(&mut self, network: &Network<'_>) {
        for node in network.order.iter().rev() {
            let i = node.index();
            let receiver = network.receivers[i].index();
            if receiver == i {
                continue;
            }
            let reach = &mut self.reaches[i];
            let (volume, response) = if reach.pool == 0.0 {
                let response = reach.response + reach.area;
                let scale = 1.0 / (1.0 + reach.fall + reach.settling * response);
                reach.cut = (reach.fall * reach.height - reach.settling * reach.volume) * scale;
                reach.fall *= scale;
                (reach.volume + response * reach.cut, response * reach.fall)
            } else {
                let over = self
                    .basins
                    .hand_on(&self.reaches, i, receiver, self.reaches[i].volume);
                let Reach { response, height, .. } = self.reaches[i];
                if over > 0.0 {
                    // Water falls with the spill, whose surface is another one.
                    (over + response * height, response)
                } else {
                    (0.0, 0.0)
                }
            };
            let below = &mut self.reaches[receiver];
            below.volume += volume;
            below.response += response;
        }
    }

    /// From the outlets upstream: the cuts.
    fn substitute(&mut self, network: &Network<'_>, debris: &[f64]) {
        for node in network.order {
            let i = node.index();
            let receiver = network.receivers[i].index();
            let below = self.reaches[receiver].fall;
            let reach = &mut self.reaches[i];
            reach.volume = debris[i];
            if receiver == i {
                continue;
            }
            let excess = reach.height + below;
            reach.fall = if reach.pool == 0.0 {
                // Sediment that a drowned node seemed to send back must not dig below the water.
                // (Comparisons, not minima: what is no number must be seen.)
                let (cut, most) = (reach.cut + reach.fall * below, excess.max(0.0));
                reach.cut = if cut > most { most } else { cut };
                if excess < reach.cut { excess } else { reach.cut }
            } else {
                excess.min(reach.settling)
            };
        }
    }

    /// From the sources downstream: moves the sediment. Returns what leaves over the border, m³.
    fn carry(&mut self, network: &Network<'_>) -> f64 {
        let mut exported = 0.0;
        for node in network.order.iter().rev() {
            let i = node.index();
            let receiver = network.receivers[i].index();
            let reach = &mut self.reaches[i];
            if receiver == i {
                exported += reach.volume;
                continue;
            }
            let mut left = reach.volume + reach.area * reach.cut;
            // Under water it fills the room there is; elsewhere no more is laid down than arrives.
            if reach.pool > 0.0 {
                let volume = reach.volume;
                reach.cut = -volume.min(reach.pool) / reach.area;
                left = self.basins.hand_on(&self.reaches, i, receiver, volume);
            } else if left < 0.0 {
                left = 0.0;
                reach.cut = -reach.volume / reach.area;
            }
            self.reaches[receiver].volume += left;
        }
        exported
    }

    /// Node by node: new heights and covers, and the sums.
    fn settle(&self, rivers: &Rivers<'_>, z: &mut [f64], sediment: &mut Sediment) -> Moved {
        let mut moved = Moved::default();
        let covers = sediment.thickness.iter_mut().zip(&mut sediment.debris);
        for (i, (z, (cover, debris))) in z.iter_mut().zip(covers).enumerate() {
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
    }
}
