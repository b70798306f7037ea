//! The gesture corpus, played on real land: what each recording promises is what happens.
//!
//! Each file states where the land must have changed within a second after a moment, or that nothing may change.
//! The untouched land beside it is the same world played without the file's input, so that erosion alone proves
//! nothing. Beside that, coarse golden facts catch what drifts.
//!
//! To re-mint the golden facts after a change that is meant: run
//! `cargo test --test gesture corpus:: -- --nocapture`, look at the pictures of the recordings that changed
//! (`orogen replay gestures/NAME.gesture.jsonl`), and copy the printed rows.

use std::fs;
use std::path::PathBuf;

use orogen::gesture::command::Mode;
use orogen::gesture::file::{GestureFile, read_gesture};
use orogen::report::RangeFacts;
use orogen::sim::{Sim, SimParams, TICK_US, World};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};
use rayon::prelude::*;

/// The paper's node count, and the floor.
const NODES: usize = 10_000;
/// A change that a visitor sees, metres: two contour steps of a hiking map.
const VISIBLE: f64 = 20.0;
/// Nodes within this distance of a place answer for it, metres (two spacings of 10,000 nodes).
const AROUND: f64 = 2_700.0;

fn files() -> Vec<(String, GestureFile)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("gestures");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)
        .expect("gestures")
        .map(|entry| entry.expect("entry").path())
        .collect();
    paths.sort();
    paths
        .into_iter()
        .filter(|path| path.extension().is_some_and(|e| e == "jsonl"))
        .map(|path| {
            let name = path
                .file_name()
                .expect("name")
                .to_string_lossy()
                .replace(".gesture.jsonl", "");
            let file = read_gesture(fs::File::open(&path).expect("file"), &name).expect("a good file");
            (name, file)
        })
        .filter(|(_, file)| file.header.mode == Mode::Mountain)
        .collect()
}

fn sim(file: &GestureFile) -> Sim {
    let map = PlanMap::new(file.header.size_mm, DEFAULT_SHORT_SIDE);
    let world = World::new(map, NODES, file.header.seed.unwrap_or(1)).expect("a world");
    let mut params = SimParams::default();
    if let Some(years) = file.header.years {
        params.run_on_yr = years;
    }
    Sim::new(world, params)
}

fn advance(sim: &mut Sim, until_us: u64) {
    while sim.ticks() * TICK_US < until_us {
        sim.tick();
    }
}

/// Cells of 1024² that may turn over where the land rises. Eq. 2 tears the crust close behind a hand that pushes
/// (e·Σ|Δ|/d^e > 1), and among three plates a belt of two others may rise there; in front of a hand the cap of the
/// motion keeps cells upright.
const MOST_FOLDED: usize = 2_000;

/// What one recording did.
struct Outcome {
    name: String,
    faults: Vec<String>,
    row: String,
}

fn play(name: &str, file: &GestureFile) -> Outcome {
    let (mut touched, mut untouched) = (sim(file), sim(file));
    for frame in &file.frames {
        touched.feed(frame.clone());
    }
    let expect = file
        .header
        .expect
        .clone()
        .expect("each recording states what must be seen");
    let mut faults = Vec::new();
    let mut places = expect.land_changes_at.clone();
    places.sort_by_key(|place| place.t_us);
    for place in &places {
        let by = place.t_us + 1_000_000;
        advance(&mut touched, by);
        advance(&mut untouched, by);
        let at = touched.world().map.to_plan(place.at);
        let change = touched
            .world()
            .tin
            .positions()
            .iter()
            .zip(touched.world().z.iter().zip(&untouched.world().z))
            .filter(|(p, _)| p.distance(at) < AROUND)
            .map(|(_, (a, b))| (a - b).abs())
            .fold(0.0, f64::max);
        if change < VISIBLE {
            faults.push(format!(
                "at {} mm the land moved by {change:.1} m until {} ms",
                place.at,
                by / 1000
            ));
        }
    }
    while touched.input_waits() {
        touched.tick();
        untouched.tick();
    }
    touched.finish_input();
    if expect.nothing && touched.world().z != untouched.world().z {
        faults.push("the land was to stay as it is, to the bit".into());
    }
    if !expect.nothing && places.is_empty() {
        faults.push("neither a place nor `nothing` is promised".into());
    }
    touched.run_on(|_, _| true);
    let (stats, counts) = (touched.contact_stats(), touched.counts());
    if counts.dead_touches > 0 {
        faults.push(format!("{} dead touches", counts.dead_touches));
    }
    if touched.quarantine() != orogen::sim::Quarantine::default() {
        faults.push(format!("{:?}", touched.quarantine()));
    }
    if let Some(motion) = touched.last_motion()
        && motion.folded_rising_cells > MOST_FOLDED
    {
        faults.push(format!(
            "{} cells turned over where the land rises",
            motion.folded_rising_cells
        ));
    }
    let z = &touched.world().z;
    let highest = z.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = z.iter().copied().fold(f64::INFINITY, f64::min);
    // Coarse on purpose: a change of a few metres is no fact, a range that is gone is one.
    let row = format!(
        "(\"{name}\", {}, {}, {}, {:.1}, {:.1}),",
        stats.pushes,
        stats.taps,
        touched.world().plates.plates().len(),
        (highest / 100.0).round() / 10.0,
        (lowest / 100.0).round() / 10.0,
    );
    Outcome {
        name: name.to_owned(),
        faults,
        row,
    }
}

