//! Closed forms and identities of the transport: rigid fit, volume, half-planes, q·det F, fold-over.

use glam::{DMat2, DVec2};
use orogen::gesture::rigid::{RigidFit, RigidMotion};
use orogen::mountain::compression::{CompressionField, Shortening};
use orogen::mountain::transport::{
    CpuTransport, MovedBody, Q_TOLERANCE, TransportField, TransportProblem, TransportStage, reference,
};
use orogen::mountain::{Grid, Hull};
use orogen::units::{Extent, KM};
use proptest::prelude::*;

const TABLE: Extent = Extent {
    width: 178_000.0,
    height: 100_000.0,
};

fn shifted(x: f64, y: f64) -> RigidMotion {
    RigidMotion {
        angle: 0.0,
        translation: DVec2::new(x, y),
    }
}

/// A turn about `centre` and then a shift.
fn turned(centre: DVec2, angle: f64, by: DVec2) -> RigidMotion {
    RigidMotion {
        angle,
        translation: centre + by - DVec2::from_angle(angle).rotate(centre),
    }
}

fn body(points: &[[f64; 2]], radius: f64, motion: RigidMotion) -> MovedBody {
    let points: Vec<DVec2> = points.iter().map(|&p| DVec2::from_array(p) * KM).collect();
    MovedBody {
        hull: Hull::new(&points, radius).expect("points").moved(&motion),
        motion,
    }
}

fn problem(cells: usize, bodies: Vec<MovedBody>, rest_distance: f64) -> TransportProblem {
    TransportProblem {
        grid: Grid::over(TABLE, cells),
        bodies,
        exponent: 0.9,
        rest_weight: rest_distance.powf(-0.9),
    }
}

fn run(problem: &TransportProblem) -> TransportField {
    let mut field = TransportField::new(problem.grid);
    CpuTransport.run(problem, &mut field);
    field
}

/// A table scene with turns, a segment, a disc and a polygon.
fn lively(cells: usize) -> TransportProblem {
    problem(
        cells,
        vec![
            body(
                &[[40.0, 40.0], [47.0, 52.0], [35.0, 60.0], [30.0, 48.0]],
                4_500.0,
                RigidMotion::IDENTITY,
            ),
            body(
                &[[120.0, 35.0], [128.0, 44.0], [126.0, 58.0], [118.0, 52.0]],
                4_500.0,
                turned(DVec2::new(122.0, 47.0) * KM, 0.1, DVec2::new(-16.0, 2.0) * KM),
            ),
            body(
                &[[90.0, 88.0], [100.0, 80.0]],
                4_500.0,
                shifted(1_000.0, -9_000.0),
            ),
            body(&[[85.0, 12.0]], 4_500.0, shifted(-2_000.0, 6_000.0)),
        ],
        40.0 * KM,
    )
}

#[test]
fn the_fit_finds_exact_motions_and_never_reflects() {
    let from: Vec<DVec2> = [[0.0, 0.0], [3.0, 1.0], [1.0, 4.0], [-2.0, 2.0]]
        .map(DVec2::from_array)
        .to_vec();
    for angle in [-3.1, -1.0, 0.0, 0.3, 3.1, std::f64::consts::PI] {
        let motion = turned(DVec2::new(1.0, 2.0), angle, DVec2::new(5.0, -7.0));
        let to: Vec<DVec2> = from.iter().map(|&p| motion.apply(p)).collect();
        let fit = RigidFit::fit(&from, &to);
        assert!(fit.residual < 1e-6, "angle {angle}");
        for (&p, &q) in from.iter().zip(&to) {
            assert!((fit.motion.apply(p) - q).length() < 1e-9);
        }
    }
    let mirrored: Vec<DVec2> = from.iter().map(|p| DVec2::new(-p.x, p.y)).collect();
    assert!(
        RigidFit::fit(&from, &mirrored).residual > 1.0,
        "a mirror image is not a rigid motion"
    );
}

