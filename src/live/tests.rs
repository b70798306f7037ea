//! Faults that only this module can inject.

use glam::DVec2;

use super::*;
use crate::gesture::command::{Action, Command};
use crate::gesture::contact::{Contact, ContactKey, Phase, Source};
use crate::gesture::file::read_gesture;
use crate::mountain::Stages;
use crate::sim::{Sim, SimParams, TICK_US};
use crate::units::{DEFAULT_SHORT_SIDE, PlanMap};

/// A session that is driven tick by tick.
struct Table {
    session: Session,
    now_us: u64,
}

impl Table {
    fn new() -> Self {
        let mut sim = SimParams::default();
        sim.mountain.cells = 96 * 96;
        let session = Session::spawn(LiveParams {
            map: PlanMap::new(DVec2::new(1200.0, 700.0), DEFAULT_SHORT_SIDE),
            nodes: 400,
            seed: 3,
            layers: crate::rock::preset::default(),
            sim,
            raster_width: 24,
            threads: 1,
            stages: Stages::default(),
        });
        Self {
            session: session.unwrap(),
            now_us: 5_000_000,
        }
    }

    fn ticks(&mut self, count: u64) {
        for _ in 0..count {
            self.now_us += TICK_US;
            self.session.advance(self.now_us);
            // Whoever has answered has played what came before.
            self.session.save_world().recv().unwrap();
        }
    }

    fn contact(&self, phase: Phase, x: f64) {
        let contact = Contact {
            key: ContactKey {
                source: Source::Window,
                device: 0,
                id: 1,
                generation: 0,
            },
            position: DVec2::new(x, 300.0),
            size_mm: None,
            confidence: None,
        };
        self.session
            .send(vec![ContactEvent { phase, contact }], Vec::new(), self.now_us);
    }

    fn land(&self) -> Sim {
        Sim::resume(self.session.save_world().recv().unwrap())
    }
}

#[test]
fn a_panic_costs_a_second_and_the_contacts() {
    let mut table = Table::new();
    table.ticks(5);
    table.contact(Phase::Down, 300.0);
    for step in 0..100 {
        table.ticks(1);
        table.contact(Phase::Move, 300.0 + f64::from(step));
    }
    table
        .session
        .send(Vec::new(), vec![Command::new(Action::Speed(0.25))], table.now_us);
    table.ticks(70);
    let before = table.land();
    assert_eq!(before.hands().count(), 1);
    table.session.tell(Message::Fault);
    table.ticks(2);
    let after = table.land();
    assert_eq!(after.hands().count(), 0, "contacts are withdrawn");
    assert!(after.ticks() > before.ticks(), "session time goes on");
    let lost_yr = before.world().time_yr - after.world().time_yr;
    assert!((0.0..=0.6e6).contains(&lost_yr), "{lost_yr}");
    assert!(after.world().time_yr > 0.5e6);
    assert_eq!(after.pace_yr_per_s(), 0.25e6, "the clock is as it was set");
    assert_eq!(after.world().plates.plates().len(), 1);
    assert!(!after.world().plates.plates()[0].held);
    assert_eq!(table.session.frame().panics, 1);

    // The thread lives: a new finger does what fingers do, and the recording can be read.
    table.contact(Phase::Move, 500.0);
    table.contact(Phase::Up, 500.0);
    table.contact(Phase::Down, 600.0);
    table.ticks(3);
    assert_eq!(table.session.frame().hands.len(), 1);
    let bytes = table.session.ring_file().recv().unwrap();
    let file = read_gesture(bytes.as_slice(), "ring").unwrap();
    let cancelled = |frame: &crate::gesture::contact::InputFrame| {
        frame.events.iter().any(|event| event.phase == Phase::Cancel)
    };
    assert!(file.frames.iter().any(cancelled));
}

#[test]
fn panics_in_a_row_lead_back_to_the_first_land() {
    let mut table = Table::new();
    table.contact(Phase::Down, 300.0);
    for step in 0..100 {
        table.ticks(1);
        table.contact(Phase::Move, 300.0 + f64::from(step));
    }
    table.contact(Phase::Up, 400.0);
    table.ticks(100);
    let heartbeat = table.session.heartbeat();
    let mut times = vec![table.land().world().time_yr];
    for _ in 0..4 {
        table.session.tell(Message::Fault);
        table.ticks(1);
        times.push(table.land().world().time_yr);
    }
    assert!(times[0] - times[1] < 0.6e6 && times[1] > 1e6, "{times:?}");
    assert!(
        times[2] <= times[1] && times[2] > 1e6,
        "the land alone: {times:?}"
    );
    assert_eq!(times[3], 0.0, "the first land");
    assert_eq!(times[4], 0.0);
    assert_eq!(table.session.frame().panics, 4);
    let beats = heartbeat.beats();
    table.ticks(70);
    assert!(heartbeat.beats() > beats);
    assert!(table.land().world().time_yr > 0.0, "and on it goes");
}

#[test]
fn the_shown_land_is_whole_after_a_panic() {
    let mut table = Table::new();
    table.contact(Phase::Down, 300.0);
    for step in 0..40 {
        table.ticks(1);
        table.contact(Phase::Move, 300.0 + 2.0 * f64::from(step));
        if step % 10 == 9 {
            table.session.tell(Message::Fault);
        }
    }
    table.ticks(4);
    let world = table.land();
    let frame = table.session.frame();
    let shown = frame.surface.height.data.iter().copied().fold(f32::MIN, f32::max);
    let highest = world.world().z.iter().copied().fold(f64::MIN, f64::max);
    assert!(frame.surface.height.data.iter().all(|z| z.is_finite()));
    assert!(f64::from(shown) <= highest + 50.0, "{shown} of {highest}");
    assert_eq!(frame.surface.height.data.len(), 24 * 14);
}

#[test]
fn a_fresh_land_may_have_other_nodes() {
    let mut table = Table::new();
    table.ticks(3);
    let heights = table.session.frame().surface.height.data.len();
    for (seed, nodes) in [(3, 900), (3, 900), (4, 400)] {
        table.session.restart(Start::Nodes { seed, nodes });
        table.ticks(2);
        let land = table.land();
        assert_eq!((land.world().seed, land.world().tin.len()), (seed, nodes));
        assert_eq!(
            table.session.frame().surface.height.data.len(),
            heights,
            "the picture keeps its size"
        );
        // The recording of the last minute replays on as many.
        let bytes = table.session.ring_file().recv().unwrap();
        let file = read_gesture(bytes.as_slice(), "ring").unwrap();
        assert_eq!(file.header.nodes, Some(nodes as u64));
    }
    table.session.restart(Start::Seed(5));
    table.ticks(2);
    assert_eq!(table.land().world().tin.len(), 400, "from then on");
}
