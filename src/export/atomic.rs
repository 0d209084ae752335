//! Files that are whole or absent: written beside their place, renamed when complete.

use super::Error;
use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A file that appears under its name only when [`AtomicFile::finish`] is called; dropped before, it leaves nothing.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    neighbour: Neighbour,
    writer: BufWriter<File>,
}

impl AtomicFile {
    /// Opens a temporary neighbour of `path`.
    ///
    /// # Errors
    /// [`Error::Write`] when the folder does not exist or cannot be written.
    pub fn create(path: &Path) -> Result<Self, Error> {
        let neighbour = Neighbour::new(path)?;
        let file = OpenOptions::new().write(true).open(&neighbour.path).map_err(wrong(path))?;
        Ok(Self { path: path.to_owned(), neighbour, writer: BufWriter::with_capacity(1 << 18, file) })
    }

    /// The file's final name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes everything out and renames the neighbour to its final name, replacing what was there.
    ///
    /// # Errors
    /// [`Error::Write`]; the final name is then as it was before.
    pub fn finish(mut self) -> Result<(), Error> {
        self.writer.flush().map_err(wrong(&self.path))?;
        self.writer.get_ref().sync_all().map_err(wrong(&self.path))?;
        // Windows renames no open file.
        let Self { path, neighbour, writer } = self;
        drop(writer);
        neighbour.rename(&path)
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

/// A new empty file beside `path`, removed when dropped before [`Neighbour::rename`].
#[derive(Debug)]
pub(super) struct Neighbour {
    pub(super) path: PathBuf,
    renamed: bool,
}

impl Neighbour {
    pub(super) fn new(path: &Path) -> Result<Self, Error> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let Some(name) = path.file_name() else {
            let message = "no file name in this path; give one such as run.sqlite".to_owned();
            return Err(Error::Unusable { path: path.to_owned(), message });
        };
        let mut temporary = std::ffi::OsString::from(".");
        temporary.push(name);
        temporary.push(format!(".{}-{}.partial", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
        let neighbour = path.with_file_name(temporary);
        OpenOptions::new().write(true).create_new(true).open(&neighbour).map_err(wrong(path))?;
        Ok(Self { path: neighbour, renamed: false })
    }

    pub(super) fn rename(mut self, path: &Path) -> Result<(), Error> {
        std::fs::rename(&self.path, path).map_err(wrong(path))?;
        self.renamed = true;
        Ok(())
    }
}

impl Drop for Neighbour {
    fn drop(&mut self) {
        if !self.renamed {
            // A leftover is harmless, and there is nobody to tell.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}
