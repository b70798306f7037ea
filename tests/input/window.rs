//! Touches, mouse and planted hands of a window: whatever comes in, a well-formed stream of contacts comes out.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use orogen::gesture::contact::{ContactEvent, ContactKey, MAX_CONTACTS, Phase, Source};
use orogen::input::window::{TouchPhase, WindowInput, WindowMap};
use orogen::settings::Orientation;
use proptest::prelude::*;

const SIZE_MM: DVec2 = DVec2::new(1200.0, 675.0);
const WINDOW_PX: DVec2 = DVec2::new(1280.0, 720.0);

fn map(orientation: Orientation) -> WindowMap {
    WindowMap::new(WINDOW_PX, (DVec2::ZERO, WINDOW_PX), SIZE_MM, orientation, None)
}

fn table() -> (WindowInput, Vec<ContactEvent>) {
    (WindowInput::new(map(Orientation::default())), Vec::new())
}

fn phases(events: &[ContactEvent]) -> Vec<(Phase, Source, u64)> {
    let key = |event: &ContactEvent| event.contact.key;
    events
        .iter()
        .map(|e| (e.phase, key(e).source, key(e).id))
        .collect()
}

const ONE: (u16, u64) = (0, 1);

#[test]
fn a_touch_becomes_a_contact_in_millimetres_on_the_raster_of_files() {
    let (mut input, mut out) = table();
    input.touch(ONE, TouchPhase::Started, DVec2::new(640.0, 360.0), 0, &mut out);
    input.touch(ONE, TouchPhase::Moved, DVec2::new(641.0, 360.0), 1, &mut out);
    input.touch(ONE, TouchPhase::Moved, DVec2::new(641.0, 360.0), 2, &mut out);
    input.touch(ONE, TouchPhase::Ended, DVec2::new(641.0, 360.0), 3, &mut out);
    let expected = [Phase::Down, Phase::Move, Phase::Up];
    assert_eq!(out.iter().map(|e| e.phase).collect::<Vec<_>>(), expected);
    assert_eq!(out[0].contact.position, DVec2::new(600.0, 337.5));
    assert_eq!(out[2].contact.position, DVec2::new(600.94, 337.5));
}

#[test]
fn land_beside_bars_is_measured_from_its_own_corner() {
    let land = (DVec2::new(100.0, 60.0), DVec2::new(1080.0, 607.5));
    let map = WindowMap::new(WINDOW_PX, land, SIZE_MM, Orientation::default(), None);
    let mut input = WindowInput::new(map);
    let mut out = Vec::new();
    input.touch(ONE, TouchPhase::Started, land.0, 0, &mut out);
    input.touch((0, 2), TouchPhase::Started, land.0 + land.1, 0, &mut out);
    assert_eq!(out[0].contact.position, DVec2::ZERO);
    assert_eq!(out[1].contact.position, SIZE_MM);
}

/// The place on the glass stays under the finger: top left of the glass as the device reports it.
#[test]
fn each_orientation_brings_the_touch_under_the_finger_and_leaves_the_mouse_alone() {
    for ((name, orientation), corner) in Orientation::ALL.into_iter().zip([
        DVec2::new(0.0, 0.0),
        DVec2::new(1.0, 0.0),
        DVec2::new(1.0, 1.0),
        DVec2::new(0.0, 1.0),
        DVec2::new(1.0, 0.0),
        DVec2::new(1.0, 1.0),
        DVec2::new(0.0, 1.0),
        DVec2::new(0.0, 0.0),
    ]) {
        let mut input = WindowInput::new(map(orientation));
        let mut out = Vec::new();
        input.touch(ONE, TouchPhase::Started, DVec2::ZERO, 0, &mut out);
        assert_eq!(out[0].contact.position, corner * SIZE_MM, "{name}");
        input.touch((0, 2), TouchPhase::Started, WINDOW_PX * 0.5, 0, &mut out);
        assert_eq!(out[1].contact.position, SIZE_MM * 0.5, "{name}");
        input.pointer_moved(DVec2::ZERO, &mut out);
        assert_eq!(input.pointer_mm(), Some(DVec2::ZERO), "{name}");
    }
}

