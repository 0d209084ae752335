//! `gaitway simulate`: steps a crowd, measures it, hashes its state, writes trajectories.

use super::output::{note, rate, say, say_json, thousands};
use super::progress::Progress;
use super::scene::{SceneArguments, check_seconds, start};
use super::{outputs, usage};
use crate::export::columns::agents_path;
use crate::export::{Frame, Ground, TrajectoryFormat, TrajectoryWriter, Walkable};
use crate::replay::Replay;
use crate::scene::Scene;
use crate::sim::departures::{Departures, Evacuation};
use crate::sim::measured::{Extremes, MEASURED};
use crate::sim::{self, Simulation, measure};
use crate::{Error, stop};
use clap::{Args, ValueEnum};
use glam::Vec2;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Steps that are waited for together.
const TOGETHER: u32 = 16;
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

/// How long to simulate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Length {
    /// Steps at most.
    pub(super) steps: u32,
    /// Whether to stop once all people have left.
    pub(super) until_empty: bool,
}

/// What came out.
#[derive(Debug, Serialize)]
pub(super) struct Outcome {
    pub(super) device: String,
    /// `native`, or `careful` and for what.
    pub(super) arithmetic: String,
    pub(super) scene: String,
    pub(super) agents: u32,
    pub(super) steps: u32,
    pub(super) seed: u64,
    /// Simulated time, s.
    pub(super) seconds: f64,
    /// Mean over the people present and all steps, m/s; `[[outsiders]]` are not counted.
    pub(super) mean_speed: f32,
    /// Routes and journeys walked to their end.
    pub(super) arrived: u64,
    /// Agents that have been present at any time.
    pub(super) entered: u32,
    /// Agents present at the end.
    pub(super) present: u32,
    /// Agents that have left by an exit.
    pub(super) left: u32,
    /// Agents due to enter that have found no room yet.
    pub(super) waiting_outside: u32,
    /// Agents that no source has a time for.
    pub(super) never: u32,
    /// When people left, in total and by exit, and the n-t curve; null where there is no exit.
    pub(super) evacuation: Option<Evacuation>,
    /// With `--until empty`: whether all people left in time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) emptied: Option<bool>,
    /// Smallest gap between two discs after any step, m; null when no two came nearer than half a metre.
    pub(super) min_clearance: f32,
    /// Most pairs that overlapped by more than a tenth of their radii after any step.
    pub(super) overlapping_pairs_max: u32,
    /// Most agents outside the walkable area after any step.
    pub(super) agents_outside: u32,
    /// Mean weights of happy, angry, sad, neutral at the end, where feelings change.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mean_feeling: Option<[f32; 4]>,
    pub(super) state_hash: String,
    /// Agents times steps over the time spent stepping.
    pub(super) agent_steps_per_second: f64,
    pub(super) step_seconds: f64,
    pub(super) wall_seconds: f64,
    /// Trajectory file and its frames.
    pub(super) trajectories: Option<(PathBuf, u32)>,
    /// Which kernel met a value that is not finite, and the first agent.
    pub(super) failure: Option<String>,
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

/// Steps between two frames of a file of `rate` frames a second, which must divide the step rate.
pub(super) fn steps_per_frame(rate: f64, scene: &Scene) -> Result<u32, Error> {
    let steps = 1.0 / f64::from(scene.scenario.navigation.time_step);
    let every = (steps / rate).round();
    if !((1.0..=1e6).contains(&every) && (every * rate - steps).abs() < 0.01 * steps) {
        let message = format!("--fps {rate}: there are {steps:.0} simulation steps a second");
        return Err(usage(
            message,
            format!("use {steps:.0} or {steps:.0} over a whole number, such as {:.0}", steps / 3.0),
        ));
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most a million")]
    let every = every as u32;
    Ok(every)
}

/// Trajectories being written.
#[derive(Debug)]
pub(super) struct Recording {
    path: PathBuf,
    /// Steps between two frames.
    every: u32,
    writer: TrajectoryWriter,
}

impl Recording {
    /// Begins a file.
    pub(super) fn create(path: &Path, rate: f64, scene: &Scene) -> Result<Self, Error> {
        let every = steps_per_frame(rate, scene)?;
        let endings = "use .sqlite, .parquet, .txt or .csv";
        let format = TrajectoryFormat::from_path(path).map_err(|error| usage(error.to_string(), endings))?;
        if format == TrajectoryFormat::Parquet {
            outputs::free(&agents_path(path))?;
        }
        let writer = TrajectoryWriter::create(
            path,
            format,
            rate,
            &Walkable::from(&scene.geometry),
            scene.agents_info(),
        )?;
        Ok(Self { path: path.to_owned(), every, writer })
    }

    /// Begins a table of agents, without their trajectories.
    pub(super) fn of_agents(path: &Path, rate: f64, scene: &Scene) -> Result<Self, Error> {
        let every = steps_per_frame(rate, scene)?;
        let writer = TrajectoryWriter::of_agents(path, rate, scene.agents_info())?;
        Ok(Self { path: path.to_owned(), every, writer })
    }

    fn frame(&mut self, simulation: &mut Simulation) -> Result<(), Error> {
        let store = simulation.state()?;
        let agents = store.step.agent_count as usize;
        let ground = |pairs: &[[f32; 2]]| pairs[..agents].iter().copied().map(Vec2::from_array).collect();
        let (positions, velocities): (Vec<Vec2>, Vec<Vec2>) =
            (ground(&store.position), ground(&store.velocity));
        let headings: Vec<f32> = store.stance[..agents].iter().map(|stance| stance.heading).collect();
        let emotions = if store.step.feels == 0 { &[] } else { &store.feeling[..agents] };
        let frame = Frame { positions: &positions, headings: &headings, velocities: &velocities, emotions };
        Ok(self.writer.frame(&frame)?)
    }

    fn finish(self) -> Result<(PathBuf, u32), Error> {
        let frames = self.writer.frames();
        let Ground { parts, peopled } = self.writer.finish()?;
        if peopled > 1 {
            note(&format!(
                "note: obstacles cut the walkable area into {parts} parts and people are in {peopled} of them; the file \
                 joins these by slits of 2 mm, since readers take one polygon"
            ));
        }
        Ok((self.path, frames))
    }
}

/// Measures, kept over the steps.
#[derive(Debug)]
struct Measures {
    departures: Departures,
    extremes: Extremes,
    /// Steps done when the extremes were last asked for.
    asked: u32,
}

impl Measures {
    /// Begins to measure.
    fn new(scene: &Scene, simulation: &mut Simulation) -> Result<Self, Error> {
        let mut departures = Departures::new(&scene.scenario, &scene.crowd);
        departures.observe(simulation.state()?, 0);
        simulation.measure_steps()?;
        Ok(Self { departures, extremes: Extremes::NONE, asked: 0 })
    }

    /// Takes over what the device found, if it must be before the next steps.
    fn take(&mut self, simulation: &mut Simulation, done: u32) -> Result<(), Error> {
        if done - self.asked + TOGETHER > MEASURED {
            self.extremes = self.extremes.or(simulation.extremes()?);
            self.asked = done;
        }
        Ok(())
    }

    /// Notes who has left.
    fn see(&mut self, simulation: &mut Simulation) -> Result<(), Error> {
        let seen = simulation.seen()?.to_vec();
        self.departures.see(&seen, simulation.state()?);
        Ok(())
    }

    /// Takes over everything at the end. Returns the mean speed of people, m/s: `[[outsiders]]` follow them, and do not count.
    fn finish(&mut self, scene: &Scene, simulation: &mut Simulation) -> Result<f32, Error> {
        self.see(simulation)?;
        self.extremes = self.extremes.or(simulation.extremes()?);
        let people = simulation.seen()?.iter().take(scene.crowd.agents.len());
        let (sum, count) = people.fold((0.0, 0), |(sum, count), own| {
            (sum + f64::from(own.speed_sum), count + u64::from(own.steps))
        });
        #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "a speed")]
        let mean = (sum / count.max(1) as f64) as f32;
        Ok(mean)
    }
}

/// Does all steps, measuring and recording between them.
pub(super) fn simulate(
    scene: &Scene,
    simulation: &mut Simulation,
    Length { steps, until_empty }: Length,
    mut recording: Option<Recording>,
) -> Result<Outcome, Error> {
    let begin = Instant::now();
    let agents = scene.agents();
    let mut measures = Measures::new(scene, simulation)?;
    let mut progress = Progress::new(format!("simulating {} agents", thousands(u64::from(agents))));
    let (mut stepping, mut failure, mut done) = (Duration::ZERO, None, 0);
    if let Some(recording) = &mut recording {
        recording.frame(simulation)?;
    }
    let heed = stop::heed();
    while done < steps && failure.is_none() && !stop::asked() {
        let to_next = |every: u32| every - done % every;
        let frame = recording.as_ref().map_or(u32::MAX, |recording| to_next(recording.every));
        // the last frame of a file shows the empty place
        let together = if until_empty && recording.is_none() { 1 } else { TOGETHER };
        let count = together.min(frame).min(steps - done);
        let step_begin = Instant::now();
        match scene.step(simulation, count).and_then(|()| simulation.finish()) {
            Err(Error::Sim(error @ sim::Error::Failure { .. })) => failure = Some(error.to_string()),
            other => other?,
        }
        stepping += step_begin.elapsed();
        done += count;
        measures.take(simulation, done)?;
        let is_frame = recording.as_ref().is_none_or(|recording| done % recording.every == 0);
        if let Some(recording) = recording.as_mut().filter(|_| is_frame) {
            recording.frame(simulation)?;
        }
        if until_empty && is_frame {
            measures.see(simulation)?;
            if measures.departures.remaining() == 0 {
                break;
            }
        }
        progress.at(&format!("step {done} of {steps}"), f64::from(done) / f64::from(steps));
    }
    let mean_speed = measures.finish(scene, simulation)?;
    let last = measure::measures(simulation.state()?);
    let trajectories = recording.map(Recording::finish).transpose()?;
    drop(heed);
    let step_seconds = stepping.as_secs_f64();
    let work = f64::from(agents) * f64::from(done);
    Ok(Outcome {
        device: simulation.device(),
        arithmetic: simulation.arithmetic()?,
        scene: scene.scenario.name.clone(),
        agents,
        steps: done,
        seed: scene.scenario.seed,
        seconds: Replay::time_of(done, scene.scenario.navigation.time_step),
        mean_speed,
        evacuation: measures.departures.evacuation(),
        emptied: until_empty.then(|| measures.departures.remaining() == 0),
        arrived: last.arrived,
        entered: last.entered,
        present: last.present,
        left: last.left,
        waiting_outside: last.waiting_outside,
        never: last.never,
        min_clearance: measures.extremes.min_clearance,
        overlapping_pairs_max: measures.extremes.overlapping_pairs,
        agents_outside: measures.extremes.outside,
        mean_feeling: measure::mean_feeling(simulation.state()?),
        state_hash: format!("{:016x}", measure::state_hash(simulation.state()?)),
        agent_steps_per_second: if step_seconds > 0.0 { work / step_seconds } else { 0.0 },
        step_seconds,
        wall_seconds: begin.elapsed().as_secs_f64(),
        trajectories,
        failure,
    })
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
