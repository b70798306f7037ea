//! The session's thread: takes messages, plays ticks, publishes frames, and survives.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender};

use rayon::ThreadPool;

use super::exchange::Writer;
use super::timeline::Timeline;
use super::{Play, Published, Vitals};
use crate::gesture::command::{self, Command};
use crate::gesture::contact::ContactEvent;
use crate::sim::TICK_US;

/// Costly steps after which the world is shown before more are taken: a session that lags still moves.
const MOST_STEPS: u32 = 2;
/// Ticks between two moments that a session can go on from after a panic: about a second.
const CHECKPOINT_TICKS: u64 = 62;

/// What the session is told.
pub(super) enum Message<P: Play> {
    /// Contacts and commands, and table time, µs.
    Input(Vec<ContactEvent>, Vec<Command>, u64),
    /// Table time has come to this, µs.
    Advance(u64),
    Restart(P::Start),
    Save(Sender<P::Kept>),
    Ring(Sender<Vec<u8>>),
    End,
    /// The next batch panics.
    #[cfg(test)]
    Fault,
}

/// The session and what belongs to its thread.
pub(super) struct Worker<P: Play> {
    world: P,
    vitals: Arc<Vitals>,
    frames: Writer<P::Slot>,
    timeline: Timeline,
    /// The tick of the last good moment.
    good_tick: u64,
    /// Panics since then.
    relapses: u32,
    published: Published,
    /// The session is not what the last frame shows.
    changed: bool,
    /// What the next batch is to do, beside playing.
    restart: Option<P::Start>,
    saves: Vec<Sender<P::Kept>>,
    rings: Vec<Sender<Vec<u8>>>,
    #[cfg(test)]
    fault: bool,
}

impl<P: Play> Worker<P> {
    /// The session of `world`.
    pub(super) fn new(world: P, vitals: Arc<Vitals>, frames: Writer<P::Slot>) -> Self {
        Self {
            world,
            vitals,
            frames,
            timeline: Timeline::default(),
            good_tick: 0,
            relapses: 0,
            published: Published::default(),
            changed: true,
            restart: None,
            saves: Vec::new(),
            rings: Vec::new(),
            #[cfg(test)]
            fault: false,
        }
    }

    /// Serves `messages` until the session ends. All work is done in `pool`.
    pub(super) fn run(mut self, messages: &Receiver<Message<P>>, pool: &ThreadPool) {
        loop {
            // Who has nothing left to do sleeps until there is news.
            let first = if self.has_work() {
                messages.try_recv().ok()
            } else if let Ok(message) = messages.recv() {
                Some(message)
            } else {
                return;
            };
            for message in first.into_iter().chain(messages.try_iter()) {
                if !self.take(message) {
                    return;
                }
            }
            let batch = catch_unwind(AssertUnwindSafe(|| pool.install(|| self.batch())));
            if batch.is_err() {
                self.recover();
            }
            self.vitals.heartbeat.fetch_add(1, Ordering::Relaxed);
        }
    }

    fn is_behind(&self) -> bool {
        self.timeline.reaches(self.world.ticks() * TICK_US)
    }

    /// True where another batch is due without further news: ticks are left, or a panic came first.
    fn has_work(&self) -> bool {
        self.is_behind() || self.changed || !(self.saves.is_empty() && self.rings.is_empty())
    }

    /// Takes a message; false for the last one.
    fn take(&mut self, message: Message<P>) -> bool {
        match message {
            Message::Input(mut events, commands, table_us) => {
                for event in &mut events {
                    event.contact = event.contact.as_recorded();
                }
                let commands = commands.iter().filter_map(as_recorded).collect();
                self.timeline.take(events, commands, table_us);
            }
            Message::Advance(table_us) => self.timeline.advance(table_us),
            Message::Restart(start) => {
                self.timeline = Timeline::beginning(self.timeline.table_us());
                self.restart = Some(start);
            }
            Message::Save(reply) => self.saves.push(reply),
            Message::Ring(reply) => self.rings.push(reply),
            Message::End => return false,
            #[cfg(test)]
            Message::Fault => self.fault = true,
        }
        true
    }

    /// Plays the ticks that are due (or some of them, where they are many), and shows what has become of the world.
    fn batch(&mut self) {
        if let Some(start) = self.restart.take() {
            self.world.begin(start);
            self.good_tick = self.world.ticks();
            self.changed = true;
        }
        self.timeline.keep_up(self.world.ticks() * TICK_US);
        self.vitals
            .slowed_us
            .store(self.timeline.slowed_us(), Ordering::Relaxed);
        let mut steps = 0;
        while self.is_behind() && steps < MOST_STEPS {
            let tick_us = self.world.ticks() * TICK_US;
            while let Some(frame) = self.timeline.due(tick_us) {
                self.world.feed(frame);
            }
            steps += self.world.tick();
            self.changed = true;
        }
        self.published.steps += u64::from(steps);
        #[cfg(test)]
        assert!(!std::mem::take(&mut self.fault), "injected");
        if self.changed {
            self.publish();
        }
        if self.world.ticks() >= self.good_tick + CHECKPOINT_TICKS {
            self.world.remember();
            self.good_tick = self.world.ticks();
            self.relapses = 0;
        }
        // Whoever asked may have gone meanwhile.
        for reply in self.saves.drain(..) {
            let _ = reply.send(self.world.kept());
        }
        for reply in self.rings.drain(..) {
            if let Ok(bytes) = self.world.ring().write(Vec::new()) {
                let _ = reply.send(bytes);
            }
        }
    }

    /// Draws the session as it is and hands the frame over.
    pub(super) fn publish(&mut self) {
        self.published.sequence += 1;
        self.world.draw(self.frames.back(), self.published);
        self.frames.publish();
        self.changed = false;
    }

    fn recover(&mut self) {
        self.published.panics += 1;
        self.world.recover(self.relapses);
        self.relapses += 1;
        self.good_tick = self.world.ticks();
        self.changed = true;
    }
}

/// The command as a gesture file gives it back; none where a file could not hold it.
fn as_recorded(command: &Command) -> Option<Command> {
    let mut json = String::new();
    command.write_json(&mut json);
    let parsed = command::parse(&serde_json::from_str(&json).ok()?).ok()?;
    parsed.commands.into_iter().next()
}
