//! A session that goes on from an earlier moment, or beside itself.

use std::collections::VecDeque;

use super::exposure::Exposure;
use super::folding::Folding;
use super::rollback::Rollback;
use super::step::{Sim, State};
use super::wear::Wear;
use super::{SimParams, TICK_US, World};
use crate::gesture::contact::{ContactEvent, InputFrame, Phase};
use crate::isostasy::{Crust, Isostasy};
use crate::mountain::{Stages, TectonicField, Tectonics};
use crate::terrain::{Erosion, Sediment};

/// All that a session is at one moment: plain data, cheap to take and to keep. Input that waits for its tick is not part
/// of it.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    pub(super) params: SimParams,
    pub(super) state: State,
}

impl Checkpoint {
    /// The same moment at a later session time: what lies between is not played. For going on after a fault, with input
    /// that is of now.
    #[must_use]
    pub fn at_tick(mut self, tick: u64) -> Self {
        self.state.tick = self.state.tick.max(tick);
        self
    }

    /// Ticks done at that moment.
    pub fn ticks(&self) -> u64 {
        self.state.tick
    }

    /// The parameters of the session.
    pub fn params(&self) -> &SimParams {
        &self.params
    }

    /// The world of that moment.
    pub fn world(&self) -> &World {
        &self.state.world
    }
}

impl Sim {
    /// The session as it is.
    pub fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            params: self.params.clone(),
            state: self.state.clone(),
        }
    }

    /// The session of `checkpoint` in memory of its own: it goes on as the other one did, to the bit.
    pub fn resume(checkpoint: Checkpoint) -> Self {
        let Checkpoint { params, state } = checkpoint;
        let stages = Stages::default();
        let mut rollback = Rollback::new();
        rollback.checkpoint((state.tick * TICK_US) as i64 - TICK_US as i64, &state);
        Self {
            tectonics: Tectonics::with_stage(stages.transport),
            field: TectonicField::still(state.world.map.extent(), &params.mountain),
            field_of: None,
            exact: true,
            rates: Vec::new(),
            fold_rates: Vec::new(),
            skeletons: Vec::new(),
            folding: Folding::new(stages.folds),
            ahead: false,
            exposure: Exposure::default(),
            isostasy: params
                .isostasy
                .map(|floats| Isostasy::new(&state.world.tin, &floats)),
            base: Vec::new(),
            erosion: Erosion::new(&state.world.tin),
            before: Vec::new(),
            before_crust: Crust::new(0),
            before_sediment: Sediment::default(),
            wear: Wear::default(),
            land_revision: 0,
            queue: VecDeque::new(),
            banned: Vec::new(),
            rollback,
            params,
            state,
        }
    }

    /// Lets `stages` compute from now on, and gives back those that did.
    pub fn replace_stages(&mut self, stages: Stages) -> Stages {
        Stages {
            transport: self.tectonics.replace_stage(stages.transport),
            folds: self.folding.replace_stage(stages.folds),
        }
    }

    /// Withdraws every contact that is down, at the next tick: what they do is over, and if it had only just begun it
    /// is undone.
    pub fn cancel_contacts(&mut self) {
        let withdrawn = |contact: &_| ContactEvent {
            phase: Phase::Cancel,
            contact: *contact,
        };
        let events = self
            .state
            .hands
            .contacts()
            .map(|(contact, ..)| withdrawn(contact))
            .collect();
        self.queue.push_front(InputFrame {
            t_us: self.state.tick * TICK_US,
            events,
            commands: Vec::new(),
        });
    }
}
