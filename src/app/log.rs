//! The log: one file a day, the oldest go.

use std::path::Path;

use tracing_appender::non_blocking::{NonBlocking, WorkerGuard};
use tracing_appender::rolling::{RollingFileAppender, Rotation};
use tracing_subscriber::EnvFilter;

/// Days of which a log is kept.
const DAYS: usize = 14;
/// What is logged where `OROGEN_LOG` does not say.
const FILTER: &str = "warn,orogen=info";

/// Logs into `folder`, or to the terminal where there is none. A log that cannot be opened is no reason to stop a
/// table: then it goes to the terminal too. What waits is written out when the guard is dropped.
pub(super) fn start(folder: Option<&Path>) -> Option<WorkerGuard> {
    let opened = folder.map(|folder| {
        RollingFileAppender::builder()
            .rotation(Rotation::DAILY)
            .filename_prefix("orogen")
            .filename_suffix("log")
            .max_log_files(DAYS)
            .build(folder)
    });
    let (writer, guard, fault) = match opened {
        Some(Ok(file)) => {
            let (writer, guard) = tracing_appender::non_blocking(file);
            (Some(writer), Some(guard), None)
        }
        Some(Err(error)) => (None, None, Some(error)),
        None => (None, None, None),
    };
    subscribe(writer);
    if let Some(error) = fault {
        tracing::warn!("no log file: {error}");
    }
    guard
}

/// A second subscriber in one process is refused and the first goes on, which is what a second window wants.
fn subscribe(writer: Option<NonBlocking>) {
    let filter = EnvFilter::try_from_env("OROGEN_LOG").unwrap_or_else(|_| EnvFilter::new(FILTER));
    let builder = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_target(false);
    let set = match writer {
        Some(writer) => builder.with_ansi(false).with_writer(writer).try_init(),
        None => builder.with_writer(std::io::stderr).try_init(),
    };
    drop(set);
}
