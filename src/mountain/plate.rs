//! Plates: what hands have set in motion, where it stands, and for how long.

use std::collections::BTreeMap;

use glam::DVec2;

use super::hull::Hull;
use super::params::MountainParams;
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

/// Plates that overlap act as one rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// The lowest id among its plates; names it in a [`Pair`].
    pub lead: PlateId,
    /// `A`: the hull of all their supports.
    pub support: Hull,
    /// `T`: the motion of all their arrows together.
    pub motion: RigidMotion,
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
    plates: Vec<Plate>,
    domes: Vec<Dome>,
    sides: BTreeMap<Pair, FaultSide>,
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

    /// The plate of that name.
    pub fn get(&self, id: PlateId) -> Option<&Plate> {
        self.plates.iter().find(|p| p.id == id)
    }

    pub(super) fn plates_mut(&mut self) -> &mut Vec<Plate> {
        &mut self.plates
    }

    pub(super) fn sides_mut(&mut self) -> &mut BTreeMap<Pair, FaultSide> {
        &mut self.sides
    }

    /// Where the fault of a pair lies: latched at first contact, or flipped by hand; at the plate itself for one
    /// that pushes alone.
    pub fn fault_side(&self, pair: Pair) -> FaultSide {
        self.sides.get(&pair).copied().unwrap_or(FaultSide::First)
    }

    /// True while a push is unspent or a dome rises: the world has something to do.
    pub fn active(&self, now_yr: f64, params: &MountainParams) -> bool {
        self.plates.iter().any(|p| p.state(now_yr) == PlateState::Pushing)
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
        self.sides
            .retain(|pair, _| pair.first != id && pair.second != Some(id));
    }

    /// Caps the motions of all working plates against each other, and latches the fault sides of new pairs.
    pub(super) fn settle(&mut self, now_yr: f64, params: &MountainParams) {
        let groups = self.groups(now_yr);
        let asked: Vec<Body> = groups.iter().map(|g| self.join(g, |p| p.fit.motion)).collect();
        let caps = capped_fractions(&asked, params.gap_kept);
        for ((group, body), &cap) in groups.iter().zip(&asked).zip(&caps) {
            let motion = scaled(&body.motion, body.support.centre(), cap);
            for &index in group {
                let plate = &mut self.plates[index];
                plate.motion = motion;
                plate.cap = cap;
            }
        }
        self.latch(now_yr);
    }

    /// Stable is the resting plate of a pair, else the slower one when they first meet (the older of equals).
    fn latch(&mut self, now_yr: f64) {
        /// Speeds within this ratio count as equal: hands are not exact.
        const EQUAL: f64 = 1.05;
        let bodies = self.bodies(now_yr);
        for (i, a) in bodies.iter().enumerate() {
            for b in &bodies[i + 1..] {
                let speed = |body: &Body| {
                    let c = body.support.centre();
                    body.motion.apply(c).distance(c)
                };
                let pair = Pair::of(a.lead, b.lead);
                let (first, second) = if a.lead < b.lead { (a, b) } else { (b, a) };
                if speed(first) == 0.0 && speed(second) == 0.0 {
                    continue;
                }
                self.sides
                    .entry(pair)
                    .or_insert(if speed(first) <= EQUAL * speed(second) {
                        FaultSide::First
                    } else {
                        FaultSide::Second
                    });
            }
        }
    }

    /// Indices of the working plates, gathered by overlap of their supports (Eq. 2 is 0/0 where hulls overlap).
    fn groups(&self, now_yr: f64) -> Vec<Vec<usize>> {
        let mut groups: Vec<(Hull, Vec<usize>)> = Vec::new();
        for (index, plate) in self.plates.iter().enumerate() {
            if plate.state(now_yr) == PlateState::Standing {
                continue;
            }
            let mut hull = plate.support.clone();
            let mut members = vec![index];
            // A grown hull may reach further groups: repeat until none is left.
            while let Some(hit) = groups.iter().position(|(other, _)| other.overlaps(&hull)) {
                let (other, others) = groups.remove(hit);
                hull = hull.merged(&other);
                members.extend(others);
            }
            members.sort_unstable();
            groups.push((hull, members));
        }
        groups.sort_by_key(|(_, members)| members[0]);
        groups.into_iter().map(|(_, members)| members).collect()
    }

    fn join(&self, group: &[usize], motion_of: impl Fn(&Plate) -> RigidMotion) -> Body {
        let first = &self.plates[group[0]];
        let mut body = Body {
            lead: first.id,
            support: first.support.clone(),
            motion: motion_of(first),
        };
        if group.len() > 1 {
            let (mut from, mut to) = (Vec::new(), Vec::new());
            for &index in group {
                let plate = &self.plates[index];
                body.lead = body.lead.min(plate.id);
                body.support = body.support.merged(&plate.support);
                let motion = motion_of(plate);
                from.extend_from_slice(&plate.starts);
                to.extend(plate.starts.iter().map(|&p| motion.apply(p)));
            }
            body.motion = RigidFit::fit(&from, &to).motion;
        }
        body
    }

    /// The rigid bodies that take part in Eq. 1–2 at `now_yr`: resting and pushing plates, overlapping ones joined.
    pub fn bodies(&self, now_yr: f64) -> Vec<Body> {
        self.groups(now_yr)
            .iter()
            .map(|g| self.join(g, |p| p.motion))
            .collect()
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

/// The part `fraction` of a motion: that part of its angle about `centre`, and of the centre's displacement.
pub(super) fn scaled(motion: &RigidMotion, centre: DVec2, fraction: f64) -> RigidMotion {
    if fraction == 1.0 {
        return *motion;
    }
    let angle = motion.angle * fraction;
    let target = centre + (motion.apply(centre) - centre) * fraction;
    RigidMotion {
        angle,
        translation: target - DVec2::from_angle(angle).rotate(centre),
    }
}

/// For each body the part of its motion after which (and on the way to which) every pair keeps `gap_kept` of its
/// first gap.
fn capped_fractions(bodies: &[Body], gap_kept: f64) -> Vec<f64> {
    /// One pair's cap can let another pair close (a plate that no longer runs away): a few sweeps settle that.
    const SWEEPS: usize = 4;
    let mut caps = vec![1.0; bodies.len()];
    let moves = |body: &Body| body.motion != RigidMotion::IDENTITY;
    for _ in 0..SWEEPS {
        let mut next = caps.clone();
        let mut changed = false;
        for i in 0..bodies.len() {
            for j in i + 1..bodies.len() {
                let (a, b) = (&bodies[i], &bodies[j]);
                if !(moves(a) || moves(b)) {
                    continue;
                }
                let share = pair_fraction(a, caps[i], b, caps[j], gap_kept);
                if share < 1.0 {
                    next[i] = f64::min(next[i], caps[i] * share);
                    next[j] = f64::min(next[j], caps[j] * share);
                    changed = true;
                }
            }
        }
        caps = next;
        if !changed {
            break;
        }
    }
    caps
}

/// Largest common part of both motions along which the gap stays above `gap_kept` of the first one.
fn pair_fraction(a: &Body, cap_a: f64, b: &Body, cap_b: f64, gap_kept: f64) -> f64 {
    /// The way is looked at in so many steps, so that a push cannot jump over a small hull.
    const STEPS: usize = 32;
    const BISECTIONS: usize = 40;
    let (centre_a, centre_b) = (a.support.centre(), b.support.centre());
    let gap = |s: f64| {
        let a = a.support.moved(&scaled(&a.motion, centre_a, cap_a * s));
        a.distance_to(&b.support.moved(&scaled(&b.motion, centre_b, cap_b * s)))
    };
    let least = gap_kept * a.support.distance_to(&b.support);
    let mut free = 0.0;
    for k in 1..=STEPS {
        let s = k as f64 / STEPS as f64;
        // Rounding must not cap a pair again that an earlier sweep has brought to the limit.
        if gap(s) < least * (1.0 - 1e-9) {
            let mut blocked = s;
            for _ in 0..BISECTIONS {
                let middle = (free + blocked) / 2.0;
                if gap(middle) < least {
                    blocked = middle;
                } else {
                    free = middle;
                }
            }
            return free;
        }
        free = s;
    }
    1.0
}