#[test]
fn a_second_down_cancels_the_first_and_ids_get_new_generations() {
    let (mut input, mut out) = table();
    for _ in 0..2 {
        input.touch(ONE, TouchPhase::Started, DVec2::ONE, 0, &mut out);
    }
    input.touch(ONE, TouchPhase::Ended, DVec2::ONE, 0, &mut out);
    input.touch(ONE, TouchPhase::Started, DVec2::ONE, 0, &mut out);
    let told: Vec<_> = out.iter().map(|e| (e.phase, e.contact.key.generation)).collect();
    let expected = [
        (Phase::Down, 0),
        (Phase::Cancel, 0),
        (Phase::Down, 1),
        (Phase::Up, 1),
        (Phase::Down, 2),
    ];
    assert_eq!(told, expected);
    assert_eq!(input.counts().doubled, 1);
}

#[test]
fn ends_of_touches_nobody_began_are_counted() {
    let (mut input, mut out) = table();
    input.touch(ONE, TouchPhase::Moved, DVec2::ONE, 0, &mut out);
    input.touch(ONE, TouchPhase::Ended, DVec2::ONE, 0, &mut out);
    input.touch(ONE, TouchPhase::Started, DVec2::NAN, 0, &mut out);
    input.touch(ONE, TouchPhase::Started, DVec2::splat(1e9), 0, &mut out);
    assert_eq!(out, []);
    assert_eq!(input.counts().unknown, 4);
}

#[test]
fn a_move_to_nowhere_leaves_the_contact_where_it_is() {
    let (mut input, mut out) = table();
    input.touch(ONE, TouchPhase::Started, DVec2::ONE, 0, &mut out);
    input.touch(
        ONE,
        TouchPhase::Moved,
        DVec2::new(f64::INFINITY, 0.0),
        0,
        &mut out,
    );
    input.touch(ONE, TouchPhase::Ended, DVec2::NAN, 0, &mut out);
    assert_eq!(out.len(), 2);
    assert_eq!(out[1].phase, Phase::Up);
    assert_eq!(out[1].contact.position, out[0].contact.position);
}

#[test]
fn the_mouse_is_a_finger() {
    let (mut input, mut out) = table();
    input.button(true, false, 0, &mut out);
    assert_eq!(out, [], "nobody knows where it is");
    input.pointer_moved(DVec2::new(64.0, 64.0), &mut out);
    input.button(true, false, 0, &mut out);
    input.pointer_moved(DVec2::new(128.0, 64.0), &mut out);
    input.pointer_left();
    input.button(false, false, 9, &mut out);
    input.button(false, false, 9, &mut out);
    let told = phases(&out);
    assert_eq!(told.len(), 3);
    assert_eq!(told[0], (Phase::Down, Source::Mouse, 0));
    assert_eq!(out[1].contact.position, DVec2::new(120.0, 60.0));
    assert_eq!(told[2].0, Phase::Up);
}

#[test]
fn the_mouse_is_no_finger_while_touches_are_down_nor_just_after() {
    let (mut input, mut out) = table();
    input.pointer_moved(DVec2::ONE, &mut out);
    input.button(true, false, 0, &mut out);
    input.touch(ONE, TouchPhase::Started, DVec2::ONE, 10, &mut out);
    assert_eq!(
        phases(&out)[1..],
        [
            (Phase::Cancel, Source::Mouse, 0),
            (Phase::Down, Source::Window, 1)
        ]
    );
    out.clear();
    input.button(true, false, 20_000, &mut out);
    input.touch(ONE, TouchPhase::Ended, DVec2::ONE, 900_000, &mut out);
    input.button(true, false, 1_399_999, &mut out);
    assert_eq!(out.len(), 1, "nothing but the end of the touch");
    assert_eq!(input.counts().shadows, 2);
    input.button(true, false, 1_400_000, &mut out);
    assert_eq!(phases(&out)[1], (Phase::Down, Source::Mouse, 0));
}

