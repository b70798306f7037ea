//! Everything that lies on top of the land: ink, halos of fingers, controls, cross-sections, ghost hands, readouts, the
//! warning before a reset, and the menu for staff.
//!
//! All of it is drawn with egui's painter from plain data. Positions come in as table millimetres or plan metres and
//! pass through a [`Sight`], which alone knows where they are on the screen. Time comes in as seconds of a clock that
//! only has to rise; what is remembered between frames is how far a fade has come.
//!
//! The look is that of a printed map under a lamp: two inks, thin lines, light only where a hand is near. Marks that
//! mean different things differ in line as well as in colour: solid for what pushes, dashed for what rests, faded for
//! what is spent.

pub mod controls;
mod ease;
pub mod folds;
pub mod ghost;
pub mod globe;
pub mod halo;
mod icons;
pub mod ink;
pub mod layers;
mod lettering;
pub mod palette;
mod pen;
pub mod readouts;
pub mod section;
mod sight;
pub mod staff;
pub mod warning;
mod words;

pub use sight::Sight;
