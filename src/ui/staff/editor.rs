//! Settings, one section of the file at a time. What a key may hold is told by the table of keys, which also draws
//! the widgets.

use egui::{
    Button, Id, Response, RichText, Role, Slider, SliderClamping, TextEdit, Ui, Vec2, WidgetInfo, vec2,
};

use super::keypad::{self, Key as Pressed};
use super::style;
use super::{StaffAction, StaffPanel, StaffView, TARGET};
use crate::settings::{Bound, Domain, KEYS, Key, PIN_DIGITS, Value};
use crate::ui::palette::AMBER;

impl StaffPanel {
    pub(super) fn section(
        &mut self,
        ui: &mut Ui,
        view: &StaffView<'_>,
        section: &'static str,
        actions: &mut Vec<StaffAction>,
    ) {
        let mut draft = self.draft.take().unwrap_or_else(|| view.settings.clone());
        for key in KEYS.iter().filter(|key| key.section == section) {
            if let Some(value) = self.field(ui, key, &(key.get)(&draft), view.scale) {
                key.put(&mut draft, &value);
            }
            ui.add_space(4.0 * view.scale);
        }
        let changed = draft != *view.settings;
        ui.horizontal(|ui| {
            let size = vec2(190.0, TARGET) * view.scale;
            ui.add_enabled_ui(changed, |ui| {
                if ui.add_sized(size, Button::new("Save settings")).clicked() {
                    actions.push(StaffAction::Apply(Box::new(draft.clone())));
                }
                if ui.add_sized(size, Button::new("Discard")).clicked() {
                    draft = view.settings.clone();
                }
            });
        });
        self.draft = (draft != *view.settings).then_some(draft);
    }

    /// One key: its name, what it means, and its widget. Returns the value that somebody gave it.
    fn field(&mut self, ui: &mut Ui, key: &Key, value: &Value, scale: f32) -> Option<Value> {
        let label = ui.label(spoken(key.name));
        ui.label(RichText::new(key.help).small().color(style::quiet()));
        match (key.domain, value) {
            (Domain::Number(bound), Value::Number(number)) => {
                number_field(ui, bound, *number, label.id, key, scale).map(Value::Number)
            }
            (Domain::NumberOr(bound, word), value) => {
                ui.horizontal(|ui| {
                    let mut is_word = *value == Value::Word;
                    let boxed = ui.checkbox(&mut is_word, format!("{} {word}", spoken(key.name)));
                    let number = match value {
                        Value::Number(number) => *number,
                        // Half-way, until somebody chooses.
                        _ => nearest(bound, f64::midpoint(bound.min, bound.max)),
                    };
                    if boxed.changed() {
                        return Some(if is_word {
                            Value::Word
                        } else {
                            Value::Number(number)
                        });
                    }
                    if is_word {
                        return None;
                    }
                    number_field(ui, bound, number, label.id, key, scale).map(Value::Number)
                })
                .inner
            }
            (Domain::Switch, Value::Switch(on)) => {
                let mut on = *on;
                let word = if on { "on" } else { "off" };
                let switched = ui.checkbox(&mut on, word);
                switched
                    .labelled_by(label.id)
                    .changed()
                    .then_some(Value::Switch(on))
            }
            (Domain::Choice(words), Value::Text(chosen)) => {
                ui.horizontal_wrapped(|ui| {
                    let (mut put, target) = (None, vec2(TARGET, TARGET) * scale);
                    for word in words {
                        if ui
                            .add(Button::selectable(chosen == word, *word).min_size(target))
                            .clicked()
                        {
                            put = Some(Value::Text((*word).to_owned()));
                        }
                    }
                    put
                })
                .inner
            }
            (Domain::Pin, Value::Text(pin)) => self.pin(ui, key, pin, scale),
            (Domain::Path, Value::Text(path)) => text_field(ui, key, path, &label),
            (Domain::Text(_), Value::Text(text)) => form_field(ui, key, text, scale),
            // A value of another kind than its key's: shown, and left alone.
            _ => {
                ui.label(key.expected());
                None
            }
        }
    }

