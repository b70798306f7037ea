//! The slice tool: the fingers of one side set the ends of its cross-section.

use glam::DVec2;

use super::deed::SliceView;
use super::edit::on_raster;
use crate::gesture::command::{Action, Arrow, REACH_MM};
use crate::gesture::contact::{ContactKey, Side};

/// Nearer to each other than this, two ends are none, mm.
const LEAST_MM: f64 = 10.0;

/// The finger that sets the second end may land anywhere on the table so long after the first, µs: later it may be
/// somebody else's.
const TOGETHER_US: u64 = 1_500_000;

/// Least time between two cross-sections that are sent, µs, and least motion of an end, mm.
const SEND_US: u64 = 32_000;
const SEND_STEP_MM: f64 = 0.5;

/// For so long what the fingers have set is shown before what the session says, µs.
const PATIENCE_US: u64 = 500_000;

/// The cross-section of one side as its fingers set it. Table mm.
#[derive(Clone, Debug, Default)]
pub(super) struct Section {
    /// The first end while there is no second, and when it was set.
    first: Option<(DVec2, u64)>,
    /// The ends as the session has them.
    known: Option<[DVec2; 2]>,
    frozen: bool,
    /// The ends as fingers have set them, and when: ahead of the session.
    ahead: Option<([DVec2; 2], u64)>,
    /// Who holds which end.
    held: [Option<ContactKey>; 2],
    /// What was sent last, and when.
    sent: Option<([DVec2; 2], u64)>,
}

impl Section {
    /// Looks at what the session has.
    pub(super) fn look(&mut self, known: Option<[DVec2; 2]>, frozen: bool, now_us: u64) {
        if known.is_none() && self.known.is_some() {
            // It has been closed, or the land is another.
            *self = Self::default();
        }
        (self.known, self.frozen) = (known, frozen);
        let is_held = self.held.iter().any(Option::is_some);
        let answered =
            |ends: [DVec2; 2]| known.is_some_and(|known| known.map(on_raster) == ends.map(on_raster));
        self.ahead = self.ahead.filter(|&(ends, since_us)| {
            is_held || !(answered(ends) || now_us.saturating_sub(since_us) > PATIENCE_US)
        });
    }

    fn ends(&self) -> Option<[DVec2; 2]> {
        self.ahead.map(|(ends, _)| ends).or(self.known)
    }

    /// True where an end is within reach that nobody holds, or a first end waits for the second finger of the same
    /// hand: then a finger that lands is this side's, wherever it lands.
    pub(super) fn takes(&self, at: DVec2, now_us: u64) -> bool {
        if self.frozen {
            return false;
        }
        if let Some((_, since_us)) = self.first {
            return self.held[0].is_some() && now_us.saturating_sub(since_us) <= TOGETHER_US;
        }
        let free =
            |ends: [DVec2; 2]| (0..2).any(|i| self.held[i].is_none() && ends[i].distance(at) <= REACH_MM);
        self.ends().is_some_and(free)
    }

    /// A finger lands and takes hold of an end; the end goes where the finger is. False where there is none for it.
    pub(super) fn take(&mut self, key: ContactKey, at: DVec2, now_us: u64) -> bool {
        if self.frozen {
            return false;
        }
        if let Some(ends) = self.ends() {
            let free = (0..2).filter(|&i| self.held[i].is_none());
            let nearest = free.min_by(|&a, &b| ends[a].distance(at).total_cmp(&ends[b].distance(at)));
            if let Some(end) = nearest {
                self.held[end] = Some(key);
                self.set(ends, end, at, now_us);
            }
            return nearest.is_some();
        }
        match self.first {
            Some((first, _)) if self.held[0].is_some() || first.distance(at) >= LEAST_MM => {
                self.first = None;
                self.held[1] = Some(key);
                self.ahead = Some(([first, at], now_us));
            }
            _ => {
                self.first = Some((at, now_us));
                self.held[0] = Some(key);
            }
        }
        true
    }

    /// The finger that holds an end moves.
    pub(super) fn shift(&mut self, key: ContactKey, at: DVec2, now_us: u64) {
        let Some(end) = self.held.iter().position(|held| *held == Some(key)) else {
            return;
        };
        if let Some((first, _)) = &mut self.first {
            *first = at;
        } else if let Some(ends) = self.ends() {
            self.set(ends, end, at, now_us);
        }
    }

    fn set(&mut self, mut ends: [DVec2; 2], end: usize, at: DVec2, now_us: u64) {
        ends[end] = at;
        self.ahead = Some((ends, now_us));
    }

    /// A finger lifts (or is withdrawn, and then takes a lonely first end with it).
    pub(super) fn release(&mut self, key: ContactKey, lifted: bool) {
        for held in self.held.iter_mut().filter(|held| **held == Some(key)) {
            *held = None;
            self.first = self.first.filter(|_| lifted);
        }
    }

