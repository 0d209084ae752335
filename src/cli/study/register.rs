//! `gaitway study register`: a study's registration, before its first participant has a place.

use super::super::failed;
use super::super::output::{say, say_json};
use super::beside::{Beside, Gaits, study};
use super::folder::write_text;
use super::opening;
use crate::Error;
use crate::study::check::Severity;
use crate::study::plan::Ending;
use crate::study::protocol::State;
use crate::study::register::{Registration, register};
use crate::study::store::{Opening, Reading};
use crate::study::{BLANK, Study, check};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `gaitway study register`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study register mine/ --out registration.md\n  gaitway study register mine/ --data run1/ --out \
                  registration.md\n\nThe headings are those of the template \"OSF Preregistration\". What the study file does not say \
                  is marked TO FILL IN. [registration] in the file has authors, hypotheses and smallest_w, from which the power is \
                  computed.\nExit code 1: the study has errors, the data are of other files, or a participant has had a place."
)]
pub(super) struct Arguments {
    /// Study file, or folder with study.toml
    #[arg(value_name = "STUDY")]
    study: String,
    /// Library of gaits to take in place of the one that the study names
    #[arg(long, value_name = "LIB.glb")]
    library: Option<PathBuf>,
    /// Folder of the study's data: it must be of these files, and no participant may have had a place
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// File to write, Markdown [default: standard output]
    #[arg(long, value_name = "PAGE.md", conflicts_with = "json")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Outcome {
    study: String,
    version: u32,
    /// SHA-256 of study file, texts and libraries; none where one of them is not there.
    hash: Option<String>,
    /// How many blanks the page has.
    blanks: usize,
    page: String,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let study = study(&arguments.study)?;
    let beside = Beside::of(&study, &Gaits::of(arguments.library.clone()))?;
    plannable(&study, &beside)?;
    let libraries = opening::libraries(&study, arguments.library.as_deref());
    let is_whole = study.folder.is_some() && libraries.values().all(|path| path.is_file());
    let opening = Opening { study, materials: beside.materials, libraries, rows: None };
    let hash = if is_whole { Some(opening.hash()?) } else { None };
    if let Some(data) = &arguments.data {
        untouched(data, hash.as_deref())?;
    }
    let Opening { study, materials, .. } = &opening;
    let data = arguments.data.as_ref().map(|data| data.display().to_string());
    let page = register(&Registration { study, materials, hash: hash.as_deref(), data: data.as_deref() })?;
    let blanks = page.matches(BLANK).count();
    if arguments.json {
        let (id, version) = (study.file.study.id.clone(), study.file.study.version);
        say_json(&Outcome { study: id, version, hash, blanks, page })?;
        return Ok(true);
    }
    match &arguments.out {
        Some(out) => {
            write_text(out, &page)?;
            say(&format!("written  {} ({blanks} blanks to fill in)", out.display()));
        }
        None => say(page.trim_end()),
    }
    Ok(true)
}

/// A study with errors is not registered. What people still have to fill in may be missing.
fn plannable(study: &Study, beside: &Beside) -> Result<(), Error> {
    let report = check(study, &beside.materials);
    match report.notes.iter().find(|note| note.severity == Severity::Error) {
        Some(first) => Err(failed(first.to_string(), "`gaitway study check` lists all errors")),
        None => Ok(()),
    }
}

/// The data are of these files, and no participant has had a place.
fn untouched(data: &Path, hash: Option<&str>) -> Result<(), Error> {
    let reading = Reading::open(data)?;
    let Some(version) = reading.versions().last() else { return Ok(()) };
    if hash != Some(version.hash.as_str()) {
        let message = format!(
            "{} holds version {} with the hash {:.8}, and the study's files have {:.8}",
            data.display(),
            version.number,
            version.hash,
            hash.unwrap_or("none")
        );
        let hint = format!("register the files that its participants will see: {}", version.folder.display());
        return Err(failed(message, hint));
    }
    let tables = reading.tables(None);
    // what a participant who withdrew had is deleted: it may have been a place
    let had_one =
        tables.participants.iter().filter(|one| one.placed || one.state == State::Ended(Ending::Withdrawn));
    match had_one.count() {
        0 => Ok(()),
        count => Err(too_late(data, count)),
    }
}

fn too_late(data: &Path, count: usize) -> Error {
    let s = if count == 1 { "participant has" } else { "participants have" };
    failed(
        format!("{}: {count} {s} had a place already", data.display()),
        "a registration comes before the first place; rehearse with a folder of data of its own, and delete that folder",
    )
}
