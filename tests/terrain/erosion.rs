//! Whole erosion steps: mass, bounds, isotropy, talus, edges, determinism, broken input.

use glam::DVec2;
use orogen::terrain::{
    Border, Edges, Erosion, ErosionParams, Forcing, Landslides, StartLand, StepSums, Tin, priority_flood,
};
use orogen::units::{Extent, KM};

const SQUARE: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};

const UPLIFT: f64 = 5e-4;

/// The paper's constants.
fn paper() -> ErosionParams {
    ErosionParams {
        k: 5.5e-7,
        ..ErosionParams::default()
    }
}

fn without_slides() -> ErosionParams {
    ErosionParams {
        landslides: false,
        ..paper()
    }
}

/// `steps` steps of `dt_yr` under uniform uplift from the start land.
fn evolve(tin: &Tin, params: &ErosionParams, dt_yr: f64, steps: usize) -> (Vec<f64>, Erosion, StepSums) {
    let mut z = StartLand::new(1).heights(tin);
    let uplift = vec![UPLIFT; tin.len()];
    let mut erosion = Erosion::new(tin);
    let mut sums = StepSums::default();
    for _ in 0..steps {
        sums = erosion.step(tin, &mut z, &Forcing::uplift(&uplift), params, dt_yr);
    }
    (z, erosion, sums)
}

#[test]
fn defaults_are_within_their_bounds_and_others_are_refused() {
    assert_eq!(ErosionParams::default().check(), Ok(()));
    assert!((ErosionParams::default().talus.atan().to_degrees() - 30.0).abs() < 1e-12);
    let bad = |change: fn(&mut ErosionParams)| {
        let mut params = ErosionParams::default();
        change(&mut params);
        params.check().unwrap_err().to_string()
    };
    assert_eq!(bad(|p| p.k = -1.0), "k is -1 1/yr: expected 0 to 0.01");
    assert!(bad(|p| p.n = f64::NAN).starts_with("n is NaN"));
    assert!(bad(|p| p.base_level = Some(1e9)).starts_with("base_level is"));
}

#[test]
fn volumes_balance_and_heights_stay_within_bounds() {
    let tin = Tin::poisson(SQUARE, 4000, 3).unwrap();
    let uplift: Vec<f64> = tin
        .positions()
        .iter()
        .map(|p| UPLIFT * (p.x / 15e3).sin())
        .collect();
    let erodibility: Vec<f64> = tin
        .positions()
        .iter()
        .map(|p| 1.0 + 0.5 * (p.y / 9e3).cos())
        .collect();
    let protect: Vec<f64> = tin
        .positions()
        .iter()
        .map(|p| f64::from(u8::from(p.y < 20e3)))
        .collect();
    let rain = vec![0.7; tin.len()];
    let forcing = Forcing {
        uplift: &uplift,
        erodibility: Some(&erodibility),
        talus: None,
        rain: Some(&rain),
        protect: Some(&protect),
    };
    for params in [
        paper(),
        ErosionParams {
            edges: Edges::Free,
            ..paper()
        },
        ErosionParams {
            edges: Edges::Free,
            base_level: Some(-200.0),
            ..paper()
        },
        ErosionParams {
            base_level: Some(-50.0),
            n: 1.6,
            m: 0.8,
            k: 1e-7,
            ..paper()
        },
    ] {
        let mut z = StartLand::new(4).heights(&tin);
        let mut erosion = Erosion::new(&tin);
        let mut lakes = 0;
        for step in 0..40 {
            let before = z.clone();
            let sums = erosion.step(&tin, &mut z, &forcing, &params, 1e5);
            lakes = lakes.max(sums.lakes);
            erosion.flow().sanity_check(&tin).unwrap();
            let changes = || {
                tin.areas()
                    .iter()
                    .zip(z.iter().zip(&before))
                    .map(|(a, (new, old))| a * (new - old))
            };
            let StepSums {
                uplifted_m3,
                fluvial_m3,
                landslide_m3,
                base_level_m3,
                not_finite,
                ..
            } = sums;
            let balance = uplifted_m3 - fluvial_m3 - landslide_m3 + base_level_m3;
            // Each height carries its own round-off, about 1e-13 m, next to changes of some metres.
            let scale: f64 = changes().map(f64::abs).sum::<f64>() + 1e-3 * SQUARE.area();
            assert!(
                (changes().sum::<f64>() - balance).abs() < 1e-12 * scale,
                "step {step}"
            );
            assert!(fluvial_m3 >= 0.0 && landslide_m3 >= 0.0);
            assert_eq!(not_finite, 0);
            let water = erosion.water_level(&z);
            for node in tin.nodes() {
                let i = node.index();
                let risen = before[i] + 1e5 * uplift[i];
                let set_to_base = params.edges == Edges::Fixed && tin.is_border(node);
                assert!(z[i] <= risen + 1e-9 || set_to_base, "erosion only lowers");
                assert!(water[i] >= z[i]);
                if protect[i] == 1.0 && !tin.is_border(node) {
                    assert!((z[i] - risen).abs() < 1e-9);
                }
                if let Some(receiver) = erosion.flow().receiver(node) {
                    assert!(water[i] >= water[receiver.index()], "water flows down");
                }
            }
        }
        assert!(lakes > 0, "the subsiding bands hold lakes");
    }
}

