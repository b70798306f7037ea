//! Touchscreens of every shape: what they send, and who touches then.

mod hid_common;

use glam::{DAffine2, DVec2};
use hid_common::{FINGER, INPUT_MODE, Items, MOUSE, PEN, Sent, Shape, TOUCH_PAD, TOUCH_SCREEN, X, Y};
use orogen::gesture::contact::{Phase, Source};
use orogen::input::hid::decode::Frame;
use orogen::input::hid::{Decoder, Descriptor, Quirk, Quirks, Refusal};
use orogen::input::touching::{Touching, Tracker};

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

// --- Descriptors

#[test]
fn what_is_no_touchscreen_is_refused_with_a_reason() {
    let touchpad = |usage| {
        let mut items = Items::default();
        items.open(usage, 1);
        Shape::default().report(&mut items);
        items.close();
        Descriptor::parse(&items.0).unwrap().touch.unwrap_err()
    };
    assert_eq!(touchpad(TOUCH_PAD), Refusal::Touchpad);
    assert_eq!(touchpad(PEN), Refusal::Pen);
    assert_eq!(touchpad(MOUSE), Refusal::Mouse);
    assert_eq!(touchpad((0x01, 0x06)), Refusal::NoDigitizer);

    let mut items = Items::default();
    items
        .open(TOUCH_SCREEN, 1)
        .fields(0x80, X, [0, 100], 8, 1)
        .close();
    let nowhere = Descriptor::parse(&items.0).unwrap();
    assert_eq!(nowhere.touch.unwrap_err(), Refusal::NoPositions);
}

#[test]
fn a_touchscreen_beside_a_touchpad_and_a_mouse_is_found() {
    let mut items = Items::default();
    items
        .open(MOUSE, 1)
        .item(0x84, 9)
        .fields(0x80, X, [-127, 127], 8, 1)
        .close();
    items.open(TOUCH_PAD, 1);
    Shape {
        report_id: Some(7),
        slots: 10,
        ..Shape::default()
    }
    .report(&mut items);
    items.close().open(TOUCH_SCREEN, 1);
    Shape {
        report_id: Some(3),
        slots: 4,
        ..Shape::default()
    }
    .report(&mut items);
    items.close();
    let found = Descriptor::parse(&items.0).unwrap();
    assert_eq!(found.applications, [0x0001_0002, 0x000d_0005, 0x000d_0004]);
    let report = found.touch.unwrap();
    assert_eq!((report.id, report.slots.len()), (Some(3), 4));
}

#[test]
fn of_several_touch_reports_the_one_with_most_contact_ids_counts() {
    let mut items = Items::default();
    items.open(TOUCH_SCREEN, 1);
    for (id, slots, id_bits) in [(1, 1, 0), (2, 6, 0), (3, 2, 8), (4, 1, 8)] {
        Shape {
            report_id: Some(id),
            slots,
            id_bits,
            count_bits: None,
            ..Shape::default()
        }
        .report(&mut items);
    }
    items.close();
    let report = Descriptor::parse(&items.0).unwrap().touch.unwrap();
    assert_eq!((report.id, report.slots.len()), (Some(3), 2));
}

#[test]
fn sizes_are_in_millimetres_or_not_told() {
    let size = |physical_mm| {
        parse(&Shape {
            physical_mm,
            ..Shape::default()
        })
        .touch
        .unwrap()
        .physical_mm()
    };
    assert_eq!(size(Some([1210, 681])), Some(DVec2::new(1210.0, 681.0)));
    assert_eq!(size(None), None);
    assert_eq!(size(Some([0, 0])), None);
    assert_eq!(size(Some([3, 2])), None);
    assert_eq!(size(Some([30_000, 20_000])), None);
    assert_eq!(size(Some([2000, 40])), None);

    // Inches in hundredths.
    let mut items = Items::default();
    items
        .open(TOUCH_SCREEN, 1)
        .open(FINGER, 2)
        .fields(0x80, (0x0d, 0x42), [0, 1], 8, 1);
    items
        .item(0x64, 0x13)
        .item(0x54, 14)
        .item(0x44, 2000)
        .fields(0x80, X, [0, 999], 16, 1);
    items
        .item(0x44, 1000)
        .fields(0x80, Y, [0, 999], 16, 1)
        .close()
        .close();
    let report = Descriptor::parse(&items.0).unwrap().touch.unwrap();
    let size = report.physical_mm().unwrap();
    assert!(
        (size - DVec2::new(508.0, 254.0)).abs().max_element() < 1e-9,
        "{size}"
    );
}

