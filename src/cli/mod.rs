//! The commands. Everything that touches files, threads, the clock and the terminal is here.

mod bench;
mod console;
mod devices;
mod erode;
mod export_evemu;
mod failure;
mod globe;
mod import;
mod memory;
mod output;
#[cfg(feature = "app")]
mod record;
mod refine;
#[cfg(feature = "app")]
mod render;
mod replay;
mod slice;
#[cfg(feature = "app")]
mod table;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::DVec2;

use crate::sim::refine::Region;
use crate::slice::parse_ends;
use console::Console;
use failure::Failure;

/// Put both hands on the table and push: each hand is a tectonic plate, and between them mountains rise.
///
/// Without a command Orogen opens the table, full screen. Where there is no display or no graphics, it says so, plays
/// its built-in session into ./orogen-out and names the pictures.
#[derive(Debug, Parser)]
#[command(
    name = "orogen",
    version,
    propagate_version = true,
    args_conflicts_with_subcommands = true
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[cfg(feature = "app")]
    #[command(flatten)]
    table: TableArgs,
    /// Say only what went wrong.
    #[arg(long, short, global = true)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The table for unattended machines: no way out for visitors, and no fall-back without a display.
    #[cfg(feature = "app")]
    Kiosk(TableArgs),
    /// Play gesture files (none: the built-in session) through the same code as the table, without a display.
    Replay(ReplayArgs),
    /// Let a planet of moving plates grow older: a random one, or one from two images.
    Planet(PlanetArgs),
    /// Erode a terrain in batch: uplift in, eroded land out.
    Erode(ErodeArgs),
    /// Turn a recording of another tool into a gesture file.
    Import(ImportArgs),
    /// The touch devices that are plugged in, or what a HID report descriptor means.
    Devices(DevicesArgs),
    /// Record contacts as a gesture file: of the table in its window, of TUIO, or of a raw touchscreen.
    #[cfg(feature = "app")]
    Record(RecordArgs),
    /// Turn a gesture file into an evemu recording, which evemu-play and others play on Linux.
    ExportEvemu(ExportEvemuArgs),
    /// Is this machine fast enough? Every stage at the sizes of the literature.
    Bench(BenchArgs),
}

/// How the table opens.
#[cfg(feature = "app")]
#[derive(Clone, Debug, Default, Args)]
struct TableArgs {
    /// A window instead of the full screen.
    #[arg(long)]
    windowed: bool,
    /// Size of the window in pixels; implies --windowed.
    #[arg(long, value_name = "WxH", value_parser = table::window_size)]
    size: Option<[u32; 2]>,
    /// Which monitor, counted from 1 (default: the primary one).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    monitor: Option<u16>,
    /// Which world to begin with.
    #[arg(long, value_enum)]
    mode: Option<table::ModeChoice>,
    /// Rock under new land: a preset, or a TOML file (default: the settings').
    #[arg(long, value_name = "NAME|FILE")]
    layers: Option<String>,
    /// Settings file (TOML); it is written when staff save their changes.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Write figures as JSON lines, one each second.
    #[arg(long, value_name = "FILE")]
    metrics: Option<PathBuf>,
}

/// Which pictures to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PictureChoice {
    /// The relief map.
    Map,
    /// The land at evening, seen aslant as the table shows it; needs a graphics adapter.
    #[cfg(feature = "app")]
    Render,
    /// Both; where there is no graphics adapter, the map alone.
    #[cfg(feature = "app")]
    Both,
    /// No picture.
    None,
}

impl PictureChoice {
    fn has_map(self) -> bool {
        match self {
            Self::Map => true,
            #[cfg(feature = "app")]
            Self::Both => true,
            _ => false,
        }
    }

    /// The file to name when all is done.
    fn shown(self) -> &'static str {
        match self {
            Self::None => "report.json",
            #[cfg(feature = "app")]
            Self::Render => render::FILE,
            _ => "picture.png",
        }
    }
}

