//! The session as a whole: answers, undo, roll-back, quarantine, determinism.

use std::sync::Arc;

use glam::DVec2;
use orogen::gesture::command::{Action, Arrow, Command};
use orogen::gesture::contact::{InputFrame, Phase, Side};
use orogen::sim::{Sim, SimParams, TICK_US, World};
use orogen::terrain::{Resampling, Tin};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

use crate::sim_common::{SIZE_MM, event, frame, palm, stroke};

fn sim(nodes: usize) -> Sim {
    let world = World::new(PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE), nodes, 7).expect("a world");
    Sim::new(world, SimParams::default())
}

fn play(sim: &mut Sim, frames: Vec<InputFrame>, until_ms: u64) {
    for frame in frames {
        sim.feed(frame);
    }
    while sim.ticks() * TICK_US <= until_ms * 1000 {
        sim.tick();
    }
}

fn difference(a: &Sim, b: &Sim) -> f64 {
    a.world()
        .z
        .iter()
        .zip(&b.world().z)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn land_answers_while_the_finger_moves() {
    let (mut touched, mut untouched) = (sim(3000), sim(3000));
    play(
        &mut touched,
        stroke(1, DVec2::new(600.0, 340.0), DVec2::new(80.0, 0.0), 100, 800),
        900,
    );
    play(&mut untouched, Vec::new(), 900);
    assert!(difference(&touched, &untouched) > 5.0, "before the finger lifts");
    play(&mut touched, Vec::new(), 1900);
    play(&mut untouched, Vec::new(), 1900);
    assert!(difference(&touched, &untouched) > 50.0, "a second later");
    assert_eq!(touched.counts().dead_touches, 0);
    assert_eq!(touched.contact_stats().pushes, 1);
}

#[test]
fn undo_restores_land_and_time_of_the_last_push_of_that_side() {
    let mut sim = sim(1000);
    play(&mut sim, Vec::new(), 500);
    let before = sim.world().clone();
    // A push in the southern half, then one in the northern half.
    play(
        &mut sim,
        stroke(1, DVec2::new(300.0, 550.0), DVec2::new(60.0, 0.0), 520, 400),
        2000,
    );
    let between = sim.world().clone();
    play(
        &mut sim,
        stroke(2, DVec2::new(800.0, 120.0), DVec2::new(60.0, 0.0), 2020, 400),
        3000,
    );
    assert!(sim.undo(Some(Side::North)));
    assert!(
        sim.world().time_yr >= between.time_yr
            && sim.world().plates.plates().len() == between.plates.plates().len()
    );
    assert!(sim.undo(Some(Side::South)));
    assert_eq!(sim.world().plates.plates().len(), 0);
    assert!(sim.world().time_yr - before.time_yr < 100_000.0);
    assert!(!sim.undo(Some(Side::South)), "nothing is left to undo");
    let undone = InputFrame {
        t_us: 3_100_000,
        events: Vec::new(),
        commands: vec![Command {
            action: Action::Undo,
            side: Some(Side::South),
            contact: None,
        }],
    };
    play(&mut sim, vec![undone], 3200);
    assert_eq!(sim.counts().idle_commands, 1);
}

#[test]
fn a_contact_that_turns_out_to_be_a_sleeve_leaves_no_trace() {
    let (mut touched, mut untouched) = (sim(2000), sim(2000));
    let at = |step: u64| DVec2::new(600.0 + 10.0 * step as f64, 340.0);
    let mut frames = vec![frame(96, vec![event(Phase::Down, 1, at(0))])];
    for step in 1..12 {
        frames.push(frame(96 + step * 16, vec![event(Phase::Move, 1, at(step))]));
    }
    // Only now does the device say that it is none of a finger's contacts, within 250 ms.
    frames.push(frame(96 + 12 * 16, vec![palm(Phase::Move, 1, at(12))]));
    for step in 13..60 {
        frames.push(frame(96 + step * 16, vec![palm(Phase::Move, 1, at(step))]));
    }
    frames.push(frame(96 + 60 * 16, vec![palm(Phase::Up, 1, at(60))]));
    play(&mut touched, frames, 2000);
    play(&mut untouched, Vec::new(), 2000);
    assert_eq!(touched.counts().rolled_back, 1);
    assert_eq!(touched.world().plates.plates().len(), 0);
    assert_eq!(difference(&touched, &untouched), 0.0, "to the bit");
    assert_eq!(touched.ticks(), untouched.ticks());
}

#[test]
fn a_short_stroke_does_not_undo_a_grand_push() {
    let (mut alone, mut disturbed) = (sim(3000), sim(3000));
    let (from, by) = (DVec2::new(500.0, 340.0), DVec2::new(120.0, 0.0));
    let push = stroke(1, from, by, 0, 600);
    let mut both = push.clone();
    // A second later somebody's finger slips back over the place where the plate now stands.
    both.extend(stroke(2, from + by, DVec2::new(-8.0, 3.0), 1600, 160));
    play(&mut alone, push, 6000);
    play(&mut disturbed, both, 6000);
    assert_eq!(disturbed.contact_stats().pushes, 2);
    let highest = |sim: &Sim| sim.world().z.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (alone, disturbed) = (highest(&alone), highest(&disturbed));
    assert!(alone > 500.0, "the grand push raises a range: {alone} m");
    assert!(disturbed > 0.9 * alone, "and goes on: {disturbed} m of {alone} m");
}

#[test]
fn commands_edit_standing_plates() {
    let mut sim = sim(1000);
    let at = DVec2::new(600.0, 340.0);
    play(&mut sim, stroke(1, at, DVec2::new(80.0, 0.0), 0, 400), 1000);
    let command = |t_us: u64, action: Action| InputFrame {
        t_us,
        events: Vec::new(),
        commands: vec![Command::new(action)],
    };
    let before = sim.world().plates.plates()[0].motion;
    let tip = at + DVec2::new(80.0, 0.0);
    let arrow = Arrow {
        from: tip,
        to: tip + DVec2::new(0.0, 40.0),
    };
    play(&mut sim, vec![command(1_100_000, Action::EditArrow(arrow))], 1300);
    let after = sim.world().plates.plates()[0].motion;
    assert!(
        after.translation.y < before.translation.y - 1000.0,
        "down on the table is south"
    );
    play(&mut sim, vec![command(1_400_000, Action::Speed(0.0))], 1500);
    let stopped = sim.world().time_yr;
    play(&mut sim, vec![command(1_600_000, Action::Remove { at })], 2000);
    assert_eq!(sim.world().time_yr, stopped, "speed 0 stops the clock");
    assert!(sim.world().plates.plates().is_empty());
    play(&mut sim, vec![command(2_100_000, Action::StartOver)], 2200);
    assert_eq!(sim.world().time_yr, 0.0);
    assert!(sim.fault_traces().is_empty(), "fresh land has no faults");
    play(&mut sim, vec![command(2_300_000, Action::Earth)], 2400);
    assert_eq!(
        sim.counts().idle_commands,
        1,
        "the globe's words mean nothing here"
    );
}

#[test]
fn an_edit_is_undone_as_one_and_gives_the_plate_back() {
    let mut sim = sim(1000);
    let at = DVec2::new(600.0, 340.0);
    play(&mut sim, stroke(1, at, DVec2::new(80.0, 0.0), 0, 400), 1000);
    let command = |t_us: u64, action: Action| InputFrame {
        t_us,
        events: Vec::new(),
        commands: vec![Command {
            contact: Some(77),
            ..Command::new(action)
        }],
    };
    let before = sim.world().plates.plates()[0].motion;
    let tip = at + DVec2::new(80.0, 0.0);
    let step = |from: f64, to: f64| {
        Action::EditArrow(Arrow {
            from: tip + DVec2::new(0.0, from),
            to: tip + DVec2::new(0.0, to),
        })
    };
    let steps = [(0.0, 10.0), (10.0, 20.0), (20.0, 30.0)];
    let frames = steps
        .iter()
        .zip([1_100_000, 1_150_000, 1_200_000])
        .map(|(&(from, to), t_us)| command(t_us, step(from, to)))
        .collect();
    play(&mut sim, frames, 1300);
    assert_ne!(sim.world().plates.plates()[0].motion, before);
    play(&mut sim, vec![command(1_400_000, Action::Undo)], 1450);
    assert_eq!(
        sim.world().plates.plates()[0].motion,
        before,
        "all steps of one contact"
    );
    play(&mut sim, vec![command(1_500_000, Action::Remove { at })], 1550);
    assert!(sim.world().plates.plates().is_empty());
    play(&mut sim, vec![command(1_600_000, Action::Undo)], 1650);
    assert_eq!(sim.world().plates.plates().len(), 1);
    // What changes nothing leaves nothing to undo: the next undo takes the push itself back.
    let nowhere = Action::Remove {
        at: DVec2::new(10.0, 10.0),
    };
    play(&mut sim, vec![command(1_700_000, nowhere)], 1750);
    play(&mut sim, vec![command(1_800_000, Action::Undo)], 1850);
    assert!(sim.world().plates.plates().is_empty());
}

#[test]
fn a_world_moves_to_other_nodes() {
    let mut sim = sim(2000);
    play(
        &mut sim,
        stroke(1, DVec2::new(600.0, 340.0), DVec2::new(80.0, 0.0), 0, 400),
        3000,
    );
    let world = sim.world();
    let finer = Tin::poisson(world.map.extent(), 8000, 3).expect("a TIN");
    let places = Resampling::new(&world.tin, finer.positions());
    let moved = world.resampled(Arc::new(finer), &places);
    let mean = |world: &World| {
        let areas = world.tin.areas();
        world.z.iter().zip(areas).map(|(z, a)| z * a).sum::<f64>() / areas.iter().sum::<f64>()
    };
    assert_eq!(moved.z.len(), 8000);
    assert!(
        (mean(world) - mean(&moved)).abs() < 3.0,
        "{} m and {} m",
        mean(world),
        mean(&moved)
    );
    assert_eq!(moved.strata.base().len(), 8000);
    assert_eq!(moved.plates, world.plates);
}

#[test]
fn a_paused_world_stands_still() {
    let mut sim = sim(500);
    let pause = Command {
        action: Action::Pause,
        side: None,
        contact: None,
    };
    play(
        &mut sim,
        vec![InputFrame {
            t_us: 0,
            events: Vec::new(),
            commands: vec![pause],
        }],
        1000,
    );
    assert_eq!(sim.world().time_yr, 0.0);
    let go = Command {
        action: Action::Play,
        side: None,
        contact: None,
    };
    play(
        &mut sim,
        vec![InputFrame {
            t_us: 1_100_000,
            events: Vec::new(),
            commands: vec![go],
        }],
        2000,
    );
    assert!(sim.world().time_yr > 0.0);
}

#[test]
fn numbers_that_are_none_never_reach_the_land() {
    let world = World::new(PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE), 500, 7).expect("a world");
    let mut params = SimParams::default();
    params.erosion.k = f64::NAN;
    let mut sim = Sim::new(world, params);
    play(
        &mut sim,
        stroke(1, DVec2::new(600.0, 340.0), DVec2::new(80.0, 0.0), 0, 400),
        1000,
    );
    assert!(sim.quarantine().steps > 0, "the broken steps are counted");
    assert!(sim.world().z.iter().all(|z| z.is_finite()));
}

