//! The TIN: node counts, areas, Delaunay property, errors, determinism.

use glam::DVec2;
use orogen::terrain::{Border, MIN_POISSON_NODES, NodeId, Tin, TinError};
use orogen::units::{Extent, KM};
use proptest::prelude::*;

const SQUARE: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};

const TABLE: Extent = Extent {
    width: 177_777.0,
    height: 100.0 * KM,
};

#[test]
fn poisson_gives_exactly_the_requested_nodes_and_covers_the_land() {
    for (extent, nodes) in [
        (SQUARE, 16),
        (SQUARE, 17),
        (SQUARE, 40),
        (TABLE, 100),
        (SQUARE, 1000),
        (TABLE, 10_007),
        (
            Extent {
                width: 500.0 * KM,
                height: 1.0 * KM,
            },
            16,
        ),
        (
            Extent {
                width: 0.5,
                height: 3.0,
            },
            333,
        ),
    ] {
        let tin = Tin::poisson(extent, nodes, 3).unwrap();
        assert_eq!(tin.len(), nodes);
        tin.sanity_check().unwrap();
        let covered: f64 = tin
            .triangles()
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| tin.positions()[k as usize]);
                0.5 * (b - a).perp_dot(c - a)
            })
            .sum();
        assert!(
            (covered / extent.area() - 1.0).abs() < 1e-12,
            "{extent:?} {nodes}: {covered}"
        );
        for (p, &border) in tin.positions().iter().zip(tin.border()) {
            let on_side = p.x == 0.0 || p.y == 0.0 || p.x == extent.width || p.y == extent.height;
            assert_eq!(on_side, border);
        }
    }
}

#[test]
fn poisson_spacing_is_even() {
    let nodes = 20_000;
    let tin = Tin::poisson(TABLE, nodes, 9).unwrap();
    let mut shortest = f64::INFINITY;
    let mut longest: f64 = 0.0;
    let (mut sum, mut count) = (0.0, 0);
    for i in tin.nodes() {
        for j in tin.neighbours(i).filter(|&j| i < j) {
            let d = tin.distance(i, j);
            shortest = shortest.min(d);
            if !(tin.is_border(i) && tin.is_border(j)) {
                longest = longest.max(d);
            }
            sum += d;
            count += 1;
        }
    }
    let mean = sum / f64::from(count);
    // A saturated sample has a mean edge of 1.333 r and no hole wider than 2 r.
    assert!(shortest > 0.70 * mean, "shortest {shortest} of mean {mean}");
    assert!(longest < 1.9 * mean, "longest {longest} of mean {mean}");
    let cell = TABLE.area() / nodes as f64;
    let inner = tin
        .areas()
        .iter()
        .zip(tin.border())
        .filter(|(_, border)| !**border);
    for (&area, _) in inner {
        assert!(
            area > 0.5 * cell && area < 2.2 * cell,
            "cell of {} mean areas",
            area / cell
        );
    }
}

/// Pair directions between a node and all nodes within a few spacings have no preferred axis: the amplitude of
/// harmonics 2, 4 and 8 of the direction histogram stays at the level of chance.
#[test]
fn poisson_has_no_preferred_direction() {
    let tin = Tin::poisson(SQUARE, 30_000, 5).unwrap();
    let mut sums = [(0.0, 0.0); 3];
    let mut count = 0.0;
    for i in tin.nodes().filter(|&i| !tin.is_border(i)) {
        for j in tin.neighbours(i).filter(|&j| i < j && !tin.is_border(j)) {
            let d = tin.position(j) - tin.position(i);
            let angle = d.y.atan2(d.x);
            for (sum, harmonic) in sums.iter_mut().zip([2.0, 4.0, 8.0]) {
                sum.0 += (harmonic * angle).cos();
                sum.1 += (harmonic * angle).sin();
            }
            count += 1.0;
        }
    }
    for (cos, sin) in sums {
        // The Rayleigh statistic is exponential with mean 1 for independent directions; links around a node
        // repel each other, so it stays below. 9 is a chance of 1e-4.
        let rayleigh = f64::hypot(cos, sin).powi(2) / count;
        assert!(rayleigh < 9.0, "Rayleigh statistic {rayleigh}");
    }
}

#[test]
fn poisson_is_a_pure_function_of_its_arguments() {
    let tin = Tin::poisson(TABLE, 3000, 11).unwrap();
    assert_eq!(tin, Tin::poisson(TABLE, 3000, 11).unwrap());
    assert_ne!(tin, Tin::poisson(TABLE, 3000, 12).unwrap());
}

