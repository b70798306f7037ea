//! Plates: what hands have set in motion, where it stands, and for how long.

use std::collections::BTreeMap;

use glam::DVec2;

use super::hull::Hull;
use super::params::MountainParams;
use super::residue::{MAX_RESIDUES, Residue};
use crate::gesture::contact::Side;
use crate::gesture::event::{HandEvent, HandId, Leg};
use crate::gesture::rigid::{RigidFit, RigidMotion};
use crate::units::PlanMap;

/// At most this many plates stand; the oldest spent ones go first, then the oldest.
pub const MAX_PLATES: usize = 16;

/// At most this many domes rise at once; the oldest finish first.
pub const MAX_DOMES: usize = 64;

/// Names a plate for the whole session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PlateId(pub u32);

/// What a plate does at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateState {
    /// It is an anchor: it holds the crust still.
    Resting,
    /// Its push is at work.
    Pushing,
    /// Its time is over: out of Eq. 2, but its support stands and can be pushed again.
    Standing,
}

/// A rigid piece of crust, and its push.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Its name.
    pub id: PlateId,
    /// The side of the table it belongs to.
    pub side: Side,
    /// The hand that touched it last.
    pub hand: HandId,
    /// The leg that pushes it; `None` for an anchor or an edited plate.
    pub leg: Option<Leg>,
    /// The hand is still down.
    pub held: bool,
    /// `A` of Eq. 1: where it is held rigid, before the motion.
    pub support: Hull,
    /// Where the arrows begin, plan metres.
    pub starts: Vec<DVec2>,
    /// The motion the hand asked for, plan frame.
    pub fit: RigidFit,
    /// The motion after capping: what Eq. 1–2 and the arrows use.
    pub motion: RigidMotion,
    /// The part of the asked motion that is left, 0–1; below 1 the push was longer than the gap allows.
    pub cap: f64,
    /// When it began, years.
    pub begun_yr: f64,
    /// When it is spent, years. A held anchor does not expire.
    pub expires_yr: f64,
    /// The support it had before the present hand came, where it stood; kept unless the hand is larger.
    inherited: Option<Hull>,
}

impl Plate {
    /// What it does at `now_yr`.
    pub fn state(&self, now_yr: f64) -> PlateState {
        let anchor = self.motion == RigidMotion::IDENTITY && self.fit.motion == RigidMotion::IDENTITY;
        if anchor && (self.held || now_yr < self.expires_yr) {
            PlateState::Resting
        } else if !anchor && now_yr < self.expires_yr {
            PlateState::Pushing
        } else {
            PlateState::Standing
        }
    }

    /// How much of its time has gone, 0–1: arrows fade with it.
    pub fn spent(&self, now_yr: f64) -> f64 {
        if self.held && self.leg.is_none() {
            return 0.0;
        }
        let span = self.expires_yr - self.begun_yr;
        if span > 0.0 {
            ((now_yr - self.begun_yr) / span).clamp(0.0, 1.0)
        } else {
            1.0
        }
    }

    /// The support after the motion, `B = T(A)`: the rigid set of Eq. 1–2 in the reading that is continuous at its
    /// rim, and where the plate stands when it is spent.
    pub fn moved_support(&self) -> Hull {
        self.support.moved(&self.motion)
    }

    /// The arrows as they act: from each start to its fitted, capped tip.
    pub fn arrows(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        self.starts.iter().map(|&p| (p, self.motion.apply(p)))
    }
}

/// A small dome under a tapping finger, as a pluton raises it: an addition to the paper, so that drumming answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dome {
    /// Its summit, plan metres.
    pub centre: DVec2,
    /// When it began to rise, years.
    pub begun_yr: f64,
    /// The side of the table it belongs to.
    pub side: Side,
}

/// Two plates, or a plate and the resting ground, between which a belt rises.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pair {
    /// The plate with the lower id.
    pub first: PlateId,
    /// The other plate; `None` is the ground.
    pub second: Option<PlateId>,
}

impl Pair {
    /// The pair of two plates in canonical order.
    pub fn of(a: PlateId, b: PlateId) -> Self {
        Self {
            first: a.min(b),
            second: Some(a.max(b)),
        }
    }

    /// A plate that pushes alone.
    pub fn alone(plate: PlateId) -> Self {
        Self {
            first: plate,
            second: None,
        }
    }
}

/// On which side of a belt its fault (and steep front) lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultSide {
    /// At the pair's first plate.
    First,
    /// At the second, or, for a plate that pushes alone, away from it.
    Second,
}

/// What an event did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Applied {
    /// Nothing to do with plates, or about plates that are gone.
    Unchanged,
    /// This plate came, changed or was let go.
    Plate(PlateId),
    /// So many domes began to rise.
    Domes(usize),
}

/// All plates and domes: plain state, no clock, no scratch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlateSet {
    pub(super) plates: Vec<Plate>,
    domes: Vec<Dome>,
    residues: Vec<Residue>,
    pub(super) sides: BTreeMap<Pair, FaultSide>,
    next_id: u32,
}

