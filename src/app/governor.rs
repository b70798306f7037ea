//! Resolution gives way before the frame rate does.
//!
//! With vertical sync a frame takes a whole number of refreshes however little there is to draw, so spare time cannot
//! be read off. The governor therefore tries: when frames have been in time for a while it takes one step up, and
//! goes back when they no longer are, waiting twice as long before it tries that again.

/// Resolutions the land may be drawn at, as parts of the window's. Neighbours are near enough that a step is not seen.
const SCALES: [f32; 6] = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
/// Frames that are judged together.
const WINDOW: usize = 24;
/// A frame this many times longer than wanted is late.
const LATE: f64 = 1.25;
/// Late frames of a window after which resolution gives way.
const MOST_LATE: usize = 8;
/// Windows in time before a step up is tried.
const FIRST_PATIENCE: u32 = 8;
/// The longest it waits before trying again, windows.
const LONGEST_PATIENCE: u32 = 256;

/// Chooses the resolution from how long frames take.
#[derive(Clone, Debug)]
pub(super) struct Governor {
    wanted_ms: f64,
    step: usize,
    frames: usize,
    late: usize,
    in_time: u32,
    patience: u32,
    /// The step now in use is a trial.
    trial: bool,
}

impl Governor {
    /// Begins at full resolution. `wanted_ms` is how long a frame may take.
    pub(super) fn new(wanted_ms: f64) -> Self {
        Self {
            wanted_ms,
            step: SCALES.len() - 1,
            frames: 0,
            late: 0,
            in_time: 0,
            patience: FIRST_PATIENCE,
            trial: false,
        }
    }

    /// Begins low, for machines that are known to be slow: nobody has to wait until it has come down.
    pub(super) fn low(wanted_ms: f64) -> Self {
        Self {
            step: 1,
            ..Self::new(wanted_ms)
        }
    }

    /// The resolution, as a part of the window's.
    pub(super) fn scale(&self) -> f32 {
        SCALES[self.step]
    }

    /// A frame took `ms`. Returns the new resolution if it changes.
    pub(super) fn frame(&mut self, ms: f64) -> Option<f32> {
        self.frames += 1;
        self.late += usize::from(ms > LATE * self.wanted_ms);
        if self.late > MOST_LATE {
            return self.down();
        }
        if self.frames < WINDOW {
            return None;
        }
        self.begin();
        self.in_time += 1;
        if self.in_time < self.patience {
            return None;
        }
        if self.trial {
            // The step held: the next one may be tried as soon as the first was.
            self.patience = FIRST_PATIENCE;
            self.trial = false;
        }
        self.in_time = 0;
        if self.step + 1 == SCALES.len() {
            return None;
        }
        self.step += 1;
        self.trial = true;
        Some(self.scale())
    }

    fn down(&mut self) -> Option<f32> {
        self.begin();
        self.in_time = 0;
        if self.trial {
            self.patience = (self.patience * 2).min(LONGEST_PATIENCE);
        }
        self.trial = false;
        if self.step == 0 {
            return None;
        }
        self.step -= 1;
        Some(self.scale())
    }

    fn begin(&mut self) {
        self.frames = 0;
        self.late = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs `frames` frames on a machine that takes `cost` ms at full resolution, and returns how often it changed.
    fn run(governor: &mut Governor, frames: usize, cost: f64) -> usize {
        let takes = |scale: f32| {
            let ms = cost * f64::from(scale * scale);
            (ms / 16.0).ceil() * 16.0
        };
        (0..frames)
            .filter(|_| governor.frame(takes(governor.scale())).is_some())
            .count()
    }

    #[test]
    fn a_fast_machine_stays_at_full_resolution() {
        let mut governor = Governor::new(16.7);
        assert_eq!(run(&mut governor, 10_000, 12.0), 0);
        assert_eq!(governor.scale(), 1.0);
    }

    #[test]
    fn a_slow_machine_settles_where_frames_are_in_time() {
        let mut governor = Governor::new(16.7);
        run(&mut governor, 2_000, 30.0);
        let settled = governor.scale();
        assert!((0.6..=0.8).contains(&settled), "{settled}");
        // It tries one step more now and then, more and more rarely.
        let tries = run(&mut governor, 20_000, 30.0);
        assert!(tries <= 12, "{tries}");
    }

    #[test]
    fn one_that_begins_low_comes_up_where_there_is_time() {
        let mut governor = Governor::low(50.0);
        assert!(governor.scale() < 0.7);
        run(&mut governor, 10_000, 12.0);
        assert_eq!(governor.scale(), 1.0);
    }

    #[test]
    fn a_hopeless_machine_stays_at_the_least() {
        let mut governor = Governor::new(16.7);
        run(&mut governor, 5_000, 1000.0);
        assert_eq!(governor.scale(), SCALES[0]);
    }

    #[test]
    fn it_comes_back_when_there_is_time_again() {
        let mut governor = Governor::new(16.7);
        run(&mut governor, 1_000, 60.0);
        assert_eq!(governor.scale(), SCALES[0]);
        run(&mut governor, 10_000, 10.0);
        assert_eq!(governor.scale(), 1.0);
    }
}
