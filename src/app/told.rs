//! What the table tells of itself: figures each second, and where its controls are.

use serde::Serialize;

use super::graphics::Graphics;
use super::listen::{Listeners, word};
use super::metrics::Facts;
use super::table::Table;
use crate::gesture::contact::Side;
use crate::gesture::hand::ContactStats;
use crate::instrument::ControlKind;
use crate::kiosk::Phase;
use crate::live::{Frame, GlobeFrame};
use crate::render::{Disc, plan_rect};
use crate::surface::planet::Grip;

/// Where a fingertip is held in the staff's corner, mm from both edges.
const FINGERTIP_MM: f64 = 12.0;

impl Table {
    /// Figures of this second.
    pub(super) fn facts(
        &self,
        graphics: &Graphics,
        listeners: &Listeners,
        scale: f32,
        devices_lost: u32,
    ) -> Facts {
        let [width, height] = graphics.size_px();
        let info = &graphics.gpu().info;
        let window = self.input.counts();
        let worlds = self.worlds();
        let facts = Facts {
            phase: phase_name(self.kiosk.phase()),
            mode: worlds.shown().name(),
            contacts: self.contacts(),
            hands: worlds.hands().len(),
            control_presses: self.control_presses,
            resets: self.resets,
            devices_lost: u64::from(devices_lost),
            scale,
            elapsed_yr: worlds.clock().elapsed_yr,
            transport: self.stages.transport(),
            folds: self.stages.folds(),
            adapter: info.name.clone(),
            backend: info.backend.to_string(),
            width,
            height,
            ..match worlds.globe() {
                Some(globe) => of_planet(globe),
                None => of_mountain(worlds.mountain(), worlds.nodes()),
            }
        };
        let stream = self.stream.counts();
        let devices = stream.devices;
        Facts {
            ignored: facts.ignored + window.unknown + devices.no_place,
            doubled: facts.doubled + window.doubled + devices.doubled,
            over_cap: facts.over_cap + window.over_cap + devices.over_cap,
            withdrawn: window.withdrawn + devices.withdrawn,
            source: word(self.stream.heard()),
            devices: self.stream.devices().count(),
            unheard: stream.unheard,
            states_lost: listeners.lost(),
            packets_refused: listeners.refused(),
            ..facts
        }
    }

    /// Where the planet is in the window, while it is shown.
    pub(super) fn disc(&self) -> Option<Disc> {
        let (corner, size) = plan_rect(self.map.extent(), self.size_px);
        let per_mm = size.x / self.map.size_mm().x;
        let globe = self.worlds().globe()?;
        Some(Disc::of(&globe.view, corner, per_mm))
    }

    /// Where controls are in the window, when that has changed since this was last asked: for whoever drives the
    /// table from outside.
    pub(super) fn layout_line(&mut self) -> Option<LayoutLine> {
        let controls = self.instrument.controls();
        let now = (self.size_px, controls.iter().map(|control| control.id).collect());
        if self.layout_told.as_ref() == Some(&now) {
            return None;
        }
        self.layout_told = Some(now);
        let (corner, size) = plan_rect(self.map.extent(), self.size_px);
        let per_mm = size.x / self.map.size_mm().x;
        let size_mm = self.map.size_mm();
        let staff_corner = self.instrument.params().corner.position(size_mm);
        // A fingertip inside the corner itself.
        let staff = staff_corner + (size_mm / 2.0 - staff_corner).signum() * FINGERTIP_MM;
        Some(LayoutLine {
            controls: controls
                .iter()
                .map(|control| {
                    let at = corner + control.centre_mm * per_mm;
                    ControlPlace {
                        id: format!("{}-{}", side_name(control.side), kind_name(control.kind)),
                        side: side_name(control.side),
                        kind: kind_name(control.kind),
                        x_px: at.x,
                        y_px: at.y,
                        half_px: control.half_size_mm.y * per_mm,
                    }
                })
                .collect(),
            staff_corner: Place {
                label: None,
                x_px: (corner + staff * per_mm).x,
                y_px: (corner + staff * per_mm).y,
            },
        })
    }
}

/// What is told of the mountain.
fn of_mountain(frame: &Frame, nodes: usize) -> Facts {
    let heights = &frame.surface.height.data;
    Facts {
        steps: frame.steps,
        dead_touches: frame.counts.dead_touches,
        panics: frame.panics,
        nodes,
        max_m: heights.iter().copied().fold(f32::NEG_INFINITY, f32::max),
        min_m: heights.iter().copied().fold(f32::INFINITY, f32::min),
        ..of_contacts(&frame.contacts)
    }
}

/// What is told of the planet.
fn of_planet(frame: &GlobeFrame) -> Facts {
    let planet = &frame.planet;
    let heights = &planet.elevation_m;
    let led = planet.plates.iter().filter(|plate| plate.grip == Grip::Led);
    Facts {
        steps: frame.steps,
        panics: frame.panics,
        nodes: planet.lattice.len(),
        max_m: heights.iter().copied().fold(f32::NEG_INFINITY, f32::max),
        min_m: heights.iter().copied().fold(f32::INFINITY, f32::min),
        plates: planet.plates.len(),
        plates_led: led.clone().count(),
        led_deg_per_my: led
            .map(|plate| plate.omega.length().to_degrees())
            .fold(0.0, f64::max),
        ..of_contacts(&frame.contacts)
    }
}

fn of_contacts(contacts: &ContactStats) -> Facts {
    Facts {
        contacts_total: contacts.total,
        pushes: contacts.pushes,
        taps: contacts.taps,
        ghosts_dropped: contacts.dropped_ghosts,
        retracted: contacts.retracted,
        bridged: contacts.bridged,
        stuck: contacts.stuck,
        doubled: contacts.doubled,
        over_cap: contacts.over_cap,
        ignored: contacts.ignored,
        ..Facts::default()
    }
}

/// Where controls are, as a line of metrics.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LayoutLine {
    controls: Vec<ControlPlace>,
    staff_corner: Place,
}

#[derive(Clone, Debug, Serialize)]
struct ControlPlace {
    id: String,
    side: &'static str,
    kind: &'static str,
    x_px: f64,
    y_px: f64,
    half_px: f64,
}

/// A place in the window, pixels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Place {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) label: Option<String>,
    pub(super) x_px: f64,
    pub(super) y_px: f64,
}

fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Attract => "attract",
        Phase::Invite => "invite",
        Phase::Play => "play",
        Phase::IdleWarning { .. } => "idle_warning",
        Phase::Reset => "reset",
    }
}

fn side_name(side: Side) -> &'static str {
    match side {
        Side::North => "north",
        Side::South => "south",
    }
}

fn kind_name(kind: ControlKind) -> &'static str {
    match kind {
        ControlKind::Tool(tool) => tool.name(),
        ControlKind::Undo => "undo",
        ControlKind::PlayPause => "play_pause",
        ControlKind::Speed => "speed",
        ControlKind::Scrub => "scrub",
        ControlKind::StartOver => "start_over",
        ControlKind::Readouts => "readouts",
        ControlKind::Save => "save",
        ControlKind::Final => "final",
        ControlKind::World => "world",
        ControlKind::FreezeSlice => "freeze_slice",
        ControlKind::CloseSlice => "close_slice",
    }
}
