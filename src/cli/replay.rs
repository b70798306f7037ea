//! `orogen replay`: gesture files through the same code as the table, without a display.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use indicatif::ProgressBar;

use super::console::Console;
use super::failure::Failure;
use super::output::{Pictures, Timings, draw_frame, land_of, write_json};
use super::{Common, PictureChoice, Quality, ReplayArgs, Switch, globe, on_threads, refine, slice};
#[cfg(feature = "app")]
use super::{StageChoice, render};
use crate::export::OutDir;
use crate::gesture::command::{Action, Mode};
use crate::gesture::file::{GestureFile, read_gesture};
use crate::input::pile::named_pile;
use crate::report::{RefinementFacts, Report};
use crate::rock::preset;
use crate::sim::{Sim, SimParams, World};
use crate::units::{DEFAULT_SHORT_SIDE, PlanMap};

/// The session that plain `orogen` plays where nobody can touch it.
const BUILTIN: &str = include_str!("../../gestures/builtin_session.gesture.jsonl");
const BUILTIN_NAME: &str = "builtin_session";
/// Nodes where neither the file nor the user says a number: what looks like land on a full-screen table.
const DEFAULT_NODES: u64 = 60_000;
/// Seed where neither the file nor the user names one.
const DEFAULT_SEED: u64 = 1;
/// What all gesture files end with.
const EXTENSION: &str = ".gesture.jsonl";

/// Plays the built-in session into `./orogen-out`.
pub(super) fn builtin(console: Console) -> Result<(), Failure> {
    console.note("playing the built-in session (see `orogen --help` for more)");
    let args = ReplayArgs {
        files: Vec::new(),
        common: Common {
            out: "orogen-out".into(),
            seed: None,
            threads: None,
            nodes: None,
            size: None,
            picture: PictureChoice::Map,
        },
        years: None,
        quality: Quality::Live,
        region: None,
        layers: preset::names()[0].to_owned(),
        paper: false,
        every: None,
        isostasy: Switch::On,
        deposition: Switch::On,
        slices: Vec::new(),
        #[cfg(feature = "app")]
        stages: StageChoice::Cpu,
    };
    run(&args, console)
}

/// Plays all files of `args`, after all of them have been read and found good.
pub(super) fn run(args: &ReplayArgs, console: Console) -> Result<(), Failure> {
    if let Some(years) = args.years
        && !(0.0..=1e9).contains(&years)
    {
        return Err(Failure::input(format!("--years {years}: expected 0 to 1e9")));
    }
    let mut sessions = Vec::new();
    if args.files.is_empty() {
        let file = read_gesture(BUILTIN.as_bytes(), BUILTIN_NAME).map_err(Failure::input)?;
        sessions.push((BUILTIN_NAME.to_owned(), file));
    }
    for path in &args.files {
        let stem = stem(path);
        if sessions.iter().any(|(other, _)| *other == stem) {
            let path = path.display();
            return Err(Failure::input(format!(
                "{path}: a second file named {stem}; replay it by itself"
            )));
        }
        let reader =
            File::open(path).map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
        let file =
            read_gesture(BufReader::new(reader), &path.display().to_string()).map_err(Failure::input)?;
        if file.header.mode == Mode::Globe {
            globe::check_options(path, args)?;
        }
        sessions.push((stem, file));
    }
    if args.slices.len() > slice::MOST {
        return Err(Failure::input(format!(
            "--slice: expected at most {} of them, found {}",
            slice::MOST,
            args.slices.len()
        )));
    }
    let of_mode = |mode| sessions.iter().filter(move |(_, file)| file.header.mode == mode);
    for (_, file) in of_mode(Mode::Mountain) {
        // A slice that misses the land is refused before the work.
        let land = plan(file).extent();
        slice::on_land(&args.slices, land)?;
        refine::check(args, live_nodes(file, args), land)?;
    }
    let pictures = Pictures::new(args.common.picture)?.with_slices(&args.slices);
    on_threads(args.common.threads, || {
        for (stem, file) in &sessions {
            for warning in &file.warnings {
                Console::warn(warning);
            }
            match file.header.mode {
                Mode::Mountain => play(stem, file, args, &pictures, console)?,
                Mode::Globe => globe::play(stem, file, args, console)?,
            }
        }
        Ok(())
    })
}

/// The name of a run: the file's, without its folder and endings.
fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let stem = name
        .strip_suffix(EXTENSION)
        .unwrap_or_else(|| name.split('.').next().unwrap_or(&name));
    if stem.is_empty() {
        "session".to_owned()
    } else {
        stem.to_owned()
    }
}

/// Where the table of `file` lies on the ground.
fn plan(file: &GestureFile) -> PlanMap {
    PlanMap::new(file.header.size_mm, DEFAULT_SHORT_SIDE)
}

/// Nodes of the land while it is sculpted. At final quality the user names those of the final land.
fn live_nodes(file: &GestureFile, args: &ReplayArgs) -> usize {
    let asked = args.common.nodes.filter(|_| args.quality == Quality::Live);
    asked
        .map(u64::from)
        .or(file.header.nodes)
        .unwrap_or(DEFAULT_NODES) as usize
}

