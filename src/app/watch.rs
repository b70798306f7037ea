//! The watch: reads the heartbeats of the loop that draws and of the session's thread, and says so when one stops.
//!
//! It repairs nothing: a hung program is ended by who started it (systemd's watchdog), and the log says which part hung.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How often the heartbeats are read.
const ROUND: Duration = Duration::from_millis(500);
/// Rounds without a beat after which a part is said to hang (5 s).
const PATIENCE: u32 = 10;

/// A counter that rises as long as a part of the program lives.
#[derive(Clone, Debug, Default)]
pub(super) struct Heartbeat(Arc<AtomicU64>);

impl Heartbeat {
    /// Beats once.
    pub(super) fn beat(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    /// Beats so far.
    pub(super) fn beats(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// Reads how often a part has beaten.
pub(super) type Pulse = Box<dyn Fn() -> u64 + Send>;

/// What the watch makes of one part's beats.
#[derive(Debug, PartialEq, Eq)]
enum Verdict {
    /// Nothing to say.
    Quiet,
    /// It has just begun to hang.
    Hangs,
    /// It beats again.
    Recovered,
}

/// One part that is watched.
struct Part {
    name: &'static str,
    pulse: Pulse,
    seen: u64,
    silent: u32,
}

impl Part {
    fn round(&mut self) -> Verdict {
        let beats = (self.pulse)();
        if beats == self.seen {
            self.silent = self.silent.saturating_add(1);
            return if self.silent == PATIENCE {
                Verdict::Hangs
            } else {
                Verdict::Quiet
            };
        }
        self.seen = beats;
        let hung = self.silent >= PATIENCE;
        self.silent = 0;
        if hung { Verdict::Recovered } else { Verdict::Quiet }
    }
}

/// The watch's thread; ends when it is dropped.
#[derive(Debug)]
pub(super) struct Watch {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Watches the parts.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub(super) fn over(parts: Vec<(&'static str, Pulse)>) -> std::io::Result<Self> {
        let over = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&over);
        let mut parts: Vec<Part> = parts
            .into_iter()
            .map(|(name, pulse)| Part {
                name,
                pulse,
                seen: u64::MAX,
                silent: 0,
            })
            .collect();
        let thread = thread::Builder::new()
            .name("orogen-watch".to_owned())
            .spawn(move || {
                while !ended.load(Ordering::Relaxed) {
                    for part in &mut parts {
                        match part.round() {
                            Verdict::Quiet => {}
                            Verdict::Hangs => tracing::error!("{} has not moved for 5 s", part.name),
                            Verdict::Recovered => tracing::warn!("{} moves again", part.name),
                        }
                    }
                    thread::park_timeout(ROUND);
                }
            })?;
        Ok(Self {
            over,
            thread: Some(thread),
        })
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            if thread.join().is_err() {
                tracing::error!("the watch had stopped");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_is_told_once_and_so_is_its_end() {
        let heart = Heartbeat::default();
        let pulse = heart.clone();
        let mut part = Part {
            name: "test",
            pulse: Box::new(move || pulse.beats()),
            seen: u64::MAX,
            silent: 0,
        };
        assert_eq!(part.round(), Verdict::Quiet);
        let told: Vec<Verdict> = (0..3 * PATIENCE).map(|_| part.round()).collect();
        assert_eq!(told.iter().filter(|v| **v == Verdict::Hangs).count(), 1);
        heart.beat();
        assert_eq!(part.round(), Verdict::Recovered);
        heart.beat();
        assert_eq!(part.round(), Verdict::Quiet);
    }
}
