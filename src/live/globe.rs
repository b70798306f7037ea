//! The planet, played live.

use std::io;
use std::sync::Arc;

use glam::DVec2;

use super::play::{Play, Published};
use super::{Clock, Ring};
use crate::gesture::command::Mode;
use crate::gesture::contact::{InputFrame, Side};
use crate::gesture::file::Header;
use crate::gesture::hand::{ContactStats, HandView};
use crate::globe::{self, Start};
use crate::sim::TICK_US;
use crate::sim::globe::{GlobeSim, GlobeSimParams, Tap, Tether};
use crate::sphere::Lattice;
use crate::surface::planet::Planet;
use crate::units::{GlobeView, MYR};

/// Least number of ticks from one drawing of a planet that moves to the next: 80 ms. The view follows its hands at once.
const DRAWN_TICKS: u64 = 5;

/// What a session of the planet needs to know.
#[derive(Clone, Debug)]
pub struct LiveGlobeParams {
    /// Size of the table, mm.
    pub size_mm: DVec2,
    /// Samples of the planet.
    pub samples: usize,
    /// What the first planet begins as.
    pub start: Start,
    /// Parameters of the session itself.
    pub sim: GlobeSimParams,
    /// Threads that compute; 0 takes one per core.
    pub threads: usize,
}

/// Everything that can be seen of the planet's session at one moment.
#[derive(Clone, Debug)]
pub struct GlobeFrame {
    /// Rises with every frame.
    pub sequence: u64,
    /// Rises when the planet was drawn anew; the view may change without.
    pub land: u64,
    /// The planet.
    pub planet: Arc<Planet>,
    /// How it lies on the table.
    pub view: GlobeView,
    /// Fingers and what they hold.
    pub tethers: Vec<Tether>,
    /// Marks of taps.
    pub taps: Vec<Tap>,
    /// The hands that are down.
    pub hands: Vec<HandView>,
    /// Time, and what moves.
    pub clock: Clock,
    /// What became of the contacts since the session began.
    pub contacts: ContactStats,
    /// Times that the session's thread panicked and went on from the last good planet.
    pub panics: u64,
    /// Steps of the planet since the thread began.
    pub steps: u64,
}

/// A frame that circulates.
#[derive(Clone, Debug)]
pub struct Slot(GlobeFrame);

impl AsRef<GlobeFrame> for Slot {
    fn as_ref(&self) -> &GlobeFrame {
        &self.0
    }
}

/// The planet on its session's thread.
#[derive(Debug)]
pub struct Globe {
    params: LiveGlobeParams,
    lattice: Arc<Lattice>,
    sim: GlobeSim,
    ring: Ring,
    /// What the session began as.
    first: Start,
    /// Where to go on from after a panic.
    good: GlobeSim,
    drawn: Drawn,
}

/// The planet as frames show it, and what it was drawn from.
#[derive(Debug)]
struct Drawn {
    planet: Arc<Planet>,
    of: Arc<globe::Planet>,
    pending_my: f64,
    tick: u64,
    /// Counts the drawings.
    land: u64,
}

impl Drawn {
    fn of(sim: &GlobeSim, land: u64) -> Self {
        Self {
            planet: Arc::new(sim.surface()),
            of: sim.planet_shared(),
            pending_my: sim.pending_my(),
            tick: sim.ticks(),
            land,
        }
    }

    /// Draws the planet again if it has changed, and not too soon.
    fn follow(&mut self, sim: &GlobeSim) {
        let same = Arc::ptr_eq(&self.of, &sim.planet_shared()) && self.pending_my == sim.pending_my();
        let soon = (self.tick..self.tick + DRAWN_TICKS).contains(&sim.ticks());
        if !(same || soon) {
            *self = Self::of(sim, self.land + 1);
        }
    }
}

impl Globe {
    fn new_sim(lattice: &Arc<Lattice>, start: Start, params: &LiveGlobeParams) -> io::Result<GlobeSim> {
        GlobeSim::new(Arc::clone(lattice), start, params.size_mm, params.sim).map_err(invalid)
    }
}

impl Play for Globe {
    type Params = LiveGlobeParams;
    type Start = Start;
    type Kept = GlobeSim;
    type Frame = GlobeFrame;
    type Slot = Slot;

    fn threads(params: &LiveGlobeParams) -> usize {
        params.threads
    }

