//! `gaitway study analyse`: the planned analysis of a study's answers.

use super::super::gait::ratings::label;
use super::super::output::{note, say, say_json};
use super::super::outputs::make_folder;
use super::super::scene::library;
use super::super::usage;
use super::folder::{self, FrontArguments};
use crate::Error;
use crate::perception::ratings;
use crate::study::Study;
use crate::study::analyse::{Analysis, analyse_chosen, html, markdown, rating_sheet};
use crate::study::tables::{Tables, name};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Arguments of `gaitway study analyse`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study simulate eva-agents --effect eva-g=0.9 --out run/\n  gaitway study analyse run/\n  gaitway \
                  study analyse run/ --out report/\n  gaitway study analyse run/ --out results.md\n  gaitway study analyse run/ \
                  --library library.glb --rated rated.glb\n\nThe tests are those of [[analysis.test]] in the study file. Ratings of \
                  gaits become labels as by `gaitway gait ratings`.\nPeople and simulated participants are never in one analysis. Where \
                  people took part in a browser and in a headset, --front says who counts.\nExit code 1: fewer people or answers than a study's plan needs."
)]
pub(super) struct Arguments {
    /// Folders with study.toml, answers.csv and participants.csv; several stand in one report
    #[arg(value_name = "DIR", required = true)]
    data: Vec<PathBuf>,
    /// Folder for results.md, results.json and index.html with figures; a name that ends in .md is the page alone
    #[arg(long, value_name = "REPORT")]
    out: Option<PathBuf>,
    #[command(flatten)]
    front: FrontArguments,
    /// The library whose gaits were rated
    #[arg(long, value_name = "LIB.glb", requires = "rated")]
    library: Option<PathBuf>,
    /// That library with the ratings and labels, to write
    #[arg(long, value_name = "RATED.glb", requires = "library")]
    rated: Option<PathBuf>,
    /// Print one JSON object; of several folders a list
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let mut found: Vec<Analysis> = Vec::new();
    for data in &arguments.data {
        let (study, tables) = folder::read(data)?;
        let chosen = arguments.front.choose(&tables, data)?;
        for (front, count) in &chosen.left_out {
            let (data, s, front) = (data.display(), if *count == 1 { "" } else { "s" }, name(front));
            note(&format!("note: {data}: left out: {count} participant{s} of the front {front}"));
        }
        found.push(analyse_chosen(&study.file, &chosen)?);
        if let (Some(library), Some(rated)) = (&arguments.library, &arguments.rated)
            && (study.file.analysis.ratings.is_some() || arguments.data.len() == 1)
        {
            close_the_loop(&study, &chosen.tables, library, rated)?;
        }
    }
    let page = found.iter().map(markdown).collect::<Vec<_>>().join("\n");
    if let Some(out) = &arguments.out {
        write(out, &found, &page)?;
    }
    match &found[..] {
        [one] if arguments.json => say_json(one)?,
        all if arguments.json => say_json(&all)?,
        _ => say(page.trim_end()),
    }
    Ok(!found.iter().any(|one| one.is_short))
}

/// Writes the page alone, or a folder of it, its numbers and its figures.
fn write(out: &Path, found: &[Analysis], page: &str) -> Result<(), Error> {
    if out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("md")) {
        return folder::write_text(out, page);
    }
    let json = match found {
        [one] => serde_json::to_string_pretty(one),
        all => serde_json::to_string_pretty(all),
    };
    let figures = html(&found.iter().collect::<Vec<_>>());
    make_folder(out)?;
    folder::write_text(&out.join("results.md"), page)?;
    folder::write_text(&out.join("results.json"), &(json.unwrap_or_default() + "\n"))?;
    folder::write_text(&out.join("index.html"), &figures)
}

/// The library with the ratings of the participants that the analysis keeps.
fn close_the_loop(study: &Study, tables: &Tables, path: &Path, rated: &Path) -> Result<(), Error> {
    let asked = study.file.analysis.ratings.as_ref().zip(rating_sheet(&study.file, tables)?);
    let Some((asked, sheet)) = asked else {
        return Err(usage(
            format!("--rated {}: the study asks for no ratings", rated.display()),
            "a study of gaits has [analysis] ratings in its file",
        ));
    };
    let library = library(Some(path))?;
    let names: HashSet<String> = library.gaits().iter().map(|gait| gait.name.clone()).collect();
    let options = ratings::Options { videos: Some(&names), skip_bad: false };
    let responses = ratings::parse(&sheet, "the ratings of the study", &options)?.responses;
    let unrated = label(&library, &ratings::analyse(&responses, asked.theta), Some(rated))?;
    if !unrated.is_empty() {
        note(&format!("note: {} gaits of the library were not rated and stay as they are", unrated.len()));
    }
    Ok(())
}
