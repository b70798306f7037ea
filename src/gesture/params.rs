//! Thresholds of the gesture grammar.

use glam::DVec2;

/// Most fingers of a hand.
pub const MAX_FINGERS: usize = 5;

/// Fingertips of a relaxed right hand around its middle, seen from the south, thumb to little finger, mm. Neighbours
/// are 34 to 51 mm apart, as in recorded hands.
pub const RELAXED_HAND_MM: [DVec2; MAX_FINGERS] = [
    DVec2::new(-52.0, 34.0),
    DVec2::new(-32.0, -12.0),
    DVec2::new(3.0, -26.0),
    DVec2::new(36.0, -16.0),
    DVec2::new(58.0, 14.0),
];

/// The thresholds that tell fingers from palms and hands from each other. [`GestureParams::BOUNDS`] lists unit and
/// range of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GestureParams {
    /// Side of the box that holds a hand, mm. Smaller: a spread hand falls apart; larger: neighbours merge.
    pub hand_box_mm: f64,
    /// Downs this close in time belong to one landing hand anywhere in its box, ms.
    pub join_ms: f64,
    /// A finger that lands later must land this near to one of the hand's fingers, mm. Inside real hands the nearest
    /// finger is 46 mm away in the median; smaller: late thumbs stay alone; larger: another hand is taken for fingers.
    pub late_reach_mm: f64,
    /// Fingers that landed on either side of the table's middle line, both at least half of this from it, belong to
    /// visitors who face each other, mm. Smaller: a hand that reaches across the line falls apart.
    pub facing_gap_mm: f64,
    /// Motion (root mean square over the fingers) from which a hand drags; below it rests or taps, mm. Smaller: taps
    /// push; larger: the land answers late.
    pub motion_mm: f64,
    /// A hand that has not moved for this long rests; what lifts sooner is a tap, ms.
    pub rest_ms: f64,
    /// Motion of a finger from which a hand may fall apart, mm. Less is not yet known to mean anything.
    pub split_mm: f64,
    /// Part of the motion that the rigid fit may leave unexplained, as a ratio of lengths, before a hand falls apart.
    pub split_fraction: f64,
    /// Least retreat from the farthest point that turns a leg back, mm. Smaller: rubbing makes many little pushes.
    pub reversal_mm: f64,
    /// Least retreat as a part of the leg's length; the larger of the two counts.
    pub reversal_fraction: f64,
    /// Width or height from which a contact is a palm or sleeve, mm.
    pub palm_mm: f64,
    /// Time in which later evidence takes back what a contact did, ms (Schwarz et al. 2014 revise for about that long).
    pub revise_ms: f64,
    /// A down this soon after a lift …, ms.
    pub bridge_ms: f64,
    /// … and this near to it goes on with the same stroke, mm.
    pub bridge_mm: f64,
    /// A contact shorter than this …, ms,
    pub ghost_ms: f64,
    /// … that moved less than this, mm, …
    pub ghost_mm: f64,
    /// … while its size changed by more than this, is a ghost and no tap, mm.
    pub ghost_resize_mm: f64,
    /// So many contacts that follow each other so soon and near (`bridge_ms`, `bridge_mm`) within `rest_ms`, none of them more than a tap, are a palm.
    /// Smaller: a screen that bounces loses taps; larger: a palm without size taps for longer.
    pub palm_flickers: f64,
    /// A contact that reports the very same coordinates for longer than this while others move is stuck, ms.
    pub stuck_ms: f64,
}

impl Default for GestureParams {
    fn default() -> Self {
        Self {
            hand_box_mm: 200.0,
            join_ms: 150.0,
            late_reach_mm: 120.0,
            facing_gap_mm: 190.0,
            motion_mm: 4.0,
            rest_ms: 500.0,
            split_mm: 8.0,
            split_fraction: 0.5,
            reversal_mm: 15.0,
            reversal_fraction: 0.25,
            palm_mm: 25.0,
            revise_ms: 250.0,
            bridge_ms: 50.0,
            bridge_mm: 10.0,
            ghost_ms: 60.0,
            ghost_mm: 2.0,
            ghost_resize_mm: 2.0,
            palm_flickers: 3.0,
            stuck_ms: 20_000.0,
        }
    }
}

