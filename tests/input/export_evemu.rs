//! What is exported to evemu comes back as it was.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use glam::DVec2;
use orogen::export::evemu::write_evemu;
use orogen::gesture::command::{Action, Command};
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, Phase, Source};
use orogen::gesture::file::{GestureFile, Header, read_gesture};
use orogen::input::import::{ImportOptions, Imported, import_evemu};
use proptest::prelude::*;

const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);

fn export(frames: &[InputFrame]) -> (String, Vec<String>) {
    let mut bytes = Vec::new();
    let left_out = write_evemu(&mut bytes, "Table", SIZE_MM, frames).expect("memory takes all");
    (String::from_utf8(bytes).expect("text"), left_out)
}

fn import(text: &str) -> Imported {
    import_evemu(text.as_bytes(), "rec", &ImportOptions::default()).expect("a recording")
}

fn contact(id: u64, generation: u32, x: f64, y: f64) -> Contact {
    Contact {
        key: ContactKey {
            source: Source::File,
            device: 0,
            id,
            generation,
        },
        position: DVec2::new(x, y),
        size_mm: None,
        confidence: None,
    }
}

fn frame(ms: u64, events: &[(Phase, Contact)]) -> InputFrame {
    InputFrame {
        t_us: ms * 1000,
        events: events
            .iter()
            .map(|&(phase, contact)| ContactEvent { phase, contact })
            .collect(),
        commands: Vec::new(),
    }
}

#[test]
fn a_recording_as_the_kernel_would_write_it() {
    let (one, two) = (contact(0, 0, 100.0, 50.0), contact(1, 0, 1200.01, -0.5));
    let two = Contact {
        size_mm: Some(DVec2::new(12.5, 9.0)),
        ..two
    };
    let moved = Contact {
        position: DVec2::new(100.01, 50.0),
        ..one
    };
    let (text, left_out) = export(&[
        frame(0, &[(Phase::Down, one), (Phase::Down, two)]),
        frame(8, &[(Phase::Move, moved)]),
        frame(16, &[(Phase::Up, moved), (Phase::Up, two)]),
    ]);
    assert_eq!(left_out, Vec::<String>::new());
    let expected = "\
# EVEMU 1.3
# 1209.6 × 680.4 mm, 100 units per mm
N: Table
I: 0000 0000 0000 0000
P: 02 00 00 00 00 00 00 00
B: 00 0b 00 00 00 00 00 00 00
B: 01 00 00 00 00 00 00 00 00
B: 01 00 00 00 00 00 00 00 00
B: 01 00 00 00 00 00 00 00 00
B: 01 00 00 00 00 00 00 00 00
B: 01 00 00 00 00 00 00 00 00
B: 01 00 04 00 00 00 00 00 00
B: 03 03 00 00 00 00 80 f3 02
A: 00 0 120960 0 0 100
A: 01 0 68040 0 0 100
A: 2f 0 1 0 0 0
A: 30 0 2000000 0 0 100
A: 31 0 2000000 0 0 100
A: 34 0 1 0 0 0
A: 35 0 120960 0 0 100
A: 36 0 68040 0 0 100
A: 37 0 2 0 0 0
A: 39 0 65535 0 0 0
E: 0.000000 0003 002f 0000
E: 0.000000 0003 0039 0001
E: 0.000000 0003 0035 10000
E: 0.000000 0003 0036 5000
E: 0.000000 0003 002f 0001
E: 0.000000 0003 0039 0002
E: 0.000000 0003 0035 120001
E: 0.000000 0003 0036 -050
E: 0.000000 0003 0030 1250
E: 0.000000 0003 0031 0900
E: 0.000000 0003 0034 0001
E: 0.000000 0001 014a 0001
E: 0.000000 0000 0000 0000
E: 0.008000 0003 002f 0000
E: 0.008000 0003 0035 10001
E: 0.008000 0000 0000 0000
E: 0.016000 0003 0039 -001
E: 0.016000 0003 002f 0001
E: 0.016000 0003 0039 -001
E: 0.016000 0001 014a 0000
E: 0.016000 0000 0000 0000
";
    assert_eq!(text, expected);
}

#[test]
fn what_evemu_has_no_words_for_is_named() {
    let sized = Contact {
        size_mm: Some(DVec2::new(9.0, 9.0)),
        confidence: Some(0.5),
        ..contact(5, 0, 100.0, 50.0)
    };
    let bare = contact(5, 0, 101.0, 50.0);
    let mut frames = vec![
        frame(0, &[(Phase::Down, sized)]),
        frame(8, &[(Phase::Move, bare)]),
        frame(16, &[(Phase::Up, bare)]),
    ];
    frames[1].commands.push(Command::new(Action::Undo));
    let many: Vec<_> = (0..=256)
        .map(|id| (Phase::Down, contact(id, 1, 1.0, 1.0)))
        .collect();
    frames.push(frame(24, &many));
    let (text, left_out) = export(&frames);
    assert_eq!(
        left_out,
        [
            // (The slot that has told a size is for nobody who tells none.)
            "2 contact(s) left out: more than can be down at once",
            "1 confidence(s) left out: evemu knows fingers and palms, nothing between",
            "1 contact(s) whose size was no longer told keep their last one",
            "1 command(s) left out: evemu knows contacts alone",
        ]
    );
    assert_eq!(import(&text).frames.len(), 5);
}

