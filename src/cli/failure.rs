//! How a command ends when it cannot do what it was asked.

use std::process::ExitCode;

/// Why a command stopped. Each prints as one line and has an exit code of its own.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    /// Bad usage or bad input: the line names the file, line or field and what was expected. Exit code 2.
    #[error("{0}")]
    Input(String),
    /// No display or no usable graphics where one is required; the line says what to do. Exit code 3.
    #[cfg(feature = "app")]
    #[error("{0}")]
    NoDisplay(String),
    /// Anything else. Exit code 1.
    #[error("{0}")]
    Other(String),
}

impl Failure {
    /// A failure of the input, from any error that says what was expected.
    pub(super) fn input(error: impl std::fmt::Display) -> Self {
        Self::Input(one_line(&error.to_string()))
    }

    /// No display or no graphics, and what to do.
    #[cfg(feature = "app")]
    pub(super) fn no_display(error: impl std::fmt::Display) -> Self {
        Self::NoDisplay(one_line(&error.to_string()))
    }

    /// Any other failure.
    pub(super) fn other(error: impl std::fmt::Display) -> Self {
        Self::Other(one_line(&error.to_string()))
    }

    /// The exit code.
    pub(super) fn code(&self) -> ExitCode {
        match self {
            Self::Input(_) => ExitCode::from(2),
            #[cfg(feature = "app")]
            Self::NoDisplay(_) => ExitCode::from(3),
            Self::Other(_) => ExitCode::FAILURE,
        }
    }
}

/// Other people's messages may have several lines; ours have one.
fn one_line(message: &str) -> String {
    message
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .collect::<Vec<_>>()
        .join("; ")
}
