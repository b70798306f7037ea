//! From gestures to uplift: what a range looks like, that nothing pops, and that nothing breaks.

use glam::DVec2;
use orogen::gesture::contact::Side;
use orogen::gesture::event::{HandEvent, HandId, Leg};
use orogen::gesture::rigid::RigidFit;
use orogen::mountain::{MountainParams, PlateSet, TectonicField, Tectonics};
use orogen::units::{DEFAULT_SHORT_SIDE, KM, MYR, PlanMap};
use proptest::prelude::*;

fn table() -> PlanMap {
    PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE)
}

/// Few cells: shapes of kilometres need no more.
fn params() -> MountainParams {
    MountainParams {
        cells: 384 * 384,
        ..MountainParams::default()
    }
}

/// A hand of five: middle, push and turn; no push rests.
#[derive(Clone, Copy, Debug)]
struct Hand {
    at: DVec2,
    push: DVec2,
    turn: f64,
}

fn hand(at: [f64; 2], push: [f64; 2]) -> Hand {
    Hand {
        at: DVec2::from_array(at) * KM,
        push: DVec2::from_array(push) * KM,
        turn: 0.0,
    }
}

const SPREAD: [[f64; 2]; 5] = [[-4.0, -9.0], [6.0, -5.5], [8.5, 0.0], [6.0, 5.5], [-4.0, 9.0]];

fn plates(hands: &[Hand], params: &MountainParams) -> PlateSet {
    let map = table();
    let mut plates = PlateSet::default();
    for (index, hand) in hands.iter().enumerate() {
        let id = HandId(index as u32);
        // Fingers point along the push, thumbs behind.
        let facing = hand.push.normalize_or(DVec2::X);
        let starts: Vec<DVec2> = SPREAD
            .iter()
            .map(|&f| hand.at + facing.rotate(DVec2::from_array(f)) * KM)
            .collect();
        let spin = DVec2::from_angle(hand.turn);
        let tips: Vec<DVec2> = starts
            .iter()
            .map(|&p| spin.rotate(p - hand.at) + hand.at + hand.push)
            .collect();
        let mm = |points: &[DVec2]| points.iter().map(|&p| map.to_table(p)).collect::<Vec<_>>();
        let event = if starts == tips {
            HandEvent::Rest {
                hand: id,
                side: Side::South,
                fingers: mm(&starts),
            }
        } else {
            HandEvent::Push {
                leg: Leg { hand: id, index: 0 },
                side: Side::South,
                fit: RigidFit::fit(&mm(&starts), &mm(&tips)),
                starts: mm(&starts),
            }
        };
        plates.apply(&event, &map, 0.0, params);
    }
    plates
}

fn field(hands: &[Hand], params: &MountainParams) -> TectonicField {
    Tectonics::default().compute(&plates(hands, params), table().extent(), 0.1 * MYR, params)
}

fn two_hands() -> [Hand; 2] {
    [hand([50.0, 50.0], [0.0, 0.0]), hand([125.0, 50.0], [-16.0, 0.0])]
}

/// Mean position, and the extent along x and y (standard deviations), of what rises.
fn moments(field: &TectonicField) -> (DVec2, DVec2, f64) {
    let (mut sum, mut mean, mut square) = (0.0, DVec2::ZERO, DVec2::ZERO);
    let grid = field.uplift.grid;
    for row in 0..grid.rows {
        for col in 0..grid.cols {
            let u = f64::from(field.uplift.data[row * grid.cols + col]).max(0.0);
            let p = grid.centre(col, row);
            sum += u;
            mean += p * u;
            square += p * p * u;
        }
    }
    let mean = mean / sum;
    (mean, (square / sum - mean * mean).powf(0.5), sum)
}

