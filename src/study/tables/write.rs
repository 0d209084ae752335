//! Writes the tables of a study.

use super::{
    ANSWER_COLUMNS, Answer, FRAME_COLUMNS, PARTICIPANT_COLUMNS, Participant, Role, Tables, Value, name,
};
use crate::table::cell;

/// The texts of `answers.csv` and `participants.csv`, in this order.
pub fn write(tables: &Tables) -> (String, String) {
    let mut answers = row(&ANSWER_COLUMNS.map(str::to_owned));
    answers.extend(tables.answers.iter().map(|one| row(&answer(one))));
    let has_frames = tables.participants.iter().any(|one| one.frames.is_some());
    let columns = PARTICIPANT_COLUMNS.iter().chain(FRAME_COLUMNS.iter().filter(|_| has_frames));
    let mut participants = row(&columns.map(|&name| name.to_owned()).collect::<Vec<_>>());
    participants.extend(tables.participants.iter().map(|one| row(&participant(one, has_frames))));
    (answers, participants)
}

fn row(cells: &[String]) -> String {
    let cells: Vec<_> = cells.iter().map(|text| cell(text)).collect();
    cells.join(",") + "\n"
}

fn participant(one: &Participant, has_frames: bool) -> Vec<String> {
    let placed = if one.placed { "true" } else { "false" };
    let mut cells = vec![one.participant.clone(), name(&one.front), name(&one.state), placed.to_owned()];
    if has_frames {
        cells.push(number(one.frames.map(|frames| frames.all)));
        cells.push(number(one.frames.map(|frames| frames.late)));
    }
    cells
}

fn answer(one: &Answer) -> [String; 15] {
    let (role, instructed) = match one.trial.map(|trial| trial.role) {
        None => ("", None),
        Some(Role::Ordinary) => ("ordinary", None),
        Some(Role::Repeat) => ("repeat", None),
        Some(Role::Catch(answer)) => ("catch", Some(answer)),
    };
    let shown = |text: &Option<String>| text.clone().unwrap_or_default();
    [
        one.participant.clone(),
        name(&one.front),
        one.part.clone(),
        one.page.clone(),
        number(one.trial.map(|trial| trial.position)),
        role.to_owned(),
        number(instructed),
        shown(&one.shown.gait),
        shown(&one.shown.scene),
        shown(&one.shown.condition),
        shown(&one.shown.emotion),
        shown(&one.shown.body),
        one.question.clone(),
        match &one.value {
            None => String::new(),
            Some(Value::Number(value)) => value.to_string(),
            Some(Value::Text(text)) => free_text(text),
        },
        number(one.ms),
    ]
}

/// Free text as a cell: with a quote before it where a spreadsheet would compute it, and where it would be read as a number.
pub(in crate::study) fn free_text(text: &str) -> String {
    let text = text.trim();
    let is_marked = text.starts_with(['=', '+', '-', '@', '\'']) || text.parse::<i64>().is_ok();
    format!("{}{text}", if is_marked { "'" } else { "" })
}

fn number<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}
