//! The kiosk's circle: attract, invite, play, idle warning, reset; and the way in for staff.
//!
//! * [`Kiosk`]: a fresh table plays a show (attract); the first touch ends it on fresh land (invite); the first push
//!   begins the visit (play); when nobody is there a warning counts down, and the land is reset.
//! * [`Show`]: the gesture files of attract, as contacts; [`Orbit`]: the same for the planet; [`Hint`]: ghost hands of the two first gestures;
//!   [`Flight`]: how far the view is from the plan.
//! * [`StaffDoor`]: a corner that is held, a PIN, and the staff's menu.
//!
//! Times come in as numbers, and a clock that jumps does no harm: time goes on by what a table may have missed
//! between two looks, not by what a clock says.

mod circle;
mod door;
mod flight;
mod hint;
mod lived;
mod orbit;
mod presence;
mod show;

pub use circle::{Effect, Kiosk, KioskParams, Phase};
pub use door::{DoorParams, DoorPhase, StaffDoor};
pub use flight::{Flight, FlightWish};
pub use hint::{GhostHand, Hint, Lesson};
pub use orbit::Orbit;
pub use show::{Show, ShowStep};
