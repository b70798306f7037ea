//! Rigid bodies: working plates, joined where they overlap, and capped against each other.

use super::hull::Hull;
use super::params::MountainParams;
use super::plate::{FaultSide, Pair, Plate, PlateId, PlateSet, PlateState};
use crate::gesture::rigid::{RigidFit, RigidMotion};
use glam::DVec2;

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

impl PlateSet {
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
                let middle = f64::midpoint(free, blocked);
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
