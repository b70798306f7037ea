//! `orogen erode`: uplift in, eroded land out.

use std::path::Path;

use serde::Serialize;

use super::console::Console;
use super::failure::Failure;
use super::output::{LandFiles, Marks, Pictures, Timings, write_json};
use super::{EdgeChoice, ErodeArgs, Switch, memory, on_threads};
use crate::export::{OutDir, digest};
use crate::input::maps::{MapKind, read_map};
use crate::report::{Inputs, REPORT_VERSION, TerrainFacts};
use crate::surface::Raster;
use crate::terrain::{Edges, Erosion, ErosionParams, Flow, Forcing, StartLand, Tin};
use crate::units::{Extent, KM};

/// Nodes where the user does not say.
const DEFAULT_NODES: u32 = 60_000;
/// Seed where the user does not say.
const DEFAULT_SEED: u64 = 1;
/// Uplift beyond this is no uplift of the Earth, m/yr (the fastest known are some 0.01).
const MOST_UPLIFT: f64 = 1.0;

/// Uplift as the user gave it.
enum Uplift {
    Constant(f64),
    Map(Raster),
}

/// The maps of a run, all laid over the same ground.
struct Maps {
    uplift: Uplift,
    start: Option<Raster>,
    erodibility: Option<Raster>,
    rain: Option<Raster>,
    protect: Option<Raster>,
    extent: Extent,
}

/// `report.json` of a batch erosion.
#[derive(Serialize)]
struct ErodeReport {
    format_version: u32,
    orogen: &'static str,
    inputs: Inputs,
    terrain: TerrainFacts,
    digest: String,
}

/// Erodes what `args` describe.
pub(super) fn run(args: &ErodeArgs, console: Console) -> Result<(), Failure> {
    let params = params(args)?;
    within("--years", args.years, 0.0, 1e9)?;
    within("--dt", args.dt, 1.0, 1e8)?;
    within("--km", args.km, 0.01, 100_000.0)?;
    memory::check(nodes(args))?;
    on_threads(args.common.threads, || {
        let maps = Maps::read(args)?;
        let stem = name(args);
        let pictures = Pictures::new(args.common.picture)?;
        let out = OutDir::create(args.common.out.join(&stem)).map_err(Failure::input)?;
        erode(args, &maps, &params, &stem, (&out, &pictures), console)
    })
}

fn nodes(args: &ErodeArgs) -> usize {
    args.common.nodes.unwrap_or(DEFAULT_NODES) as usize
}

fn within(option: &str, value: f64, low: f64, high: f64) -> Result<(), Failure> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(Failure::input(format!(
        "{option} {value}: expected {low} to {high}"
    )))
}

fn params(args: &ErodeArgs) -> Result<ErosionParams, Failure> {
    let mut params = ErosionParams::default();
    if let Some(k) = args.k {
        within("--k", k, 0.0, 1.0)?;
        params.k = k;
    }
    if let Some(m) = args.m {
        within("--m", m, 0.0, 2.0)?;
        params.m = m;
    }
    if let Some(n) = args.n {
        within("--n", n, 0.1, 5.0)?;
        params.n = n;
    }
    if let Some(degrees) = args.talus {
        within("--talus", degrees, 1.0, 89.0)?;
        params.talus = degrees.to_radians().tan();
    }
    if let Some(level) = args.base_level {
        within("--base-level", level, -12_000.0, 12_000.0)?;
        params.base_level = Some(level);
    }
    params.landslides = args.landslide == Switch::On;
    params.edges = match args.edges {
        EdgeChoice::Fixed => Edges::Fixed,
        EdgeChoice::Free => Edges::Free,
    };
    Ok(params)
}