/// The session of `file`, before its first tick.
fn session(file: &GestureFile, args: &ReplayArgs) -> Result<Sim, Failure> {
    let header = &file.header;
    let nodes = live_nodes(file, args);
    let seed = args.common.seed.or(header.seed).unwrap_or(DEFAULT_SEED);
    let mut params = if args.paper {
        SimParams::paper()
    } else {
        SimParams::default()
    };
    if args.isostasy == Switch::Off {
        params.isostasy = None;
    }
    if args.deposition == Switch::Off {
        params.erosion.deposition = None;
    }
    if let Some(years) = args.years.or(header.years) {
        params.run_on_yr = years;
    }
    let mut commands = file.frames.iter().flat_map(|frame| &frame.commands);
    if !commands.any(|command| matches!(command.action, Action::Scrub(_))) {
        // Nobody will look back.
        params.history_bytes = 0;
    }
    let world = World::new(plan(file), nodes, seed).map_err(Failure::input)?;
    let pile = named_pile(&args.layers, Path::new("")).map_err(Failure::input)?;
    #[cfg_attr(
        not(feature = "app"),
        expect(unused_mut, reason = "there is no card to hand stages to")
    )]
    let mut sim = Sim::new(world.with_layers(pile), params);
    #[cfg(feature = "app")]
    if args.stages == StageChoice::Gpu {
        sim.replace_stages(render::stages()?);
    }
    Ok(sim)
}

fn play(
    stem: &str,
    file: &GestureFile,
    args: &ReplayArgs,
    pictures: &Pictures,
    console: Console,
) -> Result<(), Failure> {
    // The folder is tried before the work, so that a bad --out costs no waiting.
    let out = OutDir::create(args.common.out.join(stem)).map_err(Failure::input)?;
    let mut timings = Timings::start();
    let title = file.header.title.clone().unwrap_or_else(|| stem.to_owned());
    let mut sim = session(file, args)?;
    timings.lap("start");
    let mut frames = FrameWriter {
        every: args.every,
        out: &out,
        size: args.common.size(),
        drawn: 0,
    };
    for frame in &file.frames {
        sim.feed(frame.clone());
    }
    let bar = console.progress(session_steps(file, &sim), &title);
    while sim.input_waits() {
        let report = sim.tick();
        bar.inc(u64::from(report.erosion_steps));
        if report.erosion_steps > 0 {
            frames.draw(&sim, &title)?;
        }
    }
    sim.finish_input();
    timings.lap("gestures");
    run_on(&mut sim, &bar, &mut frames, &title)?;
    bar.finish_and_clear();
    timings.lap("run_on");

    match args.quality {
        Quality::Live => write_session(
            (&sim, None),
            &title,
            &out,
            (args.common.size(), pictures),
            timings,
        )?,
        Quality::Final => refine::play(sim, args, (&title, &out), pictures, timings, console)?,
    }
    Console::result(&out.path().join(args.common.picture.shown()).display().to_string());
    Ok(())
}

/// Writes all files of a session's land: pictures `size` pixels wide, maps, meshes, the report.
pub(super) fn write_session(
    (sim, refinement): (&Sim, Option<RefinementFacts>),
    title: &str,
    out: &OutDir,
    (size, pictures): (u32, &Pictures),
    mut timings: Timings,
) -> Result<(), Failure> {
    let flow = sim.flow();
    let mut report = Report::of_session(title, sim, &flow);
    report.refinement = refinement;
    timings.lap("report");
    let k = vec![sim.params().erosion.k; sim.world().tin.len()];
    land_of(sim, &flow, &k, title).write(out, size, pictures, &mut timings)?;
    write_json(out, "report.json", &report)?;
    write_json(out, "timings.json", &timings.finish())?;
    if report.quarantine.steps > 0 {
        Console::warn(&format!(
            "{} steps held numbers that are none and were thrown away",
            report.quarantine.steps
        ));
    }
    Ok(())
}

/// About how many erosion steps the session will take, for the progress bar.
fn session_steps(file: &GestureFile, sim: &Sim) -> u64 {
    let params = sim.params();
    let seconds = file.frames.last().map_or(0.0, |frame| frame.t_us as f64 / 1e6);
    ((seconds * params.pace_yr_per_s + params.run_on_yr) / params.erosion_dt_yr) as u64
}

fn run_on(
    sim: &mut Sim,
    bar: &ProgressBar,
    frames: &mut FrameWriter<'_>,
    title: &str,
) -> Result<(), Failure> {
    let mut failure = None;
    sim.run_on(|sim, left_yr| {
        bar.inc(1);
        let left = (left_yr / sim.params().erosion_dt_yr).ceil() as u64;
        bar.set_length(bar.position() + left);
        match frames.draw(sim, title) {
            Ok(()) => true,
            Err(error) => {
                failure = Some(error);
                false
            }
        }
    });
    failure.map_or(Ok(()), Err)
}

/// Draws the pictures of `--every`.
struct FrameWriter<'a> {
    every: Option<u32>,
    out: &'a OutDir,
    size: u32,
    drawn: u32,
}

impl FrameWriter<'_> {
    fn draw(&mut self, sim: &Sim, title: &str) -> Result<(), Failure> {
        let Some(every) = self.every else { return Ok(()) };
        let world = sim.world();
        if !world.totals.steps.is_multiple_of(u64::from(every)) {
            return Ok(());
        }
        self.drawn += 1;
        let frames = OutDir::create(self.out.path().join("frames")).map_err(Failure::other)?;
        draw_frame(&frames, &format!("{:05}.png", self.drawn), sim, title, self.size)
    }
}
