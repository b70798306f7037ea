//! Contacts of touch devices on the table, and the calibration of where they lie.

use super::table::{Seen, Table};
use crate::device::DeviceFrame;
use crate::gesture::contact::{ContactEvent, Phase, Source};
use crate::input::calibrate::{Calibrating, TARGETS};
use crate::instrument::Route;
use crate::settings::Settings;

impl Table {
    /// What a touch device says. True for news of fingers.
    pub(super) fn device(&mut self, source: Source, frame: &DeviceFrame, now_us: u64) -> bool {
        let mut events = Vec::new();
        match frame {
            DeviceFrame::Plugged { device, .. } => self.stream.plugged(source, *device),
            DeviceFrame::Unplugged { device } => self.stream.unplugged(source, *device, &mut events),
            DeviceFrame::State { device, touching, .. } => {
                if self.stream.state(source, *device, touching, &mut events) {
                    self.withdraw_touches(now_us);
                }
                self.input.shadowed(now_us);
            }
            DeviceFrame::Denied { .. } => {}
        }
        let news = !events.is_empty();
        self.take(events, now_us);
        news
    }

    /// True where touches of the window are to be let pass.
    pub(super) fn hears_window(&mut self, now_us: u64) -> bool {
        let heard = self.stream.heard() == Source::Window;
        if !heard {
            self.input.shadowed(now_us);
        }
        heard
    }

    /// Takes over how surfaces lie on the table, and which source is heard.
    pub(super) fn apply_input(&mut self, settings: &Settings, now_us: u64) {
        let mut events = Vec::new();
        let withdraw = self.stream.set_listen(settings.input.source, &mut events);
        self.stream.set_map(self.input.map().surface(), &mut events);
        if withdraw {
            self.input.withdraw_touches(&mut events);
        }
        self.take(events, now_us);
    }

    /// Forgets all devices: they are looked for anew.
    pub(super) fn forget_devices(&mut self, now_us: u64) {
        let mut events = Vec::new();
        let devices: Vec<(Source, u16)> = self.stream.devices().map(|(s, d, _)| (s, d)).collect();
        for (source, device) in devices {
            self.stream.unplugged(source, device, &mut events);
        }
        self.take(events, now_us);
    }

    fn withdraw_touches(&mut self, now_us: u64) {
        let mut events = Vec::new();
        self.input.withdraw_touches(&mut events);
        self.take(events, now_us);
    }

    /// Asks for four touches.
    pub(super) fn calibrate(&mut self, now_us: u64) {
        self.cancel_all(now_us);
        self.calibrating = Some(Calibrating::new(now_us));
    }

    /// The cross that is to be touched, table mm, its number, and the seconds left; `None` while nothing is calibrated.
    pub(super) fn cross(&self) -> Option<(glam::DVec2, usize, f64)> {
        let calibrating = self.calibrating.as_ref()?;
        let number = calibrating.touched();
        let at = TARGETS.get(number)?;
        let left_s = calibrating.left_us(self.now_us()) as f64 / 1e6;
        Some((self.input.map().window().transform_point2(*at), number, left_s))
    }

    /// Takes a contact while crosses are touched. False when none are.
    pub(super) fn calibrates(&mut self, event: &ContactEvent, now_us: u64) -> bool {
        let Some(calibrating) = &mut self.calibrating else {
            return false;
        };
        self.seen.push(Seen {
            event: *event,
            route: Route::Ignored,
        });
        // The mouse goes where the eye does.
        if event.phase == Phase::Up && event.contact.key.source != Source::Mouse {
            let part = self
                .input
                .map()
                .window()
                .inverse()
                .transform_point2(event.contact.position);
            calibrating.touch(part, now_us);
        }
        true
    }

    /// Ends a calibration that is over. The settings have changed where it has come to something.
    pub(super) fn end_calibration(&mut self, settings: &mut Settings, now_us: u64) -> bool {
        let Some(done) = self.calibrating.as_ref().and_then(|c| c.done(now_us)) else {
            return false;
        };
        self.calibrating = None;
        if let Some(found) = done {
            let before = settings.table.calibration.unwrap_or_default();
            settings.table.calibration = Some(found * before);
            self.apply(settings, now_us);
        } else {
            self.saver
                .say("The touches do not fit the crosses: all is as it was.");
        }
        done.is_some()
    }
}
