//! `gaitway run`: runs of a plan, each into a folder of its own that appears when it is whole.

use super::course::{Course, Length, Outcome, Recording};
use super::output::{say, say_json, thousands, warn};
use super::progress::Progress;
use super::scene::{PlaceArguments, build, check_changed, tell_place};
use super::usage;
use crate::scene::Scene;
use crate::sim::departures::Departures;
use crate::sim::{Islands, Simulation};
use crate::sweep::folder::{Committed, Folder, Unfinished};
use crate::sweep::{self, Header, Plan, PlannedRun};
use crate::{Error, file, stop};
use clap::{Args, value_parser};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Instant;

/// Where schedulers say which of many equal jobs this one is: Slurm's arrays, Kubernetes' indexed jobs.
const INDICES: [&str; 2] = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"];
/// The record of a run in its folder: one line of JSON.
const RECORD: &str = "run.json";

/// Arguments of `gaitway run`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway run plan.jsonl --out runs\n  gaitway run plan.jsonl --index 7 --out runs\n  gaitway run plan.jsonl \
                  --index 0..100 --out runs --backend cpu\n  gaitway run plan.jsonl --together 64 --out runs\n\nA run that is done is skipped, so the same command goes on where it was broken \
                  off, and many of them may work on one folder.\nWithout --index the environment says which run it is \
                  (SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX); without these, all are done."
)]
pub(super) struct Arguments {
    /// A plan, written by `gaitway plan`
    #[arg(value_name = "PLAN.jsonl")]
    file: PathBuf,
    /// Which runs, from 0: a number, a range without its end (0..100), or several (3,7..9)
    #[arg(long, value_name = "N|A..B")]
    index: Option<Indices>,
    /// Folder of the runs; it may hold others
    #[arg(long, value_name = "RUNS")]
    out: PathBuf,
    /// How many runs to do at a time, in one process: on a device their steps are submitted together, which fills a GPU with
    /// small crowds; on the CPU each is a task. Results are the same
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = value_parser!(u16).range(1..=4096))]
    together: u16,
    #[command(flatten)]
    place: PlaceArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Numbers of runs.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Indices(Vec<[usize; 2]>);

/// Text that names no runs.
#[derive(Debug, thiserror::Error)]
#[error("use a number such as 7, a range such as 0..100, or several: 3,7..9")]
struct NoIndices;

impl FromStr for Indices {
    type Err = NoIndices;

    fn from_str(text: &str) -> Result<Self, NoIndices> {
        let one = |part: &str| -> Option<[usize; 2]> {
            let part = part.trim();
            let (begin, end) = match part.split_once("..") {
                Some((begin, end)) => (begin.parse().ok()?, end.parse().ok()?),
                None => {
                    let begin: usize = part.parse().ok()?;
                    (begin, begin.checked_add(1)?)
                }
            };
            (begin < end).then_some([begin, end])
        };
        let parts: Option<Vec<_>> = text.split(',').map(one).collect();
        parts.map(Self).ok_or(NoIndices)
    }
}

impl Indices {
    /// The runs that the command line or the environment names; none: all.
    fn wanted(arguments: &Arguments) -> Result<Option<Self>, Error> {
        if arguments.index.is_some() {
            return Ok(arguments.index.clone());
        }
        for name in INDICES {
            if let Ok(text) = std::env::var(name) {
                let wrong =
                    |error: NoIndices| usage(format!("{name}={text}: no number of a run"), error.to_string());
                let index = text.parse().map_err(wrong)?;
                return Ok(Some(index));
            }
        }
        Ok(None)
    }

    fn holds(&self, number: usize) -> bool {
        self.0.iter().any(|[begin, end]| (*begin..*end).contains(&number))
    }

    /// Refuses numbers beyond the last run. The last range of an array may stick out.
    fn check(&self, runs: usize) -> Result<(), Error> {
        match self.0.iter().find(|[begin, _]| *begin >= runs) {
            Some([begin, _]) => {
                let message = format!("--index {begin}: the plan has {runs} runs");
                Err(usage(message, format!("use 0 to {}", runs.saturating_sub(1))))
            }
            None => Ok(()),
        }
    }
}

/// What `run.json` holds: the object of `simulate --json`, and what it is the result of.
#[derive(Debug, Serialize)]
struct Record<'a> {
    key: &'a str,
    version: &'a str,
    #[serde(flatten)]
    outcome: &'a Outcome,
    /// Keys that differ between the runs of the plan, with the values of this one.
    values: BTreeMap<&'a str, &'a Option<toml::Value>>,
    /// All keys that are set.
    set: &'a [String],
    fps: f64,
    /// Name of the built-in scene or of the scenario file.
    scenario: &'a str,
    /// Its text.
    scenario_text: &'a str,
}

/// A run that went wrong.
#[derive(Debug, Serialize)]
struct Failed {
    index: usize,
    key: String,
    error: String,
}

