//! The panel of rock layers: choose a pile, change its layers, lay it under the land.
//!
//! What is pressed comes out as a [`LayersAction`]: nothing is done here. A panel in the middle, upright for the south
//! side, as the staff's.

use std::sync::Arc;

use egui::{
    Align2, Area, Button, Color32, Context, FontId, Grid, Id, Order, Rect, RichText, ScrollArea, Sense,
    Slider, SliderClamping, Stroke, TextEdit, Ui, pos2, vec2,
};

use super::palette::{AMBER, LAMP};
use super::staff::{TARGET, style};
use crate::rock::{Basement, Bound, Layer, MAX_BEDS, MAX_LAYERS, Stratigraphy, bounds, preset};

/// Size of the drawn pile, points at scale 1.
const COLUMN: (f32, f32) = (250.0, 430.0);

/// Least height of a layer in it, so that a finger can choose it.
const LEAST_ROW: f32 = 24.0;

/// Part of the drawn pile's height that is the basement.
const BASEMENT: f32 = 0.1;

/// Most characters of a file's name.
const MAX_NAME: usize = 40;

/// What somebody has pressed.
#[derive(Clone, Debug, PartialEq)]
pub enum LayersAction {
    /// This pile is laid under the land.
    Lay(Arc<Stratigraphy>),
    /// It is kept under this name: letters, digits, `-` and `_`.
    Save(String, Arc<Stratigraphy>),
    /// The pile that was kept under this name is shown.
    Load(String),
    /// The panel closes.
    Close,
}

/// What the panel shows.
#[derive(Clone, Copy, Debug)]
pub struct LayersView<'a> {
    /// The pile under the land.
    pub pile: &'a Arc<Stratigraphy>,
    /// Names of the piles that have been kept.
    pub saved: &'a [String],
    /// Wavelength (m) of a layer's folds: its thickness (m), that of the softer layer below (m), and how many times as
    /// viscous it is.
    pub wavelength: fn(f64, f64, f64) -> f64,
    /// What became of the last action, at the foot.
    pub notice: Option<&'a str>,
    /// Size of letters and targets, as [`super::staff::scale_for`] says.
    pub scale: f32,
}

/// What was drawn and pressed.
#[derive(Clone, Debug)]
pub struct LayersShown {
    /// What was pressed.
    pub actions: Vec<LayersAction>,
    /// Where the panel is, points.
    pub rect: Rect,
}

/// The panel's memory: a pile that is being changed.
#[derive(Clone, Debug, Default)]
pub struct LayersPanel {
    draft: Option<Draft>,
}

/// A pile whose numbers need not yet make one.
#[derive(Clone, Debug)]
struct Draft {
    name: String,
    title: String,
    layers: Vec<Layer>,
    basement: Basement,
    selected: usize,
}

impl Draft {
    fn of(pile: &Stratigraphy) -> Self {
        Self {
            name: pile.name().to_owned(),
            title: pile.title().to_owned(),
            layers: pile.layers().to_vec(),
            basement: pile.basement().clone(),
            selected: 0,
        }
    }

    /// The pile, or why it is none.
    fn pile(&self) -> Result<Arc<Stratigraphy>, String> {
        // What has been changed is no longer the preset of that name.
        let known = preset::by_name(&self.name).filter(|known| self.is(known));
        if let Some(known) = known {
            return Ok(known);
        }
        let name = if preset::by_name(&self.name).is_some() {
            format!("my_{}", self.name)
        } else {
            self.name.clone()
        };
        Stratigraphy::new(
            name,
            self.title.clone(),
            self.layers.clone(),
            self.basement.clone(),
        )
        .map(Arc::new)
        .map_err(|error| error.to_string())
    }

    fn is(&self, pile: &Stratigraphy) -> bool {
        self.layers == pile.layers() && self.basement == *pile.basement()
    }
}

impl LayersPanel {
    /// Shows this pile, whatever was changed before.
    pub fn open(&mut self, pile: &Stratigraphy) {
        self.draft = Some(Draft::of(pile));
    }

    /// Draws the panel.
    pub fn show(&mut self, context: &Context, view: &LayersView<'_>) -> LayersShown {
        let mut actions = Vec::new();
        let mut draft = self.draft.take().unwrap_or_else(|| Draft::of(view.pile));
        let area = Area::new(Id::unique("layers"))
            .order(Order::Foreground)
            .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .movable(false)
            .fade_in(false);
        let shown = area.show(context, |ui| {
            style::apply(ui, view.scale);
            ui.style_mut().spacing.slider_width = 210.0 * view.scale;
            ui.style_mut().spacing.item_spacing = vec2(10.0, 6.0) * view.scale;
            style::panel(view.scale).show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    ui.vertical(|ui| piles(ui, view, &mut draft, &mut actions));
                    ui.vertical(|ui| column(ui, &mut draft, view.scale));
                    ui.vertical(|ui| editor(ui, view, &mut draft));
                });
                foot(ui, view, &mut draft, &mut actions);
            });
        });
        self.draft = Some(draft);
        LayersShown {
            actions,
            rect: shown.response.rect,
        }
    }
}

