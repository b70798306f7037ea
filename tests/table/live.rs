//! The session's thread: nothing is lost, nobody waits, and what was live replays to the bit.

use std::collections::BTreeMap;

use glam::DVec2;
use orogen::gesture::command::{Action, Arrow, Command};
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, Phase, Side, Source};
use orogen::gesture::file::read_gesture;
use orogen::live::{Frame, LiveParams, Session, Start};
use orogen::mountain::Stages;
use orogen::rock::preset;
use orogen::sim::{Sim, SimParams, TICK_US, World};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);
const NODES: usize = 900;
const SEED: u64 = 11;

fn params() -> LiveParams {
    let mut sim = SimParams::default();
    // Coarse, so that these tests are quick.
    sim.mountain.cells = 128 * 128;
    LiveParams {
        map: PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE),
        nodes: NODES,
        seed: SEED,
        layers: preset::default(),
        sim,
        raster_width: 48,
        threads: 2,
        stages: Stages::default(),
    }
}

/// A session on a table whose clock this test turns.
struct Table {
    session: Session,
    now_us: u64,
}

impl Table {
    fn with(params: LiveParams) -> Self {
        Self {
            session: Session::spawn(params).expect("a session"),
            now_us: 123_456_789,
        }
    }

    fn new() -> Self {
        Self::with(params())
    }

    fn send(&self, events: Vec<ContactEvent>) {
        self.session.send(events, Vec::new(), self.now_us);
    }

    fn order(&self, action: Action) {
        let command = Command {
            side: Some(Side::South),
            ..Command::new(action)
        };
        self.session.send(Vec::new(), vec![command], self.now_us);
    }

    /// Lets the table's time pass, tick by tick, so that the session keeps up.
    fn pass(&mut self, ms: u64) {
        for _ in 0..ms.div_ceil(16) {
            self.now_us += TICK_US;
            self.session.advance(self.now_us);
            self.settle();
        }
    }

    /// Waits until all that was handed over has been taken.
    fn settle(&self) {
        self.session.save_world().recv().expect("an answer");
    }

    fn sim(&self) -> Sim {
        Sim::resume(self.session.save_world().recv().expect("an answer"))
    }

    fn frame(&mut self) -> &Frame {
        self.session.frame()
    }
}

fn event(phase: Phase, id: u64, position: DVec2) -> ContactEvent {
    ContactEvent {
        phase,
        contact: Contact {
            key: ContactKey {
                source: Source::Window,
                device: 1,
                id,
                generation: 0,
            },
            position,
            size_mm: None,
            confidence: None,
        },
    }
}

