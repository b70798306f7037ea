//! The keypad and the menu for staff.
//!
//! Whether the door is open, and whether a PIN is right, is decided elsewhere ([`DoorPhase`]); here is what is seen
//! and pressed. Everything that is pressed comes out as a [`StaffAction`]: nothing is done here.
//!
//! Both are panels in the middle, upright for the south side, with targets of 44 points and more.

mod editor;
mod health;
mod keypad;
mod menu;
pub(super) mod style;

use egui::{Align2, Area, Context, Id, Order, Painter, Rect};
use glam::DVec2;

use super::ease;
use super::palette::{LAMP, faded};
use super::pen::{Line, Pen};
use super::sight::Sight;
use crate::kiosk::DoorPhase;
use crate::settings::Settings;

pub use health::{ContactHealth, Health};
pub use style::scale_for;

/// Least side of anything that is pressed, points at scale 1.
pub(super) const TARGET: f32 = 48.0;

/// What a member of staff has pressed.
#[derive(Clone, Debug, PartialEq)]
pub enum StaffAction {
    /// A digit of the PIN, 0 to 9.
    Digit(u8),
    /// The last digit goes.
    Erase,
    /// The PIN is complete.
    Enter,
    /// The panel closes.
    Leave,
    /// The program ends.
    Quit,
    /// The land starts afresh.
    RestartLand,
    /// The panel of rock layers opens.
    Layers,
    /// The contacts of the last 60 s are written to a gesture file.
    SaveContacts,
    /// The land is written to files.
    SaveLand,
    /// The land is worked out at final quality, and written.
    FinalLand,
    /// Not after all.
    CancelFinal,
    /// Touches do nothing for a while, so that the table can be wiped.
    Clean,
    /// Four crosses are touched, to show how the touching surface lies.
    Calibrate,
    /// These settings are taken and written to the file.
    Apply(Box<Settings>),
}

/// What is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Page {
    Actions,
    Health,
    /// The settings of one section of the file.
    Section(&'static str),
}

/// A button that is pressed twice before it acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Armed {
    Quit,
    Restart,
}

/// The panels' memory: which page is open, and settings that are not saved yet.
#[derive(Clone, Debug)]
pub struct StaffPanel {
    page: Page,
    armed: Option<Armed>,
    /// Settings as the editor has them, from the first change to saving.
    draft: Option<Settings>,
    /// A PIN that is being typed.
    pin: Option<String>,
}

/// What was drawn and pressed.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// What was pressed.
    pub actions: Vec<StaffAction>,
    /// Where the panel is, points; contacts there are its own. `None` when nothing is shown.
    pub rect: Option<Rect>,
}

/// What the panels show.
#[derive(Clone, Copy, Debug)]
pub struct StaffView<'a> {
    /// Where the door is.
    pub door: DoorPhase,
    /// The settings in force.
    pub settings: &'a Settings,
    /// How the table is.
    pub health: &'a Health<'a>,
    /// What became of the last action ("saved as …", or why not); shown at the foot of the menu.
    pub notice: Option<&'a str>,
    /// How much of a final land is done, 0–1; none while none is made.
    pub final_done: Option<f32>,
    /// Size of letters and targets, as [`scale_for`] says.
    pub scale: f32,
}

/// Draws how far the staff's corner (`corner_mm`, table mm) has been held: a ring that a quiet one grows into.
pub fn draw_hold(painter: &Painter, sight: &Sight<'_>, corner_mm: DVec2, progress: f64) {
    const RADIUS: f32 = 60.0;
    let pen = Pen::new(painter, sight);
    if let Some(corner) = sight.of_table(corner_mm) {
        let part = ease::smooth(progress);
        pen.ring(corner, RADIUS, Line::solid(LAMP, 0.35 * part, 0.8));
        pen.glow(corner, RADIUS * part, 6.0, 2.0, faded(LAMP, 0.25 * part));
        pen.ring(corner, RADIUS * part, Line::solid(LAMP, 0.8 * part, 1.2));
    }
}

impl Default for StaffPanel {
    fn default() -> Self {
        Self {
            page: Page::Actions,
            armed: None,
            draft: None,
            pin: None,
        }
    }
}

impl StaffPanel {
    /// Shows what the door asks for, and forgets what was not saved when it shuts.
    pub fn show(&mut self, context: &Context, view: &StaffView<'_>) -> Shown {
        let mut actions = Vec::new();
        match view.door {
            DoorPhase::Shut | DoorPhase::Holding { .. } => {
                *self = Self::default();
                return Shown::default();
            }
            DoorPhase::Keypad { .. } | DoorPhase::Locked { .. } | DoorPhase::Menu => {}
        }
        let area = Area::new(Id::unique("staff"))
            .order(Order::Foreground)
            .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .movable(false)
            .fade_in(false);
        let shown = area.show(context, |ui| {
            style::apply(ui, view.scale);
            style::panel(view.scale).show(ui, |ui| match view.door {
                DoorPhase::Menu => self.menu(ui, view, &mut actions),
                DoorPhase::Keypad { digits, wrong } => {
                    let state = keypad::State::Open { digits, wrong };
                    keypad::show(ui, state, view.scale, &mut actions);
                }
                DoorPhase::Locked { left_ms } => {
                    keypad::show(ui, keypad::State::Locked { left_ms }, view.scale, &mut actions);
                }
                DoorPhase::Shut | DoorPhase::Holding { .. } => {}
            });
        });
        Shown {
            actions,
            rect: Some(shown.response.rect),
        }
    }
}
