//! What the tests of the renderer share.

use orogen::gpu::Gpu;

/// Something that draws off screen. Where there is nothing, the tests say so and pass; with `OROGEN_REQUIRE_GPU=1` they
/// fail.
pub(crate) fn gpu() -> Option<Gpu> {
    match Gpu::offscreen() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            let required = std::env::var_os("OROGEN_REQUIRE_GPU").is_some_and(|value| value == "1");
            assert!(!required, "{error}");
            eprintln!("skipped: {error}");
            None
        }
    }
}
