//! The protocol: one participant at a store in memory.

mod pages;
mod returns;

use gaitway::study::file::Front;
use gaitway::study::plan::{Ending, Ledger, Plan, Scale};
use gaitway::study::protocol::{
    Answer, Content, Entry, Event, Exposure, Page, Refusal, Session, State, conduct, page,
};

/// One participant at a store in memory.
pub(super) struct Table<'p> {
    pub(super) plan: &'p Plan,
    pub(super) ledger: Ledger,
    pub(super) session: Session,
    pub(super) log: Vec<Entry>,
    pub(super) now: i64,
    pub(super) keys: u32,
}

impl<'p> Table<'p> {
    pub(super) fn new(plan: &'p Plan, person: u64) -> Self {
        let mut table = Self {
            plan,
            ledger: Ledger::new(plan),
            session: Session::new(plan),
            log: Vec::new(),
            now: 1_000,
            keys: 0,
        };
        table.send(Event::Arrived { person, front: Front::Web, language: "en".to_owned() }).unwrap();
        table
    }

    pub(super) fn page(&self) -> Page {
        self.session.page(self.plan)
    }

    pub(super) fn send(&mut self, event: Event) -> Result<Vec<Entry>, Refusal> {
        self.now += 1_000;
        let entry = Entry { at: self.now, event };
        let entries = conduct(self.plan, &mut self.ledger, &mut self.session, entry)?;
        self.log.extend(entries.iter().cloned());
        // resuming is replaying: the page comes from what is stored, and from nothing else
        assert_eq!(page(self.plan, &self.log), self.page());
        let stored = serde_json::to_string(&self.log).unwrap();
        assert_eq!(serde_json::from_str::<Vec<Entry>>(&stored).unwrap(), self.log);
        Ok(entries)
    }

    pub(super) fn answer(&mut self, question: &str, value: i64) -> Result<Vec<Entry>, Refusal> {
        self.keys += 1;
        let answer = Answer {
            page: self.page().id,
            question: question.to_owned(),
            value: Some(value),
            text: None,
            first_ms: 900,
            ms: 900,
            key: self.keys.to_string(),
        };
        self.send(Event::Answer(answer))
    }

    pub(super) fn next(&mut self) -> Result<Vec<Entry>, Refusal> {
        self.send(Event::Next { page: self.page().id })
    }

    pub(super) fn shown(&mut self) {
        let page = self.page().id;
        self.send(Event::Shown { page, exposure: Exposure::default() }).unwrap();
    }

    /// Answers a page rightly and goes on.
    pub(super) fn pass(&mut self) {
        match self.page().content {
            Content::Consent { .. } => drop(self.send(Event::Consented { text: "hash".to_owned() }).unwrap()),
            Content::Show { .. } => self.shown(),
            Content::Check { ref questions, .. } => {
                for (question, right) in questions.iter().zip([0, 1]) {
                    self.answer(&question.id, right).unwrap();
                }
                self.next().unwrap();
            }
            ref content => {
                for question in content.questions() {
                    match &question.scale {
                        Scale::Points { least, .. } | Scale::Number { least, .. } => {
                            self.answer(&question.id, *least).unwrap();
                        }
                        Scale::Options { options } => drop(self.answer(&question.id, options[0].0).unwrap()),
                        Scale::Text { .. } => {}
                    }
                }
                self.next().unwrap();
            }
        }
    }

    pub(super) fn until(&mut self, page: &str) {
        for _ in 0..500 {
            if self.page().id == page {
                return;
            }
            self.pass();
        }
        panic!("never at {page}");
    }

    pub(super) fn ending(&self) -> Option<Ending> {
        match self.session.state() {
            State::Ended(ending) => Some(ending),
            _ => None,
        }
    }
}

pub(super) fn walk_plan() -> Plan {
    crate::plan("eva-gaits", 342)
}
