//! Hand events become plates: frames, caps, groups, spans, domes, fault sides, editing.

use glam::DVec2;
use orogen::gesture::contact::Side;
use orogen::gesture::event::{HandEvent, HandId, Leg};
use orogen::gesture::rigid::RigidFit;
use orogen::mountain::plate::{FaultSide, MAX_DOMES, MAX_PLATES, Pair};
use orogen::mountain::{Applied, MountainParams, PlateId, PlateSet, PlateState};
use orogen::units::{DEFAULT_SHORT_SIDE, KM, MYR, PlanMap};

fn table() -> PlanMap {
    PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE)
}

fn fingers(at: [f64; 2]) -> Vec<DVec2> {
    [[-8.0, -5.0], [-4.0, 6.0], [1.0, 8.0], [6.0, 6.0], [8.0, 0.0]]
        .map(|f| (DVec2::from_array(at) + DVec2::from_array(f)) * KM)
        .to_vec()
}

fn mm(points: &[DVec2]) -> Vec<DVec2> {
    points.iter().map(|&p| table().to_table(p)).collect()
}

fn push(hand: u32, index: u32, starts: &[DVec2], by: [f64; 2]) -> HandEvent {
    let tips: Vec<DVec2> = starts.iter().map(|&p| p + DVec2::from_array(by) * KM).collect();
    HandEvent::Push {
        leg: Leg {
            hand: HandId(hand),
            index,
        },
        side: Side::South,
        starts: mm(starts),
        fit: RigidFit::fit(&mm(starts), &mm(&tips)),
    }
}

fn rest(hand: u32, at: &[DVec2]) -> HandEvent {
    HandEvent::Rest {
        hand: HandId(hand),
        side: Side::North,
        fingers: mm(at),
    }
}

struct Bench {
    plates: PlateSet,
    params: MountainParams,
}

impl Bench {
    fn new() -> Self {
        Self {
            plates: PlateSet::default(),
            params: MountainParams::default(),
        }
    }

    fn apply(&mut self, event: &HandEvent, now_yr: f64) -> Applied {
        self.plates.apply(event, &table(), now_yr, &self.params)
    }

    fn plate(&mut self, event: &HandEvent, now_yr: f64) -> PlateId {
        match self.apply(event, now_yr) {
            Applied::Plate(id) => id,
            other => panic!("{other:?}"),
        }
    }

    fn state(&self, id: PlateId, now_yr: f64) -> PlateState {
        self.plates.get(id).expect("plate").state(now_yr)
    }
}

#[test]
fn a_turn_on_the_table_is_the_same_turn_on_the_ground() {
    let mut bench = Bench::new();
    let starts = fingers([90.0, 50.0]);
    let centre = DVec2::new(90.0, 50.0) * KM;
    let tips: Vec<DVec2> = starts
        .iter()
        .map(|&p| DVec2::from_angle(0.4).rotate(p - centre) + centre + DVec2::new(3.0, 2.0) * KM)
        .collect();
    let event = HandEvent::Push {
        leg: Leg {
            hand: HandId(1),
            index: 0,
        },
        side: Side::South,
        starts: mm(&starts),
        fit: RigidFit::fit(&mm(&starts), &mm(&tips)),
    };
    let id = bench.plate(&event, 0.0);
    let plate = bench.plates.get(id).expect("plate");
    assert!(
        (plate.motion.angle - 0.4).abs() < 1e-9,
        "north is up, so the turn keeps its sense"
    );
    for ((_, arrow), tip) in plate.arrows().zip(&tips) {
        assert!((arrow - *tip).length() < 1e-3);
    }
    assert!(plate.support.contains(starts[0]) && plate.moved_support().contains(tips[0]));
}

