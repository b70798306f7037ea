//! Hands that hold plates: what they took hold of, where they lead it, and when it tears.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DQuat, DVec2, DVec3};

use super::super::TICK_US;
use super::session::GlobeSim;
use super::view::TapMark;
use crate::gesture::command::{Paint, Tool};
use crate::gesture::contact::Side;
use crate::gesture::event::{HandEvent, HandId};
use crate::gesture::hand::Doing;
use crate::gesture::pole::{rotation, rotation_vector};
use crate::gesture::stroke::{Role, StrokeId};
use crate::globe::{Cut, Planet};
use crate::sphere::{RADIUS_KM, arc};

/// A plate has come to where it was led when less than this is missing, radians (about 20 km).
const ARRIVED: f64 = 0.003;

/// What a finger was taken for where it landed; it stays that, wherever it goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Duty {
    /// It holds a plate.
    Sculpt,
    /// It moves the view.
    Turn,
    /// It paints, for a side.
    Paint(Paint, Side),
}

/// What a hand does with the plate below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grasp {
    /// It has only just landed.
    Touching,
    /// It holds the plate where it is.
    Resting,
    /// It leads the plate.
    Leading,
    /// It has lifted, and the plate still goes to where it was led.
    Lifted,
}

/// A hand on a plate.
#[derive(Clone, Debug)]
pub(super) struct Hold {
    pub(super) side: Side,
    pub(super) plate: u32,
    pub(super) grasp: Grasp,
    pub(super) fingers: BTreeMap<StrokeId, Finger>,
    /// Angular velocity that the plate had of itself, rad/My: its spin about a single finger stays.
    own: DVec3,
    /// The plate does not tear here.
    refused: bool,
    /// After the hand has lifted: how long the plate is still led, My.
    left_my: f64,
}

/// A finger on a plate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finger {
    /// Where it took hold, in the plate's own frame.
    pub(super) anchor: DVec3,
    /// Where it is, in the world's frame.
    pub(super) target: DVec3,
}

impl Hold {
    /// Says where the plate is to go, or not to go.
    fn acts(&self) -> bool {
        self.grasp != Grasp::Touching
    }

    /// Middle of the places taken hold of, where `rotation` has brought them, and middle of the fingers.
    fn middles(&self, rotation: DQuat) -> (DVec3, DVec3) {
        let fingers = self.fingers.values();
        let held: DVec3 = fingers.clone().map(|finger| finger.anchor).sum();
        let led: DVec3 = fingers.map(|finger| finger.target).sum();
        (
            (rotation * held).normalize_or(DVec3::Z),
            led.normalize_or(DVec3::Z),
        )
    }
}

/// A hand that is down, with its fingers.
pub(super) struct Down {
    pub(super) hand: HandId,
    side: Side,
    grasp: Grasp,
    pub(super) duty: Duty,
    /// Table mm.
    pub(super) fingers: Vec<(StrokeId, DVec2)>,
}

impl GlobeSim {
    /// Marks taps.
    pub(super) fn hear(&mut self, events: &[HandEvent]) {
        for event in events {
            let HandEvent::Tap { side, fingers, .. } = event else {
                continue;
            };
            let middle = fingers.iter().sum::<DVec2>() / fingers.len().max(1) as f64;
            if self.brush_at(*side).is_some() && self.state.view.contains(middle) {
                continue;
            }
            match self.state.view.cast(middle) {
                Some(at) if self.state.tools[*side as usize] != Tool::View => {
                    let plate = self.plate_shown_at(at);
                    let back = self.shown_rotation(plate).unwrap_or_default().inverse();
                    self.state.taps.push(TapMark {
                        plate,
                        anchor: back * at,
                        tick: self.state.tick,
                    });
                    self.state.counts.taps += 1;
                }
                _ => self.state.counts.dead_touches += 1,
            }
        }
        let ticks = (self.params.tap_s * 1e6 / TICK_US as f64) as u64;
        let now = self.state.tick;
        self.state.taps.retain(|tap| now - tap.tick < ticks);
    }