#[test]
fn shift_plants_a_hand_of_five_that_stays_until_it_is_clicked_again() {
    let (mut input, mut out) = table();
    input.pointer_moved(WINDOW_PX * 0.5, &mut out);
    input.button(true, true, 0, &mut out);
    input.button(false, true, 0, &mut out);
    assert_eq!(out.len(), 5);
    assert!(out.iter().all(|e| e.phase == Phase::Down));
    // Five fingers of one hand: they fit its box, and each has a neighbour as near as in recorded hands.
    for a in &out {
        let mut distances: Vec<f64> = out
            .iter()
            .map(|b| a.contact.position.distance(b.contact.position))
            .collect();
        distances.sort_by(f64::total_cmp);
        assert!(distances[1] > 30.0 && distances[1] < 52.0, "{distances:?}");
        assert!(distances[4] < 200.0);
    }
    // The other hand drags beside it.
    input.pointer_moved(DVec2::new(900.0, 360.0), &mut out);
    input.button(true, false, 1, &mut out);
    input.button(false, false, 2, &mut out);
    assert_eq!(input.contacts().count(), 5);
    // A second hand elsewhere; a click near the first lifts that one.
    input.pointer_moved(DVec2::new(200.0, 360.0), &mut out);
    input.button(true, true, 3, &mut out);
    assert_eq!(input.contacts().count(), 10);
    out.clear();
    input.pointer_moved(DVec2::new(660.0, 370.0), &mut out);
    input.button(true, true, 4, &mut out);
    assert_eq!(out.len(), 5);
    assert!(
        out.iter()
            .all(|e| e.phase == Phase::Up && e.contact.position.x > 500.0)
    );
    input.lift_all(&mut out);
    assert_eq!(input.contacts().count(), 0);
    assert_eq!(out.len(), 10);
}

#[test]
fn focus_size_and_device_withdraw_what_they_take_along() {
    let (mut input, mut out) = table();
    let fill = |input: &mut WindowInput, out: &mut Vec<ContactEvent>| {
        input.pointer_moved(WINDOW_PX * 0.5, out);
        input.button(true, true, 0, out);
        for device in [0, 7] {
            input.touch((device, 1), TouchPhase::Started, DVec2::ONE, 0, out);
        }
        out.clear();
    };
    fill(&mut input, &mut out);
    input.device_removed(7, &mut out);
    assert_eq!(phases(&out), [(Phase::Cancel, Source::Window, 1)]);
    assert_eq!(input.contacts().count(), 6);
    input.set_map(map(Orientation::default()), &mut out);
    assert_eq!(input.contacts().count(), 6, "the same map moves nothing");
    input.set_map(map(Orientation::new(2, false)), &mut out);
    assert_eq!(input.contacts().count(), 0);
    assert_eq!(input.pointer_mm(), None);
    assert_eq!(input.counts().withdrawn, 7);
    // What comes late from before is nobody's.
    out.clear();
    input.touch((0, 1), TouchPhase::Ended, DVec2::ONE, 9, &mut out);
    assert_eq!(out, []);
}

#[test]
fn beyond_the_cap_nothing_lands() {
    let (mut input, mut out) = table();
    for id in 0..MAX_CONTACTS as u64 + 3 {
        input.touch((0, id), TouchPhase::Started, DVec2::ONE, 0, &mut out);
    }
    assert_eq!(out.len(), MAX_CONTACTS);
    assert_eq!(input.counts().over_cap, 3);
    input.touch((0, 300), TouchPhase::Ended, DVec2::ONE, 0, &mut out);
    assert_eq!(out.len(), MAX_CONTACTS);
}

