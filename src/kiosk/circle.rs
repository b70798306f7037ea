//! The circle from one visitor to the next.

/// Where the table is in its circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Nobody is there; the show plays.
    Attract,
    /// Somebody has touched; ghost hands show what hands do.
    Invite,
    /// Somebody sculpts.
    Play,
    /// Nobody has touched for a while; any touch ends the warning.
    IdleWarning {
        /// Until the reset, ms.
        left_ms: u64,
    },
    /// The land becomes fresh for the next visitor.
    Reset,
}

/// What is to be done when the phase changes, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The show begins.
    StartShow,
    /// The show ends, and its contacts with it.
    CancelShow,
    /// All contacts are withdrawn.
    CancelContacts,
    /// The land starts afresh: new world, empty history.
    FreshLand,
    /// Tools, figures and speed are as on a new table.
    ResetTools,
    /// The view is the plan.
    ResetView,
}
