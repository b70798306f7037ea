//! Plates, arrows and faults as a cartographer inks them, live.
//!
//! | mark | line |
//! |---|---|
//! | pushing plate | solid vermilion, an arrow from each finger; the part of the push that is spent has paled |
//! | resting plate | dashed blue-black, a trigonometrical point under each finger |
//! | spent plate | thin, faded blue-black |
//! | capped push | a bar across the tip, and dots to where the hand wanted to go |
//! | fault | a line with teeth on the side of the range |

use std::f32::consts::{FRAC_PI_2, TAU};

use egui::{Color32, Painter, Pos2, Vec2};
use glam::DVec2;

use super::ease;
use super::palette::{AMBER, BLUE_BLACK, PAPER, VERMILION, between, faded};
use super::pen::{Line, Pen, aside, length};
use super::sight::Sight;
use crate::instrument::{EditView, Editing};
use crate::surface::{FaultTrace, PlateMark, PlateState};

/// Time in which a mark comes, seconds.
const COMES: f64 = 0.25;

/// Time in which a mark goes, seconds.
const GOES: f64 = 0.6;

/// Time in which a plate passes from one state to another, seconds.
const TURNS: f64 = 0.5;

/// A mark whose middle moved less than this since the last frame is the same mark, metres.
const SAME: f64 = 12e3;

/// A handle lights up from this distance to a finger, mm, and is fully lit at the other.
const NEAR: (f64, f64) = (70.0, 15.0);

/// Radius of the ring that fills while something is held to be removed, mm: wider than a fingertip.
const HOLD_RADIUS: f32 = 17.0;

/// The marks on the land: what is there, and how far it has come or gone.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    plates: Vec<Shown<PlateMark>>,
    faults: Vec<Shown<FaultTrace>>,
}

/// A mark and its fades. Times are seconds of the clock that [`Chart::follow`] is given.
#[derive(Clone, Debug)]
struct Shown<M> {
    mark: M,
    came: f64,
    /// Since when it is no longer there.
    left: Option<f64>,
    /// What it was before, and since when it is no longer that.
    before: Option<(PlateState, f64)>,
}

/// A mark that can be known again in the next frame.
trait Mark: Clone {
    /// Its middle, plan metres.
    fn middle(&self) -> DVec2;
    /// What it does, where marks of its kind do something.
    fn state(&self) -> Option<PlateState>;
}

impl Mark for PlateMark {
    fn middle(&self) -> DVec2 {
        middle(&self.hull)
    }

    fn state(&self) -> Option<PlateState> {
        Some(self.state)
    }
}

impl Mark for FaultTrace {
    fn middle(&self) -> DVec2 {
        middle(&self.points)
    }

    fn state(&self) -> Option<PlateState> {
        None
    }
}

fn middle(points: &[DVec2]) -> DVec2 {
    points.iter().sum::<DVec2>() / points.len().max(1) as f64
}

impl<M: Mark> Shown<M> {
    /// How much of it is to be seen, 0 to 1.
    fn presence(&self, now_s: f64) -> f32 {
        let gone = self.left.map_or(0.0, |left| ease::smooth((now_s - left) / GOES));
        ease::out((now_s - self.came) / COMES) * (1.0 - gone)
    }
}

/// Brings `shown` up to `marks`: known ones are taken over, new ones come, missing ones go.
fn follow<M: Mark>(shown: &mut Vec<Shown<M>>, marks: &[M], now_s: f64) {
    let mut known = std::mem::take(shown);
    for mark in marks {
        let middle = mark.middle();
        let nearest = (0..known.len())
            .filter(|&i| known[i].left.is_none())
            .map(|i| (i, known[i].mark.middle().distance(middle)))
            .filter(|&(_, distance)| distance < SAME)
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let (came, before) = match nearest {
            Some((i, _)) => {
                let old = known.remove(i);
                let before = match (old.mark.state(), mark.state()) {
                    (Some(was), Some(is)) if was != is => Some((was, now_s)),
                    _ => old.before.filter(|&(_, since)| now_s - since < TURNS),
                };
                (old.came, before)
            }
            None => (now_s, None),
        };
        shown.push(Shown {
            mark: mark.clone(),
            came,
            left: None,
            before,
        });
    }
    for mut old in known {
        let left = *old.left.get_or_insert(now_s);
        if now_s - left < GOES {
            shown.push(old);
        }
    }
}

