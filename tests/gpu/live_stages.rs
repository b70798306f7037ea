//! A live session whose stages are computed elsewhere: they stay with it, and it outlives them.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use glam::DVec2;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, Phase, Source};
use orogen::gpu::{GpuFolds, GpuTransport, OnCard};
use orogen::live::{LiveParams, Session, Start};
use orogen::mountain::Stages;
use orogen::mountain::transport::{CpuTransport, TransportField, TransportProblem, TransportStage};
use orogen::rock::preset;
use orogen::sim::{Sim, SimParams, TICK_US};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

use crate::card;

fn session(stages: Stages) -> Session {
    let mut sim = SimParams::default();
    // Coarse, so that these tests are quick; there are nodes enough for folds.
    sim.mountain.cells = 128 * 128;
    Session::spawn(LiveParams {
        map: PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE),
        nodes: 8_000,
        seed: 11,
        layers: preset::by_name("jura").expect("a preset"),
        sim,
        raster_width: 48,
        threads: 2,
        stages,
    })
    .expect("a session")
}

/// One finger rests and another pushes towards it for as many ticks, from `now_us` on.
fn push(session: &Session, now_us: &mut u64, ticks: u32) {
    let event = |phase, id, x| ContactEvent {
        phase,
        contact: Contact {
            key: ContactKey {
                source: Source::Window,
                device: 1,
                id,
                generation: 0,
            },
            position: DVec2::new(x, 340.0),
            size_mm: None,
            confidence: None,
        },
    };
    session.send(
        vec![event(Phase::Down, 1, 300.0), event(Phase::Down, 2, 800.0)],
        Vec::new(),
        *now_us,
    );
    for tick in 0..ticks {
        session.send(
            vec![event(Phase::Move, 2, 800.0 - 2.0 * f64::from(tick))],
            Vec::new(),
            *now_us,
        );
        *now_us += TICK_US;
        session.advance(*now_us);
        // Waits until it has been played.
        session.save_world().recv().expect("an answer");
    }
    session.send(
        vec![event(Phase::Up, 1, 300.0), event(Phase::Up, 2, 700.0)],
        Vec::new(),
        *now_us,
    );
}

fn sim(session: &Session) -> Sim {
    Sim::resume(session.save_world().recv().expect("an answer"))
}

/// Panics in some of its runs, counted from 1.
#[derive(Debug)]
struct Failing {
    runs: Arc<AtomicUsize>,
    fails: fn(usize) -> bool,
}

impl TransportStage for Failing {
    fn run(&mut self, problem: &TransportProblem, out: &mut TransportField) {
        let run = self.runs.fetch_add(1, Ordering::Relaxed) + 1;
        assert!(!(self.fails)(run), "injected");
        CpuTransport.run(problem, out);
    }

    fn is_reproducible(&self) -> bool {
        false
    }
}

fn failing(fails: fn(usize) -> bool) -> (Stages, Arc<AtomicUsize>) {
    let runs = Arc::new(AtomicUsize::new(0));
    let transport = Failing {
        runs: Arc::clone(&runs),
        fails,
    };
    let stages = Stages {
        transport: Box::new(transport),
        ..Stages::default()
    };
    (stages, runs)
}

#[test]
fn stages_stay_with_a_session_that_begins_again() {
    let (stages, runs) = failing(|_| false);
    let session = session(stages);
    let mut now_us = 0;
    push(&session, &mut now_us, 60);
    assert!(
        !sim(&session).is_reproducible(),
        "the land tells who has computed"
    );
    session.restart(Start::Seed(12));
    let before = runs.load(Ordering::Relaxed);
    push(&session, &mut now_us, 60);
    assert!(
        runs.load(Ordering::Relaxed) > before + 10,
        "the stage is asked again"
    );
}

#[test]
fn a_stage_that_panics_leaves_the_work_to_the_processor() {
    let (stages, runs) = failing(|run| run > 3);
    let mut session = session(stages);
    let mut now_us = 0;
    push(&session, &mut now_us, 80);
    push(&session, &mut now_us, 80);
    assert_eq!((runs.load(Ordering::Relaxed), session.frame().panics), (4, 1));
    let rates = sim(&session).node_uplift().iter().copied().fold(0.0, f64::max);
    assert!(rates > 1e-5, "hands still move the land: {rates} m/yr");
}

#[test]
fn a_session_outlives_its_card() {
    let Some(gpu) = card::computing() else { return };
    let patience = Duration::from_mins(1);
    let transport = GpuTransport::new(&gpu).expect("a stage").with_patience(patience);
    let folds = GpuFolds::new(&gpu).expect("a stage").with_patience(patience);
    let on_card = [transport.on_card(), folds.on_card()];
    let mut session = session(Stages {
        transport: Box::new(transport),
        folds: Box::new(folds),
    });
    let mut now_us = 0;
    push(&session, &mut now_us, 40);
    session.restart(Start::Seed(12));
    push(&session, &mut now_us, 40);
    assert!(on_card.iter().all(OnCard::get));
    assert!(!sim(&session).is_reproducible());
    gpu.device.destroy();
    push(&session, &mut now_us, 40);
    assert!(on_card.iter().all(|on_card| !on_card.get()));
    assert_eq!(session.frame().panics, 0);
    let after = sim(&session);
    assert!(
        after.node_uplift().iter().any(|&rate| rate > 1e-5),
        "hands still move the land"
    );
    assert!(after.world().z.iter().all(|z| z.is_finite()));
    drop(session);
}
