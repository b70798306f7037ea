//! Where the controls are: a row along each long side, turned towards it, and beside it the sheet of the side's
//! cross-section.

use std::f64::consts::PI;

use glam::DVec2;

use super::control::{ControlId, ControlKind, Paper};
use crate::gesture::command::Tool;
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

/// The sheet of a cross-section beside the row: least part of the table's width, part of its height, most height (mm),
/// most width for its height. What is more is out of a seated visitor's sight.
const LEAST_PAPER: f64 = 0.2;
const PAPER_PART: f64 = 0.3;
const MOST_PAPER_MM: f64 = 420.0;
const MOST_ASPECT: f64 = 2.2;

/// Parts of the table that the sheet takes behind the row.
const BEHIND: DVec2 = DVec2::new(0.72, 0.2);

/// Gap around the controls in the sheet's strip, in sizes of a control.
const STRIP_GAP: f64 = 0.2;

/// Controls from left to right, as the side reads them, in groups. [`ControlKind::Scrub`] lies behind them.
const GROUPS: [&[ControlKind]; 3] = [
    &[
        ControlKind::Tool(Tool::Edit),
        ControlKind::Tool(Tool::Fold),
        ControlKind::Tool(Tool::Slice),
        ControlKind::Tool(Tool::Land),
        ControlKind::Tool(Tool::Sea),
        ControlKind::Undo,
    ],
    &[ControlKind::PlayPause, ControlKind::Speed],
    &[
        ControlKind::StartOver,
        ControlKind::Readouts,
        ControlKind::Save,
        ControlKind::Final,
        ControlKind::World,
    ],
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

/// Controls and sheets of both sides of a table.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// North side first.
    pub(super) placed: Vec<Placed>,
    /// Of the north and the south side.
    pub(super) papers: [Paper; 2],
}

/// The controls of both sides of a table of `size_mm`, as far as they are `offered`.
pub(super) fn layout(size_mm: DVec2, offered: impl Fn(ControlKind) -> bool) -> Layout {
    let groups: Vec<Vec<ControlKind>> = GROUPS
        .iter()
        .map(|group| group.iter().copied().filter(|&kind| offered(kind)).collect())
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
    if offered(ControlKind::Scrub) {
        south.push((
            ControlKind::Scrub,
            DVec2::new(size_mm.x / 2.0, y - (1.0 + GAP) * size),
            DVec2::new(SLIDER * size / 2.0, size / 2.0),
        ));
    }
    let paper = south_paper(size_mm, size, row * size);
    // In the sheet's strip, from its right end.
    let strip_y = paper.centre_mm.y - paper.half_size_mm.y + paper.strip_mm / 2.0;
    let right = paper.centre_mm.x + paper.half_size_mm.x - STRIP_GAP * size;
    for (place, kind) in [ControlKind::CloseSlice, ControlKind::FreezeSlice]
        .into_iter()
        .enumerate()
        .filter(|&(_, kind)| offered(kind))
    {
        let from_right = (0.5 + place as f64 * (1.0 + GAP)) * size;
        south.push((kind, DVec2::new(right - from_right, strip_y), half));
    }
    let turned = |side, at| match side {
        Side::North => size_mm - at,
        Side::South => at,
    };
    let mut placed = Vec::new();
    for side in [Side::North, Side::South] {
        for &(kind, at, half) in &south {
            placed.push(Placed {
                id: ControlId(side, kind),
                centre: turned(side, at),
                half,
                size,
            });
        }
    }
    let papers = [(Side::North, PI), (Side::South, 0.0)].map(|(side, rotation)| Paper {
        side,
        centre_mm: turned(side, paper.centre_mm),
        rotation,
        ..paper
    });
    Layout { placed, papers }
}

