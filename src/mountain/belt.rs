//! Where ranges and rifts stand: belts between two bodies, or before one that pushes alone.
//!
//! Eq. 2 thickens the crust in wide lobes with its maxima along the rims of the hulls. Strain in the crust localises
//! instead: a belt is a spindle across the motion, as long as the hulls face each other and fading over half the gap,
//! steep above its thrust fault and gentle behind. Its front is bowed towards the fault's foreland in the middle,
//! where the displacement is largest (the bow-and-arrow rule, Elliott 1976, Phil. Trans. R. Soc. A 283), and never
//! follows a hull. A belt is a mask between 0 and 1; how fast the ground rises in it comes from `q`.
//!
//! All weights are smooth functions of the gesture: a belt that begins, ends, or hands over to another one does so
//! gradually.

use glam::DVec2;

use super::params::MountainParams;
use super::plate::{Body, FaultSide, Pair, PlateId};
use super::smoother;
use super::transport::MovedBody;
use crate::units::KM;

/// What a belt does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The crust is pressed together: a range.
    Range,
    /// The crust is pulled apart: a rift basin.
    Rift,
}

/// A belt.
#[derive(Clone, Debug, PartialEq)]
pub struct Belt {
    /// Between whom.
    pub pair: Pair,
    /// What it does.
    pub kind: Kind,
    /// How much it takes part, 0–1.
    pub weight: f64,
    shape: Shape,
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Spindle(Spindle),
    Swirl(Swirl),
}

/// A belt across the direction `across`, in a frame with its origin in the middle.
#[derive(Clone, Debug, PartialEq)]
struct Spindle {
    origin: DVec2,
    /// Unit vector along the relative motion, from the low to the high edge.
    across: DVec2,
    /// Edges along `across` in the middle of the belt, metres from the origin.
    edges: [f64; 2],
    /// Widths over which it rises from those edges.
    flanks: [f64; 2],
    /// How far each edge draws in towards the ends of the belt.
    bow: [f64; 2],
    /// Half-length along the strike over which it is whole, and the length over which it then fades.
    whole: f64,
    fade: f64,
    /// The fault lies at the high edge (+1), at the low one (−1), or there is none (0).
    fault: f64,
}

/// The belts around a body that turns on the spot: before its leading rims, wherever they are.
#[derive(Clone, Debug, PartialEq)]
struct Swirl {
    body: MovedBody,
    /// Largest displacement of its rim, metres.
    reach: f64,
    front_width: f64,
    rim_offset: f64,
}

impl Spindle {
    fn local(&self, p: DVec2) -> (f64, f64) {
        let d = p - self.origin;
        (d.dot(self.across), self.across.perp_dot(d))
    }

    fn edges_at(&self, along: f64) -> (f64, f64, f64) {
        let strength = 1.0 - smoother((along.abs() - self.whole) / self.fade);
        let end = 1.0 - strength;
        (
            strength,
            self.edges[0] + self.bow[0] * end,
            self.edges[1] - self.bow[1] * end,
        )
    }

    fn mask(&self, p: DVec2) -> f64 {
        let (x, along) = self.local(p);
        if along.abs() >= self.whole + self.fade || x <= self.edges[0] || x >= self.edges[1] {
            return 0.0;
        }
        let (strength, low, high) = self.edges_at(along);
        strength * smoother((x - low) / self.flanks[0]) * smoother((high - x) / self.flanks[1])
    }
}

impl Swirl {
    fn mask(&self, p: DVec2) -> f64 {
        let near = self.body.hull.nearest(p);
        let far = 28.0 * KM;
        if near.distance <= self.rim_offset || near.distance >= far {
            return 0.0;
        }
        let outward = (p - near.projection) / near.distance;
        let shift = near.projection - self.body.motion.apply_inverse(near.projection);
        let ahead = smoother((shift.dot(outward) / self.reach - 0.05) / 0.5);
        ahead
            * smoother((near.distance - self.rim_offset) / self.front_width)
            * smoother((far - near.distance) / (far - self.front_width))
    }
}

impl Belt {
    /// How much of the thickening at `p` is land rising (or sinking) in this belt, 0–1.
    pub fn mask(&self, p: DVec2) -> f64 {
        self.weight
            * match &self.shape {
                Shape::Spindle(s) => s.mask(p),
                Shape::Swirl(s) => s.mask(p),
            }
    }

