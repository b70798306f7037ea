//! Cross-sections: the line on the land, and the sheet on which its side sees what the line cuts.

use egui::emath::Rot2;
use egui::epaint::{Mesh, Shadow};
use egui::{Align2, Color32, CornerRadius, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use glam::DVec2;

use super::ink;
use super::lettering;
use super::palette::{AMBER, BLUE_BLACK, PAPER, VERMILION, faded};
use super::pen::{Line, Pen, aside};
use super::sight::Sight;
use crate::gesture::contact::Side;
use crate::instrument::{Paper, SliceView};
use crate::slice::{Anchor, Band, Figure, Line as Drawn, Role, Text};

/// Least size of letters on a sheet, points.
const SMALLEST: f64 = 11.0;

/// Letters are enlarged by no more than this, or there is no room for them.
const MOST_ENLARGED: f64 = 2.0;

/// Smallest letters of a figure 1600 wide.
const FIGURE_LETTERS: f64 = 14.5;

/// A note that is being typed.
#[derive(Clone, Debug, PartialEq)]
pub struct NoteDraft {
    /// Part of the cross-section's length, 0–1.
    pub at: f64,
    /// What has been typed.
    pub text: String,
}

/// The letter of a side's cross-section.
pub fn letter(side: Side) -> char {
    match side {
        Side::North => 'B',
        Side::South => 'A',
    }
}

/// Size in points of the figure that a sheet has room for.
pub fn figure_size(sight: &Sight<'_>, paper: &Paper) -> DVec2 {
    let margin = f64::from(sight.mm(MARGIN_MM));
    let point = f64::from(sight.mm(1.0));
    let size = 2.0 * paper.half_size_mm - DVec2::new(0.0, paper.strip_mm * STRIP_PART);
    (size * point - 2.0 * margin).max(DVec2::splat(64.0))
}

/// True where letters of a figure so large are read as they are: then layers may be named beside it.
pub fn has_room_for_names(size: DVec2) -> bool {
    FIGURE_LETTERS * size.x / 1600.0 >= 0.8 * SMALLEST
}

/// Part of a cross-section's length (0–1) under a place on its sheet (parts of the sheet's size); `None` beside it.
pub fn part_of_length(sight: &Sight<'_>, paper: &Paper, figure: &Figure, at: DVec2) -> Option<f64> {
    let (left, right) = section(figure)?;
    let x = (at.x - 0.5) * 2.0 * paper.half_size_mm.x * f64::from(sight.mm(1.0)) + figure.size.x / 2.0;
    let part = (x - left) / (right - left);
    (0.0..=1.0).contains(&part).then_some(part)
}

/// Paper around a figure, mm, and the part of the strip that the figure's heading does not share with the controls.
const MARGIN_MM: f32 = 4.0;
const STRIP_PART: f64 = 0.4;

/// Where the section of a figure begins and ends, points from its left edge.
fn section(figure: &Figure) -> Option<(f64, f64)> {
    let ground = figure
        .bands
        .iter()
        .filter(|band| matches!(band.role, Role::Rock(_) | Role::Ground));
    let ends = ground.filter_map(|band| Some((band.top.first()?.x, band.top.last()?.x)));
    ends.filter(|(left, right)| right > left)
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// Where figures lie on a sheet.
#[derive(Clone, Copy)]
struct Lay {
    /// The figure's top left corner on the screen, as its side reads it.
    corner: Pos2,
    turn: f32,
    strength: f32,
}

impl Lay {
    fn place(&self, p: DVec2) -> Pos2 {
        self.corner + Rot2::from_angle(self.turn) * vec2(p.x as f32, p.y as f32)
    }
}

/// What is on a sheet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sheet<'a> {
    /// The drawn cross-section, without a heading.
    pub figure: Option<&'a Figure>,
    /// Its heading, beside the controls: length and exaggeration.
    pub facts: &'a str,
    /// A note that is being typed.
    pub draft: Option<&'a NoteDraft>,
}

/// Draws a sheet with `strength` (0 to 1) of its opacity.
pub fn draw_sheet(painter: &Painter, sight: &Sight<'_>, paper: &Paper, sheet: &Sheet<'_>, strength: f32) {
    let corners = [-1.0, 1.0].map(|end| sight.of_table(paper.centre_mm + paper.half_size_mm * end));
    let [Some(least), Some(most)] = corners else {
        return;
    };
    let rect = Rect::from_min_max(least, most);
    let radius = CornerRadius::same(sight.mm(2.0) as u8);
    let shadow = Shadow {
        offset: [0, sight.mm(2.0) as i8],
        blur: sight.mm(9.0) as u8,
        spread: 0,
        color: faded(Color32::BLACK, 0.45 * strength),
    };
    painter.add(shadow.as_shape(rect, radius));
    let ground = sheet.figure.map_or(PAPER, |figure| colour(figure.paper));
    painter.rect_filled(rect, radius, faded(ground, strength));
    let Some(figure) = sheet.figure else { return };
    let turn = paper.rotation as f32;
    let strip = sight.mm(paper.strip_mm as f32);
    let start = vec2(
        sight.mm(2.0 * MARGIN_MM) - rect.width() / 2.0,
        (strip - rect.height()) / 2.0,
    );
    lettering::write(
        painter,
        rect.center() + Rot2::from_angle(turn) * start,
        Align2::LEFT_CENTER,
        sheet.facts,
        (0.3 * strip).max(SMALLEST as f32),
        faded(BLUE_BLACK, strength),
        turn,
    );
    let room = rect.size() - vec2(0.0, strip * STRIP_PART as f32);
    // The figure stands at the foot of the sheet; what it leaves free is above it.
    let free = (room.y - sight.mm(2.0 * MARGIN_MM) - figure.size.y as f32).max(0.0) * 0.5;
    let from_centre = vec2(
        -figure.size.x as f32 / 2.0,
        rect.height() / 2.0 - sight.mm(MARGIN_MM) - free - figure.size.y as f32,
    );
    let lay = Lay {
        corner: rect.center() + Rot2::from_angle(turn) * from_centre,
        turn,
        strength,
    };
    let painter = painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    for shown in &figure.bands {
        painter.add(band(shown, lay));
    }
    for shown in &figure.lines {
        line(&painter, shown, lay);
    }
    letters(&painter, figure, lay);
    if let (Some(draft), Some((left, right))) = (sheet.draft, section(figure)) {
        typed(
            &painter,
            figure,
            lay,
            left + (right - left) * draft.at,
            &draft.text,
        );
    }
}

/// An area between two lines, as triangles.
fn band(band: &Band, lay: Lay) -> Shape {
    let fill = faded(colour(band.colour), lay.strength);
    let mut mesh = Mesh::default();
    for (top, bottom) in band.top.iter().zip(&band.bottom) {
        mesh.colored_vertex(lay.place(*top), fill);
        mesh.colored_vertex(lay.place(*bottom), fill);
    }
    for column in 1..(mesh.vertices.len() / 2) as u32 {
        let corner = 2 * column - 2;
        mesh.add_triangle(corner, corner + 1, corner + 2);
        mesh.add_triangle(corner + 1, corner + 2, corner + 3);
    }
    Shape::mesh(mesh)
}

fn line(painter: &Painter, line: &Drawn, lay: Lay) {
    let width = (line.width as f32).max(0.75);
    let stroke = Stroke::new(width, faded(colour(line.colour), lay.strength));
    let points: Vec<Pos2> = line.points.iter().map(|&p| lay.place(p)).collect();
    match line.dash {
        Some([dash, gap]) => painter.extend(Shape::dashed_line(
            &points,
            stroke,
            (dash as f32).max(2.0),
            (gap as f32).max(2.0),
        )),
        None => {
            painter.add(Shape::line(points, stroke));
        }
    }
}

/// Letters are no smaller than they can be read. Where that leaves no room for all, the larger ones stay.
fn letters(painter: &Painter, figure: &Figure, lay: Lay) {
    let smallest = figure
        .texts
        .iter()
        .map(|text| text.size)
        .fold(f64::INFINITY, f64::min);
    let enlarged = (SMALLEST / smallest).clamp(1.0, MOST_ENLARGED);
    let mut order: Vec<&Text> = figure.texts.iter().collect();
    order.sort_by(|a, b| b.size.total_cmp(&a.size));
    let mut taken: Vec<Rect> = Vec::new();
    for text in order {
        let size = (text.size * enlarged) as f32;
        let half = lettering::width(painter, &text.text, size) / 2.0;
        let (x, y) = (text.at.x as f32, text.at.y as f32);
        let middle = match text.anchor {
            Anchor::Start => x + half,
            Anchor::Middle => x,
            Anchor::End => x - half,
        };
        // Ends of axes must not run off the sheet.
        let most = (figure.size.x as f32 - half).max(half);
        let middle = middle.clamp(half, most);
        let place = Rect::from_center_size(Pos2::new(middle, y - 0.36 * size), vec2(2.0 * half, size));
        if taken.iter().any(|other| other.intersects(place)) {
            continue;
        }
        taken.push(place);
        let at = lay.place(DVec2::new(
            f64::from(place.center().x),
            f64::from(place.center().y),
        ));
        let ink = faded(colour(text.colour), lay.strength);
        lettering::write(
            painter,
            at,
            Align2::CENTER_CENTER,
            &text.text,
            size,
            ink,
            lay.turn,
        );
    }
}

/// A note that is being typed over a place along the section.
fn typed(painter: &Painter, figure: &Figure, lay: Lay, x: f64, text: &str) {
    let size = 1.4 * SMALLEST as f32;
    let shown = format!("{text}|");
    let half = lettering::width(painter, &shown, size) / 2.0;
    let y = figure.size.y * 0.3;
    let (head, foot) = (
        lay.place(DVec2::new(x, y)),
        lay.place(DVec2::new(x, figure.size.y * 0.75)),
    );
    painter.line_segment([head, foot], Stroke::new(1.0, VERMILION));
    let most = (figure.size.x as f32 - half).max(half);
    let middle = DVec2::new(f64::from((x as f32).clamp(half, most)), y);
    let at = lay.place(middle);
    let bed = Rect::from_center_size(at, vec2(2.0 * half + size, 1.6 * size));
    painter.rect_filled(bed, 3.0, PAPER);
    painter.rect_stroke(bed, 3.0, Stroke::new(1.0, VERMILION), egui::StrokeKind::Inside);
    lettering::write(
        painter,
        at,
        Align2::CENTER_CENTER,
        &shown,
        size,
        BLUE_BLACK,
        lay.turn,
    );
}

fn colour([red, green, blue]: crate::rock::Colour) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// Draws the lines of cross-sections on the land, with their letters, and their handles where they have some.
pub fn draw_lines(
    painter: &Painter,
    sight: &Sight<'_>,
    slices: impl Iterator<Item = SliceView>,
    strength: f32,
) {
    const LETTER_MM: f32 = 11.0;
    let pen = Pen::new(painter, sight);
    let strong = Line::solid(BLUE_BLACK, 0.95 * strength, 1.5);
    for slice in slices {
        let plan = slice.ends.map(|end| sight.map().to_plan(end));
        if slice.whole {
            let line = if slice.frozen {
                Line {
                    dash: Some((7.0, 3.0)),
                    ..strong
                }
            } else {
                strong
            };
            for stretch in sight.line(&plan) {
                pen.ink(&stretch, false, line);
            }
        }
        let places = plan.map(|end| sight.of_plan(end));
        for (end, at) in places.into_iter().enumerate() {
            let Some(at) = at else { continue };
            if end == 1 && !slice.whole {
                continue;
            }
            let outwards = match places[1 - end] {
                Some(other) if other.distance(at) > 1.0 => (at - other).normalized(),
                _ => Vec2::new(-1.0, 0.0),
            };
            if slice.handles {
                let near = if slice.held[end] { 1.0 } else { 0.25 };
                ink::handle(pen, at, near, strength);
            } else {
                let tick = aside(outwards) * pen.mm(4.0);
                pen.ink(&[at - tick, at + tick], false, strong);
            }
            let letter = letter(slice.side);
            let name = if end == 0 {
                letter.to_string()
            } else {
                format!("{letter}'")
            };
            let beside = at + outwards * pen.mm(if slice.handles { 22.0 } else { 14.0 });
            pen.disc(beside, 8.0, PAPER, 0.82 * strength);
            lettering::write(
                painter,
                beside,
                Align2::CENTER_CENTER,
                &name,
                pen.mm(LETTER_MM).max(SMALLEST as f32),
                faded(if slice.handles { VERMILION } else { BLUE_BLACK }, strength),
                lettering::turn(slice.side),
            );
            if !slice.whole {
                // It waits for the other end.
                pen.ring(at, 13.0, Line::solid(AMBER, 0.8 * strength, 1.2));
            }
        }
    }
}
