//! Keys of plain `orogen`: a laptop can do everything.

use winit::event::{ElementState, KeyEvent};
use winit::keyboard::{Key as WinitKey, ModifiersState, NamedKey};

use crate::gesture::command::Tool;
use crate::instrument::Key;

/// Escape closes the program, unless it has a mouse's resting hands to lift first.
pub(super) fn closes(key: &KeyEvent) -> bool {
    pressed_once(key) && key.logical_key == WinitKey::Named(NamedKey::Escape)
}

/// F11 changes between window and full screen.
pub(super) fn toggles_full_screen(key: &KeyEvent) -> bool {
    pressed_once(key) && key.logical_key == WinitKey::Named(NamedKey::F11)
}

/// L opens and closes the panel of rock layers.
pub(super) fn toggles_layers(key: &KeyEvent) -> bool {
    let is_l = |text: &str| text.eq_ignore_ascii_case("l");
    pressed_once(key) && matches!(&key.logical_key, WinitKey::Character(text) if is_l(text))
}

/// What a key types into a field of a panel.
pub(super) fn typed(key: &KeyEvent) -> Option<egui::Event> {
    let text: String = key.text.iter().flat_map(|text| text.chars()).collect();
    let pressed = key.state == ElementState::Pressed;
    (pressed && !text.is_empty() && !text.chars().any(char::is_control)).then_some(egui::Event::Text(text))
}

fn pressed_once(key: &KeyEvent) -> bool {
    key.state == ElementState::Pressed && !key.repeat
}

/// What a key means in the staff's panels: the way from button to button, and pressing one.
pub(super) fn panel(key: &KeyEvent) -> Option<egui::Event> {
    let named = match key.logical_key {
        WinitKey::Named(NamedKey::Tab) => egui::Key::Tab,
        WinitKey::Named(NamedKey::Enter) => egui::Key::Enter,
        WinitKey::Named(NamedKey::Space) => egui::Key::Space,
        WinitKey::Named(NamedKey::ArrowUp) => egui::Key::ArrowUp,
        WinitKey::Named(NamedKey::ArrowDown) => egui::Key::ArrowDown,
        WinitKey::Named(NamedKey::ArrowLeft) => egui::Key::ArrowLeft,
        WinitKey::Named(NamedKey::ArrowRight) => egui::Key::ArrowRight,
        WinitKey::Named(NamedKey::Backspace) => egui::Key::Backspace,
        _ => return None,
    };
    Some(egui::Event::Key {
        key: named,
        physical_key: None,
        pressed: key.state == ElementState::Pressed,
        repeat: key.repeat,
        modifiers: egui::Modifiers::default(),
    })
}

/// The control that a key stands for, and whether the key went down. Keys that are held repeat only where a control
/// steps.
pub(super) fn control(key: &KeyEvent, modifiers: ModifiersState) -> Option<(Key, bool)> {
    let control = named(&key.logical_key, modifiers.control_key())?;
    let steps = matches!(control, Key::Faster | Key::Slower | Key::Back | Key::Forward);
    (steps || !key.repeat).then_some((control, key.state == ElementState::Pressed))
}

fn named(key: &WinitKey, control: bool) -> Option<Key> {
    match key {
        WinitKey::Named(NamedKey::Space) => Some(Key::PlayPause),
        WinitKey::Named(NamedKey::ArrowLeft) => Some(Key::Back),
        WinitKey::Named(NamedKey::ArrowRight) => Some(Key::Forward),
        WinitKey::Character(text) => match (text.to_lowercase().as_str(), control) {
            ("u", false) | ("z", true) => Some(Key::Undo),
            ("e", false) => Some(Key::Tool(Tool::Edit)),
            ("f", false) => Some(Key::Tool(Tool::Fold)),
            ("c", false) => Some(Key::Tool(Tool::Slice)),
            ("b", false) => Some(Key::Tool(Tool::Land)),
            ("o", false) => Some(Key::Tool(Tool::Sea)),
            ("i", false) => Some(Key::Readouts),
            ("s", _) => Some(Key::Save),
            ("m", false) => Some(Key::Final),
            ("r", false) => Some(Key::StartOver),
            ("g", false) => Some(Key::World),
            ("+" | "=", false) => Some(Key::Faster),
            ("-", false) => Some(Key::Slower),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_mean_what_the_readme_says() {
        let letter = |text: &str, control| named(&WinitKey::Character(text.into()), control);
        assert_eq!(letter("U", false), Some(Key::Undo));
        assert_eq!(letter("z", true), Some(Key::Undo));
        assert_eq!(letter("z", false), None);
        assert_eq!(letter("M", false), Some(Key::Final));
        assert_eq!(letter("f", false), Some(Key::Tool(Tool::Fold)));
        assert_eq!(letter("c", false), Some(Key::Tool(Tool::Slice)));
        assert_eq!(letter("b", false), Some(Key::Tool(Tool::Land)));
        assert_eq!(letter("G", false), Some(Key::World));
        assert_eq!(letter("s", true), Some(Key::Save));
        assert_eq!(
            named(&WinitKey::Named(NamedKey::Space), false),
            Some(Key::PlayPause)
        );
    }
}