#[test]
fn the_same_session_gives_the_same_bits_for_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let mut sim = sim(5000);
            let mut frames = stroke(1, DVec2::new(300.0, 340.0), DVec2::new(90.0, 20.0), 0, 500);
            frames.extend(stroke(
                2,
                DVec2::new(800.0, 300.0),
                DVec2::new(-90.0, 0.0),
                600,
                500,
            ));
            play(&mut sim, frames, 2500);
            sim.world().z.iter().map(|z| z.to_bits()).collect::<Vec<_>>()
        })
    };
    let one = run(1);
    assert!(one == run(2), "2 threads");
    assert!(one == run(7), "7 threads");
}

#[test]
fn a_world_rests_five_million_years_after_its_last_push() {
    let mut sim = sim(300);
    play(
        &mut sim,
        stroke(1, DVec2::new(600.0, 340.0), DVec2::new(60.0, 0.0), 0, 400),
        600,
    );
    assert!(!sim.at_rest());
    let mut steps = 0;
    sim.run_on(|_, _| {
        steps += 1;
        true
    });
    assert!(sim.at_rest());
    let since = sim.world().time_yr - sim.world().last_push_yr;
    assert!((5.0e6..5.1e6).contains(&since), "{since}");
    assert!(steps > 80);
    let resting = sim.world().time_yr;
    sim.tick();
    assert_eq!(sim.world().time_yr, resting);
}

