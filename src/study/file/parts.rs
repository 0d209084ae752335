//! Parts of a study: pages of text, forms, checks, trials.

use super::{Names, Question};
use crate::study::words::Words;
use serde::{Deserialize, Serialize};

/// One part of the flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Part {
    /// A page to read.
    Text(Text),
    /// A page of questions.
    Form(Form),
    /// Questions with a right answer.
    Comprehension(Check),
    /// Stimuli, each with questions after it.
    Trials(Box<Trials>),
}

impl Part {
    /// The trials, if it is such a part.
    pub const fn trials(&self) -> Option<&Trials> {
        match self {
            Self::Trials(trials) => Some(trials),
            _ => None,
        }
    }
}

/// A page to read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Text {
    /// What it says; paragraphs are parted by an empty line.
    pub text: Words,
}

/// A page of questions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Form {
    /// Names of questions, of questionnaires, or the built-in `gender` and `age`.
    pub ask: Names,
}

/// Questions with a right answer: a participant who fails is screened out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// How often they may be answered, 1 to 10.
    pub attempts: u32,
    /// The questions, each a choice with `right`.
    pub questions: Vec<RightChoice>,
}

/// A choice with a right answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RightChoice {
    /// The question.
    pub text: Words,
    /// The answers to choose from.
    pub options: Vec<Words>,
    /// Index of the right one, from 0.
    pub right: usize,
}

/// Stimuli, each with questions after it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trials {
    /// What is shown.
    pub show: Show,
    /// Names of the questions after each stimulus.
    pub ask: Names,
    /// Who gets what; left out: every stimulus once, in the order of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub design: Option<Design>,
    /// Whether its answers count; practice does not.
    #[serde(default = "yes")]
    pub counted: bool,
    /// Stimuli that are shown a second time, 0 to 10.
    #[serde(default)]
    pub repeat: u32,
    /// Pages without a stimulus that say which answer to give, 0 to 10.
    #[serde(default, rename = "catch")]
    pub catches: u32,
    /// What such a page says, with `{answer}` for the answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instruction: Option<Words>,
    /// How trials are seeded.
    #[serde(default)]
    pub seeds: Seeds,
    /// Names of questions after each block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after_block: Option<Names>,
    /// A rest after each so many blocks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_after_blocks: Option<u32>,
}

const fn yes() -> bool {
    true
}

/// How trials are seeded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Seeds {
    /// The trials of a block show the same people.
    PerBlock,
    /// Every trial has a seed of its own.
    #[default]
    PerTrial,
}

/// What is shown: gaits, scenes or single agents.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Show {
    /// A library of gaits, a file beside the study file; or `practice`, the built-in examples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gaits: Option<String>,
    /// Names or files of scenes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenes: Option<Vec<String>>,
    /// Single agents.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub agents: Option<Agents>,
    /// Conditions of scenes: `baseline`, `eva-o`, `eva-g`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Vec<String>>,
    /// The one condition of scenes or agents.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condition: Option<String>,
    /// From where a gait is seen: `front`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<String>,
    /// How long it lasts, s, 0.5 to 600.
    pub seconds: f64,
    /// How often it is played before the questions, 1 to 10.
    #[serde(default = "once")]
    pub plays: u32,
    /// Whether it may be played again while the questions are answered.
    #[serde(default)]
    pub replay: bool,
}

const fn once() -> u32 {
    1
}

/// Single agents: every emotion with every body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Agents {
    /// Emotions that they are to show.
    pub each_of: Vec<String>,
    /// Names of avatars.
    pub bodies: Vec<String>,
}

/// Who gets what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Design {
    /// Everyone gets some; all get the same number of answers.
    Fill {
        /// Stimuli of one participant.
        each: u32,
        /// Answers that every stimulus gets at least.
        at_least: u32,
    },
    /// Scenes in blocks, conditions within, both by Williams squares.
    Blocks {
        /// What a block holds fixed: `scenes`.
        blocks: String,
        /// What differs within a block: `conditions`.
        within: String,
    },
    /// All stimuli, in the orders of a Williams square.
    Square,
}

/// The questions of a check as ordinary choices, without their right answers.
impl From<&RightChoice> for Question {
    fn from(choice: &RightChoice) -> Self {
        Self::Choice {
            text: choice.text.clone(),
            options: choice.options.clone(),
            order: super::ItemOrder::Fixed,
            optional: false,
        }
    }
}
