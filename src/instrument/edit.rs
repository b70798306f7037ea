//! The edit tool: what one contact does to standing plates.

use glam::DVec2;

use super::deed::{EditView, Editing, Scene};
use crate::gesture::command::{Action, Arrow, REACH_MM};
use crate::gesture::contact::{Side, quantise_mm};
use crate::gesture::rigid::RigidFit;
use crate::surface::{FaultTrace, PlateMark};

/// A contact that has stayed where it landed for so long removes what is under it, µs.
const HOLD_US: u64 = 800_000;

/// The finger must have gone on so far before the arrow is sent after it again, mm.
const STEP_MM: f64 = 1.0;

/// If the plate has not answered for so long, the arrow is sent again, µs.
const PATIENCE_US: u64 = 150_000;

/// One contact of the edit tool.
#[derive(Clone, Debug)]
pub(super) struct Edit {
    /// The side it landed on.
    pub(super) side: Side,
    from: DVec2,
    at: DVec2,
    since_us: u64,
    /// Motion from which it drags and does not hold or tap, mm.
    motion_mm: f64,
    stage: Stage,
    tip: Option<Tip>,
    on_plate: bool,
    on_fault: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// It may still become a tap or a hold.
    Still,
    /// It drags.
    Moved,
    /// It was held, and has removed what was under it.
    Removed,
}

/// The arrow tip that a contact has hold of.
#[derive(Clone, Copy, Debug)]
struct Tip {
    /// Which plate of the scene, and which of its arrows, as long as the scene has as many.
    plate: usize,
    arrow: usize,
    plates: usize,
    /// Where it was last seen, table mm.
    at: DVec2,
    /// Where it was sent last, where it was seen then, and when.
    sent: Option<(DVec2, DVec2, u64)>,
}

impl Edit {
    /// A contact lands on `at`.
    pub(super) fn new(side: Side, at: DVec2, motion_mm: f64, now_us: u64, scene: &Scene<'_>) -> Self {
        Self {
            side,
            from: at,
            at,
            since_us: now_us,
            motion_mm,
            stage: Stage::Still,
            tip: tip_near(at, scene),
            on_plate: scene.plates.iter().any(|plate| stands_on(plate, at, scene)),
            on_fault: scene.faults.iter().any(|fault| fault_near(fault, at, scene)),
        }
    }

    /// The contact moves.
    pub(super) fn shift(&mut self, at: DVec2) {
        self.at = at;
        if self.stage == Stage::Still && at.distance(self.from) >= self.motion_mm {
            self.stage = Stage::Moved;
        }
    }

    /// What has to be done now: an arrow follows, or a plate has been held for long enough.
    pub(super) fn tick(&mut self, now_us: u64, scene: &Scene<'_>) -> Option<Action> {
        match self.stage {
            Stage::Removed => return None,
            Stage::Moved => return self.follow(now_us, scene, false),
            Stage::Still if now_us.saturating_sub(self.since_us) < HOLD_US => return None,
            Stage::Still => {}
        }
        // A tip may lie outside the ground that a hold reaches: the plate is found at the tip itself.
        let at = match self.tip {
            _ if self.on_plate => self.from,
            Some(tip) => tip.at,
            None => return None,
        };
        self.stage = Stage::Removed;
        Some(Action::Remove { at: on_raster(at) })
    }

    /// The contact lifts: what it does.
    pub(super) fn lift(&mut self, now_us: u64, scene: &Scene<'_>) -> Option<Action> {
        match self.stage {
            Stage::Removed => None,
            Stage::Still => self.on_fault.then(|| Action::FlipFault {
                at: on_raster(self.from),
            }),
            Stage::Moved if self.tip.is_some() => self.follow(now_us, scene, true),
            Stage::Moved => self.on_plate.then(|| {
                Action::AddArrow(Arrow {
                    from: on_raster(self.from),
                    to: on_raster(self.at),
                })
            }),
        }
    }

    /// How it looks.
    pub(super) fn view(&self, now_us: u64) -> EditView {
        let still = self.stage == Stage::Still;
        let can_remove = self.on_plate || self.tip.is_some();
        let held = now_us.saturating_sub(self.since_us) as f64 / HOLD_US as f64;
        EditView {
            side: self.side,
            at: self.at,
            doing: match self.tip {
                _ if self.stage == Stage::Removed => Editing::Removed,
                Some(tip) => Editing::Tip { tip: tip.at },
                None if self.on_plate && !still => Editing::NewArrow {
                    from: self.from,
                    to: self.at,
                },
                None if self.on_fault && still => Editing::Fault,
                None if self.on_plate => Editing::Plate,
                None => Editing::Nothing,
            },
            hold: if can_remove && still { held.min(1.0) } else { 0.0 },
        }
    }

