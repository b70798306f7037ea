//! Tables that come, speak, may not be opened and go, on a bus of the test's own.

use crate::hid_common;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::hid_common::{Items, Sent, Shape, TOUCH_PAD};
use glam::DVec2;
use orogen::device::hid::{Bus, Found, Gone, HidListener, HidOptions, OpenError, Wire};
use orogen::device::{DeviceFacts, DeviceFrame};

/// What is plugged in.
#[derive(Default)]
struct Plug {
    found: Option<Found>,
    denied: bool,
    descriptor: Vec<u8>,
    most: u8,
    reports: VecDeque<Vec<u8>>,
    /// Feature reports that were set.
    told: Vec<Vec<u8>>,
    unplugged: bool,
}

type Plugs = Arc<Vec<Mutex<Plug>>>;

struct FakeBus(Plugs);

struct FakeWire(Plugs, usize);

impl Bus for FakeBus {
    fn list(&mut self) -> Vec<Found> {
        let there = self.0.iter().map(|plug| plug.lock().expect("no test panicked"));
        there
            .filter(|plug| !plug.unplugged)
            .filter_map(|plug| plug.found.clone())
            .collect()
    }

    fn open(&mut self, found: &Found) -> Result<Box<dyn Wire>, OpenError> {
        let is_it = |plug: &Mutex<Plug>| plug.lock().expect("no test panicked").found.as_ref() == Some(found);
        let at = self.0.iter().position(is_it).expect("a listed device");
        if self.0[at].lock().expect("no test panicked").denied {
            return Err(OpenError::Denied);
        }
        Ok(Box::new(FakeWire(Arc::clone(&self.0), at)))
    }
}

impl FakeWire {
    fn plug(&self) -> std::sync::MutexGuard<'_, Plug> {
        self.0[self.1].lock().expect("no test panicked")
    }
}

impl Wire for FakeWire {
    fn descriptor(&mut self, buffer: &mut [u8]) -> Result<usize, Gone> {
        let plug = self.plug();
        buffer[..plug.descriptor.len()].copy_from_slice(&plug.descriptor);
        Ok(plug.descriptor.len())
    }

    fn ask(&mut self, request: Vec<u8>) -> Option<Vec<u8>> {
        Some(vec![request[0], self.plug().most])
    }

    fn tell(&mut self, report: &[u8]) {
        self.plug().told.push(report.to_vec());
    }

    fn read(&mut self, buffer: &mut [u8], _: i32) -> Result<usize, Gone> {
        let mut plug = self.plug();
        if plug.unplugged {
            return Err(Gone);
        }
        let Some(report) = plug.reports.pop_front() else {
            drop(plug);
            std::thread::sleep(Duration::from_millis(1));
            return Ok(0);
        };
        buffer[..report.len()].copy_from_slice(&report);
        Ok(report.len())
    }
}

fn found(n: u16) -> Found {
    Found {
        path: format!("/dev/hidraw{n}"),
        name: format!("table {n}"),
        vid: 0x0eef,
        pid: n,
        usb: true,
    }
}

fn table(n: u16) -> Mutex<Plug> {
    Mutex::new(Plug {
        found: Some(found(n)),
        descriptor: Shape::default().build().bytes,
        most: 40,
        ..Plug::default()
    })
}