/// Place, size and palm of a contact; what happens to it.
type Wish = (u8, (i32, i32), (u16, u16), bool);

fn wishes(ids: u64) -> impl Strategy<Value = Vec<(u64, BTreeMap<u64, Wish>)>> {
    let wish = (
        0..8_u8,
        (-100..121_000_i32, -100..69_000_i32),
        (0..6000_u16, 0..6000_u16),
        prop::bool::weighted(0.1),
    );
    prop::collection::vec(
        (1..40_000_u64, prop::collection::btree_map(0..ids, wish, 0..6)),
        1..50,
    )
}

/// A session in which ids with even numbers tell sizes.
fn session(wishes: &[(u64, BTreeMap<u64, Wish>)]) -> Vec<InputFrame> {
    let mut live: BTreeMap<u64, Contact> = BTreeMap::new();
    let mut downs: BTreeMap<u64, u32> = BTreeMap::new();
    let (mut frames, mut t_us): (Vec<InputFrame>, u64) = (Vec::new(), 0);
    let mut push = |t_us, mut events: Vec<ContactEvent>| {
        events.sort_by_key(|event| (event.phase.order(), event.contact.key));
        if !events.is_empty() {
            frames.push(InputFrame {
                t_us,
                events,
                commands: Vec::new(),
            });
        }
    };
    for (gap_us, ids) in wishes {
        t_us += gap_us;
        let mut events = Vec::new();
        for (&id, &(kind, (x, y), (w, h), palm)) in ids {
            let mm = |units: i32| f64::from(units) / 100.0;
            let reading = |generation| Contact {
                size_mm: (id % 2 == 0).then(|| DVec2::new(mm(w.into()), mm(h.into()))),
                confidence: palm.then_some(0.0),
                ..contact(id, generation, mm(x), mm(y))
            };
            if let Some(before) = live.remove(&id) {
                let phase = match kind {
                    0 | 1 => Phase::Up,
                    2 if before.confidence.is_none() => Phase::Cancel,
                    _ => Phase::Move,
                };
                if phase == Phase::Move {
                    let now = reading(downs[&id] - 1);
                    live.insert(id, now);
                    if now != before {
                        events.push(ContactEvent { phase, contact: now });
                    }
                    continue;
                }
                events.push(ContactEvent {
                    phase,
                    contact: before,
                });
                if kind != 1 {
                    continue;
                }
            }
            *downs.entry(id).or_default() += 1;
            let now = reading(downs[&id] - 1);
            live.insert(id, now);
            let phase = Phase::Down;
            events.push(ContactEvent { phase, contact: now });
        }
        push(t_us, events);
    }
    let cancel = |contact: &Contact| ContactEvent {
        phase: Phase::Cancel,
        contact: *contact,
    };
    push(t_us + 5_000, live.values().map(cancel).collect());
    let start_us = frames.first().map_or(0, |frame| frame.t_us);
    for frame in &mut frames {
        frame.t_us -= start_us;
    }
    frames
}

/// The way of each contact, without its name.
fn ways(frames: &[InputFrame]) -> Vec<String> {
    let mut open: BTreeMap<ContactKey, String> = BTreeMap::new();
    for frame in frames {
        for ContactEvent { phase, contact } in &frame.events {
            let way = open.entry(contact.key).or_default();
            let told = (
                frame.t_us,
                phase,
                contact.position,
                contact.size_mm,
                contact.confidence,
            );
            write!(way, "{told:?} ").expect("memory takes all");
        }
    }
    let mut ways: Vec<String> = open.into_values().collect();
    ways.sort();
    ways
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn contacts_come_back_to_the_bit(wishes in wishes(12)) {
        let frames = session(&wishes);
        prop_assume!(!frames.is_empty());
        let (text, left_out) = export(&frames);
        prop_assert_eq!(left_out, Vec::<String>::new());
        let imported = import(&text);
        prop_assert_eq!(&imported.frames, &frames);
        prop_assert_eq!((&imported.title[..], imported.size_mm), ("Table", SIZE_MM));
        // And what was imported is the same file when it was written, and the same recording when it is exported.
        let file = GestureFile {
            header: Header::new(imported.size_mm),
            frames: imported.frames,
            warnings: Vec::new(),
        };
        let bytes = file.write(Vec::new()).expect("memory takes all");
        let again = read_gesture(&bytes[..], "again").expect("what was written");
        prop_assert_eq!(&again.frames, &file.frames);
        prop_assert_eq!(export(&again.frames).0, text);
    }

    #[test]
    fn whatever_they_are_called(wishes in wishes(2000)) {
        let frames = session(&wishes);
        prop_assume!(!frames.is_empty());
        let (text, left_out) = export(&frames);
        prop_assert_eq!(left_out, Vec::<String>::new());
        prop_assert_eq!(ways(&import(&text).frames), ways(&frames));
    }
}
