//! The fold tool: lines drawn along the land, and the handle that raises the folds along the last of them.

use glam::DVec2;

use super::deed::FoldHandle;
use super::edit::on_raster;
use crate::gesture::command::{Action, MAX_RAISE, PATH_POINTS, REACH_MM};
use crate::gesture::contact::Side;

/// Points of a stroke are so far apart, mm: nearer ones only hold the finger's tremble.
const STEP_MM: f64 = 2.0;

/// Points of a line that is sent are at least so far apart, mm.
const SENT_STEP_MM: f64 = 10.0;

/// Most points of a stroke; of a longer one every second is forgotten.
const MOST_POINTS: usize = 2048;

/// Way of the handle for a factor of 1, mm.
const UNIT_MM: f64 = 40.0;

/// Least time between two factors that are sent, µs, and least difference between them.
const SEND_US: u64 = 48_000;
const SEND_STEP: f64 = 0.02;

/// A line that a finger draws, table mm.
#[derive(Clone, Debug)]
pub(super) struct Stroke {
    points: Vec<DVec2>,
    last: DVec2,
}

impl Stroke {
    /// A finger lands on `at`.
    pub(super) fn new(at: DVec2) -> Self {
        Self {
            points: vec![at],
            last: at,
        }
    }

    /// It goes on to `at`.
    pub(super) fn shift(&mut self, at: DVec2) {
        self.last = at;
        if self.points.last().is_none_or(|last| last.distance(at) >= STEP_MM) {
            self.points.push(at);
        }
        if self.points.len() > MOST_POINTS {
            let mut odd = false;
            self.points.retain(|_| {
                odd = !odd;
                odd
            });
        }
    }

    /// The line so far.
    pub(super) fn points(&self) -> impl Iterator<Item = DVec2> {
        self.points.iter().copied().chain([self.last])
    }

    /// The line as it is sent: evenly spaced, on the raster of gesture files. `None` where it is shorter than
    /// `least_mm`: a tap.
    pub(super) fn finished(&self, least_mm: f64) -> Option<Vec<DVec2>> {
        let line: Vec<DVec2> = self.points().collect();
        let length = length(&line);
        // A finger that turns on the spot has drawn nothing either.
        let reach = line.iter().map(|p| p.distance(line[0])).fold(0.0, f64::max);
        if reach.is_nan() || reach < least_mm {
            return None;
        }
        let (fewest, most) = PATH_POINTS;
        let count = ((length / SENT_STEP_MM) as usize + 1).clamp(fewest, most);
        let part = |i: usize| i as f64 / (count - 1) as f64;
        Some((0..count).map(|i| on_raster(along(&line, part(i)))).collect())
    }
}

/// A line that has been drawn, and the handle in its middle.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    side: Side,
    path: Vec<DVec2>,
    /// Factor on the height of the folds along it.
    by: f64,
    /// What was sent last, and when.
    sent: (f64, u64),
    /// Where the finger that holds the handle landed, and the factor then.
    held: Option<(DVec2, f64)>,
}

impl Drawn {
    /// `side` has drawn `path`.
    pub(super) fn new(side: Side, path: Vec<DVec2>, now_us: u64) -> Self {
        Self {
            side,
            path,
            by: 1.0,
            sent: (1.0, now_us),
            held: None,
        }
    }

    /// True where a finger that lands takes hold of the handle.
    pub(super) fn takes(&self, at: DVec2) -> bool {
        self.held.is_none() && self.handle(self.by).distance(at) <= REACH_MM
    }

    /// A finger takes hold of the handle.
    pub(super) fn hold(&mut self, at: DVec2) {
        self.held = Some((at, self.by));
    }

    /// The finger that holds it moves: away from its side raises.
    pub(super) fn shift(&mut self, at: DVec2) {
        if let Some((from, by)) = self.held {
            let way = (at - from).dot(away(self.side)) / UNIT_MM;
            self.by = ((by + way).clamp(0.0, MAX_RAISE) * 100.0).round() / 100.0;
        }
    }

    /// The finger lets it go.
    pub(super) fn release(&mut self) {
        self.held = None;
    }

    /// The factor, if it has changed since it was sent last and the session can follow; `at_last` sends any change.
    pub(super) fn due(&mut self, now_us: u64, at_last: bool) -> Option<Action> {
        let (sent, sent_us) = self.sent;
        let due = (self.by - sent).abs() >= SEND_STEP && now_us.saturating_sub(sent_us) >= SEND_US;
        (due || (at_last && self.by != sent)).then(|| {
            self.sent = (self.by, now_us);
            Action::RaiseFolds {
                path: self.path.clone(),
                by: self.by,
            }
        })
    }

