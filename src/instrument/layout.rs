//! Where the controls are: a row along each long side, turned towards it.

use std::f64::consts::PI;

use glam::DVec2;

use super::control::{ControlId, ControlKind};
use crate::gesture::contact::Side;
use crate::settings::CORNER_MM;

/// Least size of a control, mm, on tables whose short side is 250 mm or more (F of the WCAG on a table: 20 mm).
const LEAST_MM: f64 = 20.0;

/// Size of a control past which it is no easier to hit, mm.
const MOST_MM: f64 = 34.0;

/// Size of a control on no table is less, mm: what a finger hits with care, on a laptop's touchscreen.
const FLOOR_MM: f64 = 9.0;

/// Size of a control as a part of the table's short side, between the two above.
const PART: f64 = 0.044;

/// On small tables a control takes no more than this part of the short side.
const MOST_PART: f64 = 0.08;

/// Gaps, in sizes of a control: between neighbours, between groups, to the edge. 8 mm are 0.4 of the least size.
const GAP: f64 = 0.4;
const GROUP_GAP: f64 = 0.9;
const EDGE_GAP: f64 = 0.5;

/// How far around a control a contact that lands is taken for it, and one that slides is still on it, in sizes of a
/// control: a bit more than half of the gap between groups, and between neighbours.
const TAKES: f64 = 0.46;
const HOLDS: f64 = 0.21;

/// Length of the slider, in sizes of a control.
const SLIDER: f64 = 11.0;

/// Controls from left to right, as the side reads them, in groups. [`ControlKind::Scrub`] lies behind them.
const GROUPS: [&[ControlKind]; 3] = [
    &[ControlKind::Tool, ControlKind::Undo],
    &[ControlKind::PlayPause, ControlKind::Speed],
    &[ControlKind::StartOver, ControlKind::Readouts, ControlKind::Save],
];

/// A control in its place, table mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub(super) id: ControlId,
    pub(super) centre: DVec2,
    pub(super) half: DVec2,
    /// Its size, from which gaps are measured.
    size: f64,
}

impl Placed {
    /// True where a contact that lands may mean this control, if none is nearer: nobody sculpts between two of them.
    pub(super) fn takes(&self, place: DVec2) -> bool {
        self.past(place) <= TAKES * self.size
    }

    /// True where a contact is still on it.
    pub(super) fn holds(&self, place: DVec2) -> bool {
        self.past(place) <= HOLDS * self.size
    }

    fn past(&self, place: DVec2) -> f64 {
        ((place - self.centre).abs() - self.half).max_element()
    }

    /// Distance of a place from its edge, mm; 0 inside.
    pub(super) fn distance(&self, place: DVec2) -> f64 {
        let past = (place - self.centre).abs() - self.half;
        past.max(DVec2::ZERO).length()
    }

    /// Clockwise angle at which it is read.
    pub(super) fn rotation(&self) -> f64 {
        match self.id.0 {
            Side::North => PI,
            Side::South => 0.0,
        }
    }

    /// Where along it a place is, 0–1 from left to right as its side reads it.
    pub(super) fn along(&self, place: DVec2) -> f64 {
        let part = (place.x - self.centre.x) / (2.0 * self.half.x);
        let towards = if self.id.0 == Side::North { -part } else { part };
        (towards + 0.5).clamp(0.0, 1.0)
    }
}

