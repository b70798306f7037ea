//! Lands as a whole: what a smaller time step changes, and the statistics of developed lands next to real ones.

use orogen::terrain::{Erosion, ErosionParams, Forcing, StartLand, Tin};
use orogen::units::{Extent, KM};

const SQUARE: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};

const UPLIFT: f64 = 5e-4;

/// Rivers alone, with the paper's constants.
fn rivers() -> ErosionParams {
    ErosionParams {
        k: 5.5e-7,
        landslides: false,
        ..ErosionParams::default()
    }
}

fn evolve(tin: &Tin, dt_yr: f64, years: f64) -> (Vec<f64>, Erosion) {
    let mut z = StartLand::new(1).heights(tin);
    let uplift = vec![UPLIFT; tin.len()];
    let mut erosion = Erosion::new(tin);
    for _ in 0..(years / dt_yr).round() as usize {
        erosion.step(tin, &mut z, &Forcing::uplift(&uplift), &rivers(), dt_yr);
    }
    (z, erosion)
}

#[test]
fn shorter_steps_converge() {
    let tin = Tin::poisson(SQUARE, 5000, 1).unwrap();
    let (fine, _) = evolve(&tin, 1e4, 5e6);
    let rms = |dt_yr: f64| {
        let (z, _) = evolve(&tin, dt_yr, 5e6);
        let squares: f64 = z.iter().zip(&fine).map(|(a, b)| (a - b).powi(2)).sum();
        (squares / tin.len() as f64).sqrt()
    };
    let errors = [1e6, 2.5e5, 1e5, 5e4, 2e4].map(rms);
    for pair in errors.windows(2) {
        assert!(pair[1] < 0.9 * pair[0], "rms by step, m: {errors:?}");
    }
    // Another engine, on 10,000 nodes from noise, differs by 440, 322 and 203 m at the first three. None of the land is
    // steady after 5 My, and where rivers flip first depends on the step, so that convergence is slow.
    assert!((100.0..440.0).contains(&errors[0]), "rms by step, m: {errors:?}");
    assert!((40.0..203.0).contains(&errors[2]), "rms by step, m: {errors:?}");
}

/// Slope of the straight line through points, by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mean_x, mean_y) = points
        .iter()
        .fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let covariance: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let variance: f64 = points.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    covariance / variance
}

#[test]
fn developed_land_has_the_statistics_of_real_land() {
    let tin = Tin::poisson(SQUARE, 10_000, 1).unwrap();
    let (z, erosion) = evolve(&tin, 2.5e5, 5e7);
    let flow = erosion.flow();
    // Of each river, the longest way up to a divide.
    let mut length = vec![0.0_f64; tin.len()];
    for &node in flow.order().iter().rev() {
        if let Some(receiver) = flow.receiver(node) {
            let through = length[node.index()] + tin.distance(node, receiver);
            length[receiver.index()] = length[receiver.index()].max(through);
        }
    }
    let (mut lengths, mut slopes) = (Vec::new(), Vec::new());
    for node in tin.nodes() {
        let area = flow.drainage()[node.index()];
        if let Some(receiver) = flow.receiver(node).filter(|_| area > 20e6) {
            lengths.push((area.ln(), length[node.index()].ln()));
            let drop = z[node.index()] - z[receiver.index()];
            // Heights are those after the step that followed the routing: here and there a river has just moved.
            if drop > 0.0 {
                slopes.push((area.ln(), (drop / tin.distance(node, receiver)).ln()));
            }
        }
    }
    assert!(lengths.len() > 500 && slopes.len() > lengths.len() * 9 / 10);
    // Hack (1957): rivers lengthen as the 0.6th power of their area; 0.5 would be drainage basins of one shape, optimal
    // channel networks have 0.57, and another engine with the same setting 0.595.
    let hack = slope(&lengths);
    assert!((0.52..0.62).contains(&hack), "Hack's exponent {hack}");
    // Real rivers 0.4–0.6; the law's m/n is 0.5.
    let concavity = -slope(&slopes);
    assert!((0.4..0.6).contains(&concavity), "concavity {concavity}");
    // Strahler (1952): 0.35–0.6 where land is mature, less where it is old; another engine 0.367.
    let highest = z.iter().copied().fold(0.0, f64::max);
    let mean = z.iter().zip(tin.areas()).map(|(z, a)| z * a).sum::<f64>() / SQUARE.area();
    let integral = mean / highest;
    assert!((0.3..0.6).contains(&integral), "hypsometric integral {integral}");
}
