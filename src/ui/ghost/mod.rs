//! Ghost hands: they show the first two gestures without a word.
//!
//! The shadow of a hand touches, moves, leaves the arrows of a push, and a range of peaks as on old maps grows before
//! it. What the hands do is decided elsewhere ([`GhostHand`]); here they are given a body that fits.

mod hand;
mod laid;

use egui::emath::Rot2;
use egui::epaint::{Mesh, PathStroke};
use egui::{Color32, Painter, Pos2, Rect, Vec2, vec2};
use glam::DVec2;

use self::hand::{Pose, Shape};
use self::laid::Laid;
use super::ease;
use super::palette::{BLUE_BLACK, LAMP, PAPER, VERMILION, faded};
use super::pen::{Line, Pen, arc, aside};
use super::sight::Sight;
use crate::kiosk::{GhostHand, Hint};

/// Radius of the ring around a ghost's finger, mm.
const RING: f32 = 11.0;

/// Way after which the range of a push is whole, mm.
const GROWN: f64 = 70.0;

/// A lone hand's range stands so far before its fingers, mm.
const AHEAD: f64 = 62.0;

/// A motion shorter than this shows nothing, mm.
const LEAST: f64 = 3.0;

/// Draws the hands of a lesson, with what they leave on the land.
pub fn draw(painter: &Painter, sight: &Sight<'_>, hands: &[GhostHand]) {
    let pen = Pen::new(painter, sight);
    let hands: Vec<Ghost<'_>> = hands.iter().filter_map(Ghost::new).collect();
    range(pen, &hands);
    for ghost in &hands {
        ghost.arrows(pen);
    }
    for ghost in &hands {
        ghost.shadow(pen);
    }
}

/// Draws a lesson where nothing may travel: the hands stand where the gesture ends, and come and go.
pub fn draw_still(painter: &Painter, sight: &Sight<'_>, hint: &Hint) {
    /// Part of a lesson at which the hands have moved and still touch.
    const MOVED: f64 = 0.76;
    /// Part of a lesson in which they come, and in which they go.
    const FADE: f64 = 0.22;
    let moved = Hint {
        progress: MOVED,
        ..*hint
    };
    let came = ease::step(0.0, FADE, hint.progress);
    let left = ease::step(1.0 - FADE, 1.0, hint.progress);
    let mut hands = moved.hands(sight.map().size_mm());
    for hand in &mut hands {
        hand.opacity *= f64::from(came * (1.0 - left));
    }
    draw(painter, sight, &hands);
}

/// A hand whose places are places.
struct Ghost<'a> {
    hand: &'a GhostHand,
    /// Middle of its fingers, mm.
    middle: DVec2,
    /// From where they landed to where they are, mm.
    way: DVec2,
    opacity: f32,
    touching: f32,
}

fn mean(points: &[DVec2]) -> DVec2 {
    points.iter().sum::<DVec2>() / points.len().max(1) as f64
}

impl<'a> Ghost<'a> {
    fn new(hand: &'a GhostHand) -> Option<Self> {
        let places = hand.fingers.iter().chain(&hand.starts).chain([&hand.wrist]);
        let seen = !hand.fingers.is_empty() && hand.opacity > 0.0;
        (seen && places.into_iter().all(|p| p.is_finite())).then(|| {
            let middle = mean(&hand.fingers);
            Self {
                hand,
                middle,
                way: if hand.starts.is_empty() {
                    DVec2::ZERO
                } else {
                    middle - mean(&hand.starts)
                },
                opacity: hand.opacity.clamp(0.0, 1.0) as f32,
                touching: hand.touching.clamp(0.0, 1.0) as f32,
            }
        })
    }

    /// The arrows of the push.
    fn arrows(&self, pen: Pen<'_>) {
        for (&from, &to) in self.hand.starts.iter().zip(&self.hand.fingers) {
            if let (Some(from), Some(to)) = (pen.sight.of_table(from), pen.sight.of_table(to)) {
                arrow(pen, from, to, self.opacity);
            }
        }
    }

    fn shadow(&self, pen: Pen<'_>) {
        let pose = if self.hand.fingers.len() > 1 {
            Pose::Spread
        } else {
            Pose::Pointing
        };
        let shape = hand::shape(pose);
        let laid = Laid::new(shape, self.hand);
        let place = |p: Pos2| pen.sight.of_table(laid.place(p));
        let (Some(wrist), Some(middle)) = (
            pen.sight.of_table(self.hand.wrist),
            pen.sight.of_table(self.middle),
        ) else {
            return;
        };
        // The forearm fades away from the wrist on.
        let (down, long) = ((wrist - middle).normalized(), f64::from(pen.mm(100.0)));
        let seen = self.opacity;
        let fade = move |p: Pos2| 1.0 - ease::step(-0.1, 0.95, f64::from((p - wrist).dot(down)) / long);

        let touch = self.touching * seen;
        let tips: Vec<Pos2> = self
            .hand
            .fingers
            .iter()
            .filter_map(|&f| pen.sight.of_table(f))
            .collect();
        for &tip in &tips {
            pen.glow(tip, RING, 8.0, 8.0, faded(LAMP, 0.75 * touch));
        }
        let mut mesh = Mesh::default();
        for &(p, depth) in &shape.corners {
            // Thin at the rim, deeper in the middle: a shadow without an edge.
            let depth = 0.30 + 0.16 * (1.0 - (-depth / 5.0).exp());
            let Some(p) = place(p) else { return };
            mesh.colored_vertex(p, faded(BLUE_BLACK, seen * fade(p) * depth));
        }
        for &[a, b, c] in &shape.triangles {
            mesh.add_triangle(a, b, c);
        }
        pen.painter.add(mesh);

        let outline: Vec<Pos2> = shape.rim.iter().filter_map(|&p| place(p)).collect();
        let colour = move |_: Rect, p: Pos2| -> Color32 { faded(LAMP, 0.85 * seen * fade(p)) };
        let width = pen.mm(0.9).max(1.0);
        pen.painter.line(outline, PathStroke::new_uv(width, colour));
        for &tip in &tips {
            pen.ring(tip, RING, Line::solid(LAMP, touch, 1.1));
        }
    }
}

