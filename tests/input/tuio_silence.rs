//! Senders that fall silent, come back, or are replaced: no finger is forgotten, and none that rests is let go.

use crate::tuio_common::*;
use orogen::input::tuio::MAX_SOURCES;

const FRAME_US: u64 = 16_000;
const SECOND_US: u64 = 1_000_000;

/// A sender that repeats `frames` times what it said, each `pause_us`. Returns the time of the last.
fn repeat(table: &mut Table, from_us: u64, pause_us: u64, frames: u64) -> u64 {
    for i in 0..frames {
        table.hear(from_us + i * pause_us, &cursors("a@b", -1, &[(1, 0.1, 0.1)]));
    }
    from_us + (frames - 1) * pause_us
}

#[test]
fn who_speaks_only_of_changes_keeps_a_finger_that_rests() {
    let mut table = Table::default();
    for i in 0..200 {
        table.hear(i * FRAME_US, &cursors("a@b", -1, &[(1, i as f32 / 200.0, 0.1)]));
    }
    let last_us = 199 * FRAME_US;
    table.tick(last_us + 50 * SECOND_US);
    assert_eq!(table.down(), [1]);
    table.tick(last_us + 60 * SECOND_US);
    assert_eq!(table.down(), [1]);
    table.tick(last_us + 60 * SECOND_US + 1);
    assert_eq!(table.down(), [0; 0]);
    assert_eq!(
        (table.decoder.counts().forgotten, table.decoder.sources().count()),
        (1, 0)
    );
}

#[test]
fn who_repeats_itself_and_stops_is_gone() {
    let mut table = Table::default();
    let last_us = repeat(&mut table, 0, FRAME_US, 30);
    table.tick(last_us + SECOND_US);
    assert_eq!(table.down(), [1], "not before a second");
    table.tick(last_us + SECOND_US + 1);
    assert_eq!((table.down().len(), table.decoder.counts().silenced), (0, 1));
    // Once only, and the sender itself is known for longer.
    table.tick(last_us + 2 * SECOND_US);
    assert_eq!((table.lost, table.decoder.sources().count()), (1, 1));
    repeat(&mut table, last_us + 3 * SECOND_US, FRAME_US, 1);
    assert_eq!((table.found, table.down()), (2, vec![1]));
}

#[test]
fn the_pauses_are_learned() {
    let mut table = Table::default();
    let last_us = repeat(&mut table, 0, SECOND_US, 20);
    table.tick(last_us + 8 * SECOND_US);
    assert_eq!(table.down(), [1]);
    table.tick(last_us + 8 * SECOND_US + 1);
    assert_eq!(table.down(), [0; 0]);
}

#[test]
fn packets_that_the_network_doubles_are_no_habit() {
    let mut table = Table::default();
    for i in 0..200 {
        let packet = cursors("a@b", -1, &[(1, i as f32 / 200.0, 0.1)]);
        table.hear(i * FRAME_US, &packet);
        table.hear(i * FRAME_US + 100, &packet);
    }
    table.tick(200 * FRAME_US + 30 * SECOND_US);
    assert_eq!(table.down(), [1]);
}

#[test]
fn who_comes_back_with_the_same_finger_is_not_taken_for_gone_so_soon_again() {
    let mut table = Table::default();
    let last_us = repeat(&mut table, 0, FRAME_US, 11);
    table.tick(last_us + 2 * SECOND_US);
    assert_eq!(table.down(), [0; 0]);
    let last_us = repeat(&mut table, last_us + 3 * SECOND_US, FRAME_US, 20);
    assert_eq!(table.down(), [1]);
    table.tick(last_us + 40 * SECOND_US);
    assert_eq!(table.down(), [1], "the habit has to be shown again");
    let last_us = repeat(&mut table, last_us + 41 * SECOND_US, FRAME_US, 8_000);
    table.tick(last_us + 2 * SECOND_US);
    assert_eq!(
        table.down(),
        [0; 0],
        "and then is believed, once the long pause has faded"
    );
}

#[test]
fn silence_with_nothing_down_means_nothing() {
    let mut table = Table::default();
    repeat(&mut table, 0, FRAME_US, 30);
    table.hear(SECOND_US, &cursors("a@b", -1, &[]));
    table.tick(30 * SECOND_US);
    assert_eq!((table.lost, table.decoder.sources().count()), (0, 1));
}

#[test]
fn a_namesake_on_another_port_of_the_machine_takes_over() {
    let mut table = Table::default();
    table.hear_from(0, 1, &cursors("a@b", 77, &[(1, 0.1, 0.1)]));
    table.hear_from(0, 9, &cursors("other@b", 77, &[(9, 0.9, 0.1)]));
    table.hear_from(SECOND_US, 2, &cursors("a@b", 1, &[(5, 0.5, 0.5)]));
    table.tick(SECOND_US + 900_000);
    assert_eq!(table.down(), [1, 9, 5]);
    table.tick(2 * SECOND_US);
    assert_eq!(table.down(), [9, 5]);
    // Two that both speak are two.
    let mut table = Table::default();
    for i in 0..20 {
        table.hear_from(i * SECOND_US / 2, 1, &cursors("a@b", -1, &[(1, 0.1, 0.1)]));
        table.hear_from(i * SECOND_US / 2, 2, &cursors("a@b", -1, &[(2, 0.2, 0.1)]));
    }
    assert_eq!(table.down(), [1, 2]);
}

#[test]
fn there_is_room_for_so_many_senders_and_the_one_longest_silent_makes_way() {
    let mut table = Table::default();
    for port in 1..=MAX_SOURCES as u16 {
        table.hear_from(port.into(), port, &cursors("", 1, &[(i32::from(port), 0.1, 0.1)]));
    }
    table.hear_from(100, 99, &cursors("", 1, &[(99, 0.9, 0.9)]));
    assert_eq!(
        (table.down().len(), table.decoder.counts().over_sources),
        (MAX_SOURCES, 1)
    );
    table.hear_from(SECOND_US + 1, 99, &cursors("", 1, &[(99, 0.9, 0.9)]));
    let down = table.down();
    assert_eq!(
        (down.len(), down.contains(&1), down.contains(&99)),
        (MAX_SOURCES, false, true)
    );
}

#[test]
fn forgetting_all_leaves_nothing_down() {
    let mut table = Table::default();
    table.hear_from(0, 1, &cursors("a@b", 1, &[(1, 0.1, 0.1)]));
    table.hear_from(0, 2, &pointers("c:0@d", 1, &[(2, 0.1, 0.1)]));
    let mut lost = Vec::new();
    table
        .decoder
        .forget_all(&mut |event| lost.push(format!("{event:?}")));
    assert_eq!(lost.len(), 2);
    assert_eq!(table.decoder.sources().count(), 0);
}
