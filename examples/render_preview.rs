//! Draws a gesture file's land with the table's own renderer, to judge its looks without a window.
//!
//! `cargo run --example render_preview -- GESTURES OUT VIEWS [WIDTHxHEIGHT] [NODES] [YEARS] [COLUMNS] [QUALITY] [PILE]
//! [FOLDS]`
//!
//! Views are separated by spaces and written to `OUT-0.png`, `OUT-1.png` …: `plan`; `flight:SECONDS`; `way:T`, the
//! eye at `T` (0 to 1) of its way from the plan into the flight; `AZIMUTH,DEPRESSION,KM` about the flight's focus.
//! Qualities are `picture`, `high` and `software`; a view that ends with `!` is drawn in the geological map's colours.
//! `FOLDS`, metres, bends the layers of the finished land into waves of that height, as a painter's dummy: the land was
//! not eroded along them.

#![expect(clippy::print_stdout, reason = "a tool for the terminal")]

use std::error::Error;
use std::f64::consts::TAU;
use std::fs::File;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;
use orogen::gesture::file::read_gesture;
use orogen::gpu::Gpu;
use orogen::render::{Camera, Focus, LandStyle, Oblique, RenderQuality, flight, picture};
use orogen::rock::preset;
use orogen::sim::{Sim, SimParams, World};
use orogen::surface::{Raster, Surface};
use orogen::survey::{Ground, Survey};
use orogen::units::{DEFAULT_SHORT_SIDE, KM, PlanMap};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |i: usize, default: &str| arguments.get(i).cloned().unwrap_or_else(|| default.to_owned());
    let (width, height) = {
        let size = argument(3, "1600x900");
        let (width, height) = size.split_once('x').ok_or("expected WIDTHxHEIGHT")?;
        (width.parse::<f64>()?, height.parse::<f64>()?)
    };
    let surface = land(
        &argument(0, "gestures/two_hands_push.gesture.jsonl"),
        argument(4, "60000").parse()?,
        argument(5, "5e6").parse()?,
        argument(6, "1024").parse()?,
        &argument(8, "plain"),
    )?;
    let surface = folded(surface, argument(9, "0").parse()?);
    let quality = match &*argument(7, "picture") {
        "picture" => RenderQuality::PICTURE,
        "high" => RenderQuality::HIGH,
        "software" => RenderQuality::SOFTWARE,
        other => return Err(format!("{other}: expected picture, high or software").into()),
    };
    let gpu = Gpu::offscreen()?;
    for (number, view) in argument(2, "plan flight:0").split_whitespace().enumerate() {
        let (view, geology) = view.strip_suffix('!').map_or((view, 0.0), |view| (view, 1.0));
        let style = LandStyle {
            geology,
            ..LandStyle::default()
        };
        let camera = eye(view, &surface, &style, DVec2::new(width, height))?;
        let began = Instant::now();
        let path = format!("{}-{number}.png", argument(1, "render"));
        picture(&gpu, &surface, &camera, &style, quality)?.save(&path)?;
        let taken = began.elapsed().as_secs_f64() * 1e3;
        println!("{path}: {view} on {} in {taken:.0} ms", gpu.info.name);
    }
    Ok(())
}

/// What the session of a gesture file yields.
fn land(path: &str, nodes: usize, years: f64, columns: usize, pile: &str) -> Result<Surface, Box<dyn Error>> {
    let file = read_gesture(File::open(path)?, path)?;
    let params = SimParams {
        run_on_yr: years,
        ..SimParams::default()
    };
    let map = PlanMap::new(file.header.size_mm, DEFAULT_SHORT_SIDE);
    let mut world = World::new(map, nodes, file.header.seed.unwrap_or(1))?;
    world.stratigraphy = preset::by_name(pile).ok_or_else(|| format!("{pile}: no such pile"))?;
    let mut sim = Sim::new(world, params);
    for frame in file.frames {
        sim.feed(frame);
    }
    while sim.input_waits() {
        sim.tick();
    }
    sim.finish_input();
    sim.run_on(|_, _| true);
    let (tin, flow) = (&sim.world().tin, sim.flow());
    let ground = Ground {
        tin,
        z: &sim.world().z,
        flow: &flow,
    };
    let mut survey = Survey::new(tin, columns);
    let mut surface = survey.surface(ground, sim.world().time_yr);
    survey.draw_layers(&sim.underground(), &mut surface);
    Ok(surface)
}

/// The land with its layers bent into waves of that height, metres, seven kilometres long.
fn folded(mut surface: Surface, metres: f64) -> Surface {
    if let Some(map) = &mut surface.strata
        && metres > 0.0
    {
        let map = Arc::make_mut(map);
        let extent = map.depth.extent;
        let waves = Raster::from_fn(map.depth.width, map.depth.height, extent, |p| {
            let bend = 900.0 * (p.y / (11.0 * KM)).sin();
            (metres * (0.5 + 0.5 * ((p.x + bend) / (7.0 * KM) * TAU).cos())) as f32
        });
        for (depth, wave) in map.depth.data.iter_mut().zip(waves.data) {
            *depth += wave;
        }
    }
    surface
}

/// The eye that `view` names.
fn eye(view: &str, surface: &Surface, style: &LandStyle, viewport: DVec2) -> Result<Camera, Box<dyn Error>> {
    let extent = surface.height.extent;
    let focus = Focus::of(surface);
    let (kind, number) = view.split_once(':').unwrap_or((view, "0"));
    Ok(match kind {
        "plan" => Camera::plan(extent, viewport),
        "flight" => Camera::between(extent, viewport, &flight(&focus, style, number.parse()?), 1.0),
        "way" => Camera::between(extent, viewport, &flight(&focus, style, 0.0), number.parse()?),
        _ => {
            let numbers: Vec<f64> = view.split(',').map(str::parse).collect::<Result<_, _>>()?;
            let [azimuth, depression, distance] = numbers[..] else {
                return Err("expected plan, flight:SECONDS, way:T or AZIMUTH,DEPRESSION,KM".into());
            };
            let oblique = Oblique {
                azimuth: azimuth.to_radians(),
                depression: depression.to_radians(),
                distance: distance * KM,
                ..flight(&focus, style, 0.0)
            };
            Camera::between(extent, viewport, &oblique, 1.0)
        }
    })
}
