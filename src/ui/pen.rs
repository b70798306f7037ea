//! Lines, rings and light, in millimetres.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use egui::epaint::{Mesh, PathStroke};
use egui::{Color32, Painter, Pos2, Shape, Stroke, Vec2, vec2};

use super::palette::{PAPER, faded};
use super::sight::Sight;

/// Corners of a circle or ring of light.
const CORNERS: usize = 48;

/// Part of a line's opacity that its paper bed has.
const BED: f32 = 0.42;

/// How much wider than its line the bed is, mm.
const BED_WIDER: f32 = 1.7;

/// Short side of the table that the marks are designed for, mm.
const USUAL_DEPTH: f32 = 680.0;

/// Least and greatest scale of marks for other tables.
const SCALES: (f32, f32) = (0.3, 1.4);

/// How a line looks.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) colour: Color32,
    /// Opacity, 0 to 1.
    pub(super) strength: f32,
    /// Width, mm; never thinner than a pixel.
    pub(super) width: f32,
    /// Length of the dashes and of the gaps between them, mm.
    pub(super) dash: Option<(f32, f32)>,
}

impl Line {
    pub(super) fn solid(colour: Color32, strength: f32, width: f32) -> Self {
        Self {
            colour,
            strength,
            width,
            dash: None,
        }
    }
}

/// A painter that thinks in millimetres.
#[derive(Clone, Copy)]
pub(super) struct Pen<'a> {
    pub(super) painter: &'a Painter,
    pub(super) sight: &'a Sight<'a>,
    /// Millimetres of the table for one of the pen.
    pub(super) scale: f32,
}

impl<'a> Pen<'a> {
    /// A pen for marks of the map: its millimetres are those of a table 680 mm deep, and shrink with smaller ones.
    pub(super) fn new(painter: &'a Painter, sight: &'a Sight<'a>) -> Self {
        Self::at_least(painter, sight, SCALES.0)
    }

    /// A pen for what surrounds a finger, which does not shrink with the table: not below `least`.
    pub(super) fn at_least(painter: &'a Painter, sight: &'a Sight<'a>, least: f32) -> Self {
        let depth = sight.map().size_mm().min_element() as f32 / USUAL_DEPTH;
        let scale = if depth.is_finite() {
            depth.clamp(least, SCALES.1)
        } else {
            1.0
        };
        Self {
            painter,
            sight,
            scale,
        }
    }

    /// Points for `mm` of the pen.
    pub(super) fn mm(&self, mm: f32) -> f32 {
        self.sight.mm(mm * self.scale)
    }

    fn stroke(&self, colour: Color32, strength: f32, width: f32) -> Stroke {
        let thinnest = 1.0 / self.painter.pixels_per_point();
        Stroke::new(self.mm(width).max(thinnest), faded(colour, strength))
    }

    /// A line as it is.
    pub(super) fn line(&self, points: &[Pos2], closed: bool, line: Line) {
        let stroke = self.stroke(line.colour, line.strength, line.width);
        match line.dash {
            None => self.path(points.to_vec(), closed, stroke),
            Some((dash, gap)) => {
                for piece in dashes(points, closed, self.mm(dash), self.mm(gap)) {
                    self.path(piece, false, stroke);
                }
            }
        }
    }

    /// A line of ink on its pale bed, so that it reads on dark slopes and on snow.
    pub(super) fn ink(&self, points: &[Pos2], closed: bool, line: Line) {
        self.bed(points, closed, line);
        self.line(points, closed, line);
    }

    fn bed(&self, points: &[Pos2], closed: bool, line: Line) {
        let bed = Line {
            colour: PAPER,
            strength: line.strength * BED,
            width: line.width + BED_WIDER,
            dash: None,
        };
        self.line(points, closed, bed);
    }

    fn path(&self, points: Vec<Pos2>, closed: bool, stroke: impl Into<PathStroke>) {
        let stroke = stroke.into();
        if points.len() > 1 {
            self.painter.add(if closed {
                Shape::closed_line(points, stroke)
            } else {
                Shape::line(points, stroke)
            });
        }
    }

    /// Fills a convex outline.
    pub(super) fn fill(&self, corners: &[Pos2], colour: Color32, strength: f32) {
        let fill = faded(colour, strength);
        self.painter
            .add(Shape::convex_polygon(corners.to_vec(), fill, Stroke::NONE));
    }

