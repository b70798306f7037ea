//! The way in for staff: nobody comes in by accident, and whoever knows the PIN does.

use glam::DVec2;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, Phase, Source};
use orogen::kiosk::{DoorParams, DoorPhase, StaffDoor};
use orogen::settings::Corner;
use proptest::prelude::*;

const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);
const CORNER: DVec2 = DVec2::new(30.0, 30.0);
const OUTSIDE: DVec2 = DVec2::new(90.0, 30.0);

struct Table {
    door: StaffDoor,
    now_ms: u64,
}

impl Table {
    fn new(corner: Corner) -> Self {
        let door = StaffDoor::new(DoorParams {
            pin: "2580".to_owned(),
            corner,
            size_mm: SIZE_MM,
        });
        Self { door, now_ms: 70_000 }
    }

    fn opened() -> Self {
        let mut table = Self::new(Corner::NorthWest);
        table.touch(1, Phase::Down, CORNER);
        table.wait(3000);
        table.touch(1, Phase::Up, CORNER);
        assert_eq!(table.door.phase(), DoorPhase::Keypad { digits: 0, wrong: 0 });
        table
    }

    fn touch(&mut self, id: u64, phase: Phase, position: DVec2) {
        let key = ContactKey {
            source: Source::Window,
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
        self.door.feed(&ContactEvent { phase, contact }, self.now_ms);
    }

    fn wait(&mut self, ms: u64) {
        let end = self.now_ms + ms;
        self.door.tick(self.now_ms);
        while self.now_ms < end {
            self.now_ms = (self.now_ms + 20).min(end);
            self.door.tick(self.now_ms);
        }
    }

    fn pin(&mut self, pin: &str) {
        for digit in pin.bytes() {
            self.door.digit(digit - b'0', self.now_ms);
        }
        self.door.enter(self.now_ms);
    }

    fn shut(&self) -> bool {
        matches!(self.door.phase(), DoorPhase::Shut | DoorPhase::Holding { .. })
    }
}

#[test]
fn a_still_finger_that_is_held_in_any_chosen_corner_opens_the_keypad() {
    for (name, corner) in Corner::ALL {
        let mut table = Table::new(corner);
        let inwards = (SIZE_MM / 2.0 - corner.position(SIZE_MM)).signum();
        let at = corner.position(SIZE_MM) + inwards * 59.0;
        table.touch(1, Phase::Down, at);
        table.wait(1500);
        let DoorPhase::Holding { progress } = table.door.phase() else {
            panic!("{name}: {:?}", table.door.phase());
        };
        assert!((progress - 0.5).abs() < 0.02, "{name}: {progress}");
        table.touch(1, Phase::Move, at + inwards * 6.0);
        table.wait(1500);
        assert_eq!(
            table.door.phase(),
            DoorPhase::Keypad { digits: 0, wrong: 0 },
            "{name}"
        );
        let others = Corner::ALL.into_iter().filter(|(_, other)| *other != corner);
        for (_, other) in others {
            let mut table = Table::new(corner);
            table.touch(1, Phase::Down, other.position(SIZE_MM));
            table.wait(5000);
            assert_eq!(table.door.phase(), DoorPhase::Shut);
        }
    }
}

#[test]
fn what_visitors_do_in_a_corner_opens_nothing() {
    type Doing = (&'static str, fn(&mut Table));
    let doings: [Doing; 7] = [
        ("taps", |t| {
            for id in 0..30 {
                t.touch(id, Phase::Down, CORNER);
                t.wait(200);
                t.touch(id, Phase::Up, CORNER);
                t.wait(100);
            }
        }),
        ("a short hold", |t| {
            t.touch(1, Phase::Down, CORNER);
            t.wait(2900);
            t.touch(1, Phase::Up, CORNER);
            t.wait(5000);
        }),
        ("a finger that wanders", |t| {
            t.touch(1, Phase::Down, CORNER);
            t.wait(1000);
            t.touch(1, Phase::Move, CORNER + DVec2::new(11.0, 0.0));
            t.touch(1, Phase::Move, CORNER);
            t.wait(5000);
        }),
        ("a finger that slides in", |t| {
            t.touch(1, Phase::Down, OUTSIDE);
            t.touch(1, Phase::Move, CORNER);
            t.wait(5000);
        }),
        ("two fingers", |t| {
            t.touch(1, Phase::Down, CORNER);
            t.wait(1000);
            t.touch(2, Phase::Down, CORNER + 9.0);
            t.wait(5000);
            t.touch(2, Phase::Up, CORNER + 9.0);
            t.wait(5000);
        }),
        ("a second finger after a palm", |t| {
            t.touch(1, Phase::Down, CORNER);
            t.touch(2, Phase::Down, CORNER);
            t.touch(1, Phase::Up, CORNER);
            t.touch(3, Phase::Down, CORNER);
            t.wait(5000);
        }),
        ("a device that goes away", |t| {
            t.touch(1, Phase::Down, CORNER);
            t.wait(2000);
            t.touch(1, Phase::Cancel, CORNER);
            t.wait(5000);
        }),
    ];
    for (name, doing) in doings {
        let mut table = Table::new(Corner::NorthWest);
        doing(&mut table);
        assert!(table.shut(), "{name}: {:?}", table.door.phase());
    }
}

#[test]
fn fingers_elsewhere_do_not_disturb_whoever_holds() {
    let mut table = Table::new(Corner::NorthWest);
    table.touch(9, Phase::Down, OUTSIDE);
    table.touch(1, Phase::Down, CORNER);
    table.wait(1000);
    table.touch(9, Phase::Move, OUTSIDE * 2.0);
    table.touch(9, Phase::Up, OUTSIDE * 2.0);
    table.wait(2000);
    assert!(!table.shut());
}

#[test]
fn the_pin_opens_the_menu_and_digits_can_be_taken_back() {
    let mut table = Table::opened();
    for digit in [2, 5, 7] {
        table.door.digit(digit, table.now_ms);
    }
    table.door.erase(table.now_ms);
    for digit in [8, 0] {
        table.door.digit(digit, table.now_ms);
    }
    assert_eq!(table.door.phase(), DoorPhase::Keypad { digits: 4, wrong: 0 });
    table.door.enter(table.now_ms);
    assert_eq!(table.door.phase(), DoorPhase::Menu);
    table.door.close();
    assert_eq!(table.door.phase(), DoorPhase::Shut);
}

#[test]
fn five_wrong_pins_lock_the_door_for_a_minute_also_for_the_right_one() {
    let mut table = Table::opened();
    table.door.enter(table.now_ms);
    assert_eq!(
        table.door.phase(),
        DoorPhase::Keypad { digits: 0, wrong: 0 },
        "none typed"
    );
    for wrong in 1..5 {
        table.pin("1234");
        assert_eq!(table.door.phase(), DoorPhase::Keypad { digits: 0, wrong });
    }
    table.pin("25800000");
    assert_eq!(table.door.phase(), DoorPhase::Locked { left_ms: 60_000 });
    table.pin("2580");
    assert!(matches!(table.door.phase(), DoorPhase::Locked { .. }));
    // To close it and to come again does not help.
    table.door.close();
    table.touch(5, Phase::Down, CORNER);
    table.wait(3000);
    table.touch(5, Phase::Up, CORNER);
    assert_eq!(table.door.phase(), DoorPhase::Locked { left_ms: 57_000 });
    table.wait(57_000);
    table.pin("2580");
    assert_eq!(table.door.phase(), DoorPhase::Menu);
}

#[test]
fn wrong_pins_are_remembered_when_the_door_closes() {
    let mut table = Table::opened();
    for _ in 0..4 {
        table.pin("0000");
    }
    table.door.close();
    table.touch(5, Phase::Down, CORNER);
    table.wait(3000);
    assert_eq!(table.door.phase(), DoorPhase::Keypad { digits: 0, wrong: 4 });
    table.pin("0000");
    assert!(matches!(table.door.phase(), DoorPhase::Locked { .. }));
}

#[test]
fn what_is_open_closes_when_nobody_uses_it() {
    let mut keypad = Table::opened();
    keypad.door.digit(2, keypad.now_ms);
    keypad.wait(59_900);
    assert!(!keypad.shut());
    keypad.wait(200);
    assert_eq!(keypad.door.phase(), DoorPhase::Shut);
    let mut menu = Table::opened();
    menu.pin("2580");
    for _ in 0..5 {
        menu.wait(50_000);
        menu.door.stir(menu.now_ms);
        assert_eq!(menu.door.phase(), DoorPhase::Menu);
    }
    menu.wait(60_000);
    assert_eq!(menu.door.phase(), DoorPhase::Shut);
}

#[test]
fn a_bag_in_the_corner_opens_the_keypad_once() {
    let mut table = Table::new(Corner::NorthWest);
    table.touch(1, Phase::Down, CORNER);
    table.wait(3000);
    assert!(!table.shut());
    table.wait(600_000);
    assert_eq!(table.door.phase(), DoorPhase::Shut);
}

#[test]
fn a_clock_that_jumps_neither_opens_nor_unlocks() {
    let mut table = Table::new(Corner::NorthWest);
    table.touch(1, Phase::Down, CORNER);
    table.now_ms += 3_600_000;
    table.door.tick(table.now_ms);
    table.now_ms = 0;
    table.door.tick(table.now_ms);
    assert!(table.shut());
    table.wait(2000);
    assert!(!table.shut());
    for _ in 0..5 {
        table.pin("1111");
    }
    table.now_ms += 3_600_000;
    table.door.tick(table.now_ms);
    let DoorPhase::Locked { left_ms } = table.door.phase() else {
        panic!("{:?}", table.door.phase());
    };
    assert!(left_ms >= 59_000);
}

proptest! {
    /// Whatever is done, the menu is only reached by the PIN.
    #[test]
    fn nobody_comes_in_without_the_pin(
        steps in prop::collection::vec((0..9_u8, 0..10_u8, 0..4000_u64), 0..200)
    ) {
        let mut table = Table::opened();
        let mut typed = String::new();
        for (what, digit, ms) in steps {
            match what {
                0..=3 => {
                    table.door.digit(digit, table.now_ms);
                    if matches!(table.door.phase(), DoorPhase::Keypad { .. }) && typed.len() < 8 {
                        typed.push(char::from(b'0' + digit));
                    }
                }
                4 => {
                    table.door.erase(table.now_ms);
                    typed.pop();
                }
                5 => {
                    // The one way in is shut.
                    if typed == "2580" {
                        table.door.digit(0, table.now_ms);
                    }
                    table.door.enter(table.now_ms);
                    typed.clear();
                }
                6 => table.touch(1, Phase::Down, CORNER),
                7 => table.touch(1, Phase::Up, CORNER),
                _ => table.wait(ms),
            }
            if table.shut() {
                typed.clear();
            }
            prop_assert!(table.door.phase() != DoorPhase::Menu);
        }
    }
}
