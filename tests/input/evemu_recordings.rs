//! Small evemu recordings of every shape, and what becomes of them.

use orogen::gesture::contact::Phase;
use orogen::input::import::{ImportOptions, Imported, import_evemu};

use crate::import_support::{HEAD, at, shown};

fn import(text: &str) -> Result<Imported, String> {
    import_evemu(text.as_bytes(), "rec", &ImportOptions::default()).map_err(|error| error.to_string())
}

fn played(events: &[String]) -> (Vec<String>, Vec<String>) {
    let imported = import(&(HEAD.to_owned() + &events.concat())).expect("a recording");
    (shown(&imported.frames), imported.warnings)
}

#[test]
fn two_fingers_land_move_and_lift() {
    let text = HEAD.to_owned()
        + &at(
            1000,
            "id 7,x 1000,y 500,button 1,single 99,slot 1,id 8,x 2000,y 0700,sync",
        )
        + &at(1008, "single 3,sync")
        + &at(1016, "x 2105,slot 0,y 501,sync")
        + &at(1032, "id -001,slot 1,id -1,button 0,sync");
    let imported = import(&text).unwrap();
    assert_eq!(imported.title, "Table");
    assert_eq!(imported.size_mm.to_array(), [400.0, 300.0]);
    assert_eq!(imported.warnings, Vec::<String>::new());
    assert_eq!(
        shown(&imported.frames),
        [
            "0: down 0.0 (100,50), down 1.0 (200,70)",
            "16: move 0.0 (100,50.1), move 1.0 (210.5,70)",
            "32: up 0.0, up 1.0",
        ]
    );
}

#[test]
fn a_slot_and_an_id_are_used_again() {
    let (frames, warnings) = played(&[
        at(0, "id 7,x 1000,y 500,sync"),
        at(10, "id -1,sync"),
        // The kernel does not repeat the y that the slot has already.
        at(20, "id 7,x 1100,sync"),
        at(30, "id 9,x 1200,sync"),
        at(40, "id -1,id 9,sync"),
        at(50, "id -1,sync"),
    ]);
    assert_eq!(
        frames,
        [
            "0: down 0.0 (100,50)",
            "10: up 0.0",
            "20: down 0.1 (110,50)",
            "30: up 0.1, down 0.2 (120,50)",
            "40: up 0.2, down 0.3 (120,50)",
            "50: up 0.3",
        ]
    );
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn dropped_events_cancel_everything_until_the_next_report() {
    let (frames, warnings) = played(&[
        at(0, "id 7,x 1000,y 500,slot 1,id 8,x 2000,y 500,sync"),
        at(10, "x 2100,dropped,x 3000,y 3000,slot 0,x 3000,sync"),
        at(20, "x 1200,sync"),
        at(30, "y 600,slot 1,id -1,sync"),
        at(40, "slot 0,id -1,sync"),
    ]);
    assert_eq!(
        frames,
        [
            "0: down 0.0 (100,50), down 1.0 (200,50)",
            "10: cancel 0.0, cancel 1.0",
            // Slot 0 is heard of again, but what it read before may be wrong.
            "30: down 0.1 (120,60)",
            "40: up 0.1",
        ]
    );
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].starts_with("1 SYN_DROPPED"), "{warnings:?}");
    assert!(
        warnings[1].starts_with("1 contact(s) already down"),
        "{warnings:?}"
    );
}

#[test]
fn a_recording_may_begin_mid_touch() {
    let (frames, warnings) = played(&[
        at(0, "x 1000,sync"),
        at(10, "y 500,sync"),
        at(20, "slot 1,id -1,slot 2,id 4,x 50,sync"),
        at(30, "slot 0,id -1,slot 2,id -1,sync"),
    ]);
    assert_eq!(frames, ["0: down 0.0 (100,50)", "20: up 0.0"]);
    assert_eq!(
        warnings,
        [
            "1 contact(s) already down when the recording begins or goes on, taken to land where first seen",
            "1 contact(s) left out: no frame has them down with both coordinates",
        ]
    );
}

#[test]
fn the_description_tells_which_slot_is_meant_first() {
    let head = format!("#   Event type 3 (EV_ABS)\n#     Event code 47 (ABS_MT_SLOT)\n#  Value 3\n{HEAD}");
    let text = head + &at(0, "id 7,x 1000,y 500,sync") + &at(5, "slot 0,id 8,x 10,y 10,sync");
    let imported = import(&text).unwrap();
    assert_eq!(
        shown(&imported.frames),
        [
            "0: down 3.0 (100,50)",
            "5: down 0.0 (1,1)",
            "5: cancel 0.0, cancel 3.0"
        ]
    );
}

