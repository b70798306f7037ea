//! Random contacts through random legal descriptors and back.

use crate::hid_common::{Sent, Shape};
use glam::DVec2;
use orogen::input::hid::{Decoder, Descriptor, Quirks};
use proptest::prelude::*;

/// How a touchscreen may be shaped: with a count, or as many slots as contacts.
fn shapes() -> impl Strategy<Value = Shape> {
    let form = (
        proptest::option::of(1_u8..200),
        1_usize..=20,
        4_u32..=32,
        10_u32..=32,
        -500_i64..500,
        400_i64..600_000,
    );
    let has = proptest::collection::vec(any::<bool>(), 8);
    let bits = (proptest::option::of(6_u32..=16), 16_u32..=32);
    (form, has, bits).prop_map(
        |((report_id, slots, id_bits, xy_bits, low, range), has, (count, scan))| {
            let low = if xy_bits > 20 { low } else { low.max(0) };
            let high = low + range.min((1 << (xy_bits - 1)) - 501);
            Shape {
                report_id,
                slots,
                id_bits,
                xy_bits,
                x: [low, high],
                y: [low, low + (high - low) / 2 + 1],
                physical_mm: has[0].then_some([1210, 681]),
                in_range: has[1],
                confidence: has[2],
                area: has[3],
                two_positions: has[4],
                count_bits: count,
                scan_bits: has[5].then_some(scan),
                collections: has[6] || has[4],
                constant_id: has[7],
                max_feature: Some(if count.is_some() { 40 } else { slots as u8 }),
                ..Shape::default()
            }
        },
    )
}

/// Contacts of one frame: parts of the surface, and an area.
fn contacts() -> impl Strategy<Value = Vec<(u64, f64, f64, f64)>> {
    let one = (0_u64..u64::MAX, 0.0..=1.0, 0.0..=1.0, 0.0..0.1);
    proptest::collection::vec(one, 0..40)
}

