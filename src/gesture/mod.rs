//! Contacts → strokes → hands → rigid fit, and the gesture file.

pub mod command;
pub mod contact;
pub mod event;
pub mod rigid;
