//! Sediment: volumes, the steady state of the plain law, lakes that fill, fans, broken input.

use glam::DVec2;
use orogen::terrain::{
    Border, Deposition, Edges, Erosion, ErosionParams, Forcing, NodeId, Sediment, StartLand, StepSums, Tin,
};
use orogen::units::{Extent, KM};
use proptest::prelude::*;

const SQUARE: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};

const UPLIFT: f64 = 5e-4;

fn params(settling: f64) -> ErosionParams {
    ErosionParams {
        k: 1.1e-6,
        deposition: Some(Deposition {
            settling,
            ..Deposition::default()
        }),
        ..ErosionParams::default()
    }
}

fn rivers_only(settling: f64) -> ErosionParams {
    ErosionParams {
        landslides: false,
        ..params(settling)
    }
}

fn volume(tin: &Tin, depth: impl Fn(usize) -> f64) -> f64 {
    (0..tin.len()).map(|i| tin.areas()[i] * depth(i)).sum()
}

/// A step whose volumes are checked: what the heights changed by, and where all that was taken is.
fn step(
    tin: &Tin,
    (z, sediment, erosion): (&mut [f64], &mut Sediment, &mut Erosion),
    forcing: &Forcing<'_>,
    params: &ErosionParams,
    dt_yr: f64,
) -> StepSums {
    let (before, debris) = (z.to_vec(), sediment.debris.iter().sum::<f64>());
    let sums = erosion.step_with_sediment(tin, z, sediment, forcing, params, dt_yr);
    let StepSums {
        uplifted_m3,
        fluvial_m3,
        landslide_m3,
        deposited_m3,
        exported_m3,
        base_level_m3,
        ..
    } = sums;
    let scale = volume(tin, |i| (z[i] - before[i]).abs()) + fluvial_m3 + landslide_m3 + 1e-3 * SQUARE.area();
    let changed = volume(tin, |i| z[i] - before[i]);
    let balance = uplifted_m3 - fluvial_m3 - landslide_m3 + deposited_m3 + base_level_m3;
    assert!(
        (changed - balance).abs() < 1e-11 * scale,
        "{changed} and {balance}"
    );
    let stored = sediment.debris.iter().sum::<f64>() - debris;
    let gone = fluvial_m3 + landslide_m3 - deposited_m3 - exported_m3 - stored;
    assert!(gone.abs() < 1e-11 * scale, "{gone} of {scale} is nowhere");
    for part in [fluvial_m3, landslide_m3, deposited_m3, exported_m3] {
        assert!(part >= 0.0);
    }
    assert!(
        sediment
            .thickness
            .iter()
            .chain(&sediment.debris)
            .all(|&s| s >= 0.0 && s.is_finite())
    );
    sums
}

#[test]
fn the_law_is_checked() {
    assert_eq!(params(0.7).check(), Ok(()));
    assert!(
        params(-1.0)
            .check()
            .unwrap_err()
            .to_string()
            .starts_with("settling is -1")
    );
    assert!(params(f64::NAN).check().is_err());
    let curved = ErosionParams {
        n: 1.5,
        ..params(1.0)
    };
    let error = curved.check().unwrap_err().to_string();
    assert_eq!(error, "n, with deposition, is 1.5 : expected 1 to 1");
}

#[test]
fn without_the_law_the_step_is_the_plain_one_to_the_bit() {
    let tin = Tin::poisson(SQUARE, 2000, 3).unwrap();
    let uplift = vec![UPLIFT; tin.len()];
    let forcing = Forcing::uplift(&uplift);
    let (mut plain, mut kept) = (StartLand::new(1).heights(&tin), StartLand::new(1).heights(&tin));
    let mut sediment = Sediment::new(tin.len());
    sediment.thickness.fill(3.0);
    let curved = ErosionParams {
        n: 1.3,
        ..params(1.0)
    };
    for off in [ErosionParams::default(), curved] {
        let sums = Erosion::new(&tin).step(&tin, &mut plain, &forcing, &off, 1e5);
        let same = Erosion::new(&tin).step_with_sediment(&tin, &mut kept, &mut sediment, &forcing, &off, 1e5);
        assert_eq!(sums, same);
        assert_eq!(plain, kept);
        assert_eq!(sediment, Sediment::new(tin.len()));
        assert_eq!((sums.deposited_m3, sums.exported_m3), (0.0, 0.0));
    }
}

/// A cone with notches, which drains everywhere.
fn cone(tin: &Tin) -> Vec<f64> {
    let middle = 0.5 * SQUARE.size();
    let height =
        |p: &DVec2| 0.02 * (55e3 - p.distance(middle)) + 30.0 * (p.x / 2e3).sin() * (p.y / 2.6e3).cos();
    tin.positions().iter().map(height).collect()
}