/// The arrow of a finger.
fn arrow(pen: Pen<'_>, from: Pos2, to: Pos2, strength: f32) {
    let length = from.distance(to);
    pen.disc(from, 1.6, VERMILION, strength);
    if length > pen.mm(LEAST as f32) {
        let along = (to - from) / length;
        let head = pen.mm(7.0).min(0.5 * length);
        let neck = to - along * head;
        pen.line(&[from, neck], false, Line::solid(PAPER, 0.5 * strength, 2.8));
        pen.line(&[from, neck], false, Line::solid(VERMILION, strength, 1.2));
        let wing = aside(along) * head * 0.36;
        pen.fill(&[to, neck + wing, neck - wing], VERMILION, strength);
    }
}

/// A row of peaks as on old maps, across the push: before a hand that pushes alone, or between the hands. They grow,
/// the middle one first.
fn range(pen: Pen<'_>, hands: &[Ghost<'_>]) {
    let Some(first) = hands.iter().find(|ghost| ghost.way.length() > LEAST) else {
        return;
    };
    let along = first.way.normalize();
    let (middle, peaks) = match hands {
        [ghost] => (ghost.middle + along * AHEAD, 3),
        _ => (
            mean(&hands.iter().map(|ghost| ghost.middle).collect::<Vec<_>>()),
            5,
        ),
    };
    // Upright for whoever the hands are of.
    let turn = if first.hand.wrist.y < first.middle.y {
        std::f32::consts::PI
    } else {
        0.0
    };
    let grown = first.way.length() / GROWN;
    let last = f64::from(peaks - 1);
    let mut feet: Vec<(DVec2, f64)> = (0..peaks)
        .map(|i| {
            let offset = f64::from(i) - last / 2.0;
            let stagger = along * f64::from(9 * (i % 2));
            (
                middle + along.perp() * offset * 31.0 + stagger,
                offset.abs() / last * 2.0,
            )
        })
        .collect();
    // Those that are nearer to the visitor stand before the others.
    feet.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
    if turn > 0.0 {
        feet.reverse();
    }
    for (foot, far) in feet {
        let grown = ease::step(0.15 + 0.25 * far, 0.7 + 0.3 * far, grown);
        if let Some(foot) = pen.sight.of_table(foot) {
            peak(
                pen,
                foot,
                (34.0 - 11.0 * far as f32) * grown,
                turn,
                first.opacity * grown,
            );
        }
    }
}

/// One peak, `tall` mm high: its left side lit, its right side in the shade.
fn peak(pen: Pen<'_>, foot: Pos2, tall: f32, turn: f32, strength: f32) {
    if tall < 2.0 {
        return;
    }
    let wide = tall * 0.78;
    let place = |x: f32, y: f32| foot + Rot2::from_angle(turn) * vec2(x, y + 10.0) * pen.mm(1.0);
    let (top, inner) = (place(0.0, -tall), place(wide * 0.22, tall * 0.10));
    let (left, right) = (place(-wide, 0.0), place(wide, 0.0));
    pen.fill(&[top, inner, left], PAPER, 0.86 * strength);
    pen.fill(&[top, right, inner], BLUE_BLACK, 0.62 * strength);
    pen.line(
        &[left, top, right],
        false,
        Line::solid(BLUE_BLACK, 0.9 * strength, 0.9),
    );
}

/// A hand that points, as an icon `tall` mm high around `centre`, turned clockwise by `turn`.
pub(super) fn icon(pen: Pen<'_>, centre: Pos2, tall: f32, turn: f32, colour: Color32, strength: f32) {
    let Shape { rim, tips, .. } = hand::shape(Pose::Pointing);
    // From the fingertip to a little below the wrist.
    let (top, bottom) = (-108.0, 74.0);
    let scale = tall / (bottom - top);
    let place = |p: Pos2| {
        let mm: Vec2 = vec2(p.x + 3.0, p.y - f32::midpoint(top, bottom)) * scale;
        centre + Rot2::from_angle(turn) * mm * pen.mm(1.0)
    };
    let outline: Vec<Pos2> = rim.iter().filter(|p| p.y < bottom).map(|&p| place(p)).collect();
    pen.line(&outline, false, Line::solid(colour, strength, 1.0));
    if let Some(&tip) = tips.first() {
        let rays = arc(place(tip), pen.mm(22.0 * scale), turn - 2.6, 2.1);
        pen.line(&rays, false, Line::solid(colour, 0.8 * strength, 0.8));
    }
}
