//! The program as it is run in a terminal.

mod cli_common;
mod commands;
mod devices;
mod final_quality;
mod globe;
#[path = "../common/hid.rs"]
mod hid_common;
#[cfg(feature = "app")]
mod record;
#[path = "../common/tuio.rs"]
#[cfg(feature = "app")]
mod tuio_common;