#[test]
fn the_end_cancels_and_half_lines_and_frames_are_left_out() {
    let text = HEAD.to_owned() + &at(0, "id 7,x 1000,y 500,sync") + &at(20, "x 1100") + "E: 1369413358.0";
    let imported = import(&text).unwrap();
    assert_eq!(
        shown(&imported.frames),
        ["0: down 0.0 (100,50)", "20: cancel 0.0"]
    );
    assert_eq!(
        imported.warnings,
        [
            "line 16: torn, left out",
            "the last frame has no SYN_REPORT, left out",
            "1 contact(s) still down at the end, cancelled",
        ]
    );
    // With its newline the line is not torn but wrong.
    let error = import(&(text + "\n")).unwrap_err();
    assert!(
        error.starts_with("rec:16: E: expected E: sec.usec type code value"),
        "{error}"
    );
}

#[test]
fn sizes_follow_the_axes_and_palms_are_no_fingers() {
    let text = HEAD.to_owned()
        + &at(
            0,
            "id 1,x 0,y 0,width 50,slot 1,id 2,x 1,y 1,major 200,minor 100,sync",
        )
        + &at(5, "turn 1,tool 2,sync")
        + &at(9, "tool 0,turn 0,sync");
    let imported = import(&text).unwrap();
    let size = |frame: usize, event: usize| {
        let contact = imported.frames[frame].events[event].contact;
        (contact.size_mm.map(|s| s.to_array()), contact.confidence)
    };
    assert_eq!(size(0, 0), (Some([5.0, 5.0]), None));
    assert_eq!(size(0, 1), (Some([10.0, 20.0]), None), "upright");
    assert_eq!(size(1, 0), (Some([20.0, 10.0]), Some(0.0)), "lying, a palm");
    assert_eq!(size(2, 0), (Some([10.0, 20.0]), None));
}

#[test]
fn sizes_in_an_unknown_unit_are_left_out() {
    let sizes = |axis: &str| -> Vec<Option<[f64; 2]>> {
        let text = HEAD.to_owned()
            + axis
            + &at(0, "id 1,x 0,y 0,major 200,sync")
            + &at(5, "major 100,sync")
            + &at(9, "x 10,sync");
        let frames = import(&text).unwrap().frames;
        let contacts = frames.iter().flat_map(|frame| &frame.events);
        let contacts = contacts.filter(|event| event.phase != Phase::Cancel);
        contacts
            .map(|e| e.contact.size_mm.map(|s| s.to_array()))
            .collect()
    };
    let [told, untold] = [[20.0, 10.0, 10.0].map(|mm| Some([mm, mm])), [None; 3]];
    assert_eq!(sizes(""), told, "as the kernel's documentation has it");
    assert_eq!(sizes("A: 30 0 4000 0 0 0\n"), told, "the longer side");
    assert_eq!(sizes("A: 30 0 5000 0 0 0\n"), told, "the diagonal");
    // A strength, and a change of it that is none of the contact.
    assert_eq!(sizes("A: 30 0 255 0 0 0\n"), untold[..2]);
    assert_eq!(sizes("A: 30 0 65535 0 0 0\n"), untold[..2]);
    let own = [40.0, 20.0, 20.0].map(|mm| Some([mm, mm]));
    assert_eq!(sizes("A: 30 0 255 0 0 5\n"), own, "its own units per mm");
    // Without a usable area of touch, the approaching finger's.
    let text = HEAD.to_owned() + "A: 30 0 255 0 0 0\n" + &at(0, "id 1,x 0,y 0,major 200,width 150,sync");
    let contact = import(&text).unwrap().frames[0].events[0].contact;
    assert_eq!(contact.size_mm.map(|s| s.to_array()), Some([15.0, 15.0]));
}

#[test]
fn range_and_size_come_from_the_options_or_the_recording() {
    let touch = at(0, "id 1,x 320,y 120,sync");
    let described = "# Event type 3 (EV_ABS)\n# Event code 53 (ABS_MT_POSITION_X)\n# Min 20\n# Max 620\n\
                     # Resolution 10\n# Event code 54 (ABS_MT_POSITION_Y)\n# Min 0\n# Max 300\n# Resolution 5\n\
                     # Properties:\n# Min 9\n";
    let axes = "A: 35 0 640 0 0\nA: 36 0 480 0 0\n";
    let options = ImportOptions {
        range: Some([0.0, 3200.0, -120.0, 1200.0]),
        size_mm: Some([100.0, 110.0].into()),
    };
    let import = |head: &str, options: &ImportOptions| {
        import_evemu((head.to_owned() + &touch).as_bytes(), "rec", options)
            .map(|i| {
                (
                    i.size_mm.to_array(),
                    i.frames[0].events[0].contact.position.to_array(),
                )
            })
            .map_err(|error| error.to_string())
    };
    let none = ImportOptions::default();
    // Lines 35 and 36 have no range of their own where the comment has one, and no resolution but the comment's.
    assert_eq!(import(described, &none), Ok(([60.0, 60.0], [30.0, 24.0])));
    assert_eq!(
        import(&(described.to_owned() + axes), &none),
        Ok(([64.0, 96.0], [32.0, 24.0]))
    );
    assert_eq!(
        import(&(described.to_owned() + axes), &options),
        Ok(([100.0, 110.0], [10.0, 20.0]))
    );
    assert_eq!(import(axes, &options), Ok(([100.0, 110.0], [10.0, 20.0])));
    assert_eq!(import("", &options), Ok(([100.0, 110.0], [10.0, 20.0])));
    let error = import("", &none).unwrap_err();
    assert!(error.starts_with("rec:2: expected a range"), "{error}");
    assert!(error.contains("--range X0,X1,Y0,Y1"), "{error}");
    let error = import(axes, &none).unwrap_err();
    assert!(error.starts_with("rec:4: expected a resolution"), "{error}");
    assert!(error.contains("--size-mm W,H"), "{error}");
    for (bad, field) in [
        (
            ImportOptions {
                range: Some([5.0, 5.0, 0.0, 1.0]),
                ..options
            },
            "--range",
        ),
        (
            ImportOptions {
                range: Some([0.0, f64::INFINITY, 0.0, 1.0]),
                ..options
            },
            "--range",
        ),
        (
            ImportOptions {
                size_mm: Some([0.0, 1.0].into()),
                ..options
            },
            "--size-mm",
        ),
        (
            ImportOptions {
                size_mm: Some([f64::NAN, 1.0].into()),
                ..options
            },
            "--size-mm",
        ),
    ] {
        let error = import("", &bad).unwrap_err();
        assert!(error.contains(&format!("{field}: expected")), "{error}");
    }
}

