//! Borders, arrows and legends on maps of the world.

use std::collections::BTreeMap;

use ab_glyph::FontRef;
use glam::{DQuat, DVec2, DVec3, Vec3};
use image::RgbaImage;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, PixmapPaint, Rect, Stroke, Transform,
};

use super::WorldMapStyle;
use super::theme::Theme;
use crate::picture::lettering::{Letters, font};
use crate::rock::Colour;
use crate::slice::colour::{INK, PAPER};
use crate::sphere::{RADIUS_KM, latitude_longitude};
use crate::surface::planet::{Border, BorderKind, Planet};

/// Height of the strip below a map as a part of its width.
const STRIP: f32 = 0.042;
/// How long an arrow is: what the plate moves in this time, My.
const ARROW_MY: f64 = 14.0;

/// Colour, width (thousandths of half the map's width) and name of a kind of border.
fn line(kind: BorderKind) -> (Colour, f32, &'static str) {
    match kind {
        BorderKind::Ridge => ([196, 62, 46], 1.5, "ridge, rift"),
        BorderKind::Subduction => ([28, 32, 58], 1.7, "subduction"),
        BorderKind::Collision => ([110, 44, 96], 1.7, "collision"),
        BorderKind::Transform => ([236, 232, 220], 1.0, "transform"),
    }
}

const KINDS: [BorderKind; 4] = [
    BorderKind::Transform,
    BorderKind::Ridge,
    BorderKind::Collision,
    BorderKind::Subduction,
];

/// Lays borders, arrows and legend over a world map.
pub(super) fn finish(map: RgbaImage, planet: &Planet, style: WorldMapStyle) -> RgbaImage {
    let Some(mut sheet) = sheet(&map, style.legend) else {
        return map;
    };
    let width = map.width() as f32;
    if style.borders {
        borders(&mut sheet, planet, width, 1.0);
        arrows(&mut sheet, planet, width);
    }
    if style.legend
        && let Some(font) = font()
    {
        let mut pen = Pen::new(&mut sheet, &font, width);
        pen.text(&format!("{:.0} My", planet.time_my), 1.5, 0.95);
        pen.gap(1.0);
        pen.heights();
        if style.borders {
            for kind in KINDS.into_iter().rev() {
                pen.border(kind);
            }
            pen.text(&format!("arrows: {ARROW_MY:.0} My of motion"), 1.0, 0.75);
        }
    }
    unpacked(&sheet, map)
}

/// Lays the borders and the key of a theme over its map.
pub(super) fn finish_theme(map: RgbaImage, planet: &Planet, theme: Theme) -> RgbaImage {
    let Some(mut sheet) = sheet(&map, true) else {
        return map;
    };
    let width = map.width() as f32;
    borders(&mut sheet, planet, width, 0.7);
    if let Some(font) = font() {
        let (title, entries) = theme.key();
        let mut pen = Pen::new(&mut sheet, &font, width);
        pen.text(title, 1.5, 0.95);
        pen.text(&format!("{:.0} My", planet.time_my), 1.0, 0.75);
        pen.gap(1.0);
        for (colour, words) in entries {
            pen.swatch([16, 8, 0].map(|shift| (colour >> shift) as u8), &words);
        }
    }
    unpacked(&sheet, map)
}

/// The map on its sheet, with room for a strip where one is wanted.
fn sheet(map: &RgbaImage, strip: bool) -> Option<Pixmap> {
    let foot = if strip {
        (map.width() as f32 * STRIP) as u32
    } else {
        0
    };
    let mut pixels = Pixmap::new(map.width(), map.height())?;
    pixels.data_mut().copy_from_slice(map.as_raw());
    let mut sheet = Pixmap::new(map.width(), map.height() + foot)?;
    sheet.fill(Color::from_rgba8(PAPER[0], PAPER[1], PAPER[2], 255));
    sheet.draw_pixmap(
        0,
        0,
        pixels.as_ref(),
        &PixmapPaint::default(),
        Transform::identity(),
        None,
    );
    Some(sheet)
}