/// Two half-planes that close by `d` across a gap `L`: q = 1 + e·d/L in the middle, 1 + d/L on average.
#[test]
fn half_planes_give_the_closed_form() {
    let (gap, closing, exponent) = (40.0 * KM, 4.0 * KM, 0.9);
    // Long bars stand for half-planes; their far ends are 500 times the gap away.
    let far = 20_000.0;
    let motion = shifted(-closing, 0.0);
    let west = body(
        &[[-far, -far], [20.0, -far], [20.0, far], [-far, far]],
        0.0,
        RigidMotion::IDENTITY,
    );
    let start = 60.0 + closing / KM;
    let east = body(
        &[[start, -far], [far, -far], [far, far], [start, far]],
        0.0,
        motion,
    );
    let problem = problem(1024 * 1024, vec![west, east], f64::INFINITY);
    let field = run(&problem);
    let row = problem.grid.rows / 2;
    let column = |x: f64| ((x - problem.grid.north_west.x) / problem.grid.cell) as usize;
    let q = |x: f64| f64::from(field.q.data[row * problem.grid.cols + column(x)]);
    let expected = 1.0 + exponent * closing / gap;
    assert!(
        (q(40.0 * KM) - expected).abs() < 5e-4,
        "{} against {expected}",
        q(40.0 * KM)
    );

    // The mean is exact for any sampling: the crust of the gap and what closed it.
    let whole = column(20.0 * KM)..=column(60.0 * KM);
    let mean = whole
        .clone()
        .map(|c| f64::from(field.q.data[row * problem.grid.cols + c]))
        .sum::<f64>()
        / whole.count() as f64;
    assert!((mean - (1.0 + closing / gap)).abs() < 1e-3, "{mean}");

    // Along the whole gap: Φ⁻¹ = x + d·x^e/(x^e + (L − x)^e).
    for part in [0.1, 0.3, 0.5, 0.8] {
        let p = DVec2::new(20.0 * KM + part * gap, 50.0 * KM);
        let shift = reference::shift(&problem, p);
        let (near, other) = (part.powf(exponent), (1.0 - part).powf(exponent));
        // Φ⁻¹ undoes the motion of the eastern plate.
        assert!((shift.x - closing * near / (near + other)).abs() < 1e-6 * closing);
        assert!(shift.y.abs() < 1e-9);
    }
}

#[test]
fn crust_is_conserved_to_the_last_cell() {
    let problem = lively(512 * 512);
    let report = run(&problem).report;
    // f32 rounds each q at 1e-7; errors of 3e5 cells average out.
    assert!(
        (report.volume / report.preimage_area - 1.0).abs() < 1e-7,
        "{report:?}"
    );
    assert!(
        (report.preimage_area / TABLE.area() * 1e6 - 1.0).abs() > 1e-3,
        "the border must move for this to tell"
    );

    // In double precision the sum telescopes.
    let q = reference::thickness(&problem);
    let grid = problem.grid;
    let at = |col: usize, row: usize| {
        let p = grid.corner(col, row);
        p + reference::shift(&problem, p)
    };
    let mut border: Vec<DVec2> = (0..grid.rows).map(|r| at(0, r)).collect();
    border.extend((0..grid.cols).map(|c| at(c, grid.rows)));
    border.extend((1..=grid.rows).rev().map(|r| at(grid.cols, r)));
    border.extend((1..=grid.cols).rev().map(|c| at(c, 0)));
    let origin = border[0];
    let area: f64 = (0..border.len())
        .map(|i| (border[i] - origin).perp_dot(border[(i + 1) % border.len()] - origin))
        .sum::<f64>()
        / 2.0;
    let volume = q.iter().sum::<f64>() * grid.cell * grid.cell;
    assert!((volume / area - 1.0).abs() < 1e-12, "{volume} against {area}");
}

#[test]
fn inside_a_moved_hull_nothing_is_thickened() {
    let problem = lively(512 * 512);
    let field = run(&problem);
    let exact = reference::thickness(&problem);
    let grid = problem.grid;
    let mut inside = 0;
    for row in 0..grid.rows {
        for col in 0..grid.cols {
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(c, r)| grid.corner(col + c, row + r));
            if problem
                .bodies
                .iter()
                .any(|b| corners.iter().all(|&p| b.hull.contains(p)))
            {
                inside += 1;
                let at = row * grid.cols + col;
                assert!((exact[at] - 1.0).abs() < 1e-9);
                assert!((f64::from(field.q.data[at]) - 1.0).abs() < Q_TOLERANCE);
            }
        }
    }
    assert!(inside > 10_000, "the scene has hulls: {inside}");
}