    /// Brings view and holds to where the hands are now.
    pub(super) fn follow_hands(&mut self) {
        let down = self.hands_down();
        let turning = down.iter().filter(|hand| hand.duty == Duty::Turn);
        let moves = turning.clone().any(|hand| hand.grasp == Grasp::Leading);
        let middles = turning.map(|hand| {
            let sum: DVec2 = hand.fingers.iter().map(|finger| finger.1).sum();
            (hand.hand, hand.fingers.len(), sum / hand.fingers.len() as f64)
        });
        self.turn_view(middles.collect(), moves);
        for hand in down.iter().filter(|hand| hand.duty == Duty::Sculpt) {
            self.hold_on(hand);
        }
        self.paint(&down);
        self.let_go();
        self.tear();
        // While the clock stands, what is shown stands too.
        if !self.state.paused {
            self.lead_plates(self.horizon_my());
        }
    }

    /// Model time in which a led plate is to come to its fingers: half a step, which looks like a soft tether; at high
    /// speeds of the clock no less than a tick, or it would come too far.
    fn horizon_my(&self) -> f64 {
        let per_tick = self.state.pace_my_per_s * (TICK_US as f64 / 1e6);
        per_tick.max(self.params.globe.dt_my / 2.0)
    }

    /// The hands that are down, with what they are there for.
    fn hands_down(&mut self) -> Vec<Down> {
        let brushes = [Side::North, Side::South].map(|side| self.brush_at(side));
        let state = &mut self.state;
        let mut down = Vec::new();
        for view in state.hands.hands() {
            let contacts = state.hands.contacts();
            let fingers: Vec<(StrokeId, DVec2)> = contacts
                .filter_map(|(contact, role, hand)| match role {
                    Role::Finger(stroke) if hand == Some(view.hand) => Some((stroke, contact.position)),
                    _ => None,
                })
                .collect();
            if fingers.is_empty() {
                // It flickers, or its last lift waits to be believed.
                continue;
            }
            // Fingers keep their duty when their hand falls apart.
            let known = fingers.iter().find_map(|(stroke, _)| state.duties.get(stroke));
            let duty = known.map_or_else(
                || {
                    let middle = fingers.iter().map(|finger| finger.1).sum::<DVec2>() / fingers.len() as f64;
                    let tool = state.tools[view.side as usize];
                    match brushes[view.side as usize] {
                        _ if tool == Tool::View || !state.view.contains(middle) => Duty::Turn,
                        Some((paint, side)) => Duty::Paint(paint, side),
                        None => Duty::Sculpt,
                    }
                },
                |known| known.1,
            );
            for (stroke, _) in &fingers {
                state.duties.insert(*stroke, (view.hand, duty));
            }
            down.push(Down {
                hand: view.hand,
                side: view.side,
                grasp: match view.doing {
                    Doing::Touching => Grasp::Touching,
                    Doing::Resting => Grasp::Resting,
                    Doing::Pushing { .. } => Grasp::Leading,
                },
                duty,
                fingers,
            });
        }
        let alive: BTreeSet<HandId> = state.hands.hands().map(|view| view.hand).collect();
        state.duties.retain(|_, (hand, _)| alive.contains(hand));
        state.remembered.retain(|hand| alive.contains(hand));
        down
    }

