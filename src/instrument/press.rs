//! A finger or key on a control.

use glam::DVec2;

use super::control::ControlKind;
use crate::gesture::contact::ContactKey;

/// How long a control must be held that is not tapped, µs.
const HOLD_US: u64 = 1_500_000;

/// Shortest time between two steps of the slider, µs.
const SLIDER_US: u64 = 50_000;

/// Least step of the slider, as a part of it.
const SLIDER_STEP: f64 = 0.002;

/// Who presses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finger {
    Contact(ContactKey),
    Key,
}

impl Finger {
    pub(super) fn contact(self) -> Option<ContactKey> {
        match self {
            Self::Contact(key) => Some(key),
            Self::Key => None,
        }
    }
}

/// A control that is pressed.
#[derive(Clone, Debug)]
pub(super) struct Press {
    pub(super) finger: Finger,
    pub(super) at: DVec2,
    /// The finger is on the control: it may slide off and come back.
    pub(super) inside: bool,
    /// What is held has acted.
    pub(super) done: bool,
    /// When it landed, or came back, µs.
    since_us: u64,
    /// Where the slider was sent last, and when.
    sent: Option<(f64, u64)>,
}

impl Press {
    pub(super) fn new(finger: Finger, now_us: u64) -> Self {
        Self {
            finger,
            at: DVec2::ZERO,
            inside: true,
            done: false,
            since_us: now_us,
            sent: None,
        }
    }

    pub(super) fn shift(&mut self, at: DVec2, inside: bool, now_us: u64) {
        self.at = at;
        if inside && !self.inside {
            self.since_us = now_us;
        }
        self.inside = inside;
    }

    /// True at the moment when a control that is held acts.
    pub(super) fn held_long_enough(&self, kind: ControlKind, now_us: u64) -> bool {
        self.inside && !self.done && self.progress(kind, now_us) >= 1.0
    }

    /// Part of the time for which it must be held.
    pub(super) fn progress(&self, kind: ControlKind, now_us: u64) -> f64 {
        if !is_held(kind) || !self.inside {
            0.0
        } else if self.done {
            1.0
        } else {
            (now_us.saturating_sub(self.since_us) as f64 / HOLD_US as f64).min(1.0)
        }
    }

    /// True when lifting the finger sets the control off.
    pub(super) fn acts_on_lift(&self, kind: ControlKind) -> bool {
        self.inside && !is_held(kind) && kind != ControlKind::Scrub
    }

    /// Where the slider is to be sent, if it has gone on since it was sent last.
    pub(super) fn follow(&mut self, part: f64, now_us: u64) -> Option<f64> {
        let due = self.sent.is_none_or(|(sent, sent_us)| {
            (part - sent).abs() >= SLIDER_STEP && now_us.saturating_sub(sent_us) >= SLIDER_US
        });
        due.then(|| {
            self.sent = Some((part, now_us));
            part
        })
    }
}

/// True for controls that nobody shall set off by a tap.
fn is_held(kind: ControlKind) -> bool {
    matches!(kind, ControlKind::StartOver | ControlKind::Final)
}
