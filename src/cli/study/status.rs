//! `gaitway study status`: a running or finished study at a glance.

use super::super::output::{say, say_json};
use crate::Error;
use crate::study::store::{Overview, Person, Reading};
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `gaitway study status`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study status run1/\n  gaitway study status run1/ --json\n\nIt may be asked while the \
                        study runs. Codes lead to participants: keep the list to yourself."
)]
pub(super) struct Arguments {
    /// Folder of the study's data
    #[arg(value_name = "DIR")]
    data: PathBuf,
    /// Also list the participants
    #[arg(long)]
    people: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Outcome {
    study: String,
    version: u32,
    /// SHA-256 of study file, texts and libraries.
    hash: String,
    #[serde(flatten)]
    overview: Overview,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    people: Vec<Person>,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let reading = Reading::open(&arguments.data)?;
    let overview = reading.overview().map_err(super::opening::trouble)?;
    let people = if arguments.people { reading.people() } else { Vec::new() };
    let current = reading.versions().last().map(|version| (version.number, version));
    let (version, study, hash) = current.map_or((0, String::new(), String::new()), |(number, version)| {
        (number, version.study.file.study.id.clone(), version.hash.clone())
    });
    let outcome = Outcome { study, version, hash, overview, people };
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome);
    }
    Ok(true)
}

fn print(outcome: &Outcome) {
    let Outcome { overview, .. } = outcome;
    say(&format!("study         {}, version {} ({:.8})", outcome.study, outcome.version, outcome.hash));
    let admission = match (overview.is_closed, overview.is_admitting) {
        (true, _) => "closed by an operator",
        (false, true) => "open",
        (false, false) => "closed: every place is taken or answered",
    };
    say(&format!("admission     {admission}"));
    say(&format!("places        {} given, {} more are needed if all stay", overview.places, overview.needs));
    for (state, count) in &overview.states {
        say(&format!("              {count} {state}"));
    }
    for (part, (fewest, most)) in &overview.answered {
        let wanted =
            overview.at_least.get(part).map_or_else(String::new, |wanted| format!(" ({wanted} wanted)"));
        say(&format!("{part:<13} {fewest} to {most} answers of each stimulus{wanted}"));
    }
    if overview.faults > 0 {
        say(&format!("faults        {} stimuli could not be shown", overview.faults));
    }
    if let Some(days) = overview.links_days {
        say(&format!("links         the oldest platform id is deleted in {days} days"));
    }
    for Person { code, state, page, silent_ms, .. } in &outcome.people {
        say(&format!("{code}  {:<12} {page:<16} silent for {} s", state.name(), silent_ms / 1000));
    }
}
