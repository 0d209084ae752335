//! What operators see.

use super::super::plan::Counts;
use super::super::protocol::{Event, Progress, State};
use super::books::Participation;
use super::desk::Desk;
use super::request::{Trouble, Turn};
use super::{links, secret};
use crate::study::file::{Design, Front};
use rusqlite::params;
use serde::Serialize;
use std::collections::BTreeMap;

/// Milliseconds of a day.
const DAY: i64 = 86_400_000;

/// The current version of a study at a glance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overview {
    /// Whether a new participant would get a place.
    pub is_admitting: bool,
    /// Whether the operator has closed admission.
    pub is_closed: bool,
    /// Participants of all versions by where they stand.
    pub states: BTreeMap<&'static str, usize>,
    /// Stimuli that could not be shown.
    pub faults: usize,
    /// Participants that are still needed if all stay.
    pub needs: usize,
    /// Places given so far.
    pub places: u64,
    /// Counts of every counted part, answered and leased together, by stimulus or row.
    #[serde(serialize_with = "counts")]
    pub counts: Vec<Counts>,
    /// Fewest and most answers of a stimulus in each part that is filled.
    pub answered: BTreeMap<String, (u32, u32)>,
    /// Answers that every stimulus is to have, by part.
    pub at_least: BTreeMap<String, u32>,
    /// Days until the oldest of the platform's ids is deleted; none without such ids.
    pub links_days: Option<i64>,
}

fn counts<S: serde::Serializer>(counts: &[Counts], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(counts.iter().map(|one| (&one.part, &one.counts)))
}

/// A participant, for lists.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Person {
    /// The participant's code.
    pub code: String,
    /// The version of the study.
    pub version: u32,
    /// Where the participant takes part.
    pub front: Front,
    /// Where the participation stands.
    pub state: State,
    /// The current page.
    pub page: String,
    /// The part that it belongs to.
    pub part: String,
    /// How far the participant is in the trials of the part.
    pub progress: Option<Progress>,
    /// Since the last sign of life, ms.
    pub silent_ms: i64,
    /// Frames shown.
    pub frames: u64,
    /// Frames shown late.
    pub late_frames: u64,
    /// Why the operator has excluded the participant.
    pub reason: String,
}

/// What an operator does with a participant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Act {
    /// Pauses the participation.
    Pause,
    /// Lets it go on.
    Resume,
    /// Excludes the participant, whose answers stay.
    Exclude {
        /// Why.
        reason: String,
    },
    /// Notes something.
    Note {
        /// What.
        text: String,
    },
    /// Withdraws on the participant's behalf.
    Withdraw,
}

impl Act {
    /// Its name in the audit.
    const fn name(&self) -> &'static str {
        match self {
            Self::Pause => "pause",
            Self::Resume => "resume",
            Self::Exclude { .. } => "exclude",
            Self::Note { .. } => "note",
            Self::Withdraw => "withdraw",
        }
    }
}

impl Desk {
    pub(super) fn overview(&self) -> Result<Overview, Trouble> {
        let version = self.current().ok_or(Trouble::Unknown)?;
        let plan = &version.plan;
        let ledger = self.books.ledgers.get(&version.number).ok_or(Trouble::Unknown)?;
        let mut states = BTreeMap::new();
        for one in self.books.people.values() {
            *states.entry(one.session.state().name()).or_default() += 1;
        }
        let parts = || version.study.file.parts.iter();
        let answered = parts().filter_map(|(part, _)| {
            let answered = ledger.answered(part)?;
            Some((part.clone(), (*answered.iter().min()?, *answered.iter().max()?)))
        });
        let at_least = parts().filter_map(|(part, kind)| match kind.trials()?.design {
            Some(Design::Fill { at_least, .. }) => Some((part.clone(), at_least)),
            _ => None,
        });
        let kept = i64::from(version.study.file.data.keep_links_days);
        let days = |oldest: i64| (oldest + kept * DAY - self.clock.now()).div_euclid(DAY).max(0);
        Ok(Overview {
            is_admitting: !self.books.is_closed && ledger.is_open(plan),
            is_closed: self.books.is_closed,
            states,
            faults: self.books.people.values().map(|one| one.faults).sum(),
            needs: ledger.needs(plan),
            places: ledger.places(),
            counts: ledger.counts(),
            answered: answered.collect(),
            at_least: at_least.collect(),
            links_days: links::oldest(&self.connection)?.map(days),
        })
    }

