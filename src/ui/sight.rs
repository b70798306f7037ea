//! Where things on the table and on the land are on the screen.

use egui::{Pos2, Rect};
use glam::DVec2;

use crate::surface::Raster;
use crate::units::PlanMap;

/// Steps in which a line is laid on the land where it is seen aslant, metres.
const DRAPE_STEP: f64 = 1500.0;

/// Most steps of one stretch of a line.
const MAX_STEPS: usize = 256;

/// Turns table millimetres and plan metres into egui's points.
#[derive(Clone, Copy)]
pub struct Sight<'a> {
    map: PlanMap,
    points_per_mm: f32,
    cast: Cast<'a>,
}

#[derive(Clone, Copy)]
enum Cast<'a> {
    /// Straight down: the table's top-left corner lies here.
    Flat(Pos2),
    /// Aslant: marks lie on the ground.
    Draped {
        ground: &'a Raster,
        project: &'a dyn Fn(DVec2, f64) -> Option<Pos2>,
    },
}

impl<'a> Sight<'a> {
    /// The table seen from straight above, filling the width of `rect` (points) from its top-left corner.
    pub fn flat(map: PlanMap, rect: Rect) -> Self {
        Self {
            map,
            points_per_mm: scale(&map, rect),
            cast: Cast::Flat(rect.min),
        }
    }

    /// The land seen aslant: `project` casts a plan position (metres) and a height (metres, as in `ground`) to points,
    /// `None` where it is behind the eye or hidden. Lines keep the thickness they have in [`Sight::flat`].
    pub fn draped(
        map: PlanMap,
        rect: Rect,
        ground: &'a Raster,
        project: &'a dyn Fn(DVec2, f64) -> Option<Pos2>,
    ) -> Self {
        Self {
            map,
            points_per_mm: scale(&map, rect),
            cast: Cast::Draped { ground, project },
        }
    }

    /// The map between table and land.
    pub fn map(&self) -> PlanMap {
        self.map
    }

    /// Points for `mm` of table.
    pub fn mm(&self, mm: f32) -> f32 {
        mm * self.points_per_mm
    }

    /// The place of a table position (mm).
    pub fn of_table(&self, mm: DVec2) -> Option<Pos2> {
        match self.cast {
            Cast::Flat(origin) => place(
                f64::from(origin.x) + mm.x * f64::from(self.points_per_mm),
                f64::from(origin.y) + mm.y * f64::from(self.points_per_mm),
            ),
            Cast::Draped { .. } => self.of_plan(self.map.to_plan(mm)),
        }
    }

    /// The place of a plan position (metres) on the ground.
    pub fn of_plan(&self, plan: DVec2) -> Option<Pos2> {
        match self.cast {
            Cast::Flat(_) => self.of_table(self.map.to_table(plan)),
            Cast::Draped { ground, project } => {
                let height = f64::from(ground.sample(plan));
                project(plan, height).and_then(|at| place(f64::from(at.x), f64::from(at.y)))
            }
        }
    }

    /// The stretches of a line over the land (plan metres) that can be seen, each of two places or more.
    pub(super) fn line(&self, plan: &[DVec2]) -> Vec<Vec<Pos2>> {
        let mut stretches = Vec::new();
        let mut current = Vec::new();
        let mut put = |place: Option<Pos2>| match place {
            Some(at) => current.push(at),
            None => stretches.push(std::mem::take(&mut current)),
        };
        for (i, &to) in plan.iter().enumerate() {
            let steps = match (self.cast, i) {
                (Cast::Flat(_), _) | (_, 0) => 1,
                (Cast::Draped { .. }, i) => {
                    ((plan[i - 1].distance(to) / DRAPE_STEP) as usize).clamp(1, MAX_STEPS)
                }
            };
            for step in 1..=steps {
                let from = plan[i.saturating_sub(1)];
                put(self.of_plan(from.lerp(to, step as f64 / steps as f64)));
            }
        }
        stretches.push(current);
        stretches.retain(|stretch| stretch.len() > 1);
        stretches
    }
}

/// Points per millimetre where the table's width fills `rect`; 1 where one of them has none.
fn scale(map: &PlanMap, rect: Rect) -> f32 {
    let scale = rect.width() / map.size_mm().x as f32;
    if scale.is_finite() && scale > 0.0 {
        scale
    } else {
        1.0
    }
}

/// A place that a screen can have; what is far outside would only upset the tessellator.
fn place(x: f64, y: f64) -> Option<Pos2> {
    const FARTHEST: f64 = 1e5;
    (x.abs() < FARTHEST && y.abs() < FARTHEST).then_some(Pos2::new(x as f32, y as f32))
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;
    use crate::units::DEFAULT_SHORT_SIDE;

    fn map() -> PlanMap {
        PlanMap::new(DVec2::new(1200.0, 600.0), DEFAULT_SHORT_SIDE)
    }

    #[test]
    fn table_and_plan_meet_on_the_screen() {
        let sight = Sight::flat(map(), Rect::from_min_max(pos2(10.0, 20.0), pos2(2410.0, 1220.0)));
        assert_eq!(sight.mm(3.0), 6.0);
        assert_eq!(sight.of_table(DVec2::ZERO), Some(pos2(10.0, 20.0)));
        let at = DVec2::new(300.0, 150.0);
        let (table, plan) = (sight.of_table(at), sight.of_plan(map().to_plan(at)));
        assert!(table.zip(plan).is_some_and(|(a, b)| a.distance(b) < 1e-3));
        assert_eq!(sight.of_table(DVec2::NAN), None);
        assert_eq!(sight.of_table(DVec2::splat(1e30)), None);
    }

    #[test]
    fn a_draped_line_follows_the_ground_and_breaks_where_it_is_hidden() {
        let extent = map().extent();
        let ground = Raster::from_fn(64, 32, extent, |p| (p.x * 0.01) as f32);
        let project = |p: DVec2, z: f64| (p.x < 100e3).then(|| pos2((p.x / 1e3) as f32, (-z) as f32));
        let rect = Rect::from_min_max(Pos2::ZERO, pos2(1200.0, 600.0));
        let sight = Sight::draped(map(), rect, &ground, &project);
        let line = sight.line(&[
            DVec2::new(10e3, 50e3),
            DVec2::new(190e3, 50e3),
            DVec2::new(20e3, 50e3),
        ]);
        assert_eq!(line.len(), 2, "out of sight and back");
        assert!(line[0].len() > 30);
        for at in line.iter().flatten() {
            assert!(
                (at.x * 1e3 * 0.01 + at.y).abs() < 20.0,
                "{at:?} is not on the ground"
            );
        }
    }
}
