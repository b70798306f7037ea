//! The floating crust on a network of nodes: volumes, roots, rebound, foreland.

use orogen::isostasy::{Crust, Isostasy, IsostasyParams};
use orogen::terrain::Tin;
use orogen::units::{Extent, KM};

const LAND: Extent = Extent {
    width: 177.8 * KM,
    height: 100.0 * KM,
};
const DT: f64 = 5e4;

fn land() -> Tin {
    Tin::poisson(LAND, 12_000, 2).expect("a rectangle")
}

/// A range along the south–north middle.
fn range(tin: &Tin) -> Vec<f64> {
    let middle = LAND.width / 2.0;
    tin.positions()
        .iter()
        .map(|p| 1e-3 * (-((p.x - middle) / 12e3).powi(2)).exp())
        .collect()
}

fn params(elastic_thickness: f64) -> IsostasyParams {
    IsostasyParams {
        elastic_thickness,
        margin: 0.0,
        ..IsostasyParams::default()
    }
}

fn volume(tin: &Tin, depth: &[f64]) -> f64 {
    tin.areas().iter().zip(depth).map(|(a, d)| a * d).sum()
}

#[test]
fn rock_on_the_plate_sinks_five_sixths_of_its_volume() {
    let tin = land();
    let thickening = range(&tin);
    let mut crust = Crust::new(tin.len());
    let mut uplift = vec![0.0; tin.len()];
    Isostasy::new(&tin, &params(10e3)).uplift(&mut crust, &thickening, &params(10e3), DT, &mut uplift);
    let (gained, sunk) = (DT * volume(&tin, &thickening), volume(&tin, &crust.root));
    // The grid keeps the volume to round-off; nodes sample it, smooth as it is.
    assert!((sunk / gained * 1.2 - 1.0).abs() < 2e-3, "{}", sunk / gained);
    for i in 0..tin.len() {
        assert!((uplift[i] - (thickening[i] - crust.root[i] / DT)).abs() < 1e-15);
    }
}

#[test]
fn a_range_rises_and_its_foreland_sinks() {
    let tin = land();
    let thickening = range(&tin);
    for elastic_thickness in [5e3, 10e3] {
        let params = params(elastic_thickness);
        let mut uplift = vec![0.0; tin.len()];
        Isostasy::new(&tin, &params).uplift(
            &mut Crust::new(tin.len()),
            &thickening,
            &params,
            DT,
            &mut uplift,
        );
        let mean_at = |from: f64, to: f64| {
            let inside: Vec<f64> = (tin.nodes().map(|node| (tin.position(node).x, node.index())))
                .filter(|(x, _)| (from..to).contains(&((x - LAND.width / 2.0).abs())))
                .map(|(_, i)| uplift[i])
                .collect();
            inside.iter().sum::<f64>() / inside.len() as f64
        };
        assert!(mean_at(0.0, 5e3) > 3e-4);
        let (near, far) = (mean_at(24e3, 32e3), mean_at(75e3, 88e3));
        assert!(near < 0.0 && near < far, "foredeep {near}, far away {far}");
    }
}

#[test]
fn erosion_rebounds_and_sediment_sinks() {
    let tin = land();
    let params = params(8e3);
    let mut isostasy = Isostasy::new(&tin, &params);
    let mut crust = Crust::new(tin.len());
    let still = vec![0.0; tin.len()];
    let before = vec![500.0; tin.len()];
    let after: Vec<f64> = (range(&tin).iter()).map(|rate| 500.0 - rate * 1e5).collect();
    crust.book(&before, &after, &still, DT);
    let mut uplift = vec![0.0; tin.len()];
    isostasy.uplift(&mut crust, &still, &params, DT, &mut uplift);
    let lost = volume(&tin, &before) - volume(&tin, &after);
    assert!((DT * volume(&tin, &uplift) / lost * 1.2 - 1.0).abs() < 2e-3);
    // Answered once, it is over.
    isostasy.uplift(&mut crust, &still, &params, DT, &mut uplift);
    assert!(uplift.iter().all(|&u| u == 0.0));
    crust.book(&after, &before, &still, DT);
    isostasy.uplift(&mut crust, &still, &params, DT, &mut uplift);
    assert!(volume(&tin, &uplift) < 0.0);
    assert!(crust.root.iter().all(|root| root.abs() < 1e-9), "there and back");
}

#[test]
fn the_boost_lifts_a_range_as_if_it_did_not_float() {
    let tin = land();
    let wavelength = LAND.width;
    let wave = |x: f64| 5e-4 * (std::f64::consts::TAU * x / wavelength).cos();
    let thickening: Vec<f64> = tin.positions().iter().map(|p| wave(p.x)).collect();
    let plain = params(10e3);
    let boosted = IsostasyParams {
        boost: 1.0 / plain.rise_share(wavelength),
        ..plain
    };
    assert!(boosted.boost > 1.5);
    let mut uplift = vec![0.0; tin.len()];
    let mut crust = Crust::new(tin.len());
    Isostasy::new(&tin, &plain).uplift(&mut crust, &thickening, &boosted, DT, &mut uplift);
    for (uplift, rate) in uplift.iter().zip(&thickening) {
        assert!((uplift - rate).abs() < 0.02 * 5e-4, "{uplift} for {rate}");
    }
}

#[test]
fn another_strength_is_taken_up_and_threads_change_nothing() {
    let tin = land();
    let thickening = range(&tin);
    let run = |start: f64| {
        let mut crust = Crust::new(tin.len());
        let mut uplift = vec![0.0; tin.len()];
        Isostasy::new(&tin, &params(start)).uplift(&mut crust, &thickening, &params(7e3), DT, &mut uplift);
        uplift
    };
    let expected = run(7e3);
    assert_eq!(run(30e3), expected);
    for threads in [1, 2, 7] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        assert_eq!(pool.install(|| run(7e3)), expected);
    }
}

#[test]
fn what_is_no_number_weighs_nothing() {
    let tin = land();
    let mut thickening = range(&tin);
    thickening[77] = f64::NAN;
    let mut crust = Crust::new(tin.len());
    crust.unanswered[5] = f64::INFINITY;
    let mut uplift = vec![0.0; tin.len()];
    Isostasy::new(&tin, &params(10e3)).uplift(&mut crust, &thickening, &params(10e3), DT, &mut uplift);
    assert!(
        crust
            .root
            .iter()
            .chain(&crust.unanswered)
            .all(|value| value.is_finite())
    );
    assert_eq!(uplift.iter().filter(|u| !u.is_finite()).count(), 1);
}

#[test]
fn crust_beyond_the_border_helps_to_carry_a_range() {
    let tin = land();
    let thickening = range(&tin);
    let sunk = |elastic_thickness: f64, margin: f64| {
        let params = IsostasyParams {
            margin,
            ..params(elastic_thickness)
        };
        let mut crust = Crust::new(tin.len());
        let mut uplift = vec![0.0; tin.len()];
        Isostasy::new(&tin, &params).uplift(&mut crust, &thickening, &params, DT, &mut uplift);
        volume(&tin, &crust.root)
    };
    assert!(sunk(20e3, 0.5) < 0.8 * sunk(20e3, 0.0));
    assert!(sunk(20e3, 0.5) > 0.3 * sunk(20e3, 0.0));
    // Columns that float alone have nobody to lean on.
    assert!((sunk(0.0, 0.5) / sunk(0.0, 0.0) - 1.0).abs() < 0.05);
}
