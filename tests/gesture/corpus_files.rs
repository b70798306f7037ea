//! The gesture files: written as the tool writes them, readable, and understood as hands.

#[path = "../../examples/make_gestures/corpus/mod.rs"]
mod corpus;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

use glam::DVec2;
use orogen::gesture::contact::ContactKey;
use orogen::gesture::event::{HandEvent, HandId, Leg};
use orogen::gesture::file::{GestureFile, read_gesture};
use orogen::gesture::hand::{ContactStats, HandTracker};
use orogen::gesture::params::GestureParams;
use orogen::gesture::stroke::Role;

/// The simulation's tick, µs.
const TICK_US: u64 = 16_000;

/// Most bytes of a file.
const MAX_FILE_BYTES: usize = 300_000;

/// Changes that are to be seen keep this far from the border, where the land is held down; mm (12 km).
const BORDER_MM: f64 = 82.0;

/// What each file comes to: hands, pushes, rests, taps, ghosts.
///
/// When a rule of the gesture grammar or a scene changes, `every_file_comes_to_its_hands` prints the line that it
/// found. Take it over only after having read, line by line, why it is what the grammar says; a line that cannot be
/// explained is a fault of the grammar's code.
const GOLDEN: [(&str, [u64; 5]); 39] = [
    ("builtin_session", [5, 4, 1, 0, 0]),
    ("cancel", [1, 1, 0, 0, 1]),
    ("confidence_lost", [0, 0, 0, 0, 1]),
    ("drumming", [16, 0, 0, 16, 0]),
    ("finished_range_eroding", [2, 1, 1, 0, 0]),
    ("flicker", [1, 1, 0, 0, 0]),
    ("folds_edited", [2, 1, 1, 0, 0]),
    ("four_visitors", [4, 4, 0, 0, 0]),
    ("hand_rests_other_pushes", [2, 1, 1, 0, 0]),
    ("id_reuse", [3, 3, 0, 0, 0]),
    ("late_finger", [1, 1, 0, 0, 0]),
    ("neighbour_leaning_in", [1, 1, 0, 0, 2]),
    ("oblique_push", [2, 1, 1, 0, 0]),
    ("one_finger_push", [1, 1, 0, 0, 0]),
    ("palm_and_sleeve", [2, 1, 0, 0, 2]),
    ("palm_flickers", [4, 1, 0, 3, 33]),
    ("palm_only", [2, 0, 0, 0, 3]),
    ("pinch_and_spread", [4, 4, 0, 0, 0]),
    ("planet_collide_and_tear", [6, 5, 3, 0, 0]),
    ("planet_island_arc", [2, 1, 2, 0, 0]),
    ("pull_apart", [2, 2, 0, 0, 0]),
    ("pulling_towards_oneself", [1, 1, 0, 0, 0]),
    ("range_andes", [6, 3, 3, 0, 0]),
    ("range_digne", [2, 1, 1, 0, 0]),
    ("range_jura", [4, 2, 2, 0, 0]),
    ("range_southern_alps", [2, 1, 1, 0, 0]),
    ("range_zagros", [6, 3, 3, 0, 0]),
    ("rubbing", [1, 7, 0, 0, 0]),
    ("same_push_again", [2, 2, 0, 0, 0]),
    ("sleeve_sweeps", [0, 0, 0, 0, 1]),
    ("slapping", [2, 0, 0, 2, 2]),
    ("slow_and_fast", [2, 2, 1, 0, 0]),
    ("stuck_contact", [3, 2, 1, 0, 0]),
    ("ten_fingers", [2, 2, 0, 0, 0]),
    ("three_plates", [3, 3, 0, 0, 0]),
    ("twisting_hand", [1, 1, 0, 0, 0]),
    ("two_equal_pushes", [2, 2, 0, 0, 0]),
    ("two_hands_push", [2, 1, 1, 0, 0]),
    ("writing_a_name", [4, 8, 0, 0, 0]),
];

fn dir() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("gestures")
}

