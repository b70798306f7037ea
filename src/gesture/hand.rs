//! Strokes → hands: which fingers belong together, and what the hand does with the ground.
//!
//! * Fingers that land near each other and close in time are a hand; they stay one until they lift.
//! * A hand that has not moved by 4 mm **rests** after half a second, and **taps** if it lifts before.
//! * A hand that moves **drags**: one leg, from where its fingers started, by the best rigid motion. It stands still
//!   or goes on as it likes; when it turns back the leg ends at its farthest point and the next one begins there.
//! * A finger that lands later joins at T⁻¹ of where it lands, so that the plate seems to have carried it there; a
//!   finger that lifts before the others is carried on with them.
//! * A hand whose fingers do not move together falls apart into hands that do, each pushing from where its fingers
//!   started.
//!
//! Motions are root mean squares over a hand's fingers, so that one slipping finger of five is not yet a drag.

use std::collections::BTreeMap;

use glam::DVec2;

use super::contact::{Contact, ContactEvent, ContactKey, InputFrame};
use super::event::{HandEvent, HandId};
use super::grouping::{self, Standing};
use super::leg::{self, Arrow};
use super::params::{GestureParams, MAX_FINGERS, micros};
use super::rigid::RigidFit;
use super::stage::{Hand, Stage};
use super::stroke::{Role, StrokeEvent, StrokeId, StrokeTracker};
pub use super::view::{ContactStats, Doing, HandView};

/// Turns contacts into what hands do. Equal frames and ticks give equal events, to the bit; how the frames of a tick
/// are fed, how contacts are ordered within one and what ids they have makes no difference but to the ids.
///
/// To take back what contacts did ([`HandEvent::Retract`]), restore a clone from before `since_us`, [`Self::ban`]
/// the contacts on it (and all that were banned before, if the clone is older than that), and feed and tick it again.
#[derive(Clone, Debug)]
pub struct HandTracker {
    params: GestureParams,
    size_mm: DVec2,
    strokes: StrokeTracker,
    /// Frames not yet played.
    pending: Vec<InputFrame>,
    /// Session time played so far, µs.
    t_us: u64,
    hands: BTreeMap<HandId, Hand>,
    /// Which hand a finger belongs to.
    owners: BTreeMap<StrokeId, HandId>,
    next: u32,
    outbox: Vec<(HandId, HandEvent)>,
    undo: Vec<ContactKey>,
    undo_since_us: u64,
    stats: ContactStats,
}

impl HandTracker {
    /// A tracker for a table of `size_mm` with nothing on it.
    pub fn new(params: GestureParams, size_mm: DVec2) -> Self {
        Self {
            params,
            size_mm,
            strokes: StrokeTracker::new(params),
            pending: Vec::new(),
            t_us: 0,
            hands: BTreeMap::new(),
            owners: BTreeMap::new(),
            next: 0,
            outbox: Vec::new(),
            undo: Vec::new(),
            undo_since_us: u64::MAX,
            stats: ContactStats::default(),
        }
    }

    /// Takes what contacts do at one moment, to be played by the tick that reaches it. Commands are not looked at.
    pub fn feed(&mut self, frame: &InputFrame) {
        if frame.events.is_empty() {
            return;
        }
        let t_us = self
            .pending
            .last()
            .map_or(self.t_us, |last| last.t_us)
            .max(frame.t_us);
        match self.pending.last_mut() {
            // Frames of one moment are one moment, however they were cut.
            Some(last) if last.t_us == t_us => last.events.extend_from_slice(&frame.events),
            _ => self.pending.push(InputFrame {
                t_us,
                events: frame.events.clone(),
                commands: Vec::new(),
            }),
        }
    }

    /// Plays the frames up to session time `t_us` and returns what the hands did: retractions first, then hand by
    /// hand, each in its own order.
    pub fn tick(&mut self, t_us: u64) -> Vec<HandEvent> {
        let played = self.pending.partition_point(|frame| frame.t_us <= t_us);
        let frames: Vec<InputFrame> = self.pending.drain(..played).collect();
        for frame in frames {
            self.t_us = self.t_us.max(frame.t_us);
            self.moment(&frame.events);
        }
        self.t_us = self.t_us.max(t_us);
        let events = self.strokes.advance(self.t_us);
        self.apply(events);
        self.tell();
        self.deliver()
    }

