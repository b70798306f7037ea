//! Frames of the table's own picture, and what a new land costs to hand over.

use glam::DVec2;

use super::Bench;
use crate::surface::{Raster, Surface};
use crate::units::{DEFAULT_SHORT_SIDE, KM, PlanMap};

impl Bench {
    /// Frames of the table's own picture, at the quality of software adapters, while the land stands still and while
    /// it grows; and what a new land costs to hand over.
    pub(super) fn frames(&mut self) {
        use crate::gpu::Gpu;
        use crate::render::{Camera, Canvas, Focus, LandStyle, RenderQuality, flight};

        /// Time between two frames, s.
        const FRAME_S: f32 = 0.033;
        /// The size that the goal for frames is about.
        const GOAL_SIZE: [u32; 2] = [1920, 1080];

        let gpu = match Gpu::offscreen() {
            Ok(gpu) => gpu,
            Err(error) => return self.note(&format!("frames: left out: {error}")),
        };
        self.note(&format!("frames: {} ({:?})", gpu.info.name, gpu.info.backend));
        let (runs, all) = if gpu.is_software() {
            self.circumstances.software = Some(gpu.info.name.clone());
            (5, 11)
        } else {
            (21, 501)
        };
        let surface = mountains(640, 360);
        let style = LandStyle::default();
        let eye = flight(&Focus::of(&surface), &style, 0.0);
        for size in [[1280, 720], [1920, 1080], [3840, 2160]] {
            let pixels = (size[0] * size[1]) as usize;
            let viewport = DVec2::from(size.map(f64::from));
            for (stage, tilt) in [("frame_plan", 0.0), ("frame_oblique", 1.0)] {
                let camera = Camera::between(surface.height.extent, viewport, &eye, tilt);
                let Ok(mut canvas) = Canvas::new(&gpu, size, RenderQuality::SOFTWARE) else {
                    continue;
                };
                canvas.land.show(&gpu, &surface);
                let frame = |canvas: &mut Canvas| canvas.draw(&gpu, &camera, &style, FRAME_S).is_ok();
                // The first frames make pipelines and whole sheets.
                while frame(&mut canvas) && !canvas.land.settled() {}
                self.time((stage, pixels, "settled"), None, runs, || frame(&mut canvas));
                if size == GOAL_SIZE {
                    // A new land for each of them, as on a table that keeps up with its hands.
                    let key = (stage, pixels, "p99");
                    self.time_part(
                        key,
                        None,
                        (all, 0.99),
                        || (),
                        |()| {
                            canvas.land.show(&gpu, &surface);
                            frame(&mut canvas)
                        },
                    );
                }
                canvas.land.show(&gpu, &surface);
                self.time((stage, pixels, "growing"), None, runs, || frame(&mut canvas));
            }
        }
        if let Ok(mut canvas) = Canvas::new(&gpu, [64, 36], RenderQuality::SOFTWARE) {
            self.time(("upload", 640 * 360, "–"), None, 11, || {
                canvas.land.show(&gpu, &surface);
                gpu.queue.submit([]);
            });
        }
    }
}

/// A range of ridges and valleys on a plain, with rivers, over flat layers.
fn mountains(width: usize, height: usize) -> Surface {
    use std::sync::Arc;

    use crate::rock::preset;
    use crate::surface::{River, RiverPoint, StrataMap};

    /// Height of the first surface over the plain, metres.
    const TOP: f32 = 3000.0;

    let extent = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE).extent();
    let field = |value: &dyn Fn(DVec2) -> f64| Raster::from_fn(width, height, extent, |p| value(p) as f32);
    let river = |i: usize| {
        let north = (i as f64 + 0.5) / 120.0 * extent.height;
        let point = |k: usize| RiverPoint {
            at: DVec2::new(k as f64 * 0.5 * KM, north + 0.4 * KM * (k as f64 / 9.0).sin()),
            drainage: (20.0 + 10.0 * k as f64) * KM * KM,
        };
        River {
            points: (0..100).map(point).collect(),
            order: 3,
        }
    };
    let height = field(&|p| {
        let belt = (1.0 - ((p.x - extent.width / 2.0) / (36.0 * KM)).powi(2)).max(0.0);
        belt * (2200.0 + 900.0 * (p.y / 900.0 + (p.x / 1700.0).sin()).sin() * (p.x / 2300.0).cos())
    });
    let none = field(&|_| 0.0);
    let depth = Raster {
        data: height.data.iter().map(|z| TOP - z).collect(),
        ..none.clone()
    };
    Surface {
        strata: Some(Arc::new(StrataMap {
            stratigraphy: preset::default(),
            base: field(&|_| f64::from(TOP)),
            folds: Vec::new(),
            sediment: none.clone(),
            root: none.clone(),
            depth,
        })),
        height,
        lake_depth: field(&|p| 4.0 * KM - p.distance(extent.size() / 5.0)),
        drainage: none,
        spacing: 545.0,
        rivers: (0..120).map(river).collect(),
        plates: Vec::new(),
        faults: Vec::new(),
        folds: Vec::new(),
        elapsed_yr: 5e6,
    }
}
