//! Networks that lose, double, delay and make up packets: whatever comes, the events are well formed, and when the
//! sender has spoken its last, nothing is down that should not be.

use std::collections::{BTreeMap, BTreeSet};

use crate::tuio_common::*;
use orogen::gesture::contact::{ContactEvent, ContactKey, MAX_CONTACTS, Phase};
use orogen::input::tuio::MAX_SOURCES;
use proptest::prelude::*;

const FRAME_US: u64 = 16_000;
const SECOND_US: u64 = 1_000_000;

/// Each contact lands, moves and ends, once. Returns what is down after all.
fn well_formed(events: &[ContactEvent]) -> BTreeSet<ContactKey> {
    let mut seen: BTreeMap<ContactKey, bool> = BTreeMap::new();
    for event in events {
        let key = event.contact.key;
        match event.phase {
            Phase::Down => assert_eq!(seen.insert(key, true), None, "a key names one contact"),
            Phase::Move => assert_eq!(seen.get(&key), Some(&true)),
            Phase::Up | Phase::Cancel => assert_eq!(seen.insert(key, false), Some(true)),
        }
        assert!(seen.values().filter(|down| **down).count() <= MAX_SOURCES * MAX_CONTACTS);
    }
    let down = seen.into_iter().filter(|(_, down)| *down);
    down.map(|(key, _)| key).collect()
}

/// How a sender speaks.
#[derive(Clone, Copy, Debug)]
enum Speech {
    Numbered,
    Unnumbered,
    Split,
    Second,
    SecondSplit,
}

/// What happens in a frame: fingers that land, lift or move, by choice of a number; or the sender starts anew.
#[derive(Clone, Debug)]
struct Step {
    choice: u8,
    restarts: bool,
    /// Lost, doubled, or delayed by so many frames; for each of the packets of the frame.
    fates: [(bool, bool, u8); 2],
}

fn step() -> impl Strategy<Value = Step> {
    let fate = || {
        (
            prop::bool::weighted(0.3),
            prop::bool::weighted(0.1),
            prop_oneof![4 => Just(0), 1 => 0..6_u8],
        )
    };
    (any::<u8>(), prop::bool::weighted(0.02), [fate(), fate()]).prop_map(|(choice, restarts, fates)| Step {
        choice,
        restarts,
        fates,
    })
}

fn speech() -> impl Strategy<Value = Speech> {
    prop_oneof![
        Just(Speech::Numbered),
        Just(Speech::Unnumbered),
        Just(Speech::Split),
        Just(Speech::Second),
        Just(Speech::SecondSplit),
    ]
}

