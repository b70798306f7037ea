//! The edit tool on a real session: what the instrument sends changes the plate that was meant, although what it sees
//! lags behind.

use std::collections::VecDeque;

use crate::instrument_support::{Table, contact};
use glam::DVec2;
use orogen::gesture::command::{Action, Command, REACH_MM};
use orogen::gesture::contact::{ContactEvent, InputFrame, Phase, Side};
use orogen::instrument::{Deed, Editing, Route};
use orogen::sim::{Sim, SimParams, TICK_US, World};
use orogen::surface::PlateMark;

/// Ticks by which the scene is older than the session.
const LAG: usize = 3;

const HAND: [DVec2; 5] = [
    DVec2::new(-50.0, 40.0),
    DVec2::new(-30.0, -10.0),
    DVec2::new(0.0, -25.0),
    DVec2::new(30.0, -15.0),
    DVec2::new(50.0, 15.0),
];

/// A table and the session it commands.
struct Bench {
    table: Table,
    sim: Sim,
    seen: VecDeque<Vec<PlateMark>>,
    sent: Vec<Command>,
}

impl Bench {
    /// Each push is fingers that move together by as much; then the clock stands.
    fn new(pushes: &[(&[DVec2], DVec2)]) -> Self {
        let table = Table::new();
        let world = World::new(table.set.map, 2000, 7).expect("a world");
        let mut bench = Self {
            table,
            sim: Sim::new(world, SimParams::default()),
            seen: VecDeque::new(),
            sent: Vec::new(),
        };
        for (fingers, by) in pushes {
            for step in 0..=40_u32 {
                let phase = match step {
                    0 => Phase::Down,
                    40 => Phase::Up,
                    _ => Phase::Move,
                };
                let part = f64::from(step.min(39)) / 39.0;
                let events = (1..).zip(*fingers).map(|(id, &at)| ContactEvent {
                    phase,
                    contact: contact(id, at + *by * part),
                });
                let events = events.collect();
                bench.play(events, Vec::new());
            }
            for _ in 0..20 {
                bench.play(Vec::new(), Vec::new());
            }
        }
        let pause = Command {
            action: Action::Pause,
            side: None,
            contact: None,
        };
        bench.play(Vec::new(), vec![pause]);
        bench.table.set.clock.paused = true;
        bench.run(LAG + 1);
        bench
    }

    fn play(&mut self, events: Vec<ContactEvent>, commands: Vec<Command>) {
        self.sim.feed(InputFrame {
            t_us: self.sim.ticks() * TICK_US,
            events,
            commands,
        });
        self.sim.tick();
    }

    /// Looks and ticks so many times.
    fn run(&mut self, ticks: usize) {
        for _ in 0..ticks {
            self.table.now_us += TICK_US;
            self.seen.push_back(self.sim.plate_marks());
            if self.seen.len() > LAG {
                self.table.set.plates = self.seen.pop_front().expect("marks");
            }
            self.table.set.faults = self.sim.fault_traces();
            self.table.tick();
            let mut commands = Vec::new();
            for deed in self.table.instrument.drain() {
                match deed {
                    Deed::Command(command) => commands.push(command),
                    other => panic!("{other:?}"),
                }
            }
            self.sent.extend(commands.iter().cloned());
            self.play(Vec::new(), commands);
        }
    }

    /// A finger goes from one place to another within so many ticks, and waits a little before it lifts.
    fn drag(&mut self, from: DVec2, to: DVec2, ticks: u32) {
        assert_eq!(self.table.down(1, from), Route::Tool);
        for step in 1..=ticks {
            self.table
                .shift(1, from.lerp(to, f64::from(step) / f64::from(ticks)));
            self.run(1);
        }
        self.run(30);
        self.table.up(1);
        self.run(LAG + 2);
    }

    fn tips(&self, plate: usize) -> Vec<DVec2> {
        let arrows = &self.sim.plate_marks()[plate].arrows;
        arrows
            .iter()
            .map(|(_, tip)| self.table.set.map.to_table(*tip))
            .collect()
    }

    fn doing(&self) -> Editing {
        self.table.instrument.edits()[0].doing
    }
}