/// Presets, and what has been kept.
fn piles(ui: &mut Ui, view: &LayersView<'_>, draft: &mut Draft, actions: &mut Vec<LayersAction>) {
    let size = vec2(170.0, TARGET) * view.scale;
    style::heading(ui, "Rock");
    for pile in preset::names().iter().filter_map(|name| preset::by_name(name)) {
        let button = Button::selectable(draft.is(&pile), pile.title()).min_size(size);
        if ui.add(button).clicked() {
            *draft = Draft::of(&pile);
        }
    }
    if !view.saved.is_empty() {
        ui.label(RichText::new("Kept").small().color(style::quiet()));
        ScrollArea::vertical()
            .max_height(2.4 * TARGET * view.scale)
            .show(ui, |ui| {
                for name in view.saved {
                    if ui.add(Button::new(name).min_size(size)).clicked() {
                        actions.push(LayersAction::Load(name.clone()));
                    }
                }
            });
    }
}

/// The pile as a drawn column: thicker layers are higher, hard beds stand out.
fn column(ui: &mut Ui, draft: &mut Draft, scale: f32) {
    let size = vec2(COLUMN.0, COLUMN.1) * scale;
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter().clone();
    let total: f64 = draft.layers.iter().map(|layer| layer.thickness_m).sum();
    let least = LEAST_ROW * scale;
    let room = rect.height() * (1.0 - BASEMENT) - least * draft.layers.len() as f32;
    let mut top = rect.top();
    let width = rect.width() * 0.42;
    let letters = FontId::proportional(14.0 * scale);
    let mut depth_m = 0.0;
    for (i, layer) in draft.layers.iter().enumerate() {
        let height = least + room.max(0.0) * (layer.thickness_m / total) as f32;
        let row = Rect::from_min_size(pos2(rect.left(), top), vec2(rect.width(), height));
        let rock = row.with_max_x(rect.left() + width);
        painter.rect_filled(rock, 0.0, colour(layer.rock.colour));
        beds(&painter, rock, layer);
        let chosen = draft.selected == i;
        let ink = if chosen { AMBER } else { LAMP };
        let at = pos2(rock.right() + 8.0 * scale, row.top() + 3.0 * scale);
        painter.text(at, Align2::LEFT_TOP, &layer.name, letters.clone(), ink);
        if height > 2.0 * least {
            let under = at + vec2(0.0, 17.0 * scale);
            let words = format!("{:.0} m, top at {depth_m:.0} m", layer.thickness_m);
            let small = FontId::proportional(12.0 * scale);
            painter.text(under, Align2::LEFT_TOP, words, small, style::quiet());
        }
        if chosen {
            painter.rect_stroke(rock, 0.0, Stroke::new(2.5, AMBER), egui::StrokeKind::Inside);
        }
        let response = ui.interact(row, Id::unique(("layer", i)), Sense::click());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &layer.name));
        if response.clicked() {
            draft.selected = i;
        }
        top += height;
        depth_m += layer.thickness_m;
    }
    let rock = Rect::from_min_max(pos2(rect.left(), top), pos2(rect.left() + width, rect.bottom()));
    painter.rect_filled(rock, 0.0, colour(draft.basement.rock.colour));
    let at = pos2(rock.right() + 8.0 * scale, rock.center().y);
    painter.text(
        at,
        Align2::LEFT_CENTER,
        &draft.basement.name,
        letters,
        style::quiet(),
    );
}

/// Weak beds are shaded by how much they differ from the hard ones.
fn beds(painter: &egui::Painter, rock: Rect, layer: &Layer) {
    let step = rock.height() / f32::from(layer.beds.max(1));
    let shade = Color32::BLACK.gamma_multiply(0.06 + 0.22 * layer.contrast as f32);
    for bed in (1..layer.beds).step_by(2) {
        let top = rock.top() + step * f32::from(bed);
        let weak = Rect::from_min_size(pos2(rock.left(), top), vec2(rock.width(), step));
        painter.rect_filled(weak, 0.0, shade);
    }
    painter.line_segment(
        [rock.left_bottom(), rock.right_bottom()],
        Stroke::new(1.0, Color32::BLACK.gamma_multiply(0.6)),
    );
}

