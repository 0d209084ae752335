//! The page of a participation.

use super::page::{Content, Page, PageQuestion, Progress};
use super::session::Session;
use super::stops::Stop;
use crate::study::file::ItemOrder;
use crate::study::plan::{
    Ending, Plan, Prompt, Purpose, Role, Scale, StepKind, Stimulus, TrialsStep, random, word,
};
use crate::study::words::Words;

impl Session {
    /// The current page.
    pub fn page(&self, plan: &Plan) -> Page {
        let part = self.current(plan).map_or_else(String::new, |step| step.name.clone());
        let progress = self.trial().filter(|_| self.ending.is_none()).map(|(trial, _)| Progress {
            trial: trial.position,
            of: u32::try_from(self.trials.len()).unwrap_or(u32::MAX),
        });
        Page { id: self.page_id(plan), part, progress, content: self.content(plan) }
    }

    fn content(&self, plan: &Plan) -> Content {
        let ended = |ending| Content::Ended { ending, code: plan.code(ending).map(str::to_owned) };
        if let Some(ending) = self.ending {
            return ended(ending);
        }
        if self.has_lapsed() {
            return Content::Lapsed;
        }
        if self.is_paused() {
            return Content::Paused;
        }
        if self.is_broken() {
            return Content::Broken;
        }
        let text = |words: &Words| words.find(&self.language, &plan.languages).to_owned();
        match self.current(plan).map(|step| &step.kind) {
            None => ended(Ending::Finished),
            Some(StepKind::Consent { text: file, minimum_age }) => {
                Content::Consent { text: text(file), minimum_age: *minimum_age }
            }
            Some(StepKind::Text(words)) => Content::Text { text: text(words) },
            Some(StepKind::Form(prompts)) => Content::Form { questions: self.questions(plan, prompts) },
            Some(StepKind::Check { attempts, prompts, .. }) => Content::Check {
                attempt: self.failed + 1,
                attempts: *attempts,
                questions: self.questions(plan, prompts),
            },
            Some(StepKind::Trials(_)) if self.needs_place(plan) => {
                if self.is_full {
                    ended(Ending::Full)
                } else {
                    Content::Place
                }
            }
            Some(StepKind::Trials(step)) => self.trial_content(plan, step),
        }
    }

    fn trial_content(&self, plan: &Plan, step: &TrialsStep) -> Content {
        let Some((trial, was_shown)) = self.trial() else {
            return match self.stops.get(self.stop) {
                Some(Stop::AfterBlock(_)) => {
                    Content::Form { questions: self.questions(plan, &step.after_block) }
                }
                _ => Content::Rest,
            };
        };
        let name = self.stimulus(plan, trial).map(|stimulus| {
            // a gait is one stimulus for all; scenes and agents differ by seed
            let seed = if matches!(stimulus, Stimulus::Gait { .. }) { 0 } else { trial.seed };
            plan.name(stimulus, seed)
        });
        match (name, trial.role) {
            (Some(name), _) if !was_shown => {
                Content::Show { name, seconds: step.shows.seconds, plays: step.shows.plays }
            }
            (name, role) => Content::Ask {
                replay: name.filter(|_| step.shows.replay),
                instruction: match role {
                    Role::Catch { answer } => Some(self.instruction(plan, step, answer)),
                    _ => None,
                },
                questions: self.questions(plan, &step.prompts),
            },
        }
    }

    /// What an instructed trial says.
    fn instruction(&self, plan: &Plan, step: &TrialsStep, answer: i64) -> String {
        let labels = step.prompts.iter().find_map(|prompt| match &prompt.scale {
            Scale::Points { labels, .. } => labels.iter().find(|(point, _)| *point == answer),
            _ => None,
        });
        let find = |words: &Words| words.find(&self.language, &plan.languages).to_owned();
        let answer = labels.map_or_else(|| answer.to_string(), |(_, words)| find(words));
        find(&step.instruction).replace("{answer}", &answer)
    }

    /// The questions in the participant's language and order.
    fn questions(&self, plan: &Plan, prompts: &[Prompt]) -> Vec<PageQuestion> {
        let find = |words: &Words| words.find(&self.language, &plan.languages).to_owned();
        let mut questions = Vec::with_capacity(prompts.len());
        for group in prompts.chunk_by(|a, b| a.group == b.group) {
            let mut order: Vec<&Prompt> = group.iter().collect();
            self.shuffle(plan, &group[0], &mut order);
            questions.extend(order.into_iter().map(|prompt| PageQuestion {
                id: prompt.id.clone(),
                heading: find(&prompt.heading),
                text: find(&prompt.text),
                scale: self.scale(plan, prompt, find),
                optional: prompt.optional,
            }));
        }
        questions
    }

    fn scale(&self, plan: &Plan, prompt: &Prompt, find: impl Fn(&Words) -> String) -> Scale<String> {
        let texts = |words: &[(i64, Words)]| words.iter().map(|(value, text)| (*value, find(text))).collect();
        match &prompt.scale {
            Scale::Points { least, greatest, labels } => {
                Scale::Points { least: *least, greatest: *greatest, labels: texts(labels) }
            }
            Scale::Options { options } => {
                let mut options: Vec<(i64, String)> = texts(options);
                self.shuffle(plan, prompt, &mut options);
                Scale::Options { options }
            }
            Scale::Number { least, greatest } => Scale::Number { least: *least, greatest: *greatest },
            Scale::Text { most } => Scale::Text { most: *most },
        }
    }

    /// Puts what belongs to a question into the participant's order.
    fn shuffle<T>(&self, plan: &Plan, prompt: &Prompt, items: &mut [T]) {
        let page = match prompt.order {
            ItemOrder::Fixed => return,
            ItemOrder::PerParticipant => 0,
            ItemOrder::PerTrial => word(&self.page_id(plan)),
        };
        random(plan.seed, Purpose::Items, &[self.person(), word(&prompt.group), page]).shuffle(items);
    }
}
