//! TUIO 1.1: which frames are believed, and what they make of the contacts.

use crate::tuio_common::*;
use glam::DVec2;
use orogen::gesture::contact::{MAX_CONTACTS, Phase};
use rosc::OscType;

const FRAME_US: u64 = 16_000;

#[test]
fn a_finger_lands_moves_and_lifts() {
    let mut table = Table::default();
    table.hear(0, &cursors("tracker@host", 1, &[(7, 0.5, 0.5)]));
    table.hear(FRAME_US, &cursors("tracker@host", 2, &[(7, 0.6, 0.5)]));
    table.hear(2 * FRAME_US, &cursors("tracker@host", 3, &[]));
    let seen: Vec<_> = table
        .events
        .iter()
        .map(|e| (e.phase, e.contact.key.id, e.contact.position))
        .collect();
    let expected = [
        (Phase::Down, 7, DVec2::new(500.0, 250.0)),
        (Phase::Move, 7, DVec2::new(600.0, 250.0)),
        (Phase::Up, 7, DVec2::new(600.0, 250.0)),
    ];
    assert_eq!(seen, expected);
    assert_eq!(table.decoder.counts().frames, 3);
    let source = table.decoder.sources().next().unwrap();
    assert_eq!(
        (source.name.as_str(), source.peer, source.frames),
        ("tracker@host", peer(5000), 3)
    );
}

#[test]
fn frames_without_a_number_are_always_believed() {
    let mut table = Table::default();
    table.hear(0, &cursors("a@b", 500, &[(1, 0.1, 0.1)]));
    table.hear(1, &cursors("a@b", -1, &[(1, 0.2, 0.1), (2, 0.3, 0.3)]));
    assert_eq!(table.down(), [1, 2]);
    table.hear(2, &cursors("a@b", 0, &[]));
    assert_eq!(table.down(), [0; 0]);
    // They leave the count as it was.
    table.hear(3, &cursors("a@b", 499, &[(3, 0.1, 0.1)]));
    assert_eq!((table.down().len(), table.decoder.counts().late), (0, 1));
}

#[test]
fn parts_of_a_frame_have_one_number() {
    let mut table = Table::default();
    table.hear(
        0,
        &bundle(vec![alive(CURSOR, &[1, 2]), cursor(1, 0.1, 0.1), fseq(CURSOR, 9)]),
    );
    assert_eq!(table.down(), [1], "the second is not placed yet");
    table.hear(
        1,
        &bundle(vec![alive(CURSOR, &[1, 2]), cursor(2, 0.2, 0.2), fseq(CURSOR, 9)]),
    );
    assert_eq!(table.down(), [1, 2]);
    // A part may leave out the list.
    table.hear(2, &bundle(vec![cursor(2, 0.4, 0.2), fseq(CURSOR, 9)]));
    assert_eq!(table.place(2), Some(DVec2::new(400.0, 100.0)));
}

#[test]
fn what_was_overtaken_is_dropped_and_what_starts_anew_is_not() {
    let mut table = Table::default();
    table.hear(0, &cursors("a@b", 200, &[(1, 0.1, 0.1)]));
    for number in [199, 150, 100] {
        table.hear(1, &cursors("a@b", number, &[(9, 0.9, 0.9)]));
    }
    assert_eq!((table.down(), table.decoder.counts().late), (vec![1], 3));
    // One lower, and it is a sender that counts anew; its finger 1 is another one.
    table.hear(2, &cursors("a@b", 99, &[(1, 0.2, 0.2)]));
    let phases: Vec<_> = table
        .events
        .iter()
        .map(|e| (e.phase, e.contact.key.generation))
        .collect();
    assert_eq!(phases, [(Phase::Down, 0), (Phase::Cancel, 0), (Phase::Down, 1)]);
    assert_eq!(table.decoder.counts().restarts, 1);
    // From here on it counts from 99.
    table.hear(3, &cursors("a@b", 98, &[]));
    assert_eq!(table.down(), [1]);
    table.hear(4, &cursors("a@b", 100, &[]));
    assert_eq!(table.down(), [0; 0]);
}

#[test]
fn a_sender_that_starts_anew_soon_after_its_first_start_is_heard_within_a_second() {
    let mut table = Table::default();
    for number in 1..=60 {
        table.hear(
            number * FRAME_US,
            &cursors("a@b", number as i32, &[(1, 0.1, 0.1)]),
        );
    }
    let start_us = 61 * FRAME_US;
    for number in 1..=59 {
        table.hear(
            start_us + number * 2 * FRAME_US,
            &cursors("a@b", number as i32, &[]),
        );
    }
    assert_eq!(table.down(), [0; 0]);
    assert_eq!(table.decoder.counts().restarts, 1);
}

