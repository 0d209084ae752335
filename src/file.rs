//! Files: read whole with a bound, written whole or not at all.

use std::collections::BTreeSet;
use std::fs::{File, Metadata, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Read as _, Result, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Most programs that write the same file at the same time.
const MOST_WRITERS: u32 = 100;

/// The bytes of a file of at most `most` bytes.
///
/// # Errors
/// When it cannot be read, is longer, or is no regular file: a pipe or a device has no end, or never begins.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let size = regular(path)?.len();
    let too_long = |size| {
        let message = format!("{size} bytes; files of up to {most} bytes are read");
        Error::new(ErrorKind::FileTooLarge, message)
    };
    if size > most {
        return Err(too_long(size));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(usize::try_from(size).unwrap_or(usize::MAX))?;
    // it may have grown since, and files of the system have no length until they are read
    let found = File::open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if found as u64 > most { Err(too_long(found as u64)) } else { Ok(bytes) }
}

/// The text of a file of at most `most` bytes.
///
/// # Errors
/// As [`read`]; also when its bytes are no UTF-8.
pub fn read_text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read(path, most)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
        Error::new(ErrorKind::InvalidData, format!("line {line} holds bytes that are no text (UTF-8)"))
    })
}

/// What the system says of a regular file.
///
/// # Errors
/// When there is none, or something else has the name.
pub fn regular(path: &Path) -> Result<Metadata> {
    let data = std::fs::metadata(path)?;
    if data.is_file() {
        Ok(data)
    } else {
        Err(Error::new(ErrorKind::InvalidInput, format!("is {}, not a file", kind(&data))))
    }
}

#[cfg(unix)]
fn kind(data: &Metadata) -> &'static str {
    use std::os::unix::fs::FileTypeExt as _;
    let kind = data.file_type();
    match () {
        () if kind.is_dir() => "a folder",
        () if kind.is_fifo() => "a pipe",
        () if kind.is_socket() => "a socket",
        () => "a device",
    }
}

#[cfg(not(unix))]
fn kind(data: &Metadata) -> &'static str {
    if data.is_dir() { "a folder" } else { "a device" }
}

/// The folder where this system's programs keep what they can make again; none for a user without a home.
pub fn users_cache() -> Option<PathBuf> {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    users_cache_of(set, cfg!(windows), cfg!(target_os = "macos"))
}

fn users_cache_of(set: impl Fn(&str) -> Option<PathBuf>, windows: bool, mac: bool) -> Option<PathBuf> {
    // a home that is not there is none: accounts of services have such
    let home = || set("HOME").filter(|home| home.is_dir());
    if windows {
        return set("LOCALAPPDATA");
    }
    if mac {
        return home().map(|home| home.join("Library/Caches"));
    }
    let named = set("XDG_CACHE_HOME").filter(|path| path.is_absolute());
    named.or_else(|| home().map(|home| home.join(".cache")))
}

/// Writes a whole file; on failure its name is as it was before.
///
/// # Errors
/// When it cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut partial = Partial::create(path)?;
    partial.write_all(bytes)?;
    partial.finish()
}

/// A file being written, a hidden neighbour of its place: `.NAME.partial`. It takes its name when finished, and is removed
/// when dropped before that.
///
/// Its writer holds a lock on it. An unlocked one was left by a program that was killed: it is used again.
#[derive(Debug)]
pub struct Partial {
    path: PathBuf,
    temporary: PathBuf,
    file: File,
    is_finished: bool,
}

/// Those that are being written.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Partial {
    /// Begins a file that is to be `path`.
    ///
    /// # Errors
    /// When the folder does not exist or cannot be written to, or `path` is something else than a file.
    pub fn create(path: &Path) -> Result<Self> {
        let Some(name) = path.file_name() else {
            let message = "no file name in this path; give one such as run.sqlite";
            return Err(Error::new(ErrorKind::InvalidFilename, message));
        };
        match regular(path) {
            Err(error) if error.kind() == ErrorKind::InvalidInput => return Err(error),
            _ => {}
        }
        for number in 1..=MOST_WRITERS {
            let mut hidden = std::ffi::OsString::from(".");
            hidden.push(name);
            hidden.push(if number == 1 { ".partial".to_owned() } else { format!(".{number}.partial") });
            let temporary = path.with_file_name(hidden);
            if let Some(file) = own(&temporary)? {
                unfinished().insert(temporary.clone());
                return Ok(Self { path: path.to_owned(), temporary, file, is_finished: false });
            }
        }
        Err(Error::new(ErrorKind::ResourceBusy, format!("{MOST_WRITERS} programs are writing it")))
    }

    /// Where its bytes are for now.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Waits until its bytes are on the disk.
    ///
    /// # Errors
    /// When they cannot be written there.
    pub fn sync(&self) -> Result<()> {
        self.file.sync_all()
    }

    /// The file takes its name; what had it is replaced.
    ///
    /// # Errors
    /// When it cannot be renamed; the name is then as it was before.
    pub fn finish(mut self) -> Result<()> {
        std::fs::rename(&self.temporary, &self.path)?;
        self.is_finished = true;
        Ok(())
    }
}

