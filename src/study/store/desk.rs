//! What the one writer holds: the connection, and everything that its rows tell, ready in memory.

use super::super::protocol::{Entry, Event};
use super::books::{Books, Participation};
use super::request::{Arrival, Failure};
use super::secret::{self, Hash};
use super::version::Version;
use super::{entries, links};
use crate::study::file::OnWithdrawal;
use rusqlite::{Connection, OptionalExtension as _, params};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// The clock of a store: it never goes back, though the system's may.
#[derive(Debug)]
pub(super) struct Clock {
    began: Instant,
    at_begin: i64,
}

impl Clock {
    /// A clock that goes on from the last stored time, or from now if that is later.
    fn after(last: i64) -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let now = i64::try_from(since.as_millis()).unwrap_or(i64::MAX);
        Self { began: Instant::now(), at_begin: now.max(last) }
    }

    /// UTC ms.
    pub(super) fn now(&self) -> i64 {
        self.at_begin + i64::try_from(self.began.elapsed().as_millis()).unwrap_or(0)
    }
}

/// What the one writer holds.
#[derive(Debug)]
pub(super) struct Desk {
    pub(super) folder: PathBuf,
    pub(super) connection: Connection,
    /// All versions, oldest first; there is at least one.
    pub(super) versions: Arc<Vec<Arc<Version>>>,
    pub(super) clock: Clock,
    /// Key of the hashes of platform ids.
    pub(super) key: Hash,
    pub(super) books: Books,
    is_writing: bool,
    /// Why a request of the current transaction could not be written.
    failure: Option<String>,
    /// Whether memory is ahead of the disk.
    is_stale: bool,
    /// Whether something was deleted that must not stay in the logs.
    pub(super) has_forgotten: bool,
}

impl Desk {
    /// A desk over an open store.
    pub(super) fn new(
        folder: PathBuf,
        connection: Connection,
        versions: Vec<Arc<Version>>,
    ) -> rusqlite::Result<Self> {
        let key = connection.query_row("SELECT ids FROM secret", [], |row| row.get(0))?;
        let last = connection.query_row(
            "SELECT max(coalesce((SELECT max(at) FROM event), 0), coalesce((SELECT max(at) FROM answer), 0), \
             coalesce((SELECT max(arrived) FROM participant), 0))",
            [],
            |row| row.get(0),
        )?;
        let mut desk = Self {
            folder,
            connection,
            versions: Arc::new(versions),
            clock: Clock::after(last),
            key,
            books: Books::default(),
            is_writing: false,
            failure: None,
            is_stale: false,
            has_forgotten: false,
        };
        desk.rebuild()?;
        Ok(desk)
    }

    /// A version by its number.
    pub(super) fn version(&self, number: u32) -> Option<Arc<Version>> {
        self.versions.iter().find(|version| version.number == number).cloned()
    }

    /// The version that new participants get.
    pub(super) fn current(&self) -> Option<Arc<Version>> {
        self.versions.last().cloned()
    }

    /// Notes that a request could not be written: the transaction will be taken back.
    pub(super) fn fail(&mut self, reason: String) {
        self.failure.get_or_insert(reason);
    }

    /// Why the current transaction will be taken back, if it will.
    pub(super) fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// Commits, or takes everything back since the last commit. Returns why.
    pub(super) fn settle(&mut self) -> Option<String> {
        let failure = match self.failure.take() {
            Some(reason) => Some(reason),
            None => self.commit().err().map(|error| error.to_string()),
        };
        let Some(failure) = failure else {
            if std::mem::take(&mut self.has_forgotten) {
                // where a reader holds the log, the next deletion or the end empties it
                let _emptied = self.empty_logs();
                // what is left, the next deletion or the next start deletes
                let _deleted = self.forget_recordings();
            }
            return None;
        };
        // without the disk there is nothing to rebuild from; the next request tries again
        self.is_stale = self.roll_back().is_err();
        Some(failure)
    }

    /// Moves everything from the logs into the files themselves: what was deleted is then overwritten everywhere.
    pub(super) fn empty_logs(&self) -> rusqlite::Result<()> {
        self.connection
            .execute_batch("PRAGMA main.wal_checkpoint(TRUNCATE); PRAGMA links.wal_checkpoint(TRUNCATE)")
    }

    /// Rebuilds what could not be rebuilt after a failure.
    pub(super) fn refresh(&mut self) -> Result<(), Failure> {
        if self.is_stale {
            self.roll_back()?;
            self.is_stale = false;
        }
        Ok(())
    }

    /// Begins to write, if nothing has been written since the last commit.
    pub(super) fn begin(&mut self) -> rusqlite::Result<()> {
        if !self.is_writing {
            self.connection.execute_batch("BEGIN IMMEDIATE")?;
            self.is_writing = true;
        }
        Ok(())
    }

