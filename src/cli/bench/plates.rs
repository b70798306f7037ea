//! From a moved finger to uplift and folds.

use glam::DVec2;

use super::goals::GRID;
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

/// What the paper took for one transport, ms.
pub(super) const PAPER_TRANSPORT_MS: f64 = 10.0;

/// Folds of one wavelength, and what the paper took for their stages, ms.
pub(super) struct FoldSize {
    /// Name of the rows.
    pub(super) state: &'static str,
    /// Wavelength, km.
    pub(super) wavelength_km: f64,
    /// Choosing crests and troughs.
    pub(super) skeletons_ms: f64,
    /// Heights on the grid.
    pub(super) heights_ms: f64,
}

/// About the sizes of the paper: 955, 4,246 and 36,715 lines.
pub(super) const FOLD_SIZES: [FoldSize; 3] = [
    FoldSize {
        state: "7 km",
        wavelength_km: 7.0,
        skeletons_ms: 0.9,
        heights_ms: 2.1,
    },
    FoldSize {
        state: "3 km",
        wavelength_km: 3.0,
        skeletons_ms: 3.7,
        heights_ms: 1.4,
    },
    FoldSize {
        state: "1 km",
        wavelength_km: 1.0,
        skeletons_ms: 53.0,
        heights_ms: 2.8,
    },
];

impl Bench {
    /// Transport of three plates on 1024² cells, and the whole way from a moved finger to new uplift.
    pub(super) fn mountain(&mut self) {
        let map = table();
        let params = MountainParams::default();
        let mut tectonics = Tectonics::default();
        let plates = three_plates(&map, &params);
        let mut field = tectonics.compute(&plates, map.extent(), 0.0, &params);
        let problem = transport_of(&plates, &map, &params);
        self.time(
            ("transport", GRID, "3 plates"),
            Some(PAPER_TRANSPORT_MS),
            11,
            || {
                CpuTransport.run(&problem, &mut field.transport);
            },
        );
        self.time(("gesture_to_uplift", GRID, "3 plates"), None, 11, || {
            tectonics.compute_into(&plates, map.extent(), 0.0, &params, &mut field);
        });
    }

    /// The whole way from a moved finger to the uplift and the folds that the nodes feel, as the session goes it.
    pub(super) fn gesture(&mut self) -> Result<(), Failure> {
        let map = table();
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

    /// Skeletons of folds, crests and troughs together, and their heights on 1024² cells.
    pub(super) fn folds(&mut self) -> Result<(), Failure> {
        let grid = fold_grid();
        let drive = fold_drive();
        for FoldSize {
            state,
            wavelength_km,
            skeletons_ms,
            heights_ms,
        } in FOLD_SIZES
        {
            let mesh = fold_mesh(wavelength_km)?;
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

/// Cells that heights of folds are computed on.
pub(super) fn fold_grid() -> Grid {
    Grid::over(SQUARE, GRID)
}

/// Where folds of a wavelength, km, may lie.
pub(super) fn fold_mesh(wavelength_km: f64) -> Result<FoldMesh, Failure> {
    FoldMesh::new(SQUARE, wavelength_km * KM, SEED).map_err(Failure::other)
}

/// What makes folds everywhere, across one direction.
pub(super) fn fold_drive() -> FoldDrive {
    FoldDrive::uniform(fold_grid().blocks(), UPLIFT, 0.4)
}

/// The transport under three hands on a table.
#[cfg(feature = "app")]
pub(super) fn three_plates_transport() -> TransportProblem {
    let (map, params) = (table(), MountainParams::default());
    transport_of(&three_plates(&map, &params), &map, &params)
}

fn transport_of(plates: &PlateSet, map: &PlanMap, params: &MountainParams) -> TransportProblem {
    let moved = plates.bodies(0.0).into_iter().map(|body| MovedBody {
        hull: body.support.moved(&body.motion),
        motion: body.motion,
    });
    TransportProblem {
        grid: Grid::over(map.extent(), params.cells),
        bodies: moved.collect(),
        exponent: params.exponent,
        rest_weight: params.rest_weight(),
    }
}

/// A touch table of 55 inches.
fn table() -> PlanMap {
    PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE)
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
        let map = table();
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
