//! Layers that fold while the land is sculpted, and the hands that turn and raise their ridges.

use std::fs;
use std::path::Path;

use glam::DVec2;
use orogen::gesture::command::{Action, Command};
use orogen::gesture::contact::{InputFrame, Side};
use orogen::gesture::file::read_gesture;
use orogen::sim::{Sim, SimParams, TICK_US, World};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

/// Enough to tell the longest folds of every pile apart.
const NODES: usize = 12_000;

/// The session of a gesture file after its last push, ready to run on.
fn played(name: &str) -> Sim {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("gestures/{name}.gesture.jsonl"));
    let file = read_gesture(fs::File::open(path).expect("a file"), name).expect("a gesture file");
    let map = PlanMap::new(file.header.size_mm, DEFAULT_SHORT_SIDE);
    let mut params = SimParams::default();
    params.mountain.cells = 256 * 256;
    let world = World::new(map, NODES, 7).expect("a world");
    let mut sim = Sim::new(world, params);
    for frame in file.frames {
        sim.feed(frame);
    }
    while sim.input_waits() {
        sim.tick();
    }
    sim
}

/// Ticks for so many years.
fn run(sim: &mut Sim, years: f64) {
    let until = sim.world().time_yr + years;
    while sim.world().time_yr < until {
        sim.tick();
    }
}

fn order(sim: &mut Sim, action: Action) {
    sim.feed(InputFrame {
        t_us: sim.ticks() * TICK_US,
        events: Vec::new(),
        commands: vec![Command {
            side: Some(Side::South),
            ..Command::new(action)
        }],
    });
    sim.tick();
}

/// A line askew across the middle of the longest crest, table mm.
fn across_a_crest(sim: &Sim) -> Vec<DVec2> {
    let lines = sim.fold_lines(1);
    let crests = lines.iter().filter(|line| line.crest);
    let crest = crests.max_by_key(|line| line.points.len()).expect("a crest");
    let middle = crest.points[crest.points.len() / 2];
    let map = sim.world().map;
    [-1.0, -0.5, 0.0, 0.5, 1.0]
        .map(|part| map.to_table(middle + DVec2::new(0.7, 0.7) * (part * crest.wavelength_m)))
        .to_vec()
}

#[test]
fn ranges_of_the_world_fold_as_their_layers_do() {
    for (name, folds) in [
        ("range_jura", true),
        ("range_zagros", true),
        ("range_andes", true),
        ("range_southern_alps", false),
        ("range_digne", true),
    ] {
        let mut sim = played(name);
        run(&mut sim, 3e6);
        let world = sim.world();
        let raised = world
            .strata
            .folds()
            .flat_map(|fold| fold.raised.iter().copied())
            .fold(0.0, f64::max);
        assert_eq!(raised > 200.0, folds, "{name}: folds of {raised} m");
        let stats = sim.fold_stats();
        assert_eq!(stats.is_empty(), !folds, "{name}");
        for (layer, stats) in &stats {
            let ratio = stats.realised_wavelength / layer.wavelength;
            assert!(
                (0.75..1.35).contains(&ratio),
                "{name}: folds of {} m instead of {} m",
                stats.realised_wavelength,
                layer.wavelength
            );
        }
        // Layers stay in order under every node, and the rock at the surface is somewhere in the pile.
        let pile = &world.stratigraphy;
        for node in world.tin.nodes() {
            let column = world.strata.column(pile, node.index());
            let heights: Vec<f64> = (0..pile.depths().len()).map(|i| column.height(i)).collect();
            assert!(heights.is_sorted_by(|above, below| above > below), "{name}");
        }
    }
}

