//! Who participants are on a platform: a file of its own, which is deleted on its own date.

use super::files::LINKS;
use super::request::PlatformId;
use rusqlite::{Connection, OptionalExtension as _, Result, params};
use std::path::Path;

/// Attaches the file of links to a connection. A reader gets an empty one where there is none.
pub(super) fn attach(connection: &Connection, folder: &Path, is_reader: bool) -> Result<()> {
    let path = folder.join(LINKS);
    let path = if is_reader && !path.exists() { ":memory:".into() } else { path.to_string_lossy() };
    connection.execute("ATTACH ?1 AS links", [path])?;
    connection.execute_batch(
        "PRAGMA links.journal_mode = WAL; PRAGMA links.synchronous = FULL; PRAGMA links.secure_delete = ON; \
         CREATE TABLE IF NOT EXISTS links.link ( \
             participant INTEGER PRIMARY KEY, platform_id TEXT NOT NULL, submission TEXT NOT NULL, at INTEGER NOT NULL \
         ) STRICT;",
    )
}

/// Notes who a participant is on a platform.
pub(super) fn write(connection: &Connection, id: i64, platform: &PlatformId, at: i64) -> Result<()> {
    let mut statement =
        connection.prepare_cached("INSERT OR REPLACE INTO links.link VALUES (?1, ?2, ?3, ?4)")?;
    statement.execute(params![id, platform.participant, platform.submission, at]).map(drop)
}

/// The id by which the platform knows a participant; none where it is not there any more.
pub(super) fn read(connection: &Connection, id: i64) -> Result<Option<String>> {
    let mut statement =
        connection.prepare_cached("SELECT platform_id FROM links.link WHERE participant = ?1")?;
    statement.query_row([id], |row| row.get(0)).optional()
}

/// Deletes who a participant is.
pub(super) fn forget(connection: &Connection, id: i64) -> Result<()> {
    connection.execute("DELETE FROM links.link WHERE participant = ?1", [id]).map(drop)
}

/// Deletes all links older than a time, UTC ms; returns how many there were.
pub(super) fn purge(connection: &Connection, before: i64) -> Result<usize> {
    connection.execute("DELETE FROM links.link WHERE at < ?1", [before])
}

/// When the oldest link was made, UTC ms; none without links.
pub(super) fn oldest(connection: &Connection) -> Result<Option<i64>> {
    connection.query_row("SELECT min(at) FROM links.link", [], |row| row.get(0))
}