impl Chart {
    /// Takes over the marks of the newest frame at `now_s` seconds.
    pub fn follow(&mut self, plates: &[PlateMark], faults: &[FaultTrace], now_s: f64) {
        follow(&mut self.plates, plates, now_s);
        follow(&mut self.faults, faults, now_s);
    }

    /// True while something comes, goes or turns: the picture is to be drawn again.
    pub fn moves(&self, now_s: f64) -> bool {
        let plates = self.plates.iter().map(|p| (p.came, p.left, p.before));
        let faults = self.faults.iter().map(|f| (f.came, f.left, f.before));
        plates
            .chain(faults)
            .any(|(came, left, before)| now_s - came < COMES || left.is_some() || before.is_some())
    }

    /// Draws the marks with `strength` (0 to 1) of their opacity. `edits` is what contacts of the edit tool do, `None`
    /// where no side has that tool: then there are no handles.
    pub fn draw(
        &self,
        painter: &Painter,
        sight: &Sight<'_>,
        strength: f32,
        edits: Option<&[EditView]>,
        now_s: f64,
    ) {
        if strength <= 0.0 {
            return;
        }
        let pen = Pen::new(painter, sight);
        for shown in &self.faults {
            fault(pen, &shown.mark, strength * shown.presence(now_s));
        }
        for shown in &self.plates {
            let present = strength * shown.presence(now_s);
            let turned = shown
                .before
                .map_or(1.0, |(_, since)| ease::smooth((now_s - since) / TURNS));
            if let Some((before, _)) = shown.before {
                plate(pen, &shown.mark, before, present * (1.0 - turned));
            }
            plate(pen, &shown.mark, shown.mark.state, present * turned);
        }
        if let Some(edits) = edits {
            let standing = self.plates.iter().filter(|shown| shown.left.is_none());
            let tips = standing.flat_map(|shown| &shown.mark.arrows).map(|&(_, to)| to);
            handles(pen, tips, edits, strength);
        }
    }
}

/// One plate in the manner of a state.
fn plate(pen: Pen<'_>, mark: &PlateMark, state: PlateState, strength: f32) {
    if strength <= 0.0 || mark.hull.len() < 3 {
        return;
    }
    let spent = mark.spent.clamp(0.0, 1.0) as f32;
    let (line, rim) = match state {
        PlateState::Pushing => (
            Line::solid(VERMILION, strength * (0.95 - 0.45 * spent), 1.0),
            faded(VERMILION, 0.30 * strength * (1.0 - spent)),
        ),
        PlateState::Resting => (
            Line {
                dash: Some((4.8, 3.4)),
                ..Line::solid(BLUE_BLACK, 0.85 * strength, 1.0)
            },
            faded(BLUE_BLACK, 0.16 * strength),
        ),
        PlateState::Standing => (
            Line::solid(BLUE_BLACK, 0.38 * strength, 0.7),
            Color32::TRANSPARENT,
        ),
    };
    let closed: Vec<DVec2> = mark.hull.iter().chain(mark.hull.first()).copied().collect();
    for stretch in pen.sight.line(&closed) {
        let whole = stretch.first() == stretch.last();
        if whole && rim != Color32::TRANSPARENT {
            pen.rim_light(&stretch[1..], 9.0, rim);
        }
        pen.ink(&stretch[usize::from(whole)..], whole, line);
    }
    for &(from, to) in &mark.arrows {
        match state {
            PlateState::Resting => anchor(pen, from, line),
            PlateState::Pushing | PlateState::Standing => {
                arrow(pen, from, to, line.colour, line.strength, spent);
                if let Some(part) = mark.cap {
                    cap(pen, from, to, part, line);
                }
            }
        }
    }
}

/// Where a resting finger holds the land: a trigonometrical point.
fn anchor(pen: Pen<'_>, at: DVec2, line: Line) {
    let Some(at) = pen.sight.of_plan(at) else {
        return;
    };
    let corner = |turn: f32| at + pen.mm(4.2) * Vec2::angled(turn.to_radians());
    let line = Line {
        dash: None,
        width: 0.8,
        ..line
    };
    pen.ink(&[corner(-90.0), corner(30.0), corner(150.0)], true, line);
    pen.disc(at, 0.8, line.colour, line.strength);
}