    pub(super) fn list(&self) -> Vec<Person> {
        let now = self.clock.now();
        let person = |one: &Participation| {
            let version = self.version(one.version)?;
            let page = one.session.page(&version.plan);
            let exposures = one.session.exposures().values();
            Some(Person {
                code: one.code.clone(),
                version: one.version,
                front: one.front,
                state: one.session.state(),
                page: page.id,
                part: page.part,
                progress: page.progress,
                silent_ms: (now - one.last_sign).max(0),
                frames: exposures.clone().map(|shown| u64::from(shown.frames)).sum(),
                late_frames: exposures.map(|shown| u64::from(shown.late_frames)).sum(),
                reason: one.reason.clone(),
            })
        };
        self.books.people.values().filter_map(person).collect()
    }

    /// Does something with a participant, and notes who did it.
    pub(super) fn operate(&mut self, operator: &str, code: &str, act: Act) -> Result<Turn, Trouble> {
        let id = *self.books.by_code.get(&secret::normal(code)).ok_or(Trouble::Unknown)?;
        let code = self.books.people.get(&id).map(|one| one.code.clone()).unwrap_or_default();
        self.audit(operator, act.name(), &code)?;
        let event = match act {
            Act::Pause => Event::Paused,
            Act::Resume => Event::Resumed,
            Act::Exclude { reason } => Event::Excluded { reason },
            Act::Note { text } => {
                let at = self.clock.now();
                self.begin()?;
                let sql = "INSERT INTO note VALUES (?1, ?2, ?3, ?4)";
                self.connection.prepare_cached(sql)?.execute(params![id, at, operator, text])?;
                return self.turn(id);
            }
            Act::Withdraw => Event::Withdrawn,
        };
        self.conduct(id, Some(event))
    }

    /// Notes who did what to whom.
    pub(super) fn audit(&mut self, operator: &str, what: &str, about: &str) -> Result<(), Trouble> {
        let at = self.clock.now();
        self.begin()?;
        let sql = "INSERT INTO audit VALUES (?1, ?2, ?3, ?4)";
        self.connection.prepare_cached(sql)?.execute(params![at, operator, what, about])?;
        Ok(())
    }

    pub(super) fn set_admission(&mut self, operator: &str, is_open: bool) -> Result<(), Trouble> {
        self.audit(operator, if is_open { "open admission" } else { "close admission" }, "")?;
        self.connection.execute("UPDATE secret SET is_closed = ?1", [!is_open])?;
        self.books.is_closed = !is_open;
        Ok(())
    }

    /// Ends the leases of participants that were silent for too long.
    pub(super) fn lapse(&mut self) -> rusqlite::Result<()> {
        let now = self.clock.now();
        let mut lapsed = Vec::new();
        for (&id, one) in &mut self.books.people {
            let number = one.version;
            let Some(version) = self.versions.iter().find(|version| version.number == number) else {
                continue;
            };
            let Some(ledger) = self.books.ledgers.get_mut(&number) else { continue };
            let entry = super::super::protocol::lapse(&version.plan, ledger, &mut one.session, now);
            lapsed.extend(entry.map(|entry| (id, entry)));
        }
        lapsed.into_iter().try_for_each(|(id, entry)| self.write(id, &[entry]))
    }

    /// Deletes what the study's dates say: the platform's ids, and participants with all they answered. Returns how many of each.
    pub(super) fn purge(&mut self) -> Result<(usize, usize), Trouble> {
        let now = self.clock.now();
        let data = self.current().ok_or(Trouble::Unknown)?.study.file.data;
        self.begin()?;
        let links = links::purge(&self.connection, now - i64::from(data.keep_links_days) * DAY)?;
        let before = now - i64::from(data.keep_answers_days) * DAY;
        let mut old = self.connection.prepare("SELECT code FROM participant WHERE arrived < ?1")?;
        let codes: Vec<String> = old.query_map([before], |row| row.get(0))?.collect::<Result<_, _>>()?;
        drop(old);
        // first what no row leads to afterwards
        for code in &codes {
            let failed = |error: std::io::Error| Trouble::Unavailable(error.to_string());
            self.delete_recordings(code).map_err(failed)?;
        }
        let participants = self.connection.execute("DELETE FROM participant WHERE arrived < ?1", [before])?;
        self.has_forgotten |= links + participants > 0;
        if participants > 0 {
            self.commit()?;
            self.rebuild()?;
        }
        Ok((links, participants))
    }

    /// Whether a row can be written and read.
    pub(super) fn health(&mut self) -> Result<(), Trouble> {
        let at = self.clock.now();
        self.begin()?;
        self.connection.execute("INSERT OR REPLACE INTO health VALUES (1, ?1)", [at])?;
        let found: i64 = self.connection.query_row("SELECT at FROM health", [], |row| row.get(0))?;
        if found == at { Ok(()) } else { Err(Trouble::Unavailable("a row was read back wrongly".to_owned())) }
    }
}
