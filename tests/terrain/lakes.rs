//! Flow routing and lakes: water levels equal to a flood from the border, to the bit; water leaves only at outlets.

use glam::DVec2;
use orogen::terrain::{Border, Flow, NodeId, Outlets, StartLand, Tin, priority_flood};
use orogen::units::{Extent, KM};
use proptest::prelude::*;

const SQUARE: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};

/// Routes, checks everything that must hold for any surface, and returns the flow.
fn route_and_check(tin: &Tin, z: &[f64], outlets: Outlets) -> Flow {
    let mut flow = Flow::new(tin);
    flow.route(tin, z, outlets, None);
    flow.sanity_check(tin).expect("a sane flow");
    let levels = priority_flood(tin, z);
    for node in tin.nodes() {
        let i = node.index();
        assert_eq!(
            flow.lakes().level(node, z[i]).to_bits(),
            levels[i].to_bits(),
            "{node:?}"
        );
        assert_eq!(flow.lakes().lake(node, z[i]).is_some(), levels[i] > z[i]);
        // Where it is dry, the carved flow goes strictly down; the water surface never rises downstream.
        if let Some(receiver) = flow.receiver(node) {
            assert!(
                levels[receiver.index()] <= levels[i],
                "{node:?} flows up to {receiver:?}"
            );
        }
        if outlets == Outlets::Border && tin.is_border(node) {
            assert_eq!(flow.receiver(node), None);
        }
    }
    let left: f64 = tin
        .nodes()
        .filter(|&node| flow.receiver(node).is_none())
        .map(|node| flow.drainage()[node.index()])
        .sum();
    assert!(
        (left / tin.extent().area() - 1.0).abs() < 1e-12,
        "{left} m² leave"
    );
    flow
}

fn heights(tin: &Tin, height: impl Fn(DVec2) -> f64) -> Vec<f64> {
    tin.positions().iter().map(|&p| height(p)).collect()
}

/// Distance from the middle of the square, 1 at the middle of a side.
fn radius(p: DVec2) -> f64 {
    (p / (50.0 * KM) - DVec2::ONE).length()
}

#[test]
fn a_slope_has_no_lake() {
    let tin = Tin::poisson(SQUARE, 1000, 1).unwrap();
    let flow = route_and_check(
        &tin,
        &heights(&tin, |p| 0.01 * p.x + 0.003 * p.y),
        Outlets::Border,
    );
    assert!(!flow.lakes().any());
    assert_eq!(flow.lakes().count(), 0);
}

#[test]
fn a_bowl_is_one_lake_up_to_its_lowest_rim() {
    let tin = Tin::poisson(SQUARE, 2000, 2).unwrap();
    let z = heights(&tin, |p| 100.0 * radius(p).powi(2) + p.x * 1e-4);
    for outlets in [Outlets::Border, Outlets::Lowest] {
        let flow = route_and_check(&tin, &z, outlets);
        assert_eq!(flow.lakes().count(), 1);
        let rim = tin
            .nodes()
            .filter(|&node| tin.is_border(node))
            .map(|node| z[node.index()])
            .fold(f64::INFINITY, f64::min);
        let deepest = tin
            .nodes()
            .min_by(|a, b| z[a.index()].total_cmp(&z[b.index()]))
            .unwrap();
        assert_eq!(flow.lakes().level(deepest, z[deepest.index()]), rim);
    }
}

#[test]
fn nested_bowls_share_a_surface_only_when_the_inner_rim_is_under_water() {
    let tin = Tin::poisson(SQUARE, 8000, 3).unwrap();
    // Two bowls in a bowl: the sill between them is at 20 m (dry or drowned), the outer rim at about 50 m or 10 m.
    let two_bowls = |p: DVec2| {
        let west = (p - DVec2::new(35.0 * KM, 50.0 * KM)).length();
        let east = (p - DVec2::new(65.0 * KM, 50.0 * KM)).length();
        20.0 * west.min(east) / (15.0 * KM)
    };
    let drowned = heights(&tin, |p| two_bowls(p).min(200.0));
    let flow = route_and_check(&tin, &drowned, Outlets::Border);
    assert_eq!(flow.lakes().count(), 1);
    // A trench from the west side into each bowl's rim keeps both levels below the sill.
    let drained = heights(&tin, |p| {
        if (p.y - 50.0 * KM).abs() < 3.0 * KM && (p.x < 30.0 * KM || p.x > 70.0 * KM) {
            5.0
        } else {
            two_bowls(p)
        }
    });
    let flow = route_and_check(&tin, &drained, Outlets::Border);
    let lake_near = |x: f64| {
        let centre = DVec2::new(x, 50.0 * KM);
        let nearest = |node: &NodeId| tin.position(*node).distance(centre);
        let node = tin
            .nodes()
            .min_by(|a, b| nearest(a).total_cmp(&nearest(b)))
            .unwrap();
        flow.lakes().lake(node, drained[node.index()])
    };
    let (west, east) = (lake_near(35.0 * KM), lake_near(65.0 * KM));
    assert!(
        west.is_some() && east.is_some() && west != east,
        "{west:?} {east:?}"
    );
}

