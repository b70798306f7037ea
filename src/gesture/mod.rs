//! Contacts → strokes → hands → rigid fit, and the gesture file.
//!
//! * [`contact`]: what every source reports; [`admission`] puts it in order and keeps nonsense out.
//! * [`stroke`]: contacts that are fingers (palms, ghosts, flicker and stuck contacts end here).
//! * [`hand`]: fingers that belong together, and what they do ([`event`]), by the best rigid motion ([`rigid`]).
//! * [`pole`]: the same on the sphere, by the best Euler pole.
//! * [`command`]: what visitors do outside the contacts; [`mod@file`]: all of it, written down.
//!
//! Everything here is in table millimetres, x right, y down, and session microseconds. No clock is read and no file
//! is opened: time comes in as numbers, files as `Read` and `Write`.

pub mod admission;
pub mod command;
pub mod contact;
pub mod event;
pub mod file;
mod flicker;
mod grouping;
pub mod hand;
pub mod json;
mod leg;
pub mod params;
pub mod pole;
pub mod rigid;
mod stage;
pub mod stroke;
mod view;
