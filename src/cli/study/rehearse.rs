//! `gaitway study rehearse`: simulated browsers at a running server.

use super::super::output::{note, say, say_json, thousands};
use super::super::scene::seed;
use super::super::{failed, usage};
use crate::Error;
use crate::study::rehearse::{Outcome, Rehearsal, rehearse};
use serde::Serialize;
use std::time::Duration;

/// Arguments of `gaitway study rehearse`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  gaitway study serve mine/ --data rehearsal/ --requests-per-minute 0 &\n  gaitway study rehearse \
                  http://127.0.0.1:8080/s/eva-gaits --participants 500 --at-once 100 --drop 0.02\n\nThe browsers take places like \
                  people: rehearse with a folder of data of its own. What they answer means nothing.\nExit code 1: a browser was \
                  not answered as it should be."
)]
pub(super) struct Arguments {
    /// Address of the study's first page
    #[arg(value_name = "http://HOST/s/ID")]
    address: String,
    /// Most browsers that come
    #[arg(long, default_value_t = 100, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    participants: u32,
    /// Browsers at the same time
    #[arg(long, default_value_t = 30, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2_000))]
    at_once: u32,
    /// Chance of leaving at each film, 0 to 1
    #[arg(long, default_value_t = 0.0, value_name = "CHANCE")]
    drop: f64,
    /// Longest pause before an answer, s
    #[arg(long, default_value_t = 0.0, value_name = "SECONDS")]
    pause: f64,
    /// Seed of all draws
    #[arg(long, default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Printed {
    arrived: u32,
    finished: u32,
    left: u32,
    turned_away: u32,
    lost: usize,
    answers: usize,
    repeated_requests: u64,
    seconds: f64,
    answers_per_second: f64,
    /// From sending an answer to its acknowledgement, ms.
    median_ms: f64,
    p99_ms: f64,
    greatest_ms: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let Arguments { drop, pause, .. } = *arguments;
    if !(0.0..=1.0).contains(&drop) {
        return Err(usage(
            format!("--drop {drop}: must be 0 to 1"),
            "it is the chance of leaving at each film",
        ));
    }
    if !(0.0..=3600.0).contains(&pause) {
        return Err(usage(format!("--pause {pause}: must be 0 to 3600 s"), "each pause is drawn from 0 on"));
    }
    let has_study = arguments.address.splitn(4, '/').nth(3).is_some_and(|path| path.starts_with("s/"));
    if !arguments.address.starts_with("http://") || !has_study {
        return Err(usage(
            format!("{}: must be http://HOST:PORT/s/ID", arguments.address),
            "`gaitway study serve` prints it; rehearse on the server itself, before the proxy",
        ));
    }
    let heed = crate::stop::heed();
    let outcome = rehearse(&Rehearsal {
        address: arguments.address.trim_end_matches('/').to_owned(),
        participants: arguments.participants,
        at_once: arguments.at_once,
        leaving: drop,
        pause: Duration::from_secs_f64(pause),
        patience: Duration::from_secs(60),
        seed: arguments.seed,
    })
    .map_err(|error| {
        failed(error.to_string(), "start it with `gaitway study serve`, and give the address that it prints")
    })?;
    std::mem::drop(heed);
    let printed = printed(&outcome);
    if arguments.json {
        say_json(&printed)?;
    } else {
        print(&printed);
    }
    if let Some(first) = outcome.lost.first() {
        note(&format!("note: {} browsers were lost, the first by: {first}", outcome.lost.len()));
    }
    Ok(outcome.lost.is_empty())
}

fn printed(outcome: &Outcome) -> Printed {
    Printed {
        arrived: outcome.arrived,
        finished: outcome.finished,
        left: outcome.left,
        turned_away: outcome.turned_away,
        lost: outcome.lost.len(),
        answers: outcome.answers.len(),
        repeated_requests: outcome.repeated,
        seconds: outcome.seconds,
        answers_per_second: outcome.rate(),
        median_ms: outcome.latency(0.5),
        p99_ms: outcome.latency(0.99),
        greatest_ms: outcome.latency(1.0),
    }
}

fn print(outcome: &Printed) {
    let Printed { arrived, finished, left, turned_away, lost, .. } = outcome;
    say(&format!(
        "browsers  {arrived} arrived, {finished} finished, {left} left, {turned_away} turned away, {lost} lost"
    ));
    say(&format!(
        "answers   {} in {:.1} s: {:.0} a second",
        thousands(outcome.answers as u64),
        outcome.seconds,
        outcome.answers_per_second
    ));
    say(&format!(
        "latency   median {:.1} ms, 99 of 100 within {:.1} ms, greatest {:.1} ms",
        outcome.median_ms, outcome.p99_ms, outcome.greatest_ms
    ));
    if outcome.repeated_requests > 0 {
        say(&format!("repeated  {} requests", outcome.repeated_requests));
    }
}
