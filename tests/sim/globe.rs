//! The session on the globe: hands lead, hold and tear plates, and turn the view; undo, roll-back, determinism.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use orogen::gesture::command::{Action, Paint, Place, Tool};
use orogen::gesture::contact::{InputFrame, Phase, Side};
use orogen::globe::Start;
use orogen::sim::TICK_US;
use orogen::sim::globe::{GlobeSim, GlobeSimParams, Grasp};
use orogen::sphere::{Lattice, RADIUS_KM, arc};
use orogen::surface::planet::{Grip, Planet};

use crate::sim_common::{SIZE_MM, command, drag, event, frame, lift, stroke};

const MIDDLE: DVec2 = DVec2::new(604.8, 340.2);

/// A small planet of few, large plates.
fn sim() -> GlobeSim {
    let lattice = Arc::new(Lattice::new(4000).expect("a lattice"));
    let start = Start::Random {
        plates: 8,
        continental: 0.3,
        seed: 5,
    };
    GlobeSim::new(lattice, start, SIZE_MM, GlobeSimParams::default()).expect("a planet")
}

fn play(sim: &mut GlobeSim, mut frames: Vec<InputFrame>, until_ms: u64) {
    frames.sort_by_key(|frame| frame.t_us);
    for frame in frames {
        sim.feed(frame);
    }
    while sim.ticks() * TICK_US <= until_ms * 1000 {
        sim.tick();
    }
}

/// All that one sees of a planet, as bits.
fn bits(planet: &Planet) -> Vec<u64> {
    let mut bits: Vec<u64> = planet
        .elevation_m
        .iter()
        .map(|z| u64::from(z.to_bits()))
        .collect();
    bits.extend(planet.plate.iter().map(|&plate| u64::from(plate)));
    for plate in &planet.plates {
        let rotation = plate.rotation.to_array().into_iter();
        bits.extend(rotation.chain(plate.omega.to_array()).map(f64::to_bits));
    }
    bits.push(planet.time_my.to_bits());
    bits
}

fn omega(sim: &GlobeSim, plate: u32) -> DVec3 {
    sim.planet().plate_state(plate).expect("the plate").1
}

fn grip(sim: &GlobeSim, plate: u32) -> Grip {
    let shown = sim.surface();
    let facts = shown.plates.iter().find(|facts| facts.id == plate);
    facts.expect("the plate").grip
}

#[test]
fn a_plate_follows_the_finger_and_is_no_faster_than_plates_are() {
    let mut sim = sim();
    let by = DVec2::new(90.0, 0.0);
    play(&mut sim, drag(1, MIDDLE, by, 96, 400), 96);
    let landed = sim.tethers();
    assert_eq!(landed.len(), 1, "the touch is answered in its tick");
    assert_eq!(landed[0].grasp, Grasp::Touching);
    assert!(arc(landed[0].held, landed[0].finger) < 1e-3);
    play(&mut sim, Vec::new(), 600);
    let plate = landed[0].plate;
    let goal = sim.view().cast(MIDDLE + by).expect("on the globe");
    let fastest = sim.params().globe.max_speed / RADIUS_KM;
    let mut missing = Vec::new();
    for ms in (600..6600).step_by(400) {
        play(&mut sim, Vec::new(), ms);
        let tether = sim.tethers()[0];
        assert_eq!((tether.plate, tether.grasp), (plate, Grasp::Leading));
        assert!(arc(tether.finger, goal) < 1e-9);
        missing.push(arc(tether.held, tether.finger));
        assert!(omega(&sim, plate).length() <= fastest * (1.0 + 1e-9));
    }
    assert!(missing[0] > 0.2, "1,800 km are not covered at once: {missing:?}");
    assert!(
        missing.windows(2).all(|pair| pair[1] < pair[0] + 1e-9),
        "it only comes nearer: {missing:?}"
    );
    assert!(missing[missing.len() - 1] < 1e-3, "it arrives: {missing:?}");
    assert!(sim.planet().totals().clamped > 0, "and the clamp is reported");
    assert_eq!(grip(&sim, plate), Grip::Led);
}