#[test]
fn fixed_edges_hold_and_base_level_sets_them() {
    let tin = Tin::poisson(SQUARE, 1000, 3).unwrap();
    let start = StartLand::new(1).heights(&tin);
    let (held, ..) = evolve(&tin, &paper(), 1e5, 5);
    let set = ErosionParams {
        base_level: Some(12.5),
        ..paper()
    };
    let (set, ..) = evolve(&tin, &set, 1e5, 5);
    for node in tin.nodes().filter(|&node| tin.is_border(node)) {
        assert_eq!(held[node.index()], start[node.index()]);
        assert_eq!(set[node.index()], 12.5);
    }
}

#[test]
fn free_edges_rise_and_a_base_level_cuts_them_down() {
    let tin = Tin::poisson(SQUARE, 1000, 3).unwrap();
    let border_mean = |z: &[f64]| {
        let border: Vec<f64> = tin
            .nodes()
            .filter(|&node| tin.is_border(node))
            .map(|node| z[node.index()])
            .collect();
        border.iter().sum::<f64>() / border.len() as f64
    };
    let free = ErosionParams {
        edges: Edges::Free,
        ..paper()
    };
    let (z, erosion, _) = evolve(&tin, &free, 1e5, 50);
    assert!(border_mean(&z) > 0.9 * UPLIFT * 5e6);
    assert!(tin.nodes().any(|node| erosion.flow().receiver(node).is_none()));
    let cut = ErosionParams {
        base_level: Some(0.0),
        ..free
    };
    let (lower, ..) = evolve(&tin, &cut, 1e5, 50);
    assert!(border_mean(&lower) < 0.7 * border_mean(&z));
}

#[test]
fn steady_land_erodes_as_fast_as_it_rises() {
    let tin = Tin::poisson(SQUARE, 2000, 5).unwrap();
    let (z, _, sums) = evolve(&tin, &without_slides(), 1e6, 300);
    assert!(
        (sums.fluvial_m3 / sums.uplifted_m3 - 1.0).abs() < 0.02,
        "{sums:?}"
    );
    let highest = z.iter().copied().fold(0.0, f64::max);
    assert!((3000.0..9000.0).contains(&highest), "{highest} m");
    // Mature land: hypsometric integral 0.35–0.6 in nature, 0.37 for the same model elsewhere.
    let mean = z.iter().zip(tin.areas()).map(|(z, a)| z * a).sum::<f64>() / SQUARE.area();
    assert!(
        (0.28..0.6).contains(&(mean / highest)),
        "hypsometric integral {}",
        mean / highest
    );
}

