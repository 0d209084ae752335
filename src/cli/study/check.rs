//! `gaitway study check`: what is wrong with a study, and what it asks of people.

use super::super::output::{say, say_json};
use super::beside::{Beside, Gaits};
use crate::Error;
use crate::study;

/// Arguments of `gaitway study check`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study check mine/\n  gaitway study check eva-agents\n  gaitway study check mine/ --gaits \
                  120 --json\n\nExit code 1: the study has errors, or lacks what people need to take part."
)]
pub(super) struct Arguments {
    /// Study file, folder with study.toml, or eva-gaits or eva-agents
    #[arg(value_name = "STUDY")]
    study: String,
    #[command(flatten)]
    gaits: Gaits,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let study = super::beside::study(&arguments.study)?;
    let beside = Beside::of(&study, &arguments.gaits)?;
    let report = study::check(&study, &beside.materials);
    if arguments.json {
        say_json(&report)?;
        return Ok(report.is_ready());
    }
    say(report.to_string().trim_end());
    say(match (report.is_valid(), report.is_ready()) {
        (false, _) => "result: it has errors",
        (true, false) => {
            "result: it can be simulated; people cannot take part before the missing is filled in"
        }
        (true, true) => "result: people can take part",
    });
    Ok(report.is_ready())
}
