//! `gaitway study power`: how many people Friedman's test needs.

use super::super::output::{say, say_json, table};
use super::super::usage;
use crate::Error;
use crate::statistics::power::{friedman_people, friedman_power, friedman_power_finite};
use serde::Serialize;

/// Numbers of people that are listed.
const PEOPLE: [usize; 8] = [12, 18, 24, 30, 36, 48, 60, 96];

/// Arguments of `gaitway study power`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study power --w 0.16\n  gaitway study power --w 0.08 --conditions 4 --power 0.9\n\nKendall's W \
                  is 0.1 for a small effect, 0.3 for a medium one, 0.5 for a large one (Cohen 1988). The paper's W are in \
                  docs/statistics.md."
)]
pub(super) struct Arguments {
    /// Kendall's W that is to be found, above 0 and below 1
    #[arg(long)]
    w: f64,
    /// Conditions that everyone sees
    #[arg(long, default_value_t = 3, value_name = "K")]
    conditions: usize,
    /// Probability of a false positive
    #[arg(long, default_value_t = 0.05)]
    alpha: f64,
    /// Probability with which the effect is to be found
    #[arg(long, default_value_t = 0.8)]
    power: f64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Outcome {
    w: f64,
    conditions: usize,
    alpha: f64,
    power: f64,
    /// People with whom the test has that power, by the limit for many people.
    people: usize,
    rows: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    people: usize,
    /// Noncentral chi-square with n (k - 1) W: the limit for many people.
    limit: f64,
    /// With (n - 1) (k - 1) W / (1 - W), nearer to simulation for W above 0.1.
    finite: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let Arguments { w, conditions, alpha, power, .. } = *arguments;
    let row = |people| -> Result<Row, crate::statistics::Error> {
        let limit = friedman_power(people, conditions, w, alpha)?;
        Ok(Row { people, limit, finite: friedman_power_finite(people, conditions, w, alpha)? })
    };
    let wrong =
        |error: crate::statistics::Error| usage(error.to_string(), "`--help` says what the numbers mean");
    let people = friedman_people(conditions, w, alpha, power).map_err(wrong)?;
    let rows = PEOPLE.into_iter().map(row).collect::<Result<_, _>>().map_err(wrong)?;
    let outcome = Outcome { w, conditions, alpha, power, people, rows };
    if arguments.json {
        say_json(&outcome)?;
        return Ok(true);
    }
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let cells: Vec<Vec<String>> = outcome
        .rows
        .iter()
        .map(|row| vec![row.people.to_string(), percent(row.limit), percent(row.finite)])
        .collect();
    table(&["people", "power, limit", "power, finite"], &cells);
    say(&format!("{people} people find W = {w} with a power of {} at alpha = {alpha}", percent(power)));
    Ok(true)
}
