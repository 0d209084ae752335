//! `gaitway plan`: a sweep as a list of runs; what has become of them; what broken-off ones left.

use super::output::{say, say_json, thousands};
use super::{outputs, usage};
use crate::Error;
use crate::sweep::Plan;
use crate::sweep::folder::Folder;
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Age from which on a folder of a run that is not finished is taken to be left behind, s: a day.
const OLD: Duration = Duration::from_secs(86_400);

/// Arguments of `gaitway plan`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway plan sweep.toml --out plan.jsonl\n  gaitway run plan.jsonl --out runs\n  gaitway plan plan.jsonl \
                  --status --out runs\n  gaitway plan --clean --out runs\n\nA sweep.toml:\n  scenario = \"hall.toml\"\n  seconds = 60\n  \
                  seeds = 6\n  [vary]\n  population.agents = [200, 400]\n  condition = [\"baseline\", \"eva-g\"]\n\nThe plan \
                  is one file that needs no other; docs/sweeps.md has all keys."
)]
pub(super) struct Arguments {
    /// A sweep, or with --status a plan
    #[arg(value_name = "SWEEP.toml|PLAN.jsonl", required_unless_present = "clean")]
    file: Option<PathBuf>,
    /// Where to write the plan; with --status and --clean, the folder of the runs
    #[arg(long, value_name = "PLAN.jsonl|RUNS")]
    out: PathBuf,
    /// Say how many runs are done, and which are missing
    #[arg(long, conflicts_with = "clean")]
    status: bool,
    /// Remove what runs left that were broken off more than a day ago
    #[arg(long)]
    clean: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// What was planned.
#[derive(Debug, Serialize)]
struct Planned {
    plan: PathBuf,
    runs: usize,
    /// Combinations that came up again and were left out.
    repeated: usize,
    /// Keys that differ between runs.
    vary: Vec<String>,
}

/// How far a sweep is.
#[derive(Debug, Serialize)]
struct Status {
    runs: usize,
    done: usize,
    missing: usize,
    /// From the first to before the last number of each gap, as `run --index` takes them.
    missing_runs: Vec<[usize; 2]>,
    /// Folders of runs that are being done, or were broken off.
    unfinished: Vec<PathBuf>,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let Arguments { file, out, json, .. } = arguments;
    match file {
        _ if arguments.clean => clean(out, *json),
        Some(file) if arguments.status => status(file, out, *json),
        Some(file) => plan(file, out, *json),
        None => Err(usage("a sweep is missing", "gaitway plan sweep.toml --out plan.jsonl")),
    }
}

fn plan(file: &Path, out: &Path, json: bool) -> Result<bool, Error> {
    outputs::free(out)?;
    let plan = Plan::of_file(file)?;
    plan.write(out)?;
    let Plan { header, runs, repeated } = plan;
    let planned = Planned { plan: out.to_owned(), runs: runs.len(), repeated, vary: header.vary };
    if json {
        say_json(&planned)?;
        return Ok(true);
    }
    say(&format!(
        "runs     {} of {} s of {}",
        thousands(planned.runs as u64),
        header.seconds,
        header.scenario
    ));
    if !planned.vary.is_empty() {
        say(&format!("vary     {}", planned.vary.join(", ")));
    }
    if repeated > 0 {
        say(&format!("repeated {} combinations came up again and are left out", thousands(repeated as u64)));
    }
    say(&format!("plan     {}", out.display()));
    Ok(true)
}

fn status(file: &Path, out: &Path, json: bool) -> Result<bool, Error> {
    let (_, runs) = Plan::read(file, |_| true)?;
    let folder = Folder::at(out);
    let done = folder.done()?;
    let mut missing_runs: Vec<[usize; 2]> = Vec::new();
    for (number, _) in runs.iter().filter(|(_, run)| !done.contains(&run.key)) {
        match missing_runs.last_mut() {
            Some([_, end]) if end == number => *end += 1,
            _ => missing_runs.push([*number, *number + 1]),
        }
    }
    let missing: usize = missing_runs.iter().map(|[begin, end]| end - begin).sum();
    let unfinished = folder.unfinished()?;
    let status = Status { runs: runs.len(), done: runs.len() - missing, missing, missing_runs, unfinished };
    if json {
        say_json(&status)?;
        return Ok(true);
    }
    say(&format!("runs       {}", thousands(status.runs as u64)));
    say(&format!("done       {}", thousands(status.done as u64)));
    let gap = |[begin, end]: &[usize; 2]| {
        if begin + 1 == *end { begin.to_string() } else { format!("{begin}..{end}") }
    };
    let gaps: Vec<String> = status.missing_runs.iter().take(12).map(gap).collect();
    let more = if status.missing_runs.len() > gaps.len() { ", ..." } else { "" };
    let gaps = if gaps.is_empty() { String::new() } else { format!(" ({}{more})", gaps.join(",")) };
    say(&format!("missing    {}{gaps}", thousands(status.missing as u64)));
    say(&format!("unfinished {}", status.unfinished.len()));
    Ok(true)
}

fn clean(out: &Path, json: bool) -> Result<bool, Error> {
    let removed = Folder::at(out).clean(OLD)?;
    if json {
        say_json(&serde_json::json!({ "removed": removed }))?;
        return Ok(true);
    }
    for path in &removed {
        say(&format!("removed {}", path.display()));
    }
    if removed.is_empty() {
        say("nothing was left behind");
    }
    Ok(true)
}
