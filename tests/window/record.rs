//! A session that is recorded in the real window holds what its visitor did, and nothing of the show before.

use crate::window_support::fingers::Script;
use crate::window_support::{SLOW_S, Setup, Table};
use orogen::gesture::contact::Phase;
use orogen::gesture::file::read_gesture;

#[test]
fn a_recording_holds_the_visitors_fingers_alone() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("taken.gesture.jsonl");
    let setup = Setup {
        arguments: &["record", "--out", out.to_str().unwrap()],
        ..Setup::default()
    };
    // The show has hands of its own.
    let Some(mut table) = Table::start("a_recording_holds_the_visitors_fingers_alone", &setup) else {
        return;
    };
    table.wait("the show", SLOW_S, |now| {
        now.phase == "attract" && now.max_m > 500.0
    });
    let mut touch = Script::default();
    touch.stroke(0.0, 1.5, table.at(0.4, 0.5), table.at(0.55, 0.5));
    table.play(&touch);
    let now = table.wait("the stroke to end", SLOW_S, |now| {
        now.phase != "attract" && now.contacts == 0 && now.max_m > 250.0
    });
    let bytes = std::fs::read(&out).unwrap();
    let file = read_gesture(&bytes[..], "taken").unwrap();
    let events: Vec<_> = file.frames.iter().flat_map(|frame| &frame.events).collect();
    let count = |phase| events.iter().filter(|event| event.phase == phase).count();
    assert_eq!(
        (count(Phase::Down), count(Phase::Up), count(Phase::Cancel)),
        (1, 1, 0),
        "{now:?}"
    );
    assert_eq!(file.frames[0].t_us, 0);
    let from = events[0].contact.position / file.header.size_mm;
    assert!((from - glam::DVec2::new(0.4, 0.5)).length() < 0.02, "{from}");
    // The land that lies there after the show is another than the program began with.
    assert_eq!(file.header.seed, Some(2));
}
