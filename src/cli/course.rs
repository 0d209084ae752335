//! A crowd on its way through its steps, measured and recorded between them.

use super::output::{note, thousands};
use super::progress::Progress;
use super::{outputs, usage};
use crate::export::columns::agents_path;
use crate::export::{Frame, Ground, TrajectoryFormat, TrajectoryWriter, Walkable};
use crate::replay::Replay;
use crate::scene::Scene;
use crate::sim::departures::{Departures, Evacuation};
use crate::sim::measured::{Extremes, MEASURED};
use crate::sim::{self, Simulation, measure};
use crate::{Error, stop};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Steps that are waited for together.
const TOGETHER: u32 = 16;

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
    /// Memory of the last frame.
    /// From before the file exists: an interrupted recording ends where it is.
    _heed: stop::Heed,
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
        let heed = stop::heed();
        let writer = TrajectoryWriter::create(
            path,
            format,
            rate,
            &Walkable::from(&scene.geometry),
            scene.agents_info(),
        )?;
        Ok(Self::new(path, every, writer, heed))
    }

    /// Begins a table of agents, without their trajectories.
    pub(super) fn of_agents(path: &Path, rate: f64, scene: &Scene) -> Result<Self, Error> {
        let every = steps_per_frame(rate, scene)?;
        let heed = stop::heed();
        let writer = TrajectoryWriter::of_agents(path, rate, scene.agents_info())?;
        Ok(Self::new(path, every, writer, heed))
    }

    fn new(path: &Path, every: u32, writer: TrajectoryWriter, heed: stop::Heed) -> Self {
        Self { path: path.to_owned(), every, writer, _heed: heed }
    }

    fn frame(&mut self, simulation: &mut Simulation) -> Result<(), Error> {
        let store = simulation.state()?;
        let agents = store.step.agent_count as usize;
        let emotions = if store.step.feels == 0 { &[] } else { &store.feeling[..agents] };
        let frame = Frame {
            positions: bytemuck::cast_slice(&store.position[..agents]),
            headings: &store.heading[..agents],
            velocities: bytemuck::cast_slice(&store.velocity[..agents]),
            emotions,
        };
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

/// A crowd on its way through its steps: measured and recorded between them. Who steps it is not its business.
#[derive(Debug)]
pub(super) struct Course {
    begin: Instant,
    length: Length,
    measures: Measures,
    recording: Option<Recording>,
    stepping: Duration,
    failure: Option<String>,
    done: u32,
    is_empty: bool,
}

impl Course {
    /// Begins to measure, and records the start.
    pub(super) fn begin(
        scene: &Scene,
        simulation: &mut Simulation,
        length: Length,
        mut recording: Option<Recording>,
    ) -> Result<Self, Error> {
        let begin = Instant::now();
        let measures = Measures::new(scene, simulation)?;
        if let Some(recording) = &mut recording {
            recording.frame(simulation)?;
        }
        let (stepping, failure) = (Duration::ZERO, None);
        Ok(Self { begin, length, measures, recording, stepping, failure, done: 0, is_empty: false })
    }

    /// Steps to be done until it looks at the crowd again; none when it is over.
    pub(super) fn due(&self) -> Option<u32> {
        let Length { steps, until_empty } = self.length;
        let to_next = |every: u32| every - self.done % every;
        let frame = self.recording.as_ref().map_or(u32::MAX, |recording| to_next(recording.every));
        // the last frame of a file shows the empty place
        let together = if until_empty && self.recording.is_none() { 1 } else { TOGETHER };
        let is_over = self.done >= steps || self.failure.is_some() || self.is_empty;
        (!is_over).then(|| together.min(frame).min(steps - self.done))
    }

    /// Share of its steps that are done.
    pub(super) fn share(&self) -> f64 {
        f64::from(self.done) / f64::from(self.length.steps.max(1))
    }

    /// Looks at the crowd after steps that took so long.
    pub(super) fn look(
        &mut self,
        simulation: &mut Simulation,
        count: u32,
        took: Duration,
    ) -> Result<(), Error> {
        self.stepping += took;
        self.done += count;
        self.measures.take(simulation, self.done)?;
        let is_frame =
            self.recording.as_ref().is_none_or(|recording| self.done.is_multiple_of(recording.every));
        if let Some(recording) = self.recording.as_mut().filter(|_| is_frame) {
            recording.frame(simulation)?;
        }
        if self.length.until_empty && is_frame {
            self.measures.see(simulation)?;
            self.is_empty = self.measures.departures.remaining() == 0;
        }
        Ok(())
    }

    /// Notes a failure of a kernel, with which the course is over; others are errors.
    pub(super) fn heed(&mut self, outcome: Result<(), Error>) -> Result<(), Error> {
        match outcome {
            Err(Error::Sim(error @ sim::Error::Failure { .. })) => {
                self.failure = Some(error.to_string());
                Ok(())
            }
            other => other,
        }
    }

    /// What came of it.
    pub(super) fn finish(mut self, scene: &Scene, simulation: &mut Simulation) -> Result<Outcome, Error> {
        let mean_speed = self.measures.finish(scene, simulation)?;
        let last = measure::measures(simulation.state()?);
        let trajectories = self.recording.map(Recording::finish).transpose()?;
        let (agents, step_seconds) = (scene.agents(), self.stepping.as_secs_f64());
        let work = f64::from(agents) * f64::from(self.done);
        Ok(Outcome {
            device: simulation.device(),
            arithmetic: simulation.arithmetic()?,
            scene: scene.scenario.name.clone(),
            agents,
            steps: self.done,
            seed: scene.scenario.seed,
            seconds: Replay::time_of(self.done, scene.scenario.navigation.time_step),
            mean_speed,
            evacuation: self.measures.departures.evacuation(),
            emptied: self.length.until_empty.then(|| self.measures.departures.remaining() == 0),
            arrived: last.arrived,
            entered: last.entered,
            present: last.present,
            left: last.left,
            waiting_outside: last.waiting_outside,
            never: last.never,
            min_clearance: self.measures.extremes.min_clearance,
            overlapping_pairs_max: self.measures.extremes.overlapping_pairs,
            agents_outside: self.measures.extremes.outside,
            mean_feeling: measure::mean_feeling(simulation.state()?),
            state_hash: format!("{:016x}", measure::state_hash(simulation.state()?)),
            agent_steps_per_second: if step_seconds > 0.0 { work / step_seconds } else { 0.0 },
            step_seconds,
            wall_seconds: self.begin.elapsed().as_secs_f64(),
            trajectories,
            failure: self.failure,
        })
    }
}

/// Does all steps, measuring and recording between them.
pub(super) fn simulate(
    scene: &Scene,
    simulation: &mut Simulation,
    length: Length,
    recording: Option<Recording>,
) -> Result<Outcome, Error> {
    let heed = stop::heed();
    let mut course = Course::begin(scene, simulation, length, recording)?;
    let mut progress = Progress::new(format!("simulating {} agents", thousands(u64::from(scene.agents()))));
    while let Some(count) = course.due().filter(|_| !stop::asked()) {
        let begin = Instant::now();
        course.heed(scene.step(simulation, count).and_then(|()| simulation.finish()))?;
        course.look(simulation, count, begin.elapsed())?;
        progress.at(&format!("step {} of {}", course.done, length.steps), course.share());
    }
    let outcome = course.finish(scene, simulation);
    drop(heed);
    outcome
}
