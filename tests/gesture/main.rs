//! From contacts to strokes and rigid motions, the gesture file, and the committed recordings.

mod corpus;
mod corpus_files;
mod corpus_globe;
mod file;
mod file_writer;
mod gesture_support;
mod grammar;
mod pole;
mod properties;
mod rigid;
mod strokes;