#[test]
fn equal_translations_and_no_motion_leave_the_crust_as_it_is() {
    for motion in [RigidMotion::IDENTITY, shifted(7_000.0, -3_000.0)] {
        let bodies = vec![
            body(&[[40.0, 40.0], [50.0, 60.0]], 4_500.0, motion),
            body(&[[120.0, 50.0]], 4_500.0, motion),
        ];
        let field = run(&problem(256 * 256, bodies, f64::INFINITY));
        for &q in &field.q.data {
            assert!((f64::from(q) - 1.0).abs() < Q_TOLERANCE, "{q}");
        }
    }
    let still = run(&problem(128 * 128, Vec::new(), 40.0 * KM));
    assert_eq!((still.report.q_min, still.report.q_max), (1.0, 1.0));
}

#[test]
fn the_fast_stage_agrees_with_the_equation() {
    let problem = lively(1024 * 1024);
    let field = run(&problem);
    let exact = reference::thickness(&problem);
    let mut worst: f64 = 0.0;
    for (&fast, &exact) in field.q.data.iter().zip(&exact) {
        // At the rims, where q is singular, the tolerance is relative.
        worst = worst.max((f64::from(fast) - exact).abs() / exact.abs().max(1.0));
    }
    assert!(worst < Q_TOLERANCE, "{worst}");
    // The comparison sees a wrong exponent.
    let wrong = TransportProblem {
        exponent: 0.91,
        ..problem
    };
    let field = run(&wrong);
    let differs = field
        .q
        .data
        .iter()
        .zip(&exact)
        .any(|(&q, &e)| (f64::from(q) - e).abs() > 10.0 * Q_TOLERANCE);
    assert!(differs);
}

/// F = (∇Φ⁻¹)⁻¹, so q = 1/(ν₁ν₂); a compressed crust has ν₁ < 1 (the printed sign gives ν₁ > 1 and C = 0).
#[test]
fn thickness_is_one_over_the_determinant_of_the_deformation() {
    let problem = lively(512 * 512);
    let field = run(&problem);
    let mut compression = CompressionField::none(problem.grid);
    compression.fill(&field);
    let grid = problem.grid;
    let mut squeezed = 0;
    for row in (0..grid.rows).step_by(7) {
        for col in (0..grid.cols).step_by(7) {
            let centre = grid.centre(col, row);
            // Differences over a tenth of a cell against quads of whole cells: equal to second order away from the
            // rims, where Φ⁻¹ is not smooth.
            if problem
                .bodies
                .iter()
                .any(|b| b.hull.nearest(centre).distance < 4_000.0)
            {
                continue;
            }
            let h = 0.05 * grid.cell;
            let map = |d: DVec2| centre + d + reference::shift(&problem, centre + d);
            let column = |d: DVec2| (map(d * h) - map(-d * h)) / (2.0 * h);
            let gradient = DMat2::from_cols(column(DVec2::X), column(DVec2::Y));
            let q = f64::from(field.q.data[row * grid.cols + col]);
            let deformation = gradient.inverse();
            assert!(
                (q * deformation.determinant() - 1.0).abs() < 3e-3,
                "{q} at {centre}"
            );

            let here = Shortening::of(gradient);
            // ν₁ is the least stretch of F, along the axis the shortening names.
            let stretch = (deformation.transpose() * here.direction).length();
            if here.strength > 0.02 {
                squeezed += 1;
                assert!(
                    (stretch - (1.0 - here.strength)).abs() < 1e-4,
                    "{stretch} {here:?}"
                );
                let across = (deformation.transpose() * here.direction.perp()).length();
                assert!(across >= stretch - 1e-6);
                let field_here = compression.at(centre);
                assert!((field_here.strength - here.strength).abs() < 5e-3);
                assert!(field_here.direction.perp_dot(here.direction).abs() < 0.05);
            }
        }
    }
    assert!(squeezed > 100, "{squeezed}");
}

