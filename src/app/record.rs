//! The session at the table as a gesture file, written while it goes on.

use std::fs::File;
use std::io;
use std::path::Path;

use glam::DVec2;

use crate::gesture::command::{Command, Mode};
use crate::gesture::contact::{ContactEvent, InputFrame};
use crate::gesture::file::{GestureWriter, Header};

/// Writes what goes to the world that was shown first. Each line is whole: a power cut loses the last one at most.
#[derive(Debug)]
pub(super) struct Recorder {
    /// `None` after the file could not be written any more.
    writer: Option<GestureWriter<File>>,
    mode: Mode,
    began_us: Option<u64>,
}

impl Recorder {
    /// Begins a file for a table of `size_mm` with `seed` and `nodes`. A file that is there is not touched.
    ///
    /// # Errors
    /// The file is there already, or cannot be written.
    pub(super) fn new(path: &Path, size_mm: DVec2, mode: Mode, seed: u64, nodes: usize) -> io::Result<Self> {
        let header = Header {
            title: Some("a session at the table".to_owned()),
            mode,
            seed: Some(seed),
            nodes: Some(nodes as u64),
            ..Header::new(size_mm)
        };
        let writer = GestureWriter::new(File::create_new(path)?, &header)?;
        Ok(Self {
            writer: Some(writer),
            mode,
            began_us: None,
        })
    }

    /// Takes what goes to the world `mode`.
    pub(super) fn take(&mut self, mode: Mode, events: &[ContactEvent], commands: &[Command], now_us: u64) {
        let Some(writer) = self.writer.as_mut().filter(|_| mode == self.mode) else {
            return;
        };
        let began_us = *self.began_us.get_or_insert(now_us);
        let frame = InputFrame {
            t_us: now_us.saturating_sub(began_us),
            events: events.iter().map(as_recorded).collect(),
            commands: commands.to_vec(),
        };
        if let Err(error) = writer.write_frame(&frame).and_then(|()| writer.flush()) {
            tracing::error!("the recording ends here: {error}");
            self.writer = None;
        }
    }
}

fn as_recorded(event: &ContactEvent) -> ContactEvent {
    ContactEvent {
        phase: event.phase,
        contact: event.contact.as_recorded(),
    }
}
