//! From a moved finger to uplift and folds.

use glam::DVec2;

use super::{Bench, SEED, SQUARE, UPLIFT};
use crate::cli::failure::Failure;
use crate::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, Phase, Side, Source};
use crate::gesture::event::{HandEvent, HandId, Leg};
use crate::gesture::rigid::RigidFit;
use crate::mountain::fold::lines::troughs;
use crate::mountain::fold::{FoldDrive, FoldMesh, FoldShape, Skeleton};
use crate::mountain::transport::{CpuTransport, MovedBody, TransportProblem, TransportStage};
use crate::mountain::{Grid, MountainParams, PlateSet, Tectonics};
use crate::sim::{Sim, SimParams, TICK_US, World};
use crate::units::{DEFAULT_SHORT_SIDE, KM, PlanMap};

/// Nodes that a finger's uplift must reach.
const NODES: usize = 60_000;
/// Ticks until a hand that moves is known to push.
const TICKS_TO_PUSH: u64 = 40;
/// How far a pushing hand comes in a tick, table mm: a fifth of a metre per second.
const STRIDE_MM: f64 = 3.0;

impl Bench {
    /// Transport of three plates on 1024² cells, and the whole way from a moved finger to new uplift.
    pub(super) fn mountain(&mut self) {
        let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
        let params = MountainParams::default();
        let mut tectonics = Tectonics::default();
        let plates = three_plates(&map, &params);
        let cells = 1024 * 1024;
        let mut field = tectonics.compute(&plates, map.extent(), 0.0, &params);
        let moved = plates.bodies(0.0).into_iter().map(|body| MovedBody {
            hull: body.support.moved(&body.motion),
            motion: body.motion,
        });
        let problem = TransportProblem {
            grid: field.transport.grid,
            bodies: moved.collect(),
            exponent: params.exponent,
            rest_weight: params.rest_weight(),
        };
        self.time(("transport", cells, "3 plates"), Some(10.0), 11, || {
            CpuTransport.run(&problem, &mut field.transport);
        });
        self.time(("gesture_to_uplift", cells, "3 plates"), None, 11, || {
            tectonics.compute_into(&plates, map.extent(), 0.0, &params, &mut field);
        });
    }

    /// The whole way from a moved finger to the uplift and the folds that the nodes feel, as the session goes it.
    pub(super) fn gesture(&mut self) -> Result<(), Failure> {
        let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
        let params = SimParams {
            fold_layers: 1,
            // The land stands still: its steps have rows of their own.
            pace_yr_per_s: 1.0,
            ..SimParams::default()
        };
        let cells = params.mountain.cells;
        let mut sim = Sim::new(World::new(map, NODES, SEED).map_err(Failure::other)?, params);
        for _ in 0..TICKS_TO_PUSH {
            move_on(&mut sim);
        }
        let key = ("gesture_to_uplift", cells, "one fold layer");
        self.time(key, None, 21, || move_on(&mut sim));
        Ok(())
    }

    /// Skeletons of folds, crests and troughs together, at about the sizes of the literature (955, 4,246 and 36,715
    /// lines), and their heights on 1024² cells.
    pub(super) fn folds(&mut self) -> Result<(), Failure> {
        let grid = Grid::over(SQUARE, 1024 * 1024);
        let drive = FoldDrive::uniform(grid.blocks(), UPLIFT, 0.4);
        let sizes = [
            ("7 km", 7.0, 0.9, 2.1),
            ("3 km", 3.0, 3.7, 1.4),
            ("1 km", 1.0, 53.0, 2.8),
        ];
        for (state, wavelength, skeletons_ms, heights_ms) in sizes {
            let mesh = FoldMesh::new(SQUARE, wavelength * KM, SEED).map_err(Failure::other)?;
            let choose = || {
                let skeleton = Skeleton::select(&mesh, &drive, None, &[]);
                let lines = skeleton.top_len() + troughs(&mesh, &skeleton).len();
                (skeleton, lines)
            };
            let (skeleton, lines) = choose();
            self.time(("fold_skeletons", lines, state), Some(skeletons_ms), 21, choose);
            let mut heights = Vec::new();
            self.time(("fold_heights", grid.len(), state), Some(heights_ms), 11, || {
                FoldShape::new(&mesh, &skeleton).on_grid(grid, &mut heights);
            });
        }
        Ok(())
    }
}

/// One tick of a session in which one hand rests and one pushes towards it. True where the uplift is another one.
fn move_on(sim: &mut Sim) -> bool {
    let tick = sim.ticks();
    let way = DVec2::new(-STRIDE_MM * tick as f64, 0.0);
    let event = |(id, position)| ContactEvent {
        phase: if tick == 0 { Phase::Down } else { Phase::Move },
        contact: Contact {
            key: ContactKey {
                source: Source::File,
                device: 0,
                id,
                generation: 0,
            },
            position,
            size_mm: None,
            confidence: None,
        },
    };
    let resting = hand(300.0, 340.0).into_iter();
    let pushing = hand(850.0, 340.0).into_iter().map(|finger| finger + way);
    sim.feed(InputFrame {
        t_us: tick * TICK_US,
        events: (0..).zip(resting.chain(pushing)).map(event).collect(),
        commands: Vec::new(),
    });
    sim.tick();
    sim.refresh_uplift()
}

/// Five fingers around a place, table mm.
fn hand(x: f64, y: f64) -> Vec<DVec2> {
    (0..5)
        .map(|i| DVec2::new(x + 18.0 * f64::from(i % 2), y + 35.0 * f64::from(i) - 70.0))
        .collect()
}

/// Three hands of five fingers, one resting and two pushing towards it.
fn three_plates(map: &PlanMap, params: &MountainParams) -> PlateSet {
    let mut plates = PlateSet::default();
    let rest = HandEvent::Rest {
        hand: HandId(0),
        side: Side::South,
        fingers: hand(300.0, 340.0),
    };
    plates.apply(&rest, map, 0.0, params);
    for (id, x, y, push) in [
        (1, 850.0, 200.0, DVec2::new(-90.0, 10.0)),
        (2, 850.0, 520.0, DVec2::new(-70.0, -20.0)),
    ] {
        let starts = hand(x, y);
        let ends: Vec<DVec2> = starts.iter().map(|&p| p + push).collect();
        let leg = Leg {
            hand: HandId(id),
            index: 0,
        };
        let fit = RigidFit::fit(&starts, &ends);
        plates.apply(
            &HandEvent::Push {
                leg,
                side: Side::South,
                starts,
                fit,
            },
            map,
            0.0,
            params,
        );
    }
    plates
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_tick_of_the_session_brings_another_uplift() {
        let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
        let mut params = SimParams {
            pace_yr_per_s: 1.0,
            ..SimParams::default()
        };
        params.mountain.cells = 64 * 64;
        let mut sim = Sim::new(World::new(map, 500, SEED).expect("a table"), params);
        for _ in 0..TICKS_TO_PUSH {
            move_on(&mut sim);
        }
        assert!((0..25).all(|_| move_on(&mut sim)));
        assert_eq!((sim.hands().count(), sim.world().totals.steps), (2, 0));
    }
}
