//! The fold and the slice tool, driven as a table drives them: several people, contacts over controls, fingers that are
//! withdrawn half-way.

use crate::instrument_support::{SIZE_MM, Table, contact, params};
use glam::DVec2;
use orogen::gesture::command::{self, Action, Command, MAX_RAISE, Mode, PATH_POINTS, Tool};
use orogen::gesture::contact::{Phase, Side};
use orogen::instrument::{ControlKind, Deed, InstrumentParams, Key, Route};
use orogen::surface::Cut;
use proptest::prelude::*;

const A: DVec2 = DVec2::new(400.0, 420.0);
const B: DVec2 = DVec2::new(800.0, 440.0);

fn commands(table: &mut Table) -> Vec<Command> {
    let deeds = table.instrument.drain().into_iter();
    deeds
        .map(|deed| match deed {
            Deed::Command(command) => command,
            other => panic!("{other:?}"),
        })
        .collect()
}

/// A table whose sides have taken these tools.
fn with_tools(tools: &[(Side, Tool)]) -> Table {
    let mut table = Table::new();
    for &(side, tool) in tools {
        table.tap(90, table.place(side, ControlKind::Tool(tool)));
    }
    table.instrument.drain();
    table
}

/// A finger goes from one place to another in so many looks.
fn drag(table: &mut Table, id: u64, to: DVec2, looks: u32) {
    let from = table
        .instrument
        .strokes()
        .first()
        .map_or(to, |stroke| stroke[stroke.len() - 1]);
    for step in 1..=looks {
        table.shift(id, from.lerp(to, f64::from(step) / f64::from(looks)));
        table.wait(16);
    }
}

/// The session has taken over what a side has sent.
fn answer(table: &mut Table, sent: &Command) {
    let Action::Slice(ends) = sent.action else {
        panic!("{sent:?}");
    };
    let side = sent.side.expect("a side");
    table.set.cuts[side as usize] = Some(Cut {
        ends: [ends.from, ends.to].map(|end| table.set.map.to_plan(end)),
        frozen: false,
        notes: Vec::new(),
    });
    table.wait(16);
}