#[test]
fn developed_land_does_not_flicker_more_than_its_peers() {
    let tin = Tin::poisson(SQUARE, 5000, 6).unwrap();
    let (mut z, mut erosion, _) = evolve(&tin, &without_slides(), 4e5, 100);
    let uplift = vec![UPLIFT; tin.len()];
    let mut flicker = Vec::new();
    for _ in 0..40 {
        let before = z.clone();
        erosion.step(&tin, &mut z, &Forcing::uplift(&uplift), &without_slides(), 1e5);
        flicker.push(
            before
                .iter()
                .zip(&z)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max),
        );
    }
    flicker.sort_by(f64::total_cmp);
    // Elsewhere 63 m, median of the largest change per step at dt = 1e5 yr and 10,000 nodes.
    assert!(flicker[20] < 120.0, "median flicker {} m", flicker[20]);
}

#[test]
fn talus_makes_the_relief_independent_of_the_spacing_of_nodes() {
    let relief = |nodes: usize, params: &ErosionParams| {
        let tin = Tin::poisson(SQUARE, nodes, 7).unwrap();
        // Strong uplift, so that the talus matters at these spacings.
        let uplift = vec![4.0 * UPLIFT; tin.len()];
        let mut z = vec![0.0; tin.len()];
        let noise = StartLand::new(2).heights(&tin);
        z.iter_mut().zip(noise).for_each(|(z, noise)| *z += noise);
        let mut erosion = Erosion::new(&tin);
        for _ in 0..120 {
            erosion.step(&tin, &mut z, &Forcing::uplift(&uplift), params, 1e6);
        }
        z.iter().zip(tin.areas()).map(|(z, a)| z * a).sum::<f64>() / SQUARE.area()
    };
    let growth = |params: &ErosionParams| relief(8000, params) - relief(2000, params);
    let (with, without) = (growth(&paper()), growth(&without_slides()));
    assert!(
        with < 0.5 * without,
        "mean height grows by {with} m with talus, {without} m without"
    );
}

#[test]
fn slopes_fall_to_the_talus_from_above() {
    let tin = Tin::poisson(SQUARE, 3000, 9).unwrap();
    let middle = 0.5 * SQUARE.size();
    let (talus, reach) = (0.6, 3000.0);
    let mut z: Vec<f64> = tin
        .positions()
        .iter()
        .map(|p| 60e3 - 1.5 * p.distance(middle))
        .collect();
    let border = tin.border().to_vec();
    let mut slides = Landslides::default();
    let steepest = |z: &[f64], i: usize| {
        tin.links(orogen::terrain::NodeId::new(i))
            .iter()
            .map(|link| (z[i] - z[link.to.index()]) * f64::from(link.inverse_distance))
            .fold(f64::NEG_INFINITY, f64::max)
    };
    let mut worst = 0.0;
    for _ in 0..80 {
        let before = z.clone();
        let slide_reach = |i: usize| if border[i] { 0.0 } else { reach };
        slides.step(
            &tin,
            &mut z,
            |_| talus,
            slide_reach,
            |i, below, depth| {
                assert!(depth > 0.0 && !border[i] && below != i);
            },
        );
        let mut excess: f64 = 0.0;
        for i in (0..z.len()).filter(|&i| !border[i]) {
            if steepest(&before, i) > talus {
                assert!(
                    steepest(&z, i) > talus - 1e-5,
                    "undershoot to {}",
                    steepest(&z, i)
                );
            } else {
                assert_eq!(z[i], before[i]);
            }
            excess = excess.max(steepest(&z, i) - talus);
        }
        worst = excess;
    }
    assert!(worst < 0.01, "{worst} above the talus after 80 steps");
}

