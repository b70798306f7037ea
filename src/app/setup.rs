//! What the settings mean to the parts of the table.

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;

use super::Options;

use crate::gesture::command::Mode;
use crate::gesture::params::GestureParams;
use crate::input::pile::{PileError, named_pile};
use crate::input::window::WindowMap;
use crate::instrument::InstrumentParams;
use crate::kiosk::{DoorParams, Flight};
use crate::live::LiveGlobeParams;
use crate::render::plan_rect;
use crate::rock::Stratigraphy;
use crate::settings::Settings;
use crate::sim::globe::{GlobeSimParams, LIVE_SAMPLES, default_start};
use crate::units::PlanMap;

/// Columns of the rasters that the session draws for the window.
const COLUMNS: usize = 1024;
/// The same where processor cores also draw the picture.
const SOFTWARE_COLUMNS: usize = 512;
/// Samples of the planet where processor cores also draw the picture.
const SOFTWARE_SAMPLES: usize = 24_000;

/// Columns of the rasters that the session draws.
pub(super) fn raster_width(software: bool) -> usize {
    if software { SOFTWARE_COLUMNS } else { COLUMNS }
}

/// Samples of the planet.
pub(super) fn globe_samples(software: bool) -> usize {
    if software { SOFTWARE_SAMPLES } else { LIVE_SAMPLES }
}

/// What the planet's session is made for.
pub(super) fn globe_params(size_mm: DVec2, software: bool) -> LiveGlobeParams {
    LiveGlobeParams {
        size_mm,
        samples: globe_samples(software),
        start: default_start(1),
        sim: GlobeSimParams::default(),
        threads: 0,
    }
}

/// The rock under new land.
pub(super) fn layers(options: &Options, settings: &Settings) -> Result<Arc<Stratigraphy>, PileError> {
    if let Some(name) = &options.layers {
        return named_pile(name, Path::new(""));
    }
    let file = options.settings.as_deref().and_then(Path::parent);
    named_pile(&settings.land.layers, file.unwrap_or(Path::new("")))
}

/// How the window's pixels lie on the table.
pub(super) fn window_map(settings: &Settings, map: &PlanMap, size_px: DVec2) -> WindowMap {
    let land_px = plan_rect(map.extent(), size_px);
    let table = &settings.table;
    WindowMap::new(
        size_px,
        land_px,
        map.size_mm(),
        table.orientation,
        table.calibration,
    )
}

/// What the instrument is made for.
pub(super) fn instrument_params(
    settings: &Settings,
    size_mm: DVec2,
    unattended: bool,
    mode: Mode,
) -> InstrumentParams {
    InstrumentParams {
        size_mm,
        corner: settings.staff.corner,
        unattended,
        mode,
        artists: !settings.view.tools.are_few(unattended),
        readouts: settings.view.readouts,
        gesture: GestureParams::default(),
    }
}

/// What the staff's door is made for.
pub(super) fn door_params(settings: &Settings, size_mm: DVec2) -> DoorParams {
    DoorParams {
        pin: settings.staff.pin.clone(),
        corner: settings.staff.corner,
        size_mm,
    }
}

/// A flight that has not begun.
pub(super) fn grounded(settings: &Settings) -> Flight {
    let after_ms = (settings.kiosk.flight_after_s * 1e3) as u64;
    Flight::new(after_ms, settings.view.reduced_motion)
}