#[test]
fn rivers_that_lay_nothing_down_are_those_of_the_plain_law() {
    let tin = Tin::poisson(SQUARE, 3000, 5).unwrap();
    let rate = |p: &DVec2| UPLIFT * (1.0 + 0.5 * (p.x / 20e3).sin());
    let uplift: Vec<f64> = tin.positions().iter().map(rate).collect();
    let forcing = Forcing::uplift(&uplift);
    let (mut plain, mut shared) = (cone(&tin), cone(&tin));
    let (mut a, mut b) = (Erosion::new(&tin), Erosion::new(&tin));
    let mut sediment = Sediment::new(tin.len());
    for _ in 0..5 {
        a.step(&tin, &mut plain, &forcing, &rivers_only(0.0), 1e5);
    }
    // Carved, it has no pits left.
    shared.copy_from_slice(&plain);
    for _ in 0..40 {
        let before = a.step(&tin, &mut plain, &forcing, &rivers_only(0.0), 1e5);
        let sums = step(
            &tin,
            (&mut shared, &mut sediment, &mut b),
            &forcing,
            &rivers_only(0.0),
            1e5,
        );
        assert_eq!((before.lakes, sums.lakes), (0, 0));
        assert!((sums.exported_m3 / before.fluvial_m3 - 1.0).abs() < 1e-9);
    }
    for (a, b) in plain.iter().zip(&shared) {
        assert!((a - b).abs() < 1e-9, "{a} and {b}");
    }
}

#[test]
fn the_steady_land_is_that_of_the_plain_law_for_any_settling() {
    let tin = Tin::poisson(SQUARE, 400, 6).unwrap();
    let uplift = vec![UPLIFT; tin.len()];
    for (settling, dt) in [(0.0, 1e6), (0.7, 1e6), (1.0, 1e7), (5.0, 1e6)] {
        let params = rivers_only(settling);
        let mut z = cone(&tin);
        let (mut erosion, mut sediment) = (Erosion::new(&tin), Sediment::new(tin.len()));
        let mut sums = StepSums::default();
        for _ in 0..(1e9 / dt) as usize {
            let land = (&mut z[..], &mut sediment, &mut erosion);
            sums = step(&tin, land, &Forcing::uplift(&uplift), &params, dt);
        }
        assert!(
            (sums.exported_m3 / sums.uplifted_m3 - 1.0).abs() < 1e-6,
            "G {settling}: {sums:?}"
        );
        for node in tin.nodes() {
            if let Some(receiver) = erosion.flow().receiver(node) {
                let i = node.index();
                let expected =
                    tin.distance(node, receiver) * UPLIFT / params.k / erosion.drainage()[i].sqrt();
                let found = z[i] - z[receiver.index()];
                assert!(
                    (found / expected - 1.0).abs() < 1e-6,
                    "G {settling}: {found} for {expected}"
                );
            }
        }
    }
}

#[test]
fn a_lake_becomes_a_plain_and_then_lets_all_sediment_pass() {
    // A bowl within a ring of hills that are low in the east; nothing rises.
    let tin = Tin::poisson(SQUARE, 3000, 7).unwrap();
    let middle = 0.5 * SQUARE.size();
    let height = |p: &DVec2| {
        let (from, r) = (*p - middle, p.distance(middle) / KM);
        let ring = 1.0 - 0.9 * (-(from.y.atan2(from.x) / 0.3).powi(2)).exp();
        let hills = 400.0 * ring * ((1.0 - (r - 35.0).abs() / 15.0).max(0.0));
        100.0 + hills - 10.0 * (20.0 - r).max(0.0)
    };
    let start: Vec<f64> = tin.positions().iter().map(height).collect();
    let mut z = start.clone();
    let still = vec![0.0; tin.len()];
    let (mut erosion, mut sediment) = (Erosion::new(&tin), Sediment::new(tin.len()));
    let mut first = StepSums::default();
    let mut last = first;
    for k in 0..400 {
        let land = (&mut z[..], &mut sediment, &mut erosion);
        last = step(&tin, land, &Forcing::uplift(&still), &params(1.0), 5e4);
        if k == 0 {
            first = last;
        }
    }
    assert_eq!(first.lakes, 1);
    // The outer slopes send theirs over the border.
    assert!(
        first.deposited_m3 > 0.25 * (first.fluvial_m3 + first.landslide_m3),
        "{first:?}"
    );
    assert_eq!(last.lakes, 0);
    assert!(last.exported_m3 > 0.9 * (last.fluvial_m3 + last.landslide_m3));
    let core: Vec<NodeId> = (tin.nodes())
        .filter(|&node| tin.position(node).distance(middle) < 10.0 * KM)
        .collect();
    let ground = |node: &NodeId| z[node.index()];
    let (low, high) = core
        .iter()
        .map(ground)
        .fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
    assert!(
        low > start[core[0].index()] && high - low < 120.0,
        "{low} to {high} m"
    );
    assert!(core.iter().all(|node| sediment.thickness[node.index()] > 10.0));
}

