//! Where the mountain is seen from: the flight, the camera and the room's light.

use glam::DVec2;

use super::setup::grounded;
use crate::kiosk::{Flight, FlightWish};
use crate::live::Frame;
use crate::render::{Camera, Focus, LandStyle, flight};
use crate::settings::Settings;
use crate::units::Extent;

/// Time in which the room's light follows a reset, s.
const EASE_S: f64 = 0.25;
/// Time in which the eye follows a land that changes under it, s: slower than anybody notices.
const FOLLOWS_S: f64 = 6.0;

/// The eye over the mountain, and the light on both worlds.
pub(super) struct Eye {
    flight: Flight,
    /// The flight on the ground, to begin anew with.
    grounded: Flight,
    focus: Focus,
    goal: Focus,
    /// The land that the goal was found on.
    land: u64,
    camera: Camera,
    style: LandStyle,
}

impl Eye {
    /// An eye on the plan.
    pub(super) fn new(settings: &Settings, frame: &Frame, extent: Extent, size_px: DVec2) -> Self {
        let focus = Focus::of(&frame.surface);
        Self {
            flight: grounded(settings),
            grounded: grounded(settings),
            focus,
            goal: focus,
            land: 0,
            camera: Camera::plan(extent, size_px),
            style: LandStyle::default(),
        }
    }

    /// The eye of the next picture.
    pub(super) fn camera(&self) -> &Camera {
        &self.camera
    }

    /// How the land is shown in the next picture.
    pub(super) fn style(&self) -> &LandStyle {
        &self.style
    }

    /// Factor on heights in the next picture.
    pub(super) fn drawn_exaggeration(&self) -> f64 {
        self.style.drawn_exaggeration(self.camera.tilt())
    }

    /// How far the view is from the plan, 0–1.
    pub(super) fn aloft(&self) -> f64 {
        self.flight.amount()
    }

    /// The view is not the plan.
    pub(super) fn in_flight(&self) -> bool {
        self.flight.in_flight()
    }

    /// Back to the plan at once.
    pub(super) fn land(&mut self) {
        self.flight = self.grounded.clone();
    }

    /// Settings have changed.
    pub(super) fn apply(&mut self, settings: &Settings) {
        self.grounded = grounded(settings);
        self.land();
    }

    /// Where the view goes.
    pub(super) fn turn(&mut self, now_ms: u64, wish: FlightWish, untouched_ms: u64) {
        self.flight.tick(now_ms, wish, untouched_ms);
    }

    /// Camera, exaggeration and light of the next picture. `lit`: the room's light is on.
    pub(super) fn look(
        &mut self,
        frame: &Frame,
        (extent, size_px): (Extent, DVec2),
        lit: bool,
        settings: &Settings,
        dt_s: f64,
    ) {
        let aloft = self.flight.amount();
        if self.land != frame.land {
            // Looked for only where the eye may be needed: when the land has changed.
            self.land = frame.land;
            self.goal = Focus::of(&frame.surface);
        }
        let follows = if aloft > 0.0 {
            1.0 - (-dt_s / FOLLOWS_S).exp()
        } else {
            1.0
        };
        self.focus = self.focus.towards(&self.goal, follows);
        let eye = flight(&self.focus, &self.style, self.flight.aloft_s());
        self.camera = Camera::between(extent, size_px, &eye, aloft);
        let eased = if settings.view.reduced_motion {
            1.0
        } else {
            1.0 - (-dt_s / EASE_S).exp()
        };
        self.style.lamp += (f32::from(u8::from(lit)) - self.style.lamp) * eased as f32;
    }
}