#[test]
fn a_push_is_extended_while_it_moves_and_then_stands() {
    let mut bench = Bench::new();
    let starts = fingers([120.0, 50.0]);
    let id = bench.plate(&push(1, 0, &starts, [-4.0, 0.0]), 0.0);
    assert_eq!(bench.plate(&push(1, 0, &starts, [-9.0, 0.0]), 0.5 * MYR), id);
    bench.apply(
        &HandEvent::PushEnd {
            leg: Leg {
                hand: HandId(1),
                index: 0,
            },
        },
        0.6 * MYR,
    );
    assert_eq!(bench.state(id, 5.4 * MYR), PlateState::Pushing);
    assert!(bench.plates.active(5.4 * MYR, &bench.params));
    assert_eq!(bench.state(id, 5.6 * MYR), PlateState::Standing);
    assert!(!bench.plates.active(5.6 * MYR, &bench.params));
    assert!(
        bench.plates.bodies(5.6 * MYR).is_empty(),
        "spent plates leave Eq. 2"
    );
    assert_eq!(bench.plates.get(id).expect("plate").spent(5.6 * MYR), 1.0);

    // A hand on the standing support pushes the same plate again, from where it stands.
    let again = bench.plate(&push(2, 0, &fingers([111.0, 50.0]), [-5.0, 0.0]), 6.0 * MYR);
    assert_eq!(again, id);
    assert_eq!(bench.plates.plates().len(), 1);
    let plate = bench.plates.get(id).expect("plate");
    assert!((plate.support.centre().x - (plate.moved_support().centre().x + 5.0 * KM)).abs() < 1.0);
    assert_eq!(bench.state(id, 10.9 * MYR), PlateState::Pushing);
}

#[test]
fn anchors_stand_while_held_and_a_span_after() {
    let mut bench = Bench::new();
    let id = bench.plate(&rest(3, &fingers([50.0, 50.0])), 0.0);
    assert_eq!(bench.state(id, 50.0 * MYR), PlateState::Resting);
    bench.apply(&HandEvent::Lift { hand: HandId(3) }, 50.0 * MYR);
    assert_eq!(bench.state(id, 54.9 * MYR), PlateState::Resting);
    assert_eq!(bench.state(id, 55.1 * MYR), PlateState::Standing);
    // It becomes a drag when it moves.
    let mut bench = Bench::new();
    let id = bench.plate(&rest(3, &fingers([50.0, 50.0])), 0.0);
    assert_eq!(
        bench.plate(&push(3, 0, &fingers([50.0, 50.0]), [6.0, 0.0]), 1.0),
        id
    );
    assert_eq!(bench.state(id, 2.0), PlateState::Pushing);
}

#[test]
fn a_push_longer_than_the_gap_is_capped_and_says_so() {
    let mut bench = Bench::new();
    bench.plate(&rest(1, &fingers([50.0, 50.0])), 0.0);
    let starts = fingers([110.0, 50.0]);
    let mut last = f64::INFINITY;
    for by in [-10.0, -25.0, -40.0, -80.0] {
        let id = bench.plate(&push(2, 0, &starts, [by, 0.0]), 0.0);
        let bodies = bench.plates.bodies(0.0);
        let first = bodies[0].support.distance_to(&bodies[1].support);
        let moved = |i: usize| bodies[i].support.moved(&bodies[i].motion);
        let gap = moved(0).distance_to(&moved(1));
        assert!(
            gap >= 0.35 * first - 1.0 && gap <= last + 1.0,
            "{by}: {gap} of {first}"
        );
        last = gap;
        let plate = bench.plates.get(id).expect("plate");
        assert_eq!(plate.cap < 1.0, by < -20.0, "{by}: {}", plate.cap);
        assert!((plate.motion.translation.x - plate.cap * by * KM).abs() < 1.0);
    }
}

#[test]
fn overlapping_anchors_are_one_body_and_hands_do_not_take_each_others_plates() {
    let mut bench = Bench::new();
    let first = bench.plate(&rest(1, &fingers([60.0, 50.0])), 0.0);
    let second = bench.plate(&rest(2, &fingers([72.0, 50.0])), 0.0);
    assert_ne!(first, second, "held by another hand");
    assert_eq!(bench.plates.bodies(0.0).len(), 1);
}

