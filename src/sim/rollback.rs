//! Taking back what a palm did: checkpoints, and the input since.

use std::collections::VecDeque;

use crate::gesture::contact::InputFrame;

/// How far back a checkpoint must reach, µs: the revision time of strokes (250 ms) and a few ticks.
const REACH_US: i64 = 320_000;

/// States from the last moments and the input that came since the oldest of them.
#[derive(Clone, Debug)]
pub(super) struct Rollback<S> {
    /// Session time up to which input has been played (−16 ms: none), and the state then.
    checkpoints: VecDeque<(i64, S)>,
    frames: VecDeque<InputFrame>,
}

impl<S: Clone> Rollback<S> {
    pub(super) fn new() -> Self {
        Self {
            checkpoints: VecDeque::new(),
            frames: VecDeque::new(),
        }
    }

    /// Remembers `state` as it is when all input up to `played_us` has been played, and forgets what no stroke can be
    /// revised to any more. One checkpoint at or before the reach always stays.
    pub(super) fn checkpoint(&mut self, played_us: i64, state: &S) {
        self.checkpoints.push_back((played_us, state.clone()));
        while self
            .checkpoints
            .get(1)
            .is_some_and(|(t, _)| *t <= played_us - REACH_US)
        {
            self.checkpoints.pop_front();
        }
        let kept_us = self.checkpoints.front().map_or(i64::MIN, |(t, _)| *t);
        while self
            .frames
            .front()
            .is_some_and(|frame| (frame.t_us as i64) <= kept_us)
        {
            self.frames.pop_front();
        }
    }

    /// True when the last checkpoint is so old that input piles up behind it, as it does while no steps are taken.
    pub(super) fn is_due(&self, played_us: i64) -> bool {
        let last = self.checkpoints.back();
        last.is_none_or(|(t, _)| *t <= played_us - REACH_US)
    }

    /// Remembers a frame of input.
    pub(super) fn record(&mut self, frame: &InputFrame) {
        self.frames.push_back(frame.clone());
    }

    /// The newest state from before `since_us` and the frames that came after it. `None` when nothing reaches back
    /// so far. Later checkpoints are forgotten.
    pub(super) fn rewind(&mut self, since_us: u64) -> Option<(S, Vec<InputFrame>)> {
        let index = self
            .checkpoints
            .iter()
            .rposition(|(played_us, _)| *played_us < since_us as i64)?;
        self.checkpoints.truncate(index + 1);
        let (played_us, state) = self.checkpoints.back()?;
        let frames = self
            .frames
            .iter()
            .filter(|f| f.t_us as i64 > *played_us)
            .cloned()
            .collect();
        Some((state.clone(), frames))
    }
}

#[cfg(test)]
mod tests {
    use super::super::TICK_US;
    use super::*;

    fn frame(t_us: u64) -> InputFrame {
        InputFrame {
            t_us,
            ..InputFrame::default()
        }
    }

    const TICK: i64 = TICK_US as i64;

    #[test]
    fn rewinds_to_before_the_moment_and_keeps_what_came_after() {
        let mut rollback = Rollback::new();
        for tick in 0..100i64 {
            rollback.record(&frame(tick as u64 * TICK_US));
            if tick % 6 == 0 {
                rollback.checkpoint(tick * TICK, &tick);
            }
        }
        let (state, frames) = rollback.rewind(90 * TICK_US).expect("within reach");
        assert_eq!(state, 84);
        assert_eq!(frames.first().map(|f| f.t_us), Some(85 * TICK_US));
        assert_eq!(frames.last().map(|f| f.t_us), Some(99 * TICK_US));
    }

    #[test]
    fn forgets_what_is_too_old_but_never_all() {
        let mut rollback = Rollback::new();
        for tick in 0..1000i64 {
            rollback.record(&frame(tick as u64 * TICK_US));
            rollback.checkpoint(tick * TICK, &tick);
        }
        assert!(rollback.checkpoints.len() < 30);
        assert!(rollback.frames.len() < 30);
        assert!(rollback.rewind(10 * TICK_US).is_none());
        assert!(rollback.rewind(999 * TICK_US - 250_000).is_some());
    }

    #[test]
    fn input_does_not_pile_up_while_no_steps_are_taken() {
        let mut rollback = Rollback::new();
        rollback.checkpoint(-TICK, &-1);
        for tick in 0..1000i64 {
            rollback.record(&frame(tick as u64 * TICK_US));
            if rollback.is_due(tick * TICK) {
                rollback.checkpoint(tick * TICK, &tick);
            }
        }
        assert!(rollback.frames.len() < 60, "{}", rollback.frames.len());
        assert!(rollback.rewind(999 * TICK_US - 250_000).is_some());
    }

    #[test]
    fn the_very_first_contact_can_be_taken_back() {
        let mut rollback = Rollback::new();
        rollback.checkpoint(-TICK, &"start");
        rollback.record(&frame(0));
        let (state, frames) = rollback.rewind(0).expect("the start is kept");
        assert_eq!((state, frames.len()), ("start", 1));
    }
}
