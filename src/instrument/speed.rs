//! Speeds of the geological clock that can be chosen.

use crate::units::MYR;

/// All speeds, My of model time per second, from slowest to fastest; keys go through them one by one.
const LADDER: [f64; 6] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0];

/// Those of the control: slow, normal, fast, and round again.
const STOPS: [f64; 3] = [0.1, 0.5, 2.0];

/// Speeds this near to each other are the same.
const SAME: f64 = 1.01;

/// The control's next speed after `pace` (years per second), My per second.
pub(super) fn next(pace: f64) -> f64 {
    let faster = STOPS.into_iter().find(|stop| *stop * MYR > pace * SAME);
    faster.unwrap_or(STOPS[0])
}

/// One step faster or slower than `pace` (years per second), My per second.
pub(super) fn stepped(pace: f64, faster: bool) -> f64 {
    let mut ladder = LADDER.into_iter();
    if faster {
        ladder.find(|step| *step * MYR > pace * SAME).unwrap_or(LADDER[5])
    } else {
        ladder
            .rfind(|step| *step * MYR < pace / SAME)
            .unwrap_or(LADDER[0])
    }
}

/// Where `pace` (years per second) lies between slowest and fastest, 0–1, by ratios.
pub(super) fn place(pace: f64) -> f64 {
    let (least, most) = (LADDER[0], LADDER[5]);
    ((pace / MYR / least).ln() / (most / least).ln()).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_control_goes_round_and_keys_stop_at_the_ends() {
        assert_eq!(next(0.1 * MYR), 0.5);
        assert_eq!(next(0.5 * MYR), 2.0);
        assert_eq!(next(2.0 * MYR), 0.1);
        assert_eq!(next(1.0 * MYR), 2.0);
        assert_eq!(stepped(0.5 * MYR, true), 1.0);
        assert_eq!(stepped(0.5 * MYR, false), 0.2);
        assert_eq!(stepped(5.0 * MYR, true), 5.0);
        assert_eq!(stepped(0.1 * MYR, false), 0.1);
        assert_eq!(stepped(0.0, true), 0.1);
    }

    #[test]
    fn the_place_grows_with_the_pace() {
        assert_eq!(place(0.1 * MYR), 0.0);
        assert_eq!(place(5.0 * MYR), 1.0);
        assert!(place(0.5 * MYR) > 0.4 && place(0.5 * MYR) < 0.42);
        assert_eq!(place(0.0), 0.0);
    }
}
