//! Fingers, keys and mouse: device events with times, played through one connection to the X server.

use std::f64::consts::PI;
use std::fs::{self, File};
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use orogen::gesture::contact::Phase;
use orogen::gesture::file::{GestureFile, read_gesture};
use serde_json::{Value, json};

use super::display::{Display, touch_x};
use super::{At, Key};

/// Reports of the touchscreen a second.
const HZ: f64 = 120.0;

/// Fingers of a hand from its middle, pixels: an arc of thumb to little finger, as wide as a spread adult hand
/// (about 130 mm) on the table of the tests. The hand reaches upwards; [`Script::hand`] turns it.
const SPREAD: [At; 5] = [
    (-68.0, 28.0),
    (-38.0, -18.0),
    (0.0, -32.0),
    (38.0, -22.0),
    (68.0, 6.0),
];

/// A contact's doing at a moment.
#[derive(Clone, Copy, Debug)]
enum Doing {
    Down(At),
    Move(At),
    Up,
}

/// Contacts over time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Script {
    /// Seconds, contact, doing; in any order.
    events: Vec<(f64, u32, Doing)>,
    contacts: u32,
}

impl Script {
    /// A finger that lands at `from`, goes to `to` and stays down.
    pub(crate) fn hold(&mut self, start_s: f64, seconds: f64, from: At, to: At) -> u32 {
        let id = self.contacts;
        self.contacts += 1;
        self.events.push((start_s, id, Doing::Down(from)));
        let steps = (seconds * HZ).round();
        for step in 1..=steps as u32 {
            let share = f64::from(step) / steps;
            let at = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            self.events.push((start_s + share * seconds, id, Doing::Move(at)));
        }
        id
    }

    /// A finger that lands at `from`, goes to `to` and lifts.
    pub(crate) fn stroke(&mut self, start_s: f64, seconds: f64, from: At, to: At) {
        let id = self.hold(start_s, seconds, from, to);
        self.events.push((start_s + seconds, id, Doing::Up));
    }

    /// A finger that lands and lifts after `seconds` without moving.
    pub(crate) fn tap(&mut self, start_s: f64, seconds: f64, at: At) {
        let id = self.hold(start_s, 0.0, at, at);
        self.events.push((start_s + seconds, id, Doing::Up));
    }

    /// A hand of five fingers whose middle goes from `from` to `to`, fingertips ahead, and stays down.
    pub(crate) fn hand(&mut self, start_s: f64, seconds: f64, from: At, to: At) {
        let (sin, cos) = ((to.1 - from.1).atan2(to.0 - from.0) + PI / 2.0).sin_cos();
        for (x, y) in SPREAD {
            let (x, y) = (cos * x - sin * y, sin * x + cos * y);
            self.hold(start_s, seconds, (from.0 + x, from.1 + y), (to.0 + x, to.1 + y));
        }
    }

    /// Lifts what an earlier script left down: its first `contacts` fingers.
    pub(crate) fn lifting(contacts: u32) -> Self {
        let events = (0..contacts).map(|id| (0.0, id, Doing::Up)).collect();
        Self { events, contacts }
    }

    /// The contacts of a gesture file on a table of `width_px` pixels. Sizes and confidences are left out: the
    /// window is not told of them.
    pub(crate) fn of_gesture(file: &GestureFile, width_px: f64) -> Self {
        let px_per_mm = width_px / file.header.size_mm.x;
        let mut script = Self::default();
        for frame in &file.frames {
            for event in &frame.events {
                let at = event.contact.position * px_per_mm;
                let doing = match event.phase {
                    Phase::Down => Doing::Down(at.into()),
                    Phase::Move => Doing::Move(at.into()),
                    Phase::Up | Phase::Cancel => Doing::Up,
                };
                let id = event.contact.key.id as u32;
                script.events.push((frame.t_us as f64 / 1e6, id, doing));
            }
        }
        script
    }

    /// Lines for the injector, in the order of time.
    fn lines(&self, origin: At) -> Vec<Value> {
        let mut events = self.events.clone();
        events.sort_by(|a, b| a.0.total_cmp(&b.0));
        let line = |&(t, id, doing): &(f64, u32, Doing)| match doing {
            Doing::Down(at) => {
                json!({"t": t, "op": "down", "id": id, "x": at.0 + origin.0, "y": at.1 + origin.1})
            }
            Doing::Move(at) => {
                json!({"t": t, "op": "move", "id": id, "x": at.0 + origin.0, "y": at.1 + origin.1})
            }
            Doing::Up => json!({"t": t, "op": "up", "id": id}),
        };
        events.iter().map(line).collect()
    }
}

/// A gesture file of the repository.
pub(crate) fn gesture(name: &str) -> GestureFile {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("gestures/{name}.gesture.jsonl"));
    read_gesture(fs::read(&path).unwrap().as_slice(), name).unwrap()
}

/// The injector. Its connection serves a whole test, as the server's driver wants it.
pub(super) struct Fingers {
    lines: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    injector: Child,
}

impl Fingers {
    pub(super) fn start(display: &Display, folder: &Path) -> Self {
        let errors = File::options()
            .create(true)
            .append(true)
            .open(folder.join("injector.err"));
        let mut injector = display
            .command("python3")
            .arg(touch_x("touchinject.py"))
            .args(["play", "-"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(errors.unwrap())
            .spawn()
            .unwrap();
        let mut fingers = Self {
            lines: injector.stdin.take(),
            answers: BufReader::new(injector.stdout.take().unwrap()),
            injector,
        };
        // Its answer says that it is connected.
        fingers.send(&[]);
        fingers
    }

    pub(super) fn play(&mut self, script: &Script, origin: At) {
        self.send(&script.lines(origin));
    }

    pub(super) fn keys(&mut self, keys: &[Key], seconds: f64) {
        let line = |key: &Key, press: bool| json!({"op": "key", "code": *key as u32, "press": press});
        let pressed = keys.iter().map(|key| line(key, true));
        let released = keys.iter().rev().map(|key| line(key, false));
        let held = std::iter::once(json!({"op": "sleep", "s": seconds}));
        self.send(&pressed.chain(held).chain(released).collect::<Vec<_>>());
    }

    pub(super) fn drag(&mut self, from: At, to: At, seconds: f64, origin: At) {
        let steps = (seconds * HZ).round();
        let pointer = |step: u32| {
            let share = f64::from(step) / steps;
            json!({"t": share * seconds, "op": "pointer",
                "x": origin.0 + from.0 + share * (to.0 - from.0), "y": origin.1 + from.1 + share * (to.1 - from.1)})
        };
        let mut lines = vec![pointer(0), json!({"op": "button", "button": 1, "press": true})];
        lines.extend((1..=steps as u32).map(pointer));
        lines.push(json!({"op": "button", "button": 1, "press": false}));
        self.send(&lines);
    }

    /// Sends lines with times from now on, and waits until the server has processed them.
    fn send(&mut self, lines: &[Value]) {
        let start = json!({"op": "start"});
        let sync = json!({"op": "sync"});
        let all = std::iter::once(&start).chain(lines).chain(std::iter::once(&sync));
        let mut text = Vec::new();
        all.for_each(|line| writeln!(text, "{line}").unwrap());
        self.lines.as_mut().unwrap().write_all(&text).unwrap();
        let mut answer = String::new();
        self.answers.read_line(&mut answer).unwrap();
        assert_eq!(answer.trim(), "synced", "the injector ended; see injector.err");
    }
}

impl Drop for Fingers {
    fn drop(&mut self) {
        // At the end of its input the injector leaves the server tidily.
        drop(self.lines.take());
        let _ = self.injector.wait();
    }
}