#[test]
fn a_lifted_hand_lets_its_plate_go() {
    let mut sim = sim();
    let by = DVec2::new(60.0, 0.0);
    let mut frames = drag(1, MIDDLE, by, 96, 160);
    frames.push(lift(272, 1, MIDDLE + by));
    play(&mut sim, frames, 800);
    let tether = sim.tethers()[0];
    assert_eq!(tether.grasp, Grasp::Lifted, "a flick goes on for a while");
    assert_eq!(grip(&sim, tether.plate), Grip::Led);
    let before = tether.held;
    play(&mut sim, Vec::new(), 1400);
    assert!(arc(sim.tethers()[0].held, tether.finger) < arc(before, tether.finger) - 0.01);
    play(&mut sim, Vec::new(), 4000);
    assert!(sim.tethers().is_empty());
    assert_eq!(grip(&sim, tether.plate), Grip::Free);
}

#[test]
fn a_resting_hand_anchors_its_plate_until_it_lifts() {
    let mut sim = sim();
    play(
        &mut sim,
        vec![frame(96, vec![event(Phase::Down, 1, MIDDLE)])],
        500,
    );
    let plate = sim.tethers()[0].plate;
    assert_eq!(grip(&sim, plate), Grip::Free, "too soon to tell");
    play(&mut sim, Vec::new(), 700);
    assert_eq!(sim.tethers()[0].grasp, Grasp::Resting);
    assert_eq!(grip(&sim, plate), Grip::Anchored);
    assert_eq!(omega(&sim, plate), DVec3::ZERO);
    let at = sim.planet().plate_state(plate).expect("the plate").0;
    play(&mut sim, Vec::new(), 3000);
    assert_eq!(sim.planet().plate_state(plate).expect("the plate").0, at);
    play(&mut sim, vec![lift(3016, 1, MIDDLE)], 4500);
    assert_eq!(grip(&sim, plate), Grip::Free);
    assert!(sim.tethers().is_empty());
    assert_eq!(sim.counts().anchored, 1);
}

/// Two places 160 mm apart that lie on one plate, well inside of it.
fn within_one_plate(sim: &GlobeSim) -> [DVec2; 2] {
    let plate = |mm: DVec2| sim.view().cast(mm).map(|place| sim.plate_shown_at(place));
    for row in -4..=4 {
        for column in -4..=4 {
            let middle = MIDDLE + DVec2::new(f64::from(column), f64::from(row)) * 30.0;
            let across = DVec2::new(110.0, 0.0);
            let around = [-1.4, -1.0, -0.5, 0.0, 0.5, 1.0, 1.4].map(|k| plate(middle + across * k));
            if around.iter().all(|found| found.is_some() && *found == around[0]) {
                return [middle - across, middle + across];
            }
        }
    }
    panic!("no plate is that large");
}

#[test]
fn two_hands_tear_a_plate_between_them_and_lead_the_parts_away() {
    let mut sim = sim();
    let [left, right] = within_one_plate(&sim);
    let by = DVec2::new(25.0, 0.0);
    let mut frames = drag(1, left, -by, 96, 320);
    frames.extend(drag(2, right, by, 96, 320));
    play(&mut sim, frames, 120);
    let plates: Vec<u32> = sim.tethers().iter().map(|tether| tether.plate).collect();
    assert_eq!(plates.len(), 2);
    assert_eq!(plates[0], plates[1], "both on one plate");
    let count = sim.planet().plate_ids().count();
    play(&mut sim, Vec::new(), 500);
    assert_eq!((sim.counts().torn, sim.counts().refused), (1, 0));
    assert_eq!(sim.planet().plate_ids().count(), count + 1);
    let tethers = sim.tethers();
    assert_ne!(tethers[0].plate, tethers[1].plate, "each hand has its part");
    let before = arc(tethers[0].held, tethers[1].held);
    play(&mut sim, Vec::new(), 2500);
    let after: Vec<DVec3> = sim.tethers().iter().map(|tether| tether.held).collect();
    assert!(arc(after[0], after[1]) > before + 0.05, "they part");
    assert_eq!(sim.counts().torn, 1, "once");
}

