//! The front: page after page on one stage, until the participation has ended.

use super::panels;
use super::parties::{Operator, Participation};
use super::watch::{Ahead, Beside};
use super::words::Phrases;
use crate::library::GaitLibrary;
use crate::scenario::{Scenario, User};
use crate::scene::Scene;
use crate::study::lab::Order;
use crate::study::protocol::{Content, Event, Page};
use crate::study::theatre::Theatre;
use crate::xr::{Choice, Outcome, Panel, Plan, Stage, World};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// How long it takes to look again whether something has changed, s.
pub(super) const LOOK: f64 = 0.1;
/// How long the last panel stands, s.
const FAREWELL: f64 = 4.0;

/// What the front has to know beside the pages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setup {
    /// Name of the study, for the recordings.
    pub study: String,
    /// The participant's code.
    pub participant: String,
    /// Language of the panels (BCP 47); English where there are no words in it.
    pub language: String,
    /// Folder of the participant's recordings.
    pub recordings: PathBuf,
    /// Answers from which on the operator reads a warning, by question or group of questions.
    pub stop_at: BTreeMap<String, i64>,
}

/// Shows a participation.
pub struct Front<'a> {
    pub(super) stage: Stage,
    pub(super) participation: &'a mut dyn Participation,
    pub(super) beside: Beside<'a>,
    pub(super) theatre: Theatre,
    pub(super) setup: Setup,
    pub(super) words: Phrases,
    pub(super) ahead: Option<Ahead>,
    /// Answers given so far, for their keys.
    pub(super) answers: u64,
}

impl std::fmt::Debug for Front<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Front").field("setup", &self.setup).finish_non_exhaustive()
    }
}

/// Why a page was not finished.
pub(super) enum Cut {
    /// The session with the headset is over, or the operator has ended it.
    Over,
    /// The operator wants something.
    Order(Order),
}

impl<'a> Front<'a> {
    /// Begins a session in a grey room. Sticks move no participant: they walk in their room.
    ///
    /// # Errors
    /// When the room cannot be made, or there is no thread for the headset.
    pub fn open(
        plan: Plan,
        participation: &'a mut dyn Participation,
        operator: &'a mut dyn Operator,
        theatre: Theatre,
        setup: Setup,
    ) -> Result<Self, crate::Error> {
        let room = World::new(&room()?)?;
        let mut stage = Stage::open(&room, Plan { moves: false, ..plan })?;
        stage.fade(1.0);
        let (beside, words) = (Beside::new(operator), Phrases::of(&setup.language));
        Ok(Self { stage, participation, beside, theatre, setup, words, ahead: None, answers: 0 })
    }

    /// Shows page after page until the participation has ended, the session is over or the operator ends it.
    ///
    /// # Errors
    /// When the store, the headset, a scene or a recording fails. What was answered is stored.
    pub fn run(mut self) -> Result<Outcome, crate::Error> {
        let shown = self.pages();
        let outcome = self.stage.close(&mut self.beside);
        shown?;
        outcome
    }

    fn pages(&mut self) -> Result<(), crate::Error> {
        let mut page = self.participation.page()?;
        while !self.stage.is_over() {
            if let Content::Ended { ending, .. } = page.content {
                self.say_farewell(&panels::farewell(&self.words, ending).clone())?;
                return Ok(());
            }
            match self.page(&page)? {
                Some(next) => page = next,
                None if self.stage.is_over() => return Ok(()),
                None => return self.say_farewell(&self.words.ended.clone()),
            }
        }
        Ok(())
    }

    /// Shows a page. Returns the next one; none if the session is over.
    fn page(&mut self, page: &Page) -> Result<Option<Page>, crate::Error> {
        match &page.content {
            Content::Consent { text, minimum_age } => self.consent(text, *minimum_age),
            Content::Text { text } => self.read(page, text),
            Content::Form { questions } | Content::Check { questions, .. } => {
                self.questions(page, questions, None)
            }
            Content::Ask { questions, instruction, .. } => {
                self.look_ahead()?;
                self.questions(page, questions, instruction.as_deref())
            }
            Content::Show { seconds, plays, .. } => self.trial(page, seconds * f64::from((*plays).max(1))),
            Content::Rest => self.read(page, &self.words.rest.clone()),
            Content::Paused => self.wait(page, &self.words.paused.clone()),
            // the store owes the next page
            Content::Place | Content::Lapsed | Content::Broken | Content::Ended { .. } => {
                self.wait(page, &self.words.wait.clone())
            }
        }
    }