#[test]
fn a_stopped_clock_does_not_run_on() {
    for stop in [Action::Pause, Action::Speed(0.0)] {
        let mut sim = sim(300);
        play(
            &mut sim,
            stroke(1, DVec2::new(600.0, 340.0), DVec2::new(60.0, 0.0), 0, 400),
            600,
        );
        let commands = vec![Command::new(stop)];
        play(
            &mut sim,
            vec![InputFrame {
                t_us: 700_000,
                events: Vec::new(),
                commands,
            }],
            800,
        );
        let stopped = sim.world().time_yr;
        sim.run_on(|_, _| true);
        assert_eq!(sim.world().time_yr, stopped);
    }
}

#[test]
fn the_shown_land_rises_between_two_steps_and_meets_the_next_one() {
    let mut sim = sim(3000);
    play(
        &mut sim,
        stroke(1, DVec2::new(600.0, 340.0), DVec2::new(80.0, 0.0), 0, 400),
        6000,
    );
    // The heights at the moment, with what erosion takes between two steps and without.
    let mut rise = Vec::new();
    let mut shown = |sim: &mut Sim| {
        sim.refresh_uplift();
        sim.rise_into(&mut rise);
        let (z, pending) = (&sim.world().z, sim.pending_yr());
        let at = |rates: &[f64]| -> Vec<f64> { z.iter().zip(rates).map(|(z, r)| z + r * pending).collect() };
        [at(&rise), at(sim.node_uplift())]
    };
    let rms = |a: &[f64], b: &[f64]| {
        (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
    };
    let (mut moved, mut jumps) = (f64::INFINITY, [0.0; 2]);
    let mut before = shown(&mut sim);
    for _ in 0..60 {
        let revision = sim.land_revision();
        let stepped = sim.tick().erosion_steps > 0;
        let now = shown(&mut sim);
        assert_eq!(sim.land_revision() > revision, stepped);
        if stepped {
            jumps = [0, 1].map(|k| jumps[k] + rms(&now[k], &before[k]));
        } else {
            moved = moved.min(rms(&now[0], &before[0]));
        }
        before = now;
    }
    assert!(moved > 0.02, "a moving land moves at every tick: {moved} m");
    let [jump, bare] = jumps;
    assert!(
        jump < 0.5 * bare,
        "steps show half as much: {jump} m, not {bare} m"
    );
}

#[test]
fn contacts_that_are_withdrawn_end_what_they_do() {
    let mut sim = sim(500);
    let at = DVec2::new(600.0, 340.0);
    play(&mut sim, vec![frame(0, vec![event(Phase::Down, 1, at)])], 1000);
    assert_eq!(sim.hands().count(), 1);
    let mut resumed = Sim::resume(sim.checkpoint().at_tick(100));
    assert_eq!(resumed.ticks(), 100);
    resumed.cancel_contacts();
    resumed.tick();
    assert_eq!(resumed.hands().count(), 0);
    assert_eq!(sim.hands().count(), 1, "the other one is another session");
}

#[test]
fn looking_at_every_tick_changes_nothing() {
    let (mut watched, mut alone) = (sim(800), sim(800));
    // Rubbing: the plate is another at every tick, and what it was between two steps leaves no mark.
    let rub = |step: u64| DVec2::new(600.0 + 60.0 * (step as f64 * 0.3).sin(), 340.0 + step as f64);
    let mut frames = vec![frame(0, vec![event(Phase::Down, 1, rub(0))])];
    frames.extend((1..150).map(|step| frame(step * 16, vec![event(Phase::Move, 1, rub(step))])));
    for frame in frames {
        watched.feed(frame.clone());
        alone.feed(frame);
    }
    for _ in 0..200 {
        watched.refresh_uplift();
        watched.tick();
        alone.tick();
        assert!(watched.world().z == alone.world().z);
        assert_eq!(watched.fault_traces(), alone.fault_traces());
        assert_eq!(watched.node_uplift(), alone.node_uplift());
    }
    assert!(alone.world().plates.residues().len() > 1);
}