/// Name, pushes, taps, plates at the end, highest and lowest point in km (to 100 m).
type Row = (&'static str, u64, u64, usize, f64, f64);

const GOLDEN: &[Row] = &[
    ("builtin_session", 4, 0, 5, 2.1, -0.2),
    ("cancel", 1, 0, 1, 1.5, -0.1),
    ("confidence_lost", 0, 0, 0, 0.2, -0.1),
    ("drumming", 0, 16, 0, 0.6, -0.1),
    ("finished_range_eroding", 1, 0, 2, 0.5, -0.1),
    ("flicker", 1, 0, 1, 1.9, -0.1),
    ("folds_edited", 1, 0, 2, 1.1, -0.1),
    ("four_visitors", 4, 0, 4, 2.3, -0.3),
    ("hand_rests_other_pushes", 1, 0, 2, 2.0, -0.1),
    ("id_reuse", 3, 0, 3, 0.9, -0.1),
    ("late_finger", 1, 0, 1, 1.7, -0.1),
    ("neighbour_leaning_in", 1, 0, 1, 1.8, -0.1),
    ("oblique_push", 1, 0, 2, 2.1, -0.1),
    ("one_finger_push", 1, 0, 1, 1.6, -0.1),
    ("palm_and_sleeve", 1, 0, 1, 1.4, -0.1),
    ("palm_flickers", 1, 3, 1, 1.6, -0.1),
    ("palm_only", 0, 0, 0, 0.2, -0.1),
    ("pinch_and_spread", 4, 0, 4, 1.2, -0.1),
    ("pull_apart", 2, 0, 2, 1.9, -0.2),
    ("pulling_towards_oneself", 1, 0, 1, 2.0, -0.2),
    ("range_andes", 3, 0, 6, 2.1, -0.2),
    ("range_digne", 1, 0, 2, 1.3, -0.1),
    ("range_jura", 2, 0, 4, 1.0, -0.1),
    ("range_southern_alps", 1, 0, 2, 2.5, -0.1),
    ("range_zagros", 3, 0, 6, 1.9, -0.2),
    ("rubbing", 7, 0, 1, 1.9, -0.1),
    ("same_push_again", 2, 0, 1, 1.4, -0.1),
    ("sleeve_sweeps", 0, 0, 0, 0.2, -0.1),
    ("slapping", 0, 2, 0, 0.2, -0.1),
    ("slow_and_fast", 2, 0, 2, 1.3, -0.1),
    ("stuck_contact", 2, 0, 3, 1.5, -0.1),
    ("ten_fingers", 2, 0, 2, 1.0, -0.1),
    ("three_plates", 3, 0, 3, 2.1, -0.1),
    ("twisting_hand", 1, 0, 1, 1.3, -1.2),
    ("two_equal_pushes", 2, 0, 2, 2.3, -0.1),
    ("two_hands_push", 1, 0, 2, 2.3, -0.1),
    ("writing_a_name", 8, 0, 4, 1.8, -0.2),
];

#[test]
fn recordings_keep_their_promises() {
    let outcomes: Vec<Outcome> = files().par_iter().map(|(name, file)| play(name, file)).collect();
    let mut faults = Vec::new();
    for outcome in &outcomes {
        println!("{}", outcome.row);
        faults.extend(
            outcome
                .faults
                .iter()
                .map(|fault| format!("{}: {fault}", outcome.name)),
        );
    }
    let golden: Vec<String> = GOLDEN
        .iter()
        .map(|(name, pushes, taps, plates, high, low)| {
            format!("(\"{name}\", {pushes}, {taps}, {plates}, {high:.1}, {low:.1}),")
        })
        .collect();
    let found: Vec<String> = outcomes.into_iter().map(|outcome| outcome.row).collect();
    for row in &found {
        if !golden.contains(row) {
            faults.push(format!("not golden: {row}"));
        }
    }
    assert_eq!(golden.len(), found.len(), "one golden row per recording");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Two wide hands pushed together give a range that reads as one, at the default settings and node count.
#[test]
fn a_range_reads_as_a_range() {
    let (_, file) = files()
        .into_iter()
        .find(|(name, _)| name == "two_hands_push")
        .expect("shipped");
    let map = PlanMap::new(file.header.size_mm, DEFAULT_SHORT_SIDE);
    let world = World::new(map, 60_000, file.header.seed.unwrap_or(1)).expect("a world");
    let mut sim = Sim::new(world, SimParams::default());
    for frame in &file.frames {
        sim.feed(frame.clone());
    }
    while sim.input_waits() {
        sim.tick();
    }
    sim.finish_input();
    sim.run_on(|_, _| true);
    let risen = sim.world().strata.base();
    let range = RangeFacts::new(&sim.world().tin, &sim.world().z, &sim.flow(), risen);
    println!("{range:?}");
    // The push goes west, so the strike is north–south.
    let off_strike = range.divide_azimuth_deg.min(180.0 - range.divide_azimuth_deg);
    assert!(
        off_strike < 30.0,
        "the divide runs along the strike: {off_strike}° off"
    );
    assert!(
        range.front_drainage_fraction > 0.5,
        "most water leaves across the fronts"
    );
    assert!(
        range.relief_10km_m < 3_300.0,
        "relief {} m within 10 km",
        range.relief_10km_m
    );
    assert!(
        (20.0..28.0).contains(&range.mean_slope_deg),
        "mean slope {}°",
        range.mean_slope_deg
    );
}

/// Every pile makes a range that reads as one, gentler over soft rock: along its strike (degrees from north, at right
/// angles to the motion), with two fronts. The measure finds no divide on the broad back of the Andes, where neighbouring
/// streams leave close to each other; there only relief and slope are held.
#[test]
fn every_pile_makes_a_range_that_reads_as_one() {
    let strikes = [
        ("range_jura", Some(0.0)),
        ("range_zagros", Some(90.0)),
        ("range_andes", None),
        // Half-way between the normals of the motion and of the line that joins the plates.
        ("range_southern_alps", Some(24.0)),
        ("range_digne", Some(0.0)),
    ];
    let wrong: Vec<String> = strikes
        .par_iter()
        .filter_map(|&(name, strike)| {
            let (_, file) = files()
                .into_iter()
                .find(|(found, _)| found == name)
                .expect("shipped");
            let map = PlanMap::new(file.header.size_mm, DEFAULT_SHORT_SIDE);
            let world = World::new(map, 60_000, file.header.seed.unwrap_or(1)).expect("a world");
            let mut sim = Sim::new(world, SimParams::default());
            for frame in &file.frames {
                sim.feed(frame.clone());
            }
            while sim.input_waits() {
                sim.tick();
            }
            sim.finish_input();
            sim.run_on(|_, _| true);
            let world = sim.world();
            let range = RangeFacts::new(&world.tin, &world.z, &sim.flow(), world.strata.base());
            let lies_along = strike.is_none_or(|strike: f64| {
                let off = (range.divide_azimuth_deg - strike).rem_euclid(180.0);
                off.min(180.0 - off) < 30.0 && range.front_drainage_fraction > 0.5
            });
            let reads = lies_along
                && (1_000.0..3_300.0).contains(&range.relief_10km_m)
                && (8.0..30.0).contains(&range.mean_slope_deg);
            (!reads).then(|| format!("{name}: {range:?}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
