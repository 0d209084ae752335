//! A study's data as a dataset that others can read: Psych-DS, with the study file, an R script and the planned analysis.
//!
//! ```text
//! dataset_description.json      what it is, every column: description, unit, range, levels
//! README.md, CHANGES.md
//! data/study-ID_task-PART_data.csv                 one row an answer, one file a part
//! data/study-ID_description-participants_data.csv  one row a participant
//! data/study-ID_description-scores_data.csv        one row a participant, page and score of a questionnaire
//! materials/                    study file, consent texts
//! analysis/                     models.R, results of the planned analysis, ratings.csv for `gait ratings`
//! ```
//!
//! Based on: Psych-DS 1.5.1 (psych-ds.github.io). A dataset holds no participant that withdrew, unless the study file keeps their answers.
//!
//! ```
//! use gaitway::study::export::{Options, export};
//! use gaitway::study::plan::Plan;
//! use gaitway::study::simulate::{Habits, Minds, Setup, run};
//! use gaitway::study::tables::Tables;
//! use gaitway::study::{Materials, Study};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let study = Study::builtin("eva-agents")?;
//! let plan = Plan::of(&study.file, &Materials::default())?;
//! let setup = Setup { participants: 24, at_once: 6, habits: Habits::default(), seed: 1 };
//! let (_, run) = run(&plan, &Minds::default(), setup)?;
//! let dataset = export(&study, &Tables::simulated(&run), &Materials::default().texts, Options::default())?;
//! assert!(dataset.files.iter().any(|file| file.path == "data/study-evaagents_task-scenes_data.csv"));
//! # Ok(())
//! # }
//! ```

mod columns;
mod describe;
mod names;
mod notes;
mod people;
mod script;
mod sheet;
mod texts;

use super::analyse::{self, Analysis, Error, analyse, html, markdown, rating_sheet};
use super::tables::{Chosen, Fronts, Tables};
use super::{FILE_NAME, Study};
use names::Names;
pub use notes::{Note, SMALLEST_CELL};
use people::Detail;
use std::collections::BTreeMap;

/// What an export is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// Give gender and exact age away even where fewer than [`SMALLEST_CELL`] people share both.
    pub small_cells: bool,
    /// Whose answers are wanted, as [`Tables::choose`] takes it.
    pub fronts: Option<Fronts>,
}

/// A file of a dataset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// From the dataset's folder, with `/`.
    pub path: String,
    /// What it holds.
    pub text: String,
}

/// A dataset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dataset {
    /// Its files.
    pub files: Vec<File>,
    /// What a person has to know before it is handed on.
    pub notes: Vec<Note>,
}

/// The dataset of a study. `texts` are the consent texts that are known, by the name of their file.
///
/// # Errors
/// As [`Tables::choose`], which keeps people and simulated participants apart, and as [`analyse()`]: answers that do not fit the
/// study file.
pub fn export(
    study: &Study,
    tables: &Tables,
    texts: &BTreeMap<String, String>,
    options: Options,
) -> Result<Dataset, Error> {
    let Chosen { tables, left_out } = &tables.choose(options.fronts)?;
    let analysis = analyse(&study.file, tables)?;
    let tables = analyse::not_withdrawn(&study.file, tables);
    let detail = if options.small_cells { Detail::Exact } else { Detail::of(&tables) };
    let names = Names::new(&study.file, &tables);
    let mut sheets = Vec::new();
    for (part, file) in &names.parts {
        sheets.extend(columns::part(&tables, &analysis, part, file, detail));
    }
    sheets.push(people::participants(&study.file, &tables, &analysis, names.of("participants"), detail)?);
    sheets.extend(columns::scores(&study.file, &tables, names.of("scores"))?);
    let mut notes = notes(&tables, &analysis, detail);
    notes.extend(left_out.iter().map(|(&front, &count)| Note::LeftOut { front, count }));
    let mut files = vec![
        file("dataset_description.json", describe::dataset(&study.file, &analysis, &sheets)?),
        file("README.md", texts::readme(&study.file, &analysis, &sheets, &notes)),
        file("CHANGES.md", texts::changes(&study.file)),
    ];
    files.extend(sheets.iter().map(|sheet| file(&format!("data/{}", sheet.file), sheet.csv())));
    files.push(file(&format!("materials/{FILE_NAME}"), study.text.clone()));
    // the name of a consent text comes from the study file: only its last piece names a file here
    let last = |name: &str| name.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    files.extend(texts.iter().map(|(name, text)| file(&format!("materials/{}", last(name)), text.clone())));
    files.extend(results(study, &tables, &analysis, &names)?);
    Ok(Dataset { files, notes })
}

fn file(path: &str, text: String) -> File {
    File { path: path.to_owned(), text }
}

fn results(study: &Study, tables: &Tables, analysis: &Analysis, names: &Names) -> Result<Vec<File>, Error> {
    let json = serde_json::to_string_pretty(analysis).unwrap_or_default() + "\n";
    let mut files = vec![
        file("analysis/models.R", script::script(&study.file, names)),
        file("analysis/results.md", markdown(analysis)),
        file("analysis/results.json", json),
        file("analysis/index.html", html(&[analysis])),
    ];
    if let Some(ratings) = rating_sheet(&study.file, tables)? {
        files.push(file("analysis/ratings.csv", ratings));
    }
    Ok(files)
}

fn notes(tables: &Tables, analysis: &Analysis, detail: Detail) -> Vec<Note> {
    let mut notes = Vec::new();
    if let Some(smallest) = people::smallest_cell(tables).filter(|&smallest| smallest < SMALLEST_CELL) {
        notes.push(match detail {
            Detail::Exact => Note::SmallCells { smallest },
            Detail::Bands => Note::Banded { smallest },
            Detail::Gender | Detail::Nothing => {
                let mut questions = people::asked(tables);
                questions.retain(|question| !detail.has(question));
                Note::Withheld { questions, smallest }
            }
        });
    }
    let count =
        tables.answers.iter().filter(|row| matches!(row.value, Some(super::tables::Value::Text(_)))).count();
    if count > 0 {
        notes.push(Note::FreeTexts { count });
    }
    if analysis.participants.is_simulated {
        notes.push(Note::Simulated);
    }
    notes
}
