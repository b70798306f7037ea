//! Time as a table lives through it.

/// Adds up the time between looks. A clock that is set back adds nothing, and one that leaps (a machine that slept, a
/// clock that was set) adds no more than a look may take: no countdown runs out unseen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lived {
    longest: u64,
    last: Option<u64>,
    total: u64,
}

impl Lived {
    /// `longest` is what one look may add, in the unit of the clock.
    pub(super) fn new(longest: u64) -> Self {
        Self {
            longest,
            last: None,
            total: 0,
        }
    }

    /// The clock says `now`: the time lived through so far.
    pub(super) fn at(&mut self, now: u64) -> u64 {
        let step = self.last.map_or(0, |last| now.saturating_sub(last));
        self.last = Some(now);
        self.total += step.min(self.longest);
        self.total
    }

    /// The time lived through up to the last look.
    pub(super) fn total(&self) -> u64 {
        self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_leaps_nor_steps_back_count() {
        let mut lived = Lived::new(1000);
        assert_eq!(lived.at(5_000_000), 0);
        assert_eq!(lived.at(5_000_400), 400);
        assert_eq!(lived.at(100), 400);
        assert_eq!(lived.at(700), 1000);
        assert_eq!(lived.at(u64::MAX), 2000);
        assert_eq!(lived.at(u64::MAX), 2000);
        assert_eq!(lived.total(), 2000);
    }
}