/// What all commands that compute a land have in common.
#[derive(Debug, Args)]
struct Common {
    /// Folder for the results; each run gets a folder of its own in it.
    #[arg(long, value_name = "DIR", default_value = "orogen-out")]
    out: PathBuf,
    /// The one seed of the world (default: the file's, else 1).
    #[arg(long)]
    seed: Option<u64>,
    /// Threads to compute with; the results are the same bits for any number (default: all cores).
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Nodes of the terrain, samples of a planet (default: the file's, else 60000; at final quality a
    /// million).
    #[arg(long, value_parser = clap::value_parser!(u32).range(16..=4_000_000))]
    nodes: Option<u32>,
    /// Pixels along the width of pictures and height maps, such as 1009, 2017, 4033, 8129 or a power of two (default:
    /// 1920, at final quality 3840).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=16384))]
    size: Option<u32>,
    /// Which picture to draw.
    #[arg(long, value_enum, default_value_t = PictureChoice::Map)]
    picture: PictureChoice,
}

impl Common {
    /// Pixels along the width where the user names none.
    const SIZE: u32 = 1920;

    fn size(&self) -> u32 {
        self.size.unwrap_or(Self::SIZE)
    }
}

/// How finely a land is worked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Quality {
    /// As the table shows it.
    Live,
    /// A million nodes (or --nodes), all folds, and pictures 3840 pixels wide: takes a minute or two.
    Final,
}

#[derive(Debug, Args)]
struct ReplayArgs {
    /// Gesture files (*.gesture.jsonl).
    files: Vec<PathBuf>,
    #[command(flatten)]
    common: Common,
    /// Model years that the world runs on after the last push (default: the file's, else 5e6, and 20e6 on a globe).
    #[arg(long, allow_negative_numbers = true)]
    years: Option<f64>,
    /// How finely the land is worked out.
    #[arg(long, value_enum, default_value_t = Quality::Live)]
    quality: Quality,
    /// Also refine a box of the final land: its south-west corner and its side in km (4 to 16), and metres between nodes
    /// (2 to 10; default 5), into `region/`.
    #[arg(long, value_name = "X,Y,SIDE[,METRES]", value_parser = refine::region, allow_hyphen_values = true)]
    region: Option<Region>,
    /// Rock under the land: a preset (plain, jura, zagros, andes, digne, …), or a TOML file.
    #[arg(long, value_name = "NAME|FILE", default_value = "plain")]
    layers: String,
    /// Use the rules of the papers instead of Orogen's own defaults (no rest weight, tapers or rifts; on a globe the
    /// printed constants).
    #[arg(long)]
    paper: bool,
    /// Also draw a picture every N erosion steps, into `frames/`; on a globe a map every N My, into `history/`.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    every: Option<u32>,
    /// Whether the crust floats: it sinks under a range, and rises where it is eroded.
    #[arg(long, value_enum, default_value_t = Switch::On)]
    isostasy: Switch,
    /// Whether rivers lay down what they carry.
    #[arg(long, value_enum, default_value_t = Switch::On)]
    deposition: Switch,
    /// Also draw a cross-section between two points of the plan, in km from the south-west corner (x east, y north), as
    /// slice.svg and slice.png; may be given several times.
    #[arg(long = "slice", value_name = "X0,Y0,X1,Y1", value_parser = parse_ends, allow_hyphen_values = true)]
    slices: Vec<[DVec2; 2]>,
    /// Who computes transport and heights of folds. The processor's results are the same bits on every machine; a
    /// graphics card's are as right, but equal to those only within rounding, and report.json says `reproducible: false`.
    #[cfg(feature = "app")]
    #[arg(long, value_enum, default_value_t = StageChoice::Cpu)]
    stages: StageChoice,
}

/// Who computes the stages that a graphics card can compute.
#[cfg(feature = "app")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StageChoice {
    /// The processor.
    Cpu,
    /// A graphics card.
    Gpu,
}

