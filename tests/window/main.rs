//! The program in a real window, under real fingers.

mod final_land;
mod globe;
mod kiosk;
mod mountain;
mod record;
mod tools;
mod tuio;
#[path = "../common/tuio.rs"]
mod tuio_common;
mod window_support;
