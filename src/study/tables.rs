//! The tables of a study: one row an answer, one row a participant. What an analysis reads, and what it can be given by others.

use super::error::Error;
use super::plan::{Role, Stimulus};
use super::simulate::{AnswerRow, Run};
use crate::emotion::Emotion;
use crate::table::{Record, Records, cell};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Columns of the table of answers.
pub const ANSWER_COLUMNS: [&str; 15] = [
    "participant",
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
    "front",
];
/// Columns of the table of participants.
pub const PEOPLE_COLUMNS: [&str; 4] = ["participant", "front", "state", "placed"];
/// What `front` says of simulated participants.
pub const SIMULATED: &str = "simulated";
/// What `state` says of participants that did everything.
pub const FINISHED: &str = "finished";
/// Roles of trials, as tables name them.
pub const ORDINARY: &str = "ordinary";
const REPEAT: &str = "repeat";
/// The role of a trial that asks for a certain answer.
pub const CATCH: &str = "catch";

/// One answer. What does not apply is empty.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Answer {
    /// The participant.
    pub participant: String,
    /// The part of the study.
    pub part: String,
    /// The page.
    pub page: String,
    /// Position of the trial within its part, from 1.
    pub position: Option<u32>,
    /// `ordinary`, `repeat` or `catch`; empty beside trials.
    pub role: String,
    /// What a `catch` asks for.
    pub wanted: Option<i64>,
    /// The gait that was shown.
    pub gait: String,
    /// The scene that was shown.
    pub scene: String,
    /// The condition in which it was shown.
    pub condition: String,
    /// The emotion of the agent that was shown.
    pub emotion: String,
    /// The avatar of the agent that was shown.
    pub body: String,
    /// The question.
    pub question: String,
    /// The number answered; none for free text.
    pub value: Option<i64>,
    /// From the moment the question was seen to the answer, ms.
    pub ms: u32,
    /// `web`, `headset` or `simulated`.
    pub front: String,
}

/// One participant.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Person {
    /// The participant.
    pub participant: String,
    /// `web`, `headset` or `simulated`.
    pub front: String,
    /// Where the participation ended.
    pub state: String,
    /// Whether there was a place.
    pub placed: bool,
}

/// The tables of a study.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tables {
    /// Answers, by participant.
    pub answers: Vec<Answer>,
    /// Participants.
    pub people: Vec<Person>,
}

impl Tables {
    /// The tables of a simulated study.
    pub fn of(run: &Run) -> Self {
        let person = |one: &super::simulate::Participant| Person {
            participant: one.number.to_string(),
            front: SIMULATED.to_owned(),
            state: one.state.name().to_owned(),
            placed: one.was_placed,
        };
        Self {
            answers: run.answers.iter().map(answer).collect(),
            people: run.participants.iter().map(person).collect(),
        }
    }

    /// The table of answers as CSV.
    pub fn answers_csv(&self) -> String {
        let number = |value: Option<i64>| value.map_or_else(String::new, |value| value.to_string());
        rows(
            &ANSWER_COLUMNS,
            self.answers.iter().map(|one| {
                let position = number(one.position.map(i64::from));
                let (wanted, value, ms) = (number(one.wanted), number(one.value), one.ms.to_string());
                [
                    &one.participant,
                    &one.part,
                    &one.page,
                    &position,
                    &one.role,
                    &wanted,
                    &one.gait,
                    &one.scene,
                    &one.condition,
                    &one.emotion,
                    &one.body,
                    &one.question,
                    &value,
                    &ms,
                    &one.front,
                ]
                .map(|text| cell(text).into_owned())
            }),
        )
    }

    /// The table of participants as CSV.
    pub fn people_csv(&self) -> String {
        rows(
            &PEOPLE_COLUMNS,
            self.people.iter().map(|one| {
                let placed = one.placed.to_string();
                [&one.participant, &one.front, &one.state, &placed].map(|text| cell(text).into_owned())
            }),
        )
    }

    /// The ratings of gaits as `gaitway gait ratings` reads them: ordinary trials of a part that are answered whole.
    pub fn ratings_csv(&self, part: &str) -> String {
        let mut trials: BTreeMap<(&str, &str, &str), [Option<i64>; 4]> = BTreeMap::new();
        let counted = self
            .answers
            .iter()
            .filter(|one| one.part == part && one.role == ORDINARY && !one.gait.is_empty());
        for one in counted {
            let item = one.question.rsplit('.').next().unwrap_or_default();
            if let Ok(emotion) = item.parse::<Emotion>() {
                trials.entry((&one.participant, &one.page, &one.gait)).or_default()[emotion.index()] =
                    one.value;
            }
        }
        let whole = trials.into_iter().filter_map(|((participant, _, gait), values)| {
            let [Some(happy), Some(angry), Some(sad), Some(neutral)] = values else { return None };
            let ratings = [happy, angry, sad, neutral].map(|value| value.to_string());
            let [happy, angry, sad, neutral] = ratings;
            Some([cell(participant).into_owned(), cell(gait).into_owned(), happy, angry, sad, neutral])
        });
        rows(&["participant", "video", "happy", "angry", "sad", "neutral"], whole)
    }

