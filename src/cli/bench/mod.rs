//! `orogen bench`: every stage at the sizes of the literature, wall and CPU time, and one sentence for staff.

#[cfg(feature = "app")]
mod frames;
mod globe;
mod touch;
mod tuio;

use std::time::Instant;

use cpu_time::ProcessTime;
use glam::DVec2;
use serde::Serialize;

use super::console::Console;
use super::failure::Failure;
use super::{BenchArgs, on_threads};
use crate::gesture::contact::Side;
use crate::gesture::event::{HandEvent, HandId, Leg};
use crate::gesture::rigid::RigidFit;
use crate::isostasy::{Crust, Isostasy, IsostasyParams};
use crate::mountain::fold::lines::troughs;
use crate::mountain::fold::{FoldDrive, FoldMesh, FoldShape, Skeleton};
use crate::mountain::transport::{CpuTransport, MovedBody, TransportProblem, TransportStage};
use crate::mountain::{Grid, MountainParams, PlateSet, Tectonics};
use crate::picture::{MapStyle, relief_map};
use crate::surface::{Raster, Surface};
use crate::terrain::{Deposition, Erosion, ErosionParams, Forcing, Sediment, StartLand, Tin, TinRaster};
use crate::units::{DEFAULT_SHORT_SIDE, Extent, KM, PlanMap};

/// The square and the constants at which the literature's figures were taken: 100 × 100 km, U = 5e-4 m/yr,
/// k = 5.5e-7, m = 0.5, n = 1, dt = 1e5 yr.
const SQUARE: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};
const UPLIFT: f64 = 5e-4;
const DT_YR: f64 = 1e5;
const SEED: u64 = 1;
/// Steps until a network counts as developed (6 My); a million nodes get a tenth of that, to be done in a minute.
const DEVELOPED_STEPS: usize = 60;

/// One line of the result.
#[derive(Clone, Debug, Serialize)]
struct Row {
    stage: &'static str,
    size: usize,
    state: &'static str,
    threads: usize,
    wall_ms: f64,
    cpu_ms: f64,
    /// Highest memory use of the process while the stage ran, where the system tells.
    peak_mib: Option<f64>,
    /// What the stage's source reports for this size, ms.
    paper_ms: Option<f64>,
}

/// Runs all stages.
pub(super) fn run(args: &BenchArgs) -> Result<(), Failure> {
    let rows = on_threads(args.threads, || {
        let mut bench = Bench {
            rows: Vec::new(),
            json: args.json,
        };
        if !args.json {
            Console::result(
                "stage                       size  state       threads   wall ms    cpu ms  peak MiB  paper ms",
            );
        }
        let sizes: &[usize] = if args.million {
            &[10_000, 100_000, 1_000_000]
        } else {
            &[10_000, 60_000, 100_000]
        };
        for &nodes in sizes {
            bench.terrain(nodes)?;
        }
        bench.mountain();
        bench.folds()?;
        bench.picture()?;
        bench.globe()?;
        bench.touch()?;
        bench.tuio();
        #[cfg(feature = "app")]
        bench.frames();
        Ok(bench.rows)
    })?;
    if !args.json {
        Console::result(&verdict(&rows));
    }
    Ok(())
}

/// What this machine is good for, in one sentence.
fn verdict(rows: &[Row]) -> String {
    let wall = |stage: &str, size: usize| {
        let found = rows
            .iter()
            .find(|r| r.stage == stage && r.size == size && r.state == "developed");
        found.map_or(f64::INFINITY, |r| r.wall_ms)
    };
    let uplift = rows
        .iter()
        .find(|r| r.stage == "gesture_to_uplift")
        .map_or(f64::INFINITY, |r| r.wall_ms);
    // The live table takes 5 to 20 erosion steps a second; a step may fill half of the time between two.
    let smooth = |step_ms: f64| step_ms <= 50.0;
    let nodes = [100_000, 60_000, 10_000]
        .into_iter()
        .find(|&n| smooth(wall("erosion_step", n)));
    match nodes {
        Some(nodes) if uplift <= 33.0 => {
            format!(
                "This machine sculpts {nodes} nodes live, and new uplift follows a finger in {uplift:.0} ms."
            )
        }
        Some(nodes) => format!(
            "This machine erodes {nodes} nodes live, but new uplift takes {uplift:.0} ms, more than the 33 ms of a \
             smooth answer."
        ),
        None => "This machine is too slow for a live table; it can replay gestures to pictures.".to_owned(),
    }
}

struct Bench {
    rows: Vec<Row>,
    json: bool,
}

