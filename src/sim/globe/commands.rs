//! What visitors do outside the contacts: undo, pause, cuts, the brush, another planet.

use std::sync::Arc;

use glam::DVec3;

use super::session::{GlobeSim, Snapshot};
use crate::gesture::command::{Action, Command, Paint, Place};
use crate::gesture::contact::Side;
use crate::globe::{Crust, Cut, Planet, Start};
use crate::sphere::{arc, direction};

/// Distance of the places of a drawn line at which it is asked which plate is below, radians.
const LINE_STEP: f64 = 0.01;

/// Memory of a snapshot beside the crust, bytes per sample: names of samples, and which plate has which.
const SET_BYTES: usize = 16;

impl GlobeSim {
    /// Keeps the planet as it is for undo.
    pub(super) fn remember(&mut self, side: Side) {
        let state = &mut self.state;
        let bytes = state.planet.lattice().len() * (size_of::<Crust>() + SET_BYTES);
        let most = (self.params.undo_bytes / bytes).max(1);
        if state.undo.len() >= most {
            let surplus = state.undo.len() + 1 - most;
            state.undo.drain(..surplus);
        }
        state.undo.push(Arc::new(Snapshot {
            side,
            planet: Arc::clone(&state.planet),
            pending_my: state.pending_my,
            start: Arc::clone(&state.start),
        }));
        state.painted_by = None;
    }

    /// Brings back the planet as the last deed of `side` (of anybody, if `None`) found it. What came after it is gone too.
    pub fn undo(&mut self, side: Option<Side>) -> bool {
        let Some(index) = self.undoable(side) else {
            return false;
        };
        let state = &mut self.state;
        let snapshot = Arc::clone(&state.undo[index]);
        state.undo.truncate(index);
        state.planet = Arc::clone(&snapshot.planet);
        state.start = Arc::clone(&snapshot.start);
        state.counts.undone += 1;
        state.pending_my = snapshot.pending_my;
        state.painted_by = None;
        self.forget_holds();
        true
    }

    pub(super) fn undoable(&self, side: Option<Side>) -> Option<usize> {
        let undo = &self.state.undo;
        undo.iter().rposition(|s| side.is_none_or(|side| s.side == side))
    }

    /// Plays one `do`. What means nothing here is counted.
    pub(super) fn command(&mut self, command: &Command) {
        let side = command.side.unwrap_or(Side::South);
        self.state.stirred[side as usize] = Some(self.state.tick);
        let done = match &command.action {
            Action::Play | Action::Pause => {
                self.state.paused = command.action == Action::Pause;
                true
            }
            Action::Speed(my_per_s) => {
                self.state.pace_my_per_s = *my_per_s;
                true
            }
            Action::Tool(tool) => {
                self.state.tools[side as usize] = *tool;
                true
            }
            Action::View { lon, lat, zoom } => {
                self.state.view = self.state.view.looking_at(*lon, *lat, *zoom);
                self.state.counts.views += 1;
                true
            }
            Action::Undo => self.undo(command.side),
            Action::StartOver => {
                let start = Arc::clone(&self.state.start);
                self.begin(start, side)
            }
            Action::Planet {
                plates,
                continental,
                seed,
            } => {
                let start = Start::Random {
                    plates: *plates,
                    continental: *continental,
                    seed: *seed,
                };
                self.begin(Arc::new(start), side)
            }
            Action::Cut { path } => self.cut(path, side),
            Action::Paint {
                at,
                radius_deg,
                paint,
            } => {
                // One contact's strokes are undone as one.
                if command.contact.is_none() || self.state.painted_by != command.contact {
                    self.remember(side);
                    self.state.painted_by = command.contact;
                }
                let continental = *paint == Paint::Continent;
                let at = direction(at.lat, at.lon);
                self.state
                    .planet_mut()
                    .paint(at, radius_deg.to_radians(), continental);
                self.state.counts.painted += 1;
                true
            }
            // Earth is not known yet, the past is not kept, and the rest is of the flat world.
            Action::Mode(_)
            | Action::Earth
            | Action::Scrub(_)
            | Action::Remove { .. }
            | Action::AddArrow(_)
            | Action::EditArrow(_)
            | Action::FlipFault { .. }
            | Action::Layers(_)
            | Action::Pile(_)
            | Action::TurnFolds { .. }
            | Action::RaiseFolds { .. }
            | Action::Slice(_)
            | Action::FreezeSlice(_)
            | Action::LabelSlice { .. }
            | Action::CloseSlice => false,
        };
        self.state.counts.idle_commands += u64::from(!done);
    }

    /// Begins with another planet, or with the same anew. Undo of that side brings the old one back.
    fn begin(&mut self, start: Arc<Start>, side: Side) -> bool {
        let lattice = Arc::clone(self.state.planet.lattice());
        let Ok(planet) = Planet::new(lattice, &start, self.params.globe) else {
            return false;
        };
        self.remember(side);
        self.state.planet = Arc::new(planet);
        self.state.start = start;
        self.state.pending_my = 0.0;
        self.forget_holds();
        true
    }

    /// Tears the plate that most of a line lies on, along it.
    fn cut(&mut self, path: &[Place], side: Side) -> bool {
        let line: Vec<DVec3> = path.iter().map(|place| direction(place.lat, place.lon)).collect();
        let mut below: Vec<(u32, usize)> = Vec::new();
        for ends in line.windows(2) {
            let pieces = (arc(ends[0], ends[1]) / LINE_STEP).ceil().max(1.0);
            for piece in 0..pieces as usize {
                let at = ends[0].lerp(ends[1], (piece as f64 + 0.5) / pieces);
                let plate = self.plate_shown_at(at.normalize_or(ends[0]));
                match below.iter_mut().find(|known| known.0 == plate) {
                    Some(known) => known.1 += 1,
                    None => below.push((plate, 1)),
                }
            }
        }
        let Some(&(plate, _)) = below.iter().rev().max_by_key(|known| known.1) else {
            return false;
        };
        self.remember(side);
        let done = self.state.planet_mut().rift(plate, &Cut::Line(line)).is_ok();
        if done {
            self.state.counts.cut += 1;
            self.parted(plate);
        } else {
            self.state.undo.pop();
            self.state.counts.refused += 1;
        }
        done
    }
}
