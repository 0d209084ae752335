//! Making and opening a folder of data.

use super::desk::Desk;
use super::files::{RECORDINGS, STORE};
use super::links;
use super::secret;
use super::version::{Opening, Version};
use crate::study::plan::Ledger;
use crate::study::{Error, Materials};
use rusqlite::{Connection, params};
use std::fs::{File, OpenOptions, TryLockError};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

const SCHEMA: &str = include_str!("schema.sql");
/// What `user_version` says of a store of this program.
const FORMAT: i64 = 1;
/// Name of the file that a program holds locked while it may write.
const LOCK: &str = "lock";
/// How long another program is waited for.
const PATIENCE: Duration = Duration::from_secs(2);

/// Opens a folder of data for writing; makes it with the study of `opening`, or adds a version. Returns the desk and the lock.
pub(super) fn open(folder: &Path, opening: Option<&Opening>) -> Result<(Desk, File), Error> {
    let path = folder.join(STORE);
    if opening.is_none() && !path.is_file() {
        return Err(Error::NoStore { path });
    }
    std::fs::create_dir_all(folder).map_err(|source| Error::Write { path: folder.to_owned(), source })?;
    let lock = lock(folder)?;
    let failed = |source: rusqlite::Error| Error::store("open", &path, source);
    let connection = connect(&path).map_err(failed)?;
    links::attach(&connection, folder, false).map_err(failed)?;
    prepare(&connection, &path)?;
    let mut versions = versions(&connection, folder)?;
    if let Some(opening) = opening {
        versions.extend(add(&connection, folder, opening, &versions)?);
        if let (Some(rows), Some(version)) = (&opening.rows, versions.last()) {
            check_rows(version, rows)?;
            let sql = "UPDATE secret SET rows_from = ?1, rows_to = ?2";
            connection.execute(sql, [rows.start, rows.end]).map_err(failed)?;
        }
    }
    let desk = Desk::new(folder.to_owned(), connection, versions).map_err(failed)?;
    let recordings = || folder.join(RECORDINGS);
    desk.forget_recordings().map_err(|source| Error::Write { path: recordings(), source })?;
    Ok((desk, lock))
}

/// Opens a folder of data for reading, beside a program that may write.
pub(super) fn read(folder: &Path) -> Result<Desk, Error> {
    let path = folder.join(STORE);
    if !path.is_file() {
        return Err(Error::NoStore { path });
    }
    let failed = |source: rusqlite::Error| Error::store("read", &path, source);
    // a log of its writer can be read by connections alone that may write
    let connection = connect(&path).map_err(failed)?;
    links::attach(&connection, folder, true).map_err(failed)?;
    // one state of all tables, whatever the writer does meanwhile
    connection.execute_batch("PRAGMA query_only = ON; BEGIN").map_err(failed)?;
    check_format(&connection, &path)?;
    let versions = versions(&connection, folder)?;
    Desk::new(folder.to_owned(), connection, versions).map_err(failed)
}

fn connect(path: &Path) -> rusqlite::Result<Connection> {
    let connection = Connection::open(path)?;
    connection.busy_timeout(PATIENCE)?;
    connection.set_prepared_statement_cache_capacity(64);
    // `secure_delete`: what a participant wants deleted is overwritten
    connection.execute_batch(
        "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON; PRAGMA secure_delete = ON; \
         PRAGMA trusted_schema = OFF;",
    )?;
    Ok(connection)
}

/// One program at a time writes.
fn lock(folder: &Path) -> Result<File, Error> {
    let path = folder.join(LOCK);
    let failed = |source| Error::Write { path: path.clone(), source };
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path).map_err(failed)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(Error::InUse { path: folder.to_owned() }),
        Err(TryLockError::Error(source)) => Err(failed(source)),
    }
}

fn check_format(connection: &Connection, path: &Path) -> Result<i64, Error> {
    let failed = |source: rusqlite::Error| Error::store("read", path, source);
    let found: i64 = connection.pragma_query_value(None, "user_version", |row| row.get(0)).map_err(failed)?;
    if found > FORMAT {
        return Err(Error::NewerStore { path: path.to_owned(), found, known: FORMAT });
    }
    Ok(found)
}

