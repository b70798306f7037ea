//! Scan time: when the device saw a frame, by its own clock.
//!
//! It counts in 100 µs and starts over at its largest value. Devices declare ten different units and some count in
//! another one than they say, so the declared unit is not looked at; what does not agree with the arrival of the
//! reports is not believed.

/// One step, µs.
const STEP_US: u64 = 100;

/// A device's clock may fall this far behind the arrival of its reports: the longest that a report waits on its way,
/// and some drift.
const MOST_BEHIND_US: u64 = 30_000;

/// Weight of a disagreement against agreements, and the weight at which the clock is believed no more: a clock that
/// drifts by a tenth of a thousandth disagrees once in some ten thousand reports, one that counts in milliseconds
/// with every fourth.
const STRIKE: u32 = 64;
const STRUCK_OUT: u32 = 512;

/// Turns scan times into µs of the host's clock: steady like the device's, never later than the report arrived, and
/// never going back.
#[derive(Clone, Debug)]
pub(super) struct ScanClock {
    /// Values until it starts over.
    period: u64,
    /// Of the frame before: scan time, arrival, and the time given.
    before: Option<(u64, u64, u64)>,
    strikes: u32,
}

impl ScanClock {
    /// A clock whose largest value is `max`, or has `bits` bits.
    pub(super) fn new(max: i64, bits: u8) -> Self {
        let all = 1_u64 << bits;
        // A largest value below a tenth of a second cannot be meant.
        let period = u64::try_from(max).map_or(all, |max| if max < 1000 { all } else { max + 1 });
        Self {
            period,
            before: None,
            strikes: 0,
        }
    }

    /// When the frame was seen that says `scan` and arrived at `arrival_us`.
    pub(super) fn stamp(&mut self, scan: u64, arrival_us: u64) -> u64 {
        let scan = scan % self.period.max(1);
        let stamp = match self.before {
            None => arrival_us,
            Some((.., before_us)) if self.strikes >= STRUCK_OUT => arrival_us.max(before_us),
            Some((scan_before, arrival_before, before_us)) => {
                let passed = arrival_us.saturating_sub(arrival_before);
                let steps = (scan + self.period - scan_before) % self.period;
                let told = before_us + steps * STEP_US;
                // After half a period it may have started over unseen.
                if passed >= self.period * STEP_US / 2 {
                    arrival_us.max(before_us)
                } else if told + MOST_BEHIND_US < arrival_us {
                    self.strikes += STRIKE;
                    arrival_us.max(before_us)
                } else {
                    self.strikes = self.strikes.saturating_sub(1);
                    told.min(arrival_us).max(before_us)
                }
            }
        };
        self.before = Some((scan, arrival_us, stamp));
        stamp
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_of_arrival_is_smoothed_and_the_wrap_is_no_step() {
        let mut clock = ScanClock::new(65_535, 16);
        let mut stamps = Vec::new();
        for i in 0..200_u64 {
            let seen_us = 6_500_000 + i * 8_000;
            let scan = (seen_us / 100) % 65_536;
            stamps.push(clock.stamp(scan, seen_us + 2_000 + [0, 900, 300][i as usize % 3]));
        }
        assert!(stamps.windows(2).all(|pair| pair[1] - pair[0] == 8_000));
        assert_eq!(stamps[0], 6_502_000);
        assert!(clock.strikes < STRUCK_OUT);
    }

    #[test]
    fn a_clock_in_other_units_is_given_up_and_arrival_counts() {
        let mut slow = ScanClock::new(65_535, 16);
        let mut fast = ScanClock::new(65_535, 16);
        for i in 0..400_u64 {
            let arrival = 1_000_000 + i * 8_000;
            let stamp = slow.stamp(i * 8 % 65_536, arrival);
            assert!(arrival - stamp <= MOST_BEHIND_US, "{i}");
            let stamp = fast.stamp(i * 800 % 65_536, arrival);
            assert_eq!(stamp, arrival);
        }
        assert!(slow.strikes >= STRUCK_OUT && fast.strikes == 0);
        assert_eq!(slow.stamp(7, 9_000_000), 9_000_000);
    }

    #[test]
    fn garbage_never_goes_back_nor_ahead() {
        let mut clock = ScanClock::new(-1, 32);
        let (mut scan, mut arrival, mut last) = (7_u64, 0_u64, 0);
        for _ in 0..10_000 {
            scan = scan
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            arrival += scan >> 48;
            let stamp = clock.stamp(scan >> 32, arrival);
            assert!((last..=arrival).contains(&stamp));
            last = stamp;
        }
    }

    #[test]
    fn after_a_pause_the_clock_starts_afresh() {
        let mut clock = ScanClock::new(65_535, 16);
        clock.stamp(100, 1_000_000);
        assert_eq!(clock.stamp(90, 9_000_000), 9_000_000);
        assert_eq!(clock.stamp(170, 9_009_000), 9_008_000);
    }
}
