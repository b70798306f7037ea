//! Contacts → strokes: which contacts are fingers, and which are palms, sleeves, ghosts, flicker or stuck.
//!
//! The first guess is made at once and revised for a while (Schwarz et al. 2014, "Probabilistic palm rejection using
//! spatiotemporal touch features and iterative classification"): a contact with confidence 0 or larger than a
//! fingertip never starts a stroke, and one that turns out to be such within the revision time is taken back with
//! all it did. Where a device tells neither, contacts that flicker around one place are a palm.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::admission::Admission;
use super::contact::{Contact, ContactEvent, ContactKey, Phase};
use super::flicker::Spots;
use super::params::{GestureParams, micros};

/// Names a stroke for the whole session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StrokeId(pub u32);

/// What a stroke does. Positions are table millimetres.
#[derive(Clone, Debug, PartialEq)]
pub enum StrokeEvent {
    /// A finger lands.
    Start {
        /// The stroke.
        stroke: StrokeId,
        /// Where.
        at: DVec2,
    },
    /// It moves.
    Move {
        /// The stroke.
        stroke: StrokeId,
        /// Where it is now.
        at: DVec2,
    },
    /// It lifts.
    End {
        /// The stroke.
        stroke: StrokeId,
        /// When, µs: a lift is held back until no flicker can bridge it.
        t_us: u64,
    },
    /// It was none.
    Drop {
        /// The stroke.
        stroke: StrokeId,
        /// Its contacts, if something they did is to be undone; else empty.
        undo: Vec<ContactKey>,
        /// When it landed, µs.
        since_us: u64,
    },
}

/// What a contact is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A finger.
    Finger(StrokeId),
    /// A palm, a sleeve, or a ghost: it acts on nothing.
    Ghost,
    /// A finger that reported the same place for too long: it acts on nothing any more.
    Stuck,
}

/// What strokes were made of, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StrokeStats {
    /// Contacts taken for palms, sleeves or ghosts, or withdrawn by their source, at once or later.
    pub dropped_ghosts: u64,
    /// Those of them that had already acted, so that what they did was undone.
    pub retracted: u64,
    /// Contacts that went on with the stroke of another, which had flickered.
    pub bridged: u64,
    /// Contacts that were stuck.
    pub stuck: u64,
}

#[derive(Clone, Debug)]
struct Stroke {
    /// Its contacts: more than one if it flickered.
    keys: Vec<ContactKey>,
    down_us: u64,
    down_at: DVec2,
    at: DVec2,
    /// Greatest distance from where it landed, mm.
    travel: f64,
    /// Smallest and largest width or height so far, where the device tells.
    size_range: Option<(f64, f64)>,
    /// Since when its coordinates are the very same, µs.
    still_us: u64,
    /// When it lifted, while a flicker may still bridge it, µs.
    lifted_us: Option<u64>,
    /// True once something came of it.
    acted: bool,
}

/// Turns contacts into strokes.
#[derive(Clone, Debug)]
pub struct StrokeTracker {
    params: GestureParams,
    admission: Admission,
    roles: BTreeMap<ContactKey, Role>,
    strokes: BTreeMap<StrokeId, Stroke>,
    banned: BTreeSet<ContactKey>,
    spots: Spots,
    next: u32,
    /// When any contact last moved, µs.
    moved_us: u64,
    stats: StrokeStats,
}

impl StrokeTracker {
    /// A tracker with nothing down.
    pub fn new(params: GestureParams) -> Self {
        Self {
            params,
            admission: Admission::default(),
            roles: BTreeMap::new(),
            strokes: BTreeMap::new(),
            banned: BTreeSet::new(),
            spots: Spots::default(),
            next: 0,
            moved_us: 0,
            stats: StrokeStats::default(),
        }
    }

    /// The gate that contacts pass first.
    pub fn admission(&self) -> &Admission {
        &self.admission
    }

    /// What strokes were made of.
    pub fn stats(&self) -> StrokeStats {
        self.stats
    }

    /// The contacts that are down, and what each is taken for.
    pub fn contacts(&self) -> impl Iterator<Item = (&Contact, Role)> {
        let role = |contact: &Contact| self.roles.get(&contact.key).copied().unwrap_or(Role::Ghost);
        self.admission.live().map(move |contact| (contact, role(contact)))
    }

    /// Something came of the stroke: if it is taken back, that is to be undone.
    pub fn mark_acted(&mut self, stroke: StrokeId) {
        if let Some(stroke) = self.strokes.get_mut(&stroke) {
            stroke.acted = true;
        }
    }

