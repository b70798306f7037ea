//! How many nodes the land has, and with them how fine the grid of the uplift is
//! ([`MountainParams::for_nodes`](crate::mountain::MountainParams::for_nodes)): chosen by a measurement at the start, and
//! changed by one rung where a fresh land begins anyway, so that nobody sees it.
//!
//! A session that falls behind its hands is slowed ([`crate::live::Live::slowed_us`]). Where that happened, the next land has
//! fewer nodes. Spare time cannot be read off a session that keeps pace, so when some have, one rung more is tried, and given
//! up again where it does not hold; each such failure doubles the wait before the next try.

use std::time::{Duration, Instant};

use crate::sim::{Sim, SimParams, World};
use crate::units::PlanMap;

/// Numbers of nodes that a land may have.
const LADDER: [usize; 4] = [15_000, 30_000, 60_000, 100_000];

/// What a step may take, ms. The usual speed takes ten steps a second and the fast one more; uplift, rasters and water come on
/// top, and hands must be answered in between.
const STEP_MS: f64 = 10.0;
/// The same where processor cores also draw the picture.
const SOFTWARE_STEP_MS: f64 = 3.0;
/// Large lands leave the processor's caches: what a node costs there, by what it costs on the land that is measured.
const CACHES: f64 = 1.25;
/// Sessions that keep pace may come so many rungs above what was measured: a start may have been disturbed.
const RUNGS_ABOVE: usize = 1;

/// Nodes of the land that is measured.
const PROBE_NODES: usize = 10_000;
/// Steps that it takes; the first half of them finds no rivers yet and is not counted.
const PROBE_STEPS: usize = 24;
/// The longest it may take.
const PROBE_TIME: Duration = Duration::from_millis(100);

/// A session is judged when it has been played for so long, µs.
const JUDGED_US: u64 = 20_000_000;
/// A session that lost more than this part of its time did not keep pace.
const LOST: f64 = 0.03;
/// A session that lost no more than this part of it did.
const KEPT: f64 = 0.005;
/// Sessions that must keep pace before another rung is tried.
const FIRST_PATIENCE: u32 = 2;
/// The longest wait before trying again, sessions.
const LONGEST_PATIENCE: u32 = 64;
/// How long a fresh land takes to be made and to be shown, µs: that tells nothing of its pace.
const SETTLING_US: u64 = 2_000_000;
/// Between two looks no session plays longer than this, µs: what is longer was a pause (another world was shown).
const LONGEST_LOOK_US: u64 = 1_000_000;

/// Chooses the number of nodes.
#[derive(Clone, Debug)]
pub(super) struct Nodes {
    /// What the settings ask for, whatever the machine.
    fixed: Option<usize>,
    rung: usize,
    most: usize,
    /// The rung now in use is tried.
    trial: bool,
    /// Sessions in a row that kept pace.
    kept: u32,
    patience: u32,
    pace: Pace,
}

/// How a session has kept its pace so far.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    /// Table time at the last look, and how far the session had been slowed, µs.
    seen: Option<(u64, u64)>,
    /// Before this table time nothing counts, µs.
    settled_us: u64,
    played_us: u64,
    lost_us: u64,
}

impl Nodes {
    /// What the settings ask for; else what this machine can do, which takes a tenth of a second to find out.
    pub(super) fn new(fixed: Option<usize>, map: PlanMap, software: bool) -> Self {
        let node_ms = match fixed {
            Some(_) => None,
            None => measure(map),
        };
        let nodes = Self {
            fixed,
            ..Self::of(node_ms, software)
        };
        let count = nodes.count();
        let why = node_ms.map_or("as the settings say".to_owned(), |ms| {
            format!("a step takes {:.0} ns per node", ms * 1e6)
        });
        tracing::info!("the land has {count} nodes: {why}");
        nodes
    }

    /// Where a step takes so many milliseconds per node; the fewest where nobody knows.
    fn of(node_ms: Option<f64>, software: bool) -> Self {
        let budget_ms = if software { SOFTWARE_STEP_MS } else { STEP_MS };
        let node_ms = node_ms.map_or(f64::INFINITY, |ms| CACHES * ms);
        let rung = LADDER.partition_point(|&nodes| nodes as f64 * node_ms <= budget_ms);
        let rung = rung.saturating_sub(1);
        Self {
            fixed: None,
            rung,
            most: (rung + RUNGS_ABOVE).min(LADDER.len() - 1),
            trial: false,
            kept: 0,
            patience: FIRST_PATIENCE,
            pace: Pace::default(),
        }
    }

