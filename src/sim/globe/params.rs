//! All parameters of a session on the globe, apart from its state.

use crate::gesture::params::GestureParams;
use crate::globe::GlobeParams;

/// What [`GlobeSim`](super::GlobeSim) needs to know besides the planet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobeSimParams {
    /// When fingers are hands, and what they mean.
    pub gesture: GestureParams,
    /// The planet.
    pub globe: GlobeParams,
    /// Model time per second of session time at the beginning, My. Default 5: the fastest plate crosses the disc in half a
    /// minute.
    pub pace_my_per_s: f64,
    /// How long a plate still goes on towards where it was led after the hand has lifted, My. Default 10, two seconds at the
    /// default pace: a quick flick would else move nothing that anybody sees.
    pub carry_my: f64,
    /// How much farther apart two hands on one plate must go than they took hold of it before it tears, km. Default 300.
    pub tear_km: f64,
    /// Radius of what a finger paints, table mm: the same on every zoom. Default 14.
    pub brush_mm: f64,
    /// A half of the globe where nobody has held a plate for so long is painted by the brush of the other side, seconds of
    /// session time. Default 5: who stands alone has just put the tool on.
    pub deserted_s: f64,
    /// How long the mark of a tap stays, seconds of session time. Default 3.
    pub tap_s: f64,
    /// Most memory that undo may keep, bytes. The oldest snapshots go first.
    pub undo_bytes: usize,
}

impl Default for GlobeSimParams {
    fn default() -> Self {
        Self {
            gesture: GestureParams::default(),
            globe: GlobeParams::default(),
            pace_my_per_s: 5.0,
            carry_my: 10.0,
            tear_km: 300.0,
            brush_mm: 14.0,
            deserted_s: 5.0,
            tap_s: 3.0,
            undo_bytes: 256 << 20,
        }
    }
}
