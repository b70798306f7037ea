//! Every word is written and read, and refused by its path.

use super::*;

fn one_of_each() -> Vec<Action> {
    let arrow = Arrow {
        from: DVec2::new(1.25, 2.0),
        to: DVec2::new(-3.0, 4.5),
    };
    let mut all: Vec<Action> = Tool::ALL.into_iter().map(Action::Tool).collect();
    all.extend([
        Action::Mode(Mode::Mountain),
        Action::Mode(Mode::Globe),
        Action::Play,
        Action::Pause,
        Action::Speed(0.25),
        Action::Undo,
        Action::Remove { at: arrow.from },
        Action::AddArrow(arrow),
        Action::EditArrow(arrow),
        Action::FlipFault { at: arrow.to },
        Action::StartOver,
        Action::Layers("thin \"skin\"".to_owned()),
        Action::Pile(crate::rock::preset::default()),
        Action::TurnFolds {
            path: vec![arrow.from, arrow.to],
        },
        Action::RaiseFolds {
            path: vec![arrow.from, arrow.to, arrow.from],
            by: 1.5,
        },
        Action::Slice(arrow),
        Action::FreezeSlice(true),
        Action::FreezeSlice(false),
        Action::LabelSlice {
            at: 0.25,
            text: "here".to_owned(),
        },
        Action::CloseSlice,
        Action::View {
            lon: -12.5,
            lat: 80.0,
            zoom: 1.5,
        },
        Action::Earth,
        Action::Planet {
            plates: 40,
            continental: 0.3,
            seed: u64::MAX,
        },
        Action::Cut {
            path: vec![
                Place { lat: -90.0, lon: 0.1 },
                Place {
                    lat: 1e-9,
                    lon: 180.0,
                },
            ],
        },
        Action::Paint {
            at: Place {
                lat: 12.25,
                lon: -170.0,
            },
            radius_deg: 6.0,
            paint: Paint::Continent,
        },
        Action::Paint {
            at: Place { lat: 0.0, lon: 0.0 },
            radius_deg: 0.5,
            paint: Paint::Ocean,
        },
        Action::Scrub(2.5e6),
    ]);
    all
}

fn reread(json: &str) -> Result<Parsed, Expected> {
    parse(&serde_json::from_str(json).unwrap())
}

#[test]
fn every_word_comes_back_as_it_was_written() {
    for (i, action) in one_of_each().into_iter().enumerate() {
        let command = Command {
            action,
            side: [None, Some(Side::North), Some(Side::South)][i % 3],
            contact: [None, Some(u64::MAX)][i % 2],
        };
        let mut json = String::new();
        command.write_json(&mut json);
        let parsed = reread(&json).unwrap();
        assert_eq!(parsed.commands, [command], "{json}");
        assert!(parsed.unknown.is_empty());
    }
}

#[test]
fn unknown_words_and_names_are_counted_and_the_rest_is_done() {
    let parsed = reread(r#"[{"dance":1},{"tool":"rake"},{"tool":"slice","side":"south"}]"#).unwrap();
    assert_eq!(parsed.unknown, ["dance", "tool \"rake\""]);
    assert_eq!(parsed.commands.len(), 1);
    assert_eq!(parsed.commands[0].side, Some(Side::South));
}

#[test]
fn known_words_of_the_wrong_kind_are_refused_by_path() {
    for (json, field) in [
        (r#"{"tool":3}"#, "do.tool"),
        (r#"{"mode":null}"#, "do.mode"),
        (r#"{"play":1}"#, "do.play"),
        (r#"{"pause":false}"#, "do.pause"),
        (r#"{"speed":"fast"}"#, "do.speed"),
        (r#"{"speed":-1}"#, "do.speed"),
        (r#"{"remove":[1]}"#, "do.remove"),
        (r#"{"add_arrow":{"from":[0,0]}}"#, "do.add_arrow.to"),
        (
            r#"{"edit_arrow":{"from":[0,0],"to":[1e30,0]}}"#,
            "do.edit_arrow.to",
        ),
        (r#"{"layers":""}"#, "do.layers"),
        (r#"{"pile":"name = 3"}"#, "do.pile"),
        (r#"{"turn_folds":[[0,0]]}"#, "do.turn_folds"),
        (r#"{"turn_folds":[[0,0],[1]]}"#, "do.turn_folds[1]"),
        (
            r#"{"raise_folds":{"path":[[0,0],[1,1]],"by":4}}"#,
            "do.raise_folds.by",
        ),
        (r#"{"slice":{"from":[0,0]}}"#, "do.slice.to"),
        (r#"{"freeze_slice":1}"#, "do.freeze_slice"),
        (r#"{"label_slice":{"at":2,"text":"x"}}"#, "do.label_slice.at"),
        (r#"{"label_slice":{"at":1,"text":""}}"#, "do.label_slice.text"),
        (r#"{"view":{"lon":0,"lat":91,"zoom":1}}"#, "do.view.lat"),
        (r#"{"scrub":1e10}"#, "do.scrub"),
        (
            r#"{"planet":{"plates":0,"continental":0.3,"seed":1}}"#,
            "do.planet.plates",
        ),
        (
            r#"{"planet":{"plates":40,"continental":30,"seed":1}}"#,
            "do.planet.continental",
        ),
        (r#"{"planet":{"plates":40,"continental":0.3}}"#, "do.planet.seed"),
        (r#"{"cut":[[0,0]]}"#, "do.cut"),
        (r#"{"cut":[[0,0],[91,0]]}"#, "do.cut[1]"),
        (r#"{"cut":[[0,0],[0]]}"#, "do.cut[1]"),
        (
            r#"{"paint":{"at":[0,181],"radius":3,"crust":"ocean"}}"#,
            "do.paint.at",
        ),
        (
            r#"{"paint":{"at":[0,0],"radius":91,"crust":"ocean"}}"#,
            "do.paint.radius",
        ),
        (
            r#"{"paint":{"at":[0,0],"radius":3,"crust":"cheese"}}"#,
            "do.paint.crust",
        ),
        (r#"{"undo":true,"side":"east"}"#, "do.side"),
        (r#"{"undo":true,"contact":-1}"#, "do.contact"),
        (r#"[{"undo":true},{"play":2}]"#, "do[1].play"),
        ("7", "do"),
    ] {
        assert_eq!(reread(json).unwrap_err().field, field, "{json}");
    }
}