#[test]
fn one_slide_has_the_closed_form() {
    // One free node over one held node: the excess over the talus shrinks by 1 + l Δt / r.
    let nodes = [DVec2::ZERO, DVec2::new(1000.0, 0.0), DVec2::new(0.0, 5000.0)];
    let land = Extent {
        width: 1000.0,
        height: 5000.0,
    };
    let tin = Tin::from_nodes(land, &nodes, Border::Flags(&[true, false, true])).unwrap();
    let mut z = [0.0, 2000.0, 0.0];
    let uplift = [0.0; 3];
    let params = ErosionParams {
        k: 0.0,
        talus: 0.5,
        ..ErosionParams::default()
    };
    let sums = Erosion::new(&tin).step(&tin, &mut z, &Forcing::uplift(&uplift), &params, 1e6);
    assert!((z[1] - (500.0 + 1500.0 / 11.0)).abs() < 1e-9, "{}", z[1]);
    assert!((sums.landslide_m3 / (tin.areas()[1] * (2000.0 - z[1])) - 1.0).abs() < 1e-12);
    // A harder node of its own talus stands.
    let mut z = [0.0, 2000.0, 0.0];
    let talus = [0.5, 2.5, 0.5];
    let forcing = Forcing {
        talus: Some(&talus),
        ..Forcing::uplift(&uplift)
    };
    Erosion::new(&tin).step(&tin, &mut z, &forcing, &params, 1e6);
    assert_eq!(z[1], 2000.0);
}

/// A disc of nodes in a larger rectangle; its outer part is border, so that clipped cells lie there only.
fn disc(turn: f64, shift: DVec2) -> Tin {
    let middle = 0.5 * SQUARE.size();
    let sampled = Tin::poisson(SQUARE, 4000, 11).expect("a square");
    let inside: Vec<DVec2> = sampled
        .positions()
        .iter()
        .copied()
        .filter(|p| p.distance(middle) < 45e3)
        .collect();
    let border: Vec<bool> = inside.iter().map(|p| p.distance(middle) > 38e3).collect();
    let land = Extent {
        width: 150e3,
        height: 150e3,
    };
    let place = |p: &DVec2| DVec2::from_angle(turn).rotate(*p - middle) + middle + shift;
    let nodes: Vec<DVec2> = inside.iter().map(place).collect();
    Tin::from_nodes(land, &nodes, Border::Flags(&border)).expect("a disc")
}

#[test]
fn turning_and_moving_the_land_changes_nothing() {
    let run = |tin: &Tin| {
        let mut z: Vec<f64> = (0..tin.len()).map(|i| (i as f64 * 0.7).sin()).collect();
        let uplift = vec![UPLIFT; tin.len()];
        let mut erosion = Erosion::new(tin);
        for _ in 0..30 {
            erosion.step(tin, &mut z, &Forcing::uplift(&uplift), &paper(), 1e5);
        }
        (z, erosion.receivers().to_vec())
    };
    let (z, receivers) = run(&disc(0.0, DVec2::ZERO));
    for (turn, shift) in [
        (0.5, DVec2::new(20e3, 30e3)),
        (1.9, DVec2::new(1e3, 0.0)),
        (0.0, DVec2::new(7e3, 11.0)),
    ] {
        let (turned, same_receivers) = run(&disc(turn, shift));
        assert_eq!(receivers, same_receivers);
        for (a, b) in z.iter().zip(&turned) {
            assert!((a - b).abs() < 1e-9 * 2500.0, "{a} and {b}");
        }
    }
}

