//! Devices as the app opens them, and programs of others that send TUIO.

mod hid;
#[path = "../common/hid.rs"]
mod hid_common;
#[path = "../common/python.rs"]
mod python;
mod tuio;
#[path = "../common/tuio.rs"]
mod tuio_common;
mod tuio_peers;
