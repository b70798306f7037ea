//! What the session's thread hands to whoever looks at it.

use crate::gesture::hand::{ContactStats, HandView};
use crate::sim::{Quarantine, SessionCounts};
use crate::surface::{Cut, Surface};

/// Everything that can be seen of the session at one moment. Plain data; frames circulate and are filled anew.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Rises with every frame.
    pub sequence: u64,
    /// Rises when the rasters or rivers of `surface` have changed; marks may change without.
    pub land: u64,
    /// The land and what lies on it.
    pub surface: Surface,
    /// The hands that are down.
    pub hands: Vec<HandView>,
    /// Cross-sections of the north and south side.
    pub cuts: [Option<Cut>; 2],
    /// Time, and what moves.
    pub clock: Clock,
    /// What became of the contacts since the session began.
    pub contacts: ContactStats,
    /// What else is counted.
    pub counts: SessionCounts,
    /// Numbers that were none.
    pub quarantine: Quarantine,
    /// Times that the session's thread panicked and went on from the last good world.
    pub panics: u64,
    /// Erosion steps taken since the thread began.
    pub steps: u64,
}

impl Frame {
    /// A frame of `surface` before anything has happened.
    pub fn new(surface: Surface) -> Self {
        Self {
            sequence: 0,
            land: 0,
            surface,
            hands: Vec::new(),
            cuts: [None, None],
            clock: Clock::default(),
            contacts: ContactStats::default(),
            counts: SessionCounts::default(),
            quarantine: Quarantine::default(),
            panics: 0,
            steps: 0,
        }
    }
}

/// The geological clock and the figures that go with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Model time since the land was new, years.
    pub elapsed_yr: f64,
    /// True while somebody has stopped it.
    pub paused: bool,
    /// True when the world has run on for as long as it may and nothing moves.
    pub at_rest: bool,
    /// Model years per second of session time while it runs.
    pub pace_yr_per_s: f64,
    /// Times that history reaches back and forward to, years.
    pub history_yr: (f64, f64),
    /// True for the sides (north, south) that have something to undo.
    pub can_undo: [bool; 2],
    /// Speed at which the fastest plate moves against the ground, m/yr; 0 while none pushes.
    pub convergence_m_per_yr: f64,
    /// Greatest shortening of the crust so far by the pushes that are under way, as a part of its first length.
    pub shortening: f64,
}
