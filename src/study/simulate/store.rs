//! A store in memory: what a database does, without one.

use crate::study::file::Front;
use crate::study::plan::{Ledger, Plan};
use crate::study::protocol::{Entry, Event, Page, Refusal, Session, conduct, follow, lapse};
use std::collections::BTreeMap;

/// Participants, their events, and the ledger of places.
#[derive(Debug, Clone)]
pub struct Store<'p> {
    plan: &'p Plan,
    ledger: Ledger,
    people: BTreeMap<u64, (Session, Vec<Entry>)>,
}

impl<'p> Store<'p> {
    /// A store without participants.
    pub fn new(plan: &'p Plan) -> Self {
        Self { plan, ledger: Ledger::new(plan), people: BTreeMap::new() }
    }

    /// A store as its events tell it; `logs` has the events of each participant, oldest first.
    pub fn rebuilt(plan: &'p Plan, logs: impl IntoIterator<Item = (u64, Vec<Entry>)>) -> Self {
        let mut store = Self::new(plan);
        for (person, entries) in logs {
            let mut session = Session::new(plan);
            entries.iter().for_each(|entry| follow(plan, &mut store.ledger, &mut session, entry));
            store.people.insert(person, (session, entries));
        }
        store
    }

    /// The ledger of places.
    pub const fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// The participation of a person.
    pub fn session(&self, person: u64) -> Option<&Session> {
        self.people.get(&person).map(|(session, _)| session)
    }

    /// All events of each participant, oldest first.
    pub fn logs(&self) -> impl Iterator<Item = (u64, &[Entry])> {
        self.people.iter().map(|(&person, (_, entries))| (person, entries.as_slice()))
    }

    /// A new participant, or the same one again. Returns the page.
    ///
    /// # Errors
    /// As [`Store::submit`].
    pub fn arrive(&mut self, person: u64, language: &str, at: i64) -> Result<Page, Refusal> {
        let plan = self.plan;
        self.people.entry(person).or_insert_with(|| (Session::new(plan), Vec::new()));
        self.submit(
            person,
            Event::Arrived { person, front: Front::Simulated, language: language.to_owned() },
            at,
        )
    }

    /// Takes an event. Returns the page after it.
    ///
    /// # Errors
    /// [`Refusal`] for a wrong event, or a person who never arrived.
    pub fn submit(&mut self, person: u64, event: Event, at: i64) -> Result<Page, Refusal> {
        let (session, entries) = self.people.get_mut(&person).ok_or(Refusal::Over)?;
        entries.extend(conduct(self.plan, &mut self.ledger, session, Entry { at, event })?);
        Ok(session.page(self.plan))
    }

    /// Ends the leases of all participants that were silent for too long at `now`, UTC ms. Returns how many there were.
    pub fn lapse(&mut self, now: i64) -> usize {
        let mut lapsed = 0;
        for (session, entries) in self.people.values_mut() {
            if let Some(entry) = lapse(self.plan, &mut self.ledger, session, now) {
                entries.push(entry);
                lapsed += 1;
            }
        }
        lapsed
    }
}
