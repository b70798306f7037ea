//! Window, event loop, threads and metrics.
