//! Why a recording is refused.

use std::io;

use super::detect::Recorder;
use super::lines::{MAX_LINE_BYTES, MAX_LINES};
use crate::gesture::contact::MAX_COORDINATE_MM;
use crate::gesture::file::MAX_TIME_MS;
use crate::gesture::json::Expected;

/// Why a recording was refused.
#[derive(Debug, thiserror::Error)]
#[error("{name}:{line}: {fault}")]
pub struct ImportError {
    /// The recording, as the caller named it.
    pub name: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong there.
    #[source]
    pub fault: ImportFault,
}

/// What is wrong with a recording.
#[derive(Debug, thiserror::Error)]
pub enum ImportFault {
    /// No tool that is understood wrote this.
    #[error("expected {}, found {found}", Recorder::UNDERSTOOD)]
    NoRecorder {
        /// The first line that says anything, cut to a few characters.
        found: String,
    },
    /// A field does not hold what it should.
    #[error(transparent)]
    Expected(#[from] Expected),
    /// The recording is not built as it should be.
    #[error("expected {0}, found something else")]
    Form(String),
    /// No device of the recording is a touchscreen.
    #[error("expected a touchscreen among the devices, found {found}")]
    NoTouchscreen {
        /// The devices, as far as they fit.
        found: String,
    },
    /// The recording cannot be read on.
    #[error("expected to read on: {0}")]
    Io(#[from] io::Error),
    /// A line is longer than [`MAX_LINE_BYTES`].
    #[error("expected at most {MAX_LINE_BYTES} bytes in a line, found more")]
    LongLine,
    /// The recording has more than [`MAX_LINES`].
    #[error("expected at most {MAX_LINES} lines, found more")]
    ManyLines,
    /// Time runs backwards.
    #[error("time: expected at least {before_s:.6} s as in the event before, found {found_s:.6}")]
    Backwards {
        /// Time of the event before, s.
        before_s: f64,
        /// Time of this event, s.
        found_s: f64,
    },
    /// Longer than a gesture file may be.
    #[error("time: expected at most {} days after the first event, found more", MAX_TIME_MS / 86_400_000.0)]
    LongTime,
    /// Slots and packets in one recording.
    #[error(
        "expected one multi-touch protocol, found SYN_MT_REPORT of protocol A beside ABS_MT_SLOT of protocol B"
    )]
    BothProtocols,
    /// No positions of several fingers.
    #[error("expected multi-touch events (ABS_MT_POSITION_X, ABS_MT_POSITION_Y), found {found}")]
    NoMultiTouch {
        /// What there is instead.
        found: &'static str,
    },
    /// Nothing says what the device units mean.
    #[error("expected a range of ABS_MT_POSITION_X and _Y, found none: give --range X0,X1,Y0,Y1")]
    NoRange,
    /// Nothing says how large the surface is.
    #[error("expected a resolution of the positions (units per mm), found none: give --size-mm W,H")]
    NoSize,
    /// A position that is on no table.
    #[error(
        "position: expected at most {MAX_COORDINATE_MM} mm from the corner, found {found_mm:.0}: check --range"
    )]
    Far {
        /// The greater coordinate, mm.
        found_mm: f64,
    },
}

impl ImportFault {
    /// The fault with its place; an empty recording is wrong in its first line.
    pub(super) fn at(self, name: &str, line: usize) -> ImportError {
        ImportError {
            name: name.to_owned(),
            line: line.max(1),
            fault: self,
        }
    }
}
