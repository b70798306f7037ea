//! Window, event loop, threads and metrics: the table as a program.
//!
//! Three threads: the one that runs [`run`] owns window, graphics and all that decides whose contact is whose; the
//! session's thread ([`crate::live`]) owns the world; the watch reads the heartbeats of both. This is the only module
//! beside the command line that reads a clock, and it hands the time on as a number.

mod circle;
mod eye;
mod governor;
mod graphics;
mod hud;
mod keeper;
mod keys;
mod layers;
mod listen;
mod log;
mod metrics;
mod nodes;
mod record;
mod save;
mod screen;
mod setup;
mod sheets;
mod shows;
mod stages;
mod table;
mod told;
mod touch;
mod watch;
mod window;
mod worlds;

use std::io;
use std::path::PathBuf;

use winit::event_loop::EventLoop;

use crate::gesture::command::Mode;
use crate::input::pile::PileError;
use crate::settings::{Settings, SettingsError};
pub use save::{LongWork, SaveLand, SavedLand};

/// How the table opens.
#[derive(Clone)]
pub struct Options {
    /// Unattended: no way out but the staff's.
    pub kiosk: bool,
    /// In a window instead of on the full screen.
    pub windowed: bool,
    /// Size of the window, pixels.
    pub size: Option<[u32; 2]>,
    /// Which monitor, counted from 1; the primary one if `None` or if there are fewer.
    pub monitor: Option<usize>,
    /// World to begin with, instead of the settings'.
    pub mode: Option<Mode>,
    /// Settings file. Where there is none yet, the defaults are written there with a comment for each, to be changed.
    pub settings: Option<PathBuf>,
    /// Where figures go, one JSON line each second, instead of the settings' file.
    pub metrics: Option<PathBuf>,
    /// Rock under new land, instead of the settings': a preset, or the path of a TOML file.
    pub layers: Option<String>,
    /// A file that is to hold what is done at the table; it must not be there yet.
    pub record: Option<PathBuf>,
    /// How a land is written to files.
    pub save: SaveLand,
}

/// Why the table could not open, or had to close.
#[derive(Debug, thiserror::Error)]
pub enum AppError {
    /// There is no display to open a window on.
    #[error("{0}")]
    NoDisplay(String),
    /// There is a display, but nothing that could draw on it.
    #[error("{0}")]
    NoGraphics(String),
    /// The settings file is not one.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// There is no such pile of rock.
    #[error(transparent)]
    Layers(#[from] PileError),
    /// The settings or metrics file cannot be opened.
    #[error("{0}: {1}")]
    File(String, io::Error),
    /// Anything else.
    #[error("{0}")]
    Other(String),
}

/// Opens the table and runs it until it is closed.
///
/// # Errors
/// When there is no display, no graphics, or a file named in `options` is not what it should be. A table that has
/// opened survives losses of the graphics card and panics of the session's thread; it ends with an error only when
/// no graphics can be had any more.
pub fn run(options: &Options) -> Result<(), AppError> {
    let settings = load_settings(options)?;
    let layers = setup::layers(options, &settings)?;
    let metrics_path = options
        .metrics
        .clone()
        .or_else(|| settings.files.metrics.as_ref().map(PathBuf::from));
    let metrics = metrics::Metrics::new(metrics_path.as_deref()).map_err(|error| {
        let path = metrics_path.unwrap_or_default();
        AppError::File(path.display().to_string(), error)
    })?;
    let events = EventLoop::new().map_err(|error| AppError::NoDisplay(no_display(&error)))?;
    let _log = log::start(settings.files.log.as_ref().map(PathBuf::from).as_deref());
    let mut program = window::Program::new(
        options.clone(),
        settings,
        layers,
        metrics,
        (events.owned_display_handle(), events.create_proxy()),
    );
    let ran = events.run_app(&mut program);
    program.end()?;
    ran.map_err(|error| AppError::Other(error.to_string()))
}

fn load_settings(options: &Options) -> Result<Settings, AppError> {
    let Some(path) = &options.settings else {
        return Ok(Settings::default());
    };
    let name = path.display().to_string();
    match std::fs::read(path) {
        Ok(bytes) => Ok(Settings::parse(&bytes, &name)?),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let settings = Settings::default();
            save::write_whole(path, settings.to_toml().as_bytes())
                .map_err(|error| AppError::File(name, error))?;
            Ok(settings)
        }
        Err(error) => Err(AppError::File(name, error)),
    }
}

/// What is missing, in words for whoever started the program.
fn no_display(error: &winit::error::EventLoopError) -> String {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let named = |name: &str| set(name).map(|value| format!("{name}={}", value.to_string_lossy()));
    match named("WAYLAND_DISPLAY")
        .or_else(|| named("WAYLAND_SOCKET"))
        .or_else(|| named("DISPLAY"))
    {
        Some(display) => format!("no display answers at {display}"),
        None if cfg!(target_os = "linux") => {
            "no display (neither WAYLAND_DISPLAY nor DISPLAY is set)".to_owned()
        }
        None => format!("no display ({error})"),
    }
}