#[test]
fn hands_that_land_beside_the_globe_turn_it_and_nothing_else() {
    let (mut turned, mut untouched) = (sim(), sim());
    let beside = DVec2::new(60.0, 340.0);
    // Onto the globe and across it: what landed beside it stays beside it.
    let mut frames = drag(1, beside, DVec2::new(500.0, 0.0), 96, 800);
    frames.push(lift(912, 1, beside + DVec2::new(500.0, 0.0)));
    play(&mut turned, frames, 2000);
    play(&mut untouched, Vec::new(), 2000);
    assert!(turned.view().longitude_deg() < -45.0, "{:?}", turned.view());
    assert_eq!(bits(&turned.surface()), bits(&untouched.surface()));
    assert_eq!((turned.counts().led, turned.counts().views), (0, 1));
    // Two of them, going apart, zoom.
    let (left, right) = (DVec2::new(150.0, 100.0), DVec2::new(1060.0, 100.0));
    let mut frames = drag(2, left, DVec2::new(-100.0, 0.0), 2096, 400);
    frames.extend(drag(3, right, DVec2::new(100.0, 0.0), 2096, 400));
    let before = turned.view();
    play(&mut turned, frames, 2600);
    let zoom = turned.view().zoom() / before.zoom();
    assert!((zoom - 1110.0 / 910.0).abs() < 0.02, "{zoom}");
    assert!(turned.tethers().is_empty());
}

#[test]
fn the_view_tool_turns_the_globe_from_anywhere() {
    let mut sim = sim();
    let from = MIDDLE + DVec2::new(40.0, 60.0);
    let mut frames = vec![command(16, Action::Tool(Tool::View))];
    frames.extend(drag(1, from, DVec2::new(80.0, 0.0), 96, 400));
    let below = sim.view().cast(from).expect("on the globe");
    play(&mut sim, frames, 700);
    let seen = sim.view().project(below).expect("on the near side");
    assert!(
        seen.distance(from + DVec2::new(80.0, 0.0)) < 1.0,
        "the place follows the finger: {seen}"
    );
    assert!(sim.tethers().is_empty());
}

#[test]
fn a_tap_marks_its_plate_for_a_while() {
    let mut sim = sim();
    let at = MIDDLE + DVec2::new(-50.0, 30.0);
    let frames = vec![
        frame(96, vec![event(Phase::Down, 1, at)]),
        lift(176, 1, at),
        frame(192, vec![event(Phase::Down, 2, DVec2::new(20.0, 20.0))]),
        lift(272, 2, DVec2::new(20.0, 20.0)),
    ];
    play(&mut sim, frames, 400);
    let taps = sim.taps();
    assert_eq!(taps.len(), 1);
    let place = sim.view().cast(at).expect("on the globe");
    assert!(arc(taps[0].at, place) < 0.02 && taps[0].age_s < 0.5);
    assert_eq!((sim.counts().taps, sim.counts().dead_touches), (1, 1));
    play(&mut sim, Vec::new(), 4000);
    assert!(sim.taps().is_empty());
}

#[test]
fn undo_brings_back_what_a_side_found_to_the_bit() {
    let mut sim = sim();
    play(&mut sim, Vec::new(), 900);
    let south = MIDDLE + DVec2::new(0.0, 80.0);
    let mut frames = drag(1, south, DVec2::new(80.0, 0.0), 1008, 400);
    frames.push(lift(1424, 1, south + DVec2::new(80.0, 0.0)));
    // The push is known for one when the finger has moved by 4 mm.
    play(&mut sim, frames, 1008);
    let mut before = sim.clone();
    play(&mut sim, Vec::new(), 2500);
    let between = sim.clone();
    let north = MIDDLE - DVec2::new(0.0, 80.0);
    let mut frames = drag(2, north, DVec2::new(-80.0, 0.0), 2608, 400);
    frames.push(lift(3024, 2, north - DVec2::new(80.0, 0.0)));
    play(&mut sim, frames, 4000);
    assert!(sim.can_undo(Side::North) && sim.can_undo(Side::South));
    assert!(sim.undo(Some(Side::North)));
    assert!(sim.planet().time_my() >= between.planet().time_my());
    assert!(sim.undo(Some(Side::South)));
    assert!(!sim.undo(None), "nothing is left to undo");
    // Up to the tick in which the push began the two are one.
    while before.counts().led == 0 {
        before.tick();
    }
    assert_eq!(sim.planet().time_my(), before.planet().time_my());
    let mut untouched = self::sim();
    while (untouched.pending_my(), untouched.planet().time_my()) != (sim.pending_my(), sim.planet().time_my())
    {
        untouched.tick();
    }
    assert_eq!(bits(&sim.surface()), bits(&untouched.surface()));
    assert_eq!(sim.counts().undone, 2);
    assert!(sim.tethers().is_empty());
}

