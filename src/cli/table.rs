//! Plain `orogen` and `orogen kiosk`: the table in a window.

use std::path::Path;
use std::sync::Arc;

use clap::ValueEnum;

use super::console::Console;
use super::failure::Failure;
use super::output::{Pictures, Timings};
use super::{PictureChoice, RecordArgs, TableArgs, refine, replay};
use crate::app::{self, AppError, LongWork, Options, SavedLand};
use crate::export::OutDir;
use crate::gesture::command::Mode;
use crate::sim::Sim;

/// Least side of the window, pixels: what the controls of both sides need.
const MIN_SIDE: u32 = 320;
/// Greatest side, pixels: what graphics cards promise.
const MAX_SIDE: u32 = 8192;

/// A world, as the command line names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ModeChoice {
    /// Mountains on a flat land.
    Mountain,
    /// Plates on a planet.
    Globe,
}

/// Opens the table; where that is not possible, plays the built-in session instead.
pub(super) fn open(args: &TableArgs, console: Console) -> Result<(), Failure> {
    match app::run(&options(args, false)) {
        Err(AppError::NoDisplay(why) | AppError::NoGraphics(why)) => {
            console.note(&format!("no table to touch here: {why}"));
            replay::builtin(console)
        }
        ended => ended.map_err(failure),
    }
}

/// Opens the table for unattended machines.
pub(super) fn kiosk(args: &TableArgs) -> Result<(), Failure> {
    app::run(&options(args, true)).map_err(failure)
}

/// Opens the table, and records what is done at it.
pub(super) fn record(args: &RecordArgs) -> Result<(), Failure> {
    let options = Options {
        record: Some(args.out.clone()),
        ..options(&args.table, false)
    };
    app::run(&options).map_err(failure)
}

fn options(args: &TableArgs, kiosk: bool) -> Options {
    Options {
        kiosk,
        record: None,
        windowed: args.windowed || args.size.is_some(),
        size: args.size,
        monitor: args.monitor.map(usize::from),
        mode: args.mode.map(|mode| match mode {
            ModeChoice::Mountain => Mode::Mountain,
            ModeChoice::Globe => Mode::Globe,
        }),
        settings: args.settings.clone(),
        layers: args.layers.clone(),
        metrics: args.metrics.clone(),
        save: Arc::new(|land, path, long| save_land(land, path, long).map_err(|failure| failure.to_string())),
    }
}

/// Pixels along the width of what the table saves.
const SAVED_SIZE: u32 = 1920;
/// Title of what the table saves.
const SAVED_TITLE: &str = "Orogen";

/// What `replay` writes, from a table that runs on meanwhile.
fn save_land(land: &SavedLand, path: &Path, long: Option<&LongWork>) -> Result<(), Failure> {
    let mut timings = Timings::start();
    if let Some(work) = long {
        let (land, refinement) = refine::watched(land, work)?;
        timings.lap("refine");
        let out = OutDir::create(path).map_err(Failure::input)?;
        let pictures = Pictures::new(PictureChoice::Map)?;
        let land = (&land, Some(refinement));
        let written = replay::write_session(land, SAVED_TITLE, &out, (refine::SIZE, &pictures), timings)
            .and_then(|()| refine::go_on(work, 1.0));
        if written.is_err() {
            // Nobody else has written into this folder: its name was free.
            let _ = std::fs::remove_dir_all(out.path());
        }
        return written;
    }
    let out = OutDir::create(path).map_err(Failure::input)?;
    let sim = Sim::resume(land.clone());
    let pictures = Pictures::new(PictureChoice::Map)?;
    replay::write_session((&sim, None), SAVED_TITLE, &out, (SAVED_SIZE, &pictures), timings)
}

fn failure(error: AppError) -> Failure {
    match error {
        AppError::NoDisplay(why) | AppError::NoGraphics(why) => Failure::no_display(format!(
            "{why}; start it where a display is, or use `orogen replay`, which needs none"
        )),
        AppError::Settings(_) | AppError::Layers(_) | AppError::File(..) => Failure::input(error),
        AppError::Other(_) => Failure::other(error),
    }
}

/// `WxH` in pixels.
pub(super) fn window_size(text: &str) -> Result<[u32; 2], String> {
    let expected = || format!("expected WIDTHxHEIGHT, each {MIN_SIDE} to {MAX_SIDE}");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side = |text: &str| {
        let side: u32 = text.parse().ok()?;
        (MIN_SIDE..=MAX_SIDE).contains(&side).then_some(side)
    };
    match (side(width), side(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err(expected()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_final_land_that_is_cancelled_leaves_nothing_behind() {
        let map = crate::units::PlanMap::new(glam::DVec2::new(1209.6, 680.4), 100e3);
        let world = crate::sim::World::new(map, 300, 1).unwrap();
        let land = Sim::new(world, crate::sim::SimParams::default()).checkpoint();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("final-001");
        let work = LongWork::default();
        work.cancel();
        let refused = save_land(&land, &path, Some(&work)).unwrap_err();
        assert_eq!(refused.to_string(), "cancelled");
        assert!(!path.exists());
    }

    #[test]
    fn window_sizes() {
        assert_eq!(window_size("1280x720"), Ok([1280, 720]));
        for bad in [
            "",
            "x",
            "1280",
            "1280x",
            "12x720",
            "1280x99999",
            "-1x720",
            "1280x720x1",
        ] {
            assert!(window_size(bad).is_err(), "{bad}");
        }
    }
}
