//! What eyes and reports may ask of a session.

use super::step::Sim;
use crate::mountain;
use crate::surface::{FaultTrace, PlateMark, PlateState};
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
}
