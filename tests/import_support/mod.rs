//! Recordings in short, and what became of them in short.
#![allow(dead_code, reason = "each test takes what it needs")]

use orogen::gesture::contact::{InputFrame, Phase};

/// The head of a table of 400 × 300 mm with 10 units per mm.
pub(crate) const HEAD: &str = "# EVEMU 1.3\n\nN: Table\nI: 0003 056a 005d 0005\nP: 02 00\nB: 00 0b 00\n\
                    A: 2f 0 9 0 0 0\nA: 34 0 1 0 0 0\nA: 35 0 4000 4 0 10\nA: 36 0 3000 4 0 10\n";

/// Events in short: `slot 1`, `id 5`, `x 100`, `y 100`, `sync`, …, separated by commas, at `ms`.
pub(crate) fn at(ms: u64, events: &str) -> String {
    let lines = events.split(',').map(|event| {
        let mut words = event.split_whitespace();
        let (kind, code) = match words.next().unwrap_or_default() {
            "slot" => (3, 0x2f),
            "major" => (3, 0x30),
            "minor" => (3, 0x31),
            "width" => (3, 0x32),
            "turn" => (3, 0x34),
            "x" => (3, 0x35),
            "y" => (3, 0x36),
            "tool" => (3, 0x37),
            "id" => (3, 0x39),
            "button" => (1, 0x14a),
            "single" => (3, 0),
            "mt_report" => (0, 2),
            "dropped" => (0, 3),
            "sync" => (0, 0),
            other => panic!("{other}"),
        };
        let value = words.next().unwrap_or("0");
        let (s, ms) = (ms / 1000 + 1_369_413_358, ms % 1000);
        format!("E: {s}.{ms:03}000 {kind:04x} {code:04x} {value}\t# as recorders write it\n")
    });
    lines.collect()
}

/// Frames in short: `16: up 0.0, down 0.1 (1,2)`, with slot and generation.
pub(crate) fn shown(frames: &[InputFrame]) -> Vec<String> {
    let one = |frame: &InputFrame| {
        let events = frame.events.iter().map(|event| {
            let contact = &event.contact;
            let (key, p) = (contact.key, contact.position);
            match event.phase {
                Phase::Up => format!("up {}.{}", key.id, key.generation),
                Phase::Cancel => format!("cancel {}.{}", key.id, key.generation),
                Phase::Move => format!("move {}.{} ({},{})", key.id, key.generation, p.x, p.y),
                Phase::Down => format!("down {}.{} ({},{})", key.id, key.generation, p.x, p.y),
            }
        });
        format!("{}: {}", frame.t_us / 1000, events.collect::<Vec<_>>().join(", "))
    };
    frames.iter().map(one).collect()
}