#[test]
fn a_contact_that_turns_out_to_be_a_sleeve_leaves_no_trace() {
    let (mut touched, mut untouched) = (sim(), sim());
    let mut frames = drag(1, MIDDLE, DVec2::new(100.0, 0.0), 96, 160);
    let palm = |phase, x: f64| {
        let mut event = event(phase, 1, MIDDLE + DVec2::new(x, 0.0));
        event.contact.confidence = Some(0.0);
        event
    };
    frames.push(frame(272, vec![palm(Phase::Move, 110.0)]));
    frames.push(frame(600, vec![palm(Phase::Move, 300.0)]));
    frames.push(frame(900, vec![palm(Phase::Up, 300.0)]));
    play(&mut touched, frames, 2000);
    play(&mut untouched, Vec::new(), 2000);
    assert_eq!(touched.counts().rolled_back, 1);
    assert_eq!(bits(&touched.surface()), bits(&untouched.surface()));
    assert_eq!(touched.ticks(), untouched.ticks());
    assert!(!touched.can_undo(Side::North) && !touched.can_undo(Side::South));
}

#[test]
fn cuts_brush_and_other_planets_are_undone_too() {
    let mut sim = sim();
    let begun = bits(&sim.surface());
    let [left, right] = within_one_plate(&sim);
    let middle = (left + right) / 2.0;
    let place = |mm| {
        let at = sim.view().cast(mm).expect("on the globe");
        let (lat, lon) = orogen::sphere::latitude_longitude(at);
        Place { lat, lon }
    };
    let path = vec![
        place(middle - DVec2::new(0.0, 90.0)),
        place(middle + DVec2::new(0.0, 90.0)),
    ];
    let at = Place { lat: 10.0, lon: 20.0 };
    let paint = |paint| Action::Paint {
        at,
        radius_deg: 8.0,
        paint,
    };
    let planet = Action::Planet {
        plates: 12,
        continental: 0.2,
        seed: 9,
    };
    let refused = Action::Planet {
        plates: 500,
        continental: 0.2,
        seed: 9,
    };
    let count = sim.planet().plate_ids().count();
    // The clock stands, so that only what is done changes anything.
    play(
        &mut sim,
        vec![command(0, Action::Pause), command(0, Action::Cut { path })],
        16,
    );
    assert_eq!(sim.counts().cut, 1);
    assert_eq!(sim.planet().plate_ids().count(), count + 1);
    let cut = bits(&sim.surface());
    let land = |sim: &GlobeSim| sim.surface().continental.iter().filter(|&&land| land).count();
    play(&mut sim, vec![command(48, paint(Paint::Ocean))], 64);
    let sea = land(&sim);
    play(&mut sim, vec![command(80, paint(Paint::Continent))], 96);
    assert!(land(&sim) > sea + 10);
    play(&mut sim, vec![command(112, planet), command(112, refused)], 128);
    assert_eq!(sim.planet().plate_ids().count(), 12);
    assert_eq!(
        sim.counts().idle_commands,
        1,
        "too many plates for so few samples"
    );
    for _ in 0..3 {
        assert!(sim.undo(Some(Side::South)));
    }
    assert_eq!(bits(&sim.surface()), cut);
    play(&mut sim, vec![command(160, Action::StartOver)], 176);
    assert_eq!(bits(&sim.surface()), begun);
    let ticks = sim.ticks();
    play(&mut sim, vec![command(192, Action::Speed(10.0))], 2000);
    assert!(
        sim.ticks() > ticks && sim.planet().time_my() == 0.0,
        "it still stands"
    );
    play(&mut sim, vec![command(2000, Action::Play)], 3000);
    assert!((sim.planet().time_my() + sim.pending_my() - 10.0).abs() < 0.4);
}

