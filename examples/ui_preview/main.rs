//! Draws what lies on top of the land, off-screen, to judge its looks: ink, halos, controls, ghost hands, warning,
//! staff's menu.
//!
//! `cargo run --example ui_preview -- FOLDER [WIDTHxHEIGHT] [SCENE…]`

mod offscreen;
mod session;

use std::error::Error;
use std::path::Path;

use egui::{Context, LayerId, Rect};
use orogen::gesture::contact::{ContactKey, Side, Source};
use orogen::instrument::{ControlId, ControlKind, ControlView, EditView, Editing, Route};
use orogen::kiosk::GhostHand;
use orogen::live::Clock;
use orogen::picture::{MapStyle, relief_map};
use orogen::ui::halo::Halos;
use orogen::ui::ink::Chart;
use orogen::ui::readouts::Readings;
use orogen::ui::{Sight, controls, ghost, readouts, warning};

use offscreen::Offscreen;
use session::{Moment, fingers, play};

const NODES: usize = 12_000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| "ui-preview".to_owned());
    let size = arguments.next().unwrap_or_else(|| "1920x1080".to_owned());
    let (width, height) = size.split_once('x').ok_or("expected WIDTHxHEIGHT")?;
    let (width, height): (u32, u32) = (width.parse()?, height.parse()?);
    let wanted: Vec<String> = arguments.collect();
    std::fs::create_dir_all(&folder)?;
    let offscreen = Offscreen::new()?;

    let scenes: [(&str, (&str, f64), Scene); 8] = [
        ("push", ("two_hands_push", 3.5), hands),
        ("rest", ("hand_rests_other_pushes", 4.0), hands),
        ("edit", ("four_visitors", 12.0), edit),
        ("idle", ("four_visitors", 12.0), idle),
        ("glow", ("four_visitors", 12.0), glow),
        ("finger", ("one_finger_push", 0.1), ghost_finger),
        ("ghosts", ("one_finger_push", 0.1), ghost_hands),
        ("warning", ("four_visitors", 12.0), countdown),
    ];
    for (name, (gestures, seconds), scene) in scenes {
        if !(wanted.is_empty() || wanted.iter().any(|w| w == name)) {
            continue;
        }
        let moment = play(gestures, seconds, NODES, width as usize)?;
        let style = MapStyle {
            marks: false,
            lettering: false,
            ..MapStyle::default()
        };
        let land = relief_map(&moment.surface, &style, width, height);
        let picture = offscreen.draw(&land, |_| (), |context, screen| scene(context, screen, &moment))?;
        picture.save(Path::new(&folder).join(format!("{name}.png")))?;
    }
    Ok(())
}

type Scene = fn(&Context, Rect, &Moment);

/// Seconds that everything has been there.
const SETTLED: f64 = 10.0;

fn hands(context: &Context, screen: Rect, moment: &Moment) {
    let painter = context.layer_painter(LayerId::background());
    let sight = Sight::flat(moment.map, screen);
    let mut chart = Chart::default();
    chart.follow(&moment.surface.plates, &moment.surface.faults, 0.0);
    chart.draw(&painter, &sight, 1.0, None, SETTLED);
    halos(moment).draw(&painter, &sight, SETTLED);
}

fn halos(moment: &Moment) -> Halos {
    let mut halos = Halos::default();
    for (id, finger) in fingers(&moment.hands).enumerate() {
        halos.touch(key(id as u64), finger, Route::Land, 0.0);
    }
    halos.meet(&moment.hands, 0.1);
    let size = moment.map.size_mm();
    for (id, (x, route)) in [
        (0.40, Route::Ignored),
        (0.46, Route::Wake),
        (0.52, Route::Edit),
        (0.58, Route::Control),
    ]
    .into_iter()
    .enumerate()
    {
        halos.touch(key(100 + id as u64), glam::DVec2::new(x, 0.1) * size, route, 0.0);
    }
    halos.touch(
        key(200),
        glam::DVec2::new(0.64, 0.1) * size,
        Route::Land,
        SETTLED - 0.6,
    );
    halos.lift(key(200), SETTLED - 0.5);
    halos
}

fn key(id: u64) -> ContactKey {
    ContactKey {
        source: Source::Window,
        device: 0,
        id,
        generation: 0,
    }
}

fn edit(context: &Context, screen: Rect, moment: &Moment) {
    let painter = context.layer_painter(LayerId::background());
    let sight = Sight::flat(moment.map, screen);
    let mut chart = Chart::default();
    chart.follow(&moment.surface.plates, &moment.surface.faults, 0.0);
    let tip = moment
        .surface
        .plates
        .first()
        .and_then(|plate| plate.arrows.first())
        .map(|&(_, to)| moment.map.to_table(to));
    let size = moment.map.size_mm();
    let edit = |x: f64, y: f64, doing, hold| EditView {
        side: Side::South,
        at: glam::DVec2::new(x, y) * size,
        doing,
        hold,
    };
    let mut edits = vec![
        edit(
            0.17,
            0.35,
            Editing::NewArrow {
                from: glam::DVec2::new(0.13, 0.2) * size,
                to: glam::DVec2::new(0.17, 0.35) * size,
            },
            0.0,
        ),
        edit(0.15, 0.74, Editing::Plate, 0.6),
        edit(0.265, 0.55, Editing::Fault, 0.0),
        edit(0.83, 0.30, Editing::Removed, 0.0),
    ];
    edits.extend(tip.map(|tip| EditView {
        side: Side::South,
        at: tip + 12.0,
        doing: Editing::Tip { tip },
        hold: 0.0,
    }));
    chart.draw(&painter, &sight, 1.0, Some(&edits), SETTLED);
    let mut halos = Halos::default();
    for (id, edit) in edits.iter().enumerate() {
        halos.touch(key(id as u64), edit.at, Route::Edit, 0.0);
    }
    halos.draw(&painter, &sight, SETTLED);
}

