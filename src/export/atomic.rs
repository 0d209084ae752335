//! Files that are whole or absent: written beside their place, renamed when complete.

use super::Error;
use crate::file::Partial;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that appears under its name only when [`AtomicFile::finish`] is called; dropped before, it leaves nothing.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    writer: BufWriter<Partial>,
}

impl AtomicFile {
    /// Opens a temporary neighbour of `path`.
    ///
    /// # Errors
    /// [`Error::Write`] when the folder does not exist or cannot be written, or `path` is no file.
    pub fn create(path: &Path) -> Result<Self, Error> {
        let partial = Partial::create(path).map_err(wrong(path))?;
        Ok(Self { path: path.to_owned(), writer: BufWriter::with_capacity(1 << 18, partial) })
    }

    /// The file's final name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes everything out and renames the neighbour to its final name, replacing what was there.
    ///
    /// # Errors
    /// [`Error::Write`]; the final name is then as it was before.
    pub fn finish(self) -> Result<(), Error> {
        let Self { path, writer } = self;
        let partial = writer.into_inner().map_err(|error| wrong(&path)(error.into_error()))?;
        partial.sync().and_then(|()| partial.finish()).map_err(wrong(&path))
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.writer.flush()
    }
}

/// Turns an I/O error into ours.
pub(super) fn wrong(path: &Path) -> impl Fn(std::io::Error) -> Error + '_ {
    move |source| Error::Write { path: path.to_owned(), source }
}
