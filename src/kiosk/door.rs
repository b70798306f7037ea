//! The way in for staff: a held corner, a PIN, a menu.

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
        /// Wrong PINs since the door was last opened.
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
