//! The writer of gesture files: one write per line, and good files of whatever live input brings.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::io::{self, Write};

use glam::DVec2;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, MAX_CONTACTS, Phase, Source};
use orogen::gesture::file::{GestureWriter, Header, MAX_LINE_BYTES, read_gesture};

/// Keeps every `write` apart.
#[derive(Default)]
struct Writes(Vec<String>);

impl Write for Writes {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.push(String::from_utf8_lossy(bytes).into_owned());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn touch(phase: Phase, source: Source, id: u64, x: f64) -> ContactEvent {
    ContactEvent {
        phase,
        contact: Contact {
            key: ContactKey {
                source,
                device: 0,
                id,
                generation: 0,
            },
            position: DVec2::new(x, 1.0),
            size_mm: None,
            confidence: None,
        },
    }
}

fn recorded(frames: &[(u64, Vec<ContactEvent>)]) -> Vec<String> {
    let mut writer = GestureWriter::new(Writes::default(), &Header::new(DVec2::new(700.0, 394.0))).unwrap();
    for (t_us, events) in frames {
        let frame = InputFrame {
            t_us: *t_us,
            events: events.clone(),
            commands: Vec::new(),
        };
        writer.write_frame(&frame).unwrap();
    }
    let writes = writer.into_inner().unwrap().0;
    read_gesture(writes.concat().as_bytes(), "written").unwrap();
    writes
}

#[test]
fn each_line_is_one_write() {
    let writes = recorded(&[
        (0, vec![touch(Phase::Down, Source::Hid, 1, 5.0)]),
        (16_000, Vec::new()),
    ]);
    assert_eq!(
        writes,
        [
            "{\"format\":\"orogen-gesture\",\"version\":1,\"surface\":{\"size_mm\":[700,394]},\"mode\":\"mountain\"}\n",
            "{\"t\":0,\"down\":[[1,5.00,1.00]]}\n",
            "{\"t\":16}\n",
        ]
    );
}

#[test]
fn the_writer_makes_good_files_of_bad_input() {
    use Phase::{Cancel, Down, Move, Up};
    use Source::{Hid, Tuio};
    let frames = [
        (
            10_000,
            vec![
                touch(Move, Hid, 1, 1.0),
                touch(Up, Hid, 1, 1.0),
                touch(Cancel, Hid, 2, 1.0),
            ],
        ),
        (20_000, vec![touch(Down, Hid, 1, 1.0), touch(Down, Tuio, 1, 2.0)]),
        // Time runs back.
        (15_000, vec![touch(Move, Tuio, 1, 3.0)]),
        // Down twice.
        (30_000, vec![touch(Down, Hid, 1, 4.0)]),
        // Lands and lifts at once, between others.
        (
            40_000,
            vec![
                touch(Down, Hid, 5, 5.0),
                touch(Up, Hid, 5, 5.0),
                touch(Move, Hid, 1, f64::NAN),
            ],
        ),
        (
            50_000,
            vec![
                touch(Down, Hid, 6, f64::INFINITY),
                touch(Up, Hid, 1, 9.0),
                touch(Up, Tuio, 1, 9.0),
            ],
        ),
    ];
    let lines = recorded(&frames);
    let lines: Vec<&str> = lines[1..].iter().map(|line| line.trim_end()).collect();
    assert_eq!(
        lines,
        [
            r#"{"t":10}"#,
            r#"{"t":20,"down":[[0,2.00,1.00],[1,1.00,1.00]]}"#,
            r#"{"t":20,"move":[[0,3.00,1.00]]}"#,
            r#"{"t":30,"cancel":[1],"down":[[1,4.00,1.00]]}"#,
            r#"{"t":40,"down":[[5,5.00,1.00]]}"#,
            r#"{"t":40,"up":[5]}"#,
            r#"{"t":50,"up":[0,1]}"#,
        ]
    );
}

#[test]
fn a_busy_table_fits_into_a_line() {
    let mut line = String::from("{\"t\":2678400000,\"move\":[");
    for i in 0..MAX_CONTACTS {
        let id = u64::MAX - i as u64;
        let _ = write!(
            line,
            "[{id},-20000.00,-20000.00,{{\"w\":20000.00,\"h\":20000.00,\"conf\":0.123}}],"
        );
    }
    assert!(line.len() * 4 < MAX_LINE_BYTES, "{}", line.len());
}
