//! From what hands do to what the land feels: plates, pushes that go on, uplift, and touches that answer nothing.

use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use super::folding::{FoldingLayer, folding_layers};
use super::step::Sim;
use crate::gesture::event::{HandEvent, HandId, Leg};
use crate::mountain::fold::FoldDrive;
use crate::mountain::residue::Residue;
use crate::mountain::strata::NodeFolds;
use crate::mountain::transport::TransportStage as _;
use crate::mountain::{Applied, FaultTrace, Field, PlateId, PlateSet, PlateState, TectonicField};
use crate::units::{KM, MYR};

/// How far from its fingers a push must move the land, metres: as far as an eye that follows the finger sees.
const ANSWER_REACH: f64 = 30.0 * KM;

/// How long a fault that no longer moves stays on the map, years.
const FAULT_YEARS: f64 = 1.0 * MYR;

/// Nodes per task where each asks the field for its rate.
const CHUNK: usize = 4096;

/// What moves the land now: which plates do what, how many domes rise, and how many earlier pushes go on.
type Drive = (Vec<(PlateId, PlateState)>, usize, usize);

/// What the plates do to the land, as far as it outlives the computation.
#[derive(Debug)]
pub(super) struct Uplift {
    /// m/yr on the grid.
    pub(super) field: Field,
    /// m/yr at the nodes.
    pub(super) at_nodes: Vec<f64>,
    /// Growth of folds at the nodes.
    pub(super) folds: Vec<NodeFolds>,
    /// What makes them grow; none where nothing folds.
    pub(super) folding: Option<Arc<FoldDrive>>,
    /// Faults, and when each stopped, years; `None` while it moves.
    pub(super) faults: Vec<(FaultTrace, Option<f64>)>,
    /// What it was computed for.
    drive: Drive,
}

impl Uplift {
    /// The same faults on a land of other nodes, where nothing rises.
    pub(super) fn still_on(&self, nodes: usize) -> Self {
        Self {
            field: self.field.clone(),
            at_nodes: vec![0.0; nodes],
            folds: Vec::new(),
            folding: None,
            faults: self.faults.clone(),
            drive: Drive::default(),
        }
    }

    /// No uplift at all.
    pub(super) fn still(field: &TectonicField, nodes: usize) -> Self {
        Self {
            field: field.uplift.clone(),
            at_nodes: vec![0.0; nodes],
            folds: Vec::new(),
            folding: None,
            faults: Vec::new(),
            drive: Drive::default(),
        }
    }
}

impl Sim {
    /// Turns one hand event into plates.
    pub(super) fn apply(&mut self, event: &HandEvent) {
        if let HandEvent::Push { leg, side, .. } = event
            && !self.state.found.contains_key(leg)
        {
            self.remember(*side, false);
            self.update_uplift();
            self.state.found.insert(*leg, Arc::clone(&self.state.uplift));
        }
        let now_yr = self.state.world.time_yr;
        let before = match event {
            HandEvent::Push { .. } | HandEvent::Rest { .. } => Some(self.state.world.plates.clone()),
            _ => None,
        };
        let world = &mut self.state.world;
        let applied = world
            .plates
            .apply(event, &world.map, now_yr, &self.params.mountain);
        if applied != Applied::Unchanged {
            self.state.stale = true;
            self.depart(now_yr);
        }
        if let (Some(before), Applied::Plate(id)) = (before, applied) {
            self.keep_going(&before, id);
        }
        let world = &mut self.state.world;
        match event {
            HandEvent::Tap { .. } if applied == Applied::Domes(0) => self.state.counts.dead_touches += 1,
            HandEvent::Push { .. } | HandEvent::Tap { .. } => world.last_push_yr = world.time_yr,
            HandEvent::PushEnd { leg } => self.judge(*leg),
            HandEvent::Rest { .. } | HandEvent::Lift { .. } | HandEvent::Retract { .. } => {}
        }
    }

    /// Lets go of plates whose hands are not down: their contacts were withdrawn, or the land is from before they came.
    pub(super) fn release_absent(&mut self) {
        let hands = &self.state.hands;
        let absent = |hand: HandId| !hands.hands().any(|view| view.hand == hand);
        let plates = self.state.world.plates.plates().iter();
        let ends: Vec<HandEvent> = plates
            .filter(|plate| plate.held && absent(plate.hand))
            .map(|plate| match plate.leg {
                Some(leg) => HandEvent::PushEnd { leg },
                None => HandEvent::Lift { hand: plate.hand },
            })
            .collect();
        for end in ends {
            let world = &mut self.state.world;
            world
                .plates
                .apply(&end, &world.map, world.time_yr, &self.params.mountain);
            self.state.stale = true;
        }
    }

    /// Lets the push that plate `id` had `before` go on, if a hand has just taken the plate from it.
    fn keep_going(&mut self, before: &PlateSet, id: PlateId) {
        let now_yr = self.state.world.time_yr;
        let leg = self.state.world.plates.get(id).and_then(|plate| plate.leg);
        let Some(old) = before.get(id) else {
            return;
        };
        if old.leg == leg || old.state(now_yr) != PlateState::Pushing {
            return;
        }
        self.field_of = None;
        let (extent, params) = (self.state.world.map.extent(), &self.params.mountain);
        let mut uplift = |plates: &PlateSet| {
            self.tectonics
                .compute_into(plates, extent, now_yr, params, &mut self.field);
            self.field.clone()
        };
        let with = uplift(&before.without_residues());
        let without = uplift(&before.without_push(id, now_yr, params));
        let residue = Residue::new(id, &with, &without, old.expires_yr);
        self.state.reproducible &= self.tectonics.stage().is_reproducible();
        self.state.world.plates.leave(residue);
    }

