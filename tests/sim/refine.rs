//! From the land of the table to the final land: what stays, what is added, and what is refused.

use std::sync::{Arc, OnceLock};

use crate::sim_common::{SIZE_MM, drag};
use glam::DVec2;
use orogen::rock::preset;
use orogen::sim::refine::{RefineError, Refined, Refinement, Region};
use orogen::sim::{Checkpoint, Sim, SimParams, World};
use orogen::terrain::{Flow, Outlets, Resampling, Tin};
use orogen::units::{DEFAULT_SHORT_SIDE, KM, PlanMap};

/// Nodes of the land before and after.
const LIVE: usize = 12_000;
const FINAL: usize = 60_000;

/// Two hands push a range up, over rock that folds in many layers; then it stands for a while.
fn live() -> &'static Checkpoint {
    static LAND: OnceLock<Checkpoint> = OnceLock::new();
    LAND.get_or_init(|| {
        let map = PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE);
        let pile = preset::by_name("plain").expect("a pile");
        let world = World::new(map, LIVE, 3).expect("a land").with_layers(pile);
        let params = SimParams {
            run_on_yr: 4e6,
            history_bytes: 0,
            ..SimParams::default()
        };
        let mut sim = Sim::new(world, params);
        let mut frames = drag(1, DVec2::new(450.0, 340.0), DVec2::ZERO, 0, 600);
        frames.extend(drag(
            2,
            DVec2::new(780.0, 300.0),
            DVec2::new(-150.0, 20.0),
            700,
            500,
        ));
        frames.sort_by_key(|frame| frame.t_us);
        for frame in frames {
            sim.feed(frame);
        }
        while sim.input_waits() {
            sim.tick();
        }
        sim.finish_input();
        sim.run_on(|_, _| true);
        sim.checkpoint()
    })
}

fn run(mut refinement: Refinement) -> Refined {
    let mut last = 0.0;
    while refinement.step().expect("a step") {
        assert!(refinement.progress() > last && refinement.progress() < 1.0);
        last = refinement.progress();
    }
    assert!((refinement.progress() - 1.0).abs() < 1e-12);
    refinement.finish()
}

fn refined() -> &'static Refined {
    static LAND: OnceLock<Refined> = OnceLock::new();
    LAND.get_or_init(|| run(Refinement::of_land(live(), FINAL).expect("finer")))
}

fn flow(tin: &Tin, z: &[f64]) -> Flow {
    let mut flow = Flow::new(tin);
    flow.route(tin, z, Outlets::Border, None);
    flow
}

/// Places along rivers that drain at least `least` m², and lie in no lake; every 50 m.
fn river_places(tin: &Tin, z: &[f64], least: f64) -> Vec<DVec2> {
    let flow = flow(tin, z);
    let mut places = Vec::new();
    for node in tin.nodes().filter(|node| flow.drainage()[node.index()] >= least) {
        let Some(receiver) = flow.receiver(node) else {
            continue;
        };
        if flow.lakes().lake(node, z[node.index()]).is_some() {
            continue;
        }
        let (from, to) = (tin.position(node), tin.position(receiver));
        let steps = (from.distance(to) / 50.0).ceil() as usize;
        places.extend((0..steps).map(|k| from.lerp(to, k as f64 / steps as f64)));
    }
    places
}

/// Part of `places` that lie within `reach` metres of one of `others`.
fn near(places: &[DVec2], others: &[DVec2], reach: f64) -> f64 {
    let cell = |p: DVec2| ((p.x / reach).floor() as i64, (p.y / reach).floor() as i64);
    let mut cells = std::collections::BTreeMap::<_, Vec<DVec2>>::new();
    for &p in others {
        cells.entry(cell(p)).or_default().push(p);
    }
    let is_near = |p: &&DVec2| {
        let (x, y) = cell(**p);
        (x - 1..=x + 1).any(|x| {
            (y - 1..=y + 1).any(|y| {
                let there = cells.get(&(x, y));
                there.is_some_and(|there| there.iter().any(|q| q.distance(**p) <= reach))
            })
        })
    };
    places.iter().filter(is_near).count() as f64 / places.len() as f64
}