#[test]
fn at_most_sixteen_plates_and_sixty_four_domes() {
    let mut bench = Bench::new();
    for hand in 0..20_u32 {
        let at = [
            20.0 + 8.0 * f64::from(hand % 18),
            8.0 + 84.0 * f64::from(hand / 10),
        ];
        let spot = [DVec2::from_array(at) * KM];
        bench.plate(&push(hand, 0, &spot, [0.0, 1.0]), f64::from(hand) * 0.01 * MYR);
        bench.apply(
            &HandEvent::PushEnd {
                leg: Leg {
                    hand: HandId(hand),
                    index: 0,
                },
            },
            f64::from(hand) * 0.01 * MYR,
        );
    }
    assert!(bench.plates.plates().len() <= MAX_PLATES);
    let tap = |n: usize| HandEvent::Tap {
        hand: HandId(99),
        side: Side::South,
        fingers: vec![DVec2::new(300.0, 300.0); n],
    };
    assert_eq!(bench.apply(&tap(5), 0.0), Applied::Domes(5));
    for _ in 0..20 {
        bench.apply(&tap(5), 0.0);
    }
    assert_eq!(bench.plates.domes().len(), MAX_DOMES);
    assert_eq!(bench.apply(&tap(0), 1.0 * MYR), Applied::Unchanged);
    assert!(bench.plates.domes().is_empty(), "they have risen");
}

#[test]
fn the_resting_plate_is_stable_and_a_tap_flips_the_fault() {
    let mut bench = Bench::new();
    let pusher = bench.plate(&push(1, 0, &fingers([120.0, 50.0]), [-12.0, 0.0]), 0.0);
    let anchor = bench.plate(&rest(2, &fingers([50.0, 50.0])), 0.0);
    let pair = Pair::of(pusher, anchor);
    assert_eq!(
        bench.plates.fault_side(pair),
        FaultSide::Second,
        "the younger one rests"
    );
    // Latched: the anchor begins to push faster, the fault stays.
    bench.plate(&push(2, 0, &fingers([50.0, 50.0]), [15.0, 0.0]), 0.0);
    assert_eq!(bench.plates.fault_side(pair), FaultSide::Second);
    bench.plates.flip_fault(pair);
    assert_eq!(bench.plates.fault_side(pair), FaultSide::First);
}

#[test]
fn editing_removes_adds_and_drags() {
    let mut bench = Bench::new();
    let id = bench.plate(&push(1, 0, &fingers([120.0, 50.0]), [-6.0, 0.0]), 0.0);
    let params = bench.params.clone();
    let tip = bench
        .plates
        .get(id)
        .expect("plate")
        .arrows()
        .next()
        .expect("arrow")
        .1;
    let pulled = bench
        .plates
        .drag_tip(tip + DVec2::X, tip - DVec2::X * 10.0 * KM, 2.0 * KM, 1.0, &params);
    assert_eq!(pulled, Some(id));
    let motion = bench.plates.get(id).expect("plate").motion;
    assert!(motion.angle != 0.0, "one tip of five turns the plate");
    let foot = DVec2::new(120.0, 50.0) * KM;
    assert_eq!(
        bench
            .plates
            .add_arrow(foot, foot - DVec2::X * 8.0 * KM, 1.0, &params),
        Some(id)
    );
    assert_eq!(bench.plates.get(id).expect("plate").starts.len(), 6);
    assert_eq!(bench.plates.remove_at(DVec2::ZERO, 1.0, &params), None);
    assert_eq!(bench.plates.remove_at(foot, 1.0, &params), Some(id));
    assert!(bench.plates.plates().is_empty());
}

#[test]
fn nonsense_from_outside_changes_nothing() {
    let mut bench = Bench::new();
    let nan = HandEvent::Rest {
        hand: HandId(1),
        side: Side::South,
        fingers: vec![DVec2::NAN],
    };
    assert_eq!(bench.apply(&nan, 0.0), Applied::Unchanged);
    let unknown = HandEvent::PushEnd {
        leg: Leg {
            hand: HandId(7),
            index: 3,
        },
    };
    assert_eq!(bench.apply(&unknown, 0.0), Applied::Unchanged);
    assert!(bench.plates.plates().is_empty());
}
