//! The ink on a planet: borders of plates by what happens there, where plates go, what hands hold, and the legend.

use std::collections::BTreeMap;

use egui::{Align2, Color32, Painter, Pos2};
use glam::{DQuat, DVec2, DVec3, Vec3};

use super::lettering;
use super::palette::{AMBER, LAMP, ROOM, faded};
use super::pen::{Line, Pen};
use super::sight::Sight;
use super::words;
use crate::gesture::contact::Side;
use crate::live::{Clock, GlobeFrame};
use crate::surface::planet::{BorderKind, Grip, Planet};
use crate::units::MYR;

/// Sea floor is born.
const RIDGE: Color32 = Color32::from_rgb(255, 178, 102);
/// A plate goes down.
const SUBDUCTION: Color32 = Color32::from_rgb(236, 92, 62);
/// Continents meet.
const COLLISION: Color32 = Color32::from_rgb(214, 128, 196);
/// They slide.
const TRANSFORM: Color32 = Color32::from_rgb(214, 220, 226);

/// All kinds, in the order of the legend.
const KINDS: [BorderKind; 4] = [
    BorderKind::Ridge,
    BorderKind::Subduction,
    BorderKind::Collision,
    BorderKind::Transform,
];

/// How often a border's corners are drawn half-way to the middle of their neighbours: the samples no longer show.
const SMOOTHINGS: usize = 3;
/// Pieces of a border from one tooth to the next.
const TOOTH_PIECES: usize = 5;
/// Places where arrows may begin, spread evenly, and the time that an arrow tells, My.
const ARROWS: usize = 130;
const ARROW_MY: f64 = 12.0;
/// Shortest arrow, radians.
const SHORTEST_ARROW: f64 = 0.035;
/// Places along an arrow.
const ARROW_PIECES: u32 = 6;
/// Parts of the disc's radius beyond which marks fade towards the limb.
const LIMB: f64 = 0.28;

/// Time in which the mark of a tap fades, s.
const TAP_S: f64 = 3.0;

/// Least letters of the legend, points, and their size, mm.
const SMALLEST: f32 = 11.0;
const LETTERS: f32 = 7.0;
/// Distance of the legend from the table's edges, mm, and from line to line.
const MARGIN: DVec2 = DVec2::new(12.0, 12.0);
const LINE_MM: f32 = 10.5;
/// Length of a sample of a border, mm.
const SAMPLE_MM: f32 = 16.0;

/// A line along one kind of border.
#[derive(Clone, Debug)]
struct Piece {
    ends: [Vec3; 2],
    kind: BorderKind,
    /// Where the teeth of a plate that lies on top point to.
    tooth: Option<Vec3>,
}

/// What is drawn of a planet, worked out once for each.
#[derive(Clone, Debug, Default)]
pub struct GlobeChart {
    land: Option<u64>,
    borders: Vec<Piece>,
    /// From where to where, unit vectors, and whether a hand is the cause.
    arrows: Vec<(Vec<Vec3>, bool)>,
}

impl GlobeChart {
    /// Takes over what the session shows.
    pub fn follow(&mut self, frame: &GlobeFrame) {
        if self.land == Some(frame.land) {
            return;
        }
        self.land = Some(frame.land);
        self.borders = borders(&frame.planet);
        self.arrows = arrows(&frame.planet);
    }

    /// Draws borders and arrows. `strength` is their opacity, 0 to 1.
    pub fn draw(&self, painter: &Painter, sight: &Sight<'_>, frame: &GlobeFrame, strength: f32) {
        let pen = Pen::new(painter, sight);
        let eye = frame.view.orientation().as_quat();
        let at = |place: Vec3| {
            let depth = f64::from((eye * place).z);
            let mm = frame.view.project(place.as_dvec3())?;
            Some((sight.of_table(mm)?, (depth / LIMB).clamp(0.0, 1.0) as f32))
        };
        for piece in &self.borders {
            let [Some((from, near)), Some((to, _))] = piece.ends.map(at) else {
                continue;
            };
            let (colour, width, dash) = ink(piece.kind);
            pen.line(
                &[from, to],
                false,
                Line {
                    colour,
                    strength: 0.9 * strength * near,
                    width,
                    dash,
                },
            );
            if let Some((tip, _)) = piece.tooth.and_then(at) {
                pen.fill(&[from, to, tip], colour, 0.9 * strength * near);
            }
        }
        for (way, led) in &self.arrows {
            let seen: Vec<(Pos2, f32)> = way.iter().filter_map(|&place| at(place)).collect();
            if seen.len() < way.len() {
                continue;
            }
            let near = seen.iter().map(|&(_, near)| near).fold(1.0, f32::min);
            let points: Vec<Pos2> = seen.into_iter().map(|(point, _)| point).collect();
            let (colour, bright) = if *led { (AMBER, 0.95) } else { (LAMP, 0.5) };
            arrow(pen, &points, colour, bright * strength * near);
        }
    }
}