#[test]
fn rivers_stay_where_they_were() {
    let (before, after) = (live().world(), &refined().world);
    let km2 = KM * KM;
    let river = |world: &World, least: f64| river_places(&world.tin, &world.z, least * km2);
    let stayed = near(&river(before, 20.0), &river(after, 10.0), 500.0);
    let known = near(&river(after, 20.0), &river(before, 10.0), 500.0);
    assert!(
        stayed > 0.95 && known > 0.95,
        "{stayed} of the rivers stayed, {known} were there before"
    );
    // What counts is not that rivers are everywhere: those of another land of the same size are elsewhere.
    let map = before.map;
    let other = World::new(map, LIVE, 99).expect("a land");
    assert!(near(&river(before, 20.0), &river(&other, 10.0), 500.0) < 0.5);
}

#[test]
fn the_large_shape_is_held_and_detail_is_added() {
    let (before, after) = (live().world(), &refined().world);
    // Means over squares of 5 km.
    let means = |world: &World| {
        let mut sums = vec![(0.0, 0.0); 36 * 20];
        for (i, p) in world.tin.positions().iter().enumerate() {
            let cell = (p.x / 5e3) as usize + 36 * ((p.y / 5e3) as usize).min(19);
            let area = world.tin.areas()[i];
            sums[cell].0 += area * world.z[i];
            sums[cell].1 += area;
        }
        sums.iter().map(|(sum, area)| sum / area).collect::<Vec<f64>>()
    };
    let (coarse, fine) = (means(before), means(after));
    let square: f64 = coarse.iter().zip(&fine).map(|(a, b)| (a - b).powi(2)).sum();
    let error = (square / coarse.len() as f64).sqrt();
    let highest = before.z.iter().copied().fold(0.0, f64::max);
    assert!(highest > 1000.0, "there is a range: {highest}");
    assert!(error < 0.02 * highest, "{error} m of {highest} m");
    assert_eq!(after.time_yr, before.time_yr, "no time has passed");
    let steepness = |world: &World| {
        let steep = world.tin.nodes().map(|node| {
            let links = world.tin.links(node);
            let fall = links.iter().map(|link| {
                (world.z[link.to.index()] - world.z[node.index()]).abs() * f64::from(link.inverse_distance)
            });
            fall.fold(0.0, f64::max) * world.tin.areas()[node.index()]
        });
        steep.sum::<f64>() / world.tin.extent().area()
    };
    let (was, is) = (steepness(before), steepness(after));
    assert!(is > 1.1 * was, "a mean slope of {was} became {is}");
}

#[test]
fn finer_layers_fold_as_far_as_the_shortening_pays_for() {
    let (before, after) = (live().world(), &refined().world);
    assert!(
        after.strata.folds().count() > before.strata.folds().count(),
        "{} layers folded on the table, {} in the end",
        before.strata.folds().count(),
        after.strata.folds().count()
    );
    let drive = after.folded.as_ref().expect("something folded");
    let wavelength = |interface| {
        let layer = after.skeletons.iter().find(|layer| layer.interface == interface);
        layer.expect("a skeleton").mesh.wavelength()
    };
    let stood = |interface| before.strata.folds().any(|fold| fold.interface == interface);
    let mut highest = 0.0_f64;
    for (i, &p) in after.tin.positions().iter().enumerate() {
        let (mut spent, mut finer) = (0.0, 0.0);
        for fold in after.strata.folds() {
            let part = (fold.crests[i] / wavelength(fold.interface)).powi(2);
            if stood(fold.interface) {
                spent += part;
            } else {
                finer += part;
                highest = highest.max(fold.raised[i]);
            }
        }
        // What stands has been carried over from coarser nodes, and may be more than there is.
        let left = (drive.at(p).limit.powi(2) - spent).max(0.0);
        assert!(finer <= left * (1.0 + 1e-6) + 1e-12, "{finer} of {left} at {p}");
    }
    assert!(highest > 5.0, "the highest of the finer folds rises {highest} m");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| run(Refinement::of_land(live(), 30_000).expect("finer")).world.z)
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(7));
}