/// The chosen layer.
fn editor(ui: &mut Ui, view: &LayersView<'_>, draft: &mut Draft) {
    arrange(ui, draft, view.scale);
    let below = draft
        .layers
        .get(draft.selected + 1)
        .map(|below| (below.thickness_m, below.viscosity_pa_s));
    let basement_pa_s = draft.basement.viscosity_pa_s;
    let Some(layer) = draft.layers.get_mut(draft.selected) else {
        ui.label("Only the basement: add a layer.");
        pile_editor(ui, draft, view.scale);
        return;
    };
    Grid::new("layer")
        .num_columns(2)
        .min_row_height(0.8 * TARGET * view.scale)
        .show(ui, |ui| {
            let label = ui.label("Layer");
            ui.add(
                TextEdit::singleline(&mut layer.name)
                    .align(Align2::LEFT_CENTER)
                    .char_limit(MAX_NAME)
                    .desired_width(280.0 * view.scale),
            )
            .labelled_by(label.id);
            ui.end_row();
            number(ui, "Thickness", &mut layer.thickness_m, bounds::THICKNESS, 0);
            power(ui, "Viscosity", &mut layer.viscosity_pa_s, bounds::VISCOSITY);
            number(
                ui,
                "Erodibility",
                &mut layer.rock.erodibility,
                bounds::ERODIBILITY,
                2,
            );
            number(ui, "Talus", &mut layer.rock.talus_deg, bounds::TALUS, 0);
            let label = ui.label("Beds");
            ui.add(Slider::new(&mut layer.beds, 1..=MAX_BEDS).clamping(SliderClamping::Always))
                .labelled_by(label.id);
            ui.end_row();
            number(ui, "Contrast of beds", &mut layer.contrast, bounds::CONTRAST, 2);
            number(ui, "Folding", &mut layer.fold, bounds::FOLD, 2);
            let law = below
                .filter(|below| layer.viscosity_pa_s > below.1)
                .map(|below| (view.wavelength)(layer.thickness_m, below.0, layer.viscosity_pa_s / below.1));
            let stiffer = layer.viscosity_pa_s > below.map_or(basement_pa_s, |below| below.1);
            let label = ui.label("Wavelength").id;
            ui.horizontal(|ui| wavelength(ui, label, &mut layer.wavelength_m, law));
            ui.end_row();
            if layer.fold > 0.0 && !stiffer {
                ui.label("");
                ui.label(
                    RichText::new("Softer than what lies below: it does not fold.")
                        .small()
                        .color(AMBER),
                );
                ui.end_row();
            }
        });
    pile_editor(ui, draft, view.scale);
}

/// What holds for the pile as a whole.
fn pile_editor(ui: &mut Ui, draft: &mut Draft, scale: f32) {
    Grid::new("pile")
        .num_columns(2)
        .min_row_height(0.8 * TARGET * scale)
        .show(ui, |ui| {
            number(
                ui,
                "Uplift of the pile",
                &mut draft.basement.uplift,
                bounds::UPLIFT,
                2,
            );
        });
}

/// A layer comes, goes, or changes its place.
fn arrange(ui: &mut Ui, draft: &mut Draft, scale: f32) {
    let size = vec2(92.0, TARGET) * scale;
    let (i, count) = (draft.selected, draft.layers.len());
    ui.horizontal(|ui| {
        let mut press = |enabled, word: &str| {
            ui.add_enabled(enabled, Button::new(word).min_size(size))
                .clicked()
        };
        if press(i > 0 && i < count, "Up") {
            draft.layers.swap(i, i - 1);
            draft.selected -= 1;
        }
        if press(i + 1 < count, "Down") {
            draft.layers.swap(i, i + 1);
            draft.selected += 1;
        }
        if press(count < MAX_LAYERS, "Add") {
            let like = draft
                .layers
                .get(i)
                .cloned()
                .or_else(|| preset::default().layers().first().cloned());
            let at = (i + 1).min(count);
            draft.layers.splice(at..at, like);
            draft.selected = at;
        }
        if press(i < count, "Remove") {
            draft.layers.remove(i);
            draft.selected = i.min(draft.layers.len().saturating_sub(1));
        }
    });
}