#[test]
fn two_hands_raise_a_range_across_the_push() {
    let field = field(&two_hands(), &params());
    let report = field.report;
    assert!((3.5e-4..7e-4).contains(&report.mean_uplift), "{report:?}");
    assert!((8e-4..1.3e-3).contains(&report.max_uplift), "{report:?}");
    assert_eq!(report.folded_rising_cells, 0);
    let (mean, spread, _) = moments(&field);
    assert!(spread.y > 1.3 * spread.x, "longer than wide: {spread}");
    assert!((mean.y - 50.0 * KM).abs() < 5.0 * KM);

    // The highest uplift of each section in the core of the range lies in the middle third of the gap.
    let (west, east) = (63.0 * KM, 96.0 * KM);
    for y in [42.0, 46.0, 50.0, 54.0, 58.0] {
        let best = (0..400)
            .map(|i| west + (east - west) * f64::from(i) / 399.0)
            .max_by(|a, b| {
                let u = |x: f64| field.uplift_at(DVec2::new(x, y * KM));
                u(*a).total_cmp(&u(*b))
            })
            .expect("some");
        let part = (best - west) / (east - west);
        assert!((0.27..0.67).contains(&part), "at {y}: {part}");
    }

    // Steep at the resting hand, gentle behind; the fault runs along the steep foot with the range to its left.
    let steepest = |from: f64, to: f64| {
        (0..200)
            .map(|i| from + (to - from) * f64::from(i) / 199.0)
            .map(|x| {
                let u = |x: f64| field.uplift_at(DVec2::new(x, 50.0 * KM));
                (u(x + 500.0) - u(x - 500.0)).abs()
            })
            .fold(0.0, f64::max)
    };
    let middle = f64::midpoint(west, east);
    assert!(steepest(west, middle) > 1.5 * steepest(middle, east));
    let fault = field
        .faults
        .iter()
        .max_by(|a, b| a.length().total_cmp(&b.length()))
        .expect("a fault");
    assert!(fault.length() > 25.0 * KM);
    for ends in fault.points.windows(2) {
        assert!(ends[0].x < middle + 8.0 * KM);
        let left = (ends[1] - ends[0]).perp().normalize_or_zero() * 400.0;
        let (range, foreland) = (field.uplift_at(ends[0] + left), field.uplift_at(ends[0] - left));
        assert!(range >= foreland, "{range} {foreland} at {ends:?}");
    }
    assert_eq!(field.fault_near(fault.points[3], 1_000.0), Some(fault.pair));
    assert_eq!(field.fault_near(DVec2::ZERO, 1_000.0), None);
}

#[test]
fn a_flipped_fault_puts_the_steep_front_on_the_other_side() {
    let params = params();
    let mut plates = plates(&two_hands(), &params);
    let mut tectonics = Tectonics::default();
    let before = tectonics.compute(&plates, table().extent(), 0.1 * MYR, &params);
    plates.flip_fault(before.faults[0].pair);
    let after = tectonics.compute(&plates, table().extent(), 0.1 * MYR, &params);
    let x = |f: &TectonicField| {
        f.faults[0].points.iter().map(|p| p.x).sum::<f64>() / f.faults[0].points.len() as f64
    };
    assert!(x(&after) > x(&before) + 10.0 * KM);
}

#[test]
fn one_hand_alone_raises_a_steep_front_and_a_long_back() {
    let field = field(&[hand([125.0, 50.0], [-16.0, 0.0])], &params());
    // The hull's front is at 125 − 16 − 8.5 − 4.5 km.
    let front = 96.0 * KM;
    let u = |ahead: f64| field.uplift_at(DVec2::new(front - ahead * KM, 50.0 * KM));
    let crest = (0..45)
        .map(f64::from)
        .max_by(|a, b| u(*a).total_cmp(&u(*b)))
        .expect("some");
    assert!(u(crest) > 5e-4);
    assert!((5.0..15.0).contains(&crest), "{crest}");
    assert!(u(25.0) > 0.15 * u(crest), "a long back");
    assert!(u(-20.0) == 0.0 && u(45.0) < 0.05 * u(crest));
}

#[test]
fn plates_pulled_apart_sink_a_rift_and_nothing_sinks_behind_one_that_pushes() {
    let params = params();
    let apart = field(
        &[hand([70.0, 50.0], [-10.0, 0.0]), hand([110.0, 50.0], [10.0, 0.0])],
        &params,
    );
    let middle = apart.uplift_at(DVec2::new(90.0, 50.0) * KM);
    assert!(
        (-params.sink_limit..-0.5 * params.sink_limit).contains(&middle),
        "{middle}"
    );
    assert!(field(&two_hands(), &params).report.min_uplift == 0.0);
    assert!(
        field(&[hand([100.0, 50.0], [-16.0, 0.0])], &params)
            .report
            .min_uplift
            == 0.0
    );
}

