//! Ghost hands that show the two first gestures, without words.

use glam::DVec2;

use crate::gesture::contact::Side;

/// What ghost hands show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lesson {
    /// One finger drags the ground.
    OneFinger,
    /// Two hands push towards each other.
    TwoHands,
}

/// The lesson that is shown now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hint {
    /// What is shown.
    pub lesson: Lesson,
    /// The side from which the hands reach in.
    pub side: Side,
    /// How much of the lesson has been shown, 0–1.
    pub progress: f64,
}

/// A ghost hand at one moment of a lesson. Table millimetres.
#[derive(Clone, Debug, PartialEq)]
pub struct GhostHand {
    /// Fingers that touch, the index finger of a lone finger or thumb to little finger.
    pub fingers: Vec<DVec2>,
    /// Where they landed: draw a trail from there.
    pub starts: Vec<DVec2>,
    /// The wrist, towards which the hand is drawn.
    pub wrist: DVec2,
    /// True for a right hand.
    pub right: bool,
    /// The fingers touch the table, 0 (hovering) to 1.
    pub touching: f64,
    /// How much is seen of it, 0–1.
    pub opacity: f64,
}
