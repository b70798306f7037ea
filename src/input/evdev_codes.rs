//! What the kernel calls its events of touchscreens (Linux, include/uapi/linux/input-event-codes.h).

pub(crate) const EV_SYN: u16 = 0;
pub(crate) const EV_KEY: u16 = 1;
pub(crate) const EV_ABS: u16 = 3;
pub(crate) const SYN_REPORT: u16 = 0;
pub(crate) const SYN_MT_REPORT: u16 = 2;
pub(crate) const SYN_DROPPED: u16 = 3;
pub(crate) const BTN_TOUCH: u16 = 0x14a;
pub(crate) const ABS_MT_SLOT: u16 = 0x2f;
pub(crate) const ABS_MT_TOUCH_MAJOR: u16 = 0x30;
pub(crate) const ABS_MT_TOUCH_MINOR: u16 = 0x31;
pub(crate) const ABS_MT_WIDTH_MAJOR: u16 = 0x32;
pub(crate) const ABS_MT_WIDTH_MINOR: u16 = 0x33;
pub(crate) const ABS_MT_ORIENTATION: u16 = 0x34;
pub(crate) const ABS_MT_POSITION_X: u16 = 0x35;
pub(crate) const ABS_MT_POSITION_Y: u16 = 0x36;
pub(crate) const ABS_MT_TOOL_TYPE: u16 = 0x37;
pub(crate) const ABS_MT_TRACKING_ID: u16 = 0x39;
/// Value of `ABS_MT_TOOL_TYPE`.
pub(crate) const MT_TOOL_PALM: i32 = 2;
/// Property: the fingers are beside the picture, as on a touchpad.
pub(crate) const INPUT_PROP_POINTER: u16 = 0;
/// Property: the fingers are on the picture.
pub(crate) const INPUT_PROP_DIRECT: u16 = 1;
pub(crate) const ABS_X: u16 = 0;
pub(crate) const ABS_Y: u16 = 1;
