//! Who comes, and what they are given.

use super::super::plan::{Ending, Trial};
use super::super::protocol::{Entry, Event, State, conduct};
use super::super::tables::name;
use super::super::theatre::Showing;
use super::books::Participation;
use super::desk::Desk;
use super::request::{Arrival, Arrived, Failure, Trouble, Turn};
use super::{links, secret};
use crate::study::file::Front;
use rusqlite::params;

impl Desk {
    /// Lets a participant in. One whom the platform has sent before goes on where they were.
    pub(super) fn arrive(&mut self, arrival: &Arrival) -> Result<Arrived, Trouble> {
        let external = arrival.platform.as_ref().map(|id| secret::keyed_hash(&self.key, &id.participant));
        if let Some(hash) = &external {
            if let Some(&id) = self.books.by_external.get(hash) {
                return Ok(Arrived { token: self.issue(id)?, turn: self.sign(id)? });
            }
            if self.is_gone(hash)? {
                return Err(Trouble::Gone);
            }
        }
        if self.books.is_closed {
            return Err(Trouble::Closed);
        }
        let version = self.current().ok_or(Trouble::Closed)?;
        let (code, person) =
            (secret::code().map_err(Failure::from)?, secret::number().map_err(Failure::from)?);
        let at = self.clock.now();
        let one = Participation::new(&version, code.clone(), arrival, person, at);
        self.begin()?;
        let mut insert = self.connection.prepare_cached(
            "INSERT INTO participant (version, code, external_hash, front, language, person, arrived, state, changed) \
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?7)",
        )?;
        let front = name(&arrival.front);
        // the numbers that stand for a person are below 2^63
        let bits = i64::try_from(person).unwrap_or(i64::MAX);
        let state = one.state.name();
        let id = insert.insert(params![
            version.number,
            code,
            external,
            front,
            arrival.language,
            bits,
            at,
            state
        ])?;
        drop(insert);
        if let Some(platform) = &arrival.platform {
            links::write(&self.connection, id, platform, at)?;
        }
        self.books.by_code.insert(code, id);
        self.books.people.insert(id, one);
        if let Some(hash) = external {
            self.books.by_external.insert(hash, id);
        }
        Ok(Arrived { token: self.issue(id)?, turn: self.turn(id)? })
    }

    /// Lets a participant go on where they began: in another browser, or in a headset.
    pub(super) fn resume(&mut self, code: &str, front: Front) -> Result<Arrived, Trouble> {
        let id = *self.books.by_code.get(&secret::normal(code)).ok_or(Trouble::Unknown)?;
        let began = self.books.people.get(&id).map_or(front, |one| one.front);
        if began != front {
            return Err(Trouble::Elsewhere(match began {
                Front::Headset => "in a headset",
                Front::Web => "in a browser",
                Front::Simulated => "as a simulated participant",
            }));
        }
        Ok(Arrived { token: self.issue(id)?, turn: self.sign(id)? })
    }

    /// The participant of a browser.
    pub(super) fn known(&self, token: &str) -> Result<i64, Trouble> {
        let hash = secret::hash(token.as_bytes());
        self.books.by_token.get(&hash).copied().ok_or(Trouble::Unknown)
    }

    /// The id by which the platform knows the participant of a secret.
    pub(super) fn platform_id(&self, token: &str) -> Result<Option<String>, Trouble> {
        Ok(links::read(&self.connection, self.known(token)?)?)
    }

    /// The page of a participant who is there: a lease that had lapsed begins again.
    pub(super) fn sign(&mut self, id: i64) -> Result<Turn, Trouble> {
        let one = self.books.people.get(&id).ok_or(Trouble::Unknown)?;
        match one.session.state() {
            // a place may have become free since, and one that is back gets a page
            State::Lapsed | State::Ended(Ending::Full) => self.conduct(id, None),
            _ => self.turn(id),
        }
    }

    /// Where a participant is.
    pub(super) fn turn(&self, id: i64) -> Result<Turn, Trouble> {
        let one = self.books.people.get(&id).ok_or(Trouble::Unknown)?;
        let version = self.version(one.version).ok_or(Trouble::Unknown)?;
        Ok(Turn {
            participant: id,
            code: one.code.clone(),
            language: one.language.clone(),
            version: one.version,
            state: one.session.state(),
            page: one.session.page(&version.plan),
        })
    }

    /// What the current trial of a participant shows, and the one after it in the same part.
    pub(super) fn showing(&self, id: i64) -> Result<[Option<Showing>; 2], Trouble> {
        let one = self.books.people.get(&id).ok_or(Trouble::Unknown)?;
        let version = self.version(one.version).ok_or(Trouble::Unknown)?;
        let showing = |trial: &Trial| Showing {
            trial: trial.clone(),
            stimulus: one.session.stimulus(&version.plan, trial).cloned(),
        };
        Ok([one.session.trial().map(|(trial, _)| trial), one.session.next_trial()]
            .map(|trial| trial.map(showing)))
    }

    /// Takes an event of a participant, or of nothing but the time, and writes what follows from it.
    pub(super) fn conduct(&mut self, id: i64, event: Option<Event>) -> Result<Turn, Trouble> {
        let at = self.clock.now();
        let one = self.books.people.get_mut(&id).ok_or(Trouble::Unknown)?;
        let number = one.version;
        let version =
            self.versions.iter().find(|version| version.number == number).ok_or(Trouble::Unknown)?;
        let ledger = self.books.ledgers.get_mut(&number).ok_or(Trouble::Unknown)?;
        let withdraws = matches!(event, Some(Event::Withdrawn));
        // a sign of life without a page changes nothing by itself; what the store owes the session follows from it
        let event = event.unwrap_or_else(|| Event::Sign { page: String::new(), kind: "seen".to_owned() });
        let happened = conduct(&version.plan, ledger, &mut one.session, Entry { at, event })?;
        let is_withdrawn = withdraws && !happened.is_empty();
        self.write(id, &happened)?;
        if is_withdrawn {
            self.forget(id)?;
        }
        self.turn(id)
    }
}
