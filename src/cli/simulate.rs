//! `gaitway simulate`: steps a crowd, measures it, hashes its state, writes trajectories.

use super::course::{Length, Outcome, Recording, simulate};
use super::output::{note, rate, say, say_json, thousands};
use super::scene::{SceneArguments, check_seconds, start};
use super::usage;
use crate::Error;
use crate::sim::departures::{Departures, Evacuation};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Instant;

/// Default simulated time, s.
const SECONDS: f64 = 10.0;
/// The same with `--until`, s.
const LONGEST: f64 = 3600.0;

/// Arguments of `gaitway simulate`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway simulate crossing --agents 2000 --seconds 10\n  gaitway simulate \
                        garden --agents 200 --seed 7 --out garden.sqlite\n  gaitway simulate my-place.toml \
                        --until empty --seconds 600\n  gaitway simulate my-place.toml --backend cpu --json\n\nThe state hash is the same on every machine whose arithmetic is \
                        exact, on both backends: same scenario, same seed, same bits."
)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Simulated time, or the most of it with --until [default: 10; with --until 3600]
    #[arg(long)]
    seconds: Option<f64>,
    /// Stop earlier: once all people have left by an exit
    #[arg(long, value_enum, value_name = "empty")]
    until: Option<Until>,
    /// Trajectories: .sqlite (JuPedSim, PedPy; with the table `agents`), .parquet (polars, pandas, duckdb; that table beside
    /// it, as NAME.agents.parquet), .txt (Pedestrian Dynamics Data Archive; people only) or .csv
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Frames per second of the trajectories; a divisor of the step rate (30)
    #[arg(long, default_value_t = 10.0)]
    fps: f64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Whether to list the scenes, and whether in JSON.
    pub(super) const fn lists(&self) -> (bool, bool) {
        (self.scene.list, self.json)
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Until {
    /// All people have left.
    Empty,
}

/// Runs the subcommand; false when a kernel failed.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let until_empty = arguments.until == Some(Until::Empty);
    let longest = arguments.seconds.unwrap_or(if until_empty { LONGEST } else { SECONDS });
    let seconds = check_seconds("--seconds", longest)?;
    let begin = Instant::now();
    let scene = arguments.scene.load()?;
    if until_empty && !Departures::new(&scene.scenario, &scene.crowd).has_exits() {
        let message =
            format!("--until empty: people cannot leave {}, which has no exit", scene.scenario.name);
        return Err(usage(message, "end a journey with a stage of kind \"exit\", or give --seconds alone"));
    }
    let mut simulation = start(&scene)?;
    let length = Length { steps: scene.steps(seconds), until_empty };
    let recording = arguments.out.as_ref().map(|path| Recording::create(path, arguments.fps, &scene));
    let mut outcome = simulate(&scene, &mut simulation, length, recording.transpose()?)?;
    outcome.wall_seconds = begin.elapsed().as_secs_f64();
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome);
    }
    if let Some(failure) = &outcome.failure {
        super::output::warn(&format!("error: {failure}"));
        super::output::warn("hint: please report this with the scenario, the seed and `gaitway verify`");
    }
    Ok(outcome.failure.is_none())
}

pub(super) fn print(outcome: &Outcome) {
    let Outcome { scene, agents, steps, seed, device, .. } = outcome;
    let clearance = if outcome.min_clearance.is_finite() {
        format!("{:.3} m", outcome.min_clearance)
    } else {
        "no two came near".to_owned()
    };
    say(&format!("scene              {scene}, {} agents, {steps} steps", thousands(u64::from(*agents))));
    say(&format!("seed               {seed}"));
    say(&format!("device             {device}"));
    say(&format!("mean speed         {:.3} m/s", outcome.mean_speed));
    say(&format!("routes completed   {}", outcome.arrived));
    let Outcome { entered, present, left, waiting_outside, never, .. } = outcome;
    if (*entered, *present) != (*agents, *agents) {
        let no_time = if *never > 0 { format!(", {never} have no time to come in") } else { String::new() };
        say(&format!(
            "people             {entered} entered, {present} present, {left} left, {waiting_outside} waiting outside{no_time}"
        ));
    }
    print_evacuation(outcome);
    say(&format!("smallest clearance {clearance}"));
    say(&format!("overlapping pairs  {} at most", outcome.overlapping_pairs_max));
    say(&format!("agents outside     {} at most", outcome.agents_outside));
    if let Some([happy, angry, sad, neutral]) = outcome.mean_feeling {
        say(&format!(
            "feelings           happy {happy:.3}, angry {angry:.3}, sad {sad:.3}, neutral {neutral:.3} at the end"
        ));
    }
    say(&format!("state hash         {}", outcome.state_hash));
    let speed = rate(outcome.agent_steps_per_second);
    say(&format!(
        "speed              {speed} agent steps a second ({:.2} s of stepping)",
        outcome.step_seconds
    ));
    if let Some((path, frames)) = &outcome.trajectories {
        say(&format!("trajectories       {} ({frames} frames)", path.display()));
    }
    say(&format!("wall time          {:.2} s", outcome.wall_seconds));
}

/// When people left, in total and by exit.
fn print_evacuation(outcome: &Outcome) {
    let Some(evacuation) = &outcome.evacuation else { return };
    let Evacuation { people, left, .. } = evacuation;
    let at = |time: Option<f64>| time.map_or_else(|| "not yet".to_owned(), |time| format!("{time:.1} s"));
    let times = |[half, most, all]: [Option<f64>; 3]| {
        format!("50 % {}, 95 % {}, 100 % {}", at(half), at(most), at(all))
    };
    let total = times([evacuation.time_50, evacuation.time_95, evacuation.time_100]);
    say(&format!("evacuation         {left} of {people} left: {total}"));
    for exit in &evacuation.exits {
        let times = times([exit.time_50, exit.time_95, exit.time_100]);
        say(&format!("  by {:<15} {} left: {times}", exit.exit, exit.left));
    }
    if outcome.emptied == Some(false) {
        let remaining = people - left;
        note(&format!(
            "note: not empty after {:.1} s: {remaining} of {people} are there or still to come (--seconds is the most)",
            outcome.seconds
        ));
    }
}
