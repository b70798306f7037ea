//! Digits for the PIN.

use egui::{Button, RichText, Sense, Stroke, Ui, vec2};

use super::StaffAction;
use super::style;
use crate::settings::PIN_DIGITS;
use crate::ui::palette::{AMBER, LAMP};

/// Side of a key, points at scale 1.
const KEY: f32 = 84.0;

/// What the pad is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    /// Digits may be typed.
    Open {
        /// Digits typed.
        digits: usize,
        /// Wrong PINs so far.
        wrong: u32,
    },
    /// Too many were wrong.
    Locked {
        /// Until digits may be typed again, ms.
        left_ms: u64,
    },
}

/// The pad that opens the door.
pub(super) fn show(ui: &mut Ui, state: State, scale: f32, actions: &mut Vec<StaffAction>) {
    let gap = ui.spacing().item_spacing.x;
    ui.set_width(3.0 * KEY * scale + 2.0 * gap);
    ui.vertical_centered(|ui| {
        style::heading(ui, "Staff");
        let (digits, told) = match state {
            State::Open { digits, wrong: 0 } => (digits, RichText::new("PIN").color(style::quiet())),
            State::Open { digits, .. } => (digits, RichText::new("Wrong PIN").color(AMBER)),
            State::Locked { left_ms } => {
                let seconds = left_ms.div_ceil(1000);
                (0, RichText::new(format!("Locked for {seconds} s")).color(AMBER))
            }
        };
        ui.label(told);
        dots(ui, digits, scale);
    });
    ui.add_enabled_ui(matches!(state, State::Open { .. }), |ui| {
        pad(ui, scale, &mut |key| {
            actions.push(match key {
                Key::Digit(digit) => StaffAction::Digit(digit),
                Key::Erase => StaffAction::Erase,
                Key::Enter => StaffAction::Enter,
            });
        });
    });
    if ui
        .add_sized(vec2(ui.available_width(), 60.0 * scale), Button::new("Close"))
        .clicked()
    {
        actions.push(StaffAction::Leave);
    }
}

/// A key of the pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Key {
    /// 0 to 9.
    Digit(u8),
    /// Takes the last one back.
    Erase,
    /// The PIN is complete.
    Enter,
}

/// The twelve keys; `press` is told each that is pressed.
pub(super) fn pad(ui: &mut Ui, scale: f32, press: &mut dyn FnMut(Key)) {
    let size = vec2(KEY, KEY * 0.86) * scale;
    let rows = [
        [1, 2, 3].map(Key::Digit),
        [4, 5, 6].map(Key::Digit),
        [7, 8, 9].map(Key::Digit),
        [Key::Erase, Key::Digit(0), Key::Enter],
    ];
    for row in rows {
        ui.horizontal(|ui| {
            for key in row {
                let text = match key {
                    Key::Digit(digit) => RichText::new(digit.to_string()).size(26.0 * scale),
                    Key::Erase => RichText::new("Erase"),
                    Key::Enter => RichText::new("Enter"),
                };
                if ui.add_sized(size, Button::new(text)).clicked() {
                    press(key);
                }
            }
        });
    }
}

/// A ring for each digit that a PIN may have, filled where one is typed.
fn dots(ui: &mut Ui, digits: usize, scale: f32) {
    let (radius, step) = (6.0 * scale, 26.0 * scale);
    let rings = digits.clamp(PIN_DIGITS.0, PIN_DIGITS.1);
    let size = vec2(step * rings as f32, 34.0 * scale);
    let (rect, _) = ui.allocate_exact_size(size, Sense::empty());
    for i in 0..rings {
        let at = rect.left_center() + vec2((i as f32 + 0.5) * step, 0.0);
        if i < digits {
            ui.painter().circle_filled(at, radius, AMBER);
        } else {
            ui.painter()
                .circle_stroke(at, radius, Stroke::new(1.2 * scale, LAMP.gamma_multiply(0.5)));
        }
    }
}