impl PlateSet {
    /// The plates, oldest first.
    pub fn plates(&self) -> &[Plate] {
        &self.plates
    }

    /// The domes, oldest first.
    pub fn domes(&self) -> &[Dome] {
        &self.domes
    }

    /// What earlier pushes of the plates still do.
    pub fn residues(&self) -> &[Residue] {
        &self.residues
    }

    /// Keeps what is left of a push whose plate has gone on to another.
    pub fn leave(&mut self, residue: Residue) {
        self.residues.push(residue);
        if self.residues.len() > MAX_RESIDUES {
            let ends = |r: &Residue| r.expires_yr;
            let first = (0..self.residues.len())
                .min_by(|&a, &b| ends(&self.residues[a]).total_cmp(&ends(&self.residues[b])));
            if let Some(first) = first {
                self.residues.remove(first);
            }
        }
    }

    /// These plates without what earlier pushes still do.
    #[must_use]
    pub fn without_residues(&self) -> Self {
        Self {
            residues: Vec::new(),
            ..self.clone()
        }
    }

    /// These plates without the push of `id`, as if it were spent at `now_yr`.
    #[must_use]
    pub fn without_push(&self, id: PlateId, now_yr: f64, params: &MountainParams) -> Self {
        let mut others = self.without_residues();
        if let Some(plate) = others.plates.iter_mut().find(|plate| plate.id == id) {
            plate.expires_yr = now_yr;
            plate.held = false;
        }
        others.settle(now_yr, params);
        others
    }

    /// The plate of that name.
    pub fn get(&self, id: PlateId) -> Option<&Plate> {
        self.plates.iter().find(|p| p.id == id)
    }

    /// Where the fault of a pair lies: latched at first contact, or flipped by hand; at the plate itself for one
    /// that pushes alone.
    pub fn fault_side(&self, pair: Pair) -> FaultSide {
        self.sides.get(&pair).copied().unwrap_or(FaultSide::First)
    }

    /// True while a push is unspent or a dome rises: the world has something to do.
    pub fn active(&self, now_yr: f64, params: &MountainParams) -> bool {
        self.plates.iter().any(|p| p.state(now_yr) == PlateState::Pushing)
            || self.residues.iter().any(|r| now_yr < r.expires_yr)
            || self.domes.iter().any(|d| now_yr < d.begun_yr + params.dome_years)
    }

