//! The data of studies with people as tables: `gaitway.study`.

use crate::error::{Fault, Result};
use crate::table::Table;
use arrow_array::{ArrayRef, BooleanArray, Float64Array, StringArray, UInt32Array};
use gaitway::low_level::study::file::Front;
use gaitway::low_level::study::tables::{ANSWERS, Answer, PARTICIPANTS, Role, Tables, Value, read};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The tables of answers and of participants of a folder of data.
#[pyfunction]
pub(crate) fn study_tables(py: Python<'_>, folder: PathBuf) -> PyResult<(Table, Table)> {
    let tables = py.detach(|| -> Result<Tables> {
        let text = |name: &str| text_of(&folder.join(name));
        Ok(read(&text(ANSWERS)?, &text(PARTICIPANTS)?, &folder.display().to_string())?)
    })?;
    Ok((answers(&tables)?, participants(&tables)?))
}

fn text_of(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|error| {
        Fault::failed(
            format!("cannot read {}: {error}", path.display()),
            "give a folder of `gaitway study simulate` or `gaitway study serve`",
        )
    })
}

/// A column of words.
fn words<T>(rows: &[T], word: impl Fn(&T) -> Option<&str>) -> ArrayRef {
    Arc::new(rows.iter().map(word).collect::<StringArray>())
}

const fn front(front: Front) -> &'static str {
    match front {
        Front::Web => "web",
        Front::Headset => "headset",
        Front::Simulated => "simulated",
    }
}

fn answers(tables: &Tables) -> Result<Table> {
    let all = &tables.answers;
    let role = |answer: &Answer| {
        answer.trial.map(|trial| match trial.role {
            Role::Ordinary => "ordinary",
            Role::Repeat => "repeat",
            Role::Catch(_) => "catch",
        })
    };
    let text = |answer: &Answer| match &answer.value {
        Some(Value::Text(text)) => Some(text.clone()),
        _ => None,
    };
    #[allow(clippy::cast_precision_loss, reason = "answers are far below 2^53")]
    let numbers: Float64Array =
        all.iter().map(|answer| answer.number().map(|number| number as f64)).collect();
    let positions: UInt32Array = all.iter().map(|answer| answer.trial.map(|trial| trial.position)).collect();
    let milliseconds: UInt32Array = all.iter().map(|answer| answer.ms).collect();
    Table::of_columns(vec![
        ("participant", "", words(all, |answer| Some(&answer.participant))),
        ("front", "", words(all, |answer| Some(front(answer.front)))),
        ("part", "", words(all, |answer| Some(&answer.part))),
        ("page", "", words(all, |answer| Some(&answer.page))),
        ("position", "", Arc::new(positions)),
        ("role", "", Arc::new(all.iter().map(role).collect::<StringArray>())),
        ("gait", "", words(all, |answer| answer.shown.gait.as_deref())),
        ("scene", "", words(all, |answer| answer.shown.scene.as_deref())),
        ("condition", "", words(all, |answer| answer.shown.condition.as_deref())),
        ("emotion", "", words(all, |answer| answer.shown.emotion.as_deref())),
        ("body", "", words(all, |answer| answer.shown.body.as_deref())),
        ("question", "", words(all, |answer| Some(&answer.question))),
        ("value", "", Arc::new(numbers)),
        ("text", "", Arc::new(all.iter().map(text).collect::<StringArray>())),
        ("ms", "ms", Arc::new(milliseconds)),
    ])
}

fn participants(tables: &Tables) -> Result<Table> {
    let all = &tables.participants;
    let placed: Vec<bool> = all.iter().map(|one| one.placed).collect();
    Table::of_columns(vec![
        ("participant", "", words(all, |one| Some(&one.participant))),
        ("front", "", words(all, |one| Some(front(one.front)))),
        ("state", "", words(all, |one| Some(one.state.name()))),
        ("placed", "", Arc::new(BooleanArray::from(placed))),
    ])
}
