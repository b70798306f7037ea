//! The contacts of one profile of a sender: named by its lists of what is alive, placed by its messages.

use glam::DVec2;

use crate::gesture::contact::MAX_CONTACTS;

/// How large a contact is, in parts of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Extent {
    /// Width and height, each in parts of its side.
    Sides(DVec2),
    /// A circle; of which side it is a part nobody says. The shorter one is the careful guess.
    Diameter(f64),
}

impl Extent {
    /// Width and height on a surface of this size; nothing where they are none.
    pub(super) fn on(self, surface: DVec2) -> Option<DVec2> {
        let size = match self {
            Self::Sides(sides) => sides * surface,
            Self::Diameter(part) => DVec2::splat(part * surface.min_element()),
        };
        Some(size).filter(|size| size.is_finite() && size.min_element() >= 0.0 && *size != DVec2::ZERO)
    }
}

/// What one message says about a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reading {
    /// Session id.
    pub(super) id: u32,
    /// Where, in parts of the surface.
    pub(super) at: DVec2,
    /// How large, where it tells.
    pub(super) extent: Option<Extent>,
    /// True for an outline, which knows the size better and the place worse than a pointer of the same id.
    pub(super) outline: bool,
    /// False for a pointer that hovers.
    pub(super) touches: bool,
}

#[derive(Clone, Copy, Debug)]
struct Known {
    id: u32,
    alive: bool,
    /// Nothing until a message places it.
    placed: Option<Reading>,
    /// The size is an outline's.
    outlined: bool,
}

impl Known {
    fn new(id: u32, alive: bool) -> Self {
        Self {
            id,
            alive,
            placed: None,
            outlined: false,
        }
    }

    fn learn(&mut self, reading: &Reading) -> bool {
        let mut now = *reading;
        if let Some(before) = self.placed {
            if reading.outline && !before.outline {
                now = Reading {
                    extent: reading.extent.or(before.extent),
                    ..before
                };
            } else if self.outlined && !reading.outline {
                now.extent = before.extent;
            }
        }
        self.outlined |= reading.outline && reading.extent.is_some();
        let changed = self.placed != Some(now);
        self.placed = Some(now);
        changed
    }
}

/// Contacts by session id.
#[derive(Clone, Debug)]
pub(super) struct Contacts {
    /// Ascending by id, each id once: at most [`MAX_CONTACTS`] alive, and as many that no list has named yet.
    known: Vec<Known>,
}

impl Contacts {
    pub(super) fn new() -> Self {
        Self {
            known: Vec::with_capacity(2 * MAX_CONTACTS),
        }
    }

    pub(super) fn clear(&mut self) {
        self.known.clear();
    }

    /// Only these are alive; `alive` is ascending, without doubles, and at most [`MAX_CONTACTS`] long. Returns whether
    /// others were before.
    pub(super) fn keep(&mut self, alive: &[u32]) -> bool {
        let mut changed = false;
        self.known.retain_mut(|known| {
            let stays = alive.binary_search(&known.id).is_ok();
            changed |= stays != known.alive;
            known.alive = stays;
            stays
        });
        let before = self.known.len();
        for &id in alive {
            if self.known[..before]
                .binary_search_by_key(&id, |known| known.id)
                .is_err()
            {
                self.known.push(Known::new(id, true));
                changed = true;
            }
        }
        self.known.sort_unstable_by_key(|known| known.id);
        changed
    }

    /// Places a contact. Returns whether that changes anything, or `None` where it is not alive.
    pub(super) fn place(&mut self, reading: &Reading) -> Option<bool> {
        let index = self.index(reading.id).ok()?;
        Some(self.known[index].learn(reading))
    }

    /// Places a contact, also one that a list is still to name. Returns whether that changes anything, or `None`
    /// where there is no room for another one.
    pub(super) fn place_ahead(&mut self, reading: &Reading) -> Option<bool> {
        let index = match self.index(reading.id) {
            Ok(index) => index,
            Err(_) if self.known.len() - self.alive() >= MAX_CONTACTS => return None,
            Err(index) => {
                self.known.insert(index, Known::new(reading.id, false));
                index
            }
        };
        Some(self.known[index].learn(reading))
    }

    fn index(&self, id: u32) -> Result<usize, usize> {
        self.known.binary_search_by_key(&id, |known| known.id)
    }

    /// Whether one of `ids` is alive.
    pub(super) fn any_alive(&self, ids: &[u32]) -> bool {
        let alive = |id: &u32| self.index(*id).is_ok_and(|index| self.known[index].alive);
        ids.iter().any(alive)
    }

    /// What touches: alive and placed.
    pub(super) fn touching(&self) -> impl Iterator<Item = &Reading> {
        let alive = self.known.iter().filter(|known| known.alive);
        alive.filter_map(|known| known.placed.as_ref().filter(|placed| placed.touches))
    }

    /// How many are alive.
    pub(super) fn alive(&self) -> usize {
        self.known.iter().filter(|known| known.alive).count()
    }
}
