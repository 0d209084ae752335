//! What the rows of a store tell, ready in memory.

use super::super::plan::Ledger;
use super::super::protocol::{Entry, Event, Session, State, follow};
use super::entries;
use super::request::Arrival;
use super::secret::Hash;
use super::version::Version;
use crate::study::file::Front;
use rusqlite::Connection;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// A participation as the store holds it.
#[derive(Debug)]
pub(super) struct Participation {
    pub(super) code: String,
    pub(super) version: u32,
    pub(super) front: Front,
    pub(super) language: String,
    pub(super) session: Session,
    /// The state that the row of the participant has.
    pub(super) state: State,
    /// Last sign of life, UTC ms.
    pub(super) last_sign: i64,
    /// Faults of stimuli.
    pub(super) faults: usize,
    /// Why the operator has excluded it.
    pub(super) reason: String,
}

/// What the rows tell; rebuilt when a transaction fails.
#[derive(Debug, Default)]
pub(super) struct Books {
    pub(super) ledgers: BTreeMap<u32, Ledger>,
    pub(super) people: BTreeMap<i64, Participation>,
    pub(super) by_token: HashMap<Hash, i64>,
    pub(super) by_code: HashMap<String, i64>,
    pub(super) by_external: HashMap<Hash, i64>,
    pub(super) is_closed: bool,
    /// Number of the last thing that happened.
    pub(super) sequence: i64,
}

impl Books {
    /// Everything that the rows tell.
    pub(super) fn read(connection: &Connection, versions: &[Arc<Version>]) -> rusqlite::Result<Self> {
        let version = |number: u32| versions.iter().find(|version| version.number == number);
        let mut books = Self::default();
        let rows = connection.query_row("SELECT rows_from, rows_to FROM secret", [], |row| {
            Ok(row.get::<_, Option<u32>>(0)?.zip(row.get::<_, Option<u32>>(1)?))
        })?;
        for version in versions {
            let ledger = Ledger::new(&version.plan).with_rows(rows.map(|(from, to)| from..to));
            books.ledgers.insert(version.number, ledger);
        }
        let mut people = connection.prepare(
            "SELECT id, version, code, front, language, person, arrived, external_hash FROM participant ORDER BY id",
        )?;
        let mut rows = people.query([])?;
        while let Some(row) = rows.next()? {
            let (id, number): (i64, u32) = (row.get(0)?, row.get(1)?);
            let Some(version) = version(number) else { continue };
            let front: String = row.get(3)?;
            let arrival = Arrival { front: front_named(&front), language: row.get(4)?, platform: None };
            let person = u64::try_from(row.get::<_, i64>(5)?).unwrap_or(0);
            let one = Participation::new(version, row.get(2)?, &arrival, person, row.get(6)?);
            books.by_code.insert(one.code.clone(), id);
            if let Some(hash) = row.get::<_, Option<Hash>>(7)? {
                books.by_external.insert(hash, id);
            }
            books.people.insert(id, one);
        }
        for (seq, id, entry) in entries::read(connection)? {
            books.sequence = seq;
            let Some(one) = books.people.get_mut(&id) else { continue };
            let (Some(version), Some(ledger)) = (version(one.version), books.ledgers.get_mut(&one.version))
            else {
                continue;
            };
            follow(&version.plan, ledger, &mut one.session, &entry);
            one.note(&entry);
        }
        books.people.values_mut().for_each(|one| one.state = one.session.state());
        let mut tokens = connection.prepare("SELECT hash, participant FROM token")?;
        for token in tokens.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))? {
            let (hash, id) = token?;
            books.by_token.insert(hash, id);
        }
        books.is_closed = connection.query_row("SELECT is_closed FROM secret", [], |row| row.get(0))?;
        Ok(books)
    }
}

impl Participation {
    /// A participation that has just begun.
    pub(super) fn new(version: &Version, code: String, arrival: &Arrival, person: u64, at: i64) -> Self {
        let mut session = Session::new(&version.plan);
        let language = arrival.language.clone();
        let event = Event::Arrived { person, front: arrival.front, language };
        session.take(&version.plan, &Entry { at, event });
        Self {
            code,
            version: version.number,
            front: arrival.front,
            language: arrival.language.clone(),
            state: session.state(),
            session,
            last_sign: at,
            faults: 0,
            reason: String::new(),
        }
    }

    /// What lists of participants show of an event.
    pub(super) fn note(&mut self, entry: &Entry) {
        if entry.event.is_sign_of_life() {
            self.last_sign = self.last_sign.max(entry.at);
        }
        match &entry.event {
            Event::Fault { .. } => self.faults += 1,
            Event::Excluded { reason } => self.reason.clone_from(reason),
            _ => {}
        }
    }
}

/// A front by its name in the store.
fn front_named(name: &str) -> Front {
    match name {
        "headset" => Front::Headset,
        "web" => Front::Web,
        _ => Front::Simulated,
    }
}
