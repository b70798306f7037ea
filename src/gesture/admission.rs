//! Which contacts are down: every event of every source passes here, once, and leaves in canonical order.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use super::contact::{Contact, ContactEvent, MAX_CONTACTS, MAX_COORDINATE_MM, Phase, Source};

/// What was turned away, counted for the health page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AdmissionStats {
    /// Contacts that went down and were let in.
    pub total: u64,
    /// Events of contacts that are not down, or with coordinates that are no place.
    pub ignored: u64,
    /// Downs of a contact that was down already; the old one was cancelled first.
    pub doubled: u64,
    /// Downs beyond [`MAX_CONTACTS`].
    pub over_cap: u64,
}

/// A source's own name of a contact: equal for contacts that follow each other under one id.
type Slot = (Source, u16, u64);

/// The contacts that are down.
#[derive(Clone, Debug, Default)]
pub struct Admission {
    live: BTreeMap<Slot, Contact>,
    stats: AdmissionStats,
}

impl Admission {
    /// The contacts that are down, by slot.
    pub fn live(&self) -> impl Iterator<Item = &Contact> {
        self.live.values()
    }

    /// What was turned away.
    pub fn stats(&self) -> AdmissionStats {
        self.stats
    }

    /// Lets go of every contact; what was counted stays.
    pub fn clear(&mut self) {
        self.live.clear();
    }

    /// Takes the events of one moment and returns those that stand, in rounds.
    ///
    /// A round is sorted: up, cancel, move, down; then by position; then by key. What a contact does keeps its order
    /// (down, then up, in one moment gives two rounds), while the order *between* contacts is forgotten: sources
    /// enumerate their contacts as they please. `Up` and `Cancel` carry the contact as it last was. Rounds that are
    /// admitted again come out as they are.
    pub fn admit(&mut self, events: &[ContactEvent]) -> Vec<Vec<ContactEvent>> {
        let mut rounds = rounds_of(&self.standing(events));
        for round in &mut rounds {
            round.sort_by(canonical);
            round.retain(|event| self.enter(event));
        }
        rounds.retain(|round| !round.is_empty());
        rounds
    }

    /// The events that make sense after those before them, as if there were room for any number of contacts.
    fn standing(&mut self, events: &[ContactEvent]) -> Vec<ContactEvent> {
        let mut changed: BTreeMap<Slot, Option<Contact>> = BTreeMap::new();
        let mut standing = Vec::with_capacity(events.len());
        for event in events {
            let slot = event.contact.key.slot();
            let before = changed
                .get(&slot)
                .copied()
                .unwrap_or_else(|| self.live.get(&slot).copied());
            let same = before.filter(|contact| contact.key == event.contact.key);
            match (event.phase, same) {
                (Phase::Up | Phase::Cancel, Some(contact)) => {
                    standing.push(ContactEvent {
                        phase: event.phase,
                        contact,
                    });
                    changed.insert(slot, None);
                }
                (Phase::Move, Some(_)) if is_place(&event.contact) => {
                    standing.push(*event);
                    changed.insert(slot, Some(event.contact));
                }
                (Phase::Down, _) if is_place(&event.contact) => {
                    if let Some(contact) = before {
                        self.stats.doubled += 1;
                        standing.push(ContactEvent {
                            phase: Phase::Cancel,
                            contact,
                        });
                    }
                    standing.push(*event);
                    changed.insert(slot, Some(event.contact));
                }
                _ => self.stats.ignored += 1,
            }
        }
        standing
    }

    /// Carries out what stands; false for contacts that found no room.
    fn enter(&mut self, event: &ContactEvent) -> bool {
        let slot = event.contact.key.slot();
        match event.phase {
            Phase::Up | Phase::Cancel => self.live.remove(&slot).is_some(),
            Phase::Move => {
                let place = self.live.get_mut(&slot);
                place.map(|contact| *contact = event.contact).is_some()
            }
            Phase::Down if self.live.len() >= MAX_CONTACTS => {
                self.stats.over_cap += 1;
                false
            }
            Phase::Down => {
                self.live.insert(slot, event.contact);
                self.stats.total += 1;
                true
            }
        }
    }
}

/// True for coordinates that can be on or near a table.
fn is_place(contact: &Contact) -> bool {
    contact.position.is_finite() && contact.position.abs().max_element() <= MAX_COORDINATE_MM
}

/// Sorts the events of a round. Positions come before keys, so that renumbering contacts changes nothing.
fn canonical(a: &ContactEvent, b: &ContactEvent) -> Ordering {
    let (p, q) = (a.contact.position, b.contact.position);
    (a.phase.order().cmp(&b.phase.order()))
        .then_with(|| p.x.total_cmp(&q.x))
        .then_with(|| p.y.total_cmp(&q.y))
        .then_with(|| a.contact.key.cmp(&b.contact.key))
}