    /// As it is drawn.
    pub(super) fn view(&self) -> FoldHandle<'_> {
        FoldHandle {
            side: self.side,
            path: &self.path,
            middle: along(&self.path, 0.5),
            at: self.handle(self.by),
            lowest: self.handle(0.0),
            highest: self.handle(MAX_RAISE),
            by: self.by,
            held: self.held.is_some(),
        }
    }

    /// Where the handle is at a factor: as far from the line as the folds differ from what they would be.
    fn handle(&self, by: f64) -> DVec2 {
        along(&self.path, 0.5) + away(self.side) * (by - 1.0) * UNIT_MM
    }
}

/// Away from who stands at a side, on the table.
fn away(side: Side) -> DVec2 {
    match side {
        Side::North => DVec2::Y,
        Side::South => DVec2::NEG_Y,
    }
}

fn length(line: &[DVec2]) -> f64 {
    line.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}

/// The place on a line at a part (0–1) of its length. The line has a point.
fn along(line: &[DVec2], part: f64) -> DVec2 {
    let mut left = part * length(line);
    for ends in line.windows(2) {
        let step = ends[0].distance(ends[1]);
        if left < step {
            return ends[0].lerp(ends[1], left / step);
        }
        left -= step;
    }
    line[line.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_line_keeps_its_ends_and_its_shape() {
        let mut stroke = Stroke::new(DVec2::new(100.0, 100.0));
        for i in 1..=300 {
            stroke.shift(DVec2::new(100.0 + f64::from(i), 100.0));
        }
        for i in 1..=100 {
            stroke.shift(DVec2::new(400.0, 100.0 + f64::from(i)));
        }
        let path = stroke.finished(4.0).unwrap();
        assert_eq!(
            (path[0], path[path.len() - 1]),
            (DVec2::splat(100.0), DVec2::new(400.0, 200.0))
        );
        assert_eq!(path.len(), 41);
        assert!(path.iter().all(|p| p.y == 100.0 || p.x > 390.0));
        assert_eq!(along(&path, 0.5), DVec2::new(300.0, 100.0));
    }

    #[test]
    fn a_tap_and_a_tremble_are_no_line() {
        let mut stroke = Stroke::new(DVec2::new(100.0, 100.0));
        assert_eq!(stroke.finished(4.0), None);
        for i in 0..500 {
            let turn = f64::from(i);
            stroke.shift(DVec2::new(100.0 + turn.cos(), 100.0 + turn.sin()));
        }
        assert_eq!(stroke.finished(4.0), None);
    }

    #[test]
    fn the_handle_goes_with_the_finger_and_away_is_up_on_both_sides() {
        for (side, up) in [(Side::South, -1.0), (Side::North, 1.0)] {
            let path = vec![DVec2::new(100.0, 300.0), DVec2::new(300.0, 300.0)];
            let mut drawn = Drawn::new(side, path, 0);
            let middle = DVec2::new(200.0, 300.0);
            assert!(drawn.takes(middle + 10.0) && !drawn.takes(middle + 20.0));
            drawn.hold(middle);
            assert!(!drawn.takes(middle), "one finger holds it");
            drawn.shift(middle + DVec2::new(30.0, up * 20.0));
            assert_eq!(drawn.view().by, 1.5);
            assert_eq!(drawn.view().at, middle + DVec2::new(0.0, up * 20.0));
            assert_eq!(
                drawn.due(10_000, false),
                None,
                "not more often than the session can follow"
            );
            assert!(matches!(
                drawn.due(60_000, false),
                Some(Action::RaiseFolds { by: 1.5, .. })
            ));
            drawn.shift(middle - DVec2::new(0.0, up * 900.0));
            assert!(matches!(
                drawn.due(60_001, true),
                Some(Action::RaiseFolds { by: 0.0, .. })
            ));
            drawn.shift(middle + DVec2::new(0.0, up * 900.0));
            assert_eq!(drawn.view().by, MAX_RAISE);
        }
    }

    proptest! {
        /// Whatever a finger draws, what is sent is within its bounds.
        #[test]
        fn a_line_is_short_enough_and_on_the_table(
            points in prop::collection::vec((0.0..1200.0f64, 0.0..680.0f64), 1..400),
            times in 1..20_usize,
        ) {
            let points: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
            let mut stroke = Stroke::new(points[0]);
            for _ in 0..times {
                for &at in &points {
                    stroke.shift(at);
                }
            }
            prop_assert!(stroke.points().count() <= MOST_POINTS + 2);
            if let Some(path) = stroke.finished(4.0) {
                prop_assert!((PATH_POINTS.0..=PATH_POINTS.1).contains(&path.len()));
                prop_assert_eq!(path[0], on_raster(points[0]));
                prop_assert!(path.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.x <= 1200.0 && p.y <= 680.0));
            }
        }
    }
}
