//! What the tests of drawings share.

use egui::{Context, LayerId, Painter, Pos2, RawInput, Rect, Shape, pos2};
use glam::DVec2;
use orogen::ui::Sight;
use orogen::units::{DEFAULT_SHORT_SIDE, PlanMap};

/// The screen that is drawn on.
pub(crate) const SCREEN: Rect = Rect::from_min_max(Pos2::ZERO, pos2(1920.0, 1080.0));

/// The table's size, mm.
pub(crate) const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);

/// How the table lies on the land.
pub(crate) fn map() -> PlanMap {
    PlanMap::new(SIZE_MM, DEFAULT_SHORT_SIDE)
}

/// All shapes that `draw` adds, one by one.
pub(crate) fn shapes(draw: impl Fn(&Painter, &Sight<'_>)) -> Vec<Shape> {
    let context = Context::default();
    let input = RawInput {
        screen_rect: Some(SCREEN),
        ..RawInput::default()
    };
    let mut output = context.run_pass(input, |context| {
        let painter = context.layer_painter(LayerId::background());
        draw(&painter, &Sight::flat(map(), SCREEN));
    });
    output.textures_delta.clear();
    output.shapes.into_iter().map(|clipped| clipped.shape).collect()
}
