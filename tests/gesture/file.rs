//! Gesture files: what is read, what is refused and how, and that writing is canonical.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::{self, Read};

use glam::DVec2;
use orogen::gesture::command::{Action, Command, Mode, Tool};
use orogen::gesture::contact::{Contact, ContactKey, MAX_CONTACTS, Phase, Side, Source};
use orogen::gesture::file::{GestureFile, Header, LandChange, MAX_LINE_BYTES, MAX_LINES, read_gesture};

const HEADER: &str = r#"{"format":"orogen-gesture","version":1,"surface":{"size_mm":[1209.6,680.4]}}"#;

/// A header and lines, each with its newline.
fn file(lines: &[&str]) -> String {
    std::iter::once(&HEADER)
        .chain(lines)
        .fold(String::new(), |text, line| text + line + "\n")
}

fn read(text: &str) -> GestureFile {
    read_gesture(text.as_bytes(), "a.gesture.jsonl").unwrap_or_else(|e| panic!("{e}"))
}

/// The message with which bytes are refused.
fn refusal(bytes: &[u8]) -> String {
    match read_gesture(bytes, "a.gesture.jsonl") {
        Ok(_) => panic!("read: {}", String::from_utf8_lossy(bytes)),
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains('\n'), "{message}");
            message
        }
    }
}

fn written(file: &GestureFile) -> String {
    String::from_utf8(file.write(Vec::new()).unwrap()).unwrap()
}

const CANONICAL: &str = r#"{"format":"orogen-gesture","version":1,"title":"two \"hands\" push","surface":{"size_mm":[1209.6,680.4]},"mode":"mountain","seed":18446744073709551615,"years":5e6,"nodes":60000,"expect":{"see":"A range rises.","land_changes_at":[[300.00,340.50,1000],[-1.25,0.00,16.667]]}}
{"t":0,"down":[[1,300.00,340.00],[2,330.00,360.00]]}
{"t":16,"move":[[1,304.00,340.00]],"down":[[9,610.00,660.00,{"w":42.00,"h":30.00,"conf":0}],[10,5.00,5.00,{"conf":0.125}],[11,5.00,6.00,{"w":7.50,"h":7.50}]]}
{"t":16.667,"up":[10],"down":[[10,5.00,5.00]]}
{"t":16.667}
{"t":480,"cancel":[9,10,11]}
{"t":500.5,"up":[1,2]}
{"t":900,"do":{"tool":"slice","side":"south"}}
{"t":900,"do":[{"pause":true,"side":"north","contact":12},{"scrub":2.5e6},{"view":{"lon":-12.5,"lat":0,"zoom":2}}]}
"#;

#[test]
fn a_canonical_file_is_written_as_it_was_read() {
    let file = read(CANONICAL);
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
    assert_eq!(written(&file), CANONICAL);
}

#[test]
fn the_header_says_what_it_says() {
    let header = read(CANONICAL).header;
    assert_eq!(header.title.as_deref(), Some("two \"hands\" push"));
    assert_eq!(header.size_mm, DVec2::new(1209.6, 680.4));
    assert_eq!((header.mode, header.seed), (Mode::Mountain, Some(u64::MAX)));
    assert_eq!((header.years, header.nodes), (Some(5e6), Some(60_000)));
    let expect = header.expect.unwrap();
    assert_eq!(expect.see.as_deref(), Some("A range rises."));
    let first = LandChange {
        at: DVec2::new(300.0, 340.5),
        t_us: 1_000_000,
    };
    assert_eq!(expect.land_changes_at[0], first);
    assert!(!expect.nothing);
    let bare = read(&file(&[])).header;
    assert_eq!(bare, Header::new(DVec2::new(1209.6, 680.4)));
}

