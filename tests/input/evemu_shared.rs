//! Recordings of real touchscreens, where they lie beside the checkout; the project ships none of them.
//!
//! They are looked for in the folder that `OROGEN_SHARED` names, else in `../shared`. Where they are missing each
//! test says so and passes, unless `OROGEN_REQUIRE_SHARED=1`.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use glam::DVec2;
use orogen::export::evemu::write_evemu;
use orogen::gesture::contact::{InputFrame, Phase};
use orogen::gesture::file::{GestureFile, Header, read_gesture};
use orogen::gesture::hand::HandTracker;
use orogen::gesture::params::GestureParams;
use orogen::input::import::{ImportError, ImportOptions, Imported, import_evemu};

/// The recording of this name, or `None` after saying that it is skipped.
fn recording(name: &str) -> Option<PathBuf> {
    let shared = std::env::var_os("OROGEN_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
        PathBuf::from,
    );
    let path = shared.join("touch/recordings").join(name);
    if path.exists() {
        return Some(path);
    }
    let required = std::env::var_os("OROGEN_REQUIRE_SHARED").is_some_and(|v| v == "1");
    assert!(
        !required,
        "OROGEN_REQUIRE_SHARED=1, but {} is missing",
        path.display()
    );
    // Past the test harness, which keeps what passing tests print to itself.
    let _ = writeln!(std::io::stderr(), "SKIPPED: {} is missing", path.display());
    None
}

fn import(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    import_evemu(
        File::open(path).expect("a readable recording"),
        "recording",
        options,
    )
}

/// Most contacts that are down at once.
fn most_down(frames: &[InputFrame]) -> usize {
    let (mut down, mut most) = (0, 0);
    for event in frames.iter().flat_map(|frame| &frame.events) {
        match event.phase {
            Phase::Down => down += 1,
            Phase::Up | Phase::Cancel => down -= 1,
            Phase::Move => {}
        }
        most = most.max(down);
    }
    assert_eq!(down, 0, "what is down at the end is cancelled");
    most
}

/// Writes the recording as a gesture file and reads it back, exports and imports it; plays it on a table of its size.
fn round_trip_and_play(imported: Imported) -> HandTracker {
    let file = GestureFile {
        header: Header::new(imported.size_mm),
        frames: imported.frames,
        warnings: Vec::new(),
    };
    let bytes = file.write(Vec::new()).expect("memory takes all");
    assert_eq!(
        read_gesture(&bytes[..], "written").expect("what was written"),
        file
    );

    let mut exported = Vec::new();
    let left_out = write_evemu(&mut exported, &imported.title, imported.size_mm, &file.frames);
    assert_eq!(left_out.expect("memory takes all"), Vec::<String>::new());
    let again = import_evemu(&exported[..], "exported", &ImportOptions::default()).expect("a recording");
    assert_eq!((again.frames, again.title), (file.frames.clone(), imported.title));

    let mut hands = HandTracker::new(GestureParams::default(), imported.size_mm);
    let mut frames = file.frames.iter().peekable();
    let end_us = file.frames.last().expect("contacts").t_us + 1_000_000;
    for t_us in (0..=end_us).step_by(16_000) {
        while let Some(frame) = frames.next_if(|frame| frame.t_us <= t_us) {
            hands.feed(frame);
        }
        hands.tick(t_us);
        hands.sanity_check().expect("whole hands");
    }
    hands.finish(end_us);
    hands.sanity_check().expect("whole hands");
    assert_eq!(hands.hands().count(), 0);
    // Fingers are fingers: none is lost as a palm, a ghost or a flicker.
    let stats = hands.stats();
    let lost = (stats.dropped_ghosts, stats.retracted, stats.bridged, stats.stuck);
    assert_eq!(lost, (0, 0, 0, 0), "{stats:?}");
    hands
}

#[test]
fn ten_fingers_on_a_large_tablet() {
    let Some(path) = recording("tablets_Wacom_DTH2242_Finger.events") else {
        return;
    };
    let imported = import(&path, &ImportOptions::default()).unwrap();
    assert_eq!(imported.title, "Wacom DTH2242 Finger");
    assert_eq!(imported.size_mm, DVec2::new(464.8, 255.6));
    assert_eq!(imported.warnings, Vec::<String>::new());
    assert_eq!(most_down(&imported.frames), 10);
    let seconds = imported.frames.last().unwrap().t_us as f64 / 1e6;
    assert!((24.0..24.5).contains(&seconds), "{seconds}");
    let first = imported.frames[0].events[0].contact;
    assert_eq!(first.position, DVec2::new(141.5, 132.6));
    assert_eq!(first.size_mm, Some(DVec2::new(12.0, 12.0)));
    let downs = imported.frames.iter().flat_map(|frame| &frame.events);
    let downs = downs.filter(|event| event.phase == Phase::Down).count();
    // 132 events of the tracking id: each contact lands and lifts once.
    assert_eq!(downs, 66);
    let stats = round_trip_and_play(imported).stats();
    assert_eq!((stats.total, stats.ignored, stats.doubled), (66, 0, 0));
    assert!(stats.hands > 0 && stats.pushes > 0, "{stats:?}");
}

