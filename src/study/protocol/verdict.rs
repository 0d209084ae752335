//! What a store does with an event.

use super::event::{Answer, Event};
use super::session::Session;
use crate::study::plan::{Ending, Plan, Prompt, Scale};
use serde::{Deserialize, Serialize};

/// What a store does with an event.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// It is new: it is stored and applied.
    Take,
    /// It was stored before, or its page is past: nothing is stored, and the reply is the current page.
    Again,
    /// It is wrong.
    Refuse(Refusal),
}

/// Why an event is wrong.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[serde(tag = "refusal", rename_all = "kebab-case")]
pub enum Refusal {
    /// The participation is over.
    #[error("this participation is over")]
    Over,
    /// The operator has paused.
    #[error("the study is paused for you")]
    Paused,
    /// The page is not the current one, and was not one before.
    #[error("the page {page:?} is not the current one")]
    WrongPage {
        /// The page.
        page: String,
    },
    /// The page does not have the question.
    #[error("the page has no question {question:?}")]
    NoSuchQuestion {
        /// The question.
        question: String,
    },
    /// The answer is none of those that can be given.
    #[error("the answer to {question:?} is none of those that can be given")]
    OffScale {
        /// The question.
        question: String,
    },
    /// Questions that must be answered are not.
    #[error("not answered yet: {}", questions.join(", "))]
    Unanswered {
        /// The questions.
        questions: Vec<String>,
    },
    /// The event does not belong to the current page.
    #[error("this page is not answered so")]
    Misplaced,
}

impl Session {
    /// What a store does with an event that has not been applied.
    pub fn judge(&self, plan: &Plan, event: &Event) -> Verdict {
        let refuse = Verdict::Refuse;
        if matches!(event, Event::Arrived { .. }) {
            return if self.has_arrived() { Verdict::Again } else { Verdict::Take };
        }
        if let Some(ending) = self.ending {
            // both are possible after the end, too: the code on the last page, the operator's list
            let is_new = match event {
                Event::Withdrawn => !matches!(ending, Ending::Withdrawn | Ending::Declined),
                Event::Excluded { .. } => ending == Ending::Finished,
                _ => false,
            };
            if is_new {
                return Verdict::Take;
            }
            let repeats = match event {
                Event::Answer(answer) => self.has_key(answer) || self.is_past(&answer.page),
                Event::Next { page } | Event::Shown { page, .. } => self.is_past(page),
                Event::Withdrawn | Event::Declined | Event::Consented { .. } => true,
                _ => false,
            };
            return if repeats { Verdict::Again } else { refuse(Refusal::Over) };
        }
        match event {
            Event::Arrived { .. } | Event::Withdrawn | Event::Excluded { .. } | Event::Sign { .. } => {
                Verdict::Take
            }
            Event::Lapsed => if_else(!self.has_lapsed(), Verdict::Take, Verdict::Again),
            Event::Returned { .. } => if_else(self.has_lapsed(), Verdict::Take, Verdict::Again),
            Event::Paused => if_else(!self.is_paused(), Verdict::Take, Verdict::Again),
            Event::Resumed => if_else(self.is_paused(), Verdict::Take, Verdict::Again),
            Event::Placed { .. } | Event::Full => {
                if_else(self.needs_place(plan), Verdict::Take, refuse(Refusal::Misplaced))
            }
            Event::Replaced(_) => if_else(self.is_broken(), Verdict::Take, refuse(Refusal::Misplaced)),
            Event::Consented { .. } | Event::Declined => {
                if_else(self.asks_consent(plan), Verdict::Take, Verdict::Again)
            }
            Event::Answer(answer) => self.judge_answer(plan, answer),
            Event::Next { page } => self.judge_page(plan, page).unwrap_or_else(|| self.judge_next(plan)),
            Event::Shown { page, .. } | Event::Fault { page, .. } => {
                let fits = if_else(self.is_showing(plan), Verdict::Take, Verdict::Again);
                self.judge_page(plan, page).unwrap_or(fits)
            }
        }
    }

    /// What becomes of an event of a page that is not the current one, or while nothing can be answered.
    fn judge_page(&self, plan: &Plan, page: &str) -> Option<Verdict> {
        if self.is_past(page) {
            return Some(Verdict::Again);
        }
        if page != self.page_id(plan) {
            return Some(Verdict::Refuse(Refusal::WrongPage { page: page.to_owned() }));
        }
        self.is_paused().then_some(Verdict::Refuse(Refusal::Paused))
    }

    fn judge_answer(&self, plan: &Plan, answer: &Answer) -> Verdict {
        if self.has_key(answer) {
            return Verdict::Again;
        }
        if let Some(verdict) = self.judge_page(plan, &answer.page) {
            return verdict;
        }
        let question = answer.question.clone();
        let Some(prompt) = self.prompts(plan).iter().find(|prompt| prompt.id == question) else {
            return Verdict::Refuse(Refusal::NoSuchQuestion { question });
        };
        if_else(fits(prompt, answer), Verdict::Take, Verdict::Refuse(Refusal::OffScale { question }))
    }

    fn judge_next(&self, plan: &Plan) -> Verdict {
        if !self.ends_by_next(plan) {
            return Verdict::Refuse(Refusal::Misplaced);
        }
        let page = self.page_id(plan);
        let lacks = |prompt: &&Prompt| !prompt.optional && self.given(&page, &prompt.id).is_none();
        let questions: Vec<String> =
            self.prompts(plan).iter().filter(lacks).map(|prompt| prompt.id.clone()).collect();
        if_else(questions.is_empty(), Verdict::Take, Verdict::Refuse(Refusal::Unanswered { questions }))
    }
}

fn if_else(is: bool, then: Verdict, other: Verdict) -> Verdict {
    if is { then } else { other }
}

/// Whether an answer can be given to a question.
fn fits(prompt: &Prompt, answer: &Answer) -> bool {
    match (&prompt.scale, answer.value, &answer.text) {
        (Scale::Text { most }, None, Some(text)) => text.chars().count() <= *most as usize,
        (Scale::Text { .. }, ..) | (_, _, Some(_)) => false,
        (scale, Some(value), None) => scale.allows(value),
        // an answer is taken back
        (_, None, None) => true,
    }
}
