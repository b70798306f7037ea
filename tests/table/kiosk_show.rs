//! The show on a real session: contacts that are well formed, land that rises, and nothing left when it is stopped.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use orogen::gesture::contact::{ContactKey, InputFrame, Phase, Source};
use orogen::kiosk::{Show, ShowStep};
use orogen::sim::{Sim, SimParams, World};
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);
const TICK_US: u64 = 16_000;

/// A show that runs, and what must hold of its contacts.
struct Watched {
    show: Show,
    now_us: u64,
    down: BTreeMap<ContactKey, DVec2>,
    used: BTreeSet<ContactKey>,
}

impl Watched {
    fn new(size_mm: DVec2) -> Self {
        let mut show = Show::new(size_mm);
        show.start();
        Self {
            show,
            now_us: 90_000_000,
            down: BTreeMap::new(),
            used: BTreeSet::new(),
        }
    }

    fn step(&mut self) -> ShowStep {
        self.now_us += TICK_US;
        let step = self.show.advance(self.now_us);
        for frame in &step.frames {
            self.check(frame);
        }
        step
    }

    fn check(&mut self, frame: &InputFrame) {
        assert_eq!(frame.t_us, self.now_us);
        for event in &frame.events {
            let key = event.contact.key;
            assert_eq!(key.source, Source::File);
            match event.phase {
                Phase::Down => {
                    assert!(self.used.insert(key), "a key is used again");
                    self.down.insert(key, event.contact.position);
                }
                Phase::Move => assert!(self.down.insert(key, event.contact.position).is_some()),
                Phase::Up | Phase::Cancel => assert!(self.down.remove(&key).is_some()),
            }
        }
    }
}

#[test]
fn it_plays_clip_after_clip_on_fresh_land_with_flights_between_and_begins_again() {
    let mut watched = Watched::new(SIZE_MM);
    let (mut fresh, mut flights, mut flew) = (Vec::new(), 0, false);
    // Six clips and the first once more, about half a minute each.
    while fresh.len() < 7 && watched.now_us < 400_000_000 {
        let step = watched.step();
        if let Some(seed) = step.fresh {
            assert!(watched.down.is_empty(), "no hand lies on new land");
            fresh.push((seed, watched.now_us));
        }
        assert!(!step.fly || watched.down.is_empty(), "hands push in the plan");
        flights += usize::from(step.fly && !flew);
        flew = step.fly;
    }
    assert_eq!(fresh.len(), 7);
    assert_eq!(flights, 6);
    assert_eq!(fresh[0].0, fresh[6].0);
    for pair in fresh.windows(2) {
        let seconds = (pair[1].1 - pair[0].1) / 1_000_000;
        assert!((24..=35).contains(&seconds), "{seconds} s");
    }
}

#[test]
fn the_first_clip_raises_a_range_within_ten_seconds() {
    let map = PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE);
    let mut watched = Watched::new(SIZE_MM);
    let seed = watched.step().fresh.expect("fresh land first");
    let world = World::new(map, 3000, seed).expect("a world");
    let before = world.z.iter().copied().fold(f64::MIN, f64::max);
    let mut sim = Sim::new(world, SimParams::default());
    for tick in 0..10_000_000 / TICK_US {
        for mut frame in watched.step().frames {
            frame.t_us = tick * TICK_US;
            sim.feed(frame);
        }
        sim.tick();
    }
    let after = sim.world().z.iter().copied().fold(f64::MIN, f64::max);
    assert!(after > before + 500.0, "{before} → {after}");
}

#[test]
fn stopped_it_withdraws_its_hands_and_goes_on_with_the_next_clip() {
    let mut watched = Watched::new(SIZE_MM);
    let first = watched.step().fresh;
    while watched.down.len() < 5 {
        watched.step();
    }
    let frame = watched.show.stop(watched.now_us).expect("hands were down");
    assert!(frame.events.iter().all(|event| event.phase == Phase::Cancel));
    watched.check(&frame);
    assert!(watched.down.is_empty());
    assert!(!watched.show.playing());
    assert_eq!(watched.step(), ShowStep::default());
    assert_eq!(watched.show.stop(watched.now_us), None);
    watched.show.start();
    let second = watched.step().fresh;
    assert!(
        second.is_some() && second != first,
        "passers-by see something new"
    );
    while watched.now_us < 200_000_000 {
        watched.step();
    }
}

#[test]
fn a_halt_does_not_make_its_hands_jump() {
    let mut watched = Watched::new(SIZE_MM);
    while watched.down.len() < 5 {
        watched.step();
    }
    watched.step();
    let before = watched.down.clone();
    watched.now_us += 30_000_000;
    watched.step();
    for (key, at) in &watched.down {
        if let Some(was) = before.get(key) {
            assert!(was.distance(*at) < 60.0);
        }
    }
    assert!(!watched.down.is_empty(), "it is still the same push");
}
