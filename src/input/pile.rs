//! Piles of rock by name, or from files.

use std::path::Path;
use std::sync::Arc;

use crate::rock::{Stratigraphy, StratigraphyError, preset};

/// Why there is no such pile.
#[derive(Debug, thiserror::Error)]
pub enum PileError {
    /// Neither a preset nor a file.
    #[error("layers {name:?}: expected a preset ({presets}) or a TOML file: {error}")]
    Missing {
        /// What was asked for.
        name: String,
        /// The presets there are.
        presets: String,
        /// Why it could not be read as a file.
        error: std::io::Error,
    },
    /// The file holds no pile.
    #[error(transparent)]
    Wrong(#[from] StratigraphyError),
}

/// The preset called `name`, or the pile in the file `name`, below `folder` unless the path is absolute.
///
/// # Errors
/// Where neither is there, or the file holds no pile.
pub fn named_pile(name: &str, folder: &Path) -> Result<Arc<Stratigraphy>, PileError> {
    preset::by_name(name).map_or_else(|| read_pile(&folder.join(name)).map(Arc::new), Ok)
}

/// The pile in a TOML file.
///
/// # Errors
/// Where the file cannot be read, or holds no pile.
pub fn read_pile(path: &Path) -> Result<Stratigraphy, PileError> {
    let name = path.display().to_string();
    match std::fs::read(path) {
        Ok(bytes) => Ok(Stratigraphy::parse(&bytes, &name)?),
        Err(error) => Err(PileError::Missing {
            name,
            presets: preset::names().join(", "),
            error,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_come_before_files_and_what_is_neither_says_so() {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/strata");
        assert_eq!(named_pile("jura", Path::new("nowhere")).unwrap().name(), "jura");
        assert_eq!(named_pile("zagros.toml", &assets).unwrap().name(), "zagros");
        let error = named_pile("jurra", &assets).unwrap_err().to_string();
        assert!(
            error.contains("jurra") && error.contains("southern_alps"),
            "{error}"
        );
        assert!(!error.contains('\n'));
    }
}