#[test]
fn what_cannot_be_is_refused() {
    let refuse = |nodes| {
        Refinement::of_land(live(), nodes)
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(
        refuse(LIVE),
        "12000 nodes: the land has 12000 already; expected more"
    );
    assert_eq!(refuse(5_000_000), "5000000 nodes: at most 4000000 are possible");
    let region = Region {
        south_west: DVec2::new(170e3, 20e3),
        side: 10e3,
        spacing: 10.0,
    };
    let refused = Refinement::of_region(live().params(), refined(), region);
    assert!(matches!(refused, Err(RefineError::Region(_))));
}

#[test]
fn a_box_inherits_heights_rivers_and_layers_at_its_edges() {
    let land = refined();
    // Where the largest river of the range runs, so that water comes in and goes out.
    let around = &land.world;
    let water = flow(&around.tin, &around.z);
    let inland = |p: DVec2| p.x > 30e3 && p.x < 140e3 && p.y > 25e3 && p.y < 75e3;
    let river = around
        .tin
        .nodes()
        .filter(|&node| inland(around.tin.position(node)))
        .max_by(|a, b| water.drainage()[a.index()].total_cmp(&water.drainage()[b.index()]))
        .expect("a river");
    let region = Region {
        south_west: around.tin.position(river) - 2e3,
        side: 4e3,
        spacing: 10.0,
    };
    let refined = run(Refinement::of_region(live().params(), land, region).expect("a box"));
    let world = &refined.world;
    assert_eq!(world.tin.len(), 160_000);
    let places: Vec<DVec2> = world
        .tin
        .positions()
        .iter()
        .map(|&p| p + region.south_west)
        .collect();
    let places = Resampling::new(&around.tin, &places);
    let (outside, cover) = (
        places.smooth(&around.z),
        places.linear(&around.sediment.thickness),
    );
    let on_edge = |p: DVec2| p.x == 0.0 || p.y == 0.0 || p.x == region.side || p.y == region.side;
    let mut moved = 0.0_f64;
    for (i, &p) in world.tin.positions().iter().enumerate() {
        if on_edge(p) {
            assert_eq!(world.z[i], outside[i], "the seam at {p}");
            assert_eq!(world.sediment.thickness[i], cover[i]);
        }
        moved = moved.max((world.z[i] - outside[i]).abs());
    }
    assert!(moved > 5.0, "inside there is something new: {moved}");
    // The layers lie as they do around.
    let risen = places.linear(around.strata.base());
    let differ = world.strata.base().iter().zip(&risen).map(|(a, b)| (a - b).abs());
    assert!(differ.fold(0.0, f64::max) < 1.0);
    assert!(Arc::ptr_eq(&world.stratigraphy, &around.stratigraphy));
    // The river that comes in goes out again.
    let rain = refined.rain.as_ref().expect("rivers flow in");
    let mut inside = Flow::new(&world.tin);
    inside.route(&world.tin, &world.z, Outlets::Border, Some(rain));
    inside.sanity_check(&world.tin).expect("all water leaves");
    let most = world
        .tin
        .nodes()
        .filter(|&node| inside.receiver(node).is_none())
        .map(|node| inside.drainage()[node.index()])
        .fold(0.0, f64::max);
    let through = water.drainage()[river.index()];
    assert!(
        (0.9..1.2).contains(&(most / through)),
        "{most} m² leave of {through}"
    );
}

#[test]
fn a_refined_session_can_be_looked_at() {
    let nodes = 20_000;
    let refined = run(Refinement::of_land(live(), nodes).expect("finer"));
    let sim = Sim::resume(live().clone().refined(refined));
    assert_eq!(sim.node_uplift().len(), nodes);
    assert_eq!(
        sim.plate_marks().len(),
        Sim::resume(live().clone()).plate_marks().len()
    );
    assert!(!sim.fold_lines(usize::MAX).is_empty());
    assert!(!sim.can_undo(orogen::gesture::contact::Side::South));
}
