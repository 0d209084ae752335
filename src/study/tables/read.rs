//! Reads the tables of a study.

use super::{
    ANSWER_COLUMNS, ANSWERS, Answer, FRAME_COLUMNS, Frames, PARTICIPANT_COLUMNS, PARTICIPANTS, Participant,
    Role, Shown, Tables, Trial, Value,
};
use crate::study::error::{BadValue, Error};
use crate::study::file::Front;
use crate::study::protocol::State;
use crate::table::{Record, Records};
use serde::Deserialize;
use serde::de::IntoDeserializer as _;
use std::collections::HashMap;
use std::str::FromStr;

const FRONTS: &str = "web, headset or simulated";
const STATES: &str = "arrived, consented, placed, lapsed, paused, finished, declined, withdrawn, screened-out, excluded or full";
const ROLES: &str = "ordinary, repeat or catch, or empty outside of counted trials";

/// Reads the texts of `answers.csv` and `participants.csv`; `origin` is their folder in messages.
///
/// # Errors
/// [`Error::Syntax`] for a missing column or an open quote. [`Error::Value`] for a cell, with file and line, column, value and what
/// is allowed. A participant has one row, each of its questions one answer, and every answer a participant.
pub fn read(answers: &str, participants: &str, origin: &str) -> Result<Tables, Error> {
    let file = |name: &str| if origin.is_empty() { name.to_owned() } else { format!("{origin}/{name}") };
    let mut tables = Tables::default();
    let mut fronts: HashMap<String, Front> = HashMap::new();
    rows(participants, &file(PARTICIPANTS), &PARTICIPANT_COLUMNS, |row| {
        let one = participant(row)?;
        if fronts.insert(one.participant.clone(), one.front).is_some() {
            return Err(row.bad("participant", "a participant of one row", "delete one of the rows"));
        }
        tables.participants.push(one);
        Ok(())
    })?;
    let mut lines: HashMap<[String; 3], usize> = HashMap::new();
    rows(answers, &file(ANSWERS), &ANSWER_COLUMNS, |row| {
        let one = answer(row)?;
        match fronts.get(&one.participant) {
            None => {
                let hint = "keep both files of a run together";
                return Err(row.bad("participant", format!("a participant of {PARTICIPANTS}"), hint));
            }
            Some(&front) if front != one.front => {
                let allowed = format!("{}, as in {PARTICIPANTS}", super::name(&front));
                return Err(row.bad("front", allowed, "a participant has one front"));
            }
            Some(_) => {}
        }
        let key = [&one.participant, &one.page, &one.question].map(String::clone);
        if let Some(first) = lines.insert(key, row.record.line) {
            let hint = format!("line {first} answers it too; keep the last answer alone");
            return Err(row.bad("question", "a question answered once on a page", hint));
        }
        tables.answers.push(one);
        Ok(())
    })?;
    Ok(tables)
}

/// A row with the columns of its file.
struct Row<'a> {
    file: &'a str,
    columns: &'a HashMap<String, usize>,
    record: Record<'a>,
}

impl Row<'_> {
    fn get(&self, column: &str) -> &str {
        self.columns.get(column).and_then(|&index| self.record.get(index)).unwrap_or_default()
    }

    fn text(&self, column: &str) -> Option<String> {
        Some(self.get(column).to_owned()).filter(|text| !text.is_empty())
    }

    fn needed(&self, column: &str) -> Result<String, Error> {
        self.text(column).ok_or_else(|| self.bad(column, "a text", "the cell is empty"))
    }

    fn number<T: FromStr>(&self, column: &str, allowed: &str) -> Result<Option<T>, Error> {
        match self.get(column) {
            "" => Ok(None),
            text => {
                let wrong = |_| self.bad(column, allowed, "an empty cell is one that does not apply");
                text.parse().map(Some).map_err(wrong)
            }
        }
    }

    /// One of the names of a type.
    fn named<'de, T: Deserialize<'de>>(&self, column: &str, allowed: &str) -> Result<T, Error> {
        let name = self.get(column).to_owned();
        let found: Result<T, serde::de::value::Error> = T::deserialize(name.into_deserializer());
        found.map_err(|_unnamed| self.bad(column, allowed, "names are written in lower case"))
    }

    fn bad(&self, column: &str, allowed: impl Into<String>, hint: impl Into<String>) -> Error {
        let bad = BadValue::new(column, format!("{:?}", self.get(column)), allowed, hint);
        Error::Value(Box::new(BadValue { place: format!("{}:{}", self.file, self.record.line), ..bad }))
    }
}