#[test]
fn rivers_of_a_cone_have_no_preferred_direction() {
    let tin = Tin::poisson(SQUARE, 40_000, 12).unwrap();
    let middle = 0.5 * SQUARE.size();
    let land = StartLand::new(3);
    let noise = |p: DVec2| 15.0 * (land.height(p) - land.hills(p));
    let z: Vec<f64> = tin
        .positions()
        .iter()
        .map(|&p| noise(p) - 0.01 * p.distance(middle))
        .collect();
    let mut flow = orogen::terrain::Flow::new(&tin);
    flow.route(&tin, &z, orogen::terrain::Outlets::Border, None);
    let mut bins = [0.0_f64; 36];
    let (mut eightfold, mut count) = (DVec2::ZERO, 0.0);
    for node in tin
        .nodes()
        .filter(|&node| tin.position(node).distance(middle) < 45e3)
    {
        if let Some(receiver) = flow.receiver(node) {
            let d = tin.position(receiver) - tin.position(node);
            let angle = d.y.atan2(d.x);
            bins[((angle / std::f64::consts::TAU + 1.0) * 36.0) as usize % 36] += 1.0;
            eightfold += DVec2::from_angle(8.0 * angle);
            count += 1.0;
        }
    }
    let expected = count / 36.0;
    let chi_squared: f64 = bins.iter().map(|n| (n - expected).powi(2) / expected).sum();
    // 35 degrees of freedom: 1e-3 of chance at 66.6; receivers of neighbours are not independent, so it stays below.
    assert!(chi_squared < 66.6, "χ² = {chi_squared}");
    assert!(eightfold.length_squared() / count < 9.0, "eight-fold harmonic");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    // Above the sizes from which passes are cut into tasks, and rivers into blocks.
    for (nodes, steps) in [(50_000, 12), (150_000, 4)] {
        let tin = Tin::poisson(SQUARE, nodes, 13).unwrap();
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let (z, erosion, sums) = evolve(&tin, &paper(), 1e5, steps);
                let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                (bits(&z), bits(erosion.drainage()), erosion.order().to_vec(), sums)
            })
        };
        let alone = run(1);
        assert!(alone == run(2) && alone == run(7));
    }
}

#[test]
fn a_new_and_a_used_erosion_give_the_same_bits() {
    let tin = Tin::poisson(SQUARE, 3000, 14).unwrap();
    let (z, mut used, _) = evolve(&tin, &paper(), 1e5, 10);
    let uplift = vec![UPLIFT; tin.len()];
    let (mut a, mut b) = (z.clone(), z);
    used.step(&tin, &mut a, &Forcing::uplift(&uplift), &paper(), 1e5);
    Erosion::new(&tin).step(&tin, &mut b, &Forcing::uplift(&uplift), &paper(), 1e5);
    assert_eq!(a, b);
}

#[test]
fn broken_heights_are_counted_and_do_no_harm() {
    let tin = Tin::poisson(SQUARE, 2000, 15).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for edges in [Edges::Fixed, Edges::Free] {
            let params = ErosionParams { edges, ..paper() };
            let mut z = StartLand::new(1).heights(&tin);
            z[700] = bad;
            z[3] = bad;
            let mut uplift = vec![UPLIFT; tin.len()];
            uplift[900] = f64::NAN;
            let mut erosion = Erosion::new(&tin);
            for _ in 0..5 {
                let sums = erosion.step(&tin, &mut z, &Forcing::uplift(&uplift), &params, 1e5);
                assert!(sums.not_finite > 0 && sums.not_finite <= tin.len());
            }
        }
    }
    let mut all = vec![f64::NAN; tin.len()];
    let uplift = vec![UPLIFT; tin.len()];
    let sums = Erosion::new(&tin).step(&tin, &mut all, &Forcing::uplift(&uplift), &paper(), 1e5);
    assert_eq!(sums.not_finite, tin.len());
}

#[test]
fn water_after_a_step_is_what_a_flood_would_leave() {
    let tin = Tin::poisson(SQUARE, 3000, 16).unwrap();
    let middle = 0.5 * SQUARE.size();
    let mut z: Vec<f64> = tin
        .positions()
        .iter()
        .map(|p| 1e-7 * (p.distance(middle) - 20e3).powi(2))
        .collect();
    let uplift = vec![0.0; tin.len()];
    let params = ErosionParams {
        landslides: false,
        ..paper()
    };
    let mut erosion = Erosion::new(&tin);
    let sums = erosion.step(&tin, &mut z, &Forcing::uplift(&uplift), &params, 1e3);
    assert!(sums.lakes > 0);
    let flood = priority_flood(&tin, &z);
    let water = erosion.water_level(&z);
    for i in 0..tin.len() {
        // Rivers may have cut a lower way out beside the one the water takes: never a higher level than along it.
        assert!(
            flood[i] <= water[i] && water[i] - flood[i] < 5.0,
            "{} for {}",
            water[i],
            flood[i]
        );
    }
}
