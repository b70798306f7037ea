//! The settings file: what is written is read, and whatever is read is settings or one clear error.

use glam::DVec2;
use orogen::settings::{Domain, KEYS, Key, Settings, Value};
use proptest::prelude::*;

fn assert_one_clear_line(error: &str) {
    assert!(!error.contains('\n'), "{error}");
    assert!(error.starts_with("orogen.toml:"), "{error}");
    assert!(error.contains("expected"), "{error}");
    let line = error["orogen.toml:".len()..].split(':').next();
    assert!(
        line.and_then(|line| line.parse::<usize>().ok())
            .is_some_and(|line| line > 0),
        "{error}"
    );
}

#[test]
fn the_sample_file_is_the_defaults_and_documents_every_key() {
    let sample = Settings::default().to_toml();
    assert_eq!(
        Settings::parse(sample.as_bytes(), "orogen.toml"),
        Ok(Settings::default())
    );
    let lines: Vec<&str> = sample.lines().collect();
    for key in KEYS {
        let start = format!("{} = ", key.name);
        let at = lines
            .iter()
            .position(|line| line.starts_with(&start))
            .expect("the key");
        assert_eq!(lines[at - 2], format!("# {}", key.help));
        assert_eq!(lines[at - 1], format!("# Expected: {}.", key.expected()));
    }
    assert!(lines.contains(&"version = 1"));
    // The fuzzer starts from the sample file; this is also where to look at it.
    let seed = concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/seeds/settings/sample.toml");
    assert_eq!(
        std::fs::read_to_string(seed).unwrap(),
        sample,
        "write {seed} anew"
    );
    assert!(
        lines.iter().all(|line| line.len() <= 130),
        "a comment nobody reads"
    );
}

#[test]
fn a_file_with_only_comments_and_one_key_changes_only_that_key() {
    let file = "# ours\n[kiosk]\n# school classes\nidle_s = 120\n";
    let settings = Settings::parse(file.as_bytes(), "orogen.toml").unwrap();
    let mut expected = Settings::default();
    expected.kiosk.idle_s = 120.0;
    assert_eq!(settings, expected);
}

#[test]
fn a_table_without_height_has_the_windows_shape() {
    let mut settings = Settings::default();
    let size = settings.table_size_mm(DVec2::new(1920.0, 1080.0));
    assert!((size - DVec2::new(1209.6, 680.4)).length() < 1e-9);
    settings.table.height_mm = Some(700.0);
    assert_eq!(settings.table_size_mm(DVec2::new(1920.0, 1080.0)).y, 700.0);
    let map = settings.plan_map(DVec2::new(1000.0, 500.0));
    assert_eq!(map.metres_per_mm(), 200.0);
}

fn value_of(key: &Key) -> BoxedStrategy<Value> {
    match key.domain {
        Domain::Number(b) => number(b),
        Domain::NumberOr(b, _) => prop_oneof![number(b), Just(Value::Word)].boxed(),
        Domain::Switch => any::<bool>().prop_map(Value::Switch).boxed(),
        Domain::Choice(words) => prop::sample::select(words)
            .prop_map(|word| Value::Text(word.to_owned()))
            .boxed(),
        Domain::Pin => "[0-9]{4,8}".prop_map(Value::Text).boxed(),
        Domain::Text(form) => prop::sample::select(vec!["", form.example()])
            .prop_map(|text| Value::Text(text.to_owned()))
            .boxed(),
        Domain::Path => r"[^\x00-\x1f\x7f-\x9f]{0,20}".prop_map(Value::Text).boxed(),
    }
}

fn number(bound: orogen::settings::Bound) -> BoxedStrategy<Value> {
    let whole = bound.whole;
    (bound.min..=bound.max)
        .prop_map(move |number| Value::Number(if whole { number.round() } else { number }))
        .boxed()
}

fn settings() -> impl Strategy<Value = Settings> {
    let values: Vec<_> = KEYS.iter().map(value_of).collect();
    values.prop_map(|values| {
        let mut settings = Settings::default();
        for (key, value) in KEYS.iter().zip(&values) {
            assert!(key.put(&mut settings, value), "{} = {value:?}", key.path());
        }
        settings
    })
}

/// Lines as people get them wrong.
fn scribble() -> impl Strategy<Value = String> {
    let keys: Vec<String> = KEYS
        .iter()
        .flat_map(|key| [key.name.to_owned(), format!("[{}]", key.section), key.path()])
        .collect();
    let key = prop::sample::select(keys);
    let value = prop::sample::select(vec![
        "1",
        "-1",
        "75",
        "1e999",
        "nan",
        "\"auto\"",
        "\"90\"",
        "true",
        "[1]",
        "{a = 1}",
        "1979-05-27",
        "'''x",
        "0x10",
        "",
    ]);
    let line = prop_oneof![
        4 => (key.clone(), value).prop_map(|(key, value)| format!("{key} = {value}")),
        3 => key,
        1 => ".{0,12}",
    ];
    prop::collection::vec(line, 0..8).prop_map(|lines| lines.join("\n"))
}

proptest! {
    #[test]
    fn what_is_written_is_read(settings in settings()) {
        let text = settings.to_toml();
        let again = Settings::parse(text.as_bytes(), "orogen.toml");
        prop_assert_eq!(again.as_ref(), Ok(&settings), "{}", text);
        prop_assert_eq!(again.unwrap().to_toml(), text);
    }

    #[test]
    fn any_bytes_are_settings_or_one_clear_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let Err(error) = Settings::parse(&bytes, "orogen.toml") {
            assert_one_clear_line(&error.to_string());
        }
    }

    #[test]
    fn any_scribble_is_settings_or_one_clear_error(text in scribble()) {
        match Settings::parse(text.as_bytes(), "orogen.toml") {
            Ok(settings) => {
                let again = Settings::parse(settings.to_toml().as_bytes(), "orogen.toml");
                prop_assert_eq!(again, Ok(settings));
            }
            Err(error) => assert_one_clear_line(&error.to_string()),
        }
    }
}