/// Marks of taps, and lines from the places that hands hold to the hands.
pub fn draw_tethers(painter: &Painter, sight: &Sight<'_>, frame: &GlobeFrame) {
    let pen = Pen::new(painter, sight);
    let at = |place: DVec3| frame.view.project(place).and_then(|mm| sight.of_table(mm));
    for tap in &frame.taps {
        if let Some(place) = at(tap.at) {
            let strength = 1.0 - (tap.age_s / TAP_S).clamp(0.0, 1.0) as f32;
            pen.ring(place, 5.0, Line::solid(LAMP, strength, 0.9));
        }
    }
    for tether in &frame.tethers {
        let (Some(held), Some(hand)) = (at(tether.held), at(tether.finger)) else {
            continue;
        };
        pen.line(&[held, hand], false, Line::solid(ROOM, 0.5, 2.6));
        pen.line(&[held, hand], false, Line::solid(AMBER, 0.95, 1.1));
        pen.disc(held, 3.4, ROOM, 0.5);
        pen.disc(held, 2.4, AMBER, 1.0);
    }
}

/// Draws the legend of a side at the left end of its edge: time and speed, and what the borders mean; with `figures` (0 to
/// 1) also what is counted.
pub fn draw_legend(painter: &Painter, sight: &Sight<'_>, frame: &GlobeFrame, side: Side, figures: f32) {
    let pen = Pen::new(painter, sight);
    let size_mm = sight.map().size_mm();
    let scale = f64::from(pen.scale);
    let turn = lettering::turn(side);
    let size = pen.mm(LETTERS).max(SMALLEST);
    let line_mm = f64::from(LINE_MM) * scale.max(f64::from(size / pen.mm(LETTERS)) * scale);
    let put = |right_mm: f64, row: f64| {
        let at = DVec2::new(
            MARGIN.x * scale + right_mm,
            size_mm.y - MARGIN.y * scale - (row + 0.5) * line_mm,
        );
        sight.of_table(if side == Side::North { size_mm - at } else { at })
    };
    let write = |text: &str, right_mm: f64, row: f64, strength: f32| {
        if let Some(at) = put(right_mm, row) {
            let colour = faded(LAMP, strength);
            lettering::write(painter, at, Align2::LEFT_CENTER, text, size, colour, turn);
        }
    };
    let sample_mm = f64::from(SAMPLE_MM) * scale;
    for (row, kind) in KINDS.into_iter().rev().enumerate() {
        let row = row as f64;
        let (colour, width, dash) = ink(kind);
        if let (Some(from), Some(to)) = (put(0.0, row), put(sample_mm, row)) {
            let strength = 0.95;
            let line = Line {
                colour,
                strength,
                width: width * 1.3,
                dash,
            };
            pen.line(&[from, to], false, line);
            if kind == BorderKind::Subduction {
                let middle = put(0.3 * sample_mm, row).zip(put(0.7 * sample_mm, row));
                let tip = put(0.5 * sample_mm, row + 0.3);
                if let (Some((a, b)), Some(tip)) = (middle, tip) {
                    pen.fill(&[a, b, tip], colour, strength);
                }
            }
        }
        write(words::border(kind), sample_mm * 1.35, row, 0.8);
    }
    write(&time(&frame.clock), 0.0, 4.3, 0.95);
    if figures > 0.0 {
        write(&counted(&frame.planet), 0.0, 5.4, 0.8 * figures);
    }
}

/// Time and speed.
fn time(clock: &Clock) -> String {
    let at = format!("{:.0} {}", clock.elapsed_yr / MYR, words::MY);
    if clock.paused {
        format!("{at}   {}", words::PAUSED)
    } else {
        format!("{at}   {} {}/s", clock.pace_yr_per_s / MYR, words::MY)
    }
}

/// Plates, and how much is land.
fn counted(planet: &Planet) -> String {
    let areas = planet.lattice.areas();
    let land: f64 = areas
        .iter()
        .zip(&planet.elevation_m)
        .filter(|(_, elevation)| **elevation > 0.0)
        .map(|(area, _)| area)
        .sum();
    let part = land / (4.0 * std::f64::consts::PI);
    format!("{} plates   {:.0} % land", planet.plates.len(), part * 100.0)
}