#[test]
fn the_tip_of_a_finger_follows_a_quick_drag_in_steps_the_session_can_find() {
    let start = DVec2::new(500.0, 400.0);
    let mut bench = Bench::new(&[(&[start], DVec2::new(60.0, 0.0))]);
    let tip = bench.tips(0)[0];
    let goal = tip + DVec2::new(-20.0, 90.0);
    // Farther in a look than an edit reaches: 92 mm within four ticks.
    bench.drag(tip + DVec2::new(6.0, -5.0), goal, 4);
    assert!(bench.tips(0)[0].distance(goal) < 0.05, "{}", bench.tips(0)[0]);
    assert_eq!(bench.sim.counts().idle_commands, 0, "each step found its tip");
    assert!(bench.sent.len() >= 2);
    for command in &bench.sent {
        assert!(matches!(command.action, Action::EditArrow(_)));
        assert_eq!((command.side, command.contact), (Some(Side::South), Some(1)));
    }
}

#[test]
fn a_slow_drag_follows_all_the_way_without_a_flood() {
    let start = DVec2::new(500.0, 340.0);
    let mut bench = Bench::new(&[(&[start], DVec2::new(60.0, 0.0))]);
    let tip = bench.tips(0)[0];
    let goal = tip + DVec2::new(0.0, 60.0);
    bench.drag(tip, goal, 60);
    assert!(bench.tips(0)[0].distance(goal) < 0.05);
    let sent = bench.sent.len();
    assert!((8..=30).contains(&sent), "{sent} in a second");
}

#[test]
fn a_tip_of_a_hand_turns_its_rigid_plate_and_no_other() {
    let left: Vec<DVec2> = HAND.map(|f| f + DVec2::new(350.0, 340.0)).to_vec();
    let right: Vec<DVec2> = HAND.map(|f| f + DVec2::new(850.0, 340.0)).to_vec();
    let mut bench = Bench::new(&[(&left, DVec2::new(70.0, 0.0)), (&right, DVec2::new(-70.0, 0.0))]);
    let (before, other) = (bench.tips(0), bench.tips(1));
    let goal = before[4] + DVec2::new(0.0, 60.0);
    bench.drag(before[4], goal, 30);
    let after = bench.tips(0);
    assert_eq!(bench.tips(1), other);
    assert_eq!(bench.sim.counts().idle_commands, 0);
    let came = (after[4] - before[4]).dot(goal - before[4]) / 60.0;
    assert!(
        came > 25.0,
        "{came} mm of 60: the other fingers hold the plate, but it comes"
    );
    assert!(
        (after[4].distance(after[0]) - before[4].distance(before[0])).abs() < 1e-6,
        "rigid"
    );
}

#[test]
fn dragging_on_a_plate_adds_an_arrow_when_it_lifts() {
    let hand: Vec<DVec2> = HAND.map(|f| f + DVec2::new(400.0, 340.0)).to_vec();
    let mut bench = Bench::new(&[(&hand, DVec2::new(90.0, 0.0))]);
    let from = DVec2::new(400.0, 345.0);
    assert!(bench.tips(0).iter().all(|tip| tip.distance(from) > REACH_MM));
    let to = DVec2::new(400.0, 400.0);
    bench.table.down(7, from);
    assert_eq!(bench.doing(), Editing::Plate);
    bench.table.shift(7, to);
    assert_eq!(bench.doing(), Editing::NewArrow { from, to });
    bench.run(100);
    assert_eq!(bench.sent, [], "not before it lifts");
    bench.table.up(7);
    bench.run(2);
    assert_eq!(bench.tips(0).len(), 6);
    assert_eq!(bench.sent.len(), 1);
    // Withdrawn, it adds none.
    bench.run(LAG);
    bench.table.down(8, from);
    bench.table.shift(8, to);
    bench.table.cancel(8);
    bench.run(2);
    assert_eq!(bench.sent.len(), 1);
}

