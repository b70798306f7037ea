//! Surface → shaded land, in plan and in perspective, on the graphics card.

mod camera;

pub use camera::{Camera, Oblique, plan_rect};