/// A new file, or one that was left behind; none if another writer has it.
fn own(temporary: &Path) -> Result<Option<File>> {
    let (file, is_new) = match OpenOptions::new().write(true).create_new(true).open(temporary) {
        Ok(file) => (file, true),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            match OpenOptions::new().write(true).open(temporary) {
                Ok(file) => (file, false),
                // removed in this moment, or another user's
                Err(_) => return Ok(None),
            }
        }
        Err(error) => return Err(error),
    };
    match file.try_lock() {
        Ok(()) if is_same(&file, temporary) => {
            file.set_len(0)?;
            Ok(Some(file))
        }
        // a file system without locks: new files are ours, old ones are left
        Err(TryLockError::Error(_)) if is_new => Ok(Some(file)),
        _ => Ok(None),
    }
}

/// Whether the open file still has that name: its last writer may have finished it meanwhile.
#[cfg(unix)]
fn is_same(file: &File, name: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    match (file.metadata(), std::fs::metadata(name)) {
        (Ok(a), Ok(b)) => (a.dev(), a.ino()) == (b.dev(), b.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_same(_: &File, name: &Path) -> bool {
    name.exists()
}

impl Write for Partial {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        self.file.flush()
    }
}

#[cfg(unix)]
impl std::os::fd::AsFd for Partial {
    fn as_fd(&self) -> std::os::fd::BorrowedFd<'_> {
        self.file.as_fd()
    }
}

impl Seek for Partial {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        self.file.seek(to)
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if !self.is_finished {
            // A leftover is harmless, and a destructor cannot return an error.
            let _ = std::fs::remove_file(&self.temporary);
        }
        unfinished().remove(&self.temporary);
    }
}

/// Removes every unfinished file, since the program ends now.
pub fn abandon() {
    // try_lock: the holder may be the very thread that has no memory left
    if let Ok(files) = UNFINISHED.try_lock() {
        for file in files.iter() {
            let _ = std::fs::remove_file(file);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_within_their_bound_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        write(&path, b"1234").unwrap();
        assert_eq!(read(&path, 4).unwrap(), b"1234");
        assert!(read(&path, 3).unwrap_err().to_string().contains("up to 3"));
        assert!(read(folder.path(), 9).unwrap_err().to_string().contains("a folder"));
        write(&path, b"a\nb\xff").unwrap();
        assert!(read_text(&path, 9).unwrap_err().to_string().starts_with("line 2"));
        #[cfg(target_os = "linux")]
        {
            assert!(read(Path::new("/dev/zero"), 9).unwrap_err().to_string().contains("a device"));
            // has a length of 0 and bytes all the same
            assert!(read(Path::new("/proc/self/status"), 9).unwrap_err().to_string().contains("up to 9"));
        }
    }

    #[test]
    fn the_users_cache_is_where_the_system_has_it() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path().to_str().unwrap();
        let found = |set: &[(&str, &str)], windows, mac| {
            let set = |name: &str| set.iter().find(|(of, _)| *of == name).map(|(_, value)| value.into());
            users_cache_of(set, windows, mac)
        };
        let below_home = |name: &str| Some(Path::new(home).join(name));
        assert_eq!(found(&[("HOME", home)], false, false), below_home(".cache"));
        let named = [("HOME", home), ("XDG_CACHE_HOME", "/c")];
        assert_eq!(found(&named, false, false), Some("/c".into()));
        assert_eq!(found(&named, false, true), below_home("Library/Caches"));
        let relative = [("HOME", home), ("XDG_CACHE_HOME", "c")];
        assert_eq!(found(&relative, false, false), below_home(".cache"));
        assert_eq!(found(&[("LOCALAPPDATA", "L"), ("HOME", home)], true, false), Some("L".into()));
        assert_eq!(found(&[("HOME", "/no/such/home")], false, false), None);
        assert_eq!(found(&[], false, false), None);
    }

    #[test]
    fn what_a_killed_writer_left_is_used_again_and_what_another_writes_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        let left = folder.path().join(".run.csv.partial");
        std::fs::write(&left, "half of").unwrap();
        let mut one = Partial::create(&path).unwrap();
        let mut two = Partial::create(&path).unwrap();
        assert_eq!(one.temporary(), left);
        assert_ne!(two.temporary(), left);
        two.write_all(b"two").unwrap();
        two.finish().unwrap();
        one.write_all(b"1").unwrap();
        one.finish().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"1");
        drop(Partial::create(&path).unwrap());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn devices_and_folders_are_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        assert!(write(folder.path(), b"").unwrap_err().to_string().contains("a folder"));
        assert!(write(Path::new("/dev/null"), b"").unwrap_err().to_string().contains("a device"));
    }
}
