//! What the tests of twins share.

use std::sync::Arc;

use orogen::gpu::Gpu;

/// Something that computes. Where there is nothing, the tests say so and pass; with `OROGEN_REQUIRE_GPU=1` they fail.
pub(crate) fn gpu() -> Option<Arc<Gpu>> {
    match Gpu::computing() {
        Ok(gpu) => Some(Arc::new(gpu)),
        Err(error) => {
            let required = std::env::var_os("OROGEN_REQUIRE_GPU").is_some_and(|value| value == "1");
            assert!(!required, "{error}");
            eprintln!("skipped: {error}");
            None
        }
    }
}
