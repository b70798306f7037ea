//! Whatever hands and commands do, the session lives, the land stays finite, and the same input gives the same bits.

use orogen::gesture::command::{Action, Arrow, Command};
use orogen::gesture::contact::InputFrame;
use orogen::sim::{Quarantine, Sim, SimParams, TICK_US, World};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};
use proptest::prelude::*;

use crate::sim_common::{SIZE_MM, any_command, any_frames, place};

fn command() -> impl Strategy<Value = Command> {
    let arrow = || (place(), place()).prop_map(|(from, to)| Arrow { from, to });
    let action = prop_oneof![
        4 => Just(Action::Play),
        1 => Just(Action::Pause),
        2 => (0.0..5.0).prop_map(Action::Speed),
        3 => Just(Action::Undo),
        2 => place().prop_map(|at| Action::Remove { at }),
        2 => arrow().prop_map(Action::AddArrow),
        2 => arrow().prop_map(Action::EditArrow),
        2 => place().prop_map(|at| Action::FlipFault { at }),
        1 => Just(Action::StartOver),
        2 => (0.0..3e6).prop_map(Action::Scrub),
        1 => Just(Action::Earth),
    ];
    any_command(action)
}

fn frames() -> impl Strategy<Value = Vec<InputFrame>> {
    any_frames(12, command())
}

/// Plays `frames`; with `looks`, somebody looks at the land after every tick, and the session is cut and resumed.
fn play(frames: &[InputFrame], looks: bool) -> Sim {
    let map = PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE);
    let world = World::new(map, 200, 3).expect("a world");
    let mut params = SimParams::default();
    // Coarse, so that many sessions fit into a test.
    params.mountain.cells = 96 * 96;
    params.run_on_yr = 2e5;
    let mut sim = Sim::new(world, params);
    for frame in frames {
        sim.feed(frame.clone());
    }
    let last = frames.last().map_or(0, |frame| frame.t_us);
    let mut rise = Vec::new();
    while sim.ticks() * TICK_US <= last {
        sim.tick();
        if looks {
            sim.refresh_uplift();
            sim.rise_into(&mut rise);
            assert!(rise.iter().all(|rate| rate.is_finite()));
        }
    }
    if looks {
        let moment = sim.checkpoint();
        sim = Sim::resume(moment);
    }
    sim.finish_input();
    sim.run_on(|_, _| true);
    sim
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn sessions_live_and_replay(frames in frames()) {
        let sim = play(&frames, false);
        prop_assert!(sim.world().z.iter().all(|z| z.is_finite()));
        prop_assert_eq!(sim.quarantine(), Quarantine::default());
        prop_assert!(sim.world().plates.plates().len() <= 16);
        prop_assert!(sim.node_uplift().iter().all(|u| u.abs() < 1e-2));
        prop_assert!(sim.ticks() >= frames.last().map_or(0, |frame| frame.t_us) / TICK_US);
        let again = play(&frames, true);
        prop_assert!(
            sim.world().z == again.world().z,
            "the same input gives the same bits, whoever looks"
        );
        prop_assert_eq!(sim.counts(), again.counts());
        prop_assert_eq!(sim.fault_traces(), again.fault_traces());
    }
}
