//! A folder for results: files appear in it whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// Why a result could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The folder itself is the trouble.
    #[error("cannot write into the folder {}: {source}", folder.display())]
    Folder {
        /// The folder as it was given.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// One file could not be completed; what stood there before is untouched.
    #[error("cannot write {}: {source}", file.display())]
    File {
        /// The file that was to be written.
        file: PathBuf,
        /// What the system or the encoder said.
        source: io::Error,
    },
}

/// A folder that has been shown to be writable.
#[derive(Clone, Debug)]
pub struct OutDir {
    path: PathBuf,
}

impl OutDir {
    /// Makes the folder, and those above it, where missing, and tries that it can be written.
    ///
    /// # Errors
    /// [`ExportError::Folder`] names the folder where that fails.
    pub fn create(path: impl Into<PathBuf>) -> Result<Self, ExportError> {
        let path = path.into();
        let tried = std::fs::create_dir_all(&path).and_then(|()| temporary_in(&path).map(drop));
        match tried {
            Ok(()) => Ok(Self { path }),
            Err(source) => Err(ExportError::Folder { folder: path, source }),
        }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file `name` by `encode`: into a temporary file beside it, flushed to the disk, then renamed over
    /// what may stand there. Returns its path.
    ///
    /// # Errors
    /// [`ExportError::File`] names the file; the temporary one is removed, an older file of that name stays.
    pub fn write(
        &self,
        name: &str,
        encode: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<PathBuf, ExportError> {
        let file = self.path.join(name);
        match self.write_beside(&file, encode) {
            Ok(()) => Ok(file),
            Err(source) => Err(ExportError::File { file, source }),
        }
    }

    fn write_beside(
        &self,
        file: &Path,
        encode: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> io::Result<()> {
        let temporary = temporary_in(&self.path)?;
        let (handle, temporary) = temporary.into_parts();
        let mut out = BufWriter::new(handle);
        encode(&mut out)?;
        out.flush()?;
        out.get_ref().sync_all()?;
        temporary.persist(file).map_err(|refused| refused.error)
    }
}

/// A temporary file in `folder`, readable as any other file of the user once it is renamed (the crate's own default
/// is for the owner alone).
fn temporary_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".orogen-").suffix(".part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}
