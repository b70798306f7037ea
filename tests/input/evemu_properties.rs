//! Any bytes are refused or imported; contacts written as protocol B come back as they were.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use glam::DVec2;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, Phase, Source};
use orogen::input::import::{ImportOptions, import_evemu};
use proptest::prelude::*;

/// Units per mm: as fine as gesture files are, so that nothing is rounded.
const UNITS_PER_MM: f64 = 100.0;
const SIZE: [i32; 2] = [46_480, 25_560];
const SLOTS: u16 = 12;

/// A contact in device units: position, area (minor, major; upright) and palm.
type Reading = (i32, i32, (i32, i32), bool);

/// What happens to one slot in one frame.
#[derive(Clone, Debug)]
enum Act {
    Land(Reading),
    Move(Reading),
    Lift,
}

/// A writer of protocol B that, like the kernel, tells only what changes and selects slots only when it has to.
#[derive(Default)]
struct Encoder {
    text: String,
    t_us: u64,
    selected: u16,
    tracking: i32,
    told: BTreeMap<(u16, u16), i32>,
}

impl Encoder {
    fn event(&mut self, kind: u16, code: u16, value: i32) {
        let (s, us) = (self.t_us / 1_000_000, self.t_us % 1_000_000);
        writeln!(self.text, "E: {s}.{us:06} {kind:04x} {code:04x} {value:04}").expect("memory takes all");
    }

    fn tell(&mut self, slot: u16, code: u16, value: i32) {
        if self.told.insert((slot, code), value) != Some(value) {
            if self.selected != slot {
                self.selected = slot;
                self.event(3, 0x2f, slot.into());
            }
            self.event(3, code, value);
        }
    }

    fn act(&mut self, slot: u16, act: &Act) {
        match act {
            Act::Lift => self.tell(slot, 0x39, -1),
            Act::Land((x, y, (minor, major), palm)) | Act::Move((x, y, (minor, major), palm)) => {
                if matches!(act, Act::Land(_)) {
                    // An id that differs from that of the contact which may still be there.
                    self.tracking = (self.tracking + 1) % 0x1_0000;
                    self.tell(slot, 0x39, self.tracking);
                }
                self.tell(slot, 0x35, *x);
                self.tell(slot, 0x36, *y);
                self.tell(slot, 0x30, *major);
                self.tell(slot, 0x31, *minor);
                if *palm || self.told.contains_key(&(slot, 0x37)) {
                    self.tell(slot, 0x37, if *palm { 2 } else { 0 });
                }
            }
        }
    }
}

fn reading() -> impl Strategy<Value = Reading> {
    (
        0..=SIZE[0],
        0..=SIZE[1],
        (0..3000, 0..3000),
        prop::bool::weighted(0.1),
    )
}

/// Time since the frame before, µs, and what is wanted of some slots; [`session`] makes sense of it.
type Wish = (u64, BTreeMap<u16, (u8, Reading)>);

fn wishes() -> impl Strategy<Value = Vec<Wish>> {
    let wish = (0..6_u8, reading());
    prop::collection::vec(
        (1..40_000_u64, prop::collection::btree_map(0..SLOTS, wish, 0..6)),
        1..60,
    )
}

fn contact(slot: u16, downs: &BTreeMap<u16, u32>, (x, y, (minor, major), palm): Reading) -> Contact {
    let mm = |units: i32| f64::from(units) / UNITS_PER_MM;
    Contact {
        key: ContactKey {
            source: Source::File,
            device: 0,
            id: slot.into(),
            generation: downs[&slot] - 1,
        },
        position: DVec2::new(mm(x), mm(y)),
        size_mm: Some(DVec2::new(mm(minor), mm(major))),
        confidence: palm.then_some(0.0),
    }
}