    /// Nodes of the land that lies there, or of the next.
    pub(super) fn count(&self) -> usize {
        self.fixed.unwrap_or(LADDER[self.rung])
    }

    /// The session is played at `now_us`, and has been slowed by `slowed_us` since it began.
    pub(super) fn look(&mut self, now_us: u64, slowed_us: u64) {
        let pace = &mut self.pace;
        let Some((then_us, slowed_then_us)) = pace.seen.replace((now_us, slowed_us)) else {
            pace.settled_us = now_us + SETTLING_US;
            return;
        };
        let since_us = now_us.saturating_sub(then_us);
        // A session that begins again counts from zero.
        let lost_us = slowed_us.checked_sub(slowed_then_us).unwrap_or(slowed_us);
        let pause = since_us.max(lost_us) > LONGEST_LOOK_US;
        if !pause && now_us >= pace.settled_us {
            pace.played_us += since_us;
            pace.lost_us += lost_us;
        }
    }

    /// A fresh land begins: how many nodes it has.
    pub(super) fn fresh(&mut self) -> usize {
        let before = self.count();
        self.judge();
        if let Some((now_us, _)) = self.pace.seen {
            self.pace.settled_us = now_us + SETTLING_US;
        }
        let count = self.count();
        if count != before {
            tracing::info!("the next land has {count} nodes instead of {before}");
        }
        count
    }

    fn judge(&mut self) {
        let Pace {
            played_us, lost_us, ..
        } = self.pace;
        if played_us < JUDGED_US {
            return;
        }
        self.pace.played_us = 0;
        self.pace.lost_us = 0;
        let lost = lost_us as f64 / played_us as f64;
        if lost > LOST {
            if self.trial {
                self.patience = (2 * self.patience).min(LONGEST_PATIENCE);
            }
            self.trial = false;
            self.kept = 0;
            self.rung = self.rung.saturating_sub(1);
        } else if lost <= KEPT {
            self.kept += 1;
            if self.kept >= self.patience {
                // The rung held: the next may be tried as soon as the first was.
                if self.trial {
                    self.patience = FIRST_PATIENCE;
                }
                self.kept = 0;
                self.trial = self.rung < self.most;
                self.rung = (self.rung + 1).min(self.most);
            }
        } else {
            self.kept = 0;
        }
    }
}

