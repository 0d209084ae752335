//! The folder of runs: `run=KEY/` for each that is done, a hidden `.run=KEY.PROCESS.NUMBER/` for each that is being done.
//!
//! A run is written into its hidden folder, brought onto the disk, and renamed. So a folder under its final name is whole,
//! whatever ended the process. Of two processes that do the same run, the second finds the name taken and removes its own.

use super::Error;
use super::key::Key;
use std::collections::HashSet;
use std::fs;
use std::io::{ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, SystemTime};

/// What comes before the key in the name of a run.
const RUN: &str = "run=";
/// The same while it is being done.
const HIDDEN: &str = ".run=";

/// Where the runs of sweeps are.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

/// A run that is being done. Dropped before [`Unfinished::commit`], it leaves nothing.
#[derive(Debug)]
pub struct Unfinished {
    hidden: PathBuf,
    place: PathBuf,
    is_done: bool,
}

/// What has become of a run that was committed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Committed {
    /// It has its name.
    Done,
    /// Another process was faster; its result is the same.
    Taken,
}

fn wrong(path: &Path) -> impl Fn(std::io::Error) -> Error + '_ {
    move |source| Error::Write { path: path.to_owned(), source }
}

impl Folder {
    /// The folder at a path, which is made if it is not there.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn make(path: &Path) -> Result<Self, Error> {
        fs::create_dir_all(path).map_err(wrong(path))?;
        Ok(Self { path: path.to_owned() })
    }

    /// The folder at a path, which need not be there.
    pub fn at(path: &Path) -> Self {
        Self { path: path.to_owned() }
    }

    /// Where a run is once it is done.
    pub fn place(&self, key: &str) -> PathBuf {
        self.path.join(format!("{RUN}{key}"))
    }

    /// Whether a run is done.
    pub fn has(&self, key: &str) -> bool {
        self.place(key).is_dir()
    }

    /// Names in the folder; none where there is no folder.
    fn names(&self) -> Result<Vec<String>, Error> {
        let read = |source| Error::Read { path: self.path.clone(), source };
        match fs::read_dir(&self.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            found => found
                .map_err(read)?
                .map(|entry| Ok(entry.map_err(read)?.file_name().to_string_lossy().into_owned()))
                .collect(),
        }
    }

    /// Keys of all runs that are done.
    ///
    /// # Errors
    /// [`Error::Read`].
    pub fn done(&self) -> Result<HashSet<String>, Error> {
        let names = self.names()?.into_iter();
        Ok(names
            .filter_map(|name| name.strip_prefix(RUN).and_then(Key::parse))
            .map(|key| key.to_string())
            .collect())
    }

    /// Folders of runs that are being done, or were when their process ended.
    ///
    /// # Errors
    /// [`Error::Read`].
    pub fn unfinished(&self) -> Result<Vec<PathBuf>, Error> {
        let is_hidden = |name: &String| {
            let key = name.strip_prefix(HIDDEN).and_then(|rest| rest.split('.').next());
            key.and_then(Key::parse).is_some()
        };
        let mut found: Vec<PathBuf> =
            self.names()?.iter().filter(|name| is_hidden(name)).map(|name| self.path.join(name)).collect();
        found.sort();
        Ok(found)
    }

    /// Removes folders of unfinished runs in which nothing was written for so long; those that it removed.
    ///
    /// # Errors
    /// [`Error::Read`] or [`Error::Write`].
    pub fn clean(&self, age: Duration) -> Result<Vec<PathBuf>, Error> {
        let now = SystemTime::now();
        let mut removed = Vec::new();
        for path in self.unfinished()? {
            let is_old =
                touched(&path).is_ok_and(|time| now.duration_since(time).is_ok_and(|since| since >= age));
            if is_old {
                match fs::remove_dir_all(&path) {
                    Err(error) if error.kind() == ErrorKind::NotFound => {} // its process ended meanwhile
                    removal => removal.map_err(wrong(&path))?,
                }
                removed.push(path);
            }
        }
        Ok(removed)
    }

    /// Begins a run in a hidden folder of its own.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn begin(&self, key: &str) -> Result<Unfinished, Error> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let place = self.place(key);
        loop {
            // Two machines may have processes of one number: the name is then taken, and the next one is tried.
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let hidden = self.path.join(format!("{HIDDEN}{key}.{}.{number}", std::process::id()));
            match fs::create_dir(&hidden) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                made => {
                    made.map_err(wrong(&hidden))?;
                    return Ok(Unfinished { hidden, place, is_done: false });
                }
            }
        }
    }
}

