//! Where ranges and rifts stand: belts between two bodies, or before one that pushes alone.
//!
//! Eq. 2 thickens the crust in wide lobes with its maxima along the rims of the hulls. Strain in the crust localises
//! instead: a belt is a spindle across the motion, as long as the hulls face each other and fading over half the gap,
//! steep above its thrust fault and gentle behind. Its front is bowed towards the fault's foreland in the middle,
//! where the displacement is largest (the bow-and-arrow rule, Elliott 1976, Phil. Trans. R. Soc. A 283), and never
//! follows a hull. What `q` says about each cross-section, it keeps: the crust that Eq. 2 piles up between the hulls is
//! gathered section by section and spread over the belt's profile.
//!
//! All weights are smooth functions of the gesture: a belt that begins, ends, or hands over to another one does so
//! gradually.

use glam::DVec2;

use super::body::Body;
use super::params::MountainParams;
use super::plate::{FaultSide, Pair, PlateId};
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

/// Cross-sections along a spindle in which the thickening is gathered.
const SECTIONS: usize = 49;

/// A belt across the direction `across`, in a frame with its origin in the middle.
#[derive(Clone, Debug, PartialEq)]
struct Spindle {
    origin: DVec2,
    /// Unit vector along the motion, from the low to the high edge.
    across: DVec2,
    /// Between these lines across the belt the crust of Eq. 2 thickens for it, metres from the origin.
    gathers: [f64; 2],
    /// Edges across the belt in its middle.
    edges: [f64; 2],
    /// Widths over which it rises from those edges.
    flanks: [f64; 2],
    /// How far each edge has drawn in at the ends of the belt.
    bow: [f64; 2],
    /// Half-length along the strike over which it is whole, and the length over which it then fades.
    whole: f64,
    fade: f64,
    /// The fault lies at the high edge (+1), at the low one (−1), or there is none (0).
    fault: f64,
    /// Thickening in each section, spread over the profile: its height in units of `q − 1`.
    heights: Vec<f64>,
}

/// The belts around a body that turns on the spot. A long body that turns presses the crust together in the two
/// quadrants ahead of its ends and draws it apart in the other two, as the field of `sin 2φ` about its long axis.
#[derive(Clone, Debug, PartialEq)]
struct Swirl {
    centre: DVec2,
    /// Azimuth of the long axis.
    axis: f64,
    /// Radius of the circle the body turns in, metres.
    radius: f64,
    /// Thickening in the middle of a quadrant, in units of `q − 1`.
    height: f64,
    front_width: f64,
    /// +1 where the crust is pressed together by a counter-clockwise turn, −1 in the other quadrants.
    sign: f64,
}

impl Spindle {
    fn local(&self, p: DVec2) -> (f64, f64) {
        let d = p - self.origin;
        (d.dot(self.across), self.across.perp_dot(d))
    }

    fn half_length(&self) -> f64 {
        self.whole + self.fade
    }

    fn edges_at(&self, along: f64) -> (f64, f64) {
        let end = (along / self.half_length()).powi(2);
        (
            self.edges[0] + self.bow[0] * end,
            self.edges[1] - self.bow[1] * end,
        )
    }

    fn mask(&self, p: DVec2) -> f64 {
        let (x, along) = self.local(p);
        if along.abs() >= self.half_length() || x <= self.edges[0] || x >= self.edges[1] {
            return 0.0;
        }
        let (low, high) = self.edges_at(along);
        let narrower = (high - low) / (self.edges[1] - self.edges[0]);
        let strength = 1.0 - smoother((along.abs() - self.whole) / self.fade);
        strength
            * smoother((x - low) / (self.flanks[0] * narrower))
            * smoother((high - x) / (self.flanks[1] * narrower))
    }

    /// Height of the profile at a place along the strike.
    fn height(&self, along: f64) -> f64 {
        let at = (f64::midpoint(along / self.half_length(), 1.0) * (SECTIONS - 1) as f64)
            .clamp(0.0, (SECTIONS - 1) as f64);
        let low = (at as usize).min(SECTIONS - 2);
        let part = at - low as f64;
        self.heights[low] * (1.0 - part) + self.heights[low + 1] * part
    }

