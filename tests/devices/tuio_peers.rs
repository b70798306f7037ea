//! Senders that others wrote, on a port of this machine: python-tuio for TUIO 1.1, and python-osc for numbered frames
//! of 1.1 and for 2.0. What they say they sent must be what arrives, frame by frame.
//!
//! They are found as `common/python.rs` says, with `tests/tuio-peers/requirements.txt`.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use glam::{DAffine2, DVec2};
use orogen::device::tuio::{TuioListener, TuioListenerOptions};
use orogen::device::{DeviceFrame, FrameQueue};
use orogen::gesture::contact::{Phase, Source};
use orogen::input::touching::Tracker;

use crate::python;

/// Senders tell places in 32 bits.
const PLACE_TOLERANCE: f64 = 1e-6;

/// Who touches where, in parts of the surface.
type State = BTreeMap<u64, DVec2>;

/// Lets a sender speak to a listener. Returns what it says it sent, what arrived, and the names of the senders heard.
fn listen(python: &Path, kind: &str) -> (Vec<State>, Vec<State>, Vec<String>) {
    let queue = FrameQueue::new(None);
    let options = TuioListenerOptions {
        address: SocketAddr::from(([127, 0, 0, 1], 0)),
        surface_mm: Some(DVec2::new(1000.0, 500.0)),
        ..TuioListenerOptions::default()
    };
    let listener = TuioListener::start(options, queue.clone()).expect("a free port");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tuio-peers/send.py");
    let output = Command::new(python)
        .arg(script)
        .args([kind, &listener.address().port().to_string()])
        .output()
        .expect("a Python that starts");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let sent: Vec<BTreeMap<u64, [f64; 2]>> =
        serde_json::from_slice(&output.stdout).expect("a list of states");
    let sent: Vec<State> = sent
        .into_iter()
        .map(|state| state.into_iter().map(|(id, place)| (id, place.into())).collect())
        .collect();

    let (mut arrived, mut names, mut new) = (Vec::new(), Vec::new(), Vec::new());
    let began = Instant::now();
    while arrived.len() < sent.len() && began.elapsed() < Duration::from_secs(10) {
        queue.drain(&mut new);
        for frame in &new {
            match frame {
                DeviceFrame::Plugged { name, .. } => names.push(name.clone()),
                DeviceFrame::State { touching, .. } => {
                    arrived.push(
                        touching
                            .iter()
                            .map(|touching| (touching.id, touching.at))
                            .collect(),
                    );
                }
                _ => {}
            }
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let counts = listener.heard().counts;
    assert_eq!(
        (counts.malformed, counts.faulty_messages, counts.no_place),
        (0, 0, 0),
        "{counts:?}"
    );
    (sent, arrived, names)
}

/// Plays states through a tracker. Returns how many contacts landed, moved and lifted.
fn play(states: &[State]) -> [usize; 3] {
    let mut tracker = Tracker::new(Source::Tuio, 0, DAffine2::from_scale(DVec2::new(1000.0, 500.0)));
    let mut events = Vec::new();
    for state in states {
        let touching: Vec<_> = state
            .iter()
            .map(|(&id, &at)| orogen::input::touching::Touching {
                id,
                at,
                size_mm: None,
                confidence: None,
            })
            .collect();
        tracker.frame(&touching, &mut events);
    }
    [Phase::Down, Phase::Move, Phase::Up]
        .map(|phase| events.iter().filter(|event| event.phase == phase).count())
}

fn assert_same(sent: &[State], arrived: &[State]) {
    assert_eq!(arrived.len(), sent.len(), "frames");
    for (i, (sent, arrived)) in sent.iter().zip(arrived).enumerate() {
        let ids = |state: &State| state.keys().copied().collect::<Vec<_>>();
        assert_eq!(ids(arrived), ids(sent), "frame {i}");
        for (id, place) in sent {
            let off = (arrived[id] - place).abs().max_element();
            assert!(
                off <= PLACE_TOLERANCE,
                "frame {i}, contact {id}: {} not {place}",
                arrived[id]
            );
        }
    }
}

#[test]
fn python_tuio_is_understood() {
    let Some(python) = python::with_modules("pythontuio, pythonosc") else {
        return;
    };
    let (sent, arrived, names) = listen(&python, "python-tuio");
    assert_same(&sent, &arrived);
    assert_eq!(names.len(), 1);
    // Two fingers, a token, a blob, and then forty fingers.
    let [down, moved, up] = play(&arrived);
    assert_eq!((down, up), (44, 44));
    assert!(moved >= 49, "{moved} moves");
}

#[test]
fn numbered_frames_are_understood() {
    let Some(python) = python::with_modules("pythontuio, pythonosc") else {
        return;
    };
    let (sent, arrived, names) = listen(&python, "numbered");
    assert_same(&sent, &arrived);
    // It began anew once, and is another device from then on.
    assert_eq!(names.len(), 2);
    assert!(names[0].starts_with("peer@127.0.0.1 from "), "{names:?}");
    let [down, moved, up] = play(&arrived);
    assert_eq!((down, up), (3, 3));
    assert!(moved >= 80, "{moved} moves");
}

#[test]
fn tuio_2_is_understood() {
    let Some(python) = python::with_modules("pythontuio, pythonosc") else {
        return;
    };
    let (sent, arrived, names) = listen(&python, "second");
    assert_same(&sent, &arrived);
    assert_eq!(names.len(), 1);
    assert!(names[0].starts_with("peer:0@127.0.0.1 from "), "{names:?}");
    let [down, moved, up] = play(&arrived);
    assert_eq!((down, up), (44, 44));
    assert!(moved >= 77, "{moved} moves");
}
