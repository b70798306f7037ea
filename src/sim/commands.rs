//! What visitors do outside the contacts: undo, pause, edits of standing plates.

use std::sync::Arc;

use glam::DVec2;

use super::Cut;
use super::drive::Uplift;
use super::step::{Sim, Snapshot};
use super::world::Totals;
use crate::gesture::command::{Action, Command, REACH_MM};
use crate::gesture::contact::Side;
use crate::isostasy::Crust;
use crate::mountain::fold::edit::MAX_EDITS;
use crate::mountain::fold::{FoldEdit, FoldEditKind};
use crate::mountain::strata::Strata;
use crate::mountain::{PlateSet, TectonicField};
use crate::rock::{Stratigraphy, preset};
use crate::terrain::StartLand;
use crate::units::MYR;

/// Most notes on a cross-section.
const MAX_NOTES: usize = 16;

impl Sim {
    /// Keeps the land as it is for undo.
    pub(super) fn remember(&mut self, side: Side, starts_over: bool) {
        let bytes = self.state.world.snapshot_bytes().max(1);
        let most = (self.params.undo_bytes / bytes).max(1);
        if self.state.undo.len() >= most {
            let surplus = self.state.undo.len() + 1 - most;
            self.state.undo.drain(..surplus);
        }
        self.state.undo.push(Arc::new(Snapshot {
            side,
            world: self.state.world.clone(),
            starts_over,
        }));
    }

    /// The land goes on from here: if it was looked back at, what came after is gone.
    pub(super) fn depart(&mut self, now_yr: f64) {
        if self.state.history.depart(now_yr) {
            self.state.undo.retain(|s| s.world.time_yr <= now_yr);
        }
    }

    /// Brings back land, plates and time as the last push of `side` (of anybody, if `None`) found them. Pushes
    /// that came after it are gone too.
    pub fn undo(&mut self, side: Option<Side>) -> bool {
        if self.undoable(side).is_none() {
            return false;
        }
        self.depart(self.state.world.time_yr);
        // Looked for again: what the land has departed from is gone from the list.
        let Some(index) = self.undoable(side) else {
            return false;
        };
        let state = &mut self.state;
        state.world.clone_from(&state.undo[index].world);
        if state.undo[index..].iter().any(|s| s.starts_over) {
            // What was kept since is the past of another land.
            state.history.clear();
        }
        state.history.forget_after(state.world.time_yr);
        state.undo.truncate(index);
        state.counts.undone += 1;
        self.land_changed();
        true
    }

    /// Which snapshot undo would bring back: of those who look back, only what was before.
    pub(super) fn undoable(&self, side: Option<Side>) -> Option<usize> {
        let state = &self.state;
        let (back, now_yr) = (state.history.visiting(), state.world.time_yr);
        state
            .undo
            .iter()
            .rposition(|s| side.is_none_or(|side| s.side == side) && (!back || s.world.time_yr <= now_yr))
    }

    /// Another land has taken the place of the one before.
    fn land_changed(&mut self) {
        // Faults of the other land are no past of this one.
        let still = TectonicField::still(self.state.world.map.extent(), &self.params.mountain);
        self.state.uplift = Arc::new(Uplift::still(&still, self.state.world.tin.len()));
        self.state.pending_yr = 0.0;
        self.state.stale = true;
        // Its folds are others, whatever its plates.
        self.field_of = None;
        self.wear.forget();
        self.land_revision += 1;
        self.keep_history();
    }

    /// Takes the land as it is into the history, if it is time.
    pub(super) fn keep_history(&mut self) {
        self.state
            .history
            .record(&self.state.world, self.params.history_bytes);
    }

    /// Stops the clock and brings back the world nearest to `years`, at or before them. The ones after it stay in reach
    /// until the land goes on from there.
    fn scrub(&mut self, years: f64) -> bool {
        let state = &mut self.state;
        let kept = state
            .history
            .visit(years, &state.world, self.params.history_bytes);
        let Some(world) = kept else {
            return false;
        };
        state.world.clone_from(&world);
        state.paused = true;
        self.land_changed();
        true
    }

