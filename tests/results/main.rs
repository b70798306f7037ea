//! What is written and drawn of a session, and what others read of it.

mod export_files;
mod export_maps_read;
mod geology;
mod picture_common;
mod picture_facts;
mod picture_planet;
mod planet_files;
#[path = "../common/python.rs"]
mod python;
mod readers;
mod slice;
mod strata_common;
mod survey;
