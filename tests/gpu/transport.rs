//! The transport field on the card against the stage on the processor and the equation itself.
//!
//! Where nothing computes, the tests say so and pass; with `OROGEN_REQUIRE_GPU=1` they fail.

use std::time::Duration;

use crate::card;
use glam::DVec2;
use orogen::gesture::rigid::RigidMotion;
use orogen::gpu::GpuTransport;
use orogen::mountain::transport::{
    CpuTransport, MovedBody, Q_TOLERANCE, TransportField, TransportProblem, TransportStage, reference,
};
use orogen::mountain::{Grid, Hull};
use orogen::units::KM;

/// Largest difference of a displacement from the exact one and from the processor's, metres: both keep 178 km to 8 mm, and
/// a turn by a tenth hands a few of these roundings on.
const SHIFT_TOLERANCE: f64 = 0.04;

/// The same beyond the table, as a part of the distance: what is 5,000 km away is known to half a metre.
const FAR_TOLERANCE: f64 = 2e-7;

/// Below this exponent hulls are not quite rigid in either stage: the weight of what is inside is finite.
const RIGID_EXPONENT: f64 = 0.9;

/// How much more a rim may differ: there `q` is singular, and cells of different stages see it at other roundings.
const RIM: f64 = 4.0;

/// A grid of any size over a land of 178 km.
fn grid(cols: usize, rows: usize) -> Grid {
    let cell = 178_000.0 / cols as f64;
    Grid {
        cols,
        rows,
        cell,
        north_west: DVec2::new(0.0, rows as f64 * cell),
    }
}

fn shifted(x: f64, y: f64) -> RigidMotion {
    RigidMotion {
        angle: 0.0,
        translation: DVec2::new(x, y) * KM,
    }
}

/// A turn about `centre` (km) and then a shift (km).
fn turned(centre: [f64; 2], angle: f64, by: [f64; 2]) -> RigidMotion {
    let centre = DVec2::from_array(centre) * KM;
    RigidMotion {
        angle,
        translation: centre + DVec2::from_array(by) * KM - DVec2::from_angle(angle).rotate(centre),
    }
}

fn body(points: &[[f64; 2]], radius_km: f64, motion: RigidMotion) -> MovedBody {
    let points: Vec<DVec2> = points.iter().map(|&p| DVec2::from_array(p) * KM).collect();
    MovedBody {
        hull: Hull::new(&points, radius_km * KM).expect("points").moved(&motion),
        motion,
    }
}

fn problem(grid: Grid, bodies: Vec<MovedBody>) -> TransportProblem {
    TransportProblem {
        grid,
        bodies,
        exponent: 0.9,
        rest_weight: (40.0 * KM).powf(-0.9),
    }
}

/// A polygon at rest, one that comes and turns, and a hand of two fingers on a line.
fn three_plates(grid: Grid) -> TransportProblem {
    let palm = [[40.0, 40.0], [47.0, 52.0], [35.0, 60.0], [30.0, 48.0]];
    let fingers = [[120.0, 35.0], [128.0, 44.0], [126.0, 58.0], [118.0, 52.0]];
    problem(
        grid,
        vec![
            body(&palm, 4.5, RigidMotion::IDENTITY),
            body(&fingers, 4.5, turned([122.0, 47.0], 0.1, [-16.0, 2.0])),
            body(&[[90.0, 88.0], [100.0, 80.0]], 4.5, shifted(1.0, -9.0)),
        ],
    )
}

/// Three plates on grids and with parameters of all kinds, by name.
fn settings() -> Vec<(&'static str, TransportProblem)> {
    let three = three_plates(grid(83, 47));
    let with = |exponent: f64, rest_km: f64| TransportProblem {
        exponent,
        rest_weight: (rest_km * KM).powf(-exponent),
        ..three.clone()
    };
    vec![
        ("three plates", three.clone()),
        ("three plates, one cell", three_plates(grid(1, 1))),
        ("three plates, one column", three_plates(grid(1, 33))),
        ("three plates, whole workgroups", three_plates(grid(64, 32))),
        (
            "three plates, corners of whole workgroups",
            three_plates(grid(63, 31)),
        ),
        ("no rest", with(0.9, f64::INFINITY)),
        ("e = 0.5", with(0.5, 40.0)),
        ("e = 2", with(2.0, 40.0)),
    ]
}

