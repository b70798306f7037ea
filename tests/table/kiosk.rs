//! The circle from visitor to visitor: every phase against every input, and what holds for any sequence of them.

use glam::DVec2;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, Phase as Touch, Source};
use orogen::kiosk::{Effect, Kiosk, KioskParams, Phase};
use orogen::settings::Settings;
use proptest::prelude::*;

const IDLE_MS: u64 = 75_000;
const COUNTDOWN_MS: u64 = 20_000;

/// A hand that rests is somebody for so long.
const REST_MS: u64 = 20_000;

/// The land fades, and a look more.
const RESET_MS: u64 = 1600;

/// A look at the table, ms.
const LOOK_MS: u64 = 100;

const AT: DVec2 = DVec2::new(300.0, 200.0);

fn params() -> KioskParams {
    KioskParams {
        idle_ms: IDLE_MS,
        countdown_ms: COUNTDOWN_MS,
        longest_visit_ms: Some(4 * 3_600_000),
        show: true,
        resets: true,
    }
}

/// A kiosk with its clock. Contacts are numbered.
struct Table {
    kiosk: Kiosk,
    now_ms: u64,
}

impl Table {
    fn with(params: KioskParams) -> Self {
        let mut table = Self {
            kiosk: Kiosk::new(params),
            now_ms: 1_000_000,
        };
        table.kiosk.tick(table.now_ms);
        table
    }

    fn touch(&mut self, source: Source, id: u64, phase: Touch, position: DVec2) {
        let key = ContactKey {
            source,
            device: 0,
            id,
            generation: 0,
        };
        let contact = Contact {
            key,
            position,
            size_mm: None,
            confidence: None,
        };
        self.kiosk.feed(&ContactEvent { phase, contact }, self.now_ms);
    }

    fn down(&mut self, id: u64) {
        self.touch(Source::Window, id, Touch::Down, AT);
    }

    fn up(&mut self, id: u64) {
        self.touch(Source::Window, id, Touch::Up, AT);
    }

    fn tap(&mut self) {
        self.down(1);
        self.wait(100);
        self.up(1);
    }

    fn wait(&mut self, ms: u64) {
        let end = self.now_ms + ms;
        while self.now_ms < end {
            self.now_ms = (self.now_ms + LOOK_MS).min(end);
            self.kiosk.tick(self.now_ms);
        }
    }

    fn kind(&self) -> Kind {
        match self.kiosk.phase() {
            Phase::Attract => Kind::Attract,
            Phase::Invite => Kind::Invite,
            Phase::Play => Kind::Play,
            Phase::IdleWarning { .. } => Kind::Warning,
            Phase::Reset => Kind::Reset,
        }
    }