/// Colour, width (mm) and dashes (mm) of a border.
fn ink(kind: BorderKind) -> (Color32, f32, Option<(f32, f32)>) {
    match kind {
        BorderKind::Ridge => (RIDGE, 1.0, None),
        BorderKind::Subduction => (SUBDUCTION, 1.2, None),
        BorderKind::Collision => (COLLISION, 1.7, None),
        BorderKind::Transform => (TRANSFORM, 0.7, Some((2.0, 1.6))),
    }
}

fn arrow(pen: Pen<'_>, points: &[Pos2], colour: Color32, strength: f32) {
    let [.., before, tip] = points else { return };
    pen.line(points, false, Line::solid(colour, strength, 0.9));
    let ahead = (*tip - *before).normalized() * pen.mm(3.6);
    let across = ahead.rot90() * 0.42;
    pen.fill(
        &[
            *tip + ahead * 0.4,
            *tip - ahead * 0.6 + across,
            *tip - ahead * 0.6 - across,
        ],
        colour,
        strength,
    );
}

/// The planet's borders without the corners of its samples.
fn borders(planet: &Planet) -> Vec<Piece> {
    // Pieces that meet have the same end, to the bit or nearly.
    let mut names: BTreeMap<[i32; 3], usize> = BTreeMap::new();
    let mut corners: Vec<Vec3> = Vec::new();
    let mut ends = Vec::with_capacity(planet.borders.len());
    for border in &planet.borders {
        ends.push(border.ends.map(|end| {
            let key = (end * 1e5).round().as_ivec3().to_array();
            *names.entry(key).or_insert_with(|| {
                corners.push(end);
                corners.len() - 1
            })
        }));
    }
    for _ in 0..SMOOTHINGS {
        let mut sums = vec![(Vec3::ZERO, 0_u32); corners.len()];
        for &[a, b] in &ends {
            sums[a].0 += corners[b];
            sums[a].1 += 1;
            sums[b].0 += corners[a];
            sums[b].1 += 1;
        }
        for (corner, (sum, count)) in corners.iter_mut().zip(sums) {
            // Where a line ends it stays.
            if count > 1 {
                *corner = corner.lerp(sum / count as f32, 0.5).normalize();
            }
        }
    }
    let spacing = planet.lattice.spacing() as f32;
    let pieces = planet.borders.iter().zip(ends).enumerate();
    pieces
        .map(|(i, (border, ends))| {
            let ends = ends.map(|end| corners[end]);
            let toothed = border.kind == BorderKind::Subduction && i % TOOTH_PIECES == 0;
            let tooth = toothed.then(|| {
                let above = planet.lattice.point(border.samples[0]).as_vec3();
                let middle = (ends[0] + ends[1]) * 0.5;
                let along = (ends[1] - ends[0]).normalize_or_zero();
                let towards = (above - middle)
                    .reject_from(along)
                    .reject_from(middle.normalize());
                (middle + towards.normalize_or_zero() * spacing * 0.9).normalize()
            });
            Piece {
                ends,
                kind: border.kind,
                tooth,
            }
        })
        .collect()
}

/// Where places go, as their plates turn now.
fn arrows(planet: &Planet) -> Vec<(Vec<Vec3>, bool)> {
    let golden = (5_f64.sqrt() - 1.0) / 2.0;
    let places = (0..ARROWS).map(|i| {
        let z = 1.0 - (2 * i + 1) as f64 / ARROWS as f64;
        let (sin, cos) = (std::f64::consts::TAU * (i as f64 * golden).fract()).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    });
    places
        .filter_map(|place| {
            let sample = planet.lattice.nearest(place);
            let plate = planet.plates.get(usize::from(planet.plate[sample as usize]))?;
            let angle = plate.omega.length() * ARROW_MY;
            let way = plate.omega.cross(place).length() * ARROW_MY;
            (way > SHORTEST_ARROW && angle.is_finite()).then(|| {
                let axis = plate.omega.normalize();
                let path = (0..=ARROW_PIECES).map(|piece| {
                    let part = f64::from(piece) / f64::from(ARROW_PIECES);
                    (DQuat::from_axis_angle(axis, angle * part) * place).as_vec3()
                });
                (path.collect(), plate.grip == Grip::Led)
            })
        })
        .collect()
}
