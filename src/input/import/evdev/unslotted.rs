//! The contacts of protocol A: all that are down in each frame, mostly without names.
//!
//! Contacts with a tracking id are known by it. The others are matched with those of the frame before so that the
//! sum of the squared distances is least (the assignment problem, by Kuhn's and Munkres' method): a row of fingers
//! that advances by more than half their spacing stays in order, which matching one nearest pair after the other would
//! break. No contact moves farther than [`REACH_MM`] between two frames; who would have to lifts, and another lands.

use glam::DVec2;

use super::axes::Plane;
use super::codes::ABS_MT_TRACKING_ID;
use super::touch::{RawEvent, Readings, Touch};
use crate::gesture::contact::Phase;

/// Most contacts of a frame: as many as the largest tables report, and few enough for a cubic method.
pub(super) const MAX_PACKETS: usize = 64;

/// Farthest way between two frames, mm: 4 m/s at 100 frames a second, and less than fingers of a hand lie apart.
const REACH_MM: f64 = 40.0;

/// A contact as protocol A tells it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packet {
    tracking: Option<i32>,
    touch: Touch,
}

impl Packet {
    /// The contact that `readings` tell, if they tell its place.
    pub(super) fn of(readings: &Readings) -> Option<Self> {
        Some(Self {
            tracking: readings.get(ABS_MT_TRACKING_ID),
            touch: readings.touch()?,
        })
    }
}

#[derive(Clone, Copy, Debug)]
struct Live {
    slot: u16,
    generation: u32,
    packet: Packet,
    at: DVec2,
}

/// The contacts that are down, each in a slot of its own.
#[derive(Debug, Default)]
pub(super) struct Unslotted {
    live: Vec<Live>,
    /// How often a contact went down in each slot.
    downs: Vec<u32>,
}

impl Unslotted {
    /// What the contacts do, that now all `state` is down.
    pub(super) fn frame(&mut self, plane: &Plane, state: &[Packet]) -> Vec<RawEvent> {
        let before = std::mem::take(&mut self.live);
        let places: Vec<DVec2> = state
            .iter()
            .map(|packet| plane.position(packet.touch.x, packet.touch.y))
            .collect();
        let from = matched(&before, state, &places);
        let mut events: Vec<RawEvent> = before
            .iter()
            .enumerate()
            .filter(|(i, _)| !from.contains(&Some(*i)))
            .map(|(_, live)| live.event(Phase::Up))
            .collect();
        // Those that stay keep their slots; only then is it known which are free.
        for ((packet, &at), &from) in state.iter().zip(&places).zip(&from) {
            let Some(from) = from else { continue };
            let live = Live {
                packet: *packet,
                at,
                ..before[from]
            };
            if live.packet.touch != before[from].packet.touch {
                events.push(live.event(Phase::Move));
            }
            self.live.push(live);
        }
        for ((packet, &at), from) in state.iter().zip(&places).zip(&from) {
            if from.is_none() {
                let live = self.land(*packet, at);
                events.push(live.event(Phase::Down));
            }
        }
        self.live.sort_by_key(|live| live.slot);
        events
    }

    /// Cancels all contacts.
    pub(super) fn drop_all(&mut self) -> Vec<RawEvent> {
        let cancelled = self.live.iter().map(|live| live.event(Phase::Cancel)).collect();
        self.live.clear();
        cancelled
    }

    /// Puts a contact into the first slot that is free.
    fn land(&mut self, packet: Packet, at: DVec2) -> Live {
        let taken = |slot: usize| self.live.iter().any(|live| usize::from(live.slot) == slot);
        let slot = (0..self.downs.len())
            .find(|slot| !taken(*slot))
            .unwrap_or(self.downs.len());
        if slot == self.downs.len() {
            self.downs.push(0);
        }
        self.downs[slot] += 1;
        let live = Live {
            slot: slot as u16,
            generation: self.downs[slot] - 1,
            packet,
            at,
        };
        self.live.push(live);
        live
    }
}

impl Live {
    fn event(&self, phase: Phase) -> RawEvent {
        RawEvent {
            phase,
            slot: self.slot,
            generation: self.generation,
            touch: self.packet.touch,
        }
    }
}