    /// Plays one `do`. What means nothing here is counted.
    pub(super) fn command(&mut self, command: &Command) {
        let edits = matches!(
            command.action,
            Action::Remove { .. }
                | Action::AddArrow(_)
                | Action::EditArrow(_)
                | Action::FlipFault { .. }
                | Action::TurnFolds { .. }
                | Action::RaiseFolds { .. }
        );
        // One contact's edits are undone as one.
        let goes_on = command.contact.is_some() && self.state.edited_by == command.contact;
        let begins = edits && !goes_on;
        if begins {
            self.remember(command.side.unwrap_or(Side::South), false);
        }
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
            Action::Scrub(years) => {
                self.state.counts.idle_commands += u64::from(!self.scrub(*years));
                return;
            }
            Action::Slice(_) | Action::FreezeSlice(_) | Action::LabelSlice { .. } | Action::CloseSlice => {
                self.state.counts.idle_commands += u64::from(!self.slice(command));
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
            Action::Layers(name) => preset::by_name(name).is_some_and(|pile| self.lay(pile, command.side)),
            Action::Pile(pile) => self.lay(Arc::clone(pile), command.side),
            Action::TurnFolds { path } => self.edit_folds(FoldEditKind::Turn, path),
            Action::RaiseFolds { path, by } => self.edit_folds(FoldEditKind::Raise(*by), path),
            // Tools belong to the table's controls; the globe is not of this world.
            Action::Tool(_)
            | Action::Mode(_)
            | Action::View { .. }
            | Action::Earth
            | Action::Planet { .. }
            | Action::Cut { .. }
            | Action::Paint { .. } => false,
        };
        if begins && !edited {
            self.state.undo.pop();
        }
        if edited {
            self.state.edited_by = command.contact.filter(|_| edits);
            self.state.stale = true;
            self.depart(now_yr);
            // What is taken away moves nothing any more.
            if edits && !matches!(command.action, Action::Remove { .. } | Action::FlipFault { .. }) {
                self.state.world.last_push_yr = now_yr;
            }
        } else {
            self.state.counts.idle_commands += 1;
        }
    }

    fn flip_fault(&mut self, at: DVec2, reach: f64) -> bool {
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

    /// Lays another pile of rock under the land as it stands.
    fn lay(&mut self, pile: Arc<Stratigraphy>, side: Option<Side>) -> bool {
        if *pile == *self.state.world.stratigraphy {
            return false;
        }
        self.remember(side.unwrap_or(Side::South), false);
        let world = &mut self.state.world;
        world.stratigraphy = pile;
        world.strata.relay();
        world.skeletons.clear();
        self.field_of = None;
        true
    }

    /// Turns or raises the folds along a line on the table, mm. False where nothing has folded yet.
    fn edit_folds(&mut self, kind: FoldEditKind, path: &[DVec2]) -> bool {
        let world = &mut self.state.world;
        let path: Vec<DVec2> = path.iter().map(|&at| world.map.to_plan(at)).collect();
        let Ok(edit) = FoldEdit::new(kind, &path) else {
            return false;
        };
        if world.skeletons.is_empty() {
            return false;
        }
        let mut edits = world.fold_edits.clone();
        // A ridge that is raised again goes on from where it was.
        edits.retain(|known| {
            matches!(known.kind(), FoldEditKind::Turn)
                || matches!(kind, FoldEditKind::Turn)
                || known.path() != edit.path()
        });
        edits.push(edit);
        let surplus = edits.len().saturating_sub(MAX_EDITS);
        edits.drain(..surplus);
        self.folding.edit(&mut self.state.world, edits);
        self.field_of = None;
        true
    }

    /// What is done to the cross-section of a side.
    fn slice(&mut self, command: &Command) -> bool {
        let map = self.state.world.map;
        let cut = &mut self.state.cuts[command.side.unwrap_or(Side::South) as usize];
        match (&command.action, cut.as_mut()) {
            (Action::Slice(ends), Some(cut)) if !cut.frozen => {
                cut.ends = [map.to_plan(ends.from), map.to_plan(ends.to)];
            }
            (Action::Slice(ends), None) => {
                *cut = Some(Cut {
                    ends: [map.to_plan(ends.from), map.to_plan(ends.to)],
                    frozen: false,
                    notes: Vec::new(),
                });
            }
            (Action::FreezeSlice(frozen), Some(cut)) => cut.frozen = *frozen,
            (Action::LabelSlice { at, text }, Some(cut)) if cut.notes.len() < MAX_NOTES => {
                cut.notes.push((*at, text.clone()));
            }
            (Action::CloseSlice, Some(_)) => *cut = None,
            _ => return false,
        }
        true
    }

    /// The land as the seed gives it, at time zero. Undo of that side brings the old one back.
    fn start_over(&mut self, side: Option<Side>) -> bool {
        self.depart(self.state.world.time_yr);
        self.remember(side.unwrap_or(Side::South), true);
        let world = &mut self.state.world;
        world.z = StartLand::new(world.seed).heights(&world.tin);
        world.strata = Strata::new(world.tin.len());
        world.skeletons.clear();
        world.fold_edits.clear();
        world.sediment.clear();
        world.crust = Crust::new(world.tin.len());
        world.plates = PlateSet::default();
        world.time_yr = 0.0;
        world.last_push_yr = 0.0;
        world.totals = Totals::default();
        self.state.history.clear();
        self.land_changed();
        true
    }
}