#[test]
fn a_fan_grows_where_a_steep_river_meets_a_plain() {
    // Mountains that rise in the west, a plain that does not in the east.
    let tin = Tin::poisson(SQUARE, 4000, 8).unwrap();
    let uplift: Vec<f64> = tin
        .positions()
        .iter()
        .map(|p| if p.x < 40e3 { 1e-3 } else { 0.0 })
        .collect();
    let mut z: Vec<f64> = (StartLand::new(2).heights(&tin).iter().zip(tin.positions()))
        .map(|(noise, p)| 0.1 * noise + 1e-3 * (100e3 - p.x))
        .collect();
    let (mut erosion, mut sediment) = (Erosion::new(&tin), Sediment::new(tin.len()));
    for _ in 0..60 {
        let land = (&mut z[..], &mut sediment, &mut erosion);
        step(&tin, land, &Forcing::uplift(&uplift), &params(1.0), 5e4);
    }
    let mean = |from: f64, to: f64| {
        let inside = |i: &usize| (from..to).contains(&(tin.positions()[*i].x / KM));
        let (area, cover) = (0..tin.len())
            .filter(inside)
            .fold((0.0, 0.0), |(area, cover), i| {
                (
                    area + tin.areas()[i],
                    cover + tin.areas()[i] * sediment.thickness[i],
                )
            });
        cover / area
    };
    let (mountains, front, far) = (mean(10.0, 38.0), mean(40.0, 55.0), mean(80.0, 95.0));
    assert!(
        front > 5.0 * mountains && front > 20.0,
        "{mountains}, {front}, {far} m"
    );
    assert!(front > 1.5 * far, "{mountains}, {front}, {far} m");
}

#[test]
fn protected_ground_lets_sediment_pass_and_hard_rock_stays_steeper() {
    let tin = Tin::poisson(SQUARE, 2000, 9).unwrap();
    let uplift = vec![UPLIFT; tin.len()];
    let half = |low: f64, high: f64| -> Vec<f64> {
        (tin.positions()
            .iter()
            .map(|p| if p.y < 50e3 { low } else { high }))
        .collect()
    };
    let (protect, hard, rain) = (half(0.0, 1.0), half(1.0, 0.4), half(1.0, 0.0));
    let run = |forcing: &Forcing<'_>| {
        let mut z = cone(&tin);
        let (mut erosion, mut sediment) = (Erosion::new(&tin), Sediment::new(tin.len()));
        for _ in 0..60 {
            step(
                &tin,
                (&mut z, &mut sediment, &mut erosion),
                forcing,
                &rivers_only(1.0),
                1e5,
            );
        }
        z
    };
    let plain = Forcing::uplift(&uplift);
    let guarded = run(&Forcing {
        protect: Some(&protect),
        ..plain
    });
    let start = cone(&tin);
    for node in tin.nodes().filter(|&node| !tin.is_border(node)) {
        let i = node.index();
        let lake = guarded[i] > start[i] + 60.0 * 50.0 + 1e-6;
        assert!(protect[i] == 0.0 || lake || (guarded[i] - start[i] - 3000.0).abs() < 1e-6);
    }
    let north = |z: &[f64]| volume(&tin, |i| if tin.positions()[i].y > 50e3 { z[i] } else { 0.0 });
    let even = run(&plain);
    let harder = run(&Forcing {
        erodibility: Some(&hard),
        ..plain
    });
    let drier = run(&Forcing {
        rain: Some(&rain),
        ..plain
    });
    assert!(north(&harder) > 1.1 * north(&even));
    assert!(north(&drier) > 1.1 * north(&even) && drier.iter().all(|z| z.is_finite()));
}

