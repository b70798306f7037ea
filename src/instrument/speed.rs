//! Speeds of the geological clock that can be chosen.

use crate::gesture::command::Mode;
use crate::units::MYR;

/// Speeds this near to each other are the same.
const SAME: f64 = 1.01;

/// Speeds of a world, My of model time per second.
pub(super) struct Speeds {
    /// All, from slowest to fastest; keys go through them one by one.
    ladder: [f64; 6],
    /// Those of the control: slow, normal, fast, and round again.
    stops: [f64; 3],
}

impl Speeds {
    /// Those of `mode`: a planet needs ten times as long for anything.
    pub(super) fn of(mode: Mode) -> &'static Self {
        match mode {
            Mode::Mountain => &Self {
                ladder: [0.1, 0.2, 0.5, 1.0, 2.0, 5.0],
                stops: [0.1, 0.5, 2.0],
            },
            Mode::Globe => &Self {
                ladder: [0.5, 1.0, 2.0, 4.0, 8.0, 16.0],
                stops: [1.0, 4.0, 8.0],
            },
        }
    }

    /// The control's next speed after `pace` (years per second), My per second.
    pub(super) fn next(&self, pace: f64) -> f64 {
        let faster = self.stops.into_iter().find(|stop| *stop * MYR > pace * SAME);
        faster.unwrap_or(self.stops[0])
    }

    /// One step faster or slower than `pace` (years per second), My per second.
    pub(super) fn stepped(&self, pace: f64, faster: bool) -> f64 {
        let [least, .., most] = self.ladder;
        let mut ladder = self.ladder.into_iter();
        if faster {
            ladder.find(|step| *step * MYR > pace * SAME).unwrap_or(most)
        } else {
            ladder.rfind(|step| *step * MYR < pace / SAME).unwrap_or(least)
        }
    }

    /// Where `pace` (years per second) lies between slowest and fastest, 0–1, by ratios.
    pub(super) fn place(&self, pace: f64) -> f64 {
        let [least, .., most] = self.ladder;
        ((pace / MYR / least).ln() / (most / least).ln()).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_control_goes_round_and_keys_stop_at_the_ends() {
        assert_eq!(Speeds::of(Mode::Mountain).next(0.1 * MYR), 0.5);
        assert_eq!(Speeds::of(Mode::Mountain).next(0.5 * MYR), 2.0);
        assert_eq!(Speeds::of(Mode::Mountain).next(2.0 * MYR), 0.1);
        assert_eq!(Speeds::of(Mode::Mountain).next(1.0 * MYR), 2.0);
        assert_eq!(Speeds::of(Mode::Mountain).stepped(0.5 * MYR, true), 1.0);
        assert_eq!(Speeds::of(Mode::Mountain).stepped(0.5 * MYR, false), 0.2);
        assert_eq!(Speeds::of(Mode::Mountain).stepped(5.0 * MYR, true), 5.0);
        assert_eq!(Speeds::of(Mode::Mountain).stepped(0.1 * MYR, false), 0.1);
        assert_eq!(Speeds::of(Mode::Mountain).stepped(0.0, true), 0.1);
        assert_eq!(Speeds::of(Mode::Globe).next(4.0 * MYR), 8.0);
    }

    #[test]
    fn the_place_grows_with_the_pace() {
        assert_eq!(Speeds::of(Mode::Mountain).place(0.1 * MYR), 0.0);
        assert_eq!(Speeds::of(Mode::Mountain).place(5.0 * MYR), 1.0);
        assert!(
            Speeds::of(Mode::Mountain).place(0.5 * MYR) > 0.4
                && Speeds::of(Mode::Mountain).place(0.5 * MYR) < 0.42
        );
        assert_eq!(Speeds::of(Mode::Mountain).place(0.0), 0.0);
    }
}
