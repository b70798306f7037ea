//! Writes the gesture files and their table: `cargo run --example make_gestures [DIR]` (default `gestures`).
//!
//! The files are composed, not recorded, so that each shows one matter and nothing else, and so that they can be
//! composed anew when the format or the matter changes. No clock and no machine gets into them: equal sources give
//! equal bytes, and `tests/gesture/corpus_files.rs` holds the files in `gestures/` to that.

mod corpus;

use std::path::PathBuf;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let dir = env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("gestures"), PathBuf::from);
    fs::create_dir_all(&dir)?;
    for (name, bytes) in corpus::files()? {
        fs::write(dir.join(name), bytes)?;
    }
    Ok(())
}
