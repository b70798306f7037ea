//! Which tool wrote a recording: its first telling line says so.

use super::ImportFault;

/// Characters of an unknown file that an error shows.
const SHOWN_CHARS: usize = 40;

/// A tool whose recordings are understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recorder {
    /// `evemu-record`.
    Evemu,
    /// `hid-recorder`.
    HidRecorder,
    /// `libinput record`.
    Libinput,
    /// A capture of TUIO.
    Tuio,
}

impl Recorder {
    /// All of them, in words.
    pub(super) const UNDERSTOOD: &str = "a recording of evemu-record (N:, A:, E: lines), libinput record (YAML with \
        version: and devices:) or hid-recorder (R:, E: lines), or a capture of TUIO (JSON with hex)";

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
        let (key, rest) = line.split_once(':')?;
        let words: Vec<&str> = rest.split_whitespace().collect();
        match (key, &words[..]) {
            ("version" | "ndevices" | "devices" | "libinput", _) => Some(Self::Libinput),
            // (Bus, vendor and product; evemu adds the version.)
            ("D" | "R", _) | ("I", [_, _, _]) => Some(Self::HidRecorder),
            // A time and a length, where evemu has a type of four digits.
            ("E", [_, length, ..]) if length.len() != 4 => Some(Self::HidRecorder),
            ("A" | "B" | "L" | "S" | "I" | "E", _) => Some(Self::Evemu),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_telling_line_counts() {
        let of = |text: &str| Recorder::of(text.as_bytes()).ok();
        assert_eq!(
            of("# EVEMU 1.3\nN: I: am\nI: 0003 056a 005d 0005\n"),
            Some(Recorder::Evemu)
        );
        assert_eq!(of("E: 0.000001 0003 0035 5\n"), Some(Recorder::Evemu));
        assert_eq!(of("# Table\nD: 0\nR: 1 05\n"), Some(Recorder::HidRecorder));
        assert_eq!(
            of("N: Table\nP: usb\nI: 3 056a 005d\n"),
            Some(Recorder::HidRecorder)
        );
        assert_eq!(of("E: 000000.000000 2 01 02\n"), Some(Recorder::HidRecorder));
        assert_eq!(
            of("\u{feff}# libinput record\n---\nversion: 1\n"),
            Some(Recorder::Libinput)
        );
        assert_eq!(of("hello: world\n"), None);
    }
}
