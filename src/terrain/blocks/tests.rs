//! Blocks against one block: the same land but for the order of sums.

use proptest::prelude::*;

use super::BLOCK;
use crate::terrain::{
    Deposition, Edges, Erosion, ErosionParams, Flow, Forcing, Outlets, Sediment, StartLand, StepSums, Tin,
};
use crate::units::{Extent, KM};

const LAND: Extent = Extent {
    width: 100.0 * KM,
    height: 70.0 * KM,
};

/// Heights that have hills, plains, lakes or noise, as `kind` says.
fn heights(tin: &Tin, kind: u32, seed: u64) -> Vec<f64> {
    let start = StartLand::new(seed);
    let height = |&p| {
        let (hills, noise) = (start.hills(p), start.height(p) - start.hills(p));
        match kind {
            0 => hills + noise,
            1 => 200.0 * noise,
            2 => (hills / 40.0).floor() * 40.0,
            _ => 10.0 * hills.max(0.0) + 5.0 * noise,
        }
    };
    tin.positions().iter().map(height).collect()
}

/// A land and what moves on it.
#[derive(Clone, Debug, PartialEq)]
struct Land {
    z: Vec<f64>,
    sediment: Sediment,
    water: Vec<f64>,
    sums: StepSums,
}

impl Land {
    fn new(z: Vec<f64>) -> Self {
        Self {
            sediment: Sediment::new(z.len()),
            water: z.clone(),
            sums: StepSums::default(),
            z,
        }
    }

    /// The land after one step in blocks of a size.
    fn step(&self, tin: &Tin, step: usize, size: usize, params: &ErosionParams, threads: usize) -> Self {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        let mut land = self.clone();
        let moves = |east: f64| if east > 3e4 * (step % 3) as f64 { 5e-4 } else { 0.0 };
        let uplift: Vec<f64> = tin.positions().iter().map(|p| moves(p.x)).collect();
        let forcing = Forcing::uplift(&uplift);
        let dt_yr = if step < 3 { 1e4 } else { 2e5 };
        let mut erosion = Erosion::in_blocks(tin, size);
        land.sums = pool.install(|| {
            erosion.step_with_sediment(tin, &mut land.z, &mut land.sediment, &forcing, params, dt_yr)
        });
        erosion.flow().sanity_check(tin).expect("a sane flow");
        land.water = erosion.water_level(&land.z).to_vec();
        land
    }
}

fn assert_near(a: &[f64], b: &[f64], tolerance: f64) {
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() <= tolerance, "node {i}: {a} and {b}");
    }
}

/// Blocks change only the order in which drainage and sediment are summed.
fn check(nodes: usize, size: usize, kind: u32, seed: u64, edges: Edges, deposition: Option<Deposition>) {
    let tin = Tin::poisson(LAND, nodes, seed).expect("a rectangle");
    let params = ErosionParams {
        k: 1e-6,
        edges,
        deposition,
        ..ErosionParams::default()
    };
    let mut land = Land::new(heights(&tin, kind, seed));
    for step in 0..6 {
        let whole = land.step(&tin, step, nodes, &params, 1);
        let blocks = land.step(&tin, step, size, &params, 1);
        assert!(blocks == land.step(&tin, step, size, &params, 2));
        assert!(blocks == land.step(&tin, step, size, &params, 7));
        assert_near(&whole.z, &blocks.z, 1e-7);
        assert_near(&whole.water, &blocks.water, 1e-7);
        assert_near(&whole.sediment.thickness, &blocks.sediment.thickness, 1e-7);
        let (a, b) = (whole.sums, blocks.sums);
        assert_eq!((a.lakes, a.not_finite), (b.lakes, b.not_finite));
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(1e9);
        assert!(near(a.uplifted_m3, b.uplifted_m3) && near(a.fluvial_m3, b.fluvial_m3));
        assert!(near(a.landslide_m3, b.landslide_m3) && near(a.deposited_m3, b.deposited_m3));
        assert!(near(a.exported_m3, b.exported_m3), "{a:?} and {b:?}");
        land = whole;
    }
}

#[test]
fn hills_terraces_and_noise_move_in_blocks_as_they_move_in_one() {
    for kind in 0..4 {
        check(3000, 250, kind, 1, Edges::Fixed, None);
        check(3001, 97, kind, 2, Edges::Free, None);
        check(2999, 750, kind, 3, Edges::Fixed, Some(Deposition::default()));
        check(2999, 64, kind, 4, Edges::Free, Some(Deposition::default()));
    }
}

#[test]
fn routing_in_blocks_is_exact_but_for_the_last_digits_of_drainage() {
    for (kind, outlets) in [(0, Outlets::Border), (1, Outlets::Lowest), (2, Outlets::Border)] {
        let tin = Tin::poisson(LAND, 5003, 5).expect("a rectangle");
        let z = heights(&tin, kind, 5);
        let mut one = Flow::in_blocks(&tin, tin.len());
        one.route(&tin, &z, outlets, None);
        for size in [33, 700, 5002] {
            let mut many = Flow::in_blocks(&tin, size);
            many.route_with(&tin, &z, outlets, None, size == 700);
            many.sanity_check(&tin).expect("a sane flow");
            assert_eq!(one.receivers(), many.receivers());
            for (a, b) in one.drainage().iter().zip(many.drainage()) {
                assert!((a / b - 1.0).abs() < 1e-12, "{a} and {b} m²");
            }
        }
    }
}

#[test]
fn heights_that_are_no_numbers_do_no_harm_in_blocks() {
    let tin = Tin::poisson(LAND, 2000, 6).expect("a rectangle");
    let mut start = heights(&tin, 0, 6);
    for (k, value) in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY]
        .into_iter()
        .enumerate()
    {
        start[300 + 500 * k] = value;
    }
    for deposition in [None, Some(Deposition::default())] {
        let params = ErosionParams {
            deposition,
            ..ErosionParams::default()
        };
        let bits = |threads| {
            let land = Land::new(start.clone()).step(&tin, 4, 128, &params, threads);
            let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
            (bits(land.z), bits(land.water), bits(land.sediment.thickness))
        };
        assert_eq!(bits(1), bits(7));
    }
}

#[test]
fn the_trunk_is_a_small_part_of_a_large_land() {
    let tin = Tin::poisson(LAND, 2 * BLOCK + 1, 7).expect("a rectangle");
    let uplift = vec![5e-4; tin.len()];
    let mut z = StartLand::new(7).heights(&tin);
    let mut erosion = Erosion::new(&tin);
    for _ in 0..3 {
        erosion.step(
            &tin,
            &mut z,
            &Forcing::uplift(&uplift),
            &ErosionParams::default(),
            1e5,
        );
    }
    let blocks = erosion.flow().blocks();
    assert_eq!(blocks.parts.len(), 3);
    assert!(blocks.trunk < tin.len() / 8, "{} nodes", blocks.trunk);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn any_land_moves_in_any_blocks_as_it_moves_in_one(
        nodes in 100_usize..1500,
        size in 16_usize..400,
        kind in 0_u32..4,
        seed in 0_u64..1000,
        free in any::<bool>(),
        settles in any::<bool>(),
    ) {
        let edges = if free { Edges::Free } else { Edges::Fixed };
        check(nodes, size, kind, seed, edges, settles.then(Deposition::default));
    }
}