/// What has become of the runs that were asked for.
#[derive(Debug, Default, Serialize)]
struct Summary {
    runs: usize,
    /// Done by this command.
    done: usize,
    /// Done before.
    skipped: usize,
    /// Done by another process meanwhile, which was faster.
    taken: usize,
    failed: Vec<Failed>,
    /// Whether it was stopped before all were done.
    interrupted: bool,
    /// Key and state hash of those done by this command.
    hashes: BTreeMap<String, String>,
    wall_seconds: f64,
}

/// A run on its way.
#[derive(Debug)]
struct Active<'a> {
    index: usize,
    run: &'a PlannedRun,
    begin: Instant,
    settings: Vec<String>,
    scene: Scene,
    course: Course,
    unfinished: Unfinished,
}

/// Runs of a plan that are done some at a time.
#[derive(Debug)]
struct Crew<'a> {
    header: &'a Header,
    folder: &'a Folder,
    place: &'a PlaceArguments,
    /// Runs on their way, and their crowds in the same order.
    active: Vec<Active<'a>>,
    islands: Islands,
    /// The crowd of a run that is over: the next one begins on its device.
    last: Option<Simulation>,
    summary: Summary,
}

/// Runs the subcommand; false when a run went wrong.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let wanted = Indices::wanted(arguments)?;
    let (header, runs) =
        Plan::read(&arguments.file, |number| wanted.as_ref().is_none_or(|all| all.holds(number)))?;
    wanted.map_or(Ok(()), |wanted| wanted.check(header.runs))?;
    let folder = Folder::make(&arguments.out)?;
    let known = if runs.len() > 1 { folder.done()? } else { Default::default() };
    let mut crew = Crew {
        header: &header,
        folder: &folder,
        place: &arguments.place,
        active: Vec::new(),
        islands: Islands::default(),
        last: None,
        summary: Summary { runs: runs.len(), ..Summary::default() },
    };
    let mut progress = Progress::new("sweep".to_owned());
    let (mut are_files_checked, heed) = (false, stop::heed());
    let mut waiting = runs.iter();
    loop {
        while crew.active.len() < usize::from(arguments.together) && !stop::asked() {
            let Some((index, run)) = waiting.next() else { break };
            if known.contains(&run.key) || folder.has(&run.key) {
                crew.summary.skipped += 1;
                continue;
            }
            if !std::mem::replace(&mut are_files_checked, true) {
                header.check_files()?;
            }
            let begun = crew.begin(*index, run);
            crew.summary.heed(*index, run, begun)?;
        }
        if stop::asked() || crew.active.is_empty() {
            break;
        }
        progress.at(&format!("{} of {}", crew.summary.over(), runs.len()), crew.share());
        crew.step()?;
    }
    let mut summary = crew.summary;
    summary.interrupted = stop::asked();
    drop(heed);
    summary.wall_seconds = begin.elapsed().as_secs_f64();
    print(&summary, arguments)?;
    Ok(summary.failed.is_empty())
}

impl Summary {
    /// Runs that are over.
    fn over(&self) -> usize {
        self.done + self.skipped + self.taken + self.failed.len()
    }

    /// Notes the fault of a run. A disk that cannot be written to is none: the next run would end as this one.
    fn heed<T>(
        &mut self,
        index: usize,
        run: &PlannedRun,
        outcome: Result<T, Error>,
    ) -> Result<Option<T>, Error> {
        match outcome {
            Ok(value) => Ok(Some(value)),
            Err(error @ (Error::Sweep(_) | Error::Export(_))) => Err(error),
            Err(error) => {
                warn(&format!("error: run {index} ({}): {error}", run.key));
                self.failed.push(Failed { index, key: run.key.clone(), error: error.to_string() });
                Ok(None)
            }
        }
    }
}

impl<'a> Crew<'a> {
    /// Share of the runs that are over, with the parts of those on their way.
    #[allow(clippy::cast_precision_loss, reason = "a share")]
    fn share(&self) -> f64 {
        let parts: f64 = self.active.iter().map(|active| active.course.share()).sum();
        (self.summary.over() as f64 + parts) / self.summary.runs.max(1) as f64
    }

    /// Sets a run on its way.
    fn begin(&mut self, index: usize, run: &'a PlannedRun) -> Result<(), Error> {
        let (begin, header) = (Instant::now(), self.header);
        let settings = header.settings(run);
        let builder = header.scene(&settings)?.seed(run.seed);
        check_changed(builder.scenario())?;
        let scene = build(self.place.choose(builder)?, None)?;
        if header.until_empty && !Departures::new(&scene.scenario, &scene.crowd).has_exits() {
            let name = &scene.scenario.name;
            let message = format!("until_empty: people cannot leave {name}, which has no exit");
            return Err(usage(
                message,
                "end a journey with a stage of kind \"exit\", or leave until_empty out",
            ));
        }
        let length = Length { steps: scene.steps(header.seconds), until_empty: header.until_empty };
        let unfinished = self.folder.begin(&run.key)?;
        let path = |name: &str| unfinished.path().join(name);
        let recording = if header.trajectories {
            Some(Recording::create(&path("trajectories.parquet"), header.fps, &scene)?)
        } else if header.agents {
            Some(Recording::of_agents(&path("agents.parquet"), header.fps, &scene)?)
        } else {
            None
        };
        let crowd = match &self.last {
            Some(last) if self.active.is_empty() => self.islands.add(scene.start_beside(last)?),
            _ => scene.start_in(&mut self.islands)?,
        };
        tell_place(crowd);
        match Course::begin(&scene, crowd, length, recording) {
            Ok(course) => {
                self.active.push(Active { index, run, begin, settings, scene, course, unfinished });
                Ok(())
            }
            Err(error) => {
                self.islands.remove(self.active.len());
                Err(error)
            }
        }
    }