    /// Plays what was fed, lifts every finger (not before `t_us`), and returns what that does.
    pub fn finish(&mut self, t_us: u64) -> Vec<HandEvent> {
        let mut events = self.tick(self.pending.last().map_or(t_us, |last| last.t_us.max(t_us)));
        let ends = self.strokes.finish(self.t_us);
        self.apply(ends);
        events.extend(self.deliver());
        events
    }

    /// From now on the contact acts on nothing, and what it is doing is dropped without a [`HandEvent::Retract`].
    pub fn ban(&mut self, key: ContactKey) {
        let events = self.strokes.ban(key);
        self.apply(events);
    }

    /// The hands that are down, by id.
    pub fn hands(&self) -> impl Iterator<Item = HandView> {
        self.hands.iter().map(|(&id, hand)| hand.view(id))
    }

    /// The contacts that are down, what each is taken for, and the hand of those that are fingers.
    pub fn contacts(&self) -> impl Iterator<Item = (&Contact, Role, Option<HandId>)> {
        self.strokes.contacts().map(|(contact, role)| {
            let hand = match role {
                Role::Finger(stroke) => self.owners.get(&stroke).copied(),
                Role::Ghost | Role::Stuck => None,
            };
            (contact, role, hand)
        })
    }

    /// What became of the contacts so far.
    pub fn stats(&self) -> ContactStats {
        let (strokes, admission) = (self.strokes.stats(), self.strokes.admission().stats());
        ContactStats {
            total: admission.total,
            ignored: admission.ignored,
            doubled: admission.doubled,
            over_cap: admission.over_cap,
            dropped_ghosts: strokes.dropped_ghosts,
            retracted: strokes.retracted,
            bridged: strokes.bridged,
            stuck: strokes.stuck,
            ..self.stats
        }
    }

    /// Checks that each finger belongs to one hand and each hand has 1 to 5 fingers down.
    ///
    /// # Errors
    /// What is broken, in words.
    pub fn sanity_check(&self) -> Result<(), String> {
        let mut fingers = 0;
        for (&id, hand) in &self.hands {
            let down = hand.fingers_down().count();
            if down == 0 || hand.arrows.len() > MAX_FINGERS {
                return Err(format!(
                    "hand {} has {down} fingers, {} arrows",
                    id.0,
                    hand.arrows.len()
                ));
            }
            for (stroke, _) in hand.fingers_down() {
                if self.owners.get(&stroke) != Some(&id) {
                    return Err(format!("finger {} of hand {} belongs to another", stroke.0, id.0));
                }
            }
            fingers += down;
        }
        if fingers == self.owners.len() {
            Ok(())
        } else {
            Err(format!(
                "{} fingers have hands, hands have {fingers}",
                self.owners.len()
            ))
        }
    }

    fn moment(&mut self, events: &[ContactEvent]) {
        for round in self.strokes.moment(self.t_us, events) {
            self.apply(round);
        }
    }

    fn apply(&mut self, events: Vec<StrokeEvent>) {
        let mut moved: Vec<HandId> = Vec::new();
        let mut landings: Vec<(StrokeId, DVec2)> = Vec::new();
        for event in events {
            match event {
                StrokeEvent::Start { stroke, at } => landings.push((stroke, at)),
                StrokeEvent::Move { stroke, at } => {
                    if let Some((id, arrow)) = self.arrow(stroke) {
                        arrow.now = at;
                        if !moved.contains(&id) {
                            moved.push(id);
                        }
                    }
                }
                StrokeEvent::End { stroke, t_us } => self.lift(stroke, t_us),
                StrokeEvent::Drop {
                    stroke,
                    undo,
                    since_us,
                } => {
                    if !undo.is_empty() {
                        self.undo.extend(undo);
                        self.undo_since_us = self.undo_since_us.min(since_us);
                    }
                    self.forget(stroke);
                }
            }
        }
        for id in moved {
            self.follow(id);
        }
        if !landings.is_empty() {
            self.land(&landings);
        }
    }

    fn arrow(&mut self, stroke: StrokeId) -> Option<(HandId, &mut Arrow)> {
        let id = *self.owners.get(&stroke)?;
        let arrows = &mut self.hands.get_mut(&id)?.arrows;
        arrows
            .iter_mut()
            .find(|arrow| arrow.stroke == Some(stroke))
            .map(|arrow| (id, arrow))
    }