#[test]
fn every_gesture_answers() {
    let params = params();
    // A visible change within a second of model time (0.5 My): some tens of metres.
    let answers = |f: &TectonicField| f.report.max_uplift.max(-f.report.min_uplift) * 0.5 * MYR;
    let mut twist = hand([90.0, 50.0], [0.0, 0.0]);
    twist.turn = 0.6;
    for (name, hands) in [
        ("twist", vec![twist]),
        ("small push", vec![hand([90.0, 50.0], [2.0, 0.0])]),
        (
            "equal pushes",
            vec![hand([50.0, 50.0], [8.0, 0.0]), hand([120.0, 50.0], [-8.0, 0.0])],
        ),
        (
            "side by side",
            vec![hand([80.0, 25.0], [10.0, 0.0]), hand([80.0, 75.0], [10.0, 0.0])],
        ),
        (
            "past each other",
            vec![hand([70.0, 25.0], [10.0, 0.0]), hand([110.0, 75.0], [-10.0, 0.0])],
        ),
        (
            "a chase",
            vec![hand([100.0, 50.0], [6.0, 0.0]), hand([50.0, 50.0], [14.0, 0.0])],
        ),
    ] {
        let risen = answers(&field(&hands, &params));
        assert!(risen > 25.0, "{name}: {risen} m");
    }
    // Drumming raises domes to their height, then they are done.
    let mut plates = PlateSet::default();
    let tap = HandEvent::Tap {
        hand: HandId(1),
        side: Side::North,
        fingers: vec![DVec2::new(600.0, 300.0)],
    };
    plates.apply(&tap, &table(), 0.0, &params);
    let centre = table().to_plan(DVec2::new(600.0, 300.0));
    let mut tectonics = Tectonics::default();
    let rising = tectonics.compute(&plates, table().extent(), 0.1 * MYR, &params);
    assert!(
        (rising.uplift_at(centre) * params.dome_years - params.dome_height).abs() < 0.05 * params.dome_height
    );
    let done = tectonics.compute(&plates, table().extent(), 0.3 * MYR, &params);
    assert_eq!(done.report.max_uplift, 0.0);
    assert!(!plates.active(0.3 * MYR, &params));
}

/// Largest change of uplift anywhere.
fn change(a: &TectonicField, b: &TectonicField) -> f64 {
    let pairs = a.uplift.data.iter().zip(&b.uplift.data);
    pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max)
}

#[test]
fn small_changes_of_a_gesture_make_small_changes_of_the_land() {
    /// A tenth of a millimetre on the table is 15 m of land; where fronts are steepest (1.3 mm/yr over the 2 km that
    /// are left of them in a short gap), 15 m of shift are 2e-5, and a belt has two flanks and two ends to move.
    const STEP: f64 = 15.0;
    const ALLOWED: f64 = 4e-5;
    let params = params();
    let mut twisted = two_hands();
    twisted[1].turn = 0.2;
    let scenes: [Vec<Hand>; 6] = [
        two_hands().to_vec(),
        twisted.to_vec(),
        vec![hand([45.0, 42.0], [0.0, 0.0]), hand([125.0, 56.0], [-14.0, -8.0])],
        vec![hand([70.0, 50.0], [-10.0, 0.0]), hand([110.0, 50.0], [10.0, 0.0])],
        vec![
            hand([40.0, 40.0], [0.0, 0.0]),
            hand([110.0, 28.0], [-14.0, 3.0]),
            hand([95.0, 82.0], [-6.0, -12.0]),
        ],
        vec![
            hand([28.0, 22.0], [10.0, 6.0]),
            hand([150.0, 25.0], [-12.0, 8.0]),
            hand([40.0, 82.0], [8.0, -10.0]),
            hand([120.0, 80.0], [-8.0, -9.0]),
        ],
    ];
    let mut tectonics = Tectonics::default();
    let mut compute =
        |hands: &[Hand]| tectonics.compute(&plates(hands, &params), table().extent(), 0.1 * MYR, &params);
    for (index, scene) in scenes.iter().enumerate() {
        let before = compute(scene);
        for direction in [DVec2::X, DVec2::Y] {
            let mut nudged = scene.clone();
            let last = nudged.len() - 1;
            nudged[last].push += direction * STEP;
            let moved = change(&before, &compute(&nudged));
            assert!(moved < ALLOWED, "scene {index} towards {direction}: {moved}");
        }
        // A step a hundred times as large is seen by the comparison.
        let mut pushed = scene.clone();
        let last = pushed.len() - 1;
        pushed[last].push *= 1.25;
        assert!(change(&before, &compute(&pushed)) > ALLOWED, "scene {index}");
    }
}