    /// Reads both tables; the names are those of messages.
    ///
    /// # Errors
    /// [`Error::Table`] with line, column, value and what is allowed.
    pub fn parse(
        [answers, people]: [&str; 2],
        [answers_name, people_name]: [&str; 2],
    ) -> Result<Self, Error> {
        let answers = read(answers, answers_name, &ANSWER_COLUMNS, |row| {
            Ok(Answer {
                participant: row.text(0),
                part: row.text(1),
                page: row.text(2),
                position: row.number(3)?,
                role: row.one_of(4, &["", ORDINARY, REPEAT, CATCH])?,
                wanted: row.number(5)?,
                gait: row.text(6),
                scene: row.text(7),
                condition: row.text(8),
                emotion: row.text(9),
                body: row.text(10),
                question: row.text(11),
                value: row.number(12)?,
                ms: row.number(13)?.unwrap_or(0),
                front: row.text(14),
            })
        })?;
        let people = read(people, people_name, &PEOPLE_COLUMNS, |row| {
            let placed = row.one_of(3, &["true", "false"])? == "true";
            Ok(Person { participant: row.text(0), front: row.text(1), state: row.text(2), placed })
        })?;
        Ok(Self { answers, people })
    }
}

/// An answer of a simulated participant.
fn answer(row: &AnswerRow) -> Answer {
    let trial = row.trial.as_ref();
    let role = trial.map_or("", |trial| match trial.role {
        Role::Ordinary => ORDINARY,
        Role::Repeat { .. } => REPEAT,
        Role::Catch { .. } => CATCH,
    });
    let wanted = trial.and_then(|trial| match trial.role {
        Role::Catch { answer } => Some(answer),
        _ => None,
    });
    let part = row.page.split('/').next().unwrap_or_default();
    let mut one = Answer {
        participant: row.participant.to_string(),
        part: part.to_owned(),
        page: row.page.clone(),
        position: trial.map(|trial| trial.position),
        role: role.to_owned(),
        wanted,
        question: row.question.clone(),
        value: row.value,
        ms: row.ms,
        front: SIMULATED.to_owned(),
        ..Answer::default()
    };
    match &row.stimulus {
        Some(Stimulus::Gait { gait }) => one.gait.clone_from(gait),
        Some(Stimulus::Scene { scene, condition }) => {
            one.scene.clone_from(scene);
            one.condition.clone_from(condition);
        }
        Some(Stimulus::Agent { emotion, body, condition }) => {
            one.emotion.clone_from(emotion);
            one.body.clone_from(body);
            one.condition.clone_from(condition);
        }
        None => {}
    }
    one
}

/// A table with its head.
fn rows<const N: usize>(head: &[&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let mut text = head.join(",");
    text.push('\n');
    for row in rows {
        // writing to a string does not fail
        let _ = writeln!(text, "{}", row.join(","));
    }
    text
}

/// A row that is read.
struct Row<'a> {
    record: &'a Record<'a>,
    columns: &'a [&'a str],
    origin: &'a str,
}

impl Row<'_> {
    fn text(&self, column: usize) -> String {
        self.record.get(column).unwrap_or_default().to_owned()
    }

    fn wrong(&self, column: usize, allowed: &str) -> Error {
        let message = format!("{} = {:?}: must be {allowed}", self.columns[column], self.text(column));
        Error::Table { origin: self.origin.to_owned(), line: self.record.line, message }
    }

    /// A whole number, or nothing.
    fn number<T: std::str::FromStr>(&self, column: usize) -> Result<Option<T>, Error> {
        let text = self.text(column);
        let wrong = |_| self.wrong(column, "a whole number, or empty");
        if text.is_empty() { Ok(None) } else { text.parse().map(Some).map_err(wrong) }
    }

    fn one_of(&self, column: usize, known: &[&str]) -> Result<String, Error> {
        let text = self.text(column);
        let list: Vec<&str> =
            known.iter().map(|word| if word.is_empty() { "empty" } else { *word }).collect();
        if known.contains(&text.as_str()) { Ok(text) } else { Err(self.wrong(column, &list.join(", "))) }
    }
}

fn read<T>(
    text: &str,
    origin: &str,
    columns: &[&str],
    of: impl Fn(&Row<'_>) -> Result<T, Error>,
) -> Result<Vec<T>, Error> {
    let wrong = |line, message| Error::Table { origin: origin.to_owned(), line, message };
    let mut found = Vec::new();
    let mut is_head = true;
    for record in Records::with_header(text) {
        let record = record.map_err(|quote| wrong(quote.line, quote.to_string()))?;
        if std::mem::take(&mut is_head) {
            if record.cells != columns {
                return Err(wrong(record.line, format!("the first line must be {}", columns.join(","))));
            }
            continue;
        }
        if record.cells.len() != columns.len() {
            let message = format!("{} cells; a row has {}", record.cells.len(), columns.len());
            return Err(wrong(record.line, message));
        }
        found.push(of(&Row { record: &record, columns, origin })?);
    }
    if is_head { Err(wrong(1, format!("the first line must be {}", columns.join(",")))) } else { Ok(found) }
}
