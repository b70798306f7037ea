//! All words that a visitor may read: few, and in one place.

use crate::gesture::command::Tool;
use crate::instrument::ControlKind;
use crate::surface::planet::BorderKind;

/// What is written beside the crosses of a calibration.
pub(super) const TOUCH_CROSS: &str = "touch the middle of the cross";

/// Beside the hand that stays the count-down.
pub(super) const TOUCH_TO_STAY: &str = "Touch to stay";

/// The clock has been stopped.
pub(super) const PAUSED: &str = "paused";

/// The world has run on for as long as it may.
pub(super) const AT_REST: &str = "at rest";

/// Millions of years.
pub(super) const MY: &str = "My";

/// What two plates do where they meet.
pub(super) fn border(kind: BorderKind) -> &'static str {
    match kind {
        BorderKind::Ridge => "apart: new sea floor",
        BorderKind::Subduction => "one dives below the other",
        BorderKind::Collision => "continents collide",
        BorderKind::Transform => "slide past",
    }
}

/// The word beside a control.
pub(super) fn control(kind: ControlKind, on: bool) -> &'static str {
    match (kind, on) {
        (ControlKind::Tool(tool), _) => tool_word(tool),
        (ControlKind::Undo, _) => "undo",
        (ControlKind::PlayPause, true) => "pause",
        (ControlKind::PlayPause, false) => "play",
        (ControlKind::Speed, _) => "speed",
        (ControlKind::Scrub, _) => "time",
        (ControlKind::StartOver, _) => "reset",
        (ControlKind::Readouts, _) => "figures",
        (ControlKind::Save, _) => "save",
        (ControlKind::Final, true) => "cancel",
        (ControlKind::Final, false) => "final land",
        (ControlKind::World, true) => "planet",
        (ControlKind::World, false) => "mountain",
        (ControlKind::FreezeSlice, true) => "follow",
        (ControlKind::FreezeSlice, false) => "freeze",
        (ControlKind::CloseSlice, _) => "close",
    }
}

fn tool_word(tool: Tool) -> &'static str {
    match tool {
        Tool::Push => "push",
        Tool::Edit => "edit",
        Tool::Fold => "folds",
        Tool::Slice => "slice",
        Tool::View => "view",
        Tool::Land => "land",
        Tool::Sea => "sea",
    }
}
