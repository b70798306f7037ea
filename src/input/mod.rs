//! What comes from outside: maps, whole planets as images, piles of rock, recordings of other tools that become contacts, and the touches of a window.

pub mod calibrate;
pub(crate) mod evdev_codes;
pub mod hid;
pub mod import;
pub mod maps;
pub mod pile;
pub mod planet;
pub mod stream;
pub mod touching;
pub mod tuio;
pub mod window;