#[test]
fn a_lost_frame_is_healed_by_the_next() {
    let mut table = Table::default();
    table.hear(0, &cursors("a@b", 1, &[(1, 0.1, 0.1)]));
    // Frame 2, in which 1 lifts and 2 lands, is lost. The next one tells of no place, the one after does.
    table.hear(2, &bundle(vec![alive(CURSOR, &[2]), fseq(CURSOR, 3)]));
    assert_eq!(table.down(), [0; 0]);
    table.hear(
        3,
        &bundle(vec![alive(CURSOR, &[2]), cursor(2, 0.3, 0.3), fseq(CURSOR, 4)]),
    );
    assert_eq!(table.down(), [2]);
}

#[test]
fn a_still_finger_needs_no_place_in_each_frame() {
    let mut table = Table::default();
    table.hear(0, &cursors("a@b", 1, &[(1, 0.1, 0.1)]));
    table.hear(1, &bundle(vec![alive(CURSOR, &[1]), fseq(CURSOR, 2)]));
    assert_eq!((table.down(), table.events.len()), (vec![1], 1));
}

#[test]
fn the_order_of_the_messages_in_a_bundle_does_not_matter() {
    let mut table = Table::default();
    let content = vec![
        fseq(CURSOR, 1),
        cursor(4, 0.5, 0.5),
        alive(CURSOR, &[4]),
        source(CURSOR, "a@b"),
    ];
    table.hear(0, &bundle(content));
    assert_eq!(table.down(), [4]);
}

#[test]
fn one_number_stands_for_all_profiles_of_a_bundle() {
    let mut table = Table::default();
    let say = |ids: [&[i32]; 3], number| {
        let mut content = vec![alive(CURSOR, ids[0]), alive(BLOB, ids[1]), alive(OBJECT, ids[2])];
        content.extend([
            cursor(1, 0.1, 0.1),
            blob(1, 0.5, 0.5, 0.1, 0.2),
            object(1, 3, 0.9, 0.9),
        ]);
        content.push(fseq(CURSOR, number));
        bundle(content)
    };
    table.hear(0, &say([&[1], &[1], &[1]], -1));
    assert_eq!(
        table.down(),
        [1, 1 << 32 | 1, 2 << 32 | 1],
        "ids of each profile are its own"
    );
    let sizes: Vec<_> = table
        .last
        .iter()
        .map(|touching| touching.size_mm.is_some())
        .collect();
    assert_eq!(sizes, [false, true, false]);
    let size = table.last[1].size_mm.unwrap();
    assert!((size - DVec2::new(100.0, 100.0)).length() < 1e-3, "{size}");
    table.hear(1, &say([&[], &[1], &[]], -1));
    assert_eq!(table.down().len(), 1);
    table.hear(2, &say([&[], &[], &[]], -1));
    assert_eq!(table.down().len(), 0);
}

#[test]
fn profiles_that_count_apart_do_not_make_each_other_late() {
    let mut table = Table::default();
    table.hear(0, &cursors("a@b", 900, &[(1, 0.1, 0.1)]));
    let objects = |number, ids: &[i32]| {
        bundle(vec![
            alive(OBJECT, ids),
            object(5, 1, 0.5, 0.5),
            fseq(OBJECT, number),
        ])
    };
    table.hear(1, &objects(880, &[5]));
    table.hear(2, &objects(881, &[5]));
    table.hear(3, &cursors("a@b", 901, &[(1, 0.2, 0.1)]));
    assert_eq!(table.down(), [1, 1 << 32 | 5]);
    let counts = table.decoder.counts();
    assert_eq!((counts.late, counts.restarts), (0, 0));
    // The name was left out of the bundles with objects: it is one sender all the same.
    assert_eq!(table.decoder.sources().count(), 1);
}

#[test]
fn a_blob_around_a_finger_is_that_finger() {
    let mut table = Table::default();
    let say = |cursors: &[OscPacketAt], blobs: &[(i32, f32, f32, f32)]| {
        let ids: Vec<i32> = cursors.iter().map(|c| c.0).collect();
        let blob_ids: Vec<i32> = blobs.iter().map(|b| b.0).collect();
        let mut content = vec![alive(CURSOR, &ids), alive(BLOB, &blob_ids), fseq(CURSOR, -1)];
        content.extend(cursors.iter().map(|&(id, x, y)| cursor(id, x, y)));
        content.extend(blobs.iter().map(|&(id, x, y, w)| blob(id, x, y, w, 2.0 * w)));
        bundle(content)
    };
    // One finger with its outline, a hand around two fingers, and a palm of its own.
    let fingers = [(1, 0.1, 0.1), (2, 0.5, 0.5), (3, 0.52, 0.5)];
    let outlines = [(11, 0.101, 0.1, 0.02), (12, 0.51, 0.5, 0.1), (13, 0.9, 0.9, 0.05)];
    table.hear(0, &say(&fingers, &outlines));
    assert_eq!(table.down(), [1, 2, 3, (2 << 32) + 13]);
    let sizes: Vec<_> = table.last.iter().map(|t| t.size_mm.map(DVec2::round)).collect();
    let mm = |size| Some(DVec2::splat(size));
    assert_eq!(sizes, [mm(20.0), None, None, mm(50.0)]);
}