/// What a node costs in a step of the live land: rivers that carry, rock that is exposed, a crust that floats; ms.
fn measure(map: PlanMap) -> Option<f64> {
    let pool = rayon::ThreadPoolBuilder::new().build().ok()?;
    pool.install(|| {
        let mut params = SimParams {
            history_bytes: 0,
            ..SimParams::default()
        };
        // Nobody pushes.
        params.mountain.cells = 64 * 64;
        let mut sim = Sim::new(World::new(map, PROBE_NODES, 1).ok()?, params);
        let mut steps_ms = Vec::with_capacity(PROBE_STEPS);
        let began = Instant::now();
        let mut step = began;
        sim.run_on(|_, _| {
            steps_ms.push(step.elapsed().as_secs_f64() * 1e3);
            step = Instant::now();
            steps_ms.len() < PROBE_STEPS && began.elapsed() < PROBE_TIME
        });
        // Other programs only add to a time: the quicker half of the later half.
        let mut later = steps_ms.split_off(steps_ms.len() / 2);
        later.sort_by(f64::total_cmp);
        later.get(later.len() / 4).map(|ms| ms / PROBE_NODES as f64)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays a session of `seconds` that is slowed by `lost` of its time, and begins the next.
    fn session(nodes: &mut Nodes, seconds: u64, lost: f64) -> usize {
        let began_us = nodes.pace.seen.map_or(0, |(now_us, _)| now_us);
        for tenth in 0..=10 * seconds {
            let played_us = 100_000 * tenth;
            nodes.look(began_us + played_us, (lost * played_us as f64) as u64);
        }
        nodes.fresh()
    }

    fn on_a_card(step_ms_at_60k: f64) -> Nodes {
        Nodes::of(Some(step_ms_at_60k / 60_000.0), false)
    }

    #[test]
    fn the_land_that_the_machine_can_step_is_chosen() {
        assert_eq!(on_a_card(7.0).count(), 60_000);
        assert_eq!(on_a_card(4.0).count(), 100_000);
        assert_eq!(on_a_card(15.0).count(), 30_000);
        assert_eq!(on_a_card(1e6).count(), 15_000, "the fewest must do");
        assert_eq!(
            Nodes::of(Some(7.0 / 60_000.0), true).count(),
            15_000,
            "cores also draw"
        );
        assert_eq!(Nodes::of(None, false).count(), 15_000);
    }

    #[test]
    fn a_session_that_fell_behind_is_followed_by_a_smaller_land() {
        let mut nodes = on_a_card(4.0);
        assert_eq!(session(&mut nodes, 60, 0.2), 60_000);
        assert_eq!(session(&mut nodes, 60, 0.2), 30_000);
        assert_eq!(session(&mut nodes, 60, 0.02), 30_000, "neither kept nor lost");
        assert_eq!(session(&mut nodes, 60, 0.5), 15_000);
        assert_eq!(session(&mut nodes, 60, 0.5), 15_000);
    }

    #[test]
    fn sessions_in_time_lead_back_up_but_not_far_beyond_what_was_measured() {
        let mut nodes = on_a_card(15.0);
        let rungs: Vec<usize> = (0..12).map(|_| session(&mut nodes, 60, 0.0)).collect();
        assert_eq!(rungs[..3], [30_000, 60_000, 60_000]);
        assert!(rungs[3..].iter().all(|&rung| rung == 60_000), "{rungs:?}");
    }

    #[test]
    fn a_rung_that_does_not_hold_is_tried_more_and_more_rarely() {
        let mut nodes = on_a_card(15.0);
        let mut tries = 0;
        for _ in 0..100 {
            let lost = if nodes.count() > 30_000 { 0.3 } else { 0.0 };
            tries += usize::from(session(&mut nodes, 60, lost) > 30_000);
        }
        assert!((4..=6).contains(&tries), "{tries}");
        assert!(nodes.count() >= 30_000);
    }

    #[test]
    fn short_sessions_are_judged_together_and_pauses_are_not_counted() {
        let mut nodes = on_a_card(7.0);
        assert_eq!(session(&mut nodes, 14, 0.2), 60_000, "too short to tell");
        assert_eq!(session(&mut nodes, 14, 0.2), 30_000);
        // Another world was shown for a minute: the session jumps, and was not slow.
        let mut nodes = on_a_card(7.0);
        session(&mut nodes, 15, 0.0);
        let (now_us, _) = nodes.pace.seen.expect("a look");
        nodes.look(now_us + 60_000_000, 60_000_000);
        assert_eq!(session(&mut nodes, 15, 0.0), 60_000);
        assert_eq!(nodes.pace.lost_us, 0);
    }

    #[test]
    fn making_a_land_is_no_slow_session() {
        let mut nodes = on_a_card(7.0);
        session(&mut nodes, 15, 0.0);
        let (now_us, _) = nodes.pace.seen.expect("a look");
        // It took most of a second, of which the session lost what was too much.
        nodes.look(now_us + 900_000, 700_000);
        session(&mut nodes, 15, 0.0);
        assert_eq!((nodes.count(), nodes.kept), (60_000, 1));
    }

    #[test]
    fn what_the_settings_ask_for_stays() {
        let mut nodes = Nodes {
            fixed: Some(7000),
            ..on_a_card(1e6)
        };
        assert_eq!(session(&mut nodes, 60, 0.9), 7000);
        assert_eq!(nodes.count(), 7000);
    }

    #[test]
    fn a_measurement_is_a_time() {
        let map = PlanMap::new(glam::DVec2::new(1209.6, 680.4), crate::units::DEFAULT_SHORT_SIDE);
        assert!(measure(map).is_some_and(|ms| ms > 0.0 && ms.is_finite()));
    }
}