    /// A finished push is a dead touch if the uplift it found is the uplift it leaves, and the land before its
    /// fingers neither rises nor sinks (the same push again only goes on raising what rises).
    fn judge(&mut self, leg: Leg) {
        self.update_uplift();
        let Some(found) = self.state.found.remove(&leg) else {
            return;
        };
        let field = &self.state.uplift.field;
        let most = |rates: &mut dyn Iterator<Item = f32>| f64::from(rates.fold(0.0, f32::max));
        let change = most(
            &mut field
                .data
                .iter()
                .zip(&found.field.data)
                .map(|(a, b)| (a - b).abs()),
        );
        let plates = self.state.world.plates.plates();
        let tips: Vec<DVec2> = plates
            .iter()
            .filter(|plate| plate.leg == Some(leg))
            .flat_map(|plate| plate.arrows().map(|(_, tip)| tip))
            .collect();
        let near = |p: DVec2| tips.iter().any(|tip| tip.distance(p) < ANSWER_REACH);
        let grid = field.grid;
        let before_fingers = (0..grid.len()).filter(|at| near(grid.centre(at % grid.cols, at / grid.cols)));
        let moving = most(&mut before_fingers.map(|at| field.data[at].abs()));
        if change.max(moving) < self.params.answer_m_per_yr {
            self.state.counts.dead_touches += 1;
        }
    }

    /// What moves the land now.
    fn drive(&self) -> Drive {
        let world = &self.state.world;
        let doing = world
            .plates
            .plates()
            .iter()
            .map(|plate| (plate.id, plate.state(world.time_yr)));
        let years = self.params.mountain.dome_years;
        let rising = world
            .plates
            .domes()
            .iter()
            .filter(|dome| world.time_yr < dome.begun_yr + years);
        let residues = world.plates.residues().iter();
        let going_on = residues.filter(|residue| world.time_yr < residue.expires_yr);
        (doing.collect(), rising.count(), going_on.count())
    }

    /// True where plates have changed, a push is spent or a dome has risen since the uplift was computed.
    fn uplift_is_old(&self) -> bool {
        self.state.stale || self.drive() != self.state.uplift.drive
    }

    /// Brings `field` and `rates` to the plates as they are now. False where they were.
    fn compute_uplift(&mut self) -> bool {
        let world = &self.state.world;
        let known = |(plates, yr): &(PlateSet, f64)| *yr == world.time_yr && *plates == world.plates;
        if self.field_of.as_ref().is_some_and(known) {
            return false;
        }
        let (extent, params) = (world.map.extent(), &self.params.mountain);
        self.tectonics
            .compute_into(&world.plates, extent, world.time_yr, params, &mut self.field);
        let field = &self.field;
        let part = world.stratigraphy.basement().uplift;
        let positions = world.tin.positions().par_iter().with_min_len(CHUNK);
        positions
            .map(|&p| field.uplift_at(p) * part)
            .collect_into_vec(&mut self.rates);
        let layers = self.folding_layers();
        (self.fold_rates, self.skeletons) =
            self.folding
                .rates(&self.state.world, &self.field.folding, &layers);
        self.exact = self.tectonics.stage().is_reproducible() && self.folding.stage().is_reproducible();
        let world = &self.state.world;
        self.field_of = Some((world.plates.clone(), world.time_yr));
        true
    }

    /// The pairs of layers that fold on this land.
    pub fn folding_layers(&self) -> Vec<FoldingLayer> {
        let world = &self.state.world;
        folding_layers(&world.stratigraphy, world.tin.spacing(), self.params.fold_layers)
    }

    /// Computes the uplift of the plates as they are now, where it has changed, for those who look. The land feels it
    /// with its next step, and whether anybody looked makes no difference to it. True where it was computed.
    pub fn refresh_uplift(&mut self) -> bool {
        self.ahead = self.uplift_is_old();
        self.ahead && self.compute_uplift()
    }

    /// Computes the uplift if plates have changed, a push is spent or a dome has risen.
    pub(super) fn update_uplift(&mut self) -> bool {
        if !self.uplift_is_old() {
            return false;
        }
        self.compute_uplift();
        self.ahead = false;
        let drive = self.drive();
        let (state, field) = (&mut self.state, &self.field);
        let now_yr = state.world.time_yr;
        state.stale = false;
        state.reproducible &= self.exact;
        state.world.skeletons.clone_from(&self.skeletons);
        let mut at_nodes = self.rates.clone();
        let mut folds = self.fold_rates.clone();
        let all = folds.iter_mut().flat_map(|fold| &mut fold.raised);
        for rate in at_nodes.iter_mut().chain(all).filter(|rate| !rate.is_finite()) {
            *rate = 0.0;
            state.quarantine.uplift_nodes += 1;
        }
        let folding = Arc::new(field.folding.clone());
        if drive.0.iter().any(|(_, doing)| *doing == PlateState::Pushing) {
            state.last_motion = Some(field.report);
            state.last_folding = Some(Arc::clone(&folding));
        }
        // A fault stays on the map for a while when its push is spent.
        let mut faults: Vec<(FaultTrace, Option<f64>)> =
            field.faults.iter().map(|fault| (fault.clone(), None)).collect();
        for (old, stopped_yr) in &state.uplift.faults {
            let moves = field.faults.iter().any(|new| new.pair == old.pair);
            let stopped_yr = stopped_yr.unwrap_or(now_yr);
            if !moves && now_yr - stopped_yr <= FAULT_YEARS {
                faults.push((old.clone(), Some(stopped_yr)));
            }
        }
        state.uplift = Arc::new(Uplift {
            field: field.uplift.clone(),
            at_nodes,
            folds,
            folding: (!folding.is_still()).then_some(folding),
            faults,
            drive,
        });
        true
    }
}