    /// Takes hold of the plate under a hand, or follows its fingers.
    fn hold_on(&mut self, down: &Down) {
        let view = self.state.view;
        if !self.state.holds.contains_key(&down.hand) {
            let places = down.fingers.iter().map(|finger| view.cast_nearest(finger.1));
            let plate = self.plate_shown_at(places.sum::<DVec3>().normalize_or(DVec3::Z));
            let own = self.state.planet.plate_state(plate).map(|state| state.1);
            let hold = Hold {
                side: down.side,
                plate,
                grasp: Grasp::Touching,
                fingers: BTreeMap::new(),
                own: own.unwrap_or_default(),
                refused: false,
                left_my: self.params.carry_my,
            };
            self.state.holds.insert(down.hand, hold);
        }
        let acts = down.grasp != Grasp::Touching;
        if acts {
            // (A tap may be anybody's, and wakes the table.)
            self.state.stirred[down.side as usize] = Some(self.state.tick);
        }
        if acts && self.state.remembered.insert(down.hand) {
            self.remember(down.side);
        }
        let Some(plate) = self.state.holds.get(&down.hand).map(|hold| hold.plate) else {
            return;
        };
        let back = self.shown_rotation(plate).unwrap_or_default().inverse();
        let state = &mut self.state;
        let Some(hold) = state.holds.get_mut(&down.hand) else {
            return;
        };
        hold.fingers
            .retain(|stroke, _| down.fingers.iter().any(|finger| finger.0 == *stroke));
        for &(stroke, mm) in &down.fingers {
            let target = view.cast_nearest(mm);
            let anchor = back * target;
            let finger = hold.fingers.entry(stroke).or_insert(Finger { anchor, target });
            finger.target = target;
        }
        if hold.grasp == down.grasp {
            return;
        }
        hold.grasp = down.grasp;
        match down.grasp {
            Grasp::Leading => state.counts.led += 1,
            Grasp::Resting => state.counts.anchored += 1,
            Grasp::Touching | Grasp::Lifted => {}
        }
    }

    /// Hands that have lifted let go, some of them after a while.
    fn let_go(&mut self) {
        let state = &mut self.state;
        let alive: BTreeSet<HandId> = state.hands.hands().map(|view| view.hand).collect();
        let taken: BTreeSet<u32> = state
            .holds
            .iter()
            .filter(|(hand, hold)| alive.contains(hand) && hold.acts())
            .map(|(_, hold)| hold.plate)
            .collect();
        state.holds.retain(|hand, hold| {
            if alive.contains(hand) {
                return true;
            }
            let leads = matches!(hold.grasp, Grasp::Leading | Grasp::Lifted);
            hold.grasp = Grasp::Lifted;
            // Who takes a plate takes it from those who have left.
            leads && !taken.contains(&hold.plate)
        });
    }

    /// Tears a plate that two hands pull apart, between them.
    fn tear(&mut self) {
        let acting: Vec<(HandId, &Hold)> = self
            .state
            .holds
            .iter()
            .filter(|(_, hold)| hold.acts() && hold.grasp != Grasp::Lifted && !hold.refused)
            .map(|(&hand, hold)| (hand, hold))
            .collect();
        let pairs = acting.iter().enumerate().flat_map(|(i, &a)| {
            let others = acting[i + 1..].iter();
            others
                .filter(move |b| b.1.plate == a.1.plate)
                .map(move |&b| (a, b))
        });
        let torn = pairs.into_iter().find_map(|((a, of_a), (b, of_b))| {
            let (rotation, ..) = self.state.planet.plate_state(of_a.plate)?;
            let (held_a, led_a) = of_a.middles(rotation);
            let (held_b, led_b) = of_b.middles(rotation);
            let apart_km = (arc(led_a, led_b) - arc(held_a, held_b)) * RADIUS_KM;
            (apart_km > self.params.tear_km).then_some((a, b, of_a.plate, bisector(held_a, held_b)))
        });
        let Some((a, b, plate, line)) = torn else {
            return;
        };
        let done = self.state.planet_mut().rift(plate, &Cut::Line(line)).is_ok();
        let state = &mut self.state;
        for hand in [a, b] {
            if let Some(hold) = state.holds.get_mut(&hand) {
                hold.refused = !done;
            }
        }
        state.counts.torn += u64::from(done);
        state.counts.refused += u64::from(!done);
        if done {
            self.parted(plate);
        }
    }

    /// A plate has been torn: each of its hands goes with the part below it. Parts have the frame of the whole.
    pub(super) fn parted(&mut self, plate: u32) {
        let Some((rotation, ..)) = self.state.planet.plate_state(plate) else {
            return;
        };
        let planet = &self.state.planet;
        for hold in self.state.holds.values_mut().filter(|hold| hold.plate == plate) {
            hold.plate = planet.plate_at(hold.middles(rotation).0);
        }
        for tap in self.state.taps.iter_mut().filter(|tap| tap.plate == plate) {
            tap.plate = planet.plate_at(rotation * tap.anchor);
        }
    }

