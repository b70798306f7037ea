//! The ways in which devices depart from the rules, each by its name.

use crate::hid_common::{Sent, Shape};
use glam::DVec2;
use orogen::input::hid::decode::Frame;
use orogen::input::hid::{Decoder, Descriptor, Quirk, Quirks};
use orogen::input::touching::Touching;

fn parse(shape: &Shape) -> Descriptor {
    Descriptor::parse(&shape.build().bytes).expect("a descriptor")
}

fn decoder_of(shape: &Shape, max: u32, quirks: Quirks) -> Decoder {
    Decoder::new(&parse(shape), quirks, max, None).expect("a touchscreen")
}

/// As Orogen would listen to it.
fn decoder(shape: &Shape, max: u32) -> Decoder {
    decoder_of(shape, max, Quirks::choose(0, 0, &parse(shape), max))
}

fn ids(frame: Option<Frame<'_>>) -> Option<Vec<u64>> {
    frame.map(|frame| frame.touching.iter().map(|t| t.id).collect())
}

fn fingers(n: u64) -> Vec<Sent> {
    (0..n).map(|i| Sent::at(i + 3, 100 * i as i64, 50)).collect()
}

/// What `quirks` make of one report of a device with in-range and no scan time.
fn with(quirks: &[Quirk], sent: &[Sent], count: u64) -> Vec<Touching> {
    let shape = Shape {
        in_range: true,
        scan_bits: None,
        ..Shape::default()
    };
    let mut decoder = decoder_of(&shape, 10, Quirks::of(quirks));
    let report = shape.build().encode(sent, count, 0);
    decoder
        .decode(&report, 0)
        .map(|frame| frame.touching.to_vec())
        .unwrap_or_default()
}

fn names(touching: &[Touching]) -> Vec<u64> {
    touching.iter().map(|t| t.id).collect()
}

#[test]
fn not_seen_means_up() {
    let shape = Shape {
        scan_bits: None,
        ..Shape::default()
    };
    let built = shape.build();
    for (quirks, expected) in [
        (vec![Quirk::NotSeenMeansUp], vec![4]),
        (vec![Quirk::AlwaysValid, Quirk::ContactCountAccurate], vec![3, 4]),
    ] {
        let mut decoder = decoder_of(&shape, 10, Quirks::of(&quirks));
        decoder.decode(&built.encode(&fingers(2), 2, 0), 0);
        assert_eq!(
            ids(decoder.decode(&built.encode(&fingers(2)[1..], 1, 0), 8_000)),
            Some(expected)
        );
    }
}

#[test]
fn valid_is_confidence() {
    let unsure = Sent {
        confidence: false,
        ..fingers(2)[1]
    };
    let touching = with(&[Quirk::ValidIsConfidence], &[fingers(1)[0], unsure], 2);
    assert_eq!(names(&touching), [3]);
    assert_eq!(touching[0].confidence, None, "it tells of slots, not of palms");
    assert_eq!(names(&with(&[], &[fingers(1)[0], unsure], 2)), [3, 4]);
}

#[test]
fn valid_is_in_range() {
    let far = Sent {
        in_range: false,
        ..fingers(2)[1]
    };
    assert_eq!(
        names(&with(&[Quirk::ValidIsInRange], &[fingers(1)[0], far], 2)),
        [3]
    );
    assert_eq!(
        names(&with(&[Quirk::AlwaysValid, Quirk::ValidIsInRange], &[far], 1)),
        [4]
    );
}

#[test]
fn contact_count_accurate_and_always_valid() {
    let three = fingers(3);
    let both = [Quirk::AlwaysValid, Quirk::ContactCountAccurate];
    assert_eq!(
        names(&with(&both, &three, 2)),
        [3, 4],
        "the third slot holds old data"
    );
    assert_eq!(names(&with(&[Quirk::AlwaysValid], &three, 2)), [3, 4, 5]);
}

#[test]
fn slot_is_contact_id() {
    let sent = [Sent::at(0, 1, 1), Sent::at(9, 1, 1), Sent::at(10, 1, 1)];
    assert_eq!(names(&with(&[Quirk::SlotIsContactId], &sent, 3)), [0, 9]);
    assert_eq!(names(&with(&[Quirk::SlotIsContactIdMinusOne], &sent, 3)), [8, 9]);
    assert_eq!(names(&with(&[Quirk::SlotIsContactNumber], &sent, 3)), [0, 1, 2]);
    let middle_empty = [
        sent[0],
        Sent {
            in_range: false,
            ..sent[1]
        },
        sent[2],
    ];
    let number = [Quirk::SlotIsContactNumber, Quirk::ValidIsInRange];
    assert_eq!(names(&with(&number, &middle_empty, 3)), [0, 2]);
}

#[test]
fn touch_size_scaling_and_no_area() {
    let large = Sent {
        w: 4095,
        h: 819,
        ..fingers(1)[0]
    };
    let size = |quirks: &[Quirk]| with(quirks, &[large], 1)[0].size_mm;
    let near = |found: Option<DVec2>, expected: DVec2| found.unwrap().distance(expected) < 1e-9;
    assert!(near(size(&[]), DVec2::new(600.0, 68.0)));
    assert!(near(size(&[Quirk::TouchSizeScaling]), DVec2::new(300.0, 34.0)));
    assert_eq!(size(&[Quirk::NoArea]), None);
}