    /// True where `p` lies on the fault's half of the belt.
    pub fn on_fault_half(&self, p: DVec2) -> bool {
        match &self.shape {
            Shape::Spindle(s) => {
                let (x, along) = s.local(p);
                let (_, low, high) = s.edges_at(along);
                // The half is counted between the middles of both flanks, so that a long back does not shift it.
                let middle = (low + high + s.flanks[0] / 2.0 - s.flanks[1] / 2.0) / 2.0;
                (x - middle) * s.fault > 0.0
            }
            Shape::Swirl(s) => s.body.hull.nearest(p).distance < s.rim_offset + s.front_width,
        }
    }
}

/// A body with what the belts need of it.
struct Mover {
    lead: PlateId,
    moved: MovedBody,
    centre: DVec2,
    /// Displacement of its centre.
    shift: DVec2,
}

impl Mover {
    fn shift_at(&self, p: DVec2) -> DVec2 {
        p - self.moved.motion.apply_inverse(p)
    }

    /// Interval of the hull along a unit vector.
    fn span(&self, direction: DVec2) -> (f64, f64) {
        (
            -self.moved.hull.support(-direction),
            self.moved.hull.support(direction),
        )
    }
}

/// All belts of the bodies, in a fixed order. `fault_side` tells where the fault of a pair lies.
pub fn belts(bodies: &[Body], params: &MountainParams, fault_side: impl Fn(Pair) -> FaultSide) -> Vec<Belt> {
    let movers: Vec<Mover> = bodies
        .iter()
        .map(|body| {
            let hull = body.support.moved(&body.motion);
            let centre = hull.centre();
            Mover {
                lead: body.lead,
                shift: centre - body.motion.apply_inverse(centre),
                moved: MovedBody {
                    hull,
                    motion: body.motion,
                },
                centre,
            }
        })
        .collect();
    let mut found = Vec::new();
    let mut alone = vec![1.0; movers.len()];
    for i in 0..movers.len() {
        for j in i + 1..movers.len() {
            let Some(belt) = between(&movers, i, j, params, &fault_side) else {
                continue;
            };
            if belt.kind == Kind::Range {
                for (k, other) in [(i, j), (j, i)] {
                    let towards = (movers[other].centre - movers[k].centre).normalize_or_zero();
                    let heading = movers[k].shift.normalize_or_zero().dot(towards);
                    alone[k] *= 1.0 - belt.weight * smoother(heading / 0.6);
                }
            }
            found.push(belt);
        }
    }
    for (mover, &weight) in movers.iter().zip(&alone) {
        before(mover, weight, params, &fault_side, &mut found);
    }
    found.retain(|belt| belt.weight > 1e-3);
    found
}

