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

/// The contacts that are down.
#[derive(Clone, Debug, Default)]
pub struct Admission {
    live: BTreeMap<(Source, u16, u64), Contact>,
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

    /// Takes the events of one moment and returns those that stand, in rounds.
    ///
    /// A round holds at most one event of a slot and is sorted: up, cancel, move, down; then by position; then by
    /// key. What a contact does keeps its order (down, then up, in one moment gives two rounds), while the order
    /// *between* contacts is forgotten: sources enumerate their contacts as they please. `Up` and `Cancel` carry
    /// the contact as it last was.
    pub fn admit(&mut self, events: &[ContactEvent]) -> Vec<Vec<ContactEvent>> {
        let mut rounds = Vec::new();
        for mut round in raw_rounds(events) {
            round.sort_by(canonical);
            let mut admitted = Vec::with_capacity(round.len());
            let mut doubled = Vec::new();
            let mut downs = Vec::new();
            for event in round {
                match event.phase {
                    Phase::Up | Phase::Cancel => admitted.extend(self.lift(event)),
                    Phase::Move => admitted.extend(self.shift(event)),
                    Phase::Down => {
                        let (old, new) = self.land(event);
                        doubled.extend(old);
                        downs.extend(new);
                    }
                }
            }
            if doubled.is_empty() {
                admitted.append(&mut downs);
            }
            for round in [admitted, doubled, downs] {
                if !round.is_empty() {
                    rounds.push(round);
                }
            }
        }
        rounds
    }

    /// Lets go of every contact; what was counted stays.
    pub fn clear(&mut self) {
        self.live.clear();
    }

    fn lift(&mut self, event: ContactEvent) -> Option<ContactEvent> {
        let slot = event.contact.key.slot();
        if self.live.get(&slot).is_none_or(|c| c.key != event.contact.key) {
            self.stats.ignored += 1;
            return None;
        }
        self.live.remove(&slot).map(|contact| ContactEvent {
            phase: event.phase,
            contact,
        })
    }

    fn shift(&mut self, event: ContactEvent) -> Option<ContactEvent> {
        let place = self.live.get_mut(&event.contact.key.slot());
        let Some(contact) = place.filter(|c| c.key == event.contact.key && is_place(&event.contact)) else {
            self.stats.ignored += 1;
            return None;
        };
        *contact = event.contact;
        Some(event)
    }

    /// The cancel of a contact that holds the slot, and the down itself.
    fn land(&mut self, event: ContactEvent) -> (Option<ContactEvent>, Option<ContactEvent>) {
        if !is_place(&event.contact) {
            self.stats.ignored += 1;
            return (None, None);
        }
        let slot = event.contact.key.slot();
        let old = self.live.remove(&slot).map(|contact| ContactEvent {
            phase: Phase::Cancel,
            contact,
        });
        self.stats.doubled += u64::from(old.is_some());
        if self.live.len() >= MAX_CONTACTS {
            self.stats.over_cap += 1;
            return (old, None);
        }
        self.live.insert(slot, event.contact);
        self.stats.total += 1;
        (old, Some(event))
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

/// Distributes events over rounds: each event of a slot goes to the slot's last round if it comes later in the
/// canonical order than what the round holds of it, else to the next.
fn raw_rounds(events: &[ContactEvent]) -> Vec<Vec<ContactEvent>> {
    let mut rounds: Vec<Vec<ContactEvent>> = Vec::new();
    let mut last: BTreeMap<(Source, u16, u64), (usize, u8)> = BTreeMap::new();
    for &event in events {
        let order = event.phase.order();
        let index = match last.get(&event.contact.key.slot()) {
            None => 0,
            Some(&(index, before)) if order > before => index,
            Some(&(index, _)) => index + 1,
        };
        last.insert(event.contact.key.slot(), (index, order));
        if rounds.len() == index {
            rounds.push(Vec::new());
        }
        rounds[index].push(event);
    }
    rounds
}