#[test]
fn ignore_duplicates() {
    let sent = [
        Sent::at(3, 1000, 0),
        Sent::at(3, 2000, 0),
        Sent::at(3, 0, 0).lifted(),
    ];
    let x = |quirks: &[Quirk]| (with(quirks, &sent, 3)[0].at.x * 4095.0).round();
    assert_eq!(x(&[Quirk::IgnoreDuplicates]), 1000.0);
    assert_eq!(x(&[Quirk::AlwaysValid]), 2000.0);
}

#[test]
fn fix_const_contact_id() {
    let shape = Shape {
        constant_id: true,
        ..Shape::default()
    };
    let descriptor = parse(&shape);
    let quirks = Quirks::choose(0, 0, &descriptor, 10);
    assert!(quirks.has(Quirk::FixConstContactId));
    assert!(!Quirks::choose(0, 0, &parse(&Shape::default()), 10).has(Quirk::FixConstContactId));
    let mut decoder = decoder(&shape, 10);
    assert_eq!(
        ids(decoder.decode(&shape.build().encode(&fingers(2), 2, 0), 0)),
        Some(vec![3, 4])
    );
}

/// The firmware forgets to say that one of two fingers has lifted, and both.
#[test]
fn sticky_fingers() {
    let shape = Shape::default();
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let two = fingers(2);
    let mut t_us = 0;
    for _ in 0..20 {
        t_us += 8_000;
        assert_eq!(
            ids(decoder.decode(&built.encode(&two, 2, t_us / 100), t_us)),
            Some(vec![3, 4])
        );
    }
    let forgotten_us = t_us;
    while t_us < forgotten_us + 100_000 {
        t_us += 8_000;
        let frame = ids(decoder.decode(&built.encode(&two[1..], 1, t_us / 100), t_us)).unwrap();
        assert_eq!(frame.contains(&3), t_us <= forgotten_us + 100_000);
    }
    assert_eq!(decoder.tick(t_us + 100_000), None);
    assert_eq!(ids(decoder.tick(t_us + 100_001)), Some(vec![]));
    assert_eq!(decoder.counts().silent, 2);
}

/// A finger that lies still on a device that only reports changes stays down, minute after minute.
#[test]
fn a_still_finger_on_a_device_that_only_reports_changes_stays() {
    let shape = Shape {
        slots: 1,
        count_bits: None,
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let mut t_us = 0;
    for i in 0..5_000 {
        // It moves for a second, then rests for ten.
        t_us += if i % 125 == 124 { 10_000_000 } else { 8_000 };
        assert_eq!(decoder.tick(t_us - 1), None, "{i}");
        let finger = Sent::at(3, i % 4000, 7);
        assert_eq!(
            ids(decoder.decode(&built.encode(&[finger], 0, t_us / 100 % 65_536), t_us)),
            Some(vec![3])
        );
    }
    assert_eq!(decoder.tick(t_us + 600_000_000), None);
}

/// A device that was taken for one that never falls silent turns out to do so: the error is made once.
#[test]
fn who_is_given_up_wrongly_teaches_the_habit() {
    let shape = Shape::default();
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let finger = fingers(1);
    for t_us in (8_000..240_000).step_by(8_000) {
        decoder.decode(&built.encode(&finger, 1, t_us / 100), t_us);
    }
    assert_eq!(ids(decoder.tick(400_000)), Some(vec![]));
    decoder.decode(&built.encode(&finger, 1, 16_000), 1_600_000);
    assert_eq!(decoder.counts().wronged, 1);
    assert_eq!(decoder.tick(20_000_000), None);
}

#[test]
fn quirks_follow_from_the_descriptor() {
    let chosen = |shape: &Shape, max| -> Vec<&'static str> {
        Quirks::choose(0, 0, &parse(shape), max)
            .iter()
            .map(Quirk::name)
            .collect()
    };
    let windows_8 = [
        "ALWAYS_VALID",
        "CONTACT_CNT_ACCURATE",
        "IGNORE_DUPLICATES",
        "STICKY_FINGERS",
    ];
    assert_eq!(chosen(&Shape::default(), 10), windows_8);
    let old = Shape {
        scan_bits: None,
        ..Shape::default()
    };
    assert_eq!(chosen(&old, 10), ["ALWAYS_VALID", "CONTACT_CNT_ACCURATE"]);
    let countless = Shape {
        count_bits: None,
        slots: 2,
        ..Shape::default()
    };
    assert_eq!(chosen(&countless, 2), ["NOT_SEEN_MEANS_UP"]);
    assert_eq!(chosen(&countless, 4), ["ALWAYS_VALID"]);
    let nameless = Shape {
        count_bits: None,
        slots: 1,
        id_bits: 0,
        ..Shape::default()
    };
    assert_eq!(chosen(&nameless, 10), ["ALWAYS_VALID", "SLOT_IS_CONTACTNUMBER"]);
    let listed = Quirks::choose(0x25b5, 0x0002, &parse(&Shape::default()), 40);
    assert_eq!(listed, Quirks::of(&[Quirk::NotSeenMeansUp, Quirk::NoArea]));
}
