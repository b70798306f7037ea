//! The last minute of contacts, always at hand: what staff save when something odd has happened.

use std::collections::VecDeque;
use std::io::{self, Write};

use crate::gesture::admission::Admission;
use crate::gesture::command::{Action, Command};
use crate::gesture::contact::{ContactEvent, InputFrame, Phase};
use crate::gesture::file::{GestureWriter, Header};
use crate::sim::TICK_US;

/// How far back the ring reaches, µs. A whole number of ticks, so that what is written plays in step.
pub const RING_US: u64 = 3_750 * TICK_US;

/// Most memory that it keeps, bytes: ten hands at 200 moments a second take half of it.
pub const RING_BYTES: usize = 32 << 20;

/// Keeps the last 60 s of input, as the session was fed with it, and writes it as a gesture file.
///
/// The land before is not in the file. Contacts that were down when it begins go down where they were, and a clock that
/// was stopped or set is stopped or set.
#[derive(Clone, Debug)]
pub struct Ring {
    header: Header,
    frames: VecDeque<InputFrame>,
    bytes: usize,
    /// Session time at which the ring begins, µs.
    begins_us: u64,
    /// The contacts that were down then.
    before: Admission,
    /// How the clock was then, where it was not as a new session has it.
    speed: Option<f64>,
    paused: bool,
    /// What laid the rock that was under the land then.
    layers: Option<Action>,
    /// What made the cross-sections that were there then.
    cuts: Vec<Command>,
}

impl Ring {
    /// An empty ring for a session that begins with the land of `header`. Its clock runs at `speed` My per second, if
    /// that is not what a replay takes by itself.
    pub fn new(header: Header, speed: Option<f64>) -> Self {
        Self {
            header,
            frames: VecDeque::new(),
            bytes: 0,
            begins_us: 0,
            before: Admission::default(),
            speed,
            paused: false,
            layers: None,
            cuts: Vec::new(),
        }
    }

    /// Keeps a frame of input that plays now. Times must not decrease.
    pub fn record(&mut self, frame: &InputFrame) {
        self.bytes += bytes_of(frame);
        self.frames.push_back(frame.clone());
        let oldest_us = frame.t_us.saturating_sub(RING_US);
        while let Some(first) = self
            .frames
            .pop_front_if(|first| first.t_us < oldest_us || self.bytes > RING_BYTES)
        {
            self.forget(&first);
        }
    }

    /// Every contact that is down is withdrawn at `t_us`.
    pub fn cancel_contacts(&mut self, t_us: u64) {
        let mut gate = self.before.clone();
        for frame in &self.frames {
            gate.admit(&frame.events);
        }
        let events: Vec<ContactEvent> = gate
            .live()
            .map(|&contact| ContactEvent {
                phase: Phase::Cancel,
                contact,
            })
            .collect();
        self.record(&InputFrame {
            t_us,
            events,
            commands: Vec::new(),
        });
    }

    /// Memory in use, bytes, but for what a frame takes by itself.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Writes what is kept as a gesture file in its canonical form.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn write<W: Write>(&self, sink: W) -> io::Result<W> {
        let mut writer = GestureWriter::new(sink, &self.header)?;
        let first = self.first_frame();
        if !(first.events.is_empty() && first.commands.is_empty()) {
            writer.write_frame(&first)?;
        }
        for frame in &self.frames {
            writer.write_frame(&InputFrame {
                t_us: frame.t_us.saturating_sub(self.begins_us),
                ..frame.clone()
            })?;
        }
        writer.into_inner()
    }

    /// What the session was when the ring begins.
    fn first_frame(&self) -> InputFrame {
        let down = |&contact: &_| ContactEvent {
            phase: Phase::Down,
            contact,
        };
        let speed = self.speed.map(Action::Speed);
        let paused = self.paused.then_some(Action::Pause);
        InputFrame {
            t_us: 0,
            events: self.before.live().map(down).collect(),
            commands: speed
                .into_iter()
                .chain(paused)
                .chain(self.layers.clone())
                .map(Command::new)
                .chain(self.cuts.iter().cloned())
                .collect(),
        }
    }

    /// A frame leaves at the old end: what it did is from now on how things were.
    fn forget(&mut self, frame: &InputFrame) {
        self.bytes -= bytes_of(frame);
        // In whole ticks, so that the frames that are left keep their place between two ticks.
        self.begins_us = frame.t_us / TICK_US * TICK_US;
        self.before.admit(&frame.events);
        for command in &frame.commands {
            match &command.action {
                Action::Speed(speed) => self.speed = Some(*speed),
                Action::Layers(_) | Action::Pile(_) => self.layers = Some(command.action.clone()),
                Action::Slice(_) | Action::FreezeSlice(_) => {
                    // The last of each kind and side counts; notes stay behind the ends they belong to.
                    let same = |kept: &&mut Command| {
                        kept.side == command.side && kept.action.word() == command.action.word()
                    };
                    match self.cuts.iter_mut().find(same) {
                        Some(kept) => kept.clone_from(command),
                        None => self.cuts.push(command.clone()),
                    }
                }
                Action::LabelSlice { .. } => self.cuts.push(command.clone()),
                Action::CloseSlice => self.cuts.retain(|kept| kept.side != command.side),
                Action::Play => self.paused = false,
                Action::Pause | Action::Scrub(_) => self.paused = true,
                _ => {}
            }
        }
    }
}