    /// Puts on the disk what was written since the last commit.
    pub(super) fn commit(&mut self) -> rusqlite::Result<()> {
        if self.is_writing {
            self.connection.execute_batch("COMMIT")?;
            self.is_writing = false;
        }
        Ok(())
    }

    /// Takes back what was written since the last commit, in memory too.
    pub(super) fn roll_back(&mut self) -> rusqlite::Result<()> {
        // some failures end the transaction by themselves
        if !self.connection.is_autocommit() {
            self.connection.execute_batch("ROLLBACK")?;
        }
        self.is_writing = false;
        self.rebuild()
    }

    /// Writes what happened to a participant, and the state that follows from it.
    pub(super) fn write(&mut self, id: i64, happened: &[Entry]) -> rusqlite::Result<()> {
        let Some(version) = self.books.people.get(&id).and_then(|one| self.version(one.version)) else {
            return Ok(());
        };
        self.begin()?;
        for entry in happened {
            self.books.sequence += 1;
            entries::write(&self.connection, &version.plan, (self.books.sequence, id), entry)?;
        }
        let Some(one) = self.books.people.get_mut(&id) else { return Ok(()) };
        happened.iter().for_each(|entry| one.note(entry));
        let state = one.session.state();
        if state != one.state {
            let sql = "UPDATE participant SET state = ?2, changed = ?3 WHERE id = ?1";
            let at = happened.last().map_or(0, |entry| entry.at);
            self.connection.prepare_cached(sql)?.execute(params![id, state.name(), at])?;
            one.state = state;
        }
        Ok(())
    }

    /// Gives a browser of a participant a secret of its own.
    pub(super) fn issue(&mut self, id: i64) -> Result<String, Failure> {
        let token = secret::token()?;
        let hash = secret::hash(token.as_bytes());
        self.begin()?;
        self.connection.prepare_cached("INSERT INTO token VALUES (?1, ?2)")?.execute(params![hash, id])?;
        self.books.by_token.insert(hash, id);
        Ok(token)
    }

    /// Everything that the rows tell, read again.
    pub(super) fn rebuild(&mut self) -> rusqlite::Result<()> {
        self.books = Books::read(&self.connection, &self.versions)?;
        Ok(())
    }

    /// Whether a platform's participant withdrew and left nothing that leads to them.
    pub(super) fn is_gone(&self, external: &Hash) -> rusqlite::Result<bool> {
        let sql = "SELECT 1 FROM gone WHERE external_hash = ?1";
        let found = self.connection.prepare_cached(sql)?.query_row([external], |_| Ok(())).optional()?;
        Ok(found.is_some())
    }

    /// Deletes what the study's withdrawal rule says, after `Withdrawn` was written.
    pub(super) fn forget(&mut self, id: i64) -> rusqlite::Result<()> {
        let Some(one) = self.books.people.get(&id) else { return Ok(()) };
        let Some(version) = self.version(one.version) else { return Ok(()) };
        links::forget(&self.connection, id)?;
        self.has_forgotten = true;
        if version.plan.on_withdrawal == OnWithdrawal::KeepAnonymous {
            self.connection.execute(
                "INSERT OR IGNORE INTO gone SELECT external_hash FROM participant WHERE id = ?1 AND external_hash NOT NULL",
                [id],
            )?;
            self.connection.execute("UPDATE participant SET external_hash = NULL WHERE id = ?1", [id])?;
            self.connection.execute("DELETE FROM token WHERE participant = ?1", [id])?;
            self.books.by_external.retain(|_, other| *other != id);
            self.books.by_token.retain(|_, other| *other != id);
            return Ok(());
        }
        for sql in [
            "DELETE FROM answer WHERE participant = ?1",
            "DELETE FROM exposure WHERE participant = ?1",
            "DELETE FROM trial WHERE participant = ?1",
            "DELETE FROM event WHERE participant = ?1 AND kind <> 'withdrawn'",
        ] {
            self.connection.execute(sql, [id])?;
        }
        self.begin_again(id, &version)
    }

    /// A participation in memory as its few remaining rows tell it.
    fn begin_again(&mut self, id: i64, version: &Version) -> rusqlite::Result<()> {
        let Some(one) = self.books.people.get_mut(&id) else { return Ok(()) };
        let sql = "SELECT person, arrived FROM participant WHERE id = ?1";
        let (person, at): (i64, i64) =
            self.connection.query_row(sql, [id], |row| Ok((row.get(0)?, row.get(1)?)))?;
        let arrival = Arrival { front: one.front, language: one.language.clone(), platform: None };
        let person = u64::try_from(person).unwrap_or(0);
        let mut fresh = Participation::new(version, one.code.clone(), &arrival, person, at);
        fresh.session.take(&version.plan, &Entry { at: one.last_sign, event: Event::Withdrawn });
        fresh.state = fresh.session.state();
        *one = fresh;
        Ok(())
    }
}