/// Samples that are continental, and where the brush of a finger at `mm` would find them.
fn land_at(sim: &GlobeSim, mm: DVec2) -> bool {
    let planet = sim.surface();
    let at = sim.view().cast(mm).expect("on the globe");
    planet.continental[planet.lattice.nearest(at) as usize]
}

#[test]
fn brushes_paint_where_fingers_go_and_a_stroke_is_undone_as_one() {
    for (paint, other) in [(Tool::Land, Tool::Sea), (Tool::Sea, Tool::Land)] {
        let mut sim = sim();
        // What is to be changed is made first, everywhere.
        let first = Action::Paint {
            at: Place { lat: 0.0, lon: 0.0 },
            radius_deg: 90.0,
            paint: other.paint().expect("a brush"),
        };
        let speed = Action::Speed(20.0);
        let frames = vec![
            command(
                0,
                Action::View {
                    lon: 0.0,
                    lat: 0.0,
                    zoom: 1.0,
                },
            ),
            command(0, first),
            command(0, speed),
            command(0, Action::Tool(paint)),
        ];
        // (Half a step later plates are shown ahead of where the planet has them.)
        play(&mut sim, frames, 48);
        let strokes = sim.counts().painted;
        let plates = sim.planet().plate_ids().count();
        let from = MIDDLE + DVec2::new(-120.0, 30.0);
        let painted = [0.0, 0.3, 0.6, 1.0].map(|part| from + DVec2::new(200.0 * part, 40.0 * part));
        let beside = MIDDLE + DVec2::new(0.0, 150.0);
        let is_land = paint == Tool::Land;
        assert!(painted.iter().all(|&mm| land_at(&sim, mm) != is_land));
        play(&mut sim, stroke(1, from, DVec2::new(200.0, 40.0), 64, 64), 160);
        assert!(
            painted.iter().all(|&mm| land_at(&sim, mm) == is_land),
            "{paint:?}"
        );
        assert_eq!(land_at(&sim, beside), !is_land);
        assert!(sim.tethers().is_empty(), "a brush moves nothing");
        assert_eq!(
            (sim.counts().painted, sim.counts().led, sim.counts().taps),
            (strokes + 1, 0, 0)
        );
        assert_eq!(sim.planet().plate_ids().count(), plates);
        assert!(sim.undo(Some(Side::South)));
        assert!(painted.iter().all(|&mm| land_at(&sim, mm) != is_land), "undone");
    }
}

#[test]
fn a_brush_reaches_across_a_deserted_table_and_not_into_anothers_work() {
    let north = MIDDLE - DVec2::new(0.0, 120.0);
    let by = DVec2::new(60.0, 0.0);
    let mut alone = sim();
    play(&mut alone, vec![command(0, Action::Tool(Tool::Land))], 16);
    play(&mut alone, stroke(1, north, by, 32, 96), 200);
    assert_eq!((alone.counts().painted, alone.counts().led), (1, 0));
    let mut shared = sim();
    play(&mut shared, stroke(1, north, by, 0, 96), 150);
    assert_eq!(shared.counts().led, 1, "somebody is there");
    play(&mut shared, vec![command(160, Action::Tool(Tool::Land))], 176);
    play(&mut shared, stroke(2, north, by, 192, 96), 400);
    assert_eq!((shared.counts().painted, shared.counts().led), (0, 2));
    play(&mut shared, stroke(3, north, by, 12_000, 96), 12_200);
    assert_eq!(
        (shared.counts().painted, shared.counts().led),
        (1, 2),
        "nobody is there any more"
    );
}