    /// A panel until the headset is off.
    fn say_farewell(&mut self, text: &str) -> Result<(), crate::Error> {
        self.stage.blank();
        self.stage.tell(&panels::notice(text))?;
        self.beside.take_order();
        self.stage.rest(FAREWELL, &mut self.beside);
        Ok(())
    }

    /// Waits with a notice until there is another page than this one. None: the session is over.
    fn wait(&mut self, page: &Page, text: &str) -> Result<Option<Page>, crate::Error> {
        self.stage.tell(&panels::notice(text))?;
        loop {
            if !self.stage.rest(LOOK, &mut self.beside)
                && let Cut::Over = self.cut()
            {
                return Ok(None);
            }
            let next = self.participation.page()?;
            if next != *page {
                return Ok(Some(next));
            }
        }
    }

    /// Waits until the operator says whether the participant agrees. None: the session is over.
    fn consent(&mut self, name: &str, minimum_age: u32) -> Result<Option<Page>, crate::Error> {
        let consent = self.participation.consent(name)?;
        self.stage.tell(&panels::notice(&self.words.consent))?;
        loop {
            let event = match self.beside.operator().agreed(&consent.text, minimum_age) {
                Some(true) => Event::Consented { text: consent.hash },
                Some(false) => Event::Declined,
                None if self.stage.rest(LOOK, &mut self.beside) => continue,
                None => match self.cut() {
                    Cut::Over => return Ok(None),
                    Cut::Order(Order::Look) => return self.participation.page().map(Some),
                    Cut::Order(order) => {
                        self.refuse(order);
                        continue;
                    }
                },
            };
            return self.participation.submit(event).map(Some);
        }
    }

    /// Shows a text, panel by panel. None: the session is over.
    fn read(&mut self, page: &Page, text: &str) -> Result<Option<Page>, crate::Error> {
        let texts = panels::texts(text);
        let mut at = 0;
        while let Some(text) = texts.get(at) {
            match self.ask(&panels::text(&self.words, text, at > 0))? {
                Ok((Choice::Back, _)) => at -= 1,
                Ok(_) => at += 1,
                Err(Cut::Over) => return Ok(None),
                Err(Cut::Order(Order::Look)) => return self.participation.page().map(Some),
                Err(Cut::Order(order)) => self.refuse(order),
            }
        }
        self.participation.submit(Event::Next { page: page.id.clone() }).map(Some)
    }

    /// Tells the operator that there is no trial now.
    pub(super) fn refuse(&mut self, order: Order) {
        let what = if order == Order::Repeat { "repeat" } else { "skip" };
        self.beside.operator().note(&format!("there is no trial to {what} now"));
    }

    /// Shows a panel and waits for a choice, and the seconds until it.
    pub(super) fn ask(&mut self, panel: &Panel) -> Result<Result<(Choice, f64), Cut>, crate::Error> {
        let answered = self.stage.ask(panel, &mut self.beside)?;
        Ok(match answered {
            Some(answered) => Ok((answered.choice, answered.seconds)),
            None => Err(self.cut()),
        })
    }

    /// Why something was cut.
    pub(super) fn cut(&mut self) -> Cut {
        match self.beside.take_order() {
            Some(order) if order != Order::End && !self.stage.is_over() => Cut::Order(order),
            _ => Cut::Over,
        }
    }
}

/// UTC ms.
pub(super) fn now() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
    i64::try_from(since.as_millis()).unwrap_or(i64::MAX)
}

/// An empty square: the room before the first trial.
fn room() -> Result<Scene, crate::Error> {
    let half = 10.0;
    let scenario = Scenario {
        name: "room".to_owned(),
        bounds: vec![[-half, -half], [half, -half], [half, half], [-half, half]],
        user: Some(User { position: Some([0.0; 2]), ..User::default() }),
        population: crate::scenario::Population { agents: 0, ..crate::scenario::Population::default() },
        ..Scenario::default()
    };
    Scene::of(scenario).library(GaitLibrary::built_in()?).build()
}
