//! A stage that leaves the card for good when the card fails.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::GpuError;

/// Tells from anywhere whether a stage is still on the card.
#[derive(Clone, Debug)]
pub struct OnCard(Arc<AtomicBool>);

impl OnCard {
    /// True until the card has failed or the stage is gone.
    pub fn get(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A twin on the card, until it fails.
#[derive(Debug)]
pub(super) struct Twin<T> {
    name: &'static str,
    working: Option<T>,
    on_card: OnCard,
}

impl<T> Twin<T> {
    pub(super) fn new(name: &'static str, twin: T) -> Self {
        Self {
            name,
            working: Some(twin),
            on_card: OnCard(Arc::new(AtomicBool::new(true))),
        }
    }

    /// True until it fails.
    pub(super) fn works(&self) -> bool {
        self.working.is_some()
    }

    pub(super) fn on_card(&self) -> OnCard {
        self.on_card.clone()
    }

    /// The twin, if there still is one.
    pub(super) fn get_mut(&mut self) -> Option<&mut T> {
        self.working.as_mut()
    }

    /// True where the twin has done `work`; otherwise somebody else has to. A twin that fails once is not asked again.
    pub(super) fn does(&mut self, work: impl FnOnce(&mut T) -> Result<(), GpuError>) -> bool {
        let Some(twin) = &mut self.working else {
            return false;
        };
        // wgpu panics when it waits for a device and the device is lost.
        let done = catch_unwind(AssertUnwindSafe(|| work(twin)));
        let why = match done {
            Ok(Ok(())) => return true,
            Ok(Err(error)) => error.to_string(),
            Err(_) => "the graphics device was lost while it worked".to_owned(),
        };
        tracing::warn!("{} goes on on the processor: {why}", self.name);
        self.working = None;
        self.on_card.0.store(false, Ordering::Relaxed);
        false
    }
}

impl<T> Drop for Twin<T> {
    fn drop(&mut self) {
        self.on_card.0.store(false, Ordering::Relaxed);
    }
}
