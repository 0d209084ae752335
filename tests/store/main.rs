//! The store of a study: what was answered well is on the disk, and everything is rebuilt from there.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test")]

mod failures;
mod headset;
mod upkeep;
mod whole;

use gaitway::study::file::Front;
use gaitway::study::plan::Scale;
use gaitway::study::protocol::{Answer, Content, Event, Exposure, Page};
use gaitway::study::store::{Arrival, Opening, PlatformId, Store, Trouble, Turn, wait};
use gaitway::study::{Materials, Study};
use std::collections::BTreeMap;
use std::path::Path;

/// A study with a library of so many walks; `change` edits its file.
fn opening(walks: usize, change: impl Fn(String) -> String) -> Opening {
    let text = change(Study::builtin("eva-gaits").unwrap().text);
    let names = (1..=walks).map(|number| format!("walk {number}")).collect();
    let materials = Materials::default()
        .with_gaits("library.glb", names)
        .with_text("consent.en.md", "# Consent\n\nDo you agree?");
    Opening {
        study: Study::parse(&text, "a test").unwrap(),
        materials,
        libraries: BTreeMap::new(),
        rows: None,
    }
}

fn open(folder: &Path, walks: usize) -> Store {
    Store::open(folder, &opening(walks, |text| text)).unwrap()
}

/// A participant at a store.
struct Person {
    token: String,
    turn: Turn,
    keys: u32,
}

impl Person {
    fn come(store: &Store, platform: Option<&str>) -> Result<Self, Trouble> {
        let platform =
            platform.map(|id| PlatformId { participant: id.to_owned(), submission: "s1".to_owned() });
        Self::arrive(store, Arrival { front: Front::Web, language: "en".to_owned(), platform })
    }

    /// A new participant in a headset.
    fn come_to_headset(store: &Store) -> Self {
        let arrival = Arrival { front: Front::Headset, language: "en".to_owned(), platform: None };
        Self::arrive(store, arrival).unwrap()
    }

    fn arrive(store: &Store, arrival: Arrival) -> Result<Self, Trouble> {
        let arrived = wait(|then| store.arrive(arrival, then))?;
        Ok(Self { token: arrived.token, turn: arrived.turn, keys: 0 })
    }

    fn send(&mut self, store: &Store, event: Event) -> Result<(), Trouble> {
        self.turn = wait(|then| store.submit(&self.token, event, then))?;
        Ok(())
    }

    fn page(&self) -> &Page {
        &self.turn.page
    }

    /// The events that answer the current page rightly.
    fn events(&mut self) -> Vec<Event> {
        let page = self.turn.page.id.clone();
        let next = Event::Next { page: page.clone() };
        let questions = match &self.turn.page.content {
            Content::Consent { .. } => return vec![Event::Consented { text: "hash".to_owned() }],
            Content::Show { .. } => {
                let exposure = Exposure { plays: 1, frames: 240, late_frames: 3, ..Exposure::default() };
                return vec![Event::Shown { page, exposure }];
            }
            content => content.questions().to_vec(),
        };
        let instructed = matches!(&self.turn.page.content, Content::Ask { instruction: Some(_), .. });
        let mut events: Vec<Event> = Vec::new();
        for question in questions {
            self.keys += 1;
            let (value, text) = match &question.scale {
                // which answer is wanted does not matter here
                Scale::Points { least, .. } => (Some(least + i64::from(instructed)), None),
                // the right answers of the built-in study
                Scale::Options { options } if question.id == "question-1" => (Some(options[0].0), None),
                Scale::Options { options } => (Some(options[options.len() - 1].0), None),
                Scale::Number { least, .. } => (Some(*least), None),
                Scale::Text { .. } => (None, Some("=fine".to_owned())),
            };
            let (first_ms, ms, key) = (800, 900, format!("k{}", self.keys));
            let page = page.clone();
            events.push(Event::Answer(Answer {
                page,
                question: question.id,
                value,
                text,
                first_ms,
                ms,
                key,
            }));
        }
        events.push(next);
        events
    }

    /// Goes on for so many pages, or to the end.
    fn go_on(&mut self, store: &Store, pages: usize) -> Result<(), Trouble> {
        for _ in 0..pages {
            if matches!(self.turn.page.content, Content::Ended { .. }) {
                break;
            }
            for event in self.events() {
                self.send(store, event)?;
            }
        }
        Ok(())
    }

    /// Goes on to a page.
    fn go_to_page(&mut self, store: &Store, page: &str) {
        while self.page().id != page {
            self.go_on(store, 1).unwrap();
        }
    }

    /// Goes on to the first page of a part.
    fn go_to(&mut self, store: &Store, part: &str) {
        while self.page().part != part {
            self.go_on(store, 1).unwrap();
        }
    }
}
