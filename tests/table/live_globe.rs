//! The planet on its session's thread: what staff save of the last minute replays to the bit.

use std::sync::Arc;

use glam::DVec2;
use orogen::gesture::command::Mode;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, Phase, Source};
use orogen::gesture::file::read_gesture;
use orogen::live::{GlobeSession, LiveGlobeParams};
use orogen::sim::TICK_US;
use orogen::sim::globe::{GlobeSim, GlobeSimParams, default_start};
use orogen::sphere::Lattice;

const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);

fn finger(phase: Phase, position: DVec2) -> Vec<ContactEvent> {
    let key = ContactKey {
        source: Source::Window,
        device: 0,
        id: 1,
        generation: 0,
    };
    vec![ContactEvent {
        phase,
        contact: Contact {
            key,
            position,
            size_mm: None,
            confidence: None,
        },
    }]
}

#[test]
fn the_last_minute_at_the_globe_replays_to_the_bit() {
    let session = GlobeSession::spawn(LiveGlobeParams {
        size_mm: SIZE_MM,
        samples: 2_000,
        start: default_start(9),
        sim: GlobeSimParams::default(),
        threads: 2,
    })
    .expect("a session");
    let mut now_us = 77_000_000;
    let middle = SIZE_MM / 2.0;
    for tick in 0..150_u32 {
        let at = middle + DVec2::new(f64::from(tick), 0.0);
        let events = match tick {
            10 => finger(Phase::Down, at),
            11..110 => finger(Phase::Move, at),
            110 => finger(Phase::Up, at),
            _ => Vec::new(),
        };
        session.send(events, Vec::new(), now_us);
        now_us += TICK_US;
        session.advance(now_us);
        session.save_world().recv().expect("an answer");
    }
    let live = session.save_world().recv().expect("the planet");
    assert_eq!(session.slowed_us(), 0, "the session kept up");
    assert!(live.counts().led > 0 && live.planet().time_my() > 4.0);

    let bytes = session.ring_file().recv().expect("the last minute");
    let file = read_gesture(bytes.as_slice(), "ring").expect("a good file");
    assert_eq!(file.header.mode, Mode::Globe, "a file of the globe");
    let samples = file.header.nodes.expect("samples") as usize;
    let lattice = Arc::new(Lattice::new(samples).expect("a lattice"));
    let start = default_start(file.header.seed.expect("a seed"));
    let params = GlobeSimParams::default();
    let mut replayed = GlobeSim::new(lattice, start, file.header.size_mm, params).expect("a planet");
    for frame in file.frames {
        replayed.feed(frame);
    }
    while replayed.ticks() < live.ticks() {
        replayed.tick();
    }
    let bits = |sim: &GlobeSim| -> Vec<u32> {
        let heights = sim.surface().elevation_m;
        heights.into_iter().map(f32::to_bits).collect()
    };
    assert!(bits(&replayed) == bits(&live), "another planet");
}
