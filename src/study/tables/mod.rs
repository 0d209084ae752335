//! The folder of a study's data: `answers.csv` with one row an answer, `participants.csv` with one row a participant.
//!
//! | column of `answers.csv` | |
//! | --- | --- |
//! | `participant` | code or number |
//! | `front` | `web`, `headset` or `simulated` |
//! | `part`, `page` | where the question stood |
//! | `position` | of the trial within its part, from 1 |
//! | `role` | `ordinary`, `repeat` (the stimulus is shown a second time) or `catch` (nothing is shown) |
//! | `wanted` | the answer that a `catch` asks for |
//! | `gait`, `scene`, `condition`, `emotion`, `body` | what was shown |
//! | `question` | `presence.q1`, `which` |
//! | `value` | a whole number, or free text; empty where the answer was taken back |
//! | `ms` | from the moment the question was seen to the answer |
//!
//! `participants.csv` has `participant`, `front`, `state` and `placed`, and `frames` and `late_frames` where they were counted.
//! A cell is empty where it does not apply. Free text that a spreadsheet would take for a formula or a number begins with `'`.
//!
//! ```
//! use gaitway::study::tables::{read, write};
//!
//! # fn main() -> Result<(), gaitway::study::Error> {
//! let participants = "participant,front,state,placed\nk7,headset,finished,true\n";
//! let answers = "participant,front,part,page,position,role,wanted,gait,scene,condition,emotion,body,question,value,ms\n\
//!                k7,headset,scenes,scenes/1,1,ordinary,,,garden,eva-g,,,presence.q1,6,2100\n";
//! let tables = read(answers, participants, "run1")?;
//! assert_eq!(tables.answers[0].number(), Some(6));
//! assert_eq!(write(&tables), (answers.to_owned(), participants.to_owned()));
//! # Ok(())
//! # }
//! ```

mod choice;
mod ratings;
mod read;
mod session;
mod write;

pub use choice::{Chosen, Fronts};
pub use ratings::ratings;
pub use read::read;
pub use session::of_session;
pub(super) use write::free_text;
pub use write::write;

use super::file::Front;
use super::plan::{self, Stimulus};
use super::protocol::State;
use super::simulate::{AnswerRow, Run};
use serde::Serialize;

/// Name of the file of answers.
pub const ANSWERS: &str = "answers.csv";
/// Name of the file of participants.
pub const PARTICIPANTS: &str = "participants.csv";

/// Columns of `answers.csv`, in the order written.
const ANSWER_COLUMNS: [&str; 15] = [
    "participant",
    "front",
    "part",
    "page",
    "position",
    "role",
    "wanted",
    "gait",
    "scene",
    "condition",
    "emotion",
    "body",
    "question",
    "value",
    "ms",
];
/// Columns that `participants.csv` always has, in the order written.
const PARTICIPANT_COLUMNS: [&str; 4] = ["participant", "front", "state", "placed"];
/// Columns that it has where frames were counted.
const FRAME_COLUMNS: [&str; 2] = ["frames", "late_frames"];

/// The data of a study.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Tables {
    /// Every participant that arrived.
    pub participants: Vec<Participant>,
    /// The last answer to every question.
    pub answers: Vec<Answer>,
}

/// A participant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Participant {
    /// Code or number.
    pub participant: String,
    /// Where the participant takes part.
    pub front: Front,
    /// Where the participation ended.
    pub state: State,
    /// Whether there was a place.
    pub placed: bool,
    /// Frames of all stimuli, where they were counted.
    pub frames: Option<Frames>,
}

/// Frames of a participant's stimuli.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Frames {
    /// Frames shown.
    pub all: u64,
    /// Frames shown late.
    pub late: u64,
}

/// An answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// The participant.
    pub participant: String,
    /// Where the participant takes part.
    pub front: Front,
    /// The part of the flow.
    pub part: String,
    /// The page.
    pub page: String,
    /// The counted trial that it is about; none of forms, checks and practice.
    pub trial: Option<Trial>,
    /// What was shown.
    pub shown: Shown,
    /// The question.
    pub question: String,
    /// What was answered; none where the answer was taken back.
    pub value: Option<Value>,
    /// From the moment the question was seen to the answer, ms.
    pub ms: Option<u32>,
}

