//! Stages on the graphics card, at the sizes of their likenesses on the processor.

use std::sync::Arc;

use glam::DVec2;

use super::{Bench, SEED, SQUARE, UPLIFT};
use crate::cli::failure::Failure;
use crate::gesture::rigid::RigidMotion;
use crate::gpu::{Gpu, GpuFolds, GpuTransport};
use crate::mountain::fold::{FoldDrive, FoldMesh, FoldShape, FoldStage, Skeleton};
use crate::mountain::transport::{MovedBody, TransportField, TransportProblem, TransportStage};
use crate::mountain::{Grid, Hull, MountainParams};
use crate::units::{DEFAULT_SHORT_SIDE, KM, PlanMap};

/// Three hands: where they are and where they push, km.
const HANDS: [([f64; 2], [f64; 2]); 3] = [
    ([45.0, 50.0], [0.0, 0.0]),
    ([125.0, 70.0], [-13.0, -1.5]),
    ([125.0, 24.0], [-10.0, 3.0]),
];

/// Half the size of a hand, km.
const HAND: [f64; 2] = [2.0, 10.0];

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
        let problem = three_plates();
        let mut field = TransportField::new(problem.grid);
        let cells = 1024 * 1024;
        // The first run makes buffers, and tells whether the card does the work at all.
        transport.run(&problem, &mut field);
        if !transport.on_card().get() {
            self.note("twins: transport: left out: the card failed");
            return Ok(());
        }
        self.time(("transport_gpu", cells, "3 plates"), Some(10.0), 11, || {
            transport.run(&problem, &mut field);
        });

        let grid = Grid::over(SQUARE, cells);
        let drive = FoldDrive::uniform(grid.blocks(), UPLIFT, 0.4);
        let on_card = folds.on_card();
        for (state, wavelength, heights_ms) in [("7 km", 7.0, 2.1), ("3 km", 3.0, 1.4), ("1 km", 1.0, 2.8)] {
            let mesh = FoldMesh::new(SQUARE, wavelength * KM, SEED).map_err(Failure::other)?;
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

/// Three hands on the table.
fn three_plates() -> TransportProblem {
    let params = MountainParams::default();
    let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
    let body = |(at, by): ([f64; 2], [f64; 2])| {
        let [half_width, half_height] = HAND;
        let tips = [(-1.0, -1.0), (1.0, -0.5), (-1.0, 0.0), (1.0, 0.5), (-1.0, 1.0)];
        let tip = |(x, y)| (DVec2::from_array(at) + DVec2::new(half_width * x, half_height * y)) * KM;
        let motion = RigidMotion {
            angle: 0.0,
            translation: DVec2::from_array(by) * KM,
        };
        let hull = Hull::new(&tips.map(tip), params.finger_radius)?.moved(&motion);
        Some(MovedBody { hull, motion })
    };
    TransportProblem {
        grid: Grid::over(map.extent(), params.cells),
        bodies: HANDS.into_iter().filter_map(body).collect(),
        exponent: params.exponent,
        rest_weight: params.rest_weight(),
    }
}