/// The name of the run: the start surface's or the uplift map's, without its ending.
fn name(args: &ErodeArgs) -> String {
    let map = args.start.as_deref().unwrap_or_else(|| Path::new(&args.uplift));
    if args.start.is_none() && args.uplift.parse::<f64>().is_ok() {
        return "erode".to_owned();
    }
    map.file_stem()
        .map_or_else(|| "erode".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

impl Maps {
    fn read(args: &ErodeArgs) -> Result<Self, Failure> {
        let uplift = match args.uplift.parse::<f64>() {
            Ok(constant) => {
                within("--uplift", constant, -MOST_UPLIFT, MOST_UPLIFT)?;
                Uplift::Constant(constant)
            }
            Err(_) => {
                Uplift::Map(read_map(Path::new(&args.uplift), MapKind::Uplift).map_err(Failure::input)?)
            }
        };
        let read = |path: &Option<std::path::PathBuf>, kind| {
            path.as_deref()
                .map(|path| read_map(path, kind))
                .transpose()
                .map_err(Failure::input)
        };
        let mut maps = Self {
            uplift,
            start: read(&args.start, MapKind::Start)?,
            erodibility: read(&args.erodibility, MapKind::Erodibility)?,
            rain: read(&args.rain, MapKind::Rain)?,
            protect: read(&args.protect, MapKind::Protect)?,
            extent: Extent {
                width: args.km * KM,
                height: args.km * KM,
            },
        };
        maps.lay_over_ground()?;
        Ok(maps)
    }

    /// The first map that there is gives the ground its shape; the others must have it too.
    fn lay_over_ground(&mut self) -> Result<(), Failure> {
        let mut all: Vec<(&str, &mut Raster)> = Vec::new();
        if let Some(start) = &mut self.start {
            all.push(("--start", start));
        }
        if let Uplift::Map(map) = &mut self.uplift {
            all.push(("--uplift", map));
        }
        let rest = [
            ("--erodibility", &mut self.erodibility),
            ("--rain", &mut self.rain),
            ("--protect", &mut self.protect),
        ];
        all.extend(
            rest.into_iter()
                .filter_map(|(name, map)| map.as_mut().map(|map| (name, map))),
        );
        let Some((first, shape)) = all.first().map(|(name, map)| (*name, (map.width, map.height))) else {
            return Ok(());
        };
        self.extent.height = self.extent.width * shape.1 as f64 / shape.0 as f64;
        for (name, map) in all {
            // One pixel of rounding is allowed: a map of half the resolution has the same shape.
            let off = (map.width * shape.1).abs_diff(map.height * shape.0);
            if off > map.width.max(map.height).max(shape.0).max(shape.1) {
                return Err(Failure::input(format!(
                    "{name}: {} × {} pixels; expected the shape of {first}, {} × {}",
                    map.width, map.height, shape.0, shape.1
                )));
            }
            map.extent = self.extent;
        }
        Ok(())
    }
}

/// A map's values at the nodes.
fn at_nodes(tin: &Tin, map: &Raster) -> Vec<f64> {
    tin.positions()
        .iter()
        .map(|&p| f64::from(map.sample(p)))
        .collect()
}

fn erode(
    args: &ErodeArgs,
    maps: &Maps,
    params: &ErosionParams,
    title: &str,
    (out, pictures): (&OutDir, &Pictures),
    console: Console,
) -> Result<(), Failure> {
    let mut timings = Timings::start();
    let seed = args.common.seed.unwrap_or(DEFAULT_SEED);
    let tin = Tin::poisson(maps.extent, nodes(args), seed).map_err(Failure::input)?;
    let mut z = maps
        .start
        .as_ref()
        .map_or_else(|| StartLand::new(seed).heights(&tin), |map| at_nodes(&tin, map));
    let uplift = match &maps.uplift {
        Uplift::Constant(rate) => vec![*rate; tin.len()],
        Uplift::Map(map) => at_nodes(&tin, map),
    };
    let of = |map: &Option<Raster>| map.as_ref().map(|map| at_nodes(&tin, map));
    let (erodibility, rain, protect) = (of(&maps.erodibility), of(&maps.rain), of(&maps.protect));
    let forcing = Forcing {
        uplift: &uplift,
        erodibility: erodibility.as_deref(),
        talus: None,
        rain: rain.as_deref(),
        protect: protect.as_deref(),
    };
    timings.lap("start");

    let steps = (args.years / args.dt).ceil() as u64;
    let bar = console.progress(steps, title);
    let mut erosion = Erosion::new(&tin);
    let (mut uplifted, mut eroded) = (0.0, 0.0);
    for step in 0..steps {
        // The last step may be shorter, so that the years come out exactly.
        let dt = args.dt.min(args.years - step as f64 * args.dt);
        let sums = erosion.step(&tin, &mut z, &forcing, params, dt);
        uplifted += sums.uplifted_m3;
        eroded += sums.fluvial_m3 + sums.landslide_m3;
        if z.iter().any(|z| !z.is_finite()) {
            let year = (step + 1) as f64 * args.dt;
            return Err(Failure::other(format!(
                "the land lost its heights in year {year:.0}; nothing was written"
            )));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    timings.lap("erosion");

    let risen: Vec<f64> = uplift.iter().map(|u| u * args.years).collect();
    let mut flow = Flow::new(&tin);
    flow.route(&tin, &z, params.edges.into(), rain.as_deref());
    let mut terrain = TerrainFacts::new(&tin, &z, &flow, &risen);
    terrain.years = args.years;
    terrain.steps = steps;
    terrain.uplifted_km3 = uplifted / 1e9;
    terrain.eroded_km3 = eroded / 1e9;
    let report = ErodeReport {
        format_version: REPORT_VERSION,
        orogen: env!("CARGO_PKG_VERSION"),
        inputs: Inputs {
            layers: None,
            title: title.to_owned(),
            seed,
            nodes: tin.len(),
            size_km: [maps.extent.width / KM, maps.extent.height / KM],
            dt_yr: args.dt,
            k: params.k,
            m: params.m,
            n: params.n,
        },
        terrain,
        digest: digest(&z),
    };
    let k: Vec<f64> = match &erodibility {
        Some(factors) => factors.iter().map(|f| f * params.k).collect(),
        None => vec![params.k; tin.len()],
    };
    let land = LandFiles {
        title,
        tin: &tin,
        z: &z,
        uplift: &uplift,
        flow: &flow,
        k: &k,
        marks: Marks::default(),
        under: None,
        elapsed_yr: args.years,
    };
    land.write(out, args.common.size(), pictures, &mut timings)?;
    write_json(out, "report.json", &report)?;
    write_json(out, "timings.json", &timings.finish())?;
    Console::result(&out.path().join(args.common.picture.shown()).display().to_string());
    Ok(())
}