#[test]
fn a_still_finger_removes_the_plate_after_eight_tenths_of_a_second() {
    for offset in [DVec2::ZERO, DVec2::new(24.0, 0.0)] {
        let mut bench = Bench::new(&[(&[DVec2::new(500.0, 340.0)], DVec2::new(60.0, 0.0))]);
        // Beside the tip no plate stands, yet it is the tip that is meant.
        let at = bench.tips(0)[0] + offset;
        bench.table.down(3, at);
        bench.table.shift(3, at + DVec2::new(2.0, 0.0));
        bench.run(25);
        let hold = bench.table.instrument.edits()[0].hold;
        assert!((hold - 0.5).abs() < 0.03, "{hold}");
        bench.run(24);
        assert_eq!(bench.sent, []);
        bench.run(3);
        assert_eq!(bench.sim.plate_marks().len(), 0);
        assert_eq!(bench.doing(), Editing::Removed);
        bench.table.shift(3, at + DVec2::new(80.0, 0.0));
        bench.run(20);
        bench.table.up(3);
        bench.run(2);
        assert_eq!(bench.sent.len(), 1, "the rest of the contact does nothing");
        assert_eq!(bench.sim.counts().idle_commands, 0);
    }
}

#[test]
fn a_tap_on_the_fault_flips_it() {
    let left: Vec<DVec2> = HAND.map(|f| f + DVec2::new(420.0, 340.0)).to_vec();
    let right: Vec<DVec2> = HAND.map(|f| f + DVec2::new(800.0, 340.0)).to_vec();
    let mut bench = Bench::new(&[(&left, DVec2::new(60.0, 0.0)), (&right, DVec2::new(-60.0, 0.0))]);
    let fault = bench.sim.fault_traces()[0].points.clone();
    let at = bench.table.set.map.to_table(fault[fault.len() / 2]) + DVec2::new(REACH_MM - 1.0, 0.0);
    bench.table.down(4, at);
    assert_eq!(bench.doing(), Editing::Fault);
    bench.table.up(4);
    bench.run(1);
    assert!(matches!(
        bench.sent[..],
        [Command {
            action: Action::FlipFault { .. },
            contact: Some(4),
            ..
        }]
    ));
    assert_eq!(bench.sim.counts().idle_commands, 0);
}

#[test]
fn where_nothing_is_nothing_happens_and_shows_at_once() {
    let mut bench = Bench::new(&[(&[DVec2::new(500.0, 340.0)], DVec2::new(60.0, 0.0))]);
    bench.table.down(1, DVec2::new(900.0, 100.0));
    assert_eq!(bench.doing(), Editing::Nothing);
    bench.run(60);
    bench.table.shift(1, DVec2::new(500.0, 340.0));
    bench.run(60);
    bench.table.up(1);
    bench.run(1);
    assert_eq!(bench.sent, []);
}

#[test]
fn a_plate_that_does_not_answer_is_asked_again_now_and_then() {
    let mut table = Table::new();
    let tip = DVec2::new(500.0, 300.0);
    table.set.clock.paused = true;
    table.set.plates = vec![PlateMark {
        hull: Vec::new(),
        arrows: vec![(table.set.map.to_plan(tip - 50.0), table.set.map.to_plan(tip))],
        spent: 0.0,
        state: orogen::surface::PlateState::Standing,
        cap: Some(0.9),
    }];
    table.down(1, tip);
    for step in 0..60_u32 {
        table.shift(1, tip + DVec2::new(f64::from(step), 0.0));
        table.wait(16);
    }
    let sent = table.instrument.drain();
    assert!((4..=8).contains(&sent.len()), "{}", sent.len());
    for deed in sent {
        let Deed::Command(Command {
            action: Action::EditArrow(arrow),
            ..
        }) = deed
        else {
            panic!("{deed:?}");
        };
        assert!(
            arrow.from.distance(tip) < 0.01,
            "it starts at the tip that is seen"
        );
    }
}

#[test]
fn a_palm_edits_nothing() {
    let mut bench = Bench::new(&[(&[DVec2::new(500.0, 340.0)], DVec2::new(60.0, 0.0))]);
    let mut palm = contact(1, bench.tips(0)[0]);
    palm.confidence = Some(0.0);
    assert_eq!(bench.table.event(Phase::Down, palm), Route::Tool);
    assert_eq!(bench.table.instrument.edits(), []);
    bench.run(80);
    bench.table.event(Phase::Up, palm);
    bench.run(1);
    assert_eq!(bench.sent, []);
}
