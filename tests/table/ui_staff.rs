//! The staff's keypad and menu, pressed as a person presses them: by what is written on the buttons.

#![cfg(feature = "app")]

use egui::accesskit::Role;
use egui::{Context, Rect, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::DVec2;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, Phase, Source};
use orogen::kiosk::{DoorParams, DoorPhase, StaffDoor};
use orogen::settings::{Domain, KEYS, Settings, Value};
use orogen::ui::staff::{ContactHealth, Health, StaffAction, StaffPanel, StaffView, scale_for};
use proptest::prelude::*;

/// Least side of a target, points.
const TARGET: f32 = 44.0;

const SCREEN: Vec2 = Vec2::new(1280.0, 720.0);

/// A table whose staff's door is real.
struct Table {
    door: StaffDoor,
    now_ms: u64,
    panel: StaffPanel,
    settings: Settings,
    actions: Vec<StaffAction>,
    rect: Option<Rect>,
}

impl Table {
    /// A table whose corner has been held for long enough.
    fn at_the_keypad() -> Self {
        let settings = Settings::default();
        let size_mm = DVec2::new(1209.6, 680.4);
        let mut door = StaffDoor::new(DoorParams {
            pin: settings.staff.pin.clone(),
            corner: settings.staff.corner,
            size_mm,
        });
        let contact = Contact {
            key: ContactKey {
                source: Source::Window,
                device: 0,
                id: 1,
                generation: 0,
            },
            position: settings.staff.corner.position(size_mm).lerp(size_mm / 2.0, 0.02),
            size_mm: None,
            confidence: None,
        };
        let phase = Phase::Down;
        door.feed(&ContactEvent { phase, contact }, 0);
        let mut now_ms = 0;
        while matches!(door.phase(), DoorPhase::Holding { .. }) {
            now_ms += 16;
            door.tick(now_ms);
        }
        Self {
            door,
            now_ms,
            panel: StaffPanel::default(),
            settings,
            actions: Vec::new(),
            rect: None,
        }
    }

    fn at_the_menu() -> Self {
        let mut table = Self::at_the_keypad();
        for digit in table.settings.staff.pin.bytes() {
            table.door.digit(digit - b'0', table.now_ms);
        }
        table.door.enter(table.now_ms);
        table
    }

    fn run(&mut self, context: &Context) {
        let view = StaffView {
            door: self.door.phase(),
            settings: &self.settings,
            health: &Health::default(),
            notice: None,
            final_done: None,
            scale: scale_for(SCREEN, 1.0),
        };
        let shown = self.panel.show(context, &view);
        self.rect = shown.rect;
        for action in shown.actions {
            match action {
                StaffAction::Digit(digit) => self.door.digit(digit, self.now_ms),
                StaffAction::Enter => self.door.enter(self.now_ms),
                StaffAction::Erase => self.door.erase(self.now_ms),
                action => self.actions.push(action),
            }
        }
    }
}

fn harness(table: Table) -> Harness<'static, Table> {
    let mut harness = Harness::builder()
        .with_size(SCREEN)
        .build_ui_state(|ui, table: &mut Table| table.run(&ui.ctx().clone()), table);
    harness.run_steps(3);
    harness
}

fn press(harness: &mut Harness<'_, Table>, label: &str) {
    harness.get_by_label(label).click();
    harness.run_steps(3);
}

fn actions(harness: &mut Harness<'_, Table>) -> Vec<StaffAction> {
    std::mem::take(&mut harness.state_mut().actions)
}

#[test]
fn the_right_pin_opens_and_a_wrong_one_says_so() {
    let mut harness = harness(Table::at_the_keypad());
    for key in ["1", "2", "3", "4", "Enter"] {
        press(&mut harness, key);
    }
    assert!(harness.query_by_label("Wrong PIN").is_some());
    assert!(harness.query_by_label("Save the land").is_none());
    for key in ["9", "Erase", "2", "5", "8", "0", "Enter"] {
        press(&mut harness, key);
    }
    assert_eq!(harness.state().door.phase(), DoorPhase::Menu);
    assert!(harness.query_by_label("Save the land").is_some());
}

#[test]
fn a_locked_door_says_so_takes_no_digits_and_can_be_left() {
    let mut harness = harness(Table::at_the_keypad());
    for _ in 0..20 {
        for key in ["1", "Enter"] {
            press(&mut harness, key);
        }
    }
    assert!(matches!(harness.state().door.phase(), DoorPhase::Locked { .. }));
    let digit = harness.get_by_label("7");
    assert!(digit.accesskit_node().is_disabled());
    assert!(harness.query_by_label_contains("Locked for").is_some());
    press(&mut harness, "Close");
    assert_eq!(actions(&mut harness), [StaffAction::Leave]);
}

