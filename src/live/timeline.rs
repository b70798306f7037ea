//! How session time follows the table's, and where input waits for it.

use std::collections::VecDeque;

use crate::gesture::command::Command;
use crate::gesture::contact::{ContactEvent, InputFrame};
use crate::sim::TICK_US;

/// How far session time may stay behind the table's, µs, before it is slowed. A visitor notices more.
const MOST_LAG_US: u64 = 200_000;
/// How far behind it is then taken to be, µs: two ticks.
const LAG_LEFT_US: u64 = 2 * TICK_US;

/// Session time, from table time. It runs with the table's clock as long as the session keeps up, and is slowed where it
/// does not: contacts then happen closer together, but in their order, and none is lost.
#[derive(Debug, Default)]
pub(super) struct Timeline {
    /// Table time at session time 0, µs; unknown until the first word from the table.
    origin_us: Option<u64>,
    /// Session time that the table has reached, µs.
    now_us: Option<u64>,
    /// Input that waits for its tick, stamped in session time, which never decreases.
    waiting: VecDeque<InputFrame>,
    last_stamp_us: u64,
    /// Table time that was left out so far, µs.
    slowed_us: u64,
}

impl Timeline {
    /// A session that begins when the table's time is `table_us`.
    pub(super) fn beginning(table_us: Option<u64>) -> Self {
        Self {
            origin_us: table_us,
            ..Self::default()
        }
    }

    /// The table's time at the session time that was reached, µs.
    pub(super) fn table_us(&self) -> Option<u64> {
        Some(self.origin_us? + self.now_us.unwrap_or(0))
    }

    /// Table time that was left out because the session could not keep up, µs.
    pub(super) fn slowed_us(&self) -> u64 {
        self.slowed_us
    }

    /// Takes input of table time `table_us`. What comes late counts as of now.
    pub(super) fn take(&mut self, events: Vec<ContactEvent>, commands: Vec<Command>, table_us: u64) {
        self.last_stamp_us = self.last_stamp_us.max(self.session_us(table_us));
        self.waiting.push_back(InputFrame {
            t_us: self.last_stamp_us,
            events,
            commands,
        });
    }

    /// The table's time has come to `table_us`: all input before that has been taken.
    pub(super) fn advance(&mut self, table_us: u64) {
        let now_us = self.session_us(table_us);
        self.now_us = self.now_us.max(Some(now_us));
    }

    /// True if the tick at session time `tick_us` may be played.
    pub(super) fn reaches(&self, tick_us: u64) -> bool {
        self.now_us >= Some(tick_us)
    }

    /// Slows session time if the tick that is next, at `tick_us`, is too far behind the table: the time between shrinks,
    /// and with it that of the input in it.
    pub(super) fn keep_up(&mut self, tick_us: u64) {
        let Some(now_us) = self.now_us else { return };
        let lag_us = now_us.saturating_sub(tick_us);
        if lag_us <= MOST_LAG_US {
            return;
        }
        let shorter = |t_us: u64| match t_us.checked_sub(tick_us) {
            None => t_us,
            Some(after_us) if after_us <= lag_us => tick_us + after_us * LAG_LEFT_US / lag_us,
            Some(after_us) => tick_us + after_us - (lag_us - LAG_LEFT_US),
        };
        for frame in &mut self.waiting {
            frame.t_us = shorter(frame.t_us);
        }
        self.last_stamp_us = shorter(self.last_stamp_us);
        self.now_us = Some(shorter(now_us));
        self.origin_us = self.origin_us.map(|origin| origin + lag_us - LAG_LEFT_US);
        self.slowed_us += lag_us - LAG_LEFT_US;
    }

    /// The next frame of input for the tick at `tick_us`. It is stamped later than the tick before, so that it plays in
    /// the same tick when it is replayed.
    pub(super) fn due(&mut self, tick_us: u64) -> Option<InputFrame> {
        let mut frame = self.waiting.pop_front_if(|frame| frame.t_us <= tick_us)?;
        if let Some(before_us) = tick_us.checked_sub(TICK_US) {
            frame.t_us = frame.t_us.max(before_us + 1);
        }
        Some(frame)
    }

    fn session_us(&mut self, table_us: u64) -> u64 {
        table_us.saturating_sub(*self.origin_us.get_or_insert(table_us))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(timeline: &mut Timeline, tick_us: u64) -> Vec<u64> {
        std::iter::from_fn(|| timeline.due(tick_us))
            .map(|frame| frame.t_us)
            .collect()
    }

    fn taken(times: &[u64]) -> Timeline {
        let mut timeline = Timeline::beginning(Some(1_000_000));
        for &t_us in times {
            timeline.take(Vec::new(), Vec::new(), 1_000_000 + t_us);
        }
        timeline
    }

    #[test]
    fn input_keeps_its_time_and_waits_for_its_tick() {
        let mut timeline = taken(&[0, 5_000, 16_000, 16_001, 40_000]);
        assert!(!timeline.reaches(0), "the table has not said so");
        timeline.advance(1_020_000);
        assert!(timeline.reaches(16_000) && !timeline.reaches(32_000));
        assert_eq!(stamps(&mut timeline, 0), [0]);
        assert_eq!(stamps(&mut timeline, 16_000), [5_000, 16_000]);
        assert_eq!(stamps(&mut timeline, 32_000), [16_001]);
    }

    #[test]
    fn late_input_counts_as_of_the_tick_that_plays_it() {
        let mut timeline = taken(&[30_000, 10_000]);
        assert_eq!(
            stamps(&mut timeline, 64_000),
            [48_001, 48_001],
            "time never runs back"
        );
        assert_eq!(
            taken(&[5]).due(0).map(|frame| frame.t_us),
            None,
            "not before its time"
        );
    }

    #[test]
    fn a_small_lag_is_caught_up_with_and_a_great_one_is_left_out() {
        let times = [0, 100_000, 500_000, 900_000, 1_000_000, 1_050_000];
        let mut timeline = taken(&times);
        timeline.advance(1_000_000 + 200_000);
        timeline.keep_up(0);
        assert_eq!(timeline.slowed_us(), 0);
        timeline.advance(1_000_000 + 1_000_000);
        timeline.keep_up(0);
        assert_eq!(timeline.slowed_us(), 968_000);
        assert!(timeline.reaches(32_000) && !timeline.reaches(48_000));
        assert_eq!(
            timeline.table_us(),
            Some(2_000_000),
            "the table's clock is what it was"
        );
        let mut all = Vec::new();
        for tick in 0..8 {
            all.extend(stamps(&mut timeline, tick * TICK_US));
        }
        assert_eq!(all, [0, 3_200, 16_000, 28_800, 32_000, 82_000]);
        // The table goes on, and so does the session.
        timeline.take(Vec::new(), Vec::new(), 2_100_000);
        timeline.advance(2_100_000);
        assert_eq!(stamps(&mut timeline, 144_000), [132_000]);
        assert!(timeline.reaches(128_000) && !timeline.reaches(144_000));
    }

    #[test]
    fn the_first_word_from_the_table_is_time_zero() {
        let mut timeline = Timeline::beginning(None);
        timeline.advance(77_000_000);
        assert!(timeline.reaches(0) && !timeline.reaches(TICK_US));
        timeline.advance(3);
        assert!(timeline.reaches(0), "a clock that jumps back stops time");
    }
}