/// The controls of both sides of a table of `size_mm`; `save` is left out on unattended tables.
pub(super) fn layout(size_mm: DVec2, unattended: bool) -> Vec<Placed> {
    let groups: Vec<Vec<ControlKind>> = GROUPS
        .iter()
        .map(|group| {
            let kinds = group.iter().copied();
            kinds
                .filter(|kind| !(unattended && *kind == ControlKind::Save))
                .collect()
        })
        .collect();
    let kinds = groups.iter().map(Vec::len).sum::<usize>() as f64;
    let gaps = (groups.len() - 1) as f64;
    // Length of the row, in sizes of a control.
    let row = kinds + (kinds - 1.0 - gaps) * GAP + gaps * GROUP_GAP;
    let short = size_mm.min_element();
    let room = (size_mm.x - 2.0 * CORNER_MM.min(0.2 * size_mm.x)) / row.max(SLIDER);
    let size = (PART * short)
        .clamp(LEAST_MM, MOST_MM)
        .min(MOST_PART * short)
        .min(room)
        .max(FLOOR_MM);
    let half = DVec2::splat(size / 2.0);
    let mut south = Vec::new();
    let mut x = (size_mm.x - row * size) / 2.0 + size / 2.0;
    let y = size_mm.y - EDGE_GAP * size - size / 2.0;
    for group in &groups {
        for &kind in group {
            south.push((kind, DVec2::new(x, y), half));
            x += (1.0 + GAP) * size;
        }
        x += (GROUP_GAP - GAP) * size;
    }
    south.push((
        ControlKind::Scrub,
        DVec2::new(size_mm.x / 2.0, y - (1.0 + GAP) * size),
        DVec2::new(SLIDER * size / 2.0, size / 2.0),
    ));
    let mut placed = Vec::new();
    for side in [Side::North, Side::South] {
        for &(kind, at, half) in &south {
            let centre = match side {
                Side::North => size_mm - at,
                Side::South => at,
            };
            placed.push(Placed {
                id: ControlId(side, kind),
                centre,
                half,
                size,
            });
        }
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Corner;

    /// A phone-sized window, laptops, screens, tables, a wall, and a window that is higher than wide.
    const TABLES: [(f64, f64); 8] = [
        (200.0, 112.5),
        (300.0, 169.0),
        (344.0, 194.0),
        (600.0, 340.0),
        (1209.6, 680.4),
        (2000.0, 1125.0),
        (5000.0, 2800.0),
        (500.0, 900.0),
    ];

    #[test]
    fn controls_are_large_apart_within_reach_and_on_the_table() {
        for (width, height) in TABLES {
            let size_mm = DVec2::new(width, height);
            for unattended in [false, true] {
                let placed = layout(size_mm, unattended);
                let least = if size_mm.min_element() >= 250.0 {
                    LEAST_MM
                } else {
                    FLOOR_MM
                };
                for (i, a) in placed.iter().enumerate() {
                    let size = 2.0 * a.half.min_element();
                    assert!(size >= least - 1e-9, "{:?} of {size} mm on {size_mm}", a.id);
                    assert!((a.centre - a.half).min_element() >= 0.0);
                    assert!(
                        (size_mm - a.centre - a.half).min_element() >= 0.0,
                        "{:?} on {size_mm}",
                        a.id
                    );
                    let from_edge = match a.id.0 {
                        Side::North => a.centre.y + a.half.y,
                        Side::South => size_mm.y - a.centre.y + a.half.y,
                    };
                    assert!(from_edge <= 610.0);
                    assert_eq!(Side::of(a.centre, size_mm), a.id.0);
                    for (_, corner) in Corner::ALL {
                        let nearest = corner
                            .position(size_mm)
                            .clamp(a.centre - a.half, a.centre + a.half);
                        assert!(
                            !corner.holds(nearest, size_mm),
                            "{:?} in the corner of {size_mm}",
                            a.id
                        );
                    }
                    for b in &placed[i + 1..] {
                        let gap = ((a.centre - b.centre).abs() - a.half - b.half).max_element();
                        assert!(
                            gap >= GAP * size - 1e-9,
                            "{:?} {:?}: {gap} mm on {size_mm}",
                            a.id,
                            b.id
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_north_row_is_the_south_row_turned_half_round() {
        let size_mm = DVec2::new(1209.6, 680.4);
        let placed = layout(size_mm, false);
        let (north, south) = placed.split_at(placed.len() / 2);
        for (n, s) in north.iter().zip(south) {
            assert_eq!(n.id.1, s.id.1);
            assert!((n.centre + s.centre - size_mm).length() < 1e-9);
            let offset = DVec2::new(0.3 * s.half.x, 0.0);
            assert!((s.along(s.centre + offset) - n.along(n.centre - offset)).abs() < 1e-12);
        }
        let at = |kind| south.iter().find(|p| p.id.1 == kind).unwrap().centre.x;
        assert!(
            at(ControlKind::Tool) < at(ControlKind::Undo),
            "read from left to right"
        );
        assert!(at(ControlKind::PlayPause) < at(ControlKind::StartOver));
    }

    #[test]
    fn unattended_tables_have_no_save() {
        let has = |unattended| {
            layout(DVec2::new(1209.6, 680.4), unattended)
                .iter()
                .any(|p| p.id.1 == ControlKind::Save)
        };
        assert!(has(false) && !has(true));
    }
}
