//! What a report descriptor and the feature reports tell of a device.

use crate::hid_common;
use crate::hid_common::{FINGER, INPUT_MODE, Items, MOUSE, PEN, Sent, Shape, TOUCH_PAD, TOUCH_SCREEN, X, Y};
use glam::DVec2;
use orogen::input::hid::{Decoder, Descriptor, Quirks, Refusal};

fn parse(shape: &Shape) -> Descriptor {
    Descriptor::parse(&shape.build().bytes).expect("a descriptor")
}

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
