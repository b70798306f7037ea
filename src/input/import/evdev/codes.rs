//! Events of the kernel (Linux, include/uapi/linux/input-event-codes.h).

pub(in super::super) const EV_SYN: u16 = 0;
pub(in super::super) const EV_KEY: u16 = 1;
pub(in super::super) const EV_ABS: u16 = 3;
pub(in super::super) const SYN_REPORT: u16 = 0;
pub(super) const SYN_MT_REPORT: u16 = 2;
pub(super) const SYN_DROPPED: u16 = 3;
pub(super) const BTN_TOUCH: u16 = 0x14a;
pub(in super::super) const ABS_MT_SLOT: u16 = 0x2f;
pub(in super::super) const ABS_MT_TOUCH_MAJOR: u16 = 0x30;
pub(super) const ABS_MT_TOUCH_MINOR: u16 = 0x31;
pub(super) const ABS_MT_WIDTH_MAJOR: u16 = 0x32;
pub(super) const ABS_MT_WIDTH_MINOR: u16 = 0x33;
pub(super) const ABS_MT_ORIENTATION: u16 = 0x34;
pub(in super::super) const ABS_MT_POSITION_X: u16 = 0x35;
pub(in super::super) const ABS_MT_POSITION_Y: u16 = 0x36;
pub(super) const ABS_MT_TOOL_TYPE: u16 = 0x37;
pub(in super::super) const ABS_MT_TRACKING_ID: u16 = 0x39;
/// Value of `ABS_MT_TOOL_TYPE`.
pub(super) const MT_TOOL_PALM: i32 = 2;

/// An event of the kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Event {
    /// Time, µs since some epoch.
    pub(in super::super) t_us: u64,
    /// `EV_…`
    pub(in super::super) kind: u16,
    pub(in super::super) code: u16,
    pub(in super::super) value: i32,
}
