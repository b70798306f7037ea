//! `orogen record`: what a TUIO sender does becomes a gesture file that plays.

use std::io::{BufRead as _, BufReader};
use std::net::UdpSocket;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::tuio_common::cursors;
use orogen::gesture::contact::Phase;
use orogen::gesture::file::read_gesture;

#[test]
fn fingers_of_tuio_become_a_gesture_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("taken.gesture.jsonl");
    let port = UdpSocket::bind("127.0.0.1:0")
        .and_then(|socket| socket.local_addr())
        .expect("a free port")
        .port();
    let record = |out: &std::path::Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_orogen"));
        command
            .args([
                "record",
                "--tuio",
                &port.to_string(),
                "--size-mm",
                "800,400",
                "--seconds",
                "4",
            ])
            .arg("--out")
            .arg(out);
        command
    };
    let mut child = record(&out).stderr(Stdio::piped()).spawn().expect("the program");
    let mut said = BufReader::new(child.stderr.take().expect("piped"));
    let mut line = String::new();
    said.read_line(&mut line).expect("a line");
    assert!(line.contains("listening for TUIO"), "{line}");
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    for frame in 1..=60 {
        let x = 0.25 + 0.005 * frame as f32;
        let second = (frame > 20).then_some((8, 0.5, 0.75));
        let down: Vec<_> = [(3, x, 0.5)].into_iter().chain(second).collect();
        let packet = cursors("", frame, &down);
        socket.send_to(&packet, ("127.0.0.1", port)).expect("loopback");
        thread::sleep(Duration::from_millis(10));
    }
    let lifted = cursors("", 61, &[(8, 0.5, 0.75)]);
    socket.send_to(&lifted, ("127.0.0.1", port)).expect("loopback");
    assert!(child.wait().expect("an end").success());

    let bytes = std::fs::read(&out).expect("a file");
    let file = read_gesture(&bytes[..], "taken").expect("a gesture file");
    assert_eq!(file.header.size_mm, glam::DVec2::new(800.0, 400.0));
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
    let events: Vec<_> = file.frames.iter().flat_map(|frame| &frame.events).collect();
    let count = |phase: Phase| events.iter().filter(|event| event.phase == phase).count();
    assert_eq!(
        (count(Phase::Down), count(Phase::Up), count(Phase::Cancel)),
        (2, 1, 1)
    );
    assert!(count(Phase::Move) >= 40, "{}", count(Phase::Move));
    let first = events[0].contact.position;
    assert!(
        (first - glam::DVec2::new(204.0, 200.0)).length() < 0.02,
        "{first}"
    );
    let last = file.frames.last().expect("frames").t_us;
    assert!((500_000..5_000_000).contains(&last), "{last}");

    // What is there is not overwritten.
    let refused = record(&out).output().expect("the program");
    assert_eq!(refused.status.code(), Some(2));
    assert_eq!(std::fs::read(&out).expect("a file"), bytes);
}