#[test]
fn a_push_grows_without_jumps() {
    let params = params();
    let mut tectonics = Tectonics::default();
    let mut before: Option<TectonicField> = None;
    // From nothing, through the cap, to far beyond, 250 m at a time.
    for step in 0..200 {
        let hands = [
            hand([50.0, 50.0], [0.0, 0.0]),
            hand([125.0, 53.0], [-0.25 * f64::from(step), 0.0]),
        ];
        let now = tectonics.compute(&plates(&hands, &params), table().extent(), 0.1 * MYR, &params);
        if let Some(before) = &before {
            let moved = change(before, &now);
            assert!(moved < 2e-4, "step {step}: {moved}");
        }
        before = Some(now);
    }
}

#[test]
fn a_mirrored_gesture_raises_the_mirrored_range() {
    let params = MountainParams {
        sinuosity: 0.0,
        ..params()
    };
    let width = table().extent().width;
    let scene = [
        hand([45.0, 42.0], [0.0, 0.0]),
        hand([125.0, 56.0], [-14.0, -8.0]),
        hand([95.0, 88.0], [-2.0, -6.0]),
    ];
    let mirrored = scene.map(|h| Hand {
        at: DVec2::new(width - h.at.x, h.at.y),
        push: DVec2::new(-h.push.x, h.push.y),
        turn: -h.turn,
    });
    // The resting hand of the helper faces east: turn it by hand.
    let (one, other) = (field(&scene[1..], &params), field(&mirrored[1..], &params));
    let cols = one.uplift.grid.cols;
    let mut worst: f64 = 0.0;
    for (a, b) in one.uplift.data.chunks(cols).zip(other.uplift.data.chunks(cols)) {
        for (a, b) in a.iter().zip(b.iter().rev()) {
            worst = worst.max(f64::from((a - b).abs()));
        }
    }
    assert!(
        one.report.max_uplift > 1e-4 && worst < 1e-3 * one.report.max_uplift,
        "{worst}"
    );
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let params = params();
    let runs = [1, 2, 7].map(|threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool")
            .install(|| field(&two_hands(), &params))
    });
    assert_eq!(runs[0], runs[1]);
    assert_eq!(runs[0], runs[2]);
}

#[test]
fn reused_memory_gives_what_fresh_memory_gives() {
    let params = params();
    let mut tectonics = Tectonics::default();
    let extent = table().extent();
    let mut out = TectonicField::still(extent, &params);
    tectonics.compute_into(
        &plates(&two_hands(), &params),
        extent,
        0.1 * MYR,
        &params,
        &mut out,
    );
    let alone = plates(&[hand([90.0, 40.0], [5.0, 9.0])], &params);
    tectonics.compute_into(&alone, extent, 0.1 * MYR, &params, &mut out);
    assert_eq!(
        out,
        Tectonics::default().compute(&alone, extent, 0.1 * MYR, &params)
    );
}

#[test]
fn the_papers_rule_has_its_mean_whatever_the_push() {
    let params = MountainParams {
        cells: 256 * 256,
        ..MountainParams::paper()
    };
    for push in [-4.0, -16.0] {
        let field = field(
            &[hand([50.0, 50.0], [0.0, 0.0]), hand([125.0, 50.0], [push, 0.0])],
            &params,
        );
        assert!(
            (field.report.mean_uplift / params.paper_mean - 1.0).abs() < 1e-3,
            "{:?}",
            field.report
        );
        assert!(field.report.min_uplift >= 0.0, "no extension");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn whatever_hands_do_the_land_stays_bounded(
        hands in proptest::collection::vec(
            ((0.0..178.0_f64, 0.0..100.0_f64), (-70.0..70.0_f64, -70.0..70.0_f64), -3.0..3.0_f64, any::<bool>()),
            0..8,
        ),
    ) {
        let params = MountainParams { cells: 128 * 128, ..MountainParams::default() };
        let hands: Vec<Hand> = hands
            .into_iter()
            .map(|(at, push, turn, rests)| Hand {
                turn: if rests { 0.0 } else { turn },
                ..hand([at.0, at.1], if rests { [0.0, 0.0] } else { [push.0, push.1] })
            })
            .collect();
        let field = field(&hands, &params);
        for &u in &field.uplift.data {
            prop_assert!(u.is_finite());
            let u = f64::from(u);
            prop_assert!(u <= params.rise_limit && u >= -params.sink_limit);
        }
        prop_assert!(field.transport.q.data.iter().all(|q| q.is_finite()));
        for fault in &field.faults {
            prop_assert!(fault.points.iter().all(|p| p.is_finite()));
        }
    }
}
