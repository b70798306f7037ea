//! What must hold for any bytes: run by the fuzz targets, and by `tests/fuzz_regressions.rs` on what they once found.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use orogen::gesture::command::Command;
use orogen::gesture::contact::{ContactEvent, InputFrame, MAX_CONTACTS, Phase, Source};
use orogen::gesture::file::{GestureFile, Header, read_gesture};
use orogen::gesture::hand::HandTracker;
use orogen::gesture::params::GestureParams;
use orogen::input::import::{
    ImportError, ImportOptions, Imported, import_evemu, import_hid_recorder, import_libinput, import_tuio,
};
use orogen::input::planet::{Colours, HEIGHT_RANGE_M, Heights};
use orogen::input::touching::Tracker;
use orogen::input::tuio::{MAX_SOURCES, TuioDecoder, TuioEvent, TuioOptions};
use orogen::rock::Stratigraphy;
use orogen::settings::Settings;
use orogen::sphere::Lattice;

/// Ticks of 16 ms that follow a frame, at most: enough for every timer of the hands to run out.
const TICKS_AFTER_FRAME: u64 = 40;
const TICK_US: u64 = 16_000;

/// A gesture file that is read can be written, reads back equal, is canonical from then on, and plays.
pub(crate) fn gesture_reader(bytes: &[u8]) {
    match read_gesture(bytes, "fuzz") {
        Ok(file) => {
            round_trip(&file);
            play(&file.frames, &file.header);
        }
        Err(error) => one_line(&error.to_string()),
    }
}

/// A recording of evemu is refused in one line, or is a gesture file and plays.
pub(crate) fn evemu_import(bytes: &[u8]) {
    imported(|options| import_evemu(bytes, "fuzz", options));
}

/// The same of libinput record.
pub(crate) fn libinput_import(bytes: &[u8]) {
    imported(|options| import_libinput(bytes, "fuzz", options));
}

/// The same of hid-recorder.
pub(crate) fn hid_recorder_import(bytes: &[u8]) {
    imported(|options| import_hid_recorder(bytes, "fuzz", options));
}

/// The same of captures of TUIO.
pub(crate) fn tuio_import(bytes: &[u8]) {
    imported(|options| import_tuio(bytes, "fuzz", options));
}

/// Packets of TUIO, each behind its length (two bytes), the time since the last one (a byte, whose square counts in
/// milliseconds) and its port (a byte): states are within the caps, their events well formed, and a minute after the
/// last packet nothing is down.
#[allow(
    clippy::default_trait_access,
    reason = "the fuzz targets do not depend on the crate of the type"
)]
pub(crate) fn tuio(mut bytes: &[u8]) {
    let mut decoder = TuioDecoder::new(TuioOptions {
        surface_mm: Some([1000.0, 500.0].into()),
    });
    let tracker = |device| Tracker::new(Source::Tuio, device, Default::default());
    let mut trackers: Vec<Tracker> = (0..MAX_SOURCES as u16).map(tracker).collect();
    let (mut events, mut down) = (Vec::new(), BTreeSet::new());
    let mut take = |event: TuioEvent<'_>| {
        match event {
            TuioEvent::Found { source, .. } => {
                assert_eq!(trackers[usize::from(source)].contacts().count(), 0);
            }
            TuioEvent::State { source, touching } => {
                assert!(touching.len() <= MAX_CONTACTS);
                trackers[usize::from(source)].frame(touching, &mut events);
            }
            TuioEvent::Lost { source } => trackers[usize::from(source)].cancel_all(&mut events),
        }
        for event in events.drain(..) {
            let key = event.contact.key;
            assert!(match event.phase {
                Phase::Down => down.insert(key),
                Phase::Move => down.contains(&key),
                Phase::Up | Phase::Cancel => down.remove(&key),
            });
        }
    };
    let mut t_us = 0;
    while let Some(([high, low, wait, port], rest)) = bytes.split_first_chunk() {
        let length = usize::from(u16::from_be_bytes([*high, *low])).min(rest.len());
        let (packet, after) = rest.split_at(length);
        bytes = after;
        t_us += u64::from(*wait).pow(2) * 1000;
        decoder.packet(t_us, ([127, 0, 0, 1], u16::from(*port)).into(), packet, &mut take);
        assert!(decoder.sources().count() <= MAX_SOURCES);
    }
    decoder.tick(t_us + 61_000_000, &mut take);
    assert_eq!(down.len(), 0, "contacts that nobody lifts");
}

