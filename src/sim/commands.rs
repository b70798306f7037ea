//! What visitors do outside the contacts: undo, pause, edits of standing plates.

use std::sync::Arc;

use super::step::{Sim, Snapshot};
use super::world::Totals;
use crate::gesture::command::{Action, Command, REACH_MM};
use crate::gesture::contact::Side;
use crate::mountain::PlateSet;
use crate::mountain::strata::Strata;
use crate::terrain::StartLand;
use crate::units::MYR;

impl Sim {
    /// Keeps the land as it is for undo.
    pub(super) fn remember(&mut self, side: Side) {
        let bytes = self.state.world.snapshot_bytes().max(1);
        let most = (self.params.undo_bytes / bytes).max(1);
        if self.state.undo.len() >= most {
            let surplus = self.state.undo.len() + 1 - most;
            self.state.undo.drain(..surplus);
        }
        self.state.undo.push(Arc::new(Snapshot {
            side,
            world: self.state.world.clone(),
        }));
    }

    /// Brings back land, plates and time as the last push of `side` (of anybody, if `None`) found them. Pushes
    /// that came after it are gone too.
    pub fn undo(&mut self, side: Option<Side>) -> bool {
        let state = &mut self.state;
        let Some(index) = state
            .undo
            .iter()
            .rposition(|s| side.is_none_or(|side| s.side == side))
        else {
            return false;
        };
        state.world.clone_from(&state.undo[index].world);
        state.undo.truncate(index);
        state.pending_yr = 0.0;
        state.stale = true;
        state.counts.undone += 1;
        true
    }

    /// Plays one `do`. What means nothing here is counted.
    pub(super) fn command(&mut self, command: &Command) {
        let world = &mut self.state.world;
        let params = &self.params.mountain;
        let (map, now_yr) = (world.map, world.time_yr);
        let reach = REACH_MM * map.metres_per_mm();
        let edited = match &command.action {
            Action::Play | Action::Pause => {
                self.state.paused = command.action == Action::Pause;
                return;
            }
            Action::Speed(my_per_s) => {
                self.state.pace_yr_per_s = my_per_s * MYR;
                return;
            }
            Action::Undo => self.undo(command.side),
            Action::StartOver => self.start_over(command.side),
            Action::Remove { at } => world.plates.remove_at(map.to_plan(*at), now_yr, params).is_some(),
            Action::AddArrow(arrow) => {
                let (from, to) = (map.to_plan(arrow.from), map.to_plan(arrow.to));
                world.plates.add_arrow(from, to, now_yr, params).is_some()
            }
            Action::EditArrow(arrow) => {
                let (from, to) = (map.to_plan(arrow.from), map.to_plan(arrow.to));
                world.plates.drag_tip(from, to, reach, now_yr, params).is_some()
            }
            Action::FlipFault { at } => self.flip_fault(map.to_plan(*at), reach),
            // Tools belong to the table's controls; the globe, layers and history are not of this world.
            Action::Tool(_)
            | Action::Mode(_)
            | Action::Layers(_)
            | Action::View { .. }
            | Action::Earth
            | Action::Scrub(_) => false,
        };
        if edited {
            self.state.stale = true;
            if matches!(command.action, Action::AddArrow(_) | Action::EditArrow(_)) {
                self.state.world.last_push_yr = now_yr;
            }
        } else {
            self.state.counts.idle_commands += 1;
        }
    }

    fn flip_fault(&mut self, at: glam::DVec2, reach: f64) -> bool {
        let near = self
            .state
            .uplift
            .faults
            .iter()
            .map(|(fault, _)| (fault.distance(at), fault.pair));
        let Some((distance, pair)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return false;
        };
        if distance <= reach {
            self.state.world.plates.flip_fault(pair);
        }
        distance <= reach
    }

    /// The land as the seed gives it, at time zero. Undo of that side brings the old one back.
    fn start_over(&mut self, side: Option<Side>) -> bool {
        self.remember(side.unwrap_or(Side::South));
        let world = &mut self.state.world;
        world.z = StartLand::new(world.seed).heights(&world.tin);
        world.strata = Strata::new(&[0.0], world.tin.len());
        world.plates = PlateSet::default();
        world.time_yr = 0.0;
        world.last_push_yr = 0.0;
        world.totals = Totals::default();
        self.state.pending_yr = 0.0;
        true
    }
}
