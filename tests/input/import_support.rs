//! Recordings in short, and what became of them in short.
use std::fmt::Write as _;

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

/// What evemu recorded, as `libinput record` would have written it: the same events and axes of one device.
pub(crate) fn as_libinput(evemu: &str, node: &str, properties: &str) -> String {
    let (mut name, mut axes, mut events) = (String::new(), String::new(), String::new());
    let mut frame_ended = true;
    for line in evemu.lines() {
        let line = line.split('#').next().unwrap_or_default();
        let words: Vec<&str> = line.split_whitespace().collect();
        let hex = |word: &str| u16::from_str_radix(word, 16).expect("hexadecimal");
        match words[..] {
            ["N:", ..] => line[2..].trim().clone_into(&mut name),
            ["A:", code, min, max, fuzz, flat, ref more @ ..] => {
                let (code, resolution) = (hex(code), more.first().unwrap_or(&"0"));
                writeln!(axes, "      {code}: [{min}, {max}, {fuzz}, {flat}, {resolution}]")
                    .expect("memory takes all");
            }
            ["E:", time, kind, code, value] => {
                let (sec, usec) = time.split_once('.').expect("a time");
                let (sec, usec): (u64, u64) = (sec.parse().expect("s"), usec.parse().expect("µs"));
                let (kind, code, value) = (hex(kind), hex(code), value.parse::<i32>().expect("a value"));
                if frame_ended {
                    events += "  - evdev:\n";
                }
                writeln!(
                    events,
                    "    - [{sec:3}, {usec:6}, {kind:3}, {code:3}, {value:7}] # EV_ABS / as it is"
                )
                .expect("memory takes all");
                frame_ended = (kind, code) == (0, 0);
            }
            _ => {}
        }
    }
    format!(
        "- node: {node}\n  evdev:\n    # Name: {name}\n    name: \"{name}\"\n    id: [3, 1386, 93, 5]\n    codes:\n      \
         0: [0, 1, 2] # EV_SYN\n    absinfo:\n{axes}    properties: [{properties}]\n  hid: [\n    0x05, 0x0d,\n    0x09, \
         0x04\n  ]\n  udev:\n    properties:\n    - ID_INPUT=1\n  quirks:\n  events:\n  # Current time is 12:34:05\n{events}"
    )
}

/// The head of a file of `libinput record`, before its devices.
pub(crate) const LIBINPUT_HEAD: &str = "# libinput record\nversion: 1\nndevices: 1\nlibinput:\n  version: \"1.22.1\"\n  git: \
                                        \"unknown\"\nsystem:\n  os: \"debian:12\"\n  kernel: \"6.1.0\"\n  dmi: \
                                        \"dmi:bvnX:bvr1:\"\ndevices:\n";
