//! Several folders of data as one.

use super::desk::Desk;
use super::files::{RECORDINGS, STORE};
use super::open;
use super::version::{Libraries, Version};
use crate::study::Error;
use crate::study::file::Part;
use rusqlite::{Connection, params};
use std::path::{Path, PathBuf};

/// Writes the data of several folders into a new one, for analysis: participants, trials, answers, exposures, events, notes,
/// audit and recordings. The platform's ids, browsers' secrets and operators stay where they are. Codes never collide. Returns the number of
/// participants.
///
/// # Errors
/// [`Error::Differs`] where folders hold different versions of a study, [`Error::Exists`] where `into` has data already, and the
/// store's other errors.
pub fn merge(from: &[PathBuf], into: &Path) -> Result<usize, Error> {
    if into.join(STORE).exists() {
        return Err(Error::Exists { path: into.join(STORE) });
    }
    let mut hashes: Option<(PathBuf, Vec<String>)> = None;
    for folder in from {
        let desk = open::read(folder)?;
        let own: Vec<String> = desk.versions.iter().map(|version| version.hash.clone()).collect();
        match &hashes {
            Some((first, known)) if *known != own => {
                return Err(Error::Differs { first: first.clone(), second: folder.clone() });
            }
            _ => hashes = Some((folder.clone(), own)),
        }
        if !into.join(STORE).exists() {
            begin(&desk, into)?;
        }
    }
    let path = into.join(STORE);
    let failed = |source: rusqlite::Error| Error::store("write", &path, source);
    let connection = Connection::open(&path).map_err(failed)?;
    for folder in from {
        add(&connection, &folder.join(STORE)).map_err(failed)?;
        copy(&folder.join(RECORDINGS), &into.join(RECORDINGS))?;
    }
    let count = "SELECT count(*) FROM participant";
    let count: i64 = connection.query_row(count, [], |row| row.get(0)).map_err(failed)?;
    Ok(usize::try_from(count).unwrap_or(0))
}

/// A new store with the versions of another one.
fn begin(desk: &Desk, into: &Path) -> Result<(), Error> {
    let path = into.join(STORE);
    std::fs::create_dir_all(into).map_err(|source| Error::Write { path: into.to_owned(), source })?;
    let connection = open::make(into)?;
    for version in desk.versions.iter() {
        let mut libraries = Libraries::new();
        let file = &version.study.file;
        let shown =
            file.parts.values().filter_map(Part::trials).filter_map(|trials| trials.show.gaits.clone());
        for name in shown.chain(file.crowd.iter().map(|crowd| crowd.library.clone())) {
            let from = version.folder.join(&name);
            if from.is_file() {
                let bytes = std::fs::read(&from).map_err(|source| Error::Read { path: from, source })?;
                libraries.insert(name, bytes);
            }
        }
        let mut copy = Version::clone(version);
        copy.folder = into.join("materials").join(version.folder.file_name().unwrap_or_default());
        copy.freeze(&libraries)?;
    }
    let from = desk.folder.join(STORE);
    let copied = || {
        connection.execute("ATTACH ?1 AS other", [from.to_string_lossy()])?;
        connection.execute_batch("INSERT INTO study SELECT * FROM other.study; DETACH other")
    };
    copied().map_err(|source: rusqlite::Error| Error::store("write", &path, source))
}

/// Copies a folder of recordings, if it is there: a folder for each code.
fn copy(from: &Path, into: &Path) -> Result<(), Error> {
    let entries = |folder: &Path| -> Result<Vec<PathBuf>, Error> {
        let read = std::fs::read_dir(folder).and_then(|found| found.map(|entry| Ok(entry?.path())).collect());
        read.map_err(|source| Error::Read { path: folder.to_owned(), source })
    };
    if !from.is_dir() {
        return Ok(());
    }
    for person in entries(from)?.into_iter().filter(|path| path.is_dir()) {
        let own = into.join(person.file_name().unwrap_or_default());
        std::fs::create_dir_all(&own).map_err(|source| Error::Write { path: own.clone(), source })?;
        for file in entries(&person)?.into_iter().filter(|path| path.is_file()) {
            let to = own.join(file.file_name().unwrap_or_default());
            std::fs::copy(&file, &to).map_err(|source| Error::Write { path: to, source })?;
        }
    }
    Ok(())
}

/// Adds the data of a store, with numbers beyond those that are there.
fn add(connection: &Connection, from: &Path) -> rusqlite::Result<()> {
    connection.execute("ATTACH ?1 AS other", [from.to_string_lossy()])?;
    let people: i64 =
        connection.query_row("SELECT coalesce(max(id), 0) FROM participant", [], |row| row.get(0))?;
    let seq: i64 = connection.query_row(
        "SELECT max(coalesce((SELECT max(seq) FROM event), 0), coalesce((SELECT max(seq) FROM answer), 0), \
         coalesce((SELECT max(seq) FROM exposure), 0))",
        [],
        |row| row.get(0),
    )?;
    connection.execute_batch("BEGIN")?;
    for sql in [
        "INSERT INTO participant SELECT id + ?1, version, code, NULL, front, language, person, arrived, state, changed \
         FROM other.participant WHERE ?2 >= 0",
        "INSERT INTO trial SELECT participant + ?1, part, position, item, gait, scene, condition, emotion, body, block, \
         row, seed, role, again, wanted FROM other.trial WHERE ?2 >= 0 ORDER BY rowid",
        "INSERT INTO answer SELECT seq + ?2, participant + ?1, page, question, value, text, first_ms, ms, key, at \
         FROM other.answer",
        "INSERT INTO exposure SELECT seq + ?2, participant + ?1, page, at, started, seconds_visible, plays, frames, \
         late_frames, longest_ms FROM other.exposure",
        "INSERT INTO event SELECT seq + ?2, participant + ?1, at, kind, detail FROM other.event",
        "INSERT INTO note SELECT participant + ?1, at, operator, text FROM other.note WHERE ?2 >= 0",
        "INSERT INTO audit SELECT at, operator, what, about FROM other.audit WHERE ?1 + ?2 >= 0",
    ] {
        connection.execute(sql, params![people, seq])?;
    }
    connection.execute_batch("COMMIT; DETACH other")
}
