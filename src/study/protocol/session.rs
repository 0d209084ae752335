//! A participation as its events tell it.

use super::event::{Answer, Entry, Event, Exposure};
use super::stops::{Stop, shows, stops};
use crate::study::file::Front;
use crate::study::plan::{Ending, Plan, Prompt, Role, Step, StepKind, Stimulus, Swap, Trial, TrialsStep};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Where a participation stands; for lists of participants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// Has not agreed yet.
    Arrived,
    /// Has agreed, and has no place yet.
    Consented,
    /// Has a place.
    Placed,
    /// Was silent for longer than the lease.
    Lapsed,
    /// The operator has paused it.
    Paused,
    /// It is over.
    #[serde(untagged)]
    Ended(Ending),
}

impl State {
    /// Its name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Arrived => "arrived",
            Self::Consented => "consented",
            Self::Placed => "placed",
            Self::Lapsed => "lapsed",
            Self::Paused => "paused",
            Self::Ended(Ending::Finished) => "finished",
            Self::Ended(Ending::Declined) => "declined",
            Self::Ended(Ending::Withdrawn) => "withdrawn",
            Self::Ended(Ending::ScreenedOut) => "screened-out",
            Self::Ended(Ending::Excluded) => "excluded",
            Self::Ended(Ending::Full) => "full",
        }
    }
}

/// The last answer to a question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Given {
    /// The number.
    pub value: Option<i64>,
    /// Free text.
    pub text: Option<String>,
    /// From the moment the question was seen to the first answer, ms.
    pub first_ms: u32,
    /// From the moment the question was seen to this answer, ms.
    pub ms: u32,
    /// When it was stored, UTC ms.
    pub at: i64,
}

/// A participation as its events tell it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Session {
    person: Option<u64>,
    front: Option<Front>,
    pub(super) language: String,
    pub(super) ending: Option<Ending>,
    pub(super) is_full: bool,
    is_paused: bool,
    has_lapsed: bool,
    is_broken: bool,
    step: usize,
    pub(super) stop: usize,
    /// Whether the current trial's stimulus was seen.
    was_shown: bool,
    /// Failed attempts at the current check.
    pub(super) failed: u32,
    placed: Option<Vec<Trial>>,
    /// The current part's trials and pages.
    pub(super) trials: Vec<Trial>,
    pub(super) stops: Vec<Stop>,
    past: BTreeSet<String>,
    keys: BTreeSet<(String, String, String)>,
    given: BTreeMap<(String, String), Given>,
    exposures: BTreeMap<String, Exposure>,
    last_sign: i64,
}

impl Session {
    /// A participation after these events, oldest first. Events that do not fit are passed over.
    pub fn replay(plan: &Plan, events: &[Entry]) -> Self {
        let mut session = Self::new(plan);
        events.iter().for_each(|entry| session.take(plan, entry));
        session
    }

    /// A participation before its first event.
    pub fn new(plan: &Plan) -> Self {
        let mut session = Self::default();
        session.enter(plan, 0);
        session
    }

    /// The random bits by which the plan draws for the participant; 0 before they arrived.
    pub fn person(&self) -> u64 {
        self.person.unwrap_or(0)
    }

    /// Where the participant takes part.
    pub const fn front(&self) -> Option<Front> {
        self.front
    }

    /// Where it stands.
    pub fn state(&self) -> State {
        match self.ending {
            Some(ending) => State::Ended(ending),
            None if self.is_full => State::Ended(Ending::Full),
            None if self.has_lapsed => State::Lapsed,
            None if self.is_paused => State::Paused,
            None if self.placed.is_some() => State::Placed,
            None if self.step > 0 => State::Consented,
            None => State::Arrived,
        }
    }

    /// The trials of all counted parts, once there is a place.
    pub fn placed(&self) -> Option<&[Trial]> {
        self.placed.as_deref()
    }

    /// The last answers, by page and question.
    pub const fn answers(&self) -> &BTreeMap<(String, String), Given> {
        &self.given
    }

    /// How stimuli were shown, by page.
    pub const fn exposures(&self) -> &BTreeMap<String, Exposure> {
        &self.exposures
    }

    /// When the lease ends unless there is a sign of life, UTC ms; none if there is no lease.
    pub fn lease_until(&self, plan: &Plan) -> Option<i64> {
        let is_leased = self.placed.is_some() && self.ending.is_none() && !self.has_lapsed && !self.is_paused;
        is_leased.then_some(self.last_sign + plan.lease_ms)
    }

    /// The current trial, and whether its stimulus was seen. The headset's front looks up here what to show.
    pub fn trial(&self) -> Option<(&Trial, bool)> {
        match self.stops.get(self.stop)? {
            Stop::Trial(index) => Some((self.trials.get(*index)?, self.was_shown)),
            _ => None,
        }
    }

