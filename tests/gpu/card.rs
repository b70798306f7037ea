//! The graphics card of the tests, hardware or software.

#![expect(clippy::print_stderr, reason = "a test that is left out says so")]

use std::sync::Arc;

use orogen::gpu::{Gpu, GpuError};

/// What draws off screen.
pub(crate) fn drawing() -> Option<Gpu> {
    present(Gpu::offscreen())
}

/// What computes.
pub(crate) fn computing() -> Option<Arc<Gpu>> {
    present(Gpu::computing()).map(Arc::new)
}

/// Where there is no card, the tests say so and pass; with `OROGEN_REQUIRE_GPU=1` they fail.
fn present(found: Result<Gpu, GpuError>) -> Option<Gpu> {
    match found {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            let required = std::env::var_os("OROGEN_REQUIRE_GPU").is_some_and(|value| value == "1");
            assert!(!required, "{error}");
            eprintln!("skipped: {error}");
            None
        }
    }
}
