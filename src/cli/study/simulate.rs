//! `gaitway study simulate`: a whole study with simulated participants, through the protocol that people go through.

use super::super::output::{note, say, say_json, thousands};
use super::super::scene::seed;
use super::super::{failed, usage};
use super::beside::{Beside, Gaits};
use crate::Error;
use crate::emotion::Emotion;
use crate::random::Random;
use crate::study::check::{Report, Severity};
use crate::study::plan::{Plan, StepKind};
use crate::study::simulate::{Habits, LinearModel, Minds, RatingModel, Run, Setup, hazard, run as simulate};
use crate::study::tables::Tables;
use crate::study::{self, Study};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What a labelled gait shows of its emotion, and of the others, to simulated raters: about 4.5 and 1.7 of five points.
const SHOWN: [f64; 2] = [1.5, -1.3];
/// Participants that arrive for each that is needed, unless said otherwise.
const ARRIVALS: u32 = 4;

/// Arguments of `gaitway study simulate`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study simulate eva-gaits --drop 0.3 --at-once 100\n  gaitway study simulate mine/ --careless \
                  0.05 --seed 2 --out run/\n  gaitway study simulate eva-agents --effect eva-o=0.5,eva-g=0.9 --out run/\n\nSimulated \
                  participants are no people. They tell whether the plan holds, how many people it needs and what the \
                  analysis would find."
)]
pub(super) struct Arguments {
    /// Study file, folder with study.toml, or eva-gaits or eva-agents
    #[arg(value_name = "STUDY")]
    study: String,
    #[command(flatten)]
    gaits: Gaits,
    /// Most participants that arrive [default: four times as many as are needed]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    participants: Option<u32>,
    /// Participants at the same time
    #[arg(long, default_value_t = 30, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    at_once: u32,
    /// Share that leaves before the end, 0 to 0.9
    #[arg(long, default_value_t = 0.0, value_name = "SHARE")]
    drop: f64,
    /// Share that answers at random, 0 to 1
    #[arg(long, default_value_t = 0.0, value_name = "SHARE")]
    careless: f64,
    /// What conditions add to answers about scenes, points of the scale
    #[arg(long, value_name = "CONDITION=POINTS,...", value_delimiter = ',', value_parser = effect)]
    effect: Vec<(String, f64)>,
    /// Seed of all draws of the participants
    #[arg(long, default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// Folder for the study file, answers.csv, participants.csv and, of ratings, ratings.csv
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// `CONDITION=POINTS`.
fn effect(text: &str) -> Result<(String, f64), String> {
    let (condition, points) = text.split_once('=').ok_or("must be CONDITION=POINTS, such as eva-g=0.5")?;
    let points: f64 = points.parse().map_err(|error| format!("{points:?}: {error}"))?;
    if !(-10.0..=10.0).contains(&points) {
        return Err(format!("{points}: must be -10 to 10 points"));
    }
    Ok((condition.to_owned(), points))
}

/// What is printed.
#[derive(Debug, Serialize)]
struct Outcome {
    study: String,
    seed: u64,
    /// Participants by the state in which they ended.
    states: BTreeMap<&'static str, usize>,
    arrived: usize,
    placed: usize,
    answers: usize,
    /// Fewest and most answers of a stimulus in each part that is filled.
    filled: BTreeMap<String, Balance>,
    /// From the first arrival to the last event, h.
    hours: f64,
    files: Vec<PathBuf>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Balance {
    fewest: u32,
    most: u32,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    shares(arguments)?;
    let study = super::beside::study(&arguments.study)?;
    let beside = Beside::of(&study, &arguments.gaits)?;
    let report = study::check(&study, &beside.materials);
    let plan = planned(&study, &beside, &report)?;
    check_effects(&plan, &arguments.effect)?;
    let minds = minds(&beside, arguments);
    let needed = report.summary.as_ref().map_or(1, |summary| summary.least);
    let arrivals = u32::try_from(needed).unwrap_or(u32::MAX).saturating_mul(ARRIVALS);
    let habits = Habits {
        careless: arguments.careless,
        leaving: hazard(arguments.drop, pages(&plan)),
        ..Habits::default()
    };
    let setup = Setup {
        participants: arguments.participants.unwrap_or(arrivals),
        at_once: arguments.at_once,
        habits,
        seed: arguments.seed,
    };
    let (_, found) = simulate(&plan, &minds, setup).map_err(|refusal| {
        failed(
            format!("the protocol refused a simulated participant: {refusal:?}"),
            "this is a fault of gaitway: please report it with the study file",
        )
    })?;
    let mut outcome = outcome(&study, arguments.seed, &found);
    if let Some(folder) = &arguments.out {
        outcome.files = super::folder::write(folder, &study, &Tables::simulated(&found))?;
    }
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome, needed);
    }
    Ok(true)
}