#[test]
fn equal_heights_route_the_same_way_twice() {
    let tin = Tin::poisson(SQUARE, 3000, 4).unwrap();
    // A flat land, terraces, and bowls with equal spills.
    let flat = vec![7.0; tin.len()];
    let terraces = heights(&tin, |p| (10.0 * radius(p)).floor());
    let waffle = heights(&tin, |p| ((p.x / 9e3).sin() * (p.y / 9e3).sin()).signum());
    for z in [flat, terraces, waffle] {
        for outlets in [Outlets::Border, Outlets::Lowest] {
            let first = route_and_check(&tin, &z, outlets);
            let second = route_and_check(&tin, &z, outlets);
            assert_eq!(first.receivers(), second.receivers());
            assert_eq!(first.order(), second.order());
            assert_eq!(first.drainage(), second.drainage());
            let wet = tin
                .nodes()
                .any(|node| first.lakes().lake(node, z[node.index()]).is_some());
            assert_eq!(first.lakes().count() > 0, wet);
        }
    }
}

#[test]
fn a_single_outlet_drains_everything() {
    let sampled = Tin::poisson(SQUARE, 3000, 5).unwrap();
    let mut flags = vec![false; sampled.len()];
    flags[1234] = true;
    let tin = Tin::from_nodes(SQUARE, sampled.positions(), Border::Flags(&flags)).unwrap();
    for outlets in [Outlets::Border, Outlets::Lowest] {
        let flow = route_and_check(&tin, &StartLand::new(3).heights(&tin), outlets);
        assert!((flow.drainage()[1234] / SQUARE.area() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn noise_has_many_lakes_and_each_is_right() {
    let tin = Tin::poisson(SQUARE, 20_000, 6).unwrap();
    let white = StartLand::new(1);
    let z = heights(&tin, |p| white.height(p) - white.hills(p));
    let flow = route_and_check(&tin, &z, Outlets::Border);
    assert!(flow.lakes().count() > 500, "{} lakes", flow.lakes().count());
    route_and_check(&tin, &z, Outlets::Lowest);
    // The same flow object, used again on land without lakes, forgets them.
    let mut flow = flow;
    let slope = heights(&tin, |p| p.x);
    flow.route(&tin, &slope, Outlets::Border, None);
    assert!(!flow.lakes().any());
    flow.sanity_check(&tin).unwrap();
}

#[test]
fn rain_scales_drainage() {
    let tin = Tin::poisson(SQUARE, 1000, 7).unwrap();
    let z = heights(&tin, |p| p.x);
    let (mut plain, mut wet) = (Flow::new(&tin), Flow::new(&tin));
    plain.route(&tin, &z, Outlets::Border, None);
    wet.route(&tin, &z, Outlets::Border, Some(&vec![2.0; tin.len()]));
    for (plain, wet) in plain.drainage().iter().zip(wet.drainage()) {
        assert_eq!(2.0 * plain, *wet);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_surface_floods_the_same_by_either_way(
        seed in 0_u64..1000,
        nodes in 16_usize..120,
        levels in 1_u32..9,
        cells in prop::collection::vec(0_u32..1000, 120),
    ) {
        // Few distinct heights: plateaus, equal spills, nested bowls at every turn.
        let tin = Tin::poisson(SQUARE, nodes, seed).unwrap();
        let z: Vec<f64> = cells[..nodes].iter().map(|c| f64::from(c % levels)).collect();
        route_and_check(&tin, &z, Outlets::Border);
        route_and_check(&tin, &z, Outlets::Lowest);
    }
}
