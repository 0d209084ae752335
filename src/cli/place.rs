//! `gaitway scene`: scenes of one's own, other programs' scenes as scenario files, and the built-in ones listed.

use super::output::{note, say, say_json, thousands};
use super::{outputs, scenario, scenes, usage};
use crate::Error;
use crate::export::AtomicFile;
use crate::scenario::menge;
use clap::{Args, Subcommand};
use serde::Serialize;
use std::io::Write as _;
use std::path::PathBuf;

/// Arguments of `gaitway scene`.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write a scenario to begin with: a hall, a street, a museum, a corridor
    New(scenario::NewArguments),
    /// Say whether scenario files are right and what they contain, without simulating
    Check(scenario::CheckArguments),
    /// Print a scene with its generated place written out, to be edited
    Show(scenario::ShowArguments),
    /// Print all keys of a scenario file: as JSON Schema for editors, or as a page
    Schema(scenario::SchemaArguments),
    /// Take a Menge project over: its scene and behaviour as a scenario file
    Import(ImportArguments),
    /// List the built-in scenes
    List(ListArguments),
}

/// Arguments of `gaitway scene list`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  gaitway scene list\n  gaitway scene list --json")]
struct ListArguments {
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Arguments of `gaitway scene import`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway scene import 4square.xml --out 4square.toml\n  gaitway simulate 4square.toml \
                  --seconds 40\n\nWhat is approximated or not \
                  taken over is named with file and line; --json has it as fields."
)]
struct ImportArguments {
    /// A Menge project: the XML that names scene and behaviour
    #[arg(value_name = "PROJECT.xml")]
    project: PathBuf,
    /// Where to write the scenario [default: the project's name with .toml, here]
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Seed of the draws that the scene leaves open
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// What was written.
#[derive(Debug, Serialize)]
struct Outcome {
    file: PathBuf,
    #[serde(flatten)]
    report: menge::Report,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    match &arguments.command {
        Command::New(arguments) => scenario::new(arguments),
        Command::Check(arguments) => scenario::check(arguments),
        Command::Show(arguments) => scenario::show(arguments),
        Command::Schema(arguments) => scenario::schema(arguments),
        Command::Import(arguments) => import(arguments),
        Command::List(arguments) => scenes::list(arguments.json),
    }
}

fn import(arguments: &ImportArguments) -> Result<bool, Error> {
    let imported = menge::import(&arguments.project, arguments.seed)?;
    let file = match &arguments.out {
        Some(out) => out.clone(),
        None => PathBuf::from(format!("{}.toml", imported.scenario.name)),
    };
    if file.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("toml")) {
        return Err(usage(format!("--out {}: a scenario ends in .toml", file.display()), "use FILE.toml"));
    }
    if arguments.out.is_none() {
        outputs::free(&file)?;
    }
    let text = imported.scenario.to_toml()?;
    let mut target = AtomicFile::create(&file)?;
    target
        .write_all(text.as_bytes())
        .map_err(|source| crate::export::Error::Write { path: file.clone(), source })?;
    target.finish()?;
    let outcome = Outcome { file, report: imported.report };
    if arguments.json {
        say_json(&outcome)?;
        return Ok(true);
    }
    let Outcome { file, report } = &outcome;
    say(&format!("written       {}", file.display()));
    say(&format!(
        "agents        {} ({} with an end to their way)",
        thousands(report.agents as u64),
        report.with_an_end
    ));
    say(&format!("obstacles     {}", thousands(report.obstacles as u64)));
    for one in &report.approximated {
        say(&format!("approximated  {one}"));
    }
    for line in &report.notes {
        say(&format!("note          {line}"));
    }
    for line in &report.unsupported {
        note(&format!("not taken over: {line}"));
    }
    Ok(true)
}
