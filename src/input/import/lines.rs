//! A recording as lines, none of them longer than it may be.

use std::borrow::Cow;
use std::io::{BufRead, BufReader, Read};

use super::ImportFault;

/// Most bytes of a line: the longest packet of TUIO, 64 KiB, takes two for each of them, and some more to say when.
pub const MAX_LINE_BYTES: usize = 160 * 1024;

/// Most lines of a recording: an hour and a half of ten fingers.
pub const MAX_LINES: usize = 4_000_000;

/// One line of a recording.
pub(super) struct Line<'a> {
    /// What it says. Names of devices and comments may be in any encoding; numbers are ASCII.
    pub(super) text: Cow<'a, str>,
    /// True if it has no end: a recorder that was killed leaves half a line.
    pub(super) torn: bool,
}

/// Reads line by line.
pub(super) struct Lines<R> {
    source: BufReader<R>,
    bytes: Vec<u8>,
    /// Lines read so far.
    pub(super) count: usize,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(source: R) -> Self {
        Self {
            source: BufReader::new(source),
            bytes: Vec::new(),
            count: 0,
        }
    }

    /// The next line, if there is one.
    pub(super) fn next(&mut self) -> Result<Option<Line<'_>>, ImportFault> {
        self.bytes.clear();
        let within = &mut (&mut self.source).take(MAX_LINE_BYTES as u64 + 1);
        let read = within.read_until(b'\n', &mut self.bytes)?;
        if read == 0 {
            return Ok(None);
        }
        self.count += 1;
        if self.count > MAX_LINES {
            return Err(ImportFault::ManyLines);
        }
        if read > MAX_LINE_BYTES {
            return Err(ImportFault::LongLine);
        }
        Ok(Some(Line {
            torn: self.bytes.last() != Some(&b'\n'),
            text: String::from_utf8_lossy(&self.bytes),
        }))
    }
}