/// Hulls and motions of all kinds, by name.
fn scenes() -> Vec<(&'static str, TransportProblem)> {
    let odd = grid(83, 47);
    let one = |points: &[[f64; 2]], radius, motion| problem(odd, vec![body(points, radius, motion)]);
    vec![
        ("no plate", problem(odd, Vec::new())),
        (
            "no plate, no rest",
            TransportProblem {
                rest_weight: 0.0,
                ..problem(odd, Vec::new())
            },
        ),
        ("one finger", one(&[[80.0, 50.0]], 4.5, shifted(-6.0, 3.0))),
        (
            "a finger without a radius",
            one(&[[80.3, 50.7]], 0.0, shifted(-6.0, 3.0)),
        ),
        (
            "five fingers in one place",
            one(&[[80.0, 50.0]; 5], 4.5, turned([80.0, 50.0], 0.4, [3.0, 0.0])),
        ),
        (
            "fingers on a line",
            one(
                &[[60.0, 30.0], [70.0, 40.0], [80.0, 50.0]],
                3.0,
                turned([70.0, 40.0], -0.2, [0.0, 8.0]),
            ),
        ),
        (
            "two hulls in one place",
            problem(
                odd,
                vec![
                    body(
                        &[[80.0, 50.0], [90.0, 55.0], [84.0, 62.0]],
                        4.5,
                        shifted(5.0, 0.0),
                    ),
                    body(
                        &[[80.0, 50.0], [90.0, 55.0], [84.0, 62.0]],
                        4.5,
                        shifted(5.0, 0.0),
                    ),
                ],
            ),
        ),
        (
            "half a turn",
            one(
                &[[70.0, 45.0], [95.0, 50.0], [80.0, 60.0]],
                4.5,
                turned([82.0, 52.0], 3.1, [2.0, 1.0]),
            ),
        ),
        (
            "far off",
            problem(
                odd,
                vec![
                    body(
                        &[[5_000.0, 40.0], [5_010.0, 52.0], [4_990.0, 60.0]],
                        4.5,
                        turned([5_000.0, 50.0], 0.3, [-9.0, 4.0]),
                    ),
                    body(&[[60.0, 40.0]], 4.5, shifted(7.0, 0.0)),
                ],
            ),
        ),
        (
            "half-planes",
            problem(
                odd,
                vec![
                    body(
                        &[[-9e3, -9e3], [20.0, -9e3], [20.0, 9e3], [-9e3, 9e3]],
                        0.0,
                        RigidMotion::IDENTITY,
                    ),
                    body(
                        &[[64.0, -9e3], [9e3, -9e3], [9e3, 9e3], [64.0, 9e3]],
                        0.0,
                        shifted(-4.0, 0.0),
                    ),
                ],
            ),
        ),
    ]
}

/// The stage, however slow the adapter is.
fn stage() -> Option<GpuTransport> {
    let stage = GpuTransport::new(&card::computing()?).expect("a stage");
    Some(stage.with_patience(Duration::from_mins(1)))
}

/// What is wrong with the answers of `stage`; nothing for a good one.
fn faults(stage: &mut dyn TransportStage, name: &str, problem: &TransportProblem) -> Vec<String> {
    let mut field = TransportField::new(problem.grid);
    // What an earlier run left must not shine through.
    field.east.fill(f32::NAN);
    field.q.data.fill(f32::NAN);
    stage.run(problem, &mut field);
    let mut cpu = TransportField::new(problem.grid);
    CpuTransport.run(problem, &mut cpu);

    let grid = problem.grid;
    let rigid = problem.exponent >= RIGID_EXPONENT;
    let distances = |p: DVec2| {
        problem
            .bodies
            .iter()
            .map(move |body| body.hull.nearest(p).distance)
    };
    let exactly = |p: DVec2| rigid || distances(p).all(|distance| distance > 2.0 * grid.cell);
    let mut worst = [
        ("displacement", 0.0_f64),
        ("displacement of the processor", 0.0),
        ("q", 0.0),
        ("q of the processor", 0.0),
    ];
    let mut look = |which: usize, off: f64, tolerance: f64| {
        let (_, worst) = &mut worst[which];
        let off = off / tolerance;
        // `max` would drop what is no number.
        *worst = worst.max(if off.is_nan() { f64::INFINITY } else { off });
    };
    for row in 0..=grid.rows {
        for col in 0..=grid.cols {
            let p = grid.corner(col, row);
            let tolerance = SHIFT_TOLERANCE + FAR_TOLERANCE * distances(p).fold(0.0, f64::max);
            let here = field.shift(col, row);
            if exactly(p) {
                look(0, (here - reference::shift(problem, p)).length(), tolerance);
            }
            look(1, (here - cpu.shift(col, row)).length(), tolerance);
        }
    }
    for (at, exact) in reference::thickness(problem).into_iter().enumerate() {
        // At the rims, where q is singular, the tolerance is relative.
        let tolerance = Q_TOLERANCE * exact.abs().max(1.0);
        let q = f64::from(field.q.data[at]);
        if exactly(grid.centre(at % grid.cols, at / grid.cols)) {
            look(2, (q - exact).abs(), tolerance);
        }
        look(3, (q - f64::from(cpu.q.data[at])).abs(), 2.0 * tolerance);
    }
    let mut faults: Vec<String> = worst
        .iter()
        .filter(|(_, worst)| *worst > 1.0)
        .map(|(what, worst)| format!("{name}: {what} is off by {worst:.2} tolerances"))
        .collect();
    let (a, b) = (field.report, cpu.report);
    let same = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance * b.abs().max(1.0);
    if a.cells != b.cells
        || a.cell_km != b.cell_km
        || a.folded_cells.abs_diff(b.folded_cells) > 2
        || !same(a.q_min, b.q_min, RIM * Q_TOLERANCE)
        || !same(a.q_max, b.q_max, RIM * Q_TOLERANCE)
        || !same(a.volume, b.volume, 1e-5)
        || !same(a.preimage_area, b.preimage_area, 1e-5)
    {
        faults.push(format!("{name}: {a:?} against {b:?}"));
    }
    faults
}