    /// Steps all crowds to where the first of them is to be looked at, and ends the runs that are over.
    fn step(&mut self) -> Result<(), Error> {
        if let Some(count) = self.active.iter().filter_map(|active| active.course.due()).min() {
            let begin = Instant::now();
            self.islands.step(count)?;
            let took = begin.elapsed() / u32::try_from(self.active.len()).unwrap_or(1);
            for number in (0..self.active.len()).rev() {
                let (active, crowd) = (&mut self.active[number], &mut self.islands.crowds_mut()[number]);
                let looked = active.course.look(crowd, count, took);
                let (index, run) = (active.index, active.run);
                if self.summary.heed(index, run, looked)?.is_none() {
                    self.active.swap_remove(number);
                    self.islands.remove(number);
                }
            }
        }
        for number in (0..self.active.len()).rev() {
            if self.active[number].course.due().is_none() {
                let active = self.active.swap_remove(number);
                let crowd = self.last.insert(self.islands.remove(number));
                let (index, run) = (active.index, active.run);
                let ended = end(self.header, active, crowd);
                if let Some((committed, hash)) = self.summary.heed(index, run, ended)? {
                    match committed {
                        Committed::Done => {
                            self.summary.done += 1;
                            self.summary.hashes.insert(run.key.clone(), hash);
                        }
                        Committed::Taken => self.summary.taken += 1,
                    }
                }
            }
        }
        Ok(())
    }
}

/// Ends a run: writes its record, and gives its folder its name. Returns what became of it and its state hash.
fn end(
    header: &Header,
    mut active: Active<'_>,
    crowd: &mut Simulation,
) -> Result<(Committed, String), Error> {
    active.course.heed(crowd.finish())?;
    let mut outcome = active.course.finish(&active.scene, crowd)?;
    if let Some(failure) = outcome.failure {
        return Err(super::failed(failure, "please report this with the plan and `gaitway verify`"));
    }
    outcome.wall_seconds = active.begin.elapsed().as_secs_f64();
    // the folder has another name soon
    outcome.trajectories =
        outcome.trajectories.and_then(|(path, frames)| Some((path.file_name()?.into(), frames)));
    let record = Record {
        key: &active.run.key,
        version: &header.version,
        outcome: &outcome,
        values: header.vary.iter().map(String::as_str).zip(&active.run.values).collect(),
        set: &active.settings,
        fps: header.fps,
        scenario: &header.scenario,
        scenario_text: &header.text,
    };
    let path = active.unfinished.path().join(RECORD);
    let write = || -> std::io::Result<()> {
        let mut line = serde_json::to_vec(&record)?;
        line.push(b'\n');
        file::write(&path, &line)
    };
    write().map_err(|source| sweep::Error::Write { path: path.clone(), source })?;
    let hash = outcome.state_hash.clone();
    Ok((active.unfinished.commit()?, hash))
}

fn print(summary: &Summary, arguments: &Arguments) -> Result<(), Error> {
    if arguments.json {
        return say_json(summary);
    }
    let count = |count: usize| thousands(count as u64);
    say(&format!("runs      {}", count(summary.runs)));
    say(&format!("done      {}", count(summary.done)));
    say(&format!("skipped   {} (done before)", count(summary.skipped)));
    if summary.taken > 0 {
        say(&format!("taken     {} (done by another process meanwhile)", count(summary.taken)));
    }
    if !summary.failed.is_empty() {
        say(&format!("failed    {}", count(summary.failed.len())));
    }
    say(&format!("folder    {}", arguments.out.display()));
    say(&format!("wall time {:.2} s", summary.wall_seconds));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_numbers_and_ranges_without_their_end() {
        let read = |text: &str| text.parse::<Indices>();
        let all: Vec<usize> = (0..20).filter(|number| read("3,7..9, 12").unwrap().holds(*number)).collect();
        assert_eq!(all, [3, 7, 8, 12]);
        for text in ["", "a", "3..3", "5..2", "-1", "1..", "..4", "3,"] {
            assert!(read(text).is_err(), "{text}");
        }
        assert!(read("5..20").unwrap().check(10).is_ok());
        assert!(read("10..20").unwrap().check(10).unwrap_err().to_string().contains("10 runs"));
    }
}