    /// All fingers are gone.
    pub(super) fn let_go(&mut self) {
        self.held = [None; 2];
        self.first = None;
    }

    /// The cross-section, if it has changed since it was sent last and the session can follow; `at_last` sends any change.
    pub(super) fn due(&mut self, now_us: u64, at_last: bool) -> Option<Action> {
        let (ends, _) = self.ahead?;
        let ends = ends.map(on_raster);
        if ends[0].distance(ends[1]) < LEAST_MM {
            return None;
        }
        let due = self.sent.is_none_or(|(sent, sent_us)| {
            let moved = (0..2).map(|i| sent[i].distance(ends[i])).fold(0.0, f64::max);
            let gone_on = moved >= SEND_STEP_MM && now_us.saturating_sub(sent_us) >= SEND_US;
            gone_on || (at_last && sent != ends)
        });
        due.then(|| {
            self.sent = Some((ends, now_us));
            let [from, to] = ends;
            Action::Slice(Arrow { from, to })
        })
    }

    /// As it is drawn; `taken`: the side has the tool.
    pub(super) fn view(&self, side: Side, taken: bool) -> Option<SliceView> {
        let (ends, whole) = match (self.ends(), self.first) {
            (Some(ends), _) => (ends, true),
            (None, Some((first, _))) => ([first; 2], false),
            (None, None) => return None,
        };
        Some(SliceView {
            side,
            ends,
            whole,
            held: self.held.map(|held| held.is_some()),
            handles: taken && !self.frozen,
            frozen: self.frozen,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gesture::contact::Source;

    const A: DVec2 = DVec2::new(300.0, 400.0);
    const B: DVec2 = DVec2::new(700.0, 450.0);

    fn key(id: u64) -> ContactKey {
        ContactKey {
            source: Source::Window,
            device: 0,
            id,
            generation: 0,
        }
    }

    fn sent(section: &mut Section, now_us: u64) -> Option<[DVec2; 2]> {
        match section.due(now_us, true) {
            Some(Action::Slice(ends)) => Some([ends.from, ends.to]),
            None => None,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn two_fingers_or_two_clicks_set_the_ends() {
        for lifts in [false, true] {
            let mut section = Section::default();
            assert!(section.take(key(1), A, 0));
            assert_eq!(sent(&mut section, 0), None);
            assert!(!section.view(Side::South, true).unwrap().whole);
            if lifts {
                section.release(key(1), true);
                assert!(!section.takes(B, 0), "elsewhere it may be a neighbour's");
            } else {
                assert!(section.takes(B, 1_000_000) && !section.takes(B, 9_000_000));
            }
            assert!(section.take(key(2), B, 0));
            assert_eq!(sent(&mut section, 0), Some([A, B]));
            assert_eq!(sent(&mut section, 99_000), None, "once");
            section.shift(key(2), B + 30.0, 100_000);
            assert_eq!(sent(&mut section, 200_000), Some([A, B + 30.0]));
        }
    }

    #[test]
    fn an_end_is_taken_hold_of_again_and_a_frozen_one_is_not() {
        let mut section = Section::default();
        section.look(Some([A, B]), false, 0);
        assert!(section.takes(B + 10.0, 0) && !section.takes(B + 30.0, 0));
        assert!(section.take(key(1), B + 100.0, 0), "the nearer one comes");
        assert!(section.take(key(2), B, 0), "then the other");
        assert!(!section.take(key(3), A, 0), "a third finger has none");
        assert_eq!(sent(&mut section, 0), Some([B, B + 100.0]));
        section.release(key(1), true);
        section.release(key(2), true);
        section.look(Some([B, B + 100.0]), true, 1_000_000);
        assert!(!section.takes(B, 0) && !section.take(key(4), B, 0));
    }

    #[test]
    fn what_fingers_set_is_shown_until_the_session_answers() {
        let mut section = Section::default();
        section.look(Some([A, B]), false, 0);
        section.take(key(1), A - 40.0, 0);
        section.release(key(1), true);
        section.look(Some([A, B]), false, 100_000);
        assert_eq!(section.view(Side::South, true).unwrap().ends, [A - 40.0, B]);
        section.look(Some([A, B]), false, 700_000);
        assert_eq!(
            section.view(Side::South, true).unwrap().ends,
            [A, B],
            "it never answered"
        );
        section.look(None, false, 700_000);
        assert_eq!(section.view(Side::South, true), None);
    }

    #[test]
    fn ends_in_one_place_are_no_cross_section_and_a_withdrawn_first_end_goes() {
        let mut section = Section::default();
        section.take(key(1), A, 0);
        section.release(key(1), true);
        section.take(key(2), A + 3.0, 0);
        assert_eq!(sent(&mut section, 0), None);
        assert!(
            !section.view(Side::South, true).unwrap().whole,
            "a second click on the same place"
        );
        section.release(key(2), false);
        assert_eq!(section.view(Side::South, true), None);
    }
}