#[derive(Debug, Args)]
struct PlanetArgs {
    #[command(flatten)]
    common: Common,
    /// Plates of a random planet.
    #[arg(long, value_name = "N", default_value_t = 40, conflicts_with = "elevation")]
    plates: u32,
    /// Share of a random planet that is continental crust, 0 to 1; some of it lies below the sea.
    #[arg(
        long,
        value_name = "SHARE",
        default_value_t = 0.3,
        conflicts_with = "elevation"
    )]
    continental: f64,
    /// Heights to begin with: an equirectangular image twice as wide as high (EXR in metres, or PNG as --metres says).
    #[arg(long, value_name = "IMAGE", requires = "plate_colours")]
    elevation: Option<PathBuf>,
    /// Plates to begin with: the same, one colour for each plate.
    #[arg(long, value_name = "IMAGE", requires = "elevation")]
    plate_colours: Option<PathBuf>,
    /// Heights of black and of white in a PNG of heights, metres.
    #[arg(long, value_name = "BLACK,WHITE", default_value = "-10000,10000", value_parser = globe::metres, allow_hyphen_values = true)]
    metres: globe::Metres,
    /// Model years.
    #[arg(long, default_value_t = 100e6, allow_negative_numbers = true)]
    years: f64,
    /// Also draw a map every N My, into `history/`.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    every: Option<u32>,
    /// Use the constants of the paper as printed instead of Orogen's own.
    #[arg(long)]
    paper: bool,
    /// How the sea floor sinks as it grows older (default: gdh1, with --paper damping).
    #[arg(long, value_enum)]
    sea_floor: Option<SeaFloorChoice>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SeaFloorChoice {
    /// By plate cooling (Stein and Stein 1992).
    Gdh1,
    /// By the paper's damping towards the depth of trenches.
    Damping,
}

#[derive(Debug, Args)]
struct ErodeArgs {
    /// Uplift: a map (EXR in m/yr, or PNG whose white is 1e-3 m/yr), or one number in m/yr for a square map.
    #[arg(long, value_name = "MAP|U", allow_negative_numbers = true)]
    uplift: String,
    #[command(flatten)]
    common: Common,
    /// Start surface in metres (EXR, or PNG with the .json that Orogen writes beside its own; otherwise white is
    /// 6553.5 m). Default: 1 m noise on smooth hills, from the seed.
    #[arg(long, value_name = "MAP")]
    start: Option<PathBuf>,
    /// Width of the map on the ground, km; its height follows from the shape of the maps.
    #[arg(long, value_name = "WIDTH", default_value_t = 100.0)]
    km: f64,
    /// Model years.
    #[arg(long, default_value_t = 5e6)]
    years: f64,
    /// Years in one step.
    #[arg(long, default_value_t = 50_000.0)]
    dt: f64,
    /// Erosion constant k, y⁻¹ for m = 0.5.
    #[arg(long)]
    k: Option<f64>,
    /// Exponent of the drainage area.
    #[arg(long)]
    m: Option<f64>,
    /// Exponent of the slope.
    #[arg(long)]
    n: Option<f64>,
    /// Slope at which hillsides begin to slide, degrees.
    #[arg(long, value_name = "DEGREES")]
    talus: Option<f64>,
    /// Landslides.
    #[arg(long, value_enum, default_value_t = Switch::On)]
    landslide: Switch,
    /// Erodibility: a factor on k (EXR, or PNG whose white is 2).
    #[arg(long, value_name = "MAP")]
    erodibility: Option<PathBuf>,
    /// Rain: a factor on the water that falls (EXR, or PNG whose white is 2).
    #[arg(long, value_name = "MAP")]
    rain: Option<PathBuf>,
    /// Protected ground: white is left as it is.
    #[arg(long, value_name = "MASK")]
    protect: Option<PathBuf>,
    /// What the border does.
    #[arg(long, value_enum, default_value_t = EdgeChoice::Fixed)]
    edges: EdgeChoice,
    /// Height of the sea at the border, metres (default: the border keeps the heights of the start surface).
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    base_level: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Switch {
    On,
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EdgeChoice {
    /// Water leaves across the border, whose height stays.
    Fixed,
    /// Water leaves across the border, which rises and is cut like all land.
    Free,
}

#[derive(Debug, Args)]
struct ImportArgs {
    /// The recording.
    file: PathBuf,
    /// The gesture file to write.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Range of the device's coordinates, where the recording does not tell or is wrong.
    #[arg(long, value_name = "X0,X1,Y0,Y1", allow_negative_numbers = true)]
    range: Option<String>,
    /// Size of the device's surface in millimetres, where the recording does not tell or is wrong.
    #[arg(long, value_name = "W,H")]
    size_mm: Option<String>,
}

#[derive(Debug, Args)]
struct DevicesArgs {
    /// Explain this descriptor instead: hexadecimal in any form, or a recording of hid-recorder.
    #[arg(long, value_name = "HEXFILE")]
    descriptor: Option<PathBuf>,
    /// For tools: one object for a descriptor, a list of them for what is plugged in.
    #[arg(long)]
    json: bool,
    /// Print the udev rule that lets you listen to the touchscreens that are plugged in.
    #[arg(long, conflicts_with_all = ["descriptor", "json"])]
    udev: bool,
}

/// What is recorded.
#[cfg(feature = "app")]
#[derive(Debug, Args)]
struct RecordArgs {
    /// The gesture file to write; it must not be there yet.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Record what TUIO senders on this machine say, instead of the table (default port: 3333).
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "3333", conflicts_with = "hid", value_parser = clap::value_parser!(u16).range(1..))]
    tuio: Option<u16>,
    /// Record a raw touchscreen, instead of the table (default: the first one that is there).
    #[arg(long, value_name = "PATH", num_args = 0..=1, default_missing_value = "")]
    hid: Option<String>,
    /// Size of the touching surface in millimetres, where the device does not tell.
    #[arg(long, value_name = "W,H")]
    size_mm: Option<String>,
    /// End after so many seconds (default: when the program is ended).
    #[arg(long, value_name = "N")]
    seconds: Option<f64>,
    #[command(flatten)]
    table: TableArgs,
}