/// Memory that a frame needs on the heap and in the queue.
fn bytes_of(frame: &InputFrame) -> usize {
    size_of::<InputFrame>() + size_of_val(frame.events.as_slice()) + size_of_val(frame.commands.as_slice())
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::gesture::contact::{Contact, ContactKey, Source};
    use crate::gesture::file::{GestureFile, read_gesture};

    const SIZE_MM: DVec2 = DVec2::new(1200.0, 700.0);

    fn event(phase: Phase, id: u64, x: f64) -> ContactEvent {
        ContactEvent {
            phase,
            contact: Contact {
                key: ContactKey {
                    source: Source::Window,
                    device: 0,
                    id,
                    generation: 3,
                },
                position: DVec2::new(x, 50.0),
                size_mm: None,
                confidence: None,
            },
        }
    }

    fn frame(t_us: u64, events: Vec<ContactEvent>, commands: Vec<Action>) -> InputFrame {
        InputFrame {
            t_us,
            events,
            commands: commands.into_iter().map(Command::new).collect(),
        }
    }

    fn ring() -> Ring {
        let header = Header {
            seed: Some(5),
            nodes: Some(900),
            ..Header::new(SIZE_MM)
        };
        Ring::new(header, None)
    }

    fn reread(ring: &Ring) -> GestureFile {
        let bytes = ring.write(Vec::new()).unwrap();
        let file = read_gesture(bytes.as_slice(), "ring").unwrap();
        if file.warnings.is_empty() {
            assert_eq!(file.write(Vec::new()).unwrap(), bytes, "canonical");
        }
        file
    }

    #[test]
    fn a_young_ring_is_the_whole_session() {
        let mut ring = ring();
        let frames = [
            frame(16_001, vec![event(Phase::Down, 4, 10.0)], vec![]),
            frame(20_000, vec![event(Phase::Move, 4, 20.0)], vec![Action::Pause]),
            frame(30_000, vec![event(Phase::Up, 4, 20.0)], vec![]),
        ];
        for frame in &frames {
            ring.record(frame);
        }
        let file = reread(&ring);
        assert_eq!((file.header.seed, file.header.nodes), (Some(5), Some(900)));
        let times: Vec<u64> = file.frames.iter().map(|frame| frame.t_us).collect();
        assert_eq!(times, [16_001, 20_000, 30_000]);
        assert_eq!(file.frames[1].commands, frames[1].commands);
        assert!(file.warnings.is_empty());
    }

    #[test]
    fn an_old_ring_begins_with_what_was_down_and_how_the_clock_was() {
        let mut ring = ring();
        ring.record(&frame(1000, vec![event(Phase::Down, 1, 10.0)], vec![]));
        ring.record(&frame(
            2000,
            vec![event(Phase::Down, 2, 99.0)],
            vec![Action::Speed(2.0)],
        ));
        ring.record(&frame(
            3000,
            vec![event(Phase::Move, 1, 30.0), event(Phase::Up, 2, 99.0)],
            vec![Action::Pause],
        ));
        let later = RING_US + 1_000_000;
        ring.record(&frame(later, vec![event(Phase::Move, 1, 40.0)], vec![]));
        let file = reread(&ring);
        assert_eq!(file.frames.len(), 3, "the end of the file lifts the finger");
        let [first, second] = [&file.frames[0], &file.frames[1]];
        assert_eq!((first.t_us, first.events.len()), (0, 1));
        assert_eq!(first.events[0].phase, Phase::Down);
        assert_eq!(first.events[0].contact.position.x, 30.0, "where it was last");
        let actions: Vec<&Action> = first.commands.iter().map(|c| &c.action).collect();
        assert_eq!(actions, [&Action::Speed(2.0), &Action::Pause]);
        assert_eq!(second.t_us % TICK_US, later % TICK_US, "in step with the ticks");
        assert_eq!(second.events[0].phase, Phase::Move);
    }

    #[test]
    fn memory_and_time_are_bounded() {
        let mut ring = ring();
        for i in 0..2_000_u64 {
            let moves = (0..256).map(|id| event(Phase::Move, id, i as f64)).collect();
            ring.record(&frame(i * 1000, moves, vec![]));
        }
        assert!(ring.bytes() <= RING_BYTES);
        assert!(ring.frames.len() > 500);
        ring.record(&frame(10 * RING_US, vec![], vec![]));
        assert_eq!(ring.frames.len(), 1);
        assert_eq!(ring.bytes(), bytes_of(&ring.frames[0]));
    }

    #[test]
    fn withdrawn_contacts_are_withdrawn_in_the_file() {
        let mut ring = ring();
        ring.record(&frame(0, vec![event(Phase::Down, 1, 10.0)], vec![]));
        ring.cancel_contacts(500);
        let file = reread(&ring);
        assert_eq!(file.frames[1].events[0].phase, Phase::Cancel);
        assert!(file.warnings.is_empty(), "nothing is left down");
    }
}
