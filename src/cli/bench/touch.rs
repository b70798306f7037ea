//! Touch devices: how long one report of a large table takes.

use super::Bench;
use crate::cli::failure::Failure;
use crate::input::hid::{Decoder, Descriptor, Quirks};

/// Contacts in one report, and on the table.
const SLOTS: u8 = 10;
const CONTACTS: u8 = 240;
/// Reports in a run of the clock: one decoded report is too short to be timed.
const REPORTS: usize = 10_000;

/// Touchscreen; report 1; a slot follows.
const HEAD: [u8; 8] = [0x05, 0x0d, 0x09, 0x04, 0xa1, 0x01, 0x85, 0x01];
/// Finger: tip and confidence, padding, id of 8 bits, x and y of 16.
const SLOT: [u8; 50] = [
    0x05, 0x0d, 0x09, 0x22, 0xa1, 0x02, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x02, 0x09, 0x42, 0x09,
    0x47, 0x81, 0x02, 0x75, 0x06, 0x95, 0x01, 0x81, 0x03, 0x75, 0x08, 0x25, 0x7f, 0x09, 0x51, 0x81, 0x02,
    0x05, 0x01, 0x75, 0x10, 0x26, 0xff, 0x7f, 0x95, 0x02, 0x09, 0x30, 0x09, 0x31, 0x81, 0x02, 0xc0,
];
/// Contact count of 8 bits, scan time of 16.
const TAIL: [u8; 19] = [
    0x05, 0x0d, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x01, 0x09, 0x54, 0x81, 0x02, 0x75, 0x10, 0x09, 0x56, 0x81,
    0x02, 0xc0,
];

/// The reports of one frame, after each other.
fn frame(scan: u16) -> Vec<Vec<u8>> {
    let ids: Vec<u8> = (0..CONTACTS).collect();
    let report = |(i, ids): (usize, &[u8])| {
        let mut bytes = vec![1];
        for &id in ids {
            let x = u16::from(id) * 100 + scan % 50;
            bytes.extend([3, id]);
            bytes.extend(x.to_le_bytes());
            bytes.extend(x.to_le_bytes());
        }
        bytes.push(if i == 0 { CONTACTS } else { 0 });
        bytes.extend(scan.to_le_bytes());
        bytes
    };
    ids.chunks(SLOTS.into()).enumerate().map(report).collect()
}

impl Bench {
    /// Ten thousand reports of a table with 240 contacts.
    pub(super) fn touch(&mut self) -> Result<(), Failure> {
        let mut bytes = HEAD.to_vec();
        bytes.extend(SLOT.repeat(SLOTS.into()));
        bytes.extend(TAIL);
        let descriptor = Descriptor::parse(&bytes).map_err(Failure::other)?;
        let quirks = Quirks::choose(0, 0, &descriptor, CONTACTS.into());
        let no_touchscreen = |refusal| Failure::other(format!("expected a touchscreen, found {refusal}"));
        let mut decoder = Decoder::new(&descriptor, quirks, CONTACTS.into(), None).map_err(no_touchscreen)?;
        let frames: Vec<Vec<u8>> = (0..100).flat_map(|i| frame(i * 42)).collect();
        let mut now_us = 0;
        self.time(("hid_reports", REPORTS, "240 contacts"), None, 5, || {
            let mut most = 0;
            for report in frames.iter().cycle().take(REPORTS) {
                now_us += 170;
                most = most.max(
                    decoder
                        .decode(report, now_us)
                        .map_or(0, |frame| frame.touching.len()),
                );
            }
            most
        });
        Ok(())
    }
}