    /// Turns one hand event into plates at model time `now_yr`.
    ///
    /// * A push lasts `push_years` from when it begins, extended while its fingers still move (each change of the
    ///   fit starts the span anew). Late fingers bring new starts, and the support grows with them.
    /// * A hand whose hull overlaps a plate acts on that plate: from where the plate stands if that is nearer, else
    ///   from where its last push began. The plate keeps its support unless the hand's own hull is larger; then it
    ///   becomes the hull of both.
    /// * An anchor stands while its hand is down, and `push_years` after.
    /// * `Retract` is not handled here: whoever owns the world restores the state from before those contacts.
    pub fn apply(
        &mut self,
        event: &HandEvent,
        map: &PlanMap,
        now_yr: f64,
        params: &MountainParams,
    ) -> Applied {
        self.domes.retain(|d| now_yr < d.begun_yr + params.dome_years);
        self.residues.retain(|r| now_yr < r.expires_yr);
        let to_plan = |points: &[DVec2]| points.iter().map(|&p| map.to_plan(p)).collect::<Vec<_>>();
        let applied = match event {
            HandEvent::Rest { hand, side, fingers } => {
                self.touch(*hand, None, *side, to_plan(fingers), None, now_yr, params)
            }
            HandEvent::Push {
                leg,
                side,
                starts,
                fit,
            } => {
                let fit = fit_in_plan(fit, map);
                self.touch(
                    leg.hand,
                    Some(*leg),
                    *side,
                    to_plan(starts),
                    Some(fit),
                    now_yr,
                    params,
                )
            }
            HandEvent::PushEnd { leg } => self.release(|p| p.leg == Some(*leg), None),
            HandEvent::Lift { hand } => self.release(
                |p| p.hand == *hand && p.leg.is_none(),
                Some(now_yr + params.push_years),
            ),
            HandEvent::Tap { side, fingers, .. } => self.tap(&to_plan(fingers), *side, now_yr),
            HandEvent::Retract { .. } => Applied::Unchanged,
        };
        self.evict(now_yr);
        self.settle(now_yr, params);
        applied
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "the fields of the two events that touch plates"
    )]
    fn touch(
        &mut self,
        hand: HandId,
        leg: Option<Leg>,
        side: Side,
        starts: Vec<DVec2>,
        fit: Option<RigidFit>,
        now_yr: f64,
        params: &MountainParams,
    ) -> Applied {
        let Some(own) = Hull::new(&starts, params.finger_radius) else {
            return Applied::Unchanged;
        };
        let fit = fit.unwrap_or(RigidFit {
            motion: RigidMotion::IDENTITY,
            residual: 0.0,
        });
        if !(fit.motion.angle.is_finite() && fit.motion.translation.is_finite()) {
            return Applied::Unchanged;
        }
        let known = self
            .plates
            .iter()
            .position(|p| p.held && p.hand == hand && p.leg == leg);
        let index = known.unwrap_or_else(|| self.adopt(hand, &own, side, now_yr));
        for (i, other) in self.plates.iter_mut().enumerate() {
            // A hand holds one plate.
            if i != index && other.hand == hand {
                other.held = false;
            }
        }
        let plate = &mut self.plates[index];
        let changed = plate.leg != leg || plate.fit != fit || plate.starts != starts;
        if plate.leg != leg || known.is_none() {
            plate.begun_yr = now_yr;
        }
        plate.hand = hand;
        plate.leg = leg;
        plate.side = side;
        plate.held = true;
        plate.support = match &plate.inherited {
            None => own,
            Some(old) if own.area() <= old.area() => old.clone(),
            Some(old) => old.merged(&own),
        };
        plate.starts = starts;
        plate.fit = fit;
        plate.motion = fit.motion;
        if changed || leg.is_none() {
            plate.expires_yr = now_yr + params.push_years;
        }
        Applied::Plate(plate.id)
    }

    /// The plate that a new hand (or a new leg of one) acts on: one that its hull overlaps and that no other hand
    /// holds, the nearest first; else a new one. Returns its index.
    fn adopt(&mut self, hand: HandId, own: &Hull, side: Side, now_yr: f64) -> usize {
        let centre = own.centre();
        let mut best: Option<(f64, usize, Hull)> = None;
        for (index, plate) in self.plates.iter().enumerate() {
            if plate.held && plate.hand != hand {
                continue;
            }
            for standing in [plate.moved_support(), plate.support.clone()] {
                let distance = standing.centre().distance(centre);
                if own.overlaps(&standing) && best.as_ref().is_none_or(|b| distance < b.0) {
                    best = Some((distance, index, standing));
                }
            }
        }
        if let Some((_, index, standing)) = best {
            self.plates[index].inherited = Some(standing);
            return index;
        }
        let id = PlateId(self.next_id);
        self.next_id += 1;
        self.plates.push(Plate {
            id,
            side,
            hand,
            leg: None,
            held: true,
            support: own.clone(),
            starts: Vec::new(),
            fit: RigidFit {
                motion: RigidMotion::IDENTITY,
                residual: 0.0,
            },
            motion: RigidMotion::IDENTITY,
            cap: 1.0,
            begun_yr: now_yr,
            expires_yr: now_yr,
            inherited: None,
        });
        self.plates.len() - 1
    }

    fn release(&mut self, which: impl Fn(&Plate) -> bool, expires_yr: Option<f64>) -> Applied {
        let Some(plate) = self.plates.iter_mut().find(|p| p.held && which(p)) else {
            return Applied::Unchanged;
        };
        plate.held = false;
        if let Some(at) = expires_yr {
            plate.expires_yr = at;
        }
        Applied::Plate(plate.id)
    }

    fn tap(&mut self, fingers: &[DVec2], side: Side, now_yr: f64) -> Applied {
        let before = self.domes.len();
        self.domes
            .extend(fingers.iter().filter(|p| p.is_finite()).map(|&centre| Dome {
                centre,
                begun_yr: now_yr,
                side,
            }));
        let risen = self.domes.len() - before;
        let surplus = self.domes.len().saturating_sub(MAX_DOMES);
        self.domes.drain(..surplus);
        if risen == 0 {
            Applied::Unchanged
        } else {
            Applied::Domes(risen)
        }
    }

    fn evict(&mut self, now_yr: f64) {
        while self.plates.len() > MAX_PLATES {
            // False sorts first: spent before working, loose before held, then by age.
            let oldest = self
                .plates
                .iter()
                .min_by(|a, b| {
                    let key = |p: &Plate| (p.state(now_yr) != PlateState::Standing, p.held);
                    key(a)
                        .cmp(&key(b))
                        .then(a.begun_yr.total_cmp(&b.begun_yr))
                        .then(a.id.cmp(&b.id))
                })
                .map(|p| p.id);
            let Some(id) = oldest else { return };
            self.forget(id);
        }
    }

    pub(super) fn forget(&mut self, id: PlateId) {
        self.plates.retain(|p| p.id != id);
        self.residues.retain(|r| r.plate != id);
        self.sides
            .retain(|pair, _| pair.first != id && pair.second != Some(id));
    }
}

/// A fit in table millimetres (y down) as one in plan metres (y north).
fn fit_in_plan(fit: &RigidFit, map: &PlanMap) -> RigidFit {
    // The motion as the plan sees it: where the plan's origin goes fixes the translation, and the mirrored axis
    // turns the angle round.
    RigidFit {
        motion: RigidMotion {
            angle: -fit.motion.angle,
            translation: map.to_plan(fit.motion.apply(map.to_table(DVec2::ZERO))),
        },
        residual: fit.residual * map.metres_per_mm(),
    }
}
