//! What eyes and reports may ask of a session.

use super::step::Sim;
use crate::gesture::contact::Side;
use crate::gesture::hand::HandView;
use crate::mountain::{self, Plate};
use crate::surface::{FaultTrace, PlateMark, PlateState};
use crate::terrain::Edges;
use crate::units::KM;

/// Step along the outline of a support on the map, metres.
const OUTLINE_STEP: f64 = 0.5 * KM;

impl Sim {
    /// The plates as marks on the map, in the order they were made.
    pub fn plate_marks(&self) -> Vec<PlateMark> {
        let now_yr = self.world().time_yr;
        let plates = self.world().plates.plates().iter();
        plates
            .map(|plate| PlateMark {
                hull: plate.support.outline(OUTLINE_STEP),
                arrows: plate.arrows().collect(),
                spent: plate.spent(now_yr),
                state: match plate.state(now_yr) {
                    mountain::PlateState::Resting => PlateState::Resting,
                    mountain::PlateState::Pushing => PlateState::Pushing,
                    mountain::PlateState::Standing => PlateState::Standing,
                },
                cap: (plate.cap < 1.0).then_some(plate.cap),
            })
            .collect()
    }

    /// The faults that move, and those that have moved not long ago.
    pub fn fault_traces(&self) -> Vec<FaultTrace> {
        let faults = self.state.uplift.faults.iter();
        faults
            .map(|(fault, _)| FaultTrace {
                points: fault.points.clone(),
                range_on_left: true,
            })
            .collect()
    }

    /// The hands that are down, by id.
    pub fn hands(&self) -> impl Iterator<Item = HandView> {
        self.state.hands.hands()
    }

    /// True while somebody has stopped the geological clock.
    pub fn paused(&self) -> bool {
        self.state.paused
    }

    /// Model years per second of session time while the clock runs.
    pub fn pace_yr_per_s(&self) -> f64 {
        self.state.pace_yr_per_s
    }

    /// True if `side` has something to undo.
    pub fn can_undo(&self, side: Side) -> bool {
        self.undoable(Some(side)).is_some()
    }

    /// Times that the history reaches back and forward to, years: the present, where nothing else is kept.
    pub fn history_yr(&self) -> (f64, f64) {
        let now_yr = self.world().time_yr;
        let kept = self.state.history.range_yr();
        kept.map_or((now_yr, now_yr), |(first, last)| (first, last.max(now_yr)))
    }

    /// Model time that has passed since the last step of the land, years.
    pub fn pending_yr(&self) -> f64 {
        self.state.pending_yr
    }

    /// Rises whenever the heights at the nodes have changed.
    pub fn land_revision(&self) -> u64 {
        self.land_revision
    }

    /// How fast each node rises (or sinks) at present, m/yr: the uplift as of [`Self::refresh_uplift`], less what
    /// erosion has taken of late. Heights plus this times [`Self::pending_yr`] are the land at this moment, between two
    /// steps.
    pub fn rise_into(&self, rise: &mut Vec<f64>) {
        let uplift = if self.ahead {
            &self.rates
        } else {
            &self.state.uplift.at_nodes
        };
        let fixed = self.params.erosion.edges == Edges::Fixed;
        let border = self.world().tin.border();
        rise.clear();
        rise.extend(
            uplift
                .iter()
                .zip(border)
                .enumerate()
                .map(|(i, (&rate, &border))| {
                    if rate.is_finite() && !(fixed && border) {
                        rate - self.wear.at(i)
                    } else {
                        0.0
                    }
                }),
        );
    }

    /// Speed of the fastest plate that pushes, against the ground, m/yr: the way of its middle over the length of a
    /// push. 0 while none pushes.
    pub fn convergence_m_per_yr(&self) -> f64 {
        let way = |plate: &Plate| {
            let middle = plate.support.centre();
            plate.motion.apply(middle).distance(middle)
        };
        let fastest = self.pushing().map(way).fold(0.0, f64::max);
        fastest / self.params.mountain.push_years
    }

    /// Greatest shortening of the crust so far by the pushes that are under way, as a part of its first length: where
    /// crust is to become `q` times as thick it loses `1 − 1/q` of its length in the end, and so far the part of that
    /// which is spent. 0 while none pushes.
    pub fn shortening(&self) -> f64 {
        let now_yr = self.world().time_yr;
        let spent = self
            .pushing()
            .map(|plate| plate.spent(now_yr))
            .fold(0.0, f64::max);
        let thickest = self.last_motion().map_or(1.0, |report| report.transport.q_max);
        spent * (1.0 - 1.0 / thickest.max(1.0))
    }

    fn pushing(&self) -> impl Iterator<Item = &Plate> {
        let world = self.world();
        let plates = world.plates.plates().iter();
        plates.filter(|plate| plate.state(world.time_yr) == mountain::PlateState::Pushing)
    }
}