fn unpacked(sheet: &Pixmap, otherwise: RgbaImage) -> RgbaImage {
    RgbaImage::from_raw(sheet.width(), sheet.height(), sheet.data().to_vec()).unwrap_or(otherwise)
}

/// Where a direction is on a map, pixels.
fn to_map(p: DVec3, width: f32) -> DVec2 {
    let (latitude, longitude) = latitude_longitude(p);
    DVec2::new(longitude + 180.0, 90.0 - latitude) * f64::from(width) / 360.0
}

/// All borders, subduction last, with teeth on the plate that stays on top.
fn borders(sheet: &mut Pixmap, planet: &Planet, width: f32, strength: f32) {
    let scale = width / 2000.0;
    for kind in KINDS {
        let (colour, thick, _) = line(kind);
        let pieces: Vec<&Border> = planet
            .borders
            .iter()
            .filter(|border| border.kind == kind)
            .collect();
        for chain in chains(&pieces, planet) {
            let points: Vec<DVec2> = chain.points.iter().map(|&p| to_map(p, width)).collect();
            let mut path = PathBuilder::new();
            let mut last: Option<DVec2> = None;
            for &p in &points {
                let near = last.is_some_and(|last| last.distance(p) < f64::from(width) / 4.0);
                if near {
                    path.line_to(p.x as f32, p.y as f32);
                } else {
                    path.move_to(p.x as f32, p.y as f32);
                }
                last = Some(p);
            }
            if let Some(path) = path.finish() {
                stroke(sheet, &path, colour, 0.85 * strength, thick * scale);
            }
            if kind == BorderKind::Subduction {
                teeth(sheet, &chain, &points, colour, 0.85 * strength, scale);
            }
        }
    }
}

/// A line of borders between the same two plates.
struct Chain {
    points: Vec<DVec3>,
    /// For each point a direction towards the plate on top.
    upper: Vec<DVec3>,
}

