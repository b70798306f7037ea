//! What visitors do outside the contacts: the closed vocabulary of `do` lines.

use super::contact::Side;

/// One `do` of a gesture file.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// What is done.
    pub action: Action,
    /// The side of the table it came from.
    pub side: Option<Side>,
}

/// The closed vocabulary.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Go on.
    Play,
    /// Stop the geological clock.
    Pause,
}