fn sent(shape: &Shape, frame: &[(u64, f64, f64, f64)]) -> Vec<Sent> {
    let most = if shape.count_bits.is_some() {
        40
    } else {
        shape.slots
    };
    let mut all: Vec<Sent> = Vec::new();
    for &(id, x, y, area) in frame {
        let id = id & ((1 << shape.id_bits) - 1);
        let along = |[low, high]: [i64; 2], part: f64| low + ((high - low) as f64 * part) as i64;
        let size = ((shape.x[1] - shape.x[0]) as f64 * area) as i64;
        if all.len() < most && all.iter().all(|s| s.id != id) {
            let finger = Sent::at(id, along(shape.x, x), along(shape.y, y));
            all.push(Sent {
                w: size,
                h: size / 2,
                ..finger
            });
        }
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, ..ProptestConfig::default() })]

    #[test]
    fn what_is_sent_is_what_touches(shape in shapes(), frames in proptest::collection::vec(contacts(), 1..8)) {
        let built = shape.build();
        let descriptor = Descriptor::parse(&built.bytes).unwrap();
        let report = descriptor.touch.clone().unwrap();
        prop_assert_eq!(report.slots.len(), shape.slots);
        prop_assert_eq!(descriptor.constant_ids, shape.constant_id);
        prop_assert_eq!(report.physical_mm(), shape.physical_mm.map(|_| DVec2::new(1210.0, 681.0)));
        let max = descriptor.features.max_contacts(None);
        let quirks = Quirks::choose(0, 0, &descriptor, max);
        let mut decoder = Decoder::new(&descriptor, quirks, max, None).unwrap();
        let mut before: Vec<Sent> = Vec::new();
        for (i, frame) in frames.iter().enumerate() {
            let now = sent(&shape, frame);
            // Those that have lifted are named once more, as the rules ask, if there is room.
            let mut all = now.clone();
            let gone = |s: &&Sent| now.iter().all(|n| n.id != s.id);
            all.extend(before.iter().filter(gone).map(|s| s.lifted()));
            let counted = shape.count_bits.is_some();
            let bits = shape.count_bits.unwrap_or(0);
            prop_assume!(!counted || (all.len() <= 40 && all.len() < 1 << bits));
            let t_us = 1_000_000 + i as u64 * 10_000;
            let scan_mask = shape.scan_bits.map_or(0, |bits| (1 << bits) - 1);
            let scan = (t_us / 100) & scan_mask;
            let reports = match (counted, shape.slots) {
                (true, slots) => built.frame(&all, slots, scan),
                // One contact after the other, those that lift first.
                (false, 1) if !all.is_empty() => {
                    all.iter().rev().map(|sent| built.encode(&[*sent], 0, scan)).collect()
                }
                (false, _) => vec![built.encode(&now, 0, scan)],
            };
            let last = reports.len() - 1;
            for (k, bytes) in reports.iter().enumerate() {
                let frame = decoder.decode(bytes, t_us + k as u64);
                prop_assert_eq!(frame.is_some(), k == last || !counted);
                if k != last {
                    continue;
                }
                let Some(frame) = frame else { continue };
                prop_assert!(frame.t_us <= t_us + k as u64 && frame.t_us >= t_us);
                let mut touching = frame.touching.to_vec();
                touching.sort_by_key(|t| t.id);
                let mut expected = now.clone();
                expected.sort_by_key(|s| s.id);
                let ids: Vec<u64> = touching.iter().map(|t| t.id).collect();
                let all_ids: Vec<u64> = expected.iter().map(|s| s.id).collect();
                prop_assert_eq!(ids, all_ids);
                for (t, s) in touching.iter().zip(&expected) {
                    let x = (s.x - shape.x[0]) as f64 / (shape.x[1] - shape.x[0]) as f64;
                    let y = (s.y - shape.y[0]) as f64 / (shape.y[1] - shape.y[0]) as f64;
                    prop_assert!(t.at.distance(DVec2::new(x, y)) < 1e-9);
                    prop_assert_eq!(t.confidence, shape.confidence.then_some(1.0));
                    let tells = shape.area && shape.physical_mm.is_some() && (s.w, s.h) != (0, 0);
                    prop_assert_eq!(t.size_mm.is_some(), tells);
                    if let Some(size) = t.size_mm {
                        let w = s.w as f64 * 1210.0 / (shape.x[1] - shape.x[0]) as f64;
                        let h = s.h as f64 * 681.0 / (shape.y[1] - shape.y[0]) as f64;
                        prop_assert!(size.distance(DVec2::new(w, h)) < 1e-6);
                    }
                }
            }
            before = now;
        }
        prop_assert_eq!(decoder.counts().torn + decoder.counts().orphans + decoder.counts().miscounted, 0);
    }

    #[test]
    fn no_bytes_are_a_reason_to_panic(
        shape in shapes(),
        reports in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..120), 0..60),
    ) {
        let descriptor = Descriptor::parse(&shape.build().bytes).unwrap();
        let quirks = Quirks::choose(0, 0, &descriptor, 40);
        let mut decoder = Decoder::new(&descriptor, quirks, 40, None).unwrap();
        for (i, bytes) in reports.iter().enumerate() {
            let now_us = i as u64 * 3000;
            if let Some(frame) = decoder.decode(bytes, now_us) {
                prop_assert!(frame.touching.len() <= 256 && frame.t_us <= now_us);
            }
            decoder.tick(now_us + 1000);
        }
        let counts = decoder.counts();
        prop_assert_eq!(counts.reports + counts.other + counts.short, reports.len() as u64);
    }

    #[test]
    fn no_descriptor_is_a_reason_to_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = Descriptor::parse(&bytes);
    }

    /// A descriptor with some bytes changed is refused, or decodes whatever comes.
    #[test]
    fn a_broken_descriptor_does_no_harm(
        shape in shapes(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        report in proptest::collection::vec(any::<u8>(), 0..300),
    ) {
        let mut bytes = shape.build().bytes;
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(descriptor) = Descriptor::parse(&bytes)
            && let Ok(mut decoder) = Decoder::new(&descriptor, Quirks::choose(0, 0, &descriptor, 10), 10, None)
        {
            for i in 0..5 {
                decoder.decode(&report, i);
            }
        }
    }
}
