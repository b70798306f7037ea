//! The session's thread, seen from outside: contacts go in without loss, the newest frame comes out.

mod frame;

pub use frame::{Clock, Frame};