    /// The PIN is typed on a pad of its own: a table has no keyboard.
    fn pin(&mut self, ui: &mut Ui, key: &Key, pin: &str, scale: f32) -> Option<Value> {
        let Some(mut typed) = self.pin.take() else {
            ui.horizontal(|ui| {
                ui.label("•".repeat(pin.len()));
                if ui.button("Change the PIN").clicked() {
                    self.pin = Some(String::new());
                }
            });
            return None;
        };
        let mut put = None;
        ui.label(RichText::new(format!("New PIN: {typed}")).color(AMBER));
        let mut done = false;
        keypad::pad(ui, 0.72 * scale, &mut |pressed| match pressed {
            Pressed::Digit(digit) if typed.len() < PIN_DIGITS.1 => typed.push(char::from(b'0' + digit % 10)),
            Pressed::Digit(_) => {}
            Pressed::Erase => {
                typed.pop();
            }
            // A PIN that is too short waits for more.
            Pressed::Enter => {
                put = Some(Value::Text(typed.clone())).filter(|pin| key.admits(pin));
                done = put.is_some();
            }
        });
        done |= ui.button("Keep the old PIN").clicked();
        self.pin = (!done).then_some(typed);
        put
    }
}

/// A slider between its bounds, with a step down and a step up for fingers.
fn number_field(ui: &mut Ui, bound: Bound, number: f64, label: Id, key: &Key, scale: f32) -> Option<f64> {
    let mut value = number;
    ui.horizontal(|ui| {
        let square = vec2(TARGET, TARGET) * scale;
        if step_button(ui, square, "−", &format!("Less: {}", spoken(key.name))) {
            value = nearest(bound, number - bound.step);
        }
        let suffix = if bound.unit == "1" {
            String::new()
        } else {
            format!(" {}", bound.unit)
        };
        let slider = Slider::new(&mut value, bound.min..=bound.max)
            .step_by(bound.step)
            .clamping(SliderClamping::Always)
            .max_decimals(2)
            .suffix(suffix);
        ui.add(slider).labelled_by(label);
        if step_button(ui, square, "+", &format!("More: {}", spoken(key.name))) {
            value = nearest(bound, number + bound.step);
        }
    });
    let value = nearest(bound, value);
    (value != number && bound.contains(value)).then_some(value)
}

/// A small button whose sign says less than its name.
fn step_button(ui: &mut Ui, size: Vec2, sign: &str, name: &str) -> bool {
    let response = ui.add_sized(size, Button::new(sign));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response.clicked()
}

/// The allowed value that is nearest; the least one for what is no number.
fn nearest(bound: Bound, value: f64) -> f64 {
    let value = if value.is_nan() {
        bound.min
    } else {
        value.clamp(bound.min, bound.max)
    };
    if bound.whole { value.round() } else { value }
}

fn text_field(ui: &mut Ui, key: &Key, text: &str, label: &Response) -> Option<Value> {
    let mut text = text.to_owned();
    let changed = ui
        .add(TextEdit::singleline(&mut text))
        .labelled_by(label.id)
        .changed();
    let value = Value::Text(text);
    (changed && key.admits(&value)).then_some(value)
}

/// A text of a certain form is written elsewhere (half of it would be none); here it is read, and taken away.
fn form_field(ui: &mut Ui, key: &Key, text: &str, scale: f32) -> Option<Value> {
    if text.is_empty() {
        ui.label("none");
        return None;
    }
    let empty = Value::Text(String::new());
    ui.horizontal(|ui| {
        ui.label(text);
        let name = format!("Take away: {}", spoken(key.name));
        step_button(ui, vec2(TARGET, TARGET) * scale, "×", &name)
    })
    .inner
    .then_some(empty)
    .filter(|empty| key.admits(empty))
}

/// A key's name as words.
fn spoken(name: &str) -> String {
    let mut words = name.replace('_', " ");
    if let Some(first) = words.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_allowed_value_is_in_bounds() {
        for key in KEYS {
            if let Domain::Number(bound) | Domain::NumberOr(bound, _) = key.domain {
                for value in [f64::NAN, f64::NEG_INFINITY, -1.0, 0.3, 1e3, f64::INFINITY] {
                    assert!(bound.contains(nearest(bound, value)), "{} {value}", key.path());
                }
            }
        }
    }

    #[test]
    fn names_are_words() {
        assert_eq!(spoken("short_side_km"), "Short side km");
        assert_eq!(spoken(""), "");
    }
}
