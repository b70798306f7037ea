//! Ghost hands that show the two first gestures, without words.

use glam::DVec2;

use crate::gesture::contact::Side;
use crate::gesture::params::RELAXED_HAND_MM;

/// Length of a lesson and of the pause after it, ms.
const LESSON_MS: u64 = 4200;
const PAUSE_MS: u64 = 1000;

/// Before the first lesson, ms: whoever has just touched looks at what that has done.
const FIRST_MS: u64 = 1500;

/// The lessons in turn: first what one finger does, and each side sees both.
const LESSONS: [(Lesson, Side); 4] = [
    (Lesson::OneFinger, Side::South),
    (Lesson::TwoHands, Side::South),
    (Lesson::OneFinger, Side::North),
    (Lesson::TwoHands, Side::North),
];

/// Parts of a lesson: seen, touching, dragging from … to, lifted, gone.
const SEEN: f64 = 0.10;
const TOUCHING: f64 = 0.20;
const DRAGGING: (f64, f64) = (0.24, 0.74);
const LIFTING: f64 = 0.80;
const LEAVING: f64 = 0.88;

/// Height of the table that the hands are drawn for, mm; smaller tables get smaller hands.
const FULL_MM: f64 = 680.0;

/// The wrist of a relaxed right hand, from the middle of its fingertips, mm.
const WRIST_MM: DVec2 = DVec2::new(14.0, 150.0);

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
    /// Fingertips that touch: the index finger alone, or thumb to little finger.
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

impl Hint {
    /// What is shown so long after the hints began; `None` in the pauses.
    pub(super) fn at(since_ms: u64) -> Option<Self> {
        let shown_ms = since_ms.checked_sub(FIRST_MS)?;
        let turn = LESSON_MS + PAUSE_MS;
        let (lesson, side) = LESSONS[(shown_ms / turn) as usize % LESSONS.len()];
        let in_turn = shown_ms % turn;
        (in_turn < LESSON_MS).then_some(Self {
            lesson,
            side,
            progress: in_turn as f64 / LESSON_MS as f64,
        })
    }

    /// The hands on a table of `size_mm`.
    pub fn hands(&self, size_mm: DVec2) -> Vec<GhostHand> {
        let scale = (size_mm.min_element() / FULL_MM).min(1.2);
        let p = self.progress;
        let opacity = smooth(p / SEEN) * (1.0 - smooth((p - LEAVING) / (1.0 - LEAVING)));
        let touching =
            smooth((p - SEEN) / (TOUCHING - SEEN)) * (1.0 - smooth((p - LIFTING) / (LEAVING - LIFTING)));
        let dragged = smooth((p - DRAGGING.0) / (DRAGGING.1 - DRAGGING.0));
        let hand = |start: DVec2, by: DVec2, right: bool, fingers: &[DVec2]| {
            let place = |offset: DVec2| {
                let turned = if right {
                    offset
                } else {
                    DVec2::new(-offset.x, offset.y)
                };
                let at = start + turned * scale;
                match self.side {
                    Side::South => at,
                    Side::North => size_mm - at,
                }
            };
            let way = by * dragged / scale;
            let way = if right { way } else { DVec2::new(-way.x, way.y) };
            GhostHand {
                fingers: fingers.iter().map(|&f| place(f + way)).collect(),
                starts: fingers.iter().map(|&f| place(f)).collect(),
                wrist: place(WRIST_MM + way),
                right,
                touching,
                opacity,
            }
        };
        let at = |x: f64| size_mm * DVec2::new(x, 0.56);
        match self.lesson {
            Lesson::OneFinger => {
                let by = DVec2::new(0.16 * size_mm.x, -0.04 * size_mm.y);
                vec![hand(at(0.40), by, true, &RELAXED_HAND_MM[1..2])]
            }
            Lesson::TwoHands => {
                let by = DVec2::new(0.09 * size_mm.x, 0.0);
                vec![
                    hand(at(0.34), by, false, &RELAXED_HAND_MM),
                    hand(at(0.66), -by, true, &RELAXED_HAND_MM),
                ]
            }
        }
    }
}

/// 0 to 1 without a start or a stop (3x² − 2x³).
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);

    #[test]
    fn one_finger_comes_first_and_both_sides_see_both_lessons() {
        assert_eq!(Hint::at(0), None);
        let seen: Vec<_> = (0..30_000)
            .step_by(100)
            .filter_map(Hint::at)
            .map(|hint| (hint.lesson, hint.side))
            .collect();
        assert_eq!(seen[0], (Lesson::OneFinger, Side::South));
        for lesson in LESSONS {
            assert!(seen.contains(&lesson));
        }
        assert_eq!(Hint::at(FIRST_MS + LESSON_MS), None, "a pause");
    }

    #[test]
    fn hands_land_drag_and_leave() {
        for (lesson, side) in LESSONS {
            let at = |progress| {
                Hint {
                    lesson,
                    side,
                    progress,
                }
                .hands(SIZE_MM)
            };
            for hand in at(0.0).iter().chain(&at(1.0)) {
                assert_eq!((hand.opacity, hand.touching), (0.0, 0.0));
            }
            for hand in at(0.5) {
                assert_eq!((hand.opacity, hand.touching), (1.0, 1.0));
                assert_eq!(hand.fingers.len(), hand.starts.len());
                let towards_side = (hand.wrist - hand.fingers[0]).y;
                assert_eq!(
                    towards_side > 0.0,
                    side == Side::South,
                    "the arm comes from its side"
                );
            }
        }
    }

    #[test]
    fn two_hands_come_together_and_their_fingers_never_meet() {
        let gap = |progress, side| {
            let hint = Hint {
                lesson: Lesson::TwoHands,
                side,
                progress,
            };
            let hands = hint.hands(SIZE_MM);
            assert_eq!(hands.len(), 2);
            let x = |hand: &GhostHand| hand.fingers.iter().map(|f| f.x).sum::<f64>() / 5.0;
            (x(&hands[0]) - x(&hands[1])).abs()
        };
        for side in [Side::North, Side::South] {
            assert!(gap(0.9, side) < gap(0.1, side) - 200.0);
            assert!(gap(0.9, side) > 120.0);
        }
    }

    #[test]
    fn everything_stays_on_the_table() {
        for size_mm in [SIZE_MM, DVec2::new(300.0, 169.0), DVec2::new(2000.0, 1125.0)] {
            for (lesson, side) in LESSONS {
                for step in 0..=10 {
                    let progress = f64::from(step) / 10.0;
                    for hand in (Hint {
                        lesson,
                        side,
                        progress,
                    })
                    .hands(size_mm)
                    {
                        for finger in hand.fingers.iter().chain(&hand.starts) {
                            assert!(finger.min_element() > 0.0 && (size_mm - *finger).min_element() > 0.0);
                        }
                    }
                }
            }
        }
    }
}
