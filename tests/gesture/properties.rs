//! What holds for every sequence of contacts, sensible or not.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::gesture_support;
use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, Phase, Source, quantise_mm};
use orogen::gesture::event::{HandEvent, HandId, Leg};
use orogen::gesture::file::{GestureWriter, Header, read_gesture};
use orogen::gesture::hand::{ContactStats, HandTracker};
use orogen::gesture::params::{GestureParams, MAX_FINGERS};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use crate::gesture_support::{TABLE_MM, TICK_US};

/// Random sessions are over by then, µs.
const END_US: u64 = 5_000_000;

/// Ids that the random contacts share: few, so that they meet.
const IDS: u64 = 10;

fn phase() -> impl Strategy<Value = Phase> {
    prop_oneof![
        4 => Just(Phase::Down),
        8 => Just(Phase::Move),
        2 => Just(Phase::Up),
        1 => Just(Phase::Cancel),
    ]
}

/// Coordinates on a part of the table where fingers meet, now and then far off it or no number at all.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        40 => (200.0..500.0).prop_map(quantise_mm),
        2 => (-100.0..1300.0).prop_map(quantise_mm),
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-1e300), Just(1e5)],
    ]
}

fn touch() -> impl Strategy<Value = ContactEvent> {
    let size =
        prop_oneof![20 => Just(None), 2 => Just(Some(9.0)), 1 => Just(Some(12.0)), 1 => Just(Some(40.0))];
    let confidence = prop_oneof![20 => Just(None), 3 => Just(Some(1.0_f32)), 1 => Just(Some(0.0))];
    (phase(), 0..IDS, coordinate(), coordinate(), size, confidence).prop_map(
        |(phase, id, x, y, size, confidence)| ContactEvent {
            phase,
            contact: Contact {
                key: ContactKey {
                    source: Source::File,
                    device: 0,
                    id,
                    generation: 0,
                },
                position: DVec2::new(x, y),
                size_mm: size.map(DVec2::splat),
                confidence,
            },
        },
    )
}

/// Frames at most 80 ms apart, in the order of time.
fn session() -> impl Strategy<Value = Vec<InputFrame>> {
    prop::collection::vec((0..80_000_u64, prop::collection::vec(touch(), 0..7)), 1..60).prop_map(|frames| {
        let mut t_us = 0;
        let at = |(dt, events)| {
            t_us += dt / 3 * (dt % 3);
            InputFrame {
                t_us,
                events,
                commands: Vec::new(),
            }
        };
        frames.into_iter().map(at).collect()
    })
}

/// Fingers that land, wander and lift in good order, so that long strokes occur.
fn strokes() -> impl Strategy<Value = Vec<InputFrame>> {
    let finger = (
        0..2_000_u64,
        20..1_500_u64,
        (200.0..600.0, 150.0..500.0),
        prop::collection::vec((-60.0..60.0, -60.0..60.0), 0..30),
        // Flickers: comes back after some ms, a few mm away.
        prop::option::of((0..70_u64, -12.0..12.0)),
    );
    prop::collection::vec(finger, 1..12).prop_map(|fingers| {
        let mut moments: BTreeMap<u64, Vec<ContactEvent>> = BTreeMap::new();
        for (id, (from_ms, for_ms, start, steps, flicker)) in fingers.into_iter().enumerate() {
            let id = id as u64;
            let mut position = DVec2::from(start).map(quantise_mm);
            let mut at = |ms: u64, phase, id, position| {
                let event = event(phase, id, position);
                moments.entry(ms * 1000).or_default().push(event);
            };
            at(from_ms, Phase::Down, id, position);
            for (i, step) in steps.iter().enumerate() {
                position = (position + DVec2::from(*step)).map(quantise_mm);
                at(from_ms + for_ms * (i as u64 + 1) / 31, Phase::Move, id, position);
            }
            let up_ms = from_ms + for_ms;
            at(up_ms, Phase::Up, id, position);
            if let Some((gap_ms, off)) = flicker {
                let down_ms = up_ms + gap_ms;
                position.x = quantise_mm(position.x + off);
                at(down_ms, Phase::Down, id + 100, position);
                position.y = quantise_mm(position.y + 20.0);
                at(down_ms + 50, Phase::Move, id + 100, position);
                at(down_ms + 100, Phase::Up, id + 100, position);
            }
        }
        let frame = |(t_us, events)| InputFrame {
            t_us,
            events,
            commands: Vec::new(),
        };
        moments.into_iter().map(frame).collect()
    })
}

fn event(phase: Phase, id: u64, position: DVec2) -> ContactEvent {
    gesture_support::event(phase, id, position.x, position.y)
}

fn any_session() -> impl Strategy<Value = Vec<InputFrame>> {
    prop_oneof![session(), strokes()]
}

