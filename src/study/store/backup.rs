//! Copies of a store while it is in use.

use super::files::STORE;
use crate::study::Error;
use rusqlite::{Connection, OpenFlags};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Folder of the copies within a folder of data.
const FOLDER: &str = "backups";
/// Copies that are kept.
const KEPT: usize = 24;

/// Writes a copy of a store, without the platform's ids, and deletes all but the newest copies. Returns the copy's path.
///
/// # Errors
/// [`Error::Store`] when the store cannot be read or the copy not be written.
pub fn write(data: &Path) -> Result<PathBuf, Error> {
    let path = data.join(STORE);
    let failed = |source: rusqlite::Error| Error::store("copy", &path, source);
    let connection = Connection::open_with_flags(&path, OpenFlags::SQLITE_OPEN_READ_WRITE).map_err(failed)?;
    connection.busy_timeout(Duration::from_secs(10)).map_err(failed)?;
    let folder = data.join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|source| Error::Write { path: folder.clone(), source })?;
    let now = "SELECT strftime('%Y%m%dT%H%M%fZ', 'now')";
    let time: String = connection.query_row(now, [], |row| row.get(0)).map_err(failed)?;
    let copy = folder.join(format!("study-{}.sqlite", time.replace('.', "")));
    let partial = copy.with_extension("partial");
    let written = connection.execute("VACUUM INTO ?1", [partial.to_string_lossy()]);
    if let Err(error) = written {
        // half a copy is none
        let _gone = std::fs::remove_file(&partial);
        return Err(failed(error));
    }
    let whole = std::fs::File::open(&partial).and_then(|file| file.sync_all());
    whole
        .and_then(|()| std::fs::rename(&partial, &copy))
        .map_err(|source| Error::Write { path: copy.clone(), source })?;
    prune(&folder)?;
    Ok(copy)
}

/// Deletes all but the newest copies.
fn prune(folder: &Path) -> Result<(), Error> {
    let failed = |source| Error::Write { path: folder.to_owned(), source };
    let mut copies: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(failed)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "sqlite"))
        .collect();
    // their names are times
    copies.sort();
    let old = copies.len().saturating_sub(KEPT);
    copies[..old].iter().try_for_each(|path| std::fs::remove_file(path).map_err(failed))
}