#[test]
fn delaunay_circles_are_empty() {
    let tin = Tin::poisson(TABLE, 2000, 1).unwrap();
    for t in tin.triangles() {
        let [a, b, c] = t.map(|k| tin.positions()[k as usize]);
        for k in t.iter().flat_map(|&k| tin.neighbours(NodeId(k))) {
            if !t.contains(&k.0) {
                let [a, b, c] = [a, b, c].map(|q| q - tin.position(k));
                let in_circle = a.length_squared() * b.perp_dot(c)
                    + b.length_squared() * c.perp_dot(a)
                    + c.length_squared() * a.perp_dot(b);
                let scale = a.length_squared() * (b - a).perp_dot(c - a);
                assert!(in_circle <= 1e-9 * scale, "{k:?} lies in the circle of {t:?}");
            }
        }
    }
}

#[test]
fn nodes_near_in_the_plane_are_near_in_memory() {
    let tin = Tin::poisson(SQUARE, 10_000, 2).unwrap();
    let mut gaps: Vec<u32> = tin
        .nodes()
        .flat_map(|i| tin.neighbours(i).map(move |j| i.0.abs_diff(j.0)))
        .collect();
    gaps.sort_unstable();
    assert!(gaps[gaps.len() / 2] < 40, "median gap {}", gaps[gaps.len() / 2]);
}

#[test]
fn nodes_that_are_no_tin_are_refused_with_the_reason() {
    let unit = Extent {
        width: 1.0,
        height: 1.0,
    };
    let build = |nodes: &[(f64, f64)]| {
        let nodes: Vec<DVec2> = nodes.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        Tin::from_nodes(unit, &nodes, Border::Hull)
    };
    assert!(matches!(
        build(&[(0.0, 0.0), (1.0, 1.0)]),
        Err(TinError::TooFewNodes {
            found: 2,
            expected: 3
        })
    ));
    assert_eq!(
        build(&[(0.0, 0.0), (0.5, 0.5), (1.0, 1.0)]),
        Err(TinError::Collinear)
    );
    assert_eq!(
        build(&[(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (1.0, 0.0)]),
        Err(TinError::Coincident { first: 1, second: 3 })
    );
    assert_eq!(
        build(&[(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.5, 0.5 + 1e-12)]),
        Err(TinError::Coincident { first: 2, second: 3 })
    );
    assert!(matches!(
        build(&[(0.0, 0.0), (1.0, 0.0), (0.5, f64::NAN)]),
        Err(TinError::BadCoordinate { index: 2, .. })
    ));
    assert!(matches!(
        build(&[(0.0, 0.0), (1.5, 0.0), (0.5, 0.5)]),
        Err(TinError::OutsideExtent { index: 1, .. })
    ));
    let nodes = [DVec2::ZERO, DVec2::X, DVec2::Y];
    assert_eq!(
        Tin::from_nodes(unit, &nodes, Border::Flags(&[true])),
        Err(TinError::BorderLength {
            found: 1,
            expected: 3
        })
    );
    assert_eq!(
        Tin::from_nodes(unit, &nodes, Border::Flags(&[false; 3])),
        Err(TinError::NoBorder)
    );
    assert!(matches!(
        Tin::from_nodes(
            Extent {
                width: 0.0,
                height: 1.0
            },
            &nodes,
            Border::Hull
        ),
        Err(TinError::BadExtent { .. })
    ));
    assert!(matches!(
        Tin::poisson(unit, MIN_POISSON_NODES - 1, 0),
        Err(TinError::TooFewNodes { .. })
    ));
    assert!(matches!(
        Tin::poisson(unit, usize::MAX, 0),
        Err(TinError::TooManyNodes { .. })
    ));
}

#[test]
fn one_triangle_splits_its_land_between_its_corners() {
    let unit = Extent {
        width: 1.0,
        height: 1.0,
    };
    let tin = Tin::from_nodes(unit, &[DVec2::ZERO, DVec2::X, DVec2::Y], Border::Hull).unwrap();
    tin.sanity_check().unwrap();
    // The bisectors cross in the middle; the corner at (1, 1), which has no node, is split between the other two.
    assert_eq!(tin.areas(), [0.25, 0.375, 0.375]);
    assert_eq!(tin.triangles(), [[0, 1, 2]]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_nodes_make_a_sane_tin_or_an_error(
        points in prop::collection::vec((0.0..=1.0_f64, 0.0..=2.0_f64), 3..200),
        grid in 1_u32..2000,
    ) {
        // Snapped to a coarse grid, many points share lines, circles and places.
        let nodes: Vec<DVec2> = points
            .iter()
            .map(|&(x, y)| (DVec2::new(x, y) * f64::from(grid)).round() / f64::from(grid))
            .collect();
        let extent = Extent { width: 1.0, height: 2.0 };
        match Tin::from_nodes(extent, &nodes, Border::Hull) {
            Ok(tin) => prop_assert_eq!(tin.sanity_check(), Ok(())),
            Err(TinError::Coincident { first, second }) => prop_assert_eq!(nodes[first], nodes[second]),
            Err(TinError::Collinear) => {
                let area = |k: usize| (nodes[k] - nodes[0]).perp_dot(nodes[1] - nodes[0]);
                prop_assert!((0..nodes.len()).all(|k| area(k).abs() < 1e-12));
            }
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}