/// All gesture files, by name.
fn committed() -> Vec<(String, Vec<u8>, GestureFile)> {
    let mut files: Vec<_> = fs::read_dir(dir())
        .expect("the folder of gesture files")
        .map(|entry| {
            entry
                .expect("a file")
                .file_name()
                .into_string()
                .expect("a name in UTF-8")
        })
        .filter(|name| name.contains(".gesture."))
        .collect();
    files.sort();
    let files = files.into_iter().map(|name| {
        let bytes = fs::read(dir().join(&name)).expect("a file that can be read");
        let file = read_gesture(bytes.as_slice(), &name).expect("a gesture file");
        (name.trim_end_matches(".gesture.jsonl").to_owned(), bytes, file)
    });
    files.collect()
}

#[test]
fn the_committed_files_are_what_the_tool_writes() {
    let written = corpus::files().unwrap();
    for (name, bytes) in &written {
        let path = dir().join(name);
        let found = fs::read(&path).unwrap_or_default();
        assert!(
            &found == bytes,
            "{name} differs: run `cargo run --example make_gestures`"
        );
    }
    let names: BTreeSet<&str> = written.iter().map(|(name, _)| name.as_str()).collect();
    for entry in fs::read_dir(dir()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(names.contains(name.as_str()), "{name} is not written by the tool");
    }
    assert_eq!(corpus::files().unwrap(), written, "the tool depends on something");
}

#[test]
fn every_matter_has_its_file() {
    let golden: BTreeSet<&str> = GOLDEN.iter().map(|(name, _)| *name).collect();
    let matters: BTreeSet<&str> = corpus::matters().iter().map(|matter| matter.name).collect();
    assert_eq!(matters, golden);
    assert_eq!(golden.len(), GOLDEN.len(), "a name stands twice");
}

#[test]
fn every_file_reads_without_warnings_and_is_canonical() {
    for (name, bytes, file) in committed() {
        assert!(file.warnings.is_empty(), "{name}: {:?}", file.warnings);
        assert!(
            file.write(Vec::new()).unwrap() == bytes,
            "{name} is not canonical"
        );
        assert!(bytes.len() < MAX_FILE_BYTES, "{name}: {} bytes", bytes.len());
    }
}

#[test]
fn a_composed_file_is_what_reading_it_gives() {
    for matter in corpus::matters() {
        let bytes = matter.file.write(Vec::new()).unwrap();
        let read = read_gesture(bytes.as_slice(), matter.name).unwrap();
        assert!(read == matter.file, "{}", matter.name);
    }
}

#[test]
fn every_file_says_what_it_is_about_and_what_must_be_seen() {
    for (name, _, file) in committed() {
        let header = &file.header;
        assert!(
            header.title.as_ref().is_some_and(|title| !title.is_empty()),
            "{name}"
        );
        let expect = header.expect.as_ref().unwrap();
        assert!(expect.see.as_ref().is_some_and(|see| !see.is_empty()), "{name}");
        assert!(
            expect.nothing || !expect.land_changes_at.is_empty(),
            "{name} expects no more than words"
        );
        let last_us = file.frames.last().unwrap().t_us;
        for change in &expect.land_changes_at {
            let inset = change.at.min(header.size_mm - change.at).min_element();
            assert!(inset >= BORDER_MM, "{name}: {:?} is near the border", change.at);
            assert!(
                change.t_us <= last_us,
                "{name}: {} µs is after the end",
                change.t_us
            );
        }
    }
}

#[test]
fn every_file_comes_to_its_hands() {
    let mut wrong = Vec::new();
    for (name, _, file) in committed() {
        let stats = Play::of(&file).stats;
        let found = [
            stats.hands,
            stats.pushes,
            stats.rests,
            stats.taps,
            stats.dropped_ghosts,
        ];
        let golden = GOLDEN.iter().find(|(golden, _)| *golden == name);
        if golden.is_none_or(|(_, numbers)| *numbers != found) {
            wrong.push(format!("    (\"{name}\", {found:?}),"));
        }
    }
    assert!(wrong.is_empty(), "found:\n{}", wrong.join("\n"));
}

#[test]
fn no_touch_is_a_dead_end() {
    for (name, _, file) in committed() {
        let play = Play::of(&file);
        assert_eq!(play.dead_ends(), 0, "{name}: hands nothing came of");
        assert_eq!(play.open_legs(), BTreeSet::new(), "{name}: legs without end");
        let nothing = file.header.expect.as_ref().unwrap().nothing;
        assert_eq!(play.told.is_empty(), nothing, "{name}: {:?}", play.told);
        assert_eq!((play.stats.ignored, play.stats.doubled), (0, 0), "{name}");
    }
}

