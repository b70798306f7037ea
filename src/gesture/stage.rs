//! One hand: its fingers, and the stage it is at.

use glam::DVec2;

use super::contact::Side;
use super::event::{HandEvent, HandId, Leg};
use super::leg::{self, Arrow};
use super::params::MAX_FINGERS;
use super::rigid::RigidFit;
use super::stroke::StrokeId;
use super::view::{Doing, HandView};

/// A hand that is down. Its arrows are its fingers, and those that lifted before the others.
#[derive(Clone, Debug)]
pub(super) struct Hand {
    pub(super) side: Side,
    pub(super) since_us: u64,
    pub(super) arrows: Vec<Arrow>,
    pub(super) stage: Stage,
    /// Legs begun.
    pub(super) legs: u32,
}

/// What a hand does.
#[derive(Clone, Debug)]
pub(super) enum Stage {
    Touching,
    /// True once the world has been told where the fingers are.
    Resting(bool),
    /// The fit that the world was told last.
    Pushing(Option<(Vec<DVec2>, RigidFit)>),
}

impl Hand {
    /// A hand without fingers yet, or with those of a hand that fell apart.
    pub(super) fn new(since_us: u64, arrows: Vec<Arrow>) -> Self {
        Self {
            side: Side::North,
            since_us,
            arrows,
            stage: Stage::Touching,
            legs: 0,
        }
    }

    pub(super) fn fingers_down(&self) -> impl Iterator<Item = (StrokeId, &Arrow)> {
        self.arrows
            .iter()
            .filter_map(|arrow| arrow.stroke.map(|stroke| (stroke, arrow)))
    }

    pub(super) fn starts(&self) -> Vec<DVec2> {
        self.arrows.iter().map(|arrow| arrow.start).collect()
    }

    pub(super) fn leg(&self, hand: HandId) -> Leg {
        Leg {
            hand,
            index: self.legs.saturating_sub(1),
        }
    }

    /// Gives it the side that the middle of its landing places is on.
    pub(super) fn take_side(&mut self, size_mm: DVec2) {
        let middle = self.arrows.iter().map(|arrow| arrow.landed).sum::<DVec2>() / self.arrows.len() as f64;
        self.side = Side::of(middle, size_mm);
    }

    /// The hand for drawing.
    pub(super) fn view(&self, id: HandId) -> HandView {
        HandView {
            hand: id,
            side: self.side,
            fingers: self.fingers_down().map(|(_, arrow)| arrow.now).collect(),
            doing: match self.stage {
                Stage::Touching => Doing::Touching,
                Stage::Resting(_) => Doing::Resting,
                Stage::Pushing(_) => Doing::Pushing {
                    leg: self.leg(id),
                    starts: self.starts(),
                    fit: leg::fit(&self.arrows),
                },
            },
        }
    }

    /// The event of a hand that touched and left.
    pub(super) fn tap(&self, id: HandId) -> HandEvent {
        HandEvent::Tap {
            hand: id,
            side: self.side,
            fingers: self.arrows.iter().map(|arrow| arrow.landed).collect(),
        }
    }

    /// The event of a hand that rests on the fingers that are down, or rested on those that were.
    pub(super) fn rest(&self, id: HandId) -> HandEvent {
        let mut fingers: Vec<DVec2> = self.fingers_down().map(|(_, arrow)| arrow.now).collect();
        if fingers.is_empty() {
            fingers = self.arrows.iter().map(|arrow| arrow.now).collect();
        }
        HandEvent::Rest {
            hand: id,
            side: self.side,
            fingers,
        }
    }

    /// A finger joins. If the hand drags, its start is where the plate would have carried it from.
    pub(super) fn join(&mut self, stroke: StrokeId, at: DVec2) {
        let mut arrow = Arrow::new(stroke, at);
        if matches!(self.stage, Stage::Pushing(_)) {
            arrow.start = leg::fit(&self.arrows).motion.apply_inverse(at);
            arrow.far = leg::far_fit(&self.arrows).motion.apply(arrow.start);
        }
        if self.arrows.len() == MAX_FINGERS {
            // A finger lands where one has lifted: the nearest lifted arrow makes room.
            let lifted = self.arrows.iter().enumerate().filter(|(_, a)| a.stroke.is_none());
            let nearest = lifted.min_by(|a, b| a.1.now.distance(at).total_cmp(&b.1.now.distance(at)));
            if let Some(i) = nearest.map(|(i, _)| i) {
                self.arrows.remove(i);
            }
        }
        self.arrows.push(arrow);
        self.fingers_changed();
    }

    pub(super) fn fingers_changed(&mut self) {
        leg::anchor(&mut self.arrows);
        if let Stage::Resting(told) = &mut self.stage {
            *told = false;
        }
    }

    /// The first leg begins, with the fingers that are down.
    pub(super) fn begin(&mut self) {
        self.arrows.retain(|arrow| arrow.stroke.is_some());
        self.stage = Stage::Pushing(None);
        self.legs += 1;
    }

    /// The event for a fit, which is then the last one told.
    pub(super) fn push(&mut self, id: HandId, now: (Vec<DVec2>, RigidFit)) -> HandEvent {
        let (starts, fit) = now.clone();
        self.stage = Stage::Pushing(Some(now));
        HandEvent::Push {
            leg: self.leg(id),
            side: self.side,
            starts,
            fit,
        }
    }
}
