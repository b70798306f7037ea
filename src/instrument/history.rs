//! The land's history, and where the clock stands in it.

use crate::gesture::command::MAX_YEARS;
use crate::live::Clock;

/// One step by keys, as a part of the history.
const STEP: f64 = 0.05;

/// True when there is somewhere to go.
pub(super) fn exists(clock: &Clock) -> bool {
    clock.history_yr.1 > clock.history_yr.0
}

/// Where the clock stands, 0–1; 0 in a land without history.
pub(super) fn place(clock: &Clock) -> f64 {
    let (first, last) = clock.history_yr;
    if exists(clock) {
        ((clock.elapsed_yr - first) / (last - first)).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Whole years at a place, 0–1.
pub(super) fn years_at(clock: &Clock, part: f64) -> f64 {
    let (first, last) = clock.history_yr;
    (first + (last - first) * part).round().clamp(0.0, MAX_YEARS)
}

/// Years one step on or back from where the clock stands.
pub(super) fn stepped(clock: &Clock, forward: bool) -> Option<f64> {
    let step = if forward { STEP } else { -STEP };
    exists(clock).then(|| years_at(clock, (place(clock) + step).clamp(0.0, 1.0)))
}