/// The sheet of the south side, for controls of `size` in a row of `row` mm: to the left of the row, where nobody who
/// stands at the controls leans; on narrow tables behind the row and the slider.
fn south_paper(size_mm: DVec2, size: f64, row: f64) -> Paper {
    let gap = EDGE_GAP * size;
    let beside = (size_mm.x - row) / 2.0 - GROUP_GAP * size - gap;
    let (half, centre) = if beside >= LEAST_PAPER * size_mm.x {
        let height = (PAPER_PART * size_mm.y).min(MOST_PAPER_MM);
        let width = beside.min(MOST_ASPECT * height);
        let half = DVec2::new(width, height) / 2.0;
        let right = gap + beside;
        (half, DVec2::new(right - half.x, size_mm.y - gap - half.y))
    } else {
        let half = size_mm * BEHIND / 2.0;
        let bottom = size_mm.y - gap - (2.0 + 2.0 * GAP) * size;
        (half, DVec2::new(size_mm.x / 2.0, bottom - half.y))
    };
    Paper {
        side: Side::South,
        centre_mm: centre,
        half_size_mm: half,
        strip_mm: (1.0 + 2.0 * STRIP_GAP) * size,
        rotation: 0.0,
    }
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
            for (unattended, globe) in [(false, false), (true, false), (false, true)] {
                let Layout { placed, papers } = layout(size_mm, |kind| match kind {
                    ControlKind::Tool(tool) => tool.paint().is_some() == globe,
                    ControlKind::Save | ControlKind::Final => !unattended && !globe,
                    _ => true,
                });
                for paper in papers {
                    let corner = paper.centre_mm - paper.half_size_mm;
                    assert!(corner.min_element() >= 0.0, "{size_mm}");
                    assert!((size_mm - paper.centre_mm - paper.half_size_mm).min_element() >= 0.0);
                    for corner in [corner, paper.centre_mm + paper.half_size_mm] {
                        assert_eq!(Side::of(corner, size_mm), paper.side, "{paper:?} on {size_mm}");
                    }
                    for control in &placed {
                        let on_it =
                            matches!(control.id.1, ControlKind::FreezeSlice | ControlKind::CloseSlice)
                                && control.id.0 == paper.side;
                        let gap =
                            (control.centre - paper.centre_mm).abs() - control.half - paper.half_size_mm;
                        let within = (gap + 2.0 * control.half).max_element() <= 1e-9;
                        assert_eq!(within, on_it, "{:?} on {size_mm}", control.id);
                        assert!(on_it || gap.max_element() > 0.0, "{:?} on {size_mm}", control.id);
                    }
                }
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
        let Layout { placed, papers } = layout(size_mm, |_| true);
        assert!((papers[0].centre_mm + papers[1].centre_mm - size_mm).length() < 1e-9);
        let corner = papers[0].centre_mm + papers[0].half_size_mm;
        assert!(
            papers[0].part(corner).length() < 1e-9,
            "the north reads it turned"
        );
        let (north, south) = placed.split_at(placed.len() / 2);
        for (n, s) in north.iter().zip(south) {
            assert_eq!(n.id.1, s.id.1);
            assert!((n.centre + s.centre - size_mm).length() < 1e-9);
            let offset = DVec2::new(0.3 * s.half.x, 0.0);
            assert!((s.along(s.centre + offset) - n.along(n.centre - offset)).abs() < 1e-12);
        }
        let at = |kind| south.iter().find(|p| p.id.1 == kind).unwrap().centre.x;
        assert!(
            at(ControlKind::Tool(Tool::Edit)) < at(ControlKind::Undo),
            "read from left to right"
        );
        assert!(at(ControlKind::PlayPause) < at(ControlKind::StartOver));
    }

    #[test]
    fn what_is_not_offered_is_not_there() {
        let fold = ControlKind::Tool(Tool::Fold);
        let all = layout(DVec2::new(1209.6, 680.4), |_| true).placed;
        let fewer = layout(DVec2::new(1209.6, 680.4), |kind| kind != fold).placed;
        assert_eq!(all.len(), fewer.len() + 2);
        assert!(fewer.iter().all(|placed| placed.id.1 != fold));
    }
}