/// For each contact of `state` the one of `before` that it was.
fn matched(before: &[Live], state: &[Packet], places: &[DVec2]) -> Vec<Option<usize>> {
    let mut from = vec![None; state.len()];
    let mut left: Vec<usize> = (0..before.len()).collect();
    for (packet, from) in state.iter().zip(&mut from) {
        let same = |i: &usize| packet.tracking.is_some() && before[*i].packet.tracking == packet.tracking;
        if let Some(place) = left.iter().position(same) {
            *from = Some(left.remove(place));
        }
    }
    left.retain(|&i| before[i].packet.tracking.is_none());
    let nameless: Vec<usize> = (0..state.len())
        .filter(|&j| state[j].tracking.is_none())
        .collect();
    let old: Vec<DVec2> = left.iter().map(|&i| before[i].at).collect();
    let new: Vec<DVec2> = nameless.iter().map(|&j| places[j]).collect();
    for (&j, i) in nameless.iter().zip(nearest(&old, &new)) {
        from[j] = i.map(|i| left[i]);
    }
    from
}

/// For each place of `new` its place of `old`.
fn nearest(old: &[DVec2], new: &[DVec2]) -> Vec<Option<usize>> {
    let far = REACH_MM * REACH_MM;
    let distance = |i: usize, j: usize| old[i].distance_squared(new[j]);
    // Whoever has no partner, or one that is too far, costs the same: a lift or a landing.
    let cost = |i: usize, j: usize| {
        if i < old.len() && j < new.len() {
            distance(i, j).min(far)
        } else {
            far
        }
    };
    let row_of = assignment(old.len().max(new.len()), cost);
    (0..new.len())
        .map(|j| Some(row_of[j]).filter(|&i| i < old.len() && distance(i, j) <= far))
        .collect()
}

/// The row of each column of a square of `n`, so that the sum of their costs is least (Kuhn 1955, Munkres 1957, with
/// potentials: cubic in `n`).
fn assignment(n: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    // Rows and columns from 1; 0 stands for none.
    let (mut row_potential, mut column_potential) = (vec![0.0; n + 1], vec![0.0; n + 1]);
    let (mut row_of, mut way) = (vec![0; n + 1], vec![0; n + 1]);
    for row in 1..=n {
        row_of[0] = row;
        let mut column = 0;
        let mut least = vec![f64::INFINITY; n + 1];
        let mut used = vec![false; n + 1];
        while row_of[column] != 0 {
            used[column] = true;
            let (here, mut step, mut next) = (row_of[column], f64::INFINITY, 0);
            for j in (1..=n).filter(|&j| !used[j]) {
                let slack = cost(here - 1, j - 1) - row_potential[here] - column_potential[j];
                if slack < least[j] {
                    (least[j], way[j]) = (slack, column);
                }
                if least[j] < step {
                    (step, next) = (least[j], j);
                }
            }
            for j in 0..=n {
                if used[j] {
                    row_potential[row_of[j]] += step;
                    column_potential[j] -= step;
                } else {
                    least[j] -= step;
                }
            }
            column = next;
        }
        // The path of exchanges that ends in the free column.
        while column != 0 {
            row_of[column] = row_of[way[column]];
            column = way[column];
        }
    }
    row_of[1..].iter().map(|row| row - 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> DVec2 {
        DVec2::new(x, 0.0)
    }

    #[test]
    fn a_row_of_fingers_that_leaps_stays_in_order() {
        let old: Vec<DVec2> = [0.0, 20.0, 40.0, 60.0].map(at).to_vec();
        let new: Vec<DVec2> = [72.0, 12.0, 52.0, 32.0].map(at).to_vec();
        assert_eq!(nearest(&old, &new), [Some(3), Some(0), Some(2), Some(1)]);
    }

    #[test]
    fn nobody_leaps_across_the_table_and_there_may_be_more_or_fewer() {
        let (old, new) = ([at(0.0), at(100.0)], [at(141.0), at(3.0)]);
        assert_eq!(nearest(&old, &new), [None, Some(0)]);
        assert_eq!(nearest(&old, &[at(100.0)]), [Some(1)]);
        assert_eq!(nearest(&old[..1], &[at(30.0), at(10.0)]), [None, Some(0)]);
        assert_eq!(nearest(&[], &new), [None, None]);
        assert_eq!(nearest(&old, &[]), []);
    }

    #[test]
    fn the_sum_is_least_of_all_orders() {
        // A small generator: costs that no pattern helps with.
        let mut state = 7_u64;
        let mut costs = [[0.0; 5]; 5];
        for cost in costs.iter_mut().flatten() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            *cost = ((state >> 40) % 100) as f64;
        }
        let rows = assignment(5, |i, j| costs[i][j]);
        let sum = |rows: &[usize]| rows.iter().enumerate().map(|(j, &i)| costs[i][j]).sum::<f64>();
        let mut least = f64::INFINITY;
        for code in 0..5_usize.pow(5) {
            let order: Vec<usize> = (0..5).map(|k| code / 5_usize.pow(k) % 5).collect();
            if (0..5).all(|i| order.contains(&i)) {
                least = least.min(sum(&order));
            }
        }
        assert_eq!(sum(&rows), least);
    }
}
