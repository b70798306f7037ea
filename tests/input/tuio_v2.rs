//! TUIO 2.0: which frames are believed, and what they make of the contacts.

use crate::tuio_common::*;
use glam::DVec2;
use orogen::gesture::contact::Phase;
use orogen::input::tuio::TuioVersion;

const NAME: &str = "table:0@127.0.0.1";

#[test]
fn a_finger_lands_moves_and_lifts() {
    let mut table = Table::default();
    table.hear(0, &pointers(NAME, 1, &[(7, 0.5, 0.5)]));
    table.hear(1, &pointers(NAME, 2, &[(7, 0.6, 0.5)]));
    table.hear(2, &bundle(vec![frm(3, NAME), alv(&[7])]));
    table.hear(3, &pointers(NAME, 4, &[]));
    let phases: Vec<_> = table.events.iter().map(|e| e.phase).collect();
    assert_eq!(phases, [Phase::Down, Phase::Move, Phase::Up]);
    let source = table.decoder.sources().next().unwrap();
    assert_eq!(source.name, NAME);
    assert_eq!(source.version, TuioVersion::V2);
    assert_eq!(source.sensor, Some([1920, 1080]));
    assert_eq!(source.frames, 4);
}

#[test]
fn only_the_last_bundle_of_a_frame_lists_who_is_alive() {
    let mut table = Table::default();
    table.hear(0, &bundle(vec![frm(5, NAME), ptr(1, 0.1, 0.1, 0.0, 1.0)]));
    table.hear(1, &bundle(vec![frm(5, NAME), ptr(2, 0.2, 0.2, 0.0, 1.0)]));
    assert_eq!((table.states, table.down().len()), (0, 0));
    table.hear(
        2,
        &bundle(vec![frm(5, NAME), ptr(3, 0.3, 0.3, 0.0, 1.0), alv(&[1, 2, 3])]),
    );
    assert_eq!((table.states, table.down()), (1, vec![1, 2, 3]));
    // A part that was overtaken by the last one still counts.
    table.hear(3, &bundle(vec![frm(6, NAME), alv(&[1, 2, 3, 4])]));
    table.hear(4, &bundle(vec![frm(6, NAME), ptr(4, 0.4, 0.4, 0.0, 1.0)]));
    assert_eq!(table.down(), [1, 2, 3, 4]);
}

#[test]
fn parts_without_a_head_belong_to_the_frame_at_hand() {
    let mut table = Table::default();
    table.hear(0, &bundle(vec![ptr(9, 0.9, 0.9, 0.0, 1.0), alv(&[9])]));
    assert_eq!((table.down().len(), table.decoder.counts().unnumbered), (0, 1));
    table.hear(1, &bundle(vec![frm(5, NAME), ptr(1, 0.1, 0.1, 0.0, 1.0)]));
    table.hear(2, &bundle(vec![ptr(2, 0.2, 0.2, 0.0, 1.0)]));
    table.hear(3, &bundle(vec![alv(&[1, 2])]));
    assert_eq!(table.down(), [1, 2]);
}

#[test]
fn a_frame_whose_end_was_lost_is_healed_by_the_next() {
    let mut table = Table::default();
    table.hear(0, &pointers(NAME, 1, &[(1, 0.1, 0.1)]));
    table.hear(
        1,
        &bundle(vec![
            frm(2, NAME),
            ptr(1, 0.2, 0.1, 0.0, 1.0),
            ptr(2, 0.5, 0.5, 0.0, 1.0),
        ]),
    );
    table.hear(2, &bundle(vec![frm(3, NAME), alv(&[1, 2])]));
    assert_eq!(table.down(), [1, 2]);
    assert_eq!(table.place(1), Some(DVec2::new(200.0, 50.0)));
    // What no list names is forgotten.
    table.hear(3, &bundle(vec![frm(4, NAME), ptr(3, 0.7, 0.7, 0.0, 1.0)]));
    table.hear(4, &bundle(vec![frm(5, NAME), alv(&[2])]));
    table.hear(5, &bundle(vec![frm(6, NAME), alv(&[2, 3])]));
    assert_eq!(table.down(), [2]);
}

#[test]
fn a_lower_number_is_late_for_a_second_and_0_never_is() {
    let mut table = Table::default();
    table.hear(0, &pointers(NAME, 10_000, &[(1, 0.1, 0.1)]));
    table.hear(1, &pointers(NAME, 9_999, &[]));
    table.hear(2, &pointers(NAME, 1, &[]));
    assert_eq!((table.down(), table.decoder.counts().late), (vec![1], 2));
    table.hear(3, &pointers(NAME, 0, &[(1, 0.1, 0.1), (2, 0.2, 0.2)]));
    assert_eq!(table.down(), [1, 2]);
    table.hear(999_999, &pointers(NAME, 3, &[]));
    assert_eq!(table.down(), [1, 2]);
    table.hear(1_000_000, &pointers(NAME, 4, &[(1, 0.1, 0.1)]));
    assert_eq!(table.down(), [1]);
    assert_eq!((table.decoder.counts().restarts, table.lost), (1, 1));
    // Ids beyond the half of 32 bits go on counting up.
    let mut table = Table::default();
    table.hear(0, &pointers(NAME, i32::MAX, &[]));
    table.hear(1, &pointers(NAME, i32::MIN, &[(1, 0.1, 0.1)]));
    assert_eq!(table.down(), [1]);
}

