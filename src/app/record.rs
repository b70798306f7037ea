//! The session at the table as a gesture file, written while it goes on.

use std::fs::File;
use std::io;
use std::path::Path;

use crate::gesture::command::{Command, Mode};
use crate::gesture::contact::{ContactEvent, InputFrame, Source};
use crate::gesture::file::{GestureWriter, Header};

/// Writes what people do to one land: the one that lies there when the first of them touches it. Each line is whole: a
/// power cut loses the last one at most.
#[derive(Debug)]
pub(super) struct Recorder(Stage);

#[derive(Debug)]
enum Stage {
    /// Nobody has touched; the header still follows the land.
    Waiting(File, Header),
    Writing {
        writer: GestureWriter<File>,
        mode: Mode,
        began_us: u64,
    },
    /// Another land has begun, or the file cannot be written any more.
    Over,
}

impl Recorder {
    /// Begins a file. One that is there is not touched.
    ///
    /// # Errors
    /// The file is there already, or cannot be written.
    pub(super) fn new(path: &Path, header: Header) -> io::Result<Self> {
        Ok(Self(Stage::Waiting(File::create_new(path)?, header)))
    }

    /// A fresh land has begun from `seed`, of so many nodes if it is the mountain's. Before the first touch the recording is
    /// of that; after it, it is over.
    pub(super) fn fresh(&mut self, seed: u64, nodes: usize) {
        match &mut self.0 {
            Stage::Waiting(_, header) => {
                header.seed = Some(seed);
                if header.mode == Mode::Mountain {
                    header.nodes = Some(nodes as u64);
                }
            }
            Stage::Writing { .. } => {
                tracing::info!("the recording is over: a fresh land begins");
                self.0 = Stage::Over;
            }
            Stage::Over => {}
        }
    }

    /// Takes what goes to the world `mode`. The show's hands are not recorded.
    pub(super) fn take(&mut self, mode: Mode, events: &[ContactEvent], commands: &[Command], now_us: u64) {
        let people = events
            .iter()
            .filter(|event| event.contact.key.source != Source::File);
        let frame = InputFrame {
            t_us: now_us,
            events: people.map(as_recorded).collect(),
            commands: commands.to_vec(),
        };
        if !frame.events.is_empty() || !frame.commands.is_empty() {
            self.write(mode, frame).unwrap_or_else(|error| {
                tracing::error!("the recording ends here: {error}");
                self.0 = Stage::Over;
            });
        }
    }

    fn write(&mut self, mode: Mode, mut frame: InputFrame) -> io::Result<()> {
        if let Stage::Waiting(file, header) = &self.0 {
            // Tools that are laid down while nobody is there belong to no session.
            if frame.events.is_empty() || header.mode != mode {
                return Ok(());
            }
            self.0 = Stage::Writing {
                writer: GestureWriter::new(file.try_clone()?, header)?,
                mode,
                began_us: frame.t_us,
            };
        }
        match &mut self.0 {
            Stage::Writing {
                writer,
                mode: own,
                began_us,
            } if *own == mode => {
                frame.t_us = frame.t_us.saturating_sub(*began_us);
                writer.write_frame(&frame)?;
                writer.flush()
            }
            _ => Ok(()),
        }
    }
}

fn as_recorded(event: &ContactEvent) -> ContactEvent {
    ContactEvent {
        phase: event.phase,
        contact: event.contact.as_recorded(),
    }
}