fn number(ui: &mut Ui, name: &str, value: &mut f64, bound: Bound, decimals: usize) {
    let label = ui.label(name);
    let suffix = if bound.unit == "degrees" {
        "°".to_owned()
    } else {
        format!(" {}", bound.unit)
    };
    let slider = Slider::new(value, bound.min..=bound.max)
        .logarithmic(bound.min > 0.0 && bound.max / bound.min > 20.0)
        .clamping(SliderClamping::Always)
        .fixed_decimals(decimals)
        .suffix(suffix.trim_end());
    ui.add(slider).labelled_by(label.id);
    ui.end_row();
}

/// A number over many powers of ten.
fn power(ui: &mut Ui, name: &str, value: &mut f64, bound: Bound) {
    let label = ui.label(name);
    let slider = Slider::new(value, bound.min..=bound.max)
        .logarithmic(true)
        .clamping(SliderClamping::Always)
        .custom_formatter(|value, _| format!("{value:.1e}"))
        .custom_parser(|text| text.trim().parse().ok())
        .suffix(format!(" {}", bound.unit));
    ui.add(slider).labelled_by(label.id);
    ui.end_row();
}

/// By the law of the layers (Eq. 3), or set by hand.
fn wavelength(ui: &mut Ui, label: Id, chosen: &mut Option<f64>, law: Option<f64>) {
    let known = law.map_or("–".to_owned(), |metres| format!("{:.1} km", metres / 1e3));
    let mut by_law = chosen.is_none();
    if ui.checkbox(&mut by_law, format!("Eq. 3: {known}")).changed() {
        let first = law
            .unwrap_or(5_000.0)
            .clamp(bounds::WAVELENGTH.min, bounds::WAVELENGTH.max);
        *chosen = (!by_law).then_some((first / 100.0).round() * 100.0);
    }
    if let Some(metres) = chosen {
        let slider = Slider::new(metres, bounds::WAVELENGTH.min..=bounds::WAVELENGTH.max)
            .logarithmic(true)
            .clamping(SliderClamping::Always)
            .fixed_decimals(0)
            .suffix(" m");
        ui.spacing_mut().slider_width *= 0.5;
        ui.add(slider).labelled_by(label);
    }
}

/// What is done with the pile.
fn foot(ui: &mut Ui, view: &LayersView<'_>, draft: &mut Draft, actions: &mut Vec<LayersAction>) {
    let pile = draft.pile();
    let size = vec2(150.0, TARGET) * view.scale;
    ui.horizontal(|ui| {
        let ready = pile.as_ref().ok();
        let news = ready.is_some_and(|pile| pile != view.pile);
        if ui
            .add_enabled(news, Button::new("Lay it").min_size(size))
            .clicked()
            && let Some(pile) = ready
        {
            actions.push(LayersAction::Lay(Arc::clone(pile)));
        }
        let label = ui.label("Name");
        ui.add(
            TextEdit::singleline(&mut draft.name)
                .align(Align2::LEFT_CENTER)
                .char_limit(MAX_NAME)
                .desired_width(180.0 * view.scale),
        )
        .labelled_by(label.id);
        let names_a_file = is_file_name(&draft.name);
        let keeps = ready.filter(|_| names_a_file);
        if ui
            .add_enabled(keeps.is_some(), Button::new("Keep").min_size(size))
            .clicked()
            && let Some(pile) = keeps
        {
            actions.push(LayersAction::Save(draft.name.clone(), Arc::clone(pile)));
        }
        if ui.add(Button::new("Close").min_size(size)).clicked() {
            actions.push(LayersAction::Close);
        }
    });
    let fault = pile.err();
    if let Some(words) = fault.as_deref().or(view.notice) {
        ui.label(RichText::new(words).color(AMBER));
    }
}

/// True for names that are files' names everywhere.
fn is_file_name(name: &str) -> bool {
    let allowed = |letter: char| letter.is_ascii_alphanumeric() || letter == '-' || letter == '_';
    !name.is_empty() && name.len() <= MAX_NAME && name.chars().all(allowed)
}

fn colour([red, green, blue]: crate::rock::Colour) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_would_leave_the_folder_are_none() {
        for bad in ["", "..", "a/b", "a b", "ä", &"x".repeat(41)] {
            assert!(!is_file_name(bad), "{bad}");
        }
        assert!(is_file_name("my_Jura-2"));
    }

    #[test]
    fn a_changed_preset_is_no_longer_the_preset() {
        let jura = preset::by_name("jura").unwrap();
        let mut draft = Draft::of(&jura);
        assert!(Arc::ptr_eq(&draft.pile().unwrap(), &jura));
        draft.layers[0].thickness_m += 100.0;
        assert_eq!(draft.pile().unwrap().name(), "my_jura");
        draft.layers[0].thickness_m = f64::NAN;
        assert!(draft.pile().is_err());
    }
}