#[test]
fn moments_say_what_contacts_and_visitors_do() {
    let frames = read(CANONICAL).frames;
    let key = |id, generation| ContactKey {
        source: Source::File,
        device: 0,
        id,
        generation,
    };
    assert_eq!(frames[1].t_us, 16_000);
    let palm = frames[1].events[1];
    assert_eq!(palm.phase, Phase::Down);
    assert_eq!(
        palm.contact,
        Contact {
            key: key(9, 0),
            position: DVec2::new(610.0, 660.0),
            size_mm: Some(DVec2::new(42.0, 30.0)),
            confidence: Some(0.0),
        }
    );
    // An id that lifts and lands in one line is another contact.
    let again: Vec<_> = frames[2]
        .events
        .iter()
        .map(|e| (e.phase, e.contact.key))
        .collect();
    assert_eq!(again, [(Phase::Up, key(10, 0)), (Phase::Down, key(10, 1))]);
    // Up tells where the contact last was.
    assert_eq!(frames[5].events[0].contact.position, DVec2::new(304.0, 340.0));
    let slice = Command {
        action: Action::Tool(Tool::Slice),
        side: Some(Side::South),
        contact: None,
    };
    assert_eq!(frames[6].commands, [slice]);
    assert_eq!(frames[7].commands.len(), 3);
}

#[test]
fn any_file_is_the_same_after_writing_and_reading() {
    // Unsorted, odd decimals, keys in another order, unknown keys and words, contacts left down, CRLF.
    let text = concat!(
        r#"{"mode":"globe","surface":{"px":[1,2],"size_mm":[700,394]},"version":1.4,"format":"orogen-gesture","new":{}}"#,
        "\r\n",
        r#"{"down":[[7,1.23456,-0.001],[3,5,5,{"h":9,"az":1}]],"t":0.12345,"note":"x"}"#,
        "\r\n",
        r#"{"t":1,"move":[[7,2,2],[3,6,6]],"do":[{"dance":true},{"undo":true,"play":true}]}"#,
        "\r\n",
    );
    let first = read(text);
    assert_eq!(
        first.frames[0].events[0].contact.key.id, 3,
        "events are in canonical order"
    );
    assert_eq!(
        first.frames[0].events[0].contact.size_mm,
        Some(DVec2::new(9.0, 9.0))
    );
    assert_eq!(first.frames[0].events[1].contact.position, DVec2::new(1.23, 0.0));
    assert_eq!(first.frames[1].commands.len(), 2);
    assert_eq!(first.warnings.len(), 2, "{:?}", first.warnings);
    assert!(
        first.warnings[0].contains("\"dance\" in line 3"),
        "{:?}",
        first.warnings
    );
    let second = read(&written(&first));
    assert_eq!((&second.header, &second.frames), (&first.header, &first.frames));
    assert!(second.warnings.is_empty());
    assert_eq!(written(&second), written(&first));
}

