//! The gesture corpus on the globe: what each recording promises is what happens.
//!
//! The numbers are coarse on purpose: they hold for another number of samples and for small changes of the constants, and
//! fail where the story is another. `cargo test --test gesture corpus_globe -- --nocapture` prints what was found.

use std::fs::File;
use std::sync::Arc;

use glam::DVec3;
use orogen::gesture::file::{GestureFile, read_gesture};
use orogen::sim::TICK_US;
use orogen::sim::globe::{GlobeSim, GlobeSimParams, default_start};
use orogen::sphere::{Lattice, arc, direction};
use orogen::surface::planet::{Orogeny, Planet};

/// Enough for ranges, and few enough for a test.
const SAMPLES: usize = 20_000;

fn file(name: &str) -> GestureFile {
    let path = format!("{}/gestures/{name}.gesture.jsonl", env!("CARGO_MANIFEST_DIR"));
    read_gesture(File::open(&path).expect("a file"), &path).expect("a gesture file")
}

/// A recording, played from one moment to the next.
struct Play {
    sim: GlobeSim,
}

impl Play {
    fn new(file: &GestureFile) -> Self {
        let lattice = Arc::new(Lattice::new(SAMPLES).expect("a lattice"));
        let start = default_start(file.header.seed.unwrap_or(1));
        let params = GlobeSimParams::default();
        let mut sim = GlobeSim::new(lattice, start, file.header.size_mm, params).expect("a planet");
        for frame in &file.frames {
            sim.feed(frame.clone());
        }
        Self { sim }
    }

    fn until_ms(&mut self, ms: u64) -> Planet {
        while self.sim.ticks() * TICK_US <= ms * 1000 {
            self.sim.tick();
        }
        self.sim.surface()
    }
}

/// Samples within an angle of a place.
fn around(planet: &Planet, at: DVec3, degrees: f64) -> impl Iterator<Item = usize> {
    let points = planet.lattice.points().iter().enumerate();
    points
        .filter(move |(_, p)| arc(**p, at) < degrees.to_radians())
        .map(|(i, _)| i)
}

fn highest(planet: &Planet, at: DVec3, degrees: f64) -> f32 {
    let heights = around(planet, at, degrees).map(|i| planet.elevation_m[i]);
    heights.fold(f32::NEG_INFINITY, f32::max)
}

/// Area of continental crust, steradians.
fn continents(planet: &Planet) -> f64 {
    let areas = planet.lattice.areas().iter().zip(&planet.continental);
    areas.filter(|(_, land)| **land).map(|(area, _)| area).sum()
}

#[test]
fn two_continents_collide_and_a_new_sea_opens_where_they_are_torn() {
    let file = file("planet_collide_and_tear");
    let mut play = Play::new(&file);
    let before = play.until_ms(160);
    assert_eq!(play.sim.planet().totals().collisions, 0);
    let welded = play.until_ms(9_500);
    let seam = direction(7.0, 35.0);
    let collisions = play.sim.planet().totals().collisions;
    let raised = around(&welded, seam, 20.0)
        .filter(|&i| welded.orogeny[i] == Orogeny::Himalayan)
        .count();
    println!(
        "{collisions} collisions, {} samples raised by them, {} m, land {:.4} → {:.4} sr",
        raised,
        highest(&welded, seam, 15.0),
        continents(&before),
        continents(&welded),
    );
    assert!((1..=6).contains(&collisions), "{collisions} collisions");
    assert!(highest(&welded, seam, 15.0) > 2_500.0, "mountains along the seam");
    assert!(raised > 20, "which are those of a collision");
    let kept = continents(&welded) / continents(&before);
    assert!(
        (0.8..1.15).contains(&kept),
        "crust is pushed together, not lost: {kept}"
    );
    assert_eq!(play.sim.counts().torn, 0);

    let end = play.until_ms(15_200);
    let young = around(&end, seam, 20.0)
        .filter(|&i| !end.continental[i] && end.age_my[i] < 30.0)
        .count();
    println!(
        "{:?}, {} samples of young sea, land {:.4} sr",
        play.sim.counts(),
        young,
        continents(&end)
    );
    assert_eq!(play.sim.counts().torn, 1, "torn by two hands");
    assert!(young > 60, "a new sea between the parts");
    let kept = continents(&end) / continents(&welded);
    assert!((0.85..1.15).contains(&kept), "{kept}");
}

#[test]
fn an_arc_of_islands_joins_a_continent() {
    let file = file("planet_island_arc");
    let mut play = Play::new(&file);
    let before = play.until_ms(160);
    let coast = direction(-1.0, 35.0);
    let after = play.until_ms(8_600);
    let collisions = play.sim.planet().totals().collisions;
    println!(
        "{collisions} collisions, coast {} → {} m, land {:.4} → {:.4} sr",
        highest(&before, coast, 6.0),
        highest(&after, coast, 6.0),
        continents(&before),
        continents(&after),
    );
    assert!((1..=8).contains(&collisions), "{collisions} collisions");
    assert!(highest(&before, coast, 6.0) < 1_500.0, "a low coast at first");
    assert!(
        highest(&after, coast, 6.0) > 2_500.0,
        "mountains where the islands joined"
    );
    let kept = continents(&after) / continents(&before);
    assert!((0.8..1.2).contains(&kept), "{kept}");
}