#[test]
fn a_sender_that_starts_anew_in_the_middle_of_a_frame_loses_what_it_had() {
    let mut table = Table::default();
    table.hear(0, &pointers(NAME, 500, &[(1, 0.1, 0.1)]));
    table.hear(2_000_000, &bundle(vec![frm(1, NAME), ptr(1, 0.5, 0.5, 0.0, 1.0)]));
    assert_eq!((table.lost, table.down().len()), (1, 0));
    table.hear(2_000_001, &bundle(vec![frm(1, NAME), alv(&[1])]));
    assert_eq!(table.down(), [1]);
}

#[test]
fn messages_of_one_id_are_about_one_thing() {
    let mut table = Table::default();
    let pointer = ptr(1, 0.5, 0.5, 0.01, 0.5);
    table.hear(0, &bundle(vec![frm(1, NAME), pointer.clone(), alv(&[1])]));
    let size = |table: &Table| table.last[0].size_mm.map(DVec2::round);
    assert_eq!(
        size(&table),
        Some(DVec2::splat(10.0)),
        "twice the radius, in parts of the shorter side"
    );
    // The outline knows the size better, the pointer the place; in either order.
    let outline = bnd(1, 0.4, 0.4, 0.02, 0.06);
    table.hear(
        1,
        &bundle(vec![frm(2, NAME), pointer.clone(), outline.clone(), alv(&[1])]),
    );
    assert_eq!(
        (size(&table), table.down().len()),
        (Some(DVec2::new(20.0, 30.0)), 1)
    );
    table.hear(2, &bundle(vec![frm(3, NAME), outline, pointer, alv(&[1])]));
    assert_eq!(size(&table), Some(DVec2::new(20.0, 30.0)));
    assert_eq!(table.place(1), Some(DVec2::new(500.0, 250.0)));
}

#[test]
fn tokens_and_outlines_are_contacts_and_symbols_are_not() {
    let mut table = Table::default();
    let symbol = floats(
        "/tuio2/sym",
        vec![3.into(), 0.into(), 0.into(), "type".into(), "data".into()],
        &[],
    );
    let control = floats("/tuio2/ctl", vec![3.into()], &[0.5, 0.5]);
    let content = vec![
        frm(1, NAME),
        tok(1, 0.1, 0.2),
        bnd(2, 0.5, 0.5, 0.1, 0.1),
        symbol,
        control,
    ];
    table.hear(0, &bundle([content, vec![alv(&[1, 2, 3])]].concat()));
    assert_eq!(table.down(), [1, 2]);
    assert_eq!(table.decoder.counts().faulty_messages, 0);
}

#[test]
fn a_pointer_that_hovers_does_not_touch() {
    let mut table = Table::default();
    let say = |id, press| bundle(vec![frm(id, NAME), ptr(1, 0.5, 0.5, 0.0, press), alv(&[1])]);
    table.hear(0, &say(1, -0.2));
    assert_eq!(table.down(), [0; 0]);
    table.hear(1, &say(2, 0.0));
    assert_eq!(table.down(), [1]);
    table.hear(2, &say(3, -0.1));
    assert_eq!(table.down(), [0; 0]);
}

#[test]
fn short_and_wrong_messages_are_let_pass() {
    let mut table = Table::default();
    let short = |address: &str, numbers: &[f32]| floats(address, vec![1.into(), 0.into(), 0.into()], numbers);
    table.hear(
        0,
        &bundle(vec![
            frm(1, NAME),
            short("/tuio2/ptr", &[0.5, 0.5, 0.0, 0.0, 0.1]),
            short("/tuio2/tok", &[0.5, 0.5]),
            message("/tuio2/ptr", vec![]),
            message("/tuio2/frm", vec![]),
            message("/tuio2/bnd", vec!["x".into()]),
            ptr(1, f32::NAN, 0.5, 0.0, 0.5),
            ptr(2, 0.5, 0.5, f32::NAN, 0.5),
            ptr(3, 0.5, 0.5, 0.1, f32::NAN),
            alv(&[1, 2, 3]),
        ]),
    );
    assert_eq!(table.down(), [2], "a size that is none is not known");
    assert_eq!(table.last[0].size_mm, None);
    let counts = table.decoder.counts();
    assert_eq!((counts.faulty_messages, counts.no_place), (5, 1));
}

#[test]
fn who_speaks_both_versions_tells_of_each_finger_once() {
    let mut table = Table::default();
    table.hear(0, &cursors("a@b", 1, &[(1, 0.5, 0.5)]));
    table.hear(1, &pointers(NAME, 1, &[(1, 0.5, 0.5)]));
    table.hear(2, &cursors("a@b", 2, &[(1, 0.5, 0.5)]));
    assert_eq!(table.down(), [1]);
    assert_eq!(table.decoder.counts().other_version, 1);
    // Another sender may speak as it likes.
    table.hear_from(3, 2, &cursors("c@d", 1, &[(2, 0.2, 0.2)]));
    assert_eq!(table.down(), [1, 2]);
}