/// Reads until what came is enough.
fn until(listener: &HidListener, all: &mut Vec<DeviceFrame>, enough: impl Fn(&[DeviceFrame]) -> bool) {
    let mut out = Vec::new();
    while !enough(all) {
        listener.drain(&mut out);
        all.extend(out.iter().cloned());
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn listen(plugs: &Plugs) -> HidListener {
    HidListener::start(Box::new(FakeBus(Arc::clone(plugs))), HidOptions::default()).expect("a thread")
}

#[test]
fn two_tables_speak_and_one_goes_and_comes_back() {
    let plugs: Plugs = Arc::new(vec![table(1), table(2)]);
    let built = Shape::default().build();
    for plug in plugs.iter() {
        let report = built.encode(&[Sent::at(7, 100, 100)], 1, 0);
        plug.lock().expect("no test panicked").reports.push_back(report);
    }
    let listener = listen(&plugs);
    let mut all = Vec::new();
    until(&listener, &mut all, |all| all.len() == 4);
    let plugged = |device, name: &str| DeviceFrame::Plugged {
        device,
        name: name.to_owned(),
        facts: DeviceFacts {
            physical_mm: Some(DVec2::new(600.0, 340.0)),
            max_contacts: Some(40),
        },
    };
    assert!(all.contains(&plugged(0, "table 1")) && all.contains(&plugged(1, "table 2")));
    for device in 0..2 {
        let of = |frame: &&DeviceFrame| match frame {
            DeviceFrame::Plugged { device: d, .. } | DeviceFrame::State { device: d, .. } => *d == device,
            _ => false,
        };
        let frames: Vec<&DeviceFrame> = all.iter().filter(of).collect();
        let [DeviceFrame::Plugged { .. }, DeviceFrame::State { touching, .. }] = frames[..] else {
            panic!("{frames:?}");
        };
        assert_eq!(touching[0].id, 7);
    }

    plugs[0].lock().expect("no test panicked").unplugged = true;
    until(&listener, &mut all, |all| all.len() == 5);
    assert_eq!(all[4], DeviceFrame::Unplugged { device: 0 });
    plugs[0].lock().expect("no test panicked").unplugged = false;
    until(&listener, &mut all, |all| all.len() == 6);
    assert_eq!(all[5], plugged(2, "table 1"));

    // At the end all are withdrawn.
    let queue = listener.queue();
    drop(listener);
    let mut out = Vec::new();
    queue.drain(&mut out);
    assert_eq!(out.len(), 2);
    assert!(
        out.iter()
            .all(|frame| matches!(frame, DeviceFrame::Unplugged { .. }))
    );
}

#[test]
fn a_table_that_may_not_be_opened_is_told_once_and_tried_again() {
    let plugs: Plugs = Arc::new(vec![table(1)]);
    plugs[0].lock().expect("no test panicked").denied = true;
    let listener = listen(&plugs);
    let mut all = Vec::new();
    until(&listener, &mut all, |all| all.len() == 1);
    let denied = DeviceFrame::Denied {
        path: "/dev/hidraw1".to_owned(),
        vid: 0x0eef,
        pid: 1,
    };
    assert_eq!(all[0], denied);
    std::thread::sleep(Duration::from_millis(1500));
    plugs[0].lock().expect("no test panicked").denied = false;
    until(&listener, &mut all, |all| all.len() == 2);
    assert!(matches!(all[1], DeviceFrame::Plugged { .. }));
}

#[test]
fn a_touchpad_is_left_alone_and_a_touchscreen_is_made_one() {
    let plugs: Plugs = Arc::new(vec![table(1), table(2)]);
    let mut items = Items::default();
    items.open(TOUCH_PAD, 1);
    Shape::default().report(&mut items);
    items.close();
    plugs[0].lock().expect("no test panicked").descriptor = items.0;
    let mut items = Items::default();
    items.open(hid_common::TOUCH_SCREEN, 1);
    Shape::default().report(&mut items);
    items
        .item(0x84, 9)
        .fields(0xb0, hid_common::INPUT_MODE, [0, 10], 8, 1)
        .close();
    plugs[1].lock().expect("no test panicked").descriptor = items.0;
    let listener = listen(&plugs);
    let mut all = Vec::new();
    until(&listener, &mut all, |all| !all.is_empty());
    let [DeviceFrame::Plugged { name, .. }] = &all[..] else {
        panic!("{all:?}")
    };
    assert_eq!(name, "table 2");
    assert_eq!(plugs[1].lock().expect("no test panicked").told, [[9, 2]]);
    assert!(plugs[0].lock().expect("no test panicked").told.is_empty());
}

#[test]
fn a_flood_of_garbage_neither_blocks_nor_grows_the_queue() {
    let plugs: Plugs = Arc::new(vec![table(1)]);
    let built = Shape::default().build();
    let listener = listen(&plugs);
    let mut all = Vec::new();
    until(&listener, &mut all, |all| all.len() == 1);
    let mut noise = 1_u64;
    let garbage = (0..50_000).map(|_| {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let mut bytes = noise.to_le_bytes().repeat(8);
        bytes.truncate((noise >> 40) as usize % 64 + 1);
        bytes[0] = if noise >> 63 == 0 { 1 } else { (noise >> 32) as u8 };
        bytes
    });
    plugs[0].lock().expect("no test panicked").reports.extend(garbage);
    let last = built.encode(&[], 0, 0);
    plugs[0].lock().expect("no test panicked").reports.push_back(last);
    while !plugs[0].lock().expect("no test panicked").reports.is_empty() {
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_millis(20));
    let mut out = Vec::new();
    listener.drain(&mut out);
    assert!(out.len() <= orogen::device::MAX_WAITING, "{}", out.len());
}