    fn open(params: LiveGlobeParams) -> io::Result<Self> {
        let lattice = Arc::new(Lattice::new(params.samples).map_err(invalid)?);
        let first = params.start.clone();
        let sim = Self::new_sim(&lattice, first.clone(), &params)?;
        Ok(Self {
            good: sim.clone(),
            drawn: Drawn::of(&sim, 1),
            ring: new_ring(&params, &first),
            params,
            lattice,
            sim,
            first,
        })
    }

    fn slot(&self) -> Slot {
        Slot(GlobeFrame {
            sequence: 0,
            land: 0,
            planet: Arc::clone(&self.drawn.planet),
            view: self.sim.view(),
            tethers: Vec::new(),
            taps: Vec::new(),
            hands: Vec::new(),
            clock: clock(&self.sim),
            contacts: ContactStats::default(),
            panics: 0,
            steps: 0,
        })
    }

    fn ticks(&self) -> u64 {
        self.sim.ticks()
    }

    fn feed(&mut self, frame: InputFrame) {
        self.ring.record(&frame);
        self.sim.feed(frame);
    }

    fn tick(&mut self) -> u32 {
        self.sim.tick().steps
    }

    fn draw(&mut self, slot: &mut Slot, published: Published) {
        self.drawn.follow(&self.sim);
        let frame = &mut slot.0;
        frame.planet = Arc::clone(&self.drawn.planet);
        frame.land = self.drawn.land;
        frame.view = self.sim.view();
        frame.tethers = self.sim.tethers();
        frame.taps = self.sim.taps();
        frame.hands.clear();
        frame.hands.extend(self.sim.hands());
        frame.clock = clock(&self.sim);
        frame.contacts = self.sim.contact_stats();
        frame.sequence = published.sequence;
        frame.panics = published.panics;
        frame.steps = published.steps;
    }

    /// A planet afresh. Where it cannot be made the one that the session began with comes back.
    fn begin(&mut self, start: Start) {
        let made = Self::new_sim(&self.lattice, start.clone(), &self.params);
        if let Ok(sim) = made {
            self.sim = sim;
            self.first = start;
        } else if let Ok(sim) = Self::new_sim(&self.lattice, self.first.clone(), &self.params) {
            self.sim = sim;
        }
        self.good = self.sim.clone();
        self.ring = new_ring(&self.params, &self.first);
        self.drawn = Drawn::of(&self.sim, self.drawn.land + 1);
    }

    fn remember(&mut self) {
        self.good = self.sim.clone();
    }

    /// After a panic: the last good moment comes back, without contacts. If that panics again within a second, the planet
    /// that the session began with.
    fn recover(&mut self, relapses: u32) {
        let tick = self.sim.ticks();
        if relapses > 0
            && let Ok(afresh) = Self::new_sim(&self.lattice, self.first.clone(), &self.params)
        {
            self.good = afresh;
        }
        self.sim = self.good.clone();
        self.sim.skip_to(tick);
        self.sim.cancel_contacts();
        self.good = self.sim.clone();
        self.ring.cancel_contacts(tick * TICK_US);
    }

    fn kept(&self) -> GlobeSim {
        self.sim.clone()
    }

    fn ring(&self) -> &Ring {
        &self.ring
    }
}

fn invalid(error: impl std::error::Error + Send + Sync + 'static) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, error)
}

/// A ring for a session that begins with the planet of `start`.
fn new_ring(params: &LiveGlobeParams, start: &Start) -> Ring {
    let header = Header {
        title: Some("the last minute at the globe".to_owned()),
        mode: Mode::Globe,
        seed: Some(start.seed()),
        nodes: Some(params.samples as u64),
        ..Header::new(params.size_mm)
    };
    let pace = params.sim.pace_my_per_s;
    let usual = pace == GlobeSimParams::default().pace_my_per_s;
    Ring::new(header, (!usual).then_some(pace))
}

fn clock(sim: &GlobeSim) -> Clock {
    Clock {
        elapsed_yr: (sim.planet().time_my() + sim.pending_my()) * MYR,
        paused: sim.paused(),
        pace_yr_per_s: sim.pace_my_per_s() * MYR,
        can_undo: [Side::North, Side::South].map(|side| sim.can_undo(side)),
        ..Clock::default()
    }
}