#[test]
fn the_operators_millimetres_scale_the_area() {
    let shape = Shape {
        physical_mm: None,
        ..Shape::default()
    };
    let mut decoder = Decoder::new(
        &parse(&shape),
        Quirks::default(),
        10,
        Some(DVec2::new(819.0, 409.5)),
    )
    .unwrap();
    let finger = Sent {
        w: 100,
        h: 50,
        ..Sent::at(1, 0, 0)
    };
    let report = shape.build().encode(&[finger], 1, 0);
    let frame = decoder.decode(&report, 0).unwrap();
    assert_eq!(frame.touching[0].size_mm, Some(DVec2::new(20.0, 5.0)));
}

// --- Features

#[test]
fn the_most_contacts_are_asked_for_and_not_declared() {
    let features = parse(&Shape {
        max_feature: Some(60),
        ..Shape::default()
    })
    .features;
    let field = features.contact_count_max.unwrap();
    assert_eq!((field.report.id, field.report.request()), (2, vec![2, 0]));
    assert_eq!(features.max_contacts(Some(&[2, 40])), 40);
    assert_eq!(features.max_contacts(Some(&[9, 40])), 60, "another report");
    assert_eq!(features.max_contacts(Some(&[2, 0])), 60);
    assert_eq!(features.max_contacts(None), 60);
    let unsure = parse(&Shape {
        max_feature: Some(255),
        ..Shape::default()
    })
    .features;
    assert_eq!(unsure.max_contacts(Some(&[2, 255])), 10);
    assert_eq!(
        parse(&Shape {
            max_feature: None,
            ..Shape::default()
        })
        .features
        .max_contacts(None),
        10
    );

    // Reports without numbers come with a zero in front, or without.
    let bare = parse(&Shape {
        report_id: None,
        ..Shape::default()
    })
    .features;
    assert_eq!(bare.contact_count_max.unwrap().report.request(), [0, 0]);
    assert_eq!(
        (bare.max_contacts(Some(&[0, 7])), bare.max_contacts(Some(&[7]))),
        (7, 7)
    );
}

#[test]
fn the_input_mode_is_set_and_the_rest_of_its_report_stays() {
    let mut items = Items::default();
    items.open(TOUCH_SCREEN, 1);
    Shape::default().report(&mut items);
    items.close().open(hid_common::CONFIGURATION, 1).item(0x84, 4);
    items.fields(0xb0, INPUT_MODE, [0, 10], 4, 1);
    items.fields(0xb0, hid_common::DEVICE_IDENTIFIER, [0, 10], 4, 1);
    items
        .item(0x84, 5)
        .fields(0xb0, INPUT_MODE, [0, 10], 8, 1)
        .close();
    let features = Descriptor::parse(&items.0).unwrap().features;
    assert_eq!(features.input_mode.unwrap().report.request(), [4, 0]);
    assert_eq!(features.set_touch_mode(Some(&[4, 0x71])), Some(vec![4, 0x72]));
    assert_eq!(features.set_touch_mode(None), Some(vec![4, 0x02]));
    assert_eq!(parse(&Shape::default()).features.set_touch_mode(None), None);
}

// --- Packing

