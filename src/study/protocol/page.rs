//! What a front shows.

use crate::study::plan::{Ending, Scale};
use serde::{Deserialize, Serialize};

/// A page in the participant's language. It tells neither what a stimulus is nor which answers are right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Page {
    /// Its id, which events refer to: `about-you`, `check/2`, `walks/3`, `scenes/after/1`, `scenes/rest/2`.
    pub id: String,
    /// The part that it belongs to; empty after the end.
    pub part: String,
    /// How far the participant is in the trials of a part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub progress: Option<Progress>,
    /// What is on it.
    #[serde(flatten)]
    pub content: Content,
}

/// How far a participant is in the trials of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Progress {
    /// The current trial, from 1.
    pub trial: u32,
    /// Trials of the part.
    pub of: u32,
}

/// What is on a page.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "content", rename_all = "kebab-case")]
pub enum Content {
    /// A text to agree to; answered by `consented` or `declined`.
    Consent {
        /// Name of its file.
        text: String,
        /// Youngest age of a participant, years.
        minimum_age: u32,
    },
    /// A text; answered by `next`.
    Text {
        /// The text.
        text: String,
    },
    /// Questions; answered by `answer` and `next`.
    Form {
        /// The questions.
        questions: Vec<PageQuestion>,
    },
    /// Questions with a right answer; answered by `answer` and `next`.
    Check {
        /// The current attempt, from 1.
        attempt: u32,
        /// How many there are.
        attempts: u32,
        /// The questions.
        questions: Vec<PageQuestion>,
    },
    /// A stimulus; answered by `shown` or `fault`.
    Show {
        /// Its name in addresses.
        name: String,
        /// How long it lasts, s.
        seconds: f64,
        /// How often it is played.
        plays: u32,
    },
    /// Questions about a stimulus, or an instructed answer; answered by `answer` and `next`.
    Ask {
        /// Name of the stimulus, where it may be played again.
        #[serde(skip_serializing_if = "Option::is_none")]
        replay: Option<String>,
        /// Which answer is asked for, in an instructed trial.
        #[serde(skip_serializing_if = "Option::is_none")]
        instruction: Option<String>,
        /// The questions.
        questions: Vec<PageQuestion>,
    },
    /// A rest; answered by `next`.
    Rest,
    /// The operator has paused; the front waits.
    Paused,
    /// The store has to give a place, by `placed` or `full`.
    Place,
    /// The store has to take the participant back, by `returned`.
    Lapsed,
    /// The store has to replace a stimulus that cannot be shown, by `replaced`.
    Broken,
    /// Nothing follows.
    Ended {
        /// How it ended.
        ending: Ending,
        /// The platform's code.
        #[serde(skip_serializing_if = "Option::is_none")]
        code: Option<String>,
    },
}

impl Content {
    /// The questions on it.
    pub fn questions(&self) -> &[PageQuestion] {
        match self {
            Self::Form { questions } | Self::Check { questions, .. } | Self::Ask { questions, .. } => {
                questions
            }
            _ => &[],
        }
    }
}

/// A question in the participant's language and order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PageQuestion {
    /// Its name, which answers refer to.
    pub id: String,
    /// What stands above it; the same for questions that belong together.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub heading: String,
    /// The question or statement.
    pub text: String,
    /// What can be answered.
    #[serde(flatten)]
    pub scale: Scale<String>,
    /// Whether it may be left out.
    pub optional: bool,
}
