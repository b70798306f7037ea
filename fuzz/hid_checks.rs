//! What must hold for any report descriptor and any reports of a HID touchscreen.

use std::collections::BTreeSet;

use glam::DAffine2;
use orogen::gesture::contact::{ContactKey, MAX_CONTACTS, Phase, Source};
use orogen::input::hid::{Decoder, Descriptor, Facts, Frame, Quirk, Quirks, describe, descriptor_from_text};
use orogen::input::touching::Tracker;

/// A descriptor, as text or as bytes, is refused in one line, or comes to facts that can be.
pub(crate) fn descriptor(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        match descriptor_from_text(text) {
            Ok(bytes) => facts(&bytes),
            Err(error) => one_line(&error.to_string()),
        }
    }
    facts(bytes);
}

fn facts(bytes: &[u8]) {
    let descriptor = match Descriptor::parse(bytes) {
        Ok(descriptor) => descriptor,
        Err(error) => return one_line(&error.to_string()),
    };
    for answer in [None, Some(bytes)] {
        let max_contacts = descriptor.features.max_contacts(answer);
        assert!((1..=250).contains(&max_contacts), "{max_contacts} contacts");
        let _ = descriptor.features.set_touch_mode(answer);
        let quirks = Quirks::choose(0, 0, &descriptor, max_contacts);
        let facts = Facts::new(&descriptor, max_contacts);
        assert!(!describe(&descriptor, quirks, &facts).is_empty());
        assert_eq!(facts.touchscreen, descriptor.touch.is_ok());
        let Ok(report) = &descriptor.touch else { continue };
        assert!((1..=256).contains(&facts.slots) && facts.report_bytes > 0);
        for slot in &report.slots {
            for axis in [Some(slot.x), Some(slot.y), slot.width, slot.height]
                .into_iter()
                .flatten()
            {
                assert!(
                    axis.max > axis.min && (1..=32).contains(&axis.bits.len),
                    "{axis:?}"
                );
                let end = (axis.bits.start as usize + usize::from(axis.bits.len)).div_ceil(8);
                assert!(end <= report.bytes, "{axis:?} beyond {} bytes", report.bytes);
            }
        }
        let mut decoder = Decoder::new(&descriptor, quirks, max_contacts, None).expect("a touchscreen");
        decoder.decode(bytes, 0);
    }
}

/// The touchscreen that is listened to where the bytes begin with no other: five slots, ids of 8 bits, confidence,
/// area, contact count and scan time.
const TABLE: &[u8] = include_bytes!("seeds/hid_descriptor/hybrid.bin");

/// Reports that begin with a number of quirks, most contacts, and the length of a descriptor; then each report with
/// the time since the one before in ms, its length and its bytes. Contacts are well formed whatever comes.
pub(crate) fn reports(bytes: &[u8]) {
    let [quirks_low, quirks_high, most, low, high, rest @ ..] = bytes else {
        return;
    };
    let length = usize::from(u16::from_le_bytes([*low, *high]));
    let own = rest.get(..length).and_then(|bytes| Descriptor::parse(bytes).ok());
    let own = own.filter(|descriptor| descriptor.touch.is_ok());
    let mut rest = if own.is_some() { &rest[length..] } else { rest };
    let descriptor = own.unwrap_or_else(|| Descriptor::parse(TABLE).expect("a descriptor"));
    let set = u16::from_le_bytes([*quirks_low, *quirks_high]);
    let chosen: Vec<Quirk> = Quirk::ALL
        .into_iter()
        .enumerate()
        .filter_map(|(i, quirk)| (set >> i & 1 != 0).then_some(quirk))
        .collect();
    let quirks = if set == 0 {
        Quirks::choose(0, 0, &descriptor, (*most).into())
    } else {
        Quirks::of(&chosen)
    };
    let mut decoder = Decoder::new(&descriptor, quirks, (*most).into(), None).expect("a touchscreen");
    let mut play = Play::new();
    let mut now_us = 0;
    while let [wait_ms, length, after @ ..] = rest {
        let (report, after) = after.split_at(after.len().min((*length).into()));
        rest = after;
        now_us += u64::from(*wait_ms) * 1000;
        if let Some(frame) = decoder.tick(now_us) {
            play.frame(frame, now_us);
        }
        if let Some(frame) = decoder.decode(report, now_us) {
            play.frame(frame, now_us);
        }
    }
    play.end();
}

/// Turns frames into contacts, as the table does.
struct Play {
    tracker: Tracker,
    down: BTreeSet<ContactKey>,
    last_us: u64,
    events: Vec<orogen::gesture::contact::ContactEvent>,
}

impl Play {
    fn new() -> Self {
        Self {
            tracker: Tracker::new(Source::Hid, 0, DAffine2::IDENTITY),
            down: BTreeSet::new(),
            last_us: 0,
            events: Vec::new(),
        }
    }

    fn frame(&mut self, frame: Frame<'_>, now_us: u64) {
        assert!(
            (self.last_us..=now_us).contains(&frame.t_us),
            "time goes back or ahead"
        );
        self.last_us = frame.t_us;
        let ids: BTreeSet<u64> = frame.touching.iter().map(|t| t.id).collect();
        assert_eq!(ids.len(), frame.touching.len(), "an id twice");
        assert!(ids.len() <= MAX_CONTACTS);
        for touching in frame.touching {
            assert!(touching.at.is_finite() && touching.at.abs().max_element() < 2.0);
            assert!(
                touching
                    .size_mm
                    .is_none_or(|size| size.is_finite() && size.min_element() >= 0.0)
            );
        }
        self.tracker.frame(frame.touching, &mut self.events);
        self.follow();
        assert_eq!(self.down.len(), ids.len(), "a forgotten finger");
    }

    fn follow(&mut self) {
        for event in self.events.drain(..) {
            let key = event.contact.key;
            match event.phase {
                Phase::Down => assert!(self.down.insert(key), "down twice"),
                Phase::Move => assert!(self.down.contains(&key), "moved and not down"),
                Phase::Up | Phase::Cancel => assert!(self.down.remove(&key), "lifted and not down"),
            }
        }
    }

    fn end(&mut self) {
        self.tracker.cancel_all(&mut self.events);
        self.follow();
        assert!(self.down.is_empty());
    }
}

fn one_line(error: &str) {
    assert!(error.contains("expected"), "what was expected: {error}");
    assert!(!error.contains('\n'), "one line: {error}");
}
