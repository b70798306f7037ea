//! Surface → shaded land, in plan and in perspective, and planet → globe, on the graphics card.
//!
//! What does not depend on the eye (shape, light, colours) is computed once for each step of the land's growth, into
//! a *sheet* as fine as the window, and only laid on the heights in each frame; on a software adapter in strips, so
//! that a frame stays cheap while the land moves. New lands are mixed in over a few frames: nothing pops.
//!
//! The colours are those of the printed map ([`crate::picture`]).

mod camera;
mod flight;
mod globe;
mod growth;
mod land;
pub mod layout;
mod offscreen;
mod passes;
mod pile;
mod quality;
mod upload;
mod work;

pub use camera::{Camera, Oblique, plan_rect};
pub use flight::{Focus, flight};
pub use globe::{Disc, GlobeRenderer};
pub use land::{LandRenderer, LandStyle};
pub use layout::LightQuality;
pub use offscreen::{Canvas, globe_picture, picture};
pub use quality::RenderQuality;