    /// A filled disc of `radius` mm.
    pub(super) fn disc(&self, centre: Pos2, radius: f32, colour: Color32, strength: f32) {
        self.painter
            .circle_filled(centre, self.mm(radius), faded(colour, strength));
    }

    /// A circle of `radius` mm.
    pub(super) fn ring(&self, centre: Pos2, radius: f32, line: Line) {
        match line.dash {
            None => {
                let stroke = self.stroke(line.colour, line.strength, line.width);
                self.painter.circle_stroke(centre, self.mm(radius), stroke);
            }
            Some(_) => self.line(&arc(centre, self.mm(radius), 0.0, TAU)[1..], true, line),
        }
    }

    /// A part of a circle of `radius` mm: from `from` on, `sweep` radians, clockwise from the right.
    pub(super) fn arc(&self, centre: Pos2, radius: f32, from: f32, sweep: f32, line: Line) {
        self.line(&arc(centre, self.mm(radius), from, sweep), false, line);
    }

    /// A ring that is brightest at `radius` mm and fades over `inward` and `outward` mm.
    pub(super) fn glow(&self, centre: Pos2, radius: f32, inward: f32, outward: f32, colour: Color32) {
        let mut mesh = Mesh::default();
        let rims = [
            (radius - inward, Color32::TRANSPARENT),
            (radius, colour),
            (radius + outward, Color32::TRANSPARENT),
        ];
        for corner in 0..=CORNERS {
            let towards = Vec2::angled(corner as f32 / CORNERS as f32 * TAU);
            for (radius, colour) in rims {
                mesh.colored_vertex(centre + towards * self.mm(radius.max(0.0)), colour);
            }
        }
        quads(&mut mesh, CORNERS, rims.len());
        self.painter.add(mesh);
    }

    /// Light or shade that is strongest in the middle and gone at `radius` mm.
    pub(super) fn spot(&self, centre: Pos2, radius: f32, colour: Color32) {
        // The fall of a bell, in three rings.
        let mut mesh = Mesh::default();
        let rims = [(0.0, 1.0), (0.35, 0.72), (0.65, 0.26), (1.0, 0.0)];
        for corner in 0..=CORNERS {
            let towards = Vec2::angled(corner as f32 / CORNERS as f32 * TAU);
            for (at, strength) in rims {
                mesh.colored_vertex(centre + towards * self.mm(radius * at), faded(colour, strength));
            }
        }
        quads(&mut mesh, CORNERS, rims.len());
        self.painter.add(mesh);
    }

    /// A band of light along the inside of a closed outline: `width` mm wide, brightest at the rim.
    pub(super) fn rim_light(&self, outline: &[Pos2], width: f32, colour: Color32) {
        let n = outline.len();
        if n < 3 {
            return;
        }
        let inside = if area(outline) > 0.0 { 1.0 } else { -1.0 } * self.mm(width);
        let mut mesh = Mesh::default();
        for i in 0..=n {
            let (before, at, after) = (outline[(i + n - 1) % n], outline[i % n], outline[(i + 1) % n]);
            let inwards = aside((after - before).normalized()) * inside;
            mesh.colored_vertex(at, colour);
            mesh.colored_vertex(at + inwards, Color32::TRANSPARENT);
        }
        quads(&mut mesh, n, 2);
        self.painter.add(mesh);
    }
}

/// A bar with round ends, `half` its size (points), turned clockwise by `turn`: the bed of letters and sliders.
pub(super) fn bar(centre: Pos2, half: Vec2, turn: f32, colour: Color32, strength: f32) -> Shape {
    let along = Vec2::angled(turn) * (half.x - half.y).max(0.0);
    let mut outline = arc(centre + along, half.y, turn - FRAC_PI_2, PI);
    outline.extend(arc(centre - along, half.y, turn + FRAC_PI_2, PI));
    Shape::convex_polygon(outline, faded(colour, strength), Stroke::NONE)
}

/// Joins `count + 1` rows of `across` vertices to bands.
fn quads(mesh: &mut Mesh, count: usize, across: usize) {
    for row in 0..count {
        for column in 0..across - 1 {
            let corner = (row * across + column) as u32;
            let next = corner + across as u32;
            mesh.add_triangle(corner, corner + 1, next);
            mesh.add_triangle(next, corner + 1, next + 1);
        }
    }
}

