//! `gaitway study export`: a study's data as a dataset.

use super::super::output::{note, say, say_json};
use super::super::outputs::make_folder;
use super::beside;
use super::folder::{self, FrontArguments};
use crate::Error;
use crate::study::export::{Note, Options, export};
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `gaitway study export`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study export run/ --out data/\n\nThe dataset follows Psych-DS: one CSV a part, every column \
                  explained in dataset_description.json. analysis/ has an R script with mixed models, the planned analysis and, for \
                  ratings, ratings.csv.\nWhere fewer than 5 people share gender and age, ages are given in bands; where that does not help, they are left out."
)]
pub(super) struct Arguments {
    /// Folder with study.toml, answers.csv and participants.csv
    #[arg(value_name = "DIR")]
    data: PathBuf,
    /// Folder to write
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    front: FrontArguments,
    /// Export gender and exact age even where fewer than 5 people share both
    #[arg(long)]
    small_cells: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Outcome {
    notes: Vec<Note>,
    files: Vec<PathBuf>,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let (study, tables) = folder::read(&arguments.data)?;
    let texts = beside::texts(&study)?.texts;
    let fronts = arguments.front.fronts();
    // asked here for an error that names the folder
    arguments.front.choose(&tables, &arguments.data)?;
    let dataset = export(&study, &tables, &texts, Options { small_cells: arguments.small_cells, fronts })?;
    let mut files = Vec::new();
    for file in &dataset.files {
        let path = arguments.out.join(&file.path);
        if let Some(folder) = path.parent() {
            make_folder(folder)?;
        }
        folder::write_text(&path, &file.text)?;
        files.push(path);
    }
    let outcome = Outcome { notes: dataset.notes, files };
    if arguments.json {
        say_json(&outcome)?;
        return Ok(true);
    }
    for file in &outcome.files {
        say(&format!("written  {}", file.display()));
    }
    for one in &outcome.notes {
        note(&format!("note: {one}"));
    }
    Ok(true)
}