/// A session with everything in it.
fn grand_session() -> Vec<InputFrame> {
    let mut frames = drag(1, MIDDLE, DVec2::new(120.0, 30.0), 96, 900);
    frames.push(frame(
        500,
        vec![event(Phase::Down, 2, MIDDLE + DVec2::new(30.0, 40.0))],
    ));
    frames.push(lift(1100, 1, MIDDLE + DVec2::new(120.0, 30.0)));
    frames.push(lift(1200, 2, MIDDLE + DVec2::new(30.0, 40.0)));
    frames.push(command(
        1300,
        Action::View {
            lon: 70.0,
            lat: 25.0,
            zoom: 1.4,
        },
    ));
    frames.extend(drag(
        3,
        DVec2::new(60.0, 300.0),
        DVec2::new(90.0, 60.0),
        1400,
        400,
    ));
    frames.push(lift(1900, 3, DVec2::new(150.0, 360.0)));
    frames.extend(drag(4, MIDDLE, DVec2::new(-140.0, 0.0), 2000, 600));
    frames.extend(drag(
        5,
        MIDDLE + DVec2::new(200.0, 0.0),
        DVec2::new(60.0, 0.0),
        2000,
        600,
    ));
    frames.push(lift(3000, 4, MIDDLE - DVec2::new(140.0, 0.0)));
    frames.push(command(3100, Action::Undo));
    frames.push(command(
        3200,
        Action::Cut {
            path: vec![
                Place { lat: 30.0, lon: 60.0 },
                Place {
                    lat: -30.0,
                    lon: 80.0,
                },
            ],
        },
    ));
    frames
}

#[test]
fn the_same_frames_give_the_same_bits_for_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let mut sim = sim();
            play(&mut sim, grand_session(), 4000);
            sim.finish_input();
            sim.run_until(40.0, |_| true);
            (bits(&sim.surface()), sim.counts(), sim.view())
        })
    };
    let one = run(1);
    assert_eq!(run(1), one, "a recording with changes of the view replays equal");
    assert_eq!(run(2), one);
    assert_eq!(run(7), one);
    assert!(
        one.1.led >= 3 && one.1.views >= 2 && one.1.undone == 1,
        "{:?}",
        one.1
    );
}

#[test]
fn a_clone_goes_on_as_the_original_does() {
    let mut sim = sim();
    for frame in grand_session() {
        sim.feed(frame);
    }
    play(&mut sim, Vec::new(), 2300);
    let mut clone = sim.clone();
    play(&mut sim, Vec::new(), 4000);
    play(&mut clone, Vec::new(), 4000);
    assert_eq!(bits(&sim.surface()), bits(&clone.surface()));
}

#[test]
fn a_led_plate_answers_within_a_frame_and_never_jumps() {
    let mut sim = sim();
    let mut frames = drag(1, MIDDLE, DVec2::new(60.0, -40.0), 208, 320);
    frames.extend(
        drag(
            1,
            MIDDLE + DVec2::new(60.0, -40.0),
            DVec2::new(-90.0, 70.0),
            544,
            640,
        )
        .into_iter()
        .skip(1),
    );
    for frame in frames {
        sim.feed(frame);
    }
    play(&mut sim, Vec::new(), 208);
    let per_tick = sim.params().globe.max_speed / RADIUS_KM * sim.pace_my_per_s() * TICK_US as f64 / 1e6;
    let mut held = sim.tethers()[0].held;
    let mut begun = None;
    for tick in 0..120 {
        sim.tick();
        let tether = sim.tethers()[0];
        let moved = arc(held, tether.held);
        assert!(moved < per_tick * 1.001, "tick {tick}: {moved} of {per_tick}");
        if tether.grasp == Grasp::Leading && begun.is_none() {
            begun = Some(tick);
            let ahead = (tether.held - held).dot(tether.finger - tether.held);
            assert!(ahead > 0.0, "the tick that knows the push moves the plate");
        }
        held = tether.held;
    }
    assert!(begun.is_some());
}
