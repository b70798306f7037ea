//! Looking back: the history of the land, and what of it stays in reach.

use glam::DVec2;
use orogen::gesture::command::Action;
use orogen::gesture::contact::{ContactEvent, InputFrame, Phase, Side};
use orogen::gesture::file::{GestureFile, Header, read_gesture};
use orogen::sim::{Sim, SimParams, TICK_US, World};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

use crate::sim_common::{SIZE_MM, command, event, frame, stroke};

fn sim() -> Sim {
    let world = World::new(PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE), 800, 7).expect("a world");
    let mut params = SimParams::default();
    // Coarse, so that these tests are quick.
    params.mountain.cells = 128 * 128;
    Sim::new(world, params)
}

/// A push of 80 mm.
fn push(id: u64, from: DVec2, start_ms: u64) -> Vec<InputFrame> {
    stroke(id, from, DVec2::new(80.0, 0.0), start_ms, 400)
}

fn play(sim: &mut Sim, frames: impl IntoIterator<Item = InputFrame>, until_ms: u64) {
    for frame in frames {
        sim.feed(frame);
    }
    while sim.ticks() * TICK_US <= until_ms * 1000 {
        sim.tick();
    }
}

const WEST: DVec2 = DVec2::new(300.0, 400.0);
const EAST: DVec2 = DVec2::new(800.0, 500.0);

#[test]
fn scrub_brings_the_land_of_that_time_back_and_stops_the_clock() {
    let mut sim = sim();
    play(&mut sim, push(1, WEST, 100), 2000);
    while sim.world().time_yr < 1.5e6 {
        sim.tick();
    }
    let then = sim.world().clone();
    let t_ms = sim.ticks() * TICK_US / 1000;
    play(&mut sim, [], t_ms + 3000);
    let present = sim.world().clone();
    let (first, last) = sim.history_yr();
    assert_eq!(first, 0.0);
    assert_eq!(last, present.time_yr);

    play(
        &mut sim,
        [command(t_ms + 3016, Action::Scrub(1.56e6))],
        t_ms + 3500,
    );
    assert!(sim.paused());
    assert_eq!(
        sim.world().time_yr,
        1.5e6,
        "the nearest snapshot before, and it stays"
    );
    assert_eq!(sim.world().z, then.z);
    assert_eq!(sim.world().plates, then.plates);
    assert_eq!(sim.history_yr(), (first, last), "the later ones stay in reach");
    play(&mut sim, [command(t_ms + 3600, Action::Scrub(1e9))], t_ms + 3700);
    assert_eq!(sim.world().z, present.z, "and so does the present");
    play(&mut sim, [command(t_ms + 3800, Action::Scrub(0.0))], t_ms + 3900);
    assert_eq!(sim.world().time_yr, 0.0);
    assert_eq!(sim.history_yr().1, last);
    assert_eq!(sim.counts().idle_commands, 0);
}

#[test]
fn a_land_that_moves_on_from_the_past_is_the_land_that_it_was() {
    let mut straight = sim();
    play(&mut straight, push(1, WEST, 100), 4000);
    let mut scrubbed = sim();
    play(&mut scrubbed, push(1, WEST, 100), 4000);
    play(&mut scrubbed, [command(4100, Action::Scrub(1.0e6))], 4200);
    let end_yr = scrubbed.history_yr().1;
    play(&mut scrubbed, [command(4300, Action::Play)], 4316);
    assert_eq!(scrubbed.history_yr().1, end_yr, "until the next step");
    while straight.world().time_yr < end_yr {
        straight.tick();
    }
    while scrubbed.world().time_yr < end_yr {
        scrubbed.tick();
        let (_, last) = scrubbed.history_yr();
        let now = scrubbed.world().time_yr;
        assert!(
            now == 1.0e6 || last == now,
            "what came after is gone: {last} {now}"
        );
    }
    assert_eq!(scrubbed.world().z, straight.world().z, "the same push goes on");
}

#[test]
fn an_edit_in_the_past_drops_what_came_after() {
    let mut sim = sim();
    play(&mut sim, push(1, WEST, 100), 2000);
    play(&mut sim, push(2, EAST, 2500), 4000);
    let early_yr = 0.6e6;
    assert!(sim.can_undo(Side::South));
    play(&mut sim, [command(4100, Action::Scrub(early_yr))], 4200);
    assert_eq!(sim.world().time_yr, early_yr);
    assert_eq!(sim.world().plates.plates().len(), 1, "the second push is to come");
    let at = WEST;
    play(&mut sim, [command(4300, Action::Remove { at })], 4400);
    assert!(sim.world().plates.plates().is_empty());
    assert_eq!(sim.history_yr().1, early_yr, "another future begins");
    // The edit is undone first.
    play(&mut sim, [command(4430, Action::Undo)], 4460);
    assert_eq!(sim.world().plates.plates().len(), 1);
    // The second push never was; the first is still there to be undone.
    play(&mut sim, [command(4500, Action::Undo)], 4600);
    assert!(sim.world().time_yr < early_yr);
    assert!(!sim.can_undo(Side::South));
    // What was edited is the present: looking back and forth keeps it.
    play(&mut sim, [command(4700, Action::Scrub(1e9))], 4800);
    assert!(sim.world().plates.plates().is_empty());
}

#[test]
fn undo_in_the_past_takes_back_what_was_before_it() {
    let mut sim = sim();
    play(&mut sim, push(1, WEST, 100), 2000);
    play(&mut sim, push(2, EAST, 2500), 4000);
    play(&mut sim, [command(4100, Action::Scrub(0.6e6))], 4200);
    play(&mut sim, [command(4300, Action::Undo)], 4400);
    assert!(sim.world().plates.plates().is_empty(), "the first push is undone");
    assert!(sim.world().time_yr < 0.6e6);
    assert!(
        !sim.can_undo(Side::South),
        "the second one is of a future that is gone"
    );
}