    /// Tells the planet what the hands want of its plates: to come to their fingers within `horizon_my`.
    pub(super) fn lead_plates(&mut self, horizon_my: f64) {
        let mut wanted: BTreeMap<u32, Vec<&Hold>> = BTreeMap::new();
        for hold in self.state.holds.values().filter(|hold| hold.acts()) {
            wanted.entry(hold.plate).or_default().push(hold);
        }
        let motions: BTreeMap<u32, Option<DVec3>> = wanted
            .into_iter()
            .map(|(plate, holds)| (plate, self.motion(plate, &holds, horizon_my)))
            .collect();
        let held: BTreeSet<u32> = motions.keys().copied().collect();
        let before = std::mem::replace(&mut self.state.held, held);
        if motions.is_empty() && before.is_empty() {
            return;
        }
        let ahead_my = self.state.pending_my;
        let planet = self.state.planet_mut();
        for plate in before.into_iter().filter(|plate| !motions.contains_key(plate)) {
            planet.release(plate);
        }
        for (plate, motion) in motions {
            planet.steer(plate, motion.unwrap_or_default(), ahead_my);
            if motion.is_none() {
                planet.anchor(plate);
            }
        }
    }

    /// The angular velocity that brings a plate to the fingers in `horizon_my`, rad/My; `None` where all of them rest.
    fn motion(&self, plate: u32, holds: &[&Hold], horizon_my: f64) -> Option<DVec3> {
        if holds.iter().all(|hold| hold.grasp == Grasp::Resting) {
            return None;
        }
        let at = self.shown_rotation(plate)?;
        let fingers = holds.iter().flat_map(|hold| hold.fingers.values());
        let (from, to): (Vec<DVec3>, Vec<DVec3>) =
            fingers.map(|finger| (at * finger.anchor, finger.target)).unzip();
        let former = holds.first().map_or(DVec3::ZERO, |hold| hold.own) * horizon_my;
        Some(rotation_vector(rotation(&from, &to, former)) / horizon_my)
    }

    /// After a step: lets go of what has arrived, takes hold again where a plate has gone, and leads the rest on.
    pub(super) fn after_step(&mut self) {
        let dt = self.params.globe.dt_my;
        let state = &mut self.state;
        let planet: &Planet = &state.planet;
        state.holds.retain(|_, hold| {
            let Some((rotation, ..)) = planet.plate_state(hold.plate) else {
                // Its crust is part of another plate now; what it has moved since the hold was taken is lost with it.
                let at = hold.middles(DQuat::IDENTITY).1;
                hold.plate = planet.plate_at(at);
                let Some((rotation, omega, _)) = planet.plate_state(hold.plate) else {
                    return false;
                };
                hold.own = omega;
                for finger in hold.fingers.values_mut() {
                    finger.anchor = rotation.inverse() * finger.target;
                }
                return hold.grasp != Grasp::Lifted;
            };
            if hold.grasp != Grasp::Lifted {
                return true;
            }
            hold.left_my -= dt;
            let missing = hold
                .fingers
                .values()
                .map(|finger| arc(rotation * finger.anchor, finger.target))
                .fold(0.0, f64::max);
            hold.left_my > 0.0 && missing > ARRIVED
        });
        self.lead_plates(dt);
    }

    /// Forgets what hands hold, since the planet is another: those that are down take hold anew.
    pub(super) fn forget_holds(&mut self) {
        self.state.holds.clear();
        self.state.held.clear();
        self.state.taps.clear();
        let ids: Vec<u32> = self.state.planet.plate_ids().collect();
        let planet = self.state.planet_mut();
        for id in ids {
            planet.release(id);
        }
    }
}

/// Two places on the great circle that runs half-way between two others.
fn bisector(a: DVec3, b: DVec3) -> Vec<DVec3> {
    let middle = (a + b).normalize_or(a.any_orthonormal_vector());
    let across = (a - b)
        .cross(middle)
        .normalize_or(middle.any_orthonormal_vector());
    [-0.3_f64, 0.3]
        .map(|angle| middle * angle.cos() + across * angle.sin())
        .to_vec()
}