/// Plays frames in ticks of 16 ms; every tick is checked. The result has the tick's time with each event.
fn play(frames: &[InputFrame]) -> Vec<(u64, HandEvent)> {
    play_and_count(frames).0
}

fn play_and_count(frames: &[InputFrame]) -> (Vec<(u64, HandEvent)>, ContactStats) {
    let mut tracker = HandTracker::new(GestureParams::default(), TABLE_MM);
    let mut told = Vec::new();
    let mut next = 0;
    let mut t_us = 0;
    while t_us < END_US {
        t_us += TICK_US;
        while next < frames.len() && frames[next].t_us <= t_us {
            tracker.feed(&frames[next]);
            next += 1;
        }
        told.extend(tracker.tick(t_us).into_iter().map(|e| (t_us, e)));
        check(&tracker);
    }
    told.extend(tracker.finish(t_us).into_iter().map(|e| (t_us, e)));
    assert_eq!(tracker.hands().count(), 0);
    assert!(tracker.tick(t_us + TICK_US).is_empty());
    (told, tracker.stats())
}

fn check(tracker: &HandTracker) {
    tracker.sanity_check().unwrap();
    for hand in tracker.hands() {
        assert!((1..=MAX_FINGERS).contains(&hand.fingers.len()));
    }
}

/// Events without the names of contacts.
fn nameless(told: &[(u64, HandEvent)]) -> Vec<(u64, HandEvent)> {
    let strip = |event: &HandEvent| match event {
        HandEvent::Retract { contacts, since_us } => HandEvent::Retract {
            contacts: contacts.iter().map(|_| gesture_support::key(0)).collect(),
            since_us: *since_us,
        },
        other => other.clone(),
    };
    told.iter().map(|(t, e)| (*t, strip(e))).collect()
}

/// Checks that events come in an order that makes sense.
fn check_story(told: &[(u64, HandEvent)]) -> Result<(), TestCaseError> {
    let mut open: BTreeSet<Leg> = BTreeSet::new();
    let mut over: BTreeSet<Leg> = BTreeSet::new();
    let mut gone: BTreeSet<HandId> = BTreeSet::new();
    let mut resting: BTreeSet<HandId> = BTreeSet::new();
    let mut retracted = false;
    for (_, event) in told {
        match event {
            HandEvent::Rest { hand, fingers, .. } => {
                prop_assert!((1..=MAX_FINGERS).contains(&fingers.len()) && !gone.contains(hand));
                resting.insert(*hand);
            }
            HandEvent::Push { leg, starts, fit, .. } => {
                prop_assert!((1..=MAX_FINGERS).contains(&starts.len()));
                prop_assert!(!over.contains(leg) && !gone.contains(&leg.hand));
                let before = leg.index.checked_sub(1).map(|index| Leg { index, ..*leg });
                prop_assert!(
                    before.is_none_or(|leg| over.contains(&leg)),
                    "a leg begins when the last is over"
                );
                prop_assert!(fit.residual.is_finite() && fit.motion.translation.is_finite());
                resting.remove(&leg.hand);
                open.insert(*leg);
            }
            HandEvent::PushEnd { leg } => {
                prop_assert!(open.remove(leg), "what ends has begun");
                over.insert(*leg);
            }
            HandEvent::Tap { hand, fingers, .. } => {
                prop_assert!((1..=MAX_FINGERS).contains(&fingers.len()));
                prop_assert!(gone.insert(*hand) && !resting.contains(hand));
            }
            HandEvent::Lift { hand } => {
                prop_assert!(resting.remove(hand) && gone.insert(*hand));
            }
            HandEvent::Retract { contacts, .. } => {
                prop_assert!(!contacts.is_empty());
                retracted = true;
            }
        }
    }
    prop_assert!(
        retracted || (open.is_empty() && resting.is_empty()),
        "everything ends"
    );
    Ok(())
}

