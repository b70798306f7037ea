//! After the start, decoding allocates nothing.

#![allow(
    unsafe_code,
    reason = "counting allocations takes an allocator, whose trait is unsafe"
)]

#[path = "common/hid.rs"]
mod hid_common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use hid_common::{Sent, Shape};
use orogen::input::hid::{Decoder, Descriptor, Quirks};

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: all is left to the system's allocator; the counter is a plain number of the thread.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // (While a thread ends its counter may be gone.)
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(work: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

#[test]
fn nothing_is_allocated_per_report() {
    assert!(
        allocations(|| drop(std::hint::black_box(vec![1_u8]))) > 0,
        "the counter counts"
    );
    let shape = Shape {
        slots: 10,
        max_feature: Some(240),
        ..Shape::default()
    };
    let built = shape.build();
    let descriptor = Descriptor::parse(&built.bytes).expect("a descriptor");
    let quirks = Quirks::choose(0, 0, &descriptor, 240);
    let mut decoder = Decoder::new(&descriptor, quirks, 240, None).expect("a touchscreen");
    let mut reports: Vec<Vec<u8>> = Vec::new();
    for frame in 0..200_u64 {
        let contacts: Vec<Sent> = (0..(frame * 37) % 240)
            .map(|id| Sent::at((id * 7 + frame / 9) % 250, id as i64, frame as i64))
            .collect();
        reports.extend(built.frame(&contacts, 10, frame * 80));
    }
    let mut most = 0;
    let count = allocations(|| {
        for (i, report) in reports.iter().enumerate() {
            let now_us = i as u64 * 400;
            most = most.max(
                decoder
                    .decode(report, now_us)
                    .map_or(0, |frame| frame.touching.len()),
            );
            decoder.tick(now_us + 200);
            decoder.decode(&report[..report.len() / 2], now_us);
        }
    });
    assert!(most >= 200, "{most}");
    assert_eq!(count, 0);
}
