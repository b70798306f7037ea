//! The kiosk's circle: attract, invite, play, idle warning, reset; and the way in for staff.
//!
//! * [`Phase`]: a fresh table plays a show (attract); the first touch ends it on fresh land (invite); the first push
//!   begins the visit (play); when nobody is there a warning counts down, and the land is reset.
//! * [`DoorPhase`]: a corner that is held, a PIN, and the staff's menu.
//!
//! Times come in as numbers, and a clock that jumps does no harm: time goes on by what a table may have missed
//! between two looks, not by what a clock says.

mod circle;
mod door;
mod hint;

pub use circle::{Effect, Phase};
pub use door::DoorPhase;
pub use hint::{GhostHand, Hint, Lesson};