    /// Fingers land: they join hands or make new ones.
    fn land(&mut self, landings: &[(StrokeId, DVec2)]) {
        let fresh_us = micros(self.params.join_ms);
        let standing: Vec<Standing> = self
            .hands
            .iter()
            // Nobody joins a hand that is leaving.
            .filter(|(_, hand)| {
                hand.fingers_down()
                    .any(|(stroke, _)| !self.strokes.is_lifting(stroke))
            })
            .map(|(&hand, state)| Standing {
                hand,
                fingers: state
                    .fingers_down()
                    .map(|(_, arrow)| (arrow.now, arrow.landed))
                    .collect(),
                fresh: self.t_us.saturating_sub(state.since_us) <= fresh_us,
            })
            .collect();
        let places: Vec<DVec2> = landings.iter().map(|landing| landing.1).collect();
        for group in grouping::group(&self.params, self.size_mm, &places, &standing) {
            let id = group.hand.unwrap_or_else(|| self.new_hand());
            let hand = self
                .hands
                .entry(id)
                .or_insert_with(|| Hand::new(self.t_us, Vec::new()));
            for &i in &group.landings {
                let (stroke, at) = landings[i];
                hand.join(stroke, at);
                self.owners.insert(stroke, id);
            }
            if matches!(hand.stage, Stage::Touching) {
                hand.take_side(self.size_mm);
            }
        }
    }

    fn new_hand(&mut self) -> HandId {
        let id = HandId(self.next);
        self.next += 1;
        self.stats.hands += 1;
        id
    }

    /// The hand has moved: it begins to drag, goes on, falls apart, or turns back.
    fn follow(&mut self, id: HandId) {
        let Some(hand) = self.hands.get_mut(&id) else {
            return;
        };
        let (moved, most) = leg::motion(&hand.arrows);
        let pushing = matches!(hand.stage, Stage::Pushing(_));
        if !pushing && moved < self.params.motion_mm {
            return;
        }
        if leg::unexplained(&hand.arrows) > self.params.split_fraction {
            if most >= self.params.split_mm {
                self.split(id);
                return;
            }
            if !pushing {
                return;
            }
        }
        if !pushing {
            hand.begin();
            self.stats.pushes += 1;
        }
        leg::carry(&mut hand.arrows);
        if leg::turned_back(&mut hand.arrows, &self.params) {
            self.end_leg(id, leg::far_fit);
            if let Some(hand) = self.hands.get_mut(&id) {
                leg::next_leg(&mut hand.arrows);
                hand.stage = Stage::Pushing(None);
                hand.legs += 1;
                self.stats.pushes += 1;
            }
        }
    }

    /// Tells the last fit of a leg, and its end.
    fn end_leg(&mut self, id: HandId, fit: fn(&[Arrow]) -> RigidFit) {
        let Some(hand) = self.hands.get_mut(&id) else {
            return;
        };
        let now = (hand.starts(), fit(&hand.arrows));
        let leg = hand.leg(id);
        if let Stage::Pushing(told) = &hand.stage
            && told.as_ref() != Some(&now)
        {
            let push = hand.push(id, now);
            self.say(id, push);
        }
        self.say(id, HandEvent::PushEnd { leg });
    }

    /// The hand falls apart into hands whose fingers move together.
    ///
    /// A leg that has begun stays with those that moved most; before that, the hand stays with those that rest if it
    /// has anchored them, else with its first finger. Lifted fingers stay with the hand.
    fn split(&mut self, id: HandId) {
        let Some(hand) = self.hands.get(&id) else { return };
        let clusters = leg::clusters(&hand.arrows, self.params.split_fraction);
        if clusters.len() < 2 {
            // Right at the limit, rounding may find the hand apart and its clusters together.
            return;
        }
        let parts: Vec<Vec<Arrow>> = clusters
            .iter()
            .map(|cluster| cluster.iter().map(|&i| hand.arrows[i].clone()).collect())
            .collect();
        let motions: Vec<f64> = parts.iter().map(|part| leg::motion(part).0).collect();
        let first_best = |better: fn(f64, f64) -> bool| {
            (1..motions.len()).fold(0, |best, i| {
                if better(motions[i], motions[best]) {
                    i
                } else {
                    best
                }
            })
        };
        let keeper = match hand.stage {
            Stage::Pushing(_) => first_best(|a, b| a > b),
            Stage::Resting(_) => first_best(|a, b| a < b),
            Stage::Touching => 0,
        };
        let since_us = hand.since_us;
        self.stats.splits += 1;
        for (i, mut arrows) in parts.into_iter().enumerate() {
            let part = if i == keeper {
                if let Some(hand) = self.hands.get_mut(&id) {
                    hand.arrows.retain(|arrow| arrow.stroke.is_none());
                    arrows.append(&mut hand.arrows);
                    hand.arrows = arrows;
                    hand.fingers_changed();
                }
                id
            } else {
                let part = self.new_hand();
                for stroke in arrows.iter().filter_map(|arrow| arrow.stroke) {
                    self.owners.insert(stroke, part);
                }
                for arrow in &mut arrows {
                    arrow.far = arrow.now;
                }
                let mut hand = Hand::new(since_us, arrows);
                hand.take_side(self.size_mm);
                hand.fingers_changed();
                self.hands.insert(part, hand);
                part
            };
            self.follow(part);
        }
    }

