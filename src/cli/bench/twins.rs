//! Stages on the graphics card, at the sizes of their likenesses on the processor.

use std::sync::Arc;

use super::Bench;
use super::goals::GRID;
use super::plates::{
    FOLD_SIZES, FoldSize, PAPER_TRANSPORT_MS, fold_drive, fold_grid, fold_mesh, three_plates_transport,
};
use crate::cli::failure::Failure;
use crate::gpu::{Gpu, GpuFolds, GpuTransport};
use crate::mountain::fold::{FoldShape, FoldStage, Skeleton};
use crate::mountain::transport::{TransportField, TransportStage};

impl Bench {
    /// Transport of three plates and heights of folds on 1024² cells, from call to answer.
    pub(super) fn twins(&mut self) -> Result<(), Failure> {
        let made = Gpu::computing().and_then(|gpu| {
            let gpu = Arc::new(gpu);
            Ok((GpuTransport::new(&gpu)?, GpuFolds::new(&gpu)?, gpu))
        });
        let (mut transport, mut folds, gpu) = match made {
            Ok(made) => made,
            Err(error) => {
                self.note(&format!("twins: left out: {error}"));
                return Ok(());
            }
        };
        self.note(&format!("twins: {} ({:?})", gpu.info.name, gpu.info.backend));
        let problem = three_plates_transport();
        let mut field = TransportField::new(problem.grid);
        // The first run makes buffers, and tells whether the card does the work at all.
        transport.run(&problem, &mut field);
        if !transport.on_card().get() {
            self.note("twins: transport: left out: the card failed");
            return Ok(());
        }
        self.time(
            ("transport_gpu", GRID, "3 plates"),
            Some(PAPER_TRANSPORT_MS),
            11,
            || {
                transport.run(&problem, &mut field);
            },
        );

        let (grid, drive) = (fold_grid(), fold_drive());
        let on_card = folds.on_card();
        for FoldSize {
            state,
            wavelength_km,
            heights_ms,
            ..
        } in FOLD_SIZES
        {
            let mesh = fold_mesh(wavelength_km)?;
            let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
            let mut heights = Vec::new();
            let mut run = || folds.on_grid(&FoldShape::new(&mesh, &skeleton), grid, &mut heights);
            run();
            if !on_card.get() {
                self.note("twins: folds: left out: the card failed");
                return Ok(());
            }
            self.time(("fold_heights_gpu", grid.len(), state), Some(heights_ms), 11, run);
        }
        Ok(())
    }
}