fn ends(command: &Command) -> [DVec2; 2] {
    match command.action {
        Action::Slice(ends) => [ends.from, ends.to],
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn a_control_takes_its_tool_up_and_lays_it_down() {
    let mut table = Table::new();
    for tool in [Tool::Fold, Tool::Slice, Tool::Edit] {
        let at = table.place(Side::South, ControlKind::Tool(tool));
        table.tap(1, at);
        assert_eq!(table.instrument.tool(Side::South), tool);
        assert_eq!(table.instrument.tool(Side::North), Tool::Push);
        let lit = |table: &Table| {
            let controls = table.instrument.controls();
            let lit = controls
                .iter()
                .filter(|c| c.on && matches!(c.kind, ControlKind::Tool(_)));
            lit.map(|c| c.kind).collect::<Vec<_>>()
        };
        assert_eq!(lit(&table), [ControlKind::Tool(tool)]);
        table.tap(1, at);
        assert_eq!(lit(&table), []);
        let done: Vec<Action> = commands(&mut table).into_iter().map(|c| c.action).collect();
        assert_eq!(done, [Action::Tool(tool), Action::Tool(Tool::Push)]);
    }
}

#[test]
fn a_line_turns_folds_when_it_lifts_and_its_handle_raises_them_live() {
    for (side, up) in [(Side::South, -1.0), (Side::North, 1.0)] {
        let mut table = with_tools(&[(side, Tool::Fold)]);
        let place = |p: DVec2| if side == Side::South { p } else { SIZE_MM - p };
        assert_eq!(table.down(1, place(A)), Route::Tool);
        drag(&mut table, 1, place(B), 40);
        assert_eq!(commands(&mut table), [], "nothing before it lifts");
        table.up(1);
        let turned = commands(&mut table);
        let [
            Command {
                action: Action::TurnFolds { path },
                contact: Some(1),
                ..
            },
        ] = &turned[..]
        else {
            panic!("{turned:?}");
        };
        assert_eq!(turned[0].side, Some(side));
        assert!(path[0].distance(place(A)) < 0.01 && path[path.len() - 1].distance(place(B)) < 0.01);
        let middle = table.instrument.fold_handles().next().expect("a handle").at;
        assert!(middle.distance(place(A).midpoint(place(B))) < 0.1);
        // Fast, and then far past the greatest factor.
        table.down(2, middle);
        for step in 1..=60 {
            table.shift(2, middle + DVec2::new(0.0, up * f64::from(step)));
            table.wait(16);
        }
        let sent = commands(&mut table);
        assert!((10..=21).contains(&sent.len()), "{} in a second", sent.len());
        table.shift(2, middle + DVec2::new(0.0, up * 70.0));
        table.up(2);
        let last = commands(&mut table);
        let [
            Command {
                action: Action::RaiseFolds { path: raised, by },
                contact: Some(2),
                ..
            },
        ] = &last[..]
        else {
            panic!("{last:?}");
        };
        assert_eq!((raised, *by), (path, 2.75));
        // A tap elsewhere lets it go; the land has had nothing of all that.
        table.tap(3, place(B + DVec2::new(0.0, 60.0)));
        assert_eq!(table.instrument.fold_handles().count(), 0);
        assert_eq!(commands(&mut table), []);
    }
}

#[test]
fn a_line_that_is_withdrawn_or_a_palm_turns_nothing() {
    let mut table = with_tools(&[(Side::South, Tool::Fold)]);
    table.down(1, A);
    drag(&mut table, 1, B, 20);
    table.cancel(1);
    table.down(2, A);
    drag(&mut table, 2, B, 20);
    let mut palm = contact(2, B);
    palm.size_mm = Some(DVec2::splat(60.0));
    table.event(Phase::Move, palm);
    assert_eq!(table.instrument.strokes(), Vec::<Vec<DVec2>>::new());
    table.up(2);
    table.down(3, A);
    table.instrument.cancel_all();
    table.up(3);
    assert_eq!(commands(&mut table), []);
    assert_eq!(table.instrument.fold_handles().count(), 0);
}

#[test]
fn a_handle_belongs_to_its_side_also_across_the_middle() {
    let mut table = with_tools(&[(Side::South, Tool::Fold)]);
    let over = DVec2::new(600.0, 150.0);
    // Somebody is over there.
    table.tap(9, table.place(Side::North, ControlKind::Speed));
    table.down(1, DVec2::new(600.0, 500.0));
    drag(&mut table, 1, over, 30);
    table.up(1);
    commands(&mut table);
    let middle = table.instrument.fold_handles().next().expect("a handle").at;
    assert_eq!(Side::of(middle, SIZE_MM), Side::North);
    assert_eq!(table.down(2, middle), Route::Tool);
    assert_eq!(
        table.down(3, middle - 80.0),
        Route::Land,
        "beside it is the neighbour's land"
    );
    // Whoever undoes, or takes another tool, has no handle any more.
    table.tap(4, table.place(Side::South, ControlKind::Undo));
    assert_eq!(table.instrument.fold_handles().count(), 0);
}

#[test]
fn who_is_alone_at_the_table_reaches_across_with_a_tool() {
    let north = DVec2::new(600.0, 100.0);
    for tool in [Tool::Fold, Tool::Slice, Tool::Edit] {
        let mut table = with_tools(&[(Side::South, tool)]);
        assert_eq!(table.down(1, north), Route::Tool);
        table.cancel(1);
        // Somebody takes the controls over there: that half is theirs for a while.
        table.tap(2, table.place(Side::North, ControlKind::Readouts));
        assert_eq!(table.down(3, north), Route::Land);
        table.wait(20_000);
        assert_eq!(
            table.down(4, north),
            Route::Land,
            "a finger of theirs is still down"
        );
        table.up(3);
        table.up(4);
        table.wait(11_000);
        assert_eq!(table.down(5, north), Route::Tool);
    }
}

#[test]
fn two_fingers_set_a_cross_section_and_it_follows_them() {
    let mut table = with_tools(&[(Side::South, Tool::Slice)]);
    assert_eq!(table.down(1, A), Route::Tool);
    table.wait(50);
    assert_eq!(commands(&mut table), [], "one end is none");
    // The second finger of the same hand may land beyond the middle.
    let far = DVec2::new(600.0, 200.0);
    assert_eq!(table.down(2, far), Route::Tool);
    table.wait(16);
    let sent = commands(&mut table);
    assert_eq!(sent.iter().map(ends).collect::<Vec<_>>(), [[A, far]]);
    answer(&mut table, &sent[0]);
    for step in 1..=60 {
        table.shift(2, far + DVec2::new(0.0, f64::from(step)));
        table.wait(16);
        let shown = table.instrument.slices().next().expect("shown").ends[1];
        assert_eq!(shown, far + DVec2::new(0.0, f64::from(step)), "at once");
    }
    let sent = commands(&mut table);
    assert!((20..=32).contains(&sent.len()), "{} in a second", sent.len());
    table.shift(2, B);
    table.up(2);
    table.up(1);
    let sent = commands(&mut table);
    assert_eq!(ends(&sent[sent.len() - 1]), [A, B]);
    answer(&mut table, &sent[sent.len() - 1]);
    // Taken hold of again, from the other side's land as well.
    assert_eq!(table.down(3, B + 5.0), Route::Tool);
    table.up(3);
    assert_eq!(
        commands(&mut table).iter().map(ends).collect::<Vec<_>>(),
        [[A, B + 5.0]]
    );
}

#[test]
fn the_sheet_has_its_controls_while_there_is_a_cross_section() {
    let mut table = with_tools(&[(Side::North, Tool::Slice)]);
    let shown = |table: &Table| {
        let controls = table.instrument.controls();
        controls
            .iter()
            .filter(|c| c.kind == ControlKind::FreezeSlice)
            .count()
    };
    assert_eq!((shown(&table), table.instrument.papers().count()), (0, 0));
    table.tap(1, DVec2::new(400.0, 200.0));
    table.tap(2, DVec2::new(800.0, 220.0));
    let sent = commands(&mut table);
    answer(&mut table, &sent[sent.len() - 1]);
    assert_eq!((shown(&table), table.instrument.papers().count()), (1, 1));
    let paper = table.instrument.papers().next().expect("a sheet");
    assert_eq!(paper.side, Side::North);
    // The sheet is no land, and a tap on it asks for a note.
    table.tap(3, paper.centre_mm);
    let asked = table.instrument.drain();
    let [
        Deed::Note {
            side: Side::North,
            at,
        },
    ] = asked[..]
    else {
        panic!("{asked:?}");
    };
    assert!((at - 0.5).length() < 1e-9);
    table.down(4, paper.centre_mm);
    table.shift(4, paper.centre_mm + 30.0);
    table.up(4);
    assert_eq!(table.instrument.drain(), [], "a wipe does not");
    let pressed = |table: &mut Table, kind| {
        table.tap(5, table.control(Side::North, kind).centre_mm);
        commands(table).remove(0).action
    };
    assert_eq!(
        pressed(&mut table, ControlKind::FreezeSlice),
        Action::FreezeSlice(true)
    );
    table.set.cuts[0].as_mut().expect("a cut").frozen = true;
    table.wait(16);
    assert!(table.control(Side::North, ControlKind::FreezeSlice).on);
    assert_eq!(table.down(6, DVec2::new(400.0, 200.0)), Route::Tool);
    table.shift(6, DVec2::new(300.0, 200.0));
    table.up(6);
    assert_eq!(commands(&mut table), [], "frozen, its ends stay");
    assert_eq!(
        pressed(&mut table, ControlKind::FreezeSlice),
        Action::FreezeSlice(false)
    );
    assert_eq!(pressed(&mut table, ControlKind::CloseSlice), Action::CloseSlice);
    table.set.cuts[0] = None;
    table.wait(16);
    assert_eq!((shown(&table), table.instrument.slices().count()), (0, 0));
}

#[test]
fn each_side_works_with_its_own_tool_at_the_same_time() {
    let mut table = with_tools(&[(Side::South, Tool::Slice), (Side::North, Tool::Fold)]);
    table.down(1, A);
    table.down(2, B);
    table.down(3, SIZE_MM - A);
    for step in 1..=20 {
        table.shift(3, SIZE_MM - A - DVec2::new(f64::from(step) * 10.0, 0.0));
        table.shift(2, B + f64::from(step));
        table.wait(16);
    }
    table.up(3);
    table.up(1);
    table.up(2);
    let sent = commands(&mut table);
    let of = |side| {
        sent.iter()
            .filter(move |c| c.side == Some(side))
            .map(|c| c.action.word())
    };
    assert!(of(Side::South).all(|word| word == "slice"));
    assert_eq!(of(Side::North).collect::<Vec<_>>(), ["turn_folds"]);
}

#[test]
fn what_is_not_offered_cannot_be_held() {
    let mut table = with_tools(&[(Side::South, Tool::Fold), (Side::North, Tool::Slice)]);
    table.instrument.set_params(InstrumentParams {
        artists: false,
        ..params()
    });
    let sent = commands(&mut table);
    assert_eq!(sent.len(), 1);
    assert_eq!(
        (&sent[0].action, sent[0].side),
        (&Action::Tool(Tool::Push), Some(Side::South))
    );
    assert_eq!(table.instrument.tool(Side::North), Tool::Slice);
    table.key(Key::Tool(Tool::Fold), true);
    table.key(Key::Tool(Tool::Fold), false);
    assert_eq!(table.instrument.tool(Side::South), Tool::Push);
}

proptest! {
    /// Whatever fingers do with tools: commands are as a gesture file can hold them, and every contact keeps its owner.
    #[test]
    fn tools_send_what_a_file_can_hold(
        steps in prop::collection::vec(
            (0..7_u64, 0..5_u8, (0.0..SIZE_MM.x, 0.0..SIZE_MM.y), 0..100_u64), 1..120),
        tools in prop::array::uniform2(prop::sample::select(vec![Tool::Push, Tool::Fold, Tool::Slice])),
        paused in any::<bool>(),
    ) {
        let taken = [(Side::North, tools[0]), (Side::South, tools[1])];
        let taken: Vec<_> = taken.into_iter().filter(|(_, tool)| *tool != Tool::Push).collect();
        let mut table = with_tools(&taken);
        table.set.clock.paused = paused;
        let mut down = std::collections::BTreeMap::new();
        for (id, what, (x, y), ms) in steps {
            table.wait(ms);
            let phase = match (what, down.contains_key(&id)) {
                (_, false) => Phase::Down,
                (0, true) => Phase::Up,
                (1, true) => Phase::Cancel,
                (_, true) => Phase::Move,
            };
            let route = table.event(phase, contact(id, DVec2::new(x, y)));
            let owner = *down.entry(id).or_insert(route);
            prop_assert_eq!(route, owner);
            if matches!(phase, Phase::Up | Phase::Cancel) {
                down.remove(&id);
            }
            for deed in table.instrument.drain() {
                let Deed::Command(sent) = deed else { continue };
                let mut json = String::new();
                sent.write_json(&mut json);
                let value = serde_json::from_str(&json).expect("JSON");
                let read = command::parse(&value).expect("in bounds");
                prop_assert_eq!(&read.commands[0], &sent);
                match &sent.action {
                    Action::TurnFolds { path } => prop_assert!(path.len() <= PATH_POINTS.1),
                    Action::RaiseFolds { by, .. } => prop_assert!((0.0..=MAX_RAISE).contains(by)),
                    Action::Slice(ends) => {
                        prop_assert!(ends.from.distance(ends.to) >= 10.0);
                        let side = sent.side.expect("a side") as usize;
                        table.set.cuts[side] = Some(Cut {
                            ends: [ends.from, ends.to].map(|end| table.set.map.to_plan(end)),
                            frozen: false,
                            notes: Vec::new(),
                        });
                    }
                    Action::CloseSlice => table.set.cuts[sent.side.expect("a side") as usize] = None,
                    _ => {}
                }
            }
        }
    }
}

#[test]
fn the_planet_has_no_tools_but_hands_and_the_way_back() {
    let mut table = Table::new();
    let tap = table.place(Side::North, ControlKind::World);
    table.tap(1, tap);
    let to_globe = Deed::World {
        side: Side::North,
        mode: Mode::Globe,
    };
    assert_eq!(table.instrument.drain(), [to_globe]);
    table.instrument.set_params(InstrumentParams {
        mode: Mode::Globe,
        ..params()
    });
    // Even while the clock stands, which on the land gives everybody the edit tool.
    table.set.clock.paused = true;
    table.wait(1);
    let kinds: Vec<ControlKind> = table
        .instrument
        .controls()
        .iter()
        .map(|control| control.kind)
        .collect();
    for kind in &kinds {
        let of_the_land = match kind {
            ControlKind::Tool(tool) => tool.paint().is_none(),
            kind => matches!(kind, ControlKind::Scrub | ControlKind::Save | ControlKind::Final),
        };
        assert!(!of_the_land, "{kind:?}");
    }
    assert!(
        [Tool::Land, Tool::Sea]
            .iter()
            .all(|&brush| kinds.contains(&ControlKind::Tool(brush)))
    );
    assert!(kinds.contains(&ControlKind::Undo) && kinds.contains(&ControlKind::StartOver));
    assert_eq!(table.down(7, SIZE_MM / 2.0), Route::Land);
    table.up(7);
    let tap = table.place(Side::South, ControlKind::World);
    table.tap(2, tap);
    let back = Deed::World {
        side: Side::South,
        mode: Mode::Mountain,
    };
    assert_eq!(table.instrument.drain(), [back]);
}