#[test]
fn undo_after_a_look_back_in_a_land_that_was_started_over() {
    let mut sim = sim();
    play(&mut sim, push(1, WEST, 100), 3000);
    play(&mut sim, [command(3016, Action::StartOver)], 3100);
    play(&mut sim, push(2, EAST, 3200), 5000);
    play(&mut sim, [command(5016, Action::Scrub(0.1e6))], 5100);
    // Older land is later in the list than the time that is looked back to; what is undone is what this land knows.
    play(&mut sim, [command(5200, Action::Undo)], 5300);
    assert!(sim.world().z.iter().all(|z| z.is_finite()));
    play(
        &mut sim,
        [command(5400, Action::Undo), command(5416, Action::Undo)],
        5500,
    );
    assert!(!sim.can_undo(Side::South));
}

#[test]
fn start_over_begins_a_history_of_its_own() {
    let mut sim = sim();
    play(&mut sim, push(1, WEST, 100), 3000);
    play(&mut sim, [command(3016, Action::Pause)], 3100);
    let before = sim.world().clone();
    play(
        &mut sim,
        [command(3200, Action::StartOver), command(3216, Action::Play)],
        3250,
    );
    assert_eq!(sim.history_yr(), (0.0, 0.0));
    play(&mut sim, [], 9000);
    play(
        &mut sim,
        [command(9016, Action::Pause), command(9032, Action::Undo)],
        9100,
    );
    assert_eq!(sim.world().time_yr, before.time_yr);
    assert_eq!(
        sim.history_yr().0,
        before.time_yr,
        "not the past of the land between"
    );
    play(&mut sim, [command(9116, Action::Scrub(0.0))], 9200);
    assert_eq!(sim.world().z, before.z);
}

#[test]
fn a_palm_that_is_taken_back_leaves_the_past_as_it_was() {
    let at = |step: u64| WEST + DVec2::new(10.0 * step as f64, 0.0);
    let palm = |mut event: ContactEvent| {
        event.contact.confidence = Some(0.0);
        event
    };
    let mut frames = vec![frame(2000, vec![event(Phase::Down, 9, at(0))])];
    frames.extend((1..12).map(|step| frame(2000 + step * 16, vec![event(Phase::Move, 9, at(step))])));
    frames.extend((12..30).map(|step| frame(2000 + step * 16, vec![palm(event(Phase::Move, 9, at(step)))])));
    frames.push(frame(2480, vec![palm(event(Phase::Up, 9, at(29)))]));
    // A teacher scrubs and lets go on while the sleeve lies there.
    let orders = [
        command(2048, Action::Scrub(0.5e6)),
        command(2064, Action::Play),
        command(2160, Action::Scrub(0.3e6)),
        command(2320, Action::Play),
    ];
    let (mut with, mut without) = (sim(), sim());
    let mut all = frames;
    all.extend(orders.clone());
    all.sort_by_key(|frame| frame.t_us);
    play(&mut with, all, 5000);
    play(&mut without, orders, 5000);
    assert_eq!(with.counts().rolled_back, 1);
    assert_eq!(with.world().z, without.world().z);
    assert_eq!(with.world().time_yr, without.world().time_yr);
    assert_eq!(with.history_yr(), without.history_yr());
}

#[test]
fn scrubbing_replays_from_a_gesture_file() {
    let mut frames = push(1, WEST, 100);
    frames.push(command(2000, Action::Scrub(0.4e6)));
    frames.extend(push(2, EAST, 2200));
    frames.push(command(2700, Action::Play));
    frames.push(command(4000, Action::Scrub(0.7e6)));
    frames.push(command(4500, Action::Play));
    let file = GestureFile {
        header: Header::new(SIZE_MM),
        frames: frames.clone(),
        warnings: Vec::new(),
    };
    let bytes = file.write(Vec::new()).expect("memory");
    let read = read_gesture(bytes.as_slice(), "memory").expect("a good file");
    let (mut live, mut replayed) = (sim(), sim());
    play(&mut live, frames, 6000);
    play(&mut replayed, read.frames, 6000);
    assert_eq!(live.world().z, replayed.world().z);
    assert!(live.world().time_yr > 0.7e6);
    assert_eq!(live.world().plates.plates().len(), 2);
}

#[test]
fn a_plate_of_the_past_is_not_held_by_a_hand_that_has_left() {
    let mut sim = sim();
    // A hand rests from 0.1 s to 1.9 s.
    play(&mut sim, [frame(100, vec![event(Phase::Down, 1, WEST)])], 1900);
    play(&mut sim, [frame(1916, vec![event(Phase::Up, 1, WEST)])], 3000);
    play(
        &mut sim,
        [command(3016, Action::Scrub(0.6e6)), command(3032, Action::Play)],
        3100,
    );
    let held = |sim: &Sim| sim.world().plates.plates().iter().any(|plate| plate.held);
    assert_eq!(sim.world().plates.plates().len(), 1);
    assert!(!held(&sim));
    // Nor does one whose contact was withdrawn.
    let mut sim = self::sim();
    play(&mut sim, [frame(100, vec![event(Phase::Down, 1, WEST)])], 1900);
    assert!(held(&sim));
    play(&mut sim, [frame(1916, vec![event(Phase::Cancel, 1, WEST)])], 2000);
    assert!(!held(&sim));
}