/// The recording, and the frames that it should become.
fn session(wishes: &[Wish]) -> (String, Vec<InputFrame>) {
    let mut encoder = Encoder::default();
    let mut live: BTreeMap<u16, Contact> = BTreeMap::new();
    let mut downs: BTreeMap<u16, u32> = BTreeMap::new();
    let mut frames: Vec<InputFrame> = Vec::new();
    let mut push = |t_us, mut events: Vec<ContactEvent>| {
        events.sort_by_key(|event| (event.phase.order(), event.contact.key.id));
        if !events.is_empty() {
            frames.push(InputFrame {
                t_us,
                events,
                commands: Vec::new(),
            });
        }
    };
    encoder.t_us = 1_369_413_358_000_000;
    for (gap_us, slots) in wishes {
        encoder.t_us += gap_us;
        let mut events = Vec::new();
        let mut say = |phase, contact| events.push(ContactEvent { phase, contact });
        for (&slot, &(kind, reading)) in slots {
            let before = live.get(&slot).copied();
            // Without a contact each wish is a landing; 0 lifts, 1 lifts and lands at once, the rest moves.
            if let Some(before) = before.filter(|_| kind < 2) {
                say(Phase::Up, before);
                live.remove(&slot);
                if kind == 0 {
                    encoder.act(slot, &Act::Lift);
                    continue;
                }
            }
            if before.is_some() && kind >= 2 {
                encoder.act(slot, &Act::Move(reading));
                let now = contact(slot, &downs, reading);
                if before != Some(now) {
                    say(Phase::Move, now);
                }
                live.insert(slot, now);
            } else {
                encoder.act(slot, &Act::Land(reading));
                *downs.entry(slot).or_default() += 1;
                let now = contact(slot, &downs, reading);
                say(Phase::Down, now);
                live.insert(slot, now);
            }
        }
        encoder.event(0, 0, 0);
        push(encoder.t_us, events);
    }
    let cancel = |contact: &Contact| ContactEvent {
        phase: Phase::Cancel,
        contact: *contact,
    };
    push(encoder.t_us, live.values().map(cancel).collect());
    let start_us = frames.first().map_or(0, |frame| frame.t_us);
    for frame in &mut frames {
        frame.t_us -= start_us;
    }
    let head = format!("A: 35 0 {} 0 0 100\nA: 36 0 {} 0 0 100\n", SIZE[0], SIZE[1]);
    (head + &encoder.text, frames)
}

/// Lines that are nearly right, so that random bytes come farther than the first.
fn nearly() -> impl Strategy<Value = Vec<u8>> {
    let number = prop_oneof![
        Just("-1".to_owned()),
        (0..12_i32).prop_map(|v| v.to_string()),
        any::<i32>().prop_map(|v| v.to_string()),
    ];
    let code = prop::sample::select(vec![
        "2f", "30", "31", "32", "34", "35", "36", "37", "39", "00", "03",
    ]);
    let line = prop_oneof![
        8 => (0..3_u8, code, number.clone()).prop_map(|(t, code, v)| format!("E: {t}.000000 0003 {code} {v}\n")),
        3 => Just("E: 2.000000 0000 0000 0\n".to_owned()),
        1 => Just("E: 2.000000 0000 0003 0\n".to_owned()),
        1 => (35..37_u8, number.clone(), number).prop_map(|(c, a, b)| format!("A: {c} {a} {b} 0 0 10\n")),
        1 => any::<String>().prop_map(|text| format!("#{text}\n")),
        1 => any::<String>(),
    ];
    prop::collection::vec(line, 0..80).prop_map(|lines| lines.concat().into_bytes())
}

/// Refused in one line that says what was expected, or imported within the table's reach.
fn holds(bytes: &[u8]) -> Result<(), TestCaseError> {
    let options = ImportOptions {
        range: Some([0.0, 4095.0, 0.0, 4095.0]),
        size_mm: Some(DVec2::new(600.0, 340.0)),
    };
    match import_evemu(bytes, "any", &options) {
        Ok(imported) => {
            let mut live = BTreeMap::new();
            let mut t_us = 0;
            for frame in &imported.frames {
                prop_assert!(frame.t_us >= t_us && !frame.events.is_empty());
                t_us = frame.t_us;
                for event in &frame.events {
                    let key = event.contact.key;
                    let before = match event.phase {
                        Phase::Up | Phase::Cancel => live.remove(&key.id),
                        Phase::Move | Phase::Down => live.insert(key.id, key),
                    };
                    let wanted = (event.phase != Phase::Down).then_some(key);
                    prop_assert_eq!(before, wanted);
                }
            }
            prop_assert!(live.is_empty());
        }
        Err(error) => {
            let error = error.to_string();
            prop_assert!(error.starts_with("any:") && error.contains("expected"), "{error}");
            prop_assert!(!error.contains('\n'), "{error}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn contacts_come_back_exactly(wishes in wishes()) {
        let (text, frames) = session(&wishes);
        if frames.is_empty() {
            return Ok(());
        }
        let imported = import_evemu(text.as_bytes(), "any", &ImportOptions::default())
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        prop_assert_eq!(imported.frames, frames);
        prop_assert_eq!(imported.size_mm, DVec2::new(464.8, 255.6));
        let left_down = imported.warnings.iter().all(|w| w.contains("still down at the end"));
        prop_assert!(left_down, "{:?}", imported.warnings);
    }

    #[test]
    fn any_bytes_are_refused_or_imported(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        holds(&bytes)?;
    }

    #[test]
    fn nearly_right_lines_are_refused_or_imported(bytes in nearly()) {
        holds(&bytes)?;
    }
}