fn at(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

/// Two fingers push towards each other, one rests, a palm lies about, somebody taps, a plate is edited.
fn play_visitors(table: &mut Table) {
    table.send(vec![event(Phase::Down, 7, at(600.0, 120.0))]);
    for step in 0..60 {
        // Positions off the raster of gesture files, at moments between the ticks.
        table.now_us += 3_217;
        let way = 1.333_33 * f64::from(step);
        let phase = if step == 0 { Phase::Down } else { Phase::Move };
        let mut sleeve = event(phase, 3, at(200.0 + way, 600.0));
        sleeve.contact.size_mm = Some(at(70.123, 40.0));
        table.send(vec![
            event(phase, 2, at(800.0 - way, 351.238 + 0.1 * way)),
            event(phase, 1, at(300.0 + way, 340.0)),
            sleeve,
        ]);
        table.now_us += 9_001;
        table.session.advance(table.now_us);
        table.settle();
    }
    let lift = |id| event(Phase::Up, id, DVec2::ZERO);
    table.send(vec![lift(1), lift(2), lift(3)]);
    table.pass(500);
    let tap = |phase| event(phase, 5, at(1000.0, 500.0));
    table.send(vec![tap(Phase::Down), tap(Phase::Up)]);
    table.pass(300);
    table.order(Action::EditArrow(Arrow {
        from: at(800.0 - 78.667, 351.2 + 7.866_6),
        to: at(700.0, 300.004),
    }));
    table.pass(200);
    table.send(vec![lift(7)]);
    table.order(Action::Speed(1.0 / 3.0));
    table.pass(800);
    table.order(Action::Scrub(0.4e6));
    table.pass(100);
    table.order(Action::Play);
    table.pass(600);
}

fn bits(sim: &Sim) -> Vec<u64> {
    sim.world().z.iter().map(|z| z.to_bits()).collect()
}

#[test]
fn rock_and_cross_sections_of_a_session_are_seen_and_replay() {
    let jura = preset::by_name("jura").expect("a preset");
    let mut table = Table::with(LiveParams {
        layers: jura.clone(),
        ..params()
    });
    let ends = Arrow {
        from: at(300.0, 500.0),
        to: at(900.0, 400.0),
    };
    table.order(Action::Slice(ends));
    table.order(Action::LabelSlice {
        at: 0.25,
        text: "here".to_owned(),
    });
    table.order(Action::FreezeSlice(true));
    table.pass(100);
    let frame = table.frame();
    let cut = frame.cuts[1].clone().expect("the south side's");
    let strata = frame.surface.strata.as_ref().expect("layers");
    assert_eq!(*strata.stratigraphy, *jura);
    assert_eq!((cut.frozen, cut.notes.len(), &frame.cuts[0]), (true, 1, &None));
    // Longer than the ring is: what began before it is in it.
    table.pass(61_000);
    table.order(Action::Speed(1.0));
    table.pass(1000);
    let bytes = table.session.ring_file().recv().expect("the last minute");
    let file = read_gesture(bytes.as_slice(), "ring").expect("a good file");
    let world = World::new(params().map, NODES, SEED).expect("a world");
    let mut replayed = Sim::new(world, params().sim);
    for frame in file.frames {
        replayed.feed(frame);
    }
    replayed.tick();
    assert_eq!(*replayed.world().stratigraphy, *jura);
    assert_eq!(replayed.cut(Side::South), Some(&cut));
}

#[test]
fn what_was_live_replays_to_the_bit() {
    let mut table = Table::new();
    play_visitors(&mut table);
    assert_eq!(table.session.slowed_us(), 0, "the session kept up");
    let live = table.sim();
    let bytes = table.session.ring_file().recv().expect("the last minute");
    let file = read_gesture(bytes.as_slice(), "ring").expect("a good file");
    assert_eq!(
        file.write(Vec::new()).expect("memory"),
        bytes,
        "in its canonical form"
    );
    assert_eq!(file.header.size_mm, SIZE_MM);
    let (seed, nodes) = (
        file.header.seed.expect("a seed"),
        file.header.nodes.expect("nodes"),
    );
    let world = World::new(params().map, nodes as usize, seed).expect("a world");
    let mut replayed = Sim::new(world, params().sim);
    for frame in file.frames {
        replayed.feed(frame);
    }
    while replayed.ticks() < live.ticks() {
        replayed.tick();
    }
    assert!(live.world().time_yr > 0.4e6 && live.world().plates.plates().len() >= 2);
    assert_eq!(live.counts(), replayed.counts());
    assert_eq!(live.contact_stats(), replayed.contact_stats());
    assert!(live.contact_stats().dropped_ghosts > 0 && live.contact_stats().taps == 1);
    assert_eq!(live.world().time_yr, replayed.world().time_yr);
    assert!(bits(&live) == bits(&replayed), "the land is the same");
}

#[test]
fn any_number_of_threads_gives_the_same_land() {
    let land = |threads| {
        let mut table = Table::with(LiveParams { threads, ..params() });
        play_visitors(&mut table);
        let heights = table.frame().surface.height.data.clone();
        (bits(&table.sim()), heights)
    };
    let one = land(1);
    assert!(one == land(2), "2 threads");
    assert!(one == land(7), "7 threads");
}

#[test]
fn a_tap_between_two_ticks_is_kept() {
    let mut table = Table::new();
    table.pass(100);
    // In one message, in two of one moment, and in two of one tick.
    let tap = |phase, id: u64| event(phase, id, at(300.0 * id as f64, 340.0));
    table.send(vec![tap(Phase::Down, 1), tap(Phase::Up, 1)]);
    table.send(vec![tap(Phase::Down, 2)]);
    table.send(vec![tap(Phase::Up, 2)]);
    table.send(vec![tap(Phase::Down, 3)]);
    table.now_us += 4_000;
    table.send(vec![tap(Phase::Up, 3)]);
    table.pass(400);
    let frame = table.frame();
    assert_eq!((frame.contacts.total, frame.contacts.taps), (3, 3));
    assert!(frame.hands.is_empty());
    assert_eq!(table.sim().world().plates.domes().len(), 3);
}

#[test]
fn a_flood_is_taken_without_loss_while_nobody_waits() {
    const TAPS: u64 = 400;
    let mut table = Table::new();
    table.pass(32);
    // Ten thousand events, far faster than the session plays them.
    for tap in 0..TAPS {
        let place = at(20.0 + 2.9 * tap as f64, 100.0 + 100.0 * (tap % 5) as f64);
        table.send(vec![event(Phase::Down, tap % 32, place)]);
        for _ in 0..23 {
            table.now_us += 150;
            table.send(vec![event(Phase::Move, tap % 32, place + at(0.01, 0.0))]);
        }
        table.now_us += 2_000;
        table.send(vec![event(Phase::Up, tap % 32, place)]);
        table.session.advance(table.now_us);
    }
    table.pass(600);
    let contacts = table.frame().contacts;
    assert_eq!(contacts.total, TAPS, "{contacts:?}");
    assert_eq!((contacts.ignored, contacts.doubled), (0, 0));
    assert!(table.frame().hands.is_empty());
}

#[test]
fn a_session_that_lags_is_slowed_and_loses_no_contact() {
    let mut table = Table::new();
    table.pass(32);
    // Five fingers, one after the other, each drags for 800 ms; the session hears of it only at the end.
    for id in 0..5 {
        let from = at(150.0 + 200.0 * id as f64, 340.0);
        table.send(vec![event(Phase::Down, id, from)]);
        for step in 1..=50 {
            table.now_us += 16_000;
            table.send(vec![event(
                Phase::Move,
                id,
                from + at(0.0, 2.0 * f64::from(step)),
            )]);
        }
        table.send(vec![event(Phase::Up, id, from)]);
        table.now_us += 10_000;
    }
    table.session.advance(table.now_us);
    table.settle();
    let slowed_us = table.session.slowed_us();
    assert!(slowed_us > 3_000_000, "{slowed_us}");
    let ticks = table.sim().ticks();
    assert!(ticks < 20, "it does not run after what it has missed: {ticks}");
    table.pass(600);
    let frame = table.frame();
    let (contacts, hands) = (frame.contacts, frame.hands.len());
    assert_eq!((contacts.total, contacts.ignored), (5, 0));
    assert_eq!((contacts.pushes, hands), (5, 0), "each drag is a push");
    // The table's clock and the session's run on together.
    let ticks = table.sim().ticks();
    table.pass(320);
    assert_eq!(table.sim().ticks(), ticks + 20);
    assert_eq!(table.session.slowed_us(), slowed_us);
}

#[test]
fn the_newest_frame_wins() {
    let mut table = Table::new();
    let first = table.frame().clone();
    assert_eq!(first.sequence, 1, "the land is there at once");
    assert!(first.surface.height.data.iter().any(|&z| z != 0.0));
    assert_eq!(
        (first.surface.height.width, first.surface.height.height),
        (48, 27)
    );
    table.pass(800);
    let newest = table.frame().sequence;
    assert!(newest >= 50, "{newest}");
    assert_eq!(table.frame().sequence, newest, "nothing new");
    let ticks = table.sim().ticks();
    assert_eq!(table.frame().clock.elapsed_yr, ticks as f64 * 8_000.0);
}

#[test]
fn frames_are_whole_however_fast_they_come() {
    let mut table = Table::new();
    let mut lands: BTreeMap<u64, Vec<f32>> = BTreeMap::new();
    let mut last = 0;
    table.send(vec![event(Phase::Down, 1, at(500.0, 340.0))]);
    for step in 0..600 {
        table.now_us += 8_000;
        table.send(vec![event(
            Phase::Move,
            1,
            at(500.0 + 0.3 * f64::from(step), 340.0),
        )]);
        table.session.advance(table.now_us);
        if step % 20 == 0 {
            table.settle();
        }
        let frame = table.frame();
        assert!(frame.sequence >= last);
        last = frame.sequence;
        assert_eq!(frame.surface.elapsed_yr, frame.clock.elapsed_yr);
        assert!(frame.surface.height.data.iter().all(|z| z.is_finite()));
        assert!(frame.surface.lake_depth.data.iter().all(|&depth| depth >= 0.0));
        // One number, one land.
        let heights = lands
            .entry(frame.land)
            .or_insert_with(|| frame.surface.height.data.clone());
        assert!(*heights == frame.surface.height.data, "torn at {last}");
    }
    assert!(lands.len() > 3);
}

#[test]
fn land_rises_with_every_tick_while_a_finger_moves() {
    let mut table = Table::new();
    table.pass(100);
    let place = at(500.0, 340.0);
    table.send(vec![event(Phase::Down, 1, place)]);
    for step in 1..=30 {
        table.send(vec![event(
            Phase::Move,
            1,
            place + at(4.0 * f64::from(step), 0.0),
        )]);
        table.pass(16);
    }
    let mut before = table.frame().clone();
    for step in 31..=60 {
        table.send(vec![event(
            Phase::Move,
            1,
            place + at(4.0 * f64::from(step), 0.0),
        )]);
        table.pass(16);
        let now = table.frame().clone();
        let heights = |frame: &Frame| frame.surface.height.data.clone();
        let changed = heights(&now)
            .iter()
            .zip(heights(&before))
            .any(|(a, b)| (a - b).abs() > 0.5);
        assert!(changed && now.land > before.land, "step {step}");
        before = now;
    }
    let clock = before.clock;
    assert!((1e-4..1e-1).contains(&clock.convergence_m_per_yr), "{clock:?}");
    assert!((1e-3..1.0).contains(&clock.shortening), "{clock:?}");
    assert_eq!(clock.can_undo, [true, false], "the middle of the table is north");
    assert!(before.steps > 5);
    assert_eq!(before.surface.plates.len(), 1);
    assert!(!before.surface.rivers.is_empty());
}

#[test]
fn a_land_that_stands_still_is_not_drawn_again() {
    let mut table = Table::new();
    table.order(Action::Pause);
    table.pass(100);
    let (land, sequence) = (table.frame().land, table.frame().sequence);
    table.pass(200);
    assert_eq!(table.frame().land, land);
    assert!(table.frame().sequence > sequence);
    assert!(table.frame().clock.paused);
    table.order(Action::Play);
    table.pass(200);
    assert!(table.frame().land > land);
}

#[test]
fn restart_begins_clean() {
    let mut table = Table::new();
    let new = table.frame().surface.height.data.clone();
    table.send(vec![event(Phase::Down, 1, at(500.0, 340.0))]);
    for step in 1..=60 {
        table.send(vec![event(
            Phase::Move,
            1,
            at(500.0 + 2.0 * f64::from(step), 340.0),
        )]);
        table.pass(16);
    }
    table.order(Action::Speed(2.0));
    table.pass(500);
    assert!(table.frame().surface.height.data != new);
    let kept = table.sim().world().clone();

    // Input that is on its way is of the visitor before.
    table.send(vec![event(Phase::Down, 2, at(100.0, 340.0))]);
    table.session.restart(Start::Seed(SEED));
    table.settle();
    let frame = table.frame();
    assert!(frame.surface.height.data == new, "the first land");
    assert_eq!(frame.clock.elapsed_yr, 0.0);
    assert_eq!(frame.clock.pace_yr_per_s, SimParams::default().pace_yr_per_s);
    assert_eq!((frame.hands.len(), frame.contacts.total), (0, 0));
    // The finger is still on the glass, but means nothing until it lands again.
    table.send(vec![event(Phase::Move, 1, at(900.0, 340.0))]);
    table.pass(600);
    assert!(table.frame().hands.is_empty());
    assert_eq!(table.sim().world().plates.plates().len(), 0);

    table.session.restart(Start::Seed(SEED + 1));
    table.settle();
    assert!(table.frame().surface.height.data != new, "another land");
    table.pass(100);
    assert!(table.frame().clock.elapsed_yr > 0.0);

    table.session.restart(Start::World(Box::new(kept.clone())));
    table.settle();
    assert_eq!(table.sim().world().z, kept.z);
    assert_eq!(table.sim().world().plates.plates().len(), 1);
    assert!(table.sim().hands().next().is_none());
}

#[test]
fn numbers_that_are_none_are_seen_in_the_frame() {
    let mut params = params();
    params.sim.erosion.k = f64::NAN;
    let mut table = Table::with(params);
    table.pass(500);
    let frame = table.frame();
    assert!(frame.quarantine.steps > 0);
    assert!(frame.surface.height.data.iter().all(|z| z.is_finite()));
}

#[test]
fn a_saved_session_goes_on_elsewhere() {
    let mut table = Table::new();
    table.send(vec![event(Phase::Down, 1, at(500.0, 340.0))]);
    table.pass(16);
    table.send(vec![event(Phase::Move, 1, at(600.0, 340.0))]);
    table.pass(400);
    let mut elsewhere = table.sim();
    assert!(elsewhere.node_uplift().iter().any(|&rate| rate > 0.0));
    table.pass(800);
    while elsewhere.ticks() < table.sim().ticks() {
        elsewhere.tick();
    }
    assert!(bits(&elsewhere) == bits(&table.sim()));
}

#[test]
fn a_land_that_cannot_be_laid_out_is_an_error() {
    let error = Session::spawn(LiveParams { nodes: 0, ..params() }).expect_err("no nodes");
    assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput);
}