#[test]
fn each_button_of_the_menu_does_what_it_says_and_grave_ones_ask_first() {
    let mut harness = harness(Table::at_the_menu());
    for (label, action) in [
        ("Save the land", StaffAction::SaveLand),
        ("Layers of rock", StaffAction::Layers),
        ("Save the last 60 s of touches", StaffAction::SaveContacts),
        ("Clean the table: 30 s without touch", StaffAction::Clean),
        ("Calibrate touch at four crosses", StaffAction::Calibrate),
        ("Back to the table", StaffAction::Leave),
    ] {
        press(&mut harness, label);
        assert_eq!(actions(&mut harness), [action]);
    }
    for (first, second, action) in [
        (
            "Start the land afresh",
            "Press again to start afresh",
            StaffAction::RestartLand,
        ),
        ("Close the program", "Press again to close", StaffAction::Quit),
    ] {
        press(&mut harness, first);
        assert!(actions(&mut harness).is_empty(), "{first} asks first");
        press(&mut harness, second);
        assert_eq!(actions(&mut harness), [action]);
    }
    press(&mut harness, "Close the program");
    press(&mut harness, "Save the land");
    assert!(
        harness.query_by_label("Press again to close").is_none(),
        "another button calms it"
    );
}

#[test]
fn steps_and_switches_change_the_draft_and_save_hands_it_over() {
    let mut harness = harness(Table::at_the_menu());
    press(&mut harness, "Visits");
    press(&mut harness, "More: Idle s");
    press(&mut harness, "Attract");
    press(&mut harness, "Reset hours never");
    press(&mut harness, "View");
    press(&mut harness, "Visits");
    press(&mut harness, "Save settings");
    let mut expected = Settings::default();
    expected.kiosk.idle_s += 5.0;
    expected.kiosk.attract = false;
    expected.kiosk.reset_hours = None;
    assert_eq!(actions(&mut harness), [StaffAction::Apply(Box::new(expected))]);
    press(&mut harness, "Discard");
    press(&mut harness, "Save settings");
    assert!(actions(&mut harness).is_empty(), "nothing is left to be saved");
}

#[test]
fn settings_stay_in_bounds_however_often_their_buttons_are_pressed() {
    for key in KEYS {
        let Domain::Number(bound) = key.domain else {
            continue;
        };
        for (button, end) in [("More: ", bound.max), ("Less: ", bound.min)] {
            let mut harness = harness(Table::at_the_menu());
            assert!(key.put(&mut harness.state_mut().settings, &Value::Number(end)));
            harness.run_steps(2);
            open_section(&mut harness, key.section);
            let label = format!("{button}{}", spoken(key.name));
            press(&mut harness, &label);
            assert!(
                harness
                    .query_by_label("Save settings")
                    .is_some_and(|b| b.accesskit_node().is_disabled()),
                "{label} past its end changes nothing"
            );
        }
    }
}

#[test]
fn a_calibration_is_read_and_taken_away() {
    let calibration = KEYS.iter().find(|key| key.name == "calibration").expect("a key");
    let mut harness = harness(Table::at_the_menu());
    let text = Value::Text("1.02 0 0 0.98 -0.01 0.01".to_owned());
    assert!(calibration.put(&mut harness.state_mut().settings, &text));
    press(&mut harness, "Table");
    assert!(harness.query_by_label("1.02 0 0 0.98 -0.01 0.01").is_some());
    press(&mut harness, "Take away: Calibration");
    press(&mut harness, "Save settings");
    let expected = Settings::default();
    assert_eq!(actions(&mut harness), [StaffAction::Apply(Box::new(expected))]);
}

#[test]
fn a_new_pin_is_typed_on_the_table() {
    let mut harness = harness(Table::at_the_menu());
    press(&mut harness, "Staff");
    press(&mut harness, "Change the PIN");
    for key in ["4", "7", "1"] {
        press(&mut harness, key);
    }
    press(&mut harness, "Enter");
    assert!(
        harness.query_by_label("New PIN: 471").is_some(),
        "three digits are too few"
    );
    press(&mut harness, "1");
    press(&mut harness, "Enter");
    press(&mut harness, "Save settings");
    let mut expected = Settings::default();
    expected.staff.pin = "4711".to_owned();
    assert_eq!(actions(&mut harness), [StaffAction::Apply(Box::new(expected))]);
}

