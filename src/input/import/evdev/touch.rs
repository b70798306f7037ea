//! One contact in device units.

use std::collections::BTreeMap;

use super::codes::{
    ABS_MT_ORIENTATION, ABS_MT_POSITION_X, ABS_MT_POSITION_Y, ABS_MT_TOOL_TYPE, ABS_MT_TOUCH_MAJOR,
    ABS_MT_TOUCH_MINOR, ABS_MT_TRACKING_ID, ABS_MT_WIDTH_MAJOR, ABS_MT_WIDTH_MINOR, MT_TOOL_PALM,
};
use crate::gesture::contact::Phase;

/// A contact in device units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Touch {
    pub(super) x: i32,
    pub(super) y: i32,
    /// Major and minor axis of the touching area.
    pub(super) area: Option<(i32, i32)>,
    /// Major and minor axis of what approaches: the finger around that area.
    pub(super) approach: Option<(i32, i32)>,
    pub(super) orientation: i32,
    pub(super) palm: bool,
}

/// A contact and what happens to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RawEvent {
    pub(super) phase: Phase,
    pub(super) slot: u16,
    pub(super) generation: u32,
    pub(super) touch: Touch,
}

/// The last value of each code that speaks of a contact.
#[derive(Clone, Debug, Default)]
pub(super) struct Readings(BTreeMap<u16, i32>);

impl Readings {
    /// True for the codes that describe a contact or name it.
    pub(super) fn are_told_by(code: u16) -> bool {
        matches!(
            code,
            ABS_MT_TRACKING_ID
                | ABS_MT_POSITION_X
                | ABS_MT_POSITION_Y
                | ABS_MT_TOUCH_MAJOR
                | ABS_MT_TOUCH_MINOR
                | ABS_MT_WIDTH_MAJOR
                | ABS_MT_WIDTH_MINOR
                | ABS_MT_ORIENTATION
                | ABS_MT_TOOL_TYPE
        )
    }

    pub(super) fn tell(&mut self, code: u16, value: i32) {
        self.0.insert(code, value);
    }

    pub(super) fn get(&self, code: u16) -> Option<i32> {
        self.0.get(&code).copied()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The contact, once its place is known.
    pub(super) fn touch(&self) -> Option<Touch> {
        // Without a minor axis the area is round (kernel documentation).
        let pair = |major, minor| {
            self.get(major)
                .map(|major| (major, self.get(minor).unwrap_or(major)))
        };
        Some(Touch {
            x: self.get(ABS_MT_POSITION_X)?,
            y: self.get(ABS_MT_POSITION_Y)?,
            area: pair(ABS_MT_TOUCH_MAJOR, ABS_MT_TOUCH_MINOR),
            approach: pair(ABS_MT_WIDTH_MAJOR, ABS_MT_WIDTH_MINOR),
            orientation: self.get(ABS_MT_ORIENTATION).unwrap_or(0),
            palm: self.get(ABS_MT_TOOL_TYPE) == Some(MT_TOOL_PALM),
        })
    }
}
