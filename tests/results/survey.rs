//! From nodes to a surface: the same whether it is new or drawn over.

use orogen::surface::Surface;
use orogen::survey::{Ground, Survey, Water};
use orogen::terrain::{Flow, NodeId, Outlets, StartLand, Tin};
use orogen::units::{Extent, KM};

const LAND: Extent = Extent {
    width: 160.0 * KM,
    height: 100.0 * KM,
};

fn routed(tin: &Tin, z: &[f64]) -> Flow {
    let mut flow = Flow::new(tin);
    flow.route(tin, z, Outlets::Border, None);
    flow
}

#[test]
fn a_surface_that_is_drawn_over_is_the_new_one_in_the_old_memory() {
    let tin = Tin::poisson(LAND, 3000, 2).expect("a TIN");
    let lands = [5, 6].map(|seed| StartLand::new(seed).heights(&tin));
    let flows = [0, 1].map(|k: usize| routed(&tin, &lands[k]));
    let fresh = |k: usize| {
        let ground = Ground {
            tin: &tin,
            z: &lands[k],
            flow: &flows[k],
        };
        Survey::new(&tin, 130).surface(ground, 0.0)
    };
    let mut survey = Survey::new(&tin, 130);
    let mut surface = survey.blank();
    let memory = |surface: &Surface| {
        [&surface.height, &surface.lake_depth, &surface.drainage].map(|raster| raster.data.as_ptr())
    };
    let before = memory(&surface);
    for k in [0, 1, 0] {
        survey.draw(&tin, &lands[k], || &flows[k], &mut surface);
        assert!(surface == fresh(k), "land {k}");
    }
    assert_eq!(memory(&surface), before);
    assert!(fresh(0).height != fresh(1).height);
    assert_eq!((surface.height.width, surface.height.height), (130, 81));
    assert!(surface.lake_depth.data.iter().any(|&depth| depth > 0.0));
    assert!(!surface.rivers.is_empty());
}

#[test]
fn water_stands_where_the_flow_says() {
    let tin = Tin::poisson(LAND, 2000, 3).expect("a TIN");
    let z = StartLand::new(1).heights(&tin);
    let flow = routed(&tin, &z);
    let ground = Ground {
        tin: &tin,
        z: &z,
        flow: &flow,
    };
    let water = Water::new(ground);
    let graph = water.graph(ground);
    assert_eq!(graph.receivers, water.receivers());
    let lake = |node: NodeId| flow.lakes().lake(node, z[node.index()]);
    let depth = |node: NodeId| flow.lakes().level(node, z[node.index()]) - z[node.index()];
    let mut puddles = 0;
    for node in tin.nodes() {
        let i = node.index();
        let same = tin
            .nodes()
            .filter(|&other| lake(node).is_some() && lake(other) == lake(node));
        let deepest = same.map(depth).fold(0.0, f64::max);
        assert_eq!(
            graph.lake[i],
            deepest >= 8.0,
            "a lake is eight metres deep somewhere"
        );
        puddles += usize::from(lake(node).is_some() && !graph.lake[i]);
        assert_eq!(graph.receivers[i], flow.receivers()[i].0);
    }
    assert!(puddles > 0, "and some water is not");
}