/// A slender arrow that swells towards its head; only a dot where nothing moved. What is spent of it has paled.
fn arrow(pen: Pen<'_>, from: DVec2, to: DVec2, colour: Color32, strength: f32, spent: f32) {
    if let Some(at) = pen.sight.of_plan(from) {
        pen.disc(at, 2.3, PAPER, 0.35 * strength);
        pen.disc(at, 1.6, colour, strength);
    }
    let stretches = pen.sight.line(&[from, to]);
    let [shaft] = stretches.as_slice() else {
        return;
    };
    let (Some(&start), Some(&tip)) = (shaft.first(), shaft.last()) else {
        return;
    };
    let length = start.distance(tip);
    if length.is_nan() || length < pen.mm(2.5) {
        return;
    }
    let head = pen.mm(9.5).min(0.55 * length);
    let before = shaft[shaft.len() - 2];
    let along = (tip - before).normalized();
    let neck = tip - along * head * 0.9;
    let mut body: Vec<Pos2> = shaft.iter().copied().filter(|p| p.distance(tip) > head).collect();
    body.push(neck);
    let bed = Line::solid(PAPER, 0.42 * strength, 2.6);
    pen.line(&[body.as_slice(), &[tip]].concat(), false, bed);
    taper(pen, &body, (0.3, 1.05), colour, strength, spent);
    let wing = aside(along) * head * 0.33;
    pen.fill(
        &[tip, tip - along * head + wing, tip - along * head - wing],
        colour,
        strength,
    );
}

/// A line that swells from one half-width (mm) to another. The first part of it, `pale` of its length, is paler.
fn taper(pen: Pen<'_>, line: &[Pos2], (thin, thick): (f32, f32), colour: Color32, strength: f32, pale: f32) {
    const PALE: f32 = 0.45;
    let length = length(line);
    let half = |done: f32| {
        pen.mm(thin + (thick - thin) * done / length)
            .max(0.5 / pen.painter.pixels_per_point())
    };
    let mut done = 0.0;
    for pair in line.windows(2) {
        let across = aside((pair[1] - pair[0]).normalized());
        let part = pair[0].distance(pair[1]);
        // The stretch is cut where the paler part ends.
        let cut = (pale * length - done).clamp(0.0, part);
        for (from, to, strength) in [(0.0, cut, strength * PALE), (cut, part, strength)] {
            if to - from > 0.01 {
                let ends = [from, to].map(|at| (pair[0].lerp(pair[1], at / part), half(done + at)));
                let [(a, at_a), (b, at_b)] = ends;
                pen.fill(
                    &[
                        a + across * at_a,
                        b + across * at_b,
                        b - across * at_b,
                        a - across * at_a,
                    ],
                    colour,
                    strength,
                );
            }
        }
        done += part;
    }
}

/// A bar across the tip, and dots to where the hand wanted to go: `part` of the way is all that was left of it.
fn cap(pen: Pen<'_>, from: DVec2, to: DVec2, part: f64, line: Line) {
    let wanted = from + (to - from) / part.max(0.05);
    if let (Some(start), Some(tip)) = (pen.sight.of_plan(from), pen.sight.of_plan(to))
        && tip.distance(start) > pen.mm(1.0)
    {
        let along = (tip - start).normalized();
        let across = aside(along) * pen.mm(5.5);
        let at = tip + along * pen.mm(1.4);
        let bar = Line {
            dash: None,
            width: 1.5,
            ..line
        };
        pen.ink(&[at - across, at + across], false, bar);
    }
    for dots in pen.sight.line(&[to, wanted]) {
        let dots_line = Line {
            dash: Some((1.0, 3.2)),
            width: 1.1,
            ..line
        };
        pen.line(&dots, false, dots_line);
    }
}

/// The trace with triangular teeth on the side of the hanging wall.
fn fault(pen: Pen<'_>, fault: &FaultTrace, strength: f32) {
    const TEETH: (f32, f32, f32) = (17.0, 6.4, 5.2);
    if strength <= 0.0 {
        return;
    }
    let line = Line::solid(BLUE_BLACK, 0.85 * strength, 1.25);
    let (every, base, tall) = (pen.mm(TEETH.0), pen.mm(TEETH.1), pen.mm(TEETH.2));
    // Seen along the line, left is anticlockwise on the screen as it is on the map.
    let side = if fault.range_on_left { -1.0 } else { 1.0 };
    for trace in pen.sight.line(&fault.points) {
        pen.ink(&trace, false, line);
        let mut next = every * 0.5;
        for pair in trace.windows(2) {
            let part = pair[0].distance(pair[1]);
            let along = (pair[1] - pair[0]).normalized();
            while next <= part {
                let foot = pair[0] + along * next;
                let tip = foot + aside(along) * side * tall;
                pen.fill(
                    &[foot - along * base * 0.5, foot + along * base * 0.5, tip],
                    line.colour,
                    line.strength,
                );
                next += every;
            }
            next -= part;
        }
    }
}

