//! Recordings of other tools → contacts: one vocabulary for all of them.
//!
//! | tool | module | what it holds |
//! |---|---|---|
//! | `evemu-record` | [`evemu`] | the kernel's events, protocols A and B |
//! | `hid-recorder` | [`hid_recorder`] | the bytes that devices sent |
//! | `libinput record` | [`libinput`] | the same, in YAML, of several devices |
//! | captures of TUIO | [`tuio`] | the packets that trackers sent |
//!
//! [`import_recording`] finds out which tool wrote a recording; nothing else does, names of files least of all. Every
//! importer takes any bytes, and refuses what it does not understand in one line that names file and line.

mod detect;
mod devices;
mod evdev;
pub mod evemu;
mod fault;
pub mod hid_recorder;
pub mod libinput;
mod lines;
mod time;
pub mod tuio;

use std::io::Read;

use glam::DVec2;
use serde_json::Value;

use crate::gesture::contact::InputFrame;
use crate::gesture::file::MAX_SIZE_MM;
use crate::gesture::json::Expected;
pub use detect::Recorder;
pub use evemu::import_evemu;
pub use fault::{ImportError, ImportFault};
pub use hid_recorder::import_hid_recorder;
pub use libinput::import_libinput;
pub use lines::{MAX_LINE_BYTES, MAX_LINES};
pub use tuio::import_tuio;

/// Bytes from which it is told which tool wrote a recording: the longest description of a device fits twice.
const HEAD_BYTES: u64 = 64 * 1024;

/// Characters of a device's name that the title keeps.
const TITLE_CHARS: usize = 120;

/// What a recording may fail to say about itself, or say wrongly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Device units at the left, right, upper and lower edge (`x0, x1, y0, y1`).
    pub range: Option<[f64; 4]>,
    /// Size of the touching surface, mm.
    pub size_mm: Option<DVec2>,
}

impl ImportOptions {
    /// The size that is given, if it is one.
    fn size(&self) -> Result<Option<DVec2>, ImportFault> {
        if self.size_mm.is_none_or(is_size) {
            return Ok(self.size_mm);
        }
        let what = format!("W,H in mm, both above 0 and below {MAX_SIZE_MM}");
        let found = Value::from(self.size_mm.map(|size| size.to_array().to_vec()));
        Err(Expected::new("--size-mm", what, &found).into())
    }
}

/// True for the size of a table, mm.
fn is_size(size: DVec2) -> bool {
    size.cmpgt(DVec2::ZERO).all() && size.cmplt(DVec2::splat(MAX_SIZE_MM)).all()
}

/// A recording, as a gesture file would hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The device's name, or else the recording's.
    pub title: String,
    /// Size of the table, mm.
    pub size_mm: DVec2,
    /// The moments in which contacts change, the first at 0, each in canonical order (phase, then id).
    pub frames: Vec<InputFrame>,
    /// What was let pass, one sentence each.
    pub warnings: Vec<String>,
}

/// Reads a recording of any tool that is understood; `name` stands for it in errors, and in the title where the
/// device has no name. `options` win over what the recording says about itself.
///
/// # Errors
/// A recording of no known tool, or what that tool's importer says, by line.
pub fn import_recording<R: Read>(
    mut source: R,
    name: &str,
    options: &ImportOptions,
) -> Result<Imported, ImportError> {
    let mut head = Vec::new();
    let recorder = (&mut source)
        .take(HEAD_BYTES)
        .read_to_end(&mut head)
        .map_err(ImportFault::from)
        .and_then(|_| Recorder::of(&head))
        .map_err(|fault| fault.at(name, 1))?;
    let whole = head.chain(source);
    match recorder {
        Recorder::Evemu => import_evemu(whole, name, options),
        Recorder::HidRecorder => import_hid_recorder(whole, name, options),
        Recorder::Libinput => import_libinput(whole, name, options),
        Recorder::Tuio => import_tuio(whole, name, options),
    }
}

/// The title of a recording: the device's name if it has one.
fn title(device: Option<&str>, name: &str) -> String {
    device.unwrap_or(name).chars().take(TITLE_CHARS).collect()
}
