//! The one settings file.
