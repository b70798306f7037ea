//! What can be seen of the hands, and what is counted.

use glam::DVec2;

use super::contact::Side;
use super::event::{HandId, Leg};
use super::rigid::RigidFit;

/// What became of the contacts of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactStats {
    /// Contacts that went down.
    pub total: u64,
    /// Hands, counting what hands fell apart into.
    pub hands: u64,
    /// Legs that hands dragged.
    pub pushes: u64,
    /// Hands that rested.
    pub rests: u64,
    /// Hands that tapped.
    pub taps: u64,
    /// Hands that fell apart.
    pub splits: u64,
    /// Contacts taken for palms, sleeves or ghosts, or withdrawn by their source.
    pub dropped_ghosts: u64,
    /// Those of them that had acted, so that what they did was undone.
    pub retracted: u64,
    /// Events of contacts that were not down, or with coordinates that are no place.
    pub ignored: u64,
    /// Downs of contacts that were down.
    pub doubled: u64,
    /// Contacts that went on with the stroke of another, which had flickered.
    pub bridged: u64,
    /// Contacts that were stuck.
    pub stuck: u64,
    /// Downs beyond [`super::contact::MAX_CONTACTS`].
    pub over_cap: u64,
}

/// A hand as it is now, for drawing. Table millimetres.
#[derive(Clone, Debug, PartialEq)]
pub struct HandView {
    /// The hand.
    pub hand: HandId,
    /// The side of the table it belongs to.
    pub side: Side,
    /// Where the fingers are that are down.
    pub fingers: Vec<DVec2>,
    /// What it does.
    pub doing: Doing,
}

/// What a hand does.
#[derive(Clone, Debug, PartialEq)]
pub enum Doing {
    /// Too soon to tell.
    Touching,
    /// It anchors a plate.
    Resting,
    /// It pushes.
    Pushing {
        /// The leg.
        leg: Leg,
        /// Where the fingers were when the leg began, as in [`super::event::HandEvent::Push`].
        starts: Vec<DVec2>,
        /// The motion.
        fit: RigidFit,
    },
}