/// When something was last written in a folder.
fn touched(folder: &Path) -> IoResult<SystemTime> {
    let mut latest = fs::metadata(folder)?.modified()?;
    for entry in fs::read_dir(folder)? {
        latest = latest.max(entry?.metadata()?.modified()?);
    }
    Ok(latest)
}

impl Unfinished {
    /// Where the run's files are written.
    pub fn path(&self) -> &Path {
        &self.hidden
    }

    /// Brings everything onto the disk and gives the folder its name.
    ///
    /// # Errors
    /// [`Error::Write`]; the run is then not done.
    pub fn commit(mut self) -> Result<Committed, Error> {
        let sync = || -> IoResult<()> {
            for entry in fs::read_dir(&self.hidden)? {
                fs::File::open(entry?.path())?.sync_all()?;
            }
            sync_folder(&self.hidden)
        };
        sync().map_err(wrong(&self.hidden))?;
        // A folder takes the place of nothing but an empty one.
        match fs::rename(&self.hidden, &self.place) {
            Ok(()) => {
                self.is_done = true;
                if let Some(above) = self.place.parent() {
                    sync_folder(above).map_err(wrong(above))?;
                }
                Ok(Committed::Done)
            }
            Err(_) if self.place.is_dir() => Ok(Committed::Taken),
            Err(error) => Err(wrong(&self.place)(error)),
        }
    }
}

/// Brings the names in a folder onto the disk, where the system has that.
fn sync_folder(path: &Path) -> IoResult<()> {
    if cfg!(unix) { fs::File::open(path)?.sync_all() } else { Ok(()) }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if !self.is_done {
            // A leftover is harmless, and a destructor cannot return an error.
            let _ = fs::remove_dir_all(&self.hidden);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "0123456789abcdef0123456789abcdef";

    #[test]
    fn of_two_that_do_the_same_run_one_wins_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let runs = Folder::make(&folder.path().join("a/runs")).unwrap();
        let (one, two) = (runs.begin(KEY).unwrap(), runs.begin(KEY).unwrap());
        fs::write(one.path().join("run.json"), "1").unwrap();
        fs::write(two.path().join("run.json"), "2").unwrap();
        assert!(!runs.has(KEY));
        assert_eq!(runs.unfinished().unwrap().len(), 2);
        assert_eq!(two.commit().unwrap(), Committed::Done);
        assert_eq!(one.commit().unwrap(), Committed::Taken);
        assert_eq!(fs::read_to_string(runs.place(KEY).join("run.json")).unwrap(), "2");
        drop(runs.begin(KEY).unwrap());
        assert_eq!(runs.names().unwrap(), [format!("run={KEY}")]);
        assert_eq!(runs.done().unwrap(), HashSet::from([KEY.to_owned()]));
    }

    #[test]
    fn only_what_is_old_and_unfinished_is_cleaned_away() {
        let folder = tempfile::tempdir().unwrap();
        let runs = Folder::make(folder.path()).unwrap();
        for name in [".run=x.1.2", "run=0123", "run.json", &format!("run={KEY}"), ".git"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        let left = runs.begin(KEY).unwrap();
        fs::write(left.path().join("run.json"), "{").unwrap();
        assert_eq!(runs.clean(Duration::from_secs(3600)).unwrap(), Vec::<PathBuf>::new());
        let path = left.path().to_owned();
        std::mem::forget(left); // as a process that is killed
        assert_eq!(runs.clean(Duration::ZERO).unwrap(), std::slice::from_ref(&path));
        assert!(!path.exists());
        assert_eq!(runs.names().unwrap().len(), 5);
        assert_eq!(Folder::at(&folder.path().join("none")).unfinished().unwrap(), Vec::<PathBuf>::new());
    }
}
