//! Usages that matter to a touchscreen: page in the upper half, number in the lower, as the HID Usage Tables give them.

pub(super) const POINTER: u32 = 0x0001_0001;
pub(super) const MOUSE: u32 = 0x0001_0002;
pub(super) const X: u32 = 0x0001_0030;
pub(super) const Y: u32 = 0x0001_0031;
pub(super) const DIGITIZER: u32 = 0x000d_0001;
pub(super) const PEN: u32 = 0x000d_0002;
pub(super) const TOUCH_SCREEN: u32 = 0x000d_0004;
pub(super) const TOUCH_PAD: u32 = 0x000d_0005;
pub(super) const IN_RANGE: u32 = 0x000d_0032;
pub(super) const TIP_SWITCH: u32 = 0x000d_0042;
pub(super) const CONFIDENCE: u32 = 0x000d_0047;
pub(super) const WIDTH: u32 = 0x000d_0048;
pub(super) const HEIGHT: u32 = 0x000d_0049;
pub(super) const CONTACT_ID: u32 = 0x000d_0051;
pub(super) const INPUT_MODE: u32 = 0x000d_0052;
pub(super) const CONTACT_COUNT: u32 = 0x000d_0054;
pub(super) const CONTACT_COUNT_MAXIMUM: u32 = 0x000d_0055;
pub(super) const SCAN_TIME: u32 = 0x000d_0056;
/// The blob by which Windows knows a certified touchscreen.
pub(super) const CERTIFICATION: u32 = 0xff00_00c5;

/// What belongs to one contact.
pub(super) const OF_CONTACT: [u32; 8] = [X, Y, TIP_SWITCH, IN_RANGE, CONFIDENCE, WIDTH, HEIGHT, CONTACT_ID];
