//! `orogen planet`, and what `replay` does with files of the globe: a session from start to files.

use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;

use glam::DVec2;
use indicatif::ProgressBar;

use super::console::Console;
use super::failure::Failure;
use super::output::{Timings, png, write_json};
use super::{Common, PictureChoice, PlanetArgs, Quality, ReplayArgs, SeaFloorChoice, Switch, on_threads};
use crate::export::OutDir;
use crate::export::planet::{self as files, Rotation};
use crate::gesture::contact::InputFrame;
use crate::gesture::file::GestureFile;
use crate::globe::{GlobeParams, SeaFloor, Start};
use crate::input::planet::read_planet;
use crate::picture::planet::{Theme, WorldMapStyle, globe, theme_map, world_map};
use crate::report::GlobeReport;
use crate::rock::preset;
use crate::sim::globe::{GlobeSim, GlobeSimParams, LIVE_SAMPLES, default_start};
use crate::sphere::Lattice;
use crate::surface::planet::Planet;

/// Model years that a planet runs on after the last input, where neither the file nor the user says a number.
const RUN_ON_YR: f64 = 20e6;
/// Seed where neither the file nor the user names one.
const DEFAULT_SEED: u64 = 1;
/// The table that nobody touches, mm.
const NO_TABLE_MM: DVec2 = DVec2::new(1209.6, 680.4);
/// What a million years is in years.
const MY: f64 = 1e6;

/// Heights of black and of white, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Metres(pub(super) [f64; 2]);

/// Reads `BLACK,WHITE`.
pub(super) fn metres(text: &str) -> Result<Metres, String> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    let ends = text.split_once(',');
    ends.and_then(|(black, white)| Some(Metres([number(black)?, number(white)?])))
        .ok_or_else(|| "expected two numbers, such as -10000,10000".to_owned())
}

/// Refuses options of `replay` that mean something on flat land only.
pub(super) fn check_options(path: &Path, args: &ReplayArgs) -> Result<(), Failure> {
    let flat = [
        ("--slice", !args.slices.is_empty()),
        ("--layers", args.layers != preset::names()[0]),
        ("--isostasy", args.isostasy == Switch::Off),
        ("--deposition", args.deposition == Switch::Off),
        ("--quality final", args.quality == Quality::Final),
        ("--region", args.region.is_some()),
    ];
    let flat = flat.iter().find(|(_, given)| *given);
    if let Some((option, _)) = flat {
        let path = path.display();
        return Err(Failure::input(format!(
            "{path}: {option}: expected a file of mode \"mountain\", this one is of mode \"globe\""
        )));
    }
    check_picture(args.common.picture)
}

/// The rendered picture is one of flat land.
#[cfg_attr(
    not(feature = "app"),
    expect(
        clippy::unnecessary_wraps,
        reason = "without the renderer there is only the map"
    )
)]
fn check_picture(choice: PictureChoice) -> Result<(), Failure> {
    match choice {
        #[cfg(feature = "app")]
        PictureChoice::Render => Err(Failure::input(
            "--picture render: expected map or none for a globe",
        )),
        _ => Ok(()),
    }
}

/// Plays a gesture file of the globe into a folder of its own.
pub(super) fn play(
    stem: &str,
    file: &GestureFile,
    args: &ReplayArgs,
    console: Console,
) -> Result<(), Failure> {
    let header = &file.header;
    let seed = args.common.seed.or(header.seed).unwrap_or(DEFAULT_SEED);
    let lattice = lattice(&args.common, header.nodes)?;
    let run = Run {
        stem,
        title: header.title.as_deref().unwrap_or(stem),
        common: &args.common,
        every_my: args.every,
        after_yr: args.years.or(header.years).unwrap_or(RUN_ON_YR),
    };
    let params = GlobeSimParams {
        globe: constants(args.paper),
        ..GlobeSimParams::default()
    };
    let sim = GlobeSim::new(lattice, default_start(seed), header.size_mm, params).map_err(Failure::input)?;
    run.play(sim, &file.frames, console)
}

