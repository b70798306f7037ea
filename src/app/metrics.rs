//! How well the table runs, measured in the loop that draws and written as JSON lines.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

/// Most samples of one kind that a second can hold; what comes beyond is not measured.
const MOST_SAMPLES: usize = 4096;

/// What the second is told besides what [`Metrics`] measures itself.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Facts {
    /// Where the kiosk's circle stands.
    pub(super) phase: &'static str,
    /// The world that is shown.
    pub(super) mode: &'static str,
    /// Steps of the world since its session began.
    #[serde(skip)]
    pub(super) steps: u64,
    /// Contacts that are down, over controls or land.
    pub(super) contacts: usize,
    /// Contacts that came to the land since the session began.
    pub(super) contacts_total: u64,
    /// Hands down now.
    pub(super) hands: usize,
    /// Pushes since the session began.
    pub(super) pushes: u64,
    /// Taps since the session began.
    pub(super) taps: u64,
    /// Contacts taken for palms, sleeves or ghosts.
    pub(super) ghosts_dropped: u64,
    /// Those of them that had acted, so that it was taken back.
    pub(super) retracted: u64,
    /// Contacts that went on with the stroke of another, which had flickered.
    pub(super) bridged: u64,
    /// Contacts that were stuck.
    pub(super) stuck: u64,
    /// Downs of contacts that were down.
    pub(super) doubled: u64,
    /// Downs beyond the cap.
    pub(super) over_cap: u64,
    /// Contacts that were withdrawn with their window or device.
    pub(super) withdrawn: u64,
    /// The source of touches that is heard, and the devices there are beside the window.
    pub(super) source: &'static str,
    pub(super) devices: usize,
    /// States of devices that are not heard, that nobody fetched in time, and packets that were turned away.
    pub(super) unheard: u64,
    pub(super) states_lost: u64,
    pub(super) packets_refused: u64,
    /// Events of contacts that were not down, or with coordinates that are no place.
    pub(super) ignored: u64,
    /// Touches that changed nothing anybody could see.
    pub(super) dead_touches: u64,
    /// Controls that were pressed.
    pub(super) control_presses: u64,
    /// Times the table was made ready for the next visitor.
    pub(super) resets: u64,
    /// Times the session's thread went on from its last good world.
    pub(super) panics: u64,
    /// Times the graphics card was lost and found again.
    pub(super) devices_lost: u64,
    /// Nodes of the land, or samples of the planet.
    pub(super) nodes: usize,
    /// Part of the window's resolution at which the land is drawn.
    pub(super) scale: f32,
    /// Model time, years.
    pub(super) elapsed_yr: f64,
    /// Greatest height, metres.
    pub(super) max_m: f32,
    /// Least height, metres.
    pub(super) min_m: f32,
    /// Plates of the planet; 0 while the mountain is shown.
    pub(super) plates: usize,
    /// Those that hands lead, and how fast the fastest of them turns, degrees per My.
    pub(super) plates_led: usize,
    pub(super) led_deg_per_my: f64,
    /// Who computes the transport and heights of folds of the mountain: `cpu` or `gpu`.
    pub(super) transport: &'static str,
    pub(super) folds: &'static str,
    /// Graphics adapter.
    pub(super) adapter: String,
    /// Graphics interface.
    pub(super) backend: String,
    /// Window, pixels.
    pub(super) width: u32,
    /// Window, pixels.
    pub(super) height: u32,
}

/// One line.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Line<'a> {
    /// Seconds since the program began.
    t_s: f64,
    /// Frames presented in the second.
    frames: usize,
    /// Time from one present to the next, ms; half of the frames took less.
    frame_ms_p50: f64,
    /// And 99 of 100 less than this.
    frame_ms_p99: f64,
    /// Time from the arrival of a touch to the present of the frame that shows it, ms.
    touch_ms_p50: f64,
    /// And 95 of 100 less than this.
    touch_ms_p95: f64,
    /// Erosion steps in the second.
    steps_per_s: f64,
    #[serde(flatten)]
    facts: &'a Facts,
}

/// The figures of one second, as the staff's page shows them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Health {
    /// Graphics adapter and interface.
    pub(super) adapter: String,
    /// Frames presented in a second.
    pub(super) fps: f64,
    /// Median time from one present to the next, ms.
    pub(super) frame_ms_p50: f64,
    /// 99th percentile of it, ms.
    pub(super) frame_ms_p99: f64,
    /// Median time from touch to present, ms.
    pub(super) touch_ms_p50: f64,
    /// 95th percentile of it, ms.
    pub(super) touch_ms_p95: f64,
    /// Erosion steps per second.
    pub(super) steps_per_s: f64,
}

/// Collects samples and closes a second whenever one is over.
#[derive(Debug, Default)]
pub(super) struct Metrics {
    out: Option<File>,
    began_s: f64,
    presented_s: Option<f64>,
    frames_ms: Vec<f64>,
    /// Arrivals of touches that no frame has shown yet, s.
    waiting_s: Vec<f64>,
    touches_ms: Vec<f64>,
    steps: u64,
    health: Health,
}

impl Metrics {
    /// Collects, and writes into the file at `path` if there is one; what was in it is kept.
    ///
    /// # Errors
    /// When the file cannot be opened for writing.
    pub(super) fn new(path: Option<&Path>) -> io::Result<Self> {
        let open = |path| File::options().create(true).append(true).open(path);
        Ok(Self {
            out: path.map(open).transpose()?,
            ..Self::default()
        })
    }