#[test]
fn the_twin_agrees_in_every_scene() {
    let Some(mut stage) = stage() else { return };
    // One stage for all: buffers of one size must serve the next.
    for (name, problem) in scenes().into_iter().chain(settings()) {
        let found = faults(&mut stage, name, &problem);
        assert!(found.is_empty(), "{found:#?}");
    }
    assert!(stage.on_card().get(), "the card has done all of it");
}

#[test]
fn the_twin_agrees_on_the_table() {
    let Some(gpu) = card::computing() else { return };
    let mut stage = GpuTransport::new(&gpu)
        .expect("a stage")
        .with_patience(Duration::from_mins(1));
    let found = faults(&mut stage, "the table", &three_plates(grid(1366, 768)));
    assert!(found.is_empty(), "{found:#?}");
    assert!(stage.on_card().get());
}

/// A twin with a mistake.
struct Broken(&'static str, fn(&TransportProblem, &mut TransportField));

impl std::fmt::Debug for Broken {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(self.0)
    }
}

impl TransportStage for Broken {
    fn run(&mut self, problem: &TransportProblem, out: &mut TransportField) {
        CpuTransport.run(problem, out);
        (self.1)(problem, out);
        out.tally();
    }
}

#[test]
fn broken_twins_are_caught() {
    let mut broken = [
        Broken("the wrong sign", |_, field| {
            field
                .east
                .iter_mut()
                .chain(&mut field.north)
                .for_each(|shift| *shift = -*shift);
        }),
        Broken("q upside down", |_, field| {
            field.q.data.iter_mut().for_each(|q| *q = 2.0 - *q);
        }),
        Broken("another exponent", |problem, field| {
            let exponent = problem.exponent + 0.01;
            CpuTransport.run(
                &TransportProblem {
                    exponent,
                    ..problem.clone()
                },
                field,
            );
        }),
        Broken("a plate too few", |problem, field| {
            let bodies = problem.bodies[1..].to_vec();
            CpuTransport.run(
                &TransportProblem {
                    bodies,
                    ..problem.clone()
                },
                field,
            );
        }),
        Broken("a row that no workgroup reached", |problem, field| {
            let last = field.q.data.len() - problem.grid.cols;
            field.q.data[last..].fill(f32::NAN);
        }),
        Broken("half a metre", |_, field| field.east[40] += 0.5),
    ];
    let problem = three_plates(grid(83, 47));
    for stage in &mut broken {
        let found = faults(stage, "broken", &problem);
        assert!(!found.is_empty(), "{stage:?}");
    }
    assert!(faults(&mut CpuTransport, "the processor", &problem).is_empty());
}

/// After a failure the processor answers: in the same run, to its own bits, and from then on.
fn falls_back(mut stage: GpuTransport, problem: &TransportProblem) {
    let on_card = stage.on_card();
    let mut cpu = TransportField::new(problem.grid);
    CpuTransport.run(problem, &mut cpu);
    for _ in 0..2 {
        let mut field = TransportField::new(problem.grid);
        field.q.data.fill(f32::NAN);
        stage.run(problem, &mut field);
        assert_eq!(field, cpu);
        assert!(!on_card.get());
    }
}

#[test]
fn a_lost_device_leaves_the_work_to_the_processor() {
    let Some(gpu) = card::computing() else { return };
    let problem = three_plates(grid(83, 47));
    let mut stage = GpuTransport::new(&gpu).expect("a stage");
    let mut field = TransportField::new(problem.grid);
    stage.run(&problem, &mut field);
    gpu.device.destroy();
    falls_back(stage, &problem);
    assert!(
        GpuTransport::new(&gpu).is_err(),
        "nothing is made on what is lost"
    );
}

#[test]
fn a_card_that_does_not_answer_is_not_waited_for() {
    let Some(stage) = stage() else { return };
    falls_back(
        stage.with_patience(Duration::ZERO),
        &three_plates(grid(1366, 768)),
    );
}

#[test]
fn work_that_is_too_large_goes_to_the_processor() {
    let Some(stage) = stage() else { return };
    falls_back(stage, &three_plates(grid(4096, 2800)));
}