#[test]
fn the_dead_end_search_finds_them() {
    let (_, _, file) = committed().into_iter().next().unwrap();
    let mut play = Play::of(&file);
    play.told
        .retain(|event| !matches!(event, HandEvent::PushEnd { .. }));
    assert!(!play.open_legs().is_empty());
    play.told.clear();
    assert_ne!(play.dead_ends(), 0);
}

/// A file, played through the hands alone.
struct Play {
    told: Vec<HandEvent>,
    /// The hands that were down at the end of some tick, with the contacts that were their fingers.
    seen: BTreeMap<HandId, BTreeSet<ContactKey>>,
    /// The contacts that were taken for palms, sleeves or ghosts in the end.
    ghosts: BTreeSet<ContactKey>,
    stats: ContactStats,
}

impl Play {
    /// Plays the file, and from the start again without the contacts that turned out to be none.
    fn of(file: &GestureFile) -> Self {
        let mut banned: Vec<ContactKey> = Vec::new();
        loop {
            let play = Self::without(file, &banned);
            let retracted = play.told.iter().find_map(|event| match event {
                HandEvent::Retract { contacts, .. } => Some(contacts.clone()),
                _ => None,
            });
            match retracted {
                Some(contacts) => banned.extend(contacts),
                None => return play,
            }
        }
    }

    fn without(file: &GestureFile, banned: &[ContactKey]) -> Self {
        let size_mm: DVec2 = file.header.size_mm;
        let mut tracker = HandTracker::new(GestureParams::default(), size_mm);
        for &key in banned {
            tracker.ban(key);
        }
        let mut told = Vec::new();
        let mut seen: BTreeMap<HandId, BTreeSet<ContactKey>> = BTreeMap::new();
        let mut ghosts: BTreeSet<ContactKey> = banned.iter().copied().collect();
        let end_us = file.frames.last().map_or(0, |frame| frame.t_us);
        let mut frames = file.frames.iter().peekable();
        for tick in 0..=end_us / TICK_US + 1 {
            let t_us = tick * TICK_US;
            while let Some(frame) = frames.next_if(|frame| frame.t_us <= t_us) {
                tracker.feed(frame);
            }
            told.extend(tracker.tick(t_us));
            assert_eq!(tracker.sanity_check(), Ok(()));
            for (contact, role, hand) in tracker.contacts() {
                if let Some(hand) = hand {
                    seen.entry(hand).or_default().insert(contact.key);
                }
                if role == Role::Ghost {
                    ghosts.insert(contact.key);
                }
            }
        }
        told.extend(tracker.finish(end_us));
        assert_eq!(tracker.hands().count(), 0);
        Self {
            told,
            seen,
            ghosts,
            stats: tracker.stats(),
        }
    }

    /// How many hands with a true finger there were of which nothing was told.
    fn dead_ends(&self) -> usize {
        let fingers = self
            .seen
            .iter()
            .filter(|(_, contacts)| !contacts.is_subset(&self.ghosts));
        let mut silent: BTreeSet<HandId> = fingers.map(|(&hand, _)| hand).collect();
        for event in &self.told {
            match event {
                HandEvent::Rest { hand, .. } | HandEvent::Tap { hand, .. } | HandEvent::Lift { hand } => {
                    silent.remove(hand);
                }
                HandEvent::Push { leg, .. } | HandEvent::PushEnd { leg } => {
                    silent.remove(&leg.hand);
                }
                HandEvent::Retract { .. } => {}
            }
        }
        // A ghost that is found out when it lifts is gone before it could be seen as one.
        silent
            .len()
            .saturating_sub(self.stats.dropped_ghosts as usize - self.ghosts.len())
    }

    /// Pushes that were never ended.
    fn open_legs(&self) -> BTreeSet<Leg> {
        let mut open = BTreeSet::new();
        for event in &self.told {
            match event {
                HandEvent::Push { leg, .. } => {
                    open.insert(*leg);
                }
                HandEvent::PushEnd { leg } => {
                    open.remove(leg);
                }
                _ => {}
            }
        }
        open
    }
}
