//! The worlds of the past, for looking back.

use std::sync::Arc;

use super::World;
use crate::units::MYR;

/// Model time between two snapshots, years.
const INTERVAL_YR: f64 = 0.1 * MYR;

/// Most snapshots, however small: each checkpoint of the roll-back lists them all.
const MAX_SNAPSHOTS: usize = 1024;

/// Snapshots in the order of time. Older ones lie farther apart: whenever memory is full, every second one goes.
///
/// While the present is one of them, as it was (*visiting*), the later ones stay. They go when the land moves on or is
/// edited from there.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    snapshots: Vec<Snapshot>,
    visiting: bool,
}

#[derive(Clone, Debug)]
struct Snapshot {
    world: Arc<World>,
    /// Memory that it needs beyond what it shares with the one before.
    bytes: usize,
}

impl History {
    /// Keeps `world` if the last snapshot is old enough, in `most_bytes` in all (0 keeps nothing).
    pub(super) fn record(&mut self, world: &World, most_bytes: usize) {
        let due = |last: &Snapshot| world.time_yr - last.world.time_yr >= INTERVAL_YR;
        if most_bytes > 0 && self.snapshots.last().is_none_or(due) {
            self.push(world, most_bytes);
        }
    }

    /// The snapshot nearest to `years`, at or before it if there is one. The present stays reachable.
    pub(super) fn visit(&mut self, years: f64, present: &World, most_bytes: usize) -> Option<Arc<World>> {
        if most_bytes == 0 {
            return None;
        }
        if !self.visiting {
            // What happened at the same time as the last snapshot, after it, is part of the present.
            self.snapshots
                .pop_if(|last| last.world.time_yr >= present.time_yr);
            self.push(present, most_bytes);
        }
        self.visiting = true;
        let later = self.snapshots.partition_point(|s| s.world.time_yr <= years);
        let snapshot = self.snapshots.get(later.saturating_sub(1))?;
        Some(Arc::clone(&snapshot.world))
    }

    /// The land goes on from the world that is visited: forgets what came after `now_yr`. False where nothing is
    /// visited.
    pub(super) fn depart(&mut self, now_yr: f64) -> bool {
        if self.visiting {
            self.forget_after(now_yr);
        }
        std::mem::take(&mut self.visiting)
    }

    /// Forgets what came after `now_yr`.
    pub(super) fn forget_after(&mut self, now_yr: f64) {
        self.snapshots.retain(|s| s.world.time_yr <= now_yr);
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// True while the present is a world of the past, as it was.
    pub(super) fn visiting(&self) -> bool {
        self.visiting
    }

    /// Times of the first and the last snapshot, years.
    pub(super) fn range_yr(&self) -> Option<(f64, f64)> {
        let (first, last) = self.snapshots.first().zip(self.snapshots.last())?;
        Some((first.world.time_yr, last.world.time_yr))
    }

    fn push(&mut self, world: &World, most_bytes: usize) {
        let before = self.snapshots.last().map(|last| &*last.world);
        let bytes = world.snapshot_bytes() + world.residue_bytes_beyond(before);
        self.snapshots.push(Snapshot {
            world: Arc::new(world.clone()),
            bytes,
        });
        let total = |snapshots: &[Snapshot]| snapshots.iter().map(|s| s.bytes).sum::<usize>();
        while self.snapshots.len() > 2
            && (self.snapshots.len() > MAX_SNAPSHOTS || total(&self.snapshots) > most_bytes)
        {
            self.thin();
        }
    }

    /// Lets every second snapshot go, but neither the first nor the last.
    fn thin(&mut self) {
        let last = self.snapshots.len() - 1;
        let mut index = 0;
        self.snapshots.retain(|_| {
            index += 1;
            index % 2 == 1 || index > last
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::units::{DEFAULT_SHORT_SIDE, PlanMap};

    fn world(time_yr: f64) -> World {
        let map = PlanMap::new(DVec2::new(1200.0, 700.0), DEFAULT_SHORT_SIDE);
        World {
            time_yr,
            ..World::new(map, 50, 1).unwrap()
        }
    }

    fn times(history: &History) -> Vec<f64> {
        history.snapshots.iter().map(|s| s.world.time_yr / MYR).collect()
    }

    #[test]
    fn old_snapshots_lie_farther_apart_and_the_ends_stay() {
        let room = 8 * world(0.0).snapshot_bytes();
        let mut history = History::default();
        for step in 0..=200 {
            history.record(&world(f64::from(step) * 50_000.0), room);
        }
        let times = times(&history);
        assert!((4..=8).contains(&times.len()), "{times:?}");
        assert_eq!((times[0], times[times.len() - 1]), (0.0, 10.0));
        let gaps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(gaps.windows(2).all(|pair| pair[0] >= pair[1] - 0.11), "{times:?}");
        assert!(gaps[gaps.len() - 1] < 1.0, "{times:?}");
    }

    #[test]
    fn without_room_nothing_is_kept() {
        let mut history = History::default();
        history.record(&world(0.0), 0);
        assert!(history.visit(0.0, &world(1e6), 0).is_none());
        assert_eq!(history.range_yr(), None);
    }

    #[test]
    fn a_visit_finds_the_world_before_and_keeps_the_present() {
        let mut history = History::default();
        for step in 0..10 {
            history.record(&world(f64::from(step) * 100_000.0), usize::MAX);
        }
        let found = |history: &mut History, years| {
            history
                .visit(years, &world(930_000.0), usize::MAX)
                .map(|w| w.time_yr)
        };
        assert_eq!(found(&mut history, 250_000.0), Some(200_000.0));
        assert_eq!(found(&mut history, 1e9), Some(930_000.0), "the present");
        assert_eq!(found(&mut history, -5.0), Some(0.0), "the first");
        assert_eq!(times(&history).len(), 11, "the present is kept once");
        assert!(history.depart(200_000.0));
        assert_eq!(history.range_yr(), Some((0.0, 200_000.0)));
        assert!(!history.depart(0.0), "nothing is visited any more");
    }
}
