//! How often a sender speaks: how much of it is listened to, and how long its silence may last.

/// Longest silence of a sender whose habit is not known, µs. Some senders speak only when something changes, so a
/// finger that rests must outlive a pause; a finger that no one has confirmed for a minute is not believed any more.
pub(super) const FORGET_US: u64 = 60_000_000;

/// Shortest silence that can mean anything, µs: a busy computer pauses for a good part of this.
const LEAST_SILENCE_US: u64 = 1_000_000;

/// A pause is silence when it is this many times the longest one that is usual.
const GENEROUS: u64 = 8;

/// Frames without news, while a finger is down, that make a habit.
const HABIT_FRAMES: u32 = 10;

/// By how much more a sender has to show the habit again, after its silence was taken wrongly for its end.
const DOUBT: u32 = 8;

/// Frames closer than this say nothing about a habit, µs: a network may double a packet.
const TWINS_US: u64 = 2_000;

/// What is known about the pauses of a sender while a finger of it is down.
///
/// A sender that repeats itself while nothing changes has the habit of sending; when it stops, it is gone. One that
/// was never heard to repeat itself may just have nothing to say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Habit {
    /// Frames without news so far.
    repeated: u32,
    /// How many make a habit.
    needed: u32,
    /// The longest usual pause, µs; it fades.
    longest_us: u64,
}

impl Habit {
    pub(super) fn new() -> Self {
        Self {
            repeated: 0,
            needed: HABIT_FRAMES,
            longest_us: 0,
        }
    }

    /// A frame came after a pause in which a finger was down.
    pub(super) fn frame(&mut self, pause_us: u64, news: bool) {
        if pause_us < TWINS_US {
            return;
        }
        if !news {
            self.repeated = self.repeated.saturating_add(1);
        }
        self.longest_us = (self.longest_us - self.longest_us.div_ceil(1024)).max(pause_us);
    }

    /// The sender was silent for longer than it may, and comes back with the same fingers.
    pub(super) fn mistaken(&mut self) {
        self.repeated = 0;
        self.needed = self.needed.saturating_mul(DOUBT);
    }

    /// Silence after which the sender's fingers are not believed, µs.
    pub(super) fn silence_us(&self) -> u64 {
        if self.repeated < self.needed {
            return FORGET_US;
        }
        (self.longest_us * GENEROUS).clamp(LEAST_SILENCE_US, FORGET_US)
    }
}

/// Tokens that refill with time: one for a packet, and one more for each [`TOKEN_BYTES`] of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bucket {
    /// Millionths of a token; below 0 after a charge that there was not enough for.
    level: i64,
    filled_us: u64,
    per_second: i64,
}

/// Bytes of a packet that cost a token.
const TOKEN_BYTES: usize = 2048;

/// Millionths, so that a microsecond refills a whole number.
const TOKEN: i64 = 1_000_000;

impl Bucket {
    /// Full: as much as comes in one second.
    pub(super) fn new(per_second: u32, t_us: u64) -> Self {
        Self {
            level: i64::from(per_second) * TOKEN,
            filled_us: t_us,
            per_second: per_second.into(),
        }
    }

    /// Whether there is enough for a packet of so many bytes, which is then taken.
    pub(super) fn take(&mut self, t_us: u64, bytes: usize) -> bool {
        let passed = t_us.saturating_sub(self.filled_us).min(2 * TOKEN as u64) as i64;
        self.filled_us = self.filled_us.max(t_us);
        self.level = (self.level + passed * self.per_second).min(self.per_second * TOKEN);
        let cost = (1 + bytes / TOKEN_BYTES) as i64 * TOKEN;
        let enough = self.level >= cost;
        if enough {
            self.level -= cost;
        }
        enough
    }

    /// Takes what comes in this part of a second, also where there is less: for what should be rare.
    pub(super) fn charge(&mut self, per_second: i64) {
        self.level -= self.per_second * TOKEN / per_second;
    }
}