    /// True while the finger has lifted, but a flicker may still bridge that.
    pub fn is_lifting(&self, stroke: StrokeId) -> bool {
        self.strokes
            .get(&stroke)
            .is_some_and(|stroke| stroke.lifted_us.is_some())
    }

    /// From now on the contact acts on nothing, and what it is doing is dropped.
    pub fn ban(&mut self, key: ContactKey) -> Vec<StrokeEvent> {
        if !self.banned.insert(key) {
            return Vec::new();
        }
        self.stats.retracted += 1;
        let owner = self
            .strokes
            .iter()
            .find(|(_, stroke)| stroke.keys.contains(&key))
            .map(|(&id, _)| id);
        let mut out = Vec::new();
        if let Some(id) = owner {
            if let Some(stroke) = self.strokes.get_mut(&id) {
                stroke.acted = false;
            }
            self.drop_stroke(id, &mut out);
        }
        out
    }

    /// What time alone brings about until `t_us`: lifts that nothing bridged, and fingers that are stuck.
    pub fn advance(&mut self, t_us: u64) -> Vec<StrokeEvent> {
        let (bridge, stuck) = (micros(self.params.bridge_ms), micros(self.params.stuck_ms));
        let mut out = Vec::new();
        let ids: Vec<StrokeId> = self.strokes.keys().copied().collect();
        for id in ids {
            let stroke = &self.strokes[&id];
            match stroke.lifted_us {
                Some(lifted) if t_us.saturating_sub(lifted) > bridge => self.end(id, lifted, &mut out),
                Some(_) => {}
                None => {
                    let still = t_us.saturating_sub(stroke.still_us);
                    if still > stuck && self.moved_us > stroke.still_us {
                        self.stats.stuck += 1;
                        self.set_role(id, Role::Stuck);
                        self.end(id, t_us, &mut out);
                    }
                }
            }
        }
        out
    }

    /// Ends every stroke, as if all fingers lifted at `t_us`.
    pub fn finish(&mut self, t_us: u64) -> Vec<StrokeEvent> {
        let mut out = Vec::new();
        let ids: Vec<StrokeId> = self.strokes.keys().copied().collect();
        for id in ids {
            let lifted = self.strokes[&id].lifted_us.unwrap_or(t_us);
            self.end(id, lifted, &mut out);
        }
        self.admission.clear();
        self.roles.clear();
        out
    }

    /// Takes what contacts do at one moment. The result is in rounds, as in [`Admission::admit`].
    pub fn moment(&mut self, t_us: u64, events: &[ContactEvent]) -> Vec<Vec<StrokeEvent>> {
        let mut rounds = vec![self.advance(t_us)];
        for round in self.admission.admit(events) {
            let mut out = Vec::new();
            for event in &round {
                match event.phase {
                    Phase::Down => self.down(t_us, &event.contact, &mut out),
                    Phase::Move => self.shift(t_us, &event.contact, &mut out),
                    Phase::Up => self.up(t_us, &event.contact, &mut out),
                    Phase::Cancel => self.cancel(t_us, &event.contact, &mut out),
                }
            }
            rounds.push(out);
        }
        rounds
    }

    fn down(&mut self, t_us: u64, contact: &Contact, out: &mut Vec<StrokeEvent>) {
        let flickers = self.spots.is_palm(&self.params, t_us, contact.position);
        if self.banned.contains(&contact.key) || self.is_palm(contact) || flickers {
            self.stats.dropped_ghosts += 1;
            self.roles.insert(contact.key, Role::Ghost);
            return;
        }
        let id = if let Some(id) = self.bridgeable(contact.position) {
            self.stats.bridged += 1;
            id
        } else {
            let id = StrokeId(self.next);
            self.next += 1;
            self.strokes.insert(id, Stroke::new(t_us, contact));
            out.push(StrokeEvent::Start {
                stroke: id,
                at: contact.position,
            });
            id
        };
        self.roles.insert(contact.key, Role::Finger(id));
        if let Some(stroke) = self
            .strokes
            .get_mut(&id)
            .filter(|stroke| stroke.lifted_us.is_some())
        {
            stroke.lifted_us = None;
            stroke.keys.push(contact.key);
            self.shift(t_us, contact, out);
        }
    }

