//! The sphere, and what plates do on it.

mod events;
mod globe_common;
mod laws;
mod motion;
mod sphere;
