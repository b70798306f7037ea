//! Everything touches come from: HID reports, TUIO packets, evdev recordings, windows, image pairs.

mod evemu_packets;
mod evemu_properties;
mod evemu_recordings;
mod evemu_shared;
mod export_evemu;
#[path = "../common/hid.rs"]
mod hid_common;
mod hid_decode;
mod hid_descriptor;
mod hid_quirks;
mod hid_recordings;
mod hid_round_trip;
mod hid_shared;
mod import_support;
mod import_tuio;
mod libinput_recordings;
mod planet;
#[path = "../common/tuio.rs"]
mod tuio_common;
mod tuio_properties;
mod tuio_silence;
mod tuio_v1;
mod tuio_v2;
mod window;