/// Tables and secrets of a new store.
fn prepare(connection: &Connection, path: &Path) -> Result<(), Error> {
    if check_format(connection, path)? == FORMAT {
        return Ok(());
    }
    let names = i64::try_from(secret::number()?).unwrap_or(i64::MAX);
    let key: secret::Hash = secret::random()?;
    let made = || {
        connection.execute_batch("BEGIN IMMEDIATE")?;
        connection.execute_batch(SCHEMA)?;
        connection.execute("INSERT INTO secret VALUES (1, ?1, ?2, 0, NULL, NULL)", params![names, key])?;
        connection.execute_batch("COMMIT")
    };
    made().map_err(|source: rusqlite::Error| Error::store("make", path, source))
}

/// A store without a study.
pub(super) fn make(folder: &Path) -> Result<Connection, Error> {
    let path = folder.join(STORE);
    let connection = connect(&path).map_err(|source| Error::store("make", &path, source))?;
    prepare(&connection, &path)?;
    Ok(connection)
}

/// The frozen versions of a store, oldest first.
fn versions(connection: &Connection, folder: &Path) -> Result<Vec<Arc<Version>>, Error> {
    let path = folder.join(STORE);
    let failed = |source: rusqlite::Error| Error::store("read", &path, source);
    let secret = names(connection).map_err(failed)?;
    let mut statement =
        connection.prepare("SELECT file, materials, hash FROM study ORDER BY version").map_err(failed)?;
    let row = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?, row.get(2)?));
    let rows =
        statement.query_map([], row).and_then(Iterator::collect::<Result<Vec<_>, _>>).map_err(failed)?;
    let version = |(file, materials, hash): (String, String, String)| {
        let materials: Materials = serde_json::from_str(&materials)
            .map_err(|error| Error::store("read the materials of", &path, error))?;
        Version::of(&file, materials, hash, secret, folder).map(Arc::new)
    };
    rows.into_iter().map(version).collect()
}

/// What names of stimuli are made from.
fn names(connection: &Connection) -> rusqlite::Result<u64> {
    let bits: i64 = connection.query_row("SELECT names FROM secret", [], |row| row.get(0))?;
    Ok(u64::try_from(bits).unwrap_or(0))
}

/// Adds what is opened as a version, unless it is the newest one.
fn add(
    connection: &Connection,
    folder: &Path,
    opening: &Opening,
    known: &[Arc<Version>],
) -> Result<Option<Arc<Version>>, Error> {
    let path = folder.join(STORE);
    let failed = |source: rusqlite::Error| Error::store("write", &path, source);
    let (libraries, hash) = opening.read()?;
    let number = opening.study.file.study.version;
    if let Some(newest) = known.last() {
        if newest.hash == hash {
            newest.freeze(&libraries)?;
            return Ok(None);
        }
        let (found, wanted) = (&opening.study.file.study.id, &newest.study.file.study.id);
        if found != wanted {
            let (path, found, wanted) = (folder.to_owned(), found.clone(), wanted.clone());
            return Err(Error::OtherStudy { path, found, wanted });
        }
        if number <= newest.number {
            return Err(Error::Changed { path: folder.to_owned(), version: newest.number });
        }
    }
    let secret = names(connection).map_err(failed)?;
    let version = Version::of(&opening.study.text, opening.materials.clone(), hash, secret, folder)?;
    version.freeze(&libraries)?;
    let materials = serde_json::to_string(&version.materials)
        .map_err(|error| Error::store("write the materials of", &path, error))?;
    let sql = "INSERT INTO study VALUES (?1, ?2, ?3, ?4, ?5, ?6, unixepoch() * 1000)";
    let Version { number, hash, study, .. } = &version;
    let program = env!("CARGO_PKG_VERSION");
    connection
        .execute(sql, params![number, study.file.study.id, hash, study.text, materials, program])
        .map_err(failed)?;
    Ok(Some(Arc::new(version)))
}

/// Whether a design has these rows.
fn check_rows(version: &Version, rows: &Range<u32>) -> Result<(), Error> {
    let most = Ledger::new(&version.plan).most_rows();
    if rows.start < rows.end && rows.end as usize <= most {
        return Ok(());
    }
    let hint = "rows count from 0; `gaitway study check` says how many a design has";
    Err(Error::value(
        "rows".to_owned(),
        format!("{}..{}", rows.start, rows.end),
        format!("within 0..{most}"),
        hint,
    ))
}

/// The path of a store in a folder of data.
pub(super) fn path(folder: &Path) -> PathBuf {
    folder.join(STORE)
}