/// The belt between two bodies: a range if they close, a rift if they part.
fn between(
    movers: &[Mover],
    i: usize,
    j: usize,
    params: &MountainParams,
    fault_side: &impl Fn(Pair) -> FaultSide,
) -> Option<Belt> {
    let (a, b) = (&movers[i], &movers[j]);
    let middle = (a.centre + b.centre) / 2.0;
    let shift = |m: &Mover| m.shift_at(m.moved.hull.nearest(middle).projection);
    let (shift_a, shift_b) = (shift(a), shift(b));
    let relative = shift_a - shift_b;
    if relative.length() < 1.0 {
        return None;
    }
    let axis = (b.centre - a.centre).normalize_or_zero();
    let closing = relative.normalize().dot(axis);
    let across = relative.normalize() * closing.signum();
    let strike = across.perp();

    let (front_a, front_b) = (a.span(across).1, b.span(across).0);
    let gap = front_b - front_a;
    let (span_a, span_b) = (a.span(strike), b.span(strike));
    let (south, north) = (span_a.0.max(span_b.0), span_a.1.min(span_b.1));
    let facing = (north - south) / 2.0;
    let room = gap.max(6.0 * KM);
    let fade = (params.strike_fade * room).clamp(8.0 * KM, 30.0 * KM);

    let screened: f64 = movers
        .iter()
        .enumerate()
        .filter(|&(k, _)| k != i && k != j)
        .map(|(_, other)| {
            let t = (other.centre.dot(across) - front_a) / room;
            let along = (other.centre.dot(strike) - f64::midpoint(south, north)).abs();
            let beside = facing.max(0.0) + fade;
            1.0 - smoother(t / 0.25) * smoother((1.0 - t) / 0.25) * smoother((beside - along) / fade)
        })
        .product();
    let weight = smoother((closing.abs() - 0.15) / 0.5)
        * smoother((gap - 2.0 * KM) / (6.0 * KM))
        * (1.0 - smoother((gap - params.reach[0]) / (params.reach[1] - params.reach[0])))
        * smoother((facing + fade / 2.0) / fade)
        * smoother(relative.length() / (0.3 * (shift_a.length() + shift_b.length())))
        * screened;

    let pair = Pair::of(a.lead, b.lead);
    let at_a = (fault_side(pair) == FaultSide::First) == (a.lead == pair.first);
    // The spindle lives in the middle of the gap; all lengths shrink together when the gap is short.
    let short = (room / (params.front_width + params.back_width + 4.0 * params.rim_offset)).min(1.0);
    let (front, back) = (params.front_width * short, params.back_width * short);
    let offset = params.rim_offset * short;
    let kind = if closing > 0.0 { Kind::Range } else { Kind::Rift };
    let half = room / 2.0;
    let (edges, flanks, fault) = match (kind, at_a) {
        (Kind::Range, true) => ([offset - half, half - 2.0 * offset], [front, back], -1.0),
        (Kind::Range, false) => ([2.0 * offset - half, half - offset], [back, front], 1.0),
        (Kind::Rift, _) => ([3.0 * offset - half, half - 3.0 * offset], [front, front], 0.0),
    };
    let bow = 0.32 * room;
    Some(Belt {
        pair,
        kind,
        weight,
        shape: Shape::Spindle(Spindle {
            origin: across * f64::midpoint(front_a, front_b) + strike * f64::midpoint(south, north),
            across,
            edges,
            flanks,
            bow: [bow, bow],
            whole: 0.4 * facing.max(0.0),
            fade: fade + 0.6 * facing.max(0.0),
            fault,
        }),
    })
}

/// The belts before a body that pushes against the resting ground: a steep front before the hand and a long back
/// beyond; around its leading rims as far as it turns on the spot.
fn before(
    mover: &Mover,
    weight: f64,
    params: &MountainParams,
    fault_side: &impl Fn(Pair) -> FaultSide,
    found: &mut Vec<Belt>,
) {
    let hull = &mover.moved.hull;
    let radius = (hull.area() / std::f64::consts::PI).sqrt();
    let turn = mover.moved.motion.angle.abs() * radius;
    let shift = mover.shift.length();
    if shift + turn < 1.0 {
        return;
    }
    let turning = smoother((turn / (turn + shift) - 0.3) / 0.5);
    let pair = Pair::alone(mover.lead);
    if shift >= 1.0 {
        let across = mover.shift / shift;
        let strike = across.perp();
        let (west, east) = mover.span(strike);
        let facing = (east - west) / 2.0;
        let front = mover.span(across).1 + params.rim_offset;
        let length = 40.0 * KM;
        let long = length - params.front_width - 4.0 * KM;
        let (flanks, fault) = match fault_side(pair) {
            FaultSide::First => ([params.front_width, long], -1.0),
            FaultSide::Second => ([long, params.front_width], 1.0),
        };
        found.push(Belt {
            pair,
            kind: Kind::Range,
            weight: weight * (1.0 - turning),
            shape: Shape::Spindle(Spindle {
                origin: across * front + strike * f64::midpoint(west, east),
                across,
                edges: [0.0, length],
                flanks,
                bow: [7.0 * KM, 14.0 * KM],
                whole: 0.4 * facing,
                fade: 12.0 * KM + 0.75 * facing,
                fault,
            }),
        });
    }
    found.push(Belt {
        pair,
        kind: Kind::Range,
        weight: weight * turning,
        shape: Shape::Swirl(Swirl {
            body: mover.moved.clone(),
            reach: turn + shift,
            front_width: params.front_width,
            rim_offset: params.rim_offset,
        }),
    });
}
