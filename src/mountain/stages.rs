//! Who computes the stages that can be computed elsewhere.

use super::fold::{CpuFolds, FoldStage};
use super::transport::{CpuTransport, TransportStage};

/// The stages of one session; by default the processor's, whose results are the same bits everywhere.
///
/// A stage on another device answers within the tolerances of its trait, which is not to the bit.
#[derive(Debug)]
pub struct Stages {
    /// Where the crust comes from.
    pub transport: Box<dyn TransportStage>,
    /// Heights of folds.
    pub folds: Box<dyn FoldStage>,
}

impl Default for Stages {
    fn default() -> Self {
        Self {
            transport: Box::new(CpuTransport),
            folds: Box::new(CpuFolds),
        }
    }
}
