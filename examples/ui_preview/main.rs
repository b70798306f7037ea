//! Draws what lies on top of the land, off-screen, to judge its looks: ink, halos, controls, ghost hands, warning,
//! staff's menu.
//!
//! `cargo run --example ui_preview -- FOLDER [WIDTHxHEIGHT] [SCENE…]`

mod offscreen;
mod session;

use std::error::Error;
use std::path::Path;

use egui::{Context, LayerId, Rect};
use orogen::gesture::command::{Mode, Tool};
use orogen::gesture::contact::{ContactKey, Side, Source};
use orogen::instrument::{
    ControlKind, ControlView, EditView, Editing, Instrument, InstrumentParams, Route, Scene as TableScene,
};
use orogen::kiosk::{DoorPhase, Hint, Lesson};
use orogen::live::Clock;
use orogen::render::{self, Camera, LandStyle, Oblique, RenderQuality};
use orogen::ui::halo::Halos;
use orogen::ui::ink::Chart;
use orogen::ui::readouts::Readings;
use orogen::ui::staff::{Health, StaffPanel, StaffView, scale_for};
use orogen::ui::{Sight, controls, ghost, readouts, warning};

use offscreen::Offscreen;
use session::{Moment, fingers, play};

const NODES: usize = 25_000;

/// Factor on heights.
const EXAGGERATION: f32 = 1.6;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| "ui-preview".to_owned());
    let size = arguments.next().unwrap_or_else(|| "1920x1080".to_owned());
    let (width, height) = size.split_once('x').ok_or("expected WIDTHxHEIGHT")?;
    let (width, height): (u32, u32) = (width.parse()?, height.parse()?);
    let wanted: Vec<String> = arguments.collect();
    std::fs::create_dir_all(&folder)?;
    let offscreen = Offscreen::new()?;

    let scenes: [(&str, (&str, f64), Scene); 13] = [
        ("push", ("two_hands_push", 3.5), hands),
        ("rest", ("hand_rests_other_pushes", 4.0), hands),
        ("edit", ("four_visitors", 12.0), edit),
        ("idle", ("four_visitors", 12.0), idle),
        ("glow", ("four_visitors", 12.0), glow),
        ("finger", ("one_finger_push", 0.1), ghost_finger),
        ("ghosts", ("one_finger_push", 0.1), ghost_hands),
        ("warning", ("four_visitors", 12.0), countdown),
        ("flight", ("two_hands_push", 9.0), flight),
        ("keypad", ("four_visitors", 12.0), keypad),
        ("menu", ("four_visitors", 12.0), menu),
        ("health", ("four_visitors", 12.0), health),
        ("settings", ("four_visitors", 12.0), settings),
    ];
    for (name, (gestures, seconds), scene) in scenes {
        if !(wanted.is_empty() || wanted.iter().any(|w| w == name)) {
            continue;
        }
        let moment = play(gestures, seconds, NODES, width as usize)?;
        let viewport = glam::DVec2::new(f64::from(width), f64::from(height));
        let extent = moment.map.extent();
        let camera = if name == "flight" {
            Camera::between(extent, viewport, &aslant(extent), 1.0)
        } else {
            Camera::plan(extent, viewport)
        };
        let moment = Moment { camera, ..moment };
        let style = LandStyle {
            exaggeration: EXAGGERATION,
            ..LandStyle::default()
        };
        let land = render::picture(
            &offscreen.gpu,
            &moment.surface,
            &camera,
            &style,
            RenderQuality::PICTURE,
        )?;
        let picture = offscreen.draw(
            &land,
            |context, screen| scene(context, screen, &moment),
            |context| context.data(|data| data.get_temp(press_id())),
        )?;
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
        (0.52, Route::Tool),
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
        halos.touch(key(id as u64), edit.at, Route::Tool, 0.0);
    }
    halos.draw(&painter, &sight, SETTLED);
}

/// The controls, with a hand at some of those of the south side where `near`.
fn controls(moment: &Moment, clock: &Clock, near: bool) -> Vec<ControlView> {
    let size_mm = moment.map.size_mm();
    let mut instrument = Instrument::new(InstrumentParams {
        size_mm,
        corner: orogen::settings::Corner::default(),
        unattended: false,
        artists: true,
        mode: Mode::Mountain,
        readouts: false,
        gesture: orogen::gesture::params::GestureParams::default(),
    });
    let scene = TableScene {
        plates: &moment.surface.plates,
        faults: &moment.surface.faults,
        cuts: &[None, None],
        map: moment.map,
        clock,
        in_flight: false,
        panels: &[],
    };
    for tick in 0..60 {
        instrument.tick(tick * 16_000, &scene);
    }
    let mut views = instrument.controls();
    for view in views.iter_mut().filter(|view| near && view.side == Side::South) {
        view.glow = 1.0;
        view.pressed = view.kind == ControlKind::Speed;
        view.progress = if view.kind == ControlKind::StartOver {
            0.7
        } else {
            0.0
        };
        view.on |= view.kind == ControlKind::Tool(Tool::Edit);
        view.enabled = true;
    }
    views
}

