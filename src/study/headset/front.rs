//! The front: page after page on one stage, until the participation has ended.

use super::panels::{self, BACK, NEXT};
use super::parties::{Operator, Order, Participation, Typed};
use super::watch::{Ahead, Beside};
use crate::library::GaitLibrary;
use crate::scenario::{Scenario, User};
use crate::scene::Scene;
use crate::study::protocol::{Answer, Content, Event, Exposure, Page, PageQuestion};
use crate::study::theatre::{Showing, Theatre};
use crate::xr::{Choice, Outcome, Panel, Plan, RecordedSession, Recorder, Stage, TrialLabel, World};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::PathBuf;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// How long a fade is waited for, s.
const FADED: f64 = 0.4;
/// How long it takes to look again whether something has changed, s.
const LOOK: f64 = 0.1;
/// Most names of recordings of one trial.
const MOST_REPEATS: u32 = 100;

/// What the front has to know beside the pages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setup {
    /// Name of the study, for the recordings.
    pub study: String,
    /// The participant's code.
    pub participant: String,
    /// Folder of the participant's recordings.
    pub recordings: PathBuf,
    /// Answers from which on the operator reads a warning, by question or group of questions.
    pub stop_at: BTreeMap<String, i64>,
}

/// Shows a participation.
pub struct Front<'a> {
    stage: Stage,
    participation: &'a mut dyn Participation,
    beside: Beside<'a>,
    theatre: Theatre,
    setup: Setup,
    ahead: Option<Ahead>,
    /// Answers given so far, for their keys.
    answers: u64,
}

impl std::fmt::Debug for Front<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Front").field("setup", &self.setup).finish_non_exhaustive()
    }
}