/// What is imported is a gesture file, and plays.
fn imported(import: impl Fn(&ImportOptions) -> Result<Imported, ImportError>) {
    let given = ImportOptions {
        range: Some([0.0, 4095.0, 0.0, 4095.0]),
        size_mm: Some([600.0, 340.0].into()),
    };
    for options in [ImportOptions::default(), given] {
        match import(&options) {
            Ok(imported) => {
                let mut header = Header::new(imported.size_mm);
                header.title = Some(imported.title);
                let file = GestureFile {
                    header,
                    frames: imported.frames,
                    warnings: Vec::new(),
                };
                round_trip(&file);
                play(&file.frames, &file.header);
            }
            Err(error) => one_line(&error.to_string()),
        }
    }
}

/// A settings file is refused in one line, or can be written and reads back equal.
pub(crate) fn settings(bytes: &[u8]) {
    match Settings::parse(bytes, "fuzz") {
        Ok(settings) => {
            let written = settings.to_toml();
            let again = Settings::parse(written.as_bytes(), "again").expect("what was written can be read");
            assert_eq!(again, settings);
            assert_eq!(again.to_toml(), written);
        }
        Err(error) => one_line(&error.to_string()),
    }
}

/// The file of a pile of layers is refused in one line, or can be written and reads back equal.
pub(crate) fn pile(bytes: &[u8]) {
    match Stratigraphy::parse(bytes, "fuzz") {
        Ok(pile) => {
            let written = pile.to_toml();
            let again =
                Stratigraphy::parse(written.as_bytes(), "again").expect("what was written can be read");
            assert_eq!(again, pile);
        }
        Err(error) => one_line(&error.to_string()),
    }
}

/// An image of a planet is refused in one line, or has a height within range and a plate for every sample.
pub(crate) fn planet_image(bytes: &[u8]) {
    static LATTICE: LazyLock<Lattice> = LazyLock::new(|| Lattice::new(1_000).expect("a size within range"));
    match Heights::decode(bytes, [-11_000.0, 9_000.0]) {
        Ok(heights) => {
            let heights = heights.on(&LATTICE);
            assert_eq!(heights.len(), LATTICE.len());
            assert!(heights.iter().all(|z| HEIGHT_RANGE_M.contains(z)));
        }
        Err(error) => one_line(&error.to_string()),
    }
    match Colours::decode(bytes).and_then(|colours| colours.on(&LATTICE)) {
        Ok(plate) => {
            assert_eq!(plate.len(), LATTICE.len());
            let count = plate.iter().max().map_or(0, |&most| most + 1);
            assert!(
                (0..count).all(|number| plate.contains(&number)),
                "a plate without samples"
            );
        }
        Err(error) => one_line(&error.to_string()),
    }
}

fn one_line(error: &str) {
    assert!(error.contains("expected"), "what was expected: {error}");
    assert!(!error.contains('\n'), "one line: {error}");
}

fn round_trip(file: &GestureFile) {
    let written = file.write(Vec::new()).expect("memory takes all");
    let again = read_gesture(&written[..], "again").expect("what was written can be read");
    assert_eq!(again.header, file.header);
    assert_eq!(moments(&again.frames), moments(&file.frames));
    assert_eq!(again.warnings, Vec::<String>::new());
    let rewritten = again.write(Vec::new()).expect("memory takes all");
    assert_eq!(
        String::from_utf8_lossy(&rewritten),
        String::from_utf8_lossy(&written)
    );
}

/// All that happens at each time: per contact in its order, and the commands. (A moment in which an id lifts and
/// lands again takes two lines when it is written.)
type Moment = (BTreeMap<(Source, u16, u64), Vec<ContactEvent>>, Vec<Command>);

fn moments(frames: &[InputFrame]) -> BTreeMap<u64, Moment> {
    let mut moments: BTreeMap<u64, Moment> = BTreeMap::new();
    for frame in frames {
        let (contacts, commands) = moments.entry(frame.t_us).or_default();
        for event in &frame.events {
            let slot = event.contact.key.slot();
            contacts.entry(slot).or_default().push(*event);
        }
        commands.extend(frame.commands.iter().cloned());
    }
    moments
}

fn play(frames: &[InputFrame], header: &Header) {
    let mut hands = HandTracker::new(GestureParams::default(), header.size_mm);
    let step = |hands: &mut HandTracker, t_us| {
        hands.tick(t_us);
        hands.sanity_check().expect("whole hands");
    };
    for (i, frame) in frames.iter().enumerate() {
        hands.feed(frame);
        step(&mut hands, frame.t_us);
        let next_us = frames.get(i + 1).map_or(u64::MAX, |next| next.t_us);
        for tick in 1..=TICKS_AFTER_FRAME {
            let t_us = frame.t_us + tick * TICK_US;
            if t_us >= next_us {
                break;
            }
            step(&mut hands, t_us);
        }
    }
    hands.finish(frames.last().map_or(0, |frame| frame.t_us));
    hands.sanity_check().expect("whole hands");
    assert_eq!(hands.hands().count(), 0, "hands that stay after the end");
}
