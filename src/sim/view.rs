//! What eyes and reports may ask of a session.

use super::Cut;
use super::exposure::Exposure;
use super::folding::FoldingLayer;
use super::step::Sim;
use crate::gesture::contact::Side;
use crate::gesture::hand::HandView;
use crate::mountain::fold::{FoldStats, lines};
use crate::mountain::strata::NodeFolds;
use crate::mountain::{self, Plate};
use crate::surface::{FaultTrace, FoldLine, PlateMark, PlateState};
use crate::survey::Underground;
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

    /// Figures of the folds at the last moment when a plate moved, pair by pair.
    pub fn fold_stats(&self) -> Vec<(FoldingLayer, FoldStats)> {
        let Some(drive) = &self.state.last_folding else {
            return Vec::new();
        };
        let of = |layer: FoldingLayer| {
            let mut known = self.world().skeletons.iter();
            let known = known.find(|known| known.interface == layer.interface)?;
            Some((layer, FoldStats::of(&known.mesh, &known.skeleton, drive)))
        };
        self.folding_layers().into_iter().filter_map(of).collect()
    }

    /// Crests and troughs of the folds of the `most` pairs of layers that fold in the longest waves.
    pub fn fold_lines(&self, most: usize) -> Vec<FoldLine> {
        let mut marks = Vec::new();
        for layer in self.world().skeletons.iter().take(most) {
            let crests = lines::top_lines(&layer.mesh, &layer.skeleton);
            let troughs = lines::bottom_lines(&layer.mesh, &layer.skeleton);
            for (lines, crest) in [(crests, true), (troughs, false)] {
                marks.extend(lines.into_iter().map(|points| FoldLine {
                    points,
                    crest,
                    layer: layer.interface - 1,
                    wavelength_m: layer.mesh.wavelength(),
                }));
            }
        }
        marks
    }

    /// The layers under the land, node by node.
    pub fn underground(&self) -> Underground<'_> {
        self.world().underground()
    }

    /// The cross-section that a side of the table looks at.
    pub fn cut(&self, side: Side) -> Option<&Cut> {
        self.state.cuts[side as usize].as_ref()
    }

    /// Rises whenever the heights at the nodes have changed.
    pub fn land_revision(&self) -> u64 {
        self.land_revision
    }

    /// How fast each node rises (or sinks) at present, m/yr: the uplift as of [`Self::refresh_uplift`], less what
    /// erosion has taken of late. Heights plus this times [`Self::pending_yr`] are the land at this moment, between two
    /// steps.
    pub fn rise_into(&self, rise: &mut Vec<f64>) {
        let mut exposure = Exposure {
            rise: std::mem::take(rise),
            ..Exposure::default()
        };
        let uplift = &self.state.uplift;
        let (base, folds) = if self.ahead {
            (&self.rates, &self.fold_rates)
        } else {
            (&uplift.at_nodes, &uplift.folds)
        };
        let folds: Vec<&NodeFolds> = folds.iter().collect();
        // The plate bends slowly: it sinks on as it did in the last step.
        let mut floating = base.clone();
        if let Some(params) = &self.params.isostasy
            && self.base.len() == base.len()
        {
            for ((rate, at_last), felt) in floating.iter_mut().zip(&self.base).zip(&uplift.at_nodes) {
                *rate = params.boost * (*rate - felt) + at_last;
            }
        }
        exposure.read(self.world(), &floating, &folds);
        *rise = exposure.rise;
        let fixed = self.params.erosion.edges == Edges::Fixed;
        let border = self.world().tin.border();
        for (i, (rate, &border)) in rise.iter_mut().zip(border).enumerate() {
            *rate = if rate.is_finite() && !(fixed && border) {
                *rate - self.wear.at(i)
            } else {
                0.0
            };
        }
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
