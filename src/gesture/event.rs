//! What the hands tell the world: the joint between gestures and plates.

use glam::DVec2;

use super::contact::{ContactKey, Side};
use super::rigid::RigidFit;

/// Names a hand for the whole session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HandId(pub u32);

/// One stretch of a hand's motion between two reversals. Each leg is a push of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Leg {
    /// The hand.
    pub hand: HandId,
    /// Counts the hand's legs from 0.
    pub index: u32,
}

/// What hands did in a tick. Positions are table millimetres; fits are in table millimetres, y down.
#[derive(Clone, Debug, PartialEq)]
pub enum HandEvent {
    /// The hand rests: its fingers anchor a reference plate.
    Rest {
        /// The hand.
        hand: HandId,
        /// The side of the table it belongs to.
        side: Side,
        /// Where its fingers are.
        fingers: Vec<DVec2>,
    },
    /// The hand pushes: sent when the push begins and whenever its fit changes.
    Push {
        /// The leg.
        leg: Leg,
        /// The side of the table it belongs to.
        side: Side,
        /// Where the fingers were when the leg began; a late finger's start is where the plate carried it from.
        starts: Vec<DVec2>,
        /// Best rigid motion from the starts to the present positions.
        fit: RigidFit,
    },
    /// The leg is over (lifted, or turned back): the push stands as it is.
    PushEnd {
        /// The leg.
        leg: Leg,
    },
    /// The hand touched and left without moving.
    Tap {
        /// The hand.
        hand: HandId,
        /// The side of the table it belongs to.
        side: Side,
        /// Where its fingers were.
        fingers: Vec<DVec2>,
    },
    /// A resting hand was lifted: its anchor stands.
    Lift {
        /// The hand.
        hand: HandId,
    },
    /// Contacts that have already acted turn out to be a palm, a sleeve or a ghost within the revision time: all
    /// they did is to be undone.
    Retract {
        /// The contacts.
        contacts: Vec<ContactKey>,
        /// Session time of the first thing they did, µs.
        since_us: u64,
    },
}