fn instrument(context: &Context, screen: Rect, moment: &Moment, near: bool) {
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
        paused: near,
        history_yr: (0.0, moment.surface.elapsed_yr),
        can_undo: [true, false],
        ..Clock::default()
    };
    let readings = Readings {
        clock: &clock,
        exaggeration: f64::from(EXAGGERATION),
    };
    for side in [Side::South, Side::North] {
        readouts::draw(&painter, &sight, &readings, side, if near { 1.0 } else { 0.0 });
    }
    controls::draw(&painter, &sight, &controls(moment, &clock, near), 1.0);
}

fn idle(context: &Context, screen: Rect, moment: &Moment) {
    instrument(context, screen, moment, false);
}

fn glow(context: &Context, screen: Rect, moment: &Moment) {
    instrument(context, screen, moment, true);
}

/// A lesson, half-way.
fn lesson(context: &Context, screen: Rect, moment: &Moment, lesson: Lesson, side: Side) {
    let painter = context.layer_painter(LayerId::background());
    let hint = Hint {
        lesson,
        side,
        progress: 0.66,
    };
    let hands = hint.hands(moment.map.size_mm());
    ghost::draw(&painter, &Sight::flat(moment.map, screen), &hands);
}

fn ghost_finger(context: &Context, screen: Rect, moment: &Moment) {
    lesson(context, screen, moment, Lesson::OneFinger, Side::North);
}

fn ghost_hands(context: &Context, screen: Rect, moment: &Moment) {
    lesson(context, screen, moment, Lesson::TwoHands, Side::South);
}

fn countdown(context: &Context, screen: Rect, moment: &Moment) {
    instrument(context, screen, moment, false);
    let painter = context.layer_painter(LayerId::background());
    warning::draw(&painter, &Sight::flat(moment.map, screen), screen, 12_400, 20_000);
}

/// An eye low in the south-west.
fn aslant(extent: orogen::units::Extent) -> Oblique {
    Oblique {
        focus: extent.size() / 2.0,
        focus_height: 2000.0,
        azimuth: 0.5,
        depression: 0.5,
        distance: 110e3,
        field_of_view: 0.7,
    }
}

/// Marks that lie on the land, seen from the side.
fn flight(context: &Context, screen: Rect, moment: &Moment) {
    let painter = context.layer_painter(LayerId::background());
    let project = |plan: glam::DVec2, height: f64| {
        let at = moment
            .camera
            .project(plan.extend(height * f64::from(EXAGGERATION)))?;
        Some(egui::pos2(at.x as f32, at.y as f32))
    };
    let sight = Sight::draped(moment.map, screen, &moment.surface.height, &project);
    let mut chart = Chart::default();
    chart.follow(&moment.surface.plates, &moment.surface.faults, 0.0);
    chart.draw(&painter, &sight, 1.0, None, SETTLED);
}

/// The staff's panel, with `press`ed names of pages.
fn staff(context: &Context, screen: Rect, moment: &Moment, door: DoorPhase, page: Option<usize>) {
    instrument(context, screen, moment, false);
    let health = Health {
        version: "0.1.0",
        adapter: "NVIDIA RTX 4070, Vulkan",
        uptime_s: 93_784.0,
        frame_ms: (16.7, 17.4),
        touch_ms: (18.3, 27.0),
        steps_per_s: 9.8,
        nodes: 60_000,
        stats: orogen::gesture::hand::ContactStats {
            total: 18_234,
            hands: 5021,
            pushes: 3120,
            dropped_ghosts: 41,
            stuck: 1,
            ..Default::default()
        },
        ..Health::default()
    };
    let settings = orogen::settings::Settings::default();
    let size = moment.map.size_mm();
    let view = StaffView {
        door,
        settings: &settings,
        health: &health,
        notice: page.is_none().then_some("Saved as table-007"),
        final_done: None,
        scale: scale_for(screen.size(), screen.width() / size.x as f32),
    };
    let id = egui::Id::unique("preview panel");
    let mut panel: StaffPanel = context.data(|data| data.get_temp(id)).unwrap_or_default();
    let rect = panel.show(context, &view).rect;
    context.data_mut(|data| data.insert_temp(id, panel));
    if let (Some(rect), Some(page)) = (rect, page) {
        // The names of pages stand one under the other on the left.
        let at = rect.min + egui::vec2(110.0, 52.0 + 58.0 * page as f32) * view.scale;
        context.data_mut(|data| data.insert_temp(press_id(), at));
    }
}

fn keypad(context: &Context, screen: Rect, moment: &Moment) {
    staff(
        context,
        screen,
        moment,
        DoorPhase::Keypad { digits: 2, wrong: 1 },
        None,
    );
}

fn menu(context: &Context, screen: Rect, moment: &Moment) {
    staff(context, screen, moment, DoorPhase::Menu, None);
}

fn health(context: &Context, screen: Rect, moment: &Moment) {
    staff(context, screen, moment, DoorPhase::Menu, Some(1));
}

fn settings(context: &Context, screen: Rect, moment: &Moment) {
    staff(context, screen, moment, DoorPhase::Menu, Some(3));
}

/// Where the place is kept that a finger taps.
fn press_id() -> egui::Id {
    egui::Id::unique("preview press")
}
