//! What a session's thread asks of the world it plays.

use std::io;

use crate::gesture::contact::InputFrame;

/// What the thread itself adds to a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Published {
    /// Rises with every frame.
    pub sequence: u64,
    /// Times that the thread panicked and went on from the last good moment.
    pub panics: u64,
    /// Steps of the world taken since the thread began.
    pub steps: u64,
}

/// A world that can be played live, tick by tick. All its methods are called on the session's thread, in its pool.
pub trait Play: Sized + Send + 'static {
    /// What it needs to know to begin.
    type Params: Send + 'static;
    /// What it begins again with.
    type Start: Send + 'static;
    /// The world as it is kept elsewhere.
    type Kept: Send + 'static;
    /// What can be seen of it at one moment.
    type Frame;
    /// A frame that circulates, with what is needed to fill it anew.
    type Slot: AsRef<Self::Frame> + Send + 'static;

    /// Threads that compute; 0 takes one per core.
    fn threads(params: &Self::Params) -> usize;

    /// Makes the world.
    ///
    /// # Errors
    /// When there is no such world.
    fn open(params: Self::Params) -> io::Result<Self>;

    /// A frame with nothing in it yet.
    fn slot(&self) -> Self::Slot;

    /// Ticks played.
    fn ticks(&self) -> u64;

    /// Input of the tick that is next.
    fn feed(&mut self, frame: InputFrame);

    /// Plays a tick: how many costly steps that took.
    fn tick(&mut self) -> u32;

    /// Draws the world as it is.
    fn draw(&mut self, slot: &mut Self::Slot, published: Published);

    /// Begins again.
    fn begin(&mut self, start: Self::Start);

    /// This moment is a good one, to go on from after a panic.
    fn remember(&mut self);

    /// Goes back to the last good moment, without contacts, at the tick that was reached. `relapses` counts the panics since
    /// that moment: the more, the less of it is to be trusted.
    fn recover(&mut self, relapses: u32);

    /// The world as it is.
    fn kept(&self) -> Self::Kept;

    /// The last minute of contacts.
    fn ring(&self) -> &super::Ring;
}