/// The controls of both sides, all at one glow.
fn controls(moment: &Moment, glow: f64) -> Vec<ControlView> {
    let size = moment.map.size_mm();
    let kinds = [
        ControlKind::Tool,
        ControlKind::Undo,
        ControlKind::PlayPause,
        ControlKind::Speed,
        ControlKind::Scrub,
        ControlKind::StartOver,
        ControlKind::Readouts,
        ControlKind::Save,
    ];
    let mut views = Vec::new();
    for side in [Side::South, Side::North] {
        let mut x = 60.0;
        for (i, kind) in kinds.into_iter().enumerate() {
            let half = if kind == ControlKind::Scrub { 90.0 } else { 13.0 };
            x += half;
            let centre = glam::DVec2::new(x, size.y - 28.0);
            x += half + 12.0;
            let lit = glow > 0.0;
            views.push(ControlView {
                id: ControlId(side, kind),
                side,
                kind,
                centre_mm: if side == Side::South {
                    centre
                } else {
                    size - centre
                },
                half_size_mm: glam::DVec2::new(half, 13.0),
                rotation: if side == Side::South {
                    0.0
                } else {
                    std::f64::consts::PI
                },
                pressed: lit && i == 3,
                progress: if lit && kind == ControlKind::StartOver {
                    0.7
                } else {
                    0.0
                },
                on: lit && matches!(kind, ControlKind::Tool | ControlKind::PlayPause),
                enabled: kind != ControlKind::Undo || lit,
                value: 0.5,
                glow: if side == Side::South { glow } else { 0.0 },
            });
        }
    }
    views
}

fn instrument(context: &Context, screen: Rect, moment: &Moment, glow: f64) {
    let painter = context.layer_painter(LayerId::background());
    let sight = Sight::flat(moment.map, screen);
    let mut chart = Chart::default();
    chart.follow(&moment.surface.plates, &moment.surface.faults, 0.0);
    chart.draw(&painter, &sight, 1.0, None, SETTLED);
    let clock = Clock {
        elapsed_yr: moment.surface.elapsed_yr,
        convergence_m_per_yr: 0.0123,
        shortening: 0.31,
        pace_yr_per_s: 0.5e6,
        ..Clock::default()
    };
    let readings = Readings {
        clock: &clock,
        exaggeration: 1.6,
    };
    for side in [Side::South, Side::North] {
        readouts::draw(
            &painter,
            &sight,
            &readings,
            side,
            if glow > 0.0 { 1.0 } else { 0.0 },
        );
    }
    controls::draw(&painter, &sight, &controls(moment, glow), 1.0);
}

fn idle(context: &Context, screen: Rect, moment: &Moment) {
    instrument(context, screen, moment, 0.0);
}

fn glow(context: &Context, screen: Rect, moment: &Moment) {
    instrument(context, screen, moment, 1.0);
}

/// A hand `side` (1 right, −1 left) whose fingers are spread around `middle`, after `way` mm.
fn ghost_hand(middle: glam::DVec2, way: glam::DVec2, side: f64, one: bool) -> GhostHand {
    let spread = [
        (-58.0, 22.0),
        (-36.0, -34.0),
        (-4.0, -48.0),
        (30.0, -38.0),
        (56.0, -10.0),
    ];
    let starts: Vec<glam::DVec2> = if one {
        vec![middle]
    } else {
        spread
            .iter()
            .map(|&(x, y)| middle + glam::DVec2::new(side * x, y))
            .collect()
    };
    GhostHand {
        fingers: starts.iter().map(|&p| p + way).collect(),
        starts,
        wrist: middle
            + way
            + glam::DVec2::new(
                side * if one { 50.0 } else { 40.0 },
                120.0 + if one { 30.0 } else { 0.0 },
            ),
        right: side > 0.0,
        touching: 1.0,
        opacity: 1.0,
    }
}

fn ghost_finger(context: &Context, screen: Rect, moment: &Moment) {
    let painter = context.layer_painter(LayerId::background());
    let middle = moment.map.size_mm() * glam::DVec2::new(0.55, 0.55);
    let hand = ghost_hand(middle, glam::DVec2::new(-110.0, -20.0), 1.0, true);
    ghost::draw(&painter, &Sight::flat(moment.map, screen), &[hand]);
}

fn ghost_hands(context: &Context, screen: Rect, moment: &Moment) {
    let painter = context.layer_painter(LayerId::background());
    let middle = moment.map.size_mm() * glam::DVec2::new(0.5, 0.55);
    let hands = [1.0, -1.0].map(|side| {
        ghost_hand(
            middle + glam::DVec2::new(side * 200.0, 0.0),
            glam::DVec2::new(-side * 75.0, 0.0),
            side,
            false,
        )
    });
    ghost::draw(&painter, &Sight::flat(moment.map, screen), &hands);
}

fn countdown(context: &Context, screen: Rect, moment: &Moment) {
    instrument(context, screen, moment, 0.0);
    let painter = context.layer_painter(LayerId::background());
    warning::draw(&painter, &Sight::flat(moment.map, screen), screen, 12_400, 20_000);
}