/// A planet that nobody touches.
pub(super) fn run(args: &PlanetArgs, console: Console) -> Result<(), Failure> {
    if !(0.0..=1e9).contains(&args.years) {
        return Err(Failure::input(format!(
            "--years {}: expected 0 to 1e9",
            args.years
        )));
    }
    check_picture(args.common.picture)?;
    on_threads(args.common.threads, || {
        let lattice = lattice(&args.common, None)?;
        let seed = args.common.seed.unwrap_or(DEFAULT_SEED);
        let start = match (&args.elevation, &args.plate_colours) {
            (Some(elevation), Some(colours)) => {
                let maps =
                    read_planet(elevation, colours, args.metres.0, &lattice).map_err(Failure::input)?;
                Start::Maps {
                    elevation_m: maps.elevation_m,
                    plate: maps.plate,
                    seed,
                }
            }
            _ => Start::Random {
                plates: args.plates,
                continental: args.continental,
                seed,
            },
        };
        let mut globe = constants(args.paper);
        if let Some(sea_floor) = args.sea_floor {
            globe.sea_floor = match sea_floor {
                SeaFloorChoice::Gdh1 => SeaFloor::Gdh1,
                SeaFloorChoice::Damping => SeaFloor::Damping,
            };
        }
        let params = GlobeSimParams {
            globe,
            ..GlobeSimParams::default()
        };
        let sim = GlobeSim::new(lattice, start, NO_TABLE_MM, params).map_err(Failure::input)?;
        let run = Run {
            stem: "planet",
            title: "a planet",
            common: &args.common,
            every_my: args.every,
            after_yr: args.years,
        };
        run.play(sim, &[], console)
    })
}

fn constants(paper: bool) -> GlobeParams {
    if paper {
        GlobeParams::paper()
    } else {
        GlobeParams::planet()
    }
}

/// The samples that the user, the file or the default asks for.
fn lattice(common: &Common, of_file: Option<u64>) -> Result<Arc<Lattice>, Failure> {
    let nodes = common.nodes.map(u64::from).or(of_file);
    let samples = nodes.map_or(LIVE_SAMPLES, |nodes| nodes as usize);
    let lattice = Lattice::new(samples).map_err(|error| Failure::input(format!("--nodes: {error}")))?;
    Ok(Arc::new(lattice))
}

/// One session and where it goes.
struct Run<'a> {
    stem: &'a str,
    title: &'a str,
    common: &'a Common,
    every_my: Option<u32>,
    after_yr: f64,
}

impl Run<'_> {
    fn play(&self, mut sim: GlobeSim, frames: &[InputFrame], console: Console) -> Result<(), Failure> {
        // The folder is tried before the work, so that a bad --out costs no waiting.
        let out = OutDir::create(self.common.out.join(self.stem)).map_err(Failure::input)?;
        let mut timings = Timings::start();
        let dt = sim.params().globe.dt_my;
        let seconds = frames.last().map_or(0.0, |frame| frame.t_us as f64 / 1e6);
        let expected = (seconds * sim.pace_my_per_s() + self.after_yr / MY) / dt;
        let bar = console.progress(expected as u64, self.title);
        let mut past = Past::default();
        let mut maps = MapWriter {
            every_my: self.every_my,
            out: &out,
            width: self.common.size(),
            drawn: 0,
            next_my: 0.0,
        };
        for frame in frames {
            sim.feed(frame.clone());
        }
        while sim.input_waits() {
            let steps = sim.tick().steps;
            bar.inc(u64::from(steps));
            past.follow(&sim);
            // The first map is that of the planet which the file begins with.
            maps.draw(&sim)?;
        }
        past.follow(&sim);
        maps.draw(&sim)?;
        sim.finish_input();
        timings.lap("gestures");
        self.run_on(&mut sim, &mut past, &mut maps, &bar)?;
        bar.finish_and_clear();
        timings.lap("run_on");
        self.write(&sim, past, &out, timings)?;
        Console::result(&out.path().join(self.common.picture.shown()).display().to_string());
        Ok(())
    }

    fn run_on(
        &self,
        sim: &mut GlobeSim,
        past: &mut Past,
        maps: &mut MapWriter<'_>,
        bar: &ProgressBar,
    ) -> Result<(), Failure> {
        let until_my = sim.planet().time_my() + self.after_yr / MY;
        bar.set_length(bar.position() + (self.after_yr / MY / sim.params().globe.dt_my) as u64);
        let mut drawn = Ok(());
        sim.run_until(until_my, |sim| {
            bar.inc(1);
            past.follow(sim);
            drawn = maps.draw(sim);
            drawn.is_ok()
        });
        drawn
    }

    /// Writes all files of the planet as it is.
    fn write(
        &self,
        sim: &GlobeSim,
        mut past: Past,
        out: &OutDir,
        mut timings: Timings,
    ) -> Result<(), Failure> {
        let surface = sim.surface();
        timings.lap("surface");
        if self.common.picture.has_map() {
            write_pictures(out, &surface, sim, self.common.size())?;
        }
        timings.lap("pictures");
        past.end(&surface);
        files::write(out, &surface, &past.rotations, self.common.size() as usize).map_err(Failure::other)?;
        timings.lap("files");
        let report = GlobeReport::of_session(self.title, sim, &surface);
        write_json(out, "report.json", &report)?;
        write_json(out, "timings.json", &timings.finish())?;
        if report.totals.quarantined > 0 {
            Console::warn(&format!(
                "{} samples held numbers that are none and were taken out",
                report.totals.quarantined
            ));
        }
        Ok(())
    }
}

