//! Draws a gesture file's land with the table's own renderer, to judge its looks without a window.
//!
//! `cargo run --example render_preview -- GESTURES OUT.png [plan|AZIMUTH,DEPRESSION,KM] [WIDTHxHEIGHT] [NODES] [YEARS] [COLUMNS]`

use std::error::Error;
use std::fs::File;
use std::time::Instant;

use glam::DVec2;
use orogen::gesture::file::read_gesture;
use orogen::gpu::Gpu;
use orogen::render::{Camera, LandStyle, Oblique, RenderQuality, picture};
use orogen::sim::{Sim, SimParams, World};
use orogen::survey::{Ground, Survey};
use orogen::units::{DEFAULT_SHORT_SIDE, KM, PlanMap};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |i: usize, default: &str| arguments.get(i).cloned().unwrap_or_else(|| default.to_owned());
    let path = argument(0, "gestures/two_hands_push.gesture.jsonl");
    let (width, height) = {
        let size = argument(3, "1600x900");
        let (width, height) = size.split_once('x').ok_or("expected WIDTHxHEIGHT")?;
        (width.parse::<f64>()?, height.parse::<f64>()?)
    };
    let file = read_gesture(File::open(&path)?, &path)?;
    let mut params = SimParams::default();
    params.run_on_yr = argument(5, "5e6").parse()?;
    let map = PlanMap::new(file.header.size_mm, DEFAULT_SHORT_SIDE);
    let world = World::new(map, argument(4, "60000").parse()?, file.header.seed.unwrap_or(1))?;
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
    let surface = Survey::new(tin, argument(6, "1024").parse()?).surface(ground, sim.world().time_yr);

    let extent = surface.height.extent;
    let view = argument(2, "plan");
    let viewport = DVec2::new(width, height);
    let camera = if view == "plan" {
        Camera::plan(extent, viewport)
    } else {
        let numbers: Vec<f64> = view.split(',').map(str::parse).collect::<Result<_, _>>()?;
        let focus = extent.size() / 2.0;
        let oblique = Oblique {
            focus,
            focus_height: f64::from(surface.height.sample(focus)),
            azimuth: numbers[0].to_radians(),
            depression: numbers[1].to_radians(),
            distance: numbers[2] * KM,
            field_of_view: 0.6,
        };
        Camera::between(extent, viewport, &oblique, 1.0)
    };
    let gpu = Gpu::offscreen()?;
    let began = Instant::now();
    let style = LandStyle::default();
    picture(&gpu, &surface, &camera, &style, RenderQuality::PICTURE)?.save(argument(1, "render.png"))?;
    println!(
        "{} in {:.0} ms",
        gpu.info.name,
        began.elapsed().as_secs_f64() * 1e3
    );
    Ok(())
}