/// Name, unit and range of a parameter.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// The field's name.
    pub name: &'static str,
    /// Its unit; `1` for ratios.
    pub unit: &'static str,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Reads the field.
    pub get: fn(&GestureParams) -> f64,
}

/// A parameter outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParamsError {
    /// A value is not in its range.
    #[error("{name}: expected {min}..={max} {unit}, found {value}")]
    OutOfRange {
        /// The field.
        name: &'static str,
        /// Its unit.
        unit: &'static str,
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
        /// What it holds.
        value: f64,
    },
    /// Two values contradict each other.
    #[error("{greater}: expected at least {smaller}, found less")]
    Order {
        /// The field that should be greater.
        greater: &'static str,
        /// The field that should be smaller.
        smaller: &'static str,
    },
}

macro_rules! bound {
    ($field:ident, $unit:literal, $min:expr, $max:expr) => {
        Bound {
            name: stringify!($field),
            unit: $unit,
            min: $min,
            max: $max,
            get: |params| params.$field,
        }
    };
}

impl GestureParams {
    /// Unit and range of every parameter, in the order of the fields.
    pub const BOUNDS: [Bound; 19] = [
        bound!(hand_box_mm, "mm", 80.0, 400.0),
        bound!(join_ms, "ms", 0.0, 1000.0),
        bound!(late_reach_mm, "mm", 0.0, 400.0),
        bound!(facing_gap_mm, "mm", 0.0, 400.0),
        bound!(motion_mm, "mm", 0.5, 20.0),
        bound!(rest_ms, "ms", 100.0, 5000.0),
        bound!(split_mm, "mm", 1.0, 100.0),
        bound!(split_fraction, "1", 0.1, 1.0),
        bound!(reversal_mm, "mm", 1.0, 200.0),
        bound!(reversal_fraction, "1", 0.0, 1.0),
        bound!(palm_mm, "mm", 10.0, 100.0),
        bound!(revise_ms, "ms", 0.0, 1000.0),
        bound!(bridge_ms, "ms", 0.0, 200.0),
        bound!(bridge_mm, "mm", 0.0, 50.0),
        bound!(ghost_ms, "ms", 0.0, 200.0),
        bound!(ghost_mm, "mm", 0.0, 10.0),
        bound!(ghost_resize_mm, "mm", 0.0, 50.0),
        bound!(palm_flickers, "1", 1.0, 10.0),
        bound!(stuck_ms, "ms", 1000.0, 600_000.0),
    ];

    /// Checks every value against [`Self::BOUNDS`], and that a hand can only fall apart once it has moved.
    ///
    /// # Errors
    /// The first parameter out of range, or the pair that contradicts itself.
    pub fn validate(&self) -> Result<(), ParamsError> {
        for bound in &Self::BOUNDS {
            let value = (bound.get)(self);
            if !(bound.min..=bound.max).contains(&value) {
                return Err(ParamsError::OutOfRange {
                    name: bound.name,
                    unit: bound.unit,
                    min: bound.min,
                    max: bound.max,
                    value,
                });
            }
        }
        if self.split_mm < self.motion_mm {
            return Err(ParamsError::Order {
                greater: "split_mm",
                smaller: "motion_mm",
            });
        }
        Ok(())
    }
}

/// Milliseconds of a parameter in the microseconds of session time.
pub(super) fn micros(ms: f64) -> u64 {
    (ms * 1000.0).round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid_and_each_bound_reads_its_own_field() {
        let params = GestureParams::default();
        assert_eq!(params.validate(), Ok(()));
        let values: Vec<f64> = GestureParams::BOUNDS.iter().map(|b| (b.get)(&params)).collect();
        assert_eq!(values[0], params.hand_box_mm);
        assert_eq!(values[18], params.stuck_ms);
    }

    #[test]
    fn values_out_of_range_are_refused_by_name() {
        let params = GestureParams {
            palm_mm: f64::NAN,
            ..GestureParams::default()
        };
        let error = params.validate().unwrap_err().to_string();
        assert!(error.starts_with("palm_mm: expected 10..=100 mm"), "{error}");
        let params = GestureParams {
            split_mm: 3.0,
            ..GestureParams::default()
        };
        assert!(params.validate().unwrap_err().to_string().contains("motion_mm"));
    }
}