    /// A finger lifts; with the last one, the hand is over.
    fn lift(&mut self, stroke: StrokeId, t_us: u64) {
        let Some((id, arrow)) = self.arrow(stroke) else {
            return;
        };
        arrow.stroke = None;
        self.owners.remove(&stroke);
        let Some(hand) = self.hands.get_mut(&id) else {
            return;
        };
        leg::anchor(&mut hand.arrows);
        if hand.fingers_down().next().is_none() {
            self.close(id, t_us);
        }
    }

    fn close(&mut self, id: HandId, t_us: u64) {
        let Some(hand) = self.hands.get_mut(&id) else {
            return;
        };
        let rested = t_us.saturating_sub(hand.since_us) >= micros(self.params.rest_ms);
        if matches!(hand.stage, Stage::Touching) && rested {
            hand.stage = Stage::Resting(false);
            self.stats.rests += 1;
        }
        match hand.stage {
            Stage::Touching => {
                let tap = hand.tap(id);
                self.stats.taps += 1;
                self.say(id, tap);
            }
            Stage::Resting(told) => {
                if !told {
                    let rest = hand.rest(id);
                    self.say(id, rest);
                }
                self.say(id, HandEvent::Lift { hand: id });
            }
            Stage::Pushing(_) => self.end_leg(id, leg::fit),
        }
        self.hands.remove(&id);
    }

    /// A finger was none: its arrow goes, and with the last finger the hand.
    fn forget(&mut self, stroke: StrokeId) {
        let Some(id) = self.owners.remove(&stroke) else {
            return;
        };
        let Some(hand) = self.hands.get_mut(&id) else {
            return;
        };
        hand.arrows.retain(|arrow| arrow.stroke != Some(stroke));
        hand.fingers_changed();
        if hand.arrows.is_empty() {
            self.hands.remove(&id);
        } else if hand.fingers_down().next().is_none() {
            self.close(id, self.t_us);
        }
    }

    /// Tells what has changed since the last tick: rests that are due, and fits.
    fn tell(&mut self) {
        let rest_us = micros(self.params.rest_ms);
        let ids: Vec<HandId> = self.hands.keys().copied().collect();
        for id in ids {
            let Some(hand) = self.hands.get_mut(&id) else {
                continue;
            };
            if matches!(hand.stage, Stage::Touching) && self.t_us.saturating_sub(hand.since_us) >= rest_us {
                hand.stage = Stage::Resting(false);
                self.stats.rests += 1;
            }
            let event = match &hand.stage {
                Stage::Resting(false) => {
                    hand.stage = Stage::Resting(true);
                    hand.rest(id)
                }
                Stage::Pushing(told) => {
                    let now = (hand.starts(), leg::fit(&hand.arrows));
                    if told.as_ref() == Some(&now) {
                        continue;
                    }
                    hand.push(id, now)
                }
                Stage::Touching | Stage::Resting(true) => continue,
            };
            self.say(id, event);
        }
    }

    fn say(&mut self, id: HandId, event: HandEvent) {
        if let Some(hand) = self.hands.get(&id) {
            for (stroke, _) in hand.fingers_down() {
                self.strokes.mark_acted(stroke);
            }
        }
        self.outbox.push((id, event));
    }

    fn deliver(&mut self) -> Vec<HandEvent> {
        let mut events = Vec::new();
        if !self.undo.is_empty() {
            let mut contacts = std::mem::take(&mut self.undo);
            contacts.sort_unstable();
            let since_us = std::mem::replace(&mut self.undo_since_us, u64::MAX);
            events.push(HandEvent::Retract { contacts, since_us });
        }
        self.outbox.sort_by_key(|(id, _)| *id);
        events.extend(self.outbox.drain(..).map(|(_, event)| event));
        events
    }
}
