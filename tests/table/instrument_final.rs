//! The final land: made and given up by a control that is held, and not offered to visitors.

use glam::DVec2;
use orogen::gesture::command::Mode;
use orogen::gesture::contact::Side;
use orogen::instrument::{ControlKind, Deed, InstrumentParams, Key};

use crate::instrument_support::{Table, params};

/// Longer than it must be held, ms.
const HELD: u64 = 1600;

fn asked(side: Side, on: bool) -> [Deed; 1] {
    [Deed::FinalLand { side, on }]
}

#[test]
fn it_is_held_to_be_made_and_held_to_be_given_up() {
    let mut table = Table::new();
    let at = table.place(Side::North, ControlKind::Final);
    table.tap(1, at);
    table.wait(HELD);
    assert_eq!(table.instrument.drain(), [], "a tap does nothing");
    table.down(2, at);
    table.wait(HELD);
    table.up(2);
    assert_eq!(table.instrument.drain(), asked(Side::North, true));

    table.instrument.set_making(Some(0.25));
    for side in [Side::North, Side::South] {
        let control = table.control(side, ControlKind::Final);
        assert_eq!((control.on, control.value, control.progress), (true, 0.25, 0.0));
        assert!(
            !table.control(side, ControlKind::Save).enabled,
            "one after the other"
        );
    }
    table.tap(3, table.place(Side::South, ControlKind::Save));
    table.tap(4, table.place(Side::South, ControlKind::Final));
    assert_eq!(
        table.instrument.drain(),
        [],
        "nor does one give up a minute's work"
    );
    table.key(Key::Final, true);
    table.wait(HELD);
    table.key(Key::Final, false);
    assert_eq!(table.instrument.drain(), asked(Side::South, false));

    table.instrument.set_making(None);
    assert!(!table.control(Side::South, ControlKind::Final).on);
    table.tap(5, table.place(Side::South, ControlKind::Save));
    assert_eq!(table.instrument.drain(), [Deed::Save { side: Side::South }]);
}

#[test]
fn visitors_and_planets_have_none() {
    let offered = |params| {
        let mut table = Table::new();
        table.instrument.set_params(params);
        table.wait(10);
        let kinds = table.instrument.controls();
        kinds.iter().any(|control| control.kind == ControlKind::Final)
    };
    let artists = params();
    assert!(offered(artists));
    assert!(!offered(InstrumentParams {
        artists: false,
        ..artists
    }));
    assert!(!offered(InstrumentParams {
        unattended: true,
        ..artists
    }));
    assert!(!offered(InstrumentParams {
        mode: Mode::Globe,
        ..artists
    }));
    let small = InstrumentParams {
        size_mm: DVec2::new(300.0, 169.0),
        ..artists
    };
    assert!(offered(small), "a laptop has room for it");
}