#[test]
fn options_win_over_what_a_recording_says_and_say_so() {
    let options = ImportOptions {
        range: Some([0.0, 640.0, 0.0, 480.0]),
        size_mm: Some([200.0, 150.0].into()),
    };
    let text = HEAD.to_owned() + &at(0, "id 1,x 320,y 120,sync,id -1,sync");
    let imported = import_evemu(text.as_bytes(), "rec", &options).unwrap();
    assert_eq!(imported.size_mm.to_array(), [200.0, 150.0]);
    let landed = imported.frames[0].events[0].contact.position;
    assert_eq!(landed.to_array(), [100.0, 37.5]);
    assert_eq!(
        imported.warnings,
        [
            "--range used in place of the recording's own",
            "--size-mm used in place of the recording's own",
        ]
    );
}

#[test]
fn what_is_no_recording_is_refused_by_line() {
    let touch = at(0, "id 1,x 320,y 120,sync");
    for (events, start, holds) in [
        (at(0, "slot 0,x 1,y 1,mt_report,sync"), "rec:14: ", "protocol A"),
        (at(0, "single 5,sync"), "rec:11: ", "only single-touch axes"),
        (at(0, "sync"), "rec:11: ", "no events of any axis"),
        (String::new(), "rec:10: ", "no events of any axis"),
        (at(0, "id 1,x 5,sync"), "rec:12: ", "only one of them"),
        (at(9, "sync") + &touch, "rec:12: ", "time: expected at least"),
        (
            at(0, "sync") + &at(32 * 86_400_000, "sync"),
            "rec:12: ",
            "31 days",
        ),
        (
            at(0, "slot -1,sync"),
            "rec:11: ",
            "ABS_MT_SLOT: expected a slot (0..=255)",
        ),
        (at(0, "slot 256,sync"), "rec:11: ", "found 256"),
        (at(0, "x 300000,y 1,sync"), "rec:13: ", "check --range"),
        ("nonsense\n".to_owned(), "rec:11: ", "line: expected N:, I:"),
        ("A: 35 0\n".to_owned(), "rec:11: ", "A: code min max"),
        ("#".repeat(200_000) + "\n", "rec:11: ", "163840 bytes"),
        ("E: 1.000000 0003 0035 ü\n".to_owned(), "rec:11: ", "found \"ü\""),
    ] {
        let error = import(&(HEAD.to_owned() + &events)).unwrap_err();
        assert!(
            error.starts_with(start) && error.contains(holds),
            "{events} {error}"
        );
        assert!(error.contains("expected") && !error.contains('\n'), "{error}");
    }
    assert!(import("").unwrap_err().starts_with("rec:1: expected"));
}

#[test]
fn what_repeats_changes_nothing() {
    let (frames, warnings) = played(&[
        at(0, "id 7,x 1000,y 500,sync"),
        at(10, "id 7,x 1000,y 500,sync"),
        at(20, "id 7,x 1001,y 500,sync"),
        at(30, "id -1,sync"),
        // Nobody is there.
        at(40, "x 5,id -1,sync"),
    ]);
    assert_eq!(
        frames,
        ["0: down 0.0 (100,50)", "20: move 0.0 (100.1,50)", "30: up 0.0"]
    );
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn what_lands_and_lifts_within_a_frame_is_left_out() {
    let (frames, warnings) = played(&[
        at(0, "id 7,x 1000,y 500,sync"),
        at(10, "id 8,id 9,x 1100,sync"),
        at(20, "id -1,id 10,x 1300,id -1,sync"),
    ]);
    assert_eq!(
        frames,
        [
            "0: down 0.0 (100,50)",
            "10: up 0.0, down 0.1 (110,50)",
            "20: up 0.1"
        ]
    );
    assert_eq!(
        warnings,
        ["2 contact(s) left out: no frame has them down with both coordinates"]
    );
}