/// Calls `take` with every row of a file.
fn rows(
    text: &str,
    file: &str,
    needed: &[&str],
    mut take: impl FnMut(&Row<'_>) -> Result<(), Error>,
) -> Result<(), Error> {
    let syntax = |line, message| Error::Syntax { place: format!("{file}:{line}"), message };
    let mut records = Records::with_header(text);
    let header = match records.next() {
        None => return Err(syntax(1, format!("no header; it must name the columns {}", needed.join(", ")))),
        Some(header) => header.map_err(|quote| syntax(quote.line, quote.to_string()))?,
    };
    let mut columns = HashMap::new();
    for (index, name) in header.cells.iter().enumerate() {
        if columns.insert(name.to_lowercase(), index).is_some() {
            return Err(syntax(header.line, format!("two columns {name:?}; a column has one name")));
        }
    }
    if let Some(missing) = needed.iter().find(|&&name| !columns.contains_key(name)) {
        let found = header.cells.join(", ");
        return Err(syntax(header.line, format!("no column {missing:?}; found: {found}")));
    }
    for record in records {
        let record = record.map_err(|quote| syntax(quote.line, quote.to_string()))?;
        if record.cells.len() != header.cells.len() {
            let (found, width) = (record.cells.len(), header.cells.len());
            return Err(syntax(record.line, format!("{found} cells; the header names {width} columns")));
        }
        take(&Row { file, columns: &columns, record })?;
    }
    Ok(())
}

fn participant(row: &Row<'_>) -> Result<Participant, Error> {
    let counted = |column| row.number(column, "a count of frames, or empty");
    let frames = match (counted(FRAME_COLUMNS[0])?, counted(FRAME_COLUMNS[1])?) {
        (None, None) => None,
        (Some(all), Some(late)) if late <= all => Some(Frames { all, late }),
        (Some(_), Some(_)) => {
            return Err(row.bad(FRAME_COLUMNS[1], "at most the frames", "late frames are frames, too"));
        }
        (all, _) => {
            let empty = FRAME_COLUMNS[usize::from(all.is_some())];
            return Err(row.bad(empty, "a count of frames", "frames and late_frames go together"));
        }
    };
    Ok(Participant {
        participant: row.needed("participant")?,
        front: row.named("front", FRONTS)?,
        state: row.named::<State>("state", STATES)?,
        placed: match row.get("placed") {
            "true" => true,
            "false" => false,
            _ => return Err(row.bad("placed", "true or false", "it says whether there was a place")),
        },
        frames,
    })
}

fn answer(row: &Row<'_>) -> Result<Answer, Error> {
    Ok(Answer {
        participant: row.needed("participant")?,
        front: row.named("front", FRONTS)?,
        part: row.needed("part")?,
        page: row.needed("page")?,
        trial: trial(row)?,
        shown: Shown {
            gait: row.text("gait"),
            scene: row.text("scene"),
            condition: row.text("condition"),
            emotion: row.text("emotion"),
            body: row.text("body"),
        },
        question: row.needed("question")?,
        value: row.text("value").map(value),
        ms: row.number("ms", "whole milliseconds below 4,294,967,296, or empty")?,
    })
}

fn trial(row: &Row<'_>) -> Result<Option<Trial>, Error> {
    let position: Option<u32> = row.number("position", "a whole number from 1, or empty")?;
    let instructed: Option<i64> = row.number("wanted", "a whole number where role is catch, or empty")?;
    let role = match (row.get("role"), instructed) {
        ("", None) => None,
        ("ordinary", None) => Some(Role::Ordinary),
        ("repeat", None) => Some(Role::Repeat),
        ("catch", Some(answer)) => Some(Role::Catch(answer)),
        ("catch", None) => {
            let allowed = "a whole number where role is catch";
            return Err(row.bad("wanted", allowed, "without it no failure can be found"));
        }
        ("" | "ordinary" | "repeat", Some(_)) => {
            return Err(row.bad("wanted", "empty unless role is catch", "correct one of the cells"));
        }
        _ => return Err(row.bad("role", ROLES, "names are written in lower case")),
    };
    match (position, role) {
        (None, None) => Ok(None),
        (Some(0), _) => Err(row.bad("position", "a whole number from 1", "the first trial is 1")),
        (Some(position), Some(role)) => Ok(Some(Trial { position, role })),
        (None, Some(_)) => Err(row.bad("position", "a whole number from 1", "a role belongs to a trial")),
        (Some(_), None) => Err(row.bad("role", "ordinary, repeat or catch", "a position belongs to a trial")),
    }
}

/// A whole number, or free text, whose leading quote is a mark.
fn value(text: String) -> Value {
    match (text.strip_prefix('\''), text.parse()) {
        (Some(text), _) => Value::Text(text.to_owned()),
        (None, Ok(number)) => Value::Number(number),
        (None, Err(_)) => Value::Text(text),
    }
}
