//! Raw HID touchscreens: what a device says of itself, and what its reports mean.
//!
//! | step | what it yields |
//! |---|---|
//! | [`Descriptor::parse`] | the report with the contacts, or why the device is no touchscreen |
//! | [`Features`](feature::Features) | what is to be asked of the device, and how it is told to be a touchscreen |
//! | [`Quirks::choose`] | how it departs from the rules |
//! | [`Decoder`] | reports → who touches now |
//!
//! Nothing here opens a device or knows the time: reports come as bytes, times as µs.

pub mod decode;
pub mod descriptor;
pub mod feature;
pub mod habit;
mod lane;
pub mod prepare;
pub mod quirks;
mod scan_time;
mod usage;

pub use decode::{Decoder, DecoderCounts, Frame};
pub use descriptor::{Descriptor, Refusal, TouchReport};
pub use feature::Features;
pub use prepare::DescriptorError;
pub use quirks::{Quirk, Quirks};
