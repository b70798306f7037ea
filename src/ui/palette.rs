//! The colours on top of the land.
//!
//! The inks are those of the printed map. Hands differ by hue and by lightness, chosen from the colours of Okabe & Ito
//! (2008) and muted, so that they stay apart for every kind of colour vision; what a mark means never hangs on its
//! colour alone.

use egui::Color32;

use crate::gesture::event::HandId;

/// What pushes.
pub const VERMILION: Color32 = Color32::from_rgb(184, 62, 20);

/// What stands or rests.
pub const BLUE_BLACK: Color32 = Color32::from_rgb(30, 40, 56);

/// The pale bed under every line of ink.
pub const PAPER: Color32 = Color32::from_rgb(250, 246, 236);

/// Lines and letters of controls: the light of a lamp on paper.
pub const LAMP: Color32 = Color32::from_rgb(255, 244, 222);

/// What is on, or under a hand.
pub const AMBER: Color32 = Color32::from_rgb(255, 196, 104);

/// The room: panels and the bed of controls.
pub const ROOM: Color32 = Color32::from_rgb(13, 15, 19);

/// Colours of hands.
pub const HANDS: [Color32; 5] = [
    Color32::from_rgb(126, 196, 232),
    Color32::from_rgb(240, 170, 62),
    Color32::from_rgb(196, 116, 168),
    Color32::from_rgb(246, 234, 128),
    Color32::from_rgb(40, 112, 176),
];

/// The colour of a hand: the same for as long as it is down, and another one for each of the next few.
pub fn of_hand(hand: HandId) -> Color32 {
    HANDS[hand.0 as usize % HANDS.len()]
}

/// `colour` with `strength` (0 to 1; what is outside is brought inside) of its opacity.
pub(crate) fn faded(colour: Color32, strength: f32) -> Color32 {
    colour.gamma_multiply(if strength > 0.0 { strength.min(1.0) } else { 0.0 })
}

/// The colour between two, `t` (0 to 1) of the way.
pub(super) fn between(a: Color32, b: Color32, t: f32) -> Color32 {
    a.lerp_to_gamma(b, t.clamp(0.0, 1.0))
}
