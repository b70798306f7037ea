//! The menu: pages on the left, what they hold on the right.

use egui::{Button, Layout, ProgressBar, RichText, Ui, Vec2, vec2};

use super::{Armed, Page, StaffAction, StaffPanel, StaffView, TARGET, health};
use crate::settings::KEYS;
use crate::ui::palette::{AMBER, LAMP};

/// Width of the pages' names and of what they hold, and height of both, points at scale 1.
const SIZE: (f32, f32, f32) = (170.0, 680.0, 640.0);

impl StaffPanel {
    pub(super) fn menu(&mut self, ui: &mut Ui, view: &StaffView<'_>, actions: &mut Vec<StaffAction>) {
        let scale = view.scale;
        let (names, page, tall) = (SIZE.0 * scale, SIZE.1 * scale, SIZE.2 * scale);
        ui.horizontal_top(|ui| {
            let column = |ui: &mut Ui, width: f32, add: &mut dyn FnMut(&mut Ui)| {
                let top_down = Layout::top_down(egui::Align::Min);
                ui.allocate_ui_with_layout(vec2(width, tall), top_down, |ui| {
                    ui.set_min_size(vec2(width, tall));
                    ui.set_max_width(width);
                    add(ui);
                });
            };
            column(ui, names, &mut |ui| self.names(ui, view, actions));
            ui.add_space(8.0 * scale);
            column(ui, page, &mut |ui| {
                match self.page {
                    Page::Actions => self.actions(ui, view, actions),
                    Page::Health => health::show(ui, view.health),
                    Page::Section(section) => self.section(ui, view, section, actions),
                }
                if let Some(notice) = view.notice {
                    ui.add_space(6.0 * scale);
                    ui.label(RichText::new(notice).color(AMBER));
                }
            });
        });
    }

    fn names(&mut self, ui: &mut Ui, view: &StaffView<'_>, actions: &mut Vec<StaffAction>) {
        let size = vec2(ui.available_width(), TARGET * view.scale);
        let mut pages = vec![("Now", Page::Actions), ("Health", Page::Health)];
        let mut sections: Vec<&'static str> = KEYS.iter().map(|key| key.section).collect();
        sections.dedup();
        pages.extend(sections.into_iter().map(|s| (section_name(s), Page::Section(s))));
        for (name, page) in pages {
            if ui
                .add_sized(size, Button::selectable(self.page == page, name))
                .clicked()
            {
                self.page = page;
                self.armed = None;
                self.pin = None;
            }
        }
        ui.add_space(TARGET * 0.25 * view.scale);
        if ui.add_sized(size, Button::new("Back to the table")).clicked() {
            actions.push(StaffAction::Leave);
        }
    }

    fn actions(&mut self, ui: &mut Ui, view: &StaffView<'_>, actions: &mut Vec<StaffAction>) {
        let size = vec2(ui.available_width().min(470.0 * view.scale), 64.0 * view.scale);
        if let Some(done) = view.final_done {
            let bar = ProgressBar::new(done).text(format!("Final land: {:.0} %", 100.0 * done));
            ui.add_sized(size, bar);
            if ui.add_sized(size, Button::new("Cancel the final land")).clicked() {
                actions.push(StaffAction::CancelFinal);
            }
        } else {
            for (name, action) in [
                ("Save the land", StaffAction::SaveLand),
                ("Make the final land: some minutes", StaffAction::FinalLand),
            ] {
                if ui.add_sized(size, Button::new(name)).clicked() {
                    actions.push(action);
                    self.armed = None;
                }
            }
        }
        for (name, action) in [
            ("Layers of rock", StaffAction::Layers),
            ("Save the last 60 s of touches", StaffAction::SaveContacts),
            ("Clean the table: 30 s without touch", StaffAction::Clean),
            ("Calibrate touch at four crosses", StaffAction::Calibrate),
        ] {
            if ui.add_sized(size, Button::new(name)).clicked() {
                actions.push(action);
                self.armed = None;
            }
        }
        ui.add_space(16.0 * view.scale);
        self.twice(ui, size, Armed::Restart, StaffAction::RestartLand, actions);
        self.twice(ui, size, Armed::Quit, StaffAction::Quit, actions);
    }

    /// A button whose first press only asks.
    fn twice(
        &mut self,
        ui: &mut Ui,
        size: Vec2,
        which: Armed,
        action: StaffAction,
        actions: &mut Vec<StaffAction>,
    ) {
        let armed = self.armed == Some(which);
        let text = match (which, armed) {
            (Armed::Restart, false) => "Start the land afresh",
            (Armed::Restart, true) => "Press again to start afresh",
            (Armed::Quit, false) => "Close the program",
            (Armed::Quit, true) => "Press again to close",
        };
        let text = RichText::new(text).color(if armed { AMBER } else { LAMP });
        if ui.add_sized(size, Button::new(text)).clicked() {
            if armed {
                actions.push(action);
            }
            self.armed = (!armed).then_some(which);
        }
    }
}

/// How a section of the file is named in the menu.
fn section_name(section: &'static str) -> &'static str {
    match section {
        "" => "World",
        "table" => "Table",
        "input" => "Touch",
        "land" => "Land",
        "kiosk" => "Visits",
        "staff" => "Staff",
        "quality" => "Quality",
        "view" => "View",
        "files" => "Files",
        other => other,
    }
}