#[test]
fn targets_are_large_and_on_the_screen_on_every_page() {
    let mut pages = vec!["Now", "Health"];
    pages.extend([
        "World", "Table", "Touch", "Land", "Visits", "Staff", "Quality", "View", "Files",
    ]);
    let mut harness = harness(Table::at_the_menu());
    for page in pages {
        press(&mut harness, page);
        check_targets(&harness, page);
    }
    check_targets(&self::harness(Table::at_the_keypad()), "keypad");
}

fn check_targets(harness: &Harness<'_, Table>, page: &str) {
    let screen = Rect::from_min_size(egui::Pos2::ZERO, SCREEN);
    let panel = harness.state().rect.expect("a panel");
    assert!(screen.contains_rect(panel), "{page}: {panel}");
    for role in [Role::Button, Role::CheckBox, Role::Slider] {
        for node in harness.query_all_by_role(role) {
            let rect = node.rect();
            let label = node.accesskit_node().label().unwrap_or_default();
            assert!(rect.height() >= TARGET, "{page}: {role:?} {label:?} is {rect}");
            assert!(
                rect.width() >= TARGET || role == Role::Slider,
                "{page}: {role:?} {label:?} is {rect}"
            );
            assert!(
                screen.contains_rect(rect),
                "{page}: {label:?} at {rect} is off the screen"
            );
        }
    }
}

fn open_section(harness: &mut Harness<'_, Table>, section: &str) {
    let name = match section {
        "" => "World",
        "table" => "Table",
        "input" => "Touch",
        "land" => "Land",
        "kiosk" => "Visits",
        "staff" => "Staff",
        "quality" => "Quality",
        "view" => "View",
        _ => "Files",
    };
    press(harness, name);
}

fn spoken(name: &str) -> String {
    let words = name.replace('_', " ");
    words[..1].to_uppercase() + &words[1..]
}

fn doors() -> impl Strategy<Value = DoorPhase> {
    prop_oneof![
        Just(DoorPhase::Shut),
        any::<f64>().prop_map(|progress| DoorPhase::Holding { progress }),
        (any::<usize>(), any::<u32>()).prop_map(|(digits, wrong)| DoorPhase::Keypad { digits, wrong }),
        any::<u64>().prop_map(|left_ms| DoorPhase::Locked { left_ms }),
        Just(DoorPhase::Menu),
    ]
}

/// Shows the panel at each of `phases`, whatever the numbers.
fn show_all(
    phases: &[DoorPhase],
    numbers: [f64; 8],
    (scale, points_per_mm): (f32, f32),
    notice: Option<&str>,
) {
    let contacts: Vec<ContactHealth> = numbers
        .iter()
        .map(|&n| ContactHealth {
            at_mm: DVec2::splat(n),
            age_s: n,
        })
        .collect();
    let health = Health {
        version: "1",
        adapter: "none",
        uptime_s: numbers[0],
        frame_ms: (numbers[1], numbers[2]),
        touch_ms: (numbers[3], numbers[4]),
        steps_per_s: numbers[5],
        contacts: &contacts,
        ..Health::default()
    };
    let settings = Settings::default();
    let mut panel = StaffPanel::default();
    let context = Context::default();
    for &door in phases {
        let view = StaffView {
            door,
            settings: &settings,
            health: &health,
            notice,
            final_done: Some(0.4),
            scale: scale_for(Vec2::splat(scale), points_per_mm),
        };
        let input = egui::RawInput {
            screen_rect: Some(Rect::from_min_size(egui::Pos2::ZERO, SCREEN)),
            ..Default::default()
        };
        let mut output = context.run_pass(input, |context| {
            let _ = panel.show(context, &view);
        });
        output.textures_delta.clear();
    }
}

#[test]
fn numbers_beyond_all_sense_are_shown() {
    let numbers = [
        -2.76e289, 0.0, -1.42e-235, 1.51e-242, 6.47e-309, -4.41e16, -7.37e-309, -3.32e174,
    ];
    let keypad = DoorPhase::Keypad { digits: 0, wrong: 0 };
    show_all(&[keypad], numbers, (7.47e-24, -1.58e26), Some("*K?మ\u{c4116}"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn no_state_of_door_and_table_panics(
        phases in prop::collection::vec(doors(), 1..4),
        numbers in prop::array::uniform8(any::<f64>()),
        scale in any::<f32>(),
        points_per_mm in any::<f32>(),
        notice in proptest::option::of(".{0,40}"),
    ) {
        show_all(&phases, numbers, (scale, points_per_mm), notice.as_deref());
    }
}