    /// Gathers what Eq. 2 thickens (or thins, with `sign` −1) in each section, and spreads it over the profile.
    fn gather(&mut self, sign: f64, thickening: impl Fn(DVec2) -> f64) {
        const STEPS: usize = 24;
        /// Rounds of smoothing with (1, 2, 1)/4: facets of the hulls must not show along the strike.
        const ROUNDS: usize = 6;
        let step = (self.gathers[1] - self.gathers[0]) / STEPS as f64;
        // Each flank of the profile holds half its width.
        let profile = self.edges[1] - self.edges[0] - f64::midpoint(self.flanks[0], self.flanks[1]);
        let strike = self.across.perp();
        self.heights.clear();
        for k in 0..SECTIONS {
            let along = self.half_length() * (2.0 * k as f64 / (SECTIONS - 1) as f64 - 1.0);
            let sum: f64 = (0..STEPS)
                .map(|i| {
                    let x = self.gathers[0] + (i as f64 + 0.5) * step;
                    (sign * thickening(self.origin + self.across * x + strike * along)).max(0.0)
                })
                .sum();
            self.heights.push(sum * step / profile);
        }
        for _ in 0..ROUNDS {
            let mut before = self.heights[0];
            for k in 0..SECTIONS {
                let here = self.heights[k];
                let after = self.heights[(k + 1).min(SECTIONS - 1)];
                self.heights[k] = (before + 2.0 * here + after) / 4.0;
                before = here;
            }
        }
    }
}

impl Swirl {
    /// The belts end so far from the body, metres.
    const FAR: f64 = 26.0 * KM;

    fn mask(&self, p: DVec2) -> f64 {
        let d = p - self.centre;
        let beyond = d.length() - self.radius;
        if beyond <= 0.0 || beyond >= Self::FAR {
            return 0.0;
        }
        let quadrant = self.sign * (2.0 * (d.to_angle() - self.axis)).sin();
        smoother(quadrant)
            * smoother(beyond / self.front_width)
            * smoother((Self::FAR - beyond) / (Self::FAR - self.front_width))
    }
}

impl Belt {
    /// Where the belt is: 1 in its middle, 0 outside.
    pub fn mask(&self, p: DVec2) -> f64 {
        self.weight
            * match &self.shape {
                Shape::Spindle(s) => s.mask(p),
                Shape::Swirl(s) => s.mask(p),
            }
    }

    /// Reads from `thickening` (`q − 1`) how much crust each cross-section has to put up.
    pub fn gather(&mut self, thickening: impl Fn(DVec2) -> f64) {
        let sign = match self.kind {
            Kind::Range => 1.0,
            Kind::Rift => -1.0,
        };
        if let Shape::Spindle(s) = &mut self.shape {
            s.gather(sign, thickening);
        }
    }

    /// Thickening (of a rift: thinning) at `p` after the strain has localised, in units of `q − 1`, ≥ 0.
    pub fn localised(&self, p: DVec2) -> f64 {
        let mask = self.mask(p);
        if mask == 0.0 {
            return 0.0;
        }
        mask * match &self.shape {
            Shape::Spindle(s) => s.height(s.local(p).1),
            Shape::Swirl(s) => s.height,
        }
    }

