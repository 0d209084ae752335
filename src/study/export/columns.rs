//! Tables of answers and of scores.

use super::people::Detail;
use super::sheet::Sheet;
use crate::study::analyse::{Analysis, Error, scores as scores_of};
use crate::study::file::StudyFile;
use crate::study::tables::{Answer, Role, Tables, Value, free_text, name};

/// Columns of a table of answers.
const COLUMNS: [&str; 16] = [
    "participant",
    "front",
    "excluded",
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
    "text",
    "ms",
];
/// Those that every such table has.
const ALWAYS: [&str; 6] = ["participant", "front", "excluded", "page", "question", "value"];

/// The answers of a part; none if nothing is left of it.
pub(super) fn part(
    tables: &Tables,
    analysis: &Analysis,
    part: &str,
    file: &str,
    detail: Detail,
) -> Option<Sheet> {
    let is_ours = |row: &&Answer| row.part == part && detail.has(&row.question);
    let rows: Vec<Vec<String>> =
        tables.answers.iter().filter(is_ours).map(|row| cells(row, analysis).to_vec()).collect();
    (!rows.is_empty()).then(|| Sheet::new((file.to_owned(), "an answer"), &COLUMNS, &ALWAYS, rows))
}

fn cells(row: &Answer, analysis: &Analysis) -> [String; 16] {
    let (role, wanted) = match row.trial.map(|trial| trial.role) {
        None => ("", None),
        Some(Role::Ordinary) => ("ordinary", None),
        Some(Role::Repeat) => ("repeat", None),
        Some(Role::Catch(answer)) => ("catch", Some(answer)),
    };
    let shown = |text: &Option<String>| text.clone().unwrap_or_default();
    let (value, text) = match &row.value {
        None => (String::new(), String::new()),
        Some(Value::Number(value)) => (value.to_string(), String::new()),
        Some(Value::Text(text)) => (String::new(), free_text(text)),
    };
    [
        row.participant.clone(),
        name(&row.front),
        analysis.exclusions.has(&row.participant).to_string(),
        row.page.clone(),
        number(row.trial.map(|trial| trial.position)),
        role.to_owned(),
        number(wanted),
        shown(&row.shown.gait),
        shown(&row.shown.scene),
        shown(&row.shown.condition),
        shown(&row.shown.emotion),
        shown(&row.shown.body),
        row.question.clone(),
        value,
        text,
        number(row.ms),
    ]
}

/// The scores of questionnaires; none without one.
pub(super) fn scores(study: &StudyFile, tables: &Tables, file: String) -> Result<Option<Sheet>, Error> {
    let rows: Vec<Vec<String>> = scores_of(study, tables)?
        .into_iter()
        .map(|row| {
            vec![row.participant, row.part, row.page, row.questionnaire, row.score, row.value.to_string()]
        })
        .collect();
    let columns = ["participant", "part", "page", "questionnaire", "score", "score_value"];
    Ok((!rows.is_empty()).then(|| Sheet::new((file, "a score of a participant"), &columns, &columns, rows)))
}

pub(super) fn number<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}