#[test]
fn a_ridge_that_is_raised_rises_and_undo_takes_it_back_to_the_bit() {
    let mut edited = played("range_jura");
    run(&mut edited, 3e6);
    let mut untouched = Sim::resume(edited.checkpoint());
    let before = edited.world().clone();
    let path = across_a_crest(&edited);
    order(&mut edited, Action::TurnFolds { path: path.clone() });
    assert_ne!(edited.world().skeletons[0].skeleton, before.skeletons[0].skeleton);
    order(
        &mut edited,
        Action::RaiseFolds {
            path: path.clone(),
            by: 1.2,
        },
    );
    // The handle that is drawn on goes on from where it was.
    order(&mut edited, Action::RaiseFolds { path, by: 2.0 });
    assert_eq!(edited.world().fold_edits.len(), 2);
    run(&mut edited, 5e5);
    run(&mut untouched, 5e5);
    let change = edited
        .world()
        .z
        .iter()
        .zip(&untouched.world().z)
        .map(|(a, b)| a - b)
        .fold(0.0, f64::max);
    assert!(change > 100.0, "the drawn ridge stands {change} m higher");

    for _ in 0..3 {
        order(&mut edited, Action::Undo);
    }
    let after = edited.world();
    assert_eq!(after.fold_edits, before.fold_edits);
    assert_eq!(after.z, before.z);
    assert_eq!(after.strata, before.strata);
    assert_eq!(after.sediment, before.sediment);
    assert_eq!(after.skeletons[0].skeleton, before.skeletons[0].skeleton);
}

#[test]
fn folds_are_the_same_bits_for_any_number_of_threads() {
    let heights = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let mut sim = played("folds_edited");
            run(&mut sim, 1e6);
            sim.world().z.clone()
        })
    };
    let one = heights(1);
    assert_eq!(one, heights(2));
    assert_eq!(one, heights(7));
}

#[test]
fn another_pile_under_the_land_keeps_its_heights_and_can_be_undone() {
    let mut sim = played("range_jura");
    run(&mut sim, 2e6);
    let (z, pile) = (sim.world().z.clone(), sim.world().stratigraphy.clone());
    order(&mut sim, Action::Pause);
    order(&mut sim, Action::Layers("andes".to_owned()));
    assert_eq!(sim.world().stratigraphy.name(), "andes");
    assert_eq!(sim.world().z, z);
    order(&mut sim, Action::Undo);
    assert_eq!(sim.world().stratigraphy, pile);
    assert_eq!(sim.counts().idle_commands, 0);
    order(&mut sim, Action::Layers("no such pile".to_owned()));
    assert_eq!(sim.counts().idle_commands, 1);
}

/// The new pile's own uplift and folds drive it from the next step on, while the push goes on.
#[test]
fn another_pile_under_a_push_is_driven_as_its_own_layers_are() {
    let mut sim = played("range_jura");
    run(&mut sim, 1e6);
    let before = sim.node_uplift().iter().copied().fold(0.0, f64::max);
    order(&mut sim, Action::Layers("southern_alps".to_owned()));
    run(&mut sim, 1e5);
    let after = sim.node_uplift().iter().copied().fold(0.0, f64::max);
    // The one rises as a whole at 1.2 of the thickening, the other at 0.2.
    assert!((after / before - 6.0).abs() < 0.5, "{before} and {after}");
    assert_eq!(sim.world().strata.folds().count(), 0, "one schist does not fold");
}

/// What is missing between the first surface and the ground is what rivers and slides took and did not lay down.
#[test]
fn rock_that_is_gone_from_the_pile_is_what_erosion_took() {
    let mut sim = played("range_southern_alps");
    run(&mut sim, 2e6);
    let world = sim.world();
    let areas = world.tin.areas();
    let start = orogen::terrain::StartLand::new(world.seed).heights(&world.tin);
    let gone: f64 = (0..areas.len())
        .map(|i| areas[i] * (world.strata.column(&world.stratigraphy, i).height(0) - (world.z[i] - start[i])))
        .sum();
    let totals = world.totals;
    let taken = totals.eroded_m3 - totals.deposited_m3;
    assert!(taken > 1e11, "a range was eroded: {taken} m³");
    assert!((gone / taken - 1.0).abs() < 1e-6, "{gone} m³ of {taken} m³");
}