/// Why a page was not finished.
enum Cut {
    /// The session with the headset is over, or the operator has ended it.
    Over,
    /// The operator wants something of the current trial.
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
        let beside = Beside::new(operator);
        Ok(Self { stage, participation, beside, theatre, setup, ahead: None, answers: 0 })
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
            let next = match page.content.clone() {
                Content::Consent { text, minimum_age } => Some(self.consent(&text, minimum_age)?),
                Content::Text { text } => self.read(&page, &text)?,
                Content::Form { questions } | Content::Check { questions, .. } => {
                    self.questions(&page, &questions, None)?
                }
                Content::Ask { questions, instruction, .. } => {
                    self.look_ahead()?;
                    self.questions(&page, &questions, instruction.as_deref())?
                }
                Content::Show { seconds, plays, .. } => {
                    self.trial(&page, seconds * f64::from(plays.max(1)))?
                }
                Content::Rest => {
                    self.read(&page, "Please rest for a moment. You may take the headset off.")?
                }
                Content::Ended { ending, .. } => {
                    let end = Panel { question: panels::farewell(ending).to_owned(), ..Panel::default() };
                    self.stage.tell(&end)?;
                    self.stage.rest(4.0, &mut self.beside);
                    return Ok(());
                }
                // the store owes the next page, or the operator has paused
                Content::Paused | Content::Place | Content::Lapsed | Content::Broken => {
                    self.stage.rest(LOOK, &mut self.beside);
                    Some(self.participation.page()?)
                }
            };
            match next {
                Some(next) => page = next,
                None => return Ok(()),
            }
        }
        Ok(())
    }

    fn consent(&mut self, text: &str, minimum_age: u32) -> Result<Page, crate::Error> {
        let event = match self.beside.operator().agreed(text, minimum_age) {
            Some(text) => Event::Consented { text },
            None => Event::Declined,
        };
        self.participation.submit(event)
    }

    /// Shows a text, panel by panel. None: the session is over.
    fn read(&mut self, page: &Page, text: &str) -> Result<Option<Page>, crate::Error> {
        let texts = panels::texts(text);
        let mut at = 0;
        while let Some(text) = texts.get(at) {
            match self.ask(&panels::text(text, at > 0))? {
                Ok((Choice::Back, _)) => at -= 1,
                Ok(_) => at += 1,
                Err(Cut::Order(_)) => {}
                Err(Cut::Over) => return Ok(None),
            }
        }
        Ok(Some(self.participation.submit(Event::Next { page: page.id.clone() })?))
    }

    /// Asks the questions of a page, one at a time. None: the session is over.
    fn questions(
        &mut self,
        page: &Page,
        questions: &[PageQuestion],
        instruction: Option<&str>,
    ) -> Result<Option<Page>, crate::Error> {
        let mut given: Vec<Given> = vec![Given::default(); questions.len()];
        let mut at = 0;
        while let Some(question) = questions.get(at) {
            let mut panel = panels::question(page, question, [at, questions.len()], given[at].value);
            if let Some(instruction) = instruction {
                panel.question = format!("{instruction}\n{}", panel.question);
            }
            if panels::cells(question).is_none() {
                match self.spoken(page, question, &panel, &mut given[at])? {
                    Ok(Choice::Back) => at -= 1,
                    Ok(_) => at += 1,
                    Err(Cut::Order(_)) => {}
                    Err(Cut::Over) => return Ok(None),
                }
                continue;
            }
            match self.ask(&panel)? {
                Ok((Choice::Cell(cell), seconds)) => {
                    let value = panels::cells(question).and_then(|cells| cells.get(cell).map(|cell| cell.1));
                    given[at].add(seconds, value);
                    self.answer(page, question, &given[at], None)?;
                }
                Ok((Choice::Back, seconds)) => {
                    given[at].seconds += seconds;
                    at -= 1;
                }
                Ok((Choice::Next, _)) => at += 1,
                Err(Cut::Order(_)) => {}
                Err(Cut::Over) => return Ok(None),
            }
            self.look_ahead()?;
        }
        Ok(Some(self.participation.submit(Event::Next { page: page.id.clone() })?))
    }

    /// A question whose answer the participant says and the operator types.
    fn spoken(
        &mut self,
        page: &Page,
        question: &PageQuestion,
        panel: &Panel,
        given: &mut Given,
    ) -> Result<Result<Choice, Cut>, crate::Error> {
        let spoken = Panel {
            title: "Please say your answer aloud".to_owned(),
            cells: Vec::new(),
            back: panel.back.as_ref().map(|_| BACK.to_owned()),
            next: question.optional.then(|| NEXT.to_owned()),
            ..panel.clone()
        };
        self.beside.wait_for(question);
        let begin = std::time::Instant::now();
        let asked = self.ask(&spoken)?;
        let (value, text) = match self.beside.take_typed() {
            None => return Ok(asked.map(|(choice, _)| choice)),
            Some(Typed::Number(value)) => (Some(value), None),
            Some(Typed::Text(text)) => (None, Some(text)),
            Some(Typed::LeftOut) if question.optional => return Ok(Ok(Choice::Next)),
            Some(Typed::LeftOut | Typed::Waiting) => return Ok(Err(Cut::Order(Order::Repeat))),
        };
        given.add(begin.elapsed().as_secs_f64(), value);
        self.answer(page, question, given, text)?;
        Ok(Ok(Choice::Next))
    }

    /// Stores an answer.
    fn answer(
        &mut self,
        page: &Page,
        question: &PageQuestion,
        given: &Given,
        text: Option<String>,
    ) -> Result<(), crate::Error> {
        self.answers += 1;
        let answer = Answer {
            page: page.id.clone(),
            question: question.id.clone(),
            value: given.value,
            text,
            first_ms: given.first.map_or(0, ms),
            ms: ms(given.seconds),
            key: format!("{:x}-{}", now().unsigned_abs(), self.answers),
        };
        self.participation.submit(Event::Answer(answer))?;
        let group = question.id.split('.').next().unwrap_or_default();
        let stop = self.setup.stop_at.get(&question.id).or_else(|| self.setup.stop_at.get(group));
        if let Some((stop, value)) = stop.zip(given.value).filter(|(stop, value)| value >= stop) {
            let line = format!("{} is {value}, which is {stop} or more: ask whether to end", question.id);
            self.beside.operator().note(&line);
        }
        Ok(())
    }

    /// Shows a panel and waits for a choice, and the seconds until it.
    fn ask(&mut self, panel: &Panel) -> Result<Result<(Choice, f64), Cut>, crate::Error> {
        let answered = self.stage.ask(panel, &mut self.beside)?;
        Ok(match answered {
            Some(answered) => Ok((answered.choice, answered.seconds)),
            // what the operator typed stands for the choice
            None if self.beside.has_typed() => Ok((Choice::Next, 0.0)),
            None => Err(self.cut()),
        })
    }

    /// Why something was cut.
    fn cut(&mut self) -> Cut {
        match self.beside.take_order() {
            Some(order) if order != Order::End && !self.stage.is_over() => Cut::Order(order),
            _ => Cut::Over,
        }
    }

    /// Shows a trial. None: the session is over.
    fn trial(&mut self, page: &Page, seconds: f64) -> Result<Option<Page>, crate::Error> {
        let Some(showing) = self.participation.trial()? else {
            return Ok(Some(self.participation.page()?));
        };
        loop {
            let started = now();
            match self.show(&showing, seconds)? {
                Ok(exposure) => {
                    let (page, exposure) = (page.id.clone(), Exposure { started, ..exposure });
                    return Ok(Some(self.participation.submit(Event::Shown { page, exposure })?));
                }
                Err(Cut::Order(Order::Repeat)) => {}
                Err(Cut::Order(_)) => {
                    let (page, reason) = (page.id.clone(), "skipped by the operator".to_owned());
                    return Ok(Some(self.participation.submit(Event::Fault { page, reason })?));
                }
                Err(Cut::Over) => return Ok(None),
            }
        }
    }

    /// Shows a trial's world out of the grey and back into it, and records it.
    fn show(&mut self, showing: &Showing, seconds: f64) -> Result<Result<Exposure, Cut>, crate::Error> {
        let Some((scene, mut world)) = self.world(showing)? else { return Ok(Err(self.cut())) };
        if !self.stage.show(&world, &mut self.beside)? {
            return Ok(Err(self.cut()));
        }
        self.stage.fade(0.0);
        self.beside.record(self.recorder(showing, &scene, &mut world)?);
        let walked = self.stage.walk(&mut world, seconds, &mut self.beside)?;
        self.stage.fade(1.0);
        if let Some(recorder) = self.beside.take_recorder() {
            recorder.finish(world.simulation().state()?).map_err(|error| of_recording(&error))?;
        }
        if !walked.is_whole {
            return Ok(Err(self.cut()));
        }
        self.stage.walk(&mut world, FADED, &mut self.beside)?;
        let frames = walked.frames;
        let count = |frames: u64| u32::try_from(frames).unwrap_or(u32::MAX);
        Ok(Ok(Exposure {
            started: 0,
            seconds_visible: walked.seconds,
            plays: 1,
            frames: count(frames.drawn),
            late_frames: count(frames.missed),
            longest_ms: f64::from(frames.longest_ms),
        }))
    }

    /// The world of a trial, ready to be seen: made ahead, or now. None: the session is over, or the operator wants something.
    fn world(&mut self, showing: &Showing) -> Result<Option<(Scene, World)>, crate::Error> {
        if self.ahead.as_ref().is_none_or(|ahead| !ahead.is_of(showing)) {
            self.ahead = Some(Ahead::begin(&self.theatre, showing.clone())?);
        }
        let wait = Panel { question: "One moment, please.".to_owned(), ..Panel::default() };
        let mut waits = 0;
        while !self.look_at_ahead()? {
            waits += 1;
            if waits == 10 {
                self.stage.tell(&wait)?;
            }
            if !self.stage.rest(LOOK, &mut self.beside) {
                return Ok(None);
            }
        }
        Ok(self.ahead.take().and_then(Ahead::world))
    }

    /// Begins to make the next trial's world, and brings it to the headset's device.
    fn look_ahead(&mut self) -> Result<(), crate::Error> {
        if self.ahead.is_none()
            && let Some(next) = self.participation.next_trial()?.filter(|next| next.stimulus.is_some())
        {
            self.ahead = Some(Ahead::begin(&self.theatre, next)?);
        }
        self.look_at_ahead().map(drop)
    }

    /// Whether the next world can be seen at once.
    fn look_at_ahead(&mut self) -> Result<bool, crate::Error> {
        let Some(ahead) = &mut self.ahead else { return Ok(false) };
        let Some(world) = ahead.look()? else { return Ok(false) };
        self.stage.prepare(world);
        Ok(self.stage.is_ready(world))
    }

    /// A new recording of a trial. One that broke off is kept, and complete ones are.
    fn recorder(
        &self,
        showing: &Showing,
        scene: &Scene,
        world: &mut World,
    ) -> Result<Recorder<File>, crate::Error> {
        let label = TrialLabel {
            study: self.setup.study.clone(),
            participant: self.setup.participant.clone(),
            trial: showing.trial.position,
        };
        let of = RecordedSession::of(scene, &self.theatre.library, world.simulation().state()?);
        let session = RecordedSession { trial: Some(label), ..of };
        let name = format!("{}-{}", showing.trial.part, showing.trial.position);
        let mut last = None;
        for repeat in 1..=MOST_REPEATS {
            let again = if repeat > 1 { format!("-{repeat}") } else { String::new() };
            match crate::xr::make_way(&self.setup.recordings.join(format!("{name}{again}.csv"))) {
                Ok(way) => return Recorder::new(way.file, &session).map_err(|error| of_recording(&error)),
                Err(error @ crate::xr::RecordingError::Taken(_)) => last = Some(error),
                Err(error) => return Err(of_recording(&error)),
            }
        }
        Err(of_recording(&last.unwrap_or(crate::xr::RecordingError::Taken("there are too many recordings"))))
    }
}

/// The answer to one question so far.
#[derive(Debug, Clone, Copy, Default)]
struct Given {
    value: Option<i64>,
    /// When it was answered first, s after it was seen.
    first: Option<f64>,
    /// How long it was seen until the last answer, s.
    seconds: f64,
}

impl Given {
    /// Adds an answer after so many more seconds.
    fn add(&mut self, seconds: f64, value: Option<i64>) {
        self.seconds += seconds;
        self.first.get_or_insert(self.seconds);
        self.value = value;
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time of answering")]
fn ms(seconds: f64) -> u32 {
    (seconds * 1e3).round().clamp(0.0, f64::from(u32::MAX)) as u32
}

/// UTC ms.
fn now() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
    i64::try_from(since.as_millis()).unwrap_or(i64::MAX)
}

fn of_recording(error: &crate::xr::RecordingError) -> crate::Error {
    crate::Error::Usage {
        message: error.to_string(),
        hint: "make room on the disk, or choose a folder that can be written to".to_owned(),
    }
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
