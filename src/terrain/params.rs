//! How the land erodes: parameters and their ranges.

use super::sediment::Deposition;

/// What the border of the land does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Edges {
    /// Every border node is an outlet and keeps its height (or [`ErosionParams::base_level`]); it neither rises nor
    /// erodes. The land drains over all its sides.
    #[default]
    Fixed,
    /// Border nodes rise, erode and slide like any other. Water leaves where a border node has no lower neighbour, or
    /// where a lake spills over the border; there is always at least one such outlet. Outlets rise with the uplift
    /// and are cut down only by [`ErosionParams::base_level`].
    Free,
}

/// How the land erodes. Passed to each step, never stored in the land.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErosionParams {
    /// Erosion constant k of Eq. 5, 1/yr at m = 0.5 and n = 1. Smaller leaves plateaus, larger wears ranges down
    /// before they are high. The paper: 2.5e-7–8e-7.
    pub k: f64,
    /// Exponent m of the drainage area. m/n near 0.5 gives the concavity of real rivers.
    pub m: f64,
    /// Exponent n of the slope. 1 is solved exactly; others cost some iterations per node.
    pub n: f64,
    /// Talus slope tan θ above which slopes slide. 0 slides everywhere, large values never.
    pub talus: f64,
    /// Landslide rate l, m/yr. The steady slope exceeds the talus by U/l.
    pub landslide_rate: f64,
    /// Whether slopes slide at all.
    pub landslides: bool,
    /// What the border of the land does.
    pub edges: Edges,
    /// Height of the base level, m. None: with fixed edges each border node stays where it is, with free edges nothing
    /// cuts outlets down. Some: with fixed edges all border nodes are set to it; with free edges outlets above it
    /// incise towards it as if it lay one node spacing beyond the border.
    pub base_level: Option<f64>,
    /// How rivers lay down what they carry, in steps that keep sediment. None: what is eroded leaves the land at once,
    /// as in the paper. Some: n must be 1; with another n nothing is laid down.
    pub deposition: Option<Deposition>,
}

impl Default for ErosionParams {
    fn default() -> Self {
        Self {
            k: 1.8e-6,
            m: 0.5,
            n: 1.0,
            // 30°
            talus: 1.0 / 3.0_f64.sqrt(),
            landslide_rate: 1e-2,
            landslides: true,
            edges: Edges::Fixed,
            base_level: None,
            deposition: None,
        }
    }
}

/// Range of a parameter: validates settings and drives controls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Field of [`ErosionParams`] or [`Deposition`].
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

/// A parameter outside its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{} is {found} {}: expected {} to {}", bound.name, bound.unit, bound.min, bound.max)]
pub struct OutOfBounds {
    /// The range.
    pub bound: Bound,
    /// What was found.
    pub found: f64,
}

impl ErosionParams {
    /// Ranges of the numeric parameters.
    pub const BOUNDS: [Bound; 5] = [
        bound("k", "1/yr", 0.0, 1e-2),
        bound("m", "", 0.0, 2.0),
        bound("n", "", 0.2, 4.0),
        bound("talus", "", 0.0, 10.0),
        bound("landslide_rate", "m/yr", 0.0, 10.0),
    ];

    /// Checks each parameter against its range; the base level against ±20 km; and n against 1 where there is
    /// deposition.
    ///
    /// # Errors
    /// The first parameter outside its range (NaN is outside every range).
    pub fn check(&self) -> Result<(), OutOfBounds> {
        let values = [self.k, self.m, self.n, self.talus, self.landslide_rate];
        let base = (
            bound("base_level", "m", -2e4, 2e4),
            self.base_level.unwrap_or(0.0),
        );
        for (bound, found) in Self::BOUNDS.into_iter().zip(values).chain([base]) {
            if !(bound.min..=bound.max).contains(&found) {
                return Err(OutOfBounds { bound, found });
            }
        }
        let Some(deposition) = self.deposition else {
            return Ok(());
        };
        if self.n != 1.0 {
            return Err(OutOfBounds {
                bound: bound("n, with deposition,", "", 1.0, 1.0),
                found: self.n,
            });
        }
        deposition.check()
    }
}

pub(super) const fn bound(name: &'static str, unit: &'static str, min: f64, max: f64) -> Bound {
    Bound { name, unit, min, max }
}
