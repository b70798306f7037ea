//! The session's thread, seen from outside: contacts go in without loss, the newest frame comes out.
//!
//! ```text
//!            contacts, commands, table time (a queue: nothing is lost, nobody waits)
//!   the app ────────────────────────────────────────────────────────────────────────▶ `orogen-sim`
//!           ◀────────────────────────────────────────────────────────────────────────
//!                        frames (three circulate: the newest wins, nobody waits)
//! ```
//!
//! * The thread reads no clock. [`Session::advance`] tells it how far the table's time has come, and it plays the ticks
//!   of 16 ms up to there. A session that falls behind is slowed, never skipped: its contacts happen closer together.
//! * What is played live is on the raster of gesture files, so that the last minute ([`Ring`]) replays to the bit (where
//!   a graphics card computes stages, to its rounding).
//! * A panic costs at most the last second: the session goes on from the last good moment, without contacts.

mod chart;
mod exchange;
mod frame;
mod globe;
mod mountain;
mod play;
mod ring;
#[cfg(test)]
mod tests;
mod timeline;
mod worker;

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::JoinHandle;

pub use frame::{Clock, Frame};
pub use globe::{Globe, GlobeFrame, LiveGlobeParams};
pub use mountain::{LiveParams, Mountain, Start};
pub use play::{Play, Published};
pub use ring::{RING_BYTES, RING_US, Ring};

use crate::gesture::command::Command;
use crate::gesture::contact::ContactEvent;
use exchange::{Reader, exchange};
use worker::{Message, Worker};

/// The mountain's session.
pub type Session = Live<Mountain>;

/// The planet's session.
pub type GlobeSession = Live<Globe>;

/// Signs of life, for a thread that watches.
#[derive(Debug, Default)]
struct Vitals {
    heartbeat: AtomicU64,
    slowed_us: AtomicU64,
}

/// A session of a world on a thread of its own. Dropping it ends the thread.
#[derive(Debug)]
pub struct Live<P: Play> {
    messages: Sender<Message<P>>,
    frames: Reader<P::Slot>,
    vitals: Arc<Vitals>,
    thread: Option<JoinHandle<()>>,
}

impl<P: Play> Live<P> {
    /// Starts the thread and waits until the world is there: [`Self::frame`] shows it at once.
    ///
    /// # Errors
    /// When the world cannot be made ([`io::ErrorKind::InvalidInput`]), or threads cannot be started.
    pub fn spawn(params: P::Params) -> io::Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(P::threads(&params))
            .thread_name(|index| format!("orogen-sim-{index}"))
            .build()
            .map_err(io::Error::other)?;
        let vitals = Arc::new(Vitals::default());
        let (messages, inbox) = mpsc::channel();
        let (ready, readiness) = mpsc::channel();
        let thread = std::thread::Builder::new().name("orogen-sim".to_owned()).spawn({
            let vitals = Arc::clone(&vitals);
            move || {
                let made = pool.install(|| -> io::Result<_> {
                    let world = P::open(params)?;
                    let (writer, reader) = exchange([(); 3].map(|()| world.slot()));
                    let mut worker = Worker::new(world, vitals, writer);
                    worker.publish();
                    Ok((worker, reader))
                });
                match made {
                    Ok((worker, reader)) => {
                        if ready.send(Ok(reader)).is_ok() {
                            worker.run(&inbox, &pool);
                        }
                    }
                    // If nobody waits any more, nobody wants to know.
                    Err(error) => drop(ready.send(Err(error))),
                }
            }
        })?;
        let frames = readiness
            .recv()
            .map_err(|_| io::Error::other("the session's thread ended before its world was there"))??;
        Ok(Self {
            messages,
            frames,
            vitals,
            thread: Some(thread),
        })
    }

    /// Hands over what contacts and commands do at table time `table_us` (µs). Nothing is lost, and what a contact does
    /// keeps its order, also within one moment: a tap may come whole. Does not wait.
    pub fn send(&self, events: Vec<ContactEvent>, commands: Vec<Command>, table_us: u64) {
        self.tell(Message::Input(events, commands, table_us));
    }

    /// The table's time has come to `table_us` (µs), and all input before that has been handed over. Does not wait.
    pub fn advance(&self, table_us: u64) {
        self.tell(Message::Advance(table_us));
    }

    /// The newest frame. Does not wait.
    pub fn frame(&mut self) -> &P::Frame {
        self.frames.newest().as_ref()
    }

    /// The frame that [`Self::frame`] returned last: the same for a whole turn of the caller's loop.
    pub fn current(&self) -> &P::Frame {
        self.frames.current().as_ref()
    }

    /// Begins again for the next visitor: another world, no contacts, session time zero. Input that was handed over before
    /// and has not been played is forgotten. Does not wait.
    pub fn restart(&self, start: P::Start) {
        self.tell(Message::Restart(start));
    }

    /// Asks for the session as it is, to be saved or exported elsewhere ([`crate::sim::Sim::resume`]) while this one goes
    /// on. Does not wait; the answer comes once, after the ticks that are being played.
    pub fn save_world(&self) -> Receiver<P::Kept> {
        let (reply, answer) = mpsc::channel();
        self.tell(Message::Save(reply));
        answer
    }

    /// Asks for the last minute of contacts as the bytes of a gesture file. Answers as [`Self::save_world`] does.
    pub fn ring_file(&self) -> Receiver<Vec<u8>> {
        let (reply, answer) = mpsc::channel();
        self.tell(Message::Ring(reply));
        answer
    }

    /// Rises with every turn of the thread's loop. It turns when there is a message, so it stands still for as long as
    /// [`Self::advance`] is not called.
    pub fn heartbeat(&self) -> Heartbeat {
        Heartbeat(Arc::clone(&self.vitals))
    }

    /// Session time that was left out since the session began because the thread could not keep up, µs.
    pub fn slowed_us(&self) -> u64 {
        self.vitals.slowed_us.load(Ordering::Relaxed)
    }

    fn tell(&self, message: Message<P>) {
        // The thread outlives panics; if it has ended all the same, its heartbeat stands still and the watch sees that.
        let _ = self.messages.send(message);
    }
}

/// The heartbeat of a session's thread, to be watched from another thread.
#[derive(Clone, Debug)]
pub struct Heartbeat(Arc<Vitals>);

impl Heartbeat {
    /// Beats so far.
    pub fn beats(&self) -> u64 {
        self.0.heartbeat.load(Ordering::Relaxed)
    }
}

impl<P: Play> Drop for Live<P> {
    fn drop(&mut self) {
        self.tell(Message::End);
        if let Some(thread) = self.thread.take() {
            // A panic of the thread was told when it happened.
            let _ = thread.join();
        }
    }
}
