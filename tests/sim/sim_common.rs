//! Sessions for tests: what contacts and visitors do, written down by hand or drawn at random.
use glam::DVec2;
use orogen::gesture::command::{Action, Command};
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, Phase, Side, Source};
use proptest::prelude::*;

pub(crate) const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);

pub(crate) fn event(phase: Phase, id: u64, position: DVec2) -> ContactEvent {
    ContactEvent {
        phase,
        contact: Contact {
            key: ContactKey {
                source: Source::File,
                device: 0,
                id,
                generation: 0,
            },
            position,
            size_mm: None,
            confidence: None,
        },
    }
}

pub(crate) fn palm(phase: Phase, id: u64, position: DVec2) -> ContactEvent {
    let mut event = event(phase, id, position);
    event.contact.confidence = Some(0.0);
    event
}

pub(crate) fn frame(t_ms: u64, events: Vec<ContactEvent>) -> InputFrame {
    InputFrame {
        t_us: t_ms * 1000,
        events,
        commands: Vec::new(),
    }
}

/// What the south side does outside the contacts.
pub(crate) fn command(t_ms: u64, action: Action) -> InputFrame {
    InputFrame {
        t_us: t_ms * 1000,
        events: Vec::new(),
        commands: vec![Command {
            side: Some(Side::South),
            ..Command::new(action)
        }],
    }
}

/// A finger that lands, goes by `by` within `ms`, and stays down.
pub(crate) fn drag(id: u64, from: DVec2, by: DVec2, start_ms: u64, ms: u64) -> Vec<InputFrame> {
    let mut frames = vec![frame(start_ms, vec![event(Phase::Down, id, from)])];
    let steps = ms / 16;
    for step in 1..=steps {
        let at = from + by * (step as f64 / steps as f64);
        frames.push(frame(start_ms + step * 16, vec![event(Phase::Move, id, at)]));
    }
    frames
}

pub(crate) fn lift(t_ms: u64, id: u64, at: DVec2) -> InputFrame {
    frame(t_ms, vec![event(Phase::Up, id, at)])
}

/// As [`drag`], and then it lifts.
pub(crate) fn stroke(id: u64, from: DVec2, by: DVec2, start_ms: u64, ms: u64) -> Vec<InputFrame> {
    let mut frames = drag(id, from, by, start_ms, ms);
    frames.push(lift(start_ms + ms + 16, id, from + by));
    frames
}

/// Any place; some are off the table, as ghosts are.
pub(crate) fn place() -> impl Strategy<Value = DVec2> {
    (-100.0..1300.0, -100.0..800.0).prop_map(|(x, y)| DVec2::new(x, y))
}

fn any_event(ids: u64) -> impl Strategy<Value = ContactEvent> {
    let phase = prop_oneof![
        3 => Just(Phase::Down),
        7 => Just(Phase::Move),
        2 => Just(Phase::Up),
        1 => Just(Phase::Cancel),
    ];
    let size = prop::option::weighted(0.2, (1.0..60.0, 1.0..60.0).prop_map(|(w, h)| DVec2::new(w, h)));
    let confidence = prop::option::weighted(0.1, prop_oneof![Just(0.0f32), Just(1.0f32)]);
    (phase, 0..ids, place(), size, confidence).prop_map(|(phase, id, position, size_mm, confidence)| {
        let mut event = event(phase, id, position);
        event.contact.size_mm = size_mm;
        event.contact.confidence = confidence;
        event
    })
}

/// Any side, and perhaps one of a few contacts, does one of `actions`.
pub(crate) fn any_command(actions: impl Strategy<Value = Action>) -> impl Strategy<Value = Command> {
    let contact = prop::option::of(0u64..3);
    (actions, any::<bool>(), contact).prop_map(|(action, north, contact)| Command {
        side: Some(if north { Side::North } else { Side::South }),
        contact,
        ..Command::new(action)
    })
}

/// Any session with up to `ids` contacts and with `commands`.
pub(crate) fn any_frames(
    ids: u64,
    commands: impl Strategy<Value = Command>,
) -> impl Strategy<Value = Vec<InputFrame>> {
    let frame = (
        0u64..80_000,
        prop::collection::vec(any_event(ids), 0..6),
        prop::collection::vec(commands, 0..2),
    );
    prop::collection::vec(frame, 1..60).prop_map(|frames| {
        let mut t_us = 0;
        let later = |(wait, events, commands)| {
            t_us += wait;
            InputFrame {
                t_us,
                events,
                commands,
            }
        };
        frames.into_iter().map(later).collect()
    })
}
