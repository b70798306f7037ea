//! All parameters of a session, apart from its state.

use crate::gesture::params::GestureParams;
use crate::isostasy::IsostasyParams;
use crate::mountain::MountainParams;
use crate::terrain::{Deposition, ErosionParams};
use crate::units::MYR;

/// What [`Sim`](super::Sim) needs to know besides the world. Passed in, never stored in the [`World`](super::World).
#[derive(Clone, Debug, PartialEq)]
pub struct SimParams {
    /// When fingers are hands, and what they mean.
    pub gesture: GestureParams,
    /// Plates, transport and uplift.
    pub mountain: MountainParams,
    /// Rivers and landslides.
    pub erosion: ErosionParams,
    /// How the crust floats on its mantle; `None`: it does not, thickening is uplift (the paper).
    pub isostasy: Option<IsostasyParams>,
    /// Most pairs of layers that fold, longest folds first. Default 2: finer folds are not seen while the land is
    /// sculpted.
    pub fold_layers: usize,
    /// Model years per second of session time at speed 1. Default 0.5 My; slower is a lesson, faster a blur.
    pub pace_yr_per_s: f64,
    /// Length of one erosion step in years, 25–100 ky. Longer steps make the drainage flicker (D23), shorter ones
    /// only cost time. Default 50 ky.
    pub erosion_dt_yr: f64,
    /// How long a world runs on after its last push, years. Default 5 My, as long as a push lasts.
    pub run_on_yr: f64,
    /// A push answers when it changes the uplift somewhere by at least this much, m/yr. The default of 4e-5 raises
    /// or sinks the land by 20 m within a second at the default pace; less than that nobody sees.
    pub answer_m_per_yr: f64,
    /// Most memory that undo may keep, bytes. The oldest snapshots go first.
    pub undo_bytes: usize,
    /// Most memory that the history for scrubbing may keep, bytes. When it is full every second snapshot goes; 0 keeps
    /// no history, and then nobody can scrub.
    pub history_bytes: usize,
}

impl SimParams {
    /// The paper's rules: [`MountainParams::paper`], a crust that does not float, and rivers that lay nothing down.
    pub fn paper() -> Self {
        Self {
            mountain: MountainParams::paper(),
            erosion: ErosionParams::default(),
            isostasy: None,
            ..Self::default()
        }
    }
}

impl Default for SimParams {
    fn default() -> Self {
        Self {
            gesture: GestureParams::default(),
            mountain: MountainParams::default(),
            erosion: ErosionParams {
                deposition: Some(Deposition::default()),
                ..ErosionParams::default()
            },
            isostasy: Some(IsostasyParams::default()),
            fold_layers: 2,
            pace_yr_per_s: 0.5 * MYR,
            erosion_dt_yr: 50_000.0,
            run_on_yr: 5.0 * MYR,
            answer_m_per_yr: 4e-5,
            undo_bytes: 256 << 20,
            history_bytes: 256 << 20,
        }
    }
}