/// Twice the area, positive where the outline runs clockwise on the screen.
fn area(outline: &[Pos2]) -> f32 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| a.x * b.y - b.x * a.y).sum()
}

/// Points of a part of a circle, clockwise on the screen.
pub(super) fn arc(centre: Pos2, radius: f32, from: f32, sweep: f32) -> Vec<Pos2> {
    let steps = ((sweep.abs() / TAU * 64.0).ceil() as usize).clamp(2, 128);
    (0..=steps)
        .map(|i| centre + radius * Vec2::angled(from + sweep * i as f32 / steps as f32))
        .collect()
}

/// The dashes of a line: each bends with the line. A closed line has a whole number of them.
fn dashes(points: &[Pos2], closed: bool, dash: f32, gap: f32) -> Vec<Vec<Pos2>> {
    let mut line = points.to_vec();
    if closed && let Some(&first) = points.first() {
        line.push(first);
    }
    let length = length(&line);
    let period = dash + gap;
    if !(length.is_finite() && dash > 0.0 && gap > 0.0 && length / period < 2000.0 && length > 0.0) {
        return vec![line];
    }
    let stretch = if closed {
        length / period / (length / period).round().max(1.0)
    } else {
        1.0
    };
    let (dash, gap) = (dash * stretch, gap * stretch);
    let mut pieces = Vec::new();
    let mut piece = vec![line[0]];
    // What is left of the present dash or gap.
    let (mut drawing, mut left) = (true, dash);
    for pair in line.windows(2) {
        let (mut at, mut ahead) = (pair[0], pair[0].distance(pair[1]));
        let along = (pair[1] - pair[0]).normalized();
        while ahead > left {
            at += along * left;
            ahead -= left;
            if drawing {
                piece.push(at);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![at];
            }
            drawing = !drawing;
            left = if drawing { dash } else { gap };
        }
        left -= ahead;
        if drawing {
            piece.push(pair[1]);
        }
    }
    if drawing {
        pieces.push(piece);
    }
    // Rounding may leave a last one that cannot be seen.
    pieces.retain(|piece| self::length(piece) > 1e-3 * dash);
    pieces
}

/// How long a line is, points.
pub(super) fn length(line: &[Pos2]) -> f32 {
    line.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// `v` turned a quarter clockwise on the screen.
pub(super) fn aside(v: Vec2) -> Vec2 {
    vec2(-v.y, v.x)
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_closed_line_has_whole_dashes_that_bend_round_its_corners() {
        let square = [pos2(0.0, 0.0), pos2(10.0, 0.0), pos2(10.0, 10.0), pos2(0.0, 10.0)];
        let pieces = dashes(&square, true, 3.0, 2.7);
        assert_eq!(pieces.len(), 7);
        for piece in &pieces {
            assert!(
                (length(piece) - 3.0 / 5.7 * 40.0 / 7.0).abs() < 1e-3,
                "{}",
                length(piece)
            );
        }
        assert!(
            pieces.iter().any(|piece| piece.len() == 3),
            "one goes round a corner"
        );
    }

    #[test]
    fn an_open_line_begins_with_a_dash_and_ends_where_it_ends() {
        let line = [pos2(0.0, 0.0), pos2(10.0, 0.0)];
        let pieces = dashes(&line, false, 3.0, 1.0);
        assert_eq!(pieces[0], [pos2(0.0, 0.0), pos2(3.0, 0.0)]);
        assert_eq!(pieces.last().and_then(|p| p.last()), Some(&pos2(10.0, 0.0)));
    }

    #[test]
    fn lines_without_length_or_sense_are_left_as_they_are() {
        for short in [&[][..], &[pos2(1.0, 1.0)]] {
            assert_eq!(dashes(short, false, 1.0, 1.0), [short.to_vec()]);
        }
        assert_eq!(
            dashes(&[pos2(0.0, 0.0), pos2(f32::NAN, 0.0)], false, 1.0, 1.0).len(),
            1
        );
        assert_eq!(
            dashes(&[pos2(0.0, 0.0), pos2(9.0, 0.0)], false, 0.0, 1.0).len(),
            1
        );
    }
}
