//! One slot of the report, ready to be read: all that depends on the descriptor alone is worked out beforehand.

use glam::DVec2;

use super::descriptor::{Axis, Bits, Slot};
use super::quirks::{Quirk, Quirks};

/// Coordinates this far beyond the surface, in parts of it, are no place: the device says that it does not know.
const BEYOND: f64 = 0.1;

/// A touching area longer than this is not believed, mm.
const LARGEST_MM: f64 = 1000.0;

/// What a slot says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    pub(super) id: u64,
    pub(super) tip: bool,
    pub(super) in_range: bool,
    pub(super) confidence: Option<bool>,
    /// In parts of the surface; `None` when that is no place.
    pub(super) at: Option<DVec2>,
    pub(super) size_mm: Option<DVec2>,
}

#[derive(Clone, Debug)]
pub(super) struct Lane {
    slot: Slot,
    per_x: f64,
    per_y: f64,
    /// Where width and height stand, and their unit in millimetres.
    area: Option<[(Bits, f64); 2]>,
}

impl Lane {
    pub(super) fn new(slot: &Slot, quirks: Quirks, size_mm: Option<DVec2>) -> Self {
        let scale = if quirks.has(Quirk::TouchSizeScaling) {
            0.5
        } else {
            1.0
        };
        let area = match (slot.width, slot.height) {
            (Some(width), Some(height)) if !quirks.has(Quirk::NoArea) => {
                let x = unit_mm(&width, &slot.x, size_mm.map(|s| s.x));
                let y = unit_mm(&height, &slot.y, size_mm.map(|s| s.y));
                x.zip(y)
                    .map(|(x, y)| [(width.bits, x * scale), (height.bits, y * scale)])
            }
            _ => None,
        };
        Self {
            slot: *slot,
            per_x: 1.0 / slot.x.range(),
            per_y: 1.0 / slot.y.range(),
            area,
        }
    }

    /// Whether the slot names a contact that touches. (Without a tip, in range or sure is as good.)
    pub(super) fn touches(&self, report: &[u8]) -> bool {
        let slot = &self.slot;
        let tells = slot.tip.or(slot.in_range).or(slot.confidence);
        tells.is_some_and(|bits| bits.read(report) != 0)
    }

    pub(super) fn read(&self, report: &[u8]) -> Seen {
        let slot = &self.slot;
        let is_on = |bits: Bits| bits.read(report) != 0;
        let tip = self.touches(report);
        let x = (slot.x.bits.read(report) - slot.x.min) as f64 * self.per_x;
        let y = (slot.y.bits.read(report) - slot.y.min) as f64 * self.per_y;
        let place = -BEYOND..=1.0 + BEYOND;
        let size_mm = self.area.and_then(|[width, height]| {
            let mm = |(bits, unit): (Bits, f64)| bits.read(report) as f64 * unit;
            let size = DVec2::new(mm(width), mm(height));
            // (Both 0 is what devices say that measure none.)
            (size != DVec2::ZERO && size.min_element() >= 0.0 && size.max_element() <= LARGEST_MM)
                .then_some(size)
        });
        Seen {
            id: slot.id.map_or(0, |bits| bits.read(report) as u64),
            tip,
            in_range: slot.in_range.map_or(tip, is_on),
            confidence: slot.confidence.map(is_on),
            at: (place.contains(&x) && place.contains(&y)).then_some(DVec2::new(x, y)),
            size_mm,
        }
    }
}

/// Millimetres of one step of a width or height: as along the axis where it counts in the same steps, else by its own
/// extent, unless that was only left over from the axis.
fn unit_mm(side: &Axis, axis: &Axis, axis_mm: Option<f64>) -> Option<f64> {
    if side.range() == axis.range() {
        axis_mm.map(|mm| mm / axis.range())
    } else if side.extent_mm == axis.extent_mm {
        None
    } else {
        side.extent_mm.map(|mm| mm / side.range())
    }
}
