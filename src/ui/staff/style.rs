//! Calm dark panels, large letters, much room.

use egui::{Color32, CornerRadius, FontId, Frame, Margin, RichText, Stroke, TextStyle, Ui, Vec2, vec2};

use super::TARGET;
use crate::ui::palette::{AMBER, LAMP, ROOM};

/// Least and greatest scale.
const SCALES: (f32, f32) = (0.93, 2.4);

/// What a target should measure on the table, mm.
const TARGET_MM: f32 = 20.0;

/// Size of the menu at scale 1, points.
const MENU: Vec2 = vec2(940.0, 740.0);

/// The scale at which targets are 20 mm wide where the screen (points) has room for that, and never less than 44
/// points; `points_per_mm` is the table's.
pub fn scale_for(screen: Vec2, points_per_mm: f32) -> f32 {
    let wanted = TARGET_MM * points_per_mm / TARGET;
    let room = (screen / MENU).min_elem();
    let scale = wanted.min(room);
    if scale.is_finite() {
        scale.clamp(SCALES.0, SCALES.1)
    } else {
        1.0
    }
}

/// A line or letter of less weight.
pub(in crate::ui) fn quiet() -> Color32 {
    LAMP.gamma_multiply(0.62)
}

/// Dress of the panel.
pub(in crate::ui) fn panel(scale: f32) -> Frame {
    Frame::new()
        .fill(ROOM.gamma_multiply(0.94))
        .stroke(Stroke::new(1.0, LAMP.gamma_multiply(0.18)))
        .corner_radius(CornerRadius::same((18.0 * scale) as u8))
        .inner_margin(Margin::same((28.0 * scale) as i8))
}

/// Dress of what is in it.
pub(in crate::ui) fn apply(ui: &mut Ui, scale: f32) {
    let style = ui.style_mut();
    let sizes = [
        (TextStyle::Small, 14.0),
        (TextStyle::Body, 17.0),
        (TextStyle::Button, 18.0),
        (TextStyle::Monospace, 17.0),
        (TextStyle::Heading, 25.0),
    ];
    style.text_styles = sizes
        .map(|(name, size)| (name, FontId::proportional(size * scale)))
        .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(12.0, 10.0) * scale;
    spacing.button_padding = vec2(18.0, 8.0) * scale;
    spacing.interact_size = vec2(TARGET, TARGET) * scale;
    spacing.slider_width = 300.0 * scale;
    spacing.slider_rail_height = 6.0 * scale;
    spacing.icon_width = 28.0 * scale;
    spacing.icon_width_inner = 16.0 * scale;
    spacing.text_edit_width = 380.0 * scale;

    let visuals = &mut style.visuals;
    visuals.dark_mode = true;
    visuals.slider_trailing_fill = true;
    visuals.selection.bg_fill = AMBER.gamma_multiply(0.34);
    visuals.selection.stroke = Stroke::new(1.0, LAMP);
    visuals.extreme_bg_color = Color32::from_rgb(6, 7, 10);
    let radius = CornerRadius::same((9.0 * scale) as u8);
    let widgets = &mut visuals.widgets;
    for (widget, fill, line) in [
        (&mut widgets.noninteractive, 0.00, 0.14),
        (&mut widgets.inactive, 0.07, 0.22),
        (&mut widgets.hovered, 0.12, 0.45),
        (&mut widgets.active, 0.22, 0.75),
        (&mut widgets.open, 0.12, 0.45),
    ] {
        widget.bg_fill = LAMP.gamma_multiply(fill + 0.05);
        widget.weak_bg_fill = LAMP.gamma_multiply(fill);
        widget.bg_stroke = Stroke::new(1.0, LAMP.gamma_multiply(line));
        widget.fg_stroke = Stroke::new(1.5, LAMP);
        widget.corner_radius = radius;
        widget.expansion = 0.0;
    }
}

/// A title.
pub(in crate::ui) fn heading(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).heading().color(LAMP));
}