type OscPacketAt = (i32, f32, f32);

#[test]
fn several_senders_do_not_disturb_each_other() {
    let mut table = Table::default();
    table.hear_from(0, 1, &cursors("a@b", 900, &[(1, 0.1, 0.1)]));
    table.hear_from(1, 2, &cursors("a@b", 880, &[(1, 0.2, 0.1)]));
    table.hear_from(2, 1, &cursors("c@d", 890, &[(1, 0.3, 0.1)]));
    table.hear_from(3, 3, &cursors("", 870, &[(1, 0.4, 0.1)]));
    assert_eq!(table.down(), [1; 4]);
    assert_eq!(table.decoder.sources().count(), 4);
    table.hear_from(4, 2, &cursors("a@b", 881, &[]));
    assert_eq!(table.down(), [1; 3]);
    assert_eq!(table.decoder.counts().late, 0);
}

#[test]
fn senders_that_a_hub_packs_together_stay_apart() {
    let mut table = Table::default();
    let of = |name: &str, id: i32| {
        nested(vec![
            source(CURSOR, name),
            alive(CURSOR, &[id]),
            cursor(id, 0.5, 0.5),
            fseq(CURSOR, id),
        ])
    };
    table.hear(0, &bundle(vec![of("left@hub", 3), of("right@hub", 900)]));
    assert_eq!(table.down(), [3, 900]);
    assert_eq!(table.decoder.sources().count(), 2);
}

#[test]
fn what_is_short_or_wrong_is_let_pass() {
    let mut table = Table::default();
    let set = |args: Vec<OscType>| message(CURSOR, [vec!["set".into()], args].concat());
    let f = OscType::Float;
    table.hear(
        0,
        &bundle(vec![
            alive(CURSOR, &[1, 2, 3, 4, 5, 6]),
            set(vec![]),
            set(vec![1.into()]),
            set(vec![1.into(), f(0.1)]),
            set(vec![2.into(), "x".into(), f(0.1)]),
            set(vec![3.into(), f(f32::NAN), f(0.1)]),
            set(vec![3.into(), f(0.5), f(f32::INFINITY)]),
            set(vec![4.into(), f(640.0), f(480.0)]),
            set(vec![f(5.0), f(0.25), 1.into()]),
            set(vec![f(5.5), f(0.25), f(0.25)]),
            set(vec![77.into(), f(0.5), f(0.5)]),
            message(CURSOR, vec![]),
            message(CURSOR, vec![5.into()]),
            message(CURSOR, vec!["fseq".into()]),
            message(CURSOR, vec!["fseq".into(), "1".into()]),
            message("/tuio/25Dcur", vec!["alive".into()]),
            message("/tuio/_ext", vec![]),
            fseq(CURSOR, 1),
        ]),
    );
    assert_eq!(table.down(), [5], "ids may be floats and places may be whole");
    assert_eq!(table.place(5), Some(DVec2::new(250.0, 500.0)));
    let counts = table.decoder.counts();
    assert_eq!(counts.faulty_messages, 9);
    assert_eq!((counts.no_place, counts.not_alive), (3, 1));
}

#[test]
fn a_bundle_without_a_number_is_no_frame() {
    let mut table = Table::default();
    table.hear(0, &bundle(vec![alive(CURSOR, &[1]), cursor(1, 0.5, 0.5)]));
    assert_eq!((table.states, table.decoder.sources().count()), (0, 0));
    table.hear(1, &cursors("", 1, &[(1, 0.5, 0.5)]));
    table.hear(2, &bundle(vec![alive(CURSOR, &[])]));
    assert_eq!(table.down(), [1]);
    assert_eq!(table.decoder.counts().unnumbered, 2);
}

#[test]
fn there_is_room_for_so_many_and_no_more() {
    let mut table = Table::default();
    let many: Vec<_> = (0..300).map(|id| (id, id as f32 / 300.0, 0.5)).collect();
    table.hear(0, &cursors("a@b", 1, &many));
    assert_eq!(table.down().len(), MAX_CONTACTS);
    assert!(table.decoder.counts().over_cap > 0);
    table.hear(1, &cursors("a@b", 2, &[(299, 0.5, 0.5)]));
    assert_eq!(table.down(), [299]);
}

#[test]
fn negative_session_ids_are_ids() {
    let mut table = Table::default();
    table.hear(0, &cursors("a@b", 1, &[(-1, 0.5, 0.5), (i32::MIN, 0.1, 0.1)]));
    assert_eq!(table.down(), [u64::from(i32::MIN as u32), u64::from(u32::MAX)]);
}
