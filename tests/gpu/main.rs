//! Rendering and compute on a graphics card, or on software Vulkan.

mod card;
#[path = "../common/folds.rs"]
mod fold_common;
mod folds;
mod live_stages;
mod planet_common;
mod render_globe;
mod render_picture;
mod render_shaders;
mod render_strata;
mod replay;
mod shader_common;
mod shaders;
mod transport;