fn shares(arguments: &Arguments) -> Result<(), Error> {
    let Arguments { drop, careless, .. } = *arguments;
    for (name, share, most) in [("--drop", drop, 0.9), ("--careless", careless, 1.0)] {
        if !(0.0..=most).contains(&share) {
            return Err(usage(
                format!("{name} {share}: must be 0 to {most}"),
                "it is a share of the participants",
            ));
        }
    }
    Ok(())
}

/// The plan of a study without errors.
fn planned(study: &Study, beside: &Beside, report: &Report) -> Result<Plan, Error> {
    let mut errors = report.notes.iter().filter(|note| note.severity == Severity::Error);
    if let Some(first) = errors.next() {
        let more = errors.count();
        let hint =
            if more > 0 { format!("`gaitway study check` lists {more} more") } else { first.hint.clone() };
        return Err(failed(first.to_string().trim_start_matches("error: "), &hint));
    }
    Ok(Plan::of(&study.file, &beside.materials)?)
}

fn check_effects(plan: &Plan, effects: &[(String, f64)]) -> Result<(), Error> {
    let mut known: Vec<&str> = plan
        .counted()
        .flat_map(|(_, _, step)| &step.stimuli)
        .filter_map(study::plan::Stimulus::condition)
        .collect();
    known.sort_unstable();
    known.dedup();
    match effects.iter().find(|(condition, _)| !known.contains(&condition.as_str())) {
        Some((condition, _)) => Err(usage(
            format!("--effect {condition}: the study has no such condition"),
            format!("it has {}", if known.is_empty() { "none".to_owned() } else { known.join(", ") }),
        )),
        None => Ok(()),
    }
}

/// Pages after the place is given at which a participant may leave.
fn pages(plan: &Plan) -> u32 {
    let of = |kind: &StepKind| match kind {
        StepKind::Trials(step) => plan.trial_count(step),
        _ => 1,
    };
    let is_trials = |step: &&study::plan::Step| matches!(step.kind, StepKind::Trials(_));
    let first = plan.steps.iter().position(|step| is_trials(&step)).unwrap_or(0);
    u32::try_from(plan.steps[first..].iter().map(|step| of(&step.kind)).sum::<usize>())
        .unwrap_or(u32::MAX)
        .max(1)
}

fn minds(beside: &Beside, arguments: &Arguments) -> Minds {
    let gaits: Vec<String> = beside.materials.gaits.values().flatten().cloned().collect();
    let seed = Random::new(arguments.seed).bits();
    let mut ratings = RatingModel::drawn(&gaits, seed);
    let [own, other] = SHOWN;
    for (gait, label) in &beside.labels {
        let of = |emotion: Emotion| if emotion == *label { own } else { other };
        ratings.shown.insert(gait.clone(), Emotion::ALL.map(of));
    }
    let scenes =
        LinearModel { conditions: arguments.effect.iter().cloned().collect(), ..LinearModel::default() };
    Minds { ratings, scenes, ..Minds::default() }
}

fn outcome(study: &Study, seed: u64, found: &Run) -> Outcome {
    let mut states = BTreeMap::new();
    for participant in &found.participants {
        *states.entry(participant.state.name()).or_default() += 1;
    }
    let filled =
        found.answered.iter().map(|(part, &(fewest, most))| (part.clone(), Balance { fewest, most }));
    #[allow(clippy::cast_precision_loss, reason = "milliseconds of a study")]
    let hours = found.duration_ms as f64 / 3.6e6;
    Outcome {
        study: study.file.study.id.clone(),
        seed,
        states,
        arrived: found.participants.len(),
        placed: found.placed,
        answers: found.answers.len(),
        filled: filled.collect(),
        hours,
        files: Vec::new(),
    }
}

fn print(outcome: &Outcome, needed: usize) {
    say(&format!("study         {} (seed {})", outcome.study, outcome.seed));
    say(&format!(
        "participants  {} arrived, {} got a place; {needed} are needed if all stay",
        outcome.arrived, outcome.placed
    ));
    for (state, count) in &outcome.states {
        say(&format!("              {count} {state}"));
    }
    say(&format!("answers       {}", thousands(outcome.answers as u64)));
    for (part, Balance { fewest, most }) in &outcome.filled {
        say(&format!("{part:<13} {fewest} to {most} answers of each stimulus"));
    }
    say(&format!("time          {:.1} h", outcome.hours));
    for file in &outcome.files {
        say(&format!("written       {}", file.display()));
    }
    note("note: simulated participants are no people");
}