/// Rings on the tips of arrows (plan metres), brighter near a finger that edits; and what those fingers are doing.
fn handles(pen: Pen<'_>, tips: impl Iterator<Item = DVec2>, edits: &[EditView], strength: f32) {
    for tip in tips {
        let on_table = pen.sight.map().to_table(tip);
        let nearest = edits
            .iter()
            .map(|edit| edit.at.distance(on_table))
            .fold(f64::INFINITY, f64::min);
        let near = 1.0 - ease::step(NEAR.1, NEAR.0, nearest);
        if let Some(at) = pen.sight.of_plan(tip) {
            handle(pen, at, near, strength);
        }
    }
    for edit in edits {
        if let Some(at) = pen.sight.of_table(edit.at) {
            doing(pen, at, edit, strength);
        }
    }
}

/// What one finger with the edit tool, which is at `at`, does.
fn doing(pen: Pen<'_>, at: Pos2, edit: &EditView, strength: f32) {
    let thread = Line::solid(BLUE_BLACK, 0.7 * strength, 0.8);
    match edit.doing {
        Editing::Tip { tip } => {
            if let Some(tip) = pen.sight.of_table(tip) {
                let dotted = Line {
                    dash: Some((1.0, 2.4)),
                    ..thread
                };
                pen.ink(&[at, tip], false, dotted);
                handle(pen, tip, 1.0, strength);
            }
        }
        Editing::NewArrow { from, to } => {
            let [from, to] = [from, to].map(|mm| pen.sight.map().to_plan(mm));
            for stretch in pen.sight.line(&[from, to]) {
                let dashed = Line {
                    dash: Some((3.6, 2.6)),
                    ..Line::solid(VERMILION, 0.95 * strength, 1.3)
                };
                pen.ink(&stretch, false, dashed);
            }
            if let Some(start) = pen.sight.of_plan(from) {
                pen.disc(start, 1.6, VERMILION, strength);
            }
            handle(pen, at, 1.0, strength);
        }
        // The two ways the fault can lean.
        Editing::Fault => {
            for side in [-1.0, 1.0] {
                let foot = at + Vec2::X * pen.mm(side * 15.0);
                let tall = Vec2::X * pen.mm(side * 5.0);
                let base = Vec2::Y * pen.mm(3.4);
                pen.fill(
                    &[foot - base, foot + tall, foot + base],
                    BLUE_BLACK,
                    0.85 * strength,
                );
            }
        }
        Editing::Removed => {
            for turn in [45.0_f32, 135.0] {
                let arm = pen.mm(5.0) * Vec2::angled(turn.to_radians());
                pen.ink(&[at - arm, at + arm], false, thread);
            }
        }
        Editing::Plate | Editing::Nothing => {}
    }
    if edit.hold > 0.0 {
        let sweep = TAU * edit.hold.min(1.0) as f32;
        let line = Line::solid(VERMILION, strength, 1.8);
        pen.ring(at, HOLD_RADIUS, Line::solid(PAPER, 0.5 * strength, 3.0));
        pen.arc(at, HOLD_RADIUS, -FRAC_PI_2, sweep, line);
    }
}

/// A grip on the tip of an arrow; `near` (0 to 1) says how near a finger is.
pub(super) fn handle(pen: Pen<'_>, at: Pos2, near: f32, strength: f32) {
    let radius = 5.0 + 1.5 * near;
    pen.glow(
        at,
        radius,
        4.0 * near,
        7.0 * near,
        faded(AMBER, 0.6 * strength * near),
    );
    pen.ring(at, radius, Line::solid(BLUE_BLACK, 0.8 * strength, 2.6));
    pen.ring(
        at,
        radius,
        Line::solid(between(PAPER, AMBER, near), strength, 1.4),
    );
}
