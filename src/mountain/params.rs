//! What can be set in the mountain half, with meaning, unit, range, and what breaks at the ends.

use crate::units::{KM, MYR};

/// How thickening becomes uplift.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpliftRule {
    /// Tapered belts between the hulls, rifts where plates part, `u0 = α (q − 1)`.
    Belts,
    /// The paper's section 4.3: `u0 = α (q − 1)` with `α` such that the mean over `u0 > 0` is
    /// [`MountainParams::paper_mean`]; nothing on the stable side of the fault, no extension.
    Paper,
}

/// Parameters of plates, transport and uplift. Lengths in metres, times in years, rates in m/yr.
#[derive(Clone, Debug, PartialEq)]
pub struct MountainParams {
    /// Cells of the transport grid in all; a land of few nodes has fewer ([`Self::for_nodes`]). Default 1024². Range
    /// 64²–2048²: below about 256² the rims of hulls get rough, above 1024² a gesture no longer answers within a frame on
    /// two cores.
    pub cells: usize,
    /// Exponent `e` of the distance weights of Eq. 2. Default 0.9 (the paper's). Range 0.5–2: towards 0 every plate
    /// carries everything, above 1 the strain leaves the hulls and gathers mid-gap.
    pub exponent: f64,
    /// Distance `D` of the rest weight `1/D^e` in Eq. 2's denominator: the ground itself rests a little. Default
    /// 40 km; `∞` is the paper. Range 10 km–∞: below, pushes do not reach another hand; above about 200 km a lone
    /// finger carries the whole map along and raises nothing.
    pub rest_distance: f64,
    /// Radius by which the hull of the fingertips is grown. Default 4.5 km. Range 1–15 km: smaller discs tear the
    /// crust in front of one finger, larger ones merge neighbouring hands.
    pub finger_radius: f64,
    /// How long a push works after its last change, years. Default 5 My. The arrow is the whole displacement. Range
    /// 0.5–20 My: shorter pushes end before rivers answer.
    pub push_years: f64,
    /// Part of the gap between two hulls that no push can close. Default 0.35. Range 0.1–0.9: at 0 the hulls touch
    /// and Eq. 2 becomes 0/0.
    pub gap_kept: f64,
    /// The rule from thickening to uplift. Default [`UpliftRule::Belts`].
    pub rule: UpliftRule,
    /// `α`: uplift per unit of thickening `q − 1`. Default 2.6e-3 m/yr. Range 1e-4–1e-2.
    pub rise_per_thickening: f64,
    /// Uplift is softly capped here. Default 1.3e-3 m/yr. Range 1e-4–1e-2: real belts rarely exceed a few mm/yr, and
    /// summits grow with it.
    pub rise_limit: f64,
    /// Subsidence of a rift is softly capped here (a positive rate). Default 0.4e-3 m/yr: in the 5 My of a push that
    /// is the depth of a great rift lake and the sediment under it. Range 0–5e-3; 0 switches rifts off.
    pub sink_limit: f64,
    /// Greatest width of a rift. Default 24 km. Range 5–100 km: real rifts are some 20–60 km wide however far apart
    /// the plates that part (Kenya, Rhine, Baikal); wider ones become inland seas.
    pub rift_width: f64,
    /// Mean uplift over `u0 > 0` under [`UpliftRule::Paper`]. Default 5e-4 m/yr.
    pub paper_mean: f64,
    /// Level of the fault's trace, as a part of the 95th percentile of what is raised. Default 0.25. Range 0.05–0.6:
    /// at the ends the trace leaves the foot of the steep front.
    pub fault_level: f64,
    /// Width of the steep front above a fault. Default 5 km. Range 1–15 km: the front is a wall of single cells
    /// below, and no front above.
    pub front_width: f64,
    /// Width of the long back on the other side. Default 12 km. Range 3–40 km.
    pub back_width: f64,
    /// How far the belt's edges keep away from the hulls. Default 2 km. Range 0–10 km: at 0 the rim of Eq. 2, where
    /// `q` is highest, shines through.
    pub rim_offset: f64,
    /// The fault between two plates stands off the stable one by this part of the gap. Default 0.2. Range 0–0.4: at 0
    /// the crest leans on the resting hand, above 0.4 the belt has no room for its back.
    pub fault_stand: f64,
    /// Along the strike a belt fades over this part of the gap. Default 0.5. Range 0.1–1.5: below, belts end in
    /// walls; above, they get horns beyond the hands.
    pub strike_fade: f64,
    /// A second plate takes part in a push fully up to the first gap and not at all beyond the second. Default
    /// 50 km, 90 km.
    pub reach: [f64; 2],
    /// The same for plates that part. Default 20 km, 60 km: two visitors who push away from each other across half
    /// the table do not tear it.
    pub rift_reach: [f64; 2],
    /// Towards the border of the map, which stands still, uplift fades over this distance. Default 5 km. Range 0–30 km:
    /// at 0 a range that reaches the border ends in a wall.
    pub border_fade: f64,
    /// Sinuosity: how far fronts wander from their smooth curve. Default 1.3 km. Range 0–4 km; 0 makes fields exactly
    /// symmetrical where gestures are.
    pub sinuosity: f64,
    /// Radius (standard deviation) of the dome under a tapping finger. Default 3.5 km. Range 1–10 km.
    pub dome_radius: f64,
    /// Height of that dome when it has risen. Default 150 m. Range 0–1000 m.
    pub dome_height: f64,
    /// How long it rises. Default 0.25 My. Range 0.02–5 My: shorter and the ground pops.
    pub dome_years: f64,
}

