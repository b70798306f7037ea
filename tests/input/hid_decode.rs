//! Touchscreens of every shape: what they send, and who touches then.

use crate::hid_common::{Sent, Shape};
use glam::{DAffine2, DVec2};
use orogen::gesture::contact::{Phase, Source};
use orogen::input::hid::decode::Frame;
use orogen::input::hid::{Decoder, Descriptor, Quirks};
use orogen::input::touching::Tracker;

fn parse(shape: &Shape) -> Descriptor {
    Descriptor::parse(&shape.build().bytes).expect("a descriptor")
}

/// As Orogen would listen to it.
fn decoder(shape: &Shape, max: u32) -> Decoder {
    let descriptor = parse(shape);
    let quirks = Quirks::choose(0, 0, &descriptor, max);
    Decoder::new(&descriptor, quirks, max, None).expect("a touchscreen")
}

fn ids(frame: Option<Frame<'_>>) -> Option<Vec<u64>> {
    frame.map(|frame| frame.touching.iter().map(|t| t.id).collect())
}

fn fingers(n: u64) -> Vec<Sent> {
    (0..n).map(|i| Sent::at(i + 3, 100 * i as i64, 50)).collect()
}

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
