//! The warning before a reset: the land dims, and a ring runs out. Any touch ends it.

use std::f32::consts::{FRAC_PI_2, TAU};

use egui::emath::Rot2;
use egui::{Align2, Painter, Rect, vec2};
use glam::DVec2;

use super::ease;
use super::ghost;
use super::lettering::{self, turn};
use super::palette::{AMBER, LAMP, ROOM, between, faded};
use super::pen::{Line, Pen};
use super::sight::Sight;
use super::words;
use crate::gesture::contact::Side;

/// Time in which the land dims, ms.
const DIMS: f64 = 1500.0;

/// Radius of the ring, mm.
const RADIUS: f32 = 74.0;

/// Draws, over all of `screen` (points), for how many seconds touches still do nothing while the table is wiped.
pub fn clean(painter: &Painter, sight: &Sight<'_>, screen: Rect, left_s: f64) {
    painter.rect_filled(screen, 0.0, faded(ROOM, 0.85));
    let Some(centre) = sight.of_table(sight.map().size_mm() / 2.0) else {
        return;
    };
    let pen = Pen::new(painter, sight);
    let seconds = left_s.ceil().to_string();
    for side in [Side::South, Side::North] {
        let turn = turn(side);
        let at = centre + Rot2::from_angle(turn) * vec2(0.0, pen.mm(60.0));
        lettering::write(
            painter,
            at,
            Align2::CENTER_CENTER,
            &seconds,
            pen.mm(70.0),
            LAMP,
            turn,
        );
    }
}

/// Draws, over all of `screen` (points), the cross that is to be touched next: where it is (table mm), how many were
/// before it, and for how long it waits.
pub fn cross(painter: &Painter, sight: &Sight<'_>, screen: Rect, at_mm: DVec2, number: usize, left_s: f64) {
    painter.rect_filled(screen, 0.0, faded(ROOM, 0.85));
    let pen = Pen::new(painter, sight);
    let (Some(at), Some(centre)) = (sight.of_table(at_mm), sight.of_table(sight.map().size_mm() / 2.0))
    else {
        return;
    };
    for arm in [vec2(1.0, 0.0), vec2(0.0, 1.0)] {
        let (near, far) = (arm * pen.mm(4.0), arm * pen.mm(22.0));
        for way in [-1.0, 1.0] {
            pen.line(
                &[at + near * way, at + far * way],
                false,
                Line::solid(AMBER, 1.0, 0.9),
            );
        }
    }
    pen.ring(at, 13.0, Line::solid(LAMP, 0.7, 0.6));
    let text = format!(
        "{}  ({} of 4, {:.0} s)",
        words::TOUCH_CROSS,
        number + 1,
        left_s.ceil()
    );
    for side in [Side::South, Side::North] {
        let turn = turn(side);
        let place = centre + Rot2::from_angle(turn) * vec2(0.0, pen.mm(40.0));
        lettering::write(
            painter,
            place,
            Align2::CENTER_CENTER,
            &text,
            pen.mm(13.0),
            LAMP,
            turn,
        );
    }
}

/// Draws the warning over all of `screen` (points): `left_ms` of `whole_ms` until the reset.
pub fn draw(painter: &Painter, sight: &Sight<'_>, screen: Rect, left_ms: u64, whole_ms: u64) {
    let pen = Pen::new(painter, sight);
    let gone_ms = whole_ms.saturating_sub(left_ms) as f64;
    let shown = ease::smooth(gone_ms / DIMS);
    painter.rect_filled(screen, 0.0, faded(ROOM, 0.66 * shown));

    let Some(centre) = sight.of_table(sight.map().size_mm() / 2.0) else {
        return;
    };
    pen.spot(centre, 2.4 * RADIUS, faded(ROOM, 0.55 * shown));
    let left = left_ms.min(whole_ms) as f32 / whole_ms.max(1) as f32;
    // The last seconds are warmer.
    let colour = between(AMBER, LAMP, left * 1.4);
    pen.ring(centre, RADIUS, Line::solid(LAMP, 0.22 * shown, 0.8));
    pen.glow(centre, RADIUS, 5.0, 9.0, faded(colour, 0.16 * shown));
    // What is left runs out clockwise from the top.
    let start = -FRAC_PI_2 + TAU * (1.0 - left);
    pen.arc(centre, RADIUS, start, TAU * left, Line::solid(colour, shown, 2.4));
    let across = vec2(pen.mm(26.0), 0.0);
    pen.line(
        &[centre - across, centre + across],
        false,
        Line::solid(LAMP, 0.25 * shown, 0.6),
    );

    let seconds = left_ms.div_ceil(1000).to_string();
    for side in [Side::South, Side::North] {
        let turn = turn(side);
        let place = |y: f32| centre + Rot2::from_angle(turn) * vec2(0.0, pen.mm(y));
        let write = |y: f32, text: &str, size: f32, strength: f32| {
            lettering::write(
                painter,
                place(y),
                Align2::CENTER_CENTER,
                text,
                pen.mm(size),
                faded(LAMP, strength * shown),
                turn,
            );
        };
        write(31.0, &seconds, 44.0, 1.0);
        ghost::icon(pen, place(RADIUS + 34.0), 40.0, turn, LAMP, 0.9 * shown);
        write(RADIUS + 66.0, words::TOUCH_TO_STAY, 13.0, 0.9);
    }
}