impl Bench {
    /// Runs `work` `runs` times and records the median run.
    fn time<T>(
        &mut self,
        (stage, size, state): (&'static str, usize, &'static str),
        paper_ms: Option<f64>,
        runs: usize,
        mut work: impl FnMut() -> T,
    ) -> T {
        reset_peak();
        let mut times = Vec::with_capacity(runs);
        let mut last = None;
        for _ in 0..runs.max(1) {
            let (wall, cpu) = (Instant::now(), ProcessTime::now());
            last = Some(std::hint::black_box(work()));
            times.push((
                wall.elapsed().as_secs_f64() * 1e3,
                cpu.elapsed().as_secs_f64() * 1e3,
            ));
        }
        let median = |pick: fn(&(f64, f64)) -> f64| {
            let mut values: Vec<f64> = times.iter().map(pick).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let row = Row {
            stage,
            size,
            state,
            threads: rayon::current_num_threads(),
            wall_ms: median(|t| t.0),
            cpu_ms: median(|t| t.1),
            peak_mib: peak_mib(),
            paper_ms,
        };
        self.print(&row);
        self.rows.push(row);
        last.unwrap_or_else(work)
    }

    fn print(&self, row: &Row) {
        if self.json {
            if let Ok(line) = serde_json::to_string(row) {
                Console::result(&line);
            }
            return;
        }
        let optional = |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.1}"));
        Console::result(&format!(
            "{:<22} {:>9}  {:<10} {:>8} {:>9.2} {:>9.2} {:>9} {:>9}",
            row.stage,
            row.size,
            row.state,
            row.threads,
            row.wall_ms,
            row.cpu_ms,
            optional(row.peak_mib),
            optional(row.paper_ms)
        ));
    }

    /// A line that is no row.
    #[cfg(feature = "app")]
    fn note(&self, text: &str) {
        if !self.json {
            Console::result(text);
        }
    }

    /// TIN build, the cold first step, and steps on a developed network with landslides and without.
    fn terrain(&mut self, nodes: usize) -> Result<(), Failure> {
        let runs = if nodes > 200_000 { 1 } else { 5 };
        let tin = self
            .time(("tin_build", nodes, "–"), None, runs, || {
                Tin::poisson(SQUARE, nodes, SEED)
            })
            .map_err(Failure::other)?;
        // The paper: 10 ms at 10,000 nodes and 4 s at a million.
        let paper_ms = match nodes {
            10_000 => Some(10.0),
            1_000_000 => Some(4000.0),
            _ => None,
        };
        let params = ErosionParams {
            k: 5.5e-7,
            ..ErosionParams::default()
        };
        let bare = ErosionParams {
            landslides: false,
            ..params
        };
        let uplift = vec![UPLIFT; tin.len()];
        let forcing = Forcing::uplift(&uplift);
        let start = StartLand::new(SEED).heights(&tin);

        let mut z = start.clone();
        let mut erosion = Erosion::new(&tin);
        self.time(("erosion_step", nodes, "cold"), paper_ms, 1, || {
            erosion.step(&tin, &mut z, &forcing, &params, DT_YR)
        });
        let steps = if nodes > 200_000 {
            DEVELOPED_STEPS / 10
        } else {
            DEVELOPED_STEPS
        };
        for _ in 0..steps {
            erosion.step(&tin, &mut z, &forcing, &params, DT_YR);
        }
        let runs = if nodes > 200_000 { 3 } else { 11 };
        self.time(("erosion_step", nodes, "developed"), paper_ms, runs, || {
            erosion.step(&tin, &mut z, &forcing, &params, DT_YR)
        });
        self.time(
            ("erosion_no_landslides", nodes, "developed"),
            paper_ms,
            runs,
            || erosion.step(&tin, &mut z, &forcing, &bare, DT_YR),
        );
        self.floating(nodes, &tin, &mut z, &params);
        Ok(())
    }

    /// Steps of a developed land that keeps its sediment, and the answer of the crust under it.
    fn floating(&mut self, nodes: usize, tin: &Tin, z: &mut [f64], params: &ErosionParams) {
        let runs = if nodes > 200_000 { 3 } else { 11 };
        let params = ErosionParams {
            deposition: Some(Deposition::default()),
            ..*params
        };
        let mut uplift = vec![UPLIFT; nodes];
        let forcing = Forcing::uplift(&uplift);
        let mut sediment = Sediment::new(nodes);
        let mut erosion = Erosion::new(tin);
        for _ in 0..DEVELOPED_STEPS / 10 {
            erosion.step_with_sediment(tin, z, &mut sediment, &forcing, &params, DT_YR);
        }
        self.time(("erosion_step", nodes, "deposition"), None, runs, || {
            erosion.step_with_sediment(tin, z, &mut sediment, &forcing, &params, DT_YR)
        });
        let thickening = vec![UPLIFT; nodes];
        let floats = IsostasyParams::default();
        let mut isostasy = Isostasy::new(tin, &floats);
        let mut crust = Crust::new(nodes);
        self.time(("flexure", nodes, "–"), None, runs, || {
            isostasy.uplift(&mut crust, &thickening, &floats, DT_YR, &mut uplift);
        });
    }