#[test]
fn uniform_shortening_is_read_as_such() {
    // 10 % shortening along an oblique direction: Φ⁻¹ stretches it by 1/0.9.
    let direction = DVec2::from_angle(0.7);
    let outer = DMat2::from_cols(direction * direction.x, direction * direction.y);
    let found = Shortening::of(DMat2::IDENTITY + outer * (1.0 / 0.9 - 1.0));
    assert!((found.strength - 0.1).abs() < 1e-6);
    assert!(found.direction.perp_dot(direction).abs() < 1e-6);
    assert_eq!(
        Shortening::of(DMat2::from_diagonal(DVec2::splat(0.8))).strength,
        0.0,
        "extension"
    );
}

/// A motion larger than the gap turns the crust over; that is counted, and nothing is NaN.
#[test]
fn folds_are_counted_and_finite() {
    let bodies = |push: f64| {
        vec![
            body(&[[60.0, 40.0], [60.0, 60.0]], 4_500.0, RigidMotion::IDENTITY),
            body(&[[100.0, 40.0], [100.0, 60.0]], 4_500.0, shifted(push * KM, 0.0)),
        ]
    };
    let gentle = run(&problem(256 * 256, bodies(-6.0), 40.0 * KM));
    assert_eq!(gentle.report.folded_cells, 0);
    let beyond = run(&problem(256 * 256, bodies(-80.0), 40.0 * KM));
    assert!(beyond.report.folded_cells > 0);
    assert!(beyond.report.q_min < 0.0);
    assert!(beyond.q.data.iter().all(|q| q.is_finite()));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let problem = lively(300 * 300);
    let runs: Vec<TransportField> = [1, 2, 7]
        .map(|threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool")
                .install(|| run(&problem))
        })
        .to_vec();
    assert_eq!(runs[0], runs[1]);
    assert_eq!(runs[0], runs[2]);
}

#[test]
fn a_mirrored_table_gives_the_mirrored_field() {
    let one = lively(256 * 256);
    let mut other = one.clone();
    for body in &mut other.bodies {
        let mirror = |p: DVec2| DVec2::new(TABLE.width - p.x, p.y);
        let core: Vec<DVec2> = body.hull.core().iter().map(|&p| mirror(p)).collect();
        body.hull = Hull::new(&core, body.hull.radius()).expect("points");
        let origin = mirror(DVec2::ZERO);
        body.motion = RigidMotion {
            angle: -body.motion.angle,
            translation: mirror(body.motion.apply(origin)),
        };
    }
    let (one, other) = (run(&one), run(&other));
    let cols = one.grid.cols;
    for (row, mirrored) in one.q.data.chunks(cols).zip(other.q.data.chunks(cols)) {
        for (a, b) in row.iter().zip(mirrored.iter().rev()) {
            assert!((a - b).abs() < 1e-4 * a.abs().max(1.0), "{a} {b}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the hulls and motions (overlapping, degenerate, off the table, huge turns): all finite, and the
    /// fast stage conserves what it moves.
    #[test]
    fn no_plates_make_nan(
        bodies in proptest::collection::vec(
            (
                proptest::collection::vec((-20.0..200.0_f64, -20.0..120.0_f64), 1..7),
                0.0..12.0_f64,
                -3.2..3.2_f64,
                (-60.0..60.0_f64, -60.0..60.0_f64),
            ),
            0..6,
        ),
        rest in prop_oneof![Just(f64::INFINITY), 5.0..200.0_f64],
        exponent in 0.5..2.0_f64,
    ) {
        let bodies = bodies
            .into_iter()
            .map(|(points, radius, angle, by)| {
                let points: Vec<[f64; 2]> = points.into_iter().map(|(x, y)| [x, y]).collect();
                let centre = DVec2::from_array(points[0]) * KM;
                body(&points, radius * KM, turned(centre, angle, DVec2::new(by.0, by.1) * KM))
            })
            .collect();
        let mut problem = problem(96 * 96, bodies, rest * KM);
        problem.exponent = exponent;
        problem.rest_weight = (rest * KM).powf(-exponent);
        let field = run(&problem);
        prop_assert!(field.q.data.iter().all(|q| q.is_finite()));
        prop_assert!(field.east.iter().chain(&field.north).all(|v| v.is_finite()));
        let report = field.report;
        prop_assert!((report.volume - report.preimage_area).abs() < 1e-5 * TABLE.area() / 1e6 * (1.0 + report.q_max.abs()));
    }
}