    /// True where `p` lies on the fault's half of the belt.
    pub fn on_fault_half(&self, p: DVec2) -> bool {
        match &self.shape {
            Shape::Spindle(s) => {
                let (x, along) = s.local(p);
                let (low, high) = s.edges_at(along);
                // The half is counted between the middles of both flanks, so that a long back does not shift it.
                let middle = (low + high + s.flanks[0] / 2.0 - s.flanks[1] / 2.0) / 2.0;
                (x - middle) * s.fault > 0.0
            }
            Shape::Swirl(s) => p.distance(s.centre) < s.radius + s.front_width,
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
    // Oblique convergence is partitioned: the belt strikes half-way between the normals of motion and of the line
    // that joins the plates.
    let across = (relative.normalize() * closing.signum() + axis).normalize();
    let strike = across.perp();

    let (front_a, front_b) = (a.span(across).1, b.span(across).0);
    let gap = front_b - front_a;
    let (span_a, span_b) = (a.span(strike), b.span(strike));
    let (south, north) = (span_a.0.max(span_b.0), span_a.1.min(span_b.1));
    let facing = (north - south) / 2.0;
    let room = gap.max(6.0 * KM);
    let fade = (params.strike_fade * room).clamp(8.0 * KM, 30.0 * KM);

    let kind = if closing > 0.0 { Kind::Range } else { Kind::Rift };
    let reach = match kind {
        Kind::Range => params.reach,
        Kind::Rift => params.rift_reach,
    };
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
        // Hulls that nearly touch leave no room for a belt; it would be a wall along the slit.
        * smoother((gap - 6.0 * KM) / (14.0 * KM))
        * (1.0 - smoother((gap - reach[0]) / (reach[1] - reach[0])))
        * smoother(1.0 + facing / (0.75 * fade))
        * smoother(relative.length() / (0.3 * (shift_a.length() + shift_b.length())))
        * screened;

    let pair = Pair::of(a.lead, b.lead);
    let at_a = (fault_side(pair) == FaultSide::First) == (a.lead == pair.first);
    // The spindle lives in the gap; all lengths shrink together when the gap is short.
    let short = (room / (params.front_width + params.back_width + 4.0 * params.rim_offset)).min(1.0);
    let offset = params.rim_offset * short;
    let half = room / 2.0;
    // The fault stands off the stable plate, so that the crest comes into the middle third of the gap; the back
    // takes half the gap, and no less than asked for.
    let stand = offset.max(params.fault_stand * room);
    let front = params.front_width * short;
    let back = (params.back_width * short).max(half - offset);
    let (edges, flanks, fault) = match (kind, at_a) {
        (Kind::Range, true) => ([stand - half, half - 2.0 * offset], [front, back], -1.0),
        (Kind::Range, false) => ([2.0 * offset - half, half - stand], [back, front], 1.0),
        (Kind::Rift, _) => {
            let half_width = (half - 3.0 * offset).min(params.rift_width / 2.0);
            ([-half_width, half_width], [front, front], 0.0)
        }
    };
    let bow = 0.3 * (edges[1] - edges[0]);
    Some(Belt {
        pair,
        kind,
        weight,
        shape: Shape::Spindle(Spindle {
            origin: across * f64::midpoint(front_a, front_b) + strike * f64::midpoint(south, north),
            across,
            gathers: [-half, half],
            edges,
            flanks,
            bow: [bow, bow],
            whole: 0.6 * facing.max(0.0),
            fade: fade + 0.6 * facing.max(0.0),
            fault,
            heights: vec![0.0; SECTIONS],
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
        let long = length - params.front_width - 2.0 * KM;
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
                gathers: [0.0, length],
                edges: [0.0, length],
                flanks,
                bow: [6.0 * KM, 14.0 * KM],
                whole: 0.5 * facing,
                fade: 14.0 * KM + 0.75 * facing,
                fault,
                heights: vec![0.0; SECTIONS],
            }),
        });
    }
    let (axis, length) = long_axis(hull.core(), hull.radius());
    let sense = mover.moved.motion.angle.signum();
    for (kind, sign) in [(Kind::Range, sense), (Kind::Rift, -sense)] {
        found.push(Belt {
            pair,
            kind,
            weight: weight * turning * smoother(length / 0.1),
            shape: Shape::Swirl(Swirl {
                centre: mover.centre,
                axis,
                radius,
                // The ground takes the rim's displacement up over the rest distance.
                height: turn / params.rest_distance,
                front_width: params.front_width,
                sign,
            }),
        });
    }
}

/// Azimuth of the long axis of a grown hull, and how long it is: (λ₁ − λ₂)/(λ₁ + λ₂) of the second moments of its
/// corners and of the disc it is grown by; 0 for a disc.
fn long_axis(core: &[DVec2], radius: f64) -> (f64, f64) {
    let n = core.len() as f64;
    let mean = core.iter().sum::<DVec2>() / n;
    let (mut difference, mut cross, mut sum) = (0.0, 0.0, radius * radius / 2.0);
    for &p in core {
        let d = p - mean;
        difference += (d.x * d.x - d.y * d.y) / n;
        cross += 2.0 * d.x * d.y / n;
        sum += d.length_squared() / n;
    }
    (
        cross.atan2(difference) / 2.0,
        difference.hypot(cross) / sum.max(1e-9),
    )
}
