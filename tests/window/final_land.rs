//! The final land from the table: given up it leaves nothing behind, and made it is the land that lay there, finer, while
//! the table goes on.

use crate::window_support::fingers::Script;
use crate::window_support::{Key, SLOW_S, Setup, Table};

/// Longer than the control must be held, s: a slow machine looks at its clock a few times a second.
const HELD_S: f64 = 3.0;
/// How long it takes on a slow machine that draws meanwhile, s.
const MADE_S: f64 = 600.0;

#[test]
fn a_final_land_is_given_up_and_made_while_the_table_goes_on() {
    let name = "a_final_land_is_given_up_and_made_while_the_table_goes_on";
    let Some(mut table) = Table::start(name, &Setup::default()) else {
        return;
    };
    let mut touch = Script::default();
    touch.stroke(0.0, 1.5, table.at(0.4, 0.5), table.at(0.55, 0.5));
    table.play(&touch);
    table.wait("a range", SLOW_S, |now| now.contacts == 0 && now.max_m > 600.0);

    table.press(&[Key::M], HELD_S);
    table.look("making");
    table.press(&[Key::M], HELD_S);
    assert!(table.survives(8.0));
    assert!(!table.has_saved("final-001"), "it was given up");

    table.press(&[Key::M], HELD_S);
    let before = table.settled();
    let mut touch = Script::default();
    touch.stroke(0.0, 1.5, table.at(0.7, 0.4), table.at(0.7, 0.6));
    table.play(&touch);
    let after = table.wait("a push meanwhile", SLOW_S, |now| now.pushes > before.pushes);
    assert!(!table.has_saved("final-001"), "the table did not wait for it");
    let land = table.saved("final-001", MADE_S);
    assert_eq!(land.report["inputs"]["nodes"], 1_000_000);
    assert_eq!(land.report["refinement"]["live_nodes"], after.nodes);
    assert_eq!(
        land.report["contacts"]["pushes"], before.pushes,
        "as it lay there"
    );
    let summit = land.report["terrain"]["max_m"].as_f64().expect("a height");
    assert!(
        (0.8..1.4).contains(&(summit / before.max_m)),
        "{summit} m, {before:?}"
    );
}