/// Reorders contacts within frames, each contact's own events in order.
fn shuffled(frames: &[InputFrame], seed: u64) -> Vec<InputFrame> {
    let rank = |id: u64| (id ^ seed).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mut frames = frames.to_vec();
    for frame in &mut frames {
        frame.events.sort_by_key(|event| rank(event.contact.key.id));
    }
    frames
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn events_tell_a_story_that_ends(frames in any_session()) {
        check_story(&play(&frames))?;
    }

    #[test]
    fn a_replay_is_equal(frames in any_session()) {
        prop_assert_eq!(play(&frames), play(&frames));
    }

    #[test]
    fn how_a_moment_is_cut_makes_no_difference(frames in any_session()) {
        let cut: Vec<InputFrame> = frames
            .iter()
            .flat_map(|frame| {
                let single = |event: &ContactEvent| InputFrame { events: vec![*event], ..frame.clone() };
                frame.events.iter().map(single).collect::<Vec<_>>()
            })
            .collect();
        prop_assert_eq!(play(&cut), play(&frames));
    }

    #[test]
    fn the_order_of_contacts_makes_no_difference(frames in any_session(), seed in any::<u64>()) {
        prop_assert_eq!(play(&shuffled(&frames, seed)), play(&frames));
    }

    #[test]
    fn the_ids_make_no_difference(frames in any_session(), factor in prop_oneof![Just(3_u64), Just(7), Just(9)]) {
        let mut renamed = frames.clone();
        for event in renamed.iter_mut().flat_map(|frame| &mut frame.events) {
            // Odd factors permute the ids below 2^16.
            event.contact.key.id = (event.contact.key.id * factor + 5) % 65_536;
        }
        prop_assert_eq!(nameless(&play(&renamed)), nameless(&play(&frames)));
    }

    #[test]
    fn only_young_contacts_are_taken_back(frames in session()) {
        let revise_us = (GestureParams::default().revise_ms * 1000.0) as u64;
        for (t_us, event) in play(&frames) {
            if let HandEvent::Retract { contacts, since_us } = event {
                // The evidence came at most a tick before it was told.
                prop_assert!(t_us < since_us + revise_us + TICK_US);
                for key in contacts {
                    let landed = |e: &ContactEvent| e.phase == Phase::Down && e.contact.key == key;
                    let since = frames.iter().filter(|f| f.t_us >= since_us);
                    prop_assert!(since.flat_map(|f| &f.events).any(landed));
                }
            }
        }
    }

    #[test]
    fn what_is_recorded_plays_as_it_did(frames in any_session()) {
        let mut writer = GestureWriter::new(Vec::new(), &Header::new(TABLE_MM)).unwrap();
        for frame in &frames {
            writer.write_frame(frame).unwrap();
        }
        let bytes = writer.into_inner().unwrap();
        let file = read_gesture(bytes.as_slice(), "recorded").unwrap();
        // Only the file's end cancels what is still down.
        let mut read = file.frames.clone();
        if !file.warnings.is_empty() {
            read.pop();
        }
        prop_assert_eq!(nameless(&play(&read)), nameless(&play(&frames)));
        prop_assert_eq!(file.write(Vec::new()).unwrap(), {
            let again = read_gesture(bytes.as_slice(), "recorded").unwrap();
            again.write(Vec::new()).unwrap()
        });
        let again = read_gesture(file.write(Vec::new()).unwrap().as_slice(), "again").unwrap();
        prop_assert_eq!((&again.header, &again.frames), (&file.header, &file.frames));
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read_gesture(bytes.as_slice(), "noise");
    }

    #[test]
    fn any_damage_is_read_or_refused(frames in any_session(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut writer = GestureWriter::new(Vec::new(), &Header::new(TABLE_MM)).unwrap();
        for frame in &frames {
            writer.write_frame(frame).unwrap();
        }
        let mut bytes = writer.into_inner().unwrap();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        match read_gesture(bytes.as_slice(), "damaged") {
            Ok(file) => drop(play(&file.frames)),
            Err(error) => prop_assert!(error.to_string().starts_with("damaged:")),
        }
    }
}

#[test]
fn random_sessions_reach_every_rule() {
    let mut runner = TestRunner::deterministic();
    let strategy = any_session();
    let mut sum = ContactStats::default();
    let mut turns = 0;
    for _ in 0..200 {
        let frames = strategy.new_tree(&mut runner).unwrap().current();
        let (told, stats) = play_and_count(&frames);
        turns += told
            .iter()
            .filter(|(_, e)| matches!(e, HandEvent::PushEnd { leg } if leg.index > 0))
            .count();
        sum.pushes += stats.pushes;
        sum.rests += stats.rests;
        sum.taps += stats.taps;
        sum.splits += stats.splits;
        sum.dropped_ghosts += stats.dropped_ghosts;
        sum.retracted += stats.retracted;
        sum.ignored += stats.ignored;
        sum.doubled += stats.doubled;
        sum.bridged += stats.bridged;
    }
    let reached = [
        sum.pushes,
        sum.rests,
        sum.taps,
        sum.splits,
        sum.dropped_ghosts,
        sum.retracted,
        sum.ignored,
        sum.doubled,
        sum.bridged,
        turns as u64,
    ];
    assert!(reached.iter().all(|&count| count > 5), "{reached:?}");
}

#[test]
fn a_leg_that_ends_twice_is_no_story() {
    let leg = Leg {
        hand: HandId(0),
        index: 0,
    };
    assert!(check_story(&[(0, HandEvent::PushEnd { leg })]).is_err());
    assert!(check_story(&[(0, HandEvent::Lift { hand: HandId(0) })]).is_err());
}