#[derive(Clone, Debug)]
enum Raw {
    Touch(u16, u64, TouchPhase, DVec2),
    Pointer(DVec2),
    Left,
    Button(bool, bool),
    LiftAll,
    CancelAll,
    Removed(u16),
    Turned(usize),
    Wait(u64),
}

fn pixels() -> impl Strategy<Value = DVec2> {
    prop_oneof![
        8 => (0.0..1280.0, 0.0..720.0).prop_map(|(x, y)| DVec2::new(x, y)),
        1 => Just(DVec2::NAN),
        1 => Just(DVec2::new(f64::INFINITY, -3.0)),
        1 => Just(DVec2::splat(-1e300)),
    ]
}

fn raw() -> impl Strategy<Value = Raw> {
    let phase = prop_oneof![
        Just(TouchPhase::Started),
        Just(TouchPhase::Moved),
        Just(TouchPhase::Ended),
        Just(TouchPhase::Cancelled)
    ];
    prop_oneof![
        8 => (0..2_u16, 0..4_u64, phase, pixels()).prop_map(|(d, id, phase, px)| Raw::Touch(d, id, phase, px)),
        3 => pixels().prop_map(Raw::Pointer),
        1 => Just(Raw::Left),
        4 => (any::<bool>(), any::<bool>()).prop_map(|(pressed, shift)| Raw::Button(pressed, shift)),
        1 => Just(Raw::LiftAll),
        1 => Just(Raw::CancelAll),
        1 => (0..2_u16).prop_map(Raw::Removed),
        1 => (0..8_usize).prop_map(Raw::Turned),
        3 => (0..900_000_u64).prop_map(Raw::Wait),
    ]
}

proptest! {
    #[test]
    fn any_input_gives_a_well_formed_stream(raws in prop::collection::vec(raw(), 0..120)) {
        let (mut input, mut out) = table();
        let mut now_us = 0;
        for raw in raws {
            match raw {
                Raw::Touch(device, id, phase, px) => input.touch((device, id), phase, px, now_us, &mut out),
                Raw::Pointer(px) => input.pointer_moved(px, &mut out),
                Raw::Left => input.pointer_left(),
                Raw::Button(pressed, shift) => input.button(pressed, shift, now_us, &mut out),
                Raw::LiftAll => input.lift_all(&mut out),
                Raw::CancelAll => input.cancel_all(&mut out),
                Raw::Removed(device) => input.device_removed(device, &mut out),
                Raw::Turned(turn) => input.set_map(map(Orientation::ALL[turn].1), &mut out),
                Raw::Wait(us) => now_us += us,
            }
        }
        let still_down: BTreeSet<ContactKey> = input.contacts().map(|c| c.key).collect();
        let mut down: BTreeMap<ContactKey, DVec2> = BTreeMap::new();
        let mut used = BTreeSet::new();
        for ContactEvent { phase, contact } in &out {
            prop_assert!(contact.position.is_finite());
            match phase {
                Phase::Down => {
                    prop_assert!(used.insert(contact.key), "a key is used again");
                    let slots: Vec<_> = down.keys().map(|key| key.slot()).collect();
                    prop_assert!(!slots.contains(&contact.key.slot()), "an id is down twice");
                    down.insert(contact.key, contact.position);
                }
                Phase::Move => {
                    let before = down.insert(contact.key, contact.position);
                    prop_assert!(before.is_some_and(|before| before != contact.position));
                }
                Phase::Up | Phase::Cancel => {
                    prop_assert_eq!(down.remove(&contact.key), Some(contact.position));
                }
            }
            prop_assert!(down.len() <= MAX_CONTACTS);
        }
        prop_assert_eq!(down.into_keys().collect::<BTreeSet<_>>(), still_down);
        out.clear();
        input.cancel_all(&mut out);
        prop_assert_eq!(input.contacts().count(), 0);
    }
}
