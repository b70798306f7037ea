//! What commands say: results to standard output, everything else to standard error.

use std::io::{IsTerminal, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// The voice of a command.
#[derive(Clone, Copy, Debug)]
pub(super) struct Console {
    quiet: bool,
}

impl Console {
    pub(super) fn new(quiet: bool) -> Self {
        Self { quiet }
    }

    /// A result, for people and pipes. A closed pipe is no fault of ours.
    pub(super) fn result(line: &str) {
        let _ = writeln!(std::io::stdout(), "{line}");
    }

    /// A remark; nothing when quiet.
    pub(super) fn note(self, line: &str) {
        if !self.quiet {
            let _ = writeln!(std::io::stderr(), "{line}");
        }
    }

    /// Something that did not stop the command but should be known.
    pub(super) fn warn(line: &str) {
        let _ = writeln!(std::io::stderr(), "warning: {line}");
    }

    /// Why the command stopped.
    pub(super) fn error(line: &str) {
        let _ = writeln!(std::io::stderr(), "orogen: {line}");
    }

    /// A progress bar of `total` steps when standard error is a terminal and the command is not quiet; otherwise
    /// nothing is drawn.
    pub(super) fn progress(self, total: u64, label: &str) -> ProgressBar {
        if self.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let style = ProgressStyle::with_template("{msg:28} {bar:40} {pos:>4}/{len} {elapsed} (left: {eta})");
        let bar = ProgressBar::new(total);
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.set_message(label.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }
}
