//! What a device makes a habit of: how often it names a contact that is down.
//!
//! Devices forget to say that a finger has lifted. Those that name every contact again and again can be seen through:
//! who is not named any more is gone. But some only report changes, and there a finger that lies still is not named
//! for minutes. Which kind a device is shows in what it has done so far: one that names contacts that have not changed
//! at all has no other reason than habit.

/// A contact is never given up sooner after it was last named, µs. Linux takes the same time.
const SHORTEST_US: u64 = 100_000;

/// A silence this many times as long as any before says that the finger is gone.
const LONGER: u64 = 4;

/// A device that has been silent for so long about a finger that was down only reports changes, µs.
const LONGEST_US: u64 = 1_000_000;

/// How often a contact is named unchanged until that is a habit: with devices that are bound to it by the rules, and
/// with others.
const REPEATS_BY_RULE: u32 = 16;
const REPEATS: u32 = 256;

/// Noise may change every coordinate; then so many namings without a gap are as good.
const NAMINGS: u32 = 4096;
const GAP_US: u64 = 50_000;

/// What one device has done so far.
#[derive(Clone, Debug)]
pub struct Habit {
    by_rule: bool,
    /// Contacts named unchanged, and named at all.
    repeats: u32,
    namings: u32,
    /// Longest time between two namings of a contact that stayed down, µs.
    longest_us: u64,
}

impl Habit {
    /// A device of which nothing is known but whether the rules bind it to name every contact in every frame.
    pub(super) fn new(by_rule: bool) -> Self {
        Self {
            by_rule,
            repeats: 0,
            namings: 0,
            longest_us: 0,
        }
    }

    /// A contact that was down is named again after `gap_us`.
    pub(super) fn named(&mut self, gap_us: u64, unchanged: bool) {
        self.namings = self.namings.saturating_add(1);
        self.repeats = self
            .repeats
            .saturating_add(u32::from(unchanged && gap_us < SHORTEST_US));
        self.longest_us = self.longest_us.max(gap_us);
    }

    /// A contact that was given up is there again: it had been silent for `gap_us`, and down all the time.
    pub(super) fn wronged(&mut self, gap_us: u64) {
        self.longest_us = self.longest_us.max(gap_us);
    }

    /// After what silence a contact has lifted, µs; `None` while silence says nothing.
    pub fn silence_us(&self) -> Option<u64> {
        let repeats = if self.by_rule { REPEATS_BY_RULE } else { REPEATS };
        let steady = self.namings >= NAMINGS && self.longest_us < GAP_US;
        let is_habit = self.repeats >= repeats || steady;
        (is_habit && self.longest_us < LONGEST_US).then(|| SHORTEST_US.max(LONGER * self.longest_us))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_names_still_fingers_is_believed_when_it_falls_silent() {
        let mut habit = Habit::new(true);
        for _ in 0..REPEATS_BY_RULE {
            assert_eq!(habit.silence_us(), None);
            habit.named(8_000, true);
        }
        assert_eq!(habit.silence_us(), Some(100_000));
        habit.named(60_000, false);
        assert_eq!(habit.silence_us(), Some(240_000));
        habit.wronged(400_000);
        assert_eq!(habit.silence_us(), Some(1_600_000));
        habit.named(1_000_000, false);
        assert_eq!(habit.silence_us(), None);
    }

    #[test]
    fn noise_does_not_hide_a_habit_and_changes_alone_are_none() {
        let mut noisy = Habit::new(false);
        let mut changes = Habit::new(false);
        for _ in 0..NAMINGS {
            noisy.named(8_000, false);
            changes.named(8_000, false);
        }
        changes.named(70_000, false);
        assert_eq!(noisy.silence_us(), Some(100_000));
        assert_eq!(changes.silence_us(), None);
    }
}
