//! Times of what touch devices send.

#[path = "../tests/common/hid.rs"]
mod hid_common;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use hid_common::{Sent, Shape};
use orogen::input::hid::{Decoder, Descriptor, Quirks};

/// One report of a table with `contacts` down, in its turn of the frame's.
fn hid(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("hid_report");
    for (slots, contacts) in [(5, 5), (10, 10), (10, 240)] {
        let shape = Shape {
            slots,
            max_feature: Some(240),
            ..Shape::default()
        };
        let built = shape.build();
        let descriptor = Descriptor::parse(&built.bytes).expect("a descriptor");
        let quirks = Quirks::choose(0, 0, &descriptor, 240);
        let mut decoder = Decoder::new(&descriptor, quirks, 240, None).expect("a touchscreen");
        let sent: Vec<Sent> = (0..contacts)
            .map(|id| Sent::at(id, 16 * id as i64, 100))
            .collect();
        let reports: Vec<Vec<u8>> = (0..50).flat_map(|i| built.frame(&sent, slots, i * 80)).collect();
        let (mut next, mut now_us) = (0, 0);
        group.bench_function(
            BenchmarkId::from_parameter(format!("{contacts} contacts, {slots} slots")),
            |bencher| {
                bencher.iter(|| {
                    next = (next + 1) % reports.len();
                    now_us += 500;
                    decoder
                        .decode(&reports[next], now_us)
                        .map(|frame| frame.touching.len())
                });
            },
        );
    }
    group.finish();
}

/// Reading a descriptor, as when a table is plugged in.
fn descriptor(criterion: &mut Criterion) {
    let bytes = Shape {
        slots: 10,
        ..Shape::default()
    }
    .build()
    .bytes;
    criterion.bench_function("hid_descriptor", |bencher| {
        bencher.iter(|| Descriptor::parse(&bytes));
    });
}

criterion_group!(benches, hid, descriptor);
criterion_main!(benches);
