//! Which tool wrote a recording: its first telling line says so.

use super::ImportFault;

/// Characters of an unknown file that an error shows.
const SHOWN_CHARS: usize = 40;

/// A tool whose recordings are understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recorder {
    /// `evemu-record`.
    Evemu,
    /// `libinput record`.
    Libinput,
    /// A capture of TUIO.
    Tuio,
}

impl Recorder {
    /// All of them, in words.
    pub(super) const UNDERSTOOD: &str = "a recording of evemu-record (N:, A:, E: lines), libinput record (YAML with version: and devices:) or a capture \
         of TUIO (JSON with hex)";

    /// The tool whose recording begins with `head`.
    ///
    /// # Errors
    /// None of those that are understood.
    pub fn of(head: &[u8]) -> Result<Self, ImportFault> {
        let text = String::from_utf8_lossy(head);
        let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
        lines().find_map(Self::by_line).ok_or_else(|| {
            let first = lines().next().unwrap_or_default();
            let shown: String = first.chars().take(SHOWN_CHARS).collect();
            ImportFault::NoRecorder {
                found: if shown.is_empty() {
                    "nothing".to_owned()
                } else {
                    format!("{shown:?}")
                },
            }
        })
    }

    /// What one line tells.
    fn by_line(line: &str) -> Option<Self> {
        if line.starts_with('[') || line.starts_with('{') && line.contains("\"hex\"") {
            return Some(Self::Tuio);
        }
        let (key, _) = line.split_once(':')?;
        match key {
            "version" | "ndevices" | "devices" | "libinput" => Some(Self::Libinput),
            "A" | "B" | "L" | "S" | "I" | "E" => Some(Self::Evemu),
            _ => None,
        }
    }
}