/// A counted trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Trial {
    /// Position within the part, from 1.
    pub position: u32,
    /// What it is for.
    pub role: Role,
}

/// What a trial is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Its answers count.
    Ordinary,
    /// It shows a stimulus for the second time.
    Repeat,
    /// It shows nothing and asks for this answer.
    Catch(i64),
}

/// What was shown; a field that does not apply is none.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Shown {
    /// Name of the gait.
    pub gait: Option<String>,
    /// Name of the scene.
    pub scene: Option<String>,
    /// The condition.
    pub condition: Option<String>,
    /// The emotion that an agent was to show.
    pub emotion: Option<String>,
    /// The avatar of an agent.
    pub body: Option<String>,
}

/// What was answered.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// The number chosen or written.
    Number(i64),
    /// Free text.
    Text(String),
}

impl Answer {
    /// The number answered, if it is one.
    pub const fn number(&self) -> Option<i64> {
        match self.value {
            Some(Value::Number(value)) => Some(value),
            _ => None,
        }
    }

    /// Whether it counts: the trial is neither a repeat nor instructed.
    pub fn is_ordinary(&self) -> bool {
        self.trial.is_some_and(|trial| trial.role == Role::Ordinary)
    }
}

impl Tables {
    /// The tables of a simulated study. Their front is [`Front::Simulated`].
    pub fn simulated(run: &Run) -> Self {
        let participant = |one: &super::simulate::Participant| Participant {
            participant: one.number.to_string(),
            front: Front::Simulated,
            state: one.state,
            placed: one.was_placed,
            frames: None,
        };
        Self {
            participants: run.participants.iter().map(participant).collect(),
            answers: run.answers.iter().map(answer).collect(),
        }
    }

    /// The participants that pass a test, with their answers.
    #[must_use]
    pub fn only(&self, keeps: impl Fn(&Participant) -> bool) -> Self {
        let participants: Vec<Participant> =
            self.participants.iter().filter(|one| keeps(one)).cloned().collect();
        let kept: std::collections::BTreeSet<&str> =
            participants.iter().map(|one| one.participant.as_str()).collect();
        let answers = self.answers.iter().filter(|row| kept.contains(row.participant.as_str())).cloned();
        Self { answers: answers.collect(), participants }
    }
}

fn answer(row: &AnswerRow) -> Answer {
    let role = |role| match role {
        plan::Role::Ordinary => Role::Ordinary,
        plan::Role::Repeat { .. } => Role::Repeat,
        plan::Role::Catch { answer } => Role::Catch(answer),
    };
    Answer {
        participant: row.participant.to_string(),
        front: Front::Simulated,
        part: row.page.split('/').next().unwrap_or_default().to_owned(),
        page: row.page.clone(),
        trial: row.trial.as_ref().map(|trial| Trial { position: trial.position, role: role(trial.role) }),
        shown: row.stimulus.as_ref().map(Shown::from).unwrap_or_default(),
        question: row.question.clone(),
        value: row.value.map(Value::Number),
        ms: Some(row.ms),
    }
}

impl From<&Stimulus> for Shown {
    fn from(stimulus: &Stimulus) -> Self {
        let some = |text: &String| Some(text.clone());
        match stimulus {
            Stimulus::Gait { gait } => Self { gait: some(gait), ..Self::default() },
            Stimulus::Scene { scene, condition } => {
                Self { scene: some(scene), condition: some(condition), ..Self::default() }
            }
            Stimulus::Agent { emotion, body, condition } => Self {
                emotion: some(emotion),
                body: some(body),
                condition: some(condition),
                ..Self::default()
            },
        }
    }
}

/// The name of a value that serde writes as one word.
pub(crate) fn name<T: Serialize>(value: &T) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(name)) => name,
        _ => String::new(),
    }
}