    /// The stroke that lifted near `at` a moment ago: the nearest one, the older of two.
    fn bridgeable(&self, at: DVec2) -> Option<StrokeId> {
        let candidates = self
            .strokes
            .iter()
            .filter(|(_, stroke)| stroke.lifted_us.is_some());
        let near = candidates.map(|(&id, stroke)| (stroke.at.distance(at), id));
        near.filter(|(distance, _)| *distance <= self.params.bridge_mm)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, id)| id)
    }

    fn shift(&mut self, t_us: u64, contact: &Contact, out: &mut Vec<StrokeEvent>) {
        let Some(Role::Finger(id)) = self.roles.get(&contact.key).copied() else {
            return;
        };
        if self.is_palm(contact) {
            self.revise(id, t_us, out);
        }
        let Some(stroke) = self.strokes.get_mut(&id) else {
            return;
        };
        stroke.see_size(contact);
        if contact.position != stroke.at {
            stroke.at = contact.position;
            stroke.travel = stroke.travel.max(stroke.at.distance(stroke.down_at));
            stroke.still_us = t_us;
            self.moved_us = t_us;
            out.push(StrokeEvent::Move {
                stroke: id,
                at: contact.position,
            });
        }
    }

    fn up(&mut self, t_us: u64, contact: &Contact, out: &mut Vec<StrokeEvent>) {
        let Some(Role::Finger(id)) = self.roles.remove(&contact.key) else {
            self.spots.keep(&self.params, t_us, contact.position);
            return;
        };
        let Some(stroke) = self.strokes.get_mut(&id) else {
            return;
        };
        let age = t_us.saturating_sub(stroke.down_us);
        let params = &self.params;
        let resized = stroke
            .size_range
            .is_some_and(|(min, max)| max - min > params.ghost_resize_mm);
        if resized && age < micros(params.ghost_ms) && stroke.travel < params.ghost_mm {
            self.drop_stroke(id, out);
        } else if stroke.travel < params.motion_mm && age < micros(params.rest_ms) {
            // Two quick taps are two taps; many too quick ones are a palm.
            self.spots.lift(params, t_us, contact.position);
            self.end(id, t_us, out);
        } else {
            stroke.lifted_us = Some(t_us);
        }
    }

    fn cancel(&mut self, t_us: u64, contact: &Contact, out: &mut Vec<StrokeEvent>) {
        let Some(Role::Finger(id)) = self.roles.get(&contact.key).copied() else {
            self.roles.remove(&contact.key);
            return;
        };
        self.revise(id, t_us, out);
        self.roles.remove(&contact.key);
        if self.strokes.contains_key(&id) {
            self.end(id, t_us, out);
        }
    }

    /// There is evidence that the stroke is none: drops it, unless it has acted and the revision time is over.
    fn revise(&mut self, id: StrokeId, t_us: u64, out: &mut Vec<StrokeEvent>) {
        let Some(stroke) = self.strokes.get(&id) else {
            return;
        };
        if !stroke.acted || t_us.saturating_sub(stroke.down_us) <= micros(self.params.revise_ms) {
            self.drop_stroke(id, out);
        }
    }

    fn drop_stroke(&mut self, id: StrokeId, out: &mut Vec<StrokeEvent>) {
        self.set_role(id, Role::Ghost);
        let Some(stroke) = self.strokes.remove(&id) else {
            return;
        };
        let contacts = stroke.keys.len() as u64;
        self.stats.dropped_ghosts += contacts;
        let undo = if stroke.acted {
            self.stats.retracted += contacts;
            stroke.keys
        } else {
            Vec::new()
        };
        out.push(StrokeEvent::Drop {
            stroke: id,
            undo,
            since_us: stroke.down_us,
        });
    }

    fn end(&mut self, id: StrokeId, t_us: u64, out: &mut Vec<StrokeEvent>) {
        self.strokes.remove(&id);
        out.push(StrokeEvent::End { stroke: id, t_us });
    }

    /// Gives the contact that is down for a stroke another role.
    fn set_role(&mut self, id: StrokeId, role: Role) {
        for old in self.roles.values_mut().filter(|old| **old == Role::Finger(id)) {
            *old = role;
        }
    }

    fn is_palm(&self, contact: &Contact) -> bool {
        contact.confidence == Some(0.0) || extent(contact).is_some_and(|size| size > self.params.palm_mm)
    }
}

impl Stroke {
    fn new(t_us: u64, contact: &Contact) -> Self {
        Self {
            keys: vec![contact.key],
            down_us: t_us,
            down_at: contact.position,
            at: contact.position,
            travel: 0.0,
            size_range: extent(contact).map(|size| (size, size)),
            still_us: t_us,
            lifted_us: None,
            acted: false,
        }
    }

    fn see_size(&mut self, contact: &Contact) {
        if let Some(size) = extent(contact) {
            let (min, max) = self.size_range.unwrap_or((size, size));
            self.size_range = Some((min.min(size), max.max(size)));
        }
    }
}

/// The larger of width and height, mm, where the device tells.
fn extent(contact: &Contact) -> Option<f64> {
    contact
        .size_mm
        .map(DVec2::max_element)
        .filter(|size| size.is_finite())
}