#[test]
fn the_end_of_the_file_cancels_what_is_down() {
    let file = read(&file(&[r#"{"t":5,"down":[[2,1,1],[1,2,2]]}"#]));
    let end = file.frames.last().unwrap();
    assert_eq!(end.t_us, 5000);
    let cancelled: Vec<_> = end.events.iter().map(|e| (e.phase, e.contact.key.id)).collect();
    assert_eq!(cancelled, [(Phase::Cancel, 1), (Phase::Cancel, 2)]);
    assert_eq!(file.warnings.len(), 1);
}

#[test]
fn a_torn_last_line_is_left_out_and_the_rest_plays() {
    let whole = file(&[r#"{"t":0,"down":[[1,1,1]]}"#, r#"{"t":5,"up":[1]}"#]);
    for cut in 1..r#"{"t":5,"up":[1]}"#.len() {
        let text = &whole[..whole.len() - 1 - cut];
        let file = read(text);
        let torn = file.warnings.iter().any(|w| w.starts_with("line 3: torn"));
        assert_eq!(torn, !text.ends_with('\n'), "{text}");
        assert_eq!(
            file.frames.len(),
            2,
            "the first moment, and the cancel at the end"
        );
    }
    // Only the newline is missing: nothing is lost.
    let file = read(&whole[..whole.len() - 1]);
    assert_eq!((file.frames.len(), file.warnings.len()), (2, 0));
    // Torn within a character, or filled up by the file system.
    for rest in [&b"{\"t\":5,\"note\":\"\xc3"[..], b"{\"t\":5,\0\0\0", b"\0\0"] {
        let mut bytes = whole.clone().into_bytes();
        bytes.extend_from_slice(rest);
        let file = read_gesture(bytes.as_slice(), "x").unwrap();
        assert_eq!(file.warnings, ["line 4: torn, left out"]);
    }
}

#[test]
fn a_torn_line_with_another_after_it_is_refused() {
    let text = file(&[r#"{"t":0,"down":[[1,1"#, r#"{"t":5}"#]);
    let message = refusal(text.as_bytes());
    assert!(
        message.starts_with("a.gesture.jsonl:2: expected one JSON object, found EOF"),
        "{message}"
    );
}

#[test]
#[allow(clippy::too_many_lines, reason = "a table of cases")]
fn bad_headers_are_refused_by_field() {
    let with = |from: &str, to: &str| {
        let full = CANONICAL.lines().next().unwrap();
        assert!(full.contains(from));
        full.replace(from, to)
    };
    let cases = [
        (String::new(), "expected a header line, found an empty file"),
        ("\n".to_owned(), "expected one JSON object"),
        ("[1]\n".to_owned(), "line: expected one JSON object, found [1]"),
        (
            "{\"t\":0}\n".to_owned(),
            "format: expected \"orogen-gesture\", found nothing",
        ),
        (
            with("orogen-gesture", "kvi"),
            "format: expected \"orogen-gesture\", found \"kvi\"",
        ),
        (
            with("\"version\":1", "\"version\":2"),
            "version: expected major version 1, found 2",
        ),
        (
            with("\"version\":1", "\"version\":0.9"),
            "version: expected major version 1, found 0.9",
        ),
        (
            with("\"version\":1", "\"version\":\"1\""),
            "version: expected major version 1, found \"1\"",
        ),
        (
            with("\"version\":1,", ""),
            "version: expected major version 1, found nothing",
        ),
        (with("\"surface\"", "\"table\""), "surface: expected {\"size_mm\""),
        (
            with("{\"size_mm\":[1209.6,680.4]}", "[1,2]"),
            "surface: expected {\"size_mm\"",
        ),
        (
            with("\"size_mm\"", "\"size\""),
            "surface.size_mm: expected [width, height] in mm",
        ),
        (with("[1209.6,680.4]", "[1209.6]"), "surface.size_mm: expected"),
        (with("[1209.6,680.4]", "[0,680.4]"), "surface.size_mm: expected"),
        (with("[1209.6,680.4]", "[-5,680.4]"), "surface.size_mm: expected"),
        (
            with("[1209.6,680.4]", "[1209.6,10000]"),
            "surface.size_mm: expected",
        ),
        (
            with("[1209.6,680.4]", "[1209.6,\"680\"]"),
            "surface.size_mm: expected",
        ),
        (
            with("\"mountain\"", "\"moon\""),
            "mode: expected \"mountain\" or \"globe\", found \"moon\"",
        ),
        (
            with("18446744073709551615", "-1"),
            "seed: expected a whole number",
        ),
        (
            with("18446744073709551615", "1.5"),
            "seed: expected a whole number",
        ),
        (
            with("5e6", "-1"),
            "years: expected years (0..=1000000000), found -1",
        ),
        (with("5e6", "1.1e9"), "years: expected"),
        (
            with("60000", "15"),
            "nodes: expected a whole number (16..=4000000), found 15",
        ),
        (with("60000", "4000001"), "nodes: expected"),
        (
            with("\"two \\\"hands\\\" push\"", "7"),
            "title: expected a text, found 7",
        ),
        (
            with("\"A range rises.\"", "7"),
            "expect.see: expected a text, found 7",
        ),
        (
            with("[300.00,340.50,1000]", "[300.00,340.50]"),
            "expect.land_changes_at[0]: expected [x mm",
        ),
        (
            with("\"expect\":{", "\"expect\":{\"nothing\":true,"),
            "expect.land_changes_at: expected an empty list",
        ),
        (
            with("\"expect\":{", "\"expect\":{\"nothing\":1,"),
            "expect.nothing: expected true or false, found 1",
        ),
    ];
    for (header, says) in cases {
        let message = refusal(header.as_bytes());
        assert!(message.starts_with("a.gesture.jsonl:1: "), "{message}");
        assert!(message.contains(says), "{message}\nshould say\n{says}");
    }
}

#[test]
#[allow(clippy::too_many_lines, reason = "a table of cases")]
fn bad_moments_are_refused_by_line_and_field() {
    let good = [r#"{"t":0,"down":[[1,1,1],[2,2,2]]}"#, r#"{"t":10,"up":[2]}"#];
    let cases = [
        ("", "expected one JSON object"),
        (
            "nonsense",
            "expected one JSON object, found expected ident (column 2)",
        ),
        ("[]", "line: expected one JSON object, found []"),
        ("{} {}", "expected one JSON object, found trailing characters"),
        (r#"{"move":[]}"#, "t: expected milliseconds, found nothing"),
        (
            r#"{"t":"11"}"#,
            "t: expected milliseconds (0..=2678400000), found \"11\"",
        ),
        (r#"{"t":-1}"#, "t: expected milliseconds"),
        (r#"{"t":1e300}"#, "t: expected milliseconds"),
        (r#"{"t":1e999}"#, "found number out of range"),
        (r#"{"t":NaN}"#, "expected one JSON object"),
        (
            r#"{"t":9.999}"#,
            "t: expected at least 10 as in the line before, found 9.999",
        ),
        (
            r#"{"t":11,"down":[[1,3,3]]}"#,
            "down: expected an id that is not down, found 1, down since line 2",
        ),
        (
            r#"{"t":11,"down":[[3,3,3],[3,4,4]]}"#,
            "down: expected an id that is not down, found 3, down since line 4",
        ),
        (
            r#"{"t":11,"move":[[2,3,3]]}"#,
            "move: expected an id that is down, found 2",
        ),
        (
            r#"{"t":11,"move":[[1,3,3],[1,4,4]]}"#,
            "move: expected each id once, found 1 again",
        ),
        (r#"{"t":11,"up":[7]}"#, "up: expected an id that is down, found 7"),
        (
            r#"{"t":11,"up":[1,1]}"#,
            "up: expected an id that is down, found 1",
        ),
        (
            r#"{"t":11,"up":[1],"cancel":[1]}"#,
            "cancel: expected an id that is down, found 1",
        ),
        (
            r#"{"t":11,"up":[1],"move":[[1,2,2]]}"#,
            "move: expected an id that is down, found 1",
        ),
        (
            r#"{"t":11,"move":[[5,2,2]],"down":[[5,2,2]]}"#,
            "move: expected an id that is down, found 5",
        ),
        (r#"{"t":11,"up":1}"#, "up: expected a list of ids, found 1"),
        (
            r#"{"t":11,"up":[-1]}"#,
            "up[0]: expected an id (whole number), found -1",
        ),
        (r#"{"t":11,"up":[[1]]}"#, "up[0]: expected an id"),
        (
            r#"{"t":11,"down":{}}"#,
            "down: expected a list of [id, x, y], found {}",
        ),
        (
            r#"{"t":11,"down":[[1.5,3,3]]}"#,
            "down[0][0]: expected an id (whole number), found 1.5",
        ),
        (r#"{"t":11,"down":[[5,3]]}"#, "down[0]: expected [id, x, y] or"),
        (
            r#"{"t":11,"down":[[5,3,3,{},1]]}"#,
            "down[0]: expected [id, x, y] or",
        ),
        (
            r#"{"t":11,"down":[[5,3,null]]}"#,
            "down[0][2]: expected millimetres (-20000..=20000), found null",
        ),
        (
            r#"{"t":11,"down":[[5,20001,3]]}"#,
            "down[0][1]: expected millimetres",
        ),
        (
            r#"{"t":11,"move":[[1,3,-1e300]]}"#,
            "move[0][2]: expected millimetres",
        ),
        (r#"{"t":11,"down":[[5,inf,3]]}"#, "expected one JSON object"),
        (
            r#"{"t":11,"down":[[5,3,3,7]]}"#,
            "down[0][3]: expected an object, found 7",
        ),
        (
            r#"{"t":11,"down":[[5,3,3,{"w":-1}]]}"#,
            "down[0][3].w: expected millimetres (0..=20000), found -1",
        ),
        (
            r#"{"t":11,"down":[[5,3,3,{"h":"a"}]]}"#,
            "down[0][3].h: expected millimetres",
        ),
        (
            r#"{"t":11,"down":[[5,3,3,{"conf":2}]]}"#,
            "down[0][3].conf: expected a confidence (0..=1), found 2",
        ),
        (
            r#"{"t":11,"do":"undo"}"#,
            "do: expected an object with a word of the vocabulary",
        ),
        (
            r#"{"t":11,"do":{"speed":"fast"}}"#,
            "do.speed: expected My per second (0..=100), found \"fast\"",
        ),
        (r#"{"t":11,"do":{"tool":7}}"#, "do.tool: expected a text, found 7"),
    ];
    for (line, says) in cases {
        let text = file(&[good[0], good[1], line]);
        let message = refusal(text.as_bytes());
        assert!(message.starts_with("a.gesture.jsonl:4: "), "{message} for {line}");
        assert!(message.contains(says), "{message}\nshould say\n{says}");
        // What is complete but wrong is refused without its newline, too; what is no JSON may be torn.
        let may_be_torn = message.starts_with("a.gesture.jsonl:4: expected one JSON object");
        let unended = read_gesture(text.trim_end_matches('\n').as_bytes(), "x");
        assert_eq!(unended.is_ok(), may_be_torn, "{line}");
    }
}

#[test]
fn lines_in_another_order_are_refused() {
    let lines: Vec<&str> = CANONICAL.lines().collect();
    for i in 1..lines.len() - 1 {
        let mut swapped = lines.clone();
        swapped.swap(i, i + 1);
        let text = swapped.join("\n") + "\n";
        let same = ["{\"t\":16.667", "{\"t\":900"]
            .iter()
            .any(|t| lines[i].starts_with(t) && lines[i + 1].starts_with(t));
        assert_eq!(read_gesture(text.as_bytes(), "x").is_ok(), same, "{i}");
    }
}

#[test]
fn bytes_that_are_no_text_are_refused_with_their_column() {
    let mut bytes = file(&[]).into_bytes();
    bytes.extend_from_slice(b"{\"t\":0,\"note\":\"\xff\"}\n");
    assert_eq!(
        refusal(&bytes),
        "a.gesture.jsonl:2: expected UTF-8 text, found another byte in column 16"
    );
}

#[test]
fn there_is_room_for_so_many_contacts_and_no_more() {
    let downs = |n: usize| {
        let list: Vec<String> = (0..n).map(|i| format!("[{i},1,1]")).collect();
        format!("{{\"t\":0,\"down\":[{}]}}", list.join(","))
    };
    assert_eq!(
        read(&file(&[&downs(MAX_CONTACTS)])).frames[0].events.len(),
        MAX_CONTACTS
    );
    let message = refusal(file(&[&downs(MAX_CONTACTS + 1)]).as_bytes());
    assert!(
        message.starts_with("a.gesture.jsonl:2: down: expected at most 256 contacts"),
        "{message}"
    );
}

#[test]
fn long_lines_and_endless_files_are_refused() {
    let mut long = String::from("{\"t\":0,\"note\":\"");
    long.extend(std::iter::repeat_n('x', MAX_LINE_BYTES));
    long.push_str("\"}");
    let message = refusal(file(&["{\"t\":0}", &long]).as_bytes());
    assert!(
        message.starts_with("a.gesture.jsonl:3: expected at most 262144 bytes in a line"),
        "{message}"
    );
    // No newline ever: refused without reading on.
    assert!(
        read_gesture(io::repeat(b' '), "x")
            .unwrap_err()
            .to_string()
            .starts_with("x:1: ")
    );
    let endless = file(&[])
        .into_bytes()
        .into_iter()
        .chain(b"{\"t\":0}\n".iter().copied().cycle());
    let message = read_gesture(Bytes(endless), "x").unwrap_err().to_string();
    assert_eq!(
        message,
        format!(
            "x:{}: expected at most {MAX_LINES} lines, found more",
            MAX_LINES + 1
        )
    );
}

#[test]
fn a_file_that_cannot_be_read_on_is_refused_with_its_line() {
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::other("the stick was pulled out"))
        }
    }
    let text = file(&["{\"t\":0}"]);
    let message = read_gesture(text.as_bytes().chain(Broken), "x")
        .unwrap_err()
        .to_string();
    assert_eq!(message, "x:3: expected to read on: the stick was pulled out");
}

/// Reads from an iterator over bytes.
struct Bytes<I>(I);

impl<I: Iterator<Item = u8>> Read for Bytes<I> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut count = 0;
        for (place, byte) in buffer.iter_mut().zip(&mut self.0) {
            *place = byte;
            count += 1;
        }
        Ok(count)
    }
}
