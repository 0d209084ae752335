//! `gaitway study analyse`: the planned analysis of a study's answers.

use super::super::output::{say, say_json};
use super::folder;
use crate::Error;
use crate::study::analyse::{analyse, markdown};
use std::path::PathBuf;

/// Arguments of `gaitway study analyse`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study simulate eva-agents --effect eva-g=0.9 --out run/\n  gaitway study analyse run/\n  gaitway \
                  study analyse run/ --out results.md\n\nThe tests are those of [[analysis.test]] in the study file. Ratings of gaits \
                  become labels by `gaitway gait ratings run/ratings.csv`.\nExit code 1: fewer people or answers than the study's plan needs."
)]
pub(super) struct Arguments {
    /// Folder with study.toml, answers.csv and participants.csv
    #[arg(value_name = "DIR")]
    data: PathBuf,
    /// Page to write (Markdown)
    #[arg(long, value_name = "RESULTS.md")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let (study, tables) = folder::read(&arguments.data)?;
    let found = analyse(&study.file, &tables)?;
    let page = markdown(&found);
    if let Some(path) = &arguments.out {
        folder::write_text(path, &page)?;
    }
    if arguments.json {
        say_json(&found)?;
    } else {
        say(page.trim_end());
    }
    Ok(!found.is_short)
}