    /// True if somebody reads what is written.
    pub(super) fn writes(&self) -> bool {
        self.out.is_some()
    }

    /// The last full second.
    pub(super) fn health(&self) -> &Health {
        &self.health
    }

    /// A touch arrived.
    pub(super) fn touched(&mut self, now_s: f64) {
        if self.waiting_s.len() < MOST_SAMPLES {
            self.waiting_s.push(now_s);
        }
    }

    /// A frame that shows all touches so far was presented.
    pub(super) fn presented(&mut self, now_s: f64) {
        if let Some(last_s) = self.presented_s
            && self.frames_ms.len() < MOST_SAMPLES
        {
            self.frames_ms.push((now_s - last_s) * 1e3);
        }
        self.presented_s = Some(now_s);
        let shown = self.waiting_s.drain(..).map(|s| (now_s - s) * 1e3);
        let room = MOST_SAMPLES - self.touches_ms.len();
        self.touches_ms.extend(shown.take(room));
    }

    /// Nothing is drawn for a while: the pause is no slow frame.
    pub(super) fn paused(&mut self) {
        self.presented_s = None;
    }

    /// True when a second is over and [`Self::close`] wants the facts.
    pub(super) fn due(&self, now_s: f64) -> bool {
        now_s - self.began_s >= 1.0
    }

    /// Ends the second and writes its line. A file that cannot be written any more is given up, with a word in the log.
    pub(super) fn close(&mut self, now_s: f64, facts: &Facts) {
        let seconds = (now_s - self.began_s).max(f64::EPSILON);
        let frames = self.frames_ms.len();
        self.health = Health {
            adapter: format!("{} ({})", facts.adapter, facts.backend),
            fps: frames as f64 / seconds,
            frame_ms_p50: percentile(&mut self.frames_ms, 0.50),
            frame_ms_p99: percentile(&mut self.frames_ms, 0.99),
            touch_ms_p50: percentile(&mut self.touches_ms, 0.50),
            touch_ms_p95: percentile(&mut self.touches_ms, 0.95),
            steps_per_s: facts.steps.saturating_sub(self.steps) as f64 / seconds,
        };
        let line = Line {
            t_s: round(now_s),
            frames,
            frame_ms_p50: round(self.health.frame_ms_p50),
            frame_ms_p99: round(self.health.frame_ms_p99),
            touch_ms_p50: round(self.health.touch_ms_p50),
            touch_ms_p95: round(self.health.touch_ms_p95),
            steps_per_s: round(self.health.steps_per_s),
            facts,
        };
        self.steps = facts.steps;
        self.began_s = now_s;
        self.frames_ms.clear();
        self.touches_ms.clear();
        self.write(&line);
    }

    /// Writes one JSON line.
    pub(super) fn write(&mut self, line: &impl Serialize) {
        let Some(out) = &mut self.out else { return };
        let written = serde_json::to_string(line)
            .map_err(io::Error::other)
            .and_then(|line| writeln!(out, "{line}"));
        if let Err(error) = written {
            tracing::error!("the metrics file cannot be written any more: {error}");
            self.out = None;
        }
    }
}

/// The value that `part` of the samples do not exceed; 0 where there are none.
fn percentile(samples: &mut [f64], part: f64) -> f64 {
    samples.sort_by(f64::total_cmp);
    let last = samples.len().saturating_sub(1);
    samples
        .get((last as f64 * part).ceil() as usize)
        .copied()
        .unwrap_or(0.0)
}

/// Three decimals are more than anybody measures.
fn round(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_known_samples() {
        let mut samples: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(percentile(&mut samples, 0.50), 51.0);
        assert_eq!(percentile(&mut samples, 0.99), 100.0);
        assert_eq!(percentile(&mut samples, 0.0), 1.0);
        assert_eq!(percentile(&mut [7.0], 0.95), 7.0);
        assert_eq!(percentile(&mut [], 0.95), 0.0);
    }

    #[test]
    fn a_touch_waits_for_the_frame_that_shows_it() {
        let mut metrics = Metrics::default();
        metrics.presented(0.0);
        metrics.touched(0.004);
        metrics.presented(0.016);
        metrics.presented(0.032);
        metrics.close(1.0, &Facts::default());
        assert!((metrics.health().touch_ms_p50 - 12.0).abs() < 1e-9);
        assert!((metrics.health().frame_ms_p99 - 16.0).abs() < 1e-9);
        assert_eq!(metrics.health().fps, 2.0);
    }

    #[test]
    fn a_pause_is_no_slow_frame() {
        let mut metrics = Metrics::default();
        metrics.presented(0.0);
        metrics.paused();
        metrics.presented(100.0);
        metrics.close(101.0, &Facts::default());
        assert_eq!(metrics.health().frame_ms_p99, 0.0);
    }

    #[test]
    fn each_second_is_one_line_of_json() {
        let dir = tempfile::tempdir().expect("folder");
        let path = dir.path().join("metrics.jsonl");
        let mut metrics = Metrics::new(Some(&path)).expect("file");
        for second in 1..=2_u32 {
            let facts = Facts {
                steps: u64::from(second) * 10,
                phase: "play",
                ..Facts::default()
            };
            assert!(metrics.due(f64::from(second)));
            metrics.close(f64::from(second), &facts);
            assert!(!metrics.due(f64::from(second) + 0.5));
        }
        let text = std::fs::read_to_string(&path).expect("text");
        let lines: Vec<serde_json::Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).expect("JSON"))
            .collect();
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[1]["steps_per_s"], 10.0);
        assert_eq!(lines[1]["phase"], "play");
    }
}
