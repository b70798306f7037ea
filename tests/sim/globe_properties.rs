//! Whatever hands and commands do on the globe, the session lives, the planet stays a planet, and the same input gives the
//! same bits.

use std::sync::Arc;

use orogen::gesture::command::{Action, Command, Paint, Place, Tool};
use orogen::gesture::contact::InputFrame;
use orogen::globe::Start;
use orogen::sim::TICK_US;
use orogen::sim::globe::{GlobeSim, GlobeSimParams};
use orogen::sphere::{Lattice, RADIUS_KM};
use proptest::prelude::*;

use crate::sim_common::{SIZE_MM, any_command, any_frames};

fn command() -> impl Strategy<Value = Command> {
    let place = || (-90.0..=90.0, -180.0..=180.0).prop_map(|(lat, lon)| Place { lat, lon });
    let action = prop_oneof![
        4 => Just(Action::Play),
        1 => Just(Action::Pause),
        2 => (0.0..100.0).prop_map(Action::Speed),
        3 => Just(Action::Undo),
        1 => Just(Action::StartOver),
        1 => Just(Action::Earth),
        1 => Just(Action::Tool(Tool::View)),
        2 => Just(Action::Tool(Tool::Push)),
        2 => Just(Action::Tool(Tool::Land)),
        1 => Just(Action::Tool(Tool::Sea)),
        3 => (-180.0..=180.0, -90.0..=90.0, 0.01..100.0)
            .prop_map(|(lon, lat, zoom)| Action::View { lon, lat, zoom }),
        1 => (1u32..60, 0.0..=1.0, any::<u64>())
            .prop_map(|(plates, continental, seed)| Action::Planet { plates, continental, seed }),
        3 => prop::collection::vec(place(), 2..5).prop_map(|path| Action::Cut { path }),
        3 => (place(), 0.0..=90.0, any::<bool>()).prop_map(|(at, radius_deg, land)| Action::Paint {
            at,
            radius_deg,
            paint: if land { Paint::Continent } else { Paint::Ocean },
        }),
    ];
    any_command(action)
}

fn frames() -> impl Strategy<Value = Vec<InputFrame>> {
    any_frames(8, command())
}

/// Plays `frames`; with `looks`, somebody looks after every tick, and the session goes on as a clone.
fn play(frames: &[InputFrame], looks: bool) -> GlobeSim {
    let lattice = Arc::new(Lattice::new(1500).expect("a lattice"));
    let start = Start::Random {
        plates: 9,
        continental: 0.3,
        seed: 3,
    };
    let mut sim = GlobeSim::new(lattice, start, SIZE_MM, GlobeSimParams::default()).expect("a planet");
    for frame in frames {
        sim.feed(frame.clone());
    }
    let last = frames.last().map_or(0, |frame| frame.t_us);
    while sim.ticks() * TICK_US <= last {
        sim.tick();
        if looks {
            let (tethers, taps) = (sim.tethers(), sim.taps());
            assert!(
                tethers
                    .iter()
                    .all(|t| t.held.is_normalized() && t.finger.is_normalized())
            );
            assert!(taps.iter().all(|tap| tap.at.is_normalized()));
            sim = sim.clone();
        }
    }
    sim.finish_input();
    sim.run_until(sim.planet().time_my() + 20.0, |_| true);
    sim
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn sessions_live_and_replay(frames in frames()) {
        let sim = play(&frames, false);
        let planet = sim.surface();
        prop_assert!(planet.elevation_m.iter().all(|z| z.is_finite() && z.abs() < 12_500.0));
        prop_assert_eq!(sim.planet().totals().quarantined, 0);
        let fastest = sim.params().globe.max_speed / RADIUS_KM;
        prop_assert!(planet.plates.iter().all(|plate| plate.omega.length() <= fastest * (1.0 + 1e-9)));
        prop_assert!((planet.plates.iter().map(|plate| plate.area_sr).sum::<f64>() - 12.566_37).abs() < 1e-3);
        let again = play(&frames, true);
        let other = again.surface();
        prop_assert!(planet.elevation_m == other.elevation_m, "the same input gives the same bits, whoever looks");
        prop_assert!(planet.plates == other.plates);
        prop_assert_eq!(sim.counts(), again.counts());
        prop_assert_eq!(sim.view(), again.view());
    }
}