    /// A table that has come to a phase on its usual way, with what it has told taken.
    fn at(kind: Kind) -> Self {
        let mut table = Self::with(params());
        if kind != Kind::Attract {
            table.tap();
        }
        if !matches!(kind, Kind::Attract | Kind::Invite) {
            table.wait(1000);
            table.kiosk.pushed(table.now_ms);
        }
        for awaited in [Kind::Warning, Kind::Reset] {
            if awaited == kind || kind == Kind::Reset {
                while table.kind() != awaited {
                    table.wait(LOOK_MS);
                }
            }
        }
        assert_eq!(table.kind(), kind);
        table.kiosk.drain();
        table
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Attract,
    Invite,
    Play,
    Warning,
    Reset,
}

const KINDS: [Kind; 5] = [
    Kind::Attract,
    Kind::Invite,
    Kind::Play,
    Kind::Warning,
    Kind::Reset,
];

const FRESH: [Effect; 4] = [
    Effect::CancelContacts,
    Effect::FreshLand,
    Effect::ResetTools,
    Effect::ResetView,
];

/// Every phase × every input: where it leads, and what is to be done.
#[test]
fn the_whole_table() {
    use Kind::{Attract, Invite, Play, Reset, Warning};
    type Input = (&'static str, fn(&mut Table));
    let inputs: [Input; 9] = [
        ("a touch", |t| t.down(7)),
        ("a key", |t| t.kiosk.stir(t.now_ms)),
        ("a push", |t| t.kiosk.pushed(t.now_ms)),
        ("the show's touch", |t| t.touch(Source::File, 7, Touch::Down, AT)),
        ("a lift of nobody", |t| t.up(99)),
        ("a second", |t| t.wait(1000)),
        ("idle time", |t| t.wait(IDLE_MS)),
        ("idle time and countdown", |t| t.wait(IDLE_MS + COUNTDOWN_MS)),
        ("staff's reset", |t| t.kiosk.reset(t.now_ms)),
    ];
    let ended = [Effect::CancelShow, Effect::FreshLand];
    let again = [&FRESH[..], &[Effect::StartShow]].concat();
    let off: &[Effect] = &[Effect::CancelShow, FRESH[0], FRESH[1], FRESH[2], FRESH[3]];
    #[rustfmt::skip]
    let expected: [[(Kind, &[Effect]); 9]; 5] = [
        // a touch           a key              a push         the show's     nobody's lift  a second       idle time               idle and countdown  reset
        [(Invite, &ended), (Invite, &ended), (Attract, &[]), (Attract, &[]), (Attract, &[]), (Attract, &[]), (Attract, &[]), (Attract, &[]), (Reset, off)],
        [(Invite, &[]), (Invite, &[]), (Play, &[]), (Invite, &[]), (Invite, &[]), (Invite, &[]), (Warning, &[]), (Reset, &FRESH), (Reset, &FRESH)],
        [(Play, &[]), (Play, &[]), (Play, &[]), (Play, &[]), (Play, &[]), (Play, &[]), (Warning, &[]), (Reset, &FRESH), (Reset, &FRESH)],
        [(Play, &[]), (Play, &[]), (Warning, &[]), (Warning, &[]), (Warning, &[]), (Warning, &[]), (Attract, &again), (Attract, &again), (Reset, &FRESH)],
        [(Invite, &[]), (Invite, &[]), (Reset, &[]), (Reset, &[]), (Reset, &[]), (Reset, &[]), (Attract, &[Effect::StartShow]), (Attract, &[Effect::StartShow]), (Reset, &FRESH)],
    ];
    for (kind, row) in KINDS.into_iter().zip(expected) {
        for ((name, input), (next, effects)) in inputs.into_iter().zip(row) {
            let mut table = Table::at(kind);
            if kind == Invite {
                table.wait(500);
            }
            input(&mut table);
            assert_eq!(table.kind(), next, "{kind:?} and {name}");
            assert_eq!(table.kiosk.drain(), effects, "{kind:?} and {name}");
        }
    }
}

#[test]
fn a_new_table_begins_its_show_and_one_without_show_gives_hints() {
    let mut table = Table::with(params());
    assert_eq!(table.kiosk.drain(), [Effect::StartShow]);
    table.wait(3000);
    assert_eq!(table.kiosk.hint(), None);
    let mut quiet = Table::with(KioskParams {
        show: false,
        ..params()
    });
    assert_eq!(quiet.kiosk.drain(), []);
    quiet.wait(3000);
    assert!(quiet.kiosk.hint().is_some());
}

#[test]
fn hints_come_after_the_first_touch_and_vanish_with_the_first_push() {
    let mut table = Table::at(Kind::Invite);
    assert_eq!(table.kiosk.hint(), None, "first the land answers");
    table.wait(2500);
    assert!(table.kiosk.hint().is_some());
    table.tap();
    assert!(table.kiosk.hint().is_some(), "a tap is no push");
    table.kiosk.pushed(table.now_ms);
    assert_eq!(table.kiosk.hint(), None);
}

#[test]
fn pushes_of_the_show_that_are_told_late_are_not_the_visitors() {
    let mut table = Table::with(params());
    table.down(1);
    table.kiosk.pushed(table.now_ms + 100);
    assert_eq!(table.kind(), Kind::Invite);
    table.kiosk.pushed(table.now_ms + 500);
    assert_eq!(table.kind(), Kind::Play);
}

#[test]
fn the_warning_counts_down_and_any_new_touch_or_movement_ends_it() {
    let mut table = Table::at(Kind::Warning);
    table.wait(5000);
    let Phase::IdleWarning { left_ms } = table.kiosk.phase() else {
        panic!("{:?}", table.kiosk.phase());
    };
    assert!((14_800..=15_000).contains(&left_ms), "{left_ms}");
    table.wait(14_000);
    table.down(3);
    assert_eq!(table.kind(), Kind::Play);
    assert_eq!(table.kiosk.untouched_ms(), 0);
    assert_eq!(table.kiosk.drain(), [], "land, view and tools stay");
    // A contact that rested all the time moves.
    table.wait(REST_MS + IDLE_MS + 500);
    assert_eq!(table.kind(), Kind::Warning);
    table.touch(Source::Window, 3, Touch::Move, AT + 3.0);
    assert_eq!(table.kind(), Kind::Play);
}

#[test]
fn a_warning_before_any_push_leads_back_to_the_invitation() {
    let mut table = Table::at(Kind::Invite);
    table.wait(IDLE_MS);
    assert_eq!(table.kind(), Kind::Warning);
    table.tap();
    assert_eq!(table.kind(), Kind::Invite);
}

#[test]
fn a_bag_and_its_trembling_hold_the_table_for_twenty_seconds_and_no_longer() {
    let mut table = Table::at(Kind::Play);
    table.down(9);
    for step in 0..10 * (REST_MS + IDLE_MS) / 1000 {
        let tremble = DVec2::new((step % 3) as f64 * 0.6, (step % 2) as f64 * 0.6);
        table.touch(Source::Window, 9, Touch::Move, AT + tremble);
        table.wait(100);
    }
    table.wait(200);
    assert_eq!(table.kind(), Kind::Warning);
    table.wait(COUNTDOWN_MS + RESET_MS);
    assert_eq!(table.kind(), Kind::Attract);
    // It does not end the show either, nor does its being gone.
    table.touch(Source::Window, 9, Touch::Move, AT + 1.0);
    table.up(9);
    table.wait(1000);
    assert_eq!(table.kind(), Kind::Attract);
}

#[test]
fn a_bag_that_flickers_is_still_a_bag() {
    let mut table = Table::at(Kind::Play);
    let mut id = 100;
    table.down(id);
    for _ in 0..(REST_MS + IDLE_MS + COUNTDOWN_MS + RESET_MS) / 500 {
        table.wait(400);
        table.up(id);
        table.wait(100);
        id += 1;
        table.touch(
            Source::Window,
            id,
            Touch::Down,
            AT + DVec2::new((id % 4) as f64, 0.0),
        );
    }
    assert_eq!(table.kind(), Kind::Attract);
}

#[test]
fn a_hand_that_rests_is_somebody_and_so_is_one_that_moves_now_and_then() {
    let mut table = Table::at(Kind::Play);
    table.down(4);
    table.wait(REST_MS);
    assert_eq!(table.kiosk.untouched_ms(), 0);
    for step in 0..10_u32 {
        table.wait(IDLE_MS);
        table.touch(Source::Window, 4, Touch::Move, AT + f64::from(step + 1) * 10.0);
        assert_eq!(table.kind(), Kind::Play);
    }
}

#[test]
fn clocks_that_jump_neither_end_a_visit_nor_hold_it() {
    let mut table = Table::at(Kind::Play);
    table.now_ms += 8 * 3_600_000;
    table.kiosk.tick(table.now_ms);
    assert_eq!(table.kind(), Kind::Play, "a machine that slept");
    table.now_ms = 5;
    table.kiosk.tick(table.now_ms);
    table.wait(IDLE_MS - 5000);
    assert_eq!(table.kind(), Kind::Play);
    table.wait(5000);
    assert_eq!(table.kind(), Kind::Warning);
    table.now_ms += 3_600_000;
    table.kiosk.tick(table.now_ms);
    let Phase::IdleWarning { left_ms } = table.kiosk.phase() else {
        panic!("the countdown ran out unseen");
    };
    assert!(left_ms >= COUNTDOWN_MS - 4000, "{left_ms}");
    table.wait(COUNTDOWN_MS + RESET_MS);
    assert_eq!(table.kind(), Kind::Attract);
}

#[test]
fn a_table_that_something_touches_for_hours_is_reset_all_the_same() {
    let mut table = Table::with(KioskParams {
        longest_visit_ms: Some(1_800_000),
        ..params()
    });
    let mut waited = 0;
    while table.kind() != Kind::Reset && waited < 2_000_000 {
        table.touch(Source::Window, waited, Touch::Down, AT + (waited % 500) as f64);
        table.touch(Source::Window, waited, Touch::Up, AT);
        table.wait(10_000);
        waited += 10_000;
    }
    assert_eq!(waited, 1_800_000);
}

#[test]
fn where_work_must_not_go_nothing_is_ever_reset() {
    let mut table = Table::with(KioskParams {
        resets: false,
        ..params()
    });
    table.tap();
    table.kiosk.drain();
    table.wait(1000);
    table.kiosk.pushed(table.now_ms);
    table.wait(5 * 3_600_000);
    assert_eq!(table.kind(), Kind::Play);
    assert_eq!(table.kiosk.drain(), []);
}

#[test]
fn the_finger_that_asks_for_a_reset_does_not_begin_a_visit_by_lifting() {
    let mut table = Table::at(Kind::Play);
    table.down(1);
    table.kiosk.reset(table.now_ms);
    table.wait(200);
    table.up(1);
    table.wait(RESET_MS);
    assert_eq!(table.kind(), Kind::Attract);
}

#[test]
fn times_come_from_the_settings() {
    let settings = Settings::default();
    assert_eq!(KioskParams::new(&settings.kiosk, true), params());
}

#[derive(Clone, Debug)]
enum Input {
    Touch(u64, u8, f64),
    Show(u8),
    Key,
    Push,
    Wait(u64),
    Jump(i64),
    Reset,
}

fn input() -> impl Strategy<Value = Input> {
    prop_oneof![
        6 => (0..4_u64, 0..4_u8, 0.0..50.0).prop_map(|(id, phase, x)| Input::Touch(id, phase, x)),
        1 => (0..4_u8).prop_map(Input::Show),
        1 => Just(Input::Key),
        2 => Just(Input::Push),
        4 => (0..100_000_u64).prop_map(Input::Wait),
        1 => (-10_000_000..10_000_000_i64).prop_map(Input::Jump),
        1 => Just(Input::Reset),
    ]
}

fn touch_phase(phase: u8) -> Touch {
    [Touch::Down, Touch::Move, Touch::Up, Touch::Cancel][usize::from(phase)]
}

fn play(inputs: &[Input]) -> Table {
    let mut table = Table::with(params());
    for input in inputs {
        match *input {
            Input::Touch(id, phase, x) => {
                table.touch(Source::Window, id, touch_phase(phase), AT + DVec2::new(x, 0.0));
            }
            Input::Show(phase) => table.touch(Source::File, 1, touch_phase(phase), AT),
            Input::Key => table.kiosk.stir(table.now_ms),
            Input::Push => table.kiosk.pushed(table.now_ms),
            Input::Wait(ms) => table.wait(ms),
            Input::Jump(ms) => {
                table.now_ms = table.now_ms.saturating_add_signed(ms);
                table.kiosk.tick(table.now_ms);
            }
            Input::Reset => table.kiosk.reset(table.now_ms),
        }
    }
    table
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// From wherever, with whatever left lying on it, a table that nobody touches comes to attract.
    #[test]
    fn nobody_leads_to_attract(inputs in prop::collection::vec(input(), 0..40)) {
        let mut table = play(&inputs);
        table.wait(REST_MS + IDLE_MS + COUNTDOWN_MS + RESET_MS + 4 * LOOK_MS);
        prop_assert_eq!(table.kind(), Kind::Attract);
        table.kiosk.drain();
        table.wait(2 * IDLE_MS);
        prop_assert_eq!(table.kind(), Kind::Attract);
        prop_assert_eq!(table.kiosk.drain(), []);
    }

    /// Whoever moves at least once in each idle time is never reset.
    #[test]
    fn somebody_is_never_reset(
        inputs in prop::collection::vec(input(), 0..20),
        pauses in prop::collection::vec(1000..IDLE_MS - 1000, 1..20),
    ) {
        let mut table = play(&inputs);
        table.kiosk.stir(table.now_ms);
        table.kiosk.drain();
        table.down(50);
        let mut x = 0.0;
        for ms in pauses {
            x += 10.0;
            table.touch(Source::Window, 50, Touch::Move, AT + DVec2::new(x, 0.0));
            table.wait(ms);
            prop_assert!(matches!(table.kind(), Kind::Invite | Kind::Play));
        }
        prop_assert!(!table.kiosk.drain().contains(&Effect::FreshLand));
    }

    /// The show is stopped as often as it is started, and never runs while somebody is there.
    #[test]
    fn shows_end_before_visits_begin(inputs in prop::collection::vec(input(), 0..60)) {
        for end in 0..inputs.len() {
            let mut table = play(&inputs[..end]);
            let mut running = false;
            for effect in table.kiosk.drain() {
                match effect {
                    Effect::StartShow => {
                        prop_assert!(!running);
                        running = true;
                    }
                    Effect::CancelShow => {
                        prop_assert!(running);
                        running = false;
                    }
                    _ => {}
                }
            }
            prop_assert_eq!(running, table.kind() == Kind::Attract);
        }
    }
}