    /// The trial of the current part that comes after the current one. A headset's front makes its world ready.
    pub fn next_trial(&self) -> Option<&Trial> {
        let later = self.stops.get(self.stop + 1..)?;
        later.iter().find_map(|stop| match stop {
            Stop::Trial(index) => self.trials.get(*index),
            _ => None,
        })
    }

    /// The trials of a part; none of a counted one before there is a place.
    pub fn trials_of(&self, plan: &Plan, part: &str) -> Vec<Trial> {
        match plan.trials_of(part) {
            Some(step) if step.counted => {
                let placed = self.placed.iter().flatten();
                placed.filter(|trial| trial.part == part).cloned().collect()
            }
            Some(step) => plan.fixed_trials(part, step),
            None => Vec::new(),
        }
    }

    /// What a trial shows; none for an instructed one.
    pub fn stimulus<'p>(&self, plan: &'p Plan, trial: &Trial) -> Option<&'p Stimulus> {
        let item = match trial.role {
            Role::Repeat { of } => {
                self.trials_of(plan, &trial.part).iter().find(|first| first.position == of)?.item
            }
            _ => trial.item,
        };
        plan.trials_of(&trial.part)?.stimuli.get(item? as usize)
    }

    pub(super) fn has_arrived(&self) -> bool {
        self.person.is_some()
    }

    pub(super) const fn has_lapsed(&self) -> bool {
        self.has_lapsed
    }

    pub(super) const fn is_paused(&self) -> bool {
        self.is_paused
    }

    pub(super) const fn is_broken(&self) -> bool {
        self.is_broken
    }

    pub(super) fn has_key(&self, answer: &Answer) -> bool {
        self.keys.contains(&key(answer))
    }

    pub(super) fn is_past(&self, page: &str) -> bool {
        self.past.contains(page)
    }

    pub(super) fn given(&self, page: &str, question: &str) -> Option<&Given> {
        let given = self.given.get(&(page.to_owned(), question.to_owned()))?;
        (given.value.is_some() || given.text.is_some()).then_some(given)
    }

    pub(super) fn current<'p>(&self, plan: &'p Plan) -> Option<&'p Step> {
        plan.steps.get(self.step).filter(|_| self.ending.is_none())
    }

    fn trials_step<'p>(&self, plan: &'p Plan) -> Option<&'p TrialsStep> {
        match &self.current(plan)?.kind {
            StepKind::Trials(trials) => Some(trials),
            _ => None,
        }
    }

    pub(super) fn asks_consent(&self, plan: &Plan) -> bool {
        matches!(self.current(plan), Some(Step { kind: StepKind::Consent { .. }, .. }))
    }

    pub(super) fn needs_place(&self, plan: &Plan) -> bool {
        self.placed.is_none() && self.trials_step(plan).is_some_and(|step| step.counted)
    }

    /// Whether the page is a stimulus that has not been seen.
    pub(super) fn is_showing(&self, plan: &Plan) -> bool {
        let is_unseen = |(trial, was_shown): (&Trial, bool)| shows(trial) && !was_shown;
        !self.is_broken && !self.needs_place(plan) && self.trial().is_some_and(is_unseen)
    }

    pub(super) fn ends_by_next(&self, plan: &Plan) -> bool {
        let waits = self.asks_consent(plan) || self.needs_place(plan) || self.is_showing(plan);
        !waits && !self.is_broken && self.current(plan).is_some()
    }

    /// The questions of the current page, in the order of the file.
    pub(super) fn prompts<'p>(&self, plan: &'p Plan) -> &'p [Prompt] {
        match self.current(plan).map(|step| &step.kind) {
            Some(StepKind::Form(prompts) | StepKind::Check { prompts, .. }) => prompts,
            Some(StepKind::Trials(step)) => match self.stops.get(self.stop) {
                Some(Stop::Trial(_)) if !self.is_showing(plan) && !self.is_broken => &step.prompts,
                Some(Stop::AfterBlock(_)) => &step.after_block,
                _ => &[],
            },
            _ => &[],
        }
    }

    /// The id of the current page.
    pub(super) fn page_id(&self, plan: &Plan) -> String {
        let Some(step) = self.current(plan) else { return "end".to_owned() };
        let name = &step.name;
        match (&step.kind, self.stops.get(self.stop)) {
            (StepKind::Check { .. }, _) => format!("{name}/{}", self.failed + 1),
            (StepKind::Trials(_), Some(Stop::Trial(index))) => format!("{name}/{}", index + 1),
            (StepKind::Trials(_), Some(Stop::AfterBlock(block))) => format!("{name}/after/{block}"),
            (StepKind::Trials(_), Some(Stop::Rest(block))) => format!("{name}/rest/{block}"),
            (StepKind::Trials(_), None) => format!("{name}/place"),
            _ => name.clone(),
        }
    }

    /// Applies an event that was stored. One that does not fit changes nothing.
    pub fn take(&mut self, plan: &Plan, entry: &Entry) {
        if self.judge(plan, &entry.event) != super::Verdict::Take {
            return;
        }
        // a lease begins with a place, a return and the end of a pause, too
        let begins = matches!(&entry.event, Event::Placed { .. } | Event::Returned { .. } | Event::Resumed);
        if begins || entry.event.is_sign_of_life() {
            self.last_sign = self.last_sign.max(entry.at);
        }
        match &entry.event {
            Event::Arrived { person, front, language } => {
                self.person = Some(*person);
                self.front = Some(*front);
                self.language.clone_from(language);
                // what was drawn before the participant was known is drawn again
                self.enter(plan, self.step);
            }
            Event::Consented { .. } => self.go_on(plan),
            Event::Declined => self.ending = Some(Ending::Declined),
            Event::Withdrawn => self.ending = Some(Ending::Withdrawn),
            Event::Excluded { .. } => self.ending = Some(Ending::Excluded),
            Event::Next { .. } => self.next(plan),
            Event::Answer(answer) => self.answer(answer, entry.at),
            Event::Shown { page, exposure } => {
                self.exposures.insert(page.clone(), *exposure);
                self.was_shown = true;
            }
            Event::Fault { .. } => self.is_broken = true,
            Event::Sign { .. } => {}
            Event::Placed { trials, .. } => {
                self.placed = Some(trials.clone());
                self.is_full = false;
                self.enter(plan, self.step);
            }
            Event::Full => self.is_full = true,
            Event::Lapsed => self.has_lapsed = true,
            Event::Returned { swaps } => {
                self.has_lapsed = false;
                swaps.iter().for_each(|swap| self.swap(swap));
            }
            Event::Replaced(swap) => {
                self.is_broken = false;
                self.swap(swap);
                if swap.item.is_none() {
                    self.go_on(plan);
                }
            }
            Event::Paused => self.is_paused = true,
            Event::Resumed => self.is_paused = false,
        }
    }

    fn answer(&mut self, answer: &Answer, at: i64) {
        self.keys.insert(key(answer));
        let Answer { value, text, first_ms, ms, .. } = answer.clone();
        let at_question = (answer.page.clone(), answer.question.clone());
        self.given.insert(at_question, Given { value, text, first_ms, ms, at });
    }

    /// The page is done: on to the next one, or to the next attempt.
    fn next(&mut self, plan: &Plan) {
        if let Some(Step { kind: StepKind::Check { attempts, prompts, right }, .. }) = self.current(plan) {
            let page = self.page_id(plan);
            let is_right = |(prompt, right): (&Prompt, &i64)| {
                self.given(&page, &prompt.id).and_then(|given| given.value) == Some(*right)
            };
            if !prompts.iter().zip(right).all(is_right) {
                self.past.insert(page);
                self.failed += 1;
                if self.failed >= *attempts {
                    self.ending = Some(Ending::ScreenedOut);
                }
                return;
            }
        }
        self.go_on(plan);
    }

    fn go_on(&mut self, plan: &Plan) {
        self.past.insert(self.page_id(plan));
        self.was_shown = false;
        self.stop += 1;
        if self.stop >= self.stops.len() {
            self.enter(plan, self.step + 1);
        }
    }

    /// To the beginning of a step, or of the first one after it that has a page.
    fn enter(&mut self, plan: &Plan, from: usize) {
        self.stop = 0;
        self.failed = 0;
        self.was_shown = false;
        for step in from..plan.steps.len() {
            self.step = step;
            self.trials = Vec::new();
            self.stops = Vec::new();
            let Step { name, kind } = &plan.steps[step];
            let StepKind::Trials(part) = kind else { return };
            if part.counted && self.placed.is_none() {
                return;
            }
            self.trials = self.trials_of(plan, name);
            self.stops = stops(part, &self.trials);
            if !self.stops.is_empty() {
                return;
            }
        }
        self.ending = Some(Ending::Finished);
    }

    fn swap(&mut self, swap: &Swap) {
        let all = self.placed.iter_mut().flatten().chain(&mut self.trials);
        for trial in all.filter(|trial| trial.part == swap.part && trial.position == swap.position) {
            trial.item = swap.item;
        }
    }
}

fn key(answer: &Answer) -> (String, String, String) {
    (answer.page.clone(), answer.question.clone(), answer.key.clone())
}
