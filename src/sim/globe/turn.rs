//! Hands that turn and zoom the view.

use glam::DVec2;

use super::session::GlobeSim;
use crate::gesture::event::HandId;

/// Least distance of hands from their middle that tells a magnification, mm.
const LEAST_SPREAD_MM: f64 = 20.0;

/// The hands that turn the view, as far as the view has followed them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Turning {
    /// Each hand, how many fingers it has down, and the middle of them, table mm.
    hands: Vec<(HandId, usize, DVec2)>,
    /// They have moved the view.
    moved: bool,
}

impl Turning {
    fn is_of(&self, hands: &[(HandId, usize, DVec2)]) -> bool {
        let same = |(a, b): (&(HandId, usize, DVec2), &(HandId, usize, DVec2))| (a.0, a.1) == (b.0, b.1);
        self.hands.len() == hands.len() && self.hands.iter().zip(hands).all(same)
    }

    /// The middle of all hands, and their mean distance from it.
    fn middle_and_spread(&self) -> (DVec2, f64) {
        let count = self.hands.len() as f64;
        let middle = self.hands.iter().map(|hand| hand.2).sum::<DVec2>() / count;
        let distances = self.hands.iter().map(|hand| hand.2.distance(middle));
        (middle, distances.sum::<f64>() / count)
    }
}

impl GlobeSim {
    /// Lets the view follow `hands`, once one of them `moves`. A hand that comes or goes, or changes its fingers, moves
    /// nothing by that.
    pub(super) fn turn_view(&mut self, hands: Vec<(HandId, usize, DVec2)>, moves: bool) {
        let state = &mut self.state;
        if hands.is_empty() || !state.turning.is_of(&hands) {
            state.turning = Turning { hands, moved: false };
            return;
        }
        if !moves || hands == state.turning.hands {
            return;
        }
        state.counts.views += u64::from(!state.turning.moved);
        let now = Turning { hands, moved: true };
        let (from, from_spread) = state.turning.middle_and_spread();
        let (to, to_spread) = now.middle_and_spread();
        state.view = state.view.dragged(from, to);
        if from_spread >= LEAST_SPREAD_MM && to_spread >= LEAST_SPREAD_MM {
            state.view = state.view.pinched(to_spread / from_spread);
        }
        state.turning = now;
    }
}
