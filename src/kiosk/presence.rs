//! Is anybody there? Contacts that never move are bags, drops and faults, and nobody.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::gesture::contact::{ContactEvent, ContactKey, Phase, Source};

/// A contact that has not moved for so long is nobody, ms.
pub(super) const ASLEEP_MS: u64 = 20_000;

/// What is less is no movement: what rests on a touchscreen trembles by that much, mm.
const TREMBLE_MM: f64 = 2.0;

/// A contact that lands this soon and this near to where another lifted is the same thing, which flickers.
const FLICKER_MS: u64 = 300;
const FLICKER_MM: f64 = 5.0;

/// All contacts of visitors that are down, and since when each is still.
#[derive(Clone, Debug, Default)]
pub(super) struct Presence {
    down: BTreeMap<ContactKey, Still>,
    /// Those that have just lifted, and when.
    lifted: Vec<(Still, u64)>,
}

/// Where a contact has stayed, and since when.
#[derive(Clone, Copy, Debug)]
struct Still {
    at: DVec2,
    since_ms: u64,
}

impl Still {
    fn asleep(self, now_ms: u64) -> bool {
        now_ms.saturating_sub(self.since_ms) > ASLEEP_MS
    }
}

impl Presence {
    /// Takes what a contact does; true when that shows that somebody is there.
    pub(super) fn feed(&mut self, event: &ContactEvent, now_ms: u64) -> bool {
        let (key, at) = (event.contact.key, event.contact.position);
        if key.source == Source::File {
            return false;
        }
        self.lifted
            .retain(|(_, lifted_ms)| now_ms.saturating_sub(*lifted_ms) <= FLICKER_MS);
        match event.phase {
            Phase::Down => {
                let same = |(still, _): &(Still, u64)| still.at.distance(at) <= FLICKER_MM;
                let before = self.lifted.iter().position(same);
                let still = before.map_or(Still { at, since_ms: now_ms }, |i| self.lifted.swap_remove(i).0);
                self.down.insert(key, still);
                !still.asleep(now_ms)
            }
            Phase::Move => {
                let Some(still) = self.down.get_mut(&key) else {
                    return false;
                };
                let moved = still.at.distance(at) > TREMBLE_MM;
                if moved {
                    *still = Still { at, since_ms: now_ms };
                }
                moved
            }
            Phase::Up | Phase::Cancel => {
                let Some(still) = self.down.remove(&key) else {
                    return false;
                };
                self.lifted.push((still, now_ms));
                event.phase == Phase::Up && !still.asleep(now_ms)
            }
        }
    }

    /// True while a hand that is somebody's rests on the table.
    pub(super) fn anybody(&self, now_ms: u64) -> bool {
        self.down.values().any(|still| !still.asleep(now_ms))
    }
}
