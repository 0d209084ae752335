//! `gaitway validate`: the tests of pedestrian science, and recorded crowds.

use super::output::{note, say, say_json, table};
use super::progress::Progress;
use super::scene::PlaceArguments;
use crate::Error;
use crate::validate::judge::Outcome;
use crate::validate::scene::Equipment;
use crate::validate::{DRAWS, Options, Validation, report, run as run_tests, tests};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `gaitway validate`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway validate\n  gaitway validate rimea-4 lanes --out report\n  gaitway validate --quick \
                  --backend cpu --json\n\nExit code 1 when a value misses its criterion in more than one draw of ten. Recorded crowds are read from --data, \
                  GAITWAY_DATA or ../shared/data; without them their tests are left out.\ngaitway is no certified \
                  evacuation tool."
)]
pub(super) struct Arguments {
    /// Tests by name (see --list); none: all
    #[arg(value_name = "TEST")]
    tests: Vec<String>,
    /// Write the report (validation.md and its figures) into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Folder with recorded crowds (crowd-juelich, crowd-ucy)
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Draws of each test: other places and random numbers, scenes turned and moved
    #[arg(long, value_name = "N", default_value_t = DRAWS as u32, value_parser = clap::value_parser!(u32).range(1..=1000))]
    draws: u32,
    /// Fewer people, shorter runs, one draw
    #[arg(long, conflicts_with = "draws")]
    quick: bool,
    /// Name the tests and stop
    #[arg(long)]
    list: bool,
    #[command(flatten)]
    place: PlaceArguments,
    /// Print one JSON object: {tests: [{name, value, unit, criterion, origin, pass, draws, passes, range, larger}], device}
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Json<'a> {
    tests: &'a [Outcome],
    device: &'a str,
}

#[derive(Debug, Serialize)]
struct List {
    tests: Vec<Named>,
}

#[derive(Debug, Serialize)]
struct Named {
    name: &'static str,
    title: &'static str,
}

/// Runs the subcommand; false when a value misses its criterion.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    if arguments.list {
        if arguments.json {
            let tests = tests::ALL.iter().map(|test| Named { name: test.name, title: test.title }).collect();
            say_json(&List { tests })?;
            return Ok(true);
        }
        let rows: Vec<_> = tests::ALL.iter().map(|t| vec![t.name.to_owned(), t.title.to_owned()]).collect();
        table(&["test", "what"], &rows);
        return Ok(true);
    }
    let from_environment = || std::env::var_os("GAITWAY_DATA").map(PathBuf::from);
    let beside = PathBuf::from("../shared/data");
    let options = Options {
        tests: arguments.tests.clone(),
        is_quick: arguments.quick,
        draws: arguments.draws as usize,
        data: arguments.data.clone().or_else(from_environment).or_else(|| beside.is_dir().then_some(beside)),
    };
    let (backend, device) = arguments.place.get()?;
    let stage = Equipment::new(backend, device)?;
    if let Some(reason) = &stage.fallback {
        note(&format!(
            "note: simulating on the CPU, since {reason} (`gaitway devices` says what is missing)"
        ));
    }
    let mut progress = Progress::new("validating");
    let validation = run_tests(&stage, &options, &mut |what, share| progress.at(what, share))?;
    drop(progress);
    for skipped in &validation.skipped {
        note(&format!("left out: {skipped}"));
    }
    if let Some(folder) = &arguments.out {
        let page = report::write(folder, &validation, &options)?;
        note(&format!("wrote {}", page.display()));
    }
    if arguments.json {
        say_json(&Json { tests: &validation.outcomes, device: &validation.device })?;
    } else {
        print(&validation);
    }
    Ok(validation.pass())
}

fn print(validation: &Validation) {
    let row = |outcome: &Outcome| {
        let (verdict, draws) = match (outcome.is_judged(), outcome.pass) {
            (false, _) => ("", String::new()),
            (true, true) => ("pass", format!("{} of {}", outcome.passes, outcome.draws)),
            (true, false) => ("FAIL", format!("{} of {}", outcome.passes, outcome.draws)),
        };
        vec![
            outcome.name.clone(),
            format!("{:.3}", outcome.value),
            verdict.to_owned(),
            draws,
            outcome.criterion.clone().unwrap_or_else(|| "shown only".to_owned()),
            outcome.unit.to_owned(),
        ]
    };
    let rows: Vec<_> = validation.outcomes.iter().map(row).collect();
    table(&["value", "found", "", "draws", "criterion", "unit"], &rows);
    let (failed, judged) = (validation.failed().count(), validation.judged());
    say(&format!("device  {}", validation.device));
    say(&match failed {
        0 => format!("all {judged} judged values meet their criteria"),
        failed => format!("{failed} of {judged} judged values fail"),
    });
    say("gaitway is no certified evacuation tool");
}