#[test]
fn parallel_one_report_is_the_frame() {
    let shape = Shape {
        slots: 10,
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let three = fingers(3);
    assert_eq!(
        ids(decoder.decode(&built.encode(&three, 3, 0), 0)),
        Some(vec![3, 4, 5])
    );
    let one_lifts = [three[0].lifted(), three[1], three[2]];
    assert_eq!(
        ids(decoder.decode(&built.encode(&one_lifts, 3, 80), 8_000)),
        Some(vec![4, 5])
    );
    assert_eq!(
        ids(decoder.decode(&built.encode(&[], 0, 160), 16_000)),
        Some(vec![])
    );
    assert_eq!(decoder.counts().frames, 3);
}

#[test]
fn hybrid_the_frame_is_over_when_all_are_named() {
    let shape = Shape {
        slots: 2,
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let five = fingers(5);
    let [a, b, c] = &built.frame(&five, 2, 10)[..] else {
        panic!("three reports")
    };
    assert_eq!(ids(decoder.decode(a, 1_000)), None);
    assert_eq!(ids(decoder.decode(b, 1_100)), None);
    let frame = decoder.decode(c, 1_200).unwrap();
    assert_eq!((frame.t_us, frame.touching.len()), (1_000, 5));
}

#[test]
fn hybrid_a_lost_beginning_leaves_the_state_and_a_lost_end_is_made_up_for() {
    let shape = Shape {
        slots: 2,
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let four = fingers(4);
    for report in built.frame(&four, 2, 10) {
        decoder.decode(&report, 1_000);
    }
    let [_, end] = &built.frame(&four, 2, 90)[..] else {
        panic!("two reports")
    };
    assert_eq!(decoder.decode(end, 9_000), None);
    assert_eq!(decoder.counts().orphans, 1);
    let [begin, _] = &built.frame(&four, 2, 170)[..] else {
        panic!("two reports")
    };
    assert_eq!(decoder.decode(begin, 17_000), None);
    let [begin, end] = &built.frame(&four, 2, 250)[..] else {
        panic!("two reports")
    };
    assert_eq!(decoder.decode(begin, 25_000), None);
    assert_eq!(ids(decoder.decode(end, 25_100)), Some(vec![3, 4, 5, 6]));
    assert_eq!((decoder.counts().torn, decoder.counts().frames), (1, 2));
}

/// A count that is wrong must not spoil what follows.
#[test]
fn counts_that_cannot_be_or_never_come_true_do_not_block_the_table() {
    let shape = Shape {
        slots: 2,
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 4);
    let two = fingers(2);
    assert_eq!(
        ids(decoder.decode(&built.encode(&two, 200, 0), 0)),
        Some(vec![3, 4])
    );
    assert_eq!(decoder.counts().miscounted, 1);
    let frames = (1..20).filter(|i| {
        decoder
            .decode(&built.encode(&two, 4, i * 80), i * 8_000)
            .is_some()
    });
    assert_eq!(frames.count(), 16);
    assert_eq!(
        ids(decoder.decode(&built.encode(&[two[0].lifted()], 1, 2000), 200_000)),
        Some(vec![4])
    );
}

#[test]
fn a_count_that_is_never_told_counts_as_missing() {
    let shape = Shape::default();
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    assert_eq!(
        ids(decoder.decode(&built.encode(&fingers(2), 0, 0), 0)),
        Some(vec![3, 4])
    );
}

#[test]
fn serial_each_report_tells_of_one_contact() {
    let shape = Shape {
        slots: 1,
        count_bits: None,
        scan_bits: None,
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let two = fingers(2);
    let mut send = |sent: Sent, t| ids(decoder.decode(&built.encode(&[sent], 0, 0), t));
    assert_eq!(send(two[0], 0), Some(vec![3]));
    assert_eq!(send(two[1], 1_000), Some(vec![3, 4]));
    assert_eq!(send(two[0].lifted(), 2_000), Some(vec![4]));
    assert_eq!(send(two[1].lifted(), 3_000), Some(vec![]));
}

#[test]
fn without_a_count_several_slots_are_the_whole_state() {
    let shape = Shape {
        slots: 2,
        count_bits: None,
        scan_bits: None,
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 2);
    let two = fingers(2);
    assert_eq!(
        ids(decoder.decode(&built.encode(&two, 0, 0), 0)),
        Some(vec![3, 4])
    );
    assert_eq!(
        ids(decoder.decode(&built.encode(&two[1..], 0, 0), 1)),
        Some(vec![4])
    );
    // An empty slot says tip off and id 0, which is no lift of contact 0.
    let zero = Sent::at(0, 5, 5);
    assert_eq!(
        ids(decoder.decode(&built.encode(&[zero], 0, 0), 2)),
        Some(vec![0])
    );
}

#[test]
fn other_reports_short_and_long_ones_are_counted() {
    let shape = Shape::default();
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let mut report = built.encode(&fingers(1), 1, 0);
    assert_eq!(decoder.decode(&report[..9], 0), None);
    assert_eq!(decoder.decode(&[], 0), None);
    assert_eq!(decoder.decode(&[9; 60], 0), None);
    report.extend([0xff; 20]);
    assert_eq!(ids(decoder.decode(&report, 0)), Some(vec![3]));
    let counts = decoder.counts();
    assert_eq!((counts.short, counts.other, counts.reports), (1, 2, 1));
}

#[test]
fn two_positions_the_touched_point_counts() {
    let shape = Shape {
        two_positions: true,
        area: false,
        ..Shape::default()
    };
    let descriptor = parse(&shape);
    let report = descriptor.touch.as_ref().unwrap();
    assert_eq!(report.slots.len(), 5);
    assert_eq!(report.slots[0].y.bits.start - report.slots[0].x.bits.start, 32);
}

#[test]
fn coordinates_beyond_the_surface_leave_the_finger_where_it_was() {
    let shape = Shape {
        x: [-100, 900],
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let frame = decoder
        .decode(&built.encode(&[Sent::at(1, -100, 4095)], 1, 0), 0)
        .unwrap();
    assert_eq!(frame.touching[0].at, DVec2::new(0.0, 1.0));
    let frame = decoder
        .decode(
            &built.encode(&[Sent::at(1, -32_000, 0), Sent::at(2, 950, 0)], 2, 0),
            0,
        )
        .unwrap();
    assert_eq!(frame.touching[0].at, DVec2::new(0.0, 1.0));
    assert_eq!(frame.touching[1].at, DVec2::new(1.05, 0.0));
    assert_eq!(decoder.counts().no_contact, 1);
}

// --- Palms, unplugging

#[test]
fn a_palm_is_shown_as_one_before_it_is_gone() {
    let shape = Shape::default();
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let finger = fingers(1)[0];
    let unsure = Sent {
        confidence: false,
        ..finger
    };
    let tells = |frame: Option<Frame<'_>>| frame.unwrap().touching.first().map(|t| t.confidence);
    // Before a device has been sure once, its doubts mean nothing.
    assert_eq!(
        tells(decoder.decode(&built.encode(&[unsure], 1, 0), 0)),
        Some(None)
    );
    assert_eq!(
        tells(decoder.decode(&built.encode(&[finger], 1, 80), 8_000)),
        Some(Some(1.0))
    );
    assert_eq!(
        tells(decoder.decode(&built.encode(&[unsure], 1, 160), 16_000)),
        Some(Some(0.0))
    );
    assert_eq!(
        tells(decoder.decode(&built.encode(&[finger], 1, 240), 24_000)),
        Some(Some(1.0))
    );
    assert_eq!(
        tells(decoder.decode(&built.encode(&[unsure.lifted()], 1, 320), 32_000)),
        Some(Some(0.0))
    );
    assert_eq!(tells(decoder.tick(36_000)), None);
    assert_eq!(decoder.tick(40_000), None);
}

#[test]
fn unplugging_cancels_and_plugging_in_starts_afresh() {
    let shape = Shape {
        slots: 2,
        ..Shape::default()
    };
    let built = shape.build();
    let mut decoder = decoder(&shape, 10);
    let mut tracker = Tracker::new(Source::Hid, 0, DAffine2::IDENTITY);
    let mut out = Vec::new();
    tracker.frame(
        decoder
            .decode(&built.encode(&fingers(2), 2, 0), 0)
            .unwrap()
            .touching,
        &mut out,
    );
    // In the middle of a frame.
    assert_eq!(decoder.decode(&built.encode(&fingers(2), 4, 80), 8_000), None);
    decoder.clear();
    tracker.cancel_all(&mut out);
    let phases: Vec<Phase> = out.iter().map(|e| e.phase).collect();
    assert_eq!(phases, [Phase::Down, Phase::Down, Phase::Cancel, Phase::Cancel]);
    assert_eq!(
        ids(decoder.decode(&built.encode(&fingers(1), 1, 9), 9_000_000)),
        Some(vec![3])
    );
    assert_eq!(decoder.counts().torn, 0);
}

// --- Quirks, by name

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