/// The packets of a frame.
fn packets(speech: Speech, number: i32, fingers: &[(i32, f32, f32)]) -> Vec<Vec<u8>> {
    let ids: Vec<i32> = fingers.iter().map(|finger| finger.0).collect();
    let (first, rest) = fingers.split_at(fingers.len() / 2);
    let sets = |of: &[(i32, f32, f32)]| of.iter().map(|&(id, x, y)| cursor(id, x, y)).collect::<Vec<_>>();
    let ptrs = |of: &[(i32, f32, f32)]| {
        of.iter()
            .map(|&(id, x, y)| ptr(id, x, y, 0.01, 0.5))
            .collect::<Vec<_>>()
    };
    match speech {
        Speech::Numbered => vec![cursors("a@b", number, fingers)],
        Speech::Unnumbered => vec![cursors("", -1, fingers)],
        Speech::Split => [first, rest]
            .map(|part| bundle([vec![alive(CURSOR, &ids)], sets(part), vec![fseq(CURSOR, number)]].concat()))
            .to_vec(),
        Speech::Second => vec![pointers("a:0@b", number, fingers)],
        Speech::SecondSplit => vec![
            bundle([vec![frm(number, "a:0@b")], ptrs(first)].concat()),
            bundle([vec![frm(number, "a:0@b")], ptrs(rest), vec![alv(&ids)]].concat()),
        ],
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_finger_is_forgotten(speech in speech(), steps in prop::collection::vec(step(), 1..250)) {
        let mut table = Table::default();
        let mut fingers: Vec<(i32, f32, f32)> = Vec::new();
        let (mut number, mut next_id) = (0, 0);
        // By time and order of sending.
        let mut on_the_way: BTreeMap<(u64, usize), Vec<u8>> = BTreeMap::new();
        let mut sent = 0;
        for (i, step) in steps.iter().enumerate() {
            let t_us = i as u64 * FRAME_US;
            if step.restarts {
                (number, next_id) = (0, 0);
                fingers.clear();
            }
            match step.choice % 8 {
                0 if fingers.len() < 12 => {
                    fingers.push((next_id, 0.5, f32::from(step.choice) / 255.0));
                    next_id += 1;
                }
                1 if !fingers.is_empty() => {
                    fingers.remove(usize::from(step.choice) % fingers.len());
                }
                _ => fingers.iter_mut().for_each(|finger| finger.1 = (finger.1 + 0.01) % 1.0),
            }
            number += 1;
            for (packet, (lost, doubled, delay)) in packets(speech, number, &fingers).into_iter().zip(step.fates) {
                let mut send = |delay: u8, packet| {
                    on_the_way.insert((t_us + u64::from(delay) * FRAME_US, sent), packet);
                    sent += 1;
                };
                if doubled {
                    send(delay + 1, packet.clone());
                }
                if !lost {
                    send(delay, packet);
                }
            }
        }
        for ((t_us, _), packet) in &on_the_way {
            table.hear(*t_us, packet);
        }
        well_formed(&table.events);
        // When the network recovers, what is down is what the sender says, after a second at most.
        let end_us = (steps.len() as u64 + 10) * FRAME_US;
        for i in 0..80 {
            number += 1;
            for packet in packets(speech, number, &fingers) {
                table.hear(end_us + i * FRAME_US, &packet);
            }
        }
        let wanted: BTreeSet<u64> = fingers.iter().map(|finger| finger.0 as u64).collect();
        prop_assert_eq!(table.down().into_iter().collect::<BTreeSet<_>>(), wanted);
        // When it dies instead, nothing stays.
        table.tick(end_us + 80 * FRAME_US + 61 * SECOND_US);
        prop_assert_eq!(well_formed(&table.events), BTreeSet::new());
    }

    #[test]
    fn any_bytes_from_anybody_are_heard_in_peace(
        packets in prop::collection::vec((0_u16..40, prop::collection::vec(any::<u8>(), 0..120), 0..60_usize, any::<u8>()), 1..80),
    ) {
        let mut table = Table::default();
        let whole = [cursors("a@b", 5, &[(1, 0.1, 0.1), (2, 0.2, 0.2)]), pointers("a:0@b", 5, &[(1, 0.1, 0.1)])];
        for (i, (port, noise, at, value)) in packets.iter().enumerate() {
            let t_us = i as u64 * 100_000;
            table.hear_from(t_us, *port, noise);
            let mut packet = whole[i % 2].clone();
            let at = at * 4 % packet.len();
            packet[at] = *value;
            table.hear_from(t_us, *port, &packet);
            packet.truncate(at);
            table.hear_from(t_us, *port, &packet);
            prop_assert!(table.decoder.sources().count() <= MAX_SOURCES);
        }
        well_formed(&table.events);
        table.tick(100 * SECOND_US);
        prop_assert_eq!(table.down(), Vec::<u64>::new());
    }
}

/// Ten thousand packets a second of noise, from ports that change, beside a table of 60 Hz.
#[test]
fn noise_takes_nothing_from_a_table() {
    let mut table = Table::default();
    let seconds = 10;
    let mut noise = 12_345_u64;
    for i in 0..seconds * 10_000_u64 {
        let t_us = i * 100;
        noise = noise
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let bytes: Vec<u8> = noise.to_le_bytes().repeat(1 + (noise >> 60) as usize * 8);
        let bytes = if i % 3 == 0 {
            [b"#bundle\0", &bytes[..]].concat()
        } else {
            bytes
        };
        table.hear_from(t_us, 10_000 + (noise >> 32) as u16 % 1000, &bytes);
        if i % 167 == 0 {
            let frame = (i / 167) as i32;
            let x = (frame % 100) as f32 / 100.0;
            table.hear_from(
                t_us,
                3000,
                &cursors("table@host", frame + 1, &[(frame / 60, x, 0.5)]),
            );
        }
    }
    let counts = table.decoder.counts();
    let frames = seconds * 10_000 / 167 + 1;
    assert!(
        counts.frames >= frames - 20,
        "{counts:?}: strangers have to be met first"
    );
    let read = counts.packets - counts.over_rate - frames;
    assert!(read <= 500 * (seconds + 1), "{read} packets of noise were read");
    assert_eq!(table.decoder.sources().count(), 1);
    assert_eq!(table.down().len(), 1);
    well_formed(&table.events);
}

/// Ten thousand packets a second that are good TUIO, from one port: the rest of the senders are heard.
#[test]
fn a_sender_that_floods_is_read_at_its_rate() {
    let mut table = Table::default();
    for i in 0..50_000_u64 {
        let number = 1 + i as i32;
        table.hear_from(
            i * 100,
            1,
            &cursors("flood@host", number, &[(number % 7, 0.5, 0.5)]),
        );
        if i % 167 == 0 {
            table.hear_from(i * 100, 2, &cursors("table@host", number, &[(1000, 0.1, 0.5)]));
        }
    }
    let sources: Vec<_> = table
        .decoder
        .sources()
        .map(|source| (source.name, source.frames))
        .collect();
    assert_eq!(sources[1], ("table@host".to_owned(), 50_000 / 167 + 1));
    assert!((20_000..=24_000).contains(&sources[0].1), "{sources:?}");
    well_formed(&table.events);
}

/// A count that jumps to and fro is a restart with each packet; those who listen must not be buried under them.
#[test]
fn restarts_are_rare() {
    let mut table = Table::default();
    for i in 0..50_000_u64 {
        let number = if i % 2 == 0 { 1 } else { 1000 };
        table.hear(i * 1000, &cursors("a@b", number, &[(number, 0.5, 0.5)]));
    }
    assert!(table.lost <= 4 * 51, "{}", table.lost);
    well_formed(&table.events);
}