impl Default for MountainParams {
    fn default() -> Self {
        Self {
            cells: 1024 * 1024,
            exponent: 0.9,
            rest_distance: 40.0 * KM,
            finger_radius: 4.5 * KM,
            push_years: 5.0 * MYR,
            gap_kept: 0.35,
            rule: UpliftRule::Belts,
            rise_per_thickening: 2.6e-3,
            rise_limit: 1.3e-3,
            sink_limit: 0.4e-3,
            rift_reach: [20.0 * KM, 60.0 * KM],
            rift_width: 24.0 * KM,
            paper_mean: 5e-4,
            fault_level: 0.25,
            front_width: 5.0 * KM,
            back_width: 12.0 * KM,
            rim_offset: 2.0 * KM,
            fault_stand: 0.2,
            strike_fade: 0.5,
            reach: [50.0 * KM, 90.0 * KM],
            border_fade: 5.0 * KM,
            sinuosity: 1.3 * KM,
            dome_radius: 3.5 * KM,
            dome_height: 150.0,
            dome_years: 0.25 * MYR,
        }
    }
}

/// Cells for each node: a cell is then as wide as a quarter of the way between two nodes. What is finer, no node feels.
const CELLS_PER_NODE: usize = 18;
/// Cells that the rims of hulls need on any land.
const LEAST_CELLS: usize = 256 * 256;

impl MountainParams {
    /// The same for a land of `nodes` nodes: its grid is no finer than they can feel. A table that can step few nodes has
    /// no time for a fine grid either, and a recording made on it replays on the same one.
    #[must_use]
    pub fn for_nodes(mut self, nodes: usize) -> Self {
        self.cells = self.cells.min((CELLS_PER_NODE * nodes).max(LEAST_CELLS));
        self
    }

    /// The published rules: no resting ground, no tapers, mean uplift 5e-4 m/yr whatever the push.
    pub fn paper() -> Self {
        Self {
            rest_distance: f64::INFINITY,
            rule: UpliftRule::Paper,
            sink_limit: 0.0,
            sinuosity: 0.0,
            border_fade: 0.0,
            ..Self::default()
        }
    }

    /// The rest weight `1/D^e` of Eq. 2's denominator.
    pub fn rest_weight(&self) -> f64 {
        self.rest_distance.powf(-self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_is_no_finer_than_the_nodes_feel() {
        let cells = |nodes| MountainParams::default().for_nodes(nodes).cells;
        assert_eq!(cells(1_000_000), 1024 * 1024);
        assert_eq!(cells(60_000), 1024 * 1024, "the usual land has the whole grid");
        assert_eq!(cells(15_000), 270_000);
        assert_eq!(cells(100), 256 * 256);
        let few = MountainParams {
            cells: 64 * 64,
            ..MountainParams::default()
        };
        assert_eq!(few.for_nodes(60_000).cells, 64 * 64, "nobody asked for more");
    }
}
