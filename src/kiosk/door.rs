//! The way in for staff: a held corner, a PIN, a menu.

use std::collections::BTreeMap;

use glam::DVec2;

use super::lived::Lived;
use crate::gesture::contact::{ContactEvent, ContactKey, Phase, Source};
use crate::settings::{Corner, PIN_DIGITS};

/// How long the corner is held, ms.
const HOLD_MS: u64 = 3000;

/// A finger that moves more does not hold, mm.
const STILL_MM: f64 = 10.0;

/// Wrong PINs in a row that lock the door, and for how long, ms.
const MOST_WRONG: u32 = 5;
const LOCK_MS: u64 = 60_000;

/// What is open closes when it is not touched for so long, ms.
const CLOSE_MS: u64 = 60_000;

/// What one look may add to the time, ms.
const LONGEST_LOOK_MS: u64 = 1000;

/// Where the staff's door is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DoorPhase {
    /// Shut; nothing is shown.
    Shut,
    /// The corner is held.
    Holding {
        /// Part of the time for which it must be held, 0–1.
        progress: f64,
    },
    /// Somebody types a PIN.
    Keypad {
        /// Digits typed.
        digits: usize,
        /// Wrong PINs in a row.
        wrong: u32,
    },
    /// Too many wrong PINs: nothing can be typed for a while.
    Locked {
        /// How long still, ms.
        left_ms: u64,
    },
    /// Open.
    Menu,
}

/// What a door is made for.
#[derive(Clone, Debug, PartialEq)]
pub struct DoorParams {
    /// The PIN, [`PIN_DIGITS`] digits.
    pub pin: String,
    /// The corner.
    pub corner: Corner,
    /// Size of the table, mm.
    pub size_mm: DVec2,
}

/// The door. A single still finger that is held in the corner opens the keypad (taps never do: they happen by
/// accident), and the PIN the menu. All times are in ms of any clock that mostly goes on.
#[derive(Clone, Debug)]
pub struct StaffDoor {
    params: DoorParams,
    lived: Lived,
    /// Contacts that landed in the corner and are down.
    inside: BTreeMap<ContactKey, DVec2>,
    /// The one that holds: it landed alone and has been still since, ms lived.
    hold: Option<(ContactKey, u64)>,
    room: Room,
    typed: String,
    wrong: u32,
    locked_until_ms: u64,
    stirred_ms: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Room {
    Outside,
    Keypad,
    Menu,
}

impl StaffDoor {
    /// A door that is shut.
    pub fn new(params: DoorParams) -> Self {
        Self {
            params,
            lived: Lived::new(LONGEST_LOOK_MS),
            inside: BTreeMap::new(),
            hold: None,
            room: Room::Outside,
            typed: String::new(),
            wrong: 0,
            locked_until_ms: 0,
            stirred_ms: 0,
        }
    }

    /// Another PIN, corner or size. What is open stays open.
    pub fn set_params(&mut self, params: DoorParams) {
        self.hold = None;
        self.params = params;
    }

    /// Where it is.
    pub fn phase(&self) -> DoorPhase {
        let now_ms = self.lived.total();
        match self.room {
            Room::Menu => DoorPhase::Menu,
            Room::Keypad if self.locked() => DoorPhase::Locked {
                left_ms: self.locked_until_ms - now_ms,
            },
            Room::Keypad => DoorPhase::Keypad {
                digits: self.typed.len(),
                wrong: self.wrong,
            },
            Room::Outside => match self.hold {
                Some((_, since_ms)) => DoorPhase::Holding {
                    progress: ((now_ms - since_ms) as f64 / HOLD_MS as f64).min(1.0),
                },
                None => DoorPhase::Shut,
            },
        }
    }

    /// Takes what a contact does. Those that land elsewhere than in the corner are not looked at.
    pub fn feed(&mut self, event: &ContactEvent, now_ms: u64) {
        let now_ms = self.lived.at(now_ms);
        let (key, at) = (event.contact.key, event.contact.position);
        match event.phase {
            Phase::Down => {
                if key.source != Source::File && self.params.corner.holds(at, self.params.size_mm) {
                    // A palm is several contacts; whoever holds uses one finger.
                    self.hold = self.inside.is_empty().then_some((key, now_ms));
                    self.inside.insert(key, at);
                }
            }
            Phase::Move => {
                let strayed = self
                    .inside
                    .get(&key)
                    .is_some_and(|from| from.distance(at) > STILL_MM);
                self.hold = self.hold.filter(|(holder, _)| *holder != key || !strayed);
            }
            Phase::Up | Phase::Cancel => {
                self.inside.remove(&key);
                self.hold = self.hold.filter(|(holder, _)| *holder != key);
            }
        }
        self.go_on();
    }

    /// A digit of the keypad, 0 to 9.
    pub fn digit(&mut self, digit: u8, now_ms: u64) {
        self.stir(now_ms);
        if self.room == Room::Keypad && !self.locked() && digit < 10 && self.typed.len() < PIN_DIGITS.1 {
            self.typed.push(char::from(b'0' + digit));
        }
    }

    /// The last digit goes.
    pub fn erase(&mut self, now_ms: u64) {
        self.stir(now_ms);
        self.typed.pop();
    }

    /// What was typed is the PIN, or it is wrong.
    pub fn enter(&mut self, now_ms: u64) {
        self.stir(now_ms);
        if self.room != Room::Keypad || self.locked() || self.typed.is_empty() {
            return;
        }
        let right = self.typed == self.params.pin;
        self.typed.clear();
        if right {
            self.wrong = 0;
            self.room = Room::Menu;
            return;
        }
        self.wrong += 1;
        if self.wrong >= MOST_WRONG {
            self.wrong = 0;
            self.locked_until_ms = self.lived.total() + LOCK_MS;
        }
    }

    /// Somebody uses the keypad or the menu: it stays open.
    pub fn stir(&mut self, now_ms: u64) {
        self.tick(now_ms);
        self.stirred_ms = self.lived.total();
    }

    /// Shuts it.
    pub fn close(&mut self) {
        self.room = Room::Outside;
        self.typed.clear();
        self.hold = None;
    }

    /// Time goes on. To be called once a frame, and at least once a second.
    pub fn tick(&mut self, now_ms: u64) {
        self.lived.at(now_ms);
        self.go_on();
    }

    fn locked(&self) -> bool {
        self.lived.total() < self.locked_until_ms
    }

    fn go_on(&mut self) {
        let now_ms = self.lived.total();
        if self.room != Room::Outside {
            if now_ms - self.stirred_ms >= CLOSE_MS {
                self.close();
            }
            self.hold = None;
        } else if self
            .hold
            .is_some_and(|(_, since_ms)| now_ms - since_ms >= HOLD_MS)
        {
            // The finger that has opened the door must lift before it can hold again.
            self.hold = None;
            self.room = Room::Keypad;
            self.stirred_ms = now_ms;
        }
    }
}