#[test]
fn four_fingers_drag_on_a_small_screen() {
    let Some(path) = recording("touchscreens_EP0430M09.4-finger-drag-down.events") else {
        return;
    };
    let error = import(&path, &ImportOptions::default()).unwrap_err().to_string();
    assert!(
        error.starts_with("recording:") && error.contains("--size-mm W,H"),
        "{error}"
    );
    let options = ImportOptions {
        range: Some([0.0, 1279.0, 0.0, 767.0]),
        size_mm: Some(DVec2::new(95.0, 54.0)),
    };
    let imported = import(&path, &options).unwrap();
    assert_eq!((&imported.title[..], imported.warnings.len()), ("EP0430M09", 0));
    assert_eq!(most_down(&imported.frames), 4);
    let stats = round_trip_and_play(imported).stats();
    assert_eq!((stats.total, stats.hands, stats.pushes), (4, 1, 1), "{stats:?}");
}

#[test]
fn a_recording_without_a_head_needs_range_and_size() {
    let Some(path) = recording("tablets_Wacom_ISDv4_E6_Finger.double-center-circle.events") else {
        return;
    };
    let mut options = ImportOptions {
        range: None,
        size_mm: Some(DVec2::new(278.0, 156.0)),
    };
    let error = import(&path, &options).unwrap_err().to_string();
    assert!(error.contains("--range X0,X1,Y0,Y1"), "{error}");
    options.range = Some([0.0, 2776.0, 0.0, 1569.0]);
    let imported = import(&path, &options).unwrap();
    assert_eq!(most_down(&imported.frames), 2);
    round_trip_and_play(imported);
}

#[test]
fn single_touch_is_refused() {
    let Some(path) = recording("tablets_eGalax_Inc._USB_TouchController.events") else {
        return;
    };
    for options in [ImportOptions::default(), N_TRIG] {
        let error = import(&path, &options).unwrap_err().to_string();
        let words = "expected multi-touch events (ABS_MT_POSITION_X, ABS_MT_POSITION_Y), found only single-touch axes";
        assert!(error.contains(words), "{error}");
    }
}

/// As large as the 12-inch screens it was built into.
const N_TRIG: ImportOptions = ImportOptions {
    range: Some([0.0, 9600.0, 0.0, 7200.0]),
    size_mm: Some(DVec2::new(256.0, 192.0)),
};

#[test]
fn the_older_protocol_follows_each_finger() {
    let needs = |name: &str| {
        let path = recording(name)?;
        let error = import(&path, &ImportOptions::default()).unwrap_err().to_string();
        assert!(error.contains("give --range X0,X1,Y0,Y1"), "{error}");
        let imported = import(&path, &N_TRIG).unwrap();
        assert_eq!(imported.warnings, Vec::<String>::new());
        Some(imported)
    };
    if let Some(imported) = needs("touchscreens_N-Trig_MultiTouch.1-finger-drag-NW-SE.events") {
        let (first, last) = (imported.frames.first().unwrap(), imported.frames.last().unwrap());
        assert_eq!(most_down(&imported.frames), 1);
        let at = |frame: &InputFrame| frame.events[0].contact.position;
        // North-west to south-east, in one stroke.
        assert!(at(first).max_element() < 10.0 && at(last).min_element() > 180.0);
        let stats = round_trip_and_play(imported).stats();
        assert_eq!((stats.total, stats.hands, stats.pushes), (1, 1, 1), "{stats:?}");
    }
    if let Some(imported) = needs("touchscreens_N-Trig_MultiTouch.2-fingers-touch-release.events") {
        assert_eq!(most_down(&imported.frames), 2);
        let stats = round_trip_and_play(imported).stats();
        assert_eq!(
            (stats.total, stats.ignored, stats.doubled),
            (2, 0, 0),
            "{stats:?}"
        );
    }
}