    /// Sends the tip after the finger. A plate is rigid, so its tip may come only a part of the way, or be capped: the
    /// next stretch begins at the tip as it is seen, once the plate has answered the last one.
    fn follow(&mut self, now_us: u64, scene: &Scene<'_>, at_last: bool) -> Option<Action> {
        let tip = self.tip.as_mut()?;
        tip.look(scene);
        let to = on_raster(self.at);
        let due = tip.sent.is_none_or(|(sent, seen, sent_us)| {
            let answered = seen != tip.at || now_us.saturating_sub(sent_us) >= PATIENCE_US;
            let gone_on = sent.distance(to) >= STEP_MM && answered;
            gone_on || (at_last && sent != to)
        });
        due.then(|| {
            tip.sent = Some((to, tip.at, now_us));
            Action::EditArrow(Arrow {
                from: on_raster(tip.at),
                to,
            })
        })
    }
}

impl Tip {
    /// Looks where the tip is now. If plates have come or gone it is the one nearest to where it was.
    fn look(&mut self, scene: &Scene<'_>) {
        let same = scene.plates.len() == self.plates;
        let own = scene.plates.get(self.plate).filter(|_| same);
        if let Some(&(_, tip)) = own.and_then(|plate| plate.arrows.get(self.arrow)) {
            self.at = scene.map.to_table(tip);
        } else if let Some(near) = tip_near(self.at, scene) {
            *self = Self {
                sent: self.sent,
                ..near
            };
        }
    }
}

/// The nearest arrow tip within reach of a place (table mm).
fn tip_near(place: DVec2, scene: &Scene<'_>) -> Option<Tip> {
    let mut best: Option<(f64, Tip)> = None;
    for (plate, mark) in scene.plates.iter().enumerate() {
        for (arrow, &(_, tip)) in mark.arrows.iter().enumerate() {
            let at = scene.map.to_table(tip);
            let distance = at.distance(place);
            if distance <= REACH_MM && best.is_none_or(|(least, _)| distance < least) {
                let tip = Tip {
                    plate,
                    arrow,
                    plates: scene.plates.len(),
                    at,
                    sent: None,
                };
                best = Some((distance, tip));
            }
        }
    }
    best.map(|(_, tip)| tip)
}

/// True where a plate stands, or where its push has carried it.
fn stands_on(plate: &PlateMark, place: DVec2, scene: &Scene<'_>) -> bool {
    let p = scene.map.to_plan(place);
    let (starts, tips): (Vec<DVec2>, Vec<DVec2>) = plate.arrows.iter().copied().unzip();
    let before = RigidFit::fit(&starts, &tips).motion.apply_inverse(p);
    inside(&plate.hull, p) || inside(&plate.hull, before)
}

/// Crossings of a ray to the east: odd inside.
fn inside(outline: &[DVec2], p: DVec2) -> bool {
    let mut inside = false;
    for (i, a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
            inside = !inside;
        }
    }
    inside
}

fn fault_near(fault: &FaultTrace, place: DVec2, scene: &Scene<'_>) -> bool {
    let points = fault.points.iter().map(|&p| scene.map.to_table(p));
    let points: Vec<DVec2> = points.collect();
    points
        .windows(2)
        .any(|ends| distance_to(place, ends[0], ends[1]) <= REACH_MM)
}

/// Distance of a place from the stretch between two others.
fn distance_to(place: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let part = (place - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    place.distance(a + along * part.clamp(0.0, 1.0))
}

/// The place on the raster of gesture files.
pub(super) fn on_raster(at: DVec2) -> DVec2 {
    DVec2::new(quantise_mm(at.x), quantise_mm(at.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inside_and_near() {
        let square = [
            DVec2::ZERO,
            DVec2::new(2.0, 0.0),
            DVec2::new(2.0, 2.0),
            DVec2::new(0.0, 2.0),
        ];
        assert!(inside(&square, DVec2::ONE));
        assert!(!inside(&square, DVec2::new(3.0, 1.0)));
        assert!(!inside(&square, DVec2::new(-1.0, 1.0)));
        assert!(!inside(&[], DVec2::ONE));
        let (a, b) = (DVec2::ZERO, DVec2::new(10.0, 0.0));
        assert_eq!(distance_to(DVec2::new(5.0, 3.0), a, b), 3.0);
        assert_eq!(distance_to(DVec2::new(13.0, 4.0), a, b), 5.0);
        assert_eq!(distance_to(DVec2::new(3.0, 4.0), a, a), 5.0);
    }
}