#[test]
fn heights_that_are_no_numbers_do_no_harm() {
    let tin = Tin::poisson(SQUARE, 500, 10).unwrap();
    let uplift = vec![UPLIFT; tin.len()];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut z = StartLand::new(1).heights(&tin);
        z[250] = bad;
        let (mut erosion, mut sediment) = (Erosion::new(&tin), Sediment::new(tin.len()));
        let sums = erosion.step_with_sediment(
            &tin,
            &mut z,
            &mut sediment,
            &Forcing::uplift(&uplift),
            &params(1.0),
            1e5,
        );
        assert!(sums.not_finite > 0);
        erosion.flow().sanity_check(&tin).unwrap();
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let tin = Tin::poisson(SQUARE, 150_000, 13).unwrap();
    let uplift = vec![UPLIFT; tin.len()];
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut z = StartLand::new(1).heights(&tin);
            let (mut erosion, mut sediment) = (Erosion::new(&tin), Sediment::new(tin.len()));
            for _ in 0..4 {
                let land = (&mut z[..], &mut sediment, &mut erosion);
                step(&tin, land, &Forcing::uplift(&uplift), &params(1.0), 1e5);
            }
            (z, sediment)
        })
    };
    let one = run(1);
    assert!(one.1.thickness.iter().any(|&cover| cover > 0.0));
    for threads in [2, 7] {
        assert_eq!(run(threads), one);
    }
}

#[test]
fn one_river_has_the_closed_form() {
    // source → bed → outlet, in a line; the two equations solved by hand for one long step.
    let nodes = [
        DVec2::ZERO,
        DVec2::new(1000.0, 0.0),
        DVec2::new(2000.0, 0.0),
        DVec2::new(0.0, 900.0),
    ];
    let land = Extent {
        width: 2000.0,
        height: 900.0,
    };
    let tin = Tin::from_nodes(land, &nodes, Border::Flags(&[true, false, false, true])).unwrap();
    let params = ErosionParams {
        k: 1e-6,
        ..rivers_only(0.8)
    };
    let (start, dt) = ([0.0, 5.0, 400.0, 0.0], 2e5);
    let mut z = start;
    let mut sediment = Sediment::new(4);
    let still = [0.0; 4];
    let mut erosion = Erosion::new(&tin);
    step(
        &tin,
        (&mut z, &mut sediment, &mut erosion),
        &Forcing::uplift(&still),
        &params,
        dt,
    );
    assert_eq!(erosion.flow().receivers()[1..3], [NodeId(0), NodeId(1)]);
    let (kd, kt) = (1.8e-6, 1.8e-6 / 0.8);
    let area = tin.areas();
    let eroded = |i: usize| (start[i] - z[i]) / dt;
    let flux_above = area[2] * eroded(2);
    let flux_below = flux_above + area[1] * eroded(1);
    for (i, flux, drop, drainage) in [
        (2, flux_above, z[2] - z[1], area[2]),
        (1, flux_below, z[1], area[1] + area[2]),
    ] {
        let power = drainage.sqrt() * drop / 1000.0;
        let shared = eroded(i) / kd + flux / (kt * drainage);
        assert!(
            (shared / power - 1.0).abs() < 1e-9,
            "node {i}: {shared} for {power}"
        );
    }
    assert!(z[1] > 5.0, "the bed is filled: {}", z[1]);
    assert!((sediment.thickness[1] - (z[1] - 5.0)).abs() < 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn volumes_balance_on_any_land(
        seed in 0_u64..1000,
        nodes in 30_usize..600,
        settling in 0.0..10.0_f64,
        roughness in 0.0..2000.0_f64,
        uplift in -1e-3..2e-3_f64,
        tilt in -1.0..1.0_f64,
        log_dt in 2.0..7.0_f64,
        free in any::<bool>(),
        base in proptest::option::of(-300.0..300.0_f64),
    ) {
        let tin = Tin::poisson(SQUARE, nodes, seed).unwrap();
        let rates: Vec<f64> = tin
            .positions()
            .iter()
            .map(|p| uplift * (1.0 + tilt * (p.x / 15e3).sin() * (p.y / 11e3).cos()))
            .collect();
        let edges = if free { Edges::Free } else { Edges::Fixed };
        let params = ErosionParams { edges, base_level: base, ..params(settling) };
        let mut z: Vec<f64> = (0..nodes)
            .map(|i| roughness * ((seed as f64 + i as f64 * 12.9898).sin() * 43758.5453).fract())
            .collect();
        let (mut erosion, mut sediment) = (Erosion::new(&tin), Sediment::new(nodes));
        for _ in 0..8 {
            let land = (&mut z[..], &mut sediment, &mut erosion);
            let sums = step(&tin, land, &Forcing::uplift(&rates), &params, 10_f64.powf(log_dt));
            prop_assert_eq!(sums.not_finite, 0);
            if !erosion.flow().lakes().any() {
                continue;
            }
            let water = erosion.water_level(&z);
            for node in tin.nodes() {
                if let Some(receiver) = erosion.flow().receiver(node) {
                    prop_assert!(water[node.index()] >= water[receiver.index()]);
                }
            }
        }
    }
}
