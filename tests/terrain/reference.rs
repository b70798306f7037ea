//! The engine against a step written as plainly as possible: same receivers, same water, same heights.

use crate::terrain_common::plain_step;
use orogen::terrain::{Edges, Erosion, ErosionParams, Forcing, StartLand, Tin};
use orogen::units::{Extent, KM};

const TABLE: Extent = Extent {
    width: 120.0 * KM,
    height: 80.0 * KM,
};

const UPLIFT: f64 = 5e-4;

/// Routes and moves the same land both ways, step after step, each step from the engine's heights.
fn compare(nodes: usize, seed: u64, edges: Edges, start: impl Fn(&Tin) -> Vec<f64>) {
    compare_steps(nodes, seed, edges, 0..30, start);
}

fn compare_steps(
    nodes: usize,
    seed: u64,
    edges: Edges,
    steps: std::ops::Range<usize>,
    start: impl Fn(&Tin) -> Vec<f64>,
) {
    let params = ErosionParams {
        k: 1e-6,
        edges,
        ..ErosionParams::default()
    };
    let tin = Tin::poisson(TABLE, nodes, seed).expect("a rectangle");
    let uplift = vec![UPLIFT; nodes];
    let mut z = start(&tin);
    let mut erosion = Erosion::new(&tin);
    let mut lakes = 0;
    for step in steps {
        // Short steps keep lakes for a while, long ones make talus.
        let dt_yr = if step < 10 { 1e4 } else { 2e5 };
        let before = z.clone();
        let mut plain = z.clone();
        let sums = erosion.step(&tin, &mut z, &Forcing::uplift(&uplift), &params, dt_yr);
        let flow = plain_step(&tin, &mut plain, UPLIFT, &params, dt_yr);
        lakes = lakes.max(sums.lakes);
        for node in tin.nodes() {
            let i = node.index();
            // The engine ranks slopes by distances in single precision: slopes within 6e-8 of each other could change
            // places, and in these lands none do.
            assert_eq!(
                erosion.receivers()[i].index(),
                flow.receivers[i],
                "{node:?}, step {step}"
            );
            assert_eq!(
                erosion.flow().lakes().level(node, before[i]),
                flow.level[i],
                "{node:?}"
            );
            // The same sums in another order.
            let area = erosion.drainage()[i];
            assert!(
                (area / flow.drainage[i] - 1.0).abs() < 1e-12,
                "{node:?}: {area} m²"
            );
            // Round-off of heights of some km, and of the areas, along a river.
            assert!(
                (z[i] - plain[i]).abs() < 1e-9,
                "{node:?}: {} and {}",
                z[i],
                plain[i]
            );
        }
    }
    assert!(lakes > 0, "there are lakes to route through");
}

#[test]
fn hills_with_lakes_move_as_the_plain_step_moves_them() {
    for (seed, edges) in [(1, Edges::Fixed), (2, Edges::Free)] {
        compare(1500, seed, edges, |tin| StartLand::new(seed).heights(tin));
    }
}

#[test]
fn noise_full_of_lakes_moves_as_the_plain_step_moves_it() {
    for (seed, edges) in [(3, Edges::Fixed), (4, Edges::Free)] {
        let land = StartLand::new(seed);
        compare(1000, seed, edges, |tin| {
            let noise = |&p| 200.0 * (land.height(p) - land.hills(p));
            tin.positions().iter().map(noise).collect()
        });
    }
}

#[test]
fn terraces_with_equal_heights_move_as_the_plain_step_moves_them() {
    for (seed, edges) in [(5, Edges::Fixed), (6, Edges::Free)] {
        let land = StartLand::new(seed);
        compare(1000, seed, edges, |tin| {
            let terrace =
                |&p| (land.hills(p) / 20.0).floor() * 20.0 + 50.0 * (land.height(p) - land.hills(p)).round();
            tin.positions().iter().map(terrace).collect()
        });
    }
}

#[test]
fn a_land_of_many_nodes_moves_as_the_plain_step_moves_it() {
    // Above the size from which rivers are swept in blocks.
    compare_steps(150_001, 7, Edges::Fixed, 8..12, |tin| {
        let land = StartLand::new(7);
        tin.positions().iter().map(|&p| 5.0 * land.hills(p)).collect()
    });
}