/// The map, the globe as the table last showed it, and the maps of single facts.
fn write_pictures(out: &OutDir, surface: &Planet, sim: &GlobeSim, width: u32) -> Result<(), Failure> {
    let pictures = [
        ("picture.png", world_map(surface, WorldMapStyle::default(), width)),
        ("globe.png", globe(surface, sim.view().orientation(), width / 2)),
        ("age.png", theme_map(surface, Theme::Age, width)),
        ("plates.png", theme_map(surface, Theme::Plates, width)),
        ("crust.png", theme_map(surface, Theme::Crust, width)),
        ("orogeny.png", theme_map(surface, Theme::Orogeny, width)),
    ];
    for (name, picture) in pictures {
        let png = png(&picture)?;
        out.write(name, |w| w.write_all(&png)).map_err(Failure::other)?;
    }
    Ok(())
}

/// How the plates turned, step by step.
#[derive(Default)]
struct Past {
    rotations: Vec<Rotation>,
    /// When it was looked last, My.
    last_my: f64,
    undone: u64,
}

impl Past {
    /// Notes where the plates are, where that is new. What undo or another start has taken back is forgotten.
    fn follow(&mut self, sim: &GlobeSim) {
        let planet = sim.planet();
        let now = planet.time_my();
        let undone = sim.counts().undone;
        if undone != self.undone && self.rotations.iter().any(|entry| entry.time_my == now) {
            self.rotations.retain(|entry| entry.time_my < now);
        } else if undone != self.undone || now < self.last_my || now == 0.0 {
            self.rotations.clear();
        } else if now == self.last_my {
            return;
        }
        (self.last_my, self.undone) = (now, undone);
        for id in planet.plate_ids() {
            if let Some((rotation, ..)) = planet.plate_state(id) {
                self.rotations.push(Rotation {
                    time_my: now,
                    plate: id,
                    rotation,
                });
            }
        }
    }

    /// Notes where the plates are as they are shown.
    fn end(&mut self, surface: &Planet) {
        self.rotations.retain(|entry| entry.time_my < surface.time_my);
        self.rotations.extend(surface.plates.iter().map(|plate| Rotation {
            time_my: surface.time_my,
            plate: plate.id,
            rotation: plate.rotation,
        }));
    }
}

/// Draws the maps of `--every`.
struct MapWriter<'a> {
    every_my: Option<u32>,
    out: &'a OutDir,
    width: u32,
    drawn: u32,
    /// When the next one is due, My.
    next_my: f64,
}

impl MapWriter<'_> {
    fn draw(&mut self, sim: &GlobeSim) -> Result<(), Failure> {
        let Some(every) = self.every_my else { return Ok(()) };
        let now = sim.planet().time_my();
        if now < self.next_my {
            return Ok(());
        }
        self.next_my = now + f64::from(every);
        let history = OutDir::create(self.out.path().join("history")).map_err(Failure::other)?;
        let style = WorldMapStyle {
            borders: false,
            ..WorldMapStyle::default()
        };
        let png = png(&world_map(&sim.planet().surface(0.0), style, self.width))?;
        let name = format!("map_{:04}.png", self.drawn);
        self.drawn += 1;
        history
            .write(&name, |w| w.write_all(&png))
            .map(drop)
            .map_err(Failure::other)
    }
}