/// Distributes events over rounds: what a slot does goes to one round each, but that a lift and the next down of an id
/// share one, as in a line of a gesture file.
fn rounds_of(events: &[ContactEvent]) -> Vec<Vec<ContactEvent>> {
    let mut rounds: Vec<Vec<ContactEvent>> = Vec::new();
    let mut last: BTreeMap<Slot, (usize, Phase)> = BTreeMap::new();
    for &event in events {
        let index = match last.get(&event.contact.key.slot()) {
            None => 0,
            Some(&(index, Phase::Up | Phase::Cancel)) if event.phase == Phase::Down => index,
            Some(&(index, _)) => index + 1,
        };
        last.insert(event.contact.key.slot(), (index, event.phase));
        if rounds.len() == index {
            rounds.push(Vec::new());
        }
        rounds[index].push(event);
    }
    rounds
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::gesture::contact::ContactKey;

    fn event(phase: Phase, id: u64, generation: u32, x: f64) -> ContactEvent {
        let key = ContactKey {
            source: Source::Hid,
            device: 0,
            id,
            generation,
        };
        ContactEvent {
            phase,
            contact: Contact {
                key,
                position: DVec2::new(x, 0.0),
                size_mm: None,
                confidence: None,
            },
        }
    }

    fn phases(rounds: &[Vec<ContactEvent>]) -> Vec<Vec<(Phase, u64)>> {
        let brief = |round: &Vec<ContactEvent>| round.iter().map(|e| (e.phase, e.contact.key.id)).collect();
        rounds.iter().map(brief).collect()
    }

    #[test]
    fn an_id_lifts_and_lands_in_one_round_and_lands_and_lifts_in_two() {
        use Phase::{Down, Move, Up};
        let mut gate = Admission::default();
        let rounds = gate.admit(&[
            event(Down, 1, 0, 1.0),
            event(Up, 1, 0, 9.0),
            event(Down, 2, 0, 0.5),
        ]);
        assert_eq!(phases(&rounds), [vec![(Down, 2), (Down, 1)], vec![(Up, 1)]]);
        assert_eq!(
            rounds[1][0].contact.position.x, 1.0,
            "up tells where the contact last was"
        );
        let rounds = gate.admit(&[
            event(Move, 2, 0, 3.0),
            event(Up, 2, 0, 3.0),
            event(Down, 2, 1, 4.0),
        ]);
        assert_eq!(phases(&rounds), [vec![(Move, 2)], vec![(Up, 2), (Down, 2)]]);
    }

    #[test]
    fn a_down_on_a_held_slot_cancels_what_held_it() {
        use Phase::{Cancel, Down, Move};
        let mut gate = Admission::default();
        gate.admit(&[event(Down, 1, 0, 1.0)]);
        let rounds = gate.admit(&[event(Down, 1, 1, 2.0), event(Move, 1, 0, 3.0)]);
        assert_eq!(phases(&rounds), [vec![(Cancel, 1), (Down, 1)]]);
        let expected = AdmissionStats {
            total: 2,
            ignored: 1,
            doubled: 1,
            over_cap: 0,
        };
        assert_eq!(
            gate.stats(),
            expected,
            "the move of the cancelled contact is ignored"
        );
    }

    #[test]
    fn nonsense_takes_no_room() {
        use Phase::{Down, Move};
        let mut gate = Admission::default();
        let rounds = gate.admit(&[
            event(Move, 1, 0, 1.0),
            event(Down, 1, 0, f64::NAN),
            event(Down, 1, 0, 2e4 + 1.0),
            event(Down, 1, 0, 5.0),
        ]);
        assert_eq!(phases(&rounds), [vec![(Down, 1)]]);
        assert_eq!(gate.stats().ignored, 3);
        assert_eq!(gate.live().count(), 1);
    }

    #[test]
    fn beyond_the_cap_contacts_are_not_seen_until_there_is_room() {
        use Phase::{Down, Up};
        let mut gate = Admission::default();
        let downs: Vec<ContactEvent> = (0..=MAX_CONTACTS as u64)
            .map(|id| event(Down, id, 0, id as f64))
            .collect();
        assert_eq!(gate.admit(&downs)[0].len(), MAX_CONTACTS);
        let last = MAX_CONTACTS as u64;
        assert!(gate.admit(&[event(Up, last, 0, 0.0)]).is_empty());
        // One lifts, one lands, in one moment: the lift makes room first.
        let rounds = gate.admit(&[event(Down, last, 1, 0.0), event(Up, 7, 0, 0.0)]);
        assert_eq!(phases(&rounds), [vec![(Up, 7), (Down, last)]]);
        assert_eq!((gate.stats().over_cap, gate.stats().ignored), (1, 1));
    }
}