#[derive(Debug, Args)]
struct ExportEvemuArgs {
    /// The gesture file.
    file: PathBuf,
    /// The recording to write.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Debug, Args)]
struct BenchArgs {
    /// JSON lines instead of a table.
    #[arg(long)]
    json: bool,
    /// Also a million nodes (about a minute more).
    #[arg(long)]
    million: bool,
    /// Threads to compute with (default: all cores).
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Runs the command line and yields the exit code: 0 done, 2 bad usage or input, 3 no graphics adapter, 1
/// anything else.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    let console = Console::new(cli.quiet);
    let done = match cli.command {
        #[cfg(feature = "app")]
        None => table::open(&cli.table, console),
        #[cfg(not(feature = "app"))]
        None => replay::builtin(console),
        #[cfg(feature = "app")]
        Some(Command::Kiosk(args)) => table::kiosk(&args),
        Some(Command::Replay(args)) => replay::run(&args, console),
        Some(Command::Planet(args)) => globe::run(&args, console),
        Some(Command::Erode(args)) => erode::run(&args, console),
        Some(Command::Import(args)) => import::run(&args),
        Some(Command::Devices(args)) => devices::run(&args, console),
        #[cfg(feature = "app")]
        Some(Command::Record(args)) => record::run(&args, console),
        Some(Command::ExportEvemu(args)) => export_evemu::run(&args),
        Some(Command::Bench(args)) => bench::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            Console::error(&failure.to_string());
            failure.code()
        }
    }
}

/// Help and version print as they are; a usage error becomes one line.
fn usage(error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return if error.print().is_ok() {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        };
    }
    let text = error.to_string();
    let lines: Vec<&str> = text
        .lines()
        .map(str::trim)
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"))
        .filter(|line| !line.is_empty())
        .collect();
    let line = lines.join(" ");
    let line = line.strip_prefix("error: ").unwrap_or(&line);
    Console::error(&format!("{line} (see `orogen --help`)"));
    ExitCode::from(2)
}

/// Runs `work` on a pool of `threads` threads, all cores if `None`.
fn on_threads<T: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, usize::from))
        .thread_name(|i| format!("orogen-{i}"))
        .build()
        .map_err(Failure::other)?;
    pool.install(work)
}
