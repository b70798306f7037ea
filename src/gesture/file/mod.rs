//! Gesture files: contacts and commands as JSON Lines, so that a session can be played again, to the bit.
//!
//! Line 1 is the [`Header`]; every further line is one moment:
//!
//! ```text
//! {"format":"orogen-gesture","version":1,"title":"two hands push","surface":{"size_mm":[1209.6,680.4]},"mode":"mountain","seed":7,"years":5e6,"nodes":60000}
//! {"t":0,"down":[[1,300.00,340.00],[2,330.00,360.00]]}
//! {"t":16,"move":[[1,304.00,340.00]],"down":[[9,610.00,660.00,{"w":42.00,"h":30.00,"conf":0}]]}
//! {"t":480,"cancel":[9]}
//! {"t":500,"up":[1,2]}
//! {"t":900,"do":{"tool":"slice","side":"south"}}
//! ```
//!
//! * `t`: session time in milliseconds with at most three decimals, never decreasing.
//! * `up`, `cancel`: lists of ids. `move`, `down`: lists of `[id, x, y]` or `[id, x, y, {"w", "h", "conf"}]`, table
//!   millimetres with two decimals (more are rounded away), width, height and the device's confidence where it tells.
//! * Within a line the order is up, cancel, move, down, whatever the order of the keys, and by id: an id that lifts
//!   may land again in the same line, and what lands and lifts at once takes two lines of equal `t`.
//! * `do`: see [`super::command`].
//! * Keys that are not listed here are ignored. The end of the file cancels what is still down.
//! * `expect` in the header says what a replay should show ([`Expectation`]).
//!
//! [`read_gesture`] refuses anything else with name, line and field, except a torn last line: that is what a power
//! cut leaves, and the rest plays. [`GestureWriter`] writes the canonical form, line by line.

mod header;
mod reader;
mod writer;

pub use header::{Expectation, Header, LandChange, MAX_SIZE_MM, NODES_RANGE};
pub use reader::{
    Fault, GestureError, GestureFile, MAX_BYTES, MAX_LINE_BYTES, MAX_LINES, MAX_TIME_MS, read_gesture,
};
pub use writer::GestureWriter;

/// The value of `format`.
pub const FORMAT: &str = "orogen-gesture";

/// The major version written and read; minor versions (`1.2`) only add keys.
pub const VERSION: u64 = 1;