    /// Transport of three plates on 1024² cells, and the whole way from a moved finger to new uplift.
    fn mountain(&mut self) {
        let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
        let params = MountainParams::default();
        let mut tectonics = Tectonics::default();
        let plates = three_plates(&map, &params);
        let cells = 1024 * 1024;
        let mut field = tectonics.compute(&plates, map.extent(), 0.0, &params);
        let moved = plates.bodies(0.0).into_iter().map(|body| MovedBody {
            hull: body.support.moved(&body.motion),
            motion: body.motion,
        });
        let problem = TransportProblem {
            grid: field.transport.grid,
            bodies: moved.collect(),
            exponent: params.exponent,
            rest_weight: params.rest_weight(),
        };
        self.time(("transport", cells, "3 plates"), Some(10.0), 11, || {
            CpuTransport.run(&problem, &mut field.transport);
        });
        self.time(("gesture_to_uplift", cells, "3 plates"), None, 11, || {
            tectonics.compute_into(&plates, map.extent(), 0.0, &params, &mut field);
        });
    }

    /// Skeletons of folds, crests and troughs together, at about the sizes of the literature (955, 4,246 and 36,715
    /// lines), and their heights on 1024² cells.
    fn folds(&mut self) -> Result<(), Failure> {
        let grid = Grid::over(SQUARE, 1024 * 1024);
        let drive = FoldDrive::uniform(grid.blocks(), UPLIFT, 0.4);
        let sizes = [
            ("7 km", 7.0, 0.9, 2.1),
            ("3 km", 3.0, 3.7, 1.4),
            ("1 km", 1.0, 53.0, 2.8),
        ];
        for (state, wavelength, skeletons_ms, heights_ms) in sizes {
            let mesh = FoldMesh::new(SQUARE, wavelength * KM, SEED).map_err(Failure::other)?;
            let choose = || {
                let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
                let lines = skeleton.top_len() + troughs(&mesh, &skeleton).len();
                (skeleton, lines)
            };
            let (skeleton, lines) = choose();
            self.time(("fold_skeletons", lines, state), Some(skeletons_ms), 21, choose);
            let mut heights = Vec::new();
            self.time(("fold_heights", grid.len(), state), Some(heights_ms), 11, || {
                FoldShape::new(&mesh, &skeleton).on_grid(grid, &mut heights);
            });
        }
        Ok(())
    }

    /// The relief map at 1920 × 1080.
    fn picture(&mut self) -> Result<(), Failure> {
        let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
        let tin = Tin::poisson(map.extent(), 60_000, SEED).map_err(Failure::other)?;
        let z = StartLand::new(SEED).heights(&tin);
        let raster = self.time(("rasterise", 1920 * 1080, "60k nodes"), None, 3, || {
            TinRaster::new(&tin, 1920, 1080)
        });
        let field = |data| Raster {
            width: 1920,
            height: 1080,
            extent: tin.extent(),
            data,
        };
        let height = field(raster.smooth(&tin, &z));
        let surface = Surface {
            lake_depth: field(vec![0.0; 1920 * 1080]),
            drainage: field(vec![0.0; 1920 * 1080]),
            height,
            spacing: (tin.extent().area() / tin.len() as f64).sqrt(),
            rivers: Vec::new(),
            plates: Vec::new(),
            faults: Vec::new(),
            folds: Vec::new(),
            strata: None,
            elapsed_yr: 0.0,
        };
        self.time(("relief_map", 1920 * 1080, "–"), None, 3, || {
            relief_map(&surface, &MapStyle::default(), 1920, 1080)
        });
        Ok(())
    }
}

/// Three hands of five fingers, one resting and two pushing towards it.
fn three_plates(map: &PlanMap, params: &MountainParams) -> PlateSet {
    let mut plates = PlateSet::default();
    let hand = |x: f64, y: f64| -> Vec<DVec2> {
        (0..5)
            .map(|i| DVec2::new(x + 18.0 * f64::from(i % 2), y + 35.0 * f64::from(i) - 70.0))
            .collect()
    };
    let rest = HandEvent::Rest {
        hand: HandId(0),
        side: Side::South,
        fingers: hand(300.0, 340.0),
    };
    plates.apply(&rest, map, 0.0, params);
    for (id, x, y, push) in [
        (1, 850.0, 200.0, DVec2::new(-90.0, 10.0)),
        (2, 850.0, 520.0, DVec2::new(-70.0, -20.0)),
    ] {
        let starts = hand(x, y);
        let ends: Vec<DVec2> = starts.iter().map(|&p| p + push).collect();
        let leg = Leg {
            hand: HandId(id),
            index: 0,
        };
        let fit = RigidFit::fit(&starts, &ends);
        plates.apply(
            &HandEvent::Push {
                leg,
                side: Side::South,
                starts,
                fit,
            },
            map,
            0.0,
            params,
        );
    }
    plates
}

/// Starts a new measurement of the highest memory use. Only Linux tells, and only there it can be reset.
fn reset_peak() {
    // Refused in some containers; then the figure is that of the whole run so far.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Highest memory use since [`reset_peak`], MiB.
fn peak_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}
