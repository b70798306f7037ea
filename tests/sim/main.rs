//! Whole sessions in the core: worlds, history, refinement, planets.

mod folds;
mod globe;
mod globe_properties;
mod history;
mod properties;
mod refine;
mod sim_common;
mod whole;