/// Pieces that share ends become lines, and the lines lose the corners of the cells.
fn chains(pieces: &[&Border], planet: &Planet) -> Vec<Chain> {
    let key = |p: Vec3| p.to_array().map(|x| (x * 2e4).round() as i32);
    let pair = |border: &Border| border.samples.map(|i| planet.plate[i as usize]);
    let mut at: BTreeMap<([u16; 2], [i32; 3]), Vec<usize>> = BTreeMap::new();
    for (number, border) in pieces.iter().enumerate() {
        for end in border.ends {
            at.entry((pair(border), key(end))).or_default().push(number);
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut chains = Vec::new();
    for first in 0..pieces.len() {
        if used[first] {
            continue;
        }
        used[first] = true;
        let plates = pair(pieces[first]);
        let towards = |border: &Border| {
            let [upper, lower] = border.samples.map(|i| planet.lattice.point(i));
            upper - lower
        };
        let mut ways = Vec::new();
        for start in [1, 0] {
            let mut points = Vec::new();
            let (mut end, mut number) = (pieces[first].ends[start], first);
            loop {
                points.push((end.as_dvec3(), towards(pieces[number])));
                let next = at
                    .get(&(plates, key(end)))
                    .and_then(|near| near.iter().copied().find(|&n| !used[n]));
                let Some(next) = next else { break };
                used[next] = true;
                let ends = pieces[next].ends;
                end = if key(ends[0]) == key(end) {
                    ends[1]
                } else {
                    ends[0]
                };
                number = next;
            }
            ways.push(points);
        }
        let mut line: Vec<(DVec3, DVec3)> = ways.pop().unwrap_or_default();
        line.reverse();
        line.extend(ways.pop().unwrap_or_default());
        for _ in 0..3 {
            let before = line.clone();
            for k in 1..line.len().saturating_sub(1) {
                line[k].0 = (before[k - 1].0 + before[k].0 * 2.0 + before[k + 1].0).normalize();
            }
        }
        let (points, upper) = line.into_iter().unzip();
        chains.push(Chain { points, upper });
    }
    chains
}

fn teeth(sheet: &mut Pixmap, chain: &Chain, points: &[DVec2], colour: Colour, strength: f32, scale: f32) {
    let scale = f64::from(scale);
    let (every, base, tall) = (20.0 * scale, 7.0 * scale, 6.0 * scale);
    let mut path = PathBuilder::new();
    let mut next = every * 0.5;
    for k in 1..points.len() {
        let (from, to) = (points[k - 1], points[k]);
        let length = from.distance(to);
        if length > 100.0 * scale {
            continue;
        }
        let along = (to - from).normalize_or_zero();
        // The side of the plate on top, as the map shows it.
        let p = chain.points[k];
        let tip = to_map((p + chain.upper[k] * 0.2).normalize(), 2000.0) - to_map(p, 2000.0);
        let side = if along.perp().dot(tip) >= 0.0 { 1.0 } else { -1.0 };
        while next <= length {
            let foot = from + along * next;
            let corners = [
                foot - along * base * 0.5,
                foot + along * base * 0.5,
                foot + along.perp() * side * tall,
            ];
            path.move_to(corners[0].x as f32, corners[0].y as f32);
            path.line_to(corners[1].x as f32, corners[1].y as f32);
            path.line_to(corners[2].x as f32, corners[2].y as f32);
            path.close();
            next += every;
        }
        next -= length;
    }
    if let Some(path) = path.finish() {
        sheet.fill_path(
            &path,
            &paint(colour, strength),
            FillRule::Winding,
            Transform::identity(),
            None,
        );
    }
}

/// Where each plate goes, from the middle of its area.
fn arrows(sheet: &mut Pixmap, planet: &Planet, width: f32) {
    let scale = f64::from(width) / 2000.0;
    let mut middles = vec![DVec3::ZERO; planet.plates.len()];
    for (i, &plate) in planet.plate.iter().enumerate() {
        middles[plate as usize] += planet.lattice.points()[i] * planet.lattice.areas()[i];
    }
    for (plate, middle) in planet.plates.iter().zip(middles) {
        let Some(from) = middle.try_normalize() else {
            continue;
        };
        let speed = plate.omega.cross(from).length() * RADIUS_KM;
        // Small plates would be all arrow.
        if plate.area_sr < 0.06 || speed < 4.0 {
            continue;
        }
        let steps = 12;
        let way: Vec<DVec2> = (0..=steps)
            .map(|k| {
                let turn =
                    DQuat::from_scaled_axis(plate.omega * (ARROW_MY * f64::from(k) / f64::from(steps)));
                to_map(turn * from, width)
            })
            .collect();
        if way
            .windows(2)
            .any(|pair| pair[0].distance(pair[1]) > 60.0 * scale)
        {
            continue;
        }
        let tip = way[way.len() - 1];
        let along = (tip - way[way.len() - 2]).normalize_or_zero();
        let (head, wide) = (11.0 * scale, 4.2 * scale);
        let mut line = PathBuilder::new();
        line.move_to(way[0].x as f32, way[0].y as f32);
        for p in &way[1..] {
            line.line_to(p.x as f32, p.y as f32);
        }
        if let Some(line) = line.finish() {
            stroke(sheet, &line, [250, 246, 236], 0.9, 1.7 * scale as f32);
        }
        let mut tip_path = PathBuilder::new();
        let corners = [
            tip + along * head * 0.6,
            tip - along * head * 0.4 + along.perp() * wide,
            tip - along * head * 0.4 - along.perp() * wide,
        ];
        tip_path.move_to(corners[0].x as f32, corners[0].y as f32);
        tip_path.line_to(corners[1].x as f32, corners[1].y as f32);
        tip_path.line_to(corners[2].x as f32, corners[2].y as f32);
        tip_path.close();
        if let Some(path) = tip_path.finish() {
            sheet.fill_path(
                &path,
                &paint([250, 246, 236], 0.95),
                FillRule::Winding,
                Transform::identity(),
                None,
            );
        }
    }
}

fn stroke(sheet: &mut Pixmap, path: &tiny_skia::Path, colour: Colour, strength: f32, width: f32) {
    let stroke = Stroke {
        width: width.max(0.4),
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    sheet.stroke_path(
        path,
        &paint(colour, strength),
        &stroke,
        Transform::identity(),
        None,
    );
}

fn paint([red, green, blue]: Colour, strength: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, (strength.clamp(0.0, 1.0) * 255.0) as u8);
    paint
}

/// Writes the strip below a map, from left to right.
struct Pen<'a> {
    sheet: &'a mut Pixmap,
    font: &'a FontRef<'a>,
    at: f32,
    size: f32,
    middle: f32,
}

impl<'a> Pen<'a> {
    fn new(sheet: &'a mut Pixmap, font: &'a FontRef<'a>, width: f32) -> Self {
        let strip = width * STRIP;
        Self {
            at: 0.4 * strip,
            size: 0.26 * strip,
            middle: sheet.height() as f32 - 0.5 * strip,
            sheet,
            font,
        }
    }

    fn gap(&mut self, letters: f32) {
        self.at += letters * self.size;
    }

    fn text(&mut self, words: &str, size: f32, strength: f32) {
        let size = size * self.size;
        let letters = Letters {
            font: self.font,
            size,
            colour: INK,
            strength,
        };
        self.at = letters.write(self.sheet, words, self.at, self.middle + 0.34 * size);
        self.gap(1.4);
    }

    fn swatch(&mut self, colour: Colour, words: &str) {
        let side = 1.1 * self.size;
        if let Some(rect) = Rect::from_xywh(self.at, self.middle - 0.5 * side, 1.6 * side, side) {
            self.sheet
                .fill_rect(rect, &paint(colour, 1.0), Transform::identity(), None);
        }
        self.at += 1.6 * side;
        self.gap(0.5);
        self.text(words, 1.0, 0.85);
    }

    fn border(&mut self, kind: BorderKind) {
        let (colour, thick, name) = line(kind);
        let colour = if kind == BorderKind::Transform {
            [150, 146, 136]
        } else {
            colour
        };
        let (from, length) = (self.at, 2.6 * self.size);
        let mut path = PathBuilder::new();
        path.move_to(from, self.middle);
        path.line_to(from + length, self.middle);
        if let Some(path) = path.finish() {
            stroke(self.sheet, &path, colour, 0.95, thick * self.size / 12.0);
        }
        if kind == BorderKind::Subduction {
            let mut path = PathBuilder::new();
            for k in 0..2 {
                let foot = from + length * (0.3 + 0.4 * k as f32);
                path.move_to(foot - 0.22 * self.size, self.middle);
                path.line_to(foot + 0.22 * self.size, self.middle);
                path.line_to(foot, self.middle - 0.42 * self.size);
                path.close();
            }
            if let Some(path) = path.finish() {
                self.sheet.fill_path(
                    &path,
                    &paint(colour, 0.95),
                    FillRule::Winding,
                    Transform::identity(),
                    None,
                );
            }
        }
        self.at += length;
        self.gap(0.5);
        self.text(name, 1.0, 0.85);
    }

    /// The scales of depths and of heights, these in a mild climate.
    fn heights(&mut self) {
        let palette = super::Palette::new();
        self.scale("sea, 7 to 0 km deep", |part| palette.sea(7.0 * (1.0 - part)));
        let mild = 40_f32.to_radians().sin();
        let ground = |part: f32| palette.land(6.0 * part, mild, 0.0, [0.0; 3]).colour;
        self.scale("land at 40°, 0 to 6 km", ground);
    }

    /// A scale of colours from 0 to 1, and what it stands for.
    fn scale(&mut self, words: &str, colour: impl Fn(f32) -> Vec3) {
        let encoder = super::Encoder::new();
        let (length, tall) = (7.0 * self.size, 0.9 * self.size);
        let left = self.at.round();
        // Whole columns of pixels: where edges share a pixel a stripe would show.
        for column in 0..length as u32 {
            let x = left + column as f32;
            if let Some(rect) = Rect::from_xywh(x, self.middle - 0.5 * tall, 1.0, tall) {
                let colour = encoder.encode(colour(column as f32 / length));
                self.sheet
                    .fill_rect(rect, &paint(colour, 1.0), Transform::identity(), None);
            }
        }
        self.at += length;
        self.gap(0.5);
        self.text(words, 1.0, 0.85);
    }
}
